//! Words of the command line that have a grammar of their own. Each parser's error is the sentence
//! that clap prints after `invalid value '...' for '...':`.

use crate::film::Shard;
use std::str::FromStr;
use std::time::Duration;

/// A limit on the number of edges of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Depth(
    /// `None` is unlimited.
    pub Option<u32>,
);

impl FromStr for Depth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if matches!(text, "-1" | "unlimited") {
            return Ok(Self(None));
        }
        match text.parse() {
            Ok(depth) if depth > 0 => Ok(Self(Some(depth))),
            _ => Err("expected a whole number from 1 on, or \"unlimited\"".into()),
        }
    }
}

/// Part of a film: x0, y0, x1, y1 in pixels, upper bounds not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop(
    /// The four numbers, x0 < x1 and y0 < y1.
    pub [u32; 4],
);

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
        let Ok(&[x0, y0, x1, y1]) = numbers.as_deref() else {
            return Err("expected four whole numbers x0,y0,x1,y1 such as 0,0,320,240".into());
        };
        if x0 >= x1 || y0 >= y1 {
            return Err("it holds no pixel: x1 must be beyond x0, and y1 beyond y0".into());
        }
        Ok(Self([x0, y0, x1, y1]))
    }
}

/// A pixel of the full film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelAt(
    /// x from the left and y from the top, from 0.
    pub [u32; 2],
);

impl FromStr for PixelAt {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y]) => Ok(Self([x, y])),
            _ => Err("expected two whole numbers x,y such as 160,90".into()),
        }
    }
}

/// A value for a `$name` in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// The name, without `$`.
    pub name: String,
    /// The text to put in its place.
    pub value: String,
}

impl FromStr for Definition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
        match text.split_once('=') {
            Some((name, value)) if !name.is_empty() && name.chars().all(word) => Ok(Self {
                name: name.into(),
                value: value.into(),
            }),
            _ => Err("expected key=value such as -D spp=256".into()),
        }
    }
}

/// How often directions are drawn from a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixture(
    /// Share of the directions, within 0.1 and 0.9; `None` is learned.
    pub Option<f32>,
);

impl FromStr for Mixture {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "learned" {
            return Ok(Self(None));
        }
        match text.parse::<f32>() {
            Ok(share) if (0.1..=0.9).contains(&share) => Ok(Self(Some(share))),
            _ => Err("expected a number from 0.1 to 0.9, or \"learned\"".into()),
        }
    }
}

/// A pixel of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
}

impl FromStr for Pixel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text
            .split_once(',')
            .map(|(x, y)| (x.trim().parse(), y.trim().parse()));
        match numbers {
            Some((Ok(x), Ok(y))) => Ok(Self { x, y }),
            _ => Err("expected two whole numbers x,y such as 160,90".into()),
        }
    }
}

impl std::fmt::Display for Pixel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{}", self.x, self.y)
    }
}

/// A share of the film, `i/n` with `i` counted from 0.
///
/// # Errors
/// When it is not one.
pub fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .map(|(i, n)| (i.parse::<u32>(), n.parse::<u32>()));
    let Some((Ok(index), Ok(count))) = numbers else {
        return Err("expected i/n such as 0/4, the first of four".into());
    };
    if index >= count {
        return Err(format!(
            "shards are counted from 0: the last of {count} is {}/{count}",
            count.saturating_sub(1)
        ));
    }
    Ok(Shard { index, count })
}

/// Where to show the image while it renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Preview {
    /// In the image viewer tev, at this address.
    Tev(String),
}

/// Where tev listens unless told otherwise.
const TEV_ADDRESS: &str = "127.0.0.1:14158";

impl FromStr for Preview {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let port = |address: &str| Some(address.rsplit_once(':')?.1.parse::<u16>().is_ok());
        match text.split_once('=') {
            None if text == "tev" => Ok(Self::Tev(TEV_ADDRESS.into())),
            Some(("tev", address)) if port(address) == Some(true) => Ok(Self::Tev(address.into())),
            _ => Err("expected tev or tev=host:port such as tev=127.0.0.1:14158".into()),
        }
    }
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
    let seconds = seconds.filter(|&s| s > 0.0);
    seconds
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

/// A noise to stop at.
///
/// # Errors
/// A sentence that says what was expected.
pub fn noise(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(noise) if noise > 0.0 && noise.is_finite() => Ok(noise),
        _ => Err("expected a number above 0 such as 0.02".into()),
    }
}

/// A brightness as a power of two.
///
/// # Errors
/// A sentence that says what was expected.
pub fn stops(text: &str) -> Result<f32, String> {
    /// Beyond it every picture is black or white.
    const MOST: f32 = 64.0;
    match text.parse::<f32>() {
        Ok(stops) if stops.abs() <= MOST => Ok(stops),
        _ => Err("expected a number from -64 to 64 such as 1.5 or -2".into()),
    }
}

/// A field of view in degrees.
///
/// # Errors
/// A sentence that says what was expected.
pub fn field_of_view(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("expected degrees above 0 and below 180 such as 35".into()),
    }
}

/// A number of things such as `500`, `20k`, `5M` or `1.5G`; the units are powers of 1000.
///
/// # Errors
/// A sentence that says what was expected.
pub fn amount(text: &str) -> Result<u64, String> {
    const EXPECTED: &str = "expected a number above 0 such as 500, 20k, 5M or 1.5G";
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
        .filter(|n| *n >= 1.0 && *n < 1e15)
        .map(|n| n as u64)
        .ok_or_else(|| EXPECTED.into())
}

/// A limit on an error, or a time that may be none.
///
/// # Errors
/// A sentence that says what was expected.
pub fn limit(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(limit) if limit >= 0.0 && limit.is_finite() => Ok(limit),
        _ => Err("expected a number from 0 on such as 0.01".into()),
    }
}

/// A range of values.
///
/// # Errors
/// A sentence that says what was expected.
pub fn range(text: &str) -> Result<f64, String> {
    limit(text)
        .ok()
        .filter(|range| *range > 0.0)
        .ok_or_else(|| "expected a number above 0 such as 1".into())
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for text in ["", "0", "-1", "k", "5X", "5MB", "nan", "inf"] {
            assert!(amount(text).is_err(), "{text}");
        }
    }

    #[test]
    fn exposures_are_finite() {
        assert_eq!(stops("-2.5"), Ok(-2.5));
        for text in ["nan", "inf", "-inf", "1e30", "bright", ""] {
            assert!(stops(text).is_err(), "{text}");
        }
    }

    #[test]
    fn fields_of_view_are_below_180_degrees() {
        assert_eq!(field_of_view("35"), Ok(35.0));
        for text in ["0", "180", "-5", "wide", "nan"] {
            assert!(field_of_view(text).is_err(), "{text}");
        }
    }

    #[test]
    fn crops_hold_pixels() {
        assert_eq!("1,2,3,4".parse(), Ok(Crop([1, 2, 3, 4])));
        for text in [
            "1,2,3",
            "3,2,1,4",
            "1,4,3,4",
            "a,b,c,d",
            "1,2,3,4,5",
            "-1,0,2,2",
        ] {
            assert!(text.parse::<Crop>().is_err(), "{text}");
        }
    }

    #[test]
    fn pixels_are_two_numbers() {
        assert_eq!("3,4".parse(), Ok(Pixel { x: 3, y: 4 }));
        for text in ["", "3", "3,4,5", "-1,2", "a,b", "1.5,2"] {
            assert!(text.parse::<Pixel>().is_err(), "{text}");
        }
    }

    #[test]
    fn definitions_keep_what_follows_the_first_equals_sign() {
        let definition: Definition = "a_1=b=c".parse().unwrap();
        assert_eq!(
            (definition.name.as_str(), definition.value.as_str()),
            ("a_1", "b=c")
        );
        for text in ["", "=1", "a", "a b=1"] {
            assert!(text.parse::<Definition>().is_err(), "{text}");
        }
    }

    #[test]
    fn previews_name_a_host_and_a_port() {
        let tev = |address: &str| Ok(Preview::Tev(address.into()));
        assert_eq!("tev".parse(), tev(TEV_ADDRESS));
        assert_eq!("tev=far:99".parse(), tev("far:99"));
        for text in ["", "gimp", "tev=", "tev=host", "tev=host:port", "gimp=a:1"] {
            assert!(text.parse::<Preview>().is_err(), "{text}");
        }
    }
}
