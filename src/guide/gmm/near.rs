//! A k-d tree over points: what is near?

use crate::math::Vec3;
use crate::math::kd::KdPlane;

/// Points of a leaf.
const LEAF: usize = 8;
/// Deepest descent: more levels than 2^32 points can need.
const DEPTH: usize = 32;

/// A balanced k-d tree. Nodes are numbered as in a heap and halve their range of points, so that
/// only the dividing planes are kept.
#[derive(Clone, Debug, Default)]
pub(super) struct KdTree {
    planes: Vec<KdPlane>,
    points: Vec<Vec3>,
    /// Numbers of the points in the order that the tree has brought them to.
    order: Vec<u32>,
}

impl KdTree {
    /// Sorts points, which must be finite.
    pub fn new(points: &[Vec3]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let leaves = points.len().div_ceil(LEAF).next_power_of_two();
        let mut planes = vec![KdPlane::default(); leaves];
        divide(points, &mut order, &mut planes, 1);
        Self {
            planes,
            points: order.iter().map(|&i| points[i as usize]).collect(),
            order,
        }
    }

    /// The points in the tree's order: what a visit's slot means.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Bytes in use.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.planes) + size_of_val(&*self.points) + size_of_val(&*self.order)
    }

    /// Visits points within a squared distance of `bound` from `x`, nearer halves first. `visit` is
    /// given a point's slot and its squared distance and says what the bound is from then on.
    #[inline]
    pub fn visit(&self, x: Vec3, mut bound: f32, mut visit: impl FnMut(usize, f32) -> f32) {
        let mut stack = [(0u32, 0u32, 0u32, 0f32); DEPTH];
        let mut top = 0;
        let (mut node, mut from, mut to) = (1u32, 0u32, self.points.len() as u32);
        loop {
            while (node as usize) < self.planes.len() {
                let away = self.planes[node as usize].beyond(x);
                let middle = from + (to - from) / 2;
                let (near, far) = (
                    2 * node + u32::from(away >= 0.0),
                    2 * node + u32::from(away < 0.0),
                );
                let (low, high) = ((from, middle), (middle, to));
                let (here, there) = if away < 0.0 { (low, high) } else { (high, low) };
                if away * away < bound && top < DEPTH {
                    stack[top] = (far, there.0, there.1, away * away);
                    top += 1;
                }
                (node, from, to) = (near, here.0, here.1);
            }
            for slot in from as usize..to as usize {
                let d = self.points[slot].distance_squared(x);
                if d < bound {
                    bound = visit(slot, d);
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                let (n, f, t, d) = stack[top];
                if d < bound {
                    (node, from, to) = (n, f, t);
                    break;
                }
            }
        }
    }
}

fn divide(points: &[Vec3], order: &mut [u32], planes: &mut [KdPlane], node: usize) {
    if node >= planes.len() {
        return;
    }
    let middle = order.len() / 2;
    planes[node] = KdPlane::divide(order, middle, |&i| (points[i as usize], i));
    let (low, high) = order.split_at_mut(middle);
    divide(points, low, planes, 2 * node);
    divide(points, high, planes, 2 * node + 1);
}
