//! Lights that stand in the scene by themselves, and what shapes emit.

use super::graphics::single;
use super::images::flipped;
use super::importer::Importer;
use super::parameter::Kind;
use super::params::Params;
use super::pending::Glow;
use crate::image::file::ImageFile;
use crate::light::{Emitter, EnvironmentImage, Falloff, Slide};
use crate::math::{DAffine3, DVec3, Rgb, Vec3, luminance};
use crate::scene::import::{ImportError, named};
use crate::texture::{BitmapSettings, Filter, Texture, Wrap};
use glam::{Affine2, DMat3};
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// The kinds of lights that are read; `diffuse` is that of `AreaLightSource`.
pub(super) const LIGHTS: &[&str] = &[
    "point",
    "spot",
    "distant",
    "infinite",
    "projection",
    "goniometric",
];

impl<'s> Importer<'s> {
    /// A `LightSource`.
    pub fn light_source(&mut self, p: &Params<'_, 's>) -> Result<(), ImportError> {
        let to_world = self.standing(p.at(), "light")?;
        let emitter = match p.name() {
            "point" => self.point(p, to_world),
            "spot" => self.spot(p, to_world),
            "distant" => self.distant(p, to_world),
            "infinite" => self.infinite(p, to_world),
            "projection" => self.projection(p, to_world),
            "goniometric" => self.goniometric(p, to_world),
            other => {
                let help = named::did_you_mean(other, LIGHTS.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                Err(format!("there is no light of the kind \"{other}\"{help}"))
            }
        };
        let emitter = emitter.map_err(|message| self.source.error(p.at(), message))?;
        self.done(p);
        self.add_emitter(emitter, p.name());
        Ok(())
    }

    /// `scale`, a number or (v3) a colour, with the sensor's exposure.
    fn scale(&mut self, p: &Params<'_, 's>) -> Rgb {
        let given = p.any("scale");
        let scale = match given {
            Some(given) if !matches!(given.kind, Kind::Float | Kind::Integer) => {
                let unbounded = super::importer::Role::Unbounded;
                self.factor_of(p, given, unbounded).unwrap_or(Rgb::ONE)
            }
            _ => Rgb::splat(p.float("scale", 1.0) as f32),
        };
        if scale.min_element() < 0.0 {
            self.warn_at(
                p.place_of("scale"),
                "\"scale\" is below 0: lights that take away are left out",
            );
        }
        (scale * self.imaging_ratio).max(Rgb::ZERO)
    }

    /// The colour `name` times `scale`; with `power`, as much that this many times `emitted`, the
    /// power of a light of luminance 1, comes out.
    fn strength(&mut self, p: &Params<'_, 's>, name: &'static str, emitted: f32) -> Rgb {
        let color = self.light(p, name) * self.scale(p);
        match p.float_given("power").filter(|power| *power > 0.0) {
            Some(power) if emitted > 0.0 => color * (power as f32 / emitted),
            _ => color,
        }
    }

    fn point(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        let from = p.triple("from", DVec3::ZERO);
        let position = to_world.transform_point3(from) - self.origin;
        Ok(Emitter::Point {
            position: position.as_vec3(),
            intensity: self.strength(p, "I", 4.0 * PI),
        })
    }

    fn spot(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        let from = p.triple("from", DVec3::ZERO);
        let to = p.triple("to", DVec3::Z);
        let axis = (to - from)
            .try_normalize()
            .ok_or("\"from\" and \"to\" are the same point")?;
        let (s, t) = axis.any_orthonormal_pair();
        let placed = DAffine3::from_mat3_translation(DMat3::from_cols(s, t, axis), from);
        let cutoff = p.float_in("coneangle", 30.0, 0.0..=180.0) as f32;
        let delta = p.float_in("conedeltaangle", 5.0, 0.0..=180.0) as f32;
        let beam = (cutoff - delta).max(0.0);
        let [start, end] = [beam, cutoff].map(|a| a.to_radians().cos());
        let emitted = 2.0 * PI * ((1.0 - start) + (start - end) / 2.0);
        Ok(Emitter::Spot {
            to_world: single(self.place(to_world * placed, None)),
            intensity: self.strength(p, "I", emitted),
            cutoff_degrees: cutoff,
            beam_degrees: beam,
            falloff: Falloff::Smooth,
            texture: None,
        })
    }

    fn distant(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        let from = p.triple("from", DVec3::ZERO);
        let to = p.triple("to", DVec3::Z);
        let direction = to_world.transform_vector3(to - from).try_normalize();
        let direction = direction.ok_or("\"from\" and \"to\" are the same point")?;
        let mut irradiance = self.light(p, "L") * self.scale(p);
        if let Some(lux) = p.float_given("illuminance").filter(|lux| *lux > 0.0) {
            irradiance *= lux as f32;
        }
        Ok(Emitter::Directional {
            direction: direction.as_vec3(),
            irradiance,
        })
    }

    fn infinite(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        p.ignore(&["nsamples", "samples"]);
        self.left_out(
            p,
            &["portal"],
            "light comes from everywhere, which is noisier and brings \
            more of it where the scene is open elsewhere",
        );
        let scale = self.scale(p);
        let lux = p.float_given("illuminance").filter(|lux| *lux > 0.0);
        let name = ["filename", "mapname"].into_iter().find(|name| {
            p.find(name, &[Kind::Text])
                .is_some_and(|g| !super::textures::is_nothing(&g.values))
        });
        let Some(name) = name else {
            let mut radiance = self.light(p, "L") * scale;
            if let Some(lux) = lux {
                radiance *= lux as f32 / PI;
            }
            return Ok(Emitter::Constant { radiance });
        };
        if p.has("L") && name == "filename" {
            return Err("give \"L\" or \"filename\", not both".into());
        }
        // v3 multiplies its map by L.
        let color = if p.has("L") {
            self.light(p, "L") * scale
        } else {
            scale
        };
        let path = self
            .file_given(p, name)
            .ok_or("the file's name is expected")?;
        let image = self.environment(p, name, &path)?;
        let is_equal_area = image.layout() == crate::light::Layout::EqualArea;
        if color.x != color.y || color.y != color.z {
            self.warn_at(
                p.at(),
                "the colour of this light is left out, its luminance is kept: a map has its own",
            );
        }
        let mut scale = luminance(color);
        if let Some(lux) = lux {
            let up = if is_equal_area { Vec3::Z } else { Vec3::Y };
            let found = image.illuminance(up);
            scale *= if found > 0.0 { lux as f32 / found } else { 1.0 };
        }
        let place = match is_equal_area {
            true => to_world,
            false => to_world * LAT_LONG,
        };
        Ok(Emitter::EnvironmentMap {
            image,
            scale,
            to_world: single(place),
        })
    }

    /// The image around the scene in the file `path`, read once: a square is one of equal areas.
    fn environment(
        &mut self,
        p: &Params,
        name: &'static str,
        path: &Path,
    ) -> Result<Arc<EnvironmentImage>, String> {
        let at = p.place_of(name);
        if !path.exists() {
            let hint = named::hint_of(path);
            return Err(format!(
                "there is no environment map {}{hint}",
                path.display()
            ));
        }
        let is_square = ImageFile::open(path).is_ok_and(|file| {
            let level = file
                .header()
                .window
                .map_or(file.header().level, |w| w.whole);
            level.width == level.height
        });
        let equal_area = is_square && name == "filename";
        if name == "filename" && !is_square {
            self.warn_at(
                at,
                "this map is no square of equal areas: it is taken for latitude by \
                longitude, as in v3",
            );
        }
        let key = (path.to_owned(), equal_area);
        let known = self.environments.borrow().get(&key).cloned();
        let image = known.unwrap_or_else(|| {
            let limit = self.options.decode;
            let read = match equal_area {
                true => EnvironmentImage::read_equal_area(path, limit),
                false => EnvironmentImage::read(path, None, limit),
            };
            let read = read.map(Arc::new);
            let read = read
                .map_err(|e| format!("cannot read the environment map {}: {}", e.path, e.reason));
            self.environments.borrow_mut().insert(key, read.clone());
            read
        })?;
        for oddity in image.oddities() {
            self.warn_at(at, &format!("{}: {oddity}", path.display()));
        }
        Ok(image)
    }

    /// An image that a light shows.
    fn light_image(&mut self, p: &Params<'_, 's>, name: &'static str) -> Result<Texture, String> {
        let path = self.file_given(p, name);
        let path = path.ok_or_else(|| format!("\"{}\" needs a \"{name}\"", p.name()))?;
        let settings = BitmapSettings {
            path,
            raw: false,
            gamma: None,
            filter: Filter::Linear,
            wrap_u: Wrap::Clamp,
            wrap_v: Wrap::Clamp,
            to_uv: crate::texture::UvTransform(Affine2::IDENTITY),
            channel: None,
        };
        self.open(settings, p.place_of(name))
    }

    fn projection(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        let name = if p.has("mapname") {
            "mapname"
        } else {
            "filename"
        };
        let slide = self.light_image(p, name)?;
        let size = match &slide {
            Texture::Bitmap(bitmap) => [bitmap.width(), bitmap.height()],
            _ => [1, 1],
        };
        let aspect = size[0] as f32 / size[1] as f32;
        let fov = p.float_in("fov", 90.0, 0.0..=179.9) as f32;
        // It spans the shorter side.
        let half_height = (0.5 * fov.to_radians()).tan() * (1.0 / aspect).max(1.0);
        let half_width = half_height * aspect;
        let mut factor = self.scale(p);
        if p.has("I") {
            factor *= self.light(p, "I");
        }
        if let Some(power) = p.float_given("power").filter(|power| *power > 0.0) {
            let emitted = slide_power(&slide, size, [half_width, half_height]);
            factor *= if emitted > 0.0 {
                power as f32 / emitted
            } else {
                1.0
            };
        }
        // x to the right becomes x to the left.
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        Ok(Emitter::Projector {
            to_world: single(self.place(to_world * mirror, None)),
            slide: slide.scaled(factor),
            values: Slide::Intensity,
            scale: 1.0,
            fov_degrees: 2.0 * half_width.atan().to_degrees(),
            aspect,
        })
    }

    /// A point light of the mean of its image.
    fn goniometric(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        let name = if p.has("mapname") {
            "mapname"
        } else {
            "filename"
        };
        let mean = match p.has(name) {
            true => {
                let mean = self.light_image(p, name)?.mean();
                self.warn_at(
                    p.at(),
                    "the directions of this goniometric light are left out: it \
                    shines alike everywhere, with as much power",
                );
                mean.element_sum() / 3.0
            }
            false => 1.0,
        };
        let position = to_world.translation - self.origin;
        let power = p.float_given("power").is_some_and(|power| power > 0.0);
        let intensity = self.strength(p, "I", 4.0 * PI);
        Ok(Emitter::Point {
            position: position.as_vec3(),
            intensity: intensity * if power { 1.0 } else { mean },
        })
    }

    /// What an `AreaLightSource` makes shapes emit.
    pub fn glow(&mut self, p: &Params<'_, 's>) -> Result<Glow, String> {
        if !matches!(p.name(), "diffuse" | "area") {
            return Err(format!(
                "there is no area light of the kind \"{}\"",
                p.name()
            ));
        }
        p.ignore(&["nsamples", "samples"]);
        let scale = self.scale(p);
        let both_sides = p.boolean("twosided", false);
        let power = p.float_given("power").filter(|power| *power > 0.0);
        let power = power.map(|power| power as f32);
        let image = p.find("filename", &[Kind::Text]);
        let radiance = match image.is_some_and(|g| !super::textures::is_nothing(&g.values)) {
            false => Texture::Constant(self.light(p, "L") * scale),
            true if p.has("L") => return Err("give \"L\" or \"filename\", not both".into()),
            true => {
                let image = self.light_image(p, "filename")?;
                let image = match &image {
                    Texture::Bitmap(bitmap) => {
                        let settings = BitmapSettings {
                            to_uv: flipped(Affine2::IDENTITY),
                            ..bitmap.settings().clone()
                        };
                        self.open(settings, p.place_of("filename"))?
                    }
                    _ => image,
                };
                // With a power, the mean of the image comes out at that.
                let mean = luminance(image.mean());
                let normal = if power.is_some() && mean > 0.0 {
                    mean
                } else {
                    1.0
                };
                image.scaled(scale / normal)
            }
        };
        self.done(p);
        Ok(Glow {
            radiance,
            both_sides,
            power,
        })
    }
}

/// From the layout of maps of latitude by longitude here (+y is the zenith, the middle is +z) to
/// that of v3: +z is the zenith, columns begin at +x and go on to +y.
const LAT_LONG: DAffine3 = DAffine3 {
    matrix3: DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::NEG_X),
    translation: DVec3::ZERO,
};

/// Luminous power of a slide whose luminance is an intensity: over its area at distance 1 a
/// steradian is the third power of the cosine.
fn slide_power(slide: &Texture, [width, height]: [u32; 2], half: [f32; 2]) -> f32 {
    let area = 4.0 * half[0] * half[1];
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            let at = |i: u32, n: u32, half: f32| half * (2.0 * (i as f32 + 0.5) / n as f32 - 1.0);
            let place = Vec3::new(at(x, width, half[0]), at(y, height, half[1]), 1.0);
            let value = match slide {
                Texture::Bitmap(bitmap) => bitmap.texel(x, y),
                other => other.mean(),
            };
            sum += f64::from(luminance(value) * place.length_recip().powi(3));
        }
    }
    (sum / (f64::from(width) * f64::from(height))) as f32 * area
}
