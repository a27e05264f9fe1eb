//! Finds Debian's Embree, OpenImageIO, OpenVDB and Draco, makes Rust declarations of the first and
//! compiles the shims of the others. A missing library ends the build with the name of the package
//! that has it.

#[cfg(any(feature = "draco", feature = "oiio", feature = "openvdb"))]
#[path = "ffi/cpp_build.rs"]
mod cpp;
#[cfg(feature = "draco")]
#[path = "ffi/draco_build.rs"]
mod draco;
#[cfg(feature = "embree")]
#[path = "ffi/embree_build.rs"]
mod embree;
#[cfg(feature = "oiio")]
#[path = "ffi/oiio_build.rs"]
mod oiio;
#[cfg(feature = "openvdb")]
#[path = "ffi/openvdb_build.rs"]
mod openvdb;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(embree3)");
    println!("cargo::rustc-check-cfg=cfg(embree4)");
    #[cfg(feature = "draco")]
    draco::configure();
    #[cfg(feature = "embree")]
    embree::configure();
    #[cfg(any(feature = "draco", feature = "oiio", feature = "openvdb"))]
    {
        println!("cargo::rerun-if-changed=ffi/cpp_build.rs");
        println!("cargo::rerun-if-env-changed=CXX");
    }
    #[cfg(feature = "oiio")]
    oiio::configure();
    #[cfg(feature = "openvdb")]
    openvdb::configure();
}
