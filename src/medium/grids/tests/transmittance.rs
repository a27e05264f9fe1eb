//! The mean of estimated transmittance, and of escapes, against quadrature.

use super::*;

const DRAWS: u32 = 2_000_000;
/// What all bounds stay below, as a share of the mean: an error of 1 % is found, by another four
/// standard errors.
const POWER: f64 = 0.005;
/// No ray takes more draws than this.
const MAX_DRAWS: u32 = 1 << 20;

/// A medium of random values, some of them 0, with a random albedo on another grid; the largest
/// optical depth along a ray is `depth`.
fn random(channels: u32, lookup: Lookup, (org, dir): (Vec3, Vec3), depth: f32) -> Heterogeneous {
    let mut rng = Pcg32::new(40, u64::from(channels));
    let place = odd_place();
    let value = || (rng.next_f32() * 1.5 - 0.5).max(0.0);
    let density = grid([9, 7, 10], channels, place, lookup, value);
    let elsewhere = place * Affine3A::from_scale(Vec3::splat(1.3));
    let value = || 0.5 + 0.5 * rng.next_f32();
    let albedo = Albedo::Grid(grid([3, 2, 4], 3, elsewhere, lookup, value));
    let medium = Heterogeneous::new(density.clone(), 1.0, albedo.clone()).unwrap();
    let unit = medium.optical_depth(org, dir, f32::INFINITY).max_element();
    Heterogeneous::new(density, depth / unit, albedo).unwrap()
}

/// Checks transmittance, escapes and the light that first collisions scatter along a ray.
fn check(medium: &Heterogeneous, org: Vec3, dir: Vec3, distance: f32, seed: u64, what: &str) {
    let mut rng = Pcg32::new(seed, 1);
    let (through, scattered) = expected(medium, org, dir, distance);
    let [mut ratio, mut escaped, mut collided] = [(); 3].map(|()| Mean::default());
    for i in 0..DRAWS {
        let mut draws = 0;
        let mut u = || {
            draws += 1;
            rng.next_f32()
        };
        ratio.add(medium.transmittance(org, dir, distance, &mut u));
        // What a path brings changes the noise, not the mean.
        let mut weights = [Rgb::ONE, Rgb::new(1.6, 0.9, 0.5)][i as usize % 2];
        let flight = medium.sample(org, dir, distance, &mut weights, &mut u);
        let is_through = flight.collision.is_none();
        let of = |counts: bool| if counts { flight.factor } else { Rgb::ZERO };
        escaped.add(of(is_through));
        collided.add(of(!is_through));
        assert!(draws < MAX_DRAWS, "{what}: a ray of {draws} draws");
        assert!((weights.element_sum() - 3.0).abs() < 1e-5, "{weights}");
        assert!(
            flight
                .collision
                .is_none_or(|t| (0.0..=distance).contains(&t))
        );
    }
    ratio.check(through, POWER, &format!("{what}: transmittance"));
    escaped.check(through, POWER, &format!("{what}: escapes"));
    collided.check(scattered, POWER, &format!("{what}: collisions"));
}

/// Checks rays through random media with some of the look-ups.
fn check_random(channels: u32, stride: usize) {
    let mut rng = Pcg32::new(9, u64::from(channels));
    for (i, lookup) in lookups().enumerate().step_by(stride).take(3) {
        let (org, dir) = ray(&odd_place(), &mut rng);
        let medium = random(channels, lookup, (org, dir), 1.1);
        let what = format!("{lookup:?}, {channels} channels");
        check(&medium, org, dir, 12.0, i as u64, &what);
    }
}

#[test]
fn random_grey_media_have_the_transmittance_of_quadrature() {
    check_random(1, 3);
}

#[test]
fn random_coloured_media_have_the_transmittance_of_quadrature() {
    check_random(3, 2);
}

/// A point and a direction within the random media.
fn within() -> (Vec3, Vec3) {
    let place = odd_place();
    let dir = place.transform_vector3(Vec3::new(0.3, 0.9, 0.5));
    (
        place.transform_point3(Vec3::new(0.2, 0.1, 0.3)),
        dir.normalize(),
    )
}

#[test]
fn so_they_have_from_within_and_up_to_a_surface() {
    let (org, dir) = within();
    for (i, distance) in [1.0, 1.7].into_iter().enumerate() {
        let medium = random(3, Lookup::default(), (org, dir), 1.5);
        check(&medium, org, dir, distance, 20 + i as u64, "within");
    }
}

#[test]
fn a_glaring_voxel_does_not_stop_a_ray_that_passes_beside_it() {
    // Interpolation ends at the centres of its neighbours: a little inside them depths are about 1,
    // below majorants that are a billion times as high.
    let peak = 3 * (8 + 16 * (8 + 16 * 8));
    let mut i = 0;
    let value = || {
        i += 1;
        match i - 1 - peak {
            0 => 4e9,
            1 => 1.2e10,
            2 => 7e9,
            _ => 0.3,
        }
    };
    let density = grid([16; 3], 3, Affine3A::IDENTITY, Lookup::default(), value);
    let mut rng = Pcg32::new(17, 0);
    let value = || 0.5 + 0.5 * rng.next_f32();
    let albedo = grid([5; 3], 3, Affine3A::IDENTITY, Lookup::default(), value);
    let medium = Heterogeneous::new(density, 1.0, Albedo::Grid(albedo)).unwrap();
    let beside = 7.5 / 16.0 + 2.5e-6;
    let org = Vec3::new(-0.2, beside, beside);
    let depth = medium.optical_depth(org, Vec3::X, 9.0);
    assert!(
        depth.min_element() > 0.5 && depth.max_element() < 2.0,
        "{depth}"
    );
    // The grid begins and ends between two steps of the quadrature.
    check(&medium, org, Vec3::X, 1.6, 30, "beside");
}

#[test]
fn a_strongly_chromatic_medium_scatters_what_quadrature_says() {
    let mut rng = Pcg32::new(11, 0);
    let mut i = 0;
    // Optical depths of about 0.4, 2 and 12 in the three channels.
    let value = || {
        i += 1;
        (0.5 + rng.next_f32()) * [0.4, 2.0, 12.0][(i - 1) % 3]
    };
    let density = grid([6, 5, 4], 3, Affine3A::IDENTITY, Lookup::default(), value);
    let albedo = Albedo::Constant(Rgb::new(0.99, 0.6, 0.2));
    let medium = Heterogeneous::new(density, 1.0, albedo).unwrap();
    let (org, dir) = (Vec3::new(0.4, 0.3, -1.0), Vec3::Z);
    let (_, scattered) = expected(&medium, org, dir, 3.0);
    let mut mean = Mean::default();
    let mut u = || rng.next_f32();
    for _ in 0..DRAWS {
        let mut weights = Rgb::ONE;
        let flight = medium.sample(org, dir, 3.0, &mut weights, &mut u);
        if flight.collision.is_some() {
            // By the balance heuristic no factor exceeds the number of channels.
            assert!(flight.factor.max_element() <= 3.0 + 1e-5, "{flight:?}");
        }
        mean.add(match flight.collision {
            Some(_) => flight.factor,
            None => Rgb::ZERO,
        });
    }
    mean.check(scattered, POWER, "single scattering");
}

#[test]
fn two_flights_carry_what_the_first_has_decided() {
    // Through the first half and then through the second is the same as through all.
    let mut rng = Pcg32::new(12, 0);
    let (org, dir) = within();
    let medium = random(3, Lookup::default(), (org, dir), 1.2);
    let (through, _) = expected(&medium, org, dir, 2.0);
    let mut mean = Mean::default();
    let mut u = || rng.next_f32();
    for _ in 0..DRAWS {
        let mut weights = Rgb::ONE;
        let mut factor = Rgb::ONE;
        for from in [org, org + dir] {
            let flight = medium.sample(from, dir, 1.0, &mut weights, &mut u);
            factor *= match flight.collision {
                Some(_) => Rgb::ZERO,
                None => flight.factor,
            };
        }
        assert!(factor.max_element() <= 3.0 + 1e-4, "{factor}");
        mean.add(factor);
    }
    mean.check(through, POWER, "two flights");
}

#[test]
fn grey_media_leave_the_weights_as_they_are() {
    let mut rng = Pcg32::new(13, 0);
    let (org, dir) = ray(&odd_place(), &mut rng);
    let medium = random(1, Lookup::default(), (org, dir), 1.0);
    let mut u = || rng.next_f32();
    let before = Rgb::new(2.0, 0.7, 0.3);
    for _ in 0..1000 {
        let mut weights = before;
        let flight = medium.sample(org, dir, f32::INFINITY, &mut weights, &mut u);
        assert_eq!(weights, before);
        let albedo = flight.collision.map(|t| medium.albedo(org + dir * t));
        let off = (flight.factor - albedo.unwrap_or(Rgb::ONE)).abs();
        assert!(off.max_element() < 1e-5, "{off}");
    }
}
