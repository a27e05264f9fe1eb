//! Smooth normals with creases (`max_smooth_angle`).
//!
//! Two triangles that share an edge are smooth across it if the angle between their normals is at
//! most the given one. Around a vertex, triangles that are connected by smooth edges share a
//! normal; otherwise the vertex is split. Vertices at the same position count as one when edges are
//! matched, whatever the file did at seams, so the result depends on the surface alone.

use super::{Raw, normals};
use crate::math::{DVec3, Vec3};
use rayon::prelude::*;

/// On an edge of more than two triangles, each is compared with this many that follow it.
const NEIGHBOURS: usize = 16;

/// Replaces the normals of `raw`, splitting vertices at creases sharper than `degrees`.
pub(super) fn rebuild(raw: &mut Raw, degrees: f32) {
    let welded = weld(&raw.positions);
    let mut corners = Corners::new(raw.triangles.len());
    join_smooth(raw, &welded, f64::from(degrees), &mut corners);
    let (groups, count) = corners.groups();
    let sums = normals::accumulate(&raw.positions, &raw.triangles, &groups, count);
    split(raw, &groups, &sums);
}

/// The first vertex at the position of each vertex.
fn weld(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero makes one of the two zeros.
    let bits = |i: u32| {
        (positions[i as usize] + Vec3::ZERO)
            .to_array()
            .map(f32::to_bits)
    };
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&i| (bits(i), i));
    let mut first = vec![0; positions.len()];
    let mut current = 0;
    for (n, &i) in order.iter().enumerate() {
        if n == 0 || bits(i) != bits(current) {
            current = i;
        }
        first[i as usize] = current;
    }
    first
}

/// An edge of a triangle between welded vertices; `corners` are the triangle's corners at `low` and
/// `high`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    low: u32,
    high: u32,
    corners: [u32; 2],
}

fn edges(triangles: &[[u32; 3]], welded: &[u32]) -> Vec<Edge> {
    let edge = |face: usize, side: usize| {
        let next = (side + 1) % 3;
        let [from, to] =
            [side, next].map(|c| (welded[triangles[face][c] as usize], (face * 3 + c) as u32));
        let (a, b) = if from.0 <= to.0 {
            (from, to)
        } else {
            (to, from)
        };
        Edge {
            low: a.0,
            high: b.0,
            corners: [a.1, b.1],
        }
    };
    let mut edges: Vec<Edge> = (0..triangles.len() * 3)
        .into_par_iter()
        .map(|n| edge(n / 3, n % 3))
        .collect();
    edges.par_sort_unstable();
    edges
}

fn join_smooth(raw: &Raw, welded: &[u32], degrees: f64, corners: &mut Corners) {
    let smallest_cosine = degrees.clamp(0.0, 180.0).to_radians().cos();
    let normal = |corner: u32| -> DVec3 {
        normals::cross(&raw.positions, &raw.triangles[corner as usize / 3]).normalize()
    };
    let edges = edges(&raw.triangles, welded);
    for group in edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)) {
        for (i, a) in group.iter().enumerate() {
            for b in group[i + 1..].iter().take(NEIGHBOURS) {
                // The slack lets faces meet at exactly the angle in spite of rounding.
                if normal(a.corners[0]).dot(normal(b.corners[0])) >= smallest_cosine - 1e-9 {
                    corners.join(a.corners[0], b.corners[0]);
                    corners.join(a.corners[1], b.corners[1]);
                }
            }
        }
    }
}

/// Disjoint sets of corners (number 3 * triangle + corner); the smallest corner stands for its set.
struct Corners {
    parent: Vec<u32>,
}

impl Corners {
    fn new(triangles: usize) -> Self {
        Self {
            parent: (0..triangles as u32 * 3).collect(),
        }
    }

    fn find(&mut self, mut corner: u32) -> u32 {
        while self.parent[corner as usize] != corner {
            let above = self.parent[corner as usize];
            self.parent[corner as usize] = self.parent[above as usize];
            corner = above;
        }
        corner
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// The set of each corner, numbered in order of first use, and the number of sets.
    fn groups(mut self) -> (Vec<[u32; 3]>, usize) {
        let mut number = vec![0; self.parent.len()];
        let mut count = 0;
        for corner in 0..self.parent.len() as u32 {
            let root = self.find(corner);
            if root == corner {
                number[corner as usize] = count;
                count += 1;
            } else {
                number[corner as usize] = number[root as usize];
            }
        }
        let groups = number.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
        (groups.collect(), count as usize)
    }
}

/// One vertex for each pair of old vertex and set of corners.
fn split(raw: &mut Raw, groups: &[[u32; 3]], sums: &[Vec3]) {
    let mut pairs: Vec<(u32, u32, u32)> = raw
        .triangles
        .iter()
        .flatten()
        .zip(groups.iter().flatten())
        .enumerate()
        .map(|(corner, (&vertex, &group))| (vertex, group, corner as u32))
        .collect();
    pairs.par_sort_unstable();
    let mut sources: Vec<u32> = Vec::new();
    let mut normals = Vec::new();
    for pair in pairs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (vertex, group, _) = pair[0];
        for &(_, _, corner) in pair {
            raw.triangles[corner as usize / 3][corner as usize % 3] = sources.len() as u32;
        }
        sources.push(vertex);
        normals.push(normals::unit(sums[group as usize].as_dvec3()).unwrap_or(Vec3::Z));
    }
    raw.positions = pick(&raw.positions, &sources);
    raw.uvs = raw.uvs.take().map(|uvs| pick(&uvs, &sources));
    for attribute in raw.attributes.iter_mut().filter(|a| !a.per_face) {
        attribute.values = pick(&attribute.values, &sources);
    }
    raw.normals = Some(normals);
}

fn pick<T: Copy>(from: &[T], sources: &[u32]) -> Vec<T> {
    sources.iter().map(|&i| from[i as usize]).collect()
}
