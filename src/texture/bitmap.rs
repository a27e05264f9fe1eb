//! Image textures.
//!
//! An image is looked up in one of three ways, and all give the same numbers at the finest level:
//! *resident* texels, linear after one table look-up and a few nanoseconds away, while they fit
//! into the store's budget; the same texels *spilled* to disk and mapped; and, for files that are
//! tiled, OpenImageIO's tile cache, many times slower but bounded and without a copy of the file.
//! Values are made linear before they are interpolated.
//!
//! Row 0 of an image lies at v = 0, as in Mitsuba 3 and glTF: loaders of formats whose v points up
//! (OBJ) turn v around when they read the mesh.

use super::place::{direction, level, nearest, neighbours};
use super::pyramid::{Pyramid, Texel};
use super::texels::{Source, Texels};
use super::{BitmapSettings, Filter, SurfacePoint};
use crate::image::header::Level;
use crate::math::{Rgb, Vec2, luminance};
use std::sync::Arc;

/// An image texture, opened.
pub struct Bitmap {
    texels: Arc<Texels>,
    settings: BitmapSettings,
    /// Squared lengths, in texels, of a step of 1 in u and in v.
    texels_per_uv: Vec2,
}

/// What was asked for and the size: not the texels, and not the directory, so that a scene that is
/// moved keeps its fingerprint.
impl std::fmt::Debug for Bitmap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.settings.path.file_name();
        let settings = BitmapSettings {
            path: name.map_or_else(Default::default, Into::into),
            ..self.settings.clone()
        };
        f.debug_struct("Bitmap")
            .field("settings", &settings)
            .field("width", &self.width())
            .field("height", &self.height())
            .finish()
    }
}

impl Bitmap {
    pub(super) fn new(texels: Arc<Texels>, settings: BitmapSettings) -> Self {
        let size = Vec2::new(texels.size.width as f32, texels.size.height as f32);
        let m = settings.to_uv.0.matrix2;
        Self {
            texels_per_uv: Vec2::new(
                (m.x_axis * size).length_squared(),
                (m.y_axis * size).length_squared(),
            ),
            texels,
            settings,
        }
    }

    /// What was asked for.
    pub fn settings(&self) -> &BitmapSettings {
        &self.settings
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.texels.size.width
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.texels.size.height
    }

    /// Whether there is one value a texel and not three.
    pub fn is_grey(&self) -> bool {
        self.texels.grey
    }

    /// Whether the texels are in memory, all of them.
    pub fn is_resident(&self) -> bool {
        self.texels.bytes > 0
    }

    /// Texels of the file that were not numbers, infinite, or negative colours, and count as 0.
    /// Zero for files that were not read whole.
    pub fn bad_texels(&self) -> u64 {
        self.texels.survey.bad
    }

    /// The linear value of a texel of the finest level; row 0 is the file's first and lies at v =
    /// 0. Coordinates beyond the image are those of its edge.
    pub fn texel(&self, x: u32, y: u32) -> Rgb {
        let (x, y) = (x.min(self.width() - 1), y.min(self.height() - 1));
        self.fetch(0, [x; 2], [y; 2], 0.0, 0.0)
    }

    /// Mean of all texels.
    pub fn mean(&self) -> Rgb {
        self.texels.survey.mean
    }

    /// The largest number of any channel of any texel; of files that were not read whole, that of a
    /// coarser level.
    pub fn largest(&self) -> f32 {
        self.texels.survey.largest
    }

    /// What is odd about the file, in words.
    pub fn oddities(&self) -> Vec<String> {
        let mut list = Vec::new();
        let bad = self.bad_texels();
        if bad > 0 {
            list.push(format!(
                "{bad} texels hold negative, infinite or no numbers, which count as 0"
            ));
        }
        if let Some(window) = self.texels.window {
            let Level { width, height } = self.texels.size;
            let Level {
                width: whole_width,
                height: whole_height,
            } = window.whole;
            let [x, y] = window.at;
            list.push(format!(
                "its data window, {width} x {height} pixels from {x}, {y}, is not the whole picture of {whole_width} x {whole_height}: the data alone is the texture, as in Mitsuba"
            ));
        }
        list
    }

    /// The value at a point of a surface.
    #[inline]
    pub fn eval(&self, point: &SurfacePoint) -> Rgb {
        let level = if point.footprint > 0.0 {
            self.level_at(point)
        } else {
            0
        };
        self.eval_uv(point.uv, level)
    }

    /// The value at texture coordinates (before [`BitmapSettings::to_uv`]) on a mip level, 0 being
    /// the finest; levels that do not exist are the coarsest.
    #[inline]
    pub fn eval_uv(&self, uv: Vec2, level: usize) -> Rgb {
        let s = &self.settings;
        let uv = s.to_uv.0.transform_point2(uv);
        let level = level.min(self.texels.levels - 1);
        let size = self.level_size(level);
        match s.filter {
            Filter::Nearest => {
                let x = nearest(uv.x, size.width, s.wrap_u);
                let y = nearest(uv.y, size.height, s.wrap_v);
                self.fetch(level, [x; 2], [y; 2], 0.0, 0.0)
            }
            Filter::Linear => {
                let (x, wx) = neighbours(uv.x, size.width, s.wrap_u);
                let (y, wy) = neighbours(uv.y, size.height, s.wrap_v);
                self.fetch(level, x, y, wx, wy)
            }
        }
    }

    /// Change of the value with u and with v, where it is interpolated on the finest level; nothing
    /// changes between texels that are not.
    pub fn gradient(&self, uv: Vec2) -> [Rgb; 2] {
        let s = &self.settings;
        if s.filter == Filter::Nearest {
            return [Rgb::ZERO; 2];
        }
        let at = s.to_uv.0.transform_point2(uv);
        let size = self.texels.size;
        let (x, wx) = neighbours(at.x, size.width, s.wrap_u);
        let (y, wy) = neighbours(at.y, size.height, s.wrap_v);
        let along = |wx, wy| self.fetch(0, x, y, wx, wy);
        let scale_x = direction(at.x, s.wrap_u) * size.width as f32;
        let scale_y = direction(at.y, s.wrap_v) * size.height as f32;
        let across_x = (along(1.0, wy) - along(0.0, wy)) * scale_x;
        let across_y = (along(wx, 1.0) - along(wx, 0.0)) * scale_y;
        let m = s.to_uv.0.matrix2;
        [m.x_axis, m.y_axis].map(|axis| across_x * axis.x + across_y * axis.y)
    }

    /// Number of mip levels.
    pub fn level_count(&self) -> usize {
        self.texels.levels
    }

    /// The mip level for a point's footprint. The width of a pixel's cone is laid along u and along
    /// v; the smaller extent counts.
    #[inline]
    pub fn level_at(&self, point: &SurfacePoint) -> usize {
        if self.settings.filter == Filter::Nearest {
            return 0;
        }
        let squared = (self.texels_per_uv.x / point.dp_du.length_squared())
            .min(self.texels_per_uv.y / point.dp_dv.length_squared());
        level(
            squared * point.footprint * point.footprint,
            self.texels.levels,
        )
    }

    #[inline(always)]
    fn level_size(&self, level: usize) -> Level {
        match &self.texels.source {
            Source::Rgb8(p) => p.size(level),
            Source::Grey8(p) => p.size(level),
            Source::RgbHalf(p) => p.size(level),
            Source::GreyHalf(p) => p.size(level),
            Source::RgbFloat(p) => p.size(level),
            Source::GreyFloat(p) => p.size(level),
            #[cfg(feature = "oiio")]
            Source::Cached(c) => c.size(level),
        }
    }

    /// The bilinear mix of four texels.
    #[inline(always)]
    fn fetch(&self, level: usize, x: [u32; 2], y: [u32; 2], wx: f32, wy: f32) -> Rgb {
        match &self.texels.source {
            Source::Rgb8(p) => color(p, level, x, y, wx, wy),
            Source::Grey8(p) => grey(p, level, x, y, wx, wy),
            Source::RgbHalf(p) => color(p, level, x, y, wx, wy),
            Source::GreyHalf(p) => grey(p, level, x, y, wx, wy),
            Source::RgbFloat(p) => color(p, level, x, y, wx, wy),
            Source::GreyFloat(p) => grey(p, level, x, y, wx, wy),
            #[cfg(feature = "oiio")]
            Source::Cached(c) => mix(c.quad(level, x, y).map(Rgb::from), wx, wy),
        }
    }

    /// The value at a point as one number.
    #[inline]
    pub fn eval_scalar(&self, point: &SurfacePoint) -> f32 {
        let value = self.eval(point);
        if self.texels.grey {
            value.x
        } else {
            luminance(value)
        }
    }
}

#[inline(always)]
fn mix<V>(q: [V; 4], wx: f32, wy: f32) -> V
where
    V: Copy + std::ops::Add<Output = V> + std::ops::Mul<f32, Output = V>,
{
    (q[0] * (1.0 - wx) + q[1] * wx) * (1.0 - wy) + (q[2] * (1.0 - wx) + q[3] * wx) * wy
}

#[inline(always)]
fn color<T: Texel>(
    p: &Pyramid<T, 3>,
    level: usize,
    x: [u32; 2],
    y: [u32; 2],
    wx: f32,
    wy: f32,
) -> Rgb {
    mix(p.quad(level, x, y).map(Rgb::from), wx, wy)
}

#[inline(always)]
fn grey<T: Texel>(
    p: &Pyramid<T, 1>,
    level: usize,
    x: [u32; 2],
    y: [u32; 2],
    wx: f32,
    wy: f32,
) -> Rgb {
    Rgb::splat(mix(p.quad(level, x, y).map(|[v]| v), wx, wy))
}
