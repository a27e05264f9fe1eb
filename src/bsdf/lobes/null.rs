//! Nothing at all.

use super::{Lobe, NULL_TRANSMISSION, weighted};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// Nothing: an index-matched surface.
#[derive(Clone, Debug)]
pub struct Null;

impl Model for Null {
    type Lobe = NullLobe;

    fn read(_: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self)
    }

    fn lobe(&self, _: &Lookup) -> NullLobe {
        NullLobe
    }

    fn textures(&self) -> Textures<'_> {
        Textures::default()
    }

    fn scatters(&self) -> bool {
        false
    }

    fn transmits(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        vec![("null", Self)]
    }
}

/// An index-matched surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct NullLobe;

impl Lobe for NullLobe {
    fn sample(&self, wo: Vec3, _: f32, _: Vec2, _: Transport) -> Option<BsdfSample> {
        weighted(-wo, Rgb::ONE, 1.0, 1.0, NULL_TRANSMISSION)
    }

    fn flags(&self) -> LobeFlags {
        NULL_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        Rgb::ONE
    }
}
