//! Textures: a value at a point of a surface, from a constant, an image, a pattern or the mesh
//! itself.

mod bitmap;
#[cfg(feature = "oiio")]
mod cached;
mod computed;
mod curve;
mod load;
mod noise;
mod pattern;
mod place;
mod point;
mod pyramid;
mod reads;
mod storage;
mod store;
mod survey;
#[cfg(test)]
mod tests;
mod texels;
#[cfg(feature = "oiio")]
mod tiled;

pub use bitmap::Bitmap;
pub use computed::{Computed, NoiseKind};
pub use noise::{Octaves, noise};
pub use pattern::{Checkerboard, Grid};
pub use point::{MeshAttribute, MeshAttributes, SurfacePoint};
pub use reads::Reads;
pub use store::TextureStore;

use crate::math::{Rgb, luminance};

/// A value over a surface.
///
/// Cheap to clone: images are shared.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// An image.
    Bitmap(std::sync::Arc<Bitmap>),
    /// Two values in squares.
    Checkerboard(std::sync::Arc<Checkerboard>),
    /// Lines of one value on another.
    Grid(std::sync::Arc<Grid>),
    /// Another texture times a factor.
    Scale(std::sync::Arc<(Texture, Rgb)>),
    /// Another texture times a factor, plus an offset.
    Affine(std::sync::Arc<(Texture, Rgb, Rgb)>),
    /// Two textures multiplied.
    Product(std::sync::Arc<(Texture, Texture)>),
    /// 1 where another texture reaches a threshold, 0 elsewhere (cut-out foliage).
    Threshold(std::sync::Arc<(Texture, f32)>),
    /// Another texture, cut to the range 0 to 1.
    Limited(std::sync::Arc<Texture>),
    /// An attribute of the mesh, by name; black where the mesh has none of that name.
    MeshAttribute(std::sync::Arc<str>),
    /// A formula of other textures, of texture coordinates, or of where the point is.
    Computed(std::sync::Arc<Computed>),
}

/// Placement of a texture: `uv * scale + offset` in the general (affine) sense.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UvTransform(pub glam::Affine2);

/// What an image texture is outside `[0, 1]^2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wrap {
    /// Repeats.
    #[default]
    Repeat,
    /// Repeats, mirrored every other time.
    Mirror,
    /// The edge goes on.
    Clamp,
}

/// How an image is interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Filter {
    /// The closest texel.
    Nearest,
    /// Bilinear between texels, mip levels by footprint.
    #[default]
    Linear,
}

/// What a scene asks of an image texture.
#[derive(Clone, Debug, PartialEq)]
pub struct BitmapSettings {
    /// The file.
    pub path: std::path::PathBuf,
    /// Use the numbers as they are: no sRGB curve is undone (roughness, normals).
    pub raw: bool,
    /// Exponent that overrides the file's own curve; `None` takes the curve from the file (sRGB for
    /// 8 bit, linear for float).
    pub gamma: Option<f32>,
    /// Interpolation.
    pub filter: Filter,
    /// Outside `[0, 1]^2`.
    pub wrap_u: Wrap,
    /// Outside `[0, 1]^2`.
    pub wrap_v: Wrap,
    /// Placement.
    pub to_uv: UvTransform,
    /// Take this channel alone, as a grey value (`r`, `g`, `b`, `a`, or a channel's name).
    pub channel: Option<String>,
}

impl Texture {
    /// The value at a point.
    #[inline]
    pub fn eval(&self, point: &SurfacePoint) -> Rgb {
        match self {
            Texture::Constant(c) => *c,
            Texture::Bitmap(bitmap) => bitmap.eval(point),
            Texture::Checkerboard(board) => board.eval(point),
            Texture::Grid(grid) => grid.eval(point.uv),
            Texture::Scale(scaled) => scaled.0.eval(point) * scaled.1,
            Texture::Affine(affine) => affine.0.eval(point) * affine.1 + affine.2,
            Texture::Product(both) => both.0.eval(point) * both.1.eval(point),
            Texture::Threshold(step) => Rgb::splat(reaches(step.0.eval_scalar(point), step.1)),
            Texture::Limited(inner) => limited(inner.eval(point)),
            Texture::MeshAttribute(name) => point.attribute(name),
            Texture::Computed(formula) => formula.eval(point),
        }
    }

    /// The value as one number: a grey image's value, a colour's luminance.
    #[inline]
    pub fn eval_scalar(&self, point: &SurfacePoint) -> f32 {
        match self {
            Texture::Constant(c) => luminance(*c),
            Texture::Bitmap(bitmap) => bitmap.eval_scalar(point),
            Texture::Checkerboard(board) => board.eval_scalar(point),
            Texture::Threshold(step) => reaches(step.0.eval_scalar(point), step.1),
            Texture::Limited(inner) => inner.eval_scalar(point).clamp(0.0, 1.0),
            Texture::Computed(formula) => formula.eval_scalar(point),
            // A grey factor does not care which of the two is taken first, but a texture may.
            Texture::Scale(scaled) if is_grey(scaled.1) => scaled.0.eval_scalar(point) * scaled.1.x,
            other => luminance(other.eval(point)),
        }
    }

    /// Change of the value with u and with v, where it is known exactly.
    pub fn gradient(&self, point: &SurfacePoint) -> Option<[Rgb; 2]> {
        let times = |[u, v]: [Rgb; 2], factor: Rgb| [u * factor, v * factor];
        match self {
            Texture::Constant(_) => Some([Rgb::ZERO; 2]),
            Texture::Bitmap(bitmap) => Some(bitmap.gradient(point.uv)),
            Texture::Scale(scaled) => Some(times(scaled.0.gradient(point)?, scaled.1)),
            Texture::Affine(affine) => Some(times(affine.0.gradient(point)?, affine.1)),
            _ => None,
        }
    }

    /// Another texture with the values of this one times `factor`.
    pub fn scaled(self, factor: Rgb) -> Self {
        match self {
            same if factor == Rgb::ONE => same,
            Texture::Constant(c) => Texture::Constant(c * factor),
            texture => Texture::Scale(std::sync::Arc::new((texture, factor))),
        }
    }

    /// This texture times another.
    pub fn times(self, other: Self) -> Self {
        match (self, other) {
            (texture, Texture::Constant(c)) | (Texture::Constant(c), texture) => texture.scaled(c),
            both => Texture::Product(std::sync::Arc::new(both)),
        }
    }

    /// The mean value over the whole texture, for light selection and sampling weights. The mean of
    /// a mesh attribute is not known here: a half stands for it.
    pub fn mean(&self) -> Rgb {
        match self {
            Texture::Constant(c) => *c,
            Texture::Bitmap(bitmap) => bitmap.mean(),
            Texture::Checkerboard(board) => (board.color0.mean() + board.color1.mean()) * 0.5,
            Texture::Grid(grid) => grid.color0.lerp(grid.color1, grid.line_share()),
            Texture::Scale(scaled) => scaled.0.mean() * scaled.1,
            Texture::Affine(affine) => affine.0.mean() * affine.1 + affine.2,
            // Exact where the two are independent of each other.
            Texture::Product(both) => both.0.mean() * both.1.mean(),
            // How much of the texture reaches the threshold is not known.
            Texture::Threshold(_) => Rgb::splat(0.5),
            Texture::Limited(inner) => limited(inner.mean()),
            Texture::MeshAttribute(_) => Rgb::splat(0.5),
            Texture::Computed(formula) => formula.mean(),
        }
    }

    /// Whether the mean of the texture's values is made of the means of its images.
    pub fn averages(&self) -> bool {
        let varies = |t: &Texture| t.constant().is_none();
        match self {
            Texture::Constant(_) | Texture::Bitmap(_) | Texture::Grid(_) => true,
            Texture::MeshAttribute(_) => true,
            Texture::Checkerboard(board) => !varies(&board.color0) && !varies(&board.color1),
            Texture::Scale(scaled) => scaled.0.averages(),
            Texture::Affine(affine) => affine.0.averages(),
            Texture::Product(both) => {
                let one = !varies(&both.0) || !varies(&both.1);
                one && both.0.averages() && both.1.averages()
            }
            Texture::Threshold(step) => !varies(&step.0),
            // Cutting commutes with the mean where nothing is cut.
            Texture::Limited(inner) => {
                let uncut = inner.largest().is_some_and(|largest| largest <= 1.0);
                !varies(inner) || uncut && inner.averages()
            }
            Texture::Computed(formula) => formula.averages(),
        }
    }

    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        match self {
            Texture::Constant(c) => Some(*c),
            Texture::Scale(scaled) => scaled.0.constant().map(|c| c * scaled.1),
            Texture::Affine(affine) => affine.0.constant().map(|c| c * affine.1 + affine.2),
            Texture::Product(both) => Some(both.0.constant()? * both.1.constant()?),
            Texture::Threshold(step) => {
                let value = luminance(step.0.constant()?);
                Some(Rgb::splat(reaches(value, step.1)))
            }
            Texture::Limited(inner) => inner.constant().map(limited),
            Texture::Computed(formula) => formula.constant(),
            _ => None,
        }
    }

    /// A number that no channel exceeds anywhere, and that one reaches where factors are positive.
    /// Nothing is known of attributes of meshes.
    pub fn largest(&self) -> Option<f32> {
        Some(match self {
            Texture::Constant(c) => c.max_element(),
            Texture::Bitmap(bitmap) => bitmap.largest(),
            Texture::Checkerboard(board) => board.color0.largest()?.max(board.color1.largest()?),
            Texture::Grid(grid) => grid.color0.max(grid.color1).max_element(),
            Texture::Scale(scaled) => scaled.0.largest()? * scaled.1.max_element(),
            Texture::Affine(affine) => (affine.0.largest()? * affine.1 + affine.2).max_element(),
            Texture::Product(both) => both.0.largest()? * both.1.largest()?,
            Texture::Threshold(_) => 1.0,
            Texture::Limited(inner) => inner.largest()?.clamp(0.0, 1.0),
            Texture::MeshAttribute(_) => return None,
            Texture::Computed(formula) => formula.largest()?,
        })
    }
}

/// A colour as a reflectance.
#[inline]
fn limited(color: Rgb) -> Rgb {
    color.clamp(Rgb::ZERO, Rgb::ONE)
}

#[inline]
fn is_grey(color: Rgb) -> bool {
    color.x == color.y && color.y == color.z
}

/// 1 if `value` is at least `threshold`, else 0.
#[inline]
fn reaches(value: f32, threshold: f32) -> f32 {
    if value >= threshold { 1.0 } else { 0.0 }
}
