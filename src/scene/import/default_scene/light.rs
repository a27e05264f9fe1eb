//! The light of a studio.

use super::{Sky, Studio, facing};
use crate::accel::{AnalyticKind, AnalyticShape, Bounds};
use crate::bsdf::material::Diffuse;
use crate::camera::CameraDescription;
use crate::light::{Emitter, SunSky};
use crate::math::{Affine3A, DVec3, Rgb, Vec3};
use crate::scene::import::parts::Parts;
use crate::scene::{Geometry, Shape};
use crate::texture::Texture;
use std::f32::consts::PI;

/// Radiance of the dome.
const DOME: f32 = 0.4;
/// Irradiance that the key light alone causes on a surface that faces it.
const KEY: f32 = 2.4;
/// Distance and radius of the key light, in radii of the model.
const KEY_DISTANCE: f32 = 8.0;
const KEY_RADIUS: f32 = 1.6;
/// Where the key light is: to the left of the camera, and above the ground, degrees.
const KEY_AZIMUTH: f64 = -40.0;
const KEY_ELEVATION: f64 = 45.0;
/// Radiance of the sky in the sky model's units becomes that of the studio. How bright the sun is
/// depends on where it stands: [`Studio::exposure`] makes up for that.
const SUN_SKY_SCALE: f32 = 0.04;
/// What a white wall that faces the sun becomes in a picture.
const WHITE: f32 = 0.9;

impl Studio {
    pub(super) fn add_light(&self, parts: &mut Parts, camera: &CameraDescription, bounds: Bounds) {
        if let Some(image) = &self.environment {
            for oddity in image.oddities() {
                parts.warn(format!("{}: {oddity}", image.path().display()));
            }
            let around = Emitter::EnvironmentMap {
                image: image.clone(),
                scale: 1.0,
                to_world: self.upright(),
            };
            parts.add_emitter(around, "environment");
        }
        let default = match parts.emitters.len() > parts.faint {
            false => Sky::Studio,
            true => Sky::None,
        };
        match self.sky.as_ref().unwrap_or(&default) {
            Sky::None => {}
            Sky::White(radiance) => {
                let radiance = *radiance;
                parts.add_emitter(Emitter::Constant { radiance }, "sky");
            }
            Sky::Sun { azimuth, elevation } => {
                let sun = self.sun(*azimuth, *elevation);
                parts.add_emitter(sun, "sky");
            }
            Sky::Studio => {
                let radiance = Rgb::splat(DOME);
                parts.add_emitter(Emitter::Constant { radiance }, "dome");
                self.add_key(parts, camera, bounds);
            }
        }
    }

    /// Exposure of pictures, in stops: under a sun, that at which a white wall in it is about
    /// white.
    pub fn exposure(&self) -> f32 {
        let Some(Sky::Sun { azimuth, elevation }) = &self.sky else {
            return 0.0;
        };
        let Emitter::SunSky {
            settings, scale, ..
        } = self.sun(*azimuth, *elevation)
        else {
            return 0.0;
        };
        let wall = settings.irradiance(scale).element_sum() / (3.0 * PI);
        // In tenths, for it is said in words.
        let stops = (10.0 * (WHITE / wall).log2()).round() / 10.0;
        if stops.is_finite() { stops } else { 0.0 }
    }

    /// From a world with +y up to the studio's.
    fn upright(&self) -> Affine3A {
        if self.z_up {
            Affine3A::from_rotation_x(0.5 * PI)
        } else {
            Affine3A::IDENTITY
        }
    }

    /// A direction by its angles: azimuth 0 is the model's front, positive to its left (the right
    /// of who looks at it).
    fn direction(&self, azimuth: f64, elevation: f64) -> DVec3 {
        let (up, front) = (self.up(), self.front());
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        (front * cos_a + up.cross(front) * sin_a) * cos_e + up * sin_e
    }

    fn sun(&self, azimuth: f64, elevation: f64) -> Emitter {
        let to_world = self.upright();
        let world = self.direction(azimuth, elevation).as_vec3();
        Emitter::SunSky {
            settings: SunSky {
                sky: true,
                sun: true,
                sun_direction: to_world.inverse().transform_vector3(world).normalize(),
                turbidity: 3.0,
                albedo: Rgb::splat(0.3),
                sky_scale: 1.0,
                sun_scale: 1.0,
                sun_radius_degrees: 0.2679,
                stretch: 1.0,
                z_up: false,
            },
            scale: SUN_SKY_SCALE,
            to_world,
        }
    }

    fn add_key(&self, parts: &mut Parts, camera: &CameraDescription, bounds: Bounds) {
        let center = bounds.center();
        let radius = bounds.radius().max(f32::MIN_POSITIVE);
        let from = camera.to_world.translation - center.as_dvec3();
        let (up, front) = (self.up(), self.front());
        let azimuth = from.dot(up.cross(front)).atan2(from.dot(front));
        let to_key = self.direction(azimuth.to_degrees() + KEY_AZIMUTH, KEY_ELEVATION);
        let to_key: Vec3 = to_key.as_vec3();
        let disk = facing(
            center + to_key * (KEY_DISTANCE * radius),
            -to_key,
            KEY_RADIUS * radius,
        );
        // E = L pi sin^2 of the half angle under which a disk is seen.
        let sin2 = KEY_RADIUS.powi(2) / (KEY_RADIUS.powi(2) + KEY_DISTANCE.powi(2));
        let radiance = Texture::Constant(Rgb::splat(KEY / (PI * sin2)));
        let black = Texture::Constant(Rgb::ZERO);
        let material = parts.materials.push(Diffuse { reflectance: black });
        let shape = parts.shapes.len() as u32;
        parts.emitters.push(Emitter::Area {
            shape,
            radiance,
            both_sides: false,
        });
        parts.shapes.push(Shape {
            name: "key light".into(),
            geometry: Geometry::Analytic(AnalyticShape::new(AnalyticKind::Disk, disk)),
            material,
            emitter: Some((parts.emitters.len() - 1) as u32),
            flip_normals: false,
            group: None,
            boundary: None,
        });
    }
}
