//! Synthetic scenes: surfaces, photons and the true light, without a renderer.

use crate::guide::{Photon, Settings, SurfacePoint};
use crate::math::equal_area::DirectionCell;
use crate::math::warp::{cosine_hemisphere, uniform_sphere};
use crate::math::{Frame, Pcg32, Rgb, Vec2, Vec3};

pub fn square(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// Numbers that no record should have.
pub fn odd_number(rng: &mut Pcg32) -> f32 {
    let numbers = [
        f32::NAN,
        f32::INFINITY,
        -f32::INFINITY,
        0.0,
        -1.0,
        1e38,
        1e-45,
        f32::MAX,
    ];
    numbers[rng.next_u32() as usize % numbers.len()]
}

pub fn unit_box() -> Settings {
    Settings::new(Vec3::ZERO, Vec3::ONE)
}

/// A parallelogram.
#[derive(Clone, Copy)]
pub struct Patch {
    pub origin: Vec3,
    pub a: Vec3,
    pub b: Vec3,
}

impl Patch {
    pub fn floor() -> Self {
        Self {
            origin: Vec3::new(0.0, 0.0, 0.25),
            a: Vec3::X,
            b: Vec3::Y,
        }
    }

    pub fn normal(&self) -> Vec3 {
        self.a.cross(self.b).normalize()
    }

    pub fn area(&self) -> f64 {
        f64::from(self.a.cross(self.b).length())
    }

    pub fn point(&self, u: Vec2) -> Vec3 {
        self.origin + self.a * u.x + self.b * u.y
    }

    pub fn surface(&self, n: usize, seed: u64) -> Vec<SurfacePoint> {
        let mut rng = Pcg32::new(seed, 77);
        (0..n)
            .map(|_| SurfacePoint {
                position: self.point(square(&mut rng)),
                normal: self.normal(),
            })
            .collect()
    }

    /// Photons of an environment of constant radiance 1: with `n` of them, each of power area * pi.
    pub fn constant_light(&self, n: usize, seed: u64) -> Vec<Photon> {
        let mut rng = Pcg32::new(seed, 78);
        let frame = Frame::new(self.normal());
        let power = (self.area() * std::f64::consts::PI) as f32;
        (0..n)
            .map(|_| Photon {
                position: self.point(square(&mut rng)),
                direction: frame.to_world(cosine_hemisphere(square(&mut rng))),
                power: Rgb::splat(power),
                distance: f32::INFINITY,
                normal: self.normal(),
            })
            .collect()
    }
}

/// Photons on the unit floor from a point light at `light`: a delta in direction at every point.
pub fn point_light(light: Vec3, n: usize, seed: u64) -> Vec<Photon> {
    let mut rng = Pcg32::new(seed, 79);
    let floor = Patch::floor();
    let mut photons = Vec::with_capacity(n);
    while photons.len() < n {
        let w = uniform_sphere(square(&mut rng));
        let t = (floor.origin.z - light.z) / w.z;
        let p = light + w * t;
        if t.is_nan() || t <= 0.0 || p.x < 0.0 || p.y < 0.0 || p.x >= 1.0 || p.y >= 1.0 {
            continue;
        }
        photons.push(Photon {
            position: p,
            direction: -w,
            power: Rgb::new(1.0, 0.5, 0.25),
            distance: t,
            normal: Vec3::Z,
        });
    }
    photons
}

/// Photons on the unit floor from a glowing disk of radius `r` at `centre`, facing down.
pub fn disk_light(centre: Vec3, r: f32, n: usize, seed: u64) -> Vec<Photon> {
    let mut rng = Pcg32::new(seed, 80);
    let floor = Patch::floor();
    let mut photons = Vec::with_capacity(n);
    while photons.len() < n {
        let d = crate::math::warp::concentric_disk(square(&mut rng)) * r;
        let from = centre + d.extend(0.0);
        let w = -cosine_hemisphere(square(&mut rng));
        let t = (floor.origin.z - from.z) / w.z;
        let p = from + w * t;
        if p.x < 0.0 || p.y < 0.0 || p.x >= 1.0 || p.y >= 1.0 {
            continue;
        }
        photons.push(Photon {
            position: p,
            direction: -w,
            power: Rgb::ONE,
            distance: t,
            normal: Vec3::Z,
        });
    }
    photons
}

/// Integral of `pdf` over the sphere by a rank-1 lattice on the equal-area square.
pub fn integral(n: u32, pdf: impl Fn(Vec3) -> f32) -> f64 {
    let golden = 0.618_033_988_749_894_9f64;
    let sum: f64 = (0..n)
        .map(|i| {
            let u = Vec2::new(
                ((f64::from(i) + 0.5) / f64::from(n)) as f32,
                ((f64::from(i) * golden) % 1.0) as f32,
            );
            f64::from(pdf(crate::math::equal_area::square_to_sphere(u)))
        })
        .sum();
    sum / f64::from(n) * 4.0 * std::f64::consts::PI
}

/// Pearson's statistic of how many samples fell into each of the 64 direction cells of level 3, as a
/// normal deviate. Expected counts are integrals of `pdf` by `side` x `side` midpoints: exact within
/// finer cells of a tree, but for those that a horizon cuts.
pub fn chi_square_z(counts: &[u32; 64], side: u32, pdf: impl Fn(Vec3) -> f32) -> f64 {
    let samples: f64 = counts.iter().map(|&count| f64::from(count)).sum();
    let (mut statistic, mut freedom) = (0.0, -1.0);
    let (mut pooled, mut pooled_count) = (0.0, 0.0);
    for (i, &count) in counts.iter().enumerate() {
        let cell = DirectionCell::containing((i as u32) << 26, 3);
        let sum: f64 = (0..side * side)
            .map(|k| {
                let u = Vec2::new((k % side) as f32 + 0.5, (k / side) as f32 + 0.5) / side as f32;
                f64::from(pdf(cell.direction(u)))
            })
            .sum();
        let expected = sum / f64::from(side * side) * f64::from(cell.solid_angle()) * samples;
        if expected < 5.0 {
            pooled += expected;
            pooled_count += f64::from(count);
            continue;
        }
        statistic += (f64::from(count) - expected).powi(2) / expected;
        freedom += 1.0;
    }
    if pooled >= 5.0 {
        statistic += (pooled_count - pooled).powi(2) / pooled;
        freedom += 1.0;
    }
    // Wilson-Hilferty: the cube root of a chi-square variable is nearly normal.
    let v = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - v)) / v.sqrt()
}
