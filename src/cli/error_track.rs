//! `--reference`: how far the image is from the truth, measured while it renders.
//!
//! Points of the curve lie a constant factor apart, for an error falls with the root of the time:
//! after each doubling of the samples, or a quarter more time. Rendering waits meanwhile, and its
//! clock does too ([`Observer::time_aside`](crate::integrate::progress::Observer::time_aside)): a
//! curve costs an image nothing, however often it is looked at.

use super::Failure;
use crate::film::{Film, FilmDescription};
use crate::film::{Layers, Metadata};
use crate::image::header::{Level, Window};
use crate::image::metrics::{Pair, errors::Errors};
use crate::image::windows::Place;
use crate::image::{self, Image};
use crate::integrate::progress::{Progress, Summary};
use crate::report::stats::{ErrorPoint, Stats};
use rustix::time::{ClockId, clock_gettime};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The next point comes when the samples have grown by this factor,
const MORE_SAMPLES: u64 = 2;
/// or the time by this one.
const MORE_TIME: f64 = 1.25;

/// The error of a render over time.
pub struct ErrorTrack {
    path: PathBuf,
    reference: Image,
    /// Time of processors before rendering began.
    cpu_start: Duration,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    points: Vec<ErrorPoint>,
    taken: Duration,
    cpu_taken: Duration,
}

impl ErrorTrack {
    /// Reads the reference of a film: of the film's size, or of its crop's.
    ///
    /// # Errors
    /// When it cannot be read, or is of another size.
    pub fn against(path: &Path, film: &FilmDescription) -> Result<Self, Failure> {
        let whole = image::read_linear(path)?;
        Ok(Self {
            reference: fitting(path, whole, film)?,
            path: path.to_owned(),
            cpu_start: cpu_time(),
            state: Mutex::default(),
        })
    }

    /// What measuring has taken so far.
    pub fn time_taken(&self) -> Duration {
        self.state().taken
    }

    /// Measures, if it is time for another point.
    pub fn pass_done(&self, progress: &Progress, film: &Film) {
        let due = self.state().points.last().is_none_or(|last| {
            progress.spp >= last.spp * MORE_SAMPLES
                || progress.elapsed.as_secs_f64() >= last.seconds * MORE_TIME
        });
        if due {
            self.measure(film, (progress.elapsed, progress.spp, progress.rays));
        }
    }

    /// Measures the final image and hands the curve over.
    pub fn finish(self, film: &Film, summary: &Summary, stats: &mut Stats) {
        let measured = self.state().points.last().map(|p| p.rays);
        if measured != Some(summary.rays) && film.samples_done() > 0 {
            self.measure(film, (summary.elapsed, summary.spp, summary.rays));
        }
        stats.reference = Some(self.path.display().to_string());
        let state = self.state.into_inner();
        stats.errors = state.unwrap_or_else(PoisonError::into_inner).points;
    }

    fn measure(&self, film: &Film, (elapsed, spp, rays): (Duration, u64, u64)) {
        let (start, cpu) = (Instant::now(), cpu_time());
        let image = film.image(Layers::NONE, &Metadata::default());
        // The sizes were compared before: nothing else can fail.
        let Ok(pair) = Pair::new(&image, &self.reference) else {
            return;
        };
        let errors = Errors::of(&pair);
        let [relmse_4x4, relmse_16x16] = errors.rel_mse_of_blocks;
        let mut state = self.state();
        let spent = cpu.saturating_sub(self.cpu_start + state.cpu_taken);
        state.points.push(ErrorPoint {
            seconds: elapsed.as_secs_f64(),
            cpu_seconds: Some(spent.as_secs_f64()),
            spp,
            rays,
            rmse: errors.rmse(),
            relmse: errors.rel_mse,
            relmse_trimmed: errors.rel_mse_trimmed,
            relmse_4x4,
            relmse_16x16,
        });
        state.cpu_taken += cpu_time().saturating_sub(cpu);
        state.taken += start.elapsed();
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The reference at the film's place: cut to the film's crop if it shows more of the picture.
fn fitting(path: &Path, reference: Image, film: &FilmDescription) -> Result<Image, Failure> {
    let [x0, y0, x1, y1] = film.region();
    let wanted = Place {
        size: Level {
            width: x1 - x0,
            height: y1 - y0,
        },
        window: Window {
            at: [x0, y0].map(|c| i32::try_from(c).unwrap_or(i32::MAX)),
            whole: Level {
                width: film.width,
                height: film.height,
            },
        },
    };
    let place = reference.place();
    // Formats that cannot say where they lie are taken by their size.
    if place == wanted || (reference.window.is_none() && place.size == wanted.size) {
        return Ok(reference);
    }
    if let Some(cut) = reference.cut(&wanted) {
        return Ok(cut);
    }
    let (name, size, whole) = (path.display(), place.size, place.window.whole);
    if place.window.whole == wanted.window.whole {
        return Err(Failure::wrong(
            format!("{name} does not show all of the part that is rendered: {place}"),
            "give the same --crop, or a reference without one",
        ));
    }
    Err(Failure::wrong(
        format!(
            "{name} has {} x {} pixels, the image {} x {}",
            size.width, size.height, wanted.size.width, wanted.size.height
        ),
        format!(
            "render at its size with --width {} --height {}, or make another reference",
            whole.width, whole.height
        ),
    ))
}

/// Time that processors have spent on this process, all threads together.
fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    // Never negative, and the second part is below a second.
    Duration::new(
        u64::try_from(time.tv_sec).unwrap_or(0),
        u32::try_from(time.tv_nsec).unwrap_or(0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmKind, filter::Filter};
    use crate::math::Rgb;

    fn film(crop: Option<[u32; 4]>) -> FilmDescription {
        FilmDescription {
            width: 4,
            height: 3,
            crop,
            filter: Filter::Box { radius: 0.5 },
            kind: FilmKind::Hdr,
            exposure: 0.0,
            extras: Default::default(),
        }
    }

    fn numbered(width: u32, height: u32) -> Image {
        let pixels: Vec<Rgb> = (0..width * height).map(|i| Rgb::splat(i as f32)).collect();
        Image::from_rgb(width, height, &pixels)
    }

    #[test]
    fn a_reference_is_cut_to_the_crop_or_is_of_its_size() {
        let path = Path::new("r.exr");
        let cut = fitting(path, numbered(4, 3), &film(Some([1, 1, 3, 3]))).unwrap();
        let kept: Vec<f32> = cut.rgb().iter().map(|c| c.x).collect();
        assert_eq!(
            (cut.width, cut.height, kept),
            (2, 2, vec![5.0, 6.0, 9.0, 10.0])
        );
        let own = fitting(path, numbered(2, 2), &film(Some([1, 1, 3, 3]))).unwrap();
        assert_eq!((own.width, own.height), (2, 2));
        // A crop that says where it lies.
        let crop = film(Some([1, 1, 3, 3]));
        let placed = |width, height, x, y| {
            let whole = Level {
                width: 4,
                height: 3,
            };
            let mut image = numbered(width, height);
            image.window = Window::of(image.place().size, [x, y], whole);
            fitting(path, image, &crop)
        };
        assert_eq!(placed(2, 2, 1, 1).unwrap().pixels[0], 0.0);
        assert_eq!(placed(3, 3, 1, 0).unwrap().pixels[0], 3.0);
        for elsewhere in [placed(2, 2, 1, 0), placed(2, 3, 0, 0)] {
            let text = elsewhere.unwrap_err().text().unwrap();
            assert!(
                text.contains("--crop") && text.contains("of 4 x 3"),
                "{text}"
            );
        }
        let wrong = fitting(path, numbered(5, 3), &film(None)).unwrap_err();
        let text = wrong.text().unwrap();
        assert!(text.contains("5 x 3") && text.contains("4 x 3"), "{text}");
    }

    #[test]
    fn time_of_processors_grows_with_work() {
        let (cpu, start) = (cpu_time(), Instant::now());
        while start.elapsed() < Duration::from_millis(20) {
            std::hint::black_box(start);
        }
        assert!(cpu_time() > cpu);
    }
}
