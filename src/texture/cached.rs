//! Texels through OpenImageIO's tile cache, for tiled images that do not fit into memory.
//!
//! OpenImageIO interpolates stored values, and an average of sRGB codes is not the code of the
//! average. So only texels are asked of it, and they are made linear here before they are mixed.

use super::curve::{Cleaner, Curve};
use crate::image::PixelType;
use crate::image::header::Level;
use crate::image::oiio::textures::{Handle, TextureSystem};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// An image in OpenImageIO's cache.
#[derive(Debug)]
pub(super) struct Cached {
    pub system: Arc<TextureSystem>,
    pub handle: Handle,
    pub levels: Vec<Level>,
    /// Channels to read: one, or three in a row.
    pub first: usize,
    pub grey: bool,
    /// How the file stores them.
    pub stored: PixelType,
    pub curve: Curve,
    pub table: Box<[f32; 256]>,
    pub cleaner: Cleaner,
    /// Look-ups that the file failed to answer.
    pub failures: AtomicU64,
}

impl Cached {
    #[inline]
    pub fn size(&self, level: usize) -> Level {
        self.levels[level]
    }

    /// Four linear texels of a level: `(x0, y0) (x1, y0) (x0, y1) (x1, y1)`.
    pub fn quad(&self, level: usize, x: [u32; 2], y: [u32; 2]) -> [[f32; 3]; 4] {
        let adjacent = x[1] == x[0] + 1 && y[1] == y[0] + 1;
        if adjacent {
            return self.block::<12>(level, [x[0], 2, y[0], 2]);
        }
        if x[0] == x[1] && y[0] == y[1] {
            let [one, ..] = self.block::<3>(level, [x[0], 1, y[0], 1]);
            return [one; 4];
        }
        // Across an edge that wraps around.
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.block::<3>(level, [x[i], 1, y[j], 1])[0])
    }

    /// A block of texels, linear; `M` numbers are enough for it.
    fn block<const M: usize>(&self, level: usize, block: [u32; 4]) -> [[f32; 3]; 4] {
        let mut linear = [0.0f32; M];
        let n = if self.grey { 1 } else { 3 };
        let channels = self.first..self.first + n;
        let good = if self.stored == PixelType::U8 {
            let mut codes = [0u8; M];
            let good = self.system.texels(
                self.handle,
                level as u32,
                block,
                channels,
                PixelType::U8,
                &mut codes,
            );
            linear = codes.map(|c| self.table[c as usize]);
            good
        } else {
            let good = self.system.texels(
                self.handle,
                level as u32,
                block,
                channels,
                PixelType::Float,
                &mut linear,
            );
            linear = linear.map(|x| self.cleaner.clean(self.curve.decode(x)));
            good
        };
        if !good {
            self.failures.fetch_add(1, Ordering::Relaxed);
            return [[0.0; 3]; 4];
        }
        std::array::from_fn(|i| match (self.grey, (i + 1) * n <= M) {
            (_, false) => [0.0; 3],
            (true, true) => [linear[i]; 3],
            (false, true) => [linear[3 * i], linear[3 * i + 1], linear[3 * i + 2]],
        })
    }
}
