//! The medium `cloud`: noise that thins out upwards (Pharr, Jakob and Humphreys, "Physically Based
//! Rendering", 4th edition, section 11.4.5). pbrt follows the formula at every point; here it is
//! put on a grid of voxels.

use super::importer::Importer;
use super::params::Params;
use super::subsurface::homogeneous;
use crate::math::{DVec3, Vec3};
use crate::medium::Extinction;
use crate::medium::grids::Wrap;
use crate::texture::noise;
use rayon::prelude::*;

/// Voxels for each cell of the coarsest noise: two for each of the finest of five octaves, each 1.99
/// times finer than the one before.
const VOXELS_PER_CELL: f64 = 32.0;
/// Voxels along an axis.
const RESOLUTION: [f64; 2] = [16.0, 192.0];
/// Clouds of a scene: each takes seconds and up to 28 MB, or three times that.
const MOST_CLOUDS: usize = 16;

/// What shapes a cloud.
struct Cloud {
    density: f32,
    wispiness: f32,
    frequency: f32,
}

impl<'s> Importer<'s> {
    /// The density of a cloud on a grid, times coefficients.
    pub fn cloud(&mut self, p: &Params<'_, 's>) -> Result<Extinction, String> {
        self.clouds += 1;
        if self.clouds > MOST_CLOUDS {
            return Err(format!("more than {MOST_CLOUDS} clouds are refused"));
        }
        let (sigma_a, sigma_s) = self.coefficients(p)?;
        let cloud = Cloud {
            density: p.float("density", 1.0) as f32,
            wispiness: p.float("wispiness", 1.0) as f32,
            frequency: p.float("frequency", 5.0) as f32,
        };
        let (from, to) = (p.triple("p0", DVec3::ZERO), p.triple("p1", DVec3::ONE));
        let cells = (to - from).abs() * f64::from(cloud.frequency.abs()) * VOXELS_PER_CELL;
        let [least, most] = RESOLUTION;
        let resolution = cells.to_array().map(|n| n.ceil().clamp(least, most) as u32);
        let [x, y, z] = resolution;
        self.warn_at(
            p.at(),
            &format!(
                "this cloud is a grid of {x} x {y} x {z} voxels: what is finer in pbrt is smooth"
            ),
        );
        let medium = homogeneous(sigma_a, sigma_s);
        let densities = densities(&cloud, resolution, [from.as_vec3(), to.as_vec3()]);
        self.of_density(p, resolution, &densities, &medium, 1.0, Wrap::Clamp)
    }
}

/// Densities at the centres of voxels between two corners.
fn densities(cloud: &Cloud, [nx, ny, nz]: [u32; 3], [from, to]: [Vec3; 2]) -> Vec<f32> {
    let step = (to - from) / Vec3::new(nx as f32, ny as f32, nz as f32);
    let at = |x, y, z| cloud.density(from + step * (Vec3::new(x as f32, y as f32, z as f32) + 0.5));
    let rows = (0..ny * nz).into_par_iter();
    rows.flat_map_iter(|row| (0..nx).map(move |x| at(x, row % ny, row / ny)))
        .collect()
}

impl Cloud {
    /// Density at a point, 0 to 1.
    fn density(&self, p: Vec3) -> f32 {
        let mut at = p * self.frequency;
        if self.wispiness > 0.0 {
            let (mut strength, mut finer) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                at += strength * slope(at * finer);
                strength *= 0.5;
                finer *= 1.99;
            }
        }
        let (mut sum, mut share, mut finer) = (0.0, 0.5, 1.0);
        for _ in 0..5 {
            sum += share * noise(at * finer);
            share *= 0.5;
            finer *= 1.99;
        }
        let density = ((1.0 - p.y) * 4.5 * self.density * sum).clamp(0.0, 1.0);
        (density + 2.0 * (0.5 - p.y).max(0.0)).clamp(0.0, 1.0)
    }
}

/// The gradient of noise, by differences as in pbrt.
fn slope(p: Vec3) -> Vec3 {
    const STEP: f32 = 0.01;
    let here = noise(p);
    Vec3::from_array([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| noise(p + axis * STEP) - here)) / STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOUD: Cloud = Cloud {
        density: 2.0,
        wispiness: 1.0,
        frequency: 5.0,
    };

    /// The floor of a cloud is full, its top empty, and no density leaves 0 to 1.
    #[test]
    fn clouds_thin_out_upwards() {
        let resolution = [24, 32, 16];
        let values = densities(&CLOUD, resolution, [Vec3::ZERO, Vec3::ONE]);
        assert_eq!(values.len(), 24 * 32 * 16);
        assert!(values.iter().all(|d| (0.0..=1.0).contains(d)));
        let layer = |y: usize| {
            let rows = values.chunks_exact(24).skip(y).step_by(32);
            rows.flatten().sum::<f32>() / (24.0 * 16.0)
        };
        // Below a half there is density without noise: 31/32 at the centres of the first layer.
        assert!((0.968_75..=1.0).contains(&layer(0)), "{}", layer(0));
        assert!(layer(31) < 0.05 && layer(31) < layer(20), "{}", layer(31));
        let some = values.iter().filter(|d| **d > 0.0 && **d < 1.0).count();
        assert!(some > 1000, "{some}");
    }

    /// Voxels lie in the order of the grid, x first, and hold the value at their centres.
    #[test]
    fn voxels_hold_the_density_at_their_centres() {
        let values = densities(
            &CLOUD,
            [4, 8, 2],
            [Vec3::new(1.0, 0.0, -1.0), Vec3::new(2.0, 1.0, 1.0)],
        );
        let expected = CLOUD.density(Vec3::new(1.375, 5.5 / 8.0, 0.5));
        assert_eq!(values[(8 + 5) * 4 + 1], expected);
    }
}
