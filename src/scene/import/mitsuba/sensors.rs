//! Sensors with their film, reconstruction filter and sampler.

use super::document::Document;
use super::importer::Importer;
use super::params::Params;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::film::filter::Filter;
use crate::film::{FilmDescription, FilmKind};
use crate::math::DAffine3;
use crate::scene::description::SamplerKind;
use crate::scene::import::ImportError;

/// A sensor with everything inside it.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub camera: CameraDescription,
    pub film: FilmDescription,
    /// Samples a pixel, where the scene says.
    pub spp: Option<u32>,
    pub sampler: SamplerKind,
}

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
    }
}

impl<'a> Importer<'a> {
    /// The sensor that object `index` describes.
    pub fn sensor(&mut self, index: usize) -> Result<Sensor, ImportError> {
        let p = Params::new(self.document, index);
        // Nothing moves, and light is not measured per wavelength.
        p.ignore(&["shutter_open", "shutter_close", "srf"]);
        let camera = self.camera(&p)?;
        let film = match p.child("film")? {
            Some(film) => self.film(film)?,
            None => default_film(),
        };
        let (sampler, spp) = match p.child("sampler")? {
            Some(sampler) => self.sampler(sampler)?,
            None => (SamplerKind::default(), None),
        };
        for (_, medium) in p.children("medium") {
            self.no_media(medium)?;
        }
        self.done(&p);
        Ok(Sensor {
            camera,
            film,
            spp,
            sampler,
        })
    }

    fn camera(&mut self, p: &Params<'a>) -> Result<CameraDescription, ImportError> {
        let near_clip = p.positive("near_clip", 0.01)?;
        let far_clip = p.positive("far_clip", 10_000.0)?;
        if far_clip <= near_clip {
            return Err(p.error("\"far_clip\" must be greater than \"near_clip\""));
        }
        let given = self.place(p.to_world()?, None);
        if p.plugin() == "orthographic" {
            p.ignore(&["focus_distance"]);
            // Here the scale of the transform is the size of the picture.
            return Ok(CameraDescription {
                to_world: given,
                projection: Projection::Orthographic,
                near_clip,
                far_clip,
            });
        }
        let (fov_degrees, fov_axis) = field_of_view(self.document, p)?;
        let principal_point = [
            p.float("principal_point_offset_x", 0.0)?,
            p.float("principal_point_offset_y", 0.0)?,
        ];
        let focus_distance = p.positive("focus_distance", far_clip)?;
        let projection = if p.plugin() == "thinlens" {
            let Some(_) = p.number("aperture_radius")? else {
                return Err(p.error("a thinlens needs an \"aperture_radius\""));
            };
            Projection::ThinLens {
                fov_degrees,
                fov_axis,
                principal_point,
                aperture_radius: p.float_in("aperture_radius", 0.0, 0.0..=1e30)?,
                focus_distance,
            }
        } else {
            Projection::Perspective {
                fov_degrees,
                fov_axis,
                principal_point,
            }
        };
        Ok(CameraDescription {
            to_world: self.without_scale(p, given)?,
            projection,
            near_clip,
            far_clip,
        })
    }

    /// Camera axes of unit length. Mirrored cameras stay mirrored: 0.x scenes flip pictures that way.
    fn without_scale(&mut self, p: &Params<'a>, given: DAffine3) -> Result<DAffine3, ImportError> {
        let axes = given.matrix3;
        let lengths = [axes.x_axis, axes.y_axis, axes.z_axis].map(|a| a.length());
        if lengths.contains(&0.0) || axes.determinant() == 0.0 {
            let at = p.place_of("to_world");
            return Err(self
                .document
                .error(at, "the camera's transform cannot be inverted"));
        }
        // Matrices are written with six digits; what deviates more is a scale.
        if lengths.iter().all(|l| (l - 1.0).abs() < 1e-3) {
            return Ok(given);
        }
        let place = self.document.location(p.place_of("to_world"));
        self.warn(format!(
            "{place}: the scale in the camera's transform is ignored"
        ));
        let mut unit = given;
        unit.matrix3.x_axis /= lengths[0];
        unit.matrix3.y_axis /= lengths[1];
        unit.matrix3.z_axis /= lengths[2];
        Ok(unit)
    }

    fn film(&mut self, index: usize) -> Result<FilmDescription, ImportError> {
        let p = Params::new(self.document, index);
        // What files hold and how they are named is asked for on the command line.
        p.ignore(&[
            "file_format",
            "pixel_format",
            "component_format",
            "banner",
            "attach_log",
            "high_quality_edges",
            "sample_border",
            "compensate",
            "gamma",
            "tonemap_method",
            "key",
            "burn",
        ]);
        let default = default_film();
        let width = p.count("width", default.width, 1)?;
        let height = p.count("height", default.height, 1)?;
        if width > MAX_SIZE || height > MAX_SIZE {
            return Err(p.error(format!(
                "a picture of {width} x {height} pixels is too large"
            )));
        }
        let crop = crop(&p, width, height)?;
        let filter = match p.child("rfilter")? {
            Some(filter) => self.filter(filter)?,
            None => default.filter,
        };
        let kind = match p.plugin() {
            "ldrfilm" => FilmKind::Ldr,
            _ => FilmKind::Hdr,
        };
        let exposure = p.float("exposure", 0.0)? as f32;
        self.done(&p);
        Ok(FilmDescription {
            width,
            height,
            crop,
            filter,
            kind,
            exposure,
        })
    }

    fn filter(&mut self, index: usize) -> Result<Filter, ImportError> {
        let p = Params::new(self.document, index);
        let filter = match p.plugin() {
            "tent" => Filter::Tent {
                radius: p.positive("radius", 1.0)? as f32,
            },
            "gaussian" => Filter::Gaussian {
                stddev: p.positive("stddev", 0.5)? as f32,
            },
            "mitchell" => Filter::Mitchell {
                b: p.float("b", 1.0 / 3.0)? as f32,
                c: p.float("c", 1.0 / 3.0)? as f32,
            },
            "catmullrom" => Filter::CatmullRom,
            "lanczos" => Filter::Lanczos {
                lobes: f32::from(p.count("lobes", 3, 1)?.min(64) as u16),
            },
            _ => Filter::Box {
                radius: p.positive("radius", 0.5)? as f32,
            },
        };
        self.done(&p);
        Ok(filter)
    }

    fn sampler(&mut self, index: usize) -> Result<(SamplerKind, Option<u32>), ImportError> {
        let p = Params::new(self.document, index);
        // Seeds come from the command line; the rest belongs to point sets that Sobol's stands for.
        p.ignore(&[
            "seed",
            "scramble",
            "dimension",
            "jitter",
            "dimensions",
            "strength",
        ]);
        let kind = match p.plugin() {
            "independent" => SamplerKind::Independent,
            _ => SamplerKind::Sobol,
        };
        let spp = match p.has("sample_count") {
            true => Some(p.count("sample_count", 1, 1)?),
            false => {
                p.ignore(&["sample_count"]);
                None
            }
        };
        self.done(&p);
        Ok((kind, spp))
    }
}

/// `fov` with `fov_axis`, or `focal_length`. Degrees.
pub(super) fn field_of_view(
    document: &Document,
    p: &Params,
) -> Result<(f64, FovAxis), ImportError> {
    let axes = [
        ("x", FovAxis::X),
        ("y", FovAxis::Y),
        ("diagonal", FovAxis::Diagonal),
        ("smaller", FovAxis::Smaller),
        ("larger", FovAxis::Larger),
    ];
    let axis = p.choice("fov_axis", &axes)?;
    let focal_length = p.find("focal_length");
    if let Some(fov) = p.number("fov")? {
        if focal_length.is_some() {
            return Err(p.error("give \"fov\" or \"focal_length\", not both"));
        }
        if fov <= 0.0 || fov >= 180.0 {
            let message = format!("\"fov\" is {fov}; it must be between 0 and 180");
            return Err(document.error(p.place_of("fov"), message));
        }
        return Ok((fov, axis.unwrap_or_default()));
    }
    let text = match focal_length {
        Some(_) => p.text("focal_length")?.unwrap_or("50mm"),
        None => "50mm",
    };
    let millimetres = text.trim().trim_end_matches("mm").trim().parse::<f64>();
    let length = millimetres.ok().filter(|l| *l > 0.0 && l.is_finite());
    let length = length.ok_or_else(|| {
        let message = format!("\"focal_length\" is \"{text}\"; write it like \"50mm\"");
        document.error(p.place_of("focal_length"), message)
    })?;
    // The diagonal of a 36 mm by 24 mm negative.
    let half_diagonal = 0.5 * 36f64.hypot(24.0);
    let fov = 2.0 * (half_diagonal / length).atan().to_degrees();
    Ok((fov, FovAxis::Diagonal))
}

/// The crop window, checked against the film.
fn crop(p: &Params, width: u32, height: u32) -> Result<Option<[u32; 4]>, ImportError> {
    let x0 = p.count("crop_offset_x", 0, 0)?;
    let y0 = p.count("crop_offset_y", 0, 0)?;
    let w = p.count("crop_width", width.saturating_sub(x0), 1)?;
    let h = p.count("crop_height", height.saturating_sub(y0), 1)?;
    let (x1, y1) = (x0.saturating_add(w), y0.saturating_add(h));
    if x0 >= x1 || y0 >= y1 || x1 > width || y1 > height {
        let message =
            format!("the crop window [{x0}, {x1}) x [{y0}, {y1}) is not inside {width} x {height}");
        return Err(p.error(message));
    }
    let whole = [x0, y0, x1, y1] == [0, 0, width, height];
    Ok((!whole).then_some([x0, y0, x1, y1]))
}
