# The package for Python, as the manual's page says: installed by pip, and the page's ten lines. Sourced by
# tests/debian/run.

# The program in the first block of the manual's page on Python.
ten_lines() {
    awk '/^```$/ { if (block) exit } block; /^```python$/ { block = 1 }' "$checkout/src/manual/python.md"
}

# Packages of Python come from where the host has them from.
take_over_pip() {
    local image=$1
    [ ! -f /etc/pip.conf ] || cp -L /etc/pip.conf "$image/etc/pip.conf"
}

# pip inside an image, in the environment /opt/venv.
# usage: enter_pip IMAGE ARGUMENTS...
enter_pip() {
    local image=$1 variables=() name
    shift
    for name in PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_FIND_LINKS PIP_TRUSTED_HOST PIP_DEFAULT_TIMEOUT; do
        [ -z "${!name:-}" ] || variables+=("$name=${!name}")
    done
    [ ! -f "$image/etc/host-certificates.crt" ] || variables+=(PIP_CERT=/etc/host-certificates.crt)
    # What the program's release build has made serves here, too. The program itself is not optimised: that
    # takes minutes, and what is tested is not speed.
    local little="--config profile.release.package.twintree.opt-level=0"
    little+=" --config profile.release.package.twintree-python.opt-level=0"
    enter "$image" env "${variables[@]}" "MATURIN_PEP517_ARGS=$little" /opt/venv/bin/pip "$@"
}

# usage: install_for_python RELEASE IMAGE
install_for_python() {
    local release=$1 image=$2 picture=$2/src/twintree/picture.png
    if left_to_host "$release" python; then
        say "$release: the package for Python is tested on the host, which is the same Debian (ffi/python/ci)"
        return
    fi
    say "$release: pip install ./ffi/python"
    take_over_pip "$image"
    enter "$image" apt-get install --yes --no-install-recommends python3-venv >"$work/apt.log"
    enter "$image" python3 -m venv /opt/venv
    # Without Python's packages nothing can be tested, and the project is not why.
    enter_pip "$image" download --quiet --no-deps --dest /tmp numpy ||
        { echo "skipped: $release: the package for Python: pip reaches no packages"; return 0; }
    enter_pip "$image" install --quiet ./ffi/python
    ten_lines >"$image/src/twintree/ten.py"
    enter "$image" /opt/venv/bin/python ten.py | tee "$work/ten.log"
    expect_text "(90, 160, 3)" "$work/ten.log"
    [ "$(head -c 4 "$picture" | tail -c 3)" = PNG ] || fail "$picture is no PNG"
    rm "$picture" "$image/src/twintree/ten.py"
    # It is linked with the Embree of its Debian, and brings none along.
    local library
    library=$(cd "$image" && find opt/venv -name '_native*.so')
    enter "$image" ldd "/$library" >"$work/ldd.log"
    expect_text libembree "$work/ldd.log"
}
