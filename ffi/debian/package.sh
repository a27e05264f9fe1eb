#!/bin/sh
# Makes a Debian package of target/release/twintree for the Debian that it was built on:
#
#   cargo build --release && ffi/debian/package.sh
#
# writes target/debian/twintree_VERSION_ARCHITECTURE.deb and prints its name. Needs dpkg-dev and binutils.
# The maintainer is DEBFULLNAME <DEBEMAIL>, as for Debian's own tools; else an address that nobody has.
set -eu
cd "$(dirname "$0")/../.."

program=target/release/twintree
stage=target/debian/stage
root=$stage/debian/twintree
out=target/debian
maintainer="${DEBFULLNAME:-The twintree contributors} <${DEBEMAIL:-maintainers@twintree.invalid}>"

# The time of the newest change, so that the same checkout gives the same package, bit for bit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || stat -c %Y ffi/debian/changelog)}
export SOURCE_DATE_EPOCH

stop() {
    printf '%s\n' "package.sh: $*" >&2
    exit 1
}

# Version of the program, then the Debian it is for: each links the Embree and OpenImageIO of its own.
version() {
    upstream=$($program --version | cut -d ' ' -f 2)
    system=$(sed -n 's/^VERSION_ID=//p' /etc/os-release | tr -d '"')
    echo "$upstream-1~deb${system:-0}"
}

# usage: put MODE DIRECTORY FILE...
put() {
    mode=$1 directory=$root/$2
    shift 2
    install -d "$directory"
    install -m "$mode" "$@" "$directory/"
}

install_program() {
    put 755 usr/bin $program
    strip --strip-unneeded --remove-section=.comment --remove-section=.note $root/usr/bin/twintree
}

install_manual() {
    $program generate man $stage/man >/dev/null
    put 644 usr/share/man/man1 $stage/man/*
    gzip -9n $root/usr/share/man/man1/*
    $program generate completions $stage/completions >/dev/null
    install -D -m 644 $stage/completions/twintree.bash $root/usr/share/bash-completion/completions/twintree
    put 644 usr/share/zsh/vendor-completions $stage/completions/_twintree
    put 644 usr/share/fish/vendor_completions.d $stage/completions/twintree.fish
}

# In /usr/share/twintree, as minimal systems leave out what is in /usr/share/doc. The README's pictures
# stay behind.
install_scenes() {
    for file in scenes/*/*; do
        case $file in scenes/pictures/*) continue ;; esac
        put 644 "usr/share/twintree/$(dirname "$file")" "$file"
    done
}

install_documents() {
    put 644 usr/share/doc/twintree README.md ffi/debian/copyright
    put 644 usr/share/doc/twintree/manual src/manual/*.md
    install -m 644 $stage/debian/changelog $root/usr/share/doc/twintree/changelog.Debian
    list_libraries >$root/usr/share/doc/twintree/rust-libraries
    gzip -9n $root/usr/share/doc/twintree/changelog.Debian $root/usr/share/doc/twintree/rust-libraries
}

# The Rust libraries inside the program, each with its licence's own words where its source has them.
list_libraries() {
    sources=${CARGO_HOME:-$HOME/.cargo}/registry/src
    cargo tree --locked --edges normal --prefix none --format '{p}|{l}' | sed 's/ (\*)$//' | sort -u |
        while IFS='|' read -r package licence; do
            name=${package%% *}
            version=${package#* v}
            version=${version%% *}
            [ "$name" != twintree ] || continue
            printf '%s %s: %s\n\n' "$name" "$version" "$licence"
            find "$sources"/*/"$name-$version" -maxdepth 1 -iname '*licen[cs]e*' -type f 2>/dev/null |
                sort | xargs -r -d '\n' cat | tr -d '\r'
            printf '\n----\n'
        done
}

# What dpkg's tools want to find in debian/.
describe() {
    mkdir -p $stage/debian
    sed "s/@MAINTAINER@/$maintainer/" ffi/debian/control >$stage/debian/control
    sed "s/@VERSION@/$(version)/; s/@MAINTAINER@/$maintainer/
        s/@DATE@/$(date --rfc-email --utc --date "@$SOURCE_DATE_EPOCH")/" \
        ffi/debian/changelog >$stage/debian/changelog
}

# Dependencies are those of the libraries that the program is linked with, and of the shim over OpenImageIO
# that it carries inside; the newest one is that of the program.
write_control() {
    mkdir -p $root/DEBIAN
    shim=$(ls -t target/release/build/twintree-*/out/oiio_shim.so 2>/dev/null | head -n 1)
    cp ${shim:-$program} $stage/shim
    (
        cd $stage
        dpkg-shlibdeps -Tdebian/substvars debian/twintree/usr/bin/twintree shim
        dpkg-gencontrol -ptwintree -Pdebian/twintree -Tdebian/substvars
    )
    (cd $root && find usr -type f -print0 | sort -z | xargs -0 md5sum) >$root/DEBIAN/md5sums
    chmod 644 $root/DEBIAN/*
}

[ -x $program ] || stop "there is no $program: run cargo build --release first"
command -v dpkg-shlibdeps >/dev/null || stop "install dpkg-dev (apt-get install dpkg-dev)"
umask 022
rm -rf $stage
describe
install_program
install_manual
install_scenes
install_documents
write_control
dpkg-deb --root-owner-group --build $root $out >/dev/null
echo "$out/twintree_$(version)_$(dpkg --print-architecture).deb"
