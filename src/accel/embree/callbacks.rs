//! What Embree calls back for: bounds and intersections of exact shapes, and masked triangles.
//!
//! Packets arrive as structures of arrays whose length `N` is known at run time only. Field `f` of
//! lane `i` is the 32-bit word `f * N + i`, as the inline functions of `rtcore_ray.h` have it.

use super::numbers::Numbers;
use super::sys::*;
use crate::accel::{AnalyticShape, Opacity, mask};
use crate::math::Vec3;
use std::sync::Arc;

/// What the callbacks of one geometry need.
pub struct GeometryData {
    /// Embree's number of the geometry in its scene.
    pub number: u32,
    /// The shape, for exact ones.
    pub exact: Option<AnalyticShape>,
    /// Set for masked geometry.
    pub opacity: Option<Arc<dyn Opacity>>,
    /// Embree's numbers to the caller's.
    pub numbers: Arc<Numbers>,
}

// Word offsets in a packet's ray and in its hit, in the order of `RTCRay` and `RTCHit`.
const ORG: usize = 0;
const TNEAR: usize = 3;
const DIR: usize = 4;
const TFAR: usize = 8;
const ID: usize = 10;
const RAY_WORDS: usize = 12;
const NG: usize = 0;
const U: usize = 3;
const V: usize = 4;
const PRIM: usize = 5;
const GEOMETRY: usize = 6;
const INSTANCE: usize = 7;

// The offsets are those of the header that bindgen read.
const _: () = {
    assert!(std::mem::size_of::<RTCRay>() == 4 * RAY_WORDS);
    assert!(std::mem::offset_of!(RTCRay, tnear) == 4 * TNEAR);
    assert!(std::mem::offset_of!(RTCRay, dir_x) == 4 * DIR);
    assert!(std::mem::offset_of!(RTCRay, tfar) == 4 * TFAR);
    assert!(std::mem::offset_of!(RTCRay, id) == 4 * ID);
    assert!(std::mem::offset_of!(RTCHit, u) == 4 * U);
    assert!(std::mem::offset_of!(RTCHit, v) == 4 * V);
    assert!(std::mem::offset_of!(RTCHit, primID) == 4 * PRIM);
    assert!(std::mem::offset_of!(RTCHit, geomID) == 4 * GEOMETRY);
    assert!(std::mem::offset_of!(RTCHit, instID) == 4 * INSTANCE);
};

/// One lane of a packet's rays or hits.
#[derive(Clone, Copy)]
struct Lane {
    base: *mut f32,
    width: usize,
    lane: usize,
}

impl Lane {
    /// # Safety
    /// The packet is live and `field` exists in it.
    unsafe fn float(self, field: usize) -> f32 {
        // SAFETY: the caller's promise.
        unsafe { *self.base.add(field * self.width + self.lane) }
    }

    /// # Safety
    /// As [`Lane::float`].
    unsafe fn word(self, field: usize) -> u32 {
        // SAFETY: the caller's promise.
        unsafe { self.float(field) }.to_bits()
    }

    /// # Safety
    /// As [`Lane::float`], and nobody else refers to the field.
    unsafe fn set(self, field: usize, value: f32) {
        // SAFETY: the caller's promise.
        unsafe { *self.base.add(field * self.width + self.lane) = value }
    }

    /// # Safety
    /// As [`Lane::float`].
    unsafe fn vector(self, field: usize) -> Vec3 {
        // SAFETY: the caller's promise.
        unsafe {
            Vec3::new(
                self.float(field),
                self.float(field + 1),
                self.float(field + 2),
            )
        }
    }
}

/// Bounds of an exact shape.
pub unsafe extern "C" fn bounds(args: *const RTCBoundsFunctionArguments) {
    // SAFETY: Embree's arguments, and the user data set in `geometry.rs`.
    let (data, out) = unsafe {
        (
            &*(*args).geometryUserPtr.cast::<GeometryData>(),
            &mut *(*args).bounds_o,
        )
    };
    let Some(shape) = &data.exact else { return };
    let b = shape.bounds();
    (out.lower_x, out.lower_y, out.lower_z) = b.min.into();
    (out.upper_x, out.upper_y, out.upper_z) = b.max.into();
}

/// Meets the exact shape of `data` with one lane's ray, and lets the mask decide.
///
/// # Safety
/// `ray` is a lane of a live packet and `context` that of the query.
unsafe fn meet(
    data: &GeometryData,
    ray: Lane,
    context: *const ContextArgument,
) -> Option<(f32, f32, f32)> {
    let shape = data.exact.as_ref()?;
    // SAFETY: the caller's promise.
    let (org, dir, tmin, tmax) = unsafe {
        (
            ray.vector(ORG),
            ray.vector(DIR),
            ray.float(TNEAR),
            ray.float(TFAR),
        )
    };
    let Some(opacity) = &data.opacity else {
        return shape.intersect(org, dir, tmin, tmax);
    };
    // SAFETY: the caller's promise.
    let (instance, original) = unsafe {
        (
            QueryContext::instance(context),
            QueryContext::ray(context, ray.word(ID)),
        )
    };
    let kept = shape.crossings(org, dir, tmin, tmax).find(|c| {
        let hit = data.numbers.hit(c.t, (c.u, c.v), 0, data.number, instance);
        mask::keeps(&**opacity, original, &hit, c.wall)
    })?;
    Some((kept.t, kept.u, kept.v))
}

/// Closest hits of a packet with an exact shape.
pub unsafe extern "C" fn intersect(args: *const RTCIntersectFunctionNArguments) {
    // SAFETY: Embree's arguments, and the user data set in `geometry.rs`.
    let (args, data) = unsafe { (&*args, &*(*args).geometryUserPtr.cast::<GeometryData>()) };
    let width = args.N as usize;
    for lane in 0..width {
        // SAFETY: `valid` has N entries.
        if unsafe { *args.valid.add(lane) } == 0 {
            continue;
        }
        let base = args.rayhit.cast::<f32>();
        let ray = Lane { base, width, lane };
        // SAFETY: the lane is valid and the context that of the query; a packet's hits follow its
        // rays.
        unsafe {
            let Some((t, u, v)) = meet(data, ray, args.context) else {
                continue;
            };
            let hit = Lane {
                base: base.add(RAY_WORDS * width),
                width,
                lane,
            };
            ray.set(TFAR, t);
            for axis in 0..3 {
                hit.set(NG + axis, 0.0);
            }
            hit.set(U, u);
            hit.set(V, v);
            hit.set(PRIM, f32::from_bits(0));
            hit.set(GEOMETRY, f32::from_bits(args.geomID));
            let instance = QueryContext::instance(args.context);
            hit.set(INSTANCE, f32::from_bits(instance));
        }
    }
}

/// Whether a packet's rays are blocked by an exact shape.
pub unsafe extern "C" fn occluded(args: *const RTCOccludedFunctionNArguments) {
    // SAFETY: Embree's arguments, and the user data set in `geometry.rs`.
    let (args, data) = unsafe { (&*args, &*(*args).geometryUserPtr.cast::<GeometryData>()) };
    let width = args.N as usize;
    for lane in 0..width {
        // SAFETY: `valid` has N entries.
        if unsafe { *args.valid.add(lane) } == 0 {
            continue;
        }
        let base = args.ray.cast::<f32>();
        let ray = Lane { base, width, lane };
        // SAFETY: the lane is valid and the context that of the query.
        unsafe {
            if meet(data, ray, args.context).is_some() {
                ray.set(TFAR, f32::NEG_INFINITY);
            }
        }
    }
}

/// Decides for each lane whether its hit on a masked triangle counts: `valid` becomes 0 where not.
pub unsafe extern "C" fn filter(args: *const RTCFilterFunctionNArguments) {
    // SAFETY: Embree's arguments, and the user data set in `geometry.rs`.
    let (args, data) = unsafe { (&*args, &*(*args).geometryUserPtr.cast::<GeometryData>()) };
    let Some(opacity) = &data.opacity else { return };
    let width = args.N as usize;
    for lane in 0..width {
        // SAFETY: `valid` has N entries.
        let valid = unsafe { &mut *args.valid.add(lane) };
        if *valid == 0 {
            continue;
        }
        let (ray, hit) = (args.ray.cast::<f32>(), args.hit.cast::<f32>());
        let [ray, hit] = [ray, hit].map(|base| Lane { base, width, lane });
        // SAFETY: the lane is valid and the context that of the query. During filtering `tfar`
        // holds the distance of the candidate.
        let (original, hit) = unsafe {
            (
                QueryContext::ray(args.context, ray.word(ID)),
                data.numbers.hit(
                    ray.float(TFAR),
                    (hit.float(U), hit.float(V)),
                    hit.word(PRIM),
                    data.number,
                    hit.word(INSTANCE),
                ),
            )
        };
        if !mask::keeps(&**opacity, original, &hit, 0) {
            *valid = 0;
        }
    }
}
