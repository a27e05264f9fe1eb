//! Tests of the importer as a whole.

mod broken;
mod emitters;
mod far_away;
mod growth;
mod left_out;
mod media;
mod paths;
mod plugins;
mod render_settings;
mod together;
mod whole_scenes;

use crate::image::ImageError;
use crate::image::decoded::DecodeLimit;
use crate::math::Rgb;
use crate::scene::import::mesh::{Loaded, MeshKind, MeshOptions};
use crate::scene::import::{ImportError, ImportOptions, OpenTexture};
use crate::scene::{Description, Mesh};
use crate::texture::{BitmapSettings, Texture, TextureStore};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Remembers what was asked for and opens nothing: every image is a grey by its own number.
#[derive(Default)]
struct Asked(Mutex<Vec<BitmapSettings>>);

impl OpenTexture for Asked {
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        let mut list = self.0.lock().unwrap();
        list.push(settings);
        // Below 1, so that it is a reflectance as well.
        Ok(Texture::Constant(Rgb::splat(list.len() as f32 / 4096.0)))
    }
}

/// A mesh loader for tests that are not about meshes: one triangle.
fn one_triangle(_: &Path, _: MeshKind, options: &MeshOptions) -> Result<Loaded, ImportError> {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = corners
        .map(|c| options.to_world.transform_point3(c.into()).as_vec3())
        .to_vec();
    let triangles = crate::accel::TriangleMesh::new(positions, vec![[0, 1, 2]]).unwrap();
    Ok(Loaded {
        images: Vec::new(),
        mesh: Mesh {
            triangles: Arc::new(triangles),
            ..Mesh::default()
        },
        warnings: Vec::new(),
        face_materials: Default::default(),
    })
}

/// A directory with a scene and what it names.
pub(in super::super) struct Stage {
    directory: tempfile::TempDir,
    textures: Arc<Asked>,
    options: ImportOptions,
}

impl Stage {
    pub(in super::super) fn new() -> Self {
        let textures = Arc::new(Asked::default());
        let mut options = ImportOptions::new(textures.clone());
        options.load_mesh = one_triangle;
        Self {
            directory: tempfile::tempdir().unwrap(),
            textures,
            options,
        }
    }

    pub(in super::super) fn file(&self, name: &str, text: &str) {
        let path = self.directory.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    pub(in super::super) fn define(mut self, name: &str, value: &str) -> Self {
        self.options.defines.push((name.into(), value.into()));
        self
    }

    fn lenient(mut self) -> Self {
        self.options.lenient = true;
        self
    }

    /// Reads textures and meshes from files, instead of standing in for them.
    fn with_files(mut self) -> Self {
        self.options.textures = Arc::new(TextureStore::new(1 << 24));
        self.options.load_mesh = crate::scene::import::mesh::load;
        self
    }

    /// Limits what files may grow to.
    fn limit(&mut self, bytes: u64) {
        let decode = DecodeLimit { bytes };
        self.options.decode = decode;
        self.options.textures = Arc::new(TextureStore::new(1 << 28).with_limit(decode));
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.directory.path().join(name)
    }

    /// Writes an EXR of `size` with that value in every channel of every pixel.
    fn exr(&self, name: &str, size: usize, value: f32) {
        let pixel = |_, _| (value, value, value);
        exr::prelude::write_rgb_file(self.path(name), size, size, pixel).unwrap();
    }

    /// Loads `text` as the scene.
    pub(in super::super) fn load(&self, text: &str) -> Result<Description, ImportError> {
        self.file("scene.xml", text);
        super::load(&self.directory.path().join("scene.xml"), &self.options)
    }

    /// Loads a Mitsuba 3 scene with `inside`, which must succeed.
    pub(in super::super) fn modern(&self, inside: &str) -> Description {
        let text = format!("<scene version='3.0.0'>{SENSOR}{inside}</scene>");
        self.load(&text).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Loads a Mitsuba 0.6 scene with `inside`, which must succeed.
    fn classic(&self, inside: &str) -> Description {
        let text = format!("<scene version='0.6.0'>{SENSOR}{inside}</scene>");
        self.load(&text).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The error of a Mitsuba 3 scene with `inside`.
    fn error(&self, inside: &str) -> ImportError {
        let text = format!("<scene version='3.0.0'>{SENSOR}{inside}</scene>");
        match self.load(&text) {
            Ok(_) => panic!("this should not load: {inside}"),
            Err(error) => error,
        }
    }
}

const SENSOR: &str = "<sensor type='perspective'><film type='hdrfilm'/></sensor>";
