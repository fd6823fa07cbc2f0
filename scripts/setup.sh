#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs with apt the packages of scripts/lib/packages.txt that are missing or too old. Prints the steps before it
# runs them, asks no questions, and returns quickly if nothing is missing.
#
#     scripts/setup.sh [GROUP…]           install the groups: build, viewer, lab, page, test, farm, lint, tidy, fuzz, docs (default: all)
#     scripts/setup.sh --plan [GROUP…]    print the steps and change nothing (exit status 1: a package cannot be
#                                         installed)
#
# Environment:
#     QUINTET_SETUP=skip         do nothing; the packages are installed in another way
#     QUINTET_OS_RELEASE=FILE    used instead of /etc/os-release (tests)
#     QUINTET_APT_DIR=FOLDER     used instead of /etc/apt for the files that this script writes (tests)
#     QUINTET_COMMAND_PATH=PATH  used instead of PATH to find commands that replace a package (tests)
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
        --plan)
            mode=plan
            shift
            ;;
        -h | --help)
            sed -n '3,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"
            return
            ;;
        -*) die "unknown option '$1'; see --help" ;;
    esac
    if [[ ${QUINTET_SETUP-} == skip ]]; then
        say "skipped because of QUINTET_SETUP=skip"
        return
    fi

    readPackageList "$here/lib/packages.txt" "$@"
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this system has no apt; install these packages:"
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
