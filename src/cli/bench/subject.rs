//! What is traced: a scene, or a mesh file with a camera put in front of it.

use crate::accel::{self, Backend, Bounds, BuildSettings, Shape, World};
use crate::bsdf::Materials;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::cli::args::SceneArgs;
use crate::cli::{Failure, load, threads};
use crate::film::{FilmDescription, FilmKind, filter::Filter};
use crate::math::{DAffine3, DVec3};
use crate::scene::build::world_of;
use crate::scene::description::RenderDescription;
use crate::scene::import::mesh::{self, MeshKind, MeshOptions};
use crate::scene::{Description, Geometry, Scene, description};
use std::path::Path;
use std::sync::Arc;

/// Geometry to trace.
pub struct Subject {
    /// What the tracers to be measured are built of.
    pub world: World,
    /// The scene, with a tracer of its own: it says where rays begin.
    pub scene: Scene,
    /// The camera.
    pub camera: CameraDescription,
    /// Width over height of its film.
    pub aspect: f64,
    /// Triangles, instances counted once.
    pub triangles: u64,
}

impl Subject {
    /// Loads a scene or, by the ending of its name, a mesh.
    ///
    /// # Errors
    /// When the file cannot be used.
    pub fn load(args: &SceneArgs) -> Result<Self, Failure> {
        let mut description = match MeshKind::from_path(&args.scene) {
            Some(kind) => of_mesh(&args.scene, kind, args.lenient)?,
            None => load::load(args)?.description,
        };
        let world = world_of(&description, &description.materials);
        let triangles = crate::report::scene::triangles(&description);
        let settings = BuildSettings {
            robust: true,
            threads: threads::count(),
            ..BuildSettings::default()
        };
        let scene = Scene::build(&mut description, settings, Backend::default())?;
        let film = &description.film;
        Ok(Self {
            world,
            scene,
            camera: description.camera,
            aspect: f64::from(film.width.max(1)) / f64::from(film.height.max(1)),
            triangles,
        })
    }
}

/// A description of the mesh alone.
fn of_mesh(path: &Path, kind: MeshKind, lenient: bool) -> Result<Description, Failure> {
    let options = MeshOptions {
        lenient,
        ..MeshOptions::default()
    };
    let loaded = mesh::load(path, kind, &options)?;
    for warning in &loaded.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
    let mesh = Arc::new(loaded.mesh);
    let bounds = bounds_of(&mesh.triangles);
    let shape = description::Shape {
        name: path.display().to_string(),
        geometry: Geometry::Mesh(mesh),
        material: 0,
        emitter: None,
        flip_normals: false,
        group: None,
    };
    Ok(Description {
        shapes: vec![shape],
        groups: 0,
        instances: Vec::new(),
        materials: Materials::default(),
        emitters: Vec::new(),
        camera: camera_before(bounds),
        film: FilmDescription {
            width: 512,
            height: 512,
            crop: None,
            filter: Filter::Box { radius: 0.5 },
            kind: FilmKind::Hdr,
            exposure: 0.0,
        },
        render: RenderDescription::default(),
        warnings: Vec::new(),
    })
}

fn bounds_of(mesh: &Arc<accel::TriangleMesh>) -> Bounds {
    let world = World {
        geometries: vec![accel::Geometry {
            id: 0,
            shape: Shape::Triangles(mesh.clone()),
            masked: false,
        }],
        ..World::default()
    };
    accel::world_bounds(&world)
}

/// A camera that has all of the bounds in its picture, obliquely from the front and above.
fn camera_before(bounds: Bounds) -> CameraDescription {
    /// Distance in radii of the bounds.
    const FAR: f64 = 2.5;
    let backward = DVec3::new(0.5, 0.45, 0.75).normalize();
    let (center, radius) = (
        bounds.center().as_dvec3(),
        f64::from(bounds.radius()).max(1e-30),
    );
    let forward = -backward;
    let left = DVec3::Y.cross(forward).normalize();
    let axes = glam::DMat3::from_cols(left, forward.cross(left), forward);
    CameraDescription {
        to_world: DAffine3 {
            matrix3: axes,
            translation: center + backward * (FAR * radius),
        },
        projection: Projection::Perspective {
            fov_degrees: 2.0 * (1.0 / FAR).asin().to_degrees(),
            fov_axis: FovAxis::Smaller,
            principal_point: [0.0; 2],
        },
        near_clip: 0.0,
        far_clip: f64::INFINITY,
    }
}
