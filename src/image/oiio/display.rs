//! Displays of an OpenColorIO configuration, through OpenImageIO's `ColorConfig`.

use super::{Reason, c_text, ffi};
use std::ffi::{CString, c_int};
use std::ptr::{self, NonNull};

/// A view of a display.
#[derive(Debug)]
pub struct Display(NonNull<ffi::Display>);

// SAFETY: OpenImageIO's processor is never changed after it is made, and applying it is for any
// number of threads at once.
unsafe impl Send for Display {}
// SAFETY: as above.
unsafe impl Sync for Display {}

impl Display {
    /// A view by its name (see ffi/oiio_shim.h) in the configuration `config`. Light will be in the
    /// first of the colour spaces that the configuration has.
    ///
    /// # Errors
    /// What OpenColorIO says of the configuration, or which views there are.
    pub fn open(config: &str, name: &str, spaces: &[&str]) -> Result<Self, String> {
        ffi::load()?;
        let (config, name) = (c_text(config), c_text(name));
        let held: Vec<CString> = spaces.iter().map(|space| c_text(space)).collect();
        let spaces: Vec<_> = held.iter().map(|space| space.as_ptr()).collect();
        let (mut out, mut reason) = (ptr::null_mut(), Reason::new());
        // SAFETY: all strings outlive the call and end with zero, and the lengths are right.
        let failed = unsafe {
            ffi::twt_display_open(
                config.as_ptr(),
                name.as_ptr(),
                spaces.as_ptr(),
                spaces.len() as c_int,
                &mut out,
                reason.pointer(),
                reason.len(),
            )
        };
        match NonNull::new(out) {
            Some(display) if failed == 0 => Ok(Self(display)),
            _ => Err(reason.text()),
        }
    }

    /// Turns linear light into what the display is to show, in place.
    ///
    /// # Errors
    /// What OpenImageIO says.
    pub fn apply(&self, pixels: &mut [[f32; 3]]) -> Result<(), String> {
        let mut reason = Reason::new();
        // C counts them in 32 bits.
        for part in pixels.chunks_mut(1 << 20) {
            // SAFETY: the display is open, and `part` has that many pixels of three floats.
            let failed = unsafe {
                ffi::twt_display_apply(
                    self.0.as_ptr(),
                    part.as_mut_ptr().cast(),
                    part.len() as c_int,
                    reason.pointer(),
                    reason.len(),
                )
            };
            if failed != 0 {
                return Err(reason.text());
            }
        }
        Ok(())
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // SAFETY: it was opened, and is closed once.
        unsafe { ffi::twt_display_close(self.0.as_ptr()) }
    }
}
