//! A(r): how much surface and how much medium lies in a cell of R.
//!
//! A surface counts by its area, a medium by its extinction cross-section, the integral of
//! sigma_t over its volume, which is an area, too: photons of flux F per area collide in a piece
//! of medium at the rate of F times its cross-section, as they land on a surface at the rate of F
//! times its area. So the flux over A(r) means the same in both, and is the fluence in media.

use std::ops::Range;

/// Points that stand for surface and medium.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Measure {
    /// Keys of points spread uniformly over the surfaces, then of points spread through the media
    /// as sigma_t is; sorted, so that any cell's points are one range.
    pub keys: Vec<u64>,
    /// How many of them lie on surfaces.
    pub on_surfaces: usize,
    /// The surface area that those together stand for.
    pub area: f64,
    /// The cross-section that the others stand for.
    pub cross_section: f64,
}

impl Measure {
    /// Keeps these points (sorted keys) in the place of those before on surfaces.
    pub fn set_surfaces(&mut self, keys: Vec<u64>, area: f64) {
        self.keys.splice(..self.on_surfaces, keys.iter().copied());
        self.on_surfaces = keys.len();
        self.area = positive(area);
    }

    /// The same for those inside of media.
    pub fn set_media(&mut self, keys: Vec<u64>, cross_section: f64) {
        self.keys.truncate(self.on_surfaces);
        self.keys.extend(keys);
        self.cross_section = positive(cross_section);
    }

    /// What a range of the points stands for.
    pub fn of(&self, range: Range<usize>) -> f64 {
        let middle = self.on_surfaces.clamp(range.start, range.end);
        self.part(middle - range.start, false) + self.part(range.end - middle, true)
    }

    /// The same for a node that holds them, at least half a point: light was met there, so
    /// something is, a medium or else a surface.
    pub fn at_least_half(&self, range: Range<usize>, in_media: bool) -> f64 {
        if !range.is_empty() {
            return self.of(range);
        }
        let in_media = in_media && self.on_surfaces < self.keys.len();
        0.5 * self.part(1, in_media)
    }

    /// What so many points of a kind stand for.
    fn part(&self, count: usize, in_media: bool) -> f64 {
        let (all, total) = match in_media {
            false => (self.on_surfaces, self.area),
            true => (self.keys.len() - self.on_surfaces, self.cross_section),
        };
        match count {
            0 => 0.0,
            count => count as f64 / all.max(1) as f64 * total,
        }
    }
}

/// A total that means something.
fn positive(total: f64) -> f64 {
    match total > 0.0 && total.is_finite() {
        true => total,
        false => 1.0,
    }
}
