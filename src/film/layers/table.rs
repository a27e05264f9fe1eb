//! The layers that have the same names in every image.

use super::Layers;
use crate::film::{Extras, Pixel, Tile};
use crate::image::{Channel, PixelType};
use std::ops::Range;

/// A group of channels: names, how to store them, and how to read them off a pixel.
pub(super) struct Layer {
    names: &'static [&'static str],
    stored: Option<PixelType>,
    pub read: fn(&Seen, &mut Vec<f32>),
}

/// A pixel, its tile, its variance, and its further sums with what they are.
pub(super) struct Seen<'f> {
    pub pixel: &'f Pixel,
    pub tile: &'f Tile,
    pub variance: [f32; 3],
    pub sums: &'f [f64],
    pub extras: &'f Extras,
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
pub(super) fn single(x: f64) -> f32 {
    x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

fn average(sum: f64, count: u64) -> f32 {
    if count > 0 {
        single(sum / count as f64)
    } else {
        0.0
    }
}

/// The layers that are wanted and that such pixels have.
pub(super) fn wanted(layers: Layers, extras: &Extras) -> Vec<Layer> {
    let geometric_normal = layers.geometric_normal && extras.geometric_normal;
    let table = [
        (true, PICTURE),
        (extras.alpha, ALPHA),
        (layers.albedo, ALBEDO),
        (layers.normal, NORMAL),
        (layers.first_albedo, FIRST_ALBEDO),
        (layers.first_normal, FIRST_NORMAL),
        (layers.depth, DEPTH),
        (layers.position && extras.position, POSITION),
        (layers.uv && extras.uv, UV),
        (geometric_normal, GEOMETRIC_NORMAL),
        (layers.variance, VARIANCE),
        (layers.noise, NOISE),
        (layers.samples, SAMPLES),
    ];
    table.into_iter().filter(|w| w.0).map(|w| w.1).collect()
}

impl Layer {
    /// Its channels.
    pub fn channels(&self) -> impl Iterator<Item = Channel> + use<> {
        let stored = self.stored;
        let of = move |name: &&str| Channel {
            pixel_type: stored,
            ..Channel::new(*name)
        };
        self.names.iter().map(of)
    }
}
