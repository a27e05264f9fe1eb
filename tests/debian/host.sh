# What the images take over from the host: network settings and downloads. Sourced by tests/debian/run.

# Kibibytes that an image, what is built in it and what is kept between runs take.
needed_space=8000000

# Why the images cannot be made here; nothing if they can.
why_not() {
    local free
    if [ "$(id -u)" -ne 0 ]; then
        echo "root is needed, for mounts and chroot"
        return
    fi
    for program in dpkg debootstrap findmnt unshare wget; do
        command -v $program >/dev/null ||
            { echo "$program is not installed (apt-get install debootstrap brings what Debian lacks)"; return; }
    done
    mkdir -p "$cache"
    unshare --mount --propagation private bash "$here/permitted.sh" "$cache" 2>/dev/null ||
        { echo "mounts, devices or chroot are not permitted (a container without CAP_SYS_ADMIN?)"; return; }
    free=$(df --output=avail "$cache" | tail -n 1)
    [ "$free" -ge $needed_space ] ||
        { echo "$cache has $((free / 1000000)) GB free, $((needed_space / 1000000)) are needed"; return; }
    # What debootstrap uses, so with its proxies.
    wget --quiet --tries 2 --timeout 20 --output-document /dev/null "$(mirror)/dists/trixie/Release" ||
        echo "the Debian mirror $(mirror) cannot be reached (TWINTREE_DEBIAN_MIRROR names another)"
}

# Whether a kind of tests is left to the host, which is the same Debian.
# usage: left_to_host RELEASE KIND
left_to_host() {
    [ "$1" = "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" ] || return 1
    case " ${TWINTREE_DEBIAN_AGAIN:-} " in *" $2 "*) return 1 ;; esac
}

# The mirror that apt uses on the host for Debian itself, or Debian's own.
mirror() {
    local found=${TWINTREE_DEBIAN_MIRROR:-}
    [ -n "$found" ] ||
        found=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' |
            sed 1q)
    found=${found:-http://deb.debian.org/debian}
    echo "${found%/}"
}

# Downloads the crates on the host, where that can be done once for all images.
fetch_crates() {
    crates=
    command -v cargo >/dev/null || return 0
    say "cargo fetch"
    (cd "$checkout" && cargo fetch --locked)
    crates=${CARGO_HOME:-$HOME/.cargo}/registry
}

# usage: take_over_network IMAGE
take_over_network() {
    local image=$1 cargo_home=${CARGO_HOME:-$HOME/.cargo}
    cp -L /etc/resolv.conf "$image/etc/resolv.conf"
    apt-config dump | grep -E '^Acquire::(http|https|Check-|Retries)' \
        >"$image/etc/apt/apt.conf.d/90host" || true
    [ ! -f "${SSL_CERT_FILE:-}" ] || cp -L "$SSL_CERT_FILE" "$image/etc/host-certificates.crt"
    mkdir -p "$image/root/.cargo"
    [ ! -f "$cargo_home/config.toml" ] || cp "$cargo_home/config.toml" "$image/root/.cargo/"
    [ -z "$crates" ] || mount_read_only "$crates" "$image/root/.cargo/registry"
}

# Environment of commands inside an image, one variable a line.
image_environment() {
    local name
    echo HOME=/root
    echo LC_ALL=C.UTF-8
    echo DEBIAN_FRONTEND=noninteractive
    echo CARGO_TERM_COLOR=never
    # As in .ci/run: what is of use to who works on the program costs time and space here.
    echo CARGO_INCREMENTAL=0
    echo CARGO_PROFILE_RELEASE_DEBUG=0
    for name in http_proxy https_proxy ftp_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY \
        CARGO_BUILD_JOBS RUSTUP_DIST_SERVER RUSTUP_UPDATE_ROOT; do
        [ -z "${!name:-}" ] || echo "$name=${!name}"
    done
    [ -z "$crates" ] || echo CARGO_NET_OFFLINE=true
    [ -f "${SSL_CERT_FILE:-}" ] || return 0
    for name in SSL_CERT_FILE CARGO_HTTP_CAINFO CURL_CA_BUNDLE; do
        echo "$name=/etc/host-certificates.crt"
    done
}
