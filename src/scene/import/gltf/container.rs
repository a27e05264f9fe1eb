//! The bytes of a glTF file: JSON and buffers, from a `.gltf` with files beside it or from one
//! `.glb`.

use super::meshopt::{self, Compression};
use super::schema::{Buffer, BufferView, Document};
use super::{error, hint};
use crate::image::decoded::DecodeLimit;
use crate::image::mapped::{self, Mapped};
use crate::scene::import::{ImportError, Location, encoding, named};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// First bytes of a `.glb`.
const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// An opened file: what it describes, and all its buffers.
pub(super) struct Container {
    pub path: PathBuf,
    pub document: Document,
    file: Mapped,
    buffers: Vec<Bytes>,
    /// Buffer views that were compressed.
    decoded: HashMap<usize, Vec<u8>>,
    /// Accessors whose elements are not in a buffer view, by number: none when the file is opened.
    pub unpacked: HashMap<usize, Unpacked>,
    allowance: Allowance,
}

/// The elements of an accessor, one behind the other.
pub(super) struct Unpacked {
    /// glTF's code of their components.
    pub code: u32,
    pub bytes: Vec<u8>,
}

/// Bytes that may still be unpacked.
///
/// A short file may ask for much: by compression, by accessors without bytes, by naming the same
/// bytes again and again. What the buffers hold may be unpacked many times over (8-bit numbers
/// become floats, and meshes share vertices); beyond that there is a limit.
struct Allowance {
    spent: AtomicU64,
    most: u64,
}

/// What is said about a file that would unpack to `bytes`.
fn too_large(bytes: u64, limit: u64) -> String {
    const MIB: u64 = 1 << 20;
    format!(
        "would unpack to {} MiB or more, and the limit is {} MiB: --limit-decoded raises it, if the file is to be trusted",
        bytes.div_ceil(MIB),
        limit / MIB
    )
}

impl Allowance {
    /// Takes `bytes`, if so many are left.
    fn take(&self, bytes: u64) -> Result<(), String> {
        let before = self.spent.fetch_add(bytes, Ordering::Relaxed);
        let after = before.saturating_add(bytes);
        if after <= self.most {
            return Ok(());
        }
        // What was refused stays counted: nothing more is unpacked.
        self.spent.store(u64::MAX / 2, Ordering::Relaxed);
        Err(too_large(after, self.most))
    }
}

/// Where a buffer's bytes are.
enum Bytes {
    /// Inside the `.glb` itself.
    Inside(Range<usize>),
    File(Mapped),
    Decoded(Vec<u8>),
}

impl Container {
    /// Opens `path` and all its buffers.
    ///
    /// # Errors
    /// When one of them cannot be read or is no glTF, or when it would unpack to more than `limit`
    /// lets pass.
    pub fn open(path: &Path, limit: DecodeLimit) -> Result<Self, ImportError> {
        let file = map(path, path)?;
        let (json, binary) = match file.starts_with(MAGIC) {
            true => chunks(&file).map_err(|message| error(path, message))?,
            false => (encoding::start(&file)..file.len(), None),
        };
        if let Some(wrong) = encoding::wide(&file) {
            return Err(error(path, wrong));
        }
        let document = parse(path, &file[json])?;
        let mut container = Self {
            path: path.to_owned(),
            document,
            file,
            buffers: Vec::new(),
            decoded: HashMap::new(),
            unpacked: HashMap::new(),
            allowance: Allowance {
                spent: AtomicU64::new(0),
                most: limit.bytes,
            },
        };
        container.check_version()?;
        for (index, buffer) in container.document.buffers.iter().enumerate() {
            let bytes = container.buffer(index, buffer, &binary)?;
            container.buffers.push(bytes);
        }
        let held = container.buffers.iter();
        let held = held.map(|b| b.of(&container.file).len() as u64);
        container.allowance.most = limit.most(held.sum());
        container.decoded = container.decompress()?;
        Ok(container)
    }

    /// Notes that `count` elements of `size` bytes are about to be unpacked.
    pub fn unpack(&self, count: usize, size: usize) -> Result<(), ImportError> {
        let bytes = (count as u64).saturating_mul(size as u64);
        self.allowance
            .take(bytes)
            .map_err(|message| error(&self.path, message))
    }

    /// Decodes all buffer views that are compressed.
    fn decompress(&self) -> Result<HashMap<usize, Vec<u8>>, ImportError> {
        let decode = |(index, view): (usize, &BufferView)| {
            let named = |name: &&str| view.extensions.get(*name);
            let extension = meshopt::NAMES.iter().find_map(named)?.clone();
            let decoded = serde_json::from_value::<Compression>(extension)
                .map_err(|e| e.to_string())
                .and_then(|how| {
                    let place = (how.buffer, how.byte_offset, how.byte_length);
                    let bytes = self.slice(place).ok_or("reaches beyond its buffer")?;
                    let size = (how.count as u64).saturating_mul(how.byte_stride as u64);
                    self.allowance.take(size)?;
                    meshopt::decode(bytes, &how)
                });
            let fail = |e: String| error(&self.path, format!("buffer view {index} {e}"));
            Some(decoded.map(|d| (index, d)).map_err(fail))
        };
        let views = self.document.buffer_views.par_iter().enumerate();
        views.filter_map(decode).collect()
    }

    /// `length` bytes of a buffer from `offset`, if they are there.
    fn slice(&self, (buffer, offset, length): (usize, usize, usize)) -> Option<&[u8]> {
        let bytes = self.buffers.get(buffer)?.of(&self.file);
        bytes.get(offset..offset.checked_add(length)?)
    }

    fn check_version(&self) -> Result<(), ImportError> {
        let version = &self.document.asset.version;
        if version.starts_with("2.") {
            return Ok(());
        }
        let message = format!("is glTF of version \"{version}\", and 2.0 is read");
        let help = "convert it, for example by opening and exporting it with Blender";
        Err(hint(&self.path, message, help))
    }

    fn buffer(
        &self,
        index: usize,
        buffer: &Buffer,
        binary: &Option<Range<usize>>,
    ) -> Result<Bytes, ImportError> {
        let (bytes, length) = match (&buffer.uri, binary) {
            (Some(uri), _) => {
                let bytes = self.fetch(uri, &format!("buffer {index}"))?;
                let length = bytes.of(&self.file).len();
                (bytes, length)
            }
            (None, Some(range)) if index == 0 => (Bytes::Inside(range.clone()), range.len()),
            // A buffer of compressed data's fallback has no bytes: whoever reads it finds it empty.
            (None, _) => return Ok(Bytes::Decoded(Vec::new())),
        };
        if length < buffer.byte_length {
            let promised = buffer.byte_length;
            let message = format!("buffer {index} has {length} bytes and should have {promised}");
            return Err(error(&self.path, message));
        }
        Ok(bytes)
    }

    fn fetch(&self, uri: &str, what: &str) -> Result<Bytes, ImportError> {
        if let Some(data) = uri.strip_prefix("data:") {
            let decoded = decode(data)
                .ok_or_else(|| error(&self.path, format!("{what} is no base64 data URI")))?;
            return Ok(Bytes::Decoded(decoded));
        }
        let file = self.resolve(uri, what)?;
        let folder = self.path.parent().unwrap_or(Path::new(""));
        map(&file, &self.path).map(Bytes::File).map_err(|mut e| {
            e.message += &named::hint(&file, folder);
            e
        })
    }

    /// The file that a relative URI names.
    pub fn resolve(&self, uri: &str, what: &str) -> Result<PathBuf, ImportError> {
        if uri.contains("://") {
            let message = format!("{what} is at {uri}: only files are read");
            return Err(hint(&self.path, message, "fetch it and name the file"));
        }
        let folder = self.path.parent().unwrap_or(Path::new("."));
        let plain = folder.join(uri);
        // Exporters that forget to escape spaces and per cent signs are common.
        if plain.exists() {
            return Ok(plain);
        }
        Ok(named::resolve(folder, &unescaped(uri)))
    }

    /// The bytes that a data URI holds.
    pub fn embedded(&self, uri: &str, what: &str) -> Result<Vec<u8>, ImportError> {
        let data = uri.strip_prefix("data:").and_then(decode);
        data.ok_or_else(|| error(&self.path, format!("{what} is no base64 data URI")))
    }

    /// The bytes of buffer view `index`.
    pub fn view(&self, index: usize) -> Result<&[u8], ImportError> {
        if let Some(decoded) = self.decoded.get(&index) {
            return Ok(decoded);
        }
        let fail = |message: String| error(&self.path, message);
        let views = &self.document.buffer_views;
        let view = views
            .get(index)
            .ok_or_else(|| fail(format!("there is no buffer view {index}")))?;
        self.slice((view.buffer, view.byte_offset, view.byte_length))
            .ok_or_else(|| fail(format!("buffer view {index} reaches beyond its buffer")))
    }
}

impl Bytes {
    fn of<'a>(&'a self, file: &'a [u8]) -> &'a [u8] {
        match self {
            Bytes::Inside(range) => &file[range.clone()],
            Bytes::File(map) => map,
            Bytes::Decoded(bytes) => bytes,
        }
    }
}

/// Maps `file`, which `asked` names.
fn map(file: &Path, asked: &Path) -> Result<Mapped, ImportError> {
    mapped::open(file).map_err(|e| match file == asked {
        true => error(file, format!("cannot be read: {e}")),
        false => error(asked, format!("{} cannot be read: {e}", file.display())),
    })
}

fn word(file: &[u8], at: usize) -> Option<u32> {
    let bytes = file.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes))
}

/// The JSON and the binary chunk of a `.glb`.
fn chunks(file: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), String> {
    if word(file, 4) != Some(2) {
        return Err("is a .glb of another version than 2".into());
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(length), Some(kind)) = (word(file, at), word(file, at + 4)) {
        let start = at + 8;
        let end = start.saturating_add(length as usize);
        if end > file.len() {
            return Err(format!("ends inside the chunk at byte {at}"));
        }
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(start..end),
            BINARY_CHUNK if binary.is_none() => binary = Some(start..end),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or("is a .glb without a JSON chunk")?;
    Ok((json, binary))
}

fn parse(path: &Path, json: &[u8]) -> Result<Document, ImportError> {
    serde_json::from_slice(json).map_err(|e| ImportError {
        at: Some(Location {
            file: path.to_owned(),
            line: e.line() as u32,
            column: e.column() as u32,
        }),
        file: None,
        message: format!("is no glTF: {e}"),
        help: None,
    })
}

/// The bytes of a data URI behind `data:`.
fn decode(uri: &str) -> Option<Vec<u8>> {
    let (kind, data) = uri.split_once(',')?;
    if !kind.ends_with(";base64") {
        return None;
    }
    let lenient = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    GeneralPurpose::new(&STANDARD, lenient).decode(data).ok()
}

/// `%20` and the like made the bytes they stand for.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, behind @ ..] = rest {
        let code = behind
            .get(..2)
            .filter(|_| *first == b'%')
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &behind[2..] } else { behind };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_undone_and_odd_ones_kept() {
        assert_eq!(unescaped("a%20b.png"), "a b.png");
        assert_eq!(unescaped("50%.png"), "50%.png");
        assert_eq!(unescaped("%zz%4"), "%zz%4");
        assert_eq!(unescaped("%C3%A4"), "ä");
    }

    #[test]
    fn data_is_decoded_with_and_without_padding() {
        let of = |uri| decode(uri);
        assert_eq!(
            of("application/octet-stream;base64,AQID"),
            Some(vec![1, 2, 3])
        );
        assert_eq!(of(";base64,AQ=="), Some(vec![1]));
        assert_eq!(of(";base64,AQ"), Some(vec![1]));
        assert_eq!(of("text/plain,hello"), None);
        assert_eq!(of(";base64,?"), None);
    }
}
