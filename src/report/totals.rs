//! Totals of a scene: triangles, meshes, images and their memory.

use crate::scene::{Description, Geometry, Mesh};
use std::collections::HashSet;
use std::sync::Arc;

/// Images that the textures of a scene were made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureTotals {
    /// How many.
    pub count: usize,
    /// Memory of texels, bytes.
    pub bytes: u64,
}

/// Triangles of all meshes, those of groups once.
pub fn triangles(description: &Description) -> u64 {
    let meshes = meshes_of(description);
    meshes
        .iter()
        .map(|m| m.triangles.triangles().len() as u64)
        .sum()
}

/// Memory of all meshes, bytes.
pub fn geometry_bytes(description: &Description) -> u64 {
    meshes_of(description).iter().map(|m| mesh_bytes(m)).sum()
}

/// Triangles in the world: those of a group as often as it stands there.
pub(super) fn triangles_placed(description: &Description) -> u64 {
    let mut placements = vec![0u64; description.groups as usize];
    for (group, _) in &description.instances {
        if let Some(count) = placements.get_mut(*group as usize) {
            *count += 1;
        }
    }
    let shapes = description.shapes.iter();
    shapes
        .map(|shape| {
            let Geometry::Mesh(mesh) = &shape.geometry else {
                return 0;
            };
            let placed = shape.group.map_or(1, |g| {
                placements.get(g as usize).copied().unwrap_or_default()
            });
            placed * mesh.triangles.triangles().len() as u64
        })
        .sum()
}

/// The meshes, each once even where shapes share it.
pub(super) fn meshes_of(description: &Description) -> Vec<&Arc<Mesh>> {
    let mut seen = HashSet::new();
    let shapes = description.shapes.iter();
    shapes
        .filter_map(|shape| match &shape.geometry {
            Geometry::Mesh(mesh) => Some(mesh),
            Geometry::Analytic(_) => None,
        })
        .filter(|mesh| seen.insert(Arc::as_ptr(mesh)))
        .collect()
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let normals = mesh.normals.as_ref().map_or(0, |n| n.len() * 12);
    let uvs = mesh.uvs.as_ref().map_or(0, |uv| uv.len() * 8);
    let attributes: usize = mesh
        .attributes
        .list
        .iter()
        .map(|a| a.values.len() * 12)
        .sum();
    (mesh.triangles.memory_bytes() + normals + uvs + attributes) as u64
}
