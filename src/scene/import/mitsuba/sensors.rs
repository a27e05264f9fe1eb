//! Sensors with their film, reconstruction filter and sampler.

use super::films::default_film;
use super::importer::Importer;
use super::params::Params;
use super::pending::Sensor;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::math::DAffine3;
use crate::medium::VACUUM;
use crate::scene::description::SamplerKind;
use crate::scene::import::ImportError;

/// Far clip distance of cameras that have none.
const FARTHEST: f64 = 1e30;

impl<'a> Importer<'a> {
    /// The sensor that object `index` describes.
    pub fn sensor(&mut self, index: usize) -> Result<Sensor, ImportError> {
        let p = Params::new(self.document, index);
        // Nothing moves, and light is not measured per wavelength.
        p.ignore(&["shutter_open", "shutter_close"]);
        let camera = self.camera(&p)?;
        let film = match p.child("film")? {
            Some(film) => {
                let read = self.film(film);
                let instead = "the default takes its place";
                self.or_instead(film, read, instead, |_| default_film())
            }
            None => default_film(),
        };
        let (sampler, spp) = match p.child("sampler")? {
            Some(sampler) => self.sampler(sampler),
            None => (SamplerKind::default(), None),
        };
        let medium = match p.child("medium")? {
            Some(medium) => self.medium(medium),
            None => VACUUM,
        };
        self.done(&p);
        Ok(Sensor {
            camera,
            film,
            spp,
            sampler,
            medium,
        })
    }

    fn camera(&mut self, p: &Params<'a>) -> Result<CameraDescription, ImportError> {
        let angular = match p.plugin() {
            "spherical" => Some(Projection::Spherical),
            "fisheye" => Some(fisheye(p)),
            _ => None,
        };
        let (near_clip, far_clip) = clip_distances(p, angular.is_some())?;
        let given = self.place(p.to_world(), None);
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
        if let Some(projection) = angular {
            return Ok(CameraDescription {
                to_world: self.without_scale(p, given)?,
                projection,
                near_clip,
                far_clip,
            });
        }
        let (fov_degrees, fov_axis) = field_of_view(p);
        let principal_point = [
            p.float("principal_point_offset_x", 0.0),
            p.float("principal_point_offset_y", 0.0),
        ];
        let focus_distance = p.positive("focus_distance", far_clip);
        let projection = if p.plugin() == "thinlens" {
            let Some(_) = p.number("aperture_radius") else {
                return Err(p.error("a thinlens needs an \"aperture_radius\""));
            };
            Projection::ThinLens {
                fov_degrees,
                fov_axis,
                principal_point,
                aperture_radius: p.float_in("aperture_radius", 0.0, 0.0..=1e30),
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

    /// Camera axes of unit length. Mirrored cameras stay mirrored: 0.x scenes flip pictures that
    /// way.
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
        self.warnings.tell(format!(
            "{place}: the scale in the camera's transform is ignored"
        ));
        let mut unit = given;
        unit.matrix3.x_axis /= lengths[0];
        unit.matrix3.y_axis /= lengths[1];
        unit.matrix3.z_axis /= lengths[2];
        Ok(unit)
    }

    fn sampler(&mut self, index: usize) -> (SamplerKind, Option<u32>) {
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
            true => Some(p.count("sample_count", 1, 1)),
            false => {
                p.ignore(&["sample_count"]);
                None
            }
        };
        self.done(&p);
        (kind, spp)
    }
}

const FOV_AXES: [(&str, FovAxis); 5] = [
    ("x", FovAxis::X),
    ("y", FovAxis::Y),
    ("diagonal", FovAxis::Diagonal),
    ("smaller", FovAxis::Smaller),
    ("larger", FovAxis::Larger),
];

/// The nearest and the farthest that is seen.
fn clip_distances(p: &Params, is_angular: bool) -> Result<(f64, f64), ImportError> {
    let (near, far) = match is_angular {
        // Mitsuba 0.6's spherical camera has no clip planes.
        true => (
            p.float_in("near_clip", 0.0, 0.0..=FARTHEST),
            p.positive("far_clip", FARTHEST),
        ),
        false => (
            p.positive("near_clip", 0.01),
            p.positive("far_clip", 10_000.0),
        ),
    };
    match far > near {
        true => Ok((near, far)),
        false => Err(p.error("\"far_clip\" must be greater than \"near_clip\"")),
    }
}

/// The half of all directions unless told otherwise, in a circle that the film holds.
fn fisheye(p: &Params) -> Projection {
    const HALF: f64 = 180.0;
    let fov = p.float("fov", HALF);
    let is_possible = fov > 0.0 && fov <= 360.0;
    if !is_possible {
        let at = p.place_of("fov");
        let message = format!("\"fov\" is {fov}; it must be above 0 and at most 360");
        p.fault(at, p.document().error(at, message));
    }
    Projection::Fisheye {
        fov_degrees: if is_possible { fov } else { HALF },
        fov_axis: p.choice("fov_axis", &FOV_AXES).unwrap_or(FovAxis::Smaller),
    }
}

/// `fov` with `fov_axis`, or `focal_length`. Degrees.
pub(super) fn field_of_view(p: &Params) -> (f64, FovAxis) {
    let wrong = |name: &str, message: String| {
        let at = p.place_of(name);
        p.fault(at, p.document().error(at, message));
    };
    let axis = p.choice("fov_axis", &FOV_AXES);
    let focal_length = p.find("focal_length");
    if let Some(fov) = p.number("fov") {
        if focal_length.is_some() {
            wrong("fov", "give \"fov\" or \"focal_length\", not both".into());
        }
        if fov > 0.0 && fov < 180.0 {
            return (fov, axis.unwrap_or_default());
        }
        let message = format!("\"fov\" is {fov}; it must be between 0 and 180");
        wrong("fov", message);
    }
    let text = match focal_length {
        Some(_) => p.text("focal_length").unwrap_or("50mm"),
        None => "50mm",
    };
    let millimetres = text.trim().trim_end_matches("mm").trim().parse::<f64>();
    let length = millimetres.ok().filter(|l| *l > 0.0 && l.is_finite());
    let length = length.unwrap_or_else(|| {
        let message = format!("\"focal_length\" is \"{text}\"; write it like \"50mm\"");
        wrong("focal_length", message);
        50.0
    });
    // The diagonal of a 36 mm by 24 mm negative.
    let half_diagonal = 0.5 * 36f64.hypot(24.0);
    let fov = 2.0 * (half_diagonal / length).atan().to_degrees();
    (fov, FovAxis::Diagonal)
}
