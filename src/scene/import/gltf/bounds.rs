//! Numbers of the file held to their range: what lies outside becomes the nearest that makes sense,
//! and is told.

use super::Importer;
use crate::math::Rgb;

/// The largest amount of light that is believed: more would not stay finite.
const BRIGHTEST: f32 = 1e20;

impl Importer<'_> {
    /// A number from 0 to 1; `what` names it.
    pub(super) fn fraction(&mut self, what: &str, value: f32) -> f32 {
        self.within(what, value, [0.0, 1.0])
    }

    /// A number of `[least, most]`.
    pub(super) fn within(&mut self, what: &str, value: f32, [least, most]: [f32; 2]) -> f32 {
        let within = value.clamp(least, most);
        if within != value {
            self.warn(format!(
                "{what} is {value}, out of the range of {least} to {most}: {within} instead"
            ));
        }
        within
    }

    /// A colour of parts from 0 to 1.
    pub(super) fn tint(&mut self, what: &str, color: Rgb) -> Rgb {
        let within = color.clamp(Rgb::ZERO, Rgb::ONE);
        if within != color {
            self.warn(format!(
                "{what} is {color}, out of the range of 0 to 1: {within} instead"
            ));
        }
        within
    }

    /// A colour of light: not negative, and finite.
    pub(super) fn light_color(&mut self, what: &str, color: Rgb) -> Rgb {
        let within = color.clamp(Rgb::ZERO, Rgb::splat(BRIGHTEST));
        if within != color {
            self.warn(format!("{what} is {color}: {within} instead"));
        }
        within
    }
}
