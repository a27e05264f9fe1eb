//! The clear coat around a material (`KHR_materials_clearcoat`).

use super::Importer;
use super::extension::Extension;
use super::layers::number;
use super::schema;
use super::textures::Use;
use crate::bsdf::material::{Distribution, Roughness, white};
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;

/// Index of refraction of clear coats: KHR_materials_clearcoat fixes it.
const COAT_IOR: f32 = 1.5;
/// Narrowest facets of a rough coat; smoother ones are taken as smooth.
const SMOOTH: f32 = 1e-3;

impl Importer<'_> {
    /// `inner` under the clear coat, if there is one.
    pub(super) fn coated(
        &mut self,
        material: &schema::Material,
        inner: MaterialId,
        of: &str,
    ) -> Result<MaterialId, ImportError> {
        let coat = Extension::of(&material.extensions, "KHR_materials_clearcoat");
        let factor = coat.map_or(0.0, |c| c.number("clearcoatFactor", 0.0));
        let factor = self.fraction(&format!("{of}: clearcoatFactor"), factor);
        let Some(coat) = coat.filter(|_| factor > 0.0) else {
            return Ok(inner);
        };
        let roughness = coat.number("clearcoatRoughnessFactor", 0.0);
        let roughness = self.fraction(&format!("{of}: clearcoatRoughnessFactor"), roughness);
        let info = coat.texture("clearcoatRoughnessTexture");
        let roughness = self.textured(info.as_ref(), Use::Channel(1), Rgb::splat(roughness))?;
        if coat.texture("clearcoatNormalTexture").is_some() {
            self.warn(format!(
                "{of}: clearcoatNormalTexture is left out: the coat has the normals of what it covers"
            ));
        }
        // The facets' width is the square of the roughness.
        let coated = self.push(coating(roughness.clone().times(roughness), inner));
        let info = coat.texture("clearcoatTexture");
        let weight = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        if weight.constant() == Some(Rgb::ONE) {
            return Ok(coated);
        }
        Ok(self.push(Material::Blend {
            weight,
            first: inner,
            second: coated,
        }))
    }
}

fn coating(alpha: Texture, inner: MaterialId) -> Material {
    let (sigma_a, specular_reflectance) = (number(0.0), white());
    if alpha.constant().is_some_and(|a| a.x < SMOOTH) {
        return Material::Coating {
            eta: COAT_IOR,
            thickness: 0.0,
            sigma_a,
            specular_reflectance,
            inner,
        };
    }
    Material::RoughCoating {
        eta: COAT_IOR,
        roughness: Roughness {
            distribution: Distribution::Ggx,
            alpha_u: alpha.clone(),
            alpha_v: alpha,
        },
        thickness: 0.0,
        sigma_a,
        specular_reflectance,
        inner,
    }
}
