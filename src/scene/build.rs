//! A scene ready to render: the description's shapes handed to the ray tracer, its emitters made
//! samplable, its materials resolved on demand.

use super::description::{Description, Geometry, Mesh, Shape};
use super::media::SceneMedia;
use super::surface::{DARK, Form, Needs, Surface, Surfaces};
use crate::accel::{self, AccelError, Backend, Bounds, BuildSettings, Ray, RayQuery, World};
use crate::bsdf::Materials;
use crate::light::{Emitter, EmitterShape, Lights};
use crate::math::{Affine3A, Rgb, Vec3};
use crate::medium::{MediumId, VACUUM};
use crate::texture::{MeshAttributes, Texture};
use std::sync::Arc;

/// A scene ready to render, from any camera.
pub struct Scene {
    /// Surfaces and their materials.
    pub surfaces: Arc<Surfaces>,
    /// Participating media.
    pub media: SceneMedia,
    /// Emitters.
    pub lights: Lights,
    /// The ray tracer.
    pub rays: Box<dyn RayQuery>,
}

impl Scene {
    /// Builds the scene. `materials`, `shapes` and `emitters` move out of the description.
    ///
    /// # Errors
    /// When the ray tracer runs out of memory.
    pub fn build(
        description: &mut Description,
        settings: BuildSettings,
        backend: Backend,
    ) -> Result<Self, AccelError> {
        let materials = std::mem::take(&mut description.materials);
        let (emitters, glowing) = glowing_shapes(description, &materials);
        let world = world_of(description, &materials);
        let instances = world
            .instances
            .iter()
            .map(|i| (i.to_world, i.to_world.inverse()))
            .collect();
        let media = SceneMedia::new(
            std::mem::take(&mut description.media),
            &description.shapes,
            &materials,
        );
        let instance_groups = world.instances.iter().map(|i| i.group).collect();
        let list: Vec<Surface> = std::mem::take(&mut description.shapes)
            .into_iter()
            .map(|shape| surface_of(shape, &materials))
            .collect();
        let glows = |g: &accel::Geometry| list[g.id as usize].emitter != DARK;
        let dark = accel::world_bounds(&world.without(glows));
        let bodies = match media.has_boundaries {
            true => accel::world_bounds(&world.without(|g| !media.is_bounded_by(g.id))),
            false => Bounds::EMPTY,
        };
        let surfaces = Arc::new(Surfaces {
            list,
            instances,
            instance_groups,
            materials,
        });
        let bounds = accel::world_bounds(&world);
        // Photons are to land on what does not glow by itself, if there is anything.
        let target = if dark.radius() > 0.0 { dark } else { bounds };
        let (rays, lights) = rayon::join(
            || accel::build(world, settings, Some(surfaces.clone()), backend),
            || Lights::build(emitters, &glowing, bounds, target),
        );
        let rays = rays?;
        let mut scene = Self {
            surfaces,
            media,
            lights,
            rays,
        };
        let eye = description.camera.to_world;
        let (eye, axis) = (eye.translation.as_vec3(), eye.z_axis.as_vec3());
        let camera = Ray::new(eye, axis.normalize_or(Vec3::Z));
        scene.place_media(bodies, description.camera_medium, &camera);
        Ok(scene)
    }

    /// Finds out where media are. `bodies` are the bounds of all that has one inside; `camera` is
    /// the axis of the camera, whose medium may be given.
    fn place_media(&mut self, bodies: Bounds, given: Option<MediumId>, camera: &Ray) {
        if self.media.is_empty() {
            return;
        }
        self.media.outside = self.outside_medium(given.unwrap_or(VACUUM));
        self.media.camera = given.unwrap_or_else(|| self.medium_around(camera));
        let endless = self.media.list().get(self.media.outside).is_some();
        self.media.region = if endless { self.rays.bounds() } else { bodies };
    }
}

/// The lights of a scene that is not built: for saying what is odd about them. Emitters move out of
/// the description.
pub fn lights_of(description: &mut Description) -> Lights {
    let materials = std::mem::take(&mut description.materials);
    let (emitters, glowing) = glowing_shapes(description, &materials);
    let bounds = accel::world_bounds(&world_of(description, &materials));
    description.materials = materials;
    Lights::build(emitters, &glowing, bounds, bounds)
}

/// The radiance without that of places that are cut out: rays never meet those, so light must not
/// be sampled there either.
fn uncut(radiance: Texture, opacity: Texture) -> Texture {
    match opacity.constant() {
        Some(c) if c.max_element() > 0.0 => radiance,
        Some(_) => Texture::Constant(Rgb::ZERO),
        None => radiance.times(Texture::Threshold(Arc::new((opacity, f32::MIN_POSITIVE)))),
    }
}

/// The emitters, with area emitters renumbered to the list of glowing shapes that comes with them.
fn glowing_shapes(
    description: &mut Description,
    materials: &Materials,
) -> (Vec<Emitter>, Vec<EmitterShape>) {
    let mut glowing = Vec::new();
    let mut emitters = std::mem::take(&mut description.emitters);
    for emitter in &mut emitters {
        let Emitter::Area {
            shape, radiance, ..
        } = emitter
        else {
            continue;
        };
        let source = &description.shapes[*shape as usize];
        if materials.is_masked(source.material) {
            let opacity = materials.opacity_texture(source.material);
            *radiance = uncut(radiance.clone(), opacity);
        }
        *shape = glowing.len() as u32;
        glowing.push(match &source.geometry {
            Geometry::Mesh(mesh) => EmitterShape {
                shape: accel::Shape::Triangles(mesh.triangles.clone()),
                uvs: mesh.uvs.clone(),
                attributes: attributes_of(mesh),
                flip_normals: false,
            },
            Geometry::Analytic(exact) => EmitterShape {
                shape: accel::Shape::Analytic(*exact),
                uvs: None,
                attributes: None,
                flip_normals: source.flip_normals,
            },
        });
    }
    (emitters, glowing)
}

/// Emitted radiance may come from a mesh attribute: the few meshes that glow give theirs along.
fn attributes_of(mesh: &Mesh) -> Option<Arc<MeshAttributes>> {
    let any = !mesh.attributes.list.is_empty();
    any.then(|| Arc::new(mesh.attributes.clone()))
}

/// What rays can meet of the shapes and instances of a description.
pub fn world_of(description: &Description, materials: &Materials) -> World {
    let mut world = World {
        groups: vec![Vec::new(); description.groups as usize],
        ..World::default()
    };
    for (id, shape) in description.shapes.iter().enumerate() {
        let geometry = accel::Geometry {
            id: id as u32,
            shape: match &shape.geometry {
                Geometry::Mesh(mesh) => accel::Shape::Triangles(mesh.triangles.clone()),
                Geometry::Analytic(exact) => accel::Shape::Analytic(*exact),
            },
            masked: materials.is_masked(shape.material),
        };
        match shape.group {
            Some(group) => world.groups[group as usize].push(geometry),
            None => world.geometries.push(geometry),
        }
    }
    world.instances = description
        .instances
        .iter()
        .map(|(group, to_world)| accel::Instance {
            group: *group,
            to_world: to_affine(to_world),
        })
        .collect();
    world
}

fn to_affine(m: &crate::math::DAffine3) -> Affine3A {
    let m3 = m.matrix3;
    Affine3A::from_cols(
        m3.x_axis.as_vec3a(),
        m3.y_axis.as_vec3a(),
        m3.z_axis.as_vec3a(),
        m.translation.as_vec3a(),
    )
}

fn surface_of(shape: Shape, materials: &Materials) -> Surface {
    let needs = Needs {
        tangents: materials.needs_tangents(shape.material),
        normal_change: materials.needs_normal_change(shape.material),
        footprint: materials.filters(shape.material),
    };
    Surface {
        form: match shape.geometry {
            Geometry::Mesh(mesh) => Form::Mesh(mesh),
            Geometry::Analytic(exact) => Form::Analytic(exact, shape.flip_normals),
        },
        material: shape.material,
        emitter: shape.emitter.unwrap_or(DARK),
        group: shape.group,
        needs,
    }
}
