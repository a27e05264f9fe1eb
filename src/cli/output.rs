//! The files that a render writes: tried before the work, written after it.

use super::Failure;
use super::aov::{self, Aov};
use super::checkpoint::Checkpoint;
use super::file_args::{ExrArgs, FileArgs};
use super::input::Input;
use super::render_args::RenderArgs;
use super::targets::{Named, check_distinct, named, try_target};
use crate::film::part::{self, Packing, PartReader, Record};
use crate::film::{Film, Shard};
use crate::image::{self, Compression, Format, Image, ViewTransform, WriteOptions, atomic};
use std::path::{Path, PathBuf};

/// Pixels of an image that viewers rather read in pieces: larger EXRs are written in tiles.
const LARGE: u64 = 1 << 24;

/// What will be written.
#[derive(Debug)]
pub struct Outputs {
    images: Vec<PathBuf>,
    stats: Option<PathBuf>,
}

impl Outputs {
    /// Refuses to replace one of these files.
    ///
    /// # Errors
    /// When an output would.
    pub fn spare(&self, what: &str, files: &[PathBuf]) -> Result<(), Failure> {
        let files: Vec<Named> = files.iter().map(|path| (what, path.as_path())).collect();
        check_distinct(&self.named(), &files)
    }

    /// The outputs of a render, tried; its checkpoint, too.
    ///
    /// # Errors
    /// As [`Outputs::plan`]; also when an output would replace a file that the render reads.
    pub fn of_render(args: &RenderArgs, input: &Input) -> Result<Self, Failure> {
        let outputs = Self::plan(&args.files, input.first_path(), args.parts.shard)?;
        let mut written = outputs.named();
        let checkpoint = Checkpoint::path_of(outputs.first());
        let unfinished = atomic::unfinished(&checkpoint);
        if args.parts.saves() {
            try_target(&checkpoint)?;
            try_target(&unfinished)?;
            written.extend([
                ("--checkpoint", &*checkpoint),
                ("--checkpoint", &*unfinished),
            ]);
        }
        let files = input
            .paths()
            .into_iter()
            .map(|path| ("what is rendered", path));
        let mut read: Vec<Named> = files.collect();
        let field = args.guide.field.as_ref();
        read.extend(named(&[
            ("the reference", args.reference.as_deref()),
            ("the field", field.map(|name| name.path.as_path())),
            ("the environment map", args.scene.studio.envmap.as_deref()),
        ]));
        check_distinct(&written, &read)?;
        Ok(outputs)
    }

    /// All files, with the options that name them.
    fn named(&self) -> Vec<Named<'_>> {
        let images = self.images.iter().map(|path| ("-o", path.as_path()));
        let stats = self.stats.iter().map(|path| ("--stats", path.as_path()));
        images.chain(stats).collect()
    }

    /// Decides the names and tries every one of them: a render of an hour must not end at a typing
    /// error. A shard has one output, its part.
    ///
    /// # Errors
    /// When a name has no known format, it cannot be written, or two are the same.
    pub fn plan(args: &FileArgs, scene: &Path, shard: Option<Shard>) -> Result<Self, Failure> {
        let images = if args.output.is_empty() {
            vec![default_name(scene, shard, ".exr")?]
        } else {
            args.output.clone()
        };
        if shard.is_some() {
            check_part(&images)?;
        }
        if aov::has(&args.aov, Aov::Cryptomatte) {
            check_lossless(&args.exr)?;
        }
        Self::tried(images, args.stats.clone())
    }

    /// Images alone, every one of them tried.
    ///
    /// # Errors
    /// As [`Outputs::plan`].
    pub fn of_images(images: Vec<PathBuf>) -> Result<Self, Failure> {
        Self::tried(images, None)
    }

    fn tried(images: Vec<PathBuf>, stats: Option<PathBuf>) -> Result<Self, Failure> {
        for path in &images {
            known_format(path)?;
        }
        for path in images.iter().chain(&stats) {
            try_target(path)?;
        }
        let outputs = Self { images, stats };
        check_distinct(&outputs.named(), &[])?;
        Ok(outputs)
    }

    /// The first image, after which viewers and checkpoints are called.
    pub fn first(&self) -> &Path {
        self.images.first().map_or(Path::new(""), |p| p)
    }

    /// Whether the shard's part is there already: the very one that `record` is about. A job that a
    /// queue starts once more ends here.
    pub fn has_part(&self, ours: &Record) -> bool {
        let Ok(part) = PartReader::open(self.first()) else {
            return false;
        };
        let theirs = part.record();
        let same = (ours.shard, ours.goal, ours.region)
            == (theirs.shard, theirs.goal, theirs.region)
            && ours.identity == theirs.identity;
        if same {
            let name = self.first().display();
            tracing::info!("{name} is there already, shard {}", ours.shard);
        }
        same
    }

    /// Writes the part that a shard is.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_part(&self, record: &Record, film: &Film) -> Result<(), Failure> {
        let path = self.first();
        part::write(path, record, film, Packing::Small)
            .map_err(|e| Failure::Refused(e.to_string()))?;
        tracing::info!("wrote {}, shard {}", path.display(), record.shard);
        Ok(())
    }

    /// Writes all images, and goes on with the others where one fails.
    ///
    /// # Errors
    /// Everything that failed.
    pub fn write_images(
        &self,
        picture: &Image,
        exr: &ExrArgs,
        exposure: f32,
        view: &ViewTransform,
    ) -> Result<(), Failure> {
        let options = WriteOptions {
            pixel_type: None,
            compression: exr.compression,
            tiled: u64::from(picture.width) * u64::from(picture.height) > LARGE,
            exposure,
            view: view.clone(),
        };
        let mut failures = Vec::new();
        for path in &self.images {
            let mut options = options.clone();
            if Format::of(path) == Ok(Format::Exr) {
                options.pixel_type = Some(exr.format);
            } else if Format::of(path) == Ok(Format::Jpeg) {
                options.compression = Compression::Default;
            }
            match image::write(path, picture, &options) {
                Ok(()) => tracing::info!("wrote {}", path.display()),
                Err(e) => failures.push(match rescue(path, picture, &options) {
                    Some(kept) => format!("{e}\n  help: the image is kept in {}", kept.display()),
                    None => e.to_string(),
                }),
            }
        }
        if failures.is_empty() {
            return Ok(());
        }
        Err(Failure::Refused(failures.join("\nerror: ")))
    }

    /// Writes the measurements, if they were asked for.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_stats(&self, json: &str) -> Result<(), Failure> {
        write_if_wanted(self.stats.as_deref(), json)
    }
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// When the file cannot be written.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    atomic::replace(path, |file| {
        std::fs::write(file, &content).map_err(|e| e.to_string())
    })
    .map_err(|e| Failure::Refused(e.to_string()))
}

/// Writes measurements, if a file for them was named.
///
/// # Errors
/// When the file cannot be written.
pub fn write_if_wanted(path: Option<&Path>, json: &str) -> Result<(), Failure> {
    path.map_or(Ok(()), |path| write_file(path, json))
}

/// Writes an image that cannot go where it should (the disk is full, the directory has gone) to the
/// directory for temporary files: hours of work may be in it.
fn rescue(path: &Path, picture: &Image, options: &WriteOptions) -> Option<PathBuf> {
    let name = path.file_name()?.to_string_lossy();
    let name = format!("twintree-{}-{name}", std::process::id());
    let kept = std::env::temp_dir().join(name);
    image::write(&kept, picture, options).ok().map(|()| kept)
}

/// The scene's name with another extension, in the current directory; the shard's number before
/// that.
///
/// # Errors
/// When the scene has no name.
pub fn default_name(
    scene: &Path,
    shard: Option<Shard>,
    extension: &str,
) -> Result<PathBuf, Failure> {
    let stem = scene.file_stem().ok_or_else(|| {
        let help = "name a scene file such as scene.xml";
        Failure::wrong(
            format!("{} is not the name of a file", scene.display()),
            help,
        )
    })?;
    let mut name = stem.to_owned();
    if let Some(Shard { index, count }) = shard {
        name.push(format!(".{index}-of-{count}"));
    }
    name.push(extension);
    Ok(name.into())
}

/// What stands for names in mattes is kept to the last bit, or they are lost.
///
/// # Errors
/// When the images are to be packed with loss.
pub fn check_lossless(exr: &ExrArgs) -> Result<(), Failure> {
    if exr.compression != Compression::Dwaa {
        return Ok(());
    }
    Err(Failure::wrong(
        "--compression dwaa is lossy and would destroy the layers of --aov cryptomatte",
        "give --compression zip or piz, or leave cryptomatte out",
    ))
}

/// A shard is written into one file, which is no picture yet.
fn check_part(outputs: &[PathBuf]) -> Result<(), Failure> {
    match outputs {
        [one] if Format::of(one) == Ok(Format::Exr) => Ok(()),
        _ => Err(Failure::wrong(
            "a shard is written into one .exr file",
            "give one -o, and name the images when you merge",
        )),
    }
}

/// Finds out before the work whether an image can be written.
///
/// # Errors
/// When the name tells no format, this build does not have it, or OpenImageIO cannot be loaded.
pub fn check_format(path: &Path) -> Result<(), Failure> {
    known_format(path)?;
    load_library()
}

/// # Errors
/// When the name tells no format, or this build does not have it.
fn known_format(path: &Path) -> Result<(), Failure> {
    let format = Format::of(path)?;
    if cfg!(not(feature = "oiio")) && format == Format::Tiff {
        return Err(Failure::wrong(
            format!("{}: this build writes no TIFF", path.display()),
            "take .exr, or compile with the feature \"oiio\"",
        ));
    }
    Ok(())
}

/// Waits until OpenImageIO is loaded, without which this build writes no image.
///
/// # Errors
/// When it cannot be loaded.
pub fn load_library() -> Result<(), Failure> {
    image::load_library().map_err(|why| Failure::refused(why, "install OpenImageIO's library"))
}
