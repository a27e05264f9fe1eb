//! Makes a shared library of the C++ shim over Debian's OpenImageIO. The program embeds it and loads it
//! when the first image is opened (src/image/oiio/library.rs says why).

use crate::cpp;
use std::path::{Path, PathBuf};
use std::process::Command;

const SOURCES: [&str; 3] = [
    "ffi/oiio_shim.cpp",
    "ffi/oiio_textures.cpp",
    "ffi/oiio_display.cpp",
];

/// Called by build.rs: finds OpenImageIO by pkg-config, and compiles and links the shim. The program gets
/// the shim's path and OpenImageIO's version in `TWINTREE_OIIO_SHIM` and `TWINTREE_OIIO_VERSION`.
pub fn configure() {
    for file in ["oiio_build.rs", "oiio_shim.h", "oiio_guard.h", "guard.h"] {
        println!("cargo::rerun-if-changed=ffi/{file}");
    }
    for file in SOURCES {
        println!("cargo::rerun-if-changed={file}");
    }
    let mut config = pkg_config::Config::new();
    let library = cpp::probe(config.range_version("2.4".."3"), "OpenImageIO")
        .unwrap_or_else(|e| missing(&format!("OpenImageIO 2.4 or 2.5 was not found: {e}")));
    let shim = link(&library, &compile(&library));
    println!("cargo::rustc-env=TWINTREE_OIIO_SHIM={}", shim.display());
    println!("cargo::rustc-env=TWINTREE_OIIO_VERSION={}", library.version);
}

/// The shim's object files.
fn compile(library: &pkg_config::Library) -> Vec<PathBuf> {
    let mut build = cpp::compiler();
    build.files(SOURCES).pic(true);
    // The compiler's own directory must not be named again: it would come before C++'s headers.
    let usual = Path::new("/usr/include");
    for path in library.include_paths.iter().filter(|p| *p != usual) {
        // As a system directory: warnings inside its headers are not ours.
        build.flag("-isystem").flag(path);
    }
    cpp::tool(&build).unwrap_or_else(|e| missing(&e));
    build
        .try_compile_intermediates()
        .unwrap_or_else(|e| missing(&format!("the shim over OpenImageIO does not compile: {e}")))
}

/// Links the object files and OpenImageIO to a shared library; its path.
fn link(library: &pkg_config::Library, objects: &[PathBuf]) -> PathBuf {
    let out = std::env::var_os("OUT_DIR").map_or_else(PathBuf::new, PathBuf::from);
    let shim = out.join("oiio_shim.so");
    // Without CXXFLAGS: a sanitizer's runtime is the program's, not this library's.
    let mut command = Command::new(cpp::compiler().get_compiler().path());
    command
        .args(["-shared", "-s", "-o"])
        .arg(&shim)
        .args(objects);
    for path in &library.link_paths {
        command.arg("-L").arg(path);
    }
    for name in &library.libs {
        command.arg(format!("-l{name}"));
    }
    cpp::run(&mut command, "OpenImageIO").unwrap_or_else(|e| missing(&e));
    shim
}

/// Ends the build with what to install.
fn missing(why: &str) -> ! {
    cpp::stop(
        why,
        "Images and textures need Debian's OpenImageIO and a C++ compiler: \
         `apt-get install libopenimageio-dev g++ pkg-config`, or run ffi/install-debian.sh. \
         Without them, `--no-default-features --features embree` reads and writes EXR, PNG, JPEG and Radiance HDR only.",
    )
}
