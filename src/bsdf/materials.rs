//! All materials of a scene, with what is computed once for each.

use super::MaterialId;
use super::facet_albedo::facet_albedo;
use super::fresnel::sane_eta;
use super::material::{Material, Roughness};
use super::transmittance::{RoughTransmittance, rough_transmittance};
use crate::math::{Rgb, luminance};
use crate::texture::{SurfacePoint, Texture};

/// All materials of a scene.
#[derive(Debug, Default)]
pub struct Materials {
    pub(super) list: Vec<Prepared>,
}

/// A material and what never changes about it.
#[derive(Debug)]
pub(super) struct Prepared {
    pub model: Material,
    /// Whether a mask is somewhere inside.
    masked: bool,
    /// Table of its rough coat, if it has one.
    transmittance: Option<&'static RoughTransmittance>,
}

/// The table of a rough coat. A textured roughness shares the one of its mean.
fn coat_table(roughness: &Roughness, eta: f32) -> &'static RoughTransmittance {
    let alpha = &roughness.alpha_u;
    let alpha = luminance(alpha.constant().unwrap_or_else(|| alpha.mean()));
    rough_transmittance(roughness.distribution, alpha, sane_eta(eta))
}

impl Materials {
    /// Adds a material and returns its number. Inner materials must have been added before; one
    /// that was not absorbs all light.
    pub fn push(&mut self, material: Material) -> MaterialId {
        if matches!(material, Material::MetallicRoughness(_)) {
            // Made now, not by the first path that meets it.
            facet_albedo();
        }
        let transmittance = match &material {
            Material::RoughPlastic { eta, roughness, .. }
            | Material::RoughCoating { eta, roughness, .. } => Some(coat_table(roughness, *eta)),
            _ => None,
        };
        let masked = matches!(material, Material::Mask { .. })
            || inner_materials(&material).any(|id| self.is_masked(id));
        self.list.push(Prepared {
            model: material,
            masked,
            transmittance,
        });
        (self.list.len() - 1) as MaterialId
    }

    /// The material `id`.
    pub fn get(&self, id: MaterialId) -> &Material {
        &self.list[id as usize].model
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Opacity of material `id` at a point: below 1 only where a [`Material::Mask`] says so. Both
    /// sides of a two-sided material have the opacity of its front.
    pub fn opacity(&self, id: MaterialId, point: &SurfacePoint) -> f32 {
        let Some(prepared) = self.list.get(id as usize) else {
            return 1.0;
        };
        if !prepared.masked {
            return 1.0;
        }
        // Only materials added before are followed, so this ends.
        let of = |inner: MaterialId| {
            if inner < id {
                self.opacity(inner, point)
            } else {
                1.0
            }
        };
        match &prepared.model {
            Material::Mask { opacity, inner } => {
                opacity.eval_scalar(point).clamp(0.0, 1.0) * of(*inner)
            }
            Material::Blend {
                weight,
                first,
                second,
            } => {
                let w = weight.eval_scalar(point).clamp(0.0, 1.0);
                (1.0 - w) * of(*first) + w * of(*second)
            }
            model => inner_materials(model).next().map_or(1.0, of),
        }
    }

    /// The same as a texture; a blend counts as its first part.
    pub fn opacity_texture(&self, id: MaterialId) -> Texture {
        let Some(prepared) = self.list.get(id as usize).filter(|p| p.masked) else {
            return Texture::Constant(Rgb::ONE);
        };
        let inner = inner_materials(&prepared.model).next().filter(|i| *i < id);
        let inside = inner.map_or(Texture::Constant(Rgb::ONE), |i| self.opacity_texture(i));
        match &prepared.model {
            Material::Mask { opacity, .. } => opacity.clone().times(inside),
            _ => inside,
        }
    }

    /// Whether material `id` needs [`Materials::opacity`] asked at every hit.
    pub fn is_masked(&self, id: MaterialId) -> bool {
        self.list.get(id as usize).is_some_and(|p| p.masked)
    }

    /// The table of `id`'s rough coat.
    pub(super) fn transmittance(&self, id: MaterialId) -> Option<&'static RoughTransmittance> {
        self.list.get(id as usize)?.transmittance
    }
}

/// The materials that a material names.
pub(super) fn inner_materials(material: &Material) -> impl Iterator<Item = MaterialId> + '_ {
    let (pair, parts): ([Option<MaterialId>; 2], &[(f32, MaterialId)]) = match material {
        Material::TwoSided { front, back } => ([Some(*front), Some(*back)], &[]),
        Material::Blend { first, second, .. } => ([Some(*first), Some(*second)], &[]),
        Material::Mixture { parts } => ([None, None], parts),
        Material::Mask { inner, .. }
        | Material::BumpMap { inner, .. }
        | Material::NormalMap { inner, .. }
        | Material::Coating { inner, .. }
        | Material::RoughCoating { inner, .. } => ([Some(*inner), None], &[]),
        _ => ([None, None], &[]),
    };
    let parts = parts.iter().map(|p| p.1);
    pair.into_iter().flatten().chain(parts)
}
