//! What an importer is told besides the file.

use super::ImportError;
use super::mesh::{self, Loaded, MeshKind, MeshOptions};
use crate::image::ImageError;
use crate::image::decoded::DecodeLimit;
use crate::texture::{BitmapSettings, Texture, TextureStore};
use std::path::Path;
use std::sync::Arc;

/// Opens image textures for an importer. [`TextureStore`] is the one that reads files.
pub trait OpenTexture: Send + Sync {
    /// Opens an image texture.
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError>;
}

impl OpenTexture for TextureStore {
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        TextureStore::open(self, settings)
    }
}

/// Reads a mesh file; [`mesh::load`] is the one that does.
pub type LoadMesh = fn(&Path, MeshKind, &MeshOptions) -> Result<Loaded, ImportError>;

/// What an importer is told besides the file.
#[derive(Clone)]
pub struct ImportOptions {
    /// Values of `$name` in the scene (`-D name=value`); they win over the scene's own defaults.
    pub defines: Vec<(String, String)>,
    /// Go on without what is missing or wrong, with a warning for each that says what takes its
    /// place.
    pub lenient: bool,
    /// Where image textures come from.
    pub textures: Arc<dyn OpenTexture>,
    /// How mesh files are read.
    pub load_mesh: LoadMesh,
    /// How much a file may grow when it is decoded.
    pub decode: DecodeLimit,
}

impl ImportOptions {
    /// No definitions, strict, meshes from files.
    pub fn new(textures: Arc<dyn OpenTexture>) -> Self {
        Self {
            defines: Vec::new(),
            lenient: false,
            textures,
            load_mesh: mesh::load,
            decode: DecodeLimit::default(),
        }
    }
}

impl std::fmt::Debug for ImportOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ImportOptions")
            .field("defines", &self.defines)
            .field("lenient", &self.lenient)
            .finish_non_exhaustive()
    }
}
