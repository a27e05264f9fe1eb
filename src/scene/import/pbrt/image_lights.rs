//! Lights that show an image: around the scene, as a slide, around a point.

use super::graphics::single;
use super::importer::Importer;
use super::parameter::Kind;
use super::params::Params;
use crate::image::file::ImageFile;
use crate::light::{Emitter, EnvironmentImage, Layout, Slide};
use crate::math::{DAffine3, DVec3, Vec3, luminance};
use crate::scene::import::named;
use crate::texture::{BitmapSettings, Filter, Texture, Wrap};
use glam::{Affine2, DMat3};
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

impl<'s> Importer<'s> {
    pub fn infinite(&mut self, p: &Params<'_, 's>, to_world: DAffine3) -> Result<Emitter, String> {
        p.ignore(&["nsamples", "samples"]);
        self.left_out(
            p,
            &["portal"],
            "light comes from everywhere; in pbrt from nowhere else than through the portal, so \
            that what is open elsewhere is brighter here",
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
        let is_equal_area = image.layout() == Layout::EqualArea;
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
    pub fn light_image(
        &mut self,
        p: &Params<'_, 's>,
        name: &'static str,
    ) -> Result<Texture, String> {
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

    pub fn projection(
        &mut self,
        p: &Params<'_, 's>,
        to_world: DAffine3,
    ) -> Result<Emitter, String> {
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

    /// A point light by an image over directions: v4 takes the mean of its channels, v3 its colours.
    pub fn goniometric(
        &mut self,
        p: &Params<'_, 's>,
        to_world: DAffine3,
    ) -> Result<Emitter, String> {
        let names = ["filename", "mapname"].into_iter();
        let Some(name) = names.into_iter().find(|name| p.has(name)) else {
            let position = to_world.translation - self.origin;
            return Ok(Emitter::Point {
                position: position.as_vec3(),
                intensity: self.strength(p, "I", 4.0 * PI),
            });
        };
        let path = self
            .file_given(p, name)
            .ok_or("the file's name is expected")?;
        let mut image = self.environment(p, name, &path)?;
        if name == "filename" {
            image = Arc::new(image.channel_means());
        }
        let emitted = 4.0 * PI * luminance(image.mean());
        let intensity = self.strength(p, "I", emitted);
        // y is the axis of the image, which stands on its z.
        let turned = to_world * SWAP_YZ;
        let place = match image.layout() {
            Layout::EqualArea => turned,
            Layout::LatLong => turned * LAT_LONG,
        };
        Ok(Emitter::Goniometric {
            to_world: single(self.place(place, None)),
            image,
            intensity,
        })
    }
}

/// From the layout of maps of latitude by longitude here (+y is the zenith, the middle is +z) to
/// that of v3: +z is the zenith, columns begin at +x and go on to +y.
const LAT_LONG: DAffine3 = DAffine3 {
    matrix3: DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::NEG_X),
    translation: DVec3::ZERO,
};

/// y and z change places.
const SWAP_YZ: DAffine3 = DAffine3 {
    matrix3: DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y),
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
