#!/bin/sh
# Installs what twintree needs of Debian 12 or 13, as root: Embree, OpenImageIO, and the compilers that
# build against them. Rust comes from Debian 13 itself, where there is none yet; Debian 12's is too old.
set -eu

if [ "$(id -u)" -ne 0 ]; then
    echo "install-debian.sh: run me as root: sudo $0" >&2
    exit 1
fi
# Debian's own name for itself; other systems may have all of this under other names.
. /etc/os-release
case "${ID:-} ${VERSION_ID:-}" in
"debian 12" | "debian 13") ;;
*) echo "install-debian.sh: made for Debian 12 and 13, this is ${PRETTY_NAME:-unknown}; trying" >&2 ;;
esac

packages="g++ pkg-config libclang-dev libembree-dev libopenimageio-dev"
if ! command -v cargo >/dev/null && [ "${VERSION_ID:-}" != 12 ]; then
    packages="$packages cargo"
fi
export DEBIAN_FRONTEND=noninteractive
apt-get update
# Words are meant to be split.
# shellcheck disable=SC2086
apt-get install --yes --no-install-recommends $packages

if ! command -v cargo >/dev/null && [ ! -x "${HOME:-/root}/.cargo/bin/cargo" ]; then
    echo "install-debian.sh: all there but Rust 1.85 or newer: get it from https://rustup.rs" >&2
fi
