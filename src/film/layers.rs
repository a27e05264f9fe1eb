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

use super::{Extras, Film, Metadata, Pixel, Tile};
use crate::image::{Channel, Image, PixelType};
use std::ops::Range;

mod cryptomatte;
mod light;
#[cfg(test)]
mod tests;

use super::mattes::MatteKind;
use cryptomatte::Cryptomatte;
use light::LightLayers;

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

/// A group of channels: names, how to store them, and how to read them off a pixel.
struct Layer {
    names: &'static [&'static str],
    stored: Option<PixelType>,
    read: fn(&Seen, &mut Vec<f32>),
}

/// A pixel, its tile, its variance, and its further sums with what they are.
struct Seen<'f> {
    pixel: &'f Pixel,
    tile: &'f Tile,
    variance: [f32; 3],
    sums: &'f [f64],
    extras: &'f Extras,
}

const PICTURE: Layer = Layer {
    names: &["R", "G", "B"],
    stored: None,
    read: |seen, out| out.extend(seen.pixel.mean().map(single)),
};
const ALPHA: Layer = Layer {
    names: &["A"],
    stored: None,
    read: |seen, out| {
        let weight = seen.pixel.weight;
        let sums = seen.sums_at(seen.extras.alphas(), 1);
        out.extend(sums.map(|sum| {
            if weight > 0.0 {
                single(sum / weight)
            } else {
                0.0
            }
        }));
    },
};
const ALBEDO: Layer = Layer {
    names: &["albedo.R", "albedo.G", "albedo.B"],
    stored: None,
    read: |seen, out| out.extend(seen.pixel.seen_albedo().map(single)),
};
const NORMAL: Layer = Layer {
    names: &["normal.X", "normal.Y", "normal.Z"],
    stored: None,
    read: |seen, out| out.extend(seen.pixel.seen_normal().map(single)),
};
const FIRST_ALBEDO: Layer = Layer {
    names: &["albedo.first.R", "albedo.first.G", "albedo.first.B"],
    stored: None,
    read: |seen, out| out.extend(seen.pixel.albedo.map(|x| average(x, seen.pixel.count))),
};
const FIRST_NORMAL: Layer = Layer {
    names: &["normal.first.X", "normal.first.Y", "normal.first.Z"],
    stored: None,
    read: |seen, out| out.extend(seen.pixel.normal.map(|x| average(x, seen.pixel.count))),
};
const DEPTH: Layer = Layer {
    names: &["depth.Z"],
    stored: Some(PixelType::Float),
    read: |seen, out| out.push(average(seen.pixel.depth, seen.pixel.met)),
};
const POSITION: Layer = Layer {
    names: &["position.X", "position.Y", "position.Z"],
    stored: Some(PixelType::Float),
    read: |seen, out| {
        let (met, from) = (seen.pixel.met, &seen.extras.origin);
        let sums = seen.sums_at(seen.extras.positions(), 3).zip(from);
        out.extend(sums.map(|(sum, from)| average(sum + from * met as f64, met)));
    },
};
const UV: Layer = Layer {
    names: &["uv.U", "uv.V"],
    stored: Some(PixelType::Float),
    read: |seen, out| {
        let sums = seen.sums_at(seen.extras.uvs(), 2);
        out.extend(sums.map(|sum| average(sum, seen.pixel.met)));
    },
};
const GEOMETRIC_NORMAL: Layer = Layer {
    names: &[
        "normal.geometric.X",
        "normal.geometric.Y",
        "normal.geometric.Z",
    ],
    stored: None,
    read: |seen, out| {
        let sums = seen.sums_at(seen.extras.normals(), 3);
        out.extend(sums.map(|sum| average(sum, seen.pixel.count)));
    },
};
const VARIANCE: Layer = Layer {
    names: &["variance.R", "variance.G", "variance.B"],
    stored: Some(PixelType::Float),
    read: |seen, out| out.extend(seen.variance),
};
const NOISE: Layer = Layer {
    names: &["noise.R", "noise.G", "noise.B"],
    stored: Some(PixelType::Float),
    read: |seen, out| {
        let noise = seen.tile.realisation(seen.pixel);
        out.extend(noise.map(single));
    },
};
const SAMPLES: Layer = Layer {
    names: &["samples.Y"],
    stored: Some(PixelType::Float),
    read: |seen, out| out.push(seen.pixel.count as f32),
};

impl Seen<'_> {
    /// Some of the further sums, of which there are so many; a pixel that is not held has none.
    fn sums_at(&self, at: Range<usize>, count: usize) -> impl Iterator<Item = f64> + '_ {
        let sums = self.sums.get(at).unwrap_or(&[]).iter().copied();
        sums.chain(std::iter::repeat(0.0)).take(count)
    }
}

/// The nearest finite `f32`: radiances of 1e20 have variances that would be infinite.
fn single(x: f64) -> f32 {
    x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

fn average(sum: f64, count: u64) -> f32 {
    if count > 0 {
        single(sum / count as f64)
    } else {
        0.0
    }
}

impl Film {
    /// The film as an image: the picture and the layers asked for, as far as the film has them.
    pub fn image(&self, layers: Layers, metadata: &Metadata) -> Image {
        let extras = &**self.extras();
        let wanted = [
            (true, PICTURE),
            (extras.alpha, ALPHA),
            (layers.albedo, ALBEDO),
            (layers.normal, NORMAL),
            (layers.first_albedo, FIRST_ALBEDO),
            (layers.first_normal, FIRST_NORMAL),
            (layers.depth, DEPTH),
            (layers.position && extras.position, POSITION),
            (layers.uv && extras.uv, UV),
            (
                layers.geometric_normal && extras.geometric_normal,
                GEOMETRIC_NORMAL,
            ),
            (layers.variance, VARIANCE),
            (layers.noise, NOISE),
            (layers.samples, SAMPLES),
        ];
        let list: Vec<Layer> = wanted.into_iter().filter(|w| w.0).map(|w| w.1).collect();
        let mattes = match layers.cryptomatte {
            true => self.cryptomattes(),
            false => Vec::new(),
        };
        let mut channels: Vec<Channel> = list
            .iter()
            .flat_map(|layer| {
                let of = |name: &&str| Channel {
                    pixel_type: layer.stored,
                    ..Channel::new(*name)
                };
                layer.names.iter().map(of)
            })
            .collect();
        channels.extend(mattes.iter().flat_map(Cryptomatte::channels));
        let parts = LightLayers::new(extras, layers);
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
