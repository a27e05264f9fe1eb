//! Skies and suns: Hosek and Wilkie's sky dome (2012) baked into an importance-sampled map, and the
//! sun as a disk of one radiance, so that no texel has to be as small as it.
//!
//! Both Mitsubas take the sky from the same fit in linear sRGB, divided by the sum of the CIE
//! luminosity function so that its unit is W / (m^2 sr nm). Their suns differ, by up to a half at
//! low elevations: see [`super::sun`].

use super::SunSky;
use super::distant::{Distant, Sun};
use super::latlong::LatLong;
use super::sun;
use crate::math::rgb::sanitized;
use crate::math::{Affine3A, Mat3, Rgb, Vec3};
use hw_skymodel::rgb::{Channel, SkyParams, SkyState};
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Sum of the CIE luminosity function at steps of 1 nm, as the two programs have it.
const CIE_Y_SUM: [f32; 2] = [106.856_98, 106.750_26];
/// Size of the baked map. The sky changes fastest within half a degree of the horizon, where a row
/// is 0.18 degrees high.
const WIDTH: usize = 1024;
const HEIGHT: usize = 513;
/// The map's last row lies on the horizon; the model is evaluated just above it.
const HORIZON: f32 = FRAC_PI_2 - 1e-4;
/// Angular radius of the sun that the models' radiance belongs to, degrees.
const SUN_RADIUS_DEGREES: f32 = 0.5 * 0.5358;

/// The sky and the sun as distant lights. Nothing if the sun is below the horizon, where the models
/// end.
pub(super) fn distant(settings: &SunSky, scale: f32, to_world: &Affine3A) -> Vec<Distant> {
    let up = if settings.z_up { Vec3::Z } else { Vec3::Y };
    let to_sun = settings.sun_direction.normalize_or_zero();
    let elevation = FRAC_PI_2 - angle_between(to_sun, up);
    if to_sun == Vec3::ZERO || elevation < 0.0 {
        tracing::warn!("the sun is below the horizon: sun and sky are dark");
        return Vec::new();
    }
    let to_world = Mat3::from(to_world.matrix3);
    let mut lights = Vec::new();
    if settings.sky {
        lights.extend(sky(settings, scale, to_sun, elevation, to_world));
    }
    if settings.sun {
        lights.push(sun_disk(settings, scale, to_sun, elevation, to_world));
    }
    lights
}

/// Angle between unit vectors, exact for small ones.
fn angle_between(a: Vec3, b: Vec3) -> f32 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Local coordinates of the map, where +y is up, to the emitter's.
fn upright(z_up: bool) -> Mat3 {
    if z_up {
        Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y)
    } else {
        Mat3::IDENTITY
    }
}

fn sky(
    settings: &SunSky,
    scale: f32,
    to_sun: Vec3,
    elevation: f32,
    to_world: Mat3,
) -> Option<Distant> {
    let stretch = settings.stretch.clamp(1.0, 2.0);
    let state = SkyState::new(&SkyParams {
        elevation: elevation.clamp(0.0, FRAC_PI_2),
        turbidity: settings.turbidity.clamp(1.0, 10.0),
        albedo: settings.albedo.clamp(Rgb::ZERO, Rgb::ONE).to_array(),
    })
    .ok()?;
    let unit = scale * settings.sky_scale / CIE_Y_SUM[usize::from(settings.z_up)];
    let up = upright(settings.z_up);
    let sun = up.transpose() * to_sun;
    let texel = |x: usize, y: usize| {
        let theta = (y as f32 / (HEIGHT - 1) as f32 * FRAC_PI_2).min(HORIZON);
        let phi = (x as f32 + 0.5) / WIDTH as f32 * TAU;
        let (sin, cos) = theta.sin_cos();
        let dir = Vec3::new(phi.sin() * sin, cos, -phi.cos() * sin);
        let gamma = angle_between(dir, sun);
        let channel = |c| state.radiance(theta, gamma, c);
        let rgb = Rgb::new(
            channel(Channel::R),
            channel(Channel::G),
            channel(Channel::B),
        );
        sanitized(rgb * unit)
    };
    let pixels: Vec<Rgb> = (0..WIDTH * HEIGHT)
        .into_par_iter()
        .map(|i| texel(i % WIDTH, i / WIDTH))
        .collect();
    // Stretched, the same rows reach further down (Mitsuba 0.x's `stretch`).
    let map = LatLong::new(
        [WIDTH, HEIGHT],
        pixels,
        (FRAC_PI_2 * stretch).min(PI),
        to_world * up,
    );
    map.map(|m| Distant::Map(Box::new(m)))
}

impl SunSky {
    /// Irradiance times `scale` that the sky causes on level ground, and the sun on a surface that
    /// faces it; black below the horizon.
    pub fn irradiance(&self, scale: f32) -> Rgb {
        /// Rows of the sky: it is to tell how bright a picture will be.
        const ROWS: u32 = 32;
        let lights = distant(self, scale, &Affine3A::IDENTITY);
        let upright = upright(self.z_up);
        lights.iter().fold(Rgb::ZERO, |sum, light| match light {
            Distant::Sun(sun) => sum + sun.radiance * sun.solid_angle(),
            Distant::Parallel { irradiance, .. } => sum + *irradiance,
            // Directions of the same share of the irradiance: sin^2 of the polar angle is uniform.
            light => {
                let directions = (0..ROWS * ROWS).map(|i| {
                    let sin2 = ((i / ROWS) as f32 + 0.5) / ROWS as f32;
                    let phi = ((i % ROWS) as f32 + 0.5) / ROWS as f32 * TAU;
                    let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).sqrt());
                    upright * Vec3::new(phi.sin() * sin, cos, -phi.cos() * sin)
                });
                let radiance: Rgb = directions.map(|dir| light.radiance(dir)).sum();
                sum + radiance * (PI / (ROWS * ROWS) as f32)
            }
        })
    }
}

/// The sun's disk; its power is the same whatever its radius. A radius of 0 makes parallel light.
fn sun_disk(
    settings: &SunSky,
    scale: f32,
    to_sun: Vec3,
    elevation: f32,
    to_world: Mat3,
) -> Distant {
    let turbidity = settings.turbidity.clamp(1.0, 10.0);
    let radiance = if settings.z_up {
        sun::hosek(elevation, turbidity)
    } else {
        sun::preetham(elevation, turbidity)
    };
    let radiance = sanitized(radiance * (scale * settings.sun_scale));
    let center = (to_world * stretched(settings, to_sun)).normalize();
    let natural = one_minus_cos(SUN_RADIUS_DEGREES);
    let actual = one_minus_cos(settings.sun_radius_degrees.clamp(0.0, 89.0));
    // Too narrow for f32 directions to be told apart.
    if actual < 1e-12 {
        return Distant::Parallel {
            to_light: center,
            irradiance: radiance * (TAU * natural),
        };
    }
    Distant::Sun(Sun {
        center,
        one_minus_cos: actual,
        radiance: radiance * (natural / actual),
    })
}

fn one_minus_cos(degrees: f32) -> f32 {
    let half = (0.5 * degrees.to_radians()).sin();
    2.0 * half * half
}

/// The sun's place in a stretched sky: its polar angle grows by the same factor.
fn stretched(settings: &SunSky, to_sun: Vec3) -> Vec3 {
    let up = upright(settings.z_up);
    let d = up.transpose() * to_sun;
    let theta = angle_between(d, Vec3::Y) * settings.stretch.clamp(1.0, 2.0);
    let around = Vec3::new(d.x, 0.0, d.z).normalize_or_zero();
    up * (around * theta.sin() + Vec3::Y * theta.cos())
}
