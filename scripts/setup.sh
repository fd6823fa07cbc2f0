#!/usr/bin/env bash
# Installs what Quintet needs to build and run, with apt: the packages of scripts/lib/packages.txt that are missing
# or too old. Says what it will do first; asks nothing; does nothing, quickly, where nothing is missing.
#
#     scripts/setup.sh           do it
#     scripts/setup.sh --plan    print what it would do, and change nothing
#
# Environment: QUINTET_SETUP=skip       do nothing at all (the packages come from somewhere else)
#              QUINTET_OS_RELEASE=FILE  read FILE in place of /etc/os-release (tests)
set -euo pipefail
export LC_ALL=C

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
readonly here
readonly packageList="$here/lib/packages.txt"
readonly osRelease="${QUINTET_OS_RELEASE:-/etc/os-release}"

# shellcheck source=scripts/lib/plan.sh
source "$here/lib/plan.sh"
# shellcheck source=scripts/lib/apt.sh
source "$here/lib/apt.sh"

main() {
    local mode=apply
    case "${1-}" in
        '') ;;
        --plan) mode=plan ;;
        -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; return ;;
        *) die "unknown argument '$1' (try --help)" ;;
    esac
    if [[ ${QUINTET_SETUP-} == skip ]]; then
        say "skipped, as QUINTET_SETUP=skip asks"
        return
    fi

    readPackageList "$packageList"
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "no apt on this system, so nothing is installed. Quintet needs:"
        printNeeds
        return
    fi
    readOsRelease "$osRelease"

    findMissing
    if ((${#missing[@]} == 0)); then
        say "nothing to install"
        return
    fi
    if [[ $mode == plan ]]; then
        makePlan
        printPlan
        return
    fi
    apply
}

main "$@"
