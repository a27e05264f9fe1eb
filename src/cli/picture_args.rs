//! What can be typed about the picture: its size, its part and its filter.

use super::choice::{Choice, choice};
use super::values;
use crate::film::filter::Filter;
use clap::Args;
use serde::Serialize;
use std::str::FromStr;

/// Size and filter of the picture.
#[derive(Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Size.
    #[command(flatten)]
    #[serde(flatten)]
    pub size: SizeArgs,
    /// Render this part only, upper bounds not included
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
    pub crop: Option<Crop>,
    /// An alpha channel: the background is transparent, and the camera itself does not see what
    /// shines there. A scene asks for it by the film's pixel_format rgba and hide_emitters
    #[arg(long)]
    pub alpha: bool,
    /// Reconstruction filter [default: the scene's]
    #[arg(long, value_name = "NAME", value_parser = FILTERS)]
    pub rfilter: Option<Filter>,
}

/// Size of a picture.
#[derive(Args, Clone, Copy, Debug, Default, Serialize)]
#[command(next_help_heading = "Picture")]
pub struct SizeArgs {
    /// Width in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE))]
    pub width: Option<u32>,
    /// Height in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE))]
    pub height: Option<u32>,
}

/// Longest side of a film: no image format reaches further.
pub const MAX_SIDE: i64 = 1 << 17;

const FILTERS: Choice<Filter> = choice! {
    /// One pixel, constant
    "box" => Filter::Box { radius: 0.5 },
    /// Linear falloff over one pixel
    "tent" => Filter::Tent { radius: 1.0 },
    /// Standard deviation 0.5
    "gaussian" => Filter::Gaussian { stddev: 0.5 },
    /// Mitchell and Netravali
    "mitchell" => Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
    /// Catmull and Rom
    "catmullrom" => Filter::CatmullRom,
    /// Windowed sinc of three lobes
    "lanczos" => Filter::Lanczos { lobes: 3.0 },
};

/// Part of a film: x0, y0, x1, y1 in pixels, upper bounds not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Crop(
    /// The four numbers, x0 < x1 and y0 < y1.
    pub [u32; 4],
);

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some([x0, y0, x1, y1]) = values::list(text) else {
            return Err("expected four whole numbers x0,y0,x1,y1 such as 0,0,320,240".into());
        };
        if x0 >= x1 || y0 >= y1 {
            return Err("it holds no pixel: x1 must be beyond x0, and y1 beyond y0".into());
        }
        Ok(Self([x0, y0, x1, y1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
