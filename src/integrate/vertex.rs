//! What is known at one vertex of a path.

use super::guided_vertex::GuidedVertex;
use crate::bsdf::Bsdf;
use crate::guide::LightChoice;
use crate::math::Vec3;
use crate::scene::path_medium::PathMedium;
use crate::texture::SurfacePoint;

/// A vertex where a path scatters.
pub(super) struct Vertex<'v, 's> {
    pub point: &'v SurfacePoint<'s>,
    pub bsdf: &'v Bsdf,
    /// Towards the vertex before.
    pub wo: Vec3,
    /// The field here, if one guides.
    pub guided: Option<&'v GuidedVertex<'s>>,
    /// The media around it, in scenes that have any.
    pub media: Option<&'v PathMedium>,
    /// Out of which clusters the light was sampled.
    pub light_choice: LightChoice,
}
