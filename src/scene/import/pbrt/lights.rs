//! Lights that stand in the scene by themselves, and what shapes emit. Those that are images are in
//! [`super::image_lights`].

use super::graphics::single;
use super::images::flipped;
use super::importer::Importer;
use super::parameter::Kind;
use super::params::Params;
use super::pending::Glow;
use crate::light::{Emitter, Falloff};
use crate::math::{DAffine3, DVec3, Rgb, luminance};
use crate::scene::import::{ImportError, named};
use crate::texture::{BitmapSettings, Texture};
use glam::{Affine2, DMat3};
use std::f32::consts::PI;

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
    pub fn scale(&mut self, p: &Params<'_, 's>) -> Rgb {
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
    pub fn strength(&mut self, p: &Params<'_, 's>, name: &'static str, emitted: f32) -> Rgb {
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
