//! What a scattering model is: its parameters as a scene describes them, and how they become a
//! [`Lobe`] at a point.

use super::lobes::Lobe;
use super::microfacet::Microfacet;
use super::parameters::{Parameters, Roughness};
use super::transmittance::RoughTransmittance;
use crate::math::Rgb;
use crate::texture::{SurfacePoint, Texture};
use std::fmt::Debug;

/// The parameters of a model that scatters by itself; those that a scene may texture are
/// [`Texture`]s.
pub(super) trait Model: Debug {
    /// The model at a point, in plain numbers.
    type Lobe: Lobe
    where
        Self: Sized;

    /// Asks a scene file for its parameters. The message of an error says why they do not make a
    /// material.
    fn read(p: &mut dyn Parameters) -> Result<Self, String>
    where
        Self: Sized;

    /// Whether Mitsuba's scene files can ask for it by its name.
    fn is_plugin() -> bool
    where
        Self: Sized,
    {
        true
    }

    /// Looks up each texture once.
    fn lobe(&self, at: &Lookup) -> Self::Lobe
    where
        Self: Sized;

    /// The textures that [`Model::lobe`] looks up.
    fn textures(&self) -> Textures<'_>;

    /// Whether it depends on where the tangent points.
    fn is_anisotropic(&self) -> bool {
        false
    }

    /// Whether it scatters to more than a few discrete directions.
    fn scatters(&self) -> bool {
        true
    }

    /// Whether light goes on behind the surface in another direction.
    fn refracts(&self) -> bool {
        false
    }

    /// Whether light goes on behind the surface at all.
    fn transmits(&self) -> bool {
        self.refracts()
    }

    /// Whether light may come by way of it that next-event estimation does not find: by mirrors,
    /// metals, lenses and panes.
    fn casts_caustics(&self) -> bool {
        self.refracts()
    }

    /// Makes the tables that it needs, so that no path has to wait for them. The one of its rough
    /// coat is kept for [`Lookup::coat_table`].
    fn prepare(&self) -> Option<&'static RoughTransmittance> {
        None
    }

    /// Examples by name: the tests of `src/bsdf/tests` go through all of them, and those that
    /// `tests/vectors/bsdf.py` knows by the same name are compared with Mitsuba.
    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)>
    where
        Self: Sized;
}

/// Textures by how scattered light follows them.
#[derive(Default)]
pub(super) struct Textures<'a> {
    /// Linearly, as it follows the colour of a lobe: the light of their average is the average of
    /// the light.
    pub linear: Vec<&'a Texture>,
    /// In any other way.
    pub nonlinear: Vec<&'a Texture>,
}

impl<'a> Textures<'a> {
    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &'a Texture> + '_ {
        self.linear.iter().chain(&self.nonlinear).copied()
    }
}

/// The point at which textures are read, and what was prepared for the material.
#[derive(Clone, Copy)]
pub(super) struct Lookup<'a> {
    pub point: &'a SurfacePoint<'a>,
    /// What [`Model::prepare`] returned.
    pub prepared: Option<&'static RoughTransmittance>,
}

/// Largest value of a colour: no surface reflects as much, and the models' products stay finite.
pub(super) const MAX_COLOR: f32 = 1e4;

impl Lookup<'_> {
    #[inline]
    pub fn color(&self, t: &Texture) -> Rgb {
        t.eval(self.point).min(Rgb::splat(MAX_COLOR))
    }

    #[inline]
    pub fn scalar(&self, t: &Texture) -> f32 {
        t.eval_scalar(self.point)
    }

    pub fn facets(&self, r: &Roughness) -> Microfacet {
        let (u, v) = (self.scalar(&r.alpha_u), self.scalar(&r.alpha_v));
        Microfacet::new(r.distribution, u, v)
    }

    /// An isotropic coat's facets.
    pub fn coat(&self, r: &Roughness) -> Microfacet {
        let alpha = self.scalar(&r.alpha_u);
        Microfacet::new(r.distribution, alpha, alpha)
    }

    /// The table of that coat.
    pub fn coat_table(&self, r: &Roughness, eta: f32) -> &'static RoughTransmittance {
        self.prepared.unwrap_or_else(|| r.coat_table(eta))
    }
}
