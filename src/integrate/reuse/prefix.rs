//! A path in two parts.

use crate::bsdf::{Bsdf, View};
use crate::integrate::guided_vertex::GuidedVertex;
use crate::integrate::path::Path;
use crate::integrate::vertex::Vertex;
use crate::math::{Rgb, Vec3};
use crate::medium::Segment;
use crate::scene::Scene;
use crate::scene::path_medium::PathMedium;
use crate::texture::SurfacePoint;

/// A path takes part if its weakest channel carries this share of its strongest: what is found
/// behind is divided by what the path came with, and where that is nothing it tells nothing.
pub(super) const LEAST_CHANNEL: f32 = 1.0 / 32.0;
/// Nor does it if it has nearly underflown.
const MIN_THROUGHPUT: f32 = 1e-20;
/// Nor if it sees the vertex behind by so small a factor (see [`View`]).
const LEAST_VIEW: f32 = 1.0 / 32.0;

/// Whether a path with this throughput takes part that sees the vertex behind by the factor
/// `view`.
#[inline]
pub(super) fn is_shareable(throughput: Rgb, view: f32) -> bool {
    let (least, most) = (throughput.min_element(), throughput.max_element());
    least >= MIN_THROUGHPUT
        && most.is_finite()
        && least >= LEAST_CHANNEL * most
        && view >= LEAST_VIEW
}

/// A path up to its first rough vertex.
pub(super) struct PathPrefix<'s> {
    /// Number of its sample in the wave.
    pub sample: u32,
    /// Edges to its vertex.
    pub depth: u32,
    /// What it came with.
    pub throughput: Rgb,
    pub position: Vec3,
    /// Rounding error of the position.
    pub error: Vec3,
    /// The geometric and the shading normal.
    pub normals: [Vec3; 2],
    pub wo: Vec3,
    pub bsdf: Bsdf,
    pub guided: GuidedVertex<'s>,
    /// The media around it, in scenes that have any.
    media: Option<PathMedium>,
    /// What comes behind, if that is shared.
    pub suffix: Option<Suffix>,
}

impl<'s> PathPrefix<'s> {
    /// That of a path which leaves a vertex; none where no field guides.
    pub fn new(vertex: &Vertex<'_, 's>, path: &Path, sample: u32) -> Option<Self> {
        let Vertex {
            point, bsdf, wo, ..
        } = *vertex;
        Some(Self {
            sample,
            depth: path.depth,
            throughput: path.throughput,
            position: point.p,
            error: point.error,
            normals: point.normals(),
            wo,
            bsdf: bsdf.clone(),
            guided: vertex.guided?.clone(),
            media: vertex.media.copied(),
            suffix: None,
        })
    }

    /// What comes along the way to a place that it sees; exact.
    #[inline]
    pub fn transmittance(&self, scene: &Scene, direction: Vec3, length: f32) -> Rgb {
        let around = self.media.as_ref().map(|media| media.medium(direction));
        let medium = around.and_then(|id| scene.media.list().get(id));
        medium.map_or(Rgb::ONE, |medium| {
            medium.extinction.exact_transmittance(&Segment {
                origin: self.position,
                direction,
                length,
            })
        })
    }
}

/// The vertex behind a prefix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Suffix {
    pub position: Vec3,
    /// The geometric and the shading normal.
    pub normals: [Vec3; 2],
    /// Towards its own prefix.
    wo: Vec3,
    view: View,
    /// The accumulator of what is found here and behind.
    pub accumulator: u32,
    /// What its own path came with.
    pub throughput: Rgb,
}

impl Suffix {
    /// Whether a path that arrives at a vertex with this view takes part.
    #[inline]
    pub fn takes_part(wo: Vec3, path: &Path, view: &View) -> bool {
        is_shareable(path.throughput, view.factor(wo))
    }

    /// What it shares, once it has an accumulator for that.
    #[inline]
    pub fn new(point: &SurfacePoint, wo: Vec3, path: &Path, view: View) -> Self {
        Self {
            position: point.p,
            normals: point.normals(),
            wo,
            view,
            accumulator: path.accumulator,
            throughput: path.throughput,
        }
    }

    /// By what factors its own prefix and one in direction `w` see it.
    #[inline]
    pub fn views(&self, w: Vec3) -> [f32; 2] {
        [self.wo, w].map(|w| self.view.factor(w))
    }

    /// Whether a place in direction `w` is on the side that its own path came from: the other may
    /// look otherwise.
    #[inline]
    pub fn faces(&self, w: Vec3) -> bool {
        self.normals.iter().all(|n| n.dot(w) * n.dot(self.wo) > 0.0)
    }
}
