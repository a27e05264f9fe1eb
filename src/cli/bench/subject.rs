//! What is traced: a scene, or models with a camera put in front of them.

use crate::accel::{Backend, BuildSettings, World};
use crate::camera::CameraDescription;
use crate::cli::input::Input;
use crate::cli::scene_args::SceneArgs;
use crate::cli::{Failure, load, threads};
use crate::scene::Scene;
use crate::scene::build::world_of;

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
    /// Memory of the meshes.
    pub geometry_bytes: u64,
}

impl Subject {
    /// Loads a scene or models.
    ///
    /// # Errors
    /// When a file cannot be used.
    pub fn load(args: &SceneArgs) -> Result<Self, Failure> {
        let named = Input::of(args)?;
        let mut description = load::load_unlit(args, &named)?.description;
        let world = world_of(&description, &description.materials);
        let triangles = crate::report::totals::triangles(&description);
        let geometry_bytes = crate::report::totals::geometry_bytes(&description);
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
            geometry_bytes,
        })
    }
}
