//! The film: where samples become pixels.
//!
//! Each sample belongs to one pixel. A reconstruction filter wider than a pixel is applied by drawing
//! the sample's place from the filter ([`filter::Filter::sample`]) instead of spreading the sample over
//! pixels: pixels stay independent, so tiles need no borders, variance is per pixel, and the sum of a
//! pixel does not depend on threads.

pub mod filter;

/// What file formats a scene asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FilmKind {
    /// High dynamic range.
    #[default]
    Hdr,
    /// Eight bits with the sRGB curve.
    Ldr,
}

/// A film as a scene describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmDescription {
    /// Full width in pixels.
    pub width: u32,
    /// Full height in pixels.
    pub height: u32,
    /// Part to render: x0, y0, x1, y1 in pixels, upper bounds not included; `None` is all.
    pub crop: Option<[u32; 4]>,
    /// Reconstruction filter.
    pub filter: filter::Filter,
    /// Kind.
    pub kind: FilmKind,
    /// Multiplier applied before an 8-bit curve, as a power of two (`ldrfilm` exposure).
    pub exposure: f32,
}
