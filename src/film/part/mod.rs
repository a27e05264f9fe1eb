//! The exact state of a film as a file: a *part*.
//!
//! A part holds some or all tiles of a film with every sum to the last bit, the samples that each
//! tile has taken, and what the pixels were made of (the scene, the settings, the program). It
//! serves twice: as a shard of an image, which `twintree merge` joins with the others, and as a
//! checkpoint, from which a render goes on as if it had never been interrupted.
//!
//! The file is an OpenEXR file of two layers or more, so that any EXR tool can list and dump it, though it
//! is no picture. Numbers of 64 bits, whether `f64` or `u64`, are two channels of whole numbers,
//! `name.high` and `name.low`.
//!
//! | layer | a row is | a column is | channels |
//! |---|---|---|---|
//! | `tiles` | a tile | there is one | its number on the film, samples done, samples dropped, a checksum |
//! | `extras` | the same tile | a pixel of it, row by row; small tiles end early | the further sums of [`Extras`], if there are any |
//! | `shapes` | a tile's share of a list | an entry of it; a tile begins in a row of its own | which shapes its pixels see, if anybody asks |
//! | `pixels` | the same tile | a pixel of it, row by row; small tiles end early | the sums of [`Pixel`](super::Pixel) |
//!
//! The attribute `twintree:part` carries a [`Record`] as JSON. The checksum of a tile covers the
//! record, the tile's row and its pixels, so that a part that was changed by a hand or a disk is
//! found out. Rows are written and read a block at a time: the film is never held twice.

mod content;
mod kinds;
mod numbers;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::PartReader;
pub use write::{Packing, write};

use super::{Extras, Shard};
use serde::{Deserialize, Serialize};

/// Version of the file's layout. Another one is refused.
const LAYOUT: u32 = 6;
/// Name of the attribute with the record.
const ATTRIBUTE: &str = "twintree:part";

/// What shaped the pixels: parts of different identities are parts of different images.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Fingerprint of the scene.
    pub scene: u64,
    /// Fingerprint of the learned field, where one was read from a file instead of being learned.
    pub field: Option<u64>,
    /// Every setting that shapes the pixels, by name, the program's version among them. What does
    /// not shape them (threads, names of files) is not here.
    pub settings: Vec<(String, String)>,
}

/// What is known about how a part came to be; nothing of it shapes the pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The scene file.
    pub scene: String,
    /// The command line.
    pub words: String,
    /// The ray tracer, with its version.
    pub accel: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Brightness of 8-bit formats, as a power of two.
    pub exposure: f32,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Threads that rendered.
    pub threads: usize,
    /// Seconds of rendering so far.
    pub seconds: f64,
    /// Rays traced so far.
    pub rays: u64,
}

/// Everything about a part that is not a pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// What shaped the pixels.
    pub identity: Identity,
    /// The rendered region on the full film: x0, y0, x1, y1.
    pub region: [u32; 4],
    /// Width and height of the full film; parts of older programs do not tell.
    #[serde(default)]
    pub frame: Option<[u32; 2]>,
    /// Samples a pixel that were asked for; `None` where time or noise ends the render.
    pub goal: Option<u64>,
    /// The share of the film that was asked for.
    pub shard: Shard,
    /// What its pixels carry besides.
    #[serde(default)]
    pub extras: Extras,
    /// How it came to be.
    pub origin: Origin,
}

impl Identity {
    /// How `other` differs from this, one phrase a difference; `here` and `there` are what the two
    /// are called. Empty where they are the same.
    pub fn differences(&self, here: &str, other: &Identity, there: &str) -> Vec<String> {
        let mut list = Vec::new();
        if self.scene != other.scene {
            list.push("the scenes differ".to_owned());
        }
        if self.field != other.field {
            list.push("the fields that guide differ".to_owned());
        }
        let value = |of: &Identity, name: &str| {
            let found = of.settings.iter().find(|(n, _)| n == name);
            found.map(|(_, value)| value.clone())
        };
        let mut names: Vec<&String> = self.settings.iter().map(|(n, _)| n).collect();
        names.extend(other.settings.iter().map(|(n, _)| n));
        let mut seen: Vec<&String> = Vec::new();
        for name in names {
            let (ours, theirs) = (value(self, name), value(other, name));
            if ours == theirs || seen.contains(&name) {
                continue;
            }
            seen.push(name);
            let word = |v: Option<String>| v.unwrap_or_else(|| "not set".into());
            list.push(format!(
                "{name} is {} {here} and {} {there}",
                word(ours),
                word(theirs)
            ));
        }
        list
    }
}
