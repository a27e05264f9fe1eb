//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: buffer views as gltfpack writes them.
//!
//! ```text
//!  bytes --mode--> elements --filter--> elements as an accessor reads them
//! ```
//!
//! An own decoder, by the extension's appendices A and B: the crate for it wraps C++, and this
//! program also builds where there is no C++ compiler. Everything grows with what was read, so a
//! file cannot ask for more memory than a small multiple of its length. Guarded by vectors of
//! meshoptimizer's own encoder (tests/vectors/meshopt).

mod attributes;
mod filters;
mod indices;
#[cfg(test)]
mod tests;

use serde::Deserialize;

/// The extension's object on a buffer view.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Compression {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: usize,
    pub count: usize,
    pub mode: String,
    pub filter: Option<String>,
}

/// The names of the extension: the second reads all that the first does.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Decodes the bytes that `how` describes; the error says what is wrong with them.
pub(super) fn decode(bytes: &[u8], how: &Compression) -> Result<Vec<u8>, String> {
    let (count, stride) = (how.count, how.byte_stride);
    let mut elements = match how.mode.as_str() {
        "ATTRIBUTES" => attributes::decode(bytes, count, stride)?,
        "TRIANGLES" => pack(&indices::triangles(bytes, count)?, stride)?,
        "INDICES" => pack(&indices::sequence(bytes, count)?, stride)?,
        other => return Err(format!("is compressed in the unknown mode \"{other}\"")),
    };
    match (how.filter.as_deref().unwrap_or("NONE"), stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => filters::octahedral_8(&mut elements),
        ("OCTAHEDRAL", 8) => filters::octahedral_16(&mut elements),
        ("QUATERNION", 8) => filters::quaternion(&mut elements),
        ("COLOR", 4) => filters::color_8(&mut elements),
        ("COLOR", 8) => filters::color_16(&mut elements),
        ("EXPONENTIAL", _) if stride % 4 == 0 => filters::exponential(&mut elements),
        (other, _) => {
            return Err(format!(
                "has the filter \"{other}\" on elements of {stride} bytes"
            ));
        }
    }
    Ok(elements)
}

/// Indices of two or four bytes.
fn pack(indices: &[u32], stride: usize) -> Result<Vec<u8>, String> {
    match stride {
        2 => Ok(indices
            .iter()
            .flat_map(|&i| (i as u16).to_le_bytes())
            .collect()),
        4 => Ok(indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
        _ => Err(format!("has indices of {stride} bytes")),
    }
}

/// What is said where compressed bytes end before their elements do.
const EARLY: &str = "is compressed, and its bytes end early";

/// Signed numbers that lie around zero as unsigned ones: 0, -1, 1, -2, ..
#[inline]
fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}
