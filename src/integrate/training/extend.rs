//! Learning further, over trees that stand: the records can be shared out among machines, and the
//! sums that come back add up to the bits of one long run.
//!
//! Every camera path is guided by the field that all start from, never by what its own shard has
//! learned, so that record `i` is the same record wherever it is made.

use super::camera_paths::training_samples;
use super::learner::Learned;
use super::photons::trace_batch;
use super::settings::LearnSettings;
use crate::guide::{FieldFile, GuideError, Numbers, SampleRanges, Settings, Source};
use crate::integrate::context::View;
use crate::integrate::guiding::Guide;
use crate::integrate::progress::Stop;
use crate::photon::PhotonCounts;
use std::ops::Range;

/// Photons or paths that are held at a time, and lost where learning is stopped.
const PIECE: u64 = 1 << 18;

/// Further records: how many, and which of them here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct More {
    /// Photons in all.
    pub photons: u64,
    /// Camera paths in all.
    pub paths: u64,
    /// The part `i` of `n`, counted from 0, by itself; without it all of them, added to the base.
    pub share: Option<(u32, u32)>,
}

impl More {
    /// Which of `count` records that begin at number `first` are made here.
    fn range(&self, first: u64, count: u64) -> Range<u64> {
        let (i, n) = self.share.unwrap_or((0, 1));
        let at = |i: u32| first + (u128::from(count) * u128::from(i) / u128::from(n.max(1))) as u64;
        at(i)..at(i.saturating_add(1))
    }
}

/// Everything besides the scene and the numbers that decides what a record is.
pub fn recipe(view: &View, settings: &LearnSettings) -> String {
    let path = view.settings;
    let (film, photon) = (view.film, settings.photon);
    format!(
        "seed {}, {} x {} pixels, depth {}, roulette from {}, {} bounces of photons, roulette from {}{}",
        path.seed,
        film.width,
        film.height,
        path.max_depth,
        path.rr_depth,
        photon.max_bounces,
        photon.roulette_after,
        if path.strict_normals {
            ", strict normals"
        } else {
            ""
        }
    )
}

/// What [`super::learn`] came to, ready to be kept.
pub fn to_file(
    view: &View,
    settings: &LearnSettings,
    learned: Learned,
    scene_hash: u64,
) -> FieldFile {
    let mut trainer = learned.trainer;
    trainer.set_scene(scene_hash);
    let all = |n: u64| Numbers::new(0..n, 0..n);
    let sample_ranges = SampleRanges {
        recipe: recipe(view, settings),
        photons: all(learned.counts.emitted),
        paths: all(learned.paths),
        unrefined: false,
    };
    let guide = &learned.guide;
    FieldFile::new(trainer, sample_ranges, &guide.field, &guide.fractions)
}

/// A field that was kept, ready to guide.
pub fn to_guide(file: &FieldFile) -> Guide {
    let (field, fractions) = file.freeze();
    Guide {
        field,
        fractions,
        manifold: None,
    }
}

/// Refuses a field whose scene has another identity.
///
/// # Errors
/// When it is of another scene.
pub fn check_scene(field: &Settings, scene_hash: u64) -> Result<(), GuideError> {
    if field.scene_hash == scene_hash {
        return Ok(());
    }
    Err(GuideError::Foreign(format!(
        "the field was learned for another scene: its fingerprint is {:016x}, this scene's {scene_hash:016x}",
        field.scene_hash
    )))
}

/// Learns from further records over the structure of `base`: those that follow the records that it
/// knows, all of them or as many as there are when it is stopped.
///
/// # Errors
/// When the records would be made differently from those of the base.
pub fn extend(
    view: &View,
    settings: &LearnSettings,
    base: &FieldFile,
    more: &More,
    stop: Stop,
) -> Result<(FieldFile, PhotonCounts), GuideError> {
    let recipe = recipe(view, settings);
    if recipe != base.sample_ranges.recipe {
        return Err(GuideError::Foreign(format!(
            "the field was learned with other settings: {}; now {recipe}",
            base.sample_ranges.recipe
        )));
    }
    let mut file = match more.share {
        Some(_) => base.emptied(),
        None => base.clone(),
    };
    file.sample_ranges.unrefined = true;
    let source = base.trainer.settings().source;
    let mut counts = PhotonCounts::default();
    // These records shape nothing and are no batch: cut in any way, they count the same.
    let batches = file.trainer.intakes().batches;
    file.trainer.keep_at_most(0);
    let (ranges, known) = (&mut file.sample_ranges, &base.sample_ranges);
    if source != Source::Paths {
        let first = known.photons.next();
        take(&mut ranges.photons, more, (first, more.photons), |piece| {
            let emitted = piece.end - piece.start;
            let (landed, traced) = trace_batch((view.scene, settings), piece, stop)?;
            counts += traced;
            file.trainer.train_on_photons(landed, emitted);
            Some(())
        });
    }
    if source != Source::Photons {
        let guide = to_guide(base);
        let first = known.paths.next();
        take(&mut ranges.paths, more, (first, more.paths), |piece| {
            let guide = Some((&guide).into());
            let training_samples = training_samples(view, guide, piece, stop)?;
            let samples = training_samples.into_iter().map(|l| l.samples).collect();
            file.trainer.train_paths(samples);
            Some(())
        });
    }
    file.trainer.conclude(batches);
    Ok((file, counts))
}

/// Learns piece by piece from `count` records that begin at number `first`, or from a share of
/// them, until `learn` is stopped, and enters their numbers into a ledger.
fn take(
    into: &mut Numbers,
    more: &More,
    (first, count): (u64, u64),
    mut learn: impl FnMut(Range<u64>) -> Option<()>,
) {
    let numbers = more.range(first, count);
    let mut taken = numbers.start..numbers.start;
    for piece in pieces(numbers) {
        let end = piece.end;
        if learn(piece).is_none() {
            break;
        }
        taken.end = end;
    }
    // What a share has not taken when it is stopped is missing: the numbers behind it are others'.
    let planned = match more.share {
        Some(_) => first + count,
        None => taken.end,
    };
    into.join(&Numbers::new(taken, first..planned));
}

fn pieces(range: Range<u64>) -> impl Iterator<Item = Range<u64>> {
    let end = range.end;
    range
        .step_by(PIECE as usize)
        .map(move |from| from..(from + PIECE).min(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_each_other_and_leave_nothing_out() {
        for (count, n) in [(10, 3), (2, 5), (u64::MAX >> 1, 7), (0, 2)] {
            let range = |share| {
                let more = More {
                    photons: 0,
                    paths: 0,
                    share,
                };
                more.range(100, count)
            };
            let mut at = 100;
            for i in 0..n {
                let part = range(Some((i, n)));
                assert_eq!(part.start, at);
                at = part.end;
            }
            assert_eq!(at, 100 + count);
            assert_eq!(range(None), 100..100 + count);
        }
    }

    #[test]
    fn pieces_join_up() {
        let range = 5..5 + 3 * PIECE + 7;
        let parts: Vec<_> = pieces(range.clone()).collect();
        assert_eq!(parts.len(), 4);
        assert!(parts.windows(2).all(|w| w[0].end == w[1].start));
        assert_eq!((parts[0].start, parts[3].end), (range.start, range.end));
        assert_eq!(pieces(3..3).count(), 0);
    }
}
