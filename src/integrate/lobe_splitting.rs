//! Splitting among lobes: a delta lobe and the other lobes are both followed.
//!
//! A path that a field guides towards the sun's image in a varnished table comes with a low
//! throughput, as it should: the density was high. But varnish reflects a twentieth. If one lobe is
//! chosen by its probability, it is met one time in twenty, by a path that is then twenty times as
//! bright as the field meant it to be. So a guided path has a *split budget*: each lobe gets its
//! share of it and is followed if that is one or more; with a smaller share it is followed with
//! that probability. A branch takes its share along, so that reflections of reflections do not
//! multiply: from one guided vertex to the next there are on average at most as many branches as
//! the budget says. A path from the camera has a small budget, too.

use super::guided_path::GuidedPath;
use super::path::Arrival;
use super::roulette::MOST_BRANCHES;
use super::splitting::SplitPaths;
use crate::accel::Ray;
use crate::bsdf::{Bsdf, BsdfSample, DeltaSplit, LobeFlags, Transport};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec3};

/// Split budget behind a vertex that a field guides (measured: `EXPERIMENTS.md`).
pub const GUIDED: f32 = 32.0;

/// Split budget of a guided path from the camera: water that reflects a thirtieth would otherwise
/// show the sun in one sample of thirty, thirty times as bright (measured: `EXPERIMENTS.md`).
pub const FROM_CAMERA: f32 = 4.0;

/// A lobe's probability to be followed, and the budget of the branch that does.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Share {
    /// The probability with which it would be chosen if only one were.
    probability: f32,
    /// Probability to be followed.
    follow_probability: f32,
    /// Budget of the branch, at least 1.
    split_budget: f32,
}

impl Share {
    #[inline]
    fn of(path: &GuidedPath, probability: f32) -> Self {
        let budget = path.split_budget * probability;
        Self {
            probability,
            follow_probability: budget.min(1.0),
            split_budget: budget.max(1.0),
        }
    }

    /// Makes a path the branch along the lobe. Roulette, which goes by the throughput since the
    /// field guided the path last, is not to undo the split.
    #[inline]
    fn take(&self, path: &mut GuidedPath) {
        let factor = self.probability / self.follow_probability;
        path.base.throughput *= factor;
        path.reference_throughput *= factor;
        path.split_budget = self.split_budget;
    }
}

/// The delta lobe and the rest, where both are to be considered: at vertices that a field guides,
/// and at those between mirrors and glass that a guided path meets.
#[inline]
pub fn delta_and_rest(
    path: &GuidedPath,
    guided: bool,
    bsdf: &Bsdf,
    wo: Vec3,
) -> Option<DeltaSplit> {
    let unknown = !guided && bsdf.flags().has(LobeFlags::SMOOTH);
    if path.split_budget <= 1.0 || unknown || 2 * path.split_factor > MOST_BRANCHES {
        return None;
    }
    bsdf.split_delta(wo, Transport::Radiance)
}

/// What is left to a path once its lobes are drawn.
pub enum Remainder {
    /// It goes on by the delta lobe alone, by this ray if roulette lets it.
    Delta(Option<Ray>),
    /// The rest of the lobes, with a number in `[0, 1)` for roulette.
    Smooth(f32),
}

/// Lets a path `go` on by a delta lobe, if the number `u` in `[0, 1)` draws that; `go` is given a
/// number for roulette. The rest is left to the path, with an accumulator of its own if both are
/// followed. Where a field guides the rest it always is.
///
/// The lobes and roulette share one number of the vertex's: with one block of four more for the
/// lobes, later vertices had the worse dimensions of a Sobol sequence (L1 of a pool under a small
/// sun, mixtures and 64 samples: 0.064 instead of 0.047), and with a number beside the path's own,
/// glints were not stratified (its RMSE 0.34 instead of 0.15).
pub fn split(
    split_delta: &DeltaSplit,
    guided: bool,
    u: f32,
    path: &mut GuidedPath,
    split_paths: &mut SplitPaths,
    arrival: &mut Arrival,
    go: &mut impl FnMut(&mut GuidedPath, &Arrival, Option<BsdfSample>, f32) -> Option<Ray>,
) -> Remainder {
    let delta = Share::of(path, split_delta.delta.pdf);
    let rest = Share::of(path, split_delta.rest.chance);
    let takes_rest = guided || 1.0 - u <= rest.follow_probability;
    if u < delta.follow_probability {
        let again = (u / delta.follow_probability).min(BELOW_ONE);
        if !takes_rest {
            delta.take(path);
            return Remainder::Delta(go(path, arrival, Some(split_delta.delta), again));
        }
        path.split_factor *= 2;
        arrival.radiance = Rgb::ZERO;
        let mut branch = split_paths.branch(path, 1);
        delta.take(&mut branch);
        if let Some(ray) = go(&mut branch, arrival, Some(split_delta.delta), again) {
            split_paths.push(branch, ray);
        }
        path.base.accumulator = split_paths.open(path.base.accumulator);
    }
    if guided {
        return Remainder::Smooth(u);
    }
    rest.take(path);
    Remainder::Smooth(((1.0 - u) / rest.follow_probability).min(BELOW_ONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Rest;
    use crate::camera::CameraRay;
    use crate::integrate::path::Path;
    use crate::math::PathSampler;

    fn path(split_budget: f32) -> GuidedPath {
        let camera = CameraRay {
            ray: Ray::new(Vec3::ZERO, Vec3::Z),
            cone_width: 0.0,
            cone_spread: 0.0,
            sees: true,
        };
        let sampler = PathSampler::independent(1, 2, 3);
        GuidedPath::new(Path::new(&camera, sampler, 0), split_budget)
    }

    /// Whatever the budget, a lobe's expected throughput is that of choosing one of the two, and
    /// the branches are no more than the budget.
    #[test]
    fn shares_keep_the_mean_and_do_not_multiply() {
        for budget in [1.0, 3.0, 8.0, 32.0] {
            for p in [1e-6, 0.04, 0.3, 0.5, 0.96] {
                let shares = [p, 1.0 - p].map(|p| Share::of(&path(budget), p));
                let mut branches = 0.0;
                for share in shares {
                    let mut branch = path(budget);
                    share.take(&mut branch);
                    let mean = branch.base.throughput.x * share.follow_probability;
                    assert!((mean / share.probability - 1.0).abs() < 1e-6);
                    assert_eq!(branch.base.throughput.x, branch.reference_throughput);
                    branches += share.follow_probability * branch.split_budget;
                }
                assert!(branches <= budget * 1.000_001, "{branches} of {budget}");
                assert!(shares[0].follow_probability + shares[1].follow_probability >= 1.0 - 1e-6);
            }
        }
    }

    /// Whatever follows a lobe, the number it goes on with is any number: none is drawn more often
    /// than others.
    #[test]
    fn roulette_has_an_even_number_whatever_lobe_was_drawn() {
        const NUMBERS: u32 = 4000;
        let even = |numbers: &[f32], probability: f32| {
            let expected = probability * NUMBERS as f32;
            assert!((numbers.len() as f32 - expected).abs() <= 1.0);
            let step = 1.0 / expected;
            let mut sorted = numbers.to_vec();
            sorted.sort_unstable_by(f32::total_cmp);
            for (i, number) in sorted.iter().enumerate() {
                assert!((number - (i as f32 + 0.5) * step).abs() <= step + 1e-4);
            }
        };
        for (budget, p, guided) in [
            (1.0, 0.25, false),
            (3.0, 0.03, false),
            (3.0, 0.6, false),
            (32.0, 0.01, true),
            (4.0, 0.9, true),
        ] {
            let (mut by_delta, mut by_rest) = (Vec::new(), Vec::new());
            for i in 0..NUMBERS {
                let u = (i as f32 + 0.5) / NUMBERS as f32;
                let mut arrival = Arrival {
                    throughput: Rgb::ONE,
                    radiance: Rgb::ZERO,
                };
                let mut go = |_: &mut GuidedPath, _: &Arrival, _: Option<BsdfSample>, u: f32| {
                    by_delta.push(u);
                    None
                };
                let (path, split_paths) = (&mut path(budget), &mut SplitPaths::default());
                let left = split(
                    &lobes(p),
                    guided,
                    u,
                    path,
                    split_paths,
                    &mut arrival,
                    &mut go,
                );
                if let Remainder::Smooth(u) = left {
                    by_rest.push(u);
                }
            }
            even(&by_delta, (budget * p).min(1.0));
            let rest = if guided { 1.0 } else { budget * (1.0 - p) };
            even(&by_rest, rest.min(1.0));
        }
    }

    /// A delta lobe of probability `p`, and others.
    fn lobes(p: f32) -> DeltaSplit {
        let mut rest = Rest::ALL;
        rest.chance = 1.0 - p;
        let delta = BsdfSample {
            wi: Vec3::Z,
            weight: Rgb::ONE,
            pdf: p,
            eta: 1.0,
            lobe: LobeFlags::DELTA,
        };
        DeltaSplit { delta, rest }
    }
}
