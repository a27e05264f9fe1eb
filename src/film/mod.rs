//! The film: where samples become pixels.
//!
//! Each sample belongs to one pixel. A reconstruction filter wider than a pixel is applied by drawing
//! the sample's place from the filter ([`filter::FilterSampler::sample`]) instead of spreading the sample over
//! pixels: pixels stay independent, so tiles need no borders, variance is per pixel, and the sum of a
//! pixel does not depend on threads.

pub mod filter;

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
}

pub mod layers;
mod noise;
#[cfg(test)]
mod tests;
pub mod tile;

pub use layers::{Layers, Metadata};
pub use tile::{Pixel, Sample, TILE_SIZE, Tile};

/// Sums of samples, stored in tiles.
///
/// A tile is rendered by one task at a time and a pixel's samples are added in their order, so the
/// sums depend neither on threads nor on how samples were cut into passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// x0, y0, x1, y1 on the full film.
    region: [u32; 4],
    tiles: Vec<Tile>,
}

impl Film {
    /// An empty film of the size (or crop) asked for.
    pub fn new(description: &FilmDescription) -> Self {
        let full = [0, 0, description.width, description.height];
        let region = description.crop.unwrap_or(full);
        let [x0, y0, x1, y1] = region;
        let mut tiles = Vec::new();
        for y in (y0..y1).step_by(TILE_SIZE as usize) {
            for x in (x0..x1).step_by(TILE_SIZE as usize) {
                let (width, height) = ((x1 - x).min(TILE_SIZE), (y1 - y).min(TILE_SIZE));
                tiles.push(Tile {
                    x0: x,
                    y0: y,
                    width,
                    height,
                    pixels: vec![Pixel::default(); (width * height) as usize],
                    invalid: 0,
                    first_invalid: None,
                });
            }
        }
        Self { region, tiles }
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

    /// The pixel at `(x, y)` of the region.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        let across = self.width().div_ceil(TILE_SIZE);
        let tile = &self.tiles[(y / TILE_SIZE * across + x / TILE_SIZE) as usize];
        &tile.pixels[(y % TILE_SIZE * tile.width + x % TILE_SIZE) as usize]
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
