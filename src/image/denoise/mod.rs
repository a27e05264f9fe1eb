//! Denoising by Intel Open Image Denoise 2 (OIDN).
//!
//! OIDN is a neural network that tells noise from detail with the help of two more images: albedo
//! and normal of what is seen. Those are noisy, too (lens and motion blur, mirrors), so each is
//! filtered by itself first, and then counts as clean: the way of the best quality in OIDN's
//! manual.
//!
//! The library is loaded when it is asked for ([`Denoiser::find`] says from where); neither the
//! program nor its build needs it. It runs on the processor, on as many threads as the program has.
//!
//! ```no_run
//! use std::path::Path;
//! use twintree::image::denoise::{Denoiser, denoised};
//! let noisy = twintree::image::read(Path::new("noisy.exr"))?;
//! let clean = denoised(&Denoiser::find(None)?, &noisy, &|_| true)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod device;
mod find;
mod library;
mod picture;

pub use picture::{Known, NOISY, denoised, known};

use device::{Device, Plane};
use library::Functions;
use std::path::{Path, PathBuf};

/// The oldest version whose functions are those that are called.
const OLDEST: i32 = 20_000;

/// Why there is no denoised picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DenoiseError {
    /// Nobody has named the library, and it is in none of the usual places.
    #[error("Open Image Denoise, which takes the noise away, is not installed")]
    Missing,
    /// There is no library where one was named, or it cannot be used.
    #[error("{}: {reason}", path.display())]
    Unusable {
        /// What was named.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The library could not do it.
    #[error("Open Image Denoise: {0}")]
    Failed(String),
    /// The one who watched its progress has ended it.
    #[error("the denoiser was interrupted")]
    Cancelled,
}

/// A noisy image and what is known besides: three numbers a pixel, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<'a> {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Linear radiance, any unit.
    pub color: &'a [f32],
    /// Albedo of what is seen, 0 to 1, and its normal, each component -1 to 1, of any length.
    pub features: Option<[&'a [f32]; 2]>,
}

/// Is told the share that is done, 0 to 1, and says whether to go on. Any thread may call it.
pub type Progress<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// Open Image Denoise, loaded.
#[derive(Clone, Debug)]
pub struct Denoiser {
    functions: Functions,
    version: i32,
}

impl Denoiser {
    /// Loads the library: `path`, or else what the environment variable `TWINTREE_OIDN` says, or
    /// what the system's loader finds, or that of the Python package pyoidn in the environment of
    /// `VIRTUAL_ENV` or `CONDA_PREFIX`, in `~/.local` or in `/usr/local`. A path is the library's,
    /// or a folder's: with the library, with a release, of the package or around it.
    ///
    /// # Errors
    /// When it is not there, of another version, or does not run on this processor.
    pub fn find(path: Option<&Path>) -> Result<Self, DenoiseError> {
        if let Some(path) = find::named(path) {
            let unusable = |reason: String| DenoiseError::Unusable {
                path: path.clone(),
                reason,
            };
            let library = find::library_at(&path);
            let none = || unusable("there is no libOpenImageDenoise.so.2".into());
            return Self::load(library.ok_or_else(none)?.as_os_str()).map_err(unusable);
        }
        let mut error = DenoiseError::Missing;
        for name in find::usual() {
            match Self::load(&name) {
                Ok(denoiser) => return Ok(denoiser),
                // What the loader does not find is not there; what was found by its path is.
                Err(reason) if Path::new(&name).is_absolute() => {
                    let path = name.into();
                    error = DenoiseError::Unusable { path, reason };
                }
                Err(_) => {}
            }
        }
        Err(error)
    }

    fn load(name: &std::ffi::OsStr) -> Result<Self, String> {
        let functions = Functions::load(name)?;
        let device = Device::new(functions, 1).map_err(|e| e.to_string())?;
        let version = device.version();
        if version < OLDEST {
            return Err(format!("version {} is too old: 2.0", words(version)));
        }
        Ok(Self { functions, version })
    }

    /// Version of the library, such as `2.5.1`.
    pub fn version(&self) -> String {
        words(self.version)
    }

    /// The image without its noise. The same bits on any number of threads.
    ///
    /// # Errors
    /// When `progress` ends it, or memory runs out.
    ///
    /// # Panics
    /// When an image is not of the size that is said.
    pub fn denoise(&self, noisy: &Noisy, progress: Progress) -> Result<Vec<f32>, DenoiseError> {
        let device = Device::new(self.functions, rayon::current_num_threads())?;
        let size = [noisy.width, noisy.height];
        let runs = if noisy.features.is_some() { 3.0 } else { 1.0 };
        let part = |before: f64| move |done: f64| progress((before + done) / runs);
        let mut clean = vec![0.0; noisy.color.len()];
        let color = Plane::Read(c"color", noisy.color);
        let output = Plane::Write(c"output", &mut clean);
        let Some(features) = noisy.features else {
            device.run(size, &mut [color, output], &[c"hdr"], &part(0.0))?;
            return Ok(clean);
        };
        let [mut albedo, mut normal] = features.map(<[f32]>::to_vec);
        let mut alone = [Plane::Both([c"albedo", c"output"], &mut albedo)];
        device.run(size, &mut alone, &[], &part(0.0))?;
        let mut alone = [Plane::Both([c"normal", c"output"], &mut normal)];
        device.run(size, &mut alone, &[], &part(1.0))?;
        let [albedo, normal] = [
            Plane::Read(c"albedo", &albedo),
            Plane::Read(c"normal", &normal),
        ];
        let mut planes = [color, albedo, normal, output];
        device.run(size, &mut planes, &[c"hdr", c"cleanAux"], &part(2.0))?;
        Ok(clean)
    }
}

fn words(version: i32) -> String {
    format!(
        "{}.{}.{}",
        version / 10_000,
        version / 100 % 100,
        version % 100
    )
}
