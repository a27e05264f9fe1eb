//! Errors drawn: a directory of pictures, or all of them on one sheet.

use crate::cli::{Failure, output, targets};
use crate::image::metrics::{Pair, views};
use crate::image::{self, Format, Image, WriteOptions, curve::srgb_to_linear};
use crate::math::Rgb;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Where the drawings go.
pub struct Drawings {
    path: PathBuf,
    /// Rows of the sheet, if they go on one.
    sheet: Option<Image>,
    names: HashSet<String>,
}

impl Drawings {
    /// Decides by the name: one that ends like an image is a sheet, all else a directory, which is
    /// made if need be.
    ///
    /// # Errors
    /// When nothing can be written there.
    pub fn plan(path: &Path) -> Result<Self, Failure> {
        let is_sheet = !path.is_dir() && Format::of(path).is_ok();
        let probe = if is_sheet {
            path.to_owned()
        } else {
            std::fs::create_dir_all(path).map_err(|e| {
                let help = "name a directory that can be made, or an image file";
                Failure::refused(format!("{} cannot be made: {e}", path.display()), help)
            })?;
            path.join("drawing.png")
        };
        output::check_format(&probe)?;
        targets::try_target(&probe)?;
        Ok(Self {
            path: path.to_owned(),
            sheet: is_sheet.then(Image::default),
            names: HashSet::new(),
        })
    }

    /// Draws one image: `shown` for the screen, its errors from `pair` and the map of FLIP errors.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn add(
        &mut self,
        of: &Path,
        shown: &Pair,
        pair: &Pair,
        flip: &[f32],
    ) -> Result<(), Failure> {
        let (width, height) = (pair.width() as u32, pair.height() as u32);
        let (difference, heat) = (views::difference(pair), views::heat(flip));
        if let Some(sheet) = &mut self.sheet {
            let linear = |c: &Rgb| c.map(srgb_to_linear);
            let picture: Vec<Rgb> = shown.image().iter().map(linear).collect();
            add_row(sheet, pair.width(), &[&picture, &difference, &heat]);
            return Ok(());
        }
        let name = self.free_name(of);
        for (kind, pixels) in [("difference", difference), ("flip", heat)] {
            let path = self.path.join(format!("{name}-{kind}.png"));
            save(&path, &Image::from_rgb(width, height, &pixels))?;
        }
        Ok(())
    }

    /// Writes the sheet, if there is one.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(self) -> Result<(), Failure> {
        self.sheet.map_or(Ok(()), |sheet| save(&self.path, &sheet))
    }

    /// The image's name without directory and ending; numbered where two are alike.
    fn free_name(&mut self, of: &Path) -> String {
        let stem = of.file_stem().unwrap_or_default().to_string_lossy();
        let mut name = stem.to_string();
        let mut count = 1;
        while !self.names.insert(name.clone()) {
            count += 1;
            name = format!("{stem}-{count}");
        }
        name
    }
}

/// Adds pictures of one size side by side below what is there.
fn add_row(sheet: &mut Image, width: usize, pictures: &[&[Rgb]; 3]) {
    let mut pixels = sheet.rgb();
    let height = pictures[0].len() / width;
    for y in 0..height {
        for picture in pictures {
            pixels.extend_from_slice(&picture[y * width..][..width]);
        }
    }
    let size = (3 * width as u32, sheet.height + height as u32);
    *sheet = Image::from_rgb(size.0, size.1, &pixels);
}

fn save(path: &Path, picture: &Image) -> Result<(), Failure> {
    image::write(path, picture, &WriteOptions::default())
        .map_err(|e| Failure::Refused(e.to_string()))?;
    tracing::info!("wrote {}", path.display());
    Ok(())
}
