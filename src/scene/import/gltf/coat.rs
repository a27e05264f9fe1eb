//! The clear coat around a material (`KHR_materials_clearcoat`).

use super::Importer;
use super::extension::Extension;
use super::layers::number;
use super::schema::{self, TextureInfo};
use super::textures::{Use, bent_normals};
use crate::bsdf::material::{Distribution, InvalidNormals, Roughness, white};
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;

/// Index of refraction of clear coats: KHR_materials_clearcoat fixes it.
const COAT_IOR: f32 = 1.5;
/// Narrowest facets of a rough coat; smoother ones are taken as smooth.
const SMOOTH: f32 = 1e-3;

impl Importer<'_> {
    /// `base` with the normals of its map, under the clear coat if there is one, which has normals
    /// of its own or those of the surface.
    pub(super) fn layered(
        &mut self,
        material: &schema::Material,
        base: MaterialId,
        mirrored: bool,
        of: &str,
    ) -> Result<MaterialId, ImportError> {
        let coat = Extension::of(&material.extensions, "KHR_materials_clearcoat");
        let coat = coat.filter(|c| c.number("clearcoatFactor", 0.0) > 0.0);
        let own = material.normal_texture.as_ref();
        let Some(coat) = coat else {
            return self.bent(base, own, mirrored);
        };
        let outer = coat.texture("clearcoatNormalTexture");
        let of_map = |info: &TextureInfo| (info.index, info.scale.map(f32::to_bits));
        if outer.is_some() && outer.as_ref().map(of_map) == own.map(of_map) {
            let coated = self.coated(material, base, of)?;
            return self.bent(coated, own, mirrored);
        }
        if outer.is_some() {
            self.warn(format!(
                "{of}: clearcoatNormalTexture bends what the coat covers as well"
            ));
        }
        let inner = self.bent(base, own, mirrored)?;
        let coated = self.coated(material, inner, of)?;
        self.bent(coated, outer.as_ref(), mirrored)
    }

    /// A material with the normals of a map, if there is one.
    fn bent(
        &mut self,
        inner: MaterialId,
        map: Option<&TextureInfo>,
        mirrored: bool,
    ) -> Result<MaterialId, ImportError> {
        let normals = match map {
            Some(info) => self.texture(info, Use::Vector)?,
            None => None,
        };
        let Some(normals) = normals else {
            return Ok(inner);
        };
        let scale = map.and_then(|info| info.scale).unwrap_or(1.0);
        Ok(self.push(Material::NormalMap {
            normals: bent_normals(normals, scale, mirrored),
            invalid_normals: InvalidNormals::default(),
            inner,
        }))
    }

    /// `inner` under the clear coat, if there is one.
    fn coated(
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
