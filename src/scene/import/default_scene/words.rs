//! Words for views and skies: `orbit:30,20`, `sun:45,30`.

use crate::math::{DVec3, Rgb};
use crate::scene::import::models::numbers;
use crate::scene::import::models::palette::parse_color;
use std::str::FromStr;

/// Where a camera is.
#[derive(Clone, Debug, PartialEq)]
pub enum Viewpoint {
    /// Around the target, as near as all of the models can be seen; degrees.
    Orbit {
        /// 0 is the front (+z, or -y where +z is up), positive to the right of who looks at it.
        azimuth: f64,
        /// Above the horizon, -90 to 90.
        elevation: f64,
    },
    /// At a point.
    From(DVec3),
    /// A camera of a file, by its name or number.
    Named(String),
}

impl FromStr for Viewpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(angles) = text.strip_prefix("orbit:") {
            return match numbers(angles).as_deref() {
                Some(&[azimuth, elevation]) if elevation.abs() <= 90.0 => {
                    Ok(Self::Orbit { azimuth, elevation })
                }
                _ => Err("expected orbit:AZIMUTH,ELEVATION in degrees such as orbit:30,20".into()),
            };
        }
        if let Some(point) = text.strip_prefix("from:") {
            return self::point(point).map(Self::From);
        }
        Ok(Self::Named(text.to_owned()))
    }
}

/// A point X,Y,Z.
///
/// # Errors
/// A sentence that says what was expected.
pub fn point(text: &str) -> Result<DVec3, String> {
    match numbers(text).as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("expected three numbers X,Y,Z such as 0,1.5,0".into()),
    }
}

/// Light around models.
#[derive(Clone, Debug, PartialEq)]
pub enum Sky {
    /// A soft key light and a dome.
    Studio,
    /// The same radiance from everywhere.
    White(Rgb),
    /// A clear sky with its sun; degrees as in [`Viewpoint::Orbit`].
    Sun {
        /// Where the sun is.
        azimuth: f64,
        /// How high it is.
        elevation: f64,
    },
    /// Darkness, but for the lights of the files.
    None,
}

impl FromStr for Sky {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const EXPECTED: &str =
            "expected studio, white, white:R,G,B, sun, sun:AZIMUTH,ELEVATION or none";
        let (name, value) = match text.split_once(':') {
            Some((name, value)) => (name, Some(value)),
            None => (text, None),
        };
        match (name, value) {
            ("studio", None) => Ok(Self::Studio),
            ("none", None) => Ok(Self::None),
            ("white", None) => Ok(Self::White(Rgb::ONE)),
            ("white", Some(color)) => bright(color).map(Self::White),
            ("sun", None) => Ok(Self::Sun {
                azimuth: -40.0,
                elevation: 40.0,
            }),
            ("sun", Some(angles)) => match numbers(angles).as_deref() {
                Some(&[azimuth, elevation]) if (0.0..=90.0).contains(&elevation) => {
                    Ok(Self::Sun { azimuth, elevation })
                }
                _ => {
                    Err("expected sun:AZIMUTH,ELEVATION in degrees, ELEVATION from 0 to 90".into())
                }
            },
            _ => Err(EXPECTED.into()),
        }
    }
}

/// A radiance: a colour that may be brighter than 1.
fn bright(text: &str) -> Result<Rgb, String> {
    match numbers(text).as_deref() {
        Some(&[r, g, b]) if r.min(g).min(b) >= 0.0 => Ok(Rgb::new(r as f32, g as f32, b as f32)),
        Some(&[grey]) if grey >= 0.0 => Ok(Rgb::splat(grey as f32)),
        _ => parse_color(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_and_skies_are_read() {
        let orbit = Viewpoint::Orbit {
            azimuth: -30.0,
            elevation: 20.5,
        };
        assert_eq!("orbit:-30,20.5".parse(), Ok(orbit));
        assert_eq!(
            "from:1,2,3".parse(),
            Ok(Viewpoint::From(DVec3::new(1.0, 2.0, 3.0)))
        );
        assert_eq!(
            "Camera.001".parse(),
            Ok(Viewpoint::Named("Camera.001".into()))
        );
        assert_eq!("white:2".parse(), Ok(Sky::White(Rgb::splat(2.0))));
        let sun = Sky::Sun {
            azimuth: 10.0,
            elevation: 90.0,
        };
        assert_eq!("sun:10,90".parse(), Ok(sun));
        for text in ["orbit:1", "orbit:0,91", "from:1,2", "orbit:nan,0"] {
            assert!(text.parse::<Viewpoint>().is_err(), "{text}");
        }
        for text in ["", "dark", "sun:0", "sun:0,-5", "white:-1", "none:1"] {
            assert!(text.parse::<Sky>().is_err(), "{text}");
        }
    }
}
