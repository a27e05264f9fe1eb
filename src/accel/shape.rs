//! Exact shapes: a unit shape and the affine map that places it.

use super::Bounds;
use crate::math::{Affine3A, Vec3};

/// Which unit shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExactKind {
    /// The sphere of radius 1 around the origin; u = longitude / 2 pi from +x, v = polar angle from +z / pi.
    Sphere,
    /// The disk of radius 1 in z = 0, normal +z; u = radius, v = angle / 2 pi from +x.
    Disk,
    /// The open cylinder of radius 1 from z = 0 to z = 1; u = angle / 2 pi, v = z.
    Cylinder,
    /// The square `[-1, 1]^2` in z = 0, normal +z; u = (x + 1) / 2, v = (y + 1) / 2.
    Rectangle,
}

/// A unit shape placed by an affine map.
#[derive(Clone, Copy, Debug)]
pub struct ExactShape {
    /// Which unit shape.
    pub kind: ExactKind,
    /// Unit space to world (or group) space.
    pub to_world: Affine3A,
    /// Its inverse.
    pub to_object: Affine3A,
}

impl ExactShape {
    /// Places a unit shape.
    pub fn new(kind: ExactKind, to_world: Affine3A) -> Self {
        Self {
            kind,
            to_world,
            to_object: to_world.inverse(),
        }
    }

    /// Bounds in world (or group) space, tight for boxes, slightly wide for curved shapes.
    pub fn bounds(&self) -> Bounds {
        let (lo, hi) = match self.kind {
            ExactKind::Sphere => (Vec3::NEG_ONE, Vec3::ONE),
            ExactKind::Disk | ExactKind::Rectangle => {
                (Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0))
            }
            ExactKind::Cylinder => (Vec3::new(-1.0, -1.0, 0.0), Vec3::ONE),
        };
        (0..8).fold(Bounds::EMPTY, |b, i| {
            let corner = Vec3::new(
                if i & 1 == 0 { lo.x } else { hi.x },
                if i & 2 == 0 { lo.y } else { hi.y },
                if i & 4 == 0 { lo.z } else { hi.z },
            );
            b.with(self.to_world.transform_point3(corner))
        })
    }
}
