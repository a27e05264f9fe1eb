//! Decoded meshes of Draco: a safe face of ffi/draco_shim.h, where everything is explained.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::NonNull;

/// A decoded mesh of the library.
#[repr(C)]
struct Raw {
    _opaque: [u8; 0],
}

unsafe extern "C" {
    fn twt_draco_decode(
        data: *const u8,
        size: usize,
        out: *mut *mut Raw,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    fn twt_draco_free(mesh: *mut Raw);
    fn twt_draco_points(mesh: *const Raw) -> u32;
    fn twt_draco_faces(mesh: *const Raw) -> u32;
    fn twt_draco_indices(
        mesh: *const Raw,
        out: *mut u32,
        count: usize,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    fn twt_draco_attribute(
        mesh: *const Raw,
        id: u32,
        components: c_int,
        kind: c_int,
        out: *mut c_void,
        bytes: usize,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
}

/// Calls a function of the shim with room for the reason of a failure.
fn checked(call: impl FnOnce(*mut c_char, usize) -> c_int) -> Result<(), String> {
    let mut reason = [0u8; 256];
    if call(reason.as_mut_ptr().cast(), reason.len()) == 0 {
        return Ok(());
    }
    let text = CStr::from_bytes_until_nul(&reason).unwrap_or_default();
    Err(text.to_string_lossy().into_owned())
}

/// A decoded mesh.
pub struct Decoded(NonNull<Raw>);

impl Decoded {
    /// Decodes a mesh.
    ///
    /// # Errors
    /// What Draco says about bytes that are no mesh.
    pub fn new(bytes: &[u8]) -> Result<Self, String> {
        let mut mesh = std::ptr::null_mut();
        // SAFETY: the bytes outlive the call, which keeps no pointer to them; `mesh` is written.
        checked(|error, len| unsafe {
            twt_draco_decode(bytes.as_ptr(), bytes.len(), &mut mesh, error, len)
        })?;
        NonNull::new(mesh).map(Self).ok_or_else(|| "no mesh".into())
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        // SAFETY: the mesh lives as long as `self`.
        unsafe { twt_draco_points(self.0.as_ptr()) as usize }
    }

    /// Three points for each face.
    ///
    /// # Errors
    /// Why they cannot be handed out.
    pub fn indices(&self) -> Result<Vec<u32>, String> {
        // SAFETY: the mesh lives as long as `self`.
        let faces = unsafe { twt_draco_faces(self.0.as_ptr()) as usize };
        let mut indices = vec![0u32; 3 * faces];
        // SAFETY: the call writes at most `indices.len()` numbers.
        checked(|error, len| unsafe {
            let (out, count) = (indices.as_mut_ptr(), indices.len());
            twt_draco_indices(self.0.as_ptr(), out, count, error, len)
        })?;
        Ok(indices)
    }

    /// The attribute with a unique id, as `components` numbers a point of glTF's type `kind` (of
    /// `size` bytes).
    ///
    /// # Errors
    /// When there is no such attribute, or its numbers are of another type.
    pub fn attribute(
        &self,
        id: u32,
        components: usize,
        (kind, size): (u32, usize),
    ) -> Result<Vec<u8>, String> {
        let length = self.points() * components * size;
        // Words, so that numbers of four bytes lie where they may.
        let mut words = vec![0u32; length.div_ceil(4)];
        // SAFETY: the call writes at most `length` bytes, which `words` has.
        checked(|error, len| unsafe {
            let out = words.as_mut_ptr().cast();
            let (components, kind) = (components as c_int, kind as c_int);
            twt_draco_attribute(
                self.0.as_ptr(),
                id,
                components,
                kind,
                out,
                length,
                error,
                len,
            )
        })?;
        let bytes: &[u8] = bytemuck::cast_slice(&words);
        Ok(bytes[..length].to_vec())
    }
}

impl Drop for Decoded {
    fn drop(&mut self) {
        // SAFETY: made by the shim, and given back once.
        unsafe { twt_draco_free(self.0.as_ptr()) }
    }
}
