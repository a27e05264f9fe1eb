//! Mode 0: differences between the same bytes of successive elements, in groups of 16.

use super::EARLY;

/// Most elements of a block.
const MAX_BLOCK: usize = 256;
const GROUP: usize = 16;
/// The last bytes hold the element before the first, behind zeros if it is shorter than this.
const TAIL: usize = 32;

/// `count` elements of `stride` bytes.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    if stride == 0 || stride > 256 || stride % 4 != 0 {
        return Err(format!("has compressed elements of {stride} bytes"));
    }
    let Some((0xa0, body)) = bytes.split_first() else {
        return Err("is not compressed as attributes of version 0".into());
    };
    let body_length = body.len().checked_sub(TAIL.max(stride)).ok_or(EARLY)?;
    let mut last = body[body.len() - stride..].to_vec();
    let mut rest = &body[..body_length];
    let most = MAX_BLOCK.min((8192 / stride) & !(GROUP - 1));
    let mut elements = Vec::new();
    let mut left = count;
    while left > 0 {
        let size = left.min(most);
        let start = elements.len();
        elements.resize(start + size * stride, 0);
        let block = &mut elements[start..];
        for (byte, last) in last.iter_mut().enumerate() {
            rest = column(rest, &mut block[byte..], (size, stride), last)?;
        }
        left -= size;
    }
    Ok(elements)
}

/// One byte of all elements of a block; what is left of the input.
fn column<'a>(
    bytes: &'a [u8],
    block: &mut [u8],
    (size, stride): (usize, usize),
    last: &mut u8,
) -> Result<&'a [u8], &'static str> {
    let groups = size.div_ceil(GROUP);
    let (modes, mut rest) = bytes.split_at_checked(groups.div_ceil(4)).ok_or(EARLY)?;
    for group in 0..groups {
        let mode = modes[group / 4] >> (2 * (group % 4)) & 3;
        let (deltas, behind) = deltas(rest, mode).ok_or(EARLY)?;
        rest = behind;
        let first = group * GROUP;
        for (i, delta) in deltas.into_iter().take(size - first).enumerate() {
            let change = delta >> 1 ^ (delta & 1).wrapping_neg();
            *last = last.wrapping_add(change);
            block[(first + i) * stride] = *last;
        }
    }
    Ok(rest)
}

/// The differences of a group, and what is left.
fn deltas(bytes: &[u8], mode: u8) -> Option<([u8; GROUP], &[u8])> {
    match mode {
        0 => Some(([0; GROUP], bytes)),
        1 => packed(bytes, 2),
        2 => packed(bytes, 4),
        _ => {
            let (raw, rest) = bytes.split_first_chunk()?;
            Some((*raw, rest))
        }
    }
}

/// Differences of `bits` bits, from the most significant on; all ones stand for a byte behind them.
fn packed(bytes: &[u8], bits: usize) -> Option<([u8; GROUP], &[u8])> {
    let (small, mut rest) = bytes.split_at_checked(GROUP * bits / 8)?;
    let escape = (1u8 << bits) - 1;
    let mut deltas = [0; GROUP];
    for (i, delta) in deltas.iter_mut().enumerate() {
        let at = i * bits;
        let value = small[at / 8] >> (8 - bits - at % 8) & escape;
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
