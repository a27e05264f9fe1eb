//! Image textures.

use super::importer::{Importer, Role};
use super::params::Params;
use crate::math::Rgb;
use crate::scene::import::faults::At;
use crate::scene::import::named;
use crate::texture::{BitmapSettings, Computed, Filter, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2, Vec2};
use std::path::PathBuf;
use std::sync::Arc;

/// v points up, rows of images go down.
pub(super) fn flipped(to_uv: Affine2) -> UvTransform {
    let flip = Affine2 {
        matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)),
        translation: Vec2::Y,
    };
    UvTransform(flip * to_uv)
}

impl<'s> Importer<'s> {
    /// A texture of the kind `imagemap`.
    pub fn image_map(&mut self, p: &Params<'_, 's>, role: Role) -> Result<Texture, String> {
        let Some(path) = self.file_given(p, "filename") else {
            return Err("an imagemap needs a \"filename\"".into());
        };
        // Filtering is the renderer's business.
        p.ignore(&["maxanisotropy", "trilinear"]);
        let filters = [
            ("point", Filter::Nearest),
            ("bilinear", Filter::Linear),
            ("trilinear", Filter::Linear),
            ("ewa", Filter::Linear),
            ("EWA", Filter::Linear),
        ];
        let wrap = self.wrap(p);
        let (raw, gamma) = self.encoding(p);
        let settings = BitmapSettings {
            path,
            raw,
            gamma,
            filter: p.choice("filter", &filters).unwrap_or_default(),
            wrap_u: wrap,
            wrap_v: wrap,
            to_uv: flipped(self.mapping(p)),
            channel: None,
        };
        let mut image = self.open(settings, p.place_of("filename"))?;
        // A colour image that stands for a number: pbrt takes the mean of its channels.
        let is_grey = matches!(&image, Texture::Bitmap(bitmap) if bitmap.is_grey());
        if role == Role::Number && !is_grey {
            image = super::textures::computed(Computed::ChannelMean(image));
        }
        let scale = p.float("scale", 1.0) as f32;
        if !p.boolean("invert", false) {
            return Ok(image.scaled(Rgb::splat(scale)));
        }
        let inverted = (image, Rgb::splat(-scale), Rgb::ONE);
        let inverted = Texture::Affine(Arc::new(inverted));
        // What is above 1 would be negative.
        Ok(match role {
            Role::Reflectance | Role::Number => Texture::Limited(Arc::new(inverted)),
            Role::Unbounded => inverted,
        })
    }

    /// Opens an image; what is odd about it is told.
    pub fn open(&mut self, settings: BitmapSettings, at: At) -> Result<Texture, String> {
        let path: PathBuf = settings.path.clone();
        if !path.exists() {
            let hint = named::hint_of(&path);
            return Err(format!("there is no texture {}{hint}", path.display()));
        }
        let opened = self.options.textures.open(settings);
        let texture =
            opened.map_err(|e| format!("cannot read the texture {}: {}", e.path, e.reason))?;
        if let Texture::Bitmap(bitmap) = &texture {
            for oddity in bitmap.oddities() {
                self.warn_at(at, &format!("{}: {oddity}", path.display()));
            }
        }
        Ok(texture)
    }

    fn wrap(&mut self, p: &Params) -> Wrap {
        let modes = [
            ("repeat", (Wrap::Repeat, true)),
            ("clamp", (Wrap::Clamp, true)),
            ("black", (Wrap::Clamp, false)),
            ("octahedralsphere", (Wrap::Clamp, false)),
        ];
        let (wrap, exact) = p.choice("wrap", &modes).unwrap_or_default();
        if !exact && p.has("wrap") {
            self.warn_at(
                p.place_of("wrap"),
                "this wrap mode is rendered as \"clamp\"",
            );
        }
        wrap
    }

    /// Whether numbers are taken as they are, and the exponent that takes the place of the file's
    /// own curve.
    fn encoding(&mut self, p: &Params) -> (bool, Option<f32>) {
        // v3: false leaves the numbers of 8 bit files as they are.
        if let Some(given) = p.any("gamma") {
            return match given.kind {
                super::parameter::Kind::Bool => (!p.boolean("gamma", true), None),
                _ => (false, p.float_given("gamma").map(|g| g as f32)),
            };
        }
        let Some(text) = p.text("encoding") else {
            return (false, None);
        };
        let gamma = text.strip_prefix("gamma ").map(|g| g.trim().parse::<f32>());
        match (text, gamma) {
            ("sRGB", _) => (false, None),
            ("linear", _) => (true, None),
            (_, Some(Ok(gamma))) if gamma > 0.0 && gamma.is_finite() => (false, Some(gamma)),
            _ => {
                let message =
                    format!("\"encoding\" is \"{text}\"; it can be sRGB, linear or gamma NUMBER");
                p.wrong("encoding", message);
                (false, None)
            }
        }
    }
}
