//! The body of a material: transmission, sheen, and the model that has them.

use super::Importer;
use super::extension::Extension;
use super::materials::{Core, Metal, Variant};
use super::schema;
use super::textures::{Use, uv_set};
use super::volume;
use crate::bsdf::material::{MetallicRoughness, Principled, PrincipledThin};
use crate::bsdf::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::Texture;

fn number(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

impl Importer<'_> {
    /// What lies under a coat, and whether light passes through it.
    pub(super) fn body(
        &mut self,
        material: &schema::Material,
        core: Core,
        variant: Variant,
        of: &str,
    ) -> Result<(MaterialId, bool), ImportError> {
        let (body, transmits) = self.bare(material, core, variant, of)?;
        Ok((self.under_sheen(material, body, of)?, transmits))
    }

    /// The same without a sheen.
    fn bare(
        &mut self,
        material: &schema::Material,
        core: Core,
        variant: Variant,
        of: &str,
    ) -> Result<(MaterialId, bool), ImportError> {
        let extension = Extension::of(&material.extensions, "KHR_materials_transmission");
        let factor = extension.map_or(0.0, |e| e.number("transmissionFactor", 0.0));
        let factor = self.fraction(&format!("{of}: transmissionFactor"), factor);
        let clear = extension.filter(|_| factor > 0.0);
        let Some(extension) = clear else {
            return self.opaque(material, &core, variant, of);
        };
        self.tell_of_reflection(material, &format!("{of} lets light through"));
        let info = extension.texture("transmissionTexture");
        let share = self.textured(info.as_ref(), Use::Channel(0), Rgb::splat(factor))?;
        if volume::thickness(material) > 0.0 {
            let body = principled(&core, share);
            return Ok((self.push(body), true));
        }
        let thin = self.push(thin(&core, share));
        let metallic = core.metallic.clone();
        if metallic.constant() == Some(Rgb::ZERO) {
            return Ok((thin, true));
        }
        let metal = self.push(principled(&core, number(0.0)));
        let metal = self.push(Material::TwoSided {
            front: metal,
            back: metal,
        });
        let blend = Material::Blend {
            weight: metallic,
            first: thin,
            second: metal,
        };
        Ok((self.push(blend), true))
    }

    /// The model of what is opaque, but for a base that may let diffuse light through.
    fn opaque(
        &mut self,
        material: &schema::Material,
        core: &Core,
        variant: Variant,
        of: &str,
    ) -> Result<(MaterialId, bool), ImportError> {
        let model = MetallicRoughness {
            specular: core.specular.clone(),
            specular_color: core.specular_color.clone(),
            anisotropy: self.anisotropy(material, variant.mirrored, of)?,
            film: self.film(material, of)?,
            transmission: self.diffuse_transmission(material, of)?,
            ..MetallicRoughness::plain(
                core.color.clone(),
                core.metallic.clone(),
                core.roughness.clone(),
                core.ior,
            )
        };
        let transmits = model.transmission.is_some();
        let base = self.push(model);
        Ok((self.beside_metal(base, core), transmits))
    }

    /// `base`, of which a metal takes its share.
    fn beside_metal(&mut self, base: MaterialId, core: &Core) -> MaterialId {
        let Some(Metal { share, color }) = &core.metal else {
            return base;
        };
        let metal = self.push(MetallicRoughness::plain(
            color.clone(),
            number(1.0),
            core.roughness.clone(),
            1.5,
        ));
        if share.constant() == Some(Rgb::ONE) {
            return metal;
        }
        self.push(Material::Blend {
            weight: share.clone(),
            first: base,
            second: metal,
        })
    }

    /// `inner` under a sheen, if there is one.
    fn under_sheen(
        &mut self,
        material: &schema::Material,
        inner: MaterialId,
        of: &str,
    ) -> Result<MaterialId, ImportError> {
        let Some(sheen) = Extension::of(&material.extensions, "KHR_materials_sheen") else {
            return Ok(inner);
        };
        let color = sheen.color("sheenColorFactor", Rgb::ZERO);
        let color = self.tint(&format!("{of}: sheenColorFactor"), color);
        if color == Rgb::ZERO {
            return Ok(inner);
        }
        let roughness = sheen.number("sheenRoughnessFactor", 0.0);
        let roughness = self.fraction(&format!("{of}: sheenRoughnessFactor"), roughness);
        let (colors, map) = (
            sheen.texture("sheenColorTexture"),
            sheen.texture("sheenRoughnessTexture"),
        );
        let color = self.textured(colors.as_ref(), Use::Color, color)?;
        let roughness = self.textured(map.as_ref(), Use::Channel(3), Rgb::splat(roughness))?;
        Ok(self.push(Material::Sheen {
            color,
            roughness,
            inner,
        }))
    }

    /// Warns of what a material asks for and does not get.
    pub(super) fn tell_what_is_left_out(&mut self, material: &schema::Material) {
        if Extension::of(&material.extensions, "KHR_materials_dispersion").is_some() {
            let of = super::materials::name_of(material, None);
            self.warn(format!(
                "{of}: KHR_materials_dispersion is left out: light of all colours is bent alike"
            ));
        }
        let set = super::materials::coordinates(material);
        let others = super::materials::all_textures(material);
        if others.iter().any(|info| uv_set(info) != set) {
            let name = material.name.as_deref().unwrap_or("without a name");
            self.warn(format!(
                "material {name}: its textures use different texture coordinates; all take TEXCOORD_{set}"
            ));
        }
    }
}

fn principled(core: &Core, spec_trans: Texture) -> Material {
    Material::from(Principled {
        base_color: core.color.clone(),
        roughness: core.roughness.clone(),
        anisotropic: number(0.0),
        metallic: core.metallic.clone(),
        spec_trans,
        eta: core.ior,
        spec_tint: number(0.0),
        sheen: number(0.0),
        sheen_tint: number(0.0),
        flatness: number(0.0),
        clearcoat: number(0.0),
        clearcoat_gloss: number(0.0),
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
        diffuse_reflectance_sampling_rate: 1.0,
    })
}

fn thin(core: &Core, spec_trans: Texture) -> Material {
    Material::from(PrincipledThin {
        base_color: core.color.clone(),
        roughness: core.roughness.clone(),
        anisotropic: number(0.0),
        spec_trans,
        eta: number(core.ior),
        spec_tint: number(0.0),
        sheen: number(0.0),
        sheen_tint: number(0.0),
        flatness: number(0.0),
        diff_trans: number(0.0),
    })
}
