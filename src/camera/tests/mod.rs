//! The cameras against rays of Mitsuba 3, and their pixel cones against neighbouring rays.

use super::*;
use crate::math::DVec3;
use glam::DMat4;

mod projections;

/// One camera of the file with its film size.
struct Case {
    description: CameraDescription,
    width: u32,
    height: u32,
}

fn parse_camera(words: &[&str]) -> Case {
    let number = |i: usize| words[i].parse::<f64>().unwrap();
    let rows: [f64; 16] = std::array::from_fn(|i| number(2 + i));
    let to_world = DAffine3::from_mat4(DMat4::from_cols_array(&rows).transpose());
    let fov_degrees = number(18);
    let fov_axis = match words[19] {
        "x" => FovAxis::X,
        "y" => FovAxis::Y,
        "diagonal" => FovAxis::Diagonal,
        "smaller" => FovAxis::Smaller,
        "larger" => FovAxis::Larger,
        other => panic!("axis {other}"),
    };
    let principal_point = [number(20), number(21)];
    let projection = match words[1] {
        "perspective" => Projection::Perspective {
            fov_degrees,
            fov_axis,
            principal_point,
        },
        "thinlens" => Projection::ThinLens {
            fov_degrees,
            fov_axis,
            principal_point,
            aperture_radius: number(22),
            focus_distance: number(23),
        },
        _ => Projection::Orthographic,
    };
    Case {
        description: CameraDescription {
            to_world,
            projection,
            near_clip: number(24),
            far_clip: number(25),
        },
        width: words[26].parse().unwrap(),
        height: words[27].parse().unwrap(),
    }
}

#[test]
fn rays_are_mitsubas() {
    let mut case = None;
    let mut compared = 0;
    for line in include_str!("../../../tests/vectors/camera.txt").lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[0] {
            "camera" => case = Some(parse_camera(&words)),
            "ray" => {
                let v: Vec<f32> = words[1..].iter().map(|w| w.parse().unwrap()).collect();
                compare(case.as_ref().unwrap(), &v, line);
                compared += 1;
            }
            _ => {}
        }
    }
    assert_eq!(compared, 18 * 12);
}

fn compare(case: &Case, v: &[f32], line: &str) {
    let camera = Camera::new(&case.description, case.width, case.height);
    let film = Vec2::new(v[0] * case.width as f32, v[1] * case.height as f32);
    let ray = camera.ray(film, Vec2::new(v[2], v[3])).ray;
    let (org, dir) = (
        glam::Vec3::new(v[4], v[5], v[6]),
        glam::Vec3::new(v[7], v[8], v[9]),
    );
    // Mitsuba starts on the near plane; its own matrices are f32, hence a few parts in 1e6.
    let scale = org.abs().max_element().max(1.0);
    assert!(
        (ray.at(ray.tmin) - org).length() < 4e-6 * scale,
        "{line}\n{ray:?}"
    );
    assert!((ray.dir - dir).length() < 4e-6, "{line}\n{ray:?}");
    let length = ray.tmax - ray.tmin;
    assert!((length - v[10]).abs() < 2e-5 * v[10], "{line}\n{ray:?}");
}

fn description(projection: Projection) -> CameraDescription {
    CameraDescription {
        to_world: DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0)),
        projection,
        near_clip: 0.01,
        far_clip: 1e4,
    }
}

#[test]
fn a_cone_is_as_wide_as_the_gap_between_neighbouring_rays() {
    let perspective = Projection::Perspective {
        fov_degrees: 70.0,
        fov_axis: FovAxis::X,
        principal_point: [0.0; 2],
    };
    let fisheye = Projection::Fisheye {
        fov_degrees: 200.0,
        fov_axis: FovAxis::Diagonal,
    };
    for projection in [
        perspective,
        Projection::Orthographic,
        Projection::Spherical,
        fisheye,
    ] {
        let camera = Camera::new(&description(projection), 400, 300);
        for film in [Vec2::new(200.5, 150.5), Vec2::new(23.5, 38.5)] {
            let at = |dx: f32, dy: f32| camera.ray(film + Vec2::new(dx, dy), Vec2::ZERO);
            let (c, x, y) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0));
            let t = 10.0;
            let across = |r: &CameraRay| r.ray.at(t) - c.ray.at(t);
            let area = across(&x).cross(across(&y)).length();
            let width = c.cone_width + c.cone_spread * t;
            assert!((area.sqrt() / width - 1.0).abs() < 0.01, "{area} {width}");
        }
    }
}

#[test]
fn a_thin_lens_is_sharp_at_its_focus() {
    let camera = Camera::new(
        &description(Projection::ThinLens {
            fov_degrees: 30.0,
            fov_axis: FovAxis::Y,
            principal_point: [0.0; 2],
            aperture_radius: 0.4,
            focus_distance: 7.0,
        }),
        300,
        200,
    );
    let film = Vec2::new(30.0, 150.0);
    let focus = |lens: Vec2| {
        let ray = camera.ray(film, lens).ray;
        ray.at(7.0 / ray.dir.z)
    };
    let expected = focus(Vec2::splat(0.5));
    for lens in [Vec2::ZERO, Vec2::new(0.9, 0.1), Vec2::new(0.3, 0.99)] {
        assert!((focus(lens) - expected).length() < 1e-5);
    }
}

/// A spherical camera looks everywhere: its film is the sphere, and its cones cover it.
#[test]
fn a_spherical_film_is_the_whole_sphere() {
    let mut camera = description(Projection::Spherical);
    camera.to_world = DAffine3::from_axis_angle(DVec3::Y, 0.5) * camera.to_world;
    let (width, height) = (200, 100);
    let camera = Camera::new(&camera, width, height);
    let at = |x: f32, y: f32| camera.ray(Vec2::new(x, y), Vec2::ZERO);
    // Directions of Mitsuba 0.6's sensor: (sin phi sin theta, cos theta, -cos phi sin theta).
    let turn = DAffine3::from_axis_angle(DVec3::Y, 0.5);
    for (x, y, dir) in [
        (50.0, 50.0, DVec3::X),
        (150.0, 50.0, DVec3::NEG_X),
        (100.0, 50.0, DVec3::Z),
        (0.0, 50.0, DVec3::NEG_Z),
        (73.0, 0.0, DVec3::Y),
    ] {
        let expected = turn.transform_vector3(dir).as_vec3();
        assert!((at(x, y).ray.dir - expected).length() < 1e-6, "{x} {y}");
    }
    let mut solid_angle = 0.0;
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let spread = f64::from(at(x as f32 + 0.5, y as f32 + 0.5).cone_spread);
        solid_angle += spread * spread;
    }
    let whole = 4.0 * std::f64::consts::PI;
    assert!((solid_angle / whole - 1.0).abs() < 1e-3, "{solid_angle}");
}
