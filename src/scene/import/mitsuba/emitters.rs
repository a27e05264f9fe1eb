//! Emitters that stand in the scene by themselves. Those inside shapes are read with the shapes.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::sensors;
use super::shapes::single;
use super::sun_position::{self, DateAndPlace};
use super::value::{Dialect, Value};
use crate::camera::FovAxis;
use crate::image::file::ImageFile;
use crate::image::header::Level;
use crate::light::{Emitter, EnvironmentImage, Falloff, Slide, SunSky};
use crate::math::{DAffine3, DVec3, Rgb};
use crate::scene::import::{ImportError, named};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Diameter of the sun's disk seen from the earth, degrees, where a scene says nothing. Both
/// dialects' value.
const SUN_DIAMETER_DEGREES: f64 = 0.5358;

impl<'a> Importer<'a> {
    /// Imports the emitter that object `index` describes.
    pub fn emitter(&mut self, index: usize) -> Result<(), ImportError> {
        let params = Params::new(self.document, index);
        params.ignore(&["sampling_weight"]);
        // The boundaries around a lamp tell what it stands in.
        params.children("medium");
        let emitter = match params.plugin() {
            "point" => self.point(&params)?,
            "spot" => self.spot(&params)?,
            "directional" => self.directional(&params)?,
            "constant" => {
                let radiance = self.color(&params, "radiance", Role::Light);
                let radiance = radiance.unwrap_or(Rgb::ONE);
                Emitter::Constant { radiance }
            }
            "envmap" => self.environment_map(&params)?,
            "sun" | "sky" | "sunsky" => self.sun_sky(&params)?,
            "projector" => self.projector(&params)?,
            plugin => return Err(params.error(format!("emitter \"{plugin}\" is not known"))),
        };
        self.done(&params);
        let name = self.name_of(index, params.plugin());
        let number = self.emitters.len() as u32;
        self.emitter_names.insert(number, name);
        self.emitters.push(emitter);
        Ok(())
    }

    fn point(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        let position = match (p.vector("position"), p.transform("to_world")) {
            (Some(_), Some(_)) => {
                return Err(p.error("give \"position\" or \"to_world\", not both"));
            }
            (Some(position), None) => position,
            (None, to_world) => to_world.map_or(DVec3::ZERO, |m| m.translation),
        };
        let position = self
            .place(DAffine3::from_translation(position), None)
            .translation;
        let intensity = self.color(p, "intensity", Role::Light);
        Ok(Emitter::Point {
            position: position.as_vec3(),
            intensity: intensity.unwrap_or(Rgb::ONE),
        })
    }

    fn spot(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        let cutoff = p.float_in("cutoff_angle", 20.0, 0.0..=180.0);
        let beam = p.float_in("beam_width", 0.75 * cutoff, 0.0..=cutoff);
        let intensity = self.color(p, "intensity", Role::Light);
        let texture = self.texture_given(p, "texture", Role::Number);
        Ok(Emitter::Spot {
            to_world: single(self.place(p.to_world(), None)),
            intensity: intensity.unwrap_or(Rgb::ONE),
            cutoff_degrees: cutoff as f32,
            beam_degrees: beam as f32,
            falloff: Falloff::Linear,
            texture,
        })
    }

    fn directional(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        let direction = match (p.vector("direction"), p.transform("to_world")) {
            (Some(_), Some(_)) => {
                return Err(p.error("give \"direction\" or \"to_world\", not both"));
            }
            (Some(direction), None) => direction,
            (None, to_world) => to_world.map_or(DVec3::Z, |m| m.transform_vector3(DVec3::Z)),
        };
        let Some(direction) = direction.try_normalize() else {
            return Err(p.error("the direction is zero"));
        };
        let irradiance = self.color(p, "irradiance", Role::Light);
        Ok(Emitter::Directional {
            direction: direction.as_vec3(),
            irradiance: irradiance.unwrap_or(Rgb::ONE),
        })
    }

    fn environment_map(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        // Caches and a denser sampling of bright parts are the renderer's business.
        p.ignore(&["cache", "mis_compensation"]);
        let Some(name) = p.text("filename") else {
            return Err(p.error("an envmap needs a \"filename\""));
        };
        let at = p.place_of("filename");
        let path = self.document.resolve(at, name);
        let scale = p.float("scale", 1.0) as f32;
        let to_world = single(p.to_world());
        let gamma = p.number("gamma").filter(|g| *g > 0.0).map(|g| g as f32);
        match self.environment(&path, gamma) {
            Ok(image) => {
                let place = self.document.location(at);
                for oddity in image.oddities() {
                    self.warnings
                        .tell(format!("{place}: {}: {oddity}", path.display()));
                }
                Ok(Emitter::EnvironmentMap {
                    image,
                    scale,
                    to_world,
                })
            }
            Err(message) => {
                let error = self.document.error(at, message);
                let instead = "mid-grey takes its place";
                self.document.faults.add(at, error, instead);
                let radiance = Rgb::splat(0.5 * scale);
                Ok(Emitter::Constant { radiance })
            }
        }
    }

    /// The image around the scene in the file `path`, read once.
    fn environment(
        &mut self,
        path: &Path,
        gamma: Option<f32>,
    ) -> Result<Arc<EnvironmentImage>, String> {
        let key = (path.to_owned(), gamma.map(f32::to_bits));
        if let Some(known) = self.environments.get(&key) {
            return Ok(known.clone());
        }
        if !path.exists() {
            let hint = named::hint_of(path);
            return Err(format!(
                "there is no environment map {}{hint}",
                path.display()
            ));
        }
        let image = EnvironmentImage::read(path, gamma, self.options.decode)
            .map_err(|e| format!("cannot read the environment map {}: {}", e.path, e.reason))?;
        let image = Arc::new(image);
        self.environments.insert(key, image.clone());
        Ok(image)
    }

    fn sun_sky(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        // `sun_aperture` is Mitsuba 3's alone: scenes of 0.x that were changed for Mitsuba 3 by
        // hand often keep their version, and Mitsuba 3 reads them all the same.
        let modern = p.dialect() == Dialect::Modern || p.has("sun_aperture");
        // 0.x bakes the sky into an image of that resolution; here it is evaluated as it is.
        p.ignore(&["resolution"]);
        for (name, what) in [
            ("extend", "the sky is not continued below the horizon"),
            ("complex_sun", "the sun's disk is of one brightness"),
        ] {
            if p.boolean(name, false) {
                let place = self.document.location(p.place_of(name));
                self.warnings
                    .tell(format!("{place}: \"{name}\" is left out: {what}"));
            }
        }
        let to_world = p.to_world();
        let plugin = p.plugin();
        let scale = p.float("scale", 1.0);
        // In 0.x a separate scale takes the place of the common one.
        let (sun_scale, sky_scale) = match plugin {
            "sunsky" => (p.float("sun_scale", scale), p.float("sky_scale", scale)),
            _ => (scale, scale),
        };
        let albedo = self.color(p, "albedo", Role::Reflectance);
        let diameter = p.float_in("sun_aperture", SUN_DIAMETER_DEGREES, 0.0..=180.0);
        let radius_scale = p.float_in("sun_radius_scale", 1.0, 0.0..=300.0);
        let sun_direction = match p.vector("sun_direction") {
            Some(world) => to_world.inverse().transform_vector3(world),
            None => self.sun_from_date(p, modern)?,
        };
        let Some(sun_direction) = sun_direction.try_normalize() else {
            return Err(p.error("\"sun_direction\" is zero, or \"to_world\" cannot be inverted"));
        };
        Ok(Emitter::SunSky {
            settings: SunSky {
                sky: plugin != "sun",
                sun: plugin != "sky",
                sun_direction: sun_direction.as_vec3(),
                turbidity: p.float_in("turbidity", 3.0, 1.0..=10.0) as f32,
                albedo: albedo.unwrap_or(Rgb::splat(if modern { 0.3 } else { 0.2 })),
                sky_scale: sky_scale as f32,
                sun_scale: sun_scale as f32,
                sun_radius_degrees: (0.5 * diameter * radius_scale) as f32,
                stretch: p.float_in("stretch", 1.0, 1.0..=2.0) as f32,
                z_up: modern,
            },
            scale: 1.0,
            to_world: single(to_world),
        })
    }

    /// Direction of the sun in the emitter's coordinates, from date and place.
    fn sun_from_date(&mut self, p: &Params<'a>, modern: bool) -> Result<DVec3, ImportError> {
        let tokyo = DateAndPlace::default();
        let when = DateAndPlace {
            year: p.integer("year").unwrap_or(tokyo.year),
            month: p.integer("month").unwrap_or(tokyo.month),
            day: p.integer("day").unwrap_or(tokyo.day),
            hour: p.float("hour", tokyo.hour),
            minute: p.float("minute", tokyo.minute),
            second: p.float("second", tokyo.second),
            latitude: p.float_in("latitude", tokyo.latitude, -90.0..=90.0),
            longitude: p.float_in("longitude", tokyo.longitude, -360.0..=360.0),
            timezone: p.float_in("timezone", tokyo.timezone, -24.0..=24.0),
        };
        let sensible = (-4000..=9999).contains(&when.year) && (1..=12).contains(&when.month);
        if !sensible || !(1..=31).contains(&when.day) {
            return Err(p.error("year, month and day are not a date"));
        }
        let sun = sun_position::sun(&when);
        let direction = if modern { sun.z_up() } else { sun.y_up() };
        if sun.zenith > std::f64::consts::FRAC_PI_2 {
            let place = self.document.location(p.at());
            self.warnings.tell(format!(
                "{place}: the sun is below the horizon at this date and place"
            ));
        }
        Ok(direction)
    }

    fn projector(&mut self, p: &Params<'a>) -> Result<Emitter, ImportError> {
        let aspect = self.slide_aspect(p);
        let irradiance = self.texture(p, "irradiance", 1.0, Role::Light);
        let (fov, axis) = sensors::field_of_view(p);
        Ok(Emitter::Projector {
            to_world: single(self.place(p.to_world(), None)),
            slide: irradiance,
            values: Slide::Irradiance,
            scale: p.float("scale", 1.0) as f32,
            fov_degrees: horizontal(fov, axis, aspect) as f32,
            aspect: aspect as f32,
        })
    }

    /// Width over height of the image that a projector shows; 1 for anything but an image.
    fn slide_aspect(&mut self, p: &Params<'a>) -> f64 {
        let Some(path) = self.slide(p) else {
            return 1.0;
        };
        match ImageFile::open(&path) {
            Ok(file) => {
                let Level { width, height } = file.header().level;
                f64::from(width) / f64::from(height)
            }
            // That it cannot be read is told of the texture.
            Err(_) => 1.0,
        }
    }

    fn slide(&self, p: &Params<'a>) -> Option<PathBuf> {
        let Value::Object(index) = p.find("irradiance")?.value else {
            return None;
        };
        let slide = Params::new(self.document, index);
        let name = slide.text("filename")?;
        Some(self.document.resolve(slide.place_of("filename"), name))
    }
}

/// The full horizontal field of view, degrees, of a picture `aspect` as wide as high.
fn horizontal(fov: f64, axis: FovAxis, aspect: f64) -> f64 {
    // How much wider the picture is than what the angle spans.
    let wider = match axis {
        FovAxis::X => 1.0,
        FovAxis::Y => aspect,
        FovAxis::Diagonal => aspect / aspect.hypot(1.0),
        FovAxis::Smaller => aspect.max(1.0),
        FovAxis::Larger => aspect.min(1.0),
    };
    2.0 * ((0.5 * fov.to_radians()).tan() * wider).atan().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_view_are_turned_into_horizontal_ones() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        near(horizontal(90.0, FovAxis::X, 2.0), 90.0);
        near(
            horizontal(90.0, FovAxis::Y, 2.0),
            2.0 * 2f64.atan().to_degrees(),
        );
        near(horizontal(90.0, FovAxis::Smaller, 0.5), 90.0);
        near(horizontal(90.0, FovAxis::Larger, 2.0), 90.0);
        near(
            horizontal(90.0, FovAxis::Diagonal, 1.0),
            2.0 * 0.5f64.sqrt().atan().to_degrees(),
        );
    }
}
