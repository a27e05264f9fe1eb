//! Distances that are drawn by lights, against their density, at any scale.

use super::*;
use crate::medium::Segment;

/// A lamp in two places and one that is far away.
fn lamps(scale: f32) -> Lights {
    let places = [
        Vec3::new(0.0, 1.0, 3.0),
        Vec3::new(-0.5, 0.0, 8.0),
        Vec3::new(1e4, 0.0, 0.0),
    ];
    let emitters = places.map(|position| Emitter::Point {
        position: position * scale,
        intensity: Rgb::ONE,
    });
    Lights::build(emitters.into(), &[], Bounds::EMPTY, Bounds::EMPTY)
}

fn along_z(length: f32) -> Segment {
    Segment {
        origin: Vec3::ZERO,
        direction: Vec3::Z,
        length,
    }
}

/// Bins of a segment, equally long; the last one of an endless segment is endless.
const BINS: usize = 20;
const DRAWS: usize = 200_000;

/// Counts of drawn distances differ from the density of each lamp, integrated, by chance alone:
/// chi-square.
#[test]
fn distances_have_the_density_that_is_claimed() {
    for scale in [1e-6f32, 1.0, 1e6] {
        for length in [10.0f32, 0.01, f32::INFINITY] {
            let lights = lamps(scale);
            let segment = along_z(length * scale);
            let lit = lights.beside(segment, 0.1 / scale).unwrap();
            let step = f64::from(length.min(10.0)) / BINS as f64;
            let mut counts = [0.0; BINS + 1];
            let mut rng = Pcg32::new(5, 1);
            let mut densities_of_draws = 0.0;
            for _ in 0..DRAWS {
                let u = [rng.next_f32(), rng.next_f32()];
                let Some(drawn) = lights.distance_beside(&lit, u) else {
                    continue;
                };
                let at = f64::from(drawn.distance / scale);
                counts[((at / step) as usize).min(BINS)] += 1.0;
                let claimed = lights.pdf_beside(&lit, drawn.leaf, drawn.distance);
                densities_of_draws += f64::from(drawn.pdf / claimed);
            }
            let drawn: f64 = counts.iter().sum();
            assert!((densities_of_draws / drawn - 1.0).abs() < 1e-5);
            let mut chi_square = 0.0;
            let mut whole = 0.0;
            for (bin, count) in counts.iter().take(BINS).enumerate() {
                let fine = 2000;
                let share: f64 = (0..fine)
                    .map(|i| {
                        let at = (bin as f64 + (f64::from(i) + 0.5) / f64::from(fine)) * step;
                        let pdf = |leaf| lights.pdf_beside(&lit, leaf, at as f32 * scale);
                        (0..3).map(pdf).map(f64::from).sum::<f64>() * f64::from(scale)
                    })
                    .sum::<f64>()
                    * step
                    / f64::from(fine);
                whole += share;
                let expected = share * DRAWS as f64;
                chi_square += (count - expected).powi(2) / expected.max(1.0);
            }
            let rest = (1.0 - whole).max(0.0) * DRAWS as f64;
            if length.is_infinite() {
                chi_square += (counts[BINS] - rest).powi(2) / rest.max(1.0);
            } else {
                assert!(
                    rest < 1e-3 * DRAWS as f64,
                    "{scale} {length}: {rest} are missing"
                );
            }
            // 20 degrees of freedom: 1 in a million.
            assert!(chi_square < 65.0, "{scale} {length}: {chi_square}");
        }
    }
}

/// Most of what light samples brings comes from near the lamp: lights draw distances there, and the
/// weights of both ways sum to one for any density of free flight.
#[test]
fn near_a_lamp_distances_are_drawn_by_it() {
    let lights = lamps(1.0);
    let lit = lights.beside(along_z(10.0), 0.1).unwrap();
    let weight = |distance, density| {
        let collision = Collision {
            lit,
            distance,
            density,
        };
        lights.free_flight_weight(&collision, 0)
    };
    assert!(weight(3.0, 0.1) < 0.5, "{}", weight(3.0, 0.1));
    assert!(weight(9.5, 0.1) > 0.5, "{}", weight(9.5, 0.1));
    assert_eq!(weight(3.0, 0.0), 0.0);
    assert_eq!(weight(3.0, f32::INFINITY), 1.0);
}
