//! What a scene holds between renders: what was read and built serves the next one of the same kind.

use crate::additions::{self, Addition};
use crate::failure::Fault;
use crate::{words, work};
use std::ffi::OsString;
use std::sync::Arc;
use std::time::Instant;
use twintree::cli::args::Command;
use twintree::cli::input::Input;
use twintree::cli::load::{Loaded, Picture, load, load_beside};
use twintree::cli::picture_args::SizeArgs;
use twintree::cli::prepared::Times;
use twintree::cli::ray_args::RayArgs;
use twintree::cli::scene_args::SceneArgs;
use twintree::report::totals::triangles;
use twintree::scene::import::OpenTexture;
use twintree::scene::import::parts::Parts;

/// A scene with its options, and what was made of it.
pub struct State {
    /// Where it comes from.
    pub args: SceneArgs,
    /// Files that are read.
    pub input: Arc<Input>,
    /// Options, as words.
    pub keywords: Vec<String>,
    /// What it gets beside its files.
    pub additions: Vec<Addition>,
    /// Of a scene file, what it says, with texture coordinates that nothing reads or without.
    base: Option<(bool, Loaded)>,
    kept: Option<Kept>,
}

/// What is made anew for another picture: of models the size, and texture coordinates that nothing
/// but a layer reads.
type Key = (Option<u32>, Option<u32>, bool);

/// What was made for the last render, and serves the next one of the same kind.
struct Kept {
    key: Key,
    loaded: Arc<Loaded>,
    built: Option<(String, Arc<twintree::scene::Scene>)>,
    times: Times,
}

/// A scene to render from.
pub struct Ready {
    /// As data.
    pub loaded: Arc<Loaded>,
    /// As the ray tracer has it.
    pub scene: Arc<twintree::scene::Scene>,
    /// What making it took.
    pub times: Times,
    /// Where it comes from.
    pub args: SceneArgs,
}

impl State {
    /// Reads options; `files` are none for a scene of arrays.
    pub fn new(files: Vec<OsString>, keywords: Vec<String>) -> Result<Self, Fault> {
        // A name for messages and statistics.
        let named = match files.as_slice() {
            [] => vec!["arrays".into()],
            _ => files.clone(),
        };
        let Command::Render(args) = words::read("render", &named, &keywords)? else {
            return Err(Fault::Runtime("another command was read".into()));
        };
        let input = match files.as_slice() {
            [] => Input::Models(Vec::new()),
            _ => Input::of(&args.scene)?,
        };
        Ok(Self {
            args: args.scene,
            input: Arc::new(input),
            keywords,
            additions: Vec::new(),
            base: None,
            kept: None,
        })
    }

    /// What decides whether the scene is made anew for a picture.
    fn key(&self, picture: Picture) -> Key {
        let SizeArgs { width, height } = picture.size;
        match &*self.input {
            Input::Models(_) => (width, height, picture.tells_uvs),
            // A scene file's camera does not follow the size.
            Input::Scene(_) => (None, None, picture.tells_uvs),
        }
    }

    /// The scene as data, for a picture.
    fn loaded(&mut self, picture: Picture) -> Result<Loaded, Fault> {
        if let Input::Models(_) = &*self.input {
            let beside = |parts: &mut Parts, textures: &dyn OpenTexture| {
                additions::add_all(&self.additions, parts, textures)
            };
            return Ok(load_beside(&beside, &self.args, &self.input, picture)?);
        }
        let known = self
            .base
            .as_ref()
            .filter(|(uvs, _)| *uvs == picture.tells_uvs);
        let mut loaded = match known {
            Some((_, base)) => base.clone(),
            None => {
                let base = load(&self.args, &self.input, Some(picture))?;
                self.base = Some((picture.tells_uvs, base.clone()));
                base
            }
        };
        additions::add_to(&mut loaded, &self.additions)?;
        Ok(loaded)
    }

    /// The scene as data, of what is kept or made anew.
    fn kept(&mut self, picture: Picture) -> Result<&mut Kept, Fault> {
        let key = self.key(picture);
        let kept = match self.kept.take().filter(|kept| kept.key == key) {
            Some(kept) => kept,
            None => {
                let start = Instant::now();
                let loaded = self.loaded(picture)?;
                let times = Times {
                    load: start.elapsed().as_secs_f64(),
                    triangles: triangles(&loaded.description),
                    ..Times::default()
                };
                Kept {
                    key,
                    loaded: Arc::new(loaded),
                    built: None,
                    times,
                }
            }
        };
        Ok(self.kept.insert(kept))
    }

    /// What the next render needs is made anew.
    pub fn forget(&mut self) {
        self.kept = None;
    }

    /// The scene as data, of its own size.
    pub fn read(&mut self) -> Result<Arc<Loaded>, Fault> {
        work::own_scenes()?;
        Ok(self.kept(plain(SizeArgs::default()))?.loaded.clone())
    }

    /// The scene for a render, of what is kept or made anew.
    pub fn ready(&mut self, picture: Picture, rays: &RayArgs) -> Result<Ready, Fault> {
        work::own_scenes()?;
        let args = self.args.clone();
        let kept = self.kept(picture)?;
        let how = format!("{rays:?}");
        let built = kept.built.as_ref().filter(|(other, _)| *other == how);
        let scene = match built {
            Some((_, scene)) => scene.clone(),
            None => {
                let start = Instant::now();
                // Building takes the shapes out of what it is given.
                let scene = Arc::new(Loaded::clone(&kept.loaded).build(rays)?);
                kept.times.build = start.elapsed().as_secs_f64();
                kept.built = Some((how, scene.clone()));
                scene
            }
        };
        Ok(Ready {
            loaded: kept.loaded.clone(),
            scene,
            times: kept.times,
            args,
        })
    }
}

/// A picture of a size, without the layer of texture coordinates.
pub fn plain(size: SizeArgs) -> Picture {
    Picture {
        size,
        tells_uvs: false,
    }
}
