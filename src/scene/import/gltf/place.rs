//! From placements to shapes: which meshes are instanced, and loading them all at once.

use super::accessor::Accessors;
use super::materials::{self, Variant};
use super::nodes::{Placement, Standing};
use super::primitive::{self, ALPHA, COLOR, Job};
use super::schema::{GltfNode, Material, Mesh as MeshSchema, Primitive};
use super::{Importer, error};
use crate::light::Emitter;
use crate::math::{DAffine3, Vec2};
use crate::scene::import::ImportError;
use crate::scene::import::mesh::{self, Loaded};
use crate::scene::{Geometry, Mesh, Shape};
use glam::DMat4;
use rayon::prelude::*;
use std::sync::Arc;

/// A primitive that becomes a shape.
struct Planned<'a> {
    job: Job<'a>,
    name: String,
    group: Option<u32>,
    /// Stands where its group's instances are mirrored.
    mirrored: bool,
}

/// Which meshes stand where.
struct Places<'a> {
    standing: &'a Standing,
    /// Matrices of each node's skin.
    joints: Vec<Option<Vec<DAffine3>>>,
    /// The group of each mesh that has one. Mirrored placements of a mesh with a normal map have
    /// another.
    groups: Vec<[Option<u32>; 2]>,
}

impl<'a> Importer<'a> {
    /// Makes shapes of everything that stands in the scene.
    pub(super) fn place(
        &mut self,
        standing: &Standing,
        accessors: Accessors,
    ) -> Result<(), ImportError> {
        let places = self.places(standing, accessors)?;
        let planned = self.plan(&places)?;
        let loaded: Vec<Result<Option<Loaded>, ImportError>> = planned
            .par_iter()
            .map(|p| primitive::load(accessors, &p.job))
            .collect();
        for (plan, result) in planned.into_iter().zip(loaded) {
            match result? {
                None => self.warn("points and lines are left out"),
                Some(loaded) => self.shape(&plan, loaded)?,
            }
        }
        Ok(())
    }

    fn places<'s>(
        &mut self,
        standing: &'s Standing,
        accessors: Accessors,
    ) -> Result<Places<'s>, ImportError> {
        let document = self.document();
        let mut joints = vec![None; document.nodes.len()];
        let mut uses = vec![[0u32; 2]; document.meshes.len()];
        for placement in &standing.meshes {
            let node = &document.nodes[placement.node];
            let Some(counts) = uses.get_mut(placement.mesh) else {
                let message = format!("there is no mesh {}", placement.mesh);
                return Err(error(self.path(), message));
            };
            let count = &mut counts[self.hand(placement)];
            joints[placement.node] = self.joints(node, standing, accessors)?;
            // A mesh that moves with its node's joints or targets is like no other.
            if joints[placement.node].is_none() && node.weights.is_none() {
                *count += 1;
            }
        }
        let mut groups = vec![[None; 2]; uses.len()];
        for (mesh, counts) in uses.into_iter().enumerate() {
            let copied = self.any_material(&document.meshes[mesh], materials::glows);
            for (group, count) in groups[mesh].iter_mut().zip(counts) {
                if count > 1 && !copied {
                    *group = Some(self.parts.groups);
                    self.parts.groups += 1;
                }
            }
        }
        Ok(Places {
            standing,
            joints,
            groups,
        })
    }

    fn any_material(&self, mesh: &MeshSchema, test: impl Fn(&Material) -> bool) -> bool {
        let materials = &self.document().materials;
        let of = |p: &Primitive| self.material_of(p).and_then(|m| materials.get(m));
        mesh.primitives.iter().filter_map(of).any(test)
    }

    /// 1 for a mirrored mesh with a normal map: seen from outside its texture lies back to front.
    fn hand(&self, placement: &Placement) -> usize {
        let mirrored = placement.to_world.matrix3.determinant() < 0.0;
        let mesh = &self.document().meshes[placement.mesh];
        usize::from(mirrored && self.any_material(mesh, materials::follows_tangents))
    }

    /// The matrices of a node's skin, mesh space to world space.
    fn joints(
        &mut self,
        node: &GltfNode,
        standing: &Standing,
        accessors: Accessors,
    ) -> Result<Option<Vec<DAffine3>>, ImportError> {
        let Some(index) = node.skin else {
            return Ok(None);
        };
        let fail = |message: String| error(&self.container.path, message);
        let skin = self.document().skins.get(index);
        let skin = skin.ok_or_else(|| fail(format!("there is no skin {index}")))?;
        let inverse = match skin.inverse_bind_matrices {
            Some(accessor) => accessors.floats::<16>(accessor)?,
            None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); skin.joints.len()],
        };
        if inverse.len() < skin.joints.len() {
            let (matrices, joints) = (inverse.len(), skin.joints.len());
            return Err(fail(format!(
                "skin {index} has {matrices} matrices for {joints} joints"
            )));
        }
        let mut matrices = Vec::with_capacity(skin.joints.len());
        for (&joint, bind) in skin.joints.iter().zip(&inverse) {
            let to_world = standing.to_world.get(joint);
            let to_world = to_world.ok_or_else(|| {
                fail(format!(
                    "skin {index} has node {joint} as a joint, which is not there"
                ))
            })?;
            let bind = bind.map(f64::from);
            matrices.push(*to_world * DAffine3::from_mat4(DMat4::from_cols_array(&bind)));
        }
        if skin.joints.iter().any(|&j| !standing.stands[j]) {
            self.warn(format!(
                "skin {index} has joints that are not in the scene: they stand at the origin"
            ));
        }
        Ok(Some(matrices))
    }

    /// The primitives to load; instances are noted on the way.
    fn plan<'p>(&mut self, places: &'p Places) -> Result<Vec<Planned<'p>>, ImportError>
    where
        'a: 'p,
    {
        let mut planned = Vec::new();
        let mut has_shapes = vec![[false; 2]; places.groups.len()];
        for placement in &places.standing.meshes {
            let plain = self.document().nodes[placement.node].weights.is_none()
                && places.joints[placement.node].is_none();
            let hand = self.hand(placement);
            let group = places.groups[placement.mesh][hand].filter(|_| plain);
            if let Some(group) = group {
                if !self.instance(group, placement) {
                    continue;
                }
                if std::mem::replace(&mut has_shapes[placement.mesh][hand], true) {
                    continue;
                }
            }
            self.plan_mesh(placement, group, places, &mut planned)?;
        }
        Ok(planned)
    }

    /// Notes an instance; false if it is squashed flat and cannot be traced.
    fn instance(&mut self, group: u32, placement: &Placement) -> bool {
        let map = placement.to_world;
        let sound = map.is_finite() && map.inverse().is_finite();
        if sound {
            self.parts.instances.push((group, map));
        } else {
            let node = placement.node;
            self.warn(format!("node {node} has no extent: it is left out"));
        }
        sound
    }

    fn plan_mesh<'p>(
        &mut self,
        placement: &Placement,
        group: Option<u32>,
        places: &'p Places,
        planned: &mut Vec<Planned<'p>>,
    ) -> Result<(), ImportError>
    where
        'a: 'p,
    {
        let document = self.document();
        let mesh = &document.meshes[placement.mesh];
        let node = &document.nodes[placement.node];
        let fallback = || format!("mesh {}", placement.mesh);
        let name = mesh.name.clone().unwrap_or_else(fallback);
        for primitive in &mesh.primitives {
            let material = self.material_of(primitive);
            let material = material.and_then(|m| document.materials.get(m));
            let alpha = material.and_then(|m| m.alpha_mode.as_deref());
            planned.push(Planned {
                job: Job {
                    primitive,
                    to_world: match group {
                        Some(_) => DAffine3::IDENTITY,
                        None => placement.to_world,
                    },
                    weights: node.weights.as_deref().unwrap_or(&mesh.weights),
                    joints: places.joints[placement.node].as_deref(),
                    uv_set: material.map_or(0, materials::coordinates),
                    textured: self.only_material.is_none()
                        && material.is_some_and(|m| !materials::all_textures(m).is_empty()),
                    alpha: matches!(alpha, Some("BLEND" | "MASK")),
                    tangents: material.is_some_and(materials::follows_tangents),
                },
                name: name.clone(),
                group,
                mirrored: group.is_some() && self.hand(placement) == 1,
            });
        }
        Ok(())
    }

    fn shape(&mut self, plan: &Planned, loaded: Loaded) -> Result<(), ImportError> {
        for warning in &loaded.warnings {
            self.warn(format!("{}: {warning}", plan.name));
        }
        if loaded.mesh.triangles.triangles().is_empty() {
            return Ok(());
        }
        let index = self.material_of(plan.job.primitive);
        let material = index.and_then(|m| self.document().materials.get(m));
        let mapped = material.is_some_and(materials::follows_tangents);
        let boundary = self.boundary(index);
        let parts = match mapped {
            true => by_side(loaded.mesh),
            false => vec![(false, loaded.mesh)],
        };
        for (mirrored, mesh) in parts {
            let has = |name: &str| mesh.attributes.list.iter().any(|a| a.name == name);
            let finish = self.material(Variant {
                index,
                colored: has(COLOR),
                alpha: has(ALPHA),
                mirrored: mirrored != plan.mirrored,
            })?;
            let shape = self.parts.shapes.len() as u32;
            let emitter = finish.emission.map(|radiance| {
                self.parts.faint += usize::from(!finish.is_lamp);
                self.parts.emitters.push(Emitter::Area {
                    shape,
                    radiance,
                    both_sides: finish.both_sides,
                });
                (self.parts.emitters.len() - 1) as u32
            });
            self.parts.shapes.push(Shape {
                name: plan.name.clone(),
                geometry: Geometry::Mesh(Arc::new(mesh)),
                material: finish.material,
                emitter,
                flip_normals: false,
                group: plan.group,
                boundary,
            });
        }
        Ok(())
    }
}

/// Splits a mesh into what carries its texture the right way around and what carries it mirrored.
///
/// A normal map is made for tangents along u and *up* the image; seen from the front that is a
/// right-handed frame only where the texture is not mirrored. Tangents of the file say so; without
/// them, v points down, so that the area of a triangle in texture space is negative there.
fn by_side(mesh: Mesh) -> Vec<(bool, Mesh)> {
    let triangles = mesh.triangles.clone();
    let corners = |i: usize| triangles.triangles()[i].map(|v| v as usize);
    let parts = match (mesh.tangents.clone(), mesh.uvs.clone()) {
        (Some(tangents), _) => mesh::split(mesh, |i| {
            let sides: f32 = corners(i).map(|v| tangents[v].w).into_iter().sum();
            u32::from(sides < 0.0)
        }),
        (None, Some(uvs)) => mesh::split(mesh, |i| {
            let [a, b, c]: [Vec2; 3] = corners(i).map(|v| uvs[v]);
            u32::from((b - a).perp_dot(c - a) > 0.0)
        }),
        (None, None) => return vec![(false, mesh)],
    };
    parts.into_iter().map(|(key, m)| (key == 1, m)).collect()
}
