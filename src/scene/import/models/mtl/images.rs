//! Images of MTL files: where they lie, how they are laid, and what bends normals.

use super::Reader;
use super::map::Map;
use crate::image::file::ImageFile;
use crate::math::{Rgb, Vec2};
use crate::scene::import::{ImportError, named};
use crate::texture::{BitmapSettings, Filter, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2};
use std::path::Path;
use std::sync::Arc;

/// What an image is read for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    Color,
    Number,
    Vector,
    Opacity,
}

impl Reader<'_> {
    /// The map of normals, as strong as `-bm` says.
    pub(super) fn normals(&mut self) -> Result<Option<Texture>, ImportError> {
        let (name, normals) = match self.map("norm", Use::Vector)? {
            Some(normals) => ("norm", Some(normals)),
            None => ("map_bump", self.bumps()?),
        };
        let strength = self.entry.map(name).map_or(1.0, |m| m.strength);
        Ok(normals.map(|n| match strength {
            1.0 => n,
            s => {
                // n = 2 t - 1, so a factor s on n is t' = s t + (1 - s) / 2.
                let factor = Rgb::new(s, s, 1.0);
                Texture::Affine(Arc::new((n, factor, (Rgb::ONE - factor) * 0.5)))
            }
        }))
    }

    /// An image of bumps that holds normals, as Blender writes them: on average they point straight
    /// away from the surface. Heights are left out, as the format does not say how high they are.
    fn bumps(&mut self) -> Result<Option<Texture>, ImportError> {
        let Some(image) = self.map("map_bump", Use::Vector)? else {
            return Ok(None);
        };
        let away = image.mean() - Rgb::new(0.5, 0.5, 1.0);
        if away.abs().max_element() < 0.25 {
            self.warn("`map_Bump` holds normals, and is taken as `norm`");
            return Ok(Some(image));
        }
        self.warn("`map_Bump` holds heights, and is left out");
        Ok(None)
    }

    /// Opens an image; `None` where there is none or a missing one is forgiven.
    pub(super) fn map(&mut self, name: &str, how: Use) -> Result<Option<Texture>, ImportError> {
        let entry = self.entry;
        let Some(map) = entry.map(name) else {
            return Ok(None);
        };
        let folder = entry.file.parent().unwrap_or(Path::new(""));
        let mut path = named::resolve(folder, &map.file);
        if let Some(beside) = named::beside(&path, folder, &map.file) {
            self.warn(format!("for `{}` stands {}", map.file, beside.display()));
            path = beside;
        }
        let hint = named::hint(&path, folder);
        let channel = match how {
            Use::Opacity => map.channel.or_else(|| alpha_of(&path)),
            Use::Number => map.channel,
            Use::Color | Use::Vector => None,
        };
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let opened = self.options.textures.open(BitmapSettings {
            path,
            raw: how != Use::Color,
            gamma: None,
            filter: Filter::Linear,
            wrap_u: wrap,
            wrap_v: wrap,
            to_uv: placement(map),
            channel: channel.map(str::to_owned),
        });
        match opened {
            Ok(texture) => Ok(Some(stretched(texture, map.range))),
            Err(e) if self.options.lenient => {
                self.parts.warn(format!("a texture is left out: {e}{hint}"));
                Ok(None)
            }
            Err(e) => Err(ImportError {
                at: None,
                file: Some(entry.file.clone()),
                message: format!(
                    "the texture {} of material \"{}\" cannot be used: {}{hint}",
                    e.path, self.name, e.reason
                ),
                help: Some("restore the file, or go on without it with --lenient".into()),
            }),
        }
    }
}

/// Where an image is laid. In the format v points up and row 0 lies at v = 1; here v is 1 - v
/// already, so that s v + o becomes s v + (1 - s - o).
fn placement(map: &Map) -> UvTransform {
    let (scale, offset) = (map.scale, map.offset);
    UvTransform(Affine2 {
        matrix2: Mat2::from_diagonal(scale),
        translation: Vec2::new(offset.x, 1.0 - scale.y - offset.y),
    })
}

/// Values times the second number plus the first.
fn stretched(texture: Texture, [base, gain]: [f32; 2]) -> Texture {
    match base {
        0.0 => texture.scaled(Rgb::splat(gain)),
        _ => Texture::Affine(Arc::new((texture, Rgb::splat(gain), Rgb::splat(base)))),
    }
}

/// The channel that holds an image's opacity, if there is one; other images hold it in their grey.
fn alpha_of(path: &Path) -> Option<&'static str> {
    let file = ImageFile::open(path).ok()?;
    let channels = file.header().channels.len();
    matches!(channels, 2 | 4).then_some("a")
}
