//! Opening tiled images in OpenImageIO's cache.

use super::cached::Cached;
use super::load::Plan;
use super::pyramid::half_size;
use super::texels::{Source, Texels};
use crate::image::ImageError;
use crate::image::header::Level;
use crate::image::oiio::textures::TextureSystem;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// Opens an image in the cache. Its mean costs one pass over the file, or over the coarsest of its
/// own mip levels that still has 4096 texels.
pub(super) fn open(
    mut plan: Plan,
    system: Arc<TextureSystem>,
    path: &Path,
) -> Result<Texels, ImageError> {
    let error = |why: String| ImageError::new(path, format!("the image cannot be read: {why}"));
    let first = plan.channels[0];
    let handle = system.open(path).map_err(error)?;
    let size = plan.file.header().level;
    let mut levels = vec![size];
    while plan.file.seek(0, levels.len() as u32)? {
        levels.push(plan.file.header().level);
    }
    let has_own = levels.len() > 1;
    let useful = |l: &Level| u64::from(l.width) * u64::from(l.height) >= 4096;
    let surveyed = levels.iter().rposition(useful).unwrap_or(0);
    plan.file.seek(0, surveyed as u32)?;
    let mut survey = plan.survey()?;
    if surveyed > 0 {
        survey.bad = 0;
    }
    // OpenImageIO makes the missing levels itself, halving and rounding down as we do.
    while !has_own && levels.last().is_some_and(|l| l.width > 1 || l.height > 1) {
        let next = half_size(levels[levels.len() - 1]);
        if system.level(handle, levels.len() as u32).is_none() {
            break;
        }
        levels.push(next);
    }
    let stored = plan.file.header().pixel_type;
    let grey = plan.channels.len() == 1;
    Ok(Texels {
        size,
        levels: levels.len(),
        grey,
        survey,
        window: plan.window,
        bytes: 0,
        source: Source::Cached(Cached {
            system,
            handle,
            levels,
            first,
            grey,
            stored,
            curve: plan.curve,
            table: plan.curve.table(),
            cleaner: plan.cleaner(),
            failures: AtomicU64::new(0),
        }),
    })
}
