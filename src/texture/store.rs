//! All image textures of a scene, under one memory budget.
//!
//! Three quarters of the budget are for resident texels, the rest for OpenImageIO's tile cache. A
//! file that is tiled and mip-mapped on disk (made by `maketx`, a `.tx`) is meant to be read in
//! pieces: it becomes resident only if it takes less than a sixteenth of the budget. An image that
//! does not fit is read in pieces through the cache if it is tiled; if not, every piece would cost
//! a pass over the file, so it is read once and its texels are put on disk and mapped. The three
//! agree at the finest level; the cache's coarser levels are those of the file, or made by
//! OpenImageIO. Which way an image goes depends on the order of opening: whoever wants the same
//! bits opens in the same order.

use super::bitmap::Bitmap;
use super::load::Plan;
use super::texels::Texels;
use super::{BitmapSettings, Texture};
use crate::image::ImageError;
use crate::image::decoded::DecodeLimit;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// What makes texels the same.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    path: PathBuf,
    raw: bool,
    gamma: Option<u32>,
    channel: Option<String>,
}

type Slot = Arc<OnceLock<Result<Arc<Texels>, ImageError>>>;

#[derive(Debug, Default)]
struct Opened {
    texels: HashMap<Key, Slot>,
    bitmaps: Vec<Arc<Bitmap>>,
}

/// Opens image textures, each file once, under one memory budget.
#[derive(Debug)]
pub struct TextureStore {
    budget: usize,
    halves: bool,
    limit: DecodeLimit,
    resident: AtomicUsize,
    spilled: AtomicUsize,
    spilled_bytes: AtomicUsize,
    opened: Mutex<Opened>,
    #[cfg(feature = "oiio")]
    cache: OnceLock<Result<Arc<crate::image::oiio::textures::TextureSystem>, String>>,
}

impl TextureStore {
    /// A store whose cache holds at most `memory_bytes` of texels.
    pub fn new(memory_bytes: usize) -> Self {
        Self {
            budget: memory_bytes,
            halves: false,
            limit: DecodeLimit::default(),
            resident: AtomicUsize::new(0),
            spilled: AtomicUsize::new(0),
            spilled_bytes: AtomicUsize::new(0),
            opened: Mutex::default(),
            #[cfg(feature = "oiio")]
            cache: OnceLock::new(),
        }
    }

    /// The same, keeping colours of 32 bits in 16: half the memory, and three digits are left.
    /// Values that are no colours, such as heights, keep their bits.
    pub fn in_halves(self, halves: bool) -> Self {
        Self { halves, ..self }
    }

    /// The same, with another limit on what a file may grow to.
    pub fn with_limit(self, limit: DecodeLimit) -> Self {
        Self { limit, ..self }
    }

    /// Opens an image texture. An error names the file.
    ///
    /// Threads may open textures at once; the same file is read once. A file that cannot be opened
    /// gives the same error again.
    pub fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        let slot = self.slot(&settings);
        let texels = slot.get_or_init(|| self.load(&settings)).clone()?;
        let mut opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = opened.bitmaps.iter().find(|b| *b.settings() == settings) {
            return Ok(Texture::Bitmap(known.clone()));
        }
        let bitmap = Arc::new(Bitmap::new(texels, settings));
        opened.bitmaps.push(bitmap.clone());
        Ok(Texture::Bitmap(bitmap))
    }

    /// Bytes of texels in memory now, resident and cached.
    pub fn memory_bytes(&self) -> usize {
        self.resident.load(Ordering::Relaxed) + self.cached_bytes()
    }

    /// Images that do not fit into the budget and are not tiled, so that their texels were put on
    /// disk: how many, and their bytes.
    pub fn spilled(&self) -> (usize, usize) {
        (
            self.spilled.load(Ordering::Relaxed),
            self.spilled_bytes.load(Ordering::Relaxed),
        )
    }

    /// The budget.
    pub fn budget_bytes(&self) -> usize {
        self.budget
    }

    /// The textures that were opened, in the order of their opening.
    pub fn bitmaps(&self) -> Vec<Arc<Bitmap>> {
        let opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        opened.bitmaps.clone()
    }

    /// Number of sets of texels: files, each counted once for every curve or channel it is read
    /// with.
    pub fn file_count(&self) -> usize {
        let opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        opened.texels.len()
    }

    fn slot(&self, settings: &BitmapSettings) -> Slot {
        let key = Key {
            path: same_file(&settings.path),
            raw: settings.raw,
            gamma: settings.gamma.map(f32::to_bits),
            channel: settings.channel.clone(),
        };
        let mut opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        opened.texels.entry(key).or_default().clone()
    }

    fn load(&self, settings: &BitmapSettings) -> Result<Arc<Texels>, ImageError> {
        let mut plan = Plan::new(settings)?;
        plan.halves = self.halves;
        let bytes = plan.bytes();
        plan.file.check(self.limit, bytes as u64)?;
        if self.reserve(bytes, self.limit_for(&plan)) {
            let texels = plan.read(false);
            if texels.is_err() {
                self.resident.fetch_sub(bytes, Ordering::Relaxed);
            }
            return texels.map(Arc::new);
        }
        #[cfg(feature = "oiio")]
        if plan.file.header().tile_height > 0 && plan.is_contiguous() {
            return self.cached(plan, settings).map(Arc::new);
        }
        self.spilled.fetch_add(1, Ordering::Relaxed);
        self.spilled_bytes.fetch_add(bytes, Ordering::Relaxed);
        plan.read(true).map(Arc::new)
    }

    /// The largest size at which this image may become resident.
    fn limit_for(&self, plan: &Plan) -> usize {
        let header = plan.file.header();
        let paged = header.tile_height > 0
            && header
                .attributes
                .iter()
                .any(|a| a.name.eq_ignore_ascii_case("textureformat"));
        if paged { self.budget / 16 } else { usize::MAX }
    }

    /// Takes `bytes` out of the budget, or nothing if they are not there.
    fn reserve(&self, bytes: usize, limit: usize) -> bool {
        let most = self.budget / 4 * 3;
        bytes <= limit
            && self
                .resident
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |used| {
                    used.checked_add(bytes).filter(|&sum| sum <= most)
                })
                .is_ok()
    }

    #[cfg(not(feature = "oiio"))]
    fn cached_bytes(&self) -> usize {
        0
    }

    #[cfg(feature = "oiio")]
    fn cached_bytes(&self) -> usize {
        match self.cache.get() {
            Some(Ok(cache)) => cache.memory_bytes(),
            _ => 0,
        }
    }

    #[cfg(feature = "oiio")]
    fn cached(&self, plan: Plan, settings: &BitmapSettings) -> Result<Texels, ImageError> {
        use crate::image::oiio::textures::TextureSystem;
        let cache = self
            .cache
            .get_or_init(|| TextureSystem::new(self.budget / 4).map(Arc::new))
            .clone()
            .map_err(|e| ImageError::new(&settings.path, e))?;
        super::tiled::open(plan, cache, &settings.path)
    }
}

/// One name for a file that may have several.
fn same_file(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}
