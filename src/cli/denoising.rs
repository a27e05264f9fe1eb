//! The denoiser between a picture and the files that it is written to.

use super::Failure;
use super::console::Console;
use super::file_args::{FileArgs, OidnArgs};
use super::interrupt::Interrupt;
use super::waiting::Waiting;
use crate::image::Image;
use crate::image::denoise::{DenoiseError, Denoiser, denoised};
use crate::report::words;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// A denoiser, loaded, and who waits for it.
pub struct Denoising<'a> {
    denoiser: Denoiser,
    console: &'a Console,
    interrupt: &'a Interrupt,
}

impl<'a> Denoising<'a> {
    /// Loads the denoiser if it is asked for: before the work, for it may be missing.
    ///
    /// # Errors
    /// When it is missing or cannot be used; says how to get it.
    pub fn wanted(
        files: &FileArgs,
        console: &'a Console,
        interrupt: &'a Interrupt,
    ) -> Result<Option<Self>, Failure> {
        let load = || Self::load(&files.oidn, console, interrupt);
        files.denoise.then(load).transpose()
    }

    /// Loads the denoiser.
    ///
    /// # Errors
    /// When it is missing or cannot be used; says how to get it.
    pub fn load(
        args: &OidnArgs,
        console: &'a Console,
        interrupt: &'a Interrupt,
    ) -> Result<Self, Failure> {
        Ok(Self {
            denoiser: find(args)?,
            console,
            interrupt,
        })
    }

    /// The picture without its noise, beside which it keeps the noisy one. Where that fails, or
    /// Ctrl-C ends it, the picture as it was, and why. `interrupted` says that Ctrl-C has ended the
    /// work before.
    pub fn apply(&self, picture: Image, interrupted: bool) -> (Image, Result<(), Failure>) {
        let start = Instant::now();
        let percent = Arc::new(AtomicU32::new(0));
        let shown = percent.clone();
        let waiting = Waiting::start(self.console, move |seconds| {
            let percent = shown.load(Ordering::Relaxed);
            format!("denoising: {percent} %, {}", words::time(seconds))
        });
        match interrupted {
            true => self.interrupt.begin_anew(),
            false => self.interrupt.be_patient(),
        }
        let result = denoised(&self.denoiser, &picture, &|done| {
            percent.store((100.0 * done) as u32, Ordering::Relaxed);
            !self.interrupt.requested()
        });
        drop(waiting);
        match result {
            Ok(clean) => {
                let (by, time) = (self.denoiser.version(), start.elapsed().as_secs_f64());
                let time = words::time(time);
                tracing::info!("denoised in {time} by Open Image Denoise {by}");
                (clean, Ok(()))
            }
            Err(e) => (picture, Err(not_denoised(&e))),
        }
    }

    /// The same beside a render that goes on: nothing is shown, and where it fails the picture is
    /// as it was.
    pub fn apply_meanwhile(&self, picture: Image) -> Image {
        let go_on = |_| !self.interrupt.requested();
        denoised(&self.denoiser, &picture, &go_on).unwrap_or(picture)
    }
}

/// Loads the library.
///
/// # Errors
/// When it is missing or cannot be used; says how to get it.
pub fn find(args: &OidnArgs) -> Result<Denoiser, Failure> {
    Denoiser::find(args.oidn.as_deref()).map_err(|e| match e {
        DenoiseError::Unusable { .. } => Failure::wrong(e, HOW_TO_NAME),
        _ => Failure::refused(e, HOW_TO_GET),
    })
}

const HOW_TO_GET: &str = "\"python3 -m pip install --target oidn --no-deps pyoidn\" brings it, and \
     then --oidn oidn or TWINTREE_OIDN=oidn; so does a release from https://www.openimagedenoise.org, \
     unpacked";
const HOW_TO_NAME: &str =
    "--oidn and TWINTREE_OIDN name the library, or the folder of a release or of Python's pyoidn";

fn not_denoised(why: &DenoiseError) -> Failure {
    let later = "\"twintree denoise\" denoises an .exr later";
    if *why == DenoiseError::Cancelled {
        tracing::warn!("the picture is not denoised: {later}");
        return Failure::Interrupted;
    }
    Failure::refused(format!("the picture is not denoised: {why}"), later)
}
