//! Values of parameters: numbers, vectors, colours, read from attribute text.

use crate::math::{DMat4, DVec3, Rgb};
use crate::scene::import::numbers;
pub(super) use crate::scene::import::numbers::{number, numbers, words};
use crate::scene::import::spectrum::{self, Weighting};

/// A parameter's value.
#[derive(Clone, Debug)]
pub(super) enum Value {
    /// `<boolean>`.
    Boolean(bool),
    /// `<integer>`.
    Integer(i64),
    /// `<float>`.
    Float(f64),
    /// `<string>`.
    Text(String),
    /// `<point>` or `<vector>`.
    Vector(DVec3),
    /// `<rgb>`, `<srgb>`, `<spectrum>` or `<blackbody>`.
    Color(Color),
    /// `<transform>`.
    Transform(DMat4),
    /// A nested object or a `<ref>`, as an index into the document's objects.
    Object(usize),
    /// A `<ref>` before it is resolved.
    Reference(String),
    /// Something that could not be read, of which that is told already.
    Broken,
}

impl Value {
    /// The element that writes such a value, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Boolean(_) => "a <boolean>",
            Value::Integer(_) => "an <integer>",
            Value::Float(_) => "a <float>",
            Value::Text(_) => "a <string>",
            Value::Vector(_) => "a <point> or <vector>",
            Value::Color(_) => "a colour",
            Value::Transform(_) => "a <transform>",
            Value::Object(_) | Value::Reference(_) | Value::Broken => "an object",
        }
    }
}

/// A colour as written; what it means in RGB depends on what it is used for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Color {
    /// Linear sRGB.
    Rgb(DVec3),
    /// A spectrum with one value for all wavelengths.
    Uniform(f64),
    /// A spectrum given by (wavelength in nm, value).
    Samples(Vec<(f64, f64)>),
    /// Temperature in kelvin, and a factor.
    BlackBody(f64, f64),
}

/// Which program's file it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// Mitsuba 0.x.
    Classic,
    /// Mitsuba 2 and 3.
    Modern,
}

impl Color {
    /// Linear sRGB. A one-value spectrum used as light is grey in Mitsuba 0.x (where spectra are
    /// RGB triples) and of equal energy in Mitsuba 3.
    pub fn to_rgb(&self, weighting: Weighting, dialect: Dialect) -> Rgb {
        match self {
            Color::Rgb(c) => c.as_vec3(),
            Color::Samples(samples) => spectrum::sampled(weighting, samples),
            Color::BlackBody(kelvin, scale) => spectrum::black_body(*kelvin) * *scale as f32,
            Color::Uniform(v) => {
                if weighting == Weighting::Emission && dialect == Dialect::Modern {
                    spectrum::equal_energy(*v)
                } else {
                    Rgb::splat(*v as f32)
                }
            }
        }
    }
}

/// One number for all three or three numbers.
pub(super) fn vector(text: &str) -> Result<DVec3, String> {
    match numbers(text)?.as_slice() {
        &[v] => Ok(DVec3::splat(v)),
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(format!("expected 1 or 3 numbers, found {}", other.len())),
    }
}

/// `true` or `false`.
pub(super) fn boolean(text: &str) -> Result<bool, String> {
    let trimmed = text.trim();
    if trimmed.eq_ignore_ascii_case("true") {
        Ok(true)
    } else if trimmed.eq_ignore_ascii_case("false") {
        Ok(false)
    } else {
        Err(format!("\"{trimmed}\" is neither \"true\" nor \"false\""))
    }
}

/// A whole number.
pub(super) fn integer(text: &str) -> Result<i64, String> {
    let trimmed = text.trim();
    trimmed
        .parse()
        .map_err(|_| format!("\"{trimmed}\" is not a whole number"))
}

/// `r, g, b`, one grey value, or `#rrggbb`: 255ths taken as they are (`encoded` false) or through
/// the sRGB curve (`encoded` true). Mitsuba 0.x takes hexadecimal digits in `<rgb>` as linear too.
pub(super) fn rgb(text: &str, encoded: bool) -> Result<Color, String> {
    let raw = match text.trim().strip_prefix('#') {
        Some(hex) => hexadecimal(hex)?,
        None => vector(text)?,
    };
    let decode = if encoded {
        spectrum::srgb_to_linear
    } else {
        |v| v
    };
    Ok(Color::Rgb(DVec3::from_array(raw.to_array().map(decode))))
}

fn hexadecimal(digits: &str) -> Result<DVec3, String> {
    let bad = || format!("\"#{digits}\" is not a colour; six hexadecimal digits are expected");
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return Err(bad());
    }
    let bits = u32::from_str_radix(digits, 16).map_err(|_| bad())?;
    let channel = |shift: u32| f64::from((bits >> shift) & 0xff) / 255.0;
    Ok(DVec3::new(channel(16), channel(8), channel(0)))
}

/// One value, three values (0.x, where spectra are RGB), or `wavelength:value` pairs.
pub(super) fn spectrum(text: &str) -> Result<Color, String> {
    if text.contains(':') {
        let pairs: Result<Vec<_>, String> = words(text).map(pair).collect();
        return samples(pairs?);
    }
    match numbers(text)?.as_slice() {
        &[v] => Ok(Color::Uniform(v)),
        &[r, g, b] => Ok(Color::Rgb(DVec3::new(r, g, b))),
        other => Err(format!(
            "a spectrum has one value, three, or wavelength:value pairs; found {} values",
            other.len()
        )),
    }
}

fn pair(word: &str) -> Result<(f64, f64), String> {
    let (w, v) = word
        .split_once(':')
        .ok_or_else(|| format!("\"{word}\" is not a wavelength:value pair"))?;
    Ok((number(w)?, number(v)?))
}

/// Checks samples of a spectrum.
pub(super) fn samples(samples: Vec<(f64, f64)>) -> Result<Color, String> {
    numbers::increasing(samples).map(Color::Samples)
}

/// Text of a `.spd` file.
pub(super) fn spectrum_file(text: &str) -> Result<Color, String> {
    numbers::samples(text).map(Color::Samples)
}

/// A temperature such as `5000` or `5000K`.
pub(super) fn temperature(text: &str) -> Result<f64, String> {
    let digits = text.trim().trim_end_matches(['k', 'K']);
    let kelvin = number(digits)?;
    if kelvin <= 0.0 {
        return Err(format!("a temperature of {kelvin} K does not exist"));
    }
    Ok(kelvin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_in_every_spelling() {
        let c = |r, g, b| Ok(Color::Rgb(DVec3::new(r, g, b)));
        assert_eq!(rgb(".8,.8, .4", false), c(0.8, 0.8, 0.4));
        assert_eq!(rgb("1 2 3", false), c(1.0, 2.0, 3.0));
        assert_eq!(rgb("0.5", false), c(0.5, 0.5, 0.5));
        assert_eq!(rgb("#ff3300", false), c(1.0, 0.2, 0.0));
        let Ok(Color::Rgb(decoded)) = rgb("#80ff00", true) else {
            panic!("not a colour");
        };
        assert!((decoded.x - 0.215_860_5).abs() < 1e-6, "{decoded}");
        for bad in ["#12345", "#+12345", "#1234567", "1 2", "red"] {
            assert!(rgb(bad, false).is_err(), "{bad}");
        }
    }

    #[test]
    fn spectra_are_read_in_every_spelling() {
        assert_eq!(spectrum("0.3"), Ok(Color::Uniform(0.3)));
        assert_eq!(
            spectrum("2.1, 1.2, 1.6"),
            Ok(Color::Rgb(DVec3::new(2.1, 1.2, 1.6)))
        );
        let pairs = Color::Samples(vec![(400.0, 0.0), (500.0, 16.0)]);
        assert_eq!(spectrum("400:0, 500:16"), Ok(pairs.clone()));
        assert_eq!(spectrum_file("# head\n400 0\n\n500 16 # end\n"), Ok(pairs));
        assert!(spectrum("500:1, 400:2").is_err());
        assert!(spectrum("400:1, 500").is_err());
        assert!(spectrum("1 2").is_err());
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number(" -4.37114e-008 "), Ok(-4.37114e-8));
        for bad in ["", "x", "nan", "inf", "1e300", "0x10"] {
            assert!(number(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn one_value_light_is_grey_in_old_files_and_equal_energy_in_new_ones() {
        let one = Color::Uniform(2.0);
        let old = one.to_rgb(Weighting::Emission, Dialect::Classic);
        assert_eq!(old, Rgb::splat(2.0));
        let new = one.to_rgb(Weighting::Emission, Dialect::Modern);
        assert!(new.x > 2.3 && new.z < 1.9, "{new}");
        let factor = one.to_rgb(Weighting::Reflectance, Dialect::Modern);
        assert_eq!(factor, Rgb::splat(2.0));
    }
}
