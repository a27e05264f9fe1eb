//! A medium whose density varies: free flights and transmittance.
//!
//! It ends where the unit cube of its density's grid does. Mitsuba 3 ends it at the box around that
//! cube along the axes of the scene, which is more where `to_world` turns the grid and the shape
//! that holds the medium is larger than it.

use super::balance::Balance;
use super::grid::Grid;
use super::majorant::Majorants;
use super::tracking::Tracking;
use super::walk::Span;
use crate::math::{DVec3, Rgb, Vec3};
use crate::medium::Flight;

/// Albedos up to this are taken for 1: quotients of `f32` end a little above.
const MAX_ALBEDO: f32 = 1.001;

/// The share of light that a collision scatters.
#[derive(Clone, Debug)]
pub enum Albedo {
    /// The same everywhere, 0 to 1.
    Constant(Rgb),
    /// By place, 0 to 1.
    Grid(Grid),
}

/// Why a medium cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MediumError {
    /// A density cannot be multiplied by this.
    #[error("a scale of {0}: it must be finite and not negative")]
    Scale(f32),
    /// More light than comes in, or less than none.
    #[error("an albedo of {0}: it must be 0 to 1")]
    Albedo(f32),
}

/// A medium whose density is a grid's.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    density: Grid,
    scale: f64,
    albedo: Albedo,
    /// Nothing is scattered anywhere.
    absorbs_alone: bool,
    majorants: Majorants,
}

impl Heterogeneous {
    /// A medium with the extinction coefficient `density` times `scale`, per unit of length of the
    /// scene, inside the unit cube of the density's grid, and without any outside.
    ///
    /// # Errors
    /// When the scale is negative or not finite, or albedos are not within 0 and 1.
    pub fn new(density: Grid, scale: f32, albedo: Albedo) -> Result<Self, MediumError> {
        if !(scale >= 0.0 && scale.is_finite()) {
            return Err(MediumError::Scale(scale));
        }
        let is_albedo = |a: &f32| (0.0..=MAX_ALBEDO).contains(a);
        let wrong = match &albedo {
            Albedo::Constant(rgb) => rgb.to_array().into_iter().find(|a| !is_albedo(a)),
            Albedo::Grid(grid) => grid.values().iter().copied().find(|a| !is_albedo(a)),
        };
        if let Some(value) = wrong {
            return Err(MediumError::Albedo(value));
        }
        let absorbs_alone = match &albedo {
            Albedo::Constant(rgb) => *rgb == Rgb::ZERO,
            Albedo::Grid(grid) => grid.values().iter().all(|a| *a == 0.0),
        };
        Ok(Self {
            absorbs_alone,
            majorants: Majorants::new(&density),
            scale: f64::from(scale),
            density,
            albedo,
        })
    }

    /// The extinction coefficient at a point of the scene, per unit of its length.
    pub fn sigma_t(&self, p: Vec3) -> Rgb {
        let local = self.density.to_grid().transform_point3(p.as_dvec3());
        if local.cmplt(DVec3::ZERO).any() || local.cmpgt(DVec3::ONE).any() {
            return Rgb::ZERO;
        }
        (self.density.eval_local(local) * self.scale).as_vec3()
    }

    /// The albedo at a point of the scene, 0 to 1.
    pub fn albedo(&self, p: Vec3) -> Rgb {
        self.albedo_at(p.as_dvec3())
    }

    /// Whether nothing is scattered anywhere.
    pub fn absorbs_alone(&self) -> bool {
        self.absorbs_alone
    }

    /// All its grids.
    pub fn grids(&self) -> impl Iterator<Item = &Grid> {
        let albedo = match &self.albedo {
            Albedo::Constant(_) => None,
            Albedo::Grid(grid) => Some(grid),
        };
        [&self.density].into_iter().chain(albedo)
    }

    /// The density's grid.
    pub fn density(&self) -> &Grid {
        &self.density
    }

    /// Flies from `org` along `dir`, a unit vector, to a collision or as far as `distance` (not
    /// negative, may be infinite), whichever comes first.
    ///
    /// `weights` are the relative densities of the path in the three channels, with mean 1. They
    /// are what multiple importance sampling of channels has to know of the path so far (Miller,
    /// Georgiev and Jarosz 2019), and are brought up to date; a density of one channel leaves them
    /// as they are. `u` gives uniform numbers in `[0, 1)`.
    pub fn sample(
        &self,
        org: Vec3,
        dir: Vec3,
        distance: f32,
        weights: &mut Rgb,
        u: &mut impl FnMut() -> f32,
    ) -> Flight {
        let span = Span::new(self.density.to_grid(), org, dir, distance);
        let mut balance = Balance::new(*weights, self.density.channels() == 1);
        let fly = |span: Span| Some(span.start + self.tracking(&span).fly(&mut balance, u)?);
        let met = span.and_then(fly);
        let mut factor = Rgb::ONE;
        if self.density.channels() > 1 {
            (factor, *weights) = balance.finish();
        }
        if let Some(at) = met {
            factor *= self.albedo_at(org.as_dvec3() + dir.as_dvec3() * at);
        }
        Flight {
            factor,
            collision: met.map(|at| (at as f32).min(distance)),
        }
    }

    /// The transmittance from `org` along `dir`, a unit vector, as far as
    /// `distance` (not negative, may be infinite): 0 to 1 in each channel; exact of what absorbs
    /// alone, an unbiased estimate of what scatters. `u` gives uniform numbers in `[0, 1)`.
    pub fn transmittance(
        &self,
        org: Vec3,
        dir: Vec3,
        distance: f32,
        u: &mut impl FnMut() -> f32,
    ) -> Rgb {
        if self.absorbs_alone {
            return self.exact_transmittance(org, dir, distance);
        }
        let span = Span::new(self.density.to_grid(), org, dir, distance);
        let left = span.map_or(DVec3::ONE, |span| self.tracking(&span).transmittance(u));
        left.as_vec3()
    }

    /// The optical depth from `org` along `dir`, a unit vector, as far as `distance` (may be
    /// infinite), without noise: exact up to rounding, in as many steps as there are voxels in the
    /// way.
    pub fn optical_depth(&self, org: Vec3, dir: Vec3, distance: f32) -> Rgb {
        let span = Span::new(self.density.to_grid(), org, dir, distance);
        let depth = span.map_or(DVec3::ZERO, |s| self.tracking(&s).optical_depth());
        depth.as_vec3()
    }

    /// The transmittance that [`Self::optical_depth`] leaves.
    pub fn exact_transmittance(&self, org: Vec3, dir: Vec3, distance: f32) -> Rgb {
        (-self.optical_depth(org, dir, distance)).exp()
    }

    fn tracking<'a>(&'a self, span: &'a Span) -> Tracking<'a> {
        Tracking {
            density: &self.density,
            scale: self.scale,
            majorants: &self.majorants,
            span,
        }
    }

    fn albedo_at(&self, p: DVec3) -> Rgb {
        match &self.albedo {
            Albedo::Constant(rgb) => rgb.min(Rgb::ONE),
            Albedo::Grid(grid) => grid.eval_precise(p).as_vec3().min(Rgb::ONE),
        }
    }
}
