# shellcheck shell=bash
# What setup.sh would do: reads the package list, asks dpkg what is there and apt what it offers, and decides.
# Changes nothing on the system. Sourced by setup.sh.

say() { printf 'setup: %s\n' "$*"; }
warn() { printf 'setup: warning: %s\n' "$*" >&2; }
die() {
    printf 'setup: error: %s\n' "$*" >&2
    exit 1
}

# ---- The list -------------------------------------------------------------------------------------------------------
# Three arrays side by side, one entry for each line of the list.
needNames=()    # alternatives, separated by spaces
needVersion=()  # least version, or empty
needOptional=() # 'optional' or empty

readPackageList() {
    local line names version optional
    while IFS= read -r line || [[ -n $line ]]; do
        line=${line%%#*}
        [[ $line =~ [^[:space:]] ]] || continue
        optional='' version=''
        if [[ $line =~ ^(.*[[:space:]])optional[[:space:]]*$ ]]; then
            optional=optional
            line=${BASH_REMATCH[1]}
        fi
        if [[ $line =~ ^(.*)\>=[[:space:]]*([^[:space:]]+)[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]}
            version=${BASH_REMATCH[2]}
        fi
        read -ra names <<<"${line//|/ }"
        local name
        for name in "${names[@]}"; do
            [[ $name =~ ^[a-z0-9][a-z0-9.+-]+$ ]] || die "$1: not a package name: '$name'"
        done
        needNames+=("${names[*]}")
        needVersion+=("$version")
        needOptional+=("$optional")
    done <"$1"
}

# One line for people: 'cmake >= 3.25'.
describe() {
    local text=${needNames[$1]// / or }
    [[ -z ${needVersion[$1]} ]] || text+=" >= ${needVersion[$1]#*:}"
    [[ -z ${needOptional[$1]} ]] || text+=" (optional)"
    printf '%s' "$text"
}

printNeeds() {
    local i
    for i in "${!needNames[@]}"; do printf '    %s\n' "$(describe "$i")"; done
    cat <<'TEXT'
(names as on Debian 12), and a Vulkan driver with VK_KHR_ray_tracing_pipeline: that of an RTX-class GPU, or
Mesa's software driver lavapipe, version 25 or later.
TEXT
}

# ---- The system -----------------------------------------------------------------------------------------------------
osId='' osCodename='' osName=''

readOsRelease() {
    osId='' osCodename='' osName='this system'
    [[ -r $1 ]] || return 0
    local values
    # A file of shell assignments; read in a shell of its own, so that none of them lands here.
    mapfile -t values < <(
        # shellcheck disable=SC1090
        source "$1"
        printf '%s\n' "${ID-}" "${VERSION_CODENAME-}" "${PRETTY_NAME-this system}"
    )
    osId=${values[0]} osCodename=${values[1]} osName=${values[2]}
}

# versionFits HAVE LEAST: is HAVE at least LEAST? An empty LEAST fits all but no version.
versionFits() {
    [[ -n $1 ]] || return 1
    [[ -z $2 ]] || dpkg --compare-versions "$1" ge "$2"
}

# Fills 'missing' with the indices of the needs that no installed package meets: one call of dpkg-query for all.
declare -A installedVersion=()
missing=()

findMissing() {
    local names architecture package status arch version i
    read -ra names <<<"${needNames[*]}"
    architecture=$(dpkg --print-architecture)
    installedVersion=()
    while IFS=$'\t' read -r package status arch version; do
        [[ $status == installed && ($arch == "$architecture" || $arch == all) ]] || continue
        installedVersion[$package]=$version
    done < <(dpkg-query -W -f='${Package}\t${db:Status-Status}\t${Architecture}\t${Version}\n' "${names[@]}" 2>/dev/null)
    missing=()
    for i in "${!needNames[@]}"; do
        isInstalled "$i" || missing+=("$i")
    done
}

isInstalled() {
    local name
    for name in ${needNames[$1]}; do
        if versionFits "${installedVersion[$name]-}" "${needVersion[$1]}"; then return 0; fi
    done
    return 1
}

# Fills 'candidate' with what apt would install now.
declare -A candidate=()

readCandidates() {
    local names i line package=''
    candidate=() names=()
    for i in "${missing[@]}"; do
        # shellcheck disable=SC2206  # alternatives are separated by spaces
        names+=(${needNames[$i]})
    done
    while IFS= read -r line; do
        if [[ $line =~ ^([^[:space:]].*):$ ]]; then
            package=${BASH_REMATCH[1]}
        elif [[ $line =~ ^[[:space:]]+Candidate:[[:space:]](.*)$ && ${BASH_REMATCH[1]} != '(none)' ]]; then
            candidate[$package]=${BASH_REMATCH[1]}
        fi
    done < <(apt-cache policy "${names[@]}" 2>/dev/null)
}

# ---- The plan -------------------------------------------------------------------------------------------------------
# Debian 12 lacks two things: a Mesa with ray tracing, which is in its backports, and the memory allocator, which is in
# Debian 13. Where those suites are not among apt's sources, they are added, the second for that one package only.
planInstall=()       # packages by their plain name
planFromSuite=()     # 'package suite': to be installed from that suite
planAddSuite=()      # suites to add to apt's sources
planWarnings=()      # optional things that apt cannot offer
planFailures=()      # needed things that apt cannot offer

# The suite outside of Debian 12 proper that has a package; empty for none.
suiteFor() {
    [[ $osId == debian && $osCodename == bookworm ]] || return 0
    case $1 in
        mesa-vulkan-drivers) echo bookworm-backports ;;
        libvulkan-memory-allocator-dev) echo trixie ;;
    esac
}

makePlan() {
    local i name chosen suite
    planInstall=() planFromSuite=() planAddSuite=() planWarnings=() planFailures=()
    readCandidates
    for i in "${missing[@]}"; do
        chosen=''
        for name in ${needNames[$i]}; do
            if versionFits "${candidate[$name]-}" "${needVersion[$i]}"; then
                chosen=$name
                break
            fi
        done
        name=${needNames[$i]%% *}
        suite=$(suiteFor "$name")
        if [[ -n $chosen ]]; then
            planInstall+=("$chosen")
        elif [[ -n $suite ]]; then
            planFromSuite+=("$name $suite")
            suiteIsThere "$suite" || planAddSuite+=("$suite")
        elif [[ -n ${needOptional[$i]} ]]; then
            planWarnings+=("$i")
        else
            planFailures+=("$i")
        fi
    done
}

# Does apt have this suite among its sources?
suiteIsThere() {
    apt-get indextargets --format '$(RELEASE) $(CODENAME)' 'Created-By: Packages' 2>/dev/null | tr ' ' '\n' |
        grep -Fxq -- "$1"
}

# What apt offers for a need, in words.
offered() {
    local name text=''
    for name in ${needNames[$1]}; do
        [[ -z ${candidate[$name]-} ]] || text="apt offers ${candidate[$name]}"
    done
    [[ -n $text ]] || text="apt does not know it"
    printf '%s' "$text"
}

printPlan() {
    local entry i
    say "on $osName, the plan:"
    printf '  apt-get update\n'
    for entry in "${planAddSuite[@]}"; do
        printf '  add the suite %s to the sources of apt' "$entry"
        [[ $entry != trixie ]] || printf ', for libvulkan-memory-allocator-dev alone'
        printf '\n'
    done
    if ((${#planInstall[@]})); then
        printf '  install %s\n' "${planInstall[*]}"
    fi
    for entry in "${planFromSuite[@]}"; do
        printf '  install %s from %s\n' "${entry% *}" "${entry#* }"
    done
    for i in "${planWarnings[@]}"; do
        printf '  leave out %s: %s\n' "$(describe "$i")" "$(offered "$i")"
    done
    for i in "${planFailures[@]}"; do
        printf '  CANNOT install %s: %s\n' "$(describe "$i")" "$(offered "$i")"
    done
}
