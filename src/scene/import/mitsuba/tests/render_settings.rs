//! Sensors, films, samplers, integrators.

use super::Stage;
use crate::camera::{FovAxis, Projection};
use crate::film::FilmKind;
use crate::film::filter::Filter;
use crate::math::DVec3;
use crate::scene::Description;
use crate::scene::description::SamplerKind;

/// A scene of nothing but `sensor`.
fn seen(version: &str, sensor: &str) -> Description {
    let text = format!("<scene version='{version}'>{sensor}<shape type='sphere'/></scene>");
    let d = Stage::new().load(&text).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(d.warnings, [""; 0]);
    d
}

#[test]
fn a_perspective_camera_in_both_dialects() {
    let old = seen(
        "0.6.0",
        "<sensor type='perspective'><float name='fov' value='40'/><string name='fovAxis' value='smaller'/><float name='nearClip' value='2'/><float name='farClip' value='50'/><float name='focusDistance' value='3'/><transform name='toWorld'><lookAt origin='0,0,5' target='0,0,0' up='0,1,0'/></transform><sampler type='ldsampler'><integer name='sampleCount' value='12'/></sampler><film type='ldrfilm'><integer name='width' value='20'/><integer name='height' value='10'/><float name='exposure' value='1.5'/><float name='gamma' value='2.2'/><boolean name='banner' value='false'/><rfilter type='mitchell'><float name='B' value='0.5'/></rfilter></film></sensor>",
    );
    let new = seen(
        "3.0.0",
        "<sensor type='perspective'><float name='fov' value='40'/><string name='fov_axis' value='smaller'/><float name='near_clip' value='2'/><float name='far_clip' value='50'/><transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform><sampler type='multijitter'><integer name='sample_count' value='12'/></sampler><film type='hdrfilm'><integer name='width' value='20'/><integer name='height' value='10'/><string name='pixel_format' value='rgb'/><rfilter type='mitchell'><float name='B' value='0.5'/></rfilter></film></sensor>",
    );
    assert_eq!(old.camera, new.camera);
    assert_eq!(old.render, new.render);
    assert_eq!(
        (old.film.kind, new.film.kind),
        (FilmKind::Ldr, FilmKind::Hdr)
    );
    assert_eq!(old.film.exposure, 1.5);
    assert_eq!(new.render.spp, 12);
    assert_eq!(new.render.sampler, SamplerKind::Sobol);
    let c = 1.0 / 3.0;
    assert_eq!(new.film.filter, Filter::Mitchell { b: 0.5, c });
    let Projection::Perspective {
        fov_degrees,
        fov_axis,
        ..
    } = new.camera.projection
    else {
        panic!("{:?}", new.camera);
    };
    assert_eq!((fov_degrees, fov_axis), (40.0, FovAxis::Smaller));
    assert_eq!((new.camera.near_clip, new.camera.far_clip), (2.0, 50.0));
    let right = new.camera.to_world.transform_vector3(DVec3::NEG_X);
    assert!((right - DVec3::X).length() < 1e-12, "{right}");
}

/// Mitsuba 3.9.1 shows a horizontal field of view of 38.18484 degrees for 50 mm on 768 x 576
/// pixels.
#[test]
fn focal_lengths_are_those_of_a_35_mm_camera() {
    let d = seen("3.0.0", "<sensor type='perspective'/>");
    let Projection::Perspective {
        fov_degrees,
        fov_axis,
        ..
    } = d.camera.projection
    else {
        panic!("{:?}", d.camera);
    };
    assert_eq!(fov_axis, FovAxis::Diagonal);
    let across = (fov_degrees.to_radians() / 2.0).tan() * 768.0 / 768f64.hypot(576.0);
    assert!((2.0 * across.atan().to_degrees() - 38.184_84).abs() < 1e-4);
    assert_eq!((d.film.width, d.film.height), (768, 576));
    assert_eq!(d.film.filter, Filter::Gaussian { stddev: 0.5 });
}

#[test]
fn thin_lenses_and_parallel_projections() {
    let d = seen(
        "3.0.0",
        "<sensor type='thinlens'><float name='fov' value='30'/><float name='aperture_radius' value='0.2'/><float name='focus_distance' value='4'/></sensor>",
    );
    let Projection::ThinLens {
        aperture_radius,
        focus_distance,
        ..
    } = d.camera.projection
    else {
        panic!("{:?}", d.camera);
    };
    assert_eq!((aperture_radius, focus_distance), (0.2, 4.0));
    let d = seen(
        "3.0.0",
        "<sensor type='orthographic'><transform name='to_world'><scale x='5' y='5'/></transform></sensor>",
    );
    assert_eq!(d.camera.projection, Projection::Orthographic);
    assert_eq!(d.camera.to_world.matrix3.x_axis.x, 5.0);
}

#[test]
fn fisheyes_show_up_to_all_directions() {
    let fisheye = |inside: &str| format!("<sensor type='fisheye'>{inside}</sensor>");
    let of = |inside: &str| seen("3.0.0", &fisheye(inside)).camera;
    let projection = |fov_degrees, fov_axis| Projection::Fisheye {
        fov_degrees,
        fov_axis,
    };
    let plain = of("");
    assert_eq!(plain.projection, projection(180.0, FovAxis::Smaller));
    assert_eq!((plain.near_clip, plain.far_clip), (0.0, 1e30));
    let wide = "<float name='fov' value='360'/><string name='fov_axis' value='diagonal'/><float name='near_clip' value='0.5'/>";
    let wide = of(wide);
    assert_eq!(wide.projection, projection(360.0, FovAxis::Diagonal));
    assert_eq!(wide.near_clip, 0.5);
    for fov in ["0", "-5", "361"] {
        let sensor = fisheye(&format!("<float name='fov' value='{fov}'/>"));
        let error = Stage::new().load(&format!("<scene version='3.0.0'>{sensor}</scene>"));
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains("fov") && error.contains("scene.xml"),
            "{error}"
        );
    }
}

/// 0.x scenes mirror pictures by a negative scale; anything else in a camera's scale has no
/// meaning.
#[test]
fn mirrored_cameras_stay_mirrored_and_scaled_ones_do_not_stay_scaled() {
    let mirrored =
        "<sensor type='perspective'><transform name='toWorld'><scale x='-1'/></transform></sensor>";
    let d = seen("0.6.0", mirrored);
    assert_eq!(d.camera.to_world.matrix3.determinant(), -1.0);
    let scaled = "<scene version='0.6.0'><sensor type='perspective'><transform name='toWorld'><scale value='3'/></transform></sensor><shape type='sphere'/></scene>";
    let d = Stage::new().load(scaled).unwrap();
    assert_eq!(d.camera.to_world.matrix3.determinant(), 1.0);
    assert_eq!(d.warnings.len(), 1);
}

#[test]
fn crop_windows_are_half_open_and_checked() {
    let film = |crop: &str| {
        format!(
            "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='100'/><integer name='height' value='50'/>{crop}</film></sensor>"
        )
    };
    let d = seen(
        "3.0.0",
        &film("<integer name='crop_offset_x' value='10'/><integer name='crop_width' value='20'/>"),
    );
    assert_eq!(d.film.crop, Some([10, 0, 30, 50]));
    assert_eq!(seen("3.0.0", &film("")).film.crop, None);
    let outside =
        film("<integer name='crop_offset_x' value='90'/><integer name='crop_width' value='20'/>");
    let text = format!("<scene version='3.0.0'>{outside}</scene>");
    assert!(Stage::new().load(&text).is_err());
}

#[test]
fn integrators_leave_their_depths() {
    let stage = Stage::new();
    let d = stage.modern("<integrator type='path'><integer name='max_depth' value='7'/><integer name='rr_depth' value='9'/><boolean name='hide_emitters' value='true'/></integrator>");
    assert_eq!((d.render.max_depth, d.render.rr_depth), (Some(7), 9));
    assert!(d.render.hide_emitters);
    let d = stage.classic("<integrator type='path'><integer name='maxDepth' value='-1'/><boolean name='strictNormals' value='true'/></integrator>");
    assert_eq!(d.render.max_depth, None);
    assert!(d.render.strict_normals);
    let d = stage.modern("<integrator type='direct'/>");
    assert_eq!(d.render.max_depth, Some(2));
    let d = stage.classic("<integrator type='bdpt'><integer name='maxDepth' value='4'/><boolean name='lightImage' value='true'/></integrator><shape type='sphere'/>");
    assert_eq!(d.render.max_depth, Some(4));
    assert_eq!(d.warnings.len(), 1, "{:?}", d.warnings);
    assert!(d.warnings[0].contains("lightImage"), "{:?}", d.warnings);
}

#[test]
fn a_scene_without_a_sensor_is_seen_whole() {
    let text = "<scene version='3.0.0'><shape type='sphere'><point name='center' x='10' y='0' z='0'/></shape></scene>";
    let d = Stage::new().load(text).unwrap();
    assert!(d.warnings[0].contains("no sensor"), "{:?}", d.warnings);
    let to_camera = d.camera.to_world.inverse();
    let center = to_camera.transform_point3(DVec3::new(10.0, 0.0, 0.0));
    assert!(
        center.truncate().length() < 1e-4 && center.z > 1.0,
        "{center}"
    );
    // The sphere's silhouette is inside the field of view.
    let half = (1.0 / center.z).asin().to_degrees();
    assert!(half < 20.0 && half > 8.0, "{half}");
}
