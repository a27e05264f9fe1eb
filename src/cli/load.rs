//! From the command line's scene to a description, for every subcommand alike.

use super::aov::{self, Aov};
use super::input::{Input, check_no_defines};
use super::picture_args::SizeArgs;
use super::ray_args::{AccelBuild, RayArgs};
use super::render_args::RenderArgs;
use super::scene_args::{SceneArgs, StudioArgs, UpAxis};
use super::{Failure, budget, memory, threads};
use crate::accel::{BuildQuality, BuildSettings};
use crate::image::decoded::DecodeLimit;
use crate::image::foreign;
use crate::light::{Emitter, EnvironmentImage, Lights};
use crate::report::totals::{TextureTotals, triangles};
use crate::report::words;
use crate::scene::fingerprint::{fingerprint, world_fingerprint};
use crate::scene::import::default_scene::{Aperture, Sky, Studio};
use crate::scene::import::gltf::Show;
use crate::scene::import::models::{self, ModelOptions, ModelSource};
use crate::scene::import::parts::Parts;
use crate::scene::import::{ImportOptions, OpenTexture, mitsuba, pbrt};
use crate::scene::precautions::watertight_edges;
use crate::scene::spare::{self, Trimmed};
use crate::scene::{Description, Scene, lights_of};
use crate::texture::TextureStore;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// A scene as data, with the images that its textures use. Copies share meshes and images.
#[derive(Clone)]
pub struct Loaded {
    /// The scene.
    pub description: Description,
    textures: Arc<TextureStore>,
    /// Buffers of meshes that nothing reads and that were given back.
    pub trimmed: Trimmed,
    /// Warnings that were given.
    warnings: usize,
}

impl Loaded {
    /// Where its textures are opened, and what is added to it opens more.
    pub fn store(&self) -> &TextureStore {
        &self.textures
    }

    /// Images that textures were made of, and the memory of their texels at this moment.
    pub fn textures(&self) -> TextureTotals {
        TextureTotals {
            count: self.textures.file_count(),
            bytes: self.textures.memory_bytes() as u64,
        }
    }

    /// The image files that the scene reads.
    pub fn image_files(&self) -> Vec<PathBuf> {
        let bitmaps = self.textures.bitmaps();
        let bitmaps = bitmaps.iter().map(|b| b.settings().path.clone());
        let emitters = self.description.emitters.iter();
        let around = emitters.filter_map(|emitter| match emitter {
            Emitter::EnvironmentMap { image, .. } | Emitter::Goniometric { image, .. } => {
                Some(image.path().to_owned())
            }
            _ => None,
        });
        bitmaps.chain(around).collect()
    }

    /// The number that tells this scene from others, of a description that is not built yet.
    ///
    /// # Errors
    /// When a file that the scene names cannot be read.
    pub fn fingerprint(&self) -> Result<u64, Failure> {
        fingerprint(&self.description, &self.textures.bitmaps())
            .map_err(|e| Failure::Wrong(format!("an image of the scene cannot be read: {e}")))
    }

    /// The same, whatever the camera.
    ///
    /// # Errors
    /// As [`Loaded::fingerprint`].
    pub fn world_fingerprint(&self) -> Result<u64, Failure> {
        world_fingerprint(&self.description, &self.textures.bitmaps())
            .map_err(|e| Failure::Wrong(format!("an image of the scene cannot be read: {e}")))
    }

    /// Builds the scene for the ray tracer that was asked for, in the way that was asked for or
    /// that memory allows.
    ///
    /// # Errors
    /// When the scene cannot be used, or memory does not suffice.
    pub fn build(&mut self, rays: &RayArgs) -> Result<Scene, Failure> {
        let start = Instant::now();
        let way = rays.accel_build;
        let tracer = rays.accel.unwrap_or_default();
        let load = budget::Load {
            triangles: triangles(&self.description),
            instances: self.description.instances.len() as u64,
        };
        let available = memory::available_bytes();
        let chosen = budget::choose(way, tracer.backend, load, available)?;
        if chosen == AccelBuild::Compact && way.is_none() {
            tracing::info!("memory is short: the ray tracer's trees are built small");
        }
        let settings = BuildSettings {
            quality: match chosen {
                AccelBuild::Fast => BuildQuality::Fast,
                AccelBuild::Balanced | AccelBuild::Compact => BuildQuality::Balanced,
                AccelBuild::High => BuildQuality::High,
            },
            compact: chosen == AccelBuild::Compact,
            robust: tracer.robust || watertight_edges(&self.description).on,
            threads: threads::count(),
            memory: available.map_or(0, |bytes| usize::try_from(bytes).unwrap_or(0)),
        };
        let scene = Scene::build(&mut self.description, settings, tracer.backend)?;
        tracing::debug!(
            "{} holds {}, built in {}",
            scene.rays.name(),
            words::bytes(scene.rays.memory_bytes() as u64),
            words::time(start.elapsed().as_secs_f64())
        );
        warn_of_lights(&scene.lights);
        Ok(scene)
    }

    /// Says what building the scene would find odd, without building it; how much that is.
    pub fn check(&mut self) -> usize {
        self.warnings + warn_of_lights(&lights_of(&mut self.description))
    }
}

/// Says what is odd about the lights; how much that is.
fn warn_of_lights(lights: &Lights) -> usize {
    let dark = lights.is_empty();
    if dark {
        tracing::warn!("nothing in the scene shines: the image will be black");
    }
    usize::from(dark)
}

/// What the picture that is to be made asks of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Picture {
    /// Its size.
    pub size: SizeArgs,
    /// It tells texture coordinates, whether or not anything in the scene reads them.
    pub tells_uvs: bool,
}

impl Picture {
    /// That of a render.
    pub fn of(args: &RenderArgs) -> Self {
        Self {
            size: args.picture.size,
            tells_uvs: aov::has(&args.files.aov, Aov::Uv),
        }
    }
}

/// Reads a scene or models. Warnings are logged as well as kept.
///
/// # Errors
/// When the scene, or a file that it names, cannot be used.
pub fn load(args: &SceneArgs, input: &Input, picture: Option<Picture>) -> Result<Loaded, Failure> {
    load_in(args, input, (&args.studio, NOTHING), picture)
}

/// Adds what is made elsewhere to the parts of a scene. Its textures are opened in the store.
pub type Beside<'a> = &'a dyn Fn(&mut Parts, &dyn OpenTexture) -> Result<(), Failure>;

const NOTHING: Beside = &|_, _| Ok(());

/// Reads models beside parts that are made elsewhere: the camera frames all of them. A scene takes
/// none.
///
/// # Errors
/// As [`load`].
pub fn load_beside(
    beside: Beside,
    args: &SceneArgs,
    input: &Input,
    picture: Picture,
) -> Result<Loaded, Failure> {
    load_in(args, input, (&args.studio, beside), Some(picture))
}

/// Reads a scene, or models without the light of a studio, which would stand among what is
/// measured.
///
/// # Errors
/// As [`load`].
pub fn load_unlit(args: &SceneArgs, input: &Input) -> Result<Loaded, Failure> {
    let studio = StudioArgs {
        sky: args.studio.sky.clone().or(Some(Sky::None)),
        ..args.studio.clone()
    };
    load_in(args, input, (&studio, NOTHING), None)
}

fn load_in(
    args: &SceneArgs,
    input: &Input,
    around: (&StudioArgs, Beside),
    picture: Option<Picture>,
) -> Result<Loaded, Failure> {
    let decode = DecodeLimit {
        bytes: args.limit_decoded as u64,
    };
    let textures = TextureStore::new(args.texture_memory.bytes).with_limit(decode);
    let textures = Arc::new(textures.in_halves(args.texture_memory.half));
    let mut options = ImportOptions::new(textures.clone());
    options.decode = decode;
    options.lenient = args.read.lenient;
    options.defines = args
        .read
        .define
        .iter()
        .map(|d| (d.name.clone(), d.value.clone()))
        .collect();
    let mut description = match input {
        Input::Scene(path) if pbrt::is_scene(path) => {
            check_no_defines(args)?;
            pbrt::load(path, &options)?
        }
        Input::Scene(path) => mitsuba::load(path, &options)?,
        Input::Models(sources) => load_models(sources, around, &options, picture)?,
    };
    print_warnings(&description.warnings, args);
    let warnings = description.warnings.len() + advise_on_textures(&textures);
    let trimmed = spare::trim(&mut description, picture.is_some_and(|p| p.tells_uvs));
    if trimmed.uv_bytes + trimmed.attribute_bytes > 0 {
        tracing::debug!(
            "nothing reads {} of texture coordinates and {} of attributes",
            words::bytes(trimmed.uv_bytes),
            words::bytes(trimmed.attribute_bytes)
        );
    }
    Ok(Loaded {
        description,
        textures,
        trimmed,
        warnings,
    })
}

/// Warnings that are printed, at most: further ones are in `--stats`, and with --log-level debug.
const MOST_WARNINGS: usize = 100;

/// Prints what is odd about a scene, as far as that helps: a scene may have as many warnings as
/// shapes.
fn print_warnings(warnings: &[String], args: &SceneArgs) {
    let all = tracing::enabled!(tracing::Level::DEBUG);
    let shown = if all { warnings.len() } else { MOST_WARNINGS };
    for warning in warnings.iter().take(shown) {
        tracing::warn!("{warning}");
    }
    let further = warnings.len().saturating_sub(shown);
    if further > 0 {
        tracing::warn!(
            "{}: {further} further warnings; --log-level debug prints all of them",
            args.title()
        );
    }
}

/// Says what would help where images had to be put on disk; how many warnings that takes.
fn advise_on_textures(textures: &TextureStore) -> usize {
    let (count, bytes) = textures.spilled();
    if count == 0 {
        return 0;
    }
    let images = if count == 1 { "image" } else { "images" };
    tracing::warn!(
        "{count} {images} ({}) beyond --texture-memory {}: not tiled, so the texels were put on disk; \
         maketx (openimageio-tools) makes .tx files, which are read in pieces",
        words::bytes(bytes as u64),
        words::bytes(textures.budget_bytes() as u64)
    );
    1
}

fn load_models(
    sources: &[ModelSource],
    (args, beside): (&StudioArgs, Beside),
    options: &ImportOptions,
    picture: Option<Picture>,
) -> Result<Description, Failure> {
    let z_up = args.up == UpAxis::Z;
    if let Some(path) = args.envmap.as_ref().filter(|p| !p.exists()) {
        let message = format!("there is no environment map {}", path.display());
        return Err(Failure::wrong(message, "--envmap names an image file"));
    }
    let environment = match &args.envmap {
        Some(path) => Some(Arc::new(EnvironmentImage::read(
            path,
            None,
            options.decode,
        )?)),
        None => None,
    };
    let studio = Studio {
        view: args.camera.clone(),
        look_at: args.look_at,
        fov_degrees: args.fov,
        projection: args.projection,
        aperture: args.aperture.map(|radius| Aperture {
            radius,
            focus: args.focus,
        }),
        z_up,
        sky: args.sky.clone(),
        environment,
        ground: args.ground.clone(),
        size: picture.map_or((None, None), |p| (p.size.width, p.size.height)),
    };
    let settings = ModelOptions {
        material: args.material.clone(),
        z_up,
        show: Show {
            variant: args.variant.clone(),
            moment: args.at.clone(),
        },
    };
    for source in sources {
        if let Some(foreign) = foreign::by_path(&source.path) {
            let message = format!("{} is no model but {}", source.path.display(), foreign.what);
            return Err(Failure::wrong(message, foreign.help));
        }
    }
    budget::check_files(sources)?;
    let mut parts = Parts::default();
    beside(&mut parts, &*options.textures)?;
    let parts = models::load(sources, &settings, options, parts)?;
    let description = studio.compose(parts)?;
    let exposure = description.film.exposure;
    if picture.is_some() && exposure != 0.0 {
        tracing::info!(
            "under that sun .png and .jpg get an exposure of {exposure:.1} stops, unless --exposure says otherwise"
        );
    }
    Ok(description)
}
