//! Triangle meshes, as scene and ray tracer share them.

use super::Bounds;
use crate::math::Vec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Vertex positions and triangles, shared between the scene and the ray tracer without a copy.
///
/// Embree reads 16 bytes from the start of every vertex: [`TriangleMesh::new`] keeps one vertex of
/// spare capacity behind the last, which is why the fields are private.
#[derive(Debug, Default)]
pub struct TriangleMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bounds: OnceLock<Bounds>,
}

impl TriangleMesh {
    /// Takes over the buffers. Indices are checked: an index beyond the vertices is an error that
    /// names the first offending triangle.
    pub fn new(mut positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, BadIndex> {
        let count = positions.len();
        // The largest of many is found with vector instructions; the first that is too large is
        // not.
        let inside = triangles.par_chunks(1 << 14).all(|part| {
            let largest = part.as_flattened().iter().fold(0, |a, &b| a.max(b));
            (largest as usize) < count
        });
        if !inside {
            let beyond = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= count);
            return Err(BadIndex {
                triangle: triangles.iter().position(beyond).unwrap_or(0),
                vertices: count,
            });
        }
        positions.reserve_exact(1);
        Ok(Self {
            positions,
            triangles,
            bounds: OnceLock::new(),
        })
    }

    /// Vertex positions.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Vertex indices of each triangle, all in range.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of triangle `prim`.
    #[inline]
    pub fn corners(&self, prim: u32) -> [Vec3; 3] {
        self.triangles[prim as usize].map(|i| self.positions[i as usize])
    }

    /// Bounds of the triangles, found at the first call. Those with a corner that is not finite do
    /// not count: no backend finds them.
    pub fn bounds(&self) -> Bounds {
        /// Triangles that one thread looks at, at least.
        const GRAIN: usize = 1 << 14;
        if let Some(known) = self.bounds.get() {
            return *known;
        }
        // Not within the lock: a thread that waits for the others here may take up work that asks
        // for the same bounds.
        let triangles = (0..self.triangles.len() as u32).into_par_iter();
        let corners = triangles.with_min_len(GRAIN).map(|prim| self.corners(prim));
        let bounds = corners
            .filter(|corners| corners.iter().all(|c| c.is_finite()))
            .fold(
                || Bounds::EMPTY,
                |b, corners| corners.into_iter().fold(b, Bounds::with),
            )
            .reduce(|| Bounds::EMPTY, Bounds::union);
        *self.bounds.get_or_init(|| bounds)
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.positions.capacity() * 12 + self.triangles.capacity() * 12
    }
}

/// A triangle names a vertex that does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("triangle {triangle} names a vertex beyond the mesh's {vertices}")]
pub struct BadIndex {
    /// Index of the first such triangle.
    pub triangle: usize,
    /// Number of vertices the mesh has.
    pub vertices: usize,
}
