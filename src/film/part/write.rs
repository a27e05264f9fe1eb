//! Writing parts.

use super::numbers::{self, HALVES, PIXEL, TILE};
use super::{ATTRIBUTE, LAYOUT, Record};
use crate::film::{Film, TILE_SIZE, Tile};
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
use exr::meta::header::{ImageAttributes, LayerAttributes};
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
    let rows: Vec<[u64; 8]> = held
        .par_iter()
        .map(|(index, tile)| numbers::of_tile(*index, tile, seal))
        .collect();
    let headers = headers(record, held.len(), packing);
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
                        fill_line(line, &held, &rows);
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

/// Fills one channel of one row.
fn fill_line(line: LineRefMut<'_>, held: &[(usize, &Tile)], rows: &[[u64; 8]]) {
    let at = line.location;
    let row = at.position.y();
    let pixels = &held[row].1.pixels;
    let halves = line.value.chunks_exact_mut(4).enumerate();
    for (i, to) in halves {
        let half = match (at.layer, pixels.get(i)) {
            (0, _) => numbers::half(&rows[row], at.channel),
            (_, Some(pixel)) => numbers::half(&numbers::of_pixel(pixel), at.channel),
            (_, None) => 0,
        };
        to.copy_from_slice(&half.to_ne_bytes());
    }
}

/// The headers of the two layers.
fn headers(record: &str, rows: usize, packing: Packing) -> Vec<exr::meta::header::Header> {
    let text = |s: &str| Text::from(s);
    let compression = match packing {
        Packing::Fast => Compression::Uncompressed,
        Packing::Small => Compression::ZIP16,
    };
    let width = (TILE_SIZE * TILE_SIZE) as usize;
    let window = IntegerBounds::from_dimensions((width, rows));
    let layer = |name: &str, width: usize, numbers: &[&str]| {
        let channel = |number: &str, half: &str| {
            let name = Text::from(format!("{number}.{half}").as_str());
            ChannelDescription::new(name, SampleType::U32, true)
        };
        let channels = numbers
            .iter()
            .flat_map(|n| HALVES.map(|half| channel(n, half)))
            .collect();
        let mut own = LayerAttributes::named(text(name));
        let program = concat!("twintree ", env!("CARGO_PKG_VERSION"));
        own.software_name = Some(text(program));
        own.other
            .insert(text(ATTRIBUTE), AttributeValue::Text(text(record)));
        exr::meta::header::Header::new(text(name), Vec2(width, rows), channels)
            .with_encoding(
                compression,
                BlockDescription::ScanLines,
                LineOrder::Increasing,
            )
            .with_attributes(own)
            .with_shared_attributes(ImageAttributes::new(window))
    };
    vec![layer("tiles", 1, &TILE), layer("pixels", width, &PIXEL)]
}
