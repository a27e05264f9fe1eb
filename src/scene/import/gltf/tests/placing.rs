//! Nodes: transforms, instances, cameras, lights, skins, morph targets.

use super::*;

#[test]
fn transforms_of_parents_come_after_those_of_children() {
    let mut file = File::triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    // A quarter turn about z, then moved; the parent doubles.
    file.json["nodes"] = json!([
        {"children": [1], "scale": [2, 2, 2]},
        {"mesh": 0, "translation": [1, 0, 0], "rotation": [0, 0, half, half]},
    ]);
    let expected = [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]];
    for (p, e) in corners(&file.load(), 0).iter().zip(expected) {
        assert!((*p - Vec3::from(e)).length() < 1e-6, "{p}");
    }
    // The same as a matrix, column by column.
    file.json["nodes"][1] = json!({
        "mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1],
    });
    for (p, e) in corners(&file.load(), 0).iter().zip(expected) {
        assert!((*p - Vec3::from(e)).length() < 1e-6, "{p}");
    }
}

#[test]
fn a_mirrored_node_keeps_its_outside() {
    let mut file = File::triangle();
    file.json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    let [a, b, c] = corners(&file.load(), 0);
    let normal = (b - a).cross(c - a);
    assert!(normal.z > 0.0, "{normal}");
}

#[test]
fn a_shared_mesh_becomes_instances_of_one_group() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        {"children": [1, 2, 3]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"mesh": 0, "translation": [2, 0, 0]},
        {"mesh": 0, "scale": [0, 0, 0]},
    ]);
    let parts = file.load();
    assert_eq!((parts.shapes.len(), parts.groups), (1, 1));
    assert_eq!(parts.shapes[0].group, Some(0));
    let places: Vec<DVec3> = parts.instances.iter().map(|i| i.1.translation).collect();
    assert_eq!(places, [DVec3::X, DVec3::X * 2.0]);
    assert!(parts.warnings[0].contains("no extent"), "{parts:?}");
    // What glows is copied instead.
    file.json["materials"] = json!([{"emissiveFactor": [1, 1, 1]}]);
    file.primitive()["material"] = 0.into();
    let parts = file.load();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (2, 0));
    assert_eq!(parts.emitters.len(), 2);
}

#[test]
fn a_crowd_stands_where_its_accessors_say() {
    let mut file = File::triangle();
    let places: Vec<[f32; 3]> = (0..50_000).map(|i| [i as f32, 0.0, 1.0]).collect();
    let translation = file.floats(&places);
    file.json["nodes"][0]["extensions"] = json!({
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}},
    });
    let parts = file.load();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (1, 50_000));
    let last = parts.instances[49_999].1.translation;
    assert_eq!(last, DVec3::new(49_999.0, 0.0, 1.0));
    let bounds = parts.bounds();
    assert_eq!((bounds.min, bounds.max.x), (Vec3::Z, 50_000.0));
}

/// (1, 1, 1), scaled by (2, 3, 4), turned by a quarter about z and moved by (1, 2, 3) is
/// (-2, 4, 7); the node doubles that and moves it by (10, 0, 0).
#[test]
fn instances_are_scaled_turned_moved_and_then_placed_by_their_node() {
    let mut file = File::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let translation = file.floats(&[[1.0, 2.0, 3.0], [0.0; 3]]);
    let rotation = file.floats(&[[0.0, 0.0, half, half], [0.0, 0.0, 0.0, 1.0]]);
    let scale = file.floats(&[[2.0, 3.0, 4.0], [1.0; 3]]);
    file.json["nodes"][0] = json!({
        "mesh": 0, "translation": [10, 0, 0], "scale": [2, 2, 2],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {
            "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale, "_ID": translation,
        }}},
    });
    let first = |parts: &Parts, point: DVec3| parts.instances[0].1.transform_point3(point);
    let parts = file.load();
    assert_eq!(parts.instances.len(), 2);
    let found = first(&parts, DVec3::ONE);
    assert!(
        (found - DVec3::new(6.0, 8.0, 14.0)).length() < 1e-5,
        "{found}"
    );
    let found = parts.instances[1].1.transform_point3(DVec3::ONE);
    assert!(
        (found - DVec3::new(12.0, 2.0, 2.0)).length() < 1e-5,
        "{found}"
    );
    // Rotations may be whole numbers over 127: 90 / 127 is half a root of 2, but for 0.2 %.
    let bytes = file.integers(5120, "SCALAR", &[0i8, 0, 90, 90, 0, 0, 0, 127]);
    let accessor = &mut file.json["accessors"][bytes];
    (accessor["type"], accessor["count"]) = ("VEC4".into(), 2.into());
    accessor["normalized"] = true.into();
    let instances = &mut file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    instances["attributes"]["ROTATION"] = bytes.into();
    let found = first(&file.load(), DVec3::ONE);
    assert!(
        (found - DVec3::new(6.0, 8.0, 14.0)).length() < 0.05,
        "{found}"
    );
    // Lists of different lengths are refused.
    let instances = &mut file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    instances["attributes"]["SCALE"] = 0.into();
    assert!(
        file.error().contains("differ in number"),
        "{}",
        file.error()
    );
}

#[test]
fn cameras_look_along_minus_z_with_the_right_to_the_right() {
    let mut file = File::triangle();
    file.json["cameras"] = json!([
        {"perspective": {"yfov": 1.0, "znear": 0.1, "aspectRatio": 1.5}},
        {"orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 10}},
    ]);
    let nodes = json!([
        {"mesh": 0}, {"camera": 0, "name": "front", "translation": [0, 0, 5], "scale": [3, 3, 3]},
        {"camera": 1},
    ]);
    file.json["nodes"] = nodes;
    file.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let parts = file.load();
    let [front, ortho] = parts.cameras.as_slice() else {
        panic!("{:?}", parts.cameras)
    };
    assert_eq!((front.name.as_str(), front.aspect), ("front", Some(1.5)));
    let place = front.camera.to_world;
    assert_eq!(place.translation, DVec3::new(0.0, 0.0, 5.0));
    // Camera space is (left, up, forward).
    assert!((place.matrix3.x_axis - DVec3::NEG_X).length() < 1e-12);
    assert!((place.matrix3.z_axis - DVec3::NEG_Z).length() < 1e-12);
    let Projection::Perspective { fov_degrees, .. } = front.camera.projection else {
        panic!("{:?}", front.camera.projection)
    };
    assert!((fov_degrees.to_radians() - 1.0).abs() < 1e-12);
    assert_eq!(ortho.camera.projection, Projection::Orthographic);
    assert!((ortho.camera.to_world.matrix3.x_axis.length() - 3.0).abs() < 1e-12);
    assert_eq!(ortho.aspect, Some(1.5));
}

#[test]
fn lights_shine_from_where_their_node_is() {
    let mut file = File::triangle();
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([
        {"type": "point", "color": [1, 0.5, 0], "intensity": 4},
        {"type": "directional"},
        {"type": "spot", "spot": {"outerConeAngle": 0.5, "innerConeAngle": 0.25}},
    ]);
    let light = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    file.json["nodes"] = json!([
        {"mesh": 0, "extensions": light(0), "translation": [1, 2, 3]},
        {"extensions": light(1)}, {"extensions": light(2)},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let parts = file.load();
    let [point, sun, spot] = parts.emitters.as_slice() else {
        panic!("{:?}", parts.emitters)
    };
    let Emitter::Point {
        position,
        intensity,
    } = point
    else {
        panic!("{point:?}")
    };
    assert_eq!(*position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(*intensity, Rgb::new(4.0, 2.0, 0.0));
    let Emitter::Directional {
        direction,
        irradiance,
    } = sun
    else {
        panic!("{sun:?}")
    };
    assert_eq!((*direction, *irradiance), (Vec3::NEG_Z, Rgb::ONE));
    let Emitter::Spot {
        to_world,
        cutoff_degrees,
        ..
    } = spot
    else {
        panic!("{spot:?}")
    };
    assert!((Vec3::from(to_world.matrix3.z_axis) - Vec3::NEG_Z).length() < 1e-6);
    assert!((cutoff_degrees.to_radians() - 0.5).abs() < 1e-6);
}

#[test]
fn joints_and_morph_targets_move_vertices() {
    let mut file = File::triangle();
    let up = file.floats(&[[0.0, 0.0, 1.0]; 3]);
    file.primitive()["targets"] = json!([{"POSITION": up}]);
    file.json["meshes"][0]["weights"] = json!([0.5]);
    assert_eq!(corners(&file.load(), 0)[0], Vec3::Z * 0.5);
    // Half of the first vertex' weight is on a joint that lifts it by 4.
    let joints = file.integers(5121, "SCALAR", &[0u8, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    file.json["accessors"][joints]["type"] = "VEC4".into();
    file.json["accessors"][joints]["count"] = 3.into();
    let one = [1.0, 0.0, 0.0, 0.0];
    let weights = file.floats(&[[0.5, 0.5, 0.0, 0.0], one, one]);
    file.primitive()["attributes"]["JOINTS_0"] = joints.into();
    file.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
    file.json["skins"] = json!([{"joints": [1, 2]}]);
    file.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [9, 9, 9]}, {}, {"translation": [0, 4, 0]},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    let [a, b, _] = corners(&file.load(), 0);
    assert_eq!(a, Vec3::new(0.0, 2.0, 0.5));
    assert_eq!(b, Vec3::new(1.0, 0.0, 0.5));
}
