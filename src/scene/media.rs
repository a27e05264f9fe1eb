//! The media of a scene, and the surfaces between them.

use super::description::Shape;
use crate::accel::{Bounds, Hit};
use crate::bsdf::Materials;
use crate::medium::{Boundary, Media, MediumId, VACUUM};

/// What a shape does to a ray's medium.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The media on its sides; `None` where it divides nothing.
    pub boundary: Option<Boundary>,
    /// Light goes straight through, and the surface does nothing else.
    pub index_matched: bool,
}

/// Media, and which shapes bound them.
#[derive(Debug)]
pub struct SceneMedia {
    media: Media,
    /// By [`Hit::shape`].
    sides: Vec<Side>,
    /// Where the camera is.
    pub camera: MediumId,
    /// What is outside of all bodies.
    pub outside: MediumId,
    /// Where media may be.
    pub region: Bounds,
    /// Whether any surface is index-matched.
    pub has_index_matched: bool,
    /// Whether any surface bounds media.
    pub has_boundaries: bool,
}

impl SceneMedia {
    /// Of a description's shapes; where the camera is and what is outside is not known yet. Where
    /// there is no medium nothing is kept.
    pub(super) fn new(media: Media, shapes: &[Shape], materials: &Materials) -> Self {
        let side = |shape: &Shape| Side {
            boundary: shape.boundary,
            index_matched: shape.emitter.is_none() && materials.is_null(shape.material),
        };
        let sides: Vec<Side> = match media.is_empty() {
            true => Vec::new(),
            false => shapes.iter().map(side).collect(),
        };
        Self {
            has_index_matched: sides.iter().any(|side| side.index_matched),
            has_boundaries: sides.iter().any(|side| side.boundary.is_some()),
            outside: VACUUM,
            region: Bounds::EMPTY,
            media,
            sides,
            camera: VACUUM,
        }
    }

    /// Whether there is no medium: then rays go from surface to surface.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.media.is_empty()
    }

    /// Whether any of them scatters.
    pub fn scatter(&self) -> bool {
        self.media
            .list
            .iter()
            .any(|medium| medium.extinction.scatters())
    }

    /// Whether a shape bounds one.
    pub(super) fn is_bounded_by(&self, shape: u32) -> bool {
        self.sides[shape as usize].boundary.is_some()
    }

    /// The media, by number.
    #[inline]
    pub fn list(&self) -> &Media {
        &self.media
    }

    /// What the surface that was met does to the medium.
    #[inline]
    pub fn side(&self, hit: &Hit) -> Side {
        self.sides[hit.shape as usize]
    }
}
