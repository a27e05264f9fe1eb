//! Every projection against its own inverse, and films of angles against closed forms.

use super::*;
use std::f64::consts::PI;

const WIDTH: u32 = 320;
const HEIGHT: u32 = 200;

fn fisheye(fov_degrees: f64, fov_axis: FovAxis) -> Projection {
    Projection::Fisheye {
        fov_degrees,
        fov_axis,
    }
}

fn all() -> [Projection; 7] {
    let (fov_degrees, fov_axis) = (75.0, FovAxis::Smaller);
    let principal_point = [0.1, -0.05];
    [
        Projection::Perspective {
            fov_degrees,
            fov_axis,
            principal_point,
        },
        Projection::ThinLens {
            fov_degrees,
            fov_axis,
            principal_point,
            aperture_radius: 0.3,
            focus_distance: 4.0,
        },
        Projection::Orthographic,
        Projection::Spherical,
        fisheye(180.0, FovAxis::Smaller),
        fisheye(360.0, FovAxis::X),
        fisheye(60.0, FovAxis::Diagonal),
    ]
}

/// A camera of that projection, not at the origin and askew.
fn askew(projection: Projection) -> (CameraDescription, Camera) {
    let mut camera = description(projection);
    camera.to_world = DAffine3::from_translation(DVec3::new(1.0, -2.0, 3.0))
        * DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    if projection == Projection::Orthographic {
        camera.to_world *= DAffine3::from_scale(DVec3::new(3.0, 3.0, 1.0));
    }
    (camera, Camera::new(&camera, WIDTH, HEIGHT))
}

/// Points all over the film, none on the seam of a panorama.
fn places() -> impl Iterator<Item = Vec2> {
    let along = |count: u32, side: u32| {
        (0..count).map(move |i| (i as f32 + 0.5) / count as f32 * side as f32)
    };
    along(17, WIDTH).flat_map(move |x| along(11, HEIGHT).map(move |y| Vec2::new(x, y)))
}

#[test]
fn a_point_of_a_ray_is_placed_where_the_ray_began() {
    for projection in all() {
        let (description, camera) = askew(projection);
        let from_world = description.to_world.inverse();
        let mut seen = 0;
        for film in places() {
            let CameraRay { ray, sees, .. } = camera.ray(film, Vec2::splat(0.5));
            assert!(ray.org.is_finite() && ray.dir.is_finite());
            if !sees {
                assert!(!ray.is_traceable(), "{projection:?} {film}");
                continue;
            }
            seen += 1;
            let point = from_world.transform_point3(ray.at(5.0).as_dvec3());
            let [x, y] = camera.place(point).unwrap();
            // A few roundings of f32 at a distance of 10.
            let off = (x - f64::from(film.x)).hypot(y - f64::from(film.y));
            assert!(off < 2e-3, "{projection:?}: {film} became {x} {y}");
        }
        assert!(seen > 80, "{projection:?} sees {seen}");
    }
}

#[test]
fn what_no_ray_passes_has_no_place() {
    let placed = |projection, point: [f64; 3]| {
        let (_, camera) = askew(projection);
        camera.place(DVec3::from_array(point)).is_some()
    };
    let [perspective, thin, parallel, sphere, half, whole, narrow] = all();
    for projection in [perspective, thin, parallel, half, narrow] {
        assert!(!placed(projection, [0.5, 0.2, -1.0]), "{projection:?}");
    }
    for projection in [sphere, whole] {
        assert!(placed(projection, [0.5, 0.2, -1.0]), "{projection:?}");
        assert!(placed(projection, [0.0, 0.0, -1.0]), "{projection:?}");
    }
    for projection in [perspective, thin, sphere, half, whole, narrow] {
        assert!(!placed(projection, [0.0; 3]), "{projection:?}");
    }
    let (sin, cos) = 31f64.to_radians().sin_cos();
    assert!(!placed(narrow, [sin, 0.0, cos]));
    assert!(placed(half, [sin, 0.0, cos]));
}

/// The angle to the axis grows with the distance from the middle, and left is left.
#[test]
fn a_fisheye_shows_angles_as_distances() {
    let camera = Camera::new(&description(fisheye(180.0, FovAxis::Smaller)), 300, 200);
    for (x, y, dir) in [
        (150.0, 100.0, [0.0, 0.0, 1.0]),
        // Half of the way to the edge is half of 90 degrees.
        (100.0, 100.0, [0.5f64.sqrt(), 0.0, 0.5f64.sqrt()]),
        (150.0, 0.5, [0.0, 1.0, 0.0]),
        (150.0, 199.5, [0.0, -1.0, 0.0]),
    ] {
        let at = camera.ray(Vec2::new(x, y), Vec2::ZERO);
        let off = at.ray.dir - DVec3::from_array(dir).as_vec3();
        // Half a pixel of the edge is 0.45 degrees.
        let within = if x == 150.0 && y != 100.0 { 8e-3 } else { 1e-6 };
        assert!(at.sees && off.length() < within, "{x} {y}: {}", at.ray.dir);
    }
    assert!(!camera.ray(Vec2::new(40.0, 100.0), Vec2::ZERO).sees);
    let diagonal = Camera::new(&description(fisheye(180.0, FovAxis::Diagonal)), 300, 200);
    for (x, y) in [(0.5, 0.5), (299.5, 199.5), (0.5, 199.5)] {
        let at = diagonal.ray(Vec2::new(x, y), Vec2::ZERO);
        assert!(
            at.sees && at.ray.dir.z.abs() < 0.01,
            "{x} {y}: {}",
            at.ray.dir
        );
    }
}

/// A fisheye's pixels cover the cap of directions that it shows, 2 pi (1 - cos), and no more.
#[test]
fn the_cones_of_a_fisheye_cover_its_cap() {
    for fov in [60.0, 180.0, 270.0, 360.0] {
        let camera = Camera::new(&description(fisheye(fov, FovAxis::Smaller)), 400, 400);
        let (mut solid_angle, mut seen) = (0.0, 0);
        for (x, y) in (0..400).flat_map(|y| (0..400).map(move |x| (x, y))) {
            let at = camera.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), Vec2::ZERO);
            assert!(at.cone_spread.is_finite());
            if at.sees {
                solid_angle += f64::from(at.cone_spread).powi(2);
                seen += 1;
            }
        }
        let cap = 2.0 * PI * (1.0 - (0.5 * fov.to_radians()).cos());
        assert!(
            (solid_angle / cap - 1.0).abs() < 2e-3,
            "{fov}: {solid_angle} of {cap}"
        );
        let share = f64::from(seen) / 160_000.0;
        assert!((share - PI / 4.0).abs() < 1e-3, "{fov}: {share}");
    }
}
