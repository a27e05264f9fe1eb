//! Images that show a part of a picture, and the same part of two of them.

use super::Image;
use super::header::{Level, Window};
use std::borrow::Cow;

/// Two images do not show the same part of one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("they show different parts of a picture: {0} and {1}")]
pub struct PlacesDiffer(Place, Place);

/// Where the pixels of an image lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// How many they are.
    pub size: Level,
    /// Where that is in the picture.
    pub window: Window,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Place { size, window } = self;
        let ([x, y], whole) = (window.at, window.whole);
        write!(
            f,
            "{} x {} pixels from {x},{y} of {} x {}",
            size.width, size.height, whole.width, whole.height
        )
    }
}

impl Place {
    /// Where `inner` begins in this, if all of it is inside.
    fn offset_of(&self, inner: &Place) -> Option<[u32; 2]> {
        let along = |outer: i32, outer_size: u32, inner: i32, inner_size: u32| {
            let offset = i64::from(inner) - i64::from(outer);
            let fits = offset >= 0 && offset + i64::from(inner_size) <= i64::from(outer_size);
            fits.then_some(offset as u32)
        };
        let (a, b) = (self.window.at, inner.window.at);
        let same = self.window.whole == inner.window.whole;
        let x = along(a[0], self.size.width, b[0], inner.size.width)?;
        let y = along(a[1], self.size.height, b[1], inner.size.height)?;
        same.then_some([x, y])
    }
}

impl Image {
    /// Where its pixels lie; by itself an image is a whole picture.
    pub fn place(&self) -> Place {
        let size = Level {
            width: self.width,
            height: self.height,
        };
        let all = Window {
            at: [0, 0],
            whole: size,
        };
        Place {
            size,
            window: self.window.unwrap_or(all),
        }
    }

    /// What it shows at that place, if it shows all of that.
    pub fn cut(&self, place: &Place) -> Option<Image> {
        let [x, y] = self.place().offset_of(place)?;
        let Level { width, height } = place.size;
        let n = self.channels.len();
        let row = self.width as usize * n;
        let mut pixels = Vec::with_capacity(width as usize * height as usize * n);
        for y in y..y + height {
            let from = y as usize * row + x as usize * n;
            pixels.extend_from_slice(self.pixels.get(from..from + width as usize * n)?);
        }
        Some(Image {
            width,
            height,
            window: Window::of(place.size, place.window.at, place.window.whole),
            channels: self.channels.clone(),
            pixels,
            attributes: self.attributes.clone(),
        })
    }
}

/// The same part of two images of one picture: of each what the other shows, if one shows all of
/// the other. Images of one size are taken as they are, unless both say where they lie and that
/// differs: many formats cannot say. So are two that both do not say it, whatever their sizes.
///
/// # Errors
/// When they do not lie so.
pub fn same_part<'i>(
    a: &'i Image,
    b: &'i Image,
) -> Result<(Cow<'i, Image>, Cow<'i, Image>), PlacesDiffer> {
    let (here, there) = (a.place(), b.place());
    let as_they_are = match (a.window, b.window) {
        (None, None) => true,
        (Some(_), Some(_)) => here == there,
        _ => here.size == there.size,
    };
    if as_they_are {
        return Ok((Cow::Borrowed(a), Cow::Borrowed(b)));
    }
    if let Some(cut) = a.cut(&there) {
        return Ok((Cow::Owned(cut), Cow::Borrowed(b)));
    }
    match b.cut(&here) {
        Some(cut) => Ok((Cow::Borrowed(a), Cow::Owned(cut))),
        None => Err(PlacesDiffer(here, there)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    fn part(size: [u32; 2], at: [i32; 2], whole: [u32; 2]) -> Image {
        let value = |i: u32| {
            let (x, y) = (i % size[0], i / size[0]);
            Rgb::splat((at[0] + x as i32 + 100 * (at[1] + y as i32)) as f32)
        };
        let pixels: Vec<Rgb> = (0..size[0] * size[1]).map(value).collect();
        let [width, height] = whole;
        Image {
            window: Window::of(
                Level {
                    width: size[0],
                    height: size[1],
                },
                at,
                Level { width, height },
            ),
            ..Image::from_rgb(size[0], size[1], &pixels)
        }
    }

    #[test]
    fn a_part_is_cut_from_the_whole_where_it_lies() {
        let whole = part([8, 6], [0, 0], [8, 6]);
        assert_eq!(whole.window, None);
        for crop in [
            part([3, 2], [2, 3], [8, 6]),
            part([8, 1], [0, 5], [8, 6]),
            part([1, 6], [7, 0], [8, 6]),
        ] {
            let (a, b) = same_part(&whole, &crop).unwrap();
            assert_eq!((&*a, &*b), (&crop, &crop));
            let (a, b) = same_part(&crop, &whole).unwrap();
            assert_eq!((&*a, &*b), (&crop, &crop));
        }
        // Of two parts, the smaller.
        let (large, small) = (part([5, 5], [1, 0], [8, 6]), part([3, 2], [2, 3], [8, 6]));
        let (a, b) = same_part(&large, &small).unwrap();
        assert_eq!((&*a, &*b), (&small, &small));
    }

    #[test]
    fn parts_that_lie_elsewhere_do_not_match() {
        let crop = part([3, 2], [2, 3], [8, 6]);
        for other in [
            part([3, 2], [2, 2], [8, 6]),
            part([3, 2], [2, 3], [9, 6]),
            part([9, 6], [0, 0], [9, 6]),
            part([2, 3], [2, 2], [8, 6]),
            part([4, 2], [0, 3], [8, 6]),
        ] {
            let error = same_part(&crop, &other).unwrap_err().to_string();
            assert!(error.contains("from 2,3 of 8 x 6"), "{error}");
        }
        // A format that cannot say where it lies: a size that fits is taken.
        let plain = part([3, 2], [0, 0], [3, 2]);
        assert!(same_part(&crop, &plain).is_ok());
    }

    #[test]
    fn a_part_beyond_the_edges_is_no_part_of_the_picture() {
        let whole = part([8, 6], [0, 0], [8, 6]);
        for at in [[-1, 0], [6, 0], [0, 5], [i32::MIN, 0], [i32::MAX, 0]] {
            let place = Place {
                window: Window {
                    at,
                    whole: whole.place().size,
                },
                ..part([3, 2], [0, 0], [8, 6]).place()
            };
            assert_eq!(whole.cut(&place), None, "{at:?}");
        }
    }
}
