# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# The plan of setup.sh: compares the package list with the packages that dpkg has and that apt offers. Does not change
# the system. Sourced by setup.sh.

say() { printf 'setup: %s\n' "$*"; }
warn() { printf 'setup: warning: %s\n' "$*" >&2; }
die() {
    printf 'setup: error: %s\n' "$*" >&2
    exit 1
}

# ---- The list -------------------------------------------------------------------------------------------------------
# Parallel arrays with one entry per package of the list.
needNames=()    # names, separated by spaces
needVersion=()  # minimum version, or empty
needOptional=() # 'optional' or empty
needCommand=()  # command that replaces the package, or empty
needRemark=()   # consequence if it is missing, or empty

# readPackageList FILE [GROUP…]: reads the packages of these groups; of all groups if none is given.
readPackageList() {
    local file=$1 line name names version optional command remark group='' wanted
    shift
    wanted=" $* "
    for name in "$@"; do
        grep -Fxq -- "[$name]" "$file" || die "unknown group '$name'; see --help"
    done
    while IFS= read -r line || [[ -n $line ]]; do
        version='' optional='' command='' remark=''
        if [[ $line =~ ^([^#]*)#[[:space:]]*(.*)$ ]]; then
            line=${BASH_REMATCH[1]} remark=${BASH_REMATCH[2]}
        fi
        [[ $line =~ [^[:space:]] ]] || continue
        if [[ $line =~ ^\[([a-z]+)\][[:space:]]*$ ]]; then
            group=${BASH_REMATCH[1]}
            continue
        fi
        [[ $wanted == '  ' || $wanted == *" $group "* ]] || continue
        if [[ $line =~ ^(.*[[:space:]])optional[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]} optional=optional
        fi
        if [[ $line =~ ^(.*[[:space:]])unless[[:space:]]+([a-z0-9.+-]+)[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]} command=${BASH_REMATCH[2]}
        fi
        if [[ $line =~ ^(.*)\>=[[:space:]]*([^[:space:]]+)[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]} version=${BASH_REMATCH[2]}
        fi
        read -ra names <<<"${line//|/ }"
        for name in "${names[@]}"; do
            [[ $name =~ ^[a-z0-9][a-z0-9.+-]+$ ]] || die "$file: '$name' is not a package name"
        done
        needNames+=("${names[*]}")
        needVersion+=("$version")
        needOptional+=("$optional")
        needCommand+=("$command")
        needRemark+=("$remark")
    done <"$file"
}

# describe INDEX: prints 'cmake >= 3.25'.
describe() {
    local text=${needNames[$1]// / or }
    [[ -z ${needVersion[$1]} ]] || text+=" >= ${needVersion[$1]#*:}"
    [[ -z ${needOptional[$1]} ]] || text+=" (optional)"
    printf '%s' "$text"
}

# describeAll INDEX...: prints several descriptions, separated by commas.
describeAll() {
    local i text=''
    for i in "$@"; do text+="${text:+, }$(describe "$i")"; done
    printf '%s' "$text"
}

printNeeds() {
    local i
    for i in "${!needNames[@]}"; do printf '    %s\n' "$(describe "$i")"; done
    cat <<'TEXT'
(names of Debian 12), and a Vulkan driver with VK_KHR_ray_tracing_pipeline: the driver of a GPU that supports it, or
lavapipe, the software driver of Mesa 25.0 or later.
TEXT
}

# ---- The system -----------------------------------------------------------------------------------------------------
osId='' osCodename='' osName=''

readOsRelease() {
    osId='' osCodename='' osName='this system'
    [[ -r $1 ]] || return 0
    local values
    # The file contains shell assignments. A subshell reads it, so that they do not change variables of this script.
    mapfile -t values < <(
        # shellcheck disable=SC1090
        source "$1"
        printf '%s\n' "${ID-}" "${VERSION_CODENAME-}" "${PRETTY_NAME-this system}"
    )
    osId=${values[0]} osCodename=${values[1]} osName=${values[2]}
}

# versionFits VERSION MINIMUM: succeeds if VERSION is not empty and at least MINIMUM, which can be empty.
versionFits() {
    [[ -n $1 ]] || return 1
    [[ -z $2 ]] || dpkg --compare-versions "$1" ge "$2"
}

# Fills 'missing' with the indices of packages that are not installed or too old, with one call of dpkg-query.
declare -A installedVersion=()
missing=()

findMissing() {
    local names native package status architecture version i
    read -ra names <<<"${needNames[*]}"
    native=$(dpkg --print-architecture)
    installedVersion=()
    while IFS=$'\t' read -r package status architecture version; do
        [[ $status == installed && ($architecture == "$native" || $architecture == all) ]] || continue
        installedVersion[$package]=$version
    done < <(dpkg-query -W -f='${Package}\t${db:Status-Status}\t${Architecture}\t${Version}\n' \
        "${names[@]}" 2>/dev/null)
    missing=()
    for i in "${!needNames[@]}"; do
        isInstalled "$i" || missing+=("$i")
    done
}

# hasCommand NAME: succeeds if it is a command, whichever package it is from.
hasCommand() (
    PATH=${QUINTET_COMMAND_PATH-$PATH}
    command -v "$1" >/dev/null
)

isInstalled() {
    local name
    if [[ -n ${needCommand[$1]} ]] && hasCommand "${needCommand[$1]}"; then return 0; fi
    for name in ${needNames[$1]}; do
        if versionFits "${installedVersion[$name]-}" "${needVersion[$1]}"; then return 0; fi
    done
    return 1
}

# Fills 'candidate' with the versions that apt would install.
declare -A candidate=()

readCandidates() {
    local names=() line package='' i
    candidate=()
    for i in "${missing[@]}"; do
        # shellcheck disable=SC2206  # alternatives are separated by spaces
        names+=(${needNames[$i]})
    done
    while IFS= read -r line; do
        if [[ $line =~ ^([^[:space:]].*):$ ]]; then
            package=${BASH_REMATCH[1]}
        elif [[ $line =~ ^[[:space:]]+Candidate:[[:space:]]([^\(].*)$ ]]; then
            candidate[$package]=${BASH_REMATCH[1]}
        fi
    done < <(apt-cache policy "${names[@]}" 2>/dev/null)
}

# Succeeds if apt has package lists. A new container image has none.
haveLists() {
    apt-cache policy 2>/dev/null | grep -v 'a=now' | grep -q '^ *release '
}

# hasSuite SUITE: succeeds if it is one of apt's sources.
hasSuite() {
    # shellcheck disable=SC2016  # apt replaces the variables
    apt-get indextargets --format '$(RELEASE) $(CODENAME)' 'Created-By: Packages' 2>/dev/null |
        tr ' ' '\n' | grep -Fxq -- "$1"
}

# ---- The plan -------------------------------------------------------------------------------------------------------
# Debian 12 lacks a Mesa with ray tracing, which is in its backports, and the memory allocator, which is in Debian 13
# and has no dependencies, because it is one header.
planUpdate=''     # 'unknown' if apt has no package lists, so that versions are known only after an update
planInstall=()    # packages from the regular suites
planFromSuite=()  # entries 'package suite'
planAddSuite=()   # suites to add to apt's sources
planWarnings=()   # indices of optional packages that stay missing or too old
planFailures=()   # indices of required packages that cannot be installed

# suiteFor PACKAGE: prints the additional suite for a package on Debian 12; empty if none is needed.
suiteFor() {
    [[ $osId == debian && $osCodename == bookworm ]] || return 0
    case $1 in
        mesa-vulkan-drivers) echo bookworm-backports ;;
        libvulkan-memory-allocator-dev) echo trixie ;;
    esac
}

makePlan() {
    local i
    planUpdate='' planInstall=() planFromSuite=() planAddSuite=() planWarnings=() planFailures=()
    haveLists || planUpdate=unknown
    readCandidates
    for i in "${missing[@]}"; do planOne "$i"; done
}

planOne() {
    local i=$1 name suite
    for name in ${needNames[$i]}; do
        if versionFits "${candidate[$name]-}" "${needVersion[$i]}"; then
            planInstall+=("$name")
            return
        fi
    done
    name=${needNames[$i]%% *}
    suite=$(suiteFor "$name")
    if [[ -n $suite ]]; then
        planFromSuite+=("$name $suite")
        hasSuite "$suite" || planAddSuite+=("$suite")
    elif [[ -n $planUpdate ]]; then
        planInstall+=("$name")
    elif [[ -n ${needOptional[$i]} ]]; then
        planWarnings+=("$i")
        # An old version is better than none: an old Mesa still has drivers for GPUs.
        [[ -z ${candidate[$name]-} || -n ${installedVersion[$name]-} ]] || planInstall+=("$name")
    else
        planFailures+=("$i")
    fi
}

# Succeeds if all missing packages are optional and apt has no better versions.
planIsEmpty() {
    [[ -z $planUpdate ]] && ((${#planInstall[@]} + ${#planFromSuite[@]} + ${#planFailures[@]} == 0))
}

# offered INDEX: prints the installed version and the version that apt offers.
offered() {
    local name text=''
    for name in ${needNames[$1]}; do
        [[ -z ${installedVersion[$name]-} ]] || text="${installedVersion[$name]} is installed, "
        [[ -z ${candidate[$name]-} ]] || text+="apt offers ${candidate[$name]}"
    done
    printf '%s' "${text:-apt does not offer it}"
}

# printPlan [updated]: 'updated' omits the first step.
printPlan() {
    local entry i
    say "on $osName:"
    [[ ${1-} == updated ]] || printf '  - apt-get update\n'
    for entry in "${planAddSuite[@]}"; do
        case $entry in
            trixie) printf '  - add trixie to the sources of apt for the next step, then remove it\n' ;;
            *) printf '  - add %s to the sources of apt\n' "$entry" ;;
        esac
    done
    for entry in "${planFromSuite[@]}"; do
        printf '  - install from %s: %s\n' "${entry#* }" "${entry% *}"
    done
    if ((${#planInstall[@]})); then
        printf '  - install: %s\n' "${planInstall[*]}"
    fi
    if [[ -n $planUpdate ]]; then
        printf '  (apt has no package lists yet: versions are checked after the update)\n'
    fi
    printWarnings
    for i in "${planFailures[@]}"; do
        printf '  - CANNOT install %s: %s\n' "$(describe "$i")" "$(offered "$i")"
    done
}

printWarnings() {
    local i
    for i in "${planWarnings[@]}"; do
        warn "$(describe "$i"): $(offered "$i")${needRemark[$i]:+; without it: ${needRemark[$i]}}"
    done
}
