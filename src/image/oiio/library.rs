//! Loads the shim over OpenImageIO when the first image is opened.
//!
//! OpenImageIO brings some 250 other libraries: 0.2 s and 120 MB for each run of the program, if it
//! were linked with them. So the shim is a shared library of its own, which build.rs embeds in the
//! program, and only this library is linked with OpenImageIO. A run that needs no image, such as
//! `--version` or a render of plain geometry to EXR, never loads it.

use crate::image::embedded::in_memory;
use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL};

/// The shared library that ffi/oiio_build.rs made.
static SHIM: &[u8] = include_bytes!(env!("TWINTREE_OIIO_SHIM"));

/// Puts the shim into a file in memory and loads it from there.
pub fn open() -> Result<Library, String> {
    let cannot = |why: &dyn std::fmt::Display| format!("OpenImageIO cannot be loaded: {why}");
    let (_file, path) = in_memory("twintree-oiio", SHIM).map_err(|e| cannot(&e))?;
    // Functions are bound when they are first called: most never are, and all at once take 0.04 s.
    // SAFETY: the shim is our own; what runs when it is loaded are the initializers of Debian's
    // libraries, which any program that is linked with them runs, too.
    unsafe { Library::open(Some(&path), RTLD_LAZY | RTLD_LOCAL) }.map_err(|e| cannot(&e))
}

/// Declares the functions of the shim: each is looked up by its name when the shim is loaded, and
/// called through a pointer.
macro_rules! functions {
    ($(
        $(#[$attribute:meta])*
        pub fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)?;
    )*) => {
        struct Functions {
            $($(#[$attribute])* $name: unsafe extern "C" fn($($type),*) $(-> $result)?,)*
        }

        impl Functions {
            fn find() -> Result<Self, String> {
                let library = $crate::image::oiio::library::open()?;
                let functions = Self {
                    $($(#[$attribute])* $name: {
                        let name = concat!(stringify!($name), "\0").as_bytes();
                        // SAFETY: the shim defines it with the type that is declared here.
                        *unsafe { library.get(name) }.map_err(|e| e.to_string())?
                    },)*
                };
                // Never unloaded: its functions are called until the process ends.
                std::mem::forget(library);
                Ok(functions)
            }
        }

        static FUNCTIONS: std::sync::OnceLock<Result<Functions, String>> =
            std::sync::OnceLock::new();

        /// Loads the shim, unless it is loaded. To be called before anything else here.
        ///
        /// # Errors
        /// Why OpenImageIO cannot be loaded.
        pub fn load() -> Result<(), String> {
            FUNCTIONS.get_or_init(Functions::find).as_ref().map(|_| ()).map_err(Clone::clone)
        }

        /// Whether loading has failed.
        pub fn is_missing() -> bool {
            matches!(FUNCTIONS.get(), Some(Err(_)))
        }

        #[inline]
        fn loaded() -> &'static Functions {
            match FUNCTIONS.get() {
                Some(Ok(functions)) => functions,
                _ => unreachable!("load() comes before every other call"),
            }
        }

        $(
            $(#[$attribute])*
            // C has no other way to pass a rectangle and channels.
            #[allow(clippy::too_many_arguments)]
            #[inline]
            pub unsafe fn $name($($argument: $type),*) $(-> $result)? {
                // SAFETY: the caller keeps to what ffi/oiio_shim.h says.
                unsafe { (loaded().$name)($($argument),*) }
            }
        )*
    };
}
pub(super) use functions;
