//! Rays through Debian's Embree, version 4 or 3.
//!
//! | file | idea |
//! |---|---|
//! | `sys` | Embree's API from its header, and where 3 and 4 differ |
//! | `device` | devices and scenes as values that release themselves; errors as words; bytes counted |
//! | `geometry` | from a [`World`] to Embree's scenes, vertices shared without a copy |
//! | `callbacks` | exact shapes and masks |
//! | `packet`, `single` | rays by sixteens, and one by one |
//! | `thread` | what Embree wants of a thread that traces |
//!
//! Batches go by sixteens with the flag for incoherent rays. On rays that have nothing in common
//! packets of 1, 4, 8 and 16 are alike, on a wavefront's bounces sixteens were 1.2 times as fast as
//! single rays; the coherent flag costs a third to a half on bounced rays (`cargo bench --bench
//! accel -- thin`).
//!
//! A ray gets the same bits in every packet, on every lane and alone. Embree does not promise that,
//! but its kernels from SSE2 to AVX-512 keep it, because all of them do the same arithmetic for one
//! ray and one triangle; `tests/cuts.rs` watches over it.
//!
//! Embree is not watertight at vertices, robust or not: see `tests/watertight.rs`.

mod callbacks;
mod device;
mod geometry;
mod numbers;
mod packet;
mod single;
#[allow(clippy::upper_case_acronyms)]
mod sys;
mod thread;

use super::world::{check, overflow_factor, world_bounds};
use super::{AccelError, Bounds, BuildSettings, Hit, Opacity, Ray, RayQuery, World};
use device::Device;
use geometry::Scenes;
use std::sync::Arc;
use sys::*;

pub use thread::prepare_thread;

/// Embree behind [`RayQuery`].
pub struct Embree {
    // Dropped before the device they were made with.
    scenes: Scenes,
    device: Device,
    bounds: Bounds,
    overflow: f32,
    settings: BuildSettings,
}

impl Embree {
    /// Builds the trees. Vertex buffers stay where they are, shared.
    ///
    /// `opacity` answers for geometry with `masked` set; without it all geometry is opaque.
    ///
    /// # Errors
    /// An instance without its group or with a singular transformation; Embree's own errors, among
    /// them out of memory.
    pub fn build(
        world: World,
        settings: BuildSettings,
        opacity: Option<Arc<dyn Opacity>>,
    ) -> Result<Self, AccelError> {
        check(&world)?;
        let device = Device::new(settings.threads, settings.memory)?;
        let scenes = geometry::build(&device, &world, &settings, opacity.as_ref())?;
        Ok(Self {
            scenes,
            device,
            bounds: world_bounds(&world),
            overflow: overflow_factor(&world),
            settings,
        })
    }
}

impl RayQuery for Embree {
    fn intersect(&self, ray: &Ray) -> Hit {
        if !ray.is_traceable_within(self.overflow) {
            return Hit::NONE;
        }
        let mut context = QueryContext::new();
        context.set_rays(std::slice::from_ref(ray));
        let mut query = single::with_hit(ray);
        // SAFETY: the scene is committed, the query initialised, and the context names its ray.
        unsafe { intersect1(self.scenes.world.raw(), &mut context, &mut query) };
        single::hit(&query, &self.scenes.numbers)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        if !ray.is_traceable_within(self.overflow) {
            return false;
        }
        let mut context = QueryContext::new();
        context.set_rays(std::slice::from_ref(ray));
        let mut query = single::ray(ray);
        // SAFETY: the scene is committed, the query initialised, and the context names its ray.
        unsafe { occluded1(self.scenes.world.raw(), &mut context, &mut query) };
        query.tfar == f32::NEG_INFINITY
    }

    fn intersect_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        let scene = self.scenes.world.raw();
        let mut context = QueryContext::new();
        let mut valid = Lanes([0; packet::WIDTH]);
        let mut packet = RTCRayHit16 {
            ray: packet::new_rays(),
            hit: packet::new_hits(),
        };
        for (rays, hits) in rays
            .chunks(packet::WIDTH)
            .zip(hits.chunks_mut(packet::WIDTH))
        {
            packet::load(rays, self.overflow, &mut packet.ray, &mut valid);
            packet.hit.geomID = [INVALID_ID; packet::WIDTH];
            context.set_rays(rays);
            // SAFETY: the scene is committed, the packet initialised, and the context names its
            // rays.
            unsafe { intersect16(scene, &mut context, &valid, &mut packet) };
            packet::store(&packet, &self.scenes.numbers, hits);
        }
    }

    fn occluded_batch(&self, rays: &[Ray], blocked: &mut [bool]) {
        let scene = self.scenes.world.raw();
        let mut context = QueryContext::new();
        let mut valid = Lanes([0; packet::WIDTH]);
        let mut packet = packet::new_rays();
        for (rays, blocked) in rays
            .chunks(packet::WIDTH)
            .zip(blocked.chunks_mut(packet::WIDTH))
        {
            packet::load(rays, self.overflow, &mut packet, &mut valid);
            context.set_rays(rays);
            // SAFETY: the scene is committed, the packet initialised, and the context names its
            // rays.
            unsafe { occluded16(scene, &mut context, &valid, &mut packet) };
            for (lane, blocked) in blocked.iter_mut().enumerate() {
                *blocked = valid.0[lane] != 0 && packet.tfar[lane] == f32::NEG_INFINITY;
            }
        }
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        self.device.bytes()
    }

    fn settings(&self) -> BuildSettings {
        self.settings
    }

    fn name(&self) -> String {
        format!("Embree {}", self.device.version())
    }
}
