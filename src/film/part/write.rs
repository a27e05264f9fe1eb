//! Writing parts.

use super::kinds::Kind;
use super::numbers::{self, ShapeNumbers, TileNumbers};
use super::{ATTRIBUTE, LAYOUT, Record};
use crate::film::{Extras, Film, Tile};
use crate::image::{ImageError, atomic};
use exr::block::lines::LineRefMut;
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::error::UnitResult;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, IntegerBounds, LineOrder, SampleType, Text,
};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::prelude::Compression;
use rayon::prelude::*;
use serde::Serialize;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// How hard to pack a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Not at all: for checkpoints, which rendering waits for.
    Fast,
    /// Deflated: for shards, which travel.
    Small,
}

/// The record as it stands in the file.
#[derive(Serialize)]
struct Stored<'a> {
    layout: u32,
    #[serde(flatten)]
    record: &'a Record,
}

/// Writes the tiles that `film` holds, with every sum as it is. The file appears whole under its
/// name, or the old one stays. A writer that is killed leaves one unfinished file at most,
/// `<path>.new`, for the next to overwrite.
///
/// # Errors
/// When the file cannot be written; names it and what the system said.
pub fn write(
    path: &Path,
    record: &Record,
    film: &Film,
    packing: Packing,
) -> Result<(), ImageError> {
    let stored = Stored {
        layout: LAYOUT,
        record,
    };
    let text = serde_json::to_string(&stored)
        .map(|json| ascii(&json))
        .map_err(|e| ImageError::new(path, e.to_string()))?;
    atomic::replace_again(path, |file| {
        encode(file, &text, film, packing).map_err(|e| e.to_string())
    })
}

/// JSON in which every character beyond ASCII is escaped: EXR's texts are bytes of an unknown
/// alphabet.
fn ascii(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        if c.is_ascii() {
            out.push(c);
            continue;
        }
        let mut units = [0; 2];
        for unit in c.encode_utf16(&mut units) {
            out += &format!("\\u{unit:04x}");
        }
    }
    out
}

/// Blocks that are made and packed side by side before they are written in order: half a megabyte
/// each.
const BLOCKS_AT_ONCE: usize = 64;

fn encode(file: &Path, record: &str, film: &Film, packing: Packing) -> UnitResult {
    let seal = numbers::seal(record);
    let held: Vec<(usize, &Tile)> = film
        .tiles()
        .iter()
        .enumerate()
        .filter(|(_, t)| t.is_held())
        .collect();
    let rows: Vec<TileNumbers> = held
        .par_iter()
        .map(|(index, tile)| numbers::of_tile(*index, tile, seal))
        .collect();
    let extras = &**film.extras();
    let kinds = Kind::of_parts(extras);
    let content = Content::new(held, rows, extras);
    let headers: Vec<Header> = kinds
        .iter()
        .map(|kind| header(record, content.rows_of(*kind), *kind, packing, extras))
        .collect();
    let buffer = BufWriter::with_capacity(1 << 20, File::create(file)?);
    exr::block::write(buffer, headers.into(), true, |meta, chunks| {
        let blocks: Vec<(usize, BlockIndex)> =
            enumerate_ordered_header_block_indices(&meta.headers).collect();
        for some in blocks.chunks(BLOCKS_AT_ONCE) {
            let packed: Vec<_> = some
                .par_iter()
                .map(|(place, block)| {
                    let channels = &meta.headers[block.layer].channels;
                    let block = UncompressedBlock::from_lines(channels, *block, |line| {
                        content.fill(line, kinds[block.layer]);
                    });
                    (*place, block.compress_to_chunk(&meta.headers))
                })
                .collect();
            for (place, chunk) in packed {
                chunks.write_chunk(place, chunk?)?;
            }
        }
        Ok(())
    })
}

/// What is written.
struct Content<'f> {
    /// The tiles, with their numbers on the film.
    held: Vec<(usize, &'f Tile)>,
    rows: Vec<TileNumbers>,
    /// What pixels see, each tile's in rows of its own.
    shapes: Vec<ShapeNumbers>,
}

impl<'f> Content<'f> {
    fn new(held: Vec<(usize, &'f Tile)>, rows: Vec<TileNumbers>, extras: &Extras) -> Self {
        let width = Kind::Shapes.width();
        let mut shapes = Vec::new();
        for (_, tile) in held.iter().filter(|_| extras.mattes.is_some()) {
            shapes.extend(numbers::of_shapes(tile));
            shapes.resize(shapes.len().next_multiple_of(width), [0; 2]);
        }
        // An image has a row at least.
        shapes.resize(shapes.len().max(width), [0; 2]);
        Self { held, rows, shapes }
    }

    /// Rows of a layer.
    fn rows_of(&self, kind: Kind) -> usize {
        match kind {
            Kind::Shapes => self.shapes.len() / kind.width(),
            _ => self.rows.len(),
        }
    }

    /// Fills one channel of one row.
    fn fill(&self, line: LineRefMut<'_>, kind: Kind) {
        let (row, channel) = (line.location.position.y(), line.location.channel);
        let halves = line.value.chunks_exact_mut(4).enumerate();
        let tile = |i: usize| {
            let tile = self.held[row].1;
            (i < tile.pixels.len()).then_some(tile)
        };
        for (i, to) in halves {
            let half = match kind {
                Kind::Tiles => Some(numbers::half(&self.rows[row], channel)),
                Kind::Shapes => {
                    let entry = &self.shapes[row * kind.width() + i];
                    Some(numbers::half(entry, channel))
                }
                Kind::Pixels => tile(i).map(|tile| {
                    let pixel = numbers::of_pixel(&tile.pixels[i]);
                    numbers::half(&pixel, channel)
                }),
                Kind::Extras => tile(i).map(|tile| numbers::half_of(tile.extras_of(i), channel)),
            };
            to.copy_from_slice(&half.unwrap_or(0).to_ne_bytes());
        }
    }
}

/// The header of a layer of a part.
fn header(record: &str, rows: usize, kind: Kind, packing: Packing, extras: &Extras) -> Header {
    let text = |s: &str| Text::from(s);
    let compression = match packing {
        Packing::Fast => Compression::Uncompressed,
        Packing::Small => Compression::ZIP16,
    };
    let width = kind.width();
    // The same for all layers, whatever they hold.
    let window = (Kind::Pixels.width(), 1);
    let channels = kind.channels(extras);
    let channel = |name: &String| ChannelDescription::new(text(name), SampleType::U32, true);
    let mut own = LayerAttributes::named(text(kind.name()));
    let program = concat!("twintree ", env!("CARGO_PKG_VERSION"));
    own.software_name = Some(text(program));
    own.other
        .insert(text(ATTRIBUTE), AttributeValue::Text(text(record)));
    let channels = channels.iter().map(channel).collect();
    Header::new(text(kind.name()), Vec2(width, rows), channels)
        .with_encoding(
            compression,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        )
        .with_attributes(own)
        .with_shared_attributes(ImageAttributes::new(IntegerBounds::from_dimensions(window)))
}
