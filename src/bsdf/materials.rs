//! All materials of a scene, with what is computed once for each.

use super::MaterialId;
use super::material::Material;
use super::transmittance::RoughTransmittance;
use crate::math::Rgb;
use crate::texture::{SurfacePoint, Texture};
use std::collections::HashMap;

/// All materials of a scene.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    pub(super) list: Vec<Prepared>,
    /// What the scene calls them, those that it has a name for.
    names: HashMap<MaterialId, String>,
}

/// A material and what never changes about it.
#[derive(Clone, Debug)]
pub(super) struct Prepared {
    pub material: Material,
    /// Whether a mask is somewhere inside.
    masked: bool,
    /// Table of its rough coat, if it has one.
    pub coat_table: Option<&'static RoughTransmittance>,
}

impl Materials {
    /// Adds a material and returns its number. Inner materials must have been added before; one
    /// that was not absorbs all light.
    pub fn push(&mut self, material: impl Into<Material>) -> MaterialId {
        let material = material.into();
        let masked = matches!(material, Material::Mask { .. })
            || material.inner().any(|id| self.is_masked(id));
        self.list.push(Prepared {
            coat_table: material.prepare(),
            masked,
            material,
        });
        (self.list.len() - 1) as MaterialId
    }

    /// The material `id`.
    pub fn get(&self, id: MaterialId) -> &Material {
        &self.list[id as usize].material
    }

    /// Gives material `id` the name that the scene has for it.
    pub fn set_name(&mut self, id: MaterialId, name: impl Into<String>) {
        self.names.insert(id, name.into());
    }

    /// What the scene calls material `id`; by its model and number if it has no name.
    pub fn name(&self, id: MaterialId) -> String {
        let given = self.names.get(&id).cloned();
        given.unwrap_or_else(|| format!("{}.{id}", self.get(id).name()))
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
        match &prepared.material {
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
            material => material.inner().next().map_or(1.0, of),
        }
    }

    /// The same as a texture; a blend counts as its first part.
    pub fn opacity_texture(&self, id: MaterialId) -> Texture {
        let Some(prepared) = self.list.get(id as usize).filter(|p| p.masked) else {
            return Texture::Constant(Rgb::ONE);
        };
        let inner = prepared.material.inner().next().filter(|i| *i < id);
        let inside = inner.map_or(Texture::Constant(Rgb::ONE), |i| self.opacity_texture(i));
        match &prepared.material {
            Material::Mask { opacity, .. } => opacity.clone().times(inside),
            _ => inside,
        }
    }

    /// Whether material `id` lets all light straight through: an index-matched surface.
    pub fn is_null(&self, id: MaterialId) -> bool {
        let material = self.list.get(id as usize).map(|p| &p.material);
        matches!(material, Some(Material::Null(_)))
    }

    /// Whether material `id` needs [`Materials::opacity`] asked at every hit.
    pub fn is_masked(&self, id: MaterialId) -> bool {
        self.list.get(id as usize).is_some_and(|p| p.masked)
    }
}
