//! What can be typed about the picture: its size, its part and its filter.

use super::values::Crop;
use clap::{Args, ValueEnum};

/// Size and filter of the picture.
#[derive(Args, Debug)]
pub struct PictureArgs {
    /// Width in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE), help_heading = "Picture")]
    pub width: Option<u32>,
    /// Height in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE), help_heading = "Picture")]
    pub height: Option<u32>,
    /// Render this part only, upper bounds not included
    #[arg(
        long,
        value_name = "X0,Y0,X1,Y1",
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    pub crop: Option<Crop>,
    /// Reconstruction filter [default: the scene's]
    #[arg(long, value_name = "NAME", help_heading = "Picture")]
    pub rfilter: Option<RFilter>,
}

/// Longest side of a film: no image format reaches further.
pub const MAX_SIDE: i64 = 1 << 17;

/// Reconstruction filters.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum RFilter {
    /// One pixel, constant
    Box,
    /// Linear falloff over one pixel
    Tent,
    /// Standard deviation 0.5
    Gaussian,
    /// Mitchell and Netravali
    Mitchell,
    /// Catmull and Rom
    Catmullrom,
    /// Windowed sinc of three lobes
    Lanczos,
}
