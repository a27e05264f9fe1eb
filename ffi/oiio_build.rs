//! Compiles the C++ shim over Debian's OpenImageIO.

/// Called by build.rs.
pub fn configure() {}
