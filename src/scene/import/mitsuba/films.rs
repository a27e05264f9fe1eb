//! Films with their reconstruction filters.

use super::importer::Importer;
use super::params::Params;
use crate::film::filter::Filter;
use crate::film::{FilmDescription, FilmKind};
use crate::scene::import::ImportError;

/// Largest picture: OpenEXR and common sense end there.
const MAX_SIZE: u32 = 1 << 20;

/// Mitsuba's film where the scene has none.
pub(super) fn default_film() -> FilmDescription {
    FilmDescription {
        width: 768,
        height: 576,
        crop: None,
        filter: Filter::Gaussian { stddev: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: Default::default(),
    }
}

impl<'a> Importer<'a> {
    /// The film that object `index` describes.
    pub fn film(&mut self, index: usize) -> Result<FilmDescription, ImportError> {
        let p = Params::new(self.document, index);
        // What files hold and how they are named is asked for on the command line.
        p.ignore(&[
            "file_format",
            "component_format",
            "banner",
            "attach_log",
            "high_quality_edges",
            "sample_border",
            "compensate",
        ]);
        self.warn_of_format(&p);
        self.warn_of_tones(&p);
        let default = default_film();
        let width = p.count("width", default.width, 1);
        let height = p.count("height", default.height, 1);
        if width > MAX_SIZE || height > MAX_SIZE {
            return Err(p.error(format!(
                "a picture of {width} x {height} pixels is too large"
            )));
        }
        let crop = crop(&p, width, height);
        let filter = match p.child("rfilter")? {
            Some(filter) => self.filter(filter),
            None => default.filter,
        };
        let kind = match p.plugin() {
            "ldrfilm" => FilmKind::Ldr,
            _ => FilmKind::Hdr,
        };
        let exposure = p.float("exposure", 0.0) as f32;
        self.done(&p);
        Ok(FilmDescription {
            width,
            height,
            crop,
            filter,
            kind,
            exposure,
            extras: Default::default(),
        })
    }

    /// Images are R G B, with or without alpha: what else a scene asks for is not silently left out.
    fn warn_of_format(&mut self, p: &Params<'a>) {
        let Some(format) = p.text("pixel_format") else {
            return;
        };
        let place = self.document.location(p.place_of("pixel_format"));
        // Classic films may hold several, in a list.
        let lower = format.to_ascii_lowercase();
        if lower.contains("rgba") || lower.contains("alpha") {
            self.render.alpha = true;
        }
        if lower.contains("luminance") || lower.contains("xyz") || lower.contains("spectrum") {
            self.warnings.tell(format!(
                "{place}: \"pixel_format\" is \"{format}\": images are R G B"
            ));
        }
    }

    /// Curves of a film of few bits: images are written along the sRGB curve.
    fn warn_of_tones(&mut self, p: &Params<'a>) {
        let method = p.text("tonemap_method").unwrap_or("gamma");
        let is_curve = method.eq_ignore_ascii_case("gamma");
        if !is_curve {
            let place = self.document.location(p.place_of("tonemap_method"));
            self.warnings.tell(format!(
                "{place}: tone mapping by \"{method}\" is left out: values are written along the sRGB curve"
            ));
            p.ignore(&["key", "burn"]);
        }
        let gamma = p.number("gamma").unwrap_or(-1.0);
        // -1 stands for sRGB, which a power of 2.2 is meant to be.
        if gamma >= 0.0 && (gamma - 2.2).abs() > 0.01 {
            let place = self.document.location(p.place_of("gamma"));
            self.warnings.tell(format!(
                "{place}: \"gamma\" {gamma} is left out: values are written along the sRGB curve"
            ));
        }
    }

    fn filter(&mut self, index: usize) -> Filter {
        let p = Params::new(self.document, index);
        let filter = match p.plugin() {
            "tent" => Filter::Tent {
                radius: p.positive("radius", 1.0) as f32,
            },
            "gaussian" => Filter::Gaussian {
                stddev: p.positive("stddev", 0.5) as f32,
            },
            "mitchell" => Filter::Mitchell {
                b: p.float("b", 1.0 / 3.0) as f32,
                c: p.float("c", 1.0 / 3.0) as f32,
            },
            "catmullrom" => Filter::CatmullRom,
            "lanczos" => Filter::Lanczos {
                lobes: f32::from(p.count("lobes", 3, 1).min(64) as u16),
            },
            _ => Filter::Box {
                radius: p.positive("radius", 0.5) as f32,
            },
        };
        self.done(&p);
        filter
    }
}

/// The crop window, checked against the film.
fn crop(p: &Params, width: u32, height: u32) -> Option<[u32; 4]> {
    let x0 = p.count("crop_offset_x", 0, 0);
    let y0 = p.count("crop_offset_y", 0, 0);
    let w = p.count("crop_width", width.saturating_sub(x0), 1);
    let h = p.count("crop_height", height.saturating_sub(y0), 1);
    let (x1, y1) = (x0.saturating_add(w), y0.saturating_add(h));
    if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
        let message =
            format!("the crop window [{x0}, {x1}) x [{y0}, {y1}) is not inside {width} x {height}");
        p.fault(p.at(), p.error(message));
        return None;
    }
    let whole = [x0, y0, x1, y1] == [0, 0, width, height];
    (!whole).then_some([x0, y0, x1, y1])
}
