//! OpenImageIO on its way into memory beside other work.
//!
//! The dynamic linker needs 0.2 s on one thread for OpenImageIO and the 250 libraries that it
//! brings, longer than a small scene takes to its first samples. A render needs it when it writes,
//! and should know early that it is missing: so it is loaded from the first tile on. Not before:
//! meanwhile the linker's lock stops every thread that uses a `thread_local` for the first time
//! (`__cxa_thread_atexit_impl`), which is all of them while a render begins.

use std::thread::JoinHandle;

/// A thread that loads OpenImageIO, or none in builds without it.
#[derive(Debug)]
pub struct LibraryLoading(Option<JoinHandle<()>>);

impl LibraryLoading {
    /// Begins to load it.
    pub fn begin() -> Self {
        #[cfg(feature = "oiio")]
        {
            let thread = std::thread::Builder::new().name("OpenImageIO".into());
            // Without a thread, whoever writes loads it.
            Self(thread.spawn(|| drop(super::oiio::load())).ok())
        }
        #[cfg(not(feature = "oiio"))]
        Self(None)
    }
}

impl Drop for LibraryLoading {
    /// The process must not end while the linker runs initializers of libraries: their destructors
    /// would run beside them.
    fn drop(&mut self) {
        // If it panicked, nothing is loaded, and whoever writes says so.
        self.0.take().map(JoinHandle::join);
    }
}

/// Waits until OpenImageIO is there, if this build has it.
///
/// # Errors
/// Why it cannot be loaded.
pub fn load_library() -> Result<(), String> {
    #[cfg(feature = "oiio")]
    super::oiio::load()?;
    Ok(())
}

/// Whether it is known that OpenImageIO cannot be loaded. Waits for nobody.
pub fn library_is_missing() -> bool {
    #[cfg(feature = "oiio")]
    return super::oiio::is_missing();
    #[cfg(not(feature = "oiio"))]
    false
}
