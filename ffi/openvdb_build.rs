//! Makes a program of the C++ shim over Debian's OpenVDB. The main program embeds it and starts it for
//! each OpenVDB file (src/medium/grids/vdb/shim.rs says why).

use crate::cpp;
use std::path::{Path, PathBuf};
use std::process::Command;

const SOURCE: &str = "ffi/openvdb_shim.cpp";

/// Called by build.rs: compiles and links the shim. The program gets its path in `TWINTREE_OPENVDB_SHIM`.
pub fn configure() {
    println!("cargo::rerun-if-changed=ffi/openvdb_build.rs");
    println!("cargo::rerun-if-changed={SOURCE}");
    // Debian's OpenVDB has no file for pkg-config. Its headers use these two.
    let libraries = ["Imath", "tbb"].map(|name| {
        cpp::probe(&mut pkg_config::Config::new(), name).unwrap_or_else(|e| {
            missing(&format!("{name}, which OpenVDB needs, was not found: {e}"))
        })
    });
    let out = std::env::var_os("OUT_DIR").map_or_else(PathBuf::new, PathBuf::from);
    let shim = out.join("openvdb_shim");
    let tool = cpp::tool(cpp::compiler().opt_level(2)).unwrap_or_else(|e| missing(&e));
    let mut command: Command = tool.to_command();
    command.args([SOURCE, "-s", "-o"]).arg(&shim);
    let usual = Path::new("/usr/include");
    for library in &libraries {
        // As in ffi/oiio_build.rs.
        for path in library.include_paths.iter().filter(|p| *p != usual) {
            command.arg("-isystem").arg(path);
        }
        for path in &library.link_paths {
            command.arg("-L").arg(path);
        }
    }
    command.arg("-lopenvdb");
    for name in libraries.iter().flat_map(|l| &l.libs) {
        command.arg(format!("-l{name}"));
    }
    cpp::run(&mut command, "OpenVDB").unwrap_or_else(|e| missing(&e));
    println!("cargo::rustc-env=TWINTREE_OPENVDB_SHIM={}", shim.display());
}

/// Ends the build with what to install.
fn missing(why: &str) -> ! {
    cpp::stop(
        why,
        "The feature `openvdb` needs Debian's OpenVDB and a C++ compiler: \
         `apt-get install libopenvdb-dev libboost-dev g++ pkg-config`. \
         Without the feature, .vdb files are not read, and all else is as with it.",
    )
}
