//! What a guided path carries besides the state of a plain one.

use super::manifold::SpecularChain;
use super::path::Path;

/// [`GuidedPath::rough_vertex`] of a path that has left no vertex where manifold next-event
/// estimation was possible.
pub const NO_ROUGH_VERTEX: u32 = u32::MAX;

/// A path that a field guides.
#[derive(Clone, Copy, Debug)]
pub struct GuidedPath {
    /// The state that every path has.
    pub base: Path,
    /// What the pixel is expected to come to by the field, summed over the channels; 0 until the
    /// field was asked (Vorba and Krivanek 2016).
    pub pixel_estimate: f32,
    /// Into how many paths its sample would have been split by now, had all of them been split as
    /// often.
    pub split_factor: u32,
    /// Into how many paths it may be split among lobes (see `lobe_splitting.rs`).
    pub split_budget: f32,
    /// The path's scaled throughput (see [`super::roulette`]) when the field guided it last; 1
    /// until then.
    pub reference_throughput: f32,
    /// How far it has come.
    pub prefix: PrefixState,
    /// The mirrors and glass that it has passed since it left its last rough vertex.
    pub chain: SpecularChain,
    /// Number of that vertex among the wave's rough vertices, or [`NO_ROUGH_VERTEX`].
    pub rough_vertex: u32,
}

impl GuidedPath {
    /// A path that begins at the camera, with the split budget that such paths have.
    #[inline]
    pub fn new(base: Path, split_budget: f32) -> Self {
        Self {
            base,
            pixel_estimate: 0.0,
            split_factor: 1,
            split_budget,
            reference_throughput: 1.0,
            prefix: PrefixState::Growing,
            chain: SpecularChain::EMPTY,
            rough_vertex: NO_ROUGH_VERTEX,
        }
    }
}

impl AsRef<Path> for GuidedPath {
    #[inline]
    fn as_ref(&self) -> &Path {
        &self.base
    }
}

impl AsMut<Path> for GuidedPath {
    #[inline]
    fn as_mut(&mut self) -> &mut Path {
        &mut self.base
    }
}

/// How far a path has come, for the reuse of its suffix (see [`super::reuse`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrefixState {
    /// It has met nothing but mirrors and glass.
    Growing,
    /// It has just left its first rough vertex, the end of the prefix of this number.
    EndsHere(u32),
    /// It is past that, or has no prefix that is shared.
    Past,
}
