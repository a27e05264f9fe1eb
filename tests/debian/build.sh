# Install, build, test, render, as the README says. Sourced by tests/debian/run.

# The files of the checkout as they are, without what git ignores.
list_checkout() {
    cd "$checkout"
    # A checkout that belongs to somebody else is no danger here: nothing of it is run by git.
    if git -c safe.directory='*' rev-parse >/dev/null 2>&1; then
        git -c safe.directory='*' ls-files -z --cached --others --exclude-standard
    else
        find . \( -name target -o -name .git \) -prune -o -type f -print0
    fi
}

copy_checkout() {
    local to=$1/src/twintree
    mkdir -p "$to"
    list_checkout |
        tar --create --directory "$checkout" --null --files-from - --ignore-failed-read |
        tar --extract --no-same-owner --directory "$to"
}

# Debian 12's own Rust is too old, and ffi/install-debian.sh gets one by rustup. Where the host has that
# already, the image borrows it: that saves the download.
lend_rust() {
    local image=$1 toolchain=
    ! command -v rustc >/dev/null || toolchain=$(rustc --print sysroot)
    case $toolchain in
        */toolchains/*) mount_read_only "$toolchain" "$image/opt/rust" ;;
    esac
}

install_dependencies() {
    local release=$1 image=$2
    [ "$release" != bookworm ] || lend_rust "$image"
    enter "$image" ffi/install-debian.sh
    enter "$image" ffi/install-debian.sh >"$work/again.log"
    expect_text "everything is there already" "$work/again.log"
    enter "$image" rustc --version
}

# The library's own tests and the command line's, with the release profile of the picture: a second
# build of the dependencies and the long tests would not fit into the time. The README's command runs
# all tests on the host (.ci/run); where that is the same Debian, they are not run again.
run_tests() {
    local release=$1 image=$2 command="cargo test --release --lib --test cli"
    if left_to_host "$release" tests; then
        say "$release: tests run on the host, which is the same Debian"
        return
    fi
    say "$release: $command"
    timed "$work/$release.times" "build tests" enter "$image" sh -c "$command --no-run"
    timed "$work/$release.times" "tests" enter "$image" sh -c "$command"
}

render_picture() {
    local release=$1 image=$2 command picture=$2/src/twintree/cornell.png
    command=$(cd "$checkout" && readme_command "A picture")
    say "$release: $command"
    timed "$work/$release.times" "build and picture" enter "$image" sh -c "$command"
    [ "$(head -c 4 "$picture" | tail -c 3)" = PNG ] || fail "$picture is no PNG"
    # A picture of one colour packs into far less.
    [ "$(stat -c %s "$picture")" -gt 20000 ] || fail "$picture has nothing on it"
    rm "$picture"
}

check_exit_codes() {
    local image=$1 program=target/release/twintree scene=scenes/cornell/cornell.xml
    expect_exit_code 0 enter "$image" $program check $scene
    expect_exit_code 2 enter "$image" $program render scenes/none.xml
    expect_exit_code 2 enter "$image" $program render $scene --spp none
    expect_exit_code 1 enter "$image" $program render $scene -o /proc/picture.exr
}

# The program is linked with the Embree of its Debian, and with no other.
check_embree() {
    local release=$1 image=$2 expected=libembree4.so.4
    [ "$release" != bookworm ] || expected=libembree3.so.3
    enter "$image" ldd target/release/twintree >"$work/ldd.log"
    expect_text "$expected" "$work/ldd.log"
    [ "$(grep -c libembree "$work/ldd.log")" -eq 1 ] || fail "more than one Embree: $(cat "$work/ldd.log")"
}

# usage: build_and_test RELEASE IMAGE
build_and_test() {
    local release=$1 image=$2 times=$work/$1.times
    copy_checkout "$image"
    say "$release: ffi/install-debian.sh"
    timed "$times" "packages" install_dependencies "$release" "$image"
    # Before the first build: what it compiles until it stops is kept, and nothing is compiled twice.
    timed "$times" "missing packages" check_missing_packages "$image"
    render_picture "$release" "$image"
    run_tests "$release" "$image"
    check_exit_codes "$image"
    check_embree "$release" "$image"
}
