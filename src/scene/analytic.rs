//! Points of exact shapes.

use super::transform::{normal_to_world, transform_error};
use crate::accel::{AnalyticKind, AnalyticShape, Hit};
use crate::math::{Frame, Vec2, Vec3};
use crate::texture::SurfacePoint;
use std::f32::consts::{PI, TAU};

/// Unit-space position, normal and tangents of an exact shape at a hit, with the position pulled
/// onto the shape.
struct UnitPoint {
    p: Vec3,
    n: Vec3,
    dp_du: Vec3,
    dp_dv: Vec3,
}

fn unit_point(kind: AnalyticKind, q: Vec3) -> UnitPoint {
    match kind {
        AnalyticKind::Sphere => {
            let p = q.normalize_or(Vec3::Z);
            let r = p.truncate().length();
            let (cos, sin) = if r > 0.0 {
                (p.x / r, p.y / r)
            } else {
                (1.0, 0.0)
            };
            UnitPoint {
                p,
                n: p,
                dp_du: Vec3::new(-p.y, p.x, 0.0) * TAU,
                dp_dv: Vec3::new(p.z * cos, p.z * sin, -r) * PI,
            }
        }
        AnalyticKind::Disk => {
            let p = Vec3::new(q.x, q.y, 0.0);
            let r = p.length();
            let out = if r > 0.0 { p / r } else { Vec3::X };
            UnitPoint {
                p,
                n: Vec3::Z,
                dp_du: out,
                dp_dv: Vec3::new(-p.y, p.x, 0.0) * TAU,
            }
        }
        AnalyticKind::Cylinder => {
            let out = Vec3::new(q.x, q.y, 0.0).normalize_or(Vec3::X);
            UnitPoint {
                p: Vec3::new(out.x, out.y, q.z),
                n: out,
                dp_du: Vec3::new(-out.y, out.x, 0.0) * TAU,
                dp_dv: Vec3::Z,
            }
        }
        AnalyticKind::Rectangle => UnitPoint {
            p: Vec3::new(q.x, q.y, 0.0),
            n: Vec3::Z,
            dp_du: Vec3::X * 2.0,
            dp_dv: Vec3::Y * 2.0,
        },
    }
}

/// The point where a ray met an exact shape at the world position `met`. The second fundamental
/// form of the unit sphere is the identity: its normal changes as the position does. A cylinder's
/// does so along u alone, and the normals of flat shapes do not change.
pub(super) fn exact_point<'a>(
    shape: &AnalyticShape,
    flip: bool,
    met: Vec3,
    hit: &Hit,
) -> SurfacePoint<'a> {
    let unit = unit_point(shape.kind, shape.to_object.transform_point3(met));
    let sign = if flip { -1.0 } else { 1.0 };
    let p = shape.to_world.transform_point3(unit.p);
    let ng = normal_to_world(&shape.to_object, unit.n) * sign;
    let dp_du = shape.to_world.transform_vector3(unit.dp_du);
    let dp_dv = shape.to_world.transform_vector3(unit.dp_dv);
    let (dn_du, dn_dv) = match shape.kind {
        AnalyticKind::Sphere | AnalyticKind::Cylinder => {
            let radius = dp_du.length().max(1e-30) / unit.dp_du.length().max(1e-30);
            let along = if shape.kind == AnalyticKind::Sphere {
                dp_dv
            } else {
                Vec3::ZERO
            };
            (dp_du * (sign / radius), along * (sign / radius))
        }
        AnalyticKind::Disk | AnalyticKind::Rectangle => (Vec3::ZERO, Vec3::ZERO),
    };
    SurfacePoint {
        p,
        error: transform_error(&shape.to_world, unit.p),
        ng,
        frame: Frame::with_tangent(ng, dp_du),
        dp_du,
        dp_dv,
        dn_du,
        dn_dv,
        uv: Vec2::new(hit.u, hit.v),
        footprint: 0.0,
        prim: 0,
        vertices: [0; 3],
        barycentric: Vec2::ZERO,
        attributes: None,
    }
}
