//! The texels of an image, in memory or in OpenImageIO's cache.

#[cfg(feature = "oiio")]
use super::cached::Cached;
use super::pyramid::{Half, Pyramid};
use super::survey::Survey;
use crate::image::header::{Level, Window};

/// Where texels come from.
#[derive(Debug)]
pub(super) enum Source {
    /// 8-bit colours.
    Rgb8(Pyramid<u8, 3>),
    /// 8-bit grey.
    Grey8(Pyramid<u8, 1>),
    /// Half float colours.
    RgbHalf(Pyramid<Half, 3>),
    /// Half float grey.
    GreyHalf(Pyramid<Half, 1>),
    /// Float colours.
    RgbFloat(Pyramid<f32, 3>),
    /// Float grey.
    GreyFloat(Pyramid<f32, 1>),
    /// OpenImageIO's cache.
    #[cfg(feature = "oiio")]
    Cached(Cached),
}

/// The texels of a file, made linear: what textures with different placements share.
#[derive(Debug)]
pub(super) struct Texels {
    pub source: Source,
    pub size: Level,
    pub levels: usize,
    pub grey: bool,
    pub survey: Survey,
    pub window: Option<Window>,
    pub bytes: usize,
}
