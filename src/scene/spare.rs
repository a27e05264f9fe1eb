//! Only what the scene requires: buffers of meshes that nothing reads are given back before the ray
//! tracer is built, which is when memory is shortest.
//!
//! Textures and anisotropic materials read texture coordinates, textures read attributes. No pixel
//! changes.

use super::description::{Description, Geometry, Mesh};
use crate::light::Emitter;
use crate::math::{Rgb, Vec2};
use crate::texture::Reads;
use std::collections::HashMap;
use std::mem::size_of;
use std::sync::Arc;

/// What was given back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Trimmed {
    /// Meshes whose texture coordinates nothing reads.
    pub uv_meshes: usize,
    /// Bytes of those.
    pub uv_bytes: u64,
    /// Attributes that nothing reads.
    pub attributes: usize,
    /// Bytes of those.
    pub attribute_bytes: u64,
}

/// A mesh, the shapes made of it, and what those read.
struct Use {
    mesh: Arc<Mesh>,
    shapes: Vec<usize>,
    reads: Reads,
}

/// Gives back what nothing reads. Texture coordinates may be told to the film (`tells_uvs`).
pub fn trim(description: &mut Description, tells_uvs: bool) -> Trimmed {
    let mut trimmed = Trimmed::default();
    for mut of in uses(description) {
        of.reads.uvs |= tells_uvs;
        // The only reference, unless somebody outside the description holds the mesh, too.
        if let Some(mesh) = Arc::get_mut(&mut of.mesh) {
            trimmed.trim(mesh, &of.reads);
        }
        for shape in of.shapes {
            description.shapes[shape].geometry = Geometry::Mesh(of.mesh.clone());
        }
    }
    trimmed
}

/// Takes the meshes out of the description: shapes hold empty ones instead.
fn uses(description: &mut Description) -> Vec<Use> {
    let mut uses: Vec<Use> = Vec::new();
    let mut known: HashMap<*const Mesh, usize> = HashMap::new();
    let empty = Arc::new(Mesh::default());
    for index in 0..description.shapes.len() {
        let reads = reads_of(description, index);
        let Geometry::Mesh(held) = &mut description.shapes[index].geometry else {
            continue;
        };
        let mesh = std::mem::replace(held, empty.clone());
        let at = *known.entry(Arc::as_ptr(&mesh)).or_insert(uses.len());
        match uses.get_mut(at) {
            Some(of) => {
                of.shapes.push(index);
                of.reads.uvs |= reads.uvs;
                of.reads.attributes.extend(reads.attributes);
            }
            None => uses.push(Use {
                mesh,
                shapes: vec![index],
                reads,
            }),
        }
    }
    uses
}

/// What the material and the light of a shape read.
fn reads_of(description: &Description, shape: usize) -> Reads {
    let shape = &description.shapes[shape];
    let mut reads = Reads::default();
    description.materials.add_reads(shape.material, &mut reads);
    let emitter = shape
        .emitter
        .and_then(|e| description.emitters.get(e as usize));
    if let Some(Emitter::Area { radiance, .. }) = emitter {
        radiance.add_reads(&mut reads);
    }
    reads
}

impl Trimmed {
    fn trim(&mut self, mesh: &mut Mesh, reads: &Reads) {
        if !reads.uvs {
            if let Some(uvs) = mesh.uvs.take() {
                self.uv_meshes += 1;
                self.uv_bytes += (uvs.len() * size_of::<Vec2>()) as u64;
            }
        }
        mesh.attributes.list.retain(|attribute| {
            if reads.attributes.contains(attribute.name.as_str()) {
                return true;
            }
            self.attributes += 1;
            self.attribute_bytes += (attribute.values.len() * size_of::<Rgb>()) as u64;
            false
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::TriangleMesh;
    use crate::bsdf::Material;
    use crate::bsdf::material::Diffuse;
    use crate::math::Vec3;
    use crate::scene::Shape;
    use crate::texture::{Grid, MeshAttribute, MeshAttributes, Texture, UvTransform};

    fn attribute(name: &str) -> MeshAttribute {
        MeshAttribute {
            name: name.into(),
            per_face: false,
            values: vec![Rgb::ONE; 3],
        }
    }

    fn mesh() -> Arc<Mesh> {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        Arc::new(Mesh {
            triangles: Arc::new(TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap()),
            normals: None,
            tangents: None,
            uvs: Some(Arc::new(vec![Vec2::ZERO; 3])),
            attributes: MeshAttributes {
                list: vec![attribute("vertex_color"), attribute("vertex_heat")],
            },
        })
    }

    fn shape(mesh: &Arc<Mesh>, material: u32) -> Shape {
        Shape {
            name: "mesh".into(),
            geometry: Geometry::Mesh(mesh.clone()),
            material,
            emitter: None,
            flip_normals: false,
            group: None,
            boundary: None,
        }
    }

    fn lines() -> Texture {
        Texture::Grid(Arc::new(Grid {
            color0: Rgb::ZERO,
            color1: Rgb::ONE,
            line_width: 0.1,
            to_uv: UvTransform(glam::Affine2::IDENTITY),
        }))
    }

    /// Materials: 0 of one colour, 1 lines inside two sides, 2 the vertices' colours.
    fn scene(shapes: impl Fn() -> Vec<Shape>) -> Description {
        let mut description = Description::empty();
        let diffuse = |reflectance| Material::Diffuse(Diffuse { reflectance });
        let materials = &mut description.materials;
        materials.push(diffuse(Texture::Constant(Rgb::ONE)));
        let inner = materials.push(diffuse(lines()));
        materials.push(diffuse(Texture::MeshAttribute("vertex_color".into())));
        materials.push(Material::TwoSided {
            front: inner,
            back: inner,
        });
        description.shapes = shapes();
        description
    }

    fn kept(description: &Description, shape: usize) -> (bool, Vec<&str>) {
        let Geometry::Mesh(mesh) = &description.shapes[shape].geometry else {
            return (false, Vec::new());
        };
        let names = mesh.attributes.list.iter().map(|a| a.name.as_str());
        (mesh.uvs.is_some(), names.collect())
    }

    #[test]
    fn what_nothing_reads_is_given_back() {
        let mut plain = scene(|| vec![shape(&mesh(), 0)]);
        let trimmed = trim(&mut plain, false);
        assert_eq!(kept(&plain, 0), (false, vec![]));
        assert_eq!((trimmed.uv_meshes, trimmed.uv_bytes), (1, 24));
        assert_eq!((trimmed.attributes, trimmed.attribute_bytes), (2, 72));
    }

    #[test]
    fn what_is_read_stays() {
        let mut lined = scene(|| vec![shape(&mesh(), 3)]);
        assert_eq!(trim(&mut lined, false).uv_bytes, 0);
        assert_eq!(kept(&lined, 0), (true, vec![]));
        let mut colored = scene(|| vec![shape(&mesh(), 2)]);
        assert_eq!(trim(&mut colored, false).uv_meshes, 1);
        assert_eq!(kept(&colored, 0), (false, vec!["vertex_color"]));
    }

    #[test]
    fn a_mesh_in_two_materials_keeps_what_either_reads_and_stays_one() {
        let mut both = scene(|| {
            let mesh = mesh();
            vec![shape(&mesh, 2), shape(&mesh, 1)]
        });
        trim(&mut both, false);
        assert_eq!(kept(&both, 0), (true, vec!["vertex_color"]));
        let pointer = |s: &Shape| match &s.geometry {
            Geometry::Mesh(mesh) => Arc::as_ptr(mesh),
            Geometry::Analytic(_) => std::ptr::null(),
        };
        assert_eq!(pointer(&both.shapes[0]), pointer(&both.shapes[1]));
    }

    #[test]
    fn textured_lights_keep_their_coordinates() {
        let mut glowing = scene(|| {
            let mut shape = shape(&mesh(), 0);
            shape.emitter = Some(0);
            vec![shape]
        });
        glowing.emitters.push(Emitter::Area {
            shape: 0,
            radiance: lines(),
            both_sides: false,
        });
        assert_eq!(trim(&mut glowing, false).uv_meshes, 0);
    }
}
