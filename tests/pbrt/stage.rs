//! Scenes in a folder of their own.

use super::support::{SceneMaker, settings};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use twintree::accel::Backend;
use twintree::film::Film;
use twintree::scene::Description;
use twintree::scene::import::{ImportError, ImportOptions, mitsuba, pbrt};
use twintree::texture::TextureStore;

/// A folder with files.
pub struct Stage(TempDir);

impl Stage {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, bytes).expect("written");
    }

    fn options(lenient: bool) -> ImportOptions {
        let mut options = ImportOptions::new(Arc::new(TextureStore::new(1 << 24)));
        options.lenient = lenient;
        options
    }

    pub fn try_load(&self, name: &str, lenient: bool) -> Result<Description, ImportError> {
        let options = Self::options(lenient);
        let path = self.path(name);
        match Path::new(name).extension().is_some_and(|e| e == "xml") {
            true => mitsuba::load(&path, &options),
            false => pbrt::load(&path, &options),
        }
    }

    pub fn load(&self, name: &str) -> Description {
        let loaded = self.try_load(name, false);
        loaded.unwrap_or_else(|e| panic!("{e}"))
    }
}

/// A picture of a scene by its own settings.
pub fn picture(description: Description, spp: u64) -> Film {
    let mut settings = settings();
    settings.max_depth = description.render.max_depth.unwrap_or(u32::MAX);
    let maker = SceneMaker { description };
    maker.build(Backend::default()).render(&settings, spp).0
}
