# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# A simulated system for tests of scripts/setup.sh: os-release, installed packages, packages and sources of apt, the
# user. Sourced by run.sh. Each test calls 'newSystem', describes the system, and runs setup.sh with 'setup ARGUMENTS'.
# The simulated programs come first in the PATH and read the files below $system. apt-get logs its calls in
# $system/calls and updates $system/installed.

# shellcheck disable=SC2154,SC2034  # run.sh sets 'scratch' and reads 'output' and 'status'
# shellcheck disable=SC2016  # texts of programs

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
export system=''

newSystem() {
    system=$(mktemp -d "$scratch/system.XXXXXX")
    mkdir -p "$system"/{bin,apt/sources.list.d,apt/preferences.d}
    : >"$system/installed" # package version
    : >"$system/offered"   # package version [suite]; apt offers it without a suite or with an available one
    : >"$system/suites"    # codename, URI, location of the source
    : >"$system/calls"
    echo 0 >"$system/uid"
    touch "$system/lists"
    osRelease debian 99 nothing

    fake dpkg <<'SH'
[[ $1 != --print-architecture ]] || { echo amd64; exit; }
exec "$realDpkg" "$@"
SH
    # Like the real one: prints a line for each known package, status 1 if some are unknown.
    fake dpkg-query <<'SH'
while read -r package version; do
    [[ " $* " != *" $package "* ]] || printf '%s\tinstalled\tamd64\t%s\n' "$package" "$version"
done <"$system/installed"
exit 1
SH
    fake apt-cache <<'SH'
[[ $1 == policy ]] || exit 100
shift
if (($# == 0)); then
    printf 'Package files:\n 100 /var/lib/dpkg/status\n     release a=now\n'
    [[ ! -e $system/lists ]] || printf ' 500 mirror suite/main\n     release v=1,o=Maker,a=stable,n=suite\n'
    exit
fi
declare -A candidate=()
while read -r package version suite; do
    [[ -e $system/lists ]] || break
    # Packages of backports are no candidates by default.
    [[ -n $suite && ! -e $system/apt/preferences.d/quintet-$suite ]] || candidate[$package]=$version
done <"$system/offered"
for name in "$@"; do
    printf '%s:\n  Installed: (none)\n  Candidate: %s\n  Version table:\n' "$name" "${candidate[$name]-(none)}"
done
SH
    fake apt-get <<'SH'
printf 'apt-get %s\n' "$*" >>"$system/calls"
[[ ${DEBIAN_FRONTEND-} == noninteractive || $1 == indextargets ]] || exit 100
words=() release=''
while (($#)); do
    case $1 in
        indextargets)
            while read -r codename uri place; do
                case $3 in
                    *SOURCESENTRY*) [[ " $* " != *" Codename: $codename "* ]] || printf '%s %s\n' "$place" "$uri" ;;
                    *) printf '%s %s\n' "$codename" "$codename" ;;
                esac
            done <"$system/suites"
            exit
            ;;
        -o) shift ;;
        -t) release=$2; shift ;;
        -*) ;;
        *) words+=("$1") ;;
    esac
    shift
done
case ${words[0]} in
    update)
        [[ ! -e $system/offline ]] || exit 100
        if [[ -e $system/locked ]]; then
            rm "$system/locked"
            echo "E: Could not get lock lists/lock. It is held by process 1" >&2
            exit 100
        fi
        touch "$system/lists"
        for file in "$system"/apt/sources.list.d/quintet-*.sources; do
            [[ ! -e $file ]] || cp "$file" "$system/seen-${file##*/}"
        done
        pins=$system/apt/preferences.d/quintet-trixie
        [[ ! -e $pins ]] || cp "$pins" "$system/seen-pins"
        ;;
    install)
        declare -A version=()
        while read -r package number suite; do
            if [[ -n $suite ]]; then
                [[ -e $system/apt/sources.list.d/quintet-$suite.sources ]] ||
                    grep -q "^$suite " "$system/suites" || continue
                [[ $release == "$suite" || -e $system/apt/preferences.d/quintet-$suite ]] || continue
            fi
            version[$package]=$number
        done <"$system/offered"
        while read -r package number; do
            [[ " ${words[*]} " == *" $package "* ]] || printf '%s %s\n' "$package" "$number"
        done <"$system/installed" >"$system/installed.new"
        for name in "${words[@]:1}"; do
            [[ -n ${version[$name]-} ]] || exit 100
            printf '%s %s\n' "$name" "${version[$name]}"
        done >>"$system/installed.new"
        mv "$system/installed.new" "$system/installed"
        ;;
esac
SH
    fake sleep <<<':'
    fake id <<<'cat "$system/uid"'
}

# fake NAME: creates a program of the simulated system with the text from standard input.
fake() {
    { printf '#!%s\n' "$BASH"; cat; } >"$system/bin/$1"
    chmod +x "$system/bin/$1"
}

# osRelease ID VERSION CODENAME
osRelease() {
    printf 'ID=%s\nVERSION_ID="%s"\nVERSION_CODENAME=%s\nPRETTY_NAME="Test %s %s"\n' "$1" "$2" "$3" "$1" "$2" \
        >"$system/os-release"
}

# offer PACKAGE VERSION [SUITE], installed PACKAGE VERSION: replace earlier entries of the package; 'none' removes it.
offer() {
    [[ -n ${3-} ]] || sed -i "/^$1 [^ ]*$/d" "$system/offered"
    [[ $2 == none ]] || printf '%s %s %s\n' "$1" "$2" "${3-}" | sed 's/ *$//' >>"$system/offered"
}
installed() {
    sed -i "/^$1 /d" "$system/installed"
    [[ $2 == none ]] || printf '%s %s\n' "$1" "$2" >>"$system/installed"
}

# suite CODENAME URI LOCATION: adds a source of apt.
suite() { printf '%s %s %s\n' "$1" "$2" "$3" >>"$system/suites"; }

# Offers or installs every package of the list in a sufficient version.
offerAll() { namesInList | sed 's/$/ 9:99/' >>"$system/offered"; }
installAll() { namesInList | sed 's/$/ 9:99/' >"$system/installed"; }
namesInList() {
    sed 's/#.*//; s/|.*//; s/>=.*//; s/unless .*//; s/optional//; s/ *$//; /^$/d; /^\[/d' "$repo/scripts/lib/packages.txt"
}

# setup ARGUMENTS: runs setup.sh. $output has both output streams, $status the exit status.
setup() {
    status=0
    output=$(PATH="${onlyPath:-$system/bin:$PATH}" \
        QUINTET_OS_RELEASE="$system/os-release" QUINTET_APT_DIR="$system/apt" QUINTET_COMMAND_PATH="$system/commands" \
        "$BASH" "$repo/scripts/setup.sh" "$@" 2>&1 </dev/null) || status=$?
}

# Prints the calls of apt-get without options and indextargets.
calls() {
    sed -n 's/ -o [^ ]*//g; s/ -q//; s/ -y//; s/ --no-install-recommends//; /indextargets/d; p' "$system/calls"
}
