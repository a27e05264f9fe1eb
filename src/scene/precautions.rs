//! What is done against rounding in a scene: each precaution, whether it is on, and why.
//!
//! Most are on in every scene, because no scene tells beforehand that it can do without. One is
//! not: tests of edges that no ray slips through (Embree's "robust" mode) slow all rays down. A ray
//! that slips through an edge of a sheet shows what is behind, a millionth of the light; one that
//! slips out of a closed body, or out of glass, goes on where no path can be. So they are on where
//! a mesh is closed or refracts, which is decided here from the scene. `tests/bench/precautions.py`
//! measures what each costs.

use super::description::{Description, Geometry};
use crate::accel::TriangleMesh;
use crate::bsdf::Material;
use crate::math::Vec3;
use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

/// A precaution and what was decided about it.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Precaution {
    /// What is done.
    pub name: &'static str,
    /// Whether it is.
    pub on: bool,
    /// Why, in words.
    pub why: String,
}

/// The precaution against rays that slip through the edges of meshes.
pub fn watertight_edges(description: &Description) -> Precaution {
    let found = description.shapes.par_iter().find_map_first(|shape| {
        let Geometry::Mesh(mesh) = &shape.geometry else {
            return None;
        };
        let name = &shape.name;
        if description
            .materials
            .any(shape.material, &Material::refracts)
        {
            return Some(format!("the mesh {name} refracts"));
        }
        is_closed(&mesh.triangles).then(|| format!("the mesh {name} is closed"))
    });
    Precaution {
        name: "watertight edges",
        on: found.is_some(),
        why: found.unwrap_or_else(|| "no mesh is closed or refracts".into()),
    }
}

/// All precautions for a scene, in the order in which they are printed.
pub fn precautions(description: &Description) -> Vec<Precaution> {
    let always = |name, why: &str| Precaution {
        name,
        on: true,
        why: why.into(),
    };
    let moved = description.origin != crate::math::DVec3::ZERO;
    let centred = Precaution {
        name: "moved to the origin",
        on: moved,
        why: if moved {
            let [x, y, z] = description.origin.to_array();
            format!("the scene is far from it, around {x:.6e}, {y:.6e}, {z:.6e}")
        } else {
            "the scene is near it".into()
        },
    };
    vec![
        watertight_edges(description),
        centred,
        always(
            "error-bound offsets",
            "else rays would meet the surface they leave",
        ),
        always("film in f64", "else the sums of many samples would stall"),
        always(
            "exact sums in fields",
            "else fields would depend on the number of threads",
        ),
    ]
}

/// Whether every edge of the mesh is met by an even number of triangles: it then has no border.
///
/// Nothing is stored: the hashes of all edges, regardless of their direction, cancel in pairs. What
/// is left of a mesh with a border is 0 once in 2^64 times.
fn is_closed(mesh: &TriangleMesh) -> bool {
    let triangles = mesh.triangles();
    let edges = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| place(mesh.positions()[i as usize]));
        edge(a, b) ^ edge(b, c) ^ edge(c, a)
    };
    let left = triangles
        .par_iter()
        .with_min_len(1 << 14)
        .map(edges)
        .reduce(|| 0, |x, y| x ^ y);
    !triangles.is_empty() && left == 0
}

/// Vertices at one place are one: files repeat them along seams.
fn place(p: Vec3) -> u64 {
    // -0 becomes 0.
    xxh3_64(bytemuck::bytes_of(&(p + Vec3::ZERO)))
}

/// The same for both directions.
fn edge(a: u64, b: u64) -> u64 {
    xxh3_64(bytemuck::bytes_of(&[a.min(b), a.max(b)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(triangles: &[[u32; 3]]) -> TriangleMesh {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::ZERO];
        TriangleMesh::new(positions.to_vec(), triangles.to_vec()).unwrap()
    }

    #[test]
    fn a_mesh_is_closed_if_it_has_no_border() {
        let closed = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        assert!(is_closed(&mesh(&closed)));
        let mut seam = closed;
        // Another number for the same place, and one triangle the other way around.
        seam[1] = [4, 1, 3];
        assert!(is_closed(&mesh(&seam)));
        assert!(!is_closed(&mesh(&closed[1..])));
        assert!(!is_closed(&mesh(&[])));
        let mut open = closed;
        open[0] = [0, 1, 1];
        assert!(!is_closed(&mesh(&open)));
    }
}
