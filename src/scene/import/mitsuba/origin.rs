//! Scenes far from the origin of their coordinates, such as maps.
//!
//! Positions end as `f32`, which at 1e6 tell apart what is 0.06 away. A scene that is small beside
//! its distance from the origin is therefore imported a second time, with everything that stands in
//! the world moved towards the origin in `f64`, before any rounding. Light does not notice. What
//! still has not got enough digits (a cup in a landscape) is a warning.

use crate::accel::{Bounds, LARGEST};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::parts::{bounds_of, shape_bounds};
use crate::scene::{Description, Shape};

/// A scene is far away when the middle of its bounds is this many times its radius from the origin:
/// five of the 24 bits of a position would then say nothing but where the scene is.
const FAR: f32 = 32.0;

/// What is so far away that its size was lost in rounding is first moved near, and then to its
/// place.
pub(super) const MOST_MOVES: u32 = 3;

/// Shapes with fewer roundings of a position than this across are warned of: their silhouettes
/// would be visibly jagged.
const STEPS: f32 = 1024.0;

/// The point that should become the origin, if the scene is far from the one it has. It lies on a
/// grid as coarse as the scene, so that small changes of a scene do not move it, and so that scenes
/// that differ by a multiple of the grid are moved to the same place. A scene that was `moved`
/// already, by bounds that rounding had spoiled, is moved on until its middle is within half a
/// grid.
pub(super) fn far_origin(description: &Description, moved: bool) -> Option<DVec3> {
    let bounds = bounds_of(&description.shapes, &description.instances);
    let (center, radius) = (bounds.center(), bounds.radius());
    let distance = center.abs().max_element();
    let radius = radius.max(distance * f32::EPSILON);
    let sane = center.is_finite() && radius.is_finite() && radius > 0.0;
    if !sane || (!moved && distance <= FAR * radius) {
        return None;
    }
    let grid = f64::from(radius).log2().ceil().exp2();
    let step = (center.as_dvec3() / grid).round() * grid;
    (step != DVec3::ZERO).then_some(step)
}

/// A map into the world as seen from `origin`.
pub(super) fn seen_from(origin: DVec3, to_world: DAffine3) -> DAffine3 {
    DAffine3 {
        matrix3: to_world.matrix3,
        translation: to_world.translation - origin,
    }
}

/// Warnings of shapes whose positions are too coarse, or too large for the ray tracers.
pub(super) fn warnings(shapes: &[Shape]) -> Vec<String> {
    let mut coarse = Vec::new();
    let mut lost = Vec::new();
    for shape in shapes {
        let bounds = shape_bounds(&shape.geometry);
        if bounds.is_empty() {
            continue;
        }
        if reach(&bounds) >= LARGEST {
            lost.push(shape.name.as_str());
        } else if bounds.radius() < STEPS * rounding(&bounds) {
            coarse.push(shape.name.as_str());
        }
    }
    let mut list = Vec::new();
    if let Some(first) = coarse.first() {
        list.push(format!(
            "{} shapes are so small beside their distance from the scene's middle that their positions are coarse, the first is \"{first}\": bring them closer, or put them into a shapegroup with an instance",
            coarse.len()
        ));
    }
    if let Some(first) = lost.first() {
        list.push(format!(
            "{} shapes reach beyond coordinates of {LARGEST:e} and will not be seen there, the first is \"{first}\": choose a larger unit of length",
            lost.len()
        ));
    }
    list
}

/// The largest coordinate.
fn reach(bounds: &Bounds) -> f32 {
    bounds.min.abs().max(bounds.max.abs()).max_element()
}

/// The distance between neighbouring numbers there.
fn rounding(bounds: &Bounds) -> f32 {
    reach(bounds) * f32::EPSILON
}

#[cfg(test)]
mod tests {
    use super::super::tests::Stage;
    use crate::math::Vec3;
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
            let bounds = |d: &Description| super::shape_bounds(&d.shapes[0].geometry);
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
}
