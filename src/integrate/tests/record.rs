//! Training samples from paths whose light is made up.

use crate::guide::LightChoice;
use crate::integrate::observer::{Departure, PathObserver, SampledDirection};
use crate::integrate::path::Arrival;
use crate::integrate::training::record::{PathRecords, TrainingSamples};
use crate::math::{Rgb, Vec3};

fn rgb(r: f32, g: f32, b: f32) -> Rgb {
    Rgb::new(r, g, b)
}

fn onward(throughput: Rgb) -> SampledDirection {
    SampledDirection {
        direction: Vec3::Z,
        pdf: 0.5,
        guide_pdf: 0.0,
        bsdf_pdf: 0.5,
        weight: Rgb::ONE,
        survival: 1.0,
        throughput,
    }
}

fn departure(x: f32, onward: Option<SampledDirection>) -> Departure {
    Departure {
        position: Vec3::new(x, 0.0, 0.0),
        normal: Vec3::Z,
        arrival: Arrival {
            throughput: Rgb::ONE,
            radiance: Rgb::ZERO,
        },
        light_probability: None,
        light_choice: LightChoice::NONE,
        direction: onward,
    }
}

fn conclude(records: &mut PathRecords, radiances: &[Rgb]) -> TrainingSamples {
    let mut training_samples = TrainingSamples::default();
    conclude_into(records, radiances, &mut training_samples);
    training_samples
}

fn conclude_into(
    records: &mut PathRecords,
    radiances: &[Rgb],
    training_samples: &mut TrainingSamples,
) {
    records.conclude(radiances, training_samples);
}

/// Two paths, vertex by vertex in turn, as waves advance.
#[test]
fn each_vertex_learns_what_came_after_it_by_the_throughput_it_left_with() {
    let mut r = PathRecords::default();
    let at_first = onward(rgb(0.5, 0.25, 1.0));
    r.depart(0, departure(1.0, Some(at_first)));
    r.depart(1, departure(2.0, Some(onward(Rgb::splat(0.5)))));
    // Path 0 has found (1, 1, 1) by its second vertex, path 1 nothing yet.
    r.arrive(0, Rgb::ONE, 3.0);
    r.arrive(1, Rgb::ZERO, 4.0);
    r.depart(0, departure(5.0, Some(onward(Rgb::splat(0.1)))));
    // Path 0 leaves the scene, path 1 meets a mirror, which makes no record.
    r.arrive(0, rgb(1.0, 1.5, 1.0), f32::INFINITY);
    r.arrive(1, Rgb::splat(7.0), 9.0);
    let training_samples = conclude(&mut r, &[rgb(2.0, 2.0, 1.0), Rgb::splat(8.0)]);
    let got: Vec<_> = training_samples
        .samples
        .iter()
        .map(|s| (s.position.x, s.radiance, s.distance))
        .collect();
    let close = |a: Rgb, b: Rgb| (a - b).abs().max_element() < 1e-5;
    assert_eq!(got.len(), 3);
    assert!(close(got[0].1, rgb(2.0, 4.0, 0.0)), "{got:?}");
    assert!(close(got[1].1, Rgb::splat(16.0)), "{got:?}");
    assert!(close(got[2].1, rgb(10.0, 5.0, 0.0)), "{got:?}");
    assert_eq!(got.iter().map(|g| g.0).collect::<Vec<_>>(), [1.0, 2.0, 5.0]);
    assert_eq!(
        got.iter().map(|g| g.2).collect::<Vec<_>>(),
        [3.0, 4.0, f32::INFINITY]
    );
    assert!(training_samples.fractions.is_empty(), "no field was asked");
}

#[test]
fn a_path_that_ends_is_a_dark_sample_with_its_vertex() {
    let mut r = PathRecords::default();
    r.depart(0, departure(1.0, None));
    let training_samples = conclude(&mut r, &[Rgb::splat(3.0)]);
    let s = training_samples.samples[0];
    assert_eq!((s.radiance, s.pdf), (Rgb::ZERO, 1.0));
    assert_eq!((s.position.x, s.normal), (1.0, Vec3::Z));
}

#[test]
fn roulette_counts_in_the_density_and_an_absorbed_colour_is_dark_not_nan() {
    let mut r = PathRecords::default();
    let on = SampledDirection {
        survival: 0.25,
        throughput: rgb(0.0, 2.0, 2.0),
        ..onward(Rgb::ONE)
    };
    r.depart(0, departure(0.0, Some(on)));
    r.arrive(0, Rgb::ONE, 1.0);
    // Rounding may make the sum fall below the baseline: no light is negative.
    let training_samples = conclude(&mut r, &[rgb(1.0, 3.0, 0.5)]);
    let s = training_samples.samples[0];
    assert_eq!((s.radiance, s.pdf), (rgb(0.0, 1.0, 0.0), 0.125));
}

#[test]
fn light_from_beyond_the_surface_is_taught_to_the_side_it_falls_on() {
    let mut r = PathRecords::default();
    let through = SampledDirection {
        direction: Vec3::new(0.0, 0.6, -0.8),
        ..onward(Rgb::ONE)
    };
    r.depart(0, departure(0.0, Some(through)));
    r.arrive(0, Rgb::ZERO, 1.0);
    let training_samples = conclude(&mut r, &[Rgb::ONE]);
    assert_eq!(training_samples.samples[0].normal, -Vec3::Z);
}

#[test]
fn a_guided_vertex_also_teaches_the_fraction() {
    let mut r = PathRecords::default();
    let on = SampledDirection {
        guide_pdf: 2.0,
        bsdf_pdf: 0.25,
        pdf: 1.125,
        weight: Rgb::splat(0.5),
        survival: 0.5,
        throughput: Rgb::splat(2.0),
        ..onward(Rgb::ONE)
    };
    let asked = Departure {
        arrival: Arrival {
            throughput: Rgb::splat(0.5),
            radiance: Rgb::splat(2.0),
        },
        light_probability: Some(0.25),
        ..departure(0.0, Some(on))
    };
    r.depart(0, asked);
    r.lit(0, Rgb::splat(1.5));
    r.arrive(0, Rgb::ZERO, 1.0);
    // Too late: the vertex is left.
    r.lit(0, Rgb::splat(9.0));
    r.depart(
        0,
        Departure {
            direction: None,
            ..asked
        },
    );
    let training_samples = conclude(&mut r, &[Rgb::splat(6.0)]);
    assert_eq!(training_samples.fractions[1].pdf, 0.0);
    let f = training_samples.fractions[0];
    // 6 - 2 and 1.5, for the throughput 1.
    assert_eq!(
        (f.light, f.light_probability, f.reflected),
        (3.0, 0.25, 8.0)
    );
    // BSDF times cosine is weight times density; radiance is 6 / 2.
    assert_eq!(f.value, Rgb::splat(0.5 * 1.125 * 3.0));
    assert_eq!((f.pdf, f.guide_pdf, f.bsdf_pdf), (0.5625, 2.0, 0.25));
}

#[test]
fn waves_do_not_remember_each_other() {
    let mut r = PathRecords::default();
    r.depart(3, departure(0.0, Some(onward(Rgb::ONE))));
    let outcomes = [Rgb::ZERO, Rgb::ZERO, Rgb::ZERO, Rgb::ONE];
    assert_eq!(conclude(&mut r, &outcomes).samples.len(), 1);
    // The record of slot 3 was never closed; the next wave's slot 3 starts afresh.
    r.arrive(3, Rgb::splat(9.0), 9.0);
    r.arrive(99, Rgb::ZERO, 1.0);
    assert!(conclude(&mut r, &outcomes).samples.is_empty());
    let mut all = TrainingSamples::default();
    for x in [1.0, 2.0] {
        r.depart(0, departure(x, Some(onward(Rgb::ONE))));
        conclude_into(&mut r, &outcomes, &mut all);
    }
    let order: Vec<f32> = all.samples.iter().map(|s| s.position.x).collect();
    assert_eq!(order, [1.0, 2.0]);
}
