//! Radiance's RGBE: three mantissas of 8 bits with a shared exponent (Ward, "Real Pixels", Graphics
//! Gems II; "Radiance File Formats").
//!
//! Written here because the crates at hand take a file that is cut short for a whole one.

use super::super::PixelType;
use super::super::header::Level;
use super::stored::Shape;
use std::io::{BufRead, Read, Write};

/// Longest line of a header, in bytes.
const LONGEST_LINE: u64 = 4096;
/// Most lines of a header.
const MOST_LINES: usize = 1000;
/// Widths of rows that may be packed in runs of each channel.
const PACKED_WIDTHS: std::ops::Range<usize> = 8..32768;
/// What OpenImageIO, too, writes and reads.
const FORMAT: &str = "32-bit_rle_rgbe";

fn line(file: &mut impl BufRead) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = file.take(LONGEST_LINE).read_until(b'\n', &mut bytes);
    read.map_err(|e| e.to_string())?;
    if bytes.pop() != Some(b'\n') {
        return Err("its header does not end".into());
    }
    Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
}

/// Reads the header, up to the pixels. The error is the reason alone.
pub fn shape(file: &mut impl BufRead) -> Result<Shape, String> {
    let mut lines = 0;
    loop {
        let line = line(file)?;
        lines += 1;
        match line.strip_prefix("FORMAT=").map(str::trim) {
            Some(FORMAT) | None => {}
            Some(other) => return Err(format!("its FORMAT is {other}, and only {FORMAT} is read")),
        }
        if line.is_empty() {
            break;
        }
        if lines > MOST_LINES {
            return Err("its header does not end".into());
        }
    }
    let size = line(file)?;
    let words: Vec<&str> = size.split_whitespace().collect();
    let unclear = || format!("its size is \"{size}\", and only \"-Y HEIGHT +X WIDTH\" is read");
    let ["-Y", height, "+X", width] = words[..] else {
        return Err(unclear());
    };
    let number = |word: &str| word.parse::<u32>().map_err(|_| unclear());
    Ok(Shape {
        level: Level {
            width: number(width)?,
            height: number(height)?,
        },
        channels: 3,
        pixel_type: PixelType::Float,
    })
}

/// Reads header and pixels. The error is the reason alone.
pub fn decode(mut file: impl BufRead, expected: Shape) -> Result<Vec<f32>, String> {
    if shape(&mut file)? != expected {
        return Err("it has changed since it was opened".into());
    }
    let mut values = Vec::with_capacity(expected.numbers()?);
    let mut row = vec![[0; 4]; expected.level.width as usize];
    for y in 0..expected.level.height {
        read_row(&mut file, &mut row).map_err(|why| format!("row {y} of the pixels: {why}"))?;
        values.extend(row.iter().flat_map(|&pixel| to_color(pixel)));
    }
    Ok(values)
}

fn bytes<const N: usize>(file: &mut impl Read) -> Result<[u8; N], String> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes)
        .map_err(|_| "the file ends there")?;
    Ok(bytes)
}

fn read_row(file: &mut impl Read, row: &mut [[u8; 4]]) -> Result<(), String> {
    let first = bytes::<4>(file)?;
    let [a, b, high, low] = first;
    if !PACKED_WIDTHS.contains(&row.len()) || [a, b] != [2, 2] || high >= 128 {
        return read_pixels(file, first, row);
    }
    if usize::from(u16::from_be_bytes([high, low])) != row.len() {
        return Err("it has another width than the header says".into());
    }
    (0..4).try_for_each(|channel| read_runs(file, row, channel))
}

/// One channel of a row: a byte above 128 repeats the next one, others say how many follow.
fn read_runs(file: &mut impl Read, row: &mut [[u8; 4]], channel: usize) -> Result<(), String> {
    let mut x = 0;
    while x < row.len() {
        let [count] = bytes(file)?;
        let (length, same) = match count {
            0..=128 => (usize::from(count), None),
            _ => (usize::from(count & 127), Some(bytes::<1>(file)?[0])),
        };
        let run = row.get_mut(x..x + length).filter(|run| !run.is_empty());
        for pixel in run.ok_or("a run does not fit")? {
            pixel[channel] = match same {
                Some(value) => value,
                None => bytes::<1>(file)?[0],
            };
        }
        x += length;
    }
    Ok(())
}

/// A row of whole pixels. One of three ones repeats the pixel before it; further such pixels say
/// how often in higher digits.
fn read_pixels(file: &mut impl Read, first: [u8; 4], row: &mut [[u8; 4]]) -> Result<(), String> {
    let (mut x, mut shift, mut next) = (0, 0, Some(first));
    while x < row.len() {
        let pixel = match next.take() {
            Some(pixel) => pixel,
            None => bytes::<4>(file)?,
        };
        if pixel[..3] != [1, 1, 1] {
            row[x] = pixel;
            (x, shift) = (x + 1, 0);
            continue;
        }
        if x == 0 || shift > 24 {
            return Err("a run does not fit".into());
        }
        let (before, length) = (row[x - 1], usize::from(pixel[3]) << shift);
        let run = row.get_mut(x..x + length).ok_or("a run does not fit")?;
        run.fill(before);
        (x, shift) = (x + length, shift + 8);
    }
    Ok(())
}

/// Without the half that Radiance adds to mantissas, as OpenImageIO does it.
fn to_color([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    // 2^(e - 136) is no normal number for the smallest of e: in f64 it is.
    let unit = f64::from(i32::from(e) - 136).exp2();
    [r, g, b].map(|mantissa| (f64::from(mantissa) * unit) as f32)
}

/// Rounded down; numbers that are negative or not finite become black.
fn to_rgbe(color: [f32; 3]) -> [u8; 4] {
    let color = color.map(|x| {
        if x.is_finite() {
            f64::from(x).max(0.0)
        } else {
            0.0
        }
    });
    let largest = color.iter().copied().fold(0.0, f64::max);
    if largest < 1e-32 {
        return [0; 4];
    }
    // largest is below 2^exponent and not below half of that.
    let exponent = largest.log2().floor() as i32 + 1;
    let scale = f64::from(8 - exponent).exp2();
    let [r, g, b] = color.map(|x| (x * scale).min(255.0) as u8);
    [r, g, b, (exponent + 128).clamp(1, 255) as u8]
}

/// Writes rows of three numbers a pixel.
///
/// # Errors
/// What the system says.
pub fn write(file: &mut impl Write, width: usize, rows: &[f32]) -> std::io::Result<()> {
    let height = rows.len() / (3 * width.max(1));
    write!(
        file,
        "#?RADIANCE\nFORMAT={FORMAT}\n\n-Y {height} +X {width}\n"
    )?;
    for row in rows.chunks_exact(3 * width.max(1)) {
        let pixels = row.chunks_exact(3).map(|c| to_rgbe([c[0], c[1], c[2]]));
        let pixels: Vec<[u8; 4]> = pixels.collect();
        if !PACKED_WIDTHS.contains(&width) {
            file.write_all(bytemuck::cast_slice(&pixels))?;
            continue;
        }
        let [high, low] = (width as u16).to_be_bytes();
        file.write_all(&[2, 2, high, low])?;
        for channel in 0..4 {
            let values: Vec<u8> = pixels.iter().map(|p| p[channel]).collect();
            write_runs(file, &values)?;
        }
    }
    Ok(())
}

/// Bytes that a repetition has to have to be worth its two bytes.
const SHORTEST_RUN: usize = 4;

fn write_runs(file: &mut impl Write, values: &[u8]) -> std::io::Result<()> {
    let same_from = |at: usize| {
        let same = values[at..].iter().take_while(|v| **v == values[at]);
        same.take(127).count()
    };
    let mut at = 0;
    while at < values.len() {
        let same = same_from(at);
        if same >= SHORTEST_RUN {
            file.write_all(&[128 + same as u8, values[at]])?;
            at += same;
            continue;
        }
        let start = at;
        while at < values.len() && at - start < 128 && same_from(at) < SHORTEST_RUN {
            at += 1;
        }
        file.write_all(&[(at - start) as u8])?;
        file.write_all(&values[start..at])?;
    }
    Ok(())
}
