#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Runs a command of scripts/run.sh on these sources in a Debian of another release, as root:
#   scripts/in_debian.sh SUITE COMMAND [options]        (scripts/run.sh COMMAND --in SUITE [options] calls it)
# That Debian is made by debootstrap the first time and kept, with what was installed and built in it, in a folder below
# ~/.cache (XDG_CACHE_HOME). Ends with the command's status, or 77 if there can be no such Debian here.
set -euo pipefail

suite=$1
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
folder=${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/yade-membrane
root=$folder/$suite
sources=$root/sails # the copy that is built and run there

say() { printf 'in_debian.sh: %s\n' "$*" >&2; }
impossible() {
    say "no $suite here: $*"
    exit 77
}

# All mounts are made in a name space of its own, and go with the last process in it, however that ends.
if [[ ${2-} != --inside ]]; then
    [[ $(id -u) == 0 ]] || impossible "only root can make it"
    mkdir -p "$folder" 2>/dev/null || impossible "$folder cannot be made"
    exec 8>"$folder/.$suite.lock"
    flock -n 8 || { say "waiting for another run in $root" && flock 8; }
    unshare --mount --pid --fork --kill-child true 2>/dev/null || impossible "name spaces for its mounts cannot be made"
    exec unshare --mount --pid --fork --kill-child --mount-proc "$0" "$suite" --inside "${@:2}"
fi
shift 2
trap 'exit 130' INT
trap 'exit 143' TERM

# The first process of a name space: signals that end others do not end it without a trap.
make_root() {
    local part=$root.part log=$folder/$suite.log
    command -v debootstrap >/dev/null || impossible "debootstrap is not installed"
    (($(df --output=avail -B1G "$folder" | tail -n 1) >= 6)) || impossible "$folder has less than 6 GB left"
    say "making Debian $suite in $root, once: some minutes, with all that is built in it 4 GB"
    rm -rf --one-file-system "$part"
    debootstrap --variant=minbase "$suite" "$part" >"$log" 2>&1 || impossible "debootstrap failed, see $log"
    printf '#!/bin/sh\nexit 101\n' >"$part/usr/sbin/policy-rc.d" # starts no services
    chmod +x "$part/usr/sbin/policy-rc.d"
    echo force-unsafe-io >"$part/etc/dpkg/dpkg.cfg.d/fast"
    mv "$part" "$root"
}

# Files in a folder of sources, by name, but for what is built in it.
files_in() { find "$1" \( -path "$1/build*" -o -path "$1/out" -o -path "$1/.git" \) -prune -o -type f -printf '%P\0'; }

# The same, but for what git ignores.
list_sources() { git -C "$source" ls-files --cached --others --exclude-standard -z 2>/dev/null || files_in "$source"; }

# Takes over what differs in content, with the present time, for make to notice.
copy_sources() {
    local name
    local -A kept=()
    mkdir -p "$sources"
    while IFS= read -rd '' name; do
        [[ -e $source/$name ]] || continue
        kept[$name]=1
        cmp -s "$source/$name" "$sources/$name" && continue
        mkdir -p "$(dirname "$sources/$name")"
        cp --preserve=mode "$source/$name" "$sources/$name"
    done < <(list_sources)
    while IFS= read -rd '' name; do
        [[ -n ${kept[$name]-} ]] || rm "$sources/$name" # it went here
    done < <(files_in "$sources")
    # The viewer is the same everywhere, and npm is large.
    local viewer=build/python/membrane/viewer.html
    if [[ -e $source/$viewer && -z $(find "$source/scripts/membrane/viewer" -newer "$source/$viewer" -print -quit) ]]; then
        mkdir -p "$sources/${viewer%/*}"
        cp "$source/$viewer" "$sources/$viewer"
    fi
}

# inside [NAME=VALUE...] COMMAND...: runs it there; by pivot_root, as within a chroot no test could make a name space.
inside() {
    # shellcheck disable=SC2016
    unshare --mount sh -c 'cd "$0" && pivot_root . mnt && umount -l /mnt && exec env -i "$@"' \
        "$root" "${environment[@]}" "$@"
}

# In braces, to be read as a whole: these sources may change during a long run.
{
    [[ -d $root ]] || make_root
    copy_sources
    cp -L /etc/resolv.conf /etc/hosts "$root/etc/" || true
    mount --bind "$root" "$root" # pivot_root takes mounts only
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev" # with /dev/pts and /dev/shm
    mkdir -p "$root/root"
    environment=(MEMBRANE_DISPOSABLE=1 PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 TERM="${TERM-dumb}")
    for name in http_proxy https_proxy no_proxy; do
        [[ -z ${!name-} ]] || environment+=("$name=${!name}")
    done
    # An earlier run may have been stopped while it installed something.
    inside DEBIAN_FRONTEND=noninteractive dpkg --configure -a >/dev/null 2>&1 || true
    status=0
    inside /sails/scripts/run.sh "$@" || status=$?
    inside apt-get clean || true
    case $1 in # what it made for here
    probe) given=pkg/membrane/yade-abi/facts ;;
    package) given=build/package ;;
    *) given= ;;
    esac
    if [[ -n $given && -d $sources/$given ]]; then
        mkdir -p "$source/$given"
        cp -ru "$sources/$given/." "$source/$given"
    fi
    exit "$status"
}
