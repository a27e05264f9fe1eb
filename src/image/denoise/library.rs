//! The functions of Open Image Denoise's library that are called here, found when it is loaded.
//!
//! Nothing is linked with it: a program that never denoises does not need it. Their declarations
//! are those of OpenImageDenoise/oidn.h, versions 2.x.

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use std::ffi::{CStr, OsStr, c_char, c_int, c_void};

/// `OIDNDevice` and `OIDNFilter`: pointers to what is the library's own business.
pub type Handle = *mut c_void;
/// `OIDNProgressMonitorFunction`: is told the share that is done, and says whether to go on.
pub type ProgressMonitor = unsafe extern "C" fn(user: *mut c_void, done: f64) -> bool;

/// `OIDN_DEVICE_TYPE_CPU`.
pub const DEVICE_CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
pub const FORMAT_FLOAT3: c_int = 3;
/// `OIDN_ERROR_NONE`.
pub const ERROR_NONE: c_int = 0;
/// `OIDN_ERROR_CANCELLED`.
pub const ERROR_CANCELLED: c_int = 6;

/// Declares the functions as fields, and looks each up by its C name.
macro_rules! functions {
    ($($field:ident = $symbol:literal: fn($($type:ty),*) $(-> $result:ty)?;)*) => {
        /// What the library does.
        #[derive(Clone, Copy, Debug)]
        pub struct Functions {
            $(pub $field: unsafe extern "C" fn($($type),*) $(-> $result)?,)*
        }

        impl Functions {
            fn find(library: &Library) -> Result<Self, String> {
                Ok(Self {
                    $(
                        // SAFETY: the header declares it with this type, the same in all versions
                        // that have a function of this name.
                        $field: *unsafe { library.get($symbol) }.map_err(|e| e.to_string())?,
                    )*
                })
            }
        }
    };
}

functions! {
    new_device = b"oidnNewDevice\0": fn(c_int) -> Handle;
    release_device = b"oidnReleaseDevice\0": fn(Handle);
    set_device_bool = b"oidnSetDeviceBool\0": fn(Handle, *const c_char, bool);
    set_device_int = b"oidnSetDeviceInt\0": fn(Handle, *const c_char, c_int);
    device_int = b"oidnGetDeviceInt\0": fn(Handle, *const c_char) -> c_int;
    device_error = b"oidnGetDeviceError\0": fn(Handle, *mut *const c_char) -> c_int;
    commit_device = b"oidnCommitDevice\0": fn(Handle);
    new_filter = b"oidnNewFilter\0": fn(Handle, *const c_char) -> Handle;
    release_filter = b"oidnReleaseFilter\0": fn(Handle);
    set_image = b"oidnSetSharedFilterImage\0": fn(
        Handle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize
    );
    set_filter_bool = b"oidnSetFilterBool\0": fn(Handle, *const c_char, bool);
    set_monitor = b"oidnSetFilterProgressMonitorFunction\0": fn(
        Handle, ProgressMonitor, *mut c_void
    );
    commit_filter = b"oidnCommitFilter\0": fn(Handle);
    execute_filter = b"oidnExecuteFilter\0": fn(Handle);
}

impl Functions {
    /// Loads the library of this name: a path, or a name that the system's loader finds. Libraries
    /// that it needs itself are found beside it, by its own run path.
    ///
    /// # Errors
    /// Why it cannot be loaded, or is no Open Image Denoise 2.
    pub fn load(name: &OsStr) -> Result<Self, String> {
        // SAFETY: what runs when it is loaded are its own initializers. Whoever runs the program
        // names the file, or has installed it.
        let library = unsafe { Library::open(Some(name), RTLD_NOW | RTLD_LOCAL) };
        let library = library.map_err(|e| e.to_string())?;
        let functions = Self::find(&library)
            .map_err(|e| format!("this is no Open Image Denoise of version 2 ({e})"))?;
        // Never unloaded: its threads may outlive the last call.
        std::mem::forget(library);
        Ok(functions)
    }

    /// What went wrong on a device, or when one was made (null), since it was asked last.
    pub fn error(&self, device: Handle) -> Option<(c_int, String)> {
        let mut text = std::ptr::null();
        // SAFETY: the device is alive or null, which the header allows, and `text` is written to.
        let code = unsafe { (self.device_error)(device, &raw mut text) };
        if code == ERROR_NONE {
            return None;
        }
        if text.is_null() {
            return Some((code, format!("error {code}")));
        }
        // SAFETY: the library's own text, which ends with a zero and stays until the next call on
        // this thread; it is copied before that.
        let text = unsafe { CStr::from_ptr(text) };
        Some((code, text.to_string_lossy().into_owned()))
    }
}
