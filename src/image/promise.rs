//! What a file's header promises, held against the file's size before anything is allocated for it.

use super::header::Level;
use exr::meta::MetaData;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

/// The largest image that is read, in bytes as `f32`.
const MOST_BYTES: u64 = 1 << 36;
/// Bytes of an OpenEXR file for each of its chunks, in the table of where they are.
const BYTES_OF_CHUNK: u64 = 8;

/// First bytes of an OpenEXR file.
pub(super) const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// First bytes of a PNG file.
const PNG_MAGIC: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Bytes behind the content of a PNG file's chunk.
const CHECKSUM: i64 = 4;
/// Flag of files with several headers.
const MULTIPART: u32 = 0x1000;
/// Longest name in an OpenEXR file.
const LONGEST_WORD: u64 = 255;

/// Most bytes of pixels, as `f32`, that one byte of a file can stand for: a header that promises
/// more is lying. `format` is OpenImageIO's name.
fn most_from_one(format: &str) -> u64 {
    match format {
        // A bit for a block of 8 x 8 numbers, of which 18 make 32 x 32 colours at most.
        "jpeg" => 1366 * 4,
        // Deflate's 1032, of bits that a palette makes four numbers of.
        "png" => 1032 * 8 * 4 * 4,
        // Deflate's, and the densest codec (DWA, on a black image) about 64 times that. Old runs
        // of RGBE have no limit but the row.
        _ => 1 << 17,
    }
}

/// Numbers in an image, once it is clear that a file of `file_bytes` in a format of that name (by
/// OpenImageIO) can hold them.
///
/// # Errors
/// When it cannot.
pub fn numbers(
    level: Level,
    channels: usize,
    (file_bytes, format): (u64, &str),
) -> Result<usize, String> {
    let promised = u64::from(level.width)
        .checked_mul(u64::from(level.height))
        .and_then(|n| n.checked_mul(channels as u64))
        .and_then(|n| n.checked_mul(4));
    match promised {
        Some(bytes) if bytes <= MOST_BYTES && bytes / most_from_one(format) <= file_bytes => {
            Ok((bytes / 4) as usize)
        }
        _ => Err(format!(
            "its header promises {} x {} pixels of {channels} channels, more than {file_bytes} bytes can hold",
            level.width, level.height,
        )),
    }
}

/// Looks at a file before the library does, which takes memory for attributes, tables, rows and
/// texts as soon as it reads of them (the fuzzer found 500 bytes of OpenEXR and 300 of PNG that took
/// 1.7 GB). Files of other formats, and headers that make no sense otherwise, are left to the library.
///
/// # Errors
/// When the file cannot hold what its headers promise.
pub fn check(path: &Path, file_bytes: u64) -> Result<(), String> {
    let open = || super::regular::open(path).map(BufReader::new);
    let (Ok(mut exr), Ok(mut png)) = (open(), open()) else {
        return Ok(());
    };
    if let Walk::Promises(size) = walk(&mut exr, file_bytes) {
        return Err(format!(
            "its header promises an attribute of {size} bytes, and the file has {file_bytes}"
        ));
    }
    check_png(&mut png, file_bytes)?;
    let Ok(meta) = MetaData::read_from_file(path, false) else {
        return Ok(());
    };
    for header in &meta.headers {
        let size = header.layer_size;
        let side = |n: usize| u32::try_from(n).map_err(|_| format!("{n} pixels are too many"));
        let level = Level {
            width: side(size.width())?,
            height: side(size.height())?,
        };
        numbers(level, header.channels.list.len(), (file_bytes, "openexr"))?;
        let table = (header.chunk_count as u64).saturating_mul(BYTES_OF_CHUNK);
        if table > file_bytes {
            return Err(format!(
                "its header promises {} chunks, and {file_bytes} bytes cannot even say where they are",
                header.chunk_count
            ));
        }
    }
    Ok(())
}

/// Goes over the chunks of a PNG file: length, name, content and checksum, behind the first bytes
/// ("Portable Network Graphics", section 5.3). The image itself is read bit by bit.
fn check_png(file: &mut (impl Read + Seek), file_bytes: u64) -> Result<(), String> {
    let mut start = [0; 8];
    if file.read_exact(&mut start).is_err() || start != PNG_MAGIC {
        return Ok(());
    }
    let mut head = [0; 8];
    while file.read_exact(&mut head).is_ok() {
        let [a, b, c, d, name @ ..] = head;
        let size = u32::from_be_bytes([a, b, c, d]);
        if u64::from(size) > file_bytes && name != *b"IDAT" {
            return Err(format!(
                "a chunk of it promises {size} bytes, and the file has {file_bytes}"
            ));
        }
        if file.seek_relative(i64::from(size) + CHECKSUM).is_err() {
            break;
        }
    }
    Ok(())
}

/// What came of walking through a header.
enum Walk {
    /// It ended, or is none.
    Ended,
    /// An attribute has more bytes than the file.
    Promises(u32),
}

/// Walks over the attributes of OpenEXR headers: name, type, size, value, each name and type ended
/// by a zero, each header by an empty name, all headers by an empty header ("OpenEXR File Layout").
fn walk(file: &mut (impl BufRead + Seek), file_bytes: u64) -> Walk {
    let mut start = [0; 8];
    if file.read_exact(&mut start).is_err() || start[..4] != EXR_MAGIC {
        return Walk::Ended;
    }
    let has_parts = u32::from_le_bytes([start[4], start[5], start[6], start[7]]) & MULTIPART != 0;
    let mut at_start = true;
    loop {
        let Some(name) = word(file) else {
            return Walk::Ended;
        };
        if name == 0 {
            if at_start || !has_parts {
                return Walk::Ended;
            }
            at_start = true;
            continue;
        }
        at_start = false;
        let mut size = [0; 4];
        if word(file).is_none() || file.read_exact(&mut size).is_err() {
            return Walk::Ended;
        }
        let size = u32::from_le_bytes(size);
        if u64::from(size) > file_bytes {
            return Walk::Promises(size);
        }
        if file.seek_relative(i64::from(size)).is_err() {
            return Walk::Ended;
        }
    }
}

/// The length of a word ended by a zero; none if it is too long for OpenEXR, or the file ends.
fn word(file: &mut impl BufRead) -> Option<usize> {
    let mut bytes = Vec::new();
    let most = LONGEST_WORD + 1;
    file.take(most).read_until(0, &mut bytes).ok()?;
    (bytes.last() == Some(&0)).then(|| bytes.len() - 1)
}
