//! Camera paths that are traced for training alone, without an image.

use super::count::add_traced;
use super::record::{PathRecords, TrainingSamples};
use crate::camera::CameraRay;
use crate::integrate::context::{PathContext, View};
use crate::integrate::guiding::Guidance;
use crate::integrate::progress::Stop;
use crate::integrate::settings::PathSettings;
use crate::integrate::wave::{LONG, Wave};
use crate::math::{PathSampler, Vec2};
use rayon::prelude::*;
use std::ops::Range;

/// Camera paths in a wave.
const WAVE_PATHS: u64 = 4096;

/// Traces camera paths, in waves side by side; the training samples of each, in order. Path `i` of
/// a film of n pixels looks through a pixel of its own, so that a long enough run covers the film
/// evenly. No path is endless: there is no image whose mean that could change. `None` if it was
/// stopped.
pub(super) fn training_samples(
    view: &View,
    guide: Option<Guidance>,
    range: Range<u64>,
    stop: Stop,
) -> Option<Vec<TrainingSamples>> {
    let starts: Vec<u64> = range.clone().step_by(WAVE_PATHS as usize).collect();
    let settings = PathSettings {
        max_depth: view.settings.max_depth.min(LONG),
        ..view.settings.clone()
    };
    let context = PathContext {
        settings: &settings,
        guide,
        ..view.context()
    };
    starts
        .par_iter()
        .map_init(<(Wave, PathRecords)>::default, |(wave, records), &from| {
            if stop() {
                return None;
            }
            wave.clear();
            for i in from..(from + WAVE_PATHS).min(range.end) {
                let (ray, sampler) = training_ray(view, i);
                wave.push(ray, sampler);
            }
            let mut training_samples = TrainingSamples::default();
            let radiances = wave.trace(&context, records);
            add_traced(WAVE_PATHS.min(range.end - from));
            records.conclude(radiances, &mut training_samples);
            Some(training_samples)
        })
        .collect()
}

/// Camera ray `i` of training and the numbers of its path.
fn training_ray(view: &View, i: u64) -> (CameraRay, PathSampler) {
    let (w, h) = (u64::from(view.film.width), u64::from(view.film.height));
    // Steps of the golden ratio visit all pixels in turn and neighbours far apart.
    let pixel = ((i as f64 * 0.618_033_988_749_894_9).fract() * (w * h) as f64) as u64 % (w * h);
    let mut sampler = PathSampler::independent(view.settings.seed ^ TRAINING, pixel, i);
    let u = sampler.next4();
    let at = Vec2::new((pixel % w) as f32 + u[0], (pixel / w) as f32 + u[1]);
    let ray = view.camera.ray(at, Vec2::new(u[2], u[3]));
    (ray, sampler)
}

/// Sets the numbers of training paths apart from the image's.
const TRAINING: u64 = 0x5851_f42d_4c95_7f2d;
