//! Texture coordinates of faces' corners, as MeshLab writes them: a vertex for each pair of a vertex
//! and coordinates.

use crate::math::{Vec2, Vec3};
use crate::scene::import::mesh::Raw;
use rustc_hash::FxHashMap;

/// Divides the vertices of `raw` so that each has coordinates of its own: those that the corners
/// `uvs`, as many as `indices`, give it.
pub(super) fn divide(raw: &mut Raw, indices: &mut [u32], uvs: &[Vec2]) {
    let mut known: FxHashMap<(u32, [u32; 2]), u32> = FxHashMap::default();
    let mut made: Vec<(u32, Vec2)> = Vec::new();
    for (index, uv) in indices.iter_mut().zip(uvs) {
        let key = (*index, uv.to_array().map(f32::to_bits));
        *index = *known.entry(key).or_insert_with(|| {
            made.push((key.0, *uv));
            (made.len() - 1) as u32
        });
    }
    let pick = |from: &[Vec3]| -> Vec<Vec3> {
        // One more than needed: `TriangleMesh::new` asks for spare room behind the last position.
        let mut values = Vec::with_capacity(made.len() + 1);
        values.extend(made.iter().map(|(vertex, _)| from[*vertex as usize]));
        values
    };
    raw.positions = pick(&raw.positions);
    raw.normals = raw.normals.as_deref().map(pick);
    for attribute in raw.attributes.iter_mut().filter(|a| !a.per_face) {
        attribute.values = pick(&attribute.values);
    }
    raw.uvs = Some(made.iter().map(|(_, uv)| *uv).collect());
}
