//! From the command line's scene to a description, for every subcommand alike.

use super::Failure;
use super::args::SceneArgs;
use crate::image::ImageError;
use crate::report::scene::TextureTotals;
use crate::scene::Description;
use crate::scene::import::{ImportOptions, OpenTexture, mitsuba};
use crate::texture::{BitmapSettings, Texture, TextureStore};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene as data, with the images that its textures use.
pub struct Loaded {
    /// The scene.
    pub description: Description,
    textures: Arc<Counted>,
}

impl Loaded {
    /// Image files that textures were made of, and the memory of their texels at this moment.
    pub fn textures(&self) -> TextureTotals {
        TextureTotals {
            count: self.textures.files().len(),
            bytes: self.textures.store.memory_bytes() as u64,
        }
    }
}

/// Reads a scene. Its warnings are logged as well as kept.
///
/// # Errors
/// When the scene, or a file that it names, cannot be used.
pub fn load(args: &SceneArgs) -> Result<Loaded, Failure> {
    let textures = Arc::new(Counted {
        store: TextureStore::new(args.texture_memory),
        opened: Mutex::default(),
    });
    let mut options = ImportOptions::new(textures.clone());
    options.lenient = args.lenient;
    options.defines = args
        .define
        .iter()
        .map(|d| (d.name.clone(), d.value.clone()))
        .collect();
    let description = mitsuba::load(&args.scene, &options)?;
    for warning in &description.warnings {
        tracing::warn!("{warning}");
    }
    Ok(Loaded {
        description,
        textures,
    })
}

/// A texture store that remembers which files were asked for.
struct Counted {
    store: TextureStore,
    opened: Mutex<BTreeSet<PathBuf>>,
}

impl Counted {
    fn files(&self) -> std::sync::MutexGuard<'_, BTreeSet<PathBuf>> {
        // A set of names is whole at any moment.
        self.opened.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl OpenTexture for Counted {
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        let path = settings.path.clone();
        let texture = self.store.open(settings)?;
        self.files().insert(path);
        Ok(texture)
    }
}
