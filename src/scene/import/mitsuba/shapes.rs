//! Shapes: mesh files, exact shapes, the cube, groups and their instances.

use super::importer::Importer;
use super::params::Params;
use super::pending::{PendingGeometry, PendingShape, Request};
use super::role::Role;
use crate::accel::{AnalyticKind, AnalyticShape, TriangleMesh};
use crate::math::{Affine3A, DAffine3, DVec3, Vec2};
use crate::scene::import::ImportError;
use crate::scene::import::mesh::{MeshKind, MeshOptions};
use crate::scene::{Geometry, Mesh};
use crate::texture::Texture;
use glam::DMat3;
use std::sync::Arc;

impl<'a> Importer<'a> {
    /// Imports the shape that object `index` describes, into a group or the world.
    ///
    /// # Errors
    /// When shapes hold so many others that nobody would wait for it. What else is wrong is told.
    pub fn shape(&mut self, index: usize, group: Option<u32>) -> Result<(), ImportError> {
        self.step_into(index)?;
        let params = Params::new(self.document, index);
        let read = match params.plugin() {
            // A group shows nothing until it is instanced.
            "shapegroup" => {
                self.group(index)?;
                Ok(())
            }
            "instance" if group.is_some() => {
                Err(params.error("an instance cannot stand inside a group"))
            }
            "instance" => self.instance(&params)?,
            "merge" => {
                for (_, inner) in params.children("shape") {
                    self.shape(inner, group)?;
                }
                self.done(&params);
                Ok(())
            }
            _ => self.surface(&params, index, group),
        };
        self.or_instead(index, read, "the shape is left out", |_| ());
        Ok(())
    }

    /// A shape that rays can meet.
    fn surface(
        &mut self,
        p: &Params<'a>,
        index: usize,
        group: Option<u32>,
    ) -> Result<(), ImportError> {
        let (geometry, flip_normals) = match p.plugin() {
            "obj" => (self.mesh_file(p, MeshKind::Obj, group)?, false),
            "ply" => (self.mesh_file(p, MeshKind::Ply, group)?, false),
            "serialized" => (self.mesh_file(p, MeshKind::Serialized, group)?, false),
            "cube" => (cube(p, self.place(p.to_world(), group))?, false),
            _ => (self.exact(p, group)?, p.boolean("flip_normals", false)),
        };
        let lamp = self.lamp(p)?;
        if lamp.is_some() && group.is_some() {
            return Err(p.error("a shape in a group cannot glow"));
        }
        let material = match p.child("bsdf")? {
            Some(bsdf) => self.bsdf(bsdf),
            None => self.default_bsdf(lamp.is_some()),
        };
        let radiance = lamp.flatten();
        let lamp = p.child("emitter")?;
        let lamp_id = lamp.and_then(|lamp| self.document.objects[lamp].id.clone());
        for (_, inner) in p.children("subsurface") {
            self.no_subsurface(inner);
        }
        let boundary = self.boundary(p);
        // Mitsuba measures light at shapes with sensors; only the scene's own sensor matters here.
        let _ = p.children("sensor");
        p.ignore(&["silhouette_sampling_weight"]);
        let word = match &geometry {
            PendingGeometry::File(request) => {
                let file = request.path.file_name();
                file.map_or_else(String::new, |f| f.to_string_lossy().into_owned())
            }
            PendingGeometry::Ready(_) => p.plugin().to_owned(),
        };
        let name = self.name_of(index, &word);
        self.shapes.push(PendingShape {
            name,
            geometry,
            material,
            radiance,
            lamp_id,
            flip_normals,
            group,
            boundary,
        });
        self.done(p);
        Ok(())
    }

    /// The emitter inside a shape, if there is one, and what it emits: `None` if no path from a
    /// camera ever meets that.
    fn lamp(&mut self, p: &Params<'a>) -> Result<Option<Option<Texture>>, ImportError> {
        let Some(index) = p.child("emitter")? else {
            return Ok(None);
        };
        let inner = Params::new(self.document, index);
        inner.ignore(&["sampling_weight"]);
        // The shape's boundary tells what is around it.
        inner.children("medium");
        let radiance = match inner.plugin() {
            "area" => Some(self.texture(&inner, "radiance", 1.0, Role::Light)),
            "directionalarea" => {
                inner.ignore(&["radiance"]);
                let place = self.document.location(inner.at());
                self.warnings.tell(format!(
                    "{place}: emitter \"directionalarea\" shines along its normals alone, where no path from a camera meets it: it is dark, as in Mitsuba's path tracers"
                ));
                None
            }
            plugin => {
                let message = format!("emitter \"{plugin}\" cannot stand inside a shape");
                let error = inner.error(message);
                let instead = "the shape does not shine";
                self.document.faults.add(inner.at(), error, instead);
                return Ok(None);
            }
        };
        self.done(&inner);
        Ok(Some(radiance))
    }

    fn mesh_file(
        &mut self,
        p: &Params<'a>,
        kind: MeshKind,
        group: Option<u32>,
    ) -> Result<PendingGeometry, ImportError> {
        let Some(name) = p.text("filename") else {
            return Err(p.error(format!("\"{}\" needs a \"filename\"", p.plugin())));
        };
        p.ignore(&["collapse", "srgb"]);
        let at = p.place_of("filename");
        let shape_index = match kind {
            MeshKind::Serialized => p.count("shape_index", 0, 0) as usize,
            MeshKind::Obj | MeshKind::Ply | MeshKind::Stl => 0,
        };
        let angle = p.number("max_smooth_angle");
        let options = MeshOptions {
            to_world: self.place(p.to_world(), group),
            face_normals: p.boolean("face_normals", false),
            flip_normals: p.boolean("flip_normals", false),
            // Both dialects turn v around for OBJ, whose v points up while rows of images go down.
            flip_tex_coords: p.boolean("flip_tex_coords", kind == MeshKind::Obj),
            max_smooth_angle: angle.map(|a| a as f32),
            shape_index,
            lenient: self.options.lenient,
            decode: self.options.decode,
            ..MeshOptions::default()
        };
        Ok(PendingGeometry::File(Request {
            path: self.document.resolve(at, name),
            kind,
            options,
            at,
        }))
    }

    fn exact(
        &mut self,
        p: &Params<'a>,
        group: Option<u32>,
    ) -> Result<PendingGeometry, ImportError> {
        let to_world = self.place(p.to_world(), group);
        let (kind, local) = match p.plugin() {
            "sphere" => {
                let center = p.vector("center").unwrap_or_default();
                let radius = p.positive("radius", 1.0);
                let placed =
                    DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(radius));
                (AnalyticKind::Sphere, placed)
            }
            "disk" => (AnalyticKind::Disk, DAffine3::IDENTITY),
            "cylinder" => (AnalyticKind::Cylinder, cylinder(p)?),
            _ => (AnalyticKind::Rectangle, DAffine3::IDENTITY),
        };
        let placed = to_world * local;
        let axes = placed.matrix3;
        let flat = matches!(kind, AnalyticKind::Disk | AnalyticKind::Rectangle);
        let size = if flat {
            axes.x_axis.cross(axes.y_axis).length()
        } else {
            axes.determinant().abs()
        };
        if size == 0.0 {
            let place = self.document.location(p.place_of("to_world"));
            self.warnings.tell(format!(
                "{place}: this shape is flattened to nothing and will not be seen"
            ));
        }
        let shape = AnalyticShape::new(kind, single(placed));
        Ok(PendingGeometry::Ready(Geometry::Analytic(shape)))
    }

    /// The group that object `index` describes. Its shapes are imported once.
    fn group(&mut self, index: usize) -> Result<u32, ImportError> {
        if let Some(&group) = self.group_of.get(&index) {
            return Ok(group);
        }
        let params = Params::new(self.document, index);
        let group = self.group_of.len() as u32;
        self.group_of.insert(index, group);
        for (_, inner) in params.children("shape") {
            if self.document.objects[inner].plugin == "shapegroup" {
                let error = params.error("a group cannot hold another group");
                let instead = "the inner one is left out";
                self.document.faults.add(params.at(), error, instead);
                continue;
            }
            self.shape(inner, Some(group))?;
        }
        self.done(&params);
        Ok(group)
    }

    /// The inner result says what is wrong with the instance itself.
    fn instance(&mut self, p: &Params<'a>) -> Result<Result<(), ImportError>, ImportError> {
        let inner = match p.child("shape") {
            Ok(inner) => inner,
            Err(error) => return Ok(Err(error)),
        };
        let group = match inner {
            Some(index) if self.document.objects[index].plugin == "shapegroup" => {
                self.group(index)?
            }
            _ => {
                let message = "an instance needs a \"shapegroup\" inside (often a <ref>)";
                return Ok(Err(p.error(message)));
            }
        };
        let placed = self.place(p.to_world(), None);
        self.instances.push((group, placed));
        self.done(p);
        Ok(Ok(()))
    }
}

/// A map in single precision.
pub(super) fn single(m: DAffine3) -> Affine3A {
    Affine3A::from_mat3_translation(m.matrix3.as_mat3(), m.translation.as_vec3())
}

/// The map from the unit cylinder to one from `p0` to `p1`.
fn cylinder(p: &Params) -> Result<DAffine3, ImportError> {
    let start = p.vector("p0").unwrap_or_default();
    let axis = p.vector("p1").unwrap_or(DVec3::Z) - start;
    let radius = p.positive("radius", 1.0);
    let Some(direction) = axis.try_normalize() else {
        return Err(p.error("\"p0\" and \"p1\" are the same point"));
    };
    let (s, t) = direction.any_orthonormal_pair();
    Ok(DAffine3 {
        matrix3: DMat3::from_cols(s * radius, t * radius, axis),
        translation: start,
    })
}

/// The cube from -1 to 1: two triangles a face, so that each face has its own normal and the unit
/// square as texture coordinates.
fn cube(p: &Params, to_world: DAffine3) -> Result<PendingGeometry, ImportError> {
    // Faces stay turned outwards under a mirroring map, as Mitsuba's vertex normals do.
    let inward = p.boolean("flip_normals", false) != (to_world.matrix3.determinant() < 0.0);
    let (mut positions, mut uvs, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    // Each face's normal and direction of u, as in Mitsuba's table of vertices: (0, 0) of the
    // texture lies so that v grows along u x normal.
    for (normal, u_axis) in [
        (DVec3::X, DVec3::Y),
        (DVec3::NEG_X, DVec3::Y),
        (DVec3::Y, DVec3::NEG_X),
        (DVec3::NEG_Y, DVec3::Z),
        (DVec3::Z, DVec3::Y),
        (DVec3::NEG_Z, DVec3::NEG_Y),
    ] {
        let v_axis = u_axis.cross(normal);
        let first = positions.len() as u32;
        for (u, v) in [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
            let corner = normal + u_axis * u + v_axis * v;
            positions.push(to_world.transform_point3(corner).as_vec3());
            uvs.push(Vec2::new(0.5 * (u as f32 + 1.0), 0.5 * (v as f32 + 1.0)));
        }
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            let (b, c) = if inward { (c, b) } else { (b, c) };
            triangles.push([first + a, first + b, first + c]);
        }
    }
    let triangles = TriangleMesh::new(positions, triangles).map_err(|e| p.error(e.to_string()))?;
    Ok(PendingGeometry::Ready(Geometry::Mesh(Arc::new(Mesh {
        triangles: Arc::new(triangles),
        normals: None,
        uvs: Some(Arc::new(uvs)),
        ..Mesh::default()
    }))))
}
