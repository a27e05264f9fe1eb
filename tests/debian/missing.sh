# A build without one of the packages names it. Sourced by tests/debian/run.

# usage: check_missing_packages IMAGE
check_missing_packages() {
    local image=$1 package
    for package in libembree-dev libopenimageio-dev; do
        say "a build without $package"
        enter "$image" dpkg --remove --force-depends "$package" >"$work/dpkg.log"
        expect_exit_code 101 enter "$image" cargo build --release >"$work/missing.log" 2>&1
        expect_text "$package" "$work/missing.log"
        expect_text "ffi/install-debian.sh" "$work/missing.log"
        grep -E '^error' "$work/missing.log"
        # The script that the message names brings it back.
        enter "$image" ffi/install-debian.sh
    done
}
