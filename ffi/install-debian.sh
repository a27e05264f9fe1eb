#!/bin/sh
# Installs what building twintree needs on Debian 12 or 13, as far as it is missing: compilers, Embree,
# OpenImageIO and Rust. Rust is Debian's where that is new enough, otherwise rustup's, in the home
# directory. Packages need root: as another user the script takes sudo for apt-get and for nothing else.
# Run it as often as you like:
#
#   ffi/install-debian.sh && PATH="$HOME/.cargo/bin:$PATH" cargo build --release
#
# Exit status: 0 everything is there, 1 something could not be installed, 2 everything is there but Rust,
# and the last line says what to do about that (a rustup of yours is left as it is; a script that was
# started by sudo cannot install into your home directory).
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

# Version of the rustc on PATH, or nothing. rustup's needs its owner's toolchains.
rust_version() {
    command -v cargo >/dev/null 2>&1 || return 0
    command -v rustc >/dev/null 2>&1 || return 0
    rustc=$(command -v rustc)
    case $rustc in
        */.cargo/bin/rustc)
            owner=${rustc%/.cargo/bin/rustc}
            RUSTUP_HOME=${RUSTUP_HOME:-$owner/.rustup} rustc --version 2>/dev/null | cut -d ' ' -f 2
            ;;
        *) rustc --version 2>/dev/null | cut -d ' ' -f 2 ;;
    esac
}

# usage: apt_get ARGUMENTS...   (as root)
apt_get() {
    if [ "$(id -u)" -eq 0 ]; then
        quietly env DEBIAN_FRONTEND=noninteractive apt-get "$@"
    else
        quietly sudo env DEBIAN_FRONTEND=noninteractive apt-get "$@"
    fi
}

# Before the first use of apt-get: says who runs it, and reads the lists of packages.
read_lists() {
    [ -z "${lists_read:-}" ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null 2>&1 ||
            stop 1 "packages have to be installed, and there is no sudo: run this as root"
        say "apt-get needs root: running it with sudo"
    fi
    say "reading the lists of packages"
    apt_get update || stop 1 "apt-get update failed"
    lists_read=yes
}

install() {
    read_lists
    say "installing $*"
    apt_get install -y --no-install-recommends "$@" || stop 1 "apt-get could not install: $*"
}

# The version of Debian's Rust, such as 1.85.0+dfsg3-1, or nothing.
offered_rust() {
    LC_ALL=C apt-cache policy rustc 2>/dev/null | sed -n '/(none)/d; s/^ *Candidate: *//p'
}

get_rustup() {
    curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs |
        sh -s -- -y --profile minimal --component clippy --component rustfmt
    # An empty script runs well, too.
    [ -x "$cargo_bin/rustc" ]
}

command -v apt-get >/dev/null 2>&1 || stop 1 "there is no apt-get: this script is for Debian 12 and 13"
# Debian's own name for itself; other systems may have all of this under other names.
system=$(sed -n 's/^\(ID\|VERSION_ID\)=//p' /etc/os-release 2>/dev/null | tr -d '"' | sort -r | tr '\n' ' ')
case $system in
    "debian 12 " | "debian 13 ") ;;
    *) say "made for Debian 12 and 13, trying all the same" ;;
esac

# rustup puts Rust into a home directory, which need not be on PATH. Started by sudo itself (not in a
# shell that sudo opened), this script is for the user who called sudo, and HOME is root's.
cargo_bin=${CARGO_HOME:-$HOME/.cargo}/bin
caller=
if [ "$(id -u)" -eq 0 ] && [ "$(cat "/proc/$PPID/comm" 2>/dev/null)" = sudo ]; then
    caller=${SUDO_USER:-}
    [ "$caller" != root ] || caller=
fi
[ -z "$caller" ] || cargo_bin=$(getent passwd "$caller" | cut -d : -f 6)/.cargo/bin
PATH=$cargo_bin:$PATH

packages="ca-certificates g++ libclang-dev libembree-dev libopenimageio-dev pkg-config"
missing=
for package in $packages; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = installed ] || missing="$missing $package"
done

rust=$(rust_version)
if [ -z "$missing" ] && new_enough "$rust"; then
    say "everything is there already (Rust $rust)"
    exit 0
fi

if [ -n "$missing" ]; then
    # The names contain no spaces: splitting is what is wanted.
    # shellcheck disable=SC2086
    install $missing
fi
if new_enough "$rust"; then
    say "done (Rust $rust was there)"
    exit 0
fi

found=${rust:+Rust $rust is too old, twintree needs 1.$oldest_minor}
found=${found:-there is no Rust}
# What a user has chosen with rustup is not changed, and Debian's Rust would stand behind it.
[ ! -x "$cargo_bin/rustup" ] ||
    stop 2 "$found: rustup is in $cargo_bin, run 'rustup default stable && rustup update stable', and this again"

[ -n "$(offered_rust)" ] || read_lists
offered=$(offered_rust)
if new_enough "${offered%%[+~-]*}"; then
    install cargo rustc
    from="from Debian"
else
    found="$found, and Debian offers ${offered:-none}"
    [ -z "$caller" ] ||
        stop 2 "$found: run this again without sudo, and rustup will install Rust into your home directory"
    command -v curl >/dev/null 2>&1 || install curl
    say "$found: installing Rust with rustup (https://rustup.rs) into $cargo_bin"
    quietly get_rustup || stop 1 "rustup could not install Rust"
    from="in $cargo_bin, which new shells have on their PATH"
fi
rust=$(rust_version)
new_enough "$rust" || stop 1 "Rust was installed, and $(command -v rustc || echo "no rustc") is what PATH finds"
say "done (Rust $rust $from)"
