//! Declares Embree's API to Rust from Debian's own headers, and links the library that goes with them.
//!
//! Debian 12 ships Embree 3, Debian 13 Embree 4; their structures differ in size, so none is written
//! down by hand: bindgen reads the header that is installed and sets `cfg(embree3)` or `cfg(embree4)`.
//!
//! Two environment variables point elsewhere: `TWINTREE_EMBREE_INCLUDE` is the directory that holds
//! `embree4/` or `embree3/`, `TWINTREE_EMBREE_LIB` the directory of `libembree4.so` or `libembree3.so`.

use std::env;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::process::exit;

const INCLUDE_VARIABLE: &str = "TWINTREE_EMBREE_INCLUDE";
const LIBRARY_VARIABLE: &str = "TWINTREE_EMBREE_LIB";

/// Newest first: where both are installed, Embree 4 is used.
const MAJOR_VERSIONS: [u32; 2] = [4, 3];

/// Called by build.rs. Ends the build with a readable message where something is missing.
pub fn configure() {
    println!("cargo::rerun-if-changed=ffi/embree_build.rs");
    println!("cargo::rerun-if-env-changed={INCLUDE_VARIABLE}");
    println!("cargo::rerun-if-env-changed={LIBRARY_VARIABLE}");
    let folders = include_folders();
    let Some((major, include, header)) = find_header(&folders) else {
        stop(&missing_header(&folders));
    };
    println!("cargo::rerun-if-changed={}", header.display());
    println!("cargo::rustc-cfg=embree{major}");
    if let Some(folder) = env::var_os(LIBRARY_VARIABLE) {
        println!(
            "cargo::rustc-link-search=native={}",
            Path::new(&folder).display()
        );
    }
    println!("cargo::rustc-link-lib=dylib=embree{major}");
    declare(&include, &header);
}

fn include_folders() -> Vec<PathBuf> {
    match env::var_os(INCLUDE_VARIABLE) {
        Some(folder) => vec![folder.into()],
        None => vec!["/usr/include".into(), "/usr/local/include".into()],
    }
}

fn find_header(folders: &[PathBuf]) -> Option<(u32, PathBuf, PathBuf)> {
    for major in MAJOR_VERSIONS {
        for folder in folders {
            let header = folder.join(format!("embree{major}/rtcore.h"));
            if header.is_file() {
                return Some((major, folder.clone(), header));
            }
        }
    }
    None
}

/// Writes `OUT_DIR/embree.rs`.
fn declare(include: &Path, header: &Path) {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default()).join("embree.rs");
    let builder = bindgen::builder()
        .header(header.to_string_lossy())
        .clang_arg(format!("-I{}", include.display()))
        .allowlist_function("rtc.*")
        .allowlist_type("RTC.*")
        .prepend_enum_name(false)
        .generate_comments(false)
        .derive_default(false);
    // bindgen panics where it finds no libclang; the panic's text is kept for the message.
    std::panic::set_hook(Box::new(|_| {}));
    let outcome = std::panic::catch_unwind(AssertUnwindSafe(|| builder.generate()));
    let _ = std::panic::take_hook();
    let bindings = match outcome {
        Ok(Ok(bindings)) => bindings,
        Ok(Err(error)) => stop(&format!(
            "Embree's header {} could not be read: {error}\n\
             If a header of the C library is missing, install libc6-dev and libclang-dev \
             (ffi/install-debian.sh does).",
            header.display()
        )),
        Err(panic) => stop(&missing_clang(&panic_text(&*panic))),
    };
    if let Err(error) = bindings.write_to_file(&out) {
        stop(&format!("cannot write {}: {error}", out.display()));
    }
}

fn missing_header(folders: &[PathBuf]) -> String {
    let searched = folders
        .iter()
        .map(|f| f.display().to_string())
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "Embree's headers were not found: no embree4/rtcore.h or embree3/rtcore.h in {searched}\n\
         On Debian: sudo apt install libembree-dev libclang-dev   (or run ffi/install-debian.sh)\n\
         Elsewhere: set {INCLUDE_VARIABLE} and {LIBRARY_VARIABLE}\n\
         Without Embree: cargo build --no-default-features --features oiio   (traces with obvhs, slower)"
    )
}

fn missing_clang(reason: &str) -> String {
    format!(
        "libclang, which reads Embree's headers, was not found: {reason}\n\
         On Debian: sudo apt install libclang-dev   (or run ffi/install-debian.sh)\n\
         Elsewhere: set LIBCLANG_PATH to the directory of libclang.so"
    )
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("no reason given").replace('\n', " ")
}

/// `cargo::error` fails the build; leaving with 0 spares the reader cargo's dump of all this script printed.
fn stop(message: &str) -> ! {
    for line in message.lines() {
        println!("cargo::error={line}");
    }
    exit(0)
}
