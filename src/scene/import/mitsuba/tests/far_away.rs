//! Scenes far from the origin of their coordinates.

use super::Stage;
use crate::math::Vec3;
use crate::scene::import::parts::shape_bounds;
use crate::scene::{Description, Geometry};

/// A sphere, a mesh, an instance, a camera and a point light around (x, -x, x).
fn at(x: &str) -> Description {
    let stage = Stage::new().define("x", x).define("y", &format!("-{x}"));
    stage.file("a.obj", "");
    let text = "<scene version='3.0.0'>
         <sensor type='perspective'><transform name='to_world'><lookat origin='0 0 -5' target='0 0 0' up='0 1 0'/><translate x='$x' y='$y' z='$x'/></transform></sensor>
         <shape type='sphere'><float name='radius' value='1.5'/><transform name='to_world'><translate x='$x' y='$y' z='$x'/></transform></shape>
         <shape type='obj'><string name='filename' value='a.obj'/><transform name='to_world'><scale value='0.3'/><translate x='$x' y='$y' z='$x'/></transform></shape>
         <shape type='shapegroup' id='g'><shape type='cube'/></shape>
         <shape type='instance'><ref id='g'/><transform name='to_world'><scale value='0.7'/><translate x='$x' y='$y' z='$x'/></transform></shape>
         <emitter type='point'><transform name='to_world'><translate x='$x' y='$y' z='$x'/></transform></emitter>
         </scene>";
    stage.load(text).unwrap_or_else(|e| panic!("{e}"))
}

fn mesh_corner(d: &Description) -> Vec3 {
    match &d.shapes[1].geometry {
        Geometry::Mesh(mesh) => mesh.triangles.positions()[1],
        Geometry::Analytic(_) => panic!("a mesh"),
    }
}

#[test]
fn far_scenes_keep_the_bits_of_near_ones() {
    let near = at("0");
    for x in ["100", "10000", "1000000", "1000000000"] {
        let far = at(x);
        assert_eq!(
            far.warnings.len(),
            near.warnings.len(),
            "{:?}",
            far.warnings
        );
        assert_eq!(mesh_corner(&far), mesh_corner(&near), "{x}");
        assert_eq!(format!("{:?}", far.camera), format!("{:?}", near.camera));
        assert_eq!(far.instances, near.instances);
        assert_eq!(
            format!("{:?}", far.emitters),
            format!("{:?}", near.emitters)
        );
        let bounds = |d: &Description| shape_bounds(&d.shapes[0].geometry);
        assert_eq!(bounds(&far), bounds(&near));
    }
}

/// A scene that reaches from the origin into the distance stays where it is.
#[test]
fn near_and_wide_scenes_stay() {
    let corner = Vec3::new(0.3 + 31.0, -31.0, 31.0);
    assert!((mesh_corner(&at("31")) - corner).abs().max_element() < 1e-5);
}

#[test]
fn what_is_too_coarse_or_too_far_is_a_warning() {
    let stage = Stage::new();
    let d = stage.modern(
        "<shape type='sphere'/><shape type='sphere' id='cup'><transform name='to_world'><scale value='0.1'/><translate x='10000'/></transform></shape>",
    );
    let all = d.warnings.join("\n");
    assert!(all.contains("coarse") && all.contains("\"cup\""), "{all}");
    let d = stage.modern(
        "<shape type='sphere'/><shape type='sphere' id='star'><transform name='to_world'><scale value='1e19'/></transform></shape>",
    );
    let all = d.warnings.join("\n");
    assert!(
        all.contains("will not be seen") && all.contains("\"star\""),
        "{all}"
    );
}
