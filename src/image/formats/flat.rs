//! Files with one image: the numbers as they are stored, and as others want them.

use super::super::header::{Header, Level};
use super::super::read_rows::ReadRows;
use super::super::{Channel, PixelType, promise, regular};
use super::stored::{Shape, Stored};
use super::{jpeg_reader, png_reader, radiance};
use half::f16;
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A format of such files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// JPEG, baseline or progressive.
    Jpeg,
    /// Radiance RGBE.
    Radiance,
}

impl Format {
    /// The format of a file that begins so.
    pub fn of(head: &[u8]) -> Option<Self> {
        let starts: [(&[u8], Self); 3] = [
            (b"\x89PNG\r\n\x1a\n", Self::Png),
            (b"\xff\xd8\xff", Self::Jpeg),
            (b"#?", Self::Radiance),
        ];
        let found = starts.iter().find(|(start, _)| head.starts_with(start));
        found.map(|(_, format)| *format)
    }

    /// OpenImageIO's name for it.
    fn name(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpeg",
            Self::Radiance => "hdr",
        }
    }

    fn shape(self, file: &mut BufReader<File>) -> Result<Shape, String> {
        match self {
            Self::Png => png_reader::shape(file),
            Self::Jpeg => jpeg_reader::shape(file),
            Self::Radiance => radiance::shape(file),
        }
    }

    fn decode(self, file: BufReader<File>, shape: Shape) -> Result<Stored, String> {
        match self {
            Self::Png => png_reader::decode(file, shape),
            Self::Jpeg => jpeg_reader::decode(file, shape).map(Stored::U8),
            Self::Radiance => radiance::decode(file, shape).map(Stored::Float),
        }
    }
}

/// A file with one image.
#[derive(Debug)]
struct Input {
    path: PathBuf,
    format: Format,
    shape: Shape,
    header: Header,
    decoded: Option<Stored>,
}

/// Reads the header of a file. The error is the reason alone.
pub fn open(path: &Path, format: Format) -> Result<Box<dyn ReadRows>, String> {
    let file = regular::open(path).map_err(|e| e.to_string())?;
    let size = file.metadata().map_err(|e| e.to_string())?.len();
    let shape = format.shape(&mut BufReader::new(file))?;
    let Level { width, height } = shape.level;
    if width == 0 || height == 0 {
        return Err(format!("its header promises {width} x {height} pixels"));
    }
    promise::numbers(shape.level, shape.channels, (size, format.name()))?;
    // OpenImageIO's names.
    let names: &[&str] = match shape.channels {
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let header = Header {
        level: shape.level,
        window: None,
        channels: names.iter().map(|&name| Channel::new(name)).collect(),
        pixel_type: shape.pixel_type,
        tile_height: 0,
        attributes: Vec::new(),
        format: format.name().into(),
    };
    Ok(Box::new(Input {
        path: path.to_owned(),
        format,
        shape,
        header,
        decoded: None,
    }))
}

impl Input {
    fn decoded(&mut self) -> Result<&Stored, String> {
        if self.decoded.is_none() {
            let file = regular::open(&self.path).map_err(|e| e.to_string())?;
            let stored = self.format.decode(BufReader::new(file), self.shape)?;
            if stored.len() != self.shape.numbers()? {
                return Err("it has changed since it was opened".into());
            }
            self.decoded = Some(stored);
        }
        self.decoded
            .as_ref()
            .ok_or_else(|| "it has no image".into())
    }
}

impl ReadRows for Input {
    fn seek(&mut self, part: u32, level: u32) -> Result<bool, String> {
        Ok(part == 0 && level == 0)
    }

    fn header(&self) -> Result<Header, String> {
        Ok(self.header.clone())
    }

    fn rows(
        &mut self,
        rows: Range<u32>,
        channels: Range<usize>,
        pixel_type: PixelType,
        data: &mut [u8],
    ) -> Result<(), String> {
        let Shape {
            level,
            channels: all,
            ..
        } = self.shape;
        if rows.end > level.height || channels.end > all || channels.is_empty() {
            return Err("rows or channels that the image does not have".into());
        }
        let stored = self.decoded()?;
        let pixels =
            rows.start as usize * level.width as usize..rows.end as usize * level.width as usize;
        let places = pixels.flat_map(|pixel| channels.clone().map(move |c| pixel * all + c));
        match (stored, pixel_type) {
            (Stored::U8(codes), PixelType::U8) => {
                data.iter_mut()
                    .zip(places)
                    .for_each(|(to, at)| *to = codes[at]);
            }
            (Stored::U16(codes), PixelType::U16) => {
                put(data, places.map(|at| codes[at].to_ne_bytes()))
            }
            (_, PixelType::U8) => {
                let code = |at| (stored.value(at).clamp(0.0, 1.0) * 255.0).round() as u8;
                data.iter_mut()
                    .zip(places)
                    .for_each(|(to, at)| *to = code(at));
            }
            (_, PixelType::U16) => {
                let code = |at| (stored.value(at).clamp(0.0, 1.0) * 65535.0).round() as u16;
                put(data, places.map(|at| code(at).to_ne_bytes()));
            }
            (_, PixelType::Half) => {
                put(
                    data,
                    places.map(|at| f16::from_f32(stored.value(at)).to_ne_bytes()),
                );
            }
            (_, PixelType::Float) => put(data, places.map(|at| stored.value(at).to_ne_bytes())),
        }
        Ok(())
    }
}

fn put<const N: usize>(data: &mut [u8], values: impl Iterator<Item = [u8; N]>) {
    for (to, value) in data.chunks_exact_mut(N).zip(values) {
        to.copy_from_slice(&value);
    }
}
