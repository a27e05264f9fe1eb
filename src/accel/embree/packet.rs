//! Rays by sixteens: from our rays to Embree's packets and back.
//!
//! Every batch is traced by the 16-wide call, the last packet with lanes switched off.

use super::geometry::Numbers;
use super::sys::*;
use crate::accel::{Hit, Ray};

/// Rays in a packet.
pub const WIDTH: usize = 16;

/// Whether a ray can be traced at all: finite, and with a range that is not empty.
///
/// `x * 0` is 0 for every finite `x` and NaN otherwise; a NaN bound fails the comparison.
#[inline]
pub fn is_traceable(ray: &Ray) -> bool {
    let sum = ray.org * 0.0 + ray.dir * 0.0;
    (sum.x + sum.y + sum.z == 0.0) & (ray.tmin <= ray.tmax) & (ray.tmax >= 0.0)
}

/// A packet whose unused fields are set, once for a batch.
pub fn new_rays() -> RTCRay16 {
    RTCRay16 {
        org_x: [0.0; WIDTH],
        org_y: [0.0; WIDTH],
        org_z: [0.0; WIDTH],
        tnear: [0.0; WIDTH],
        dir_x: [0.0; WIDTH],
        dir_y: [0.0; WIDTH],
        dir_z: [0.0; WIDTH],
        time: [0.0; WIDTH],
        tfar: [0.0; WIDTH],
        mask: [u32::MAX; WIDTH],
        id: std::array::from_fn(|lane| lane as u32),
        flags: [0; WIDTH],
    }
}

/// Room for a packet's hits.
pub fn new_hits() -> RTCHit16 {
    RTCHit16 {
        Ng_x: [0.0; WIDTH],
        Ng_y: [0.0; WIDTH],
        Ng_z: [0.0; WIDTH],
        u: [0.0; WIDTH],
        v: [0.0; WIDTH],
        primID: [0; WIDTH],
        geomID: [INVALID_ID; WIDTH],
        instID: [[INVALID_ID; WIDTH]],
        #[cfg(embree4)]
        instPrimID: [[INVALID_ID; WIDTH]],
    }
}

/// Spreads up to 16 rays over the lanes.
#[inline]
pub fn load(rays: &[Ray], packet: &mut RTCRay16, valid: &mut Lanes) {
    if rays.len() < WIDTH {
        valid.0 = [0; WIDTH];
    }
    for (lane, ray) in rays.iter().take(WIDTH).enumerate() {
        packet.org_x[lane] = ray.org.x;
        packet.org_y[lane] = ray.org.y;
        packet.org_z[lane] = ray.org.z;
        packet.tnear[lane] = ray.tmin.max(0.0);
        packet.dir_x[lane] = ray.dir.x;
        packet.dir_y[lane] = ray.dir.y;
        packet.dir_z[lane] = ray.dir.z;
        packet.tfar[lane] = ray.tmax;
        valid.0[lane] = -i32::from(is_traceable(ray));
    }
}

/// Gathers the hits from the lanes.
#[inline]
pub fn store(packet: &RTCRayHit16, numbers: &Numbers, hits: &mut [Hit]) {
    let (ray, hit) = (&packet.ray, &packet.hit);
    for (lane, out) in hits.iter_mut().take(WIDTH).enumerate() {
        *out = numbers.hit(
            ray.tfar[lane],
            (hit.u[lane], hit.v[lane]),
            hit.primID[lane],
            hit.geomID[lane],
            hit.instID[0][lane],
        );
    }
}
