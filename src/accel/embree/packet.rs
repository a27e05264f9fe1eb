//! Rays by sixteens: from our rays to Embree's packets and back.
//!
//! Every batch is traced by the 16-wide call, the last packet with lanes that stand aside.

use super::numbers::Numbers;
use super::sys::*;
use crate::accel::{Hit, Ray};
use crate::math::Vec3;

/// Rays in a packet.
pub const WIDTH: usize = 16;

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

/// Stands in for a ray that cannot be traced, and on the lanes behind the last ray: its range is
/// empty.
///
/// Switching a lane off is not enough. Where a processor has no 16-wide registers, Embree 3 splits
/// the packet without a look at the switches and leaves out only rays with an empty range; and
/// Debian's library aborts the program when it meets a ray that is not finite.
const NOTHING: Ray = Ray {
    org: Vec3::ZERO,
    tmin: 1.0,
    dir: Vec3::Z,
    tmax: 0.0,
};

/// Spreads up to 16 rays over the lanes.
#[inline]
pub fn load(rays: &[Ray], overflow: f32, packet: &mut RTCRay16, valid: &mut Lanes) {
    for (lane, ray) in rays.iter().take(WIDTH).enumerate() {
        let traceable = ray.is_traceable_within(overflow);
        valid.0[lane] = -i32::from(traceable);
        load_lane(if traceable { ray } else { &NOTHING }, lane, packet);
    }
    for lane in rays.len()..WIDTH {
        valid.0[lane] = 0;
        load_lane(&NOTHING, lane, packet);
    }
}

#[inline(always)]
fn load_lane(ray: &Ray, lane: usize, packet: &mut RTCRay16) {
    packet.org_x[lane] = ray.org.x;
    packet.org_y[lane] = ray.org.y;
    packet.org_z[lane] = ray.org.z;
    packet.tnear[lane] = ray.tmin.max(0.0);
    packet.dir_x[lane] = ray.dir.x;
    packet.dir_y[lane] = ray.dir.y;
    packet.dir_z[lane] = ray.dir.z;
    packet.tfar[lane] = ray.tmax;
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
