# Tries what making an image needs; the exit code says whether it is permitted. Run by tests/debian/host.sh
# in a mount namespace of its own: permitted.sh DIRECTORY
set -eu
probe=$(mktemp -d "$1/permitted.XXXXXX")
finish() {
    umount --lazy "$probe/proc" "$probe/dev" "$probe/ro" 2>/dev/null || true
    rm -rf --one-file-system "$probe"
}
trap finish EXIT

mkdir "$probe/proc" "$probe/dev" "$probe/ro"
mount -t proc proc "$probe/proc"
mount -t tmpfs tmpfs "$probe/dev"
mount --bind "$1" "$probe/ro"
mount -o remount,bind,ro "$probe/ro"
umount "$probe/ro"
# debootstrap makes devices, and files of many owners.
mknod "$probe/null" c 1 3
echo >"$probe/null"
touch "$probe/owned"
chown 65534:65534 "$probe/owned"
# The root that is there already: an image has its own programs.
chroot / true
