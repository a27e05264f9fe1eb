//! What a studio puts around models.

use super::*;
use crate::accel::TriangleMesh;
use crate::camera::{Camera, Projection};
use crate::light::Emitter;
use crate::math::DAffine3;
use crate::scene::Mesh;
use crate::scene::import::parts::NamedCamera;
use std::sync::Arc;

mod projections;

/// A box of that half size around a centre, as the eight corners of two tetrahedra.
fn model(center: Vec3, half: Vec3) -> Parts {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        center + half * Vec3::new(sign(0), sign(1), sign(2))
    };
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    let triangles = vec![[0, 3, 5], [1, 2, 4], [6, 7, 0]];
    let mesh = Mesh {
        triangles: Arc::new(TriangleMesh::new(positions, triangles).unwrap()),
        ..Mesh::default()
    };
    let mut parts = Parts::default();
    let material = Paint::clay().add(&mut parts.materials, None);
    parts.shapes.push(Shape {
        name: "box".into(),
        geometry: Geometry::Mesh(Arc::new(mesh)),
        material,
        emitter: None,
        flip_normals: false,
        group: None,
        boundary: None,
    });
    parts
}

const HALF: Vec3 = Vec3::new(1.0, 2.0, 0.5);
const CENTER: Vec3 = Vec3::new(10.0, -3.0, 4.0);

/// Where the corners of the model lie in the picture: -1 to 1 in both directions.
fn framed(description: &Description) -> (f64, f64) {
    let camera = &description.camera;
    let Projection::Perspective { fov_degrees, .. } = camera.projection else {
        panic!("{:?}", camera.projection)
    };
    let film = &description.film;
    let aspect = f64::from(film.width) / f64::from(film.height);
    let half = (0.5 * fov_degrees.to_radians()).tan();
    let (half_x, half_y) = (half * aspect.max(1.0), half * (1.0 / aspect).max(1.0));
    let from_world = camera.to_world.inverse();
    let mut most = (0.0f64, 0.0f64);
    for i in 0..8 {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = CENTER + HALF * Vec3::new(sign(0), sign(1), sign(2));
        let p = from_world.transform_point3(corner.as_dvec3());
        assert!(p.z > 0.0, "{p} is behind the camera");
        most.0 = most.0.max((p.x / p.z / half_x).abs());
        most.1 = most.1.max((p.y / p.z / half_y).abs());
    }
    most
}

#[test]
fn the_camera_sees_all_and_is_as_near_as_it_may_be() {
    for (azimuth, elevation) in [(0.0, 0.0), (30.0, 20.0), (200.0, -60.0), (90.0, 90.0)] {
        for size in [(Some(400), Some(300)), (Some(100), Some(500))] {
            for z_up in [false, true] {
                let studio = Studio {
                    view: Some(Viewpoint::Orbit { azimuth, elevation }),
                    size,
                    z_up,
                    ..Studio::default()
                };
                let made = studio.compose(model(CENTER, HALF)).unwrap();
                let (x, y) = framed(&made);
                let tight = x.max(y);
                assert!(
                    (0.7..=1.0).contains(&tight),
                    "{azimuth} {elevation}: {x} {y}"
                );
            }
        }
    }
}

#[test]
fn the_front_is_seen_with_its_left_on_the_left() {
    let studio = Studio {
        view: Some(Viewpoint::Orbit {
            azimuth: 0.0,
            elevation: 0.0,
        }),
        ..Studio::default()
    };
    let made = studio.compose(model(CENTER, HALF)).unwrap();
    let place = made.camera.to_world;
    assert!(place.translation.z > 4.5);
    // Camera space is (left, up, forward).
    let axes = [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z];
    for (axis, expected) in [
        place.matrix3.x_axis,
        place.matrix3.y_axis,
        place.matrix3.z_axis,
    ]
    .into_iter()
    .zip(axes)
    {
        assert!((axis - expected).length() < 1e-9, "{axis}");
    }
    // An azimuth goes to the right.
    let studio = Studio {
        view: Some(Viewpoint::Orbit {
            azimuth: 90.0,
            elevation: 0.0,
        }),
        ..Studio::default()
    };
    let made = studio.compose(model(CENTER, HALF)).unwrap();
    assert!(made.camera.to_world.translation.x > 11.0);
    Camera::new(&made.camera, 64, 48);
}

#[test]
fn a_file_brings_its_own_camera_and_light() {
    let mut parts = model(CENTER, HALF);
    let mut camera = Studio::default()
        .compose(model(CENTER, HALF))
        .unwrap()
        .camera;
    camera.to_world = DAffine3::from_translation(DVec3::new(10.0, -3.0, -9.0));
    parts.cameras.push(NamedCamera {
        name: "back".into(),
        camera,
        aspect: Some(2.0),
    });
    parts.emitters.push(Emitter::Constant {
        radiance: crate::math::Rgb::ONE,
    });
    let made = Studio::default().compose(parts).unwrap();
    assert_eq!(made.camera.to_world, camera.to_world);
    assert_eq!((made.film.width, made.film.height), (WIDTH, WIDTH / 2));
    assert_eq!((made.emitters.len(), made.shapes.len()), (1, 1));
    let studio = Studio {
        view: Some(Viewpoint::Named("front".into())),
        ..Studio::default()
    };
    let error = studio.compose(model(CENTER, HALF)).unwrap_err().to_string();
    assert!(
        error.contains("\"front\"") && error.contains("--camera"),
        "{error}"
    );
}

#[test]
fn a_studio_has_a_key_a_dome_and_a_ground_under_the_model() {
    let studio = Studio {
        ground: Some("matte:0.4".parse().unwrap()),
        ..Studio::default()
    };
    let made = studio.compose(model(CENTER, HALF)).unwrap();
    assert_eq!(made.shapes.len(), 3);
    assert_eq!(made.emitters.len(), 2);
    let Geometry::Analytic(ground) = &made.shapes[1].geometry else {
        panic!("{:?}", made.shapes[1])
    };
    let bounds = ground.bounds();
    assert!((bounds.max.y - -5.0).abs() < 1e-3, "{bounds:?}");
    assert!(bounds.max.x > 100.0);
    let dark = Studio {
        sky: Some(Sky::None),
        ..Studio::default()
    };
    assert!(
        dark.compose(model(CENTER, HALF))
            .unwrap()
            .emitters
            .is_empty()
    );
}

#[test]
fn nothing_to_see_and_nowhere_to_look_are_errors() {
    let error = Studio::default().compose(Parts::default()).unwrap_err();
    assert!(error.to_string().contains("nothing to see"));
    let studio = Studio {
        view: Some(Viewpoint::From(CENTER.as_dvec3())),
        ..Studio::default()
    };
    let error = studio.compose(model(CENTER, HALF)).unwrap_err().to_string();
    assert!(error.contains("--look-at"), "{error}");
}
