# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# New, minimal Debian systems in folders (chroots), for the scripts that measure on them. Sourced; the script defines die(). Requires
# root and debootstrap.

mirror=${mirror-} # of Debian; requireSystems fills it in

# requireSystems: fails if this machine cannot create a system. Reads the mirror and the proxies of apt.
requireSystems() {
    local name value
    [[ $(id -u) == 0 ]] || die "a chroot requires root"
    command -v debootstrap >/dev/null || die "debootstrap is not installed; run: apt-get install debootstrap"
    # shellcheck disable=SC2016  # apt replaces the variables
    [[ -n $mirror ]] || mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' \
        'Component: main' | sed -n 1p)
    [[ -n $mirror ]] || die "apt has no mirror of Debian; use --mirror"
    for name in http https; do
        value=''
        eval "$(apt-config shell value "Acquire::$name::Proxy")"
        [[ -z $value || $value == DIRECT ]] || export "${name}_proxy=$value"
    done
}

# inside SYSTEM COMMAND: runs a command as root in the chroot, with its own mounts and processes.
inside() {
    local name environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 TERM=dumb)
    for name in http_proxy https_proxy no_proxy; do
        [[ -z ${!name-} ]] || environment+=("$name=${!name}")
    done
    # shellcheck disable=SC2016  # the inner shell expands the variables
    unshare --mount --pid --fork bash -c '
        system=$1 command=$2
        shift 2
        mount -t proc proc "$system/proc" && mount --rbind /dev "$system/dev" &&
            exec env -i "$@" chroot "$system" bash -c "$command"' inside "$1" "$2" "${environment[@]}" </dev/null
}

# makeSystem RELEASE SYSTEM MIRROR PACKAGE…: creates the chroot with the essential packages, apt and these packages, instead
# of an existing one. SYSTEM.debootstrap.log is the log.
makeSystem() {
    local release=$1 system=$2 from=$3 options=(--variant=minbase)
    shift 3
    rm -rf --one-file-system -- "$system"
    [[ $from != https:* ]] || options+=(--include=ca-certificates)
    debootstrap "${options[@]}" "$release" "$system" "$from" >"$system.debootstrap.log" 2>&1 ||
        die "debootstrap failed: $system.debootstrap.log"
    cp -L /etc/resolv.conf /etc/hosts "$system/etc/"
    inside "$system" "apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends $*" \
        >>"$system.debootstrap.log" 2>&1 || die "cannot install $*: $system.debootstrap.log"
}
