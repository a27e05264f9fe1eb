//! Whether a field could help the paths of a view at all: asked before anything is learned.

use super::trial::{EASY, HEAVY, unguided_noise};
use crate::integrate::context::View;
use crate::integrate::progress::Limits;

/// Samples of an image below which learning and its trial take a larger share than they bring back:
/// a trial alone takes twice 4096 paths, 3 % of these.
const FEWEST_SAMPLES: u64 = 1 << 18;
/// Samples of a pixel below which an image is a preview.
const FEWEST_SPP: u64 = 8;
/// Share of the image's samples that tell, within [`PATHS`].
const SHARE: f64 = 0.006;
const PATHS: [u64; 2] = [1 << 12, 1 << 16];
/// Edges of a path that next-event estimation finds from the camera's first surface.
const DIRECT: u32 = 2;

/// Why no field can be learned for a view; `None` if one can.
pub fn nothing_to_learn(view: &View) -> Option<&'static str> {
    if view.scene.lights.is_empty() {
        return Some("the scene has no light");
    }
    let rough = view.scene.surfaces.scatter() || view.scene.media.scatter();
    (!rough).then_some("nothing in the scene is rough")
}

/// Why a field is not worth learning for an image with these limits; `None` if it may be: then a
/// trial while rendering tells.
pub fn not_worthwhile(view: &View, limits: &Limits) -> Option<&'static str> {
    if view.settings.max_depth <= DIRECT {
        return Some("paths are too short for indirect light");
    }
    let samples = view.film.pixels().saturating_mul(limits.spp);
    if limits.spp < FEWEST_SPP || samples < FEWEST_SAMPLES {
        return Some("the image has too few samples");
    }
    is_easy(view, samples).then_some("paths find the light by themselves")
}

/// Whether unguided samples have so little noise that there is nothing to gain. Where glass or metal
/// may gather the light of a sun or of a small lamp, a few samples cannot tell: they may have missed
/// it all. An even sky or a large lamp they meet by chance.
fn is_easy(view: &View, samples: u64) -> bool {
    let scene = view.scene;
    if scene.surfaces.cast_caustics() && !scene.lights.caustic_emitters().is_empty() {
        return false;
    }
    let paths = ((SHARE * samples as f64) as u64).clamp(PATHS[0], PATHS[1]);
    let (noise, tail) = unguided_noise(view, paths);
    noise < EASY && tail < HEAVY
}
