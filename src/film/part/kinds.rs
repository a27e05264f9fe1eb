//! The layers of a part.

use super::numbers::{HALVES, PIXEL, SHAPE, TILE};
use crate::film::{Extras, TILE_SIZE};

/// What a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// What is known of tiles as wholes.
    Tiles,
    /// Further sums of pixels.
    Extras,
    /// Which shapes pixels see.
    Shapes,
    /// The sums that all pixels have. They come last: with them a tile is complete.
    Pixels,
}

impl Kind {
    /// The layers of a part whose pixels carry these extras, in their order.
    pub fn of_parts(extras: &Extras) -> Vec<Self> {
        let wanted = [
            (true, Self::Tiles),
            (extras.count() > 0, Self::Extras),
            (extras.mattes.is_some(), Self::Shapes),
            (true, Self::Pixels),
        ];
        wanted.iter().filter(|w| w.0).map(|w| w.1).collect()
    }

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tiles => "tiles",
            Self::Extras => "extras",
            Self::Shapes => "shapes",
            Self::Pixels => "pixels",
        }
    }

    /// Columns of a row.
    pub fn width(self) -> usize {
        match self {
            Self::Tiles => 1,
            Self::Extras | Self::Shapes | Self::Pixels => (TILE_SIZE * TILE_SIZE) as usize,
        }
    }

    /// Its channels, two for each number, in the order in which EXR sorts them.
    pub fn channels(self, extras: &Extras) -> Vec<String> {
        let numbers: Vec<String> = match self {
            Self::Tiles => TILE.map(str::to_owned).to_vec(),
            Self::Pixels => PIXEL.map(str::to_owned).to_vec(),
            // Of equal length, which sorts them as numbers.
            Self::Shapes => SHAPE.map(str::to_owned).to_vec(),
            Self::Extras => (0..extras.count()).map(|i| format!("{i:03}")).collect(),
        };
        let halves = |number: &String| HALVES.map(|half| format!("{number}.{half}"));
        numbers.iter().flat_map(halves).collect()
    }
}
