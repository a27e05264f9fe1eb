//! What light arrives at one point, on a surface or inside of a medium: the learned field beside
//! brute force.
//!
//! Both are lat-long images over directions (world space; x of the image is the angle around the
//! scene's z axis from -pi to pi, y the angle from +z down to -z), so that they can be compared
//! cell by cell.

use crate::accel::Ray;
use crate::camera::{Camera, CameraRay};
use crate::guide::LocalField;
use crate::integrate::context::PathContext;
use crate::integrate::guiding::Guide;
use crate::integrate::settings::PathSettings;
use crate::integrate::wave::Wave;
use crate::math::{PathSampler, Rgb, Vec2, Vec3};
use crate::medium::{MediumId, VACUUM};
use crate::scene::Scene;
use crate::scene::free_flight::MOST_PASSED;
use crate::scene::interaction::Interaction;
use crate::scene::path_medium::PathMedium;
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

/// A place where light arrives.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// Where it is.
    pub point: SurfacePoint<'a>,
    /// The side of the surface that is seen, a unit normal; zero inside of a medium.
    pub side: Vec3,
    /// What lies around it.
    around: PathMedium,
}

impl<'a> Place<'a> {
    /// On a surface in empty space, on this side of it.
    pub fn on_surface(point: SurfacePoint<'a>, side: Vec3) -> Self {
        Self {
            point,
            side,
            around: PathMedium::inside(VACUUM),
        }
    }

    /// The medium that it is in; none on a surface.
    pub fn medium(&self) -> Option<MediumId> {
        (self.side == Vec3::ZERO).then(|| self.around.medium(Vec3::Z))
    }

    /// What the field says of it.
    pub fn ask<'f>(&self, guide: &'f Guide) -> LocalField<'f> {
        let horizon = (self.side != Vec3::ZERO).then_some(self.side);
        let field = &guide.field;
        field.at_side(self.point.p, self.side, horizon, Rgb::ONE)
    }
}

/// A medium on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Which.
    pub medium: MediumId,
    /// Distance at which it begins.
    pub from: f32,
    /// Distance at which it ends; infinite where nothing ends it.
    pub to: f32,
}

/// What a pixel's centre sees.
pub struct Sight<'a> {
    /// The first surface that is not index-matched, and the place on it.
    pub surface: Option<(Interaction<'a>, Place<'a>)>,
    /// The media before it, from the camera on.
    pub media: Vec<Stretch>,
    ray: Ray,
}

impl Sight<'_> {
    /// The place in a medium so far from the camera; `None` where there is no medium before the
    /// surface.
    pub fn in_medium(&self, distance: f32) -> Option<Place<'static>> {
        let holds = |s: &&Stretch| s.from < distance && distance < s.to;
        let Stretch { medium, .. } = self.media.iter().find(holds)?;
        Some(Place {
            point: SurfacePoint::in_volume(self.ray.at(distance), -self.ray.dir, 0.0),
            side: Vec3::ZERO,
            around: PathMedium::inside(*medium),
        })
    }
}

/// What a pixel's centre sees, through index-matched surfaces.
pub fn sight<'a>(scene: &'a Scene, camera: &Camera, pixel: Vec2) -> Sight<'a> {
    let CameraRay { ray, .. } = camera.ray(pixel, Vec2::splat(0.5));
    let mut around = PathMedium::inside(scene.media.camera);
    let (mut at, mut before) = (ray, 0.0);
    let mut media = Vec::new();
    for _ in 0..MOST_PASSED {
        let hit = scene.first_hit(&at);
        let to = before + if hit.is_some() { hit.t } else { f32::INFINITY };
        let medium = around.medium(at.dir);
        if scene.media.list().get(medium).is_some() {
            media.push(Stretch {
                medium,
                from: before,
                to,
            });
        }
        if hit.is_some() && scene.media.has_index_matched && scene.media.side(&hit).index_matched {
            at = around.cross(scene, &at, &hit);
            before = to;
            continue;
        }
        let met = scene.surfaces.interaction(&at, &hit, 0.0);
        let surface = met.map(|met| {
            if !scene.media.is_empty() {
                around.arrive(scene, &at, &hit);
            }
            let place = Place {
                point: met.point,
                side: met.point.facing(met.wo),
                around,
            };
            (met, place)
        });
        return Sight {
            surface,
            media,
            ray,
        };
    }
    Sight {
        surface: None,
        media,
        ray,
    }
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

/// Density with which the field samples directions at a place, the same in all channels.
pub fn learned(guide: &Guide, place: &Place, height: u32) -> LatLong {
    let local = place.ask(guide);
    LatLong::of(height, |x, y| {
        LatLong::mean(x, y, height, 4, |w| Rgb::splat(local.pdf(w)))
    })
}

/// Incident radiance, on a surface times the cosine, by `spp` paths a pixel of the image, unguided.
/// What settings hide of emitters is left out of the light that comes straight from them.
pub fn brute_force(
    scene: &Scene,
    settings: &PathSettings,
    place: &Place,
    height: u32,
    spp: u32,
) -> LatLong {
    let Place {
        point,
        side,
        around,
    } = place;
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
            let cosine = match place.medium() {
                Some(_) => 1.0,
                None => side.dot(w),
            };
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
        let radiances = wave.trace_from(*around, &context);
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
