//! The film: where samples become pixels.
//!
//! Each sample belongs to one pixel. A reconstruction filter wider than a pixel is applied by
//! drawing the sample's place from the filter ([`filter::FilterSampler::sample`]) instead of
//! spreading the sample over pixels: pixels stay independent, so tiles need no borders, variance is
//! per pixel, and the sum of a pixel does not depend on threads.

pub mod filter;

use std::sync::Arc;

/// What file formats a scene asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FilmKind {
    /// High dynamic range.
    #[default]
    Hdr,
    /// Eight bits with the sRGB curve.
    Ldr,
}

/// A film as a scene describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmDescription {
    /// Full width in pixels.
    pub width: u32,
    /// Full height in pixels.
    pub height: u32,
    /// Part to render: x0, y0, x1, y1 in pixels, upper bounds not included; `None` is all.
    pub crop: Option<[u32; 4]>,
    /// Reconstruction filter.
    pub filter: filter::Filter,
    /// Kind.
    pub kind: FilmKind,
    /// Multiplier applied before an 8-bit curve, as a power of two (`ldrfilm` exposure).
    pub exposure: f32,
    /// What pixels carry besides the picture and its usual layers.
    pub extras: Arc<Extras>,
}

impl FilmDescription {
    /// The part to render: x0, y0, x1, y1 in pixels, upper bounds not included.
    pub fn region(&self) -> [u32; 4] {
        self.crop.unwrap_or([0, 0, self.width, self.height])
    }

    /// Pixels of that part.
    pub fn pixels(&self) -> u64 {
        let [x0, y0, x1, y1] = self.region();
        u64::from(x1 - x0) * u64::from(y1 - y0)
    }
}

pub mod extras;
pub mod features;
mod late;
pub mod layers;
pub mod light_parts;
pub mod mattes;
pub mod metadata;
mod noise;
pub mod part;
pub mod shard;
#[cfg(test)]
mod tests;
pub mod tile;
mod tile_extras;
pub mod variance;

use crate::image::header::{Level, Window};

pub use extras::{ExtraSample, Extras, FirstPoint};
pub use features::{FeatureSums, Features};
pub use late::Late;
pub use layers::Layers;
pub use light_parts::{LightGroup, LightParts};
pub use mattes::Mattes;
pub use metadata::Metadata;
pub(crate) use noise::FLOOR;
pub use noise::Noise;
pub use shard::Shard;
pub use tile::{Pixel, Sample, TILE_SIZE, Tile};

/// Sums of samples, stored in tiles.
///
/// A tile is rendered by one task at a time and a pixel's samples are added in their order, so the
/// sums depend neither on threads nor on how samples were cut into passes. A film may hold some of
/// its tiles only, a [`Shard`] of them: a tile that is not held has no pixels, and looks black.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// x0, y0, x1, y1 on the full film.
    region: [u32; 4],
    /// Width and height of the full film, where that is known.
    frame: Option<[u32; 2]>,
    tiles: Vec<Tile>,
    extras: Arc<Extras>,
}

/// What a pixel of a tile that is not held looks like.
static UNTOUCHED: Pixel = Pixel::EMPTY;

impl Film {
    /// An empty film of the size (or crop) asked for.
    pub fn new(description: &FilmDescription) -> Self {
        Self::shard(description, Shard::ALL)
    }

    /// An empty film that holds the tiles of `shard`.
    pub fn shard(description: &FilmDescription, shard: Shard) -> Self {
        let frame = [description.width, description.height];
        let vacant = Self::vacant_with(description.region(), description.extras.clone());
        let mut film = vacant.framed(Some(frame));
        for i in shard.tiles(film.tiles.len()) {
            let tile = &mut film.tiles[i];
            tile.pixels = vec![Pixel::default(); tile.area()];
            tile.carry(&film.extras);
        }
        film
    }

    /// A film of the region x0, y0, x1, y1 that holds no tile yet.
    pub fn vacant(region: [u32; 4]) -> Self {
        Self::vacant_with(region, Arc::default())
    }

    /// The same for pixels that carry more.
    pub fn vacant_with(region: [u32; 4], extras: Arc<Extras>) -> Self {
        let [x0, y0, x1, y1] = region;
        let mut tiles = Vec::new();
        for y in (y0..y1).step_by(TILE_SIZE as usize) {
            for x in (x0..x1).step_by(TILE_SIZE as usize) {
                tiles.push(Tile {
                    x0: x,
                    y0: y,
                    width: (x1 - x).min(TILE_SIZE),
                    height: (y1 - y).min(TILE_SIZE),
                    pixels: Vec::new(),
                    extras: Vec::new(),
                    shapes: Vec::new(),
                    done: 0,
                    invalid: 0,
                    first_invalid: None,
                });
            }
        }
        Self {
            region,
            frame: None,
            tiles,
            extras,
        }
    }

    /// What its pixels carry besides.
    pub fn extras(&self) -> &Arc<Extras> {
        &self.extras
    }

    /// The same film as a part of one of this width and height.
    pub fn framed(self, frame: Option<[u32; 2]>) -> Self {
        Self { frame, ..self }
    }

    /// Where the region lies on the full film, if it is not all of it.
    fn window(&self) -> Option<Window> {
        let [width, height] = self.frame?;
        let [x0, y0, ..] = self.region;
        let at = [i32::try_from(x0).ok()?, i32::try_from(y0).ok()?];
        let size = Level {
            width: self.width(),
            height: self.height(),
        };
        Window::of(size, at, Level { width, height })
    }

    /// Width of the rendered region.
    pub fn width(&self) -> u32 {
        self.region[2] - self.region[0]
    }

    /// Height of the rendered region.
    pub fn height(&self) -> u32 {
        self.region[3] - self.region[1]
    }

    /// The rendered region on the full film: x0, y0, x1, y1.
    pub fn region(&self) -> [u32; 4] {
        self.region
    }

    /// All tiles, row by row.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// All tiles, to add samples to.
    pub fn tiles_mut(&mut self) -> &mut [Tile] {
        &mut self.tiles
    }

    /// The tiles that the film holds.
    pub fn held(&self) -> impl Iterator<Item = &Tile> {
        self.tiles.iter().filter(|t| t.is_held())
    }

    /// Pixels of the tiles that the film holds.
    pub fn held_pixels(&self) -> u64 {
        self.held().map(|t| t.area() as u64).sum()
    }

    /// Samples that every pixel of the tiles held has taken.
    pub fn spp_done(&self) -> u64 {
        self.held().map(|t| t.done).min().unwrap_or(0)
    }

    /// Samples taken over the whole film, those dropped included.
    pub fn samples_done(&self) -> u64 {
        self.held().map(|t| t.done * t.area() as u64).sum()
    }

    /// The pixel at `(x, y)` of the region.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        let place = self.place([x + self.region[0], y + self.region[1]]);
        let pixel = place.and_then(|(tile, i)| self.tiles[tile].pixels.get(i));
        pixel.unwrap_or(&UNTOUCHED)
    }

    /// Number of the tile, and of the pixel in it, that the pixel `(x, y)` of the full film is in;
    /// `None` beyond the region.
    pub fn place(&self, [x, y]: [u32; 2]) -> Option<(usize, usize)> {
        let [x0, y0, x1, y1] = self.region;
        if !(x0..x1).contains(&x) || !(y0..y1).contains(&y) {
            return None;
        }
        let (x, y) = (x - x0, y - y0);
        let across = self.width().div_ceil(TILE_SIZE);
        let number = (y / TILE_SIZE * across + x / TILE_SIZE) as usize;
        let tile = &self.tiles[number];
        Some((
            number,
            (y % TILE_SIZE * tile.width + x % TILE_SIZE) as usize,
        ))
    }

    /// Number of the pixel `(x, y)` of the full film, which is in the region, when the region's
    /// pixels are counted row by row.
    pub fn row_major(&self, [x, y]: [u32; 2]) -> usize {
        let [x0, y0, ..] = self.region;
        (y - y0) as usize * self.width() as usize + (x - x0) as usize
    }

    /// All pixels, tile by tile.
    fn pixels(&self) -> impl Iterator<Item = &Pixel> {
        self.tiles.iter().flat_map(|t| &t.pixels)
    }

    /// Samples that were dropped because they were not finite.
    pub fn invalid_samples(&self) -> u64 {
        self.tiles.iter().map(|t| t.invalid).sum()
    }

    /// The first dropped sample in film order: x, y, sample.
    pub fn first_invalid(&self) -> Option<(u32, u32, u64)> {
        self.tiles.iter().find_map(|t| t.first_invalid)
    }
}
