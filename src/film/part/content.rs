//! What has been read of a part's tiles, until each is complete.

use super::Record;
use super::kinds::Kind;
use super::numbers::{self, HALVES, PIXEL, ShapeNumbers, TileNumbers};
use crate::film::{Pixel, Tile};
use exr::block::UncompressedBlock;
use exr::meta::attribute::ChannelList;

/// What has been read so far, by row of the layer `tiles`.
pub(super) struct Content {
    /// What is known of tiles as wholes.
    pub rows: Vec<TileNumbers>,
    /// Their further sums, with those of pixels that a small tile does not have.
    pub extras: Vec<Vec<f64>>,
    /// Tiles that are not complete.
    pub blank: Vec<bool>,
    /// The list of shapes that pixels see, of all tiles.
    shapes: Vec<ShapeNumbers>,
    /// Where the lists of the tiles begin in it, once that is known.
    begins: Vec<usize>,
}

impl Content {
    /// Nothing yet of so many tiles.
    pub fn new(rows: usize) -> Self {
        Self {
            rows: vec![TileNumbers::default(); rows],
            extras: vec![Vec::new(); rows],
            blank: vec![true; rows],
            shapes: Vec::new(),
            begins: Vec::new(),
        }
    }

    /// Adds what a block says of tiles as wholes.
    pub fn add_rows(&mut self, block: &UncompressedBlock, channels: &ChannelList) {
        for line in block.lines(channels) {
            let row = &mut self.rows[line.location.position.y()];
            let half = halves(line.value).next().unwrap_or(0);
            numbers::put_half(row, line.location.channel, half);
        }
    }

    /// Adds rows of the list of shapes, from row `first` on. They come in their order.
    pub fn add_shapes(&mut self, first: usize, rows: Vec<ShapeNumbers>) -> Result<(), String> {
        if first * Kind::Shapes.width() != self.shapes.len() {
            return Err("the part is damaged: its list of shapes is not in order".into());
        }
        self.shapes.extend(rows);
        Ok(())
    }

    /// Completes the tile of a row by its pixels. `false` if it is not what was written.
    pub fn complete(
        &mut self,
        row: usize,
        mut pixels: Vec<Pixel>,
        tile: &mut Tile,
        record: &Record,
        seal: u64,
    ) -> bool {
        let mut extras = std::mem::take(&mut self.extras[row]);
        let count = record.extras.count();
        pixels.truncate(tile.area());
        extras.truncate(tile.area() * count);
        (tile.pixels, tile.extras) = (pixels, extras);
        if let Some(mattes) = &record.extras.mattes {
            let Some(list) = self.shapes_of(row) else {
                return false;
            };
            let shapes = numbers::to_shapes(list, tile.area(), mattes.shapes.len());
            let Some(shapes) = shapes else { return false };
            tile.shapes = shapes;
        }
        self.blank[row] = false;
        numbers::to_tile(&self.rows[row], seal, tile)
    }

    /// The part of the list of shapes that a tile has.
    fn shapes_of(&mut self, row: usize) -> Option<&[ShapeNumbers]> {
        if self.begins.is_empty() {
            let mut begin: usize = 0;
            for row in &self.rows {
                self.begins.push(begin);
                let end = begin.saturating_add(numbers::shapes_of(row));
                begin = end.checked_next_multiple_of(Kind::Shapes.width())?;
            }
        }
        let begin = *self.begins.get(row)?;
        let end = begin.checked_add(numbers::shapes_of(&self.rows[row]))?;
        self.shapes.get(begin..end)
    }
}

/// The numbers of a line.
fn halves(line: &[u8]) -> impl Iterator<Item = u32> + '_ {
    line.chunks_exact(4)
        .map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]]))
}

/// The pixels of a block, row by row.
pub(super) fn pixels(block: &UncompressedBlock, channels: &ChannelList) -> Vec<Vec<Pixel>> {
    let mut rows = vec![vec![[0; PIXEL.len()]; width(block)]; height(block)];
    for line in block.lines(channels) {
        let at = line.location;
        let row = &mut rows[at.position.y() - block.index.pixel_position.y()];
        for (pixel, half) in row.iter_mut().zip(halves(line.value)) {
            numbers::put_half(pixel, at.channel, half);
        }
    }
    rows.iter()
        .map(|row| row.iter().map(numbers::to_pixel).collect())
        .collect()
}

/// The further sums of a block, row by row.
pub(super) fn extras(block: &UncompressedBlock, channels: &ChannelList) -> Vec<Vec<f64>> {
    let count = channels.list.len() / HALVES.len();
    let mut rows = vec![vec![0; width(block) * count]; height(block)];
    for line in block.lines(channels) {
        let at = line.location;
        let row = &mut rows[at.position.y() - block.index.pixel_position.y()];
        for (sums, half) in row.chunks_exact_mut(count).zip(halves(line.value)) {
            numbers::put_half(sums, at.channel, half);
        }
    }
    let reals = |row: Vec<u64>| row.into_iter().map(f64::from_bits).collect();
    rows.into_iter().map(reals).collect()
}

/// Entries of the list of shapes, row by row.
pub(super) fn shapes(block: &UncompressedBlock, channels: &ChannelList) -> Vec<ShapeNumbers> {
    let mut list = vec![ShapeNumbers::default(); width(block) * height(block)];
    for line in block.lines(channels) {
        let row = line.location.position.y() - block.index.pixel_position.y();
        let entries = list.chunks_exact_mut(width(block)).nth(row);
        let entries = entries.into_iter().flatten();
        for (entry, half) in entries.zip(halves(line.value)) {
            numbers::put_half(entry, line.location.channel, half);
        }
    }
    list
}

fn width(block: &UncompressedBlock) -> usize {
    block.index.pixel_size.width()
}

fn height(block: &UncompressedBlock) -> usize {
    block.index.pixel_size.height()
}
