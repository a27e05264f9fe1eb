//! Compiles the C++ shim over Debian's OpenImageIO.

use std::process::{Command, exit};

const SOURCES: [&str; 2] = ["ffi/oiio_shim.cpp", "ffi/oiio_textures.cpp"];

/// Called by build.rs: finds OpenImageIO by pkg-config, compiles the shim and links both.
pub fn configure() {
    for file in ["oiio_build.rs", "oiio_shim.h", "oiio_guard.h"] {
        println!("cargo::rerun-if-changed=ffi/{file}");
    }
    for file in SOURCES {
        println!("cargo::rerun-if-changed={file}");
    }
    println!("cargo::rerun-if-env-changed=CXX");
    // Linked after the shim that needs it: pkg-config's own output would come first.
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

    let mut shim = cc::Build::new();
    shim.cpp(true)
        .std("c++17")
        .files(SOURCES)
        .warnings(true)
        .debug(false)
        .cargo_metadata(true);
    // The compiler's own directory must not be named again: it would come before C++'s headers.
    let usual = std::path::Path::new("/usr/include");
    for path in library.include_paths.iter().filter(|p| *p != usual) {
        // As a system directory: warnings inside its headers are not ours.
        shim.flag("-isystem").flag(path);
    }
    let compiler = shim
        .try_get_compiler()
        .unwrap_or_else(|e| missing(&format!("no C++ compiler was found: {e}")));
    if Command::new(compiler.path())
        .arg("--version")
        .output()
        .is_err()
    {
        missing(&format!(
            "the C++ compiler {} does not run",
            compiler.path().display()
        ));
    }
    if let Err(e) = shim.try_compile("twintree_oiio_shim") {
        missing(&format!("the shim over OpenImageIO does not compile: {e}"));
    }

    for path in &library.link_paths {
        println!("cargo::rustc-link-search=native={}", path.display());
    }
    for name in &library.libs {
        println!("cargo::rustc-link-lib={name}");
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
