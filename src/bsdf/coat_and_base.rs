//! A coat and its base, taken apart.
//!
//! Where a path is far from the eye a material need not be known as a whole. A coat of rough
//! plastic is glossy, its base nearly diffuse: what the base reflects follows from the irradiance,
//! and looks the same from all sides, but for how much of it the coat lets through. So a path may
//! take one of the two by lot, and what is known about diffuse surfaces holds for the base.

use super::transmittance::RoughTransmittance;
use super::{Bsdf, Form};
use crate::math::Vec3;

/// How the radiance that leaves a surface depends on where it goes to: by a factor that is known,
/// whatever falls on it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    normal: Vec3,
    /// None: not at all.
    coat: Option<&'static RoughTransmittance>,
}

impl View {
    /// The factor for a direction away from the surface, on the side from which it is seen; up to
    /// 1.
    #[inline]
    pub fn factor(&self, w: Vec3) -> f32 {
        let coat = self
            .coat
            .map(|coat| coat.entering(self.normal.dot(w).abs()));
        coat.unwrap_or(1.0)
    }
}

impl Bsdf {
    /// Where it is rough plastic, leaves its coat or its base away, by the uniform number that `u`
    /// gives. Returns the factor that what is left is to be multiplied by: one over the probability
    /// that it would be left.
    #[inline]
    pub fn choose_part(&mut self, wo: Vec3, u: impl FnOnce() -> f32) -> Option<f32> {
        let cos = self.frame.n.dot(wo).abs();
        let Form::Tree(tree) = &mut self.form else {
            return None;
        };
        Some(tree.rough_plastic_mut()?.choose_part(cos, u()))
    }

    /// How it looks from different directions on one side, if that is all that tells them apart.
    #[inline]
    pub fn view(&self) -> Option<View> {
        let normal = self.frame.n;
        match &self.form {
            Form::Diffuse(_) => Some(View { normal, coat: None }),
            Form::Tree(tree) => {
                let coat = Some(tree.rough_plastic()?.view()?);
                Some(View { normal, coat })
            }
        }
    }
}
