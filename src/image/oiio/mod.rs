//! OpenImageIO in safe Rust: the only module that calls ffi/oiio_shim.h.

pub mod display;
mod ffi;
pub mod input;
mod library;
pub use ffi::{is_missing, load};
pub mod output;
pub mod textures;

use super::PixelType;
use std::ffi::{CStr, CString, c_char};
use std::path::Path;

/// Version of the OpenImageIO that this was compiled against.
pub fn version() -> &'static str {
    env!("TWINTREE_OIIO_VERSION")
}

/// Numbers of the types in the shim.
fn type_number(t: PixelType) -> i32 {
    match t {
        PixelType::U8 => 0,
        PixelType::U16 => 1,
        PixelType::Half => 2,
        PixelType::Float => 3,
    }
}

/// A path for C. `Err` says why it cannot be one.
fn c_path(path: &Path) -> Result<CString, String> {
    #[cfg(unix)]
    let bytes = std::os::unix::ffi::OsStrExt::as_bytes(path.as_os_str());
    #[cfg(not(unix))]
    let bytes = path.to_str().ok_or("the name is not UTF-8")?.as_bytes();
    CString::new(bytes).map_err(|_| "the name contains a zero byte".into())
}

/// Text for C; zero bytes inside are left out.
fn c_text(text: &str) -> CString {
    let bytes: Vec<u8> = text.bytes().filter(|&b| b != 0).collect();
    CString::new(bytes).unwrap_or_default()
}

/// Where the shim writes why it failed.
struct Reason([c_char; 512]);

impl Reason {
    fn new() -> Self {
        Self([0; 512])
    }

    fn pointer(&mut self) -> *mut c_char {
        self.0.as_mut_ptr()
    }

    fn len(&self) -> usize {
        self.0.len()
    }

    /// The message without the file's name, which the caller's error begins with anyway.
    fn text(&self) -> String {
        let bytes: Vec<u8> = self
            .0
            .iter()
            .take_while(|&&c| c != 0)
            .map(|&c| c as u8)
            .collect();
        String::from_utf8_lossy(&bytes).trim().to_owned()
    }
}

/// A string of the shim, copied.
fn copied(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the shim hands out zero-terminated strings or null.
    unsafe { CStr::from_ptr(text) }
        .to_string_lossy()
        .into_owned()
}
