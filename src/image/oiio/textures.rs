//! OpenImageIO's `TextureSystem`: tiles of textures, read when they are asked for and dropped when
//! memory runs short.

use super::{Reason, c_path, ffi, type_number};
use crate::image::PixelType;
use std::cell::Cell;
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::atomic::{AtomicU64, Ordering};

/// A texture cache with a cap on its memory.
#[derive(Debug)]
pub struct TextureSystem {
    raw: NonNull<ffi::Textures>,
    /// Never used twice in a process, so that a thread cannot take another system's record for its
    /// own.
    id: u64,
}

/// A texture of a [`TextureSystem`]; without meaning for another.
#[derive(Clone, Copy, Debug)]
pub struct Handle(NonNull<ffi::Texture>);

// SAFETY: OpenImageIO's TextureSystem is made for many threads; handles are names that never go
// stale before the system does.
unsafe impl Send for TextureSystem {}
// SAFETY: as above.
unsafe impl Sync for TextureSystem {}
// SAFETY: as above.
unsafe impl Send for Handle {}
// SAFETY: as above.
unsafe impl Sync for Handle {}

impl Drop for TextureSystem {
    fn drop(&mut self) {
        // SAFETY: made by twt_textures_create and destroyed once.
        unsafe { ffi::twt_textures_destroy(self.raw.as_ptr()) }
    }
}

thread_local! {
    /// This thread's record in the system it used last.
    static RECORD: Cell<(u64, *mut ffi::Thread)> = const { Cell::new((0, ptr::null_mut())) };
}

/// What to look up, to compare with: in OpenImageIO's own terms: stored values, `t` from the top row down.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// Place.
    pub st: [f32; 2],
    /// Change of the place with the picture's x.
    pub dx: [f32; 2],
    /// Change of the place with the picture's y.
    pub dy: [f32; 2],
    /// First channel; as many as the result is long.
    pub first_channel: usize,
    /// Outside `[0, 1]`: 0 repeat, 1 mirror, 2 clamp.
    pub wrap: [i32; 2],
    /// The closest texel of the finest level.
    pub nearest: bool,
}

impl TextureSystem {
    /// A cache for at most `max_bytes` of texels (OpenImageIO keeps no less than 10 MB).
    pub fn new(max_bytes: usize) -> Result<Self, String> {
        static IDS: AtomicU64 = AtomicU64::new(1);
        ffi::load()?;
        // SAFETY: no preconditions; null says that it failed.
        let raw = unsafe { ffi::twt_textures_create(max_bytes as f32 / (1024.0 * 1024.0)) };
        Ok(Self {
            raw: NonNull::new(raw).ok_or("OpenImageIO's texture system cannot start")?,
            id: IDS.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// Opens a texture. The error is the reason alone.
    pub fn open(&self, path: &Path) -> Result<Handle, String> {
        let (path, mut reason) = (c_path(path)?, Reason::new());
        // SAFETY: the system lives; strings outlive the call.
        let raw = unsafe {
            ffi::twt_textures_open(
                self.raw.as_ptr(),
                path.as_ptr(),
                reason.pointer(),
                reason.len(),
            )
        };
        NonNull::new(raw).map(Handle).ok_or_else(|| reason.text())
    }

    /// Bytes of texels held now.
    pub fn memory_bytes(&self) -> usize {
        // SAFETY: the system lives.
        unsafe { ffi::twt_textures_memory(self.raw.as_ptr()) }.max(0) as usize
    }

    /// Width and height of a mip level.
    pub fn level(&self, texture: Handle, level: u32) -> Option<[u32; 2]> {
        let (mut w, mut h) = (0, 0);
        // SAFETY: the system lives and `texture` is one of its.
        let bad = unsafe {
            ffi::twt_texture_level(
                self.raw.as_ptr(),
                texture.0.as_ptr(),
                level.min(64) as i32,
                &mut w,
                &mut h,
            )
        };
        (bad == 0).then_some([w as u32, h as u32])
    }

    #[inline]
    fn thread(&self) -> *mut ffi::Thread {
        RECORD.with(|record| {
            let (id, thread) = record.get();
            if id == self.id {
                return thread;
            }
            // SAFETY: the system lives; the record is used by this thread alone.
            let thread = unsafe { ffi::twt_textures_thread(self.raw.as_ptr()) };
            record.set((self.id, thread));
            thread
        })
    }

    /// Texels `x..x + nx` by `y..y + ny` of channels `channels` of a level, as stored, `pixel_type`
    /// each, into `data`. All texels must be inside the image. False if the file cannot be read.
    #[inline]
    pub fn texels<T: bytemuck::Pod>(
        &self,
        texture: Handle,
        level: u32,
        [x, nx, y, ny]: [u32; 4],
        channels: std::ops::Range<usize>,
        pixel_type: PixelType,
        data: &mut [T],
    ) -> bool {
        let size = match pixel_type {
            PixelType::U8 => 1,
            PixelType::U16 | PixelType::Half => 2,
            PixelType::Float => 4,
        };
        let bytes = nx as usize * ny as usize * channels.len() * size;
        assert!(size_of_val(data) >= bytes, "room for the texels");
        // SAFETY: the system lives, `texture` is one of its, and `data` has room for `bytes`.
        let bad = unsafe {
            ffi::twt_texture_texels(
                self.raw.as_ptr(),
                self.thread(),
                texture.0.as_ptr(),
                level as i32,
                x as i32,
                nx as i32,
                y as i32,
                ny as i32,
                channels.start as i32,
                channels.end as i32,
                type_number(pixel_type),
                data.as_mut_ptr().cast(),
            )
        };
        bad == 0
    }

    /// OpenImageIO's own filtered look-up of stored values, to compare with. False if the file
    /// cannot be read.
    #[cfg(test)]
    pub fn lookup(&self, texture: Handle, lookup: &Lookup, result: &mut [f32]) -> bool {
        let raw = ffi::Lookup {
            s: lookup.st[0],
            t: lookup.st[1],
            dsdx: lookup.dx[0],
            dtdx: lookup.dx[1],
            dsdy: lookup.dy[0],
            dtdy: lookup.dy[1],
            first_channel: lookup.first_channel as i32,
            channels: result.len() as i32,
            wrap_s: lookup.wrap[0],
            wrap_t: lookup.wrap[1],
            nearest: lookup.nearest as i32,
        };
        // SAFETY: the system lives, `texture` is one of its, `result` has room for `channels`
        // floats.
        let bad = unsafe {
            ffi::twt_texture_lookup(
                self.raw.as_ptr(),
                self.thread(),
                texture.0.as_ptr(),
                &raw,
                result.as_mut_ptr(),
            )
        };
        bad == 0
    }
}
