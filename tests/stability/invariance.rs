//! S1, S2, S8, S26: the size of a scene, its distance from the origin and its brightness do not
//! matter.

use crate::scenes::*;
use crate::support::film_mean;
use crate::table::Table;
use twintree::film::Film;

const SCALES: [f64; 4] = [1e-6, 1e-3, 1e3, 1e6];

/// With the same random numbers only rounding tells the scales apart: a few paths of many turn
/// elsewhere.
#[test]
fn s01_scale() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let path = seed(1);
        let (reference, _) = room(backend).render(&path, 64);
        for scale in SCALES {
            let built = loaded(&room_file(scale, 0.0)).build(backend);
            let (film, _) = built.render(&path, 64);
            let what = format!("scale {scale:e}: mean, relative");
            table.finite("S1", &what, name, &film);
            table.hold("S1", &what, name, 1e-4, mean_difference(&reference, &film));
        }
    }
}

/// Fields are trees over positions: their cells may fall otherwise, the mean may not.
#[test]
fn s01_scale_guided() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let (reference, _) = room(backend).render(&seed(1), 256);
        for scale in [1e-6, 1e6] {
            let built = loaded(&room_file(scale, 0.0)).build(backend);
            let guide = field_of(&built);
            let (film, _) = built.render_guided(&seed(2), 512, Some(&guide));
            let what = format!("scale {scale:e}: worst of 16 blocks, standard errors");
            let who = format!("{name}, guided");
            table.finite("S1", &what, &who, &film);
            table.hold("S1", &what, &who, 4.0, worst_block(&reference, &film));
        }
    }
}

/// A million samples for each scale, other random numbers for each: about two minutes.
#[test]
#[ignore = "slow: ten million samples"]
fn s01_scale_by_a_million_samples() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let (reference, _) = room(backend).render(&seed(1), 1024);
        for (i, scale) in SCALES.into_iter().enumerate() {
            let built = loaded(&room_file(scale, 0.0)).build(backend);
            let (film, _) = built.render(&seed(10 + i as u64), 1024);
            let what = format!("scale {scale:e}, a million samples: mean, relative");
            table.hold("S1", &what, name, 5e-3, mean_difference(&reference, &film));
            let what = format!("scale {scale:e}, a million samples: worst block, standard errors");
            table.hold("S1", &what, name, 4.0, worst_block(&reference, &film));
        }
    }
}

/// Scenes are moved to the origin before any rounding: the images have the same bits.
#[test]
fn s02_offset() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let near = room(backend);
        let near_guide = field_of(&near);
        let plain = near.render(&seed(1), 8).0;
        let guided = near.render_guided(&seed(1), 8, Some(&near_guide)).0;
        for offset in [1e2, 1e4, 1e6, 1e9] {
            let far = loaded(&room_file(1.0, offset)).build(backend);
            let what = format!("offset {offset:e}: pixels of other bits");
            let (film, _) = far.render(&seed(1), 8);
            table.finite("S2", &what, name, &film);
            table.hold("S2", &what, name, 0.0, differing_pixels(&plain, &film));
            let guide = field_of(&far);
            let (film, _) = far.render_guided(&seed(1), 8, Some(&guide));
            let who = format!("{name}, guided");
            table.finite("S2", &what, &who, &film);
            table.hold("S2", &what, &who, 0.0, differing_pixels(&guided, &film));
        }
    }
}

/// The largest relative difference between pixels of `a` and pixels of `b` over `factor`.
fn scaled_difference(a: &Film, b: &Film, factor: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for y in 0..a.height() {
        for x in 0..a.width() {
            let (a, b) = (a.pixel(x, y).mean()[1], b.pixel(x, y).mean()[1] / factor);
            worst = worst.max((a - b).abs() / a.abs().max(1e-3));
        }
    }
    worst
}

#[test]
fn s08_emission() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let (reference, _) = plain_box(0.5, 1.0, backend).render(&seed(1), 64);
        for radiance in [1e-30f32, 1e-10, 1e10, 1e30] {
            let (film, _) = plain_box(0.5, radiance, backend).render(&seed(1), 64);
            let what = format!("radiance {radiance:e}: worst pixel, relative");
            table.finite("S8", &what, name, &film);
            let worst = scaled_difference(&reference, &film, f64::from(radiance));
            table.hold("S8", &what, name, 1e-5, worst);
        }
        let built = plain_box(0.5, 1.0, backend);
        let guide = field_of(&built);
        let (reference, _) = built.render_guided(&seed(1), 64, Some(&guide));
        // Powers of two: others round the sums of the field otherwise, and paths with them.
        for exponent in [-100, -33, 33, 100] {
            let radiance = 2f32.powi(exponent);
            let built = plain_box(0.5, radiance, backend);
            let guide = field_of(&built);
            let (film, _) = built.render_guided(&seed(1), 64, Some(&guide));
            let what = format!("radiance 2^{exponent}: worst pixel, relative");
            let who = format!("{name}, guided");
            table.finite("S8", &what, &who, &film);
            let worst = scaled_difference(&reference, &film, f64::from(radiance));
            table.hold("S8", &what, &who, 1e-5, worst);
        }
    }
}

/// What guiding gains: the variance of a ray's worth of samples without it over that with it.
fn gain(scale: f64, backend: twintree::accel::Backend) -> f64 {
    let built = loaded(&room_file(scale, 0.0)).build(backend);
    let guide = field_of(&built);
    let cost = |guide| {
        let (film, summary) = built.render_guided(&seed(4), 128, guide);
        let (mean, error) = film_mean(&film);
        (error / mean).powi(2) * summary.rays as f64
    };
    cost(None) / cost(Some(&guide))
}

#[test]
fn s26_gain_of_guiding() {
    let mut table = Table::default();
    let (name, backend) = backends()[0];
    let reference = gain(1.0, backend);
    for scale in [1e-6, 1e6] {
        let what = format!("scale {scale:e}: gain of guiding, relative");
        let change = (gain(scale, backend) / reference - 1.0).abs();
        table.hold("S26", &what, &format!("{name}, guided"), 0.05, change);
    }
}
