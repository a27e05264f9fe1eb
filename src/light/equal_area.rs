//! Squares of equal areas as maps of latitude by longitude.

use crate::math::equal_area::sphere_to_square;
use crate::math::{Rgb, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Directions a texel is the mean of, along each axis.
const PLACES: usize = 4;

/// The map of a square of `side` by `side` texels, in the layout of [`super::latlong::LatLong`],
/// and its size. A texel of the square is constant, as in pbrt; the map's texels are as fine, each
/// the mean of its own part of the sphere. What comes from all directions together stays the same.
pub(super) fn to_lat_long(side: usize, square: &[Rgb]) -> ([usize; 2], Vec<Rgb>) {
    let [width, height] = [2 * side, side + 1];
    let texel = |dir: Vec3| {
        let at = sphere_to_square(dir) * side as f32;
        let [x, y] = at.to_array().map(|x| (x as usize).min(side - 1));
        square[y * side + x]
    };
    let row = |y: usize| -> Vec<Rgb> {
        let mean = |x: usize| {
            let (mut sum, mut weights) = (Rgb::ZERO, 0.0);
            for i in 0..PLACES * PLACES {
                let within = |k: usize| (k as f32 + 0.5) / PLACES as f32;
                let column = x as f32 + within(i % PLACES);
                let latitude = y as f32 - 0.5 + within(i / PLACES);
                let theta = latitude * (PI / side as f32);
                let (sin, cos) = theta.sin_cos();
                let phi = column * (TAU / width as f32);
                let dir = Vec3::new(phi.sin() * sin, cos, -phi.cos() * sin);
                // Beyond a pole it goes down on the other side.
                sum += texel(dir.normalize()) * sin.abs();
                weights += sin.abs();
            }
            sum / weights
        };
        (0..width).map(mean).collect()
    };
    let mut pixels: Vec<Rgb> = (0..height).into_par_iter().flat_map_iter(row).collect();
    let given = mean(square.iter().map(|texel| (*texel, 1.0)));
    let weights = (0..height).map(|y| share(y, side));
    let rows = pixels.chunks_exact(width).zip(weights);
    let found = mean(rows.flat_map(|(row, weight)| row.iter().map(move |p| (*p, weight))));
    let correction =
        (given / found.max(Rgb::splat(f32::MIN_POSITIVE))).clamp(Rgb::ZERO, Rgb::splat(2.0));
    pixels.iter_mut().for_each(|p| *p *= correction);
    ([width, height], pixels)
}

/// Part of the sphere that row `y` stands for, when values between rows are linear.
fn share(y: usize, side: usize) -> f64 {
    let step = std::f64::consts::PI / side as f64;
    match y {
        0 => 1.0 - step.sin() / step,
        _ if y == side => 1.0 - step.sin() / step,
        _ => (y as f64 * step).sin() * 2.0 * (1.0 - step.cos()) / step,
    }
}

fn mean(weighted: impl Iterator<Item = (Rgb, f64)>) -> Rgb {
    let (mut sum, mut weights) = (glam::DVec3::ZERO, 0.0);
    for (value, weight) in weighted {
        sum += value.as_dvec3() * weight;
        weights += weight;
    }
    (sum / weights).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::super::latlong::LatLong;
    use super::*;
    use crate::math::equal_area::square_to_sphere;
    use crate::math::{Mat3, Pcg32, Vec2};

    fn map(side: usize, square: &[Rgb]) -> LatLong {
        let (size, pixels) = to_lat_long(side, square);
        LatLong::new(size, pixels, PI, Mat3::IDENTITY).expect("not black")
    }

    /// A square whose values follow the direction: the map has them there.
    #[test]
    fn directions_keep_their_light() {
        let side = 128;
        let color = |dir: Vec3| (dir + Vec3::splat(1.5)) * 2.0;
        let centers = (0..side * side).map(|i| {
            let at = Vec2::new((i % side) as f32 + 0.5, (i / side) as f32 + 0.5);
            square_to_sphere(at / side as f32)
        });
        let square: Vec<Rgb> = centers.map(color).collect();
        let map = map(side, &square);
        let mut rng = Pcg32::new(3, 1);
        for _ in 0..10_000 {
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            let dir = crate::math::warp::uniform_sphere(u);
            let off = (map.radiance(dir) - color(dir)).abs().max_element();
            assert!(off < 0.05, "{dir} {off}");
        }
    }

    /// A sun of one texel, anywhere: as much light as in the square, from the same place.
    #[test]
    fn a_sun_keeps_its_light() {
        let side = 64;
        for i in [0, 5, 64 * 32 + 32, 64 * 63 + 63, 64 * 31 + 12, 4000] {
            let mut square = vec![Rgb::splat(1e-3); side * side];
            square[i] = Rgb::new(5000.0, 4000.0, 3000.0);
            let map = map(side, &square);
            let expected = square.iter().sum::<Rgb>() * (4.0 * PI / (side * side) as f32);
            let off = (map.integral() / expected - 1.0).abs().max_element();
            assert!(off < 3e-3, "{i}: {off}");
            let at = Vec2::new((i % side) as f32 + 0.5, (i / side) as f32 + 0.5) / side as f32;
            let sun = map.radiance(square_to_sphere(at)).x;
            assert!((2000.0..6000.0).contains(&sun), "{i}: {sun}");
        }
    }
}
