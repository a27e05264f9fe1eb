//! Meshes of any size from a formula, for trying the renderer at the scale of production.
//!
//! Every vertex and every triangle follows from its number alone, in closed form: they are computed
//! by all threads and written in order, a batch at a time, so memory does not grow with the mesh
//! and the same words give the same file.

mod dragon;
mod flake;
mod instances;
mod knot;
mod ply;
mod terrain;

pub use instances::{Dialect, Instances};
pub use ply::write as write_ply;

use crate::math::{DVec3, Vec3};

/// Shapes that can be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Mountains: a height field of noise on the square [-1, 1] in x and z.
    Terrain,
    /// A wall along Heighway's dragon curve.
    DragonCurve,
    /// Spheres on spheres (after Haines, "A Proposal for Standard Graphics Environments", 1987).
    SphereFlake,
    /// A tube along a (2, 3) torus knot.
    TorusKnot,
}

/// A mesh as a formula.
#[derive(Clone, Debug)]
pub struct Pattern(Form);

#[derive(Clone, Debug)]
enum Form {
    Terrain(terrain::Terrain),
    Dragon(dragon::Dragon),
    Flake(flake::Flake),
    Knot(knot::Knot),
}

impl Pattern {
    /// A shape of about `triangles` triangles: as near as its structure allows, and never fewer
    /// than a few dozen.
    pub fn new(kind: Kind, triangles: u64) -> Self {
        Self(match kind {
            Kind::Terrain => Form::Terrain(terrain::Terrain::new(triangles)),
            Kind::DragonCurve => Form::Dragon(dragon::Dragon::new(triangles)),
            Kind::SphereFlake => Form::Flake(flake::Flake::new(triangles)),
            Kind::TorusKnot => Form::Knot(knot::Knot::new(triangles)),
        })
    }

    /// Number of vertices.
    pub fn vertices(&self) -> u64 {
        match &self.0 {
            Form::Terrain(t) => t.vertices(),
            Form::Dragon(d) => d.vertices(),
            Form::Flake(f) => f.vertices(),
            Form::Knot(k) => k.vertices(),
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> u64 {
        match &self.0 {
            Form::Terrain(t) => t.triangles(),
            Form::Dragon(d) => d.triangles(),
            Form::Flake(f) => f.triangles(),
            Form::Knot(k) => k.triangles(),
        }
    }

    /// Vertex `i`.
    pub fn vertex(&self, i: u64) -> Vec3 {
        let p: DVec3 = match &self.0 {
            Form::Terrain(t) => t.vertex(i),
            Form::Dragon(d) => d.vertex(i),
            Form::Flake(f) => f.vertex(i),
            Form::Knot(k) => k.vertex(i),
        };
        p.as_vec3()
    }

    /// Triangle `i`, counter-clockwise seen from outside (from above, for the terrain).
    pub fn triangle(&self, i: u64) -> [u32; 3] {
        let corners = match &self.0 {
            Form::Terrain(t) => t.triangle(i),
            Form::Dragon(d) => d.triangle(i),
            Form::Flake(f) => f.triangle(i),
            Form::Knot(k) => k.triangle(i),
        };
        corners.map(|c| c as u32)
    }
}

/// One of the two triangles of a quad with corners 0, 1 on one side and 2, 3 on the other, in the
/// same direction.
fn half_quad([a, b, c, d]: [u64; 4], second: bool) -> [u64; 3] {
    if second { [b, d, c] } else { [a, b, c] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    const KINDS: [Kind; 4] = [
        Kind::Terrain,
        Kind::DragonCurve,
        Kind::SphereFlake,
        Kind::TorusKnot,
    ];

    fn corners(pattern: &Pattern, i: u64) -> [DVec3; 3] {
        let triangle = pattern.triangle(i);
        triangle.map(|v| pattern.vertex(v.into()).as_dvec3())
    }

    /// Six times the enclosed volume, by the divergence theorem.
    fn volume(pattern: &Pattern) -> f64 {
        let of = |i| {
            let [a, b, c] = corners(pattern, i);
            a.dot(b.cross(c))
        };
        (0..pattern.triangles()).map(of).sum()
    }

    #[test]
    fn sizes_come_near_to_what_is_asked_for() {
        for kind in KINDS {
            for asked in [1_000u64, 100_000, 7_654_321, 50_000_000] {
                let made = Pattern::new(kind, asked).triangles();
                let ratio = made as f64 / asked as f64;
                assert!((0.85..1.05).contains(&ratio), "{kind:?}: {made} of {asked}");
            }
            assert!(Pattern::new(kind, 1).triangles() < 400, "{kind:?}");
        }
    }

    #[test]
    fn indices_are_in_range_and_every_vertex_is_used() {
        for kind in KINDS {
            let pattern = Pattern::new(kind, 3_000);
            let mut used = vec![false; pattern.vertices() as usize];
            for i in 0..pattern.triangles() {
                let [a, b, c] = pattern.triangle(i);
                assert!(a != b && b != c && c != a);
                for v in [a, b, c] {
                    used[v as usize] = true;
                }
            }
            assert!(used.iter().all(|u| *u), "{kind:?}");
        }
    }

    #[test]
    fn closed_shapes_are_closed_and_face_outwards() {
        for kind in [Kind::DragonCurve, Kind::SphereFlake, Kind::TorusKnot] {
            let pattern = Pattern::new(kind, 3_000);
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            for i in 0..pattern.triangles() {
                let [a, b, c] = pattern.triangle(i);
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from, to)).or_default() += 1;
                }
            }
            let paired = |(&(from, to), &n): (&(u32, u32), &i32)| {
                n == 1 && edges.get(&(to, from)) == Some(&1)
            };
            assert!(edges.iter().all(paired), "{kind:?}");
            assert!(volume(&pattern) > 0.0, "{kind:?}");
        }
    }

    #[test]
    fn the_terrain_faces_up_and_covers_the_square() {
        let pattern = Pattern::new(Kind::Terrain, 5_000);
        let mut area = 0.0;
        for i in 0..pattern.triangles() {
            let [a, b, c] = corners(&pattern, i);
            let normal = (b - a).cross(c - a);
            assert!(normal.y > 0.0);
            area += 0.5 * normal.y;
        }
        assert!((area - 4.0).abs() < 1e-5, "{area}");
    }

    /// The volume of the tube is its cross-section times its length; of spheres, their number's.
    #[test]
    fn volumes_are_those_of_the_ideal_shapes() {
        let flake = Pattern::new(Kind::SphereFlake, 2_000_000);
        // Levels of equal area: each holds a third of the volume of the one before.
        let levels = flake::levels(2_000_000);
        let ideal: f64 = (0..levels)
            .map(|l| 8.0 * std::f64::consts::PI / 3f64.powi(l as i32))
            .sum();
        let ratio = volume(&flake) / ideal;
        assert!((0.97..1.0).contains(&ratio), "{ratio}");
    }
}
