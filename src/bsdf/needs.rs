//! What a material asks of the surface it lies on, so that nothing else is computed.

use super::{Material, MaterialId, Materials};
use crate::texture::Reads;

impl Materials {
    /// Whether material `id` reads tangents: it has a texture (whose level depends on the
    /// footprint), is anisotropic, or turns the normal.
    pub fn needs_tangents(&self, id: MaterialId) -> bool {
        self.any(id, &|m| {
            follows_tangents(m) || m.textures().all().any(|t| t.constant().is_none())
        })
    }

    /// Whether material `id` reads how the normal changes: only bump maps do.
    pub fn needs_normal_change(&self, id: MaterialId) -> bool {
        self.any(id, &|m| matches!(m, Material::BumpMap { .. }))
    }

    /// Whether material `id` scatters to more than a few discrete directions somewhere: a field has
    /// nothing to learn from mirrors, clear glass and what is black.
    pub fn scatters(&self, id: MaterialId) -> bool {
        self.any(id, &|m| match m.model() {
            Some(model) => model.scatters(),
            None => {
                matches!(
                    m,
                    Material::RoughCoating { .. }
                        | Material::ClearCoat { .. }
                        | Material::Sheen { .. }
                ) || m.inner().next().is_none()
            }
        })
    }

    /// Whether light may come by way of material `id` that next-event estimation does not find.
    pub fn casts_caustics(&self, id: MaterialId) -> bool {
        self.any(id, &|m| {
            m.model().is_some_and(|model| model.casts_caustics())
        })
    }

    /// Adds what material `id` reads of a mesh.
    pub fn add_reads(&self, id: MaterialId, reads: &mut Reads) {
        let Some(material) = self.list.get(id as usize).map(|p| &p.material) else {
            return;
        };
        // Tangents follow the texture coordinates.
        reads.uvs |= follows_tangents(material);
        for texture in material.textures().all() {
            texture.add_reads(reads);
        }
        for inner in material.inner().filter(|i| *i < id) {
            self.add_reads(inner, reads);
        }
    }

    /// Whether `test` holds for material `id` or one inside it. Only materials added before
    /// are followed, so this ends.
    pub(crate) fn any(&self, id: MaterialId, test: &dyn Fn(&Material) -> bool) -> bool {
        let Some(material) = self.list.get(id as usize).map(|p| &p.material) else {
            return false;
        };
        test(material) || material.inner().any(|i| i < id && self.any(i, test))
    }
}

/// Whether the tangents decide what the material itself does.
fn follows_tangents(material: &Material) -> bool {
    material.turns_normal() || material.model().is_some_and(|m| m.is_anisotropic())
}
