//! The film as an image file: the picture and its auxiliary layers in one multi-channel EXR.
//!
//! | channels | what | who reads them |
//! |---|---|---|
//! | `R G B` | the picture | everyone |
//! | `A` | how much of the pixel is covered, if the film carries that; the picture is multiplied by it | everyone |
//! | `albedo.R albedo.G albedo.B` | reflectance of the first rough surface, behind mirrors and glass | denoisers |
//! | `normal.X normal.Y normal.Z` | its normal, world space | denoisers |
//! | `albedo.first.R albedo.first.G albedo.first.B` | reflectance of the first surface | Blender, Nuke |
//! | `normal.first.X normal.first.Y normal.first.Z` | its shading normal, world space | the same |
//! | `depth.Z` | distance from the camera | Blender, Nuke |
//! | `position.X position.Y position.Z` | its position, world space | the same |
//! | `uv.U uv.V` | its texture coordinates | the same |
//! | `normal.geometric.X normal.geometric.Y normal.geometric.Z` | its geometric normal, world space | the same |
//! | `CryptoObject00.r g b a` to `02`, `CryptoMaterial00..` | mattes (see `layers/cryptomatte.rs`) | the same |
//! | `direct.R G B`, `indirect.R G B` | light that is seen directly or was scattered once; all other | the same |
//! | `light.NAME.R G B` | light of a group of emitters | the same |
//! | `bounces.N.R G B` | light that was scattered N times | the same |
//! | `variance.R variance.G variance.B` | variance of the picture's pixels over renders with other seeds | `compare` |
//! | `noise.R noise.G noise.B` | a number of the size of the picture's error: the square of its mean over any block is on average the variance of the picture's mean there | `compare` |
//! | `samples.Y` | samples of the pixel | merging |
//!
//! A picture that was denoised keeps the noisy one in `noisy.R noisy.G noisy.B` (see
//! [`crate::image::denoise`]).
//!
//! The names are `layer.channel`, the convention by which Blender and Nuke group channels.

use super::mattes::MatteKind;
use super::{Film, Metadata, Pixel};
use crate::image::{Channel, Image};
use cryptomatte::Cryptomatte;
use light::LightLayers;
use table::{Layer, Seen};

mod cryptomatte;
mod light;
mod table;
#[cfg(test)]
mod tests;

/// Which layers to write beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Reflectance of the first rough surface.
    pub albedo: bool,
    /// Its normal.
    pub normal: bool,
    /// Reflectance of the first surface.
    pub first_albedo: bool,
    /// Shading normal of the first surface.
    pub first_normal: bool,
    /// Distance to the first surface.
    pub depth: bool,
    /// Its position, if the film carries it.
    pub position: bool,
    /// Its texture coordinates, if the film carries them.
    pub uv: bool,
    /// Its geometric normal, if the film carries it.
    pub geometric_normal: bool,
    /// Light that was seen directly or scattered once, if the film carries that.
    pub direct: bool,
    /// All other light, if the film carries that.
    pub indirect: bool,
    /// Mattes of objects and materials, if the film carries what they are made of.
    pub cryptomatte: bool,
    /// Variance of the picture.
    pub variance: bool,
    /// Noise like that of the picture.
    pub noise: bool,
    /// Samples taken.
    pub samples: bool,
}

impl Layers {
    /// The picture alone.
    pub const NONE: Layers = Layers {
        albedo: false,
        normal: false,
        first_albedo: false,
        first_normal: false,
        depth: false,
        position: false,
        uv: false,
        geometric_normal: false,
        direct: false,
        indirect: false,
        cryptomatte: false,
        variance: false,
        noise: false,
        samples: false,
    };
    /// Everything there is.
    pub const ALL: Layers = Layers {
        albedo: true,
        normal: true,
        first_albedo: true,
        first_normal: true,
        depth: true,
        position: true,
        uv: true,
        geometric_normal: true,
        direct: true,
        indirect: true,
        cryptomatte: true,
        variance: true,
        noise: true,
        samples: true,
    };
}

impl Film {
    /// The film as an image: the picture and the layers asked for, as far as the film has them.
    pub fn image(&self, layers: Layers, metadata: &Metadata) -> Image {
        let extras = &**self.extras();
        let list = table::wanted(layers, extras);
        let mattes = match layers.cryptomatte {
            true => self.cryptomattes(),
            false => Vec::new(),
        };
        let parts = LightLayers::new(extras, layers);
        let mut channels: Vec<Channel> = list.iter().flat_map(Layer::channels).collect();
        channels.extend(mattes.iter().flat_map(Cryptomatte::channels));
        channels.extend(parts.channels());
        let (width, height) = (self.width(), self.height());
        let mut pixels = Vec::with_capacity(width as usize * height as usize * channels.len());
        let variances = layers.variance.then(|| self.variances());
        let [x0, y0, x1, y1] = self.region();
        let places = (y0..y1).flat_map(|y| (x0..x1).map(move |x| [x, y]));
        for (at, place) in places.enumerate() {
            let (number, i) = self.place(place).expect("the pixel is in the region");
            let tile = &self.tiles()[number];
            let seen = Seen {
                pixel: tile.pixels.get(i).unwrap_or(&Pixel::EMPTY),
                tile,
                variance: variances.as_ref().map_or([0.0; 3], |v| v.of(at)),
                sums: tile.extras_of(i),
                extras,
            };
            list.iter()
                .for_each(|layer| (layer.read)(&seen, &mut pixels));
            for matte in &mattes {
                matte.read(tile.shapes_of(i), seen.pixel.weight, &mut pixels);
            }
            parts.read(seen.sums, seen.pixel.weight, &mut pixels);
        }
        let mut attributes = metadata.attributes();
        attributes.extend(mattes.iter().flat_map(Cryptomatte::attributes));
        Image {
            width,
            height,
            window: self.window(),
            channels,
            pixels,
            attributes,
        }
    }

    /// The mattes that its pixels carry.
    fn cryptomattes(&self) -> Vec<Cryptomatte<'_>> {
        let kinds = [MatteKind::Object, MatteKind::Material];
        let mattes = self.extras().mattes.iter();
        mattes
            .flat_map(|mattes| kinds.map(|kind| Cryptomatte::new(mattes, kind)))
            .collect()
    }
}
