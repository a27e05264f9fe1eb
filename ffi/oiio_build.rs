//! Makes a shared library of the C++ shim over Debian's OpenImageIO. The program embeds it and loads it
//! when the first image is opened (src/image/oiio/library.rs says why).

use std::path::{Path, PathBuf};
use std::process::{Command, exit};

const SOURCES: [&str; 3] = [
    "ffi/oiio_shim.cpp",
    "ffi/oiio_textures.cpp",
    "ffi/oiio_display.cpp",
];

/// Called by build.rs: finds OpenImageIO by pkg-config, and compiles and links the shim. The program gets
/// the shim's path and OpenImageIO's version in `TWINTREE_OIIO_SHIM` and `TWINTREE_OIIO_VERSION`.
pub fn configure() {
    for file in ["oiio_build.rs", "oiio_shim.h", "oiio_guard.h"] {
        println!("cargo::rerun-if-changed=ffi/{file}");
    }
    for file in SOURCES {
        println!("cargo::rerun-if-changed={file}");
    }
    println!("cargo::rerun-if-env-changed=CXX");
    let library = pkg_config::Config::new()
        .cargo_metadata(false)
        .range_version("2.4".."3")
        .probe("OpenImageIO")
        .unwrap_or_else(|e| {
            missing(&format!(
                "OpenImageIO 2.4 or 2.5 was not found: {}",
                reason(&e)
            ))
        });
    let shim = link(&library, &compile(&library));
    println!("cargo::rustc-env=TWINTREE_OIIO_SHIM={}", shim.display());
    println!("cargo::rustc-env=TWINTREE_OIIO_VERSION={}", library.version);
}

fn compiler() -> cc::Build {
    let mut build = cc::Build::new();
    build
        .cpp(true)
        .std("c++17")
        .warnings(true)
        .debug(false)
        .cargo_metadata(false);
    build
}

/// The shim's object files.
fn compile(library: &pkg_config::Library) -> Vec<PathBuf> {
    let mut build = compiler();
    build.files(SOURCES).pic(true);
    // The compiler's own directory must not be named again: it would come before C++'s headers.
    let usual = Path::new("/usr/include");
    for path in library.include_paths.iter().filter(|p| *p != usual) {
        // As a system directory: warnings inside its headers are not ours.
        build.flag("-isystem").flag(path);
    }
    let tool = build
        .try_get_compiler()
        .unwrap_or_else(|e| missing(&format!("no C++ compiler was found: {e}")));
    if Command::new(tool.path()).arg("--version").output().is_err() {
        missing(&format!(
            "the C++ compiler {} does not run",
            tool.path().display()
        ));
    }
    build
        .try_compile_intermediates()
        .unwrap_or_else(|e| missing(&format!("the shim over OpenImageIO does not compile: {e}")))
}

/// Links the object files and OpenImageIO to a shared library; its path.
fn link(library: &pkg_config::Library, objects: &[PathBuf]) -> PathBuf {
    let out = std::env::var_os("OUT_DIR").map_or_else(PathBuf::new, PathBuf::from);
    let shim = out.join("oiio_shim.so");
    // Without CXXFLAGS: a sanitizer's runtime is the program's, not this library's.
    let mut command = Command::new(compiler().get_compiler().path());
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
    match command.output() {
        Ok(done) if done.status.success() => shim,
        Ok(done) => missing(&format!(
            "the shim over OpenImageIO cannot be linked: {}",
            String::from_utf8_lossy(&done.stderr)
        )),
        Err(e) => missing(&format!("the linker of C++ does not run: {e}")),
    }
}

/// What pkg-config itself said; the crate's own text around it is a page long.
fn reason(error: &pkg_config::Error) -> String {
    let pkg_config::Error::ProbeFailure { output, .. } = error else {
        return error.to_string();
    };
    let text = String::from_utf8_lossy(&output.stderr);
    text.lines()
        .next()
        .unwrap_or("pkg-config gave no reason")
        .to_string()
}

/// Ends the build with what to install. `cargo::error` fails it; leaving with 0 spares the reader cargo's
/// dump of all this script printed.
fn missing(why: &str) -> ! {
    for line in why.lines() {
        println!("cargo::error={line}");
    }
    println!(
        "cargo::error=Images and textures need Debian's OpenImageIO and a C++ compiler: \
         `apt-get install libopenimageio-dev g++ pkg-config`, or run ffi/install-debian.sh. \
         Without them, `--no-default-features --features embree` reads and writes EXR only."
    );
    exit(0)
}
