//! The parameters of a material in a scene file, asked for by name.

use super::fresnel::sane_eta;
use super::measured::MeasuredBrdf;
use super::microfacet::Distribution;
use super::transmittance::{RoughTransmittance, rough_transmittance};
use crate::math::{Rgb, luminance};
use crate::texture::Texture;

/// A material in a scene file. Names are those of Mitsuba 3; a parameter that is not given, or that
/// cannot be used, has its default.
pub(crate) trait Parameters {
    /// A factor on scattered light: each channel in `[0, 1]`.
    fn reflectance(&mut self, name: &'static str, default: f32) -> Texture;

    /// Any number that a scene may texture.
    fn number(&mut self, name: &'static str, default: f32) -> Texture;

    /// A number.
    fn float(&self, name: &'static str, default: f32) -> f32;

    /// A yes or no.
    fn boolean(&self, name: &'static str, default: bool) -> bool;

    /// One of a few words, by its place among them; `None` if it is not given.
    fn choice(&self, name: &'static str, words: &[&str]) -> Option<usize>;

    /// The first of several names for one thing that is given, or the first name.
    fn either(&self, names: &[&'static str]) -> &'static str;

    /// Parameters that mean something to Mitsuba and nothing to this renderer.
    fn ignore(&self, names: &[&'static str]);

    /// `alpha` for both, or `alpha_u` and `alpha_v`.
    fn alphas(&mut self) -> [Texture; 2];

    /// `distribution` and the alphas.
    fn roughness(&mut self) -> Roughness;

    /// `int_ior` over `ext_ior`; by default those of a material known by name and of air.
    fn relative_ior(&mut self, inside: &'static str) -> f32;

    /// `eta` and `k` of the conductor `material`, or as they are given, over `ext_eta`.
    fn conductor_ior(&mut self) -> [Texture; 2];

    /// `eta`, or the reflectance `specular` that Burley's models have in its place.
    fn principled_ior(&self) -> Result<f32, String>;

    /// The measured material in the file that a parameter names.
    fn measured(&mut self, name: &'static str) -> Result<&'static MeasuredBrdf, String>;
}

/// Roughness of a microfacet surface.
#[derive(Clone, Debug)]
pub struct Roughness {
    /// Normal distribution.
    pub distribution: Distribution,
    /// Roughness along the tangent, > 0.
    pub alpha_u: Texture,
    /// Roughness along the bitangent, > 0.
    pub alpha_v: Texture,
}

impl Roughness {
    /// Whether it may differ along tangent and bitangent.
    pub(super) fn is_anisotropic(&self) -> bool {
        differ(&self.alpha_u, &self.alpha_v)
    }

    /// The table of a coat of this roughness. A textured one shares the table of its mean.
    pub(super) fn coat_table(&self, eta: f32) -> &'static RoughTransmittance {
        let alpha = &self.alpha_u;
        let alpha = luminance(alpha.constant().unwrap_or_else(|| alpha.mean()));
        rough_transmittance(self.distribution, alpha, sane_eta(eta))
    }
}

/// Whether two textures may differ somewhere.
pub(super) fn differ(a: &Texture, b: &Texture) -> bool {
    match (a.constant(), b.constant()) {
        (Some(a), Some(b)) => a != b,
        _ => true,
    }
}

/// A factor of 1 on everything: the default of most reflectances.
pub fn white() -> Texture {
    Texture::Constant(Rgb::ONE)
}
