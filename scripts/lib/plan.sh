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
# Arrays side by side, one entry for each package of the list.
needNames=()    # the name, and its alternatives, separated by spaces
needVersion=()  # least version, or empty
needOptional=() # 'optional' or empty
needRemark=()   # what does not work without it, or empty

readPackageList() {
    local line name names version optional remark
    while IFS= read -r line || [[ -n $line ]]; do
        version='' optional='' remark=''
        if [[ $line =~ ^([^#]*)#[[:space:]]*(.*)$ ]]; then
            line=${BASH_REMATCH[1]} remark=${BASH_REMATCH[2]}
        fi
        [[ $line =~ [^[:space:]] ]] || continue
        if [[ $line =~ ^(.*[[:space:]])optional[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]} optional=optional
        fi
        if [[ $line =~ ^(.*)\>=[[:space:]]*([^[:space:]]+)[[:space:]]*$ ]]; then
            line=${BASH_REMATCH[1]} version=${BASH_REMATCH[2]}
        fi
        read -ra names <<<"${line//|/ }"
        for name in "${names[@]}"; do
            [[ $name =~ ^[a-z0-9][a-z0-9.+-]+$ ]] || die "$1: '$name' is not a package name"
        done
        needNames+=("${names[*]}")
        needVersion+=("$version")
        needOptional+=("$optional")
        needRemark+=("$remark")
    done <"$1"
}

# describe INDEX: for people, 'cmake >= 3.25'.
describe() {
    local text=${needNames[$1]// / or }
    [[ -z ${needVersion[$1]} ]] || text+=" >= ${needVersion[$1]#*:}"
    [[ -z ${needOptional[$1]} ]] || text+=" (optional)"
    printf '%s' "$text"
}

# describeAll INDEX...: the same for several, with commas.
describeAll() {
    local i text=''
    for i in "$@"; do text+="${text:+, }$(describe "$i")"; done
    printf '%s' "$text"
}

printNeeds() {
    local i
    for i in "${!needNames[@]}"; do printf '    %s\n' "$(describe "$i")"; done
    cat <<'TEXT'
(names as in Debian 12), and a Vulkan driver with VK_KHR_ray_tracing_pipeline: that of a GPU which has it, or Mesa's
software driver lavapipe, Mesa 25.0 or later.
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

# versionFits HAVE LEAST: is HAVE at least LEAST? Any version fits an empty LEAST; no version (empty) fits nothing.
versionFits() {
    [[ -n $1 ]] || return 1
    [[ -z $2 ]] || dpkg --compare-versions "$1" ge "$2"
}

# Fills 'missing' with the indices of what no installed package meets: one call of dpkg-query for all.
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

isInstalled() {
    local name
    for name in ${needNames[$1]}; do
        if versionFits "${installedVersion[$name]-}" "${needVersion[$1]}"; then return 0; fi
    done
    return 1
}

# Fills 'candidate' with the versions that apt would install now.
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

# Has apt ever read its package lists? (A fresh container image has none.)
haveLists() {
    apt-cache policy 2>/dev/null | grep -v 'a=now' | grep -q '^ *release '
}

# suiteIsThere SUITE: is it among apt's sources?
suiteIsThere() {
    # shellcheck disable=SC2016  # apt fills these in
    apt-get indextargets --format '$(RELEASE) $(CODENAME)' 'Created-By: Packages' 2>/dev/null |
        tr ' ' '\n' | grep -Fxq -- "$1"
}

# ---- The plan -------------------------------------------------------------------------------------------------------
# Debian 12 itself lacks two things: a Mesa with ray tracing, which is in its backports, and the memory allocator, which
# is in Debian 13 (and needs nothing else: it is one header).
planUpdate=''     # 'unknown' where apt has no package lists yet, so that versions are only known after an update
planInstall=()    # packages by their plain name
planFromSuite=()  # 'package suite': to be installed from that suite
planAddSuite=()   # suites to add to apt's sources
planWarnings=()   # indices of optional things that will be missing or too old
planFailures=()   # indices of needed things that cannot be had

# The suite outside of Debian 12 proper that has a package; empty for none.
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
        suiteIsThere "$suite" || planAddSuite+=("$suite")
    elif [[ -n $planUpdate ]]; then
        planInstall+=("$name")
    elif [[ -n ${needOptional[$i]} ]]; then
        planWarnings+=("$i")
        # Better an old one than none: an old Mesa still has the drivers of GPUs.
        [[ -z ${candidate[$name]-} || -n ${installedVersion[$name]-} ]] || planInstall+=("$name")
    else
        planFailures+=("$i")
    fi
}

# Nothing to do, and no need to ask apt again: all that is missing is optional, and apt has nothing better.
planIsEmpty() {
    [[ -z $planUpdate ]] && ((${#planInstall[@]} + ${#planFromSuite[@]} + ${#planFailures[@]} == 0))
}

# offered INDEX: what is there and what apt offers, in words.
offered() {
    local name text=''
    for name in ${needNames[$1]}; do
        [[ -z ${installedVersion[$name]-} ]] || text="${installedVersion[$name]} is installed, "
        [[ -z ${candidate[$name]-} ]] || text+="apt offers ${candidate[$name]}"
    done
    printf '%s' "${text:-apt does not offer it}"
}

# printPlan [updated]: without the first step, where that is done.
printPlan() {
    local entry i
    say "on $osName:"
    [[ ${1-} == updated ]] || printf '  - apt-get update\n'
    for entry in "${planAddSuite[@]}"; do
        case $entry in
            trixie) printf '  - add trixie to the sources of apt for the next step, then take it out again\n' ;;
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
