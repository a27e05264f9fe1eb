#!/bin/sh
# Installs what building twintree needs on Debian 12 or 13: compilers, Embree, OpenImageIO, and Rust
# where Debian's is new enough. Run it as root, as often as you like:
#
#   sh ffi/install-debian.sh
#
# Exit status: 0 everything is there, 1 something could not be installed, 2 Rust is missing or too old
# and has to come from rustup (the rest is installed).
set -eu

# The oldest Rust that compiles twintree (rust-version in Cargo.toml).
oldest_minor=85

say() {
    printf '%s\n' "install-debian: $*"
}

stop() {
    status=$1
    shift
    printf '%s\n' "install-debian: $*" >&2
    exit "$status"
}

# Runs a command without its output, unless it fails.
quietly() {
    log=$(mktemp)
    if "$@" >"$log" 2>&1; then
        rm -f "$log"
        return 0
    fi
    cat "$log" >&2
    rm -f "$log"
    return 1
}

# Whether version $1 (such as 1.85.0) is new enough.
new_enough() {
    major=${1%%.*}
    rest=${1#*.}
    minor=${rest%%.*}
    case $major$minor in
        '' | *[!0-9]*) return 1 ;;
    esac
    [ "$major" -gt 1 ] || [ "$minor" -ge "$oldest_minor" ]
}

# rustup puts Rust into a home directory, which is not on root's PATH under sudo.
for user in "$(id -un)" "${SUDO_USER:-}"; do
    [ -n "$user" ] || continue
    home=$(getent passwd "$user" | cut -d : -f 6)
    PATH=$PATH:$home/.cargo/bin
done

# Version of the rustc on PATH, or nothing. rustup's needs its owner's toolchains.
rust_version() {
    command -v cargo >/dev/null 2>&1 || return 0
    command -v rustc >/dev/null 2>&1 || return 0
    rustc=$(command -v rustc)
    case $rustc in
        */.cargo/bin/rustc)
            home=${rustc%/.cargo/bin/rustc}
            RUSTUP_HOME=${RUSTUP_HOME:-$home/.rustup} rustc --version 2>/dev/null | cut -d ' ' -f 2
            ;;
        *) rustc --version 2>/dev/null | cut -d ' ' -f 2 ;;
    esac
}

install() {
    say "installing $*"
    quietly apt-get install -y --no-install-recommends "$@" ||
        stop 1 "apt-get could not install: $*"
}

command -v apt-get >/dev/null 2>&1 || stop 1 "there is no apt-get: this script is for Debian 12 and 13"
[ "$(id -u)" -eq 0 ] || stop 1 "run this as root, for example: sudo sh $0"
export DEBIAN_FRONTEND=noninteractive
# Debian's own name for itself; other systems may have all of this under other names.
system=$(sed -n 's/^\(ID\|VERSION_ID\)=//p' /etc/os-release 2>/dev/null | tr -d '"' | sort -r | tr '\n' ' ')
case $system in
    "debian 12 " | "debian 13 ") ;;
    *) say "made for Debian 12 and 13, trying all the same" ;;
esac

packages="ca-certificates g++ libclang-dev libembree-dev libopenimageio-dev pkg-config"
missing=
for package in $packages; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = installed ] || missing="$missing $package"
done

rust=$(rust_version)
if [ -z "$missing" ] && [ -n "$rust" ] && new_enough "$rust"; then
    say "everything is there already (Rust $rust)"
    exit 0
fi

say "reading the lists of packages"
quietly apt-get update || stop 1 "apt-get update failed"
if [ -n "$missing" ]; then
    # The names contain no spaces: splitting is what is wanted.
    # shellcheck disable=SC2086
    install $missing
fi

how="get a newer Rust from https://rustup.rs and run this again"
if [ -n "$rust" ]; then
    new_enough "$rust" || stop 2 "Rust $rust is on PATH, and twintree needs 1.$oldest_minor: $how"
    say "done (Rust $rust was there)"
    exit 0
fi

offered=$(apt-cache policy rustc | sed -n 's/^ *Candidate: *//p')
# Debian's versions read 1.85.0+dfsg3-1.
if new_enough "${offered%%[+~-]*}"; then
    install cargo rustc
    say "done (Rust $(rust_version) from Debian)"
    exit 0
fi
stop 2 "there is no Rust, and Debian offers ${offered:-none} where twintree needs 1.$oldest_minor: $how"
