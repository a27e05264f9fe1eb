//! Numbers of the command line and their units. Each parser's error is the sentence that clap prints
//! after `invalid value '...' for '...':`.

use std::ops::RangeBounds;
use std::str::FromStr;
use std::time::Duration;

/// Numbers with commas between them, such as `160,90`; `None` if it is not `N` of them.
pub fn list<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Result<Vec<T>, _> = text.split(',').map(|t| t.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// Reads a number of a range; `expected` says what is one.
pub fn number<T: FromStr + PartialOrd>(
    range: impl RangeBounds<T> + Clone,
    expected: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| expected.into())
    }
}

/// A brightness as a power of two. Beyond the range every picture is black or white.
///
/// # Errors
/// A sentence that says what was expected.
pub fn stops(text: &str) -> Result<f32, String> {
    number(
        -64.0..=64.0,
        "expected a number from -64 to 64 such as 1.5 or -2",
    )(text)
}

/// A limit on an error, or a time that may be none.
///
/// # Errors
/// A sentence that says what was expected.
pub fn limit(text: &str) -> Result<f64, String> {
    number(
        0.0..f64::INFINITY,
        "expected a number from 0 on such as 0.01",
    )(text)
}

/// Reads a number and the letters behind it off the front of `text`.
fn number_and_unit(text: &str) -> Option<(f64, &str, &str)> {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.')?;
    let (number, rest) = text.split_at(end);
    let end = rest
        .find(|c: char| !c.is_ascii_alphabetic())
        .unwrap_or(rest.len());
    let (unit, rest) = rest.split_at(end);
    Some((number.parse().ok()?, unit, rest))
}

/// A time such as `90`, `120s`, `2m` or `1h30m`.
///
/// # Errors
/// A sentence that says what was expected.
pub fn duration(text: &str) -> Result<Duration, String> {
    const EXPECTED: &str = "expected a time above 0 such as 90, 120s, 2m or 1h30m";
    let seconds = match text.parse::<f64>() {
        Ok(seconds) => Some(seconds),
        Err(_) => seconds_by_units(text),
    };
    seconds
        .filter(|&s| s > 0.0)
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .ok_or_else(|| EXPECTED.into())
}

fn seconds_by_units(text: &str) -> Option<f64> {
    let mut rest = text;
    let mut seconds = 0.0;
    while !rest.is_empty() {
        let (number, unit, behind) = number_and_unit(rest)?;
        seconds += number
            * match unit {
                "ms" => 1e-3,
                "s" => 1.0,
                "m" | "min" => 60.0,
                "h" => 3600.0,
                "d" => 86400.0,
                _ => return None,
            };
        rest = behind;
    }
    Some(seconds)
}

/// A number of bytes such as `512M`, `2G` or `1.5GiB`; the units are powers of 1024.
///
/// # Errors
/// A sentence that says what was expected.
pub fn bytes(text: &str) -> Result<usize, String> {
    const EXPECTED: &str = "expected an amount of memory such as 512M or 2G";
    if let Ok(bytes) = text.parse() {
        return Ok(bytes);
    }
    let Some((number, unit, "")) = number_and_unit(text) else {
        return Err(EXPECTED.into());
    };
    let unit = unit.to_ascii_uppercase();
    let shift = match unit.trim_end_matches('B').trim_end_matches('I') {
        "K" => 10,
        "M" => 20,
        "G" => 30,
        "T" => 40,
        _ => return Err(EXPECTED.into()),
    };
    Ok((number * (1u64 << shift) as f64) as usize)
}

/// A whole number of things such as `500`, `20k`, `5M` or `1.5G`; the units are powers of 1000.
///
/// # Errors
/// A sentence that says what was expected.
pub fn amount(text: &str) -> Result<u64, String> {
    const EXPECTED: &str = "expected a whole number above 0 such as 500, 20k, 5M or 1.5G";
    let scaled = match text.parse::<f64>() {
        Ok(number) => Some(number),
        Err(_) => number_and_unit(text).and_then(|(number, unit, rest)| {
            let factor = match (unit.to_ascii_lowercase().as_str(), rest) {
                ("k", "") => 1e3,
                ("m", "") => 1e6,
                ("g", "") => 1e9,
                _ => return None,
            };
            Some(number * factor)
        }),
    };
    scaled
        .filter(|n| *n >= 1.0 && *n < 1e15 && n.fract() == 0.0)
        .map(|n| n as u64)
        .ok_or_else(|| EXPECTED.into())
}

/// The same, or none at all: `0`.
///
/// # Errors
/// As [`amount`].
pub fn amount_or_zero(text: &str) -> Result<u64, String> {
    match text {
        "0" => Ok(0),
        _ => amount(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::Bound::Excluded;

    #[test]
    fn times_are_read_with_and_without_units() {
        let seconds = |text| duration(text).map(|d| d.as_secs_f64());
        for (text, expected) in [
            ("90", 90.0),
            ("120s", 120.0),
            ("2m", 120.0),
            ("1h30m", 5400.0),
            ("1.5h", 5400.0),
            ("250ms", 0.25),
            ("1d1s", 86401.0),
        ] {
            assert_eq!(seconds(text), Ok(expected), "{text}");
        }
        for text in [
            "", "0", "-3", "abc", "3x", "h", "1h30", "nan", "inf", "1e300",
        ] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn memory_is_read_in_powers_of_1024() {
        for (text, expected) in [
            ("4096", 4096),
            ("512M", 512 << 20),
            ("2g", 2 << 30),
            ("1.5GiB", 3 << 29),
            ("1KB", 1024),
        ] {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in ["", "M", "1X", "-1", "1M1", "1.2.3G"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn amounts_are_read_in_powers_of_1000() {
        for (text, expected) in [
            ("500", 500),
            ("20k", 20_000),
            ("1.5M", 1_500_000),
            ("2G", 2_000_000_000),
        ] {
            assert_eq!(amount(text), Ok(expected), "{text}");
        }
        for text in [
            "", "0", "-1", "k", "5X", "5MB", "2.5", "0.0001k", "nan", "inf",
        ] {
            assert!(amount(text).is_err(), "{text}");
        }
        assert_eq!(amount_or_zero("0"), Ok(0));
        assert_eq!(amount_or_zero("4M"), Ok(4_000_000));
    }

    #[test]
    fn exposures_are_finite() {
        assert_eq!(stops("-2.5"), Ok(-2.5));
        for text in ["nan", "inf", "-inf", "1e30", "bright", ""] {
            assert!(stops(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_keep_to_their_range() {
        let degrees = number((Excluded(0.0), Excluded(180.0)), "degrees");
        assert_eq!(degrees("35"), Ok(35.0));
        for text in ["0", "180", "-5", "wide", "nan"] {
            assert_eq!(degrees(text), Err("degrees".into()), "{text}");
        }
    }

    #[test]
    fn lists_have_as_many_numbers_as_are_asked_for() {
        assert_eq!(list("3,4"), Some([3, 4]));
        assert_eq!(list("3, 4"), Some([3, 4]));
        for text in ["", "3", "3,4,5", "-1,2", "a,b", "1.5,2"] {
            assert_eq!(list::<u32, 2>(text), None, "{text}");
        }
    }
}
