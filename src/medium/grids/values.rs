//! Whether the values of a grid can be densities.

use std::fmt;

/// What is wrong with a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// NaN or infinite.
    NotFinite,
    /// Below 0.
    Negative,
}

/// Values that are no densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadValues {
    /// What is wrong with the first.
    pub fault: Fault,
    /// How many have that fault.
    pub count: usize,
    /// The voxel of the first (x, y, z), counted from 0.
    pub voxel: [usize; 3],
    /// Its channel, counted from 0.
    pub channel: usize,
    /// What it is.
    pub value: f32,
}

impl fmt::Display for BadValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fault = match self.fault {
            Fault::NotFinite => "not finite",
            Fault::Negative => "negative",
        };
        let [x, y, z] = self.voxel;
        write!(
            f,
            "{} values are {fault}, the first is {} in channel {} of voxel ({x}, {y}, {z}), \
             counted from 0",
            self.count, self.value, self.channel
        )
    }
}

/// What is wrong with `value`, if anything.
fn fault(value: f32) -> Option<Fault> {
    if !value.is_finite() {
        Some(Fault::NotFinite)
    } else if value < 0.0 {
        Some(Fault::Negative)
    } else {
        None
    }
}

/// Checks that all `values` are finite and not negative.
///
/// `resolution` and `channels` only say where the first bad one lies; neither is 0.
pub(super) fn check(values: &[f32], resolution: [u32; 3], channels: u32) -> Result<(), BadValues> {
    let Some(first) = values.iter().position(|&v| fault(v).is_some()) else {
        return Ok(());
    };
    let kind = fault(values[first]);
    let [width, height, _] = resolution.map(|n| n as usize);
    let voxel = first / channels as usize;
    Err(BadValues {
        fault: kind.unwrap_or(Fault::NotFinite),
        count: values.iter().filter(|&&v| fault(v) == kind).count(),
        voxel: [
            voxel % width,
            voxel / width % height,
            voxel / width / height,
        ],
        channel: first % channels as usize,
        value: values[first],
    })
}

/// How many values a grid has; `None` where that overflows.
pub(super) fn count(resolution: [u32; 3], channels: u32) -> Option<usize> {
    let sizes = resolution.into_iter().chain([channels]);
    sizes
        .map(|n| n as usize)
        .try_fold(1usize, usize::checked_mul)
}
