//! What a material asks of the surface it lies on, so that nothing else is computed.

use super::materials::inner_materials;
use super::{Material, MaterialId, Materials};
use crate::texture::{Reads, Texture};

impl Materials {
    /// Whether material `id` reads tangents: it has a texture (whose level depends on the
    /// footprint), is anisotropic, or turns the normal.
    pub fn needs_tangents(&self, id: MaterialId) -> bool {
        self.any(id, &|m| {
            let turns = matches!(m, Material::BumpMap { .. } | Material::NormalMap { .. });
            turns || is_anisotropic(m) || textures(m).iter().any(|t| t.constant().is_none())
        })
    }

    /// Whether material `id` reads how the normal changes: only bump maps do.
    pub fn needs_normal_change(&self, id: MaterialId) -> bool {
        self.any(id, &|m| matches!(m, Material::BumpMap { .. }))
    }

    /// Whether material `id` scatters to more than a few discrete directions somewhere: a field has
    /// nothing to learn from mirrors, clear glass and what is black.
    pub fn scatters(&self, id: MaterialId) -> bool {
        self.any(id, &|m| {
            let passes_on =
                inner_materials(m).next().is_some() && !matches!(m, Material::RoughCoating { .. });
            let discrete = matches!(
                m,
                Material::Dielectric { .. }
                    | Material::ThinDielectric { .. }
                    | Material::Conductor { .. }
                    | Material::Null
            );
            let dark = matches!(m, Material::Diffuse { reflectance }
                if reflectance.constant() == Some(crate::math::Rgb::ZERO));
            !passes_on && !discrete && !dark
        })
    }

    /// Adds what material `id` reads of a mesh.
    pub fn add_reads(&self, id: MaterialId, reads: &mut Reads) {
        let Some(material) = self.list.get(id as usize).map(|p| &p.model) else {
            return;
        };
        // Tangents follow the texture coordinates.
        let turns = matches!(
            material,
            Material::BumpMap { .. } | Material::NormalMap { .. }
        );
        reads.uvs |= turns || is_anisotropic(material);
        for texture in textures(material) {
            texture.add_reads(reads);
        }
        for inner in inner_materials(material).filter(|i| *i < id) {
            self.add_reads(inner, reads);
        }
    }

    /// Whether `test` holds for material `id` or one inside it. Only materials added before
    /// are followed, so this ends.
    pub(crate) fn any(&self, id: MaterialId, test: &dyn Fn(&Material) -> bool) -> bool {
        let Some(material) = self.list.get(id as usize).map(|p| &p.model) else {
            return false;
        };
        test(material) || inner_materials(material).any(|i| i < id && self.any(i, test))
    }
}

fn is_anisotropic(material: &Material) -> bool {
    let differ = |u: &Texture, v: &Texture| match (u.constant(), v.constant()) {
        (Some(u), Some(v)) => u != v,
        _ => true,
    };
    match material {
        Material::RoughConductor { roughness, .. }
        | Material::RoughDielectric { roughness, .. } => {
            differ(&roughness.alpha_u, &roughness.alpha_v)
        }
        Material::Ward {
            alpha_u, alpha_v, ..
        } => differ(alpha_u, alpha_v),
        Material::Principled(p) => p.anisotropic.constant() != Some(crate::math::Rgb::ZERO),
        Material::PrincipledThin(p) => p.anisotropic.constant() != Some(crate::math::Rgb::ZERO),
        _ => false,
    }
}

/// The textures a material itself looks up, without those of inner materials.
pub(super) fn textures(material: &Material) -> Vec<&Texture> {
    match material {
        Material::Diffuse { reflectance } => vec![reflectance],
        Material::RoughDiffuse {
            reflectance, alpha, ..
        } => vec![reflectance, alpha],
        Material::Dielectric {
            specular_reflectance,
            specular_transmittance,
            ..
        }
        | Material::ThinDielectric {
            specular_reflectance,
            specular_transmittance,
            ..
        } => {
            vec![specular_reflectance, specular_transmittance]
        }
        Material::RoughDielectric {
            roughness,
            specular_reflectance,
            specular_transmittance,
            ..
        } => vec![
            &roughness.alpha_u,
            &roughness.alpha_v,
            specular_reflectance,
            specular_transmittance,
        ],
        Material::Conductor {
            eta,
            k,
            specular_reflectance,
        } => vec![eta, k, specular_reflectance],
        Material::RoughConductor {
            eta,
            k,
            roughness,
            specular_reflectance,
        } => {
            vec![
                eta,
                k,
                &roughness.alpha_u,
                &roughness.alpha_v,
                specular_reflectance,
            ]
        }
        Material::Plastic {
            diffuse_reflectance,
            specular_reflectance,
            ..
        } => {
            vec![diffuse_reflectance, specular_reflectance]
        }
        Material::RoughPlastic {
            roughness,
            diffuse_reflectance,
            specular_reflectance,
            ..
        } => {
            vec![
                &roughness.alpha_u,
                diffuse_reflectance,
                specular_reflectance,
            ]
        }
        Material::Phong {
            diffuse_reflectance,
            specular_reflectance,
            exponent,
        } => {
            vec![diffuse_reflectance, specular_reflectance, exponent]
        }
        Material::Ward {
            diffuse_reflectance,
            specular_reflectance,
            alpha_u,
            alpha_v,
            ..
        } => {
            vec![diffuse_reflectance, specular_reflectance, alpha_u, alpha_v]
        }
        Material::MetallicRoughness(m) => vec![&m.base_color, &m.metallic, &m.roughness],
        Material::Principled(p) => vec![
            &p.base_color,
            &p.roughness,
            &p.anisotropic,
            &p.metallic,
            &p.spec_trans,
            &p.spec_tint,
            &p.sheen,
            &p.sheen_tint,
            &p.flatness,
            &p.clearcoat,
            &p.clearcoat_gloss,
        ],
        Material::PrincipledThin(p) => vec![
            &p.base_color,
            &p.roughness,
            &p.anisotropic,
            &p.spec_trans,
            &p.eta,
            &p.spec_tint,
            &p.sheen,
            &p.sheen_tint,
            &p.flatness,
            &p.diff_trans,
        ],
        Material::DiffuseTransmitter { transmittance } => vec![transmittance],
        Material::Mask { opacity, .. } => vec![opacity],
        Material::BumpMap { displacement, .. } => vec![displacement],
        Material::NormalMap { normals, .. } => vec![normals],
        Material::Blend { weight, .. } => vec![weight],
        Material::Coating {
            sigma_a,
            specular_reflectance,
            ..
        } => vec![sigma_a, specular_reflectance],
        Material::RoughCoating {
            roughness,
            sigma_a,
            specular_reflectance,
            ..
        } => {
            vec![&roughness.alpha_u, sigma_a, specular_reflectance]
        }
        Material::Null | Material::TwoSided { .. } | Material::Mixture { .. } => Vec::new(),
    }
}
