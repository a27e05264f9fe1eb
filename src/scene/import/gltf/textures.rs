//! Textures: images with their samplers and placements. Where images come from is in
//! [`super::images`].

use super::schema::TextureInfo;
use super::{Importer, error};
use crate::image::{self, Compression, Image, WriteOptions};
use crate::math::Rgb;
use crate::scene::import::ImportError;
use crate::texture::{BitmapSettings, Filter, Texture, UvTransform, Wrap};
use glam::{Affine2, Mat2, Vec2};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;

/// Which numbers of an image are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// Colours behind the sRGB curve.
    Color,
    /// All channels as they are.
    Vector,
    /// One channel as it is: 0 is red.
    Channel(usize),
}

/// Extensions that name an image of another format.
const OTHERS: [&str; 3] = ["KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif"];

const CHANNELS: [&str; 4] = ["r", "g", "b", "a"];

fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// The placement that `KHR_texture_transform` asks for.
///
/// Offset * rotation * scale; a positive rotation turns coordinates counter-clockwise as they are
/// seen on the image, whose v points down.
pub(super) fn placement(info: &TextureInfo) -> UvTransform {
    let Some(extension) = info.extensions.get("KHR_texture_transform") else {
        return UvTransform(Affine2::IDENTITY);
    };
    let pair = |key: &str, default: Vec2| {
        let value = extension.get(key).cloned();
        let pair: Option<[f32; 2]> = value.and_then(|v| serde_json::from_value(v).ok());
        pair.map_or(default, Vec2::from)
    };
    let angle = extension.get("rotation").and_then(Value::as_f64);
    let (sin, cos) = angle.unwrap_or(0.0).sin_cos();
    let (sin, cos) = (sin as f32, cos as f32);
    let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    let scale = Mat2::from_diagonal(pair("scale", Vec2::ONE));
    UvTransform(Affine2 {
        matrix2: rotation * scale,
        translation: pair("offset", Vec2::ZERO),
    })
}

/// The set of texture coordinates that a texture is laid out with.
pub(super) fn uv_set(info: &TextureInfo) -> usize {
    let transform = info.extensions.get("KHR_texture_transform");
    let replaced = transform.and_then(|t| t.get("texCoord")?.as_u64());
    replaced.map_or(info.tex_coord, |set| set as usize)
}

impl Importer<'_> {
    /// The texture that a material names, times `factor`; the factor alone where there is none.
    pub(super) fn textured(
        &mut self,
        info: Option<&TextureInfo>,
        how: Use,
        factor: Rgb,
    ) -> Result<Texture, ImportError> {
        let texture = match info {
            Some(info) => self.texture(info, how)?,
            None => None,
        };
        Ok(texture.map_or(Texture::Constant(factor), |t| t.scaled(factor)))
    }

    /// The texture that a material names. `None` for the opacity of an image that has none, and for
    /// what is missing and forgiven.
    pub(super) fn texture(
        &mut self,
        info: &TextureInfo,
        how: Use,
    ) -> Result<Option<Texture>, ImportError> {
        let found = self.open(info, how);
        match found {
            Err(error) if self.options.lenient => {
                self.warn(format!("a texture is left out: {}", error.message));
                Ok(None)
            }
            found => found,
        }
    }

    /// Opens the first of a texture's images that can be used.
    fn open(&mut self, info: &TextureInfo, how: Use) -> Result<Option<Texture>, ImportError> {
        let images = self.images_of(info.index)?;
        let mut failed = None;
        for image in images {
            match self.open_image(info, image, how) {
                Ok(texture) => {
                    if let Some(error) = failed {
                        let ImportError { message, .. } = error;
                        let instead = self.image_name(image);
                        self.warn(format!("{message}; {instead} is taken instead"));
                    }
                    return Ok(texture);
                }
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        failed.map_or(Ok(None), Err)
    }

    fn open_image(
        &mut self,
        info: &TextureInfo,
        image: usize,
        how: Use,
    ) -> Result<Option<Texture>, ImportError> {
        let (path, channels) = self.image_file(image)?;
        let channel = match how {
            Use::Color | Use::Vector => None,
            // Grey images answer for red, green and blue alike.
            Use::Channel(3) if channels != 2 && channels != 4 => return Ok(None),
            Use::Channel(c) if c < 3 && channels < 3 => None,
            Use::Channel(c) => CHANNELS.get(c).map(|c| (*c).to_owned()),
        };
        let settings = BitmapSettings {
            raw: how != Use::Color,
            channel,
            ..self.settings(info, path)
        };
        let opened = self.options.textures.open(settings);
        opened.map(Some).map_err(|e| {
            let message = format!("{} cannot be used: {}", self.image_name(image), e.reason);
            error(self.path(), message)
        })
    }

    /// An image's numbers as they are, laid as the texture `info` says.
    fn settings(&self, info: &TextureInfo, path: PathBuf) -> BitmapSettings {
        let textures = &self.document().textures;
        let sampler = textures.get(info.index).and_then(|t| t.sampler);
        let sampler = sampler.and_then(|s| self.document().samplers.get(s));
        BitmapSettings {
            path,
            raw: true,
            gamma: None,
            filter: match sampler.and_then(|s| s.mag_filter) {
                Some(9728) => Filter::Nearest,
                _ => Filter::Linear,
            },
            wrap_u: wrap(sampler.and_then(|s| s.wrap_s)),
            wrap_v: wrap(sampler.and_then(|s| s.wrap_t)),
            to_uv: placement(info),
            channel: None,
        }
    }

    /// The file behind a texture.
    pub(super) fn texture_file(&mut self, info: &TextureInfo) -> Result<PathBuf, ImportError> {
        let images = self.images_of(info.index)?;
        let files: Vec<_> = images.into_iter().map(|i| self.image_file(i)).collect();
        let first = files.into_iter().reduce(|a, b| a.or(b));
        let (path, _) = first.unwrap_or_else(|| Err(error(self.path(), "no image")))?;
        Ok(path)
    }

    /// A texture laid as `info` says, of texels that were made from its image and a factor; `kind`
    /// tells it from others.
    pub(super) fn made(
        &mut self,
        info: &TextureInfo,
        factor: Rgb,
        (kind, size, texels): (&str, (u32, u32), &[Rgb]),
    ) -> Result<Texture, ImportError> {
        let image = info.index;
        let [r, g, b] = factor.to_array().map(f32::to_bits);
        let name = format!("texture-{image}-{kind}-{r:x}-{g:x}-{b:x}.exr");
        let fail = |why: String| {
            let message = format!("image {image} cannot be unpacked: {why}");
            error(&self.container.path, message)
        };
        let folder = self.images.folder().map_err(|e| fail(e.to_string()))?;
        let path = folder.join(name);
        if !path.exists() {
            let picture = Image::from_rgb(size.0, size.1, texels);
            let options = WriteOptions {
                compression: Compression::None,
                ..WriteOptions::default()
            };
            image::write(&path, &picture, &options).map_err(|e| fail(e.reason))?;
        }
        let opened = self.options.textures.open(self.settings(info, path));
        opened.map_err(|e| fail(e.reason))
    }

    /// The images behind a texture, those of extensions first.
    fn images_of(&self, texture: usize) -> Result<Vec<usize>, ImportError> {
        let fail = |message: String| error(self.path(), message);
        let found = self.document().textures.get(texture);
        let found = found.ok_or_else(|| fail(format!("there is no texture {texture}")))?;
        let other = |name: &&str| {
            let source = found.extensions.get(*name)?.get("source")?.as_u64()?;
            usize::try_from(source).ok()
        };
        let images: Vec<usize> = OTHERS
            .iter()
            .filter_map(other)
            .chain(found.source)
            .collect();
        if !images.is_empty() {
            return Ok(images);
        }
        let names: Vec<&str> = found.extensions.keys().map(String::as_str).collect();
        let of = match names.is_empty() {
            true => String::new(),
            false => format!(" that can be read, only one of {}", names.join(", ")),
        };
        Err(fail(format!("texture {texture} has no image{of}")))
    }
}

/// Normals times `scale` in x and y, before they are normalised; `mirrored` turns y around, for
/// triangles whose texture is laid on back to front.
pub(super) fn bent_normals(normals: Texture, scale: f32, mirrored: bool) -> Texture {
    let y = if mirrored { -scale } else { scale };
    if (scale, y) == (1.0, 1.0) {
        return normals;
    }
    // n = 2 t - 1, so a factor s on n is t' = s t + (1 - s) / 2.
    let factor = Rgb::new(scale, y, 1.0);
    let offset = (Rgb::ONE - factor) * 0.5;
    Texture::Affine(Arc::new((normals, factor, offset)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::SurfacePoint;

    fn transform(json: &str) -> UvTransform {
        let text = format!(r#"{{"index":0,"extensions":{{"KHR_texture_transform":{json}}}}}"#);
        placement(&serde_json::from_str(&text).unwrap())
    }

    #[test]
    fn coordinates_are_scaled_then_turned_then_moved() {
        let at = |t: &UvTransform, u, v| t.0.transform_point2(Vec2::new(u, v));
        let moved = transform(r#"{"offset":[0.25,0.5],"scale":[2.0,4.0]}"#);
        assert_eq!(at(&moved, 0.5, 0.25), Vec2::new(1.25, 1.5));
        // A quarter turn counter-clockwise, seen with v down: right becomes up, which is -v.
        let turned = transform(r#"{"rotation":1.5707963267948966,"scale":[2.0,1.0]}"#);
        assert!((at(&turned, 1.0, 0.0) - Vec2::new(0.0, -2.0)).length() < 1e-6);
        assert!((at(&turned, 0.0, 1.0) - Vec2::new(1.0, 0.0)).length() < 1e-6);
    }

    #[test]
    fn normals_are_bent_about_the_surfaces_own() {
        let map = |n: Rgb| Texture::Constant(n * 0.5 + Rgb::splat(0.5));
        let n = Rgb::new(0.3, -0.4, 0.8);
        let bent = bent_normals(map(n), 0.5, true).eval(&SurfacePoint::at_uv(Vec2::ZERO));
        let decoded = bent * 2.0 - Rgb::ONE;
        assert!(
            (decoded - Rgb::new(0.15, 0.2, 0.8)).length() < 1e-6,
            "{decoded}"
        );
    }
}
