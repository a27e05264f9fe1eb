# Root filesystems: made by debootstrap, kept as an archive, entered by chroot. Sourced by tests/debian/run.

# The base system as an archive in the cache: what debootstrap makes of Debian's "required" packages and apt.
base_archive() {
    local release=$1 archive=$cache/$1.tar
    [ ! -f "$archive" ] || return 0
    say "debootstrap --variant=minbase $release"
    local made=$work/$release-base
    debootstrap --variant=minbase "$release" "$made" "$(mirror)" >"$work/debootstrap.log" 2>&1 ||
        { tail -n 20 "$work/debootstrap.log" "$made/debootstrap/debootstrap.log" >&2 || true
          skip "debootstrap could not make $release from $(mirror)"; }
    tar --create --file "$archive.part" --directory "$made" .
    mv "$archive.part" "$archive"
    rm -rf --one-file-system "$made"
}

mount_read_only() {
    mkdir -p "$2"
    mount --bind "$1" "$2"
    mount -o remount,bind,ro "$2"
}

# usage: make_image RELEASE DIRECTORY
make_image() {
    local release=$1 image=$2
    base_archive "$release"
    mkdir "$image"
    tar --extract --file "$cache/$release.tar" --directory "$image"
    write_sources "$release" "$(mirror)" >"$image/etc/apt/sources.list"
    mount -t proc proc "$image/proc"
    mount --rbind /dev "$image/dev"
    mount -t tmpfs tmpfs "$image/tmp"
    # Debian's packages are downloaded once.
    mkdir -p "$cache/$release-packages"
    mount --bind "$cache/$release-packages" "$image/var/cache/apt/archives"
    take_over_network "$image"
}

# What a Debian that was installed by hand has in its sources.list.
write_sources() {
    local release=$1 mirror=$2
    echo "deb $mirror $release main"
    echo "deb $mirror $release-updates main"
    # Mirrors keep security updates beside Debian itself, if they have them.
    case $mirror in
        */debian) echo "deb $mirror-security $release-security main" ;;
    esac
}

# Runs a command in the checkout inside an image (in / where there is none).
# usage: enter IMAGE COMMAND...
enter() {
    local image=$1 variables path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
    shift
    # A toolchain of the host (lend_rust), or of rustup inside.
    path=/opt/rust/bin:/root/.cargo/bin:$path
    mapfile -t variables < <(image_environment)
    chroot "$image" /usr/bin/env -i "PATH=$path" "${variables[@]}" \
        /bin/sh -c 'cd /src/twintree 2>/dev/null || cd /; exec "$@"' sh "$@"
}

# Removes an image, or all of them. What is mounted in it belongs to others: nothing is deleted before all
# of that is gone.
# usage: remove_image DIRECTORY
remove_image() {
    local directory=$1 target
    [ -z "${TWINTREE_DEBIAN_KEEP:-}" ] || { echo "kept: $directory"; return 0; }
    while read -r target; do
        umount --lazy "$target"
    done < <(mounts_below "$directory" | sort --reverse)
    [ -z "$(mounts_below "$directory")" ] || { echo "still mounted, so not removed: $directory" >&2; return 1; }
    rm -rf --one-file-system "$directory"
}

# usage: mounts_below DIRECTORY
mounts_below() {
    findmnt --raw --noheadings --output TARGET |
        while read -r target; do
            case $target in "$1"/*) echo "$target" ;; esac
        done
}
