//! What model files are made of, before a camera looks at it: importers of models add to the same
//! [`Parts`], so several files make one scene.

use super::told::Told;
use crate::accel::Bounds;
use crate::bsdf::Materials;
use crate::camera::CameraDescription;
use crate::light::Emitter;
use crate::math::{DAffine3, Vec3};
use crate::medium::Media;
use crate::scene::{Geometry, Shape};
use std::collections::BTreeMap;

/// A camera that a model file brings along.
#[derive(Clone, Debug)]
pub struct NamedCamera {
    /// Its name in the file; may be empty.
    pub name: String,
    /// The camera.
    pub camera: CameraDescription,
    /// Width over height of the picture it was made for.
    pub aspect: Option<f64>,
}

/// Shapes, materials, lights and cameras of model files.
#[derive(Debug, Default)]
pub struct Parts {
    /// All shapes, of the world and of groups.
    pub shapes: Vec<Shape>,
    /// Number of groups.
    pub groups: u32,
    /// Where groups stand: group, group space to world space.
    pub instances: Vec<(u32, DAffine3)>,
    /// Materials.
    pub materials: Materials,
    /// Media inside of shapes.
    pub media: Media,
    /// Emitters, those of shapes included.
    pub emitters: Vec<Emitter>,
    /// How many of them are no lamps: surfaces that show a colour of their own, or glow no brighter
    /// than white.
    pub faint: usize,
    /// What they are called, by number, those that have a name.
    pub emitter_names: BTreeMap<u32, String>,
    /// Cameras, in the order of the files.
    pub cameras: Vec<NamedCamera>,
    /// What was odd but not fatal, once each.
    pub warnings: Told,
}

impl Parts {
    /// Notes a warning, unless the same was noted before.
    pub fn warn(&mut self, warning: String) {
        self.warnings.tell(warning);
    }

    /// Adds an emitter under a name.
    pub fn add_emitter(&mut self, emitter: Emitter, name: impl Into<String>) {
        let number = self.emitters.len() as u32;
        self.emitter_names.insert(number, name.into());
        self.emitters.push(emitter);
    }

    /// Bounds of everything that has a place; empty if nothing has.
    pub fn bounds(&self) -> Bounds {
        bounds_of(&self.shapes, &self.instances)
    }
}

/// World-space bounds of shapes, those of groups wherever they stand.
pub fn bounds_of(shapes: &[Shape], instances: &[(u32, DAffine3)]) -> Bounds {
    let groups = shapes.iter().filter_map(|s| s.group).max();
    let mut of_group = vec![Bounds::EMPTY; groups.map_or(0, |g| g as usize + 1)];
    let mut world = Bounds::EMPTY;
    for shape in shapes {
        let bounds = shape_bounds(&shape.geometry);
        match shape.group {
            Some(group) => {
                let slot = &mut of_group[group as usize];
                *slot = slot.union(bounds);
            }
            None => world = world.union(bounds),
        }
    }
    for (group, to_world) in instances {
        let Some(bounds) = of_group.get(*group as usize).filter(|b| !b.is_empty()) else {
            continue;
        };
        for i in 0..8 {
            let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            let corner = Vec3::new(
                pick(0, bounds.min.x, bounds.max.x),
                pick(1, bounds.min.y, bounds.max.y),
                pick(2, bounds.min.z, bounds.max.z),
            );
            world = world.with(to_world.transform_point3(corner.as_dvec3()).as_vec3());
        }
    }
    world
}

/// Bounds of a shape in its own space: the world, or its group.
pub(super) fn shape_bounds(geometry: &Geometry) -> Bounds {
    match geometry {
        Geometry::Analytic(shape) => shape.bounds(),
        Geometry::Mesh(mesh) => {
            let positions = mesh.triangles.positions().iter();
            positions.fold(Bounds::EMPTY, |b, p| b.with(*p))
        }
    }
}
