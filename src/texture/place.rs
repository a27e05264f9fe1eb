//! From texture coordinates to texels: wrapping, the four neighbours, the mip level.

use super::Wrap;

/// A coordinate brought into `[0, 1]` by the wrap mode. What is not a number counts as 0.
#[inline(always)]
fn wrapped(u: f32, wrap: Wrap) -> f32 {
    if !u.is_finite() {
        return 0.0;
    }
    match wrap {
        Wrap::Repeat => u - u.floor(),
        Wrap::Clamp => u.clamp(0.0, 1.0),
        Wrap::Mirror => {
            let t = u - 2.0 * (u * 0.5).floor();
            if t > 1.0 { 2.0 - t } else { t }
        }
    }
}

/// Whether the image runs forwards or backwards at a coordinate: 1 or -1.
pub(super) fn direction(u: f32, wrap: Wrap) -> f32 {
    let backwards = wrap == Wrap::Mirror && u - 2.0 * (u * 0.5).floor() > 1.0;
    if backwards { -1.0 } else { 1.0 }
}

/// The texel that a coordinate falls into.
#[inline(always)]
pub(super) fn nearest(u: f32, size: u32, wrap: Wrap) -> u32 {
    ((wrapped(u, wrap) * size as f32) as u32).min(size - 1)
}

/// The two texels whose centres enclose a coordinate, and the second's weight.
#[inline(always)]
pub(super) fn neighbours(u: f32, size: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let s = wrapped(u, wrap) * size as f32 - 0.5;
    let floor = s.floor();
    let weight = s - floor;
    let last = size as i32 - 1;
    let i = (floor as i32).clamp(-1, last);
    let (lo, hi) = match wrap {
        Wrap::Repeat => (
            if i < 0 { last } else { i },
            if i >= last { 0 } else { i + 1 },
        ),
        // A mirror's neighbour across the edge is the edge itself.
        Wrap::Mirror | Wrap::Clamp => (i.max(0), (i + 1).min(last)),
    };
    ([lo as u32, hi as u32], weight)
}

/// The level whose texels are no wider than half of what a sample sees, for `squared`, the square
/// of that width in texels of the finest level.
///
/// Half of it and not all: samples lie close together inside a pixel and average what aliasing is
/// left, while an over-wide texel would blur for good. The exponent of a float is the floor of its
/// logarithm.
#[inline(always)]
pub(super) fn level(squared: f32, count: usize) -> usize {
    if !(squared >= 16.0 && squared.is_finite()) {
        return 0;
    }
    let log2 = (squared.to_bits() >> 23) as usize - 127;
    (log2 / 2 - 1).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wraps_are_what_they_say() {
        for i in -40..40 {
            let u = i as f32 * 0.1 + 0.05;
            let whole = u.floor();
            let repeat = u - whole;
            let mirror = if whole.rem_euclid(2.0) == 0.0 {
                repeat
            } else {
                1.0 - repeat
            };
            assert!((wrapped(u, Wrap::Repeat) - repeat).abs() < 1e-6);
            assert!((wrapped(u, Wrap::Mirror) - mirror).abs() < 1e-6, "{u}");
            assert_eq!(wrapped(u, Wrap::Clamp), u.clamp(0.0, 1.0));
        }
    }

    #[test]
    fn indices_stay_inside_whatever_the_coordinate() {
        let odd = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            -0.0,
        ];
        let near = [-1e-9, 1e-9, 1.0, 0.999_999_94, -1.0, 1e7, 16_777_217.0, 0.5];
        for u in odd.into_iter().chain(near) {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for size in [1, 2, 3, 1000] {
                    let ([a, b], w) = neighbours(u, size, wrap);
                    assert!(
                        a < size && b < size && (0.0..=1.0).contains(&w),
                        "{u} {size}"
                    );
                    assert!(nearest(u, size, wrap) < size);
                }
            }
        }
    }

    #[test]
    fn levels_follow_the_width() {
        for (texels, expected) in [(0.0, 0), (1.0, 0), (3.9, 0), (4.0, 1), (7.9, 1), (8.0, 2)] {
            assert_eq!(level(texels * texels, 10), expected, "{texels}");
        }
        assert_eq!(level(1e30, 10), 9);
        assert_eq!(level(f32::INFINITY, 10), 0);
        assert_eq!(level(f32::NAN, 10), 0);
    }
}
