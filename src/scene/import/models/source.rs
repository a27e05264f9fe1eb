//! A model as the command line names it: `file@translate=1,0,0;rotate=y,90;scale=2;material=gold`.

use super::numbers::numbers;
use super::palette::Paint;
use crate::math::{DAffine3, DVec3};
use std::path::PathBuf;
use std::str::FromStr;

/// A model file and what is done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelSource {
    /// The file.
    pub path: PathBuf,
    /// Placement: the words' steps, in their order.
    pub to_world: DAffine3,
    /// Material instead of the file's own.
    pub material: Option<Paint>,
    /// Flat shading.
    pub flat: bool,
    /// Turn the surface inside out.
    pub flip: bool,
}

impl ModelSource {
    /// A file as it is.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            to_world: DAffine3::IDENTITY,
            material: None,
            flat: false,
            flip: false,
        }
    }

    /// Whether two sources differ by nothing but their placement.
    pub fn same_mesh(&self, other: &Self) -> bool {
        let placed = Self {
            to_world: self.to_world,
            ..other.clone()
        };
        *self == placed
    }

    fn apply(&mut self, step: &str) -> Result<(), String> {
        let (name, value) = step.split_once('=').unwrap_or((step, ""));
        let more = match name.trim() {
            "translate" => DAffine3::from_translation(triple(step, value)?),
            "scale" => DAffine3::from_scale(scale(step, value)?),
            "rotate" => rotation(step, value)?,
            "material" => {
                self.material = Some(value.parse()?);
                return Ok(());
            }
            "flat" if value.is_empty() => {
                self.flat = true;
                return Ok(());
            }
            "flip" if value.is_empty() => {
                self.flip = true;
                return Ok(());
            }
            _ => {
                return Err(format!(
                    "\"{step}\" is none of translate=X,Y,Z, rotate=AXIS,DEGREES, scale=S, material=NAME, flat, flip"
                ));
            }
        };
        self.to_world = more * self.to_world;
        Ok(())
    }
}

impl FromStr for ModelSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // A file may have an @ in its name.
        let whole = PathBuf::from(text);
        let Some((path, steps)) = text.split_once('@').filter(|_| !whole.exists()) else {
            return Ok(Self::new(whole));
        };
        let mut source = Self::new(path);
        for step in steps.split(';').filter(|s| !s.trim().is_empty()) {
            source.apply(step)?;
        }
        Ok(source)
    }
}

fn triple(step: &str, value: &str) -> Result<DVec3, String> {
    match numbers(value).as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err(format!("\"{step}\": three numbers X,Y,Z are expected")),
    }
}

fn scale(step: &str, value: &str) -> Result<DVec3, String> {
    let scale = match numbers(value).as_deref() {
        Some(&[s]) => Some(DVec3::splat(s)),
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    };
    scale
        .filter(|s| s.x * s.y * s.z != 0.0)
        .ok_or_else(|| format!("\"{step}\": one number or three are expected, none of them 0"))
}

fn rotation(step: &str, value: &str) -> Result<DAffine3, String> {
    let wrong = || format!("\"{step}\": an axis (x, y, z or X,Y,Z) and degrees are expected");
    let (axis, degrees) = value.rsplit_once(',').ok_or_else(wrong)?;
    let axis = match axis.trim() {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        "z" => DVec3::Z,
        other => triple(step, other)?.try_normalize().ok_or_else(wrong)?,
    };
    let degrees = degrees.trim().parse::<f64>().ok().filter(|d| d.is_finite());
    let degrees = degrees.ok_or_else(wrong)?;
    Ok(DAffine3::from_axis_angle(axis, degrees.to_radians()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_follow_each_other() {
        let source: ModelSource = "a.ply@translate=1,0,0;rotate=z,90;scale=2".parse().unwrap();
        assert_eq!(source.path, PathBuf::from("a.ply"));
        let p = source.to_world.transform_point3(DVec3::new(1.0, 0.0, 3.0));
        assert!((p - DVec3::new(0.0, 4.0, 6.0)).length() < 1e-12, "{p}");
        let plain: ModelSource = "b.glb".parse().unwrap();
        assert_eq!(plain, ModelSource::new("b.glb"));
    }

    #[test]
    fn only_placements_may_differ_between_instances() {
        let of = |text: &str| text.parse::<ModelSource>().unwrap();
        assert!(of("a.ply").same_mesh(&of("a.ply@scale=3")));
        assert!(!of("a.ply").same_mesh(&of("a.ply@flat")));
        assert!(!of("a.ply").same_mesh(&of("b.ply")));
        assert!(!of("a.ply@material=gold").same_mesh(&of("a.ply")));
    }

    #[test]
    fn wrong_steps_say_what_is_expected() {
        for (text, word) in [
            ("a@scale=0", "none of them 0"),
            ("a@scale=1,2", "one number or three"),
            ("a@translate=1,2", "X,Y,Z"),
            ("a@translate=1,2,nan", "X,Y,Z"),
            ("a@rotate=w,90", "X,Y,Z"),
            ("a@rotate=90", "an axis"),
            ("a@shear=1", "translate=X,Y,Z"),
            ("a@material=cheese", "cheese"),
        ] {
            let error = text.parse::<ModelSource>().unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
