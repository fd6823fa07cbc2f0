#!/usr/bin/env bash
# Installs with apt what Quintet needs to build and run: those packages of scripts/lib/packages.txt that are missing
# or too old. Says what it will do before it does it; asks nothing; is quick where nothing is missing.
#
#     scripts/setup.sh           do it
#     scripts/setup.sh --plan    print what it would do, and change nothing (exit status 1: it could not be done)
#
# Environment:
#     QUINTET_SETUP=skip         do nothing: the packages come from somewhere else
#     QUINTET_OS_RELEASE=FILE    in place of /etc/os-release (tests)
#     QUINTET_APT_DIR=FOLDER     in place of /etc/apt, for the files that this script writes (tests)
set -euo pipefail
export LC_ALL=C

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

# shellcheck source=scripts/lib/plan.sh
source "$here/lib/plan.sh"
# shellcheck source=scripts/lib/apt.sh
source "$here/lib/apt.sh"

main() {
    local mode=apply
    case "${1-}" in
        '') ;;
        --plan) mode=plan ;;
        -h | --help)
            sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"
            return
            ;;
        *) die "unknown argument '$1' (try --help)" ;;
    esac
    if [[ ${QUINTET_SETUP-} == skip ]]; then
        say "skipped, as QUINTET_SETUP=skip asks"
        return
    fi

    readPackageList "$here/lib/packages.txt"
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this system has no apt, so nothing is installed. Quintet needs:"
        printNeeds
        return
    fi
    readOsRelease "${QUINTET_OS_RELEASE:-/etc/os-release}"

    findMissing
    if ((${#missing[@]} == 0)); then
        say "nothing to install"
        return
    fi
    makePlan
    if [[ $mode == plan ]]; then
        printPlan
        ((${#planFailures[@]} == 0))
    elif planIsEmpty; then
        printWarnings
    else
        apply
    fi
}

main "$@"
