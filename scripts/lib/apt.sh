# shellcheck shell=bash
# Carries out the plan of plan.sh with apt. Sourced by setup.sh.
# shellcheck disable=SC2154  # the plan's variables are set in plan.sh

readonly aptDir="${QUINTET_APT_DIR:-/etc/apt}"

asRoot=()      # the words before a command that must run as root
sourceFailed='' # set where apt could not read one of its sources

apply() {
    say "missing or too old: $(describeAll "${missing[@]}")"
    findRoot || return 0
    say "reading apt's package lists anew (apt-get update), then installing them"
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

# Fails where root is needed and cannot be had; returns 1 where only optional things are missing then.
findRoot() {
    local i problem needed=()
    asRoot=()
    [[ $(id -u) != 0 ]] || return 0
    if command -v sudo >/dev/null; then
        asRoot=(sudo)
        # Without a terminal sudo could not ask for a password: let it fail at once.
        [[ -t 0 ]] || asRoot+=(-n)
        ! "${asRoot[@]}" true || return 0
        problem="sudo did not work"
    else
        problem="there is no sudo"
    fi
    for i in "${missing[@]}"; do
        [[ -n ${needOptional[$i]} ]] || needed+=("$i")
    done
    if ((${#needed[@]} == 0)); then
        warn "installing needs root, and $problem: going on without, as all of this is optional"
        return 1
    fi
    die "installing needs root, and $problem. As root, run: bash scripts/setup.sh"
}

# Runs apt-get as root, asking nothing. Waits for another apt or dpkg that runs at the same time.
aptGet() {
    local name environment=(DEBIAN_FRONTEND=noninteractive LC_ALL=C)
    for name in http_proxy https_proxy no_proxy; do # sudo drops them
        [[ -z ${!name-} ]] || environment+=("$name=${!name}")
    done
    "${asRoot[@]}" env "${environment[@]}" apt-get -q \
        -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -o Acquire::http::Timeout=30 \
        -o Dpkg::Use-Pty=0 -o Dpkg::Options::=--force-confdef -o Dpkg::Options::=--force-confold "$@" </dev/null
}

# One broken source of several (somebody's old third-party one) is no reason to stop: what can be had decides.
update() {
    local log deadline=$((SECONDS + 300)) failed=''
    log=$(mktemp)
    while ! aptGet -o APT::Update::Error-Mode=any update 2>&1 | tee "$log"; do
        # For this lock, unlike dpkg's, apt does not wait by itself. Fresh machines update when they boot.
        if grep -q 'Could not get lock' "$log" && ((SECONDS < deadline)); then
            say "another program is using apt: waiting for it"
            sleep 5
        else
            failed=yes
            break
        fi
    done
    rm -f -- "$log"
    [[ -n $failed ]] || return 0
    sourceFailed=yes
    warn "apt-get update failed, at least in part (see above): going on with the package lists that are there"
}

install() {
    aptGet install -y --no-install-recommends "$@" ||
        die "apt-get install failed, see above. Is there a network, and room on the disk? To try again: make setup"
}

giveUpIfImpossible() {
    local i
    if [[ -n $planUpdate ]]; then
        die "apt has no package lists: apt-get update failed, see above. Is there a network?"
    fi
    if ((${#planFailures[@]} == 0)); then return; fi
    for i in "${planFailures[@]}"; do
        printf 'setup: error: cannot install %s: %s\n' "$(describe "$i")" "$(offered "$i")" >&2
    done
    [[ -z $sourceFailed ]] || die "apt could not read all of its sources, see above. Is there a network?"
    [[ $osId != ubuntu ]] || say "if apt does not offer a package, the component 'universe' may be off" \
        "(to switch it on: add-apt-repository universe)" >&2
    die "Quintet needs Debian 12, Ubuntu 24.04, or later. Nothing was installed"
}

installFromSuites() {
    local entry suite
    for suite in "${planAddSuite[@]}"; do addSuite "$suite"; done
    if ((${#planAddSuite[@]})); then update; fi
    for entry in "${planFromSuite[@]}"; do
        case ${entry#* } in
            trixie) install "${entry% *}" ;; # the pin lets this one package through
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

# Standard input to a file, as root, readable by all (apt reads its sources as a user of its own too).
writeAsRoot() {
    "${asRoot[@]}" tee "$1" >/dev/null
    "${asRoot[@]}" chmod 644 "$1"
}

# addSuite SUITE: from the mirror that apt uses for Debian already, checked with the same key.
addSuite() {
    local suite=$1 entry uri place key
    # shellcheck disable=SC2016  # apt fills these in
    entry=$(apt-get indextargets --format '$(SOURCESENTRY) $(REPO_URI)' 'Created-By: Packages' \
        "Codename: $osCodename" 'Label: Debian' 'Component: main' | sed -n 1p)
    [[ -n $entry ]] || die "none of apt's sources is a mirror of Debian $osCodename, so $suite cannot be added"
    place=${entry%% *} uri=${entry#* }
    key=$(keyOf "$place" "$uri")
    {
        printf '# Written by scripts/setup.sh of Quintet.\n'
        printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: main\n' "$uri" "$suite"
        [[ -z $key ]] || printf 'Signed-By: %s\n' "$key"
    } | writeAsRoot "$(sourceFile "$suite")"
    if [[ $suite == trixie ]]; then
        writeAsRoot "$(pinFile trixie)" <<'PIN'
# Written by scripts/setup.sh of Quintet: of trixie, nothing but one header-only package.
Package: *
Pin: release n=trixie
Pin-Priority: -1

Package: libvulkan-memory-allocator-dev
Pin: release n=trixie
Pin-Priority: 500
PIN
    fi
}

# keyOf FILE:NUMBER URI: the Signed-By of an entry of apt's sources: a file, or a key over several lines, or nothing.
keyOf() {
    local file=${1%:*} number=${1##*:} uri=${2%/}
    if [[ $file == *.sources ]]; then
        # Paragraphs; the one with this URI; its field, with the lines that go on with a space.
        awk -v uri="$uri" 'BEGIN { RS = ""; FS = "\n" }
            index($0, uri) && !found { for (i = 1; i <= NF; i++) {
                if ($i ~ /^[Ss]igned-[Bb]y:/) { inside = found = 1; sub(/^[^:]*:[ \t]*/, "", $i); print $i }
                else if (inside && $i ~ /^[ \t]/) print $i
                else if ($i !~ /^#/) inside = 0 } }' "$file"
    else
        sed -n "${number}s/.*[[ ]signed-by=\([^] ]*\).*/\1/p" "$file"
    fi
}

# Takes trixie out again once its one package is in: left there, its pin would block a later upgrade to Debian 13.
removeTrixie() {
    local file files=()
    for file in "$(sourceFile trixie)" "$(pinFile trixie)"; do
        [[ ! -e $file ]] || files+=("$file")
    done
    ((${#files[@]} == 0)) || "${asRoot[@]}" rm -f -- "${files[@]}"
}
