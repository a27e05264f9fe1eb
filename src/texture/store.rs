//! Opens image textures: each file once, in memory while the budget lasts, then through
//! OpenImageIO's cache.

use super::bitmap::{Bitmap, Source, Texels};
#[cfg(feature = "oiio")]
use super::cached::Cached;
use super::curve::{Cleaner, Curve};
use super::pyramid::{Pyramid, Texel};
use super::{BitmapSettings, Texture};
use crate::image::file::{Header, ImageFile};
#[cfg(feature = "oiio")]
use crate::image::oiio::textures::TextureSystem;
use crate::image::{ImageError, PixelType, color_channels};
use crate::math::{DVec3, Rgb};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

/// Numbers read from a file at a time.
const STRIP_NUMBERS: usize = 1 << 20;
/// Share of the budget that goes to OpenImageIO's cache, once it is needed.
const CACHE_SHARE: usize = 4;

/// What makes two textures share their texels.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Key {
    path: PathBuf,
    raw: bool,
    gamma: Option<u32>,
    channel: Option<String>,
}

type Entry = Arc<OnceLock<Result<Arc<Texels>, ImageError>>>;

/// Opens image textures, each file once, under one memory budget. Can be asked from many threads.
#[derive(Debug)]
pub struct TextureStore {
    budget: usize,
    resident: AtomicUsize,
    entries: Mutex<HashMap<Key, Entry>>,
    #[cfg(feature = "oiio")]
    system: OnceLock<Result<Arc<TextureSystem>, String>>,
}

/// Which numbers of a file a texture takes.
struct Plan {
    curve: Curve,
    cleaner: Cleaner,
    grey: bool,
    /// Positions of the channels: three, or the first alone for grey.
    channels: [usize; 3],
}

impl TextureStore {
    /// A store that holds at most `memory_bytes` of texels: three quarters in memory for good, a
    /// quarter in OpenImageIO's cache for what does not fit (which keeps no less than 10 MB).
    pub fn new(memory_bytes: usize) -> Self {
        Self {
            budget: memory_bytes,
            resident: AtomicUsize::new(0),
            entries: Mutex::default(),
            #[cfg(feature = "oiio")]
            system: OnceLock::new(),
        }
    }

    /// Opens an image texture.
    ///
    /// # Errors
    /// When the file is missing or no image, or does not have the channel asked for; names the file.
    pub fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        let key = Key {
            path: settings.path.clone(),
            raw: settings.raw,
            gamma: settings.gamma.map(f32::to_bits),
            channel: settings.channel.clone(),
        };
        let entry = {
            // The map is whole even if a thread that held it panicked.
            let mut entries = self.entries.lock().unwrap_or_else(|e| e.into_inner());
            entries.entry(key).or_default().clone()
        };
        let texels = entry.get_or_init(|| self.load(&settings)).clone()?;
        Ok(Texture::Bitmap(Arc::new(Bitmap::new(texels, settings))))
    }

    /// Bytes of texels held now.
    pub fn memory_bytes(&self) -> usize {
        #[cfg(feature = "oiio")]
        let cached = match self.system.get() {
            Some(Ok(system)) => system.memory_bytes(),
            _ => 0,
        };
        #[cfg(not(feature = "oiio"))]
        let cached = 0;
        self.resident.load(Ordering::Relaxed) + cached
    }

    /// Files opened.
    pub fn file_count(&self) -> usize {
        self.entries.lock().map_or(0, |e| e.len())
    }

    fn load(&self, settings: &BitmapSettings) -> Result<Arc<Texels>, ImageError> {
        let mut file = ImageFile::open(&settings.path)?;
        let plan = Plan::new(settings, file.header())?;
        let size = file.header().level;
        let texel =
            if plan.grey { 1 } else { 3 } * bytes_of(plan.storage(file.header().pixel_type));
        // A pyramid takes a third more than its finest level.
        let bytes = size.width as usize * size.height as usize * texel / 3 * 4;
        let limit = self.budget - self.budget / CACHE_SHARE;
        let before = self.resident.fetch_add(bytes, Ordering::Relaxed);
        #[cfg(feature = "oiio")]
        if before + bytes > limit && plan.is_contiguous() {
            self.resident.fetch_sub(bytes, Ordering::Relaxed);
            return self.cached(settings, file.header(), plan).map(Arc::new);
        }
        if before + bytes > limit {
            tracing::warn!(
                "{}: does not fit the texture memory and is held all the same",
                settings.path.display()
            );
        }
        plan.resident(&mut file).map(Arc::new)
    }

    /// Texels that stay in the file and pass through OpenImageIO's cache.
    #[cfg(feature = "oiio")]
    fn cached(
        &self,
        settings: &BitmapSettings,
        header: &Header,
        plan: Plan,
    ) -> Result<Texels, ImageError> {
        let error = |reason: String| ImageError::new(&settings.path, reason);
        let start = || TextureSystem::new(self.budget / CACHE_SHARE).map(Arc::new);
        let system = self.system.get_or_init(start).clone().map_err(error)?;
        let handle = system.open(&settings.path).map_err(error)?;
        let level = |l| {
            let [width, height] = system.level(handle, l)?;
            Some(crate::image::file::Level { width, height })
        };
        let levels: Vec<_> = (0..32).map_while(level).collect();
        let size = *levels
            .first()
            .ok_or_else(|| error("has no texels".into()))?;
        if header.tile_height == 0 {
            tracing::warn!(
                "{}: does not fit the texture memory and is not tiled: `maketx` makes a file that loads faster",
                settings.path.display()
            );
        }
        let cached = Cached {
            handle,
            first: plan.channels[0],
            grey: plan.grey,
            stored: header.pixel_type,
            curve: plan.curve,
            table: plan.curve.table(),
            cleaner: plan.cleaner,
            failures: Default::default(),
            levels,
            system,
        };
        let mean = sparse_mean(&cached);
        Ok(Texels {
            size,
            levels: cached.levels.len(),
            grey: plan.grey,
            mean,
            bad: 0,
            bytes: 0,
            source: Source::Cached(cached),
        })
    }
}

/// Mean over a grid of 32 x 32 places of the finest level: enough to weigh a light by.
#[cfg(feature = "oiio")]
fn sparse_mean(cached: &Cached) -> Rgb {
    const GRID: u32 = 32;
    let size = cached.size(0);
    let at = |i: u32, n: u32| ((u64::from(2 * i + 1) * u64::from(n)) / u64::from(2 * GRID)) as u32;
    let mut sum = DVec3::ZERO;
    for j in 0..GRID {
        for i in 0..GRID {
            let (x, y) = (at(i, size.width), at(j, size.height));
            sum += Rgb::from(cached.quad(0, [x; 2], [y; 2])[0]).as_dvec3();
        }
    }
    (sum / f64::from(GRID * GRID)).as_vec3()
}

fn bytes_of(t: PixelType) -> usize {
    match t {
        PixelType::U8 => 1,
        PixelType::U16 | PixelType::Half => 2,
        PixelType::Float => 4,
    }
}

impl Plan {
    fn new(settings: &BitmapSettings, header: &Header) -> Result<Self, ImageError> {
        let names: Vec<&str> = header.channels.iter().map(|c| c.name.as_str()).collect();
        let (channels, grey) = match &settings.channel {
            Some(wanted) => {
                let found = names.iter().position(|n| n.eq_ignore_ascii_case(wanted));
                let reason = || format!("has no channel {wanted}; it has {}", names.join(", "));
                (
                    [found.ok_or_else(|| ImageError::new(&settings.path, reason()))?; 3],
                    true,
                )
            }
            None => {
                let colors = color_channels(&names);
                (colors, colors[0] == colors[1])
            }
        };
        let is_alpha = grey
            && names
                .get(channels[0])
                .is_some_and(|n| n.eq_ignore_ascii_case("a"));
        let curve = Curve::of(settings, header.pixel_type, is_alpha);
        let mut plan = Self {
            curve,
            cleaner: Cleaner {
                keep_negative: settings.raw,
                half: false,
            },
            grey,
            channels,
        };
        plan.cleaner.half = plan.storage(header.pixel_type) == PixelType::Half;
        Ok(plan)
    }

    /// How texels are held: as the file has them where the curve can be undone at the look-up.
    fn storage(&self, stored: PixelType) -> PixelType {
        match stored {
            PixelType::U8 => PixelType::U8,
            PixelType::Half if self.curve == Curve::Linear => PixelType::Half,
            _ => PixelType::Float,
        }
    }

    #[cfg(feature = "oiio")]
    fn is_contiguous(&self) -> bool {
        let [r, g, b] = self.channels;
        self.grey || (g == r + 1 && b == r + 2)
    }

    fn resident(&self, file: &mut ImageFile) -> Result<Texels, ImageError> {
        let stored = file.header().pixel_type;
        match (self.storage(stored), self.grey) {
            (PixelType::U8, false) => self.texels(file, Self::byte, Source::Rgb8),
            (PixelType::U8, true) => self.texels(file, Self::byte, Source::Grey8),
            (PixelType::Half, false) => self.texels(file, Self::half, Source::RgbHalf),
            (PixelType::Half, true) => self.texels(file, Self::half, Source::GreyHalf),
            (_, false) => self.texels(file, Self::float, Source::RgbFloat),
            (_, true) => self.texels(file, Self::float, Source::GreyFloat),
        }
    }

    /// The code of a stored 8-bit number: the table undoes the curve at the look-up.
    fn byte(&self, x: f32, _: &mut u64) -> u8 {
        (x * 255.0 + 0.5) as u8
    }

    fn half(&self, x: f32, bad: &mut u64) -> half::f16 {
        half::f16::from_f32(self.float(x, bad))
    }

    fn float(&self, x: f32, bad: &mut u64) -> f32 {
        let linear = self.curve.decode(x);
        let clean = self.cleaner.clean(linear);
        *bad += u64::from(clean != linear);
        clean
    }

    /// Reads the channels of all rows and builds the levels.
    fn texels<T: Texel, const N: usize>(
        &self,
        file: &mut ImageFile,
        convert: impl Fn(&Self, f32, &mut u64) -> T,
        source: impl FnOnce(Pyramid<T, N>) -> Source,
    ) -> Result<Texels, ImageError> {
        let size = file.header().level;
        let n = file.header().channels.len();
        let row = size.width as usize * n;
        let strip = file.strip_height(STRIP_NUMBERS);
        let mut numbers = vec![0f32; row * strip.min(size.height) as usize];
        let mut texels: Vec<[T; N]> =
            Vec::with_capacity(size.width as usize * size.height as usize);
        let mut bad = 0;
        for y0 in (0..size.height).step_by(strip as usize) {
            let y1 = (y0 + strip).min(size.height);
            let part = &mut numbers[..row * (y1 - y0) as usize];
            file.rows(y0..y1, 0..n, PixelType::Float, part)?;
            texels.extend(part.chunks_exact(n).map(|pixel| {
                std::array::from_fn(|c| convert(self, pixel[self.channels[c]], &mut bad))
            }));
        }
        let table = self.curve.table();
        let mean = mean_of(&texels, &table);
        let pyramid = Pyramid::new(size, texels, table, self.cleaner, true);
        Ok(Texels {
            size,
            levels: pyramid.level_count(),
            grey: self.grey,
            mean,
            bad,
            bytes: pyramid.memory_bytes(),
            source: source(pyramid),
        })
    }
}

fn mean_of<T: Texel, const N: usize>(texels: &[[T; N]], table: &[f32; 256]) -> Rgb {
    let mut sum = [0f64; N];
    for texel in texels {
        for c in 0..N {
            sum[c] += f64::from(texel[c].decode(table));
        }
    }
    let mean = |c: usize| (sum[c.min(N - 1)] / texels.len().max(1) as f64) as f32;
    Rgb::new(mean(0), mean(1), mean(2))
}
