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
    /// Which of the two textures covers the texture coordinates.
    #[inline]
    pub fn at(&self, uv: Vec2) -> &Texture {
        let uv = self.to_uv.0.transform_point2(uv);
        let inside = uv - uv.floor();
        if (inside.x > 0.5) == (inside.y > 0.5) {
            &self.color0
        } else {
            &self.color1
        }
    }

    /// The value at a point.
    pub fn eval(&self, point: &SurfacePoint) -> Rgb {
        self.at(point.uv).eval(point)
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
        };
        for (x, y) in [(-3, 2), (0, 0), (1, 0), (5, -4), (-1, -1)] {
            let uv = Vec2::new(x as f32 * 0.5 + 0.25, y as f32 * 0.5 + 0.25);
            let expected = ((x + y) & 1) as f32;
            assert_eq!(board.eval(&SurfacePoint::at_uv(uv)).x, expected, "{x} {y}");
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
