//! Reading parts. Nothing in the file is believed: sizes, numbers and checksums are all compared.

use super::numbers::{self, HALVES, PIXEL, TILE};
use super::{ATTRIBUTE, LAYOUT, Record};
use crate::film::{Film, Pixel, TILE_SIZE, Tile};
use crate::image::{ImageError, regular};
use exr::block::UncompressedBlock;
use exr::block::reader::{ChunksReader, Reader};
use exr::meta::attribute::AttributeValue;
use exr::meta::header::Header;
use serde::Deserialize;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Longest side of a film that is believed: that of the command line.
const MAX_SIDE: u32 = 1 << 17;

/// A part whose record has been read and whose pixels have not.
#[derive(Debug)]
pub struct PartReader {
    path: PathBuf,
    record: Record,
    seal: u64,
    rows: usize,
    file: Reader<BufReader<File>>,
}

#[derive(Deserialize)]
struct Stored {
    #[serde(flatten)]
    record: Record,
}

#[derive(Deserialize)]
struct Layout {
    layout: u32,
}

impl PartReader {
    /// Opens a file and reads its record.
    ///
    /// # Errors
    /// When there is no such file, or it is not a part, or one of another layout.
    pub fn open(path: &Path) -> Result<Self, ImageError> {
        Self::try_open(path).map_err(|reason| ImageError::new(path, reason))
    }

    fn try_open(path: &Path) -> Result<Self, String> {
        let file = regular::open(path).map_err(|e| e.to_string())?;
        let file = exr::block::read(BufReader::with_capacity(1 << 20, file), true)
            .map_err(|e| format!("this is not a part of a render ({e})"))?;
        let [tiles, pixels] = file.headers() else {
            return Err("this is not a part of a render: those have two layers".into());
        };
        let name = |n: &exr::meta::attribute::Text| *n == *ATTRIBUTE;
        let attributes = &tiles.own_attributes.other;
        let text = attributes.iter().find_map(|(key, value)| match value {
            AttributeValue::Text(text) if name(key) => Some(text.to_string()),
            _ => None,
        });
        let text = text.ok_or("this is not a part of a render: it has no record")?;
        let record = parse(&text)?;
        let rows = tiles.layer_size.height();
        let width = (TILE_SIZE * TILE_SIZE) as usize;
        if !(fits(tiles, 1, rows, &TILE) && fits(pixels, width, rows, &PIXEL)) {
            return Err("the part is damaged: its layers are not those of a part".into());
        }
        Ok(Self {
            path: path.to_owned(),
            record,
            seal: numbers::seal(&text),
            rows,
            file,
        })
    }

    /// Everything but the pixels.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Reads all tiles into `film`, which must be of the record's region; `taken` is told each
    /// one's number before it is put there, and refuses by an error.
    ///
    /// # Errors
    /// When the file is damaged, a tile is not one of the film's, or `taken` refuses.
    pub fn read_into(
        self,
        film: &mut Film,
        taken: &mut dyn FnMut(usize) -> Result<(), String>,
    ) -> Result<(), ImageError> {
        let path = self.path.clone();
        self.try_read(film, taken)
            .map_err(|reason| ImageError::new(&path, reason))
    }

    fn try_read(
        self,
        film: &mut Film,
        taken: &mut dyn FnMut(usize) -> Result<(), String>,
    ) -> Result<(), String> {
        if film.region() != self.record.region {
            return Err("the part is of another region of the film".into());
        }
        if self.rows > film.tiles().len() {
            return Err("the part is damaged: it has tiles that the film has not".into());
        }
        let damaged = |e: exr::error::Error| format!("the part is damaged ({e})");
        let mut chunks = self.file.all_chunks(true).map_err(damaged)?;
        let meta = chunks.meta_data().clone();
        let mut rows = vec![[0; 8]; self.rows];
        let mut blank = vec![true; self.rows];
        while let Some(chunk) = chunks.read_next_chunk() {
            let block = UncompressedBlock::decompress_chunk(chunk.map_err(damaged)?, &meta, true)
                .map_err(damaged)?;
            let channels = &meta.headers[block.index.layer].channels;
            if block.index.layer == 0 {
                for line in block.lines(channels) {
                    let (at, row) = (line.location, &mut rows[line.location.position.y()]);
                    let half = halves(line.value).next().unwrap_or(0);
                    numbers::put_half(row, at.channel, half);
                }
                continue;
            }
            let first = block.index.pixel_position.y();
            for (k, pixels) in pixels(&block, channels).into_iter().enumerate() {
                let row = first + k;
                let tile = place(&rows[row], film, taken)?;
                let pixels = pixels[..tile.area()].to_vec();
                if !numbers::to_tile(&rows[row], pixels, self.seal, tile) {
                    return Err(format!("the part is damaged: tile {row} of it has changed"));
                }
                blank[row] = false;
            }
        }
        if blank.contains(&true) {
            return Err("the part is damaged: tiles are missing".into());
        }
        Ok(())
    }
}

/// The tile that a row is about.
fn place<'a>(
    row: &[u64; 8],
    film: &'a mut Film,
    taken: &mut dyn FnMut(usize) -> Result<(), String>,
) -> Result<&'a mut Tile, String> {
    let index = usize::try_from(numbers::index_of(row)).unwrap_or(usize::MAX);
    if index >= film.tiles().len() {
        return Err("the part is damaged: it has tiles that the film has not".into());
    }
    taken(index)?;
    Ok(&mut film.tiles_mut()[index])
}

fn parse(text: &str) -> Result<Record, String> {
    let damaged = |e: serde_json::Error| format!("the part is damaged: its record says {e}");
    let layout: Layout = serde_json::from_str(text).map_err(damaged)?;
    if layout.layout != LAYOUT {
        return Err(format!(
            "the part has layout {} and this program reads layout {LAYOUT}: it was written by another version",
            layout.layout
        ));
    }
    let stored: Stored = serde_json::from_str(text).map_err(damaged)?;
    let record = stored.record;
    let [x0, y0, x1, y1] = record.region;
    let shard = record.shard;
    let [width, height] = record.frame.unwrap_or([x1, y1]);
    let is_inside = x1 <= width && y1 <= height && width.max(height) <= MAX_SIDE;
    if x0 >= x1 || y0 >= y1 || !is_inside || shard.index >= shard.count {
        return Err("the part is damaged: its record makes no film".into());
    }
    Ok(record)
}

/// Whether a layer is what the writer makes.
fn fits(header: &Header, width: usize, rows: usize, numbers: &[&str]) -> bool {
    let names = numbers
        .iter()
        .flat_map(|n| HALVES.map(|half| format!("{n}.{half}")));
    let channels = &header.channels.list;
    let whole = |c: &exr::meta::attribute::ChannelDescription| {
        c.sample_type == exr::meta::attribute::SampleType::U32 && c.sampling.area() == 1
    };
    (header.layer_size.width(), header.layer_size.height()) == (width, rows)
        && header.own_attributes.layer_position.x() == 0
        && header.own_attributes.layer_position.y() == 0
        && channels.len() == 2 * numbers.len()
        && channels.iter().all(whole)
        && channels.iter().map(|c| c.name.to_string()).eq(names)
}

/// The numbers of a line.
fn halves(line: &[u8]) -> impl Iterator<Item = u32> + '_ {
    line.chunks_exact(4)
        .map(|b| u32::from_ne_bytes([b[0], b[1], b[2], b[3]]))
}

/// The pixels of a block, row by row.
fn pixels(
    block: &UncompressedBlock,
    channels: &exr::meta::attribute::ChannelList,
) -> Vec<Vec<Pixel>> {
    let (width, height) = (
        block.index.pixel_size.width(),
        block.index.pixel_size.height(),
    );
    let mut rows = vec![vec![[0; PIXEL.len()]; width]; height];
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
