//! From a [`World`] to Embree's scenes: one for the world, one for each group that stands in it.
//!
//! [`Numbers`] says how geometries and instances are numbered in them.

use super::callbacks::{self, GeometryData};
use super::device::{Device, Scene};
use super::numbers::{Numbers, number};
use super::sys::*;
use crate::accel::{
    AccelError, BuildSettings, Geometry, Instance, Opacity, Shape, TriangleMesh, World,
};
use std::ffi::c_void;
use std::sync::Arc;

/// The committed scenes and all they point to.
///
/// Fields drop in the order they stand in: scenes before what their geometries point to.
pub struct Scenes {
    /// The scene rays are traced through.
    pub world: Scene,
    /// Kept alive by Embree too; held here so that ownership is visible.
    _groups: Vec<Option<Scene>>,
    /// What callbacks are given: each at an address of its own, because Embree holds it.
    _data: Vec<Arc<GeometryData>>,
    /// The vertex buffers Embree reads without a copy.
    _meshes: Vec<Arc<TriangleMesh>>,
    /// Shared with the callbacks.
    pub numbers: Arc<Numbers>,
}

/// Builds all scenes.
pub fn build(
    device: &Device,
    world: &World,
    settings: &BuildSettings,
    opacity: Option<&Arc<dyn Opacity>>,
) -> Result<Scenes, AccelError> {
    let numbers = Arc::new(number(world)?);
    let mut assembly = Assembly {
        device,
        settings,
        opacity,
        numbers: &numbers,
        data: Vec::new(),
        meshes: Vec::new(),
    };
    let mut groups = Vec::with_capacity(world.groups.len());
    let mut used = vec![false; world.groups.len()];
    for instance in &world.instances {
        if let Some(flag) = used.get_mut(instance.group as usize) {
            *flag = true;
        }
    }
    for (index, group) in world.groups.iter().enumerate() {
        groups.push(if used[index] {
            Some(assembly.group(index, group)?)
        } else {
            None
        });
    }
    let scene = Scene::new(device, settings)?;
    assembly.attach_all(&scene, &world.geometries)?;
    for (index, instance) in world.instances.iter().enumerate() {
        let Some(Some(group)) = groups.get(instance.group as usize) else {
            continue;
        };
        let id = numbers.loose + index as u32;
        place(device, &scene, group, instance, id)?;
    }
    scene.commit();
    device.check("building the world's tree")?;
    Ok(Scenes {
        world: scene,
        _groups: groups,
        _data: assembly.data,
        _meshes: assembly.meshes,
        numbers,
    })
}

struct Assembly<'a> {
    device: &'a Device,
    settings: &'a BuildSettings,
    opacity: Option<&'a Arc<dyn Opacity>>,
    numbers: &'a Arc<Numbers>,
    data: Vec<Arc<GeometryData>>,
    meshes: Vec<Arc<TriangleMesh>>,
}

impl Assembly<'_> {
    fn group(&mut self, index: usize, group: &[Geometry]) -> Result<Scene, AccelError> {
        let scene = Scene::new(self.device, self.settings)?;
        self.attach_all(&scene, group)?;
        scene.commit();
        self.device
            .check(&format!("building the tree of group {index}"))?;
        Ok(scene)
    }

    fn attach_all(&mut self, scene: &Scene, geometries: &[Geometry]) -> Result<(), AccelError> {
        for (index, geometry) in geometries.iter().enumerate() {
            let raw = match &geometry.shape {
                Shape::Triangles(mesh) if mesh.triangles().is_empty() => continue,
                Shape::Triangles(mesh) => self.triangles(mesh),
                Shape::Analytic(_) => self.user(),
            };
            if raw.is_null() {
                self.device.check("creating a geometry")?;
                continue;
            }
            self.attach_data(raw, geometry, index as u32);
            // SAFETY: `raw` is complete, and all it points to is kept in `Scenes` behind the scene.
            unsafe { scene.attach(raw, index as u32) };
            self.device
                .check(&format!("adding geometry {}", geometry.id))?;
        }
        Ok(())
    }

    fn triangles(&mut self, mesh: &Arc<TriangleMesh>) -> RTCGeometry {
        // SAFETY: the device is live.
        let raw = unsafe { rtcNewGeometry(self.device.raw(), RTC_GEOMETRY_TYPE_TRIANGLE) };
        if raw.is_null() {
            return raw;
        }
        self.meshes.push(Arc::clone(mesh));
        let share = |kind: RTCBufferType, format: RTCFormat, data: *const c_void, count| {
            // SAFETY: items are 12 bytes each, the Arc in `meshes` outlives the scene, and
            // `TriangleMesh::new` leaves the spare bytes that Embree reads behind the last vertex.
            unsafe { rtcSetSharedGeometryBuffer(raw, kind, 0, format, data, 0, 12, count) };
        };
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        share(
            RTC_BUFFER_TYPE_VERTEX,
            RTC_FORMAT_FLOAT3,
            positions.as_ptr().cast(),
            positions.len(),
        );
        share(
            RTC_BUFFER_TYPE_INDEX,
            RTC_FORMAT_UINT3,
            triangles.as_ptr().cast(),
            triangles.len(),
        );
        raw
    }

    fn user(&self) -> RTCGeometry {
        // SAFETY: the device is live.
        let raw = unsafe { rtcNewGeometry(self.device.raw(), RTC_GEOMETRY_TYPE_USER) };
        if raw.is_null() {
            return raw;
        }
        // SAFETY: the geometry is live; the callbacks read the data that `attach_data` sets.
        unsafe {
            rtcSetGeometryUserPrimitiveCount(raw, 1);
            rtcSetGeometryBoundsFunction(raw, Some(callbacks::bounds), std::ptr::null_mut());
            rtcSetGeometryIntersectFunction(raw, Some(callbacks::intersect));
            rtcSetGeometryOccludedFunction(raw, Some(callbacks::occluded));
        }
        raw
    }

    /// Exact and masked geometry gets data for its callbacks; an opaque mesh needs none.
    fn attach_data(&mut self, raw: RTCGeometry, geometry: &Geometry, number: u32) {
        let opacity = if geometry.masked {
            self.opacity.cloned()
        } else {
            None
        };
        let exact = match &geometry.shape {
            Shape::Analytic(shape) => Some(*shape),
            Shape::Triangles(_) => None,
        };
        if exact.is_none() && opacity.is_none() {
            return;
        }
        let filtered = exact.is_none();
        let data = Arc::new(GeometryData {
            number,
            exact,
            opacity,
            numbers: Arc::clone(self.numbers),
        });
        let pointer = (&raw const *data).cast_mut().cast::<c_void>();
        self.data.push(data);
        // SAFETY: the geometry is live and `pointer` stays valid as long as the scene.
        unsafe {
            rtcSetGeometryUserData(raw, pointer);
            if filtered {
                rtcSetGeometryIntersectFilterFunction(raw, Some(callbacks::filter));
                rtcSetGeometryOccludedFilterFunction(raw, Some(callbacks::filter));
            }
        }
    }
}

/// Stands `group` in the world.
fn place(
    device: &Device,
    world: &Scene,
    group: &Scene,
    instance: &Instance,
    id: u32,
) -> Result<(), AccelError> {
    // SAFETY: the device is live.
    let raw = unsafe { rtcNewGeometry(device.raw(), RTC_GEOMETRY_TYPE_INSTANCE) };
    if raw.is_null() {
        return device.check("creating an instance");
    }
    let columns = instance.to_world.to_cols_array();
    // SAFETY: the matrix has 12 floats in column-major order and is copied by the call.
    unsafe {
        rtcSetGeometryInstancedScene(raw, group.raw());
        rtcSetGeometryTransform(
            raw,
            0,
            RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
            columns.as_ptr().cast(),
        );
        world.attach(raw, id);
    }
    device.check("placing an instance")
}
