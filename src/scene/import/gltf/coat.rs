//! The clear coat around a material (`KHR_materials_clearcoat`).

use super::Importer;
use super::extension::Extension;
use super::schema::{self, TextureInfo};
use super::textures::{Use, bent_normals};
use crate::bsdf::material::InvalidNormals;
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;

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
        let info = coat.texture("clearcoatTexture");
        let weight = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        Ok(self.push(Material::ClearCoat {
            weight,
            roughness,
            inner,
        }))
    }
}
