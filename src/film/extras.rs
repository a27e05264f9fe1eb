//! What pixels carry besides, where it is asked for: sums that most renders have no use for.
//!
//! A pixel's further sums stand one after the other in [`super::Tile::extras`]; [`Extras`] tells which
//! there are and where. None of them changes the picture: what is not finite counts as 0 here,
//! where in the picture it would cost the sample.

use super::light_parts::LightParts;
use super::mattes::{self, Mattes};
use crate::math::{Rgb, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Which sums pixels carry besides.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Extras {
    /// Position of the first surface.
    pub position: bool,
    /// The scene file's coordinates of the world's origin, which positions are told with.
    pub origin: [f64; 3],
    /// Texture coordinates of the first surface.
    pub uv: bool,
    /// Its geometric normal.
    pub geometric_normal: bool,
    /// How much of the pixel is covered: the alpha channel.
    pub alpha: bool,
    /// Light in parts.
    pub light: LightParts,
    /// Which shapes are seen, and what they are called.
    pub mattes: Option<Mattes>,
}

/// What a path from the camera meets first, for [`Extras`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstPoint {
    /// Position.
    pub position: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Unit geometric normal.
    pub normal: Vec3,
    /// Number of the shape.
    pub shape: u32,
}

/// What one sample gives a pixel besides.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExtraSample<'w> {
    /// What it met first.
    pub first: Option<FirstPoint>,
    /// The parts of its radiance; none at all where it is black.
    pub light: &'w [Rgb],
}

impl Extras {
    /// Whether there are any.
    pub fn is_empty(&self) -> bool {
        self.count() == 0 && self.mattes.is_none()
    }

    /// Sums of a pixel.
    pub fn count(&self) -> usize {
        self.lights().end
    }

    /// Bytes that a pixel takes more, about.
    pub fn bytes_of_pixel(&self) -> usize {
        let mattes = self.mattes.as_ref().map_or(0, |_| mattes::USUAL_BYTES);
        self.count() * size_of::<f64>() + mattes
    }

    /// Whether a wave has to keep what its samples meet first.
    pub fn wants_first_points(&self) -> bool {
        self.position || self.uv || self.geometric_normal || self.mattes.is_some()
    }

    /// Where the sums of positions are among those of a pixel; empty if there are none.
    pub fn positions(&self) -> Range<usize> {
        after(0, self.position, 3)
    }

    /// Those of texture coordinates.
    pub fn uvs(&self) -> Range<usize> {
        after(self.positions().end, self.uv, 2)
    }

    /// Those of geometric normals.
    pub fn normals(&self) -> Range<usize> {
        after(self.uvs().end, self.geometric_normal, 3)
    }

    /// That of what is covered.
    pub fn alphas(&self) -> Range<usize> {
        after(self.normals().end, self.alpha, 1)
    }

    /// Those of light in parts, three each.
    pub fn lights(&self) -> Range<usize> {
        after(self.alphas().end, true, 3 * self.light.count())
    }
}

/// So many sums after others, if there are any.
fn after(begin: usize, any: bool, count: usize) -> Range<usize> {
    begin..begin + if any { count } else { 0 }
}
