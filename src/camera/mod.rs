//! Cameras: from a place on the film and a place on the lens to a ray.
//!
//! A camera is set up and evaluated in `f64`, and only the finished ray is rounded: a telephoto
//! lens far from the origin asks for directions that differ by less than `f32` arithmetic would
//! keep. The conventions are Mitsuba 3's; `tests/vectors/camera.txt` holds rays it made, which the
//! tests compare.

use crate::accel::Ray;
use crate::math::warp::concentric_disk;
use crate::math::{DAffine3, DVec3, Vec2};
use std::f64::consts::{PI, TAU};

mod angular;
mod description;
#[cfg(test)]
mod tests;

pub use description::{CameraDescription, FovAxis, Projection};

/// A camera for a film of a certain size.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Camera space to world space.
    to_world: DAffine3,
    /// Camera-space x and y at depth 1 (on the film plane for parallel rays, angles for a sphere or
    /// a fisheye) of the film's upper left corner.
    corner: [f64; 2],
    /// Change of the same per pixel.
    step: [f64; 2],
    lens: Lens,
    near: f64,
    far: f64,
    /// Width of a pixel at depth 1 (perspective) or anywhere (parallel rays), world units; an angle
    /// for a sphere and a fisheye.
    pixel_width: f64,
}

/// Where rays pass, beside the film.
#[derive(Clone, Copy, Debug)]
enum Lens {
    Pinhole,
    Thin {
        radius: f64,
        focus: f64,
    },
    Parallel,
    Sphere,
    /// Angle from the axis to the edge of the circle.
    Fisheye {
        edge: f64,
    },
}

/// A ray from the camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The ray.
    pub ray: Ray,
    /// Width of a pixel's cone at the origin (world units).
    pub cone_width: f32,
    /// Growth of that width per unit distance.
    pub cone_spread: f32,
    /// Whether anything is seen along it. Outside of a fisheye's circle nothing is, not even the
    /// sky: there the ray is one that meets nothing.
    pub sees: bool,
}

impl Camera {
    /// Prepares a camera for a film `width` by `height` pixels.
    pub fn new(description: &CameraDescription, width: u32, height: u32) -> Self {
        let (width, height) = (f64::from(width.max(1)), f64::from(height.max(1)));
        let aspect = width / height;
        let along = |fov: f64, axis| half_width((fov.to_radians() * 0.5).tan(), axis, aspect);
        let (half_width, shift, lens) = match description.projection {
            Projection::Perspective {
                fov_degrees,
                fov_axis,
                principal_point,
            } => (along(fov_degrees, fov_axis), principal_point, Lens::Pinhole),
            Projection::ThinLens {
                fov_degrees,
                fov_axis,
                principal_point,
                aperture_radius: radius,
                focus_distance: focus,
            } => {
                let lens = Lens::Thin { radius, focus };
                (along(fov_degrees, fov_axis), principal_point, lens)
            }
            Projection::Orthographic => (1.0, [0.0; 2], Lens::Parallel),
            Projection::Spherical => return Self::spherical(description, width, height),
            Projection::Fisheye {
                fov_degrees,
                fov_axis,
            } => {
                let edge = fov_degrees.to_radians() * 0.5;
                let half = half_width(edge, fov_axis, aspect);
                (half, [0.0; 2], Lens::Fisheye { edge })
            }
        };
        let half = [half_width, half_width / aspect];
        // Camera x points left and y up, the film's x right and y down: both run from + to -.
        let step = [-2.0 * half[0] / width, -2.0 * half[1] / height];
        let corner = [
            half[0] * (1.0 - 2.0 * shift[0]),
            half[1] * (1.0 - 2.0 * shift[1]),
        ];
        let axes = description.to_world.matrix3;
        // The geometric mean of a pixel's two sides.
        let side = match lens {
            Lens::Parallel => (axes.x_axis.length() * axes.y_axis.length()).sqrt(),
            _ => 1.0,
        };
        Self {
            to_world: description.to_world,
            corner,
            step,
            lens,
            near: description.near_clip,
            far: description.far_clip,
            pixel_width: (step[0] * step[1]).sqrt() * side,
        }
    }

    /// A camera whose film is the sphere of directions: its steps are angles.
    fn spherical(description: &CameraDescription, width: f64, height: f64) -> Self {
        let step = [TAU / width, PI / height];
        Self {
            to_world: description.to_world,
            corner: [0.0; 2],
            step,
            lens: Lens::Sphere,
            near: description.near_clip,
            far: description.far_clip,
            pixel_width: (step[0] * step[1]).sqrt(),
        }
    }

    /// The ray through `film` (pixels from the upper left corner of the full film) and `lens` (unit
    /// square).
    #[inline]
    pub fn ray(&self, film: Vec2, lens: Vec2) -> CameraRay {
        let x = self.corner[0] + self.step[0] * f64::from(film.x);
        let y = self.corner[1] + self.step[1] * f64::from(film.y);
        match self.lens {
            Lens::Pinhole => self.finish(DVec3::ZERO, DVec3::new(x, y, 1.0)),
            Lens::Thin { radius, focus } => {
                let on_lens = concentric_disk(lens).as_dvec2() * radius;
                let org = DVec3::new(on_lens.x, on_lens.y, 0.0);
                // Scaled to depth 1, so that the clip planes stay multiples of the direction.
                let dir = DVec3::new(x - on_lens.x / focus, y - on_lens.y / focus, 1.0);
                self.finish(org, dir)
            }
            Lens::Parallel => self.finish(DVec3::new(x, y, 0.0), DVec3::Z),
            Lens::Sphere => self.finish_angular(angular::on_sphere(x, y)),
            Lens::Fisheye { edge } => self.finish_angular(angular::in_circle(x, y, edge)),
        }
    }

    /// Where on the film, in pixels, a point of camera space is seen, through the middle of the
    /// lens; `None` where no ray of the camera goes through it. The film's edges and the clip
    /// distances do not count.
    pub fn place(&self, point: DVec3) -> Option<[f64; 2]> {
        let [x, y] = match self.lens {
            Lens::Pinhole | Lens::Thin { .. } if point.z > 0.0 => {
                [point.x / point.z, point.y / point.z]
            }
            Lens::Parallel if point.z >= 0.0 => [point.x, point.y],
            Lens::Pinhole | Lens::Thin { .. } | Lens::Parallel => return None,
            Lens::Sphere => angular::angles_on_sphere(point)?,
            Lens::Fisheye { edge } => angular::angles_in_circle(point, edge)?,
        };
        let along = |at: f64, axis: usize| (at - self.corner[axis]) / self.step[axis];
        Some([along(x, 0), along(y, 1)])
    }

    /// Whether what is straight is straight in the picture.
    pub fn keeps_lines_straight(&self) -> bool {
        !matches!(self.lens, Lens::Sphere | Lens::Fisheye { .. })
    }

    /// Whether points behind the camera can be seen.
    pub fn sees_behind(&self) -> bool {
        match self.lens {
            Lens::Sphere => true,
            Lens::Fisheye { edge } => edge > 0.5 * PI,
            _ => false,
        }
    }

    /// The ray of a film of angles, or one that sees nothing.
    #[inline]
    fn finish_angular(&self, looks: Option<angular::Look>) -> CameraRay {
        let Some(angular::Look { dir, area }) = looks else {
            let mut blind = self.finish(DVec3::ZERO, DVec3::Z);
            (blind.ray.tmin, blind.ray.tmax) = (1.0, 0.0);
            return CameraRay {
                sees: false,
                ..blind
            };
        };
        let cone_spread = (self.pixel_width * area.max(0.0).sqrt()) as f32;
        CameraRay {
            cone_spread,
            ..self.finish(DVec3::ZERO, dir)
        }
    }

    /// Places a ray from `org` through `org + dir`, where `dir` spans a depth of 1, in the world.
    #[inline]
    fn finish(&self, org: DVec3, dir: DVec3) -> CameraRay {
        let world_dir = self.to_world.transform_vector3(dir);
        let length = world_dir.length();
        let ray = Ray {
            org: self.to_world.transform_point3(org).as_vec3(),
            tmin: (self.near * length) as f32,
            dir: (world_dir * length.recip()).as_vec3(),
            tmax: (self.far * length) as f32,
        };
        if let Lens::Parallel = self.lens {
            return CameraRay {
                ray,
                cone_width: self.pixel_width as f32,
                cone_spread: 0.0,
                sees: true,
            };
        }
        // A pixel off the axis is farther away and seen at a slant: its solid angle shrinks with
        // cos^3, so its width with cos^1.5. Single precision does for that.
        let cos = dir.as_vec3().length_recip();
        CameraRay {
            ray,
            cone_width: 0.0,
            cone_spread: self.pixel_width as f32 * cos * cos.sqrt(),
            sees: true,
        }
    }
}

/// Half the film's width where half its extent along `axis` is `half`, for a film of this width
/// over height.
fn half_width(half: f64, axis: FovAxis, aspect: f64) -> f64 {
    match axis {
        FovAxis::X => half,
        FovAxis::Y => half * aspect,
        FovAxis::Diagonal => half / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
        FovAxis::Smaller if aspect > 1.0 => half * aspect,
        FovAxis::Larger if aspect < 1.0 => half * aspect,
        FovAxis::Smaller | FovAxis::Larger => half,
    }
}
