//! Radiance from far away as a latitude-longitude image, sampled by importance.
//!
//! The layout is Mitsuba 3's: local +y is up, row 0 is the zenith and the last row the end of the
//! map (the nadir); column centres lie half a column apart from the seam, which is at local -z.
//! Values are bilinear between texels, and so is the density where neighbours differ (see
//! `blocks`): a cell between four texels is chosen by the sum of their weights (brightness times
//! sine of the polar angle), then a place in it from the bilinear patch through them. Where a sun
//! covers a few texels the density follows its flanks exactly.

use super::blocks::Blocks;
use super::caustic_emitter::{BRIGHT, CausticEmitter, LEAST_SHARE};
use crate::math::distribution::sample_linear;
use crate::math::rgb::selection_weight;
use crate::math::{Mat3, Rgb, Vec2, Vec3, luminance};
use glam::FloatExt;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A latitude-longitude image ready to sample.
#[derive(Debug)]
pub(super) struct LatLong {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
    cells: Blocks,
    /// Polar angle of the last row.
    theta_max: f32,
    to_world: Mat3,
    to_local: Mat3,
    integral: Rgb,
}

/// The four texels around a direction and where it lies between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    x: u32,
    y: u32,
    at: Vec2,
}

impl LatLong {
    /// Takes over `pixels` (rows from the top). `None` if the image is black or smaller than 1 by
    /// 2. `theta_max` is the polar angle of the last row: pi for the whole sphere.
    pub fn new(size: [usize; 2], pixels: Vec<Rgb>, theta_max: f32, to_world: Mat3) -> Option<Self> {
        let [width, height] = size;
        if width == 0 || height < 2 || pixels.len() != width * height {
            return None;
        }
        let step = theta_max / (height - 1) as f32;
        let row_weight: Vec<f32> = (0..height)
            .map(|y| {
                // At a pole the sine is 0, but the cells beside it are not: a quarter of a row's
                // width keeps a bright pole from never being sampled.
                (y as f32 * step).sin().max((0.25 * step).sin())
            })
            .collect();
        let cells = Blocks::new(width, row_weight, |x, y| {
            selection_weight(pixels[y * width + x])
        })?;
        let integral = integrate(&pixels, size, theta_max);
        let to_world = turn(to_world);
        Some(Self {
            width,
            height,
            pixels,
            cells,
            theta_max,
            to_world,
            to_local: to_world.transpose(),
            integral,
        })
    }

    /// Luminance that falls on a plane from the side of its normal `up`, a unit vector.
    pub fn illuminance(&self, up: Vec3) -> f32 {
        let texels = (0..self.pixels.len()).map(|i| {
            let (row, column) = ((i / self.width) as f32, (i % self.width) as f32 + 0.5);
            let (dir, sin_theta) = self.direction(column, row);
            let step = self.theta_max / (self.height - 1) as f32;
            let area = sin_theta * step * (TAU / self.width as f32);
            f64::from(luminance(self.pixels[i]) * area * dir.dot(up).max(0.0))
        });
        texels.sum::<f64>() as f32
    }

    /// Integral of the radiance over all directions.
    pub fn integral(&self) -> Rgb {
        self.integral
    }

    /// The sun, if there is one.
    pub fn caustic_emitter(&self) -> Option<CausticEmitter> {
        let bright = selection_weight(self.integral) * (BRIGHT / (4.0 * PI));
        let suns = (0..self.pixels.len()).filter(|&i| selection_weight(self.pixels[i]) > bright);
        let suns: Vec<(Vec3, f64)> = suns.map(|i| self.texel(i)).collect();
        let flux: f64 = suns.iter().map(|(_, flux)| flux).sum();
        if flux < f64::from(selection_weight(self.integral) * LEAST_SHARE) {
            return None;
        }
        let sum: glam::DVec3 = suns.iter().map(|(dir, f)| dir.as_dvec3() * *f).sum();
        let center = sum.as_vec3().normalize_or_zero();
        let farthest = suns
            .iter()
            .map(|(dir, _)| (*dir - center).length())
            .fold(0.0, f32::max);
        // Values are bilinear between texels: the rim reaches to the next ones.
        let texel = (TAU / self.width as f32).max(self.theta_max / (self.height - 1) as f32);
        CausticEmitter::sun(center, farthest + texel)
    }

    /// The world direction of a texel, and the light that comes from there, per area.
    fn texel(&self, i: usize) -> (Vec3, f64) {
        let (row, column) = ((i / self.width) as f32, (i % self.width) as f32 + 0.5);
        let (dir, sin_theta) = self.direction(column, row);
        let step = self.theta_max / (self.height - 1) as f32;
        let area = sin_theta * step * (TAU / self.width as f32);
        let flux = selection_weight(self.pixels[i]) * area;
        (dir, f64::from(flux))
    }

    /// The world direction of a place, in texels from the map's corner, and the sine of its polar
    /// angle.
    #[inline]
    fn direction(&self, column: f32, row: f32) -> (Vec3, f32) {
        let phi = column * (TAU / self.width as f32);
        let theta = row * (self.theta_max / (self.height - 1) as f32);
        let (sin_theta, cos_theta) = theta.sin_cos();
        let (sin_phi, cos_phi) = phi.sin_cos();
        let dir = Vec3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta);
        (self.to_world * dir, sin_theta)
    }

    /// Radiance from the world direction `dir`.
    #[inline]
    pub fn radiance(&self, dir: Vec3) -> Rgb {
        self.patch(dir)
            .map_or(Rgb::ZERO, |(patch, _)| self.radiance_of(&patch))
    }

    /// Radiance at a place of the map.
    #[inline]
    pub fn radiance_of(&self, patch: &Patch) -> Rgb {
        bilinear(self.texels(patch), patch.at)
    }

    /// Reads a word of what [`LatLong::radiance_of`] will read.
    #[inline]
    pub fn prefetch(&self, patch: &Patch) -> u32 {
        let upper = patch.y as usize * self.width + patch.x as usize;
        self.pixels[upper].x.to_bits() ^ self.pixels[upper + self.width].x.to_bits()
    }

    /// Radiance from the world direction `dir` and the density of [`LatLong::sample`] there.
    #[inline]
    pub fn radiance_pdf(&self, dir: Vec3) -> (Rgb, f32) {
        let Some((patch, sin_theta)) = self.patch(dir) else {
            return (Rgb::ZERO, 0.0);
        };
        let texels = self.texels(&patch);
        let cell = [patch.x as usize, patch.y as usize];
        let (mean, fine) = self.cells.density(cell, patch.at);
        let density = if fine {
            mean * Self::relative(&patch, self.weights(&patch, &texels))
        } else {
            mean
        };
        let pdf = self.per_solid_angle(density, sin_theta);
        (bilinear(texels, patch.at), pdf)
    }

    /// A world direction, the place of the map that its radiance comes from, and the density.
    /// Directions below the horizon of `n` (zero: there is none) are drawn, but come to nothing.
    #[inline]
    pub fn sample(&self, n: Vec3, u: Vec2) -> Option<(Vec3, Patch, f32)> {
        let drawn = self.cells.sample(u);
        let mut patch = Patch {
            x: drawn.cell[0] as u32,
            y: drawn.cell[1] as u32,
            at: drawn.at,
        };
        let mut density = drawn.density;
        if drawn.fine {
            let w = self.weights(&patch, &self.texels(&patch));
            let t = sample_linear(w[0] + w[1], w[2] + w[3], drawn.at.y);
            let s = sample_linear(w[0].lerp(w[2], t), w[1].lerp(w[3], t), drawn.at.x);
            patch.at = Vec2::new(s, t);
            density *= Self::relative(&patch, w);
        }
        let column = patch.x as f32 + 0.5 + patch.at.x;
        let (dir, sin_theta) = self.direction(column, patch.y as f32 + patch.at.y);
        let pdf = self.per_solid_angle(density, sin_theta);
        let above = n == Vec3::ZERO || dir.dot(n) > 0.0;
        (above && pdf > 0.0).then_some((dir, patch, pdf))
    }

    /// The patch a world direction lies in, and the sine of its polar angle; `None` beyond the
    /// map's last row.
    #[inline]
    fn patch(&self, dir: Vec3) -> Option<(Patch, f32)> {
        let d = self.to_local * dir;
        let sin_theta = Vec2::new(d.x, d.z).length();
        let theta = angle(sin_theta, d.y);
        let v = theta / self.theta_max * (self.height - 1) as f32;
        // Also sends a direction that is not a number away.
        if theta.is_nan() || theta > self.theta_max {
            return None;
        }
        let u = angle(d.x, -d.z) * (0.5 * FRAC_1_PI);
        let u = (u - u.floor()) * self.width as f32 - 0.5;
        let u = if u < 0.0 { u + self.width as f32 } else { u };
        let x = (u as usize).min(self.width - 1);
        let y = (v as usize).min(self.height - 2);
        let at = Vec2::new(u - x as f32, v - y as f32);
        let patch = Patch {
            x: x as u32,
            y: y as u32,
            at: at.clamp(Vec2::ZERO, Vec2::ONE),
        };
        Some((patch, sin_theta))
    }

    #[inline]
    fn texels(&self, p: &Patch) -> [Rgb; 4] {
        let (x, y) = (p.x as usize, p.y as usize);
        let right = if x + 1 == self.width { 0 } else { x + 1 };
        let (upper, lower) = (y * self.width, (y + 1) * self.width);
        [upper + x, upper + right, lower + x, lower + right].map(|i| self.pixels[i])
    }

    /// Sampling weights of the four texels.
    #[inline]
    fn weights(&self, p: &Patch, texels: &[Rgb; 4]) -> [f32; 4] {
        let y = p.y as usize;
        let (upper, lower) = (self.cells.row_weight(y), self.cells.row_weight(y + 1));
        [
            selection_weight(texels[0]) * upper,
            selection_weight(texels[1]) * upper,
            selection_weight(texels[2]) * lower,
            selection_weight(texels[3]) * lower,
        ]
    }

    /// Density at a place of a patch over its mean: bilinear between the weights of its corners.
    #[inline]
    fn relative(p: &Patch, w: [f32; 4]) -> f32 {
        let sum = w[0] + w[1] + w[2] + w[3];
        if sum <= 0.0 {
            return 0.0;
        }
        let (upper, lower) = (w[0].lerp(w[1], p.at.x), w[2].lerp(w[3], p.at.x));
        4.0 * upper.lerp(lower, p.at.y) / sum
    }

    /// From a density over the unit square of the map.
    #[inline]
    fn per_solid_angle(&self, density: f32, sin_theta: f32) -> f32 {
        if sin_theta <= 0.0 {
            return 0.0;
        }
        density / (TAU * self.theta_max * sin_theta)
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.pixels.len() * size_of::<Rgb>() + self.cells.memory_bytes()
    }
}

/// What a transform does to directions, if it neither stretches nor shears them: it turns them, and
/// may mirror them.
fn turn(to_world: Mat3) -> Mat3 {
    let y = to_world.y_axis.normalize_or(Vec3::Y);
    let across = y.any_orthonormal_vector();
    let z = to_world.z_axis.normalize_or(across);
    let z = z.reject_from_normalized(y).normalize_or(across);
    let x = y.cross(z);
    let mirrored = x.dot(to_world.x_axis) < 0.0;
    Mat3::from_cols(if mirrored { -x } else { x }, y, z)
}

/// `y.atan2(x)` to 3e-7, several times faster than the library's: a hundredth of a texel of a map
/// 100 000 texels wide. The arc tangent's polynomial on `[-tan(pi/8), tan(pi/8)]` is Cephes'
/// (Moshier).
#[inline]
fn angle(y: f32, x: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = if ay > ax { (ax, ay) } else { (ay, ax) };
    // atan(t) = pi/4 + atan((t - 1) / (t + 1)).
    let (num, base) = if small > 0.414_213_56 * large {
        (small - large, FRAC_PI_4)
    } else {
        (small, 0.0)
    };
    let den = if base > 0.0 { small + large } else { large };
    let t = num / den.max(f32::MIN_POSITIVE);
    let z = t * t;
    let series = ((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1;
    let mut angle = base + (series * z * t + t);
    if ay > ax {
        angle = FRAC_PI_2 - angle;
    }
    if x < 0.0 {
        angle = PI - angle;
    }
    angle.copysign(y)
}

#[inline]
fn bilinear(c: [Rgb; 4], at: Vec2) -> Rgb {
    let upper = c[0] * (1.0 - at.x) + c[1] * at.x;
    let lower = c[2] * (1.0 - at.x) + c[3] * at.x;
    upper * (1.0 - at.y) + lower * at.y
}

/// Integral of the bilinear radiance over solid angle: each row's mean times the integral of the
/// sine under the row's hat function.
fn integrate(pixels: &[Rgb], [width, height]: [usize; 2], theta_max: f32) -> Rgb {
    let step = f64::from(theta_max) / (height - 1) as f64;
    // Of the sine times a ramp from 0 at a to 1 at b (and for b < a the same with its sign turned).
    let ramp = |a: f64, b: f64| (b.sin() - a.sin()) / (b - a) - b.cos();
    let mut total = glam::DVec3::ZERO;
    for y in 0..height {
        let row = &pixels[y * width..][..width];
        let sum: glam::DVec3 = row.iter().map(|c| c.as_dvec3()).sum();
        let theta = y as f64 * step;
        let mut hat = 0.0;
        if y > 0 {
            hat += ramp(theta - step, theta);
        }
        if y + 1 < height {
            hat -= ramp(theta + step, theta);
        }
        total += sum * hat;
    }
    (total * (std::f64::consts::TAU / width as f64)).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transform_turns_and_mirrors_but_does_not_stretch() {
        let rotation = Mat3::from_rotation_y(0.7) * Mat3::from_rotation_x(-1.9);
        for mirror in [1.0, -1.0] {
            let exact = rotation * Mat3::from_diagonal(Vec3::new(mirror, 1.0, 1.0));
            for scale in [1e-15, 1.0, 1e15] {
                assert!(turn(exact * scale).abs_diff_eq(exact, 1e-6), "{scale}");
            }
        }
        for odd in [Mat3::ZERO, Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::Y)] {
            let turned = turn(odd);
            assert!((turned * turned.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-6));
        }
    }

    #[test]
    fn angles_are_those_of_the_library() {
        for i in 0..100_000 {
            let phi = (f64::from(i) + 0.3) * std::f64::consts::TAU / 100_000.0;
            let (sin, cos) = phi.sin_cos();
            let (y, x) = (sin as f32 * 3.0, cos as f32 * 3.0);
            let exact = f64::from(y).atan2(f64::from(x));
            assert!((f64::from(angle(y, x)) - exact).abs() < 3e-7, "{y} {x}");
        }
        assert!(angle(0.0, 0.0) == 0.0 && angle(f32::NAN, 1.0).is_nan());
        assert_eq!(
            [angle(0.0, 1.0), angle(1.0, 0.0), angle(0.0, -1.0)],
            [0.0, FRAC_PI_2, PI]
        );
    }
}
