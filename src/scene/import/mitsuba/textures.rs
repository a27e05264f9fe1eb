//! Colours and textures of parameters.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::value::{self, Color, Dialect, Value};
use crate::math::{DAffine3, Rgb};
use crate::scene::import::{ImportError, named};
use crate::texture::{BitmapSettings, Checkerboard, Filter, Grid, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2, Vec2};
use std::sync::Arc;

/// Textures that one may be made of. Thirty that each hold the next one twice would be 2^30.
const MOST_TEXTURES: usize = 256;

/// Stands for the size of what was refused for it: what holds that is plain too, without a word
/// more.
pub(super) const TOO_LARGE: usize = 1 << 40;

impl<'a> Importer<'a> {
    /// The texture `name`; `default` everywhere if it is not given, or wrong.
    pub fn texture(
        &mut self,
        params: &Params<'a>,
        name: &'static str,
        default: f32,
        role: Role,
    ) -> Texture {
        let given = self.texture_given(params, name, role);
        given.unwrap_or(Texture::Constant(Rgb::splat(default)))
    }

    /// The texture `name`, if it is given and can be read.
    pub fn texture_given(
        &mut self,
        params: &Params<'a>,
        name: &'static str,
        role: Role,
    ) -> Option<Texture> {
        let property = params.find(name)?;
        let color = match &property.value {
            Value::Float(v) => Rgb::splat(*v as f32),
            Value::Integer(v) => Rgb::splat(*v as f32),
            Value::Color(color) => color.to_rgb(role.weighting(), params.dialect()),
            // Triples that are no colours, such as normals.
            Value::Vector(v) if role == Role::Number => v.as_vec3(),
            Value::Object(index) => return Some(self.texture_object(*index, role)),
            Value::Broken => return None,
            _ => {
                let error = params.wrong(property, "a colour or a texture");
                params.fault(property.at, error);
                return None;
            }
        };
        let place = || self.document.location(property.at).to_string();
        let (color, warning) = bounded(color, role, &property.written, place);
        warning.into_iter().for_each(|w| self.warnings.tell(w));
        Some(Texture::Constant(color))
    }

    /// The colour `name`, if it is given; a texture that varies is an error.
    pub fn color(&mut self, params: &Params<'a>, name: &'static str, role: Role) -> Option<Rgb> {
        match self.texture_given(params, name, role)? {
            Texture::Constant(color) => Some(color),
            _ => {
                let at = params.place_of(name);
                let message = format!("\"{name}\" must be one colour, not a texture");
                params.fault(at, self.document.error(at, message));
                None
            }
        }
    }

    /// The texture that object `index` describes. The same object gives the same texture.
    pub fn texture_object(&mut self, index: usize, role: Role) -> Texture {
        if let Some(done) = self.texture_of.get(&(index, role)) {
            return done.clone();
        }
        let made = self.make_texture(index, role);
        let instead = "mid-grey takes its place";
        let grey = |_: &mut Self| Texture::Constant(Rgb::splat(0.5));
        let texture = self.or_instead(index, made, instead, grey);
        self.texture_of.insert((index, role), texture.clone());
        texture
    }

    fn make_texture(&mut self, index: usize, role: Role) -> Result<Texture, ImportError> {
        let params = Params::new(self.document, index);
        let tag = &self.document.objects[index].tag;
        if tag != "texture" && tag != "spectrum" {
            return Err(params.error(format!("a colour or texture is expected, not a <{tag}>")));
        }
        let texture = match params.plugin() {
            "bitmap" => self.bitmap(&params)?,
            "checkerboard" => self.checkerboard(&params, role),
            "gridtexture" => self.grid(&params, role),
            "scale" => self.scaled(&params, role)?,
            "mesh_attribute" => self.mesh_attribute(&params)?,
            "vertexcolors" => Texture::MeshAttribute("vertex_color".into()),
            _ => Texture::Constant(self.spectrum_object(&params, role)?),
        };
        self.done(&params);
        let size = self.size_of(&params);
        let size = if size > MOST_TEXTURES {
            size.max(TOO_LARGE)
        } else {
            size
        };
        self.texture_size.insert(index, size.min(TOO_LARGE));
        if size > TOO_LARGE {
            return Ok(Texture::Constant(Rgb::splat(0.5)));
        }
        if size == TOO_LARGE {
            return Err(params.error(format!(
                "this texture is made of more than {MOST_TEXTURES}, one that is referred to twice counted twice"
            )));
        }
        Ok(self.within(texture, role, index))
    }

    /// How many textures one is made of, itself included.
    fn size_of(&self, params: &Params<'a>) -> usize {
        let mut inner = params.children("texture");
        inner.extend(params.children("spectrum"));
        let sizes = inner
            .iter()
            .map(|(_, i)| self.texture_size.get(i).unwrap_or(&1));
        1 + sizes.sum::<usize>()
    }

    /// A texture cut to the range of its role, with a warning where it leaves that.
    fn within(&mut self, texture: Texture, role: Role, index: usize) -> Texture {
        if let Texture::Constant(color) = texture {
            let object = &self.document.objects[index];
            let place = || self.document.location(object.at).to_string();
            let (color, warning) = bounded(color, role, &object.plugin, place);
            warning.into_iter().for_each(|w| self.warnings.tell(w));
            return Texture::Constant(color);
        }
        let largest = texture.largest();
        let Some(largest) = largest.filter(|l| role == Role::Reflectance && *l > 1.0) else {
            return texture;
        };
        // What rounding leaves above 1 is cut without a word, as a colour's is.
        if largest > 1.01 {
            let object = &self.document.objects[index];
            let (place, plugin) = (self.document.location(object.at), &object.plugin);
            self.warnings.tell(format!(
                "{place}: this {plugin} reaches {largest}; as a reflectance it was cut to the range 0 to 1"
            ));
        }
        Texture::Limited(Arc::new(texture))
    }

    fn bitmap(&mut self, params: &Params<'a>) -> Result<Texture, ImportError> {
        let Some(name) = params.text("filename") else {
            return Err(params.error("a bitmap needs a \"filename\""));
        };
        let at = params.place_of("filename");
        // Caches and anisotropy are the texture system's business here.
        params.ignore(&["cache", "max_anisotropy", "format", "accel"]);
        let filters = [
            ("bilinear", Filter::Linear),
            ("trilinear", Filter::Linear),
            ("ewa", Filter::Linear),
            ("nearest", Filter::Nearest),
        ];
        let both = self.wrap(params, "wrap_mode");
        let raw = params.boolean("raw", false);
        let settings = BitmapSettings {
            path: self.document.resolve(at, name),
            raw,
            // Mitsuba 0.x: -1 stands for the sRGB curve, which is what 8 bit files get anyway.
            gamma: params
                .number("gamma")
                .filter(|g| *g > 0.0)
                .map(|g| g as f32),
            filter: params.choice("filter_type", &filters).unwrap_or_default(),
            wrap_u: self
                .wrap(params, "wrap_mode_u")
                .or(both)
                .unwrap_or_default(),
            wrap_v: self
                .wrap(params, "wrap_mode_v")
                .or(both)
                .unwrap_or_default(),
            to_uv: self.uv_transform(params),
            channel: params.text("channel").map(str::to_owned),
        };
        let path = settings.path.clone();
        if !path.exists() {
            let hint = named::hint_of(&path);
            let message = format!("there is no texture {}{hint}", path.display());
            return Err(self.document.error(at, message));
        }
        let opened = self.options.textures.open(settings);
        let texture = opened.map_err(|e| {
            let message = format!("cannot read the texture {}: {}", e.path, e.reason);
            self.document.error(at, message)
        })?;
        if let Texture::Bitmap(bitmap) = &texture {
            let place = self.document.location(at);
            for oddity in bitmap.oddities() {
                self.warnings
                    .tell(format!("{place}: {}: {oddity}", path.display()));
            }
        }
        Ok(texture)
    }

    fn wrap(&mut self, params: &Params<'a>, name: &'static str) -> Option<Wrap> {
        let modes = [
            ("repeat", (Wrap::Repeat, true)),
            ("mirror", (Wrap::Mirror, true)),
            ("clamp", (Wrap::Clamp, true)),
            ("zero", (Wrap::Clamp, false)),
            ("one", (Wrap::Clamp, false)),
        ];
        let (wrap, exact) = params.choice(name, &modes)?;
        if !exact {
            let place = self.document.location(params.place_of(name));
            self.warnings
                .tell(format!("{place}: this wrap mode is rendered as \"clamp\""));
        }
        Some(wrap)
    }

    /// `to_uv` (Mitsuba 3) or `uscale`, `vscale`, `uoffset`, `voffset` (0.x: scale, then offset).
    fn uv_transform(&mut self, params: &Params<'a>) -> UvTransform {
        let scale = params.float("uvscale", 1.0);
        let scale_u = params.float("uscale", scale);
        let scale_v = params.float("vscale", scale);
        let offset = Vec2::new(
            params.float("uoffset", 0.0) as f32,
            params.float("voffset", 0.0) as f32,
        );
        let scale = Vec2::new(scale_u as f32, scale_v as f32);
        let simple = Affine2::from_scale_angle_translation(scale, 0.0, offset);
        let general = params.transform("to_uv").map_or(Affine2::IDENTITY, flat);
        UvTransform(general * simple)
    }

    fn checkerboard(&mut self, params: &Params<'a>, role: Role) -> Texture {
        Texture::Checkerboard(Arc::new(Checkerboard {
            color0: self.texture(params, "color0", 0.4, role),
            color1: self.texture(params, "color1", 0.2, role),
            to_uv: self.uv_transform(params),
            swaps_numbers: params.dialect() == Dialect::Modern,
        }))
    }

    fn grid(&mut self, params: &Params<'a>, role: Role) -> Texture {
        let color = |c: Option<Rgb>, default| c.unwrap_or(Rgb::splat(default));
        Texture::Grid(Arc::new(Grid {
            color0: color(self.color(params, "color0", role), 0.2),
            color1: color(self.color(params, "color1", role), 0.4),
            line_width: params.float_in("line_width", 0.01, 0.0..=1.0) as f32,
            to_uv: self.uv_transform(params),
        }))
    }

    fn scaled(&mut self, params: &Params<'a>, role: Role) -> Result<Texture, ImportError> {
        // Only one of the two factors carries the role: light times a number is light. A
        // reflectance is in range when both are multiplied.
        let part = match role {
            Role::Light => Role::Light,
            Role::Reflectance | Role::Number => Role::Number,
        };
        let factor = self
            .color(params, "scale", Role::Number)
            .unwrap_or(Rgb::ONE);
        let mut nested = params.children("texture");
        nested.extend(params.children("spectrum"));
        let inner = match nested.as_slice() {
            [(_, index)] => self.texture_object(*index, part),
            _ => match self.texture_given(params, "value", part) {
                Some(value) => value,
                None => return Err(params.error("\"scale\" needs one texture inside")),
            },
        };
        Ok(times(inner, factor))
    }

    fn mesh_attribute(&mut self, params: &Params<'a>) -> Result<Texture, ImportError> {
        let Some(name) = params.text("name") else {
            return Err(params.error("a mesh_attribute needs a \"name\" such as vertex_color"));
        };
        let factor = params.float("scale", 1.0) as f32;
        let texture = Texture::MeshAttribute(name.into());
        Ok(times(texture, Rgb::splat(factor)))
    }

    /// Spectra written as plugins (Mitsuba 3).
    fn spectrum_object(&mut self, params: &Params<'a>, role: Role) -> Result<Rgb, ImportError> {
        let list = |name| -> Result<Option<Vec<f64>>, ImportError> {
            let Some(text) = params.text(name) else {
                return Ok(None);
            };
            let numbers = value::numbers(text).map_err(|m| params.error(m))?;
            Ok(Some(numbers))
        };
        let color = match params.plugin() {
            "srgb" => return Ok(self.color(params, "color", role).unwrap_or(Rgb::ONE)),
            // Both are white in RGB: light of D65's colour, and a number that is not a colour.
            "d65" => Color::Rgb(glam::DVec3::splat(params.float("scale", 1.0))),
            "rawconstant" => {
                let value = self.color(params, "value", Role::Number);
                return Ok(value.unwrap_or(Rgb::ONE));
            }
            "uniform" => return Ok(self.color(params, "value", role).unwrap_or(Rgb::ONE)),
            "blackbody" => {
                let kelvin = params.positive("temperature", 5000.0);
                Color::BlackBody(kelvin, params.float("scale", 1.0))
            }
            "irregular" => {
                let (Some(w), Some(v)) = (list("wavelengths")?, list("values")?) else {
                    return Err(params.error("\"irregular\" needs \"wavelengths\" and \"values\""));
                };
                self.samples(params, w, v)?
            }
            _ => {
                let low = params.float("wavelength_min", 360.0);
                let high = params.float("wavelength_max", 830.0);
                let v = list("values")?.unwrap_or_default();
                let step = (high - low) / (v.len().max(2) - 1) as f64;
                let w = (0..v.len()).map(|i| low + step * i as f64).collect();
                self.samples(params, w, v)?
            }
        };
        Ok(color.to_rgb(role.weighting(), params.dialect()))
    }

    fn samples(
        &self,
        params: &Params<'a>,
        wavelengths: Vec<f64>,
        values: Vec<f64>,
    ) -> Result<Color, ImportError> {
        if wavelengths.len() != values.len() {
            let (w, v) = (wavelengths.len(), values.len());
            return Err(params.error(format!("{w} wavelengths but {v} values")));
        }
        let pairs = wavelengths.into_iter().zip(values).collect();
        value::samples(pairs).map_err(|m| params.error(m))
    }
}

/// `texture` times `factor`, multiplied at once where it is constant.
pub(super) fn times(texture: Texture, factor: Rgb) -> Texture {
    match texture {
        texture if factor == Rgb::ONE => texture,
        Texture::Constant(color) => Texture::Constant(color * factor),
        texture => Texture::Scale(Arc::new((texture, factor))),
    }
}

/// Keeps a colour in the range of its role, with a warning where it was clearly outside.
fn bounded(
    color: Rgb,
    role: Role,
    name: &str,
    place: impl Fn() -> String,
) -> (Rgb, Option<String>) {
    let (high, range) = match role {
        Role::Number => return (color, None),
        Role::Reflectance => (1.0, "0 to 1"),
        Role::Light => (f32::MAX, "0 and more"),
    };
    let kept = color.clamp(Rgb::ZERO, Rgb::splat(high));
    // Colours from spectra leave the gamut by a little; that is no mistake of the scene's author.
    let odd = (color - kept).abs().max_element() > 0.01;
    let warning = odd.then(|| {
        let (place, c) = (place(), color.to_array());
        format!("{place}: \"{name}\" is {c:?}; it was cut to the range {range}")
    });
    (kept, warning)
}

/// The part of a transform that acts on (u, v).
fn flat(m: DAffine3) -> Affine2 {
    let (x, y, t) = (m.matrix3.x_axis, m.matrix3.y_axis, m.translation);
    Affine2::from_mat2_translation(
        Mat2::from_cols(x.truncate().as_vec2(), y.truncate().as_vec2()),
        t.truncate().as_vec2(),
    )
}
