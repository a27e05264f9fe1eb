//! Compiles the C++ shim over Debian's Draco and links both.

use crate::cpp;

/// Called by build.rs.
pub fn configure() {
    for file in [
        "draco_build.rs",
        "draco_shim.h",
        "draco_shim.cpp",
        "guard.h",
    ] {
        println!("cargo::rerun-if-changed=ffi/{file}");
    }
    let library = cpp::probe(&mut pkg_config::Config::new(), "draco")
        .unwrap_or_else(|e| missing(&format!("Draco was not found: {e}")));
    let mut build = cpp::compiler();
    build.cargo_metadata(true).file("ffi/draco_shim.cpp");
    // The compiler's own directory must not be named again: it would come before C++'s headers.
    let usual = std::path::Path::new("/usr/include");
    for path in library.include_paths.iter().filter(|p| *p != usual) {
        // As a system directory: warnings inside its headers are not ours.
        build.flag("-isystem").flag(path);
    }
    if let Err(e) = build.try_compile("twintree_draco_shim") {
        missing(&format!("the shim over Draco does not compile: {e}"));
    }
    for path in &library.link_paths {
        println!("cargo::rustc-link-search=native={}", path.display());
    }
    println!("cargo::rustc-link-lib=draco");
}

/// Ends the build with what to install.
fn missing(why: &str) -> ! {
    cpp::stop(
        why,
        "The feature `draco` needs Debian's Draco and a C++ compiler: \
         `apt-get install libdraco-dev g++ pkg-config`. \
         Without the feature, meshes that Draco compressed are refused.",
    )
}
