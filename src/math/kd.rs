//! Planes of k-d trees.

use glam::Vec3;

/// A plane that divides points, across an axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct KdPlane {
    /// The axis.
    pub axis: u32,
    /// Where on it.
    pub at: f32,
}

impl KdPlane {
    /// Divides points across the longest side of their bounds: brings those with the smallest
    /// coordinates, `middle` of them, before the others. Which of two points with the same
    /// coordinate comes first is said by the number beside the position.
    pub fn divide<T>(points: &mut [T], middle: usize, key: impl Fn(&T) -> (Vec3, u32)) -> Self {
        let (low, high) = points
            .iter()
            .map(|p| key(p).0)
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let axis = (high - low).max_position();
        if middle >= points.len() {
            return Self {
                axis: axis as u32,
                at: 0.0,
            };
        }
        let (_, first, _) = points.select_nth_unstable_by(middle, |a, b| {
            let ((a, i), (b, j)) = (key(a), key(b));
            a[axis].total_cmp(&b[axis]).then(i.cmp(&j))
        });
        Self {
            axis: axis as u32,
            at: key(first).0[axis],
        }
    }

    /// How far a point is beyond the plane; negative on the side of small coordinates.
    #[inline]
    pub fn beyond(&self, p: Vec3) -> f32 {
        p[self.axis as usize] - self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_divided_across_their_longest_side() {
        let mut points: Vec<(u32, Vec3)> = (0..100)
            .map(|i| {
                (
                    i,
                    Vec3::new(0.3, (i * 37 % 50) as f32, 1.0 - i as f32 * 0.1),
                )
            })
            .collect();
        let plane = KdPlane::divide(&mut points, 33, |p| (p.1, p.0));
        assert_eq!(plane.axis, 1);
        let (low, high) = points.split_at(33);
        assert!(low.iter().all(|p| plane.beyond(p.1) <= 0.0));
        assert!(high.iter().all(|p| plane.beyond(p.1) >= 0.0));
        // Sixteen pairs, and the first of the next one.
        let pair: Vec<u32> = points
            .iter()
            .filter(|p| p.1.y == 16.0)
            .map(|p| p.0)
            .collect();
        assert_eq!(
            pair.iter().min(),
            low.iter().filter(|p| p.1.y == 16.0).map(|p| &p.0).next()
        );
        assert_eq!(KdPlane::divide(&mut points[..1], 1, |p| (p.1, p.0)).at, 0.0);
    }
}
