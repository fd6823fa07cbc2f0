#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests of scripts/setup.sh on simulated systems (fakes.sh): without network and root, and nothing is installed.
# Exit status 77 means skipped, because dpkg is not installed, which compares versions.
set -euo pipefail

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
realDpkg=$(command -v dpkg) || { echo "skipped: dpkg is not installed"; exit 77; }
export realDpkg
unset QUINTET_SETUP
# shellcheck source=tests/setup/fakes.sh
source "$(dirname "${BASH_SOURCE[0]}")/fakes.sh"

failed=0
complain() {
    printf 'in %s: %s\n--- output, status %s:\n%s\n--- calls:\n%s\n---\n' \
        "${FUNCNAME[2]}" "$1" "$status" "$output" "$(calls)"
    failed=$((failed + 1))
}
expectStatus() { [[ $status == "$1" ]] || complain "status $1 expected"; }
expectOutput() { [[ $output == *"$1"* ]] || complain "missing in the output: $1"; }
expectNoOutput() { [[ $output != *"$1"* ]] || complain "unexpected in the output: $1"; }
expectCalls() { [[ $(calls) == "$1" ]] || complain "expected calls: $1"; }

# ---- Systems --------------------------------------------------------------------------------------------------------
# The real versions of the packages that affect the plan.
bookworm() {
    newSystem
    osRelease debian 12 bookworm
    offerAll
    offer g++ 4:12.2.0-3
    offer cmake 3.25.1-1
    offer libfmt-dev 9.1.0+ds1-2
    offer mesa-vulkan-drivers 22.3.6-1+deb12u1
    offer mesa-vulkan-drivers 25.0.7-2~bpo12+1 bookworm-backports
    offer libvulkan-memory-allocator-dev none
    offer libvulkan-memory-allocator-dev 3.2.1+dfsg-1 trixie
    printf 'deb [arch=amd64 signed-by=/keys/a.gpg] http://mirror.test/debian bookworm main\n' \
        >"$system/apt/sources.list"
    suite bookworm http://mirror.test/debian/ "$system/apt/sources.list:1"
}
noble() {
    newSystem
    osRelease ubuntu 24.04 noble
    offerAll
    offer g++ 4:13.2.0-7ubuntu1
    offer cmake 3.28.3-1build7
    offer libvulkan-memory-allocator-dev 3.0.1+git20230911+2f382df+dfsg-2
    offer mesa-vulkan-drivers "$1"
    suite noble http://mirror.test/ubuntu/ "$system/apt/sources.list:1"
}

# ---- Tests ----------------------------------------------------------------------------------------------------------
bookwormPlan() {
    bookworm
    setup --plan
    expectStatus 0
    expectOutput "add bookworm-backports to the sources"
    expectOutput "add trixie to the sources of apt for the next step, then remove it"
    expectOutput "install from bookworm-backports: mesa-vulkan-drivers"
    expectOutput "install from trixie: libvulkan-memory-allocator-dev"
    expectOutput "install: g++ cmake make ninja-build pkg-config ccache"
    expectNoOutput CANNOT
    expectCalls '' # a plan changes nothing
}

bookwormInstalls() {
    bookworm
    setup
    expectStatus 0
    expectOutput "setup: done"
    local all
    all=$(namesInList | grep -vx -e mesa-vulkan-drivers -e libvulkan-memory-allocator-dev | tr '\n' ' ')
    expectCalls "apt-get update
apt-get update
apt-get install libvulkan-memory-allocator-dev
apt-get install -t bookworm-backports mesa-vulkan-drivers
apt-get install ${all% }"
    grep -qx 'URIs: http://mirror.test/debian/' "$system/seen-quintet-trixie.sources" || complain "not apt's own mirror"
    grep -qx 'Signed-By: /keys/a.gpg' "$system/seen-quintet-trixie.sources" || complain "key not copied"
    grep -qx 'Suites: bookworm-backports' "$system/apt/sources.list.d/quintet-bookworm-backports.sources" ||
        complain "backports not kept"
    # While trixie was a source, only one package could come from it.
    local pins
    pins=$(sed '/^#/d' "$system/seen-pins" | tr '\n' ' ')
    [[ $pins == "Package: * Pin: release n=trixie Pin-Priority: -1  \
Package: libvulkan-memory-allocator-dev Pin: release n=trixie Pin-Priority: 500 " ]] || complain "pins: $pins"
    [[ ! -e $system/apt/sources.list.d/quintet-trixie.sources ]] || complain "the source of trixie was not removed"
    [[ ! -e $system/apt/preferences.d/quintet-trixie ]] || complain "the pin of trixie was not removed"

    : >"$system/calls" # the second run has nothing to do
    setup
    expectStatus 0
    expectOutput "nothing to install"
    expectCalls ''
}

bookwormWithBackports() { # like the cloud images of Debian
    bookworm
    suite bookworm-backports http://mirror.test/debian/ "$system/apt/sources.list:2"
    setup
    expectStatus 0
    expectNoOutput "add bookworm-backports"
    expectOutput "install from bookworm-backports: mesa-vulkan-drivers"
}

bookwormOldMesaInstalled() { # a desktop with Mesa 22
    bookworm
    installAll
    installed mesa-vulkan-drivers 22.3.6-1+deb12u1
    setup
    expectStatus 0
    grep -qx 'mesa-vulkan-drivers 25.0.7-2~bpo12+1' "$system/installed" || complain "not upgraded"
    expectCalls "apt-get update
apt-get update
apt-get install -t bookworm-backports mesa-vulkan-drivers"
}

keyWithinTheSource() { # deb822 with the key in the second of two paragraphs
    bookworm
    cat >"$system/apt/sources.list.d/debian.sources" <<'SOURCES'
# First
Types: deb
URIs: http://other.test/debian
Suites: bookworm
Signed-By: /keys/wrong.gpg

Types: deb
URIs: http://mirror.test/debian
Suites: bookworm
Signed-By:
 -----BEGIN KEY-----
 .
 abc=
 -----END KEY-----
Components: main
SOURCES
    echo "bookworm http://mirror.test/debian/ $system/apt/sources.list.d/debian.sources:2" >"$system/suites"
    setup
    expectStatus 0
    local key
    key=$(sed -n '/^Signed-By/,$p' "$system/seen-quintet-trixie.sources")
    [[ $key == $'Signed-By: \n -----BEGIN KEY-----\n .\n abc=\n -----END KEY-----' ]] || complain "key: $key"
}

noMirrorOfDebian() {
    bookworm
    : >"$system/suites"
    setup
    expectStatus 1
    expectOutput "none of apt's sources is a mirror of Debian bookworm"
}

trixiePlan() {
    newSystem
    osRelease debian 13 trixie
    offerAll
    offer mesa-vulkan-drivers 25.0.7-2
    offer libvulkan-memory-allocator-dev 3.2.1+dfsg-1
    setup --plan
    expectStatus 0
    expectNoOutput "to the sources"
    expectNoOutput warning
    expectOutput libvulkan-memory-allocator-dev
}

otherNameTaken() {
    bookworm
    offer pkg-config none
    offer pkgconf 1.8.1-4
    setup
    expectStatus 0
    grep -q '^pkgconf ' "$system/installed" || complain "pkgconf not installed"
    : >"$system/calls"
    setup
    expectOutput "nothing to install"
}

nobleWithUpdates() {
    noble 25.0.7-0ubuntu0.24.04.2
    setup --plan
    expectStatus 0
    expectNoOutput warning
    expectNoOutput "to the sources"
}

nobleWithoutUpdates() { # Mesa 24.0 is installed with a warning, and only once
    noble 24.0.5-1ubuntu1
    setup
    expectStatus 0
    expectOutput "warning: mesa-vulkan-drivers >= 25.0 (optional): apt offers 24.0.5-1ubuntu1"
    expectOutput "lavapipe has no tested ray tracing"
    : >"$system/calls"
    setup
    expectStatus 0
    expectOutput "24.0.5-1ubuntu1 is installed"
    expectCalls ''
}

tooOldASystem() {
    newSystem
    osRelease ubuntu 22.04 jammy
    offerAll
    offer cmake 3.22.1-1ubuntu1
    offer g++ 4:11.2.0-1ubuntu1
    setup --plan
    expectStatus 1
    expectOutput "CANNOT install cmake >= 3.25: apt offers 3.22.1-1ubuntu1"
    expectOutput "CANNOT install g++ >= 12: apt offers 4:11.2.0-1ubuntu1"
    setup
    expectStatus 1
    expectOutput "no package was installed"
    expectCalls "apt-get update"
}

neededNotOffered() {
    noble 25.0.7
    offer libtinygltf-dev none
    setup
    expectStatus 1
    expectOutput "cannot install libtinygltf-dev: apt does not offer it"
    expectOutput universe
}

# npm of a Node.js that is not Debian's.
commandReplacesPackage() {
    bookworm
    installAll
    installed npm none
    setup page
    expectCalls "apt-get update
apt-get install npm"
    bookworm
    installAll
    installed npm none
    mkdir -p "$system/commands"
    printf '#!/bin/sh\n' >"$system/commands/npm"
    chmod +x "$system/commands/npm"
    setup page
    expectStatus 0
    expectOutput "nothing to install"
    expectCalls ''
}

optionalNotOffered() {
    noble 25.0.7
    offer vulkan-tools none
    setup
    expectStatus 0
    expectOutput "warning: vulkan-tools (optional): apt does not offer it"
    : >"$system/calls"
    setup
    expectStatus 0
    expectCalls ''
}

noListsYet() {
    bookworm
    rm "$system/lists"
    setup --plan
    expectStatus 0
    expectOutput "apt has no package lists yet"
    expectOutput "install: g++ cmake"
    expectNoOutput CANNOT
    setup
    expectStatus 0
    expectOutput "setup: done"
}

offline() {
    bookworm
    rm "$system/lists"
    touch "$system/offline"
    setup
    expectStatus 1
    expectOutput "apt-get update failed"
    expectOutput network
}

aptInUse() { # like a machine that has just booted
    bookworm
    rm "$system/lists"
    touch "$system/locked"
    setup
    expectStatus 0
    expectOutput "another program is using apt"
    expectNoOutput warning
    expectOutput "setup: done"
}

noRootNoSudo() {
    bookworm
    echo 1000 >"$system/uid"
    hideSudo
    setup
    expectStatus 1
    expectOutput "missing or too old: g++ >= 12, cmake >= 3.25"
    expectOutput "sudo is not installed"
    expectOutput "bash scripts/setup.sh"
    expectCalls ''
    installAll
    installed ccache none
    setup # only an optional package is missing
    expectStatus 0
    expectOutput optional
}

sudoRefuses() {
    bookworm
    echo 1000 >"$system/uid"
    fake sudo <<<'exit 1'
    setup
    expectStatus 1
    expectOutput "sudo did not work"
    expectCalls ''
}

withSudo() {
    bookworm
    echo 1000 >"$system/uid"
    fake sudo <<'SH'
echo "sudo $*" >>"$system/sudo"
[[ $1 == -n ]] || exit 1 # without a terminal it must not ask
shift
exec "$@"
SH
    setup
    expectStatus 0
    expectOutput "setup: done"
    grep -q 'apt-get .*install' "$system/sudo" || complain "not installed with sudo"
}

noApt() {
    newSystem
    hideSudo
    rm "$system"/bin/{apt-get,apt-cache,dpkg-query,dpkg}
    setup
    expectStatus 0
    expectOutput "this system has no apt"
    expectOutput "cmake >= 3.25"
    expectOutput "g++ >= 12"
    expectOutput VK_KHR_ray_tracing_pipeline
}

skipped() {
    newSystem
    export QUINTET_SETUP=skip
    setup
    unset QUINTET_SETUP
    expectStatus 0
    expectOutput skipped
    expectCalls ''
}

noHostNames() { # mirrors come from the system, not from the scripts
    local found
    found=$(grep -rnE '://|debian\.(org|net)|ubuntu\.com' "$repo"/{scripts,Makefile,.ci/run} || true)
    status=0 output=$found
    [[ -z $found ]] || complain "host names in scripts"
}

versions() {
    status=0 output=$(
        source "$repo/scripts/lib/plan.sh"
        versionFits 3.25 3.25 || echo "an equal version must fit"
        versionFits 4:12.2.0-3 4:12 || echo "a later version must fit"
        versionFits 25.0.7-2~bpo12+1 25.0 || echo "a backport must fit"
        versionFits 1 '' || echo "any version must fit an empty minimum"
        ! versionFits 3.9 3.25 || echo "versions must not be compared as text"
        ! versionFits '' '' || echo "an empty version must not fit"
    )
    [[ -z $output ]] || complain "versions"
}

groups() { # of packages.txt
    bookworm
    setup --plan build
    expectStatus 0
    expectOutput "libshaderc-dev"
    expectNoOutput gtest
    expectNoOutput shellcheck
    setup --plan lint
    expectStatus 0
    expectOutput "install: git shellcheck clang-format-14"
    setup --plan build nothing
    expectStatus 1
    expectOutput "unknown group 'nothing'"
    setup --wrong
    expectStatus 1
    expectOutput "unknown option '--wrong'"
}

badList() {
    status=0
    output=$(bash -c '
        source "$1/scripts/lib/plan.sh"
        readPackageList <(printf "fine\nno/slash >= 1\n")' - "$repo" 2>&1) || status=$?
    expectStatus 1
    expectOutput "'no/slash' is not a package name"
}

# A PATH with the few programs that setup.sh uses, and neither sudo nor apt.
hideSudo() {
    local name
    for name in cat sed grep tr dirname awk tee chmod rm cp mv touch env; do
        ln -s "$(command -v "$name")" "$system/bin/$name"
    done
    onlyPath=$system/bin
}

# All tests run in parallel, each in its own shell with its own simulated system. Results are printed in this order.
tests=(bookwormPlan bookwormInstalls bookwormWithBackports bookwormOldMesaInstalled keyWithinTheSource noMirrorOfDebian
    trixiePlan otherNameTaken nobleWithUpdates nobleWithoutUpdates tooOldASystem neededNotOffered commandReplacesPackage optionalNotOffered
    noListsYet offline aptInUse noRootNoSudo sudoRefuses withSudo noApt skipped noHostNames versions groups badList)
runs=()
for test in "${tests[@]}"; do
    (
        trap - EXIT
        onlyPath=''
        "$test"
        exit "$((failed > 0))"
    ) >"$scratch/$test.out" 2>&1 &
    runs+=($!)
done
for i in "${!tests[@]}"; do
    if wait "${runs[i]}"; then
        printf 'ok     %s\n' "${tests[i]}"
    else
        printf 'FAILED %s\n' "${tests[i]}"
        cat "$scratch/${tests[i]}.out"
        failed=$((failed + 1))
    fi
done
echo "$((${#tests[@]} - failed)) passed, $failed failed"
((failed == 0))
