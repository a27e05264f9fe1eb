//! What the first level of R divides: surfaces by the side that they face, and media from them.
//!
//! Light on the two sides of a thin wall has nothing in common, and neither has light in a fog and
//! on the wall beside it. A record inside of a medium has no normal: it carries zero.

use super::settings::Settings;
use crate::math::Vec3;

/// What tells cells of the first level apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sides {
    /// Nothing: that level divides space.
    Together,
    /// The octant of the normal.
    Octants,
    /// The axis direction nearest to the normal, six cells; media are the seventh, and the eighth
    /// is empty.
    FacesAndMedia,
}

/// The cell of media under [`Sides::FacesAndMedia`].
pub(crate) const MEDIA: u64 = 6;

impl Sides {
    pub fn of(settings: &Settings) -> Self {
        match (settings.normal_split, settings.media) {
            (false, _) => Self::Together,
            (true, false) => Self::Octants,
            (true, true) => Self::FacesAndMedia,
        }
    }

    /// Levels of R that they take.
    pub fn levels(self) -> u8 {
        u8::from(self != Self::Together)
    }

    /// The cell of a unit normal, or of zero inside of a medium.
    #[inline]
    pub fn cell(self, normal: Vec3) -> u64 {
        match self {
            Self::Together => 0,
            Self::Octants => normal_octant(normal),
            Self::FacesAndMedia if normal == Vec3::ZERO => MEDIA,
            Self::FacesAndMedia => face(normal),
        }
    }

    /// The unit vector in the middle of a cell; z where normals are not told apart.
    pub fn middle(self, cell: u64) -> Vec3 {
        match self {
            Self::Octants => octant_middle(cell),
            Self::FacesAndMedia if cell < MEDIA => {
                let axis = Vec3::AXES[(cell / 2) as usize];
                if cell % 2 == 0 { axis } else { -axis }
            }
            Self::Together | Self::FacesAndMedia => Vec3::Z,
        }
    }
}

/// Twice the axis that the normal is nearest to, one more where it points down that axis.
#[inline]
fn face(n: Vec3) -> u64 {
    let size = n.abs();
    let axis = match (size.x >= size.y, size.x.max(size.y) >= size.z) {
        (_, false) => 2,
        (true, true) => 0,
        (false, true) => 1,
    };
    2 * axis as u64 + u64::from(n[axis] < 0.0)
}

/// Octants of a turned frame in which the six axis directions lie inside octants, 19 degrees or
/// more from a boundary: walls along the axes would otherwise flip by rounding.
#[inline]
pub(crate) fn normal_octant(n: Vec3) -> u64 {
    let below = |axis: usize| u64::from(OCTANT_AXES[axis].dot(n) < 0.0) << axis;
    below(0) | below(1) | below(2)
}

/// The frame's axes, three units long.
const OCTANT_AXES: [Vec3; 3] = [
    Vec3::new(2.0, 1.0, -2.0),
    Vec3::new(2.0, -2.0, 1.0),
    Vec3::new(1.0, 2.0, 2.0),
];

/// The unit vector in the middle of an octant of normals.
fn octant_middle(octant: u64) -> Vec3 {
    let signed = |i: usize| {
        if octant >> i & 1 == 0 {
            OCTANT_AXES[i]
        } else {
            -OCTANT_AXES[i]
        }
    };
    (signed(0) + signed(1) + signed(2)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_holds_its_middle_and_media_are_apart() {
        for sides in [Sides::Octants, Sides::FacesAndMedia] {
            let cells = if sides == Sides::Octants { 8 } else { MEDIA };
            for cell in 0..cells {
                assert_eq!(sides.cell(sides.middle(cell)), cell, "{sides:?}");
            }
        }
        assert_eq!(Sides::FacesAndMedia.cell(Vec3::ZERO), MEDIA);
        assert_eq!(Sides::Together.cell(Vec3::X), 0);
    }
}
