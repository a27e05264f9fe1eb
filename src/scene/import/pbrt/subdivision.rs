//! Loop's subdivision surfaces (Loop, "Smooth Subdivision Surfaces Based on Triangles", 1987), with
//! their limit: positions and normals are those of infinitely many levels.

use super::pending::Vertices;
use crate::math::{DVec3, Vec3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Triangles that a surface may become.
const MOST_TRIANGLES: usize = 1 << 27;

/// Faces of a vertex: putting them in order takes the square of their number.
const MOST_FACES: u32 = 4096;

/// A refined mesh.
pub(super) struct Refined {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// Refines a control mesh so many times.
///
/// # Errors
/// When it becomes too large, or no surface: an edge with three faces, a vertex where surfaces
/// touch in a point.
pub(super) fn refine(control: &Vertices, levels: u32) -> Result<Refined, String> {
    let list = control.positions.chunks_exact(3);
    let mut positions: Vec<DVec3> = list.map(|p| Vec3::from_slice(p).as_dvec3()).collect();
    let corner = |i: i32| u32::try_from(i).unwrap_or(0);
    let faces = control.indices.chunks_exact(3);
    let mut faces: Vec<[u32; 3]> = faces.map(|f| [f[0], f[1], f[2]].map(corner)).collect();
    let most = faces.len().saturating_mul(1usize << (2 * levels.min(24)));
    if most > MOST_TRIANGLES {
        return Err(format!(
            "{levels} levels of subdivision make {most} triangles; {MOST_TRIANGLES} are the most"
        ));
    }
    for _ in 0..levels {
        let rings = Rings::new(positions.len(), &faces)?;
        (positions, faces) = divided(&positions, &faces, &rings);
    }
    let rings = Rings::new(positions.len(), &faces)?;
    Ok(limit(&positions, faces, &rings))
}

/// The vertices around each vertex, in the order of its faces; those of the surface's edge begin
/// and end with their neighbours along it.
struct Rings {
    starts: Vec<u32>,
    around: Vec<u32>,
    at_edge: Vec<bool>,
}

impl Rings {
    fn new(count: usize, faces: &[[u32; 3]]) -> Result<Self, String> {
        // The faces of each vertex, as the edges opposite to it.
        let mut starts = vec![0u32; count + 1];
        for &v in faces.iter().flatten() {
            starts[v as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut opposite = vec![[0u32; 2]; 3 * faces.len()];
        let mut filled = starts.clone();
        for f in faces {
            for k in 0..3 {
                let slot = &mut filled[f[k] as usize];
                opposite[*slot as usize] = [f[(k + 1) % 3], f[(k + 2) % 3]];
                *slot += 1;
            }
        }
        let mut rings = Self {
            starts: vec![0],
            around: Vec::with_capacity(3 * faces.len() + count),
            at_edge: Vec::with_capacity(count),
        };
        for v in 0..count {
            let faces = starts[v + 1] - starts[v];
            if faces > MOST_FACES {
                return Err(format!(
                    "vertex {v} has {faces} faces; {MOST_FACES} are the most"
                ));
            }
            let edges = &mut opposite[starts[v] as usize..starts[v + 1] as usize];
            let at_edge = rings.add(edges).ok_or_else(|| {
                format!(
                    "the mesh is no surface around vertex {v}: faces there meet in the vertex \
                    alone, or three along an edge, or they are turned differently"
                )
            })?;
            rings.at_edge.push(at_edge);
            rings.starts.push(rings.around.len() as u32);
        }
        Ok(rings)
    }

    /// Chains the edges around a vertex; whether they are open. `None` where they are no chain.
    fn add(&mut self, edges: &mut [[u32; 2]]) -> Option<bool> {
        if edges.is_empty() {
            return Some(true);
        }
        let begin = edges
            .iter()
            .position(|e| !edges.iter().any(|other| other[1] == e[0]));
        let at_edge = begin.is_some();
        edges.swap(0, begin.unwrap_or(0));
        for i in 1..edges.len() {
            let wanted = edges[i - 1][1];
            let next = (i..edges.len()).find(|&k| edges[k][0] == wanted)?;
            edges.swap(i, next);
        }
        let (first, last) = (edges[0][0], edges[edges.len() - 1][1]);
        if !at_edge && first != last {
            return None;
        }
        self.around.extend(edges.iter().map(|e| e[0]));
        if at_edge {
            self.around.push(last);
        }
        Some(at_edge)
    }

    fn of(&self, v: usize) -> &[u32] {
        &self.around[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}

/// Weight of each neighbour of an inner vertex.
fn beta(valence: usize) -> f64 {
    match valence {
        3 => 3.0 / 16.0,
        n => 3.0 / (8.0 * n as f64),
    }
}

/// One level: vertices moved, and one more on each edge.
fn divided(p: &[DVec3], faces: &[[u32; 3]], rings: &Rings) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut out: Vec<DVec3> = (0..p.len()).map(|v| moved(p, v, rings)).collect();
    let mut between: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * faces.len());
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    // The vertices across each edge.
    let mut across: HashMap<[u32; 2], [Option<u32>; 2]> = HashMap::with_capacity(2 * faces.len());
    for f in faces {
        for k in 0..3 {
            let slot = across.entry(key(f[k], f[(k + 1) % 3])).or_default();
            let free = usize::from(slot[0].is_some());
            slot[free] = Some(f[(k + 2) % 3]);
        }
    }
    let mut middle = |a: u32, b: u32, out: &mut Vec<DVec3>| {
        *between.entry(key(a, b)).or_insert_with(|| {
            let ends = p[a as usize] + p[b as usize];
            out.push(match across[&key(a, b)] {
                [Some(c), Some(d)] => {
                    ends * (3.0 / 8.0) + (p[c as usize] + p[d as usize]) * (1.0 / 8.0)
                }
                _ => ends * 0.5,
            });
            out.len() as u32 - 1
        })
    };
    let mut divided = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let ab = middle(a, b, &mut out);
        let bc = middle(b, c, &mut out);
        let ca = middle(c, a, &mut out);
        divided.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    (out, divided)
}

fn moved(p: &[DVec3], v: usize, rings: &Rings) -> DVec3 {
    let ring = rings.of(v);
    match (rings.at_edge[v], ring) {
        (_, []) => p[v],
        (true, [first, .., last]) => p[v] * 0.75 + (p[*first as usize] + p[*last as usize]) * 0.125,
        (_, ring) => {
            let n = ring.len();
            let sum: DVec3 = ring.iter().map(|i| p[*i as usize]).sum();
            p[v] * (1.0 - n as f64 * beta(n)) + sum * beta(n)
        }
    }
}

/// Vertices on the surface of infinitely many levels, with its normals.
fn limit(p: &[DVec3], triangles: Vec<[u32; 3]>, rings: &Rings) -> Refined {
    let on_surface = |v: usize| {
        let ring = rings.of(v);
        match (rings.at_edge[v], ring) {
            (_, []) => p[v],
            (true, [first, .., last]) => {
                p[v] * (2.0 / 3.0) + (p[*first as usize] + p[*last as usize]) * (1.0 / 6.0)
            }
            (_, ring) => {
                let n = ring.len();
                let gamma = 1.0 / (n as f64 + 3.0 / (8.0 * beta(n)));
                let sum: DVec3 = ring.iter().map(|i| p[*i as usize]).sum();
                p[v] * (1.0 - n as f64 * gamma) + sum * gamma
            }
        }
    };
    let positions = (0..p.len()).map(|v| on_surface(v).as_vec3()).collect();
    let normals = (0..p.len())
        .map(|v| normal(p, v, rings).as_vec3())
        .collect();
    Refined {
        positions,
        normals,
        triangles,
    }
}

/// The normal of the limit, of any length: the product of two of its tangents.
fn normal(p: &[DVec3], v: usize, rings: &Rings) -> DVec3 {
    let ring: Vec<DVec3> = rings.of(v).iter().map(|i| p[*i as usize]).collect();
    let n = ring.len();
    if !rings.at_edge[v] {
        let turn = |i: usize| TAU * i as f64 / n as f64;
        let s: DVec3 = (0..n).map(|i| ring[i] * turn(i).cos()).sum();
        let t: DVec3 = (0..n).map(|i| ring[i] * turn(i).sin()).sum();
        return s.cross(t).normalize_or_zero();
    }
    let (Some(first), Some(last)) = (ring.first(), ring.last()) else {
        return DVec3::ZERO;
    };
    // Tangents along the edge and into the surface (Hoppe et al., "Piecewise Smooth Surface
    // Reconstruction", 1994).
    let along = *first - *last;
    let inwards = match n {
        2 => *first + *last - p[v] * 2.0,
        3 => ring[1] - p[v],
        4 => -*first + ring[1] * 2.0 + ring[2] * 2.0 - *last - p[v] * 2.0,
        _ => {
            let theta = PI / (n - 1) as f64;
            let inner = (1..n - 1)
                .map(|i| ring[i] * ((2.0 * theta.cos() - 2.0) * (i as f64 * theta).sin()));
            let sum: DVec3 = inner.sum();
            -((*first + *last) * theta.sin() + sum)
        }
    };
    along.cross(inwards).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    const OCTAHEDRON: [f32; 18] = [
        1., 0., 0., -1., 0., 0., 0., 1., 0., 0., -1., 0., 0., 0., 1., 0., 0., -1.,
    ];
    const FACES: [i32; 24] = [
        0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5,
    ];

    fn control<'s>(positions: &'s [f32], indices: &'s [i32]) -> Vertices<'s> {
        Vertices {
            indices,
            positions,
            ..Vertices::default()
        }
    }

    /// The limit does not depend on how often the control mesh was divided before it is taken: at
    /// the vertices of an octahedron it is its position times 1 - 4 gamma, with gamma = 1 / 8.
    #[test]
    fn the_limit_is_the_same_at_every_level() {
        for levels in 0..5 {
            let refined = refine(&control(&OCTAHEDRON, &FACES), levels).unwrap();
            assert_eq!(refined.triangles.len(), 8 << (2 * levels));
            assert!(
                (refined.positions[0] - Vec3::X * 0.5).length() < 1e-6,
                "{levels}"
            );
            for (p, n) in refined.positions.iter().zip(&refined.normals) {
                assert!((n.length() - 1.0).abs() < 1e-5);
                assert!(n.dot(p.normalize()) > 0.8, "{p} {n}");
            }
        }
    }

    /// Normals of the limit against those of a fine mesh on it.
    #[test]
    fn normals_are_those_of_the_surface() {
        let positions = [
            0., 0., 0., 1., 0., 0.4, 2., 0., 0., 0., 1., 0.3, 1., 1., 1., 2., 1., -0.2, 0., 2., 0.,
            1., 2., 0.5, 2., 2., 0.1f32,
        ];
        let faces = [
            0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7,
        ];
        let coarse = refine(&control(&positions, &faces), 0).unwrap();
        let fine = refine(&control(&positions, &faces), 6).unwrap();
        for v in 0..9 {
            let around = fine.triangles.iter().filter(|t| t.contains(&v));
            let sum: Vec3 = around
                .map(|t| {
                    let [a, b, c] = t.map(|i| fine.positions[i as usize]);
                    (b - a).cross(c - a).normalize()
                })
                .sum();
            let v = v as usize;
            assert!((fine.positions[v] - coarse.positions[v]).length() < 1e-5);
            let cos = sum.normalize().dot(coarse.normals[v]);
            assert!(cos > 0.995, "{v}: {cos}");
        }
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        let positions = [0.0f32; 24];
        // Three faces on an edge; two cones that touch in a point; faces turned differently.
        for faces in [
            &[0, 1, 2, 0, 1, 3, 0, 1, 4][..],
            &[0, 1, 2, 0, 3, 4],
            &[0, 1, 2, 0, 1, 3],
        ] {
            assert!(refine(&control(&positions, faces), 1).is_err(), "{faces:?}");
        }
        let many = refine(&control(&OCTAHEDRON, &FACES), 13).err().unwrap();
        assert!(many.contains("triangles"));
    }
}
