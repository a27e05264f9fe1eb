//! A mesh cut into several by what its triangles belong to.

use crate::accel::TriangleMesh;
use crate::scene::description::Mesh;
use crate::texture::{MeshAttribute, MeshAttributes};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Cuts a mesh: triangles with the same key stay together, in their order. The parts come in the
/// order of their keys; each keeps the vertices that it uses. A mesh with one key stays as it is.
pub fn split(mesh: Mesh, key: impl Fn(usize) -> u32) -> Vec<(u32, Mesh)> {
    let triangles = mesh.triangles.clone();
    let mut parts: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for i in 0..triangles.triangles().len() {
        parts.entry(key(i)).or_default().push(i);
    }
    match parts.first_key_value() {
        None => vec![(0, mesh)],
        Some((&key, _)) if parts.len() == 1 => vec![(key, mesh)],
        Some(_) => parts
            .into_iter()
            .map(|(key, list)| (key, part(&mesh, &list)))
            .collect(),
    }
}

/// The mesh of some triangles.
fn part(mesh: &Mesh, list: &[usize]) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let (positions, all) = (mesh.triangles.positions(), mesh.triangles.triangles());
    let mut number = vec![UNUSED; positions.len()];
    let mut used: Vec<usize> = Vec::new();
    let mut renumber = |old: u32| {
        let slot = &mut number[old as usize];
        if *slot == UNUSED {
            *slot = used.len() as u32;
            used.push(old as usize);
        }
        *slot
    };
    let triangles: Vec<[u32; 3]> = list.iter().map(|&i| all[i].map(&mut renumber)).collect();
    let attribute = |a: &MeshAttribute| MeshAttribute {
        name: a.name.clone(),
        per_face: a.per_face,
        values: pick(&a.values, if a.per_face { list } else { &used }),
    };
    let triangles = TriangleMesh::new(pick(positions, &used), triangles);
    Mesh {
        // Every number was given out for a position that was picked.
        triangles: Arc::new(triangles.unwrap_or_default()),
        normals: mesh.normals.as_ref().map(|n| pick(n, &used)),
        tangents: mesh.tangents.as_ref().map(|t| pick(t, &used)),
        uvs: mesh.uvs.as_ref().map(|uvs| Arc::new(pick(uvs, &used))),
        attributes: MeshAttributes {
            list: mesh.attributes.list.iter().map(attribute).collect(),
        },
    }
}

fn pick<T: Copy>(from: &[T], which: &[usize]) -> Vec<T> {
    which.iter().map(|&i| from[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rgb, Vec3};

    #[test]
    fn parts_keep_their_triangles_and_only_their_vertices() {
        let positions: Vec<Vec3> = (0..5)
            .map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0))
            .collect();
        let triangles = vec![[0, 1, 2], [2, 3, 4], [1, 2, 3]];
        let faces = MeshAttribute {
            name: "face_n".into(),
            per_face: true,
            values: (0..3).map(|i| Rgb::splat(i as f32)).collect(),
        };
        let mesh = Mesh {
            triangles: Arc::new(TriangleMesh::new(positions.clone(), triangles.clone()).unwrap()),
            normals: Some(positions.clone()),
            tangents: None,
            uvs: None,
            attributes: MeshAttributes { list: vec![faces] },
        };
        let parts = split(mesh, |i| [7, 3, 7][i]);
        let expected: [(u32, &[usize], usize); 2] = [(3, &[1], 3), (7, &[0, 2], 4)];
        assert_eq!(parts.len(), 2);
        for ((key, mesh), (wanted, list, vertices)) in parts.iter().zip(expected) {
            assert_eq!((*key, mesh.triangles.positions().len()), (wanted, vertices));
            for (n, &old) in list.iter().enumerate() {
                let corners = triangles[old].map(|i| positions[i as usize]);
                assert_eq!(mesh.triangles.corners(n as u32), corners);
                assert_eq!(mesh.attributes.list[0].values[n], Rgb::splat(old as f32));
            }
            assert_eq!(mesh.normals.as_deref(), Some(mesh.triangles.positions()));
        }
    }
}
