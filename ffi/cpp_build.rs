//! What the builds of the C++ shims share.

use std::process::{Command, exit};

/// A C++ compiler with the flags that all shims have.
pub fn compiler() -> cc::Build {
    let mut build = cc::Build::new();
    build
        .cpp(true)
        .std("c++17")
        .warnings(true)
        .debug(false)
        .cargo_metadata(false);
    build
}

/// The compiler of a build, which has been started once to see that it is there. `Err` says why it is
/// not.
#[cfg(any(feature = "oiio", feature = "openvdb"))]
pub fn tool(build: &cc::Build) -> Result<cc::Tool, String> {
    let tool = build
        .try_get_compiler()
        .map_err(|e| format!("no C++ compiler was found: {e}"))?;
    match Command::new(tool.path()).arg("--version").output() {
        Ok(_) => Ok(tool),
        Err(_) => Err(format!(
            "the C++ compiler {} does not run",
            tool.path().display()
        )),
    }
}

/// Finds a library without telling cargo to link the program with it. `Err` is what pkg-config said.
pub fn probe(config: &mut pkg_config::Config, name: &str) -> Result<pkg_config::Library, String> {
    config
        .cargo_metadata(false)
        .probe(name)
        .map_err(|e| reason(&e))
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

/// Runs a command that makes a shim of the library `name`. `Err` is what it said.
#[cfg(any(feature = "oiio", feature = "openvdb"))]
pub fn run(command: &mut Command, name: &str) -> Result<(), String> {
    match command.output() {
        Ok(done) if done.status.success() => Ok(()),
        Ok(done) => Err(format!(
            "the shim over {name} cannot be linked: {}",
            String::from_utf8_lossy(&done.stderr)
        )),
        Err(e) => Err(format!("the linker of C++ does not run: {e}")),
    }
}

/// Ends the build with a reason and what to install. `cargo::error` fails it; leaving with 0 spares the
/// reader cargo's dump of all this script printed.
pub fn stop(why: &str, help: &str) -> ! {
    for line in why.lines().chain([help]) {
        println!("cargo::error={line}");
    }
    exit(0)
}
