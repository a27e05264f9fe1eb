# The same scene rendered in each image: equal within noise, and how long each took.
# Sourced by tests/debian/run.

scene=scenes/cornell/cornell.xml

# Renders with a seed of its own, so that equal images are no accident of equal random numbers, and
# with each pixel's variance.
# usage: render_to_compare RELEASE IMAGE
render_to_compare() {
    local release=$1 image=$2 seed=12
    [ "$release" = bookworm ] || seed=13
    say "$release: render to compare"
    enter "$image" target/release/twintree render $scene --guide none --spp 256 --seed $seed --rfilter box \
        --format float --aov variance -o "$release.exr" --stats "$release.json"
    mv "$image/src/twintree/$release".{exr,json} "$work/"
    # Paths of 7 edges instead of 12 lose 0.9 % of the light, which the comparison must notice.
    enter "$image" target/release/twintree render $scene --guide none --spp 256 --seed $seed --rfilter box \
        --format float --aov variance --max-depth 7 -o shorter.exr
    mv "$image/src/twintree/shorter.exr" "$work/"
}

# A number of the measurements of a render.
measurement() {
    sed -n "s/^ *\"$2\": *\([0-9.]*\),*\$/\1/p" "$work/$1.json"
}

print_times() {
    local release
    say "wall-clock seconds, processor seconds, and the render's rate"
    for release in "$@"; do
        printf '%s:\n' "$release"
        print_timed "$work/$release.times"
        measurement "$release" samples_per_second |
            awk '{ printf "    %-32s %6.2f million samples a second\n", "render", $1 / 1e6 }'
    done
}

# usage: compare_images RELEASE...
compare_images() {
    local image=$work/${*: -1}
    print_times "$@"
    [ $# -gt 1 ] || return 0
    say "z-test of the renders of $*"
    cp "$work"/*.exr "$image/src/twintree/"
    enter "$image" cargo build --release --example z_test
    enter "$image" target/release/examples/z_test "$1.exr" "$2.exr"
    expect_exit_code 1 enter "$image" target/release/examples/z_test "$1.exr" shorter.exr
}
