//! What the crates read and write, against the numbers that went in, and against OpenImageIO where
//! this build has it.

use super::super::header::Header;
use super::super::{Attribute, Compression, Format, Image, ImageError, WriteOptions};
use super::*;
use crate::image::PixelType;
use crate::math::Pcg32;
use jpeg_encoder::{ColorType as Jpeg, Encoder, SamplingFactor};
use std::io::Write as _;
use std::path::PathBuf;

mod damage;
mod jpeg_files;
mod png_files;
mod radiance_files;

/// A directory, and the name of a file in it with that content.
fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (dir, path)
}

type Whole = (Header, Vec<f32>);

fn whole(mut input: Box<dyn ReadRows>) -> Result<Whole, String> {
    let header = input.header()?;
    let rows = 0..header.level.height;
    let channels = 0..header.channels.len();
    let numbers = header.level.width as usize * rows.len() * channels.len();
    let mut pixels = vec![0.0f32; numbers];
    let data = bytemuck::cast_slice_mut(&mut pixels);
    input.rows(rows, channels, PixelType::Float, data)?;
    Ok((header, pixels))
}

/// Reads a file by the crates.
fn ours(path: &Path) -> Result<Whole, String> {
    whole(open(path)?)
}

#[cfg(feature = "oiio")]
fn theirs(path: &Path) -> Result<Whole, String> {
    whole(crate::image::oiio::input::open(path)?)
}

/// Reads a file by the crates, and where this build has OpenImageIO holds that against what it
/// reads: the same header, and numbers that differ by no more than `most`, and by `mean` on average,
/// floats in relation to their size.
fn read(what: &str, path: &Path, most: f32, mean: f32) -> Whole {
    let ours = ours(path).unwrap_or_else(|e| panic!("{what}: {e}"));
    #[cfg(feature = "oiio")]
    {
        let theirs = theirs(path).unwrap_or_else(|e| panic!("{what}: {e}"));
        let told = |header: &Header| {
            let Header {
                level,
                window,
                channels,
                pixel_type,
                ..
            } = header.clone();
            (level, window, channels, pixel_type, header.format.clone())
        };
        assert_eq!(told(&ours.0), told(&theirs.0), "{what}");
        let size = |b: f32| match ours.0.pixel_type {
            PixelType::Float => b.abs().max(f32::MIN_POSITIVE),
            _ => 1.0,
        };
        let difference = |(a, b): (&f32, &f32)| (a - b).abs() / size(*b);
        let differences = ours.1.iter().zip(&theirs.1).map(difference);
        let largest = differences.clone().fold(0.0, f32::max);
        let average = differences.sum::<f32>() / ours.1.len() as f32;
        println!("{what}: {largest} at most, {average} on average");
        assert!(
            largest <= most && average <= mean,
            "{what}: {largest} {average}"
        );
    }
    let _ = (most, mean);
    ours
}

const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;
