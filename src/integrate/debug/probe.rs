//! What light arrives at one point: the learned field beside brute force.
//!
//! Both are lat-long images over directions (world space; x of the image is the angle around the
//! scene's z axis from -pi to pi, y the angle from +z down to -z), so that they can be compared
//! cell by cell.

use crate::camera::{Camera, CameraRay};
use crate::integrate::context::PathContext;
use crate::integrate::guiding::Guide;
use crate::integrate::settings::PathSettings;
use crate::integrate::wave::Wave;
use crate::math::{PathSampler, Rgb, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::interaction::Interaction;
use crate::texture::SurfacePoint;
use rayon::prelude::*;
use std::f32::consts::PI;

/// A lat-long image: `width` is twice `height`.
#[derive(Clone, Debug, PartialEq)]
pub struct LatLong {
    /// Pixels an image row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rows from +z down.
    pub pixels: Vec<Rgb>,
}

/// What a pixel's centre sees first.
pub fn seen_from<'a>(scene: &'a Scene, camera: &Camera, pixel: Vec2) -> Option<Interaction<'a>> {
    let CameraRay { ray, .. } = camera.ray(pixel, Vec2::splat(0.5));
    let hit = scene.first_hit(&ray);
    scene.surfaces.interaction(&ray, &hit, 0.0)
}

/// Direction at a place of the image, both coordinates in [0, 1).
fn direction(u: Vec2) -> Vec3 {
    let phi = (2.0 * u.x - 1.0) * PI;
    let theta = u.y * PI;
    Vec3::new(
        theta.sin() * phi.cos(),
        theta.sin() * phi.sin(),
        theta.cos(),
    )
}

impl LatLong {
    fn of(height: u32, pixel: impl Fn(u32, u32) -> Rgb + Sync) -> Self {
        let width = 2 * height;
        let pixels = (0..width * height)
            .into_par_iter()
            .map(|i| pixel(i % width, i / width))
            .collect();
        Self {
            width,
            height,
            pixels,
        }
    }

    /// Mean of `value` over `side` x `side` places of a pixel.
    fn mean(x: u32, y: u32, height: u32, side: u32, value: impl Fn(Vec3) -> Rgb) -> Rgb {
        let mut sum = Rgb::ZERO;
        for i in 0..side * side {
            let within = Vec2::new((i % side) as f32 + 0.5, (i / side) as f32 + 0.5) / side as f32;
            let at = (Vec2::new(x as f32, y as f32) + within)
                / Vec2::new(2.0 * height as f32, height as f32);
            sum += value(direction(at));
        }
        sum / (side * side) as f32
    }

    /// Integral over the sphere.
    pub fn integral(&self) -> Rgb {
        let (w, h) = (self.width, self.height);
        let area = |y: u32| {
            let edge = |y: u32| (y as f32 * PI / h as f32).cos();
            (edge(y) - edge(y + 1)) * 2.0 * PI / w as f32
        };
        (0..h)
            .map(|y| {
                let row = &self.pixels[(y * w) as usize..((y + 1) * w) as usize];
                row.iter().copied().sum::<Rgb>() * area(y)
            })
            .sum()
    }
}

/// Density with which the field samples directions at a point, the same in all channels.
pub fn learned(guide: &Guide, point: &SurfacePoint, normal: Vec3, height: u32) -> LatLong {
    let local = guide.field.at(point.p, Some(normal), Rgb::ONE);
    LatLong::of(height, |x, y| {
        LatLong::mean(x, y, height, 4, |w| Rgb::splat(local.pdf(w)))
    })
}

/// Incident radiance times cosine at a point, by `spp` paths a pixel of the image, unguided.
/// `direct` includes light that comes straight from emitters.
pub fn brute_force(
    scene: &Scene,
    settings: &PathSettings,
    point: &SurfacePoint,
    normal: Vec3,
    height: u32,
    spp: u32,
) -> LatLong {
    LatLong::of(height, |x, y| {
        let mut wave = Wave::default();
        let mut cosines = Vec::with_capacity(spp as usize);
        for i in 0..spp {
            let pixel = u64::from(y) * 2 * u64::from(height) + u64::from(x);
            let mut sampler = PathSampler::independent(settings.seed ^ PROBE, pixel, u64::from(i));
            let u = sampler.next4();
            let at = Vec2::new(x as f32 + u[0], y as f32 + u[1])
                / Vec2::new(2.0 * height as f32, height as f32);
            let w = direction(at);
            let cosine = normal.dot(w);
            if cosine <= 0.0 {
                continue;
            }
            cosines.push(cosine);
            wave.push(
                CameraRay {
                    ray: point.spawn_ray(w),
                    cone_width: 0.0,
                    cone_spread: 0.0,
                    sees: true,
                },
                sampler,
            );
        }
        let context = PathContext {
            scene,
            settings,
            guide: None,
        };
        let radiances = wave.trace(&context, &mut ());
        let sum: Rgb = radiances.iter().zip(&cosines).map(|(l, c)| *l * *c).sum();
        sum / spp as f32
    })
}

/// Sets the probe's random numbers apart from the image's.
const PROBE: u64 = 0x9e37_79b9_7f4a_7c15;

#[cfg(test)]
mod tests {
    use super::*;

    fn image(height: u32, value: impl Fn(Vec3) -> f32 + Sync) -> LatLong {
        LatLong::of(height, |x, y| {
            LatLong::mean(x, y, height, 4, |w| Rgb::splat(value(w)))
        })
    }

    #[test]
    fn rows_go_down_from_z_and_columns_around_it() {
        let at = |x, y| direction(Vec2::new(x, y));
        let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-6;
        assert!(near(at(0.3, 0.0), Vec3::Z) && near(at(0.3, 1.0), -Vec3::Z));
        assert!(near(at(0.5, 0.5), Vec3::X) && near(at(0.75, 0.5), Vec3::Y));
        assert!(near(at(0.0, 0.5), -Vec3::X));
        let up = image(8, |w| w.z);
        assert_eq!((up.width, up.pixels.len()), (16, 128));
        assert!(up.pixels.windows(17).all(|w| w[0].x > w[16].x));
    }

    #[test]
    fn integrals_are_those_of_the_sphere() {
        let sum = |value: fn(Vec3) -> f32| image(64, value).integral().y;
        assert!((sum(|_| 1.0) - 4.0 * PI).abs() < 1e-4);
        assert!((sum(|w| w.z.max(0.0)) - PI).abs() < 1e-3);
        assert!((sum(|w| w.x.max(0.0)) - PI).abs() < 3e-3);
        assert!(sum(|w| w.y).abs() < 1e-4);
        assert!((sum(|w| 3.0 * w.x * w.x) - 4.0 * PI).abs() < 5e-3);
    }
}
