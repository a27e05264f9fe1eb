//! Reading parts. Nothing in the file is believed: sizes, numbers and checksums are all compared.

use super::content::{Content, extras, pixels, shapes};
use super::kinds::Kind;
use super::numbers::{self, TileNumbers};
use super::{ATTRIBUTE, LAYOUT, Record};
use crate::film::{Extras, Film, Tile};
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
    kinds: Vec<Kind>,
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
        let headers = file.headers();
        let [tiles, _, ..] = headers else {
            return Err("this is not a part of a render: those have two layers or more".into());
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
        let kinds = Kind::of_parts(&record.extras);
        let mut layers = headers.iter().zip(&kinds);
        let fit = layers.all(|(header, kind)| fits(header, *kind, rows, &record.extras));
        if headers.len() != kinds.len() || !fit {
            return Err("the part is damaged: its layers are not those of a part".into());
        }
        Ok(Self {
            path: path.to_owned(),
            record,
            seal: numbers::seal(&text),
            rows,
            kinds,
            file,
        })
    }

    /// Everything but the pixels.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Reads all tiles into `film`, which must be of the record's region and extras; `taken` is told each
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
        if **film.extras() != self.record.extras {
            return Err("the part carries other layers than the film".into());
        }
        if self.rows > film.tiles().len() {
            return Err("the part is damaged: it has tiles that the film has not".into());
        }
        let damaged = |e: exr::error::Error| format!("the part is damaged ({e})");
        let mut chunks = self.file.all_chunks(true).map_err(damaged)?;
        let meta = chunks.meta_data().clone();
        let mut content = Content::new(self.rows);
        while let Some(chunk) = chunks.read_next_chunk() {
            let block = UncompressedBlock::decompress_chunk(chunk.map_err(damaged)?, &meta, true)
                .map_err(damaged)?;
            let channels = &meta.headers[block.index.layer].channels;
            let first = block.index.pixel_position.y();
            match self.kinds[block.index.layer] {
                Kind::Tiles => content.add_rows(&block, channels),
                Kind::Extras => {
                    for (k, sums) in extras(&block, channels).into_iter().enumerate() {
                        content.extras[first + k] = sums;
                    }
                }
                Kind::Shapes => content.add_shapes(first, shapes(&block, channels))?,
                Kind::Pixels => {
                    for (k, pixels) in pixels(&block, channels).into_iter().enumerate() {
                        let tile = place(&content.rows[first + k], film, taken)?;
                        if !content.complete(first + k, pixels, tile, &self.record, self.seal) {
                            let row = first + k;
                            return Err(format!(
                                "the part is damaged: tile {row} of it has changed"
                            ));
                        }
                    }
                }
            }
        }
        if content.blank.contains(&true) {
            return Err("the part is damaged: tiles are missing".into());
        }
        Ok(())
    }
}

/// The tile that a row is about.
fn place<'a>(
    row: &TileNumbers,
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
fn fits(header: &Header, kind: Kind, rows: usize, extras: &Extras) -> bool {
    let names = kind.channels(extras);
    let channels = &header.channels.list;
    let whole = |c: &exr::meta::attribute::ChannelDescription| {
        c.sample_type == exr::meta::attribute::SampleType::U32 && c.sampling.area() == 1
    };
    let height = header.layer_size.height();
    header.layer_size.width() == kind.width()
        && match (kind, &extras.mattes) {
            // No pixel sees a shape twice.
            (Kind::Shapes, Some(mattes)) => height <= 1 + rows * (1 + mattes.shapes.len()),
            _ => height == rows,
        }
        && header.own_attributes.layer_position.x() == 0
        && header.own_attributes.layer_position.y() == 0
        && channels.len() == names.len()
        && channels.iter().all(whole)
        && channels.iter().map(|c| c.name.to_string()).eq(names)
}
