//! Environment maps from files.

use super::equal_area;
use super::latlong::LatLong;
use crate::image::decoded::DecodeLimit;
use crate::image::file::ImageFile;
use crate::image::header::{Level, Window};
use crate::image::{Image, ImageError, PixelType};
use crate::math::rgb::sanitized;
use crate::math::{Affine3A, Mat3, Rgb, Vec3};
use std::f32::consts::PI;
use std::mem::size_of;
use std::path::{Path, PathBuf};

/// The largest number of a half float: what is beyond it is stored as infinite.
const LARGEST_HALF: f32 = 65504.0;

/// How a file lays the sphere of directions out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Layout {
    /// Latitude by longitude.
    #[default]
    LatLong,
    /// A square in which equal areas are equal solid angles (pbrt; see
    /// [`crate::math::equal_area`]). It becomes a map of latitude by longitude.
    EqualArea,
}

/// An image around the scene, in memory: linear, finite, nowhere negative.
#[derive(Clone, PartialEq)]
pub struct EnvironmentImage {
    path: PathBuf,
    gamma: Option<f32>,
    layout: Layout,
    is_grey: bool,
    size: [usize; 2],
    pixels: Vec<Rgb>,
    oddities: Vec<String>,
}

/// What was asked for and the size: not the pixels.
impl std::fmt::Debug for EnvironmentImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EnvironmentImage")
            .field("path", &self.path)
            .field("gamma", &self.gamma)
            .field("layout", &self.layout)
            .field("is_grey", &self.is_grey)
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}

impl EnvironmentImage {
    /// Reads the file `path`. `gamma` is an exponent that takes the place of the file's own curve.
    ///
    /// # Errors
    /// When it cannot be read, would take more memory than `limit` allows, or has a single row.
    pub fn read(path: &Path, gamma: Option<f32>, limit: DecodeLimit) -> Result<Self, ImageError> {
        let file = ImageFile::open(path)?;
        let header = file.header();
        let (window, halves) = (header.window, header.pixel_type == PixelType::Half);
        let whole = window.map_or(header.level, |w| w.whole);
        let pixels = u64::from(whole.width) * u64::from(whole.height);
        file.check(limit, pixels.saturating_mul(size_of::<Rgb>() as u64))?;
        if whole.height < 2 {
            let Level { width, height } = whole;
            let reason =
                format!("an environment map needs at least two rows, not {width} x {height}");
            return Err(ImageError::new(path, reason));
        }
        drop(file);
        // An exponent given by the scene takes the place of the file's own curve.
        let image = match gamma {
            Some(_) => crate::image::read(path)?,
            None => crate::image::read_linear(path)?,
        };
        let mut map = Self {
            path: path.to_owned(),
            gamma,
            layout: Layout::LatLong,
            is_grey: false,
            size: [whole.width as usize, whole.height as usize],
            pixels: Vec::new(),
            oddities: Vec::new(),
        };
        map.pixels = match window {
            Some(window) => map.placed(&image, window),
            None => image.rgb(),
        };
        drop(image);
        map.clean(halves);
        Ok(map)
    }

    /// Reads the square of equal areas in the file `path`. Its local +z is that of the map.
    ///
    /// # Errors
    /// As [`EnvironmentImage::read`], and when it is no square.
    pub fn read_equal_area(path: &Path, limit: DecodeLimit) -> Result<Self, ImageError> {
        let mut map = Self::read(path, None, limit)?;
        let [width, height] = map.size;
        if width != height {
            let reason = format!(
                "an equal-area environment map is a square, not {width} x {height}: \
                 pbrt's imgtool makeequiarea turns maps of latitude by longitude into one"
            );
            return Err(ImageError::new(path, reason));
        }
        (map.size, map.pixels) = equal_area::to_lat_long(width, &map.pixels);
        map.layout = Layout::EqualArea;
        Ok(map)
    }

    /// Mean luminance per steradian of what falls on a plane from the side of its normal, for light
    /// of the map's own values: its illuminance in the local direction `up`.
    pub fn illuminance(&self, up: Vec3) -> f32 {
        let map = LatLong::new(self.size, self.pixels.clone(), PI, Mat3::IDENTITY);
        map.map_or(0.0, |map| map.illuminance(up))
    }

    /// The same with the mean of its channels in each, as pbrt takes images of how strong light is.
    pub fn channel_means(&self) -> Self {
        let mut grey = self.clone();
        for pixel in &mut grey.pixels {
            *pixel = Rgb::splat(pixel.element_sum() / 3.0);
        }
        grey.is_grey = true;
        grey
    }

    /// Whether it is the result of [`EnvironmentImage::channel_means`].
    pub fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// The mean over all directions.
    pub fn mean(&self) -> Rgb {
        let map = LatLong::new(self.size, self.pixels.clone(), PI, Mat3::IDENTITY);
        map.map_or(Rgb::ZERO, |map| map.integral() / (4.0 * PI))
    }

    /// How the file lays directions out.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The exponent that was asked for.
    pub fn gamma(&self) -> Option<f32> {
        self.gamma
    }

    /// What is odd about the file, in words.
    pub fn oddities(&self) -> &[String] {
        &self.oddities
    }

    /// The whole picture of a file that holds a part of it, or more: black where it has nothing.
    fn placed(&mut self, image: &Image, window: Window) -> Vec<Rgb> {
        let [width, height] = self.size;
        let [x, y] = window.at;
        self.oddities.push(format!(
            "it holds {} x {} pixels from {x}, {y} of a picture of {width} x {height}: the rest is black",
            image.width, image.height
        ));
        let mut whole = vec![Rgb::ZERO; width * height];
        let data = image.rgb();
        let row_of = |y: usize, start: i32| usize::try_from(y as i64 + i64::from(start)).ok();
        for (from, row) in data.chunks_exact(image.width as usize).enumerate() {
            let Some(to) = row_of(from, y).filter(|to| *to < height) else {
                continue;
            };
            for (from, pixel) in row.iter().enumerate() {
                if let Some(column) = row_of(from, x).filter(|c| *c < width) {
                    whole[to * width + column] = *pixel;
                }
            }
        }
        whole
    }

    /// Leaves light only. What is infinite was too bright for the file, most often the sun in half
    /// floats: it becomes the largest number that the file holds.
    fn clean(&mut self, halves: bool) {
        let finite = |m: f32, p: &Rgb| {
            let channels = p.to_array().into_iter().filter(|x| x.is_finite());
            channels.fold(m, f32::max)
        };
        let endless = |p: &Rgb| p.to_array().contains(&f32::INFINITY);
        let clipped = self.pixels.iter().filter(|p| endless(p)).count();
        let mut largest = 0.0;
        if clipped > 0 {
            let brightest = self.pixels.iter().fold(0.0, finite);
            largest = if halves { LARGEST_HALF } else { brightest };
            self.oddities.push(format!(
                "{clipped} texels are infinite, as a sun too bright for the file is: they count as {largest}"
            ));
        }
        let mut rejected = 0;
        for pixel in &mut self.pixels {
            let cut = pixel
                .to_array()
                .map(|x| if x == f32::INFINITY { largest } else { x });
            let value = Rgb::from_array(cut);
            let value = self.gamma.map_or(value, |g| value.powf(g));
            let clean = sanitized(value);
            // Zero is no light, and no fault.
            rejected += usize::from(clean.x != value.x)
                + usize::from(clean.y != value.y)
                + usize::from(clean.z != value.z);
            *pixel = clean;
        }
        if rejected > 0 {
            self.oddities.push(format!(
                "{rejected} values are negative or not numbers: they count as 0"
            ));
        }
    }

    /// Texels that are not black.
    #[cfg(test)]
    pub(super) fn lit(&self) -> usize {
        self.pixels.iter().filter(|p| **p != Rgb::ZERO).count()
    }

    /// The map, if it is not black.
    pub(super) fn into_map(mut self, scale: Rgb, to_world: &Affine3A) -> Option<LatLong> {
        for pixel in &mut self.pixels {
            *pixel = sanitized(*pixel * scale);
        }
        LatLong::new(self.size, self.pixels, PI, Mat3::from(to_world.matrix3))
    }
}
