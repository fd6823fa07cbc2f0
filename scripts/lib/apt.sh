# shellcheck shell=bash
# Carries out the plan of plan.sh with apt. Sourced by setup.sh.

asRoot=() # the words before a command that must run as root

findRoot() {
    asRoot=()
    [[ $(id -u) != 0 ]] || return 0
    command -v sudo >/dev/null ||
        die "packages are missing, and installing them needs root, but sudo is not there. As root, run: bash scripts/setup.sh"
    asRoot=(sudo)
    # Without a terminal sudo could not ask for a password: let it fail at once.
    [[ -t 0 ]] || asRoot+=(-n)
}

aptGet() {
    "${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C \
        apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -q "$@"
}

apply() {
    findRoot
    say "missing or too old: $(for i in "${missing[@]}"; do printf '%s; ' "$(describe "$i")"; done)"
    update
    makePlan
    printPlan
    local suite entry
    for suite in "${planAddSuite[@]}"; do addSuite "$suite"; done
    if ((${#planAddSuite[@]})); then update; fi
    if ((${#planInstall[@]})); then
        aptGet install -y --no-install-recommends "${planInstall[@]}" || die "apt-get install failed"
    fi
    for entry in "${planFromSuite[@]}"; do
        aptGet install -y --no-install-recommends -t "${entry#* }" "${entry% *}" || die "apt-get install failed"
    done
}

update() {
    aptGet update || die "apt-get update failed"
}

# Writes a file as root, readable by all (apt reads its sources as the user _apt too).
writeAsRoot() {
    "${asRoot[@]}" tee "$1" >/dev/null
    "${asRoot[@]}" chmod 644 "$1"
}

# addSuite SUITE: from the mirror that apt uses for Debian already, with the same key.
addSuite() {
    local suite=$1 entry uri source file stanza signedBy
    entry=$(apt-get indextargets --format '$(REPO_URI) $(SOURCESENTRY)' \
        'Created-By: Packages' "Codename: $osCodename" 'Label: Debian' 'Component: main' | head -n 1)
    [[ -n $entry ]] || die "none of apt's sources is a mirror of Debian $osCodename, so $suite cannot be added"
    uri=${entry%% *} source=${entry#* }
    file=${source%:*} stanza=${source##*:}
    signedBy=$(signedByOf "$file" "$stanza")
    {
        printf '# Written by scripts/setup.sh of Quintet.\n'
        printf 'Types: deb\nURIs: %s\nSuites: %s\nComponents: main\n' "$uri" "$suite"
        [[ -z $signedBy ]] || printf 'Signed-By: %s\n' "$signedBy"
    } | writeAsRoot "/etc/apt/sources.list.d/quintet-$suite.sources"
    if [[ $suite == trixie ]]; then
        writeAsRoot /etc/apt/preferences.d/quintet-trixie <<'PIN'
# Written by scripts/setup.sh of Quintet: of trixie, nothing but the header-only Vulkan memory allocator.
Package: *
Pin: release n=trixie
Pin-Priority: -1

Package: libvulkan-memory-allocator-dev
Pin: release n=trixie
Pin-Priority: 500
PIN
    fi
}

# signedByOf FILE NUMBER: the key of an entry of apt's sources. NUMBER counts stanzas in a .sources file (from 0 or 1,
# by apt's version) and lines in a .list file, so it is only used for the latter.
signedByOf() {
    if [[ $1 == *.sources ]]; then
        sed -n 's/^[Ss]igned-[Bb]y:[[:space:]]*//p' "$1" | head -n 1
    else
        sed -n "$2{s/.*signed-by=\([^] ]*\).*/\1/p}" "$1"
    fi
}
