//! Orthonormal frames: from world directions to local ones, where the normal is +z, and back.

use glam::Vec3;

/// A right-handed orthonormal basis `(s, t, n)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent, local +x.
    pub s: Vec3,
    /// Bitangent, local +y.
    pub t: Vec3,
    /// Normal, local +z.
    pub n: Vec3,
}

impl Frame {
    /// A frame around the unit vector `n`, without a branch at the poles
    /// (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017).
    #[inline]
    pub fn new(n: Vec3) -> Self {
        let sign = 1f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// A frame around the unit normal `n` whose tangent follows `tangent` as closely as it can.
    /// Falls back to [`Frame::new`] where `tangent` is parallel to `n`, zero or not finite.
    #[inline]
    pub fn with_tangent(n: Vec3, tangent: Vec3) -> Self {
        let s = (tangent - n * n.dot(tangent)).normalize_or_zero();
        if s.length_squared() < 0.5 || !s.is_finite() {
            return Self::new(n);
        }
        Self {
            s,
            t: n.cross(s),
            n,
        }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

/// Whether geometric and shading normal disagree about the side that either direction is on.
#[inline]
pub fn normals_disagree([geometric, shading]: [Vec3; 2], [wi, wo]: [Vec3; 2]) -> bool {
    let disagree = |w: Vec3| geometric.dot(w) * shading.dot(w) <= 0.0;
    disagree(wi) || disagree(wo)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_everywhere() {
        for n in [
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            -Vec3::Z,
            Vec3::new(1e-7, 0.0, -1.0).normalize(),
            Vec3::ONE.normalize(),
        ] {
            let f = Frame::new(n);
            assert!(
                f.s.dot(f.t).abs() < 1e-6 && f.s.dot(n).abs() < 1e-6 && f.t.dot(n).abs() < 1e-6
            );
            assert!((f.s.cross(f.t) - n).length() < 1e-6);
            let v = Vec3::new(0.3, -0.2, 0.9);
            assert!((f.to_world(f.to_local(v)) - v).length() < 1e-6);
        }
    }
}
