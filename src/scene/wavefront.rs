//! Paths that advance together, so that the ray tracer gets their rays in bulk.

use super::Scene;
use crate::accel::{Hit, Ray};

/// Vertices whose data is brought into the cache at a time: a few times as many as a processor
/// waits for at once, few enough for the smallest cache.
pub const AHEAD: usize = 32;

/// The paths of a wave that are under way, each with its next ray. Kept from one wave to the next
/// for its buffers.
pub struct Wavefront<P> {
    paths: Vec<P>,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
}

impl<P> Default for Wavefront<P> {
    fn default() -> Self {
        Self {
            paths: Vec::new(),
            rays: Vec::new(),
            hits: Vec::new(),
        }
    }
}

impl<P: Copy> Extend<(P, Ray)> for Wavefront<P> {
    fn extend<I: IntoIterator<Item = (P, Ray)>>(&mut self, paths: I) {
        paths
            .into_iter()
            .for_each(|(path, ray)| self.push(path, ray));
    }
}

impl<P: Copy> Wavefront<P> {
    /// Adds a path that goes on by this ray, behind all others.
    #[inline]
    pub fn push(&mut self, path: P, ray: Ray) {
        self.paths.push(path);
        self.rays.push(ray);
    }

    /// Whether all paths have ended.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Forgets all paths.
    pub fn clear(&mut self) {
        self.paths.clear();
        self.rays.clear();
    }

    /// Takes all paths out.
    pub fn drain(&mut self) -> impl Iterator<Item = (P, Ray)> + '_ {
        self.paths.drain(..).zip(self.rays.drain(..))
    }

    /// Traces the ray of every path and lets the path take a step from what that met: it goes on by
    /// the ray that `step` returns, or ends. Paths keep their order. Returns the number of rays.
    #[inline(always)]
    pub fn advance(
        &mut self,
        scene: &Scene,
        mut step: impl FnMut(&mut P, &Ray, &Hit) -> Option<Ray>,
    ) -> u64 {
        let count = self.rays.len();
        self.hits.resize(count, Hit::NONE);
        scene.rays.intersect_batch(&self.rays, &mut self.hits);
        let mut kept = 0;
        for i in 0..count {
            if i % AHEAD == 0 {
                let next = &self.hits[i..(i + AHEAD).min(count)];
                scene.surfaces.prefetch(next);
            }
            // Moved up before it goes on: a copy of what was just written would wait for it.
            self.paths[kept] = self.paths[i];
            let next = step(&mut self.paths[kept], &self.rays[i], &self.hits[i]);
            let Some(ray) = next else { continue };
            self.rays[kept] = ray;
            kept += 1;
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
        count as u64
    }
}
