//! Walks obvhs's compressed eight-wide tree (Ylitie, Karras and Laine, HPG 2017), conservatively.
//!
//! The crate's own walk forgets boxes nearer than 1e-4 and boxes that rounding puts just beside the
//! ray. Here each slab is widened by the rounding error of its own computation, so a triangle that
//! the leaf test would find is never lost above it.

use crate::math::{Vec3, Vec3A};
use obvhs::cwbvh::{CwBvh, node::CwBvhNode};
use smallvec::SmallVec;

/// Components of a direction below this share of its largest count as this share: the reciprocal
/// stays finite, and so does its product with a coordinate. It bends the ray by less than `f32`
/// rounds.
const SMALLEST: f32 = 1e-12;

/// Subtraction, scaling and sum round four times, each by half an epsilon; twice that for safety.
const ERROR: f32 = 4.0 * f32::EPSILON;

/// Steps of a child's box across its parent.
const STEPS: f32 = 255.0;

/// A ray prepared for boxes.
pub struct BoxRay {
    org: Vec3A,
    inverse: Vec3A,
    negative: [bool; 3],
    octant: u32,
    tmin: f32,
}

impl BoxRay {
    /// Prepares a finite ray.
    #[inline]
    pub fn new(org: Vec3, dir: Vec3, tmin: f32) -> Self {
        let smallest = (dir.abs().max_element() * SMALLEST).max(f32::MIN_POSITIVE);
        let inverse = dir.map(|d| 1.0 / d.abs().max(smallest).copysign(d));
        // By the sign bit, as the reciprocal's: a component of -0 is one of the negative ones.
        let negative = dir.to_array().map(f32::is_sign_negative);
        // Child slots are numbered by octant: xor with this visits those that face the ray first.
        let bit = |axis: usize, bit: u32| if negative[axis] { 0 } else { bit };
        Self {
            org: org.into(),
            inverse: inverse.into(),
            negative,
            octant: (bit(0, 4) | bit(1, 2) | bit(2, 1)) * 0x0101_0101,
            tmin,
        }
    }

    /// The children of `node` that the ray meets before `limit`: inner ones in the upper 8 bits,
    /// nearest highest, primitives in the lower 24.
    #[inline(always)]
    fn children(&self, node: &CwBvhNode, limit: f32) -> u32 {
        let step = Vec3A::from_array(node.e.map(|e| f32::from_bits(u32::from(e) << 23)));
        let to_node = Vec3A::from_array(node.p.to_array()) - self.org;
        let scale = step * self.inverse;
        let offset = to_node * self.inverse;
        let error = (to_node.abs() + step * STEPS) * self.inverse.abs() * ERROR;
        let (enter, leave) = (offset - error, offset + error);
        let pick = |axis: usize, min, max| {
            if self.negative[axis] {
                (max, min)
            } else {
                (min, max)
            }
        };
        let slabs: [(&[u8; 8], &[u8; 8]); 3] = [
            pick(0, &node.child_min_x, &node.child_max_x),
            pick(1, &node.child_min_y, &node.child_max_y),
            pick(2, &node.child_min_z, &node.child_max_z),
        ];
        let mut near = [self.tmin; 8];
        let mut far = [limit; 8];
        for (axis, (first, last)) in slabs.into_iter().enumerate() {
            let (scale, enter, leave) = (scale[axis], enter[axis], leave[axis]);
            for child in 0..8 {
                let a = f32::from(first[child]) * scale + enter;
                let b = f32::from(last[child]) * scale + leave;
                near[child] = if a > near[child] { a } else { near[child] };
                far[child] = if b < far[child] { b } else { far[child] };
            }
        }
        let mut met = 0u32;
        for child in 0..8 {
            met |= u32::from(near[child] <= far[child]) << child;
        }
        let (bits, places) = node.get_child_and_index_bits(self.octant);
        let mut mask = 0;
        while met != 0 {
            let shift = 8 * met.trailing_zeros();
            met &= met - 1;
            let (bits, place) = (
                (bits >> shift) as u32 & 0xff,
                (places >> shift) as u32 & 0x1f,
            );
            mask |= bits << place;
        }
        mask
    }
}

/// What to do after a primitive.
pub enum Next {
    /// Go on, with hits no farther than this.
    Within(f32),
    /// The question is answered.
    Stop,
}

/// A group of siblings still to be visited: where they begin, and which (upper 8 bits) among all
/// inner children (lower 8 bits).
#[derive(Clone, Copy)]
struct Siblings {
    base: u32,
    mask: u32,
}

impl Siblings {
    const INNER: u32 = 0xff00_0000;

    fn is_empty(self) -> bool {
        self.mask & Self::INNER == 0
    }

    /// Takes the nearest one out: its node index.
    fn take(&mut self, octant: u32) -> u32 {
        let highest = 31 - self.mask.leading_zeros();
        let all = self.mask;
        self.mask &= !(1 << highest);
        let slot = (highest - 24) ^ (octant & 0xff);
        self.base + (all & !(u32::MAX << slot) & 0xff).count_ones()
    }
}

/// Calls `visit` with the index of every primitive whose box the ray meets within `limit`, roughly
/// nearest first.
#[inline]
pub fn walk(tree: &CwBvh, ray: &BoxRay, limit: f32, mut visit: impl FnMut(u32) -> Next) {
    if tree.nodes.is_empty() {
        return;
    }
    let mut limit = limit;
    // Eight-wide trees are shallow; a deeper one goes to the heap.
    let mut stack: SmallVec<[Siblings; 32]> = SmallVec::new();
    let mut siblings = Siblings {
        base: 0,
        mask: 0x8000_0000,
    };
    loop {
        let index = siblings.take(ray.octant);
        if !siblings.is_empty() {
            stack.push(siblings);
        }
        let node = &tree.nodes[index as usize];
        let met = ray.children(node, limit);
        let mut primitives = met & !Siblings::INNER;
        while primitives != 0 {
            let highest = 31 - primitives.leading_zeros();
            primitives &= !(1 << highest);
            match visit(node.primitive_base_idx + highest) {
                Next::Within(new) => limit = new,
                Next::Stop => return,
            }
        }
        siblings = Siblings {
            base: node.child_base_idx,
            mask: (met & Siblings::INNER) | u32::from(node.imask),
        };
        if siblings.is_empty() {
            let Some(next) = stack.pop() else { return };
            siblings = next;
        }
    }
}
