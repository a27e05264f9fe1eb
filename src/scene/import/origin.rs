//! Scenes far from the origin of their coordinates, such as maps.
//!
//! Positions end as `f32`, which at 1e6 tell apart what is 0.06 away. A scene that is small beside
//! its distance from the origin is therefore imported a second time, with everything that stands in
//! the world moved towards the origin in `f64`, before any rounding. Light does not notice. What
//! still has not got enough digits (a cup in a landscape) is a warning.

use super::faults::Faults;
use super::parts::{bounds_of, shape_bounds};
use super::{ImportError, ImportOptions};
use crate::accel::{Bounds, LARGEST};
use crate::math::{DAffine3, DVec3};
use crate::scene::{Description, Shape};

/// A scene is far away when the middle of its bounds is this many times its radius from the origin:
/// five of the 24 bits of a position would then say nothing but where the scene is.
const FAR: f32 = 32.0;

/// What is so far away that its size was lost in rounding is first moved near, and then to its
/// place.
const MOST_MOVES: u32 = 3;

/// Shapes with fewer roundings of a position than this across are warned of: their silhouettes
/// would be visibly jagged.
const STEPS: f32 = 1024.0;

/// The point that should become the origin, if the scene is far from the one it has. It lies on a
/// grid as coarse as the scene, so that small changes of a scene do not move it, and so that scenes
/// that differ by a multiple of the grid are moved to the same place. A scene that was `moved`
/// already, by bounds that rounding had spoiled, is moved on until its middle is within half a
/// grid.
fn far_origin(description: &Description, moved: bool) -> Option<DVec3> {
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

/// Imports a scene by `from`, which is given the point of the scene's coordinates that becomes the
/// origin: the scene's own, and where the scene is far from that, a nearer one. What is wrong is
/// noted in `faults`.
pub(super) fn import_near(
    faults: &Faults,
    options: &ImportOptions,
    mut from: impl FnMut(DVec3) -> Result<Description, ImportError>,
) -> Result<Description, ImportError> {
    let unread = faults.len();
    let mut description = from(DVec3::ZERO)?;
    if let Some(error) = faults.error().filter(|_| !options.lenient) {
        return Err(error);
    }
    let mut place = DVec3::ZERO;
    for _ in 0..MOST_MOVES {
        let Some(step) = far_origin(&description, place != DVec3::ZERO) else {
            break;
        };
        place += step;
        faults.truncate(unread);
        description = from(place)?;
    }
    description.warnings.extend(faults.warnings());
    Ok(description)
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
