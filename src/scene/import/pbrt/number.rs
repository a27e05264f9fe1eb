//! Decimal numbers from bytes, without a copy: files are mostly made of them.

/// Powers of ten that `f64` holds exactly.
const EXACT: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// Digits that a `u64` holds whatever they are.
const MOST_DIGITS: usize = 19;

/// The number that `text` begins with, and its length in bytes; `None` if it begins with none.
///
/// A mantissa below 2^53 and a power of ten up to 22 are exact in `f64`, so that one multiplication
/// or division rounds correctly (Clinger 1990); everything else goes through the standard library.
#[inline]
pub(super) fn decimal(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let mut at = usize::from(negative || text.first() == Some(&b'+'));
    let start = at;
    let mut mantissa = 0u64;
    while let Some(digit) = digit(text, at) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    let mut digits = at - start;
    let mut exponent = 0i32;
    if text.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digit(text, at) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        digits += at - point;
        exponent = -i32::try_from(at - point).ok()?;
    }
    if digits == 0 {
        return None;
    }
    if matches!(text.get(at), Some(b'e' | b'E')) {
        let (power, length) = power(&text[at + 1..])?;
        at += 1 + length;
        exponent = exponent.saturating_add(power);
    }
    let exact = digits <= MOST_DIGITS && mantissa < 1 << 53;
    let scale = EXACT.get(exponent.unsigned_abs() as usize);
    let value = match scale {
        Some(scale) if exact && exponent < 0 => mantissa as f64 / scale,
        Some(scale) if exact => mantissa as f64 * scale,
        _ => return slow(&text[..at]).map(|value| (value, at)),
    };
    Some((if negative { -value } else { value }, at))
}

#[inline(always)]
fn digit(text: &[u8], at: usize) -> Option<u64> {
    let digit = text.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

/// The power behind an `e`, and its length.
fn power(text: &[u8]) -> Option<(i32, usize)> {
    let sign = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let digits = text[sign..].iter().take_while(|b| b.is_ascii_digit());
    let length = digits.count();
    let mut value = 0i32;
    for byte in &text[sign..sign + length] {
        value = value
            .saturating_mul(10)
            .saturating_add(i32::from(byte - b'0'));
    }
    let value = if text.first() == Some(&b'-') {
        -value
    } else {
        value
    };
    (length > 0).then_some((value, sign + length))
}

#[cold]
fn slow(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let mut rng = Pcg32::new(1, 1);
        let check = |text: &str| {
            let expected: f64 = text.parse().unwrap();
            let (value, length) = decimal(text.as_bytes()).unwrap();
            assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
            assert_eq!(length, text.len());
        };
        for text in [
            "0",
            "-0",
            "+1",
            ".5",
            "-.5e1",
            "5.",
            "1e22",
            "1e23",
            "1e-400",
            "1e400",
            "-1E+3",
            "123456789012345678901234567890",
            "0.1",
            "9007199254740993",
            "4.9e-324",
            "1e-22",
            "18446744073709551616.5",
        ] {
            check(text);
        }
        for _ in 0..100_000 {
            let value = f64::from(rng.next_f32()) * 10f64.powi((rng.next_u32() % 60) as i32 - 30);
            check(&format!("{value}"));
            check(&format!("{value:e}"));
            check(&format!("{:.5}", -value.min(1e6)));
        }
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "", "-", ".", "e5", "-e", "1e", "1e+", "nan", "inf", "x", "\"1\"",
        ] {
            assert_eq!(decimal(text.as_bytes()), None, "{text}");
        }
        assert_eq!(decimal(b"1.5]"), Some((1.5, 3)));
        assert_eq!(decimal(b"12 13"), Some((12.0, 2)));
    }
}
