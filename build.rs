//! Finds Debian's Embree and OpenImageIO, makes Rust declarations of the one and compiles the shim of
//! the other. A missing library ends the build with the name of the package that has it.

#[cfg(feature = "embree")]
#[path = "ffi/embree_build.rs"]
mod embree;
#[cfg(feature = "oiio")]
#[path = "ffi/oiio_build.rs"]
mod oiio;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(embree3)");
    println!("cargo::rustc-check-cfg=cfg(embree4)");
    #[cfg(feature = "embree")]
    embree::configure();
    #[cfg(feature = "oiio")]
    oiio::configure();
}
