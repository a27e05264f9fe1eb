//! Cameras of models that are asked for by their projection.

use super::*;
use crate::camera::FovAxis;

/// Corners of the model on the film, in pixels, and the film's size.
fn placed(made: &Description) -> (Vec<[f64; 2]>, [f64; 2]) {
    let (width, height) = (made.film.width, made.film.height);
    let camera = Camera::new(&made.camera, width, height);
    let to_camera = made.camera.to_world.inverse();
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = CENTER + HALF * Vec3::new(sign(0), sign(1), sign(2));
        let place = camera.place(to_camera.transform_point3(corner.as_dvec3()));
        place.expect("every corner is seen")
    };
    (
        (0..8).map(corner).collect(),
        [f64::from(width), f64::from(height)],
    )
}

fn studio(projection: ProjectionKind, view: Viewpoint) -> Studio {
    Studio {
        view: Some(view),
        projection: Some(projection),
        ..Studio::default()
    }
}

#[test]
fn every_projection_shows_all_of_the_models() {
    let kinds = [
        ProjectionKind::Perspective,
        ProjectionKind::Orthographic,
        ProjectionKind::Spherical,
        ProjectionKind::Fisheye,
    ];
    for kind in kinds {
        for (azimuth, elevation) in [(30.0, 20.0), (200.0, -60.0), (0.0, 90.0)] {
            let studio = studio(kind, Viewpoint::Orbit { azimuth, elevation });
            let made = studio.compose(model(CENTER, HALF)).unwrap();
            let (places, size) = placed(&made);
            let most = |axis: usize| {
                let away = places.iter().map(|p| (p[axis] / size[axis] - 0.5).abs());
                2.0 * away.fold(0.0, f64::max)
            };
            let tight = most(0).max(most(1));
            assert!(tight <= 1.0, "{kind:?} {azimuth} {elevation}: {tight}");
            let least = match kind {
                // These frame the models; of a fisheye's 180 degrees they take half.
                ProjectionKind::Perspective | ProjectionKind::Orthographic => 0.7,
                ProjectionKind::Fisheye => 0.3,
                ProjectionKind::Spherical => 0.0,
            };
            assert!(tight >= least, "{kind:?} {azimuth} {elevation}: {tight}");
        }
    }
}

/// From the front the width of the model is 2, its height 4: by parallel rays it is as high
/// wherever the camera stands.
#[test]
fn parallel_rays_show_true_proportions() {
    for distance in [5.0, 500.0] {
        let eye = CENTER.as_dvec3() + DVec3::Z * distance;
        let studio = studio(ProjectionKind::Orthographic, Viewpoint::From(eye));
        let made = studio.compose(model(CENTER, HALF)).unwrap();
        let (places, [_, height]) = placed(&made);
        let extent = |axis: usize| {
            let along = places.iter().map(|p| p[axis]);
            along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
        };
        assert!((extent(1) / extent(0) - 2.0).abs() < 1e-6);
        assert!((height / extent(1) - 1.05).abs() < 1e-6, "{distance}");
    }
}

#[test]
fn panoramas_are_level_and_twice_as_wide_as_high() {
    for z_up in [false, true] {
        for elevation in [40.0, 90.0, -90.0] {
            let azimuth = 70.0;
            let studio = Studio {
                z_up,
                ..studio(
                    ProjectionKind::Spherical,
                    Viewpoint::Orbit { azimuth, elevation },
                )
            };
            let made = studio.compose(model(CENTER, HALF)).unwrap();
            let matrix = made.camera.to_world.matrix3;
            assert!((matrix.y_axis - studio.up()).length() < 1e-12, "{matrix}");
            assert!((matrix.determinant() - 1.0).abs() < 1e-12, "{matrix}");
            assert_eq!(made.film.width, 2 * made.film.height);
        }
    }
    // From the middle of the models there is a direction, too.
    let inside = studio(
        ProjectionKind::Spherical,
        Viewpoint::From(CENTER.as_dvec3()),
    );
    assert!(inside.compose(model(CENTER, HALF)).is_ok());
}

#[test]
fn lenses_are_sharp_at_what_the_camera_looks_at() {
    let lens = |focus, look_at| Studio {
        view: Some(Viewpoint::From(DVec3::new(10.0, -3.0, 24.0))),
        look_at,
        aperture: Some(Aperture { radius: 0.5, focus }),
        ..Studio::default()
    };
    let focus = |studio: Studio| {
        let made = studio.compose(model(CENTER, HALF)).unwrap();
        match made.camera.projection {
            Projection::ThinLens {
                focus_distance,
                aperture_radius,
                fov_degrees,
                ..
            } => {
                assert_eq!((aperture_radius, fov_degrees), (0.5, 35.0));
                focus_distance
            }
            other => panic!("{other:?}"),
        }
    };
    assert!((focus(lens(None, None)) - 20.0).abs() < 1e-5);
    assert_eq!(focus(lens(Some(3.0), None)), 3.0);
    let target = DVec3::new(10.0, -3.0, -6.0);
    assert!((focus(lens(None, Some(target))) - 30.0).abs() < 1e-5);
}

#[test]
fn a_camera_of_a_file_can_project_otherwise() {
    let mut camera = Studio::default()
        .compose(model(CENTER, HALF))
        .unwrap()
        .camera;
    // Parallel rays whose picture is 8 wide.
    camera.projection = Projection::Orthographic;
    camera.to_world.matrix3.x_axis *= 4.0;
    camera.to_world.matrix3.y_axis *= 4.0;
    let parts = || {
        let mut parts = model(CENTER, HALF);
        parts.cameras.push(NamedCamera {
            name: String::new(),
            camera,
            aspect: Some(3.0),
        });
        parts
    };
    let made = |studio: Studio| studio.compose(parts()).unwrap();
    let turned = made(Studio {
        look_at: Some(DVec3::ZERO),
        ..Studio::default()
    });
    assert_eq!(turned.camera.projection, Projection::Orthographic);
    assert!((turned.camera.to_world.matrix3.x_axis.length() - 4.0).abs() < 1e-9);
    let fisheye = made(Studio {
        projection: Some(ProjectionKind::Fisheye),
        fov_degrees: Some(250.0),
        ..Studio::default()
    });
    let expected = Projection::Fisheye {
        fov_degrees: 250.0,
        fov_axis: FovAxis::Smaller,
    };
    assert_eq!(fisheye.camera.projection, expected);
    assert_eq!(fisheye.film.width, fisheye.film.height);
    let axes = fisheye.camera.to_world.matrix3;
    assert!((axes.determinant() - 1.0).abs() < 1e-9, "{axes}");
    let error = Studio {
        fov_degrees: Some(50.0),
        ..Studio::default()
    }
    .compose(parts());
    assert!(error.unwrap_err().to_string().contains("parallel rays"));
}
