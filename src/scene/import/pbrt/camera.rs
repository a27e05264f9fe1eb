//! Cameras. Those of pbrt look along +z with x to the right; here x is to the left.

use super::importer::Importer;
use super::parameter::Kind;
use super::params::Params;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::named;
use glam::DMat3;

/// The kinds of cameras that are read.
pub(super) const CAMERAS: &[&str] = &["perspective", "orthographic", "spherical", "environment"];

/// Nothing is cut off in pbrt.
const FARTHEST: f64 = 1e30;
/// Where pbrt's lens focuses if the scene does not say.
const FOCUS: f64 = 1e6;

/// The part of the plane at distance 1 that the film shows, before the field of view is applied.
#[derive(Clone, Copy, Debug)]
struct Screen {
    middle: [f64; 2],
    half: [f64; 2],
}

impl<'s> Importer<'s> {
    /// A camera for a film of `aspect` (width over height), `from_world` being the transform that
    /// holds where it stands. pbrt's default without any.
    pub fn camera(
        &mut self,
        p: Option<&Params<'_, 's>>,
        aspect: f64,
    ) -> Result<CameraDescription, String> {
        let Some(p) = p else {
            return Ok(CameraDescription {
                to_world: self.place(MIRROR, None),
                projection: perspective(90.0, Screen::of(aspect), None),
                near_clip: 0.0,
                far_clip: FARTHEST,
            });
        };
        let from_world = p
            .definition
            .affine()
            .ok_or("the camera's transform is no affine map")?;
        let size = from_world.matrix3.determinant();
        if !(size != 0.0 && size.is_finite()) {
            return Err("the camera's transform cannot be inverted".into());
        }
        let to_world = from_world.inverse();
        let screen = self.screen(p, aspect);
        // Rays alone count: a scale of the whole is one of the lens.
        let scale = to_world.matrix3.determinant().abs().cbrt();
        let unit = DAffine3 {
            matrix3: to_world.matrix3 * (1.0 / scale),
            translation: to_world.translation,
        };
        let (to_world, projection) = match p.name() {
            "perspective" => {
                let lens = self.lens(p, scale);
                let stretch = screen.stretch(aspect);
                let fov = self.field_of_view(p)?;
                (unit * MIRROR * stretch, perspective(fov, screen, lens))
            }
            "orthographic" => {
                self.left_out(p, &["lensradius"], "everything is in focus");
                p.ignore(&["focaldistance"]);
                let [mx, my] = screen.middle;
                let [hx, hy] = screen.half;
                let placed = DAffine3::from_translation(DVec3::new(mx, my, 0.0))
                    * DAffine3::from_scale(DVec3::new(-hx, hy * aspect, 1.0));
                (to_world * placed, Projection::Orthographic)
            }
            "spherical" | "environment" => {
                p.ignore(&["lensradius", "focaldistance"]);
                let mapping = match p.name() {
                    "environment" => "equirectangular",
                    _ => p.text("mapping").unwrap_or("equalarea"),
                };
                if mapping != "equirectangular" {
                    self.warn_at(
                        p.at(),
                        &format!(
                            "the mapping \"{mapping}\" of this camera is rendered as \
                         \"equirectangular\": another picture of the same directions"
                        ),
                    );
                }
                (unit * PANORAMA, Projection::Spherical)
            }
            "realistic" => {
                return Err("the camera \"realistic\" is not read: write a perspective \
             one with its field of view"
                    .into());
            }
            other => {
                let help = named::did_you_mean(other, CAMERAS.iter().copied());
                let help = help.map_or(String::new(), |h| format!("; {h}"));
                return Err(format!("there is no camera \"{other}\"{help}"));
            }
        };
        // When the shutter opens and closes makes the exposure.
        p.ignore(&["shutteropen", "shutterclose"]);
        self.done(p);
        Ok(CameraDescription {
            to_world: self.place(to_world, None),
            projection,
            near_clip: 0.0,
            far_clip: FARTHEST,
        })
    }

    fn field_of_view(&self, p: &Params) -> Result<f64, String> {
        // v3 has half of it under another name.
        let half = p.float_given("halffov").map(|half| 2.0 * half);
        let fov = half.unwrap_or_else(|| p.float("fov", 90.0));
        match fov > 0.0 && fov < 180.0 {
            true => Ok(fov),
            false => Err(format!("\"fov\" is {fov}; it must be between 0 and 180")),
        }
    }

    /// Radius and focus of a lens; `None` for a pinhole.
    fn lens(&self, p: &Params, scale: f64) -> Option<[f64; 2]> {
        let radius = p.float_in("lensradius", 0.0, 0.0..=1e30);
        let focus = p.positive("focaldistance", FOCUS);
        (radius > 0.0).then_some([radius * scale, focus * scale])
    }

    fn screen(&self, p: &Params<'_, 's>, aspect: f64) -> Screen {
        let screen = Screen::of(p.positive("frameaspectratio", aspect));
        match p.floats("screenwindow", &[Kind::Float]) {
            None => screen,
            Some(&[x0, x1, y0, y1]) if x0 < x1 && y0 < y1 => {
                let [x0, x1, y0, y1] = [x0, x1, y0, y1].map(f64::from);
                Screen {
                    middle: [0.5 * (x0 + x1), 0.5 * (y0 + y1)],
                    half: [0.5 * (x1 - x0), 0.5 * (y1 - y0)],
                }
            }
            Some(_) => {
                p.wrong(
                    "screenwindow",
                    "\"screenwindow\" is four numbers: x from, x to, y from, y to",
                );
                screen
            }
        }
    }
}

impl Screen {
    /// The shorter side is from -1 to 1.
    fn of(aspect: f64) -> Self {
        Self {
            middle: [0.0; 2],
            half: [aspect.max(1.0), (1.0 / aspect).max(1.0)],
        }
    }

    /// What makes square pixels of those that the film has here.
    fn stretch(&self, aspect: f64) -> DAffine3 {
        let [width, height] = self.half;
        DAffine3::from_scale(DVec3::new(1.0, height * aspect / width, 1.0))
    }
}

/// A field of view spans the screen's unit of length.
fn perspective(fov: f64, screen: Screen, lens: Option<[f64; 2]>) -> Projection {
    let half_width = (0.5 * fov.to_radians()).tan() * screen.half[0];
    let fov_degrees = 2.0 * half_width.atan().to_degrees();
    // Shifts are in parts of the film; x grows to the left in camera space, y downwards on the
    // film.
    let [mx, my] = screen.middle;
    let principal_point = [0.5 * mx / screen.half[0], -0.5 * my / screen.half[1]];
    match lens {
        None => Projection::Perspective {
            fov_degrees,
            fov_axis: FovAxis::X,
            principal_point,
        },
        Some([aperture_radius, focus_distance]) => Projection::ThinLens {
            fov_degrees,
            fov_axis: FovAxis::X,
            principal_point,
            aperture_radius,
            focus_distance,
        },
    }
}

/// x to the right becomes x to the left.
const MIRROR: DAffine3 = DAffine3 {
    matrix3: DMat3::from_cols(DVec3::NEG_X, DVec3::Y, DVec3::Z),
    translation: DVec3::ZERO,
};

/// pbrt's panorama begins at +x and goes on to +z; here the middle is +z and the right -x.
const PANORAMA: DAffine3 = DAffine3 {
    matrix3: DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X),
    translation: DVec3::ZERO,
};
