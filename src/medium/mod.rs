//! Participating media: what light meets between surfaces.
//!
//! A [`Medium`] absorbs and scatters. Its extinction coefficient sigma_t is in inverse world units,
//! its albedo the share of what is taken out of a ray that is scattered instead of absorbed, and a
//! [`PhaseFunction`] tells where to. Shapes bound media ([`Boundary`]); a path knows in which it is.
//!
//! Extinction may differ by channel. A distance can only be drawn for one channel, so paths carry
//! [`ChannelWeights`]: how likely each channel's sampling would have been to make the path so far. Every
//! estimate is divided by the mean over the channels (spectral MIS with the balance heuristic:
//! Miller, Georgiev and Jarosz 2019, "A null-scattering path integral formulation of light
//! transport", section 5).

mod extinction;
pub mod grids;
mod homogeneous;
pub mod phase;

pub use extinction::Extinction;
pub use homogeneous::Homogeneous;
pub use phase::{PhaseFunction, PhaseLobe};

use crate::math::{Rgb, Vec3};

/// Index of a [`Medium`] in [`Media`].
pub type MediumId = u32;

/// Nothing that light meets.
pub const VACUUM: MediumId = MediumId::MAX;

/// What fills a body, or all space.
#[derive(Clone, Debug)]
pub struct Medium {
    /// What its scene calls it, for messages.
    pub name: String,
    /// How it takes light out of a ray.
    pub extinction: Extinction,
    /// How it scatters.
    pub phase: PhaseFunction,
}

impl Medium {
    /// What absorbs white light so that `color`, each channel 0 to 1, is left after a distance.
    pub fn absorbing(name: String, color: Rgb, distance: f32) -> Self {
        Self {
            name,
            extinction: Homogeneous::absorbing(color, distance).into(),
            phase: PhaseFunction::isotropic(),
        }
    }
}

/// The media of a scene.
#[derive(Clone, Debug, Default)]
pub struct Media {
    /// By [`MediumId`].
    pub list: Vec<Medium>,
}

/// The media on both sides of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boundary {
    /// On the side that the geometric normal points away from.
    pub interior: MediumId,
    /// On the side of the geometric normal.
    pub exterior: MediumId,
}

impl Boundary {
    /// Of a body that stands in nothing.
    pub fn in_vacuum(interior: MediumId) -> Self {
        Self {
            interior,
            exterior: VACUUM,
        }
    }

    /// The medium that a ray along `dir` is in after a surface of this geometric normal.
    #[inline]
    pub fn beyond(&self, ng: Vec3, dir: Vec3) -> MediumId {
        if dir.dot(ng) > 0.0 {
            self.exterior
        } else {
            self.interior
        }
    }
}

impl Media {
    /// Adds one and returns its number.
    pub fn push(&mut self, medium: Medium) -> MediumId {
        self.list.push(medium);
        self.list.len() as MediumId - 1
    }

    /// The medium of that number; `None` for [`VACUUM`].
    #[inline]
    pub fn get(&self, id: MediumId) -> Option<&Medium> {
        self.list.get(id as usize)
    }

    /// Whether the scene has none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// A part of a ray inside a medium.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where it begins.
    pub origin: Vec3,
    /// Its unit direction.
    pub direction: Vec3,
    /// Its length; infinite where nothing ends it.
    pub length: f32,
}

impl Segment {
    /// A place on it.
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }

    /// The part before a distance.
    #[inline]
    pub fn until(&self, distance: f32) -> Self {
        Self {
            length: distance,
            ..*self
        }
    }

    /// Origin, direction and length.
    #[inline]
    fn parts(&self) -> (Vec3, Vec3, f32) {
        (self.origin, self.direction, self.length)
    }
}

/// What became of a path along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// What its throughput is multiplied by: transmittance, and at a collision the scattering
    /// coefficient, over the density.
    pub factor: Rgb,
    /// Distance of the collision; `None` where it came through.
    pub collision: Option<f32>,
}

/// How likely each channel's sampling would have been to make a path: relative, of mean 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelWeights(Rgb);

impl Default for ChannelWeights {
    fn default() -> Self {
        Self(Rgb::ONE)
    }
}

impl ChannelWeights {
    /// A channel, drawn by `u`: each by how likely it made the path so far, which is the same as
    /// keeping one that was drawn at the start.
    #[inline]
    pub fn channel(&self, u: f32) -> usize {
        let u = 3.0 * u;
        match u {
            u if u < self.0.x => 0,
            u if u < self.0.x + self.0.y => 1,
            // Rounding never chooses a channel that cannot be.
            _ if self.0.z > 0.0 => 2,
            _ if self.0.y > 0.0 => 1,
            _ => 0,
        }
    }

    /// The density of what channel c samples with density `density[c]`: the mean over the channels.
    #[inline]
    pub fn density(&self, density: Rgb) -> f32 {
        (self.0 * density).element_sum() * (1.0 / 3.0)
    }

    /// Something happened that channel c samples with density `density[c]` and that contributes
    /// `value[c]`: what the throughput is multiplied by. 0 where no channel makes it.
    #[inline]
    pub fn update(&mut self, value: Rgb, density: Rgb) -> Rgb {
        let joint = self.0 * density;
        let mean = (joint.x + joint.y + joint.z) * (1.0 / 3.0);
        // Not where it is no number.
        let happens = mean > 0.0;
        if !happens {
            return Rgb::ZERO;
        }
        self.0 = joint / mean;
        value / mean
    }
}

#[cfg(test)]
mod tests;
