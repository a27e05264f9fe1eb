//! From the command line's scene to a description, for every subcommand alike.

use super::Failure;
use super::args::SceneArgs;
use crate::report::scene::TextureTotals;
use crate::scene::Description;
use crate::scene::fingerprint::fingerprint;
use crate::scene::import::{ImportOptions, mitsuba};
use crate::texture::TextureStore;
use std::sync::Arc;

/// A scene as data, with the images that its textures use.
pub struct Loaded {
    /// The scene.
    pub description: Description,
    textures: Arc<TextureStore>,
}

impl Loaded {
    /// Images that textures were made of, and the memory of their texels at this moment.
    pub fn textures(&self) -> TextureTotals {
        TextureTotals {
            count: self.textures.file_count(),
            bytes: self.textures.memory_bytes() as u64,
        }
    }

    /// The number that tells this scene from others, of a description that is not built yet.
    ///
    /// # Errors
    /// When a file that the scene names cannot be read.
    pub fn fingerprint(&self) -> Result<u64, Failure> {
        fingerprint(&self.description, &self.textures.bitmaps())
            .map_err(|e| Failure::Wrong(format!("an image of the scene cannot be read: {e}")))
    }
}

/// Reads a scene. Its warnings are logged as well as kept.
///
/// # Errors
/// When the scene, or a file that it names, cannot be used.
pub fn load(args: &SceneArgs) -> Result<Loaded, Failure> {
    let textures = Arc::new(TextureStore::new(args.texture_memory).in_halves(args.half_textures));
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
