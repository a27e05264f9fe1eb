//! Images from files, data URIs and buffers.
//!
//! The texture loader reads files; images inside the glTF file are put into a temporary directory
//! that only this user can read, and that is gone when the import ends: by then their texels are
//! loaded.

use super::{Importer, error, ktx2};
use crate::image::file::ImageFile;
use crate::image::passing::Passing;
use crate::scene::import::{ImportError, named};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Image files in use.
#[derive(Debug, Default)]
pub(super) struct Images {
    opened: HashMap<usize, Opened>,
    /// Where images inside the glTF file are unpacked.
    folder: Option<(TempDir, Passing)>,
}

#[derive(Debug)]
struct Opened {
    path: PathBuf,
    /// Names of the channels.
    channels: usize,
}

impl Importer<'_> {
    /// How messages call an image.
    pub(super) fn image_name(&self, index: usize) -> String {
        let image = self.document().images.get(index);
        let uri = image.and_then(|i| i.uri.as_deref());
        match uri.filter(|u| !u.starts_with("data:")) {
            Some(uri) => format!("image {index} ({uri})"),
            None => format!("image {index}"),
        }
    }

    /// A file with image `index`, and how many channels it has.
    pub(super) fn image_file(&mut self, index: usize) -> Result<(PathBuf, usize), ImportError> {
        if let Some(known) = self.images.opened.get(&index) {
            return Ok((known.path.clone(), known.channels));
        }
        let name = self.image_name(index);
        let path = self.locate(index, &name)?;
        let folder = self.path().parent().unwrap_or(Path::new(""));
        let file = ImageFile::open(&path).map_err(|e| {
            let hint = named::hint(&path, folder);
            let message = format!("{name} cannot be used: {}{hint}", e.reason);
            error(self.path(), message)
        })?;
        let channels = file.header().channels.len();
        let opened = Opened {
            path: path.clone(),
            channels,
        };
        self.images.opened.insert(index, opened);
        Ok((path, channels))
    }

    fn locate(&mut self, index: usize, name: &str) -> Result<PathBuf, ImportError> {
        let container = self.container;
        let fail = |message: String| error(&container.path, message);
        let image = container.document.images.get(index);
        let image = image.ok_or_else(|| fail(format!("there is no image {index}")))?;
        let decoded;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) if uri.starts_with("data:") => {
                decoded = container.embedded(uri, name)?;
                decoded.as_slice()
            }
            (Some(uri), _) => {
                let path = container.resolve(uri, name)?;
                return self.unpacked(index, path, name);
            }
            (None, Some(view)) => container.view(view)?,
            (None, None) => return Err(fail(format!("{name} is nowhere"))),
        };
        if ktx2::is(bytes) {
            return self.transcoded(index, bytes, name);
        }
        let stored = self.images.store(index, bytes, image.mime_type.as_deref());
        stored.map_err(|e| fail(format!("{name} cannot be unpacked: {e}")))
    }

    /// The file at `path`, or what is made of it where the texture loader does not know its format.
    fn unpacked(
        &mut self,
        index: usize,
        path: PathBuf,
        name: &str,
    ) -> Result<PathBuf, ImportError> {
        let ends = |end: &str| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case(end))
        };
        if !ends("ktx2") {
            return Ok(path);
        }
        let bytes = crate::image::mapped::open(&path);
        let bytes = bytes.map_err(|e| error(self.path(), format!("{name} cannot be read: {e}")))?;
        self.transcoded(index, &bytes, name)
    }

    /// A file made of an image of Basis Universal.
    fn transcoded(
        &mut self,
        index: usize,
        bytes: &[u8],
        name: &str,
    ) -> Result<PathBuf, ImportError> {
        let folder = self.images.folder().map_err(|e| e.to_string());
        let made = folder.and_then(|folder| {
            let path = folder.join(format!("image-{index}.png"));
            ktx2::unpack(bytes, self.options.decode, &path).map(|()| path)
        });
        made.map_err(|e| error(self.path(), format!("{name} cannot be used: {e}")))
    }
}

impl Images {
    /// Unpacks an image. Its name is always the same, since it helps to tell scenes apart; the
    /// name's end tells readers the format.
    fn store(
        &mut self,
        index: usize,
        bytes: &[u8],
        mime_type: Option<&str>,
    ) -> std::io::Result<PathBuf> {
        let suffix = match (bytes, mime_type) {
            ([0x89, b'P', b'N', b'G', ..], _) => "png",
            ([0xff, 0xd8, ..], _) => "jpg",
            ([b'R', b'I', b'F', b'F', ..], _) => "webp",
            ([_, _, _, _, b'f', b't', b'y', b'p', ..], _) => "avif",
            ([0x76, 0x2f, 0x31, 0x01, ..], _) => "exr",
            (_, Some("image/jpeg")) => "jpg",
            _ => "png",
        };
        let path = self.folder()?.join(format!("image-{index}.{suffix}"));
        std::fs::write(&path, bytes)?;
        Ok(path)
    }

    /// The directory for images that are no files, or not yet.
    pub(super) fn folder(&mut self) -> std::io::Result<PathBuf> {
        let folder = match self.folder.take() {
            Some(folder) => folder,
            None => Passing::make(|| tempfile::Builder::new().prefix("twintree-").tempdir())?,
        };
        Ok(self.folder.insert(folder).0.path().to_owned())
    }
}
