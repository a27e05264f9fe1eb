//! Points of surfaces under affine maps: positions with their rounding errors, normals and
//! tangents.

use crate::math::offset::gamma;
use crate::math::{Affine3A, Frame, Vec3};
use crate::texture::SurfacePoint;

/// Safety factor on the rounding error of a hit point, over the bound of the interpolation alone:
/// it covers the tests inside the ray tracer. Guarded by the tests `rays_leave_their_surface`.
pub(super) const ERROR_SAFETY: f32 = 4.0;

/// A normal through the inverse transpose of the map whose inverse is given.
pub(super) fn normal_to_world(to_object: &Affine3A, n: Vec3) -> Vec3 {
    (to_object.matrix3.transpose() * n).normalize_or(Vec3::Z)
}

/// Rounding error of `map.transform_point3(p)` for an exact `p`: three products and three sums on
/// each axis.
pub(super) fn transform_error(map: &Affine3A, p: Vec3) -> Vec3 {
    let m = &map.matrix3;
    let terms = Vec3::from(m.x_axis.abs()) * p.x.abs()
        + Vec3::from(m.y_axis.abs()) * p.y.abs()
        + Vec3::from(m.z_axis.abs()) * p.z.abs()
        + Vec3::from(map.translation.abs());
    terms * (ERROR_SAFETY * gamma(7))
}

/// A point of a group where an instance stands; its frame follows the direction `along`.
pub(super) fn to_world_point<'a>(
    local: SurfacePoint<'a>,
    along: Vec3,
    to_world: &Affine3A,
    to_group: &Affine3A,
) -> SurfacePoint<'a> {
    let m = &to_world.matrix3;
    let carried = Vec3::from(m.x_axis.abs()) * local.error.x
        + Vec3::from(m.y_axis.abs()) * local.error.y
        + Vec3::from(m.z_axis.abs()) * local.error.z;
    let n = normal_to_world(to_group, local.frame.n);
    SurfacePoint {
        p: to_world.transform_point3(local.p),
        error: carried + transform_error(to_world, local.p),
        ng: normal_to_world(to_group, local.ng),
        frame: Frame::with_tangent(n, to_world.transform_vector3(along)),
        dp_du: to_world.transform_vector3(local.dp_du),
        dp_dv: to_world.transform_vector3(local.dp_dv),
        dn_du: (to_group.matrix3.transpose() * local.dn_du),
        dn_dv: (to_group.matrix3.transpose() * local.dn_dv),
        ..local
    }
}
