//! Mode 0: differences between successive elements, byte by byte, in groups of 16.
//!
//! ```text
//!  bytes --control, group modes--> differences --channel modes--> elements
//! ```
//!
//! Version 0 is that of `EXT_meshopt_compression`; `KHR_meshopt_compression` adds version 1 with
//! finer bit lengths and differences of two and four bytes.

use super::{EARLY, unzigzag};

/// Most elements of a block.
const MAX_BLOCK: usize = 256;
const GROUP: usize = 16;

/// Bits of a difference by control mode and group mode; 0 stores nothing, 8 whole bytes.
const BITS: [[u8; 4]; 3] = [[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]];

/// The layout of a version of the format.
struct Version {
    /// The bytes at the end, at least: zeros stand before a shorter tail.
    tail: usize,
    /// Bytes of the channels' modes in the tail, and of the control modes before each block.
    modes: usize,
}

/// How the differences of a channel, four successive bytes, make values.
#[derive(Clone, Copy)]
enum Channel {
    /// Each byte for itself.
    Bytes,
    /// Two numbers of 16 bits.
    Words,
    /// One of 32 bits that is changed by exclusive or, turned to the right by so many bits.
    Turned(u32),
}

impl Channel {
    fn of(mode: u8) -> Result<Self, String> {
        match (mode & 15, mode >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Words),
            (2, turn) => Ok(Self::Turned(u32::from(turn))),
            _ => Err(format!("has a channel of the unknown mode {mode}")),
        }
    }

    /// The value behind `last`.
    fn step(self, last: [u8; 4], delta: [u8; 4]) -> [u8; 4] {
        match self {
            Self::Bytes => {
                let change = delta.map(|d| unzigzag(d.into()) as u8);
                std::array::from_fn(|i| last[i].wrapping_add(change[i]))
            }
            Self::Words => {
                let word = |b: [u8; 4], i: usize| u16::from_le_bytes([b[i], b[i + 1]]);
                let value = |i: usize| {
                    let change = unzigzag(word(delta, i).into()) as u16;
                    word(last, i).wrapping_add(change).to_le_bytes()
                };
                let ([a, b], [c, d]) = (value(0), value(2));
                [a, b, c, d]
            }
            Self::Turned(bits) => {
                let change = u32::from_le_bytes(delta).rotate_right(bits);
                (u32::from_le_bytes(last) ^ change).to_le_bytes()
            }
        }
    }
}

/// `count` elements of `stride` bytes.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    if stride == 0 || stride > 256 || stride % 4 != 0 {
        return Err(format!("has compressed elements of {stride} bytes"));
    }
    let (version, body) = match bytes.split_first() {
        Some((0xa0, body)) => (Version { tail: 32, modes: 0 }, body),
        Some((0xa1, body)) => {
            let modes = stride / 4;
            (Version { tail: 24, modes }, body)
        }
        _ => return Err("is not compressed as attributes of version 0 or 1".into()),
    };
    let tail = stride + version.modes;
    let length = body.len().checked_sub(version.tail.max(tail));
    let mut rest = &body[..length.ok_or(EARLY)?];
    let (last, modes) = body[body.len() - tail..].split_at(stride);
    let channels = match modes {
        [] => Ok(vec![Channel::Bytes; stride / 4]),
        modes => modes.iter().map(|m| Channel::of(*m)).collect(),
    };
    let channels: Vec<Channel> = channels?;
    let mut last = last.to_vec();
    let most = MAX_BLOCK.min((8192 / stride) & !(GROUP - 1));
    let mut elements = Vec::new();
    let mut left = count;
    while left > 0 {
        let size = left.min(most);
        let start = elements.len();
        elements.resize(start + size * stride, 0);
        let block = &mut elements[start..];
        let (control, behind) = rest.split_at_checked(version.modes).ok_or(EARLY)?;
        rest = behind;
        for byte in 0..stride {
            let control = control.get(byte / 4).map(|c| c >> (2 * (byte % 4)) & 3);
            rest = column(rest, &mut block[byte..], (size, stride), control)?;
        }
        sum(block, &channels, &mut last);
        left -= size;
    }
    Ok(elements)
}

/// Makes the differences in `block` the values themselves, the first behind `last`.
fn sum(block: &mut [u8], channels: &[Channel], last: &mut [u8]) {
    for element in block.chunks_exact_mut(last.len()) {
        let parts = element.chunks_exact_mut(4).zip(last.chunks_exact_mut(4));
        for ((delta, last), channel) in parts.zip(channels) {
            let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
            let value = channel.step(four(last), four(delta));
            last.copy_from_slice(&value);
            delta.copy_from_slice(&value);
        }
    }
}

/// One byte of all elements of a block: puts its differences in their places and returns what is
/// left of the input. `control` is version 1's mode of the byte.
fn column<'a>(
    bytes: &'a [u8],
    block: &mut [u8],
    (size, stride): (usize, usize),
    control: Option<u8>,
) -> Result<&'a [u8], &'static str> {
    let bits = match control {
        None => BITS[0],
        Some(0) => BITS[1],
        Some(1) => BITS[2],
        Some(2) => return Ok(bytes),
        Some(_) => {
            let (raw, rest) = bytes.split_at_checked(size).ok_or(EARLY)?;
            let places = block.iter_mut().step_by(stride);
            places.zip(raw).for_each(|(place, byte)| *place = *byte);
            return Ok(rest);
        }
    };
    let groups = size.div_ceil(GROUP);
    let (modes, mut rest) = bytes.split_at_checked(groups.div_ceil(4)).ok_or(EARLY)?;
    for group in 0..groups {
        let mode = modes[group / 4] >> (2 * (group % 4)) & 3;
        let (deltas, behind) = deltas(rest, bits[usize::from(mode)]).ok_or(EARLY)?;
        rest = behind;
        let first = group * GROUP;
        for (i, delta) in deltas.into_iter().take(size - first).enumerate() {
            block[(first + i) * stride] = delta;
        }
    }
    Ok(rest)
}

/// The differences of a group, and what is left.
fn deltas(bytes: &[u8], bits: u8) -> Option<([u8; GROUP], &[u8])> {
    match bits {
        0 => Some(([0; GROUP], bytes)),
        8 => {
            let (raw, rest) = bytes.split_first_chunk()?;
            Some((*raw, rest))
        }
        _ => packed(bytes, usize::from(bits)),
    }
}

/// Differences of `bits` bits; all ones stand for a byte behind them. Single bits begin with the
/// least significant one of their byte, all others with the most significant.
fn packed(bytes: &[u8], bits: usize) -> Option<([u8; GROUP], &[u8])> {
    let (small, mut rest) = bytes.split_at_checked(GROUP * bits / 8)?;
    let escape = (1u8 << bits) - 1;
    let mut deltas = [0; GROUP];
    for (i, delta) in deltas.iter_mut().enumerate() {
        let at = i * bits;
        let shift = if bits == 1 { at % 8 } else { 8 - bits - at % 8 };
        let value = small[at / 8] >> shift & escape;
        *delta = value;
        if value == escape {
            let (whole, behind) = rest.split_first()?;
            (*delta, rest) = (*whole, behind);
        }
    }
    Some((deltas, rest))
}

#[cfg(test)]
mod tests {
    use super::packed;

    /// The example of the specification.
    #[test]
    fn small_differences_and_their_escapes() {
        let bytes = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let (deltas, rest) = packed(&bytes, 4).unwrap();
        let signed = deltas.map(|d| (d >> 1 ^ (d & 1).wrapping_neg()) as i8);
        let expected = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
        assert_eq!(signed, expected);
        assert!(rest.is_empty());
        assert!(packed(&bytes[..9], 4).is_none());
    }
}
