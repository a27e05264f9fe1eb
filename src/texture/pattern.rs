//! Patterns computed from texture coordinates: squares and lines.

use super::{SurfacePoint, Texture, UvTransform};
use crate::math::{Rgb, Vec2};

/// Two values in squares.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    /// Value of the square at the origin.
    pub color0: Texture,
    /// Value of its neighbours.
    pub color1: Texture,
    /// Placement; a unit of the placed coordinates holds two squares a side.
    pub to_uv: UvTransform,
    /// Where one number is asked for, the two values change places: Mitsuba 3's `eval_1` does so,
    /// and its scenes are made by what they look like there.
    pub swaps_numbers: bool,
}

/// Lines of one value on another (Mitsuba 0.x `gridtexture`).
#[derive(Clone, Debug)]
pub struct Grid {
    /// Background.
    pub color0: Rgb,
    /// Lines.
    pub color1: Rgb,
    /// Half the width of the lines in texture units.
    pub line_width: f32,
    /// Placement.
    pub to_uv: UvTransform,
}

impl Checkerboard {
    /// Whether the texture coordinates lie in a square like that at the origin.
    #[inline]
    fn is_first(&self, uv: Vec2) -> bool {
        let uv = self.to_uv.0.transform_point2(uv);
        let inside = uv - uv.floor();
        (inside.x > 0.5) == (inside.y > 0.5)
    }

    /// The value at a point.
    pub fn eval(&self, point: &SurfacePoint) -> Rgb {
        if self.is_first(point.uv) {
            self.color0.eval(point)
        } else {
            self.color1.eval(point)
        }
    }

    /// The value at a point as one number.
    pub fn eval_scalar(&self, point: &SurfacePoint) -> f32 {
        if self.is_first(point.uv) != self.swaps_numbers {
            self.color0.eval_scalar(point)
        } else {
            self.color1.eval_scalar(point)
        }
    }
}

impl Grid {
    /// The value at texture coordinates.
    pub fn eval(&self, uv: Vec2) -> Rgb {
        let uv = self.to_uv.0.transform_point2(uv);
        let distance = (uv - uv.round()).abs();
        if distance.min_element() < self.line_width {
            self.color1
        } else {
            self.color0
        }
    }

    /// Share of the surface that the lines cover.
    pub fn line_share(&self) -> f32 {
        let free = (1.0 - 2.0 * self.line_width).clamp(0.0, 1.0);
        1.0 - free * free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(x: f32) -> Texture {
        Texture::Constant(Rgb::splat(x))
    }

    #[test]
    fn squares_alternate_on_both_sides_of_the_origin() {
        let board = Checkerboard {
            color0: constant(0.0),
            color1: constant(1.0),
            to_uv: UvTransform(glam::Affine2::IDENTITY),
            swaps_numbers: false,
        };
        let swapping = Checkerboard {
            swaps_numbers: true,
            ..board.clone()
        };
        for (x, y) in [(-3, 2), (0, 0), (1, 0), (5, -4), (-1, -1)] {
            let uv = Vec2::new(x as f32 * 0.5 + 0.25, y as f32 * 0.5 + 0.25);
            let point = SurfacePoint::at_uv(uv);
            let expected = ((x + y) & 1) as f32;
            assert_eq!(board.eval(&point).x, expected, "{x} {y}");
            assert_eq!(board.eval_scalar(&point), expected, "{x} {y}");
            assert_eq!(swapping.eval(&point).x, expected, "{x} {y}");
            assert_eq!(swapping.eval_scalar(&point), 1.0 - expected, "{x} {y}");
        }
    }

    #[test]
    fn lines_cover_their_share() {
        let grid = Grid {
            color0: Rgb::ZERO,
            color1: Rgb::ONE,
            line_width: 0.05,
            to_uv: UvTransform(glam::Affine2::from_scale(Vec2::splat(3.0))),
        };
        let n = 1000;
        let at = |i: i32| (i % n) as f32 / n as f32 + 0.0003;
        let sum: f32 = (0..n * n)
            .map(|i| grid.eval(Vec2::new(at(i), at(i / n))).x)
            .sum();
        let share = sum / (n * n) as f32;
        assert!(
            (share - grid.line_share()).abs() < 0.005,
            "{share} {}",
            grid.line_share()
        );
    }
}
