//! Textures by name, and those that are made of others. Images are in [`super::images`].

use super::graphics::Definition;
use super::importer::{Importer, Role};
use super::parameter::{Kind, Parameter, Values};
use super::params::Params;
use super::statement::Directive;
use crate::math::{DVec3, Rgb};
use crate::texture::{Checkerboard, Computed, NoiseKind, Octaves, Texture, UvTransform};
use glam::{Affine2, Vec2};
use std::sync::Arc;

/// The kinds of textures that are read, and those that pbrt has besides.
pub(super) const TEXTURES: &[&str] = &[
    "constant",
    "scale",
    "mix",
    "directionmix",
    "bilerp",
    "imagemap",
    "checkerboard",
    "dots",
    "fbm",
    "wrinkled",
    "windy",
    "marble",
];

/// Octaves of noise: beyond them no float has digits.
const MOST_OCTAVES: u32 = 32;

impl<'s> Importer<'s> {
    /// The texture `name`; `default` everywhere if it is not given, or wrong.
    pub fn texture(
        &mut self,
        p: &Params<'_, 's>,
        name: &'static str,
        role: Role,
        default: f32,
    ) -> Texture {
        let given = self.texture_given(p, name, role);
        given.unwrap_or(Texture::Constant(Rgb::splat(default)))
    }

    /// The texture `name`, if it is given and can be read.
    pub fn texture_given(
        &mut self,
        p: &Params<'_, 's>,
        name: &'static str,
        role: Role,
    ) -> Option<Texture> {
        let given = p.any(name)?;
        match given.kind {
            Kind::Texture => {
                let called = p.only_text(given)?;
                self.named_texture(called, given, role)
            }
            Kind::Float | Kind::Integer => p
                .float_given(name)
                .map(|value| Texture::Constant(Rgb::splat(value as f32))),
            _ if role != Role::Number => self.factor_of(p, given, role).map(Texture::Constant),
            _ => {
                let kind = given.values.described();
                p.wrong(
                    name,
                    format!("\"{name}\" is a number or a texture of numbers, not {kind}"),
                );
                None
            }
        }
    }

    /// The texture `name` where a single value is all that can be rendered: its mean, which is told.
    pub fn mean_given(
        &mut self,
        p: &Params<'_, 's>,
        name: &'static str,
        role: Role,
    ) -> Option<Rgb> {
        let texture = self.texture_given(p, name, role)?;
        if texture.constant().is_none() {
            self.warn_at(
                p.place_of(name),
                &format!("\"{name}\" is the same everywhere here: its texture's mean"),
            );
        }
        Some(texture.mean())
    }

    /// The texture of that name, one of numbers or of colours.
    pub fn named_texture(
        &mut self,
        name: &'s str,
        given: &Parameter,
        role: Role,
    ) -> Option<Texture> {
        let numbers = role == Role::Number;
        let known = self.named_textures.get(&(name, numbers)).cloned();
        let definition = known.or_else(|| self.later(Directive::Texture, name, numbers));
        let Some(definition) = definition else {
            let class = if numbers { "float" } else { "spectrum" };
            let other = self.named_textures.contains_key(&(name, !numbers));
            let hint = match other {
                true => "; the one of that name is of the other type",
                false => "",
            };
            let message = format!("there is no {class} texture \"{name}\"{hint}");
            self.source
                .fault(given.at, message, "the default takes its place");
            return None;
        };
        Some(self.texture_of(&definition, role))
    }

    /// The texture of a definition. The same definition gives the same texture.
    fn texture_of(&mut self, definition: &Definition<'s>, role: Role) -> Texture {
        let key = (definition.identity(), role);
        if let Some(texture) = self.texture_of.known(&key) {
            return texture;
        }
        let begun = self.texture_of.begin();
        let made = match &begun.too_deep {
            Ok(()) => self.make_texture(definition, role),
            Err(message) => Err(message.clone()),
        };
        let made = made.and_then(|texture| self.texture_of.bounded().map(|()| texture));
        let is_whole = made.is_ok();
        let texture = match made {
            Ok(texture) => self.within(texture, role, definition),
            Err(message) => {
                self.source
                    .fault(definition.at, message, "mid-grey takes its place");
                Texture::Constant(Rgb::splat(0.5))
            }
        };
        self.texture_of.end(&begun, key, &texture, is_whole);
        texture
    }

    /// A texture cut to the range of its role, with a warning where it leaves that.
    fn within(&mut self, texture: Texture, role: Role, definition: &Definition<'s>) -> Texture {
        let largest = texture.largest();
        let Some(largest) = largest.filter(|l| role == Role::Reflectance && *l > 1.0) else {
            return texture;
        };
        if largest > 1.01 {
            let name = &definition.plugin.name;
            self.warn_at(definition.at, &format!(
                "texture \"{name}\" reaches {largest}; as a reflectance it was cut to the range 0 \
                 to 1"
            ));
        }
        match texture {
            Texture::Constant(c) => Texture::Constant(c.clamp(Rgb::ZERO, Rgb::ONE)),
            texture => Texture::Limited(Arc::new(texture)),
        }
    }

    fn make_texture(&mut self, definition: &Definition<'s>, role: Role) -> Result<Texture, String> {
        let p = &Params::new(self.source, definition);
        // What is multiplied or mixed is in range when all is done.
        let part = match role {
            Role::Number => Role::Number,
            Role::Reflectance | Role::Unbounded => Role::Unbounded,
        };
        let texture = match p.name() {
            "constant" => self.texture(p, "value", part, 1.0),
            "scale" => {
                // v3 calls the factors tex1 and tex2.
                let names = if p.has("tex1") {
                    ["tex1", "tex2"]
                } else {
                    ["tex", "scale"]
                };
                let factor = match p.any(names[1]).map(|g| g.kind) {
                    Some(Kind::Texture) if names[1] == "scale" => Role::Number,
                    _ => part,
                };
                let inner = self.texture(p, names[0], part, 1.0);
                inner.times(self.texture(p, names[1], factor, 1.0))
            }
            "mix" => computed(Computed::Mix {
                first: self.texture(p, "tex1", part, 0.0),
                second: self.texture(p, "tex2", part, 1.0),
                amount: self.texture(p, "amount", Role::Number, 0.5),
            }),
            "directionmix" => self.direction_mix(p, part)?,
            "bilerp" => self.bilinear(p, part),
            "imagemap" => self.image_map(p, role)?,
            "checkerboard" => self.checkerboard(p, part)?,
            "dots" => computed(Computed::Dots {
                inside: self.texture(p, "inside", part, 1.0),
                outside: self.texture(p, "outside", part, 0.0),
                to_uv: UvTransform(self.mapping(p)),
            }),
            "fbm" => self.noise(p, NoiseKind::Fbm(octaves(p)))?,
            "wrinkled" => self.noise(p, NoiseKind::Wrinkled(octaves(p)))?,
            "windy" => self.noise(p, NoiseKind::Windy)?,
            "marble" => {
                let kind = NoiseKind::Marble {
                    octaves: octaves(p),
                    scale: p.float("scale", 1.0) as f32,
                    variation: p.float("variation", 0.2) as f32,
                };
                self.noise(p, kind)?
            }
            other => {
                let help =
                    crate::scene::import::named::did_you_mean(other, TEXTURES.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                return Err(format!(
                    "textures of the kind \"{other}\" are not read{help}"
                ));
            }
        };
        self.done(p);
        Ok(texture)
    }

    /// Placement by texture coordinates. Other mappings are told, and texture coordinates take
    /// their place.
    pub fn mapping(&mut self, p: &Params<'_, 's>) -> Affine2 {
        let mapping = p.text("mapping").unwrap_or("uv");
        if mapping != "uv" {
            let at = p.place_of("mapping");
            self.warn_at(at, &format!(
                "the mapping \"{mapping}\" is left out: the shape's texture coordinates take its \
                 place"
            ));
            p.ignore(&["v1", "v2", "udelta", "vdelta"]);
            return Affine2::IDENTITY;
        }
        let of = |name, default| p.float(name, default) as f32;
        Affine2::from_scale_angle_translation(
            Vec2::new(of("uscale", 1.0), of("vscale", 1.0)),
            0.0,
            Vec2::new(of("udelta", 0.0), of("vdelta", 0.0)),
        )
    }

    fn checkerboard(&mut self, p: &Params<'_, 's>, part: Role) -> Result<Texture, String> {
        let (color0, color1) = (
            self.texture(p, "tex1", part, 1.0),
            self.texture(p, "tex2", part, 0.0),
        );
        // v3's choice of a filter.
        p.ignore(&["aamode"]);
        if p.integer_given("dimension") == Some(3) {
            return Ok(computed(Computed::Cubes {
                first: color0,
                second: color1,
                to_texture: self.to_texture(p)?,
            }));
        }
        // Here a unit holds two squares a side, in pbrt one.
        let halves = Affine2::from_scale(Vec2::splat(0.5));
        Ok(Texture::Checkerboard(Arc::new(Checkerboard {
            color0,
            color1,
            to_uv: UvTransform(halves * self.mapping(p)),
            swaps_numbers: false,
        })))
    }

    fn direction_mix(&mut self, p: &Params<'_, 's>, part: Role) -> Result<Texture, String> {
        let given = p.triple("dir", DVec3::Y);
        let to_world = p.definition.affine().ok_or(NOT_AFFINE)?;
        let direction = to_world.transform_vector3(given).try_normalize();
        Ok(computed(Computed::DirectionMix {
            along: self.texture(p, "tex1", part, 0.0),
            across: self.texture(p, "tex2", part, 1.0),
            direction: direction.ok_or("\"dir\" is zero")?.as_vec3(),
        }))
    }

    fn bilinear(&mut self, p: &Params<'_, 's>, part: Role) -> Texture {
        let corners = [("v00", 0.0), ("v01", 1.0), ("v10", 0.0), ("v11", 1.0)];
        let corners = corners.map(|(name, default)| {
            let corner = self.texture(p, name, part, default);
            corner.constant().unwrap_or(Rgb::splat(default))
        });
        let to_uv = UvTransform(self.mapping(p));
        computed(Computed::Bilinear { corners, to_uv })
    }

    fn noise(&mut self, p: &Params<'_, 's>, kind: NoiseKind) -> Result<Texture, String> {
        let to_texture = self.to_texture(p)?;
        Ok(computed(Computed::Noise { kind, to_texture }))
    }

    /// The world's space to that where the texture was defined.
    fn to_texture(&self, p: &Params) -> Result<crate::math::Affine3A, String> {
        let to_world = self.place(p.definition.affine().ok_or(NOT_AFFINE)?, None);
        if to_world.matrix3.determinant() == 0.0 {
            return Err("the texture's transform cannot be inverted".into());
        }
        Ok(super::graphics::single(to_world.inverse()))
    }

    /// A text that names a file, if it is given.
    pub fn file_given(&self, p: &Params<'_, 's>, name: &'static str) -> Option<std::path::PathBuf> {
        let given = p.find(name, &[Kind::Text])?;
        let text = p.only_text(given)?;
        Some(self.source.resolve(given.at, text))
    }
}

const NOT_AFFINE: &str = "the texture's transform is no affine map";

pub(super) fn computed(formula: Computed) -> Texture {
    let constant = formula.constant();
    constant.map_or_else(|| Texture::Computed(Arc::new(formula)), Texture::Constant)
}

fn octaves(p: &Params) -> Octaves {
    Octaves {
        count: p.count("octaves", 8).min(MOST_OCTAVES),
        roughness: p.float_in("roughness", 0.5, 0.0..=1.0) as f32,
    }
}

/// Whether a list of values is a single `""`: a name that stands for nothing.
pub(super) fn is_nothing(values: &Values) -> bool {
    matches!(values, Values::Texts(list) if matches!(list.as_slice(), [name] if name.is_empty()))
}
