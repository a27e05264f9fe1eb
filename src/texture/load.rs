//! Opening an image for texturing: which channels, which curve, in memory or in the cache.

use super::BitmapSettings;
use super::curve::{Cleaner, Curve};
use super::pyramid::{Half, Pyramid, Texel};
use super::storage::Storage;
use super::survey::Census;
#[cfg(feature = "oiio")]
use super::survey::Survey;
use super::texels::{Source, Texels};
use crate::image::file::ImageFile;
use crate::image::header::Window;
use crate::image::{ImageError, PixelType, color_channels};
use bytemuck::Pod;
use std::path::PathBuf;

/// An image about to be loaded: what its header and the scene decide together.
#[derive(Debug)]
pub(super) struct Plan {
    pub file: ImageFile,
    /// Positions of the channels: one, or three.
    pub channels: Vec<usize>,
    pub curve: Curve,
    pub raw: bool,
    /// Keep floats as half floats.
    pub halves: bool,
    /// Where the file's pixels lie in a larger picture, or a smaller one.
    pub window: Option<Window>,
    path: PathBuf,
}

impl Plan {
    /// Opens the file and decides.
    pub fn new(settings: &BitmapSettings) -> Result<Self, ImageError> {
        let file = ImageFile::open(&settings.path)?;
        let header = file.header();
        let names: Vec<&str> = header.channels.iter().map(|c| c.name.as_str()).collect();
        let channels = match &settings.channel {
            Some(name) => vec![named_channel(&names, name).ok_or_else(|| {
                ImageError::new(
                    &settings.path,
                    format!("has no channel {name}, only {}", names.join(", ")),
                )
            })?],
            None if names.len() < 3 => vec![0],
            None => color_channels(&names).to_vec(),
        };
        let alpha = settings.channel.is_some() && names[channels[0]].eq_ignore_ascii_case("A");
        Ok(Self {
            curve: Curve::of(settings, header.pixel_type, alpha),
            raw: settings.raw,
            halves: false,
            path: settings.path.clone(),
            window: header.window,
            channels,
            file,
        })
    }

    /// How texels are kept: as stored, but 16-bit integers as half floats, or as floats where they
    /// are heights or the like and need every bit.
    pub fn kept(&self) -> PixelType {
        match self.file.header().pixel_type {
            PixelType::U16 if self.raw => PixelType::Float,
            PixelType::U16 => PixelType::Half,
            // What a curve makes of a half is no half.
            PixelType::Half if self.curve != Curve::Linear && !self.halves => PixelType::Float,
            PixelType::Float if self.halves && !self.raw => PixelType::Half,
            t => t,
        }
    }

    /// What is done to odd numbers.
    pub fn cleaner(&self) -> Cleaner {
        Cleaner {
            keep_negative: self.raw,
            half: self.kept() == PixelType::Half,
        }
    }

    /// Whether its channels lie side by side in the file, as the cache wants them.
    #[cfg(feature = "oiio")]
    pub fn is_contiguous(&self) -> bool {
        let first = self.channels[0];
        self.channels.iter().zip(first..).all(|(&c, i)| c == i)
    }

    /// Bytes that the texels and their mip levels will take in memory.
    pub fn bytes(&self) -> usize {
        let size = self.file.header().level;
        let one = match self.kept() {
            PixelType::U8 => 1,
            PixelType::U16 | PixelType::Half => 2,
            PixelType::Float => 4,
        };
        let finest = size.width as usize * size.height as usize * self.channels.len() * one;
        finest + finest / 3 + 2048
    }

    /// Reads everything, into memory or into a file of its own.
    pub fn read(mut self, on_disk: bool) -> Result<Texels, ImageError> {
        let size = self.file.header().level;
        let (grey, mut census) = (self.channels.len() == 1, Census::default());
        let (c, d) = (&mut census, on_disk);
        let (source, levels, bytes) = match (self.kept(), grey) {
            (PixelType::U8, true) => described(self.codes::<1>(d, c)?, Source::Grey8),
            (PixelType::U8, false) => described(self.codes::<3>(d, c)?, Source::Rgb8),
            (PixelType::Half, true) => described(self.floats::<Half, 1>(d, c)?, Source::GreyHalf),
            (PixelType::Half, false) => described(self.floats::<Half, 3>(d, c)?, Source::RgbHalf),
            (_, true) => described(self.floats::<f32, 1>(d, c)?, Source::GreyFloat),
            (_, false) => described(self.floats::<f32, 3>(d, c)?, Source::RgbFloat),
        };
        Ok(Texels {
            source,
            size,
            levels,
            grey,
            survey: census.summary(size, grey),
            window: self.window,
            bytes,
        })
    }

    /// 8-bit texels, as they are.
    fn codes<const N: usize>(
        &mut self,
        on_disk: bool,
        census: &mut Census,
    ) -> Result<Pyramid<u8, N>, ImageError>
    where
        [u8; N]: Pod,
    {
        let table = self.curve.table();
        let convert = |codes: [u8; N]| {
            census.add(&codes.map(|c| table[c as usize]));
            codes
        };
        let texels = self.stored(on_disk, PixelType::U8, convert)?;
        self.pyramid(texels, table)
    }

    /// Texels of any type through `f32`, made linear and cleaned.
    fn floats<T: Texel, const N: usize>(
        &mut self,
        on_disk: bool,
        census: &mut Census,
    ) -> Result<Pyramid<T, N>, ImageError>
    where
        [T; N]: Pod,
    {
        let (curve, cleaner) = (self.curve, self.cleaner());
        let table = Box::new([0.0; 256]);
        let convert = |stored: [f32; N]| {
            let linear = stored.map(|x| curve.decode(x));
            let clean = linear.map(|x| cleaner.clean(x));
            census.bad += u64::from(clean != linear);
            census.add(&clean);
            clean.map(|x| T::encode(x, &table))
        };
        let texels = self.stored(on_disk, PixelType::Float, convert)?;
        self.pyramid(texels, table)
    }

    /// The finest level.
    fn stored<S: Pod, T: Texel, const N: usize>(
        &mut self,
        on_disk: bool,
        stored: PixelType,
        mut convert: impl FnMut([S; N]) -> [T; N],
    ) -> Result<Storage<T, N>, ImageError>
    where
        [T; N]: Pod,
    {
        let size = self.file.header().level;
        let count = size.width as usize * size.height as usize;
        let path = self.path.clone();
        let full = |e| cannot_store(&path, e);
        let mut texels = Storage::new(count, on_disk).map_err(full)?;
        let mut part: Vec<[T; N]> = Vec::new();
        self.each_strip::<S, N>(stored, |strip| {
            part.clear();
            part.extend(strip.map(&mut convert));
            texels.push(&part).map_err(full)
        })?;
        Ok(texels)
    }

    fn pyramid<T: Texel, const N: usize>(
        &self,
        texels: Storage<T, N>,
        table: Box<[f32; 256]>,
    ) -> Result<Pyramid<T, N>, ImageError>
    where
        [T; N]: Pod,
    {
        let size = self.file.header().level;
        Pyramid::new(size, texels, table, self.cleaner(), true)
            .map_err(|e| cannot_store(&self.path, e))
    }

    /// What the texels are like, read in strips and not kept.
    #[cfg(feature = "oiio")]
    pub fn survey(&mut self) -> Result<Survey, ImageError> {
        let size = self.file.header().level;
        let (curve, cleaner, mut census) = (self.curve, self.cleaner(), Census::default());
        let mut count = |stored: &[f32]| {
            let mut clean = [0.0; 3];
            for (to, x) in clean.iter_mut().zip(stored) {
                let linear = curve.decode(*x);
                *to = cleaner.clean(linear);
                census.bad += u64::from(*to != linear);
            }
            census.add(&clean);
        };
        if self.channels.len() == 1 {
            self.each_strip::<f32, 1>(PixelType::Float, |strip| {
                strip.for_each(|t| count(&t));
                Ok(())
            })?;
        } else {
            self.each_strip::<f32, 3>(PixelType::Float, |strip| {
                strip.for_each(|t| count(&t));
                Ok(())
            })?;
        }
        Ok(census.summary(size, self.channels.len() == 1))
    }

    /// Calls `take` with the chosen channels of the texels of the file's current level, a strip of
    /// rows at a time from the top, read as `stored`.
    fn each_strip<S: Pod, const N: usize>(
        &mut self,
        stored: PixelType,
        mut take: impl FnMut(&mut dyn Iterator<Item = [S; N]>) -> Result<(), ImageError>,
    ) -> Result<(), ImageError> {
        let size = self.file.header().level;
        let first = self.channels.iter().copied().min().unwrap_or(0);
        let end = self.channels.iter().copied().max().unwrap_or(0) + 1;
        let count = end - first;
        let picks: [usize; N] = std::array::from_fn(|i| self.channels[i] - first);
        let strip = self.file.strip_height(1 << 20);
        let mut data = Vec::new();
        for y0 in (0..size.height).step_by(strip as usize) {
            let y1 = y0.saturating_add(strip).min(size.height);
            let numbers = size.width as usize * (y1 - y0) as usize * count;
            data.resize(numbers, S::zeroed());
            self.file.rows(y0..y1, first..end, stored, &mut data)?;
            take(&mut data.chunks_exact(count).map(|p| picks.map(|c| p[c])))?;
        }
        Ok(())
    }
}

fn cannot_store(path: &std::path::Path, e: std::io::Error) -> ImageError {
    ImageError::new(
        path,
        format!("its texels do not fit into memory, and cannot be put on disk: {e}"),
    )
}

fn described<T: Texel, const N: usize>(
    pyramid: Pyramid<T, N>,
    wrap: fn(Pyramid<T, N>) -> Source,
) -> (Source, usize, usize)
where
    [T; N]: Pod,
{
    let (levels, bytes) = (pyramid.level_count(), pyramid.memory_bytes());
    (wrap(pyramid), levels, bytes)
}

/// The channel of that name, or the one that `r`, `g`, `b`, `a` or `x`, `y`, `z` stands for.
fn named_channel(names: &[&str], name: &str) -> Option<usize> {
    let exact = names.iter().position(|n| *n == name);
    let any_case = || names.iter().position(|n| n.eq_ignore_ascii_case(name));
    // A grey picture answers for its colours as well.
    let place = || match name.to_ascii_lowercase().as_str() {
        "r" | "x" => Some(0),
        "g" | "y" if names.len() < 3 => Some(0),
        "b" | "z" if names.len() < 3 => Some(0),
        "g" | "y" => Some(1),
        "b" | "z" => Some(2),
        _ => None,
    };
    exact.or_else(any_case).or_else(place)
}
