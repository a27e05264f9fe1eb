//! Files of fields: reading one, writing one, and what is refused.

use super::guide_args::{FieldName, Guide as Way, GuideArgs};
use super::{Failure, output};
use crate::guide::FieldFile;
use crate::integrate::training::extend::check_scene;
use crate::report::words;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// A field that was read.
pub struct Opened {
    /// Its name.
    pub path: PathBuf,
    /// What is in it.
    pub file: FieldFile,
    /// A number that tells it from others.
    pub fingerprint: u64,
    /// Whether it may be of another scene.
    pub any_scene: bool,
}

impl Opened {
    /// Reads a field.
    ///
    /// # Errors
    /// When it cannot be read, is not a field, or is damaged.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = crate::image::regular::read(path)
            .map_err(|e| Failure::Wrong(format!("{} cannot be read: {e}", path.display())))?;
        let file = FieldFile::from_bytes(&bytes)
            .map_err(|e| Failure::Wrong(format!("{}: {e}", path.display())))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            fingerprint: xxh3_64(&bytes),
            any_scene: false,
        })
    }

    /// The same, of a field that may be of any scene if its name says so.
    ///
    /// # Errors
    /// As [`Opened::read`].
    pub fn named(name: &FieldName) -> Result<Self, Failure> {
        Ok(Self {
            any_scene: name.any_scene,
            ..Self::read(&name.path)?
        })
    }

    /// Refuses a field of another scene; one that may be of any scene is only warned about.
    ///
    /// # Errors
    /// When it is of another scene.
    pub fn check(&self, scene: u64) -> Result<(), Failure> {
        let Err(why) = check_scene(self.file.trainer.settings(), scene) else {
            return Ok(());
        };
        let message = format!("{}: {why}", self.path.display());
        if self.any_scene {
            tracing::warn!("{message}");
            return Ok(());
        }
        let help = "learn one with \"twintree train\", or take it all the same as any:FILE";
        Err(Failure::wrong(message, help))
    }
}

/// The field that a render is to be guided by, if it is in a file.
///
/// # Errors
/// When it cannot be used, or guiding is switched off beside it.
pub fn wanted_file(args: &GuideArgs) -> Result<Option<Opened>, Failure> {
    check_way(args)?;
    args.field.as_ref().map(Opened::named).transpose()
}

/// Refuses a field beside a way of guiding that has none of its kind.
///
/// # Errors
/// When guiding is switched off, or another way is asked for.
pub fn check_way(args: &GuideArgs) -> Result<(), Failure> {
    if args.field.is_none() {
        return Ok(());
    }
    if args.guide == Some(Way::None) {
        let help = "leave one of them away";
        return Err(Failure::wrong(
            "--guide none does not go with --field",
            help,
        ));
    }
    if let Some(way @ (Way::Gmm | Way::Ppg)) = args.guide {
        let message = format!(
            "--guide {} does not go with --field: only double hierarchies are kept in files",
            if way == Way::Gmm { "gmm" } else { "ppg" }
        );
        let help = match way {
            Way::Gmm => "leave --field away: the mixtures are learned before rendering",
            _ => "leave --field away: the tree is learned while rendering",
        };
        return Err(Failure::wrong(message, help));
    }
    Ok(())
}

/// What a field has learned from, in words.
pub fn records(file: &FieldFile) -> String {
    format!(
        "{} photons and {} camera paths",
        words::count(file.sample_ranges.photons.count() as f64),
        words::count(file.sample_ranges.paths.count() as f64)
    )
}

/// Writes a field, whole or not at all.
///
/// # Errors
/// When the system refuses.
pub fn write(path: &Path, file: &FieldFile) -> Result<(), Failure> {
    let bytes = file.to_bytes();
    output::write_file(path, &bytes)?;
    tracing::info!(
        "wrote {}: {}, {}",
        path.display(),
        records(file),
        words::bytes(bytes.len() as u64)
    );
    Ok(())
}
