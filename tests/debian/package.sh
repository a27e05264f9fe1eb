# The Debian package: made where the program was built, installed where nothing of that is.
# Sourced by tests/debian/run.

# usage: make_package RELEASE IMAGE   (leaves the package in $work/RELEASE.deb)
make_package() {
    local release=$1 image=$2
    say "$release: package"
    enter "$image" apt-get install --yes --no-install-recommends dpkg-dev lintian qemu-user >"$work/apt.log"
    enter "$image" ffi/debian/package.sh >"$work/package.log"
    local package
    package=$(tail -n 1 "$work/package.log")
    enter "$image" dpkg-deb --info "$package" | tee "$work/info.log"
    check_dependencies "$release"
    enter "$image" lintian --fail-on error --tag-display-limit 0 "$package"
    cp "$image/src/twintree/$package" "$work/$release.deb"
    start_on_oldest_processor "$image"
}

# The libraries of that Debian, by the versions that the program was linked with.
check_dependencies() {
    local release=$1 embree=libembree4-4
    [ "$release" != bookworm ] || embree=libembree3-3
    expect_text "$embree" "$work/info.log"
    expect_text libopenimageio2 "$work/info.log"
}

# The first x86-64 processors had SSE2 and nothing newer: the program must not take more for granted. That
# the emulated processor has no more is seen by a program that does.
start_on_oldest_processor() {
    local image=$1 program=target/debian/stage/debian/twintree/usr/bin/twintree
    [ "$(uname -m)" = x86_64 ] || return 0
    say "on a processor with SSE2 and nothing newer"
    enter "$image" sh -c "echo 'int main(void) { __asm__(\"vpaddd %ymm0, %ymm0, %ymm0\"); return 0; }' |
        cc -x c -o /tmp/newer -"
    # 132: ended by SIGILL.
    expect_exit_code 132 enter "$image" qemu-x86_64 -cpu qemu64 /tmp/newer
    enter "$image" qemu-x86_64 -cpu qemu64 $program --help >"$work/help.log"
    expect_text "Usage: twintree" "$work/help.log"
    enter "$image" qemu-x86_64 -cpu qemu64 $program render scenes/cornell/cornell.xml \
        -D resx=16 -D resy=16 --spp 4 --guide double --photons 5000 --paths 2000 \
        -o /tmp/oldest.exr -o /tmp/oldest.png
    enter "$image" qemu-x86_64 -cpu qemu64 $program render scenes/cornell/cornell.xml \
        -D resx=16 -D resy=16 --spp 4 --accel obvhs -o /tmp/oldest-obvhs.exr
    # The same light, on whatever processor it was computed.
    enter "$image" $program render scenes/cornell/cornell.xml \
        -D resx=16 -D resy=16 --spp 4 --accel obvhs -o /tmp/newest-obvhs.exr
    enter "$image" $program compare /tmp/oldest-obvhs.exr --reference /tmp/newest-obvhs.exr --max-relmse 0.001
}

# Installs the package on a base system with what it depends on, and renders one of its scenes.
# usage: install_package RELEASE IMAGE
install_package() {
    local release=$1 image=$2 log=$work/user.log
    say "$release: the package on a bare system"
    make_image "$release" "$image"
    cp "$work/$release.deb" "$image/root/twintree.deb"
    enter "$image" apt-get update >"$log"
    enter "$image" apt-get install --yes --no-install-recommends /root/twintree.deb >>"$log"
    ! enter "$image" sh -c 'command -v g++ || command -v cargo' || fail "a compiler was installed"
    enter "$image" twintree render /usr/share/twintree/scenes/cornell/cornell.xml \
        --width 160 --spp 16 -o /root/cornell.exr -o /root/cornell.png
    [ "$(stat -c %s "$image/root/cornell.png")" -gt 5000 ] || fail "$image/root/cornell.png has nothing on it"
    enter "$image" ls /usr/share/man/man1/twintree-render.1.gz \
        /usr/share/bash-completion/completions/twintree >"$log"
    enter "$image" apt-get remove --yes twintree >>"$log"
    [ ! -e "$image/usr/share/twintree" ] || fail "removing the package left /usr/share/twintree"
}
