//! Rays one by one.

use super::numbers::Numbers;
use super::sys::*;
use crate::accel::{Hit, Ray};

/// Embree's form of a ray.
#[inline]
pub fn ray(ray: &Ray) -> RTCRay {
    RTCRay {
        org_x: ray.org.x,
        org_y: ray.org.y,
        org_z: ray.org.z,
        tnear: ray.tmin.max(0.0),
        dir_x: ray.dir.x,
        dir_y: ray.dir.y,
        dir_z: ray.dir.z,
        time: 0.0,
        tfar: ray.tmax,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

/// The ray with room for its hit.
#[inline]
pub fn with_hit(of: &Ray) -> RTCRayHit {
    RTCRayHit {
        ray: ray(of),
        hit: RTCHit {
            Ng_x: 0.0,
            Ng_y: 0.0,
            Ng_z: 0.0,
            u: 0.0,
            v: 0.0,
            primID: 0,
            geomID: INVALID_ID,
            instID: [INVALID_ID],
            #[cfg(embree4)]
            instPrimID: [INVALID_ID],
        },
    }
}

/// Our form of a hit.
#[inline]
pub fn hit(query: &RTCRayHit, numbers: &Numbers) -> Hit {
    let hit = &query.hit;
    numbers.hit(
        query.ray.tfar,
        (hit.u, hit.v),
        hit.primID,
        hit.geomID,
        hit.instID[0],
    )
}
