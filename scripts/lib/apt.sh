# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Carries out the plan of plan.sh with apt. Sourced by setup.sh.
# shellcheck disable=SC2154  # plan.sh sets the variables of the plan

readonly aptDir="${QUINTET_APT_DIR:-/etc/apt}"

asRoot=()      # the words before a command that must run as root
sourceFailed='' # set if apt could not read one of its sources

apply() {
    say "missing or too old: $(describeAll "${missing[@]}")"
    findRoot || return 0
    say "updating the package lists (apt-get update), then installing"
    update
    makePlan
    if planIsEmpty; then
        printWarnings
        return
    fi
    giveUpIfImpossible
    printPlan updated

    trap removeTrixie EXIT
    installFromSuites
    if ((${#planInstall[@]})); then install "${planInstall[@]}"; fi
    checkResult
}

# Fails if root is needed but not available. Returns 1 if only optional packages are missing.
findRoot() {
    local i problem needed=()
    asRoot=()
    [[ $(id -u) != 0 ]] || return 0
    if command -v sudo >/dev/null; then
        asRoot=(sudo)
        # Without a terminal sudo cannot ask for a password and must fail immediately.
        [[ -t 0 ]] || asRoot+=(-n)
        ! "${asRoot[@]}" true || return 0
        problem="sudo did not work"
    else
        problem="sudo is not installed"
    fi
    for i in "${missing[@]}"; do
        [[ -n ${needOptional[$i]} ]] || needed+=("$i")
    done
    if ((${#needed[@]} == 0)); then
        warn "installing requires root, and $problem; continuing, because all of these packages are optional"
        return 1
    fi
    die "installing requires root, and $problem; run as root: bash scripts/setup.sh"
}

# Runs apt-get as root without questions. Waits for other apt and dpkg processes.
aptGet() {
    local name environment=(DEBIAN_FRONTEND=noninteractive LC_ALL=C)
    for name in http_proxy https_proxy no_proxy; do # sudo does not keep them
        [[ -z ${!name-} ]] || environment+=("$name=${!name}")
    done
    "${asRoot[@]}" env "${environment[@]}" apt-get -q \
        -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -o Acquire::http::Timeout=30 \
        -o Dpkg::Use-Pty=0 -o Dpkg::Options::=--force-confdef -o Dpkg::Options::=--force-confold "$@" </dev/null
}

# A single broken source, such as an old third-party one, is only a warning.
update() {
    local log deadline=$((SECONDS + 300)) failed=''
    log=$(mktemp)
    while ! aptGet -o APT::Update::Error-Mode=any update 2>&1 | tee "$log"; do
        # apt waits for the lock of dpkg, but not for this one. New machines update their lists at boot.
        if grep -q 'Could not get lock' "$log" && ((SECONDS < deadline)); then
            say "another program is using apt; waiting"
            sleep 5
        else
            failed=yes
            break
        fi
    done
    rm -f -- "$log"
    [[ -n $failed ]] || return 0
    sourceFailed=yes
    warn "apt-get update failed, at least in part (see above); continuing with the existing package lists"
}

install() {
    aptGet install -y --no-install-recommends "$@" ||
        die "apt-get install failed (see above); check the network and the free disk space, then run: make setup"
}

giveUpIfImpossible() {
    local i
    if [[ -n $planUpdate ]]; then
        die "apt has no package lists because apt-get update failed (see above); check the network"
    fi
    if ((${#planFailures[@]} == 0)); then return; fi
    for i in "${planFailures[@]}"; do
        printf 'setup: error: cannot install %s: %s\n' "$(describe "$i")" "$(offered "$i")" >&2
    done
    [[ -z $sourceFailed ]] || die "apt could not read all of its sources (see above); check the network"
    [[ $osId != ubuntu ]] || say "a package that apt does not offer may be in the component 'universe';" \
        "to enable it: add-apt-repository universe" >&2
    die "Quintet requires Debian 12, Ubuntu 24.04 or later; no package was installed"
}

installFromSuites() {
    local entry suite
    for suite in "${planAddSuite[@]}"; do addSuite "$suite"; done
    if ((${#planAddSuite[@]})); then update; fi
    for entry in "${planFromSuite[@]}"; do
        case ${entry#* } in
            trixie) install "${entry% *}" ;; # the pin allows this package only
            *) install -t "${entry#* }" "${entry% *}" ;;
        esac
    done
}

checkResult() {
    findMissing
    local i needed=()
    for i in "${missing[@]}"; do
        [[ -n ${needOptional[$i]} ]] || needed+=("$i")
    done
    ((${#needed[@]} == 0)) || die "still missing after the installation: $(describeAll "${needed[@]}")"
    say "done"
}

# ---- Suites ---------------------------------------------------------------------------------------------------------
sourceFile() { printf '%s' "$aptDir/sources.list.d/quintet-$1.sources"; }
pinFile() { printf '%s' "$aptDir/preferences.d/quintet-$1"; }

# writeAsRoot FILE: writes standard input, readable by all, because apt also reads its sources as its own user.
writeAsRoot() {
    "${asRoot[@]}" tee "$1" >/dev/null
    "${asRoot[@]}" chmod 644 "$1"
}

# addSuite SUITE: adds the suite from the mirror that apt uses for Debian, with the same key.
addSuite() {
    local suite=$1 entry uri location key
    # shellcheck disable=SC2016  # apt replaces the variables
    entry=$(apt-get indextargets --format '$(SOURCESENTRY) $(REPO_URI)' 'Created-By: Packages' \
        "Codename: $osCodename" 'Label: Debian' 'Component: main' | sed -n 1p)
    [[ -n $entry ]] || die "cannot add $suite: none of apt's sources is a mirror of Debian $osCodename"
    location=${entry%% *} uri=${entry#* }
    key=$(keyOf "$location" "$uri")
    {
        printf '# Written by scripts/setup.sh of Quintet.\n'
        printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: main\n' "$uri" "$suite"
        [[ -z $key ]] || printf 'Signed-By: %s\n' "$key"
    } | writeAsRoot "$(sourceFile "$suite")"
    if [[ $suite == trixie ]]; then
        writeAsRoot "$(pinFile trixie)" <<'PIN'
# Written by scripts/setup.sh of Quintet: allows only one header-only package of trixie.
Package: *
Pin: release n=trixie
Pin-Priority: -1

Package: libvulkan-memory-allocator-dev
Pin: release n=trixie
Pin-Priority: 500
PIN
    fi
}

# keyOf FILE:NUMBER URI: prints Signed-By of an entry of apt's sources: a file, a key with several lines, or nothing.
keyOf() {
    local file=${1%:*} number=${1##*:} uri=${2%/}
    if [[ $file == *.sources ]]; then
        # Finds the paragraph with this URI and prints its field with the continuation lines, which start with a space.
        awk -v uri="$uri" 'BEGIN { RS = ""; FS = "\n" }
            index($0, uri) && !found { for (i = 1; i <= NF; i++) {
                if ($i ~ /^[Ss]igned-[Bb]y:/) { inside = found = 1; sub(/^[^:]*:[ \t]*/, "", $i); print $i }
                else if (inside && $i ~ /^[ \t]/) print $i
                else if ($i !~ /^#/) inside = 0 } }' "$file"
    else
        sed -n "${number}s/.*[[ ]signed-by=\([^] ]*\).*/\1/p" "$file"
    fi
}

# Removes trixie after its package is installed, because its pin would block an upgrade to Debian 13.
removeTrixie() {
    local file files=()
    for file in "$(sourceFile trixie)" "$(pinFile trixie)"; do
        [[ ! -e $file ]] || files+=("$file")
    done
    ((${#files[@]} == 0)) || "${asRoot[@]}" rm -f -- "${files[@]}"
}
