//! Learning the field before rendering: batches of photons, refined after each, frozen at the end.
//!
//! Batches double: early ones are cheap and shape the trees coarsely, later ones fill them.

use super::guiding::Guide;
use crate::guide::{Field, Fractions, GuideError, Photon, Settings, Stats, SurfacePoint, Trainer};
use crate::photon::wave::PhotonWave;
use crate::photon::{Landing, PhotonCounts, PhotonSettings};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Photons in a wave: one task.
const WAVE_PHOTONS: u64 = 8192;
/// Points that measure the area inside cells.
const AREA_POINTS: usize = 1 << 20;
/// Rounds of refining after a batch.
const ROUNDS: u32 = 4;

/// How a field is learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnSettings {
    /// Photon paths in all.
    pub photons: u64,
    /// Batches they come in; each is twice as large as the one before.
    pub batches: u32,
    /// Most bytes of the trees while they are trained.
    pub memory: u64,
    /// How photons are traced.
    pub photon: PhotonSettings,
    /// Let light that comes straight from an emitter teach the field, too.
    pub direct: bool,
}

/// What learning came to.
#[derive(Debug)]
pub struct Learned {
    /// The field.
    pub guide: Guide,
    /// What became of the photons.
    pub counts: PhotonCounts,
    /// The trees in numbers.
    pub stats: Stats,
    /// Wall-clock time.
    pub elapsed: Duration,
}

/// Learns the light field of a scene.
///
/// # Errors
/// When the scene's bounds are empty or a setting is out of range.
pub fn learn(scene: &Scene, settings: &LearnSettings) -> Result<Learned, GuideError> {
    let start = Instant::now();
    let bounds = scene.rays.bounds();
    let mut guide_settings = Settings::new(bounds.min, bounds.max);
    guide_settings.memory = settings.memory;
    guide_settings.seed = settings.photon.seed;
    let mut trainer = Trainer::build(guide_settings)?;
    let (points, area) = scene.area_points(AREA_POINTS, settings.photon.seed);
    let points: Vec<_> = points
        .iter()
        .map(|p| SurfacePoint {
            position: p.position,
            normal: p.normal,
        })
        .collect();
    trainer.set_surface(&points, area);
    let mut counts = PhotonCounts::default();
    for range in batches(settings.photons, settings.batches) {
        let emitted = range.end - range.start;
        let (photons, batch) = trace_batch(scene, settings, range);
        counts += batch;
        trainer.train(&photons, emitted);
        trainer.refine_with(&photons, ROUNDS);
    }
    let field = trainer.freeze();
    let fractions = Fractions::new(&field);
    let stats = trainer.stats();
    let guide = Guide { field, fractions };
    Ok(Learned {
        guide,
        counts,
        stats,
        elapsed: start.elapsed(),
    })
}

/// Cuts `photons` into `count` ranges, each twice as long as the one before.
fn batches(photons: u64, count: u32) -> Vec<Range<u64>> {
    let count = count.clamp(1, 32);
    let shares = (1u64 << count) - 1;
    let end =
        |i: u32| (u128::from(photons) * u128::from((1u64 << i) - 1) / u128::from(shares)) as u64;
    (0..count)
        .map(|i| end(i)..end(i + 1))
        .filter(|r| !r.is_empty())
        .collect()
}

/// Traces a batch, in waves side by side whose landings are joined in photon order.
fn trace_batch(
    scene: &Scene,
    settings: &LearnSettings,
    range: Range<u64>,
) -> (Vec<Photon>, PhotonCounts) {
    let starts: Vec<u64> = range.clone().step_by(WAVE_PHOTONS as usize).collect();
    let waves: Vec<_> = starts
        .par_iter()
        .map_init(PhotonWave::default, |wave, &from| {
            let mut landed = Vec::new();
            let to = (from + WAVE_PHOTONS).min(range.end);
            let counts = wave.trace(scene, &settings.photon, from..to, &mut |l: Landing| {
                if settings.direct || l.bounces > 0 {
                    landed.push(Photon {
                        position: l.position,
                        direction: l.direction,
                        power: l.power,
                        distance: l.distance,
                        normal: l.normal,
                    });
                }
            });
            (landed, counts)
        })
        .collect();
    let mut photons = Vec::with_capacity(waves.iter().map(|w| w.0.len()).sum());
    let mut counts = PhotonCounts::default();
    for (landed, wave) in waves {
        photons.extend(landed);
        counts += wave;
    }
    (photons, counts)
}

/// A field of noise over the scene's bounds: for tests that show that no field can change the mean.
pub fn garbage(scene: &Scene, seed: u64) -> Guide {
    let bounds = scene.rays.bounds();
    let field = Field::random(
        bounds.min,
        bounds.max,
        crate::guide::ModelKind::default(),
        seed,
    );
    let fractions = Fractions::new(&field);
    Guide { field, fractions }
}
