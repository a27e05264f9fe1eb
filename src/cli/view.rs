//! Does the camera see anything? Said before an hour goes into a black picture.

use crate::accel::{Hit, Ray};
use crate::camera::{Camera, CameraDescription};
use crate::film::FilmDescription;
use crate::math::{DVec3, Vec2, Vec3};
use crate::scene::Scene;

/// Rays along each side of the film.
const RAYS: u32 = 64;

/// Warns if no surface can be seen, where that is certain, and says why.
pub fn warn(
    scene: &Scene,
    camera: &Camera,
    description: &CameraDescription,
    film: &FilmDescription,
) {
    let bounds = scene.rays.bounds();
    if bounds.is_empty() {
        return;
    }
    let rays = grid(camera, film);
    if meets(scene, &rays) {
        return;
    }
    let unclipped: Vec<Ray> = rays
        .iter()
        .map(|ray| Ray {
            tmin: 0.0,
            tmax: f32::INFINITY,
            ..*ray
        })
        .collect();
    let why = if meets(scene, &unclipped) {
        format!(
            "what is before it lies nearer than near_clip {} or farther than far_clip {}",
            description.near_clip, description.far_clip
        )
    } else {
        let corners = corners(bounds.min, bounds.max);
        match unseen(&corners, camera, description, film) {
            Some(why) => why.to_owned(),
            None => return,
        }
    };
    tracing::warn!("the camera sees no surface: {why}");
}

/// Rays through points all over the film.
fn grid(camera: &Camera, film: &FilmDescription) -> Vec<Ray> {
    let [x0, y0, x1, y1] = film.region();
    let place = |low: u32, high: u32, i: u32| {
        low as f32 + (high - low) as f32 * (i as f32 + 0.5) / RAYS as f32
    };
    let points = (0..RAYS * RAYS).map(|i| {
        let (x, y) = (i % RAYS, i / RAYS);
        Vec2::new(place(x0, x1, x), place(y0, y1, y))
    });
    points
        .map(|at| camera.ray(at, Vec2::splat(0.5)))
        .filter(|camera| camera.sees)
        .map(|camera| camera.ray)
        .collect()
}

fn meets(scene: &Scene, rays: &[Ray]) -> bool {
    let mut hits = vec![Hit::NONE; rays.len()];
    scene.rays.intersect_batch(rays, &mut hits);
    hits.iter().any(Hit::is_some)
}

fn corners(min: Vec3, max: Vec3) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let side = |axis: usize| {
            if i >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        Vec3::new(side(0), side(1), side(2)).as_dvec3()
    })
}

/// Why nothing inside these corners is seen; none where a ray through another point might meet
/// something.
fn unseen(
    corners: &[DVec3; 8],
    camera: &Camera,
    description: &CameraDescription,
    film: &FilmDescription,
) -> Option<&'static str> {
    let to_camera = description.to_world.inverse();
    let inside = corners.map(|c| to_camera.transform_point3(c));
    if !camera.sees_behind() && inside.iter().all(|c| c.z <= 0.0) {
        return Some("all of the scene is behind it");
    }
    let places: Option<Vec<_>> = inside.iter().map(|&c| camera.place(c)).collect();
    let places = places?;
    let range = |along: fn(&[f64; 2]) -> f64| {
        let values = places.iter().map(along);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let (x, y) = (range(|p| p[0]), range(|p| p[1]));
    let beyond = |(low, high): (f64, f64), side: u32| high < 0.0 || low > f64::from(side);
    let is_beside = beyond(x, film.width) || beyond(y, film.height);
    // A box with bent edges may bulge into the picture.
    if is_beside && camera.keeps_lines_straight() {
        return Some("all of the scene is beyond the edges of the picture");
    }
    let small = x.1 - x.0 < 1.0 && y.1 - y.0 < 1.0;
    small.then_some(
        "the scene is smaller than a pixel; look at its scale and at the camera's distance",
    )
}
