//! Embree's C API as bindgen read it, and the few calls whose signatures differ between Embree 3
//! and 4.

use crate::accel::Ray;

#[allow(
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    dead_code,
    unsafe_op_in_unsafe_fn,
    clippy::all,
    clippy::undocumented_unsafe_blocks
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/embree.rs"));
}

pub use bindings::*;

#[cfg(embree3)]
/// What callbacks are given as their context.
pub type ContextArgument = RTCIntersectContext;
#[cfg(embree4)]
/// What callbacks are given as their context.
pub type ContextArgument = RTCRayQueryContext;

/// The "no geometry" and "no instance" of Embree.
pub const INVALID_ID: u32 = u32::MAX;

/// What Embree hands through to callbacks: its own context, and behind it the rays of the packet in
/// world space, which a callback finds by the ray's `id` (its lane).
///
/// A filter inside an instance sees a ray in the group's space, rounded by the transformation; the
/// decision whether a masked hit counts needs the caller's bits.
#[repr(C)]
pub struct QueryContext {
    base: ContextArgument,
    rays: *const Ray,
}

impl QueryContext {
    /// A context for rays that follow in [`QueryContext::set_rays`].
    pub fn new() -> Self {
        Self {
            #[cfg(embree3)]
            base: ContextArgument {
                flags: RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT,
                filter: None,
                instID: [INVALID_ID],
            },
            #[cfg(embree4)]
            base: ContextArgument {
                instID: [INVALID_ID],
                instPrimID: [INVALID_ID],
            },
            rays: std::ptr::null(),
        }
    }

    /// Names the rays the next trace is about. They must outlive the trace.
    #[inline]
    pub fn set_rays(&mut self, rays: &[Ray]) {
        self.rays = rays.as_ptr();
    }

    /// The instance being traversed, or [`INVALID_ID`].
    ///
    /// # Safety
    /// `context` must be the `base` of a live `QueryContext`.
    #[inline]
    pub unsafe fn instance(context: *const ContextArgument) -> u32 {
        // SAFETY: the caller's promise; instID is initialised in `new`.
        unsafe { (*context).instID[0] }
    }

    /// The ray of lane `id`.
    ///
    /// # Safety
    /// `context` must be the `base` of a live `QueryContext` whose rays number more than `id`.
    #[inline]
    pub unsafe fn ray<'a>(context: *const ContextArgument, id: u32) -> &'a Ray {
        // SAFETY: the caller's promise; `base` is the first field of a repr(C) structure.
        unsafe { &*(*context.cast::<QueryContext>()).rays.add(id as usize) }
    }
}

/// Defines one traversal call for both versions.
macro_rules! traversal {
    ($(#[$doc:meta])* $name:ident, $packet:ty, $function:ident, $init:ident $(, $valid:ident)?) => {
        $(#[$doc])*
        ///
        /// # Safety
        /// `scene` is committed, `packet` is initialised, and `context` names the packet's rays.
        #[inline]
        pub unsafe fn $name(
            scene: RTCScene,
            context: &mut QueryContext,
            $($valid: &Lanes,)?
            packet: &mut $packet,
        ) {
            // SAFETY: the caller's promise; all pointers are to live, properly aligned values.
            unsafe {
                #[cfg(embree3)]
                $function($($valid.0.as_ptr(),)? scene, &mut context.base, packet);
                #[cfg(embree4)]
                $function($($valid.0.as_ptr(),)? scene, packet, &mut $init(context));
            }
        }
    };
}

/// Which lanes of a packet take part: -1 does, 0 does not. Aligned as Embree demands.
#[repr(C, align(64))]
pub struct Lanes(pub [i32; 16]);

traversal!(
    /// Closest hit of one ray.
    intersect1, RTCRayHit, rtcIntersect1, intersect_arguments
);
traversal!(
    /// Whether one ray is blocked: `tfar` becomes -infinity.
    occluded1, RTCRay, rtcOccluded1, occluded_arguments
);
traversal!(
    /// Closest hits of 16 rays.
    intersect16, RTCRayHit16, rtcIntersect16, intersect_arguments, valid
);
traversal!(
    /// Whether each of 16 rays is blocked: its `tfar` becomes -infinity.
    occluded16, RTCRay16, rtcOccluded16, occluded_arguments, valid
);

#[cfg(embree4)]
#[inline]
fn intersect_arguments(context: &mut QueryContext) -> RTCIntersectArguments {
    RTCIntersectArguments {
        flags: RTC_RAY_QUERY_FLAG_INCOHERENT,
        feature_mask: RTC_FEATURE_FLAG_ALL,
        context: &mut context.base,
        filter: None,
        intersect: None,
    }
}

#[cfg(embree4)]
#[inline]
fn occluded_arguments(context: &mut QueryContext) -> RTCOccludedArguments {
    RTCOccludedArguments {
        flags: RTC_RAY_QUERY_FLAG_INCOHERENT,
        feature_mask: RTC_FEATURE_FLAG_ALL,
        context: &mut context.base,
        filter: None,
        occluded: None,
    }
}
