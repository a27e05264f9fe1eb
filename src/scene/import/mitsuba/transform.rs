//! `<transform>`: steps from top to bottom, each applied after the ones above it.
//!
//! Matrices act on column vectors and are written row by row. `lookat` makes camera coordinates: +z
//! looks at the target, +y is up, +x is to the left.

use super::value;
use super::xml::Element;
use crate::math::{DAffine3, DMat4, DVec3};

/// The steps a transform may have, for messages.
pub(super) const STEPS: &[&str] = &["translate", "rotate", "scale", "lookat", "matrix"];

/// The matrix of one step. The error says what is wrong with it.
pub(super) fn step(element: &Element) -> Result<DMat4, String> {
    let attribute = |name: &str| {
        let found = element.attributes.iter().find(|(n, _)| n == name);
        found.map(|(_, v)| v.as_str())
    };
    match element.tag.as_str() {
        "translate" => xyz(&attribute, 0.0).map(DMat4::from_translation),
        "scale" => xyz(&attribute, 1.0).map(DMat4::from_scale),
        "rotate" => rotate(&attribute),
        "lookat" | "lookAt" => look_at(&attribute),
        "matrix" => matrix(attribute("value").ok_or("a <matrix> needs a value")?),
        other => Err(format!(
            "<{other}> is not a step of a <transform>; the steps are {}",
            STEPS.join(", ")
        )),
    }
}

/// `x`, `y`, `z` (each `missing` if left out), or `value` with one or three numbers.
pub(super) fn xyz<'e>(
    attribute: &impl Fn(&str) -> Option<&'e str>,
    missing: f64,
) -> Result<DVec3, String> {
    if let Some(all) = attribute("value") {
        return value::vector(all);
    }
    let axis = |name| attribute(name).map_or(Ok(missing), value::number);
    Ok(DVec3::new(axis("x")?, axis("y")?, axis("z")?))
}

fn rotate<'e>(attribute: &impl Fn(&str) -> Option<&'e str>) -> Result<DMat4, String> {
    let axis = xyz(attribute, 0.0)?;
    let angle = value::number(attribute("angle").ok_or("a <rotate> needs an angle")?)?;
    let axis = axis.try_normalize().ok_or("the rotation axis is zero")?;
    Ok(DMat4::from_axis_angle(axis, angle.to_radians()))
}

fn look_at<'e>(attribute: &impl Fn(&str) -> Option<&'e str>) -> Result<DMat4, String> {
    let triple = |name: &str| {
        let text = attribute(name).ok_or_else(|| format!("a <lookat> needs \"{name}\""))?;
        match value::numbers(text)?.as_slice() {
            &[x, y, z] => Ok(DVec3::new(x, y, z)),
            _ => Err(format!("\"{name}\" needs three numbers")),
        }
    };
    let (origin, target) = (triple("origin")?, triple("target")?);
    let forward = (target - origin)
        .try_normalize()
        .ok_or("origin and target are the same point")?;
    let up = match attribute("up") {
        Some(_) => triple("up")?,
        None => DVec3::ZERO,
    };
    let up = if up == DVec3::ZERO {
        forward.any_orthonormal_vector()
    } else {
        up
    };
    let left = up
        .cross(forward)
        .try_normalize()
        .ok_or("\"up\" points along the line of sight")?;
    let up = forward.cross(left);
    Ok(DMat4::from_cols(
        left.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        origin.extend(1.0),
    ))
}

/// 16 or 9 numbers, row by row.
fn matrix(text: &str) -> Result<DMat4, String> {
    let v = value::numbers(text)?;
    match v.len() {
        16 => Ok(DMat4::from_cols_slice(&v).transpose()),
        9 => {
            let rows = [v[0], v[3], v[6], v[1], v[4], v[7], v[2], v[5], v[8]];
            let m = glam::DMat3::from_cols_slice(&rows);
            Ok(DMat4::from_mat3(m))
        }
        other => Err(format!("a <matrix> has 9 or 16 numbers, this has {other}")),
    }
}

/// The affine part of `m`; an error if it is projective.
pub(super) fn affine(m: DMat4) -> Result<DAffine3, String> {
    let bottom = m.row(3);
    let w = bottom.w;
    let projective = bottom.truncate().abs().max_element() > 1e-9 * w.abs();
    if projective || w == 0.0 {
        return Err("the last row of this matrix must be 0 0 0 1".into());
    }
    Ok(DAffine3::from_mat4(m * (1.0 / w)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::import::mitsuba::xml;
    use std::path::Path;

    fn composed(text: &str) -> Result<DMat4, String> {
        let root = xml::parse(text, 0, Path::new("x")).map_err(|e| e.to_string())?;
        root.children
            .iter()
            .try_fold(DMat4::IDENTITY, |m, e| Ok(step(e)? * m))
    }

    #[test]
    fn steps_apply_from_top_to_bottom() {
        let m = composed(
            "<t><scale value='2'/><rotate y='1' angle='90'/><translate x='1' z='-3'/></t>",
        )
        .unwrap();
        let p = m.transform_point3(DVec3::new(1.0, 2.0, 0.0));
        assert!((p - DVec3::new(1.0, 4.0, -5.0)).length() < 1e-12, "{p}");
    }

    #[test]
    fn look_at_sees_its_target_ahead_and_has_x_on_the_left() {
        let m = composed("<t><lookAt origin='0, 0, 5' target='0,0,0' up='0 1 0'/></t>").unwrap();
        let ahead = m.transform_point3(DVec3::new(0.0, 0.0, 5.0));
        assert!(ahead.length() < 1e-12);
        // Looking down -z with +y up, the left hand points along -x.
        let left = m.transform_vector3(DVec3::X);
        assert!((left - DVec3::NEG_X).length() < 1e-12, "{left}");
        assert!((m.determinant() - 1.0).abs() < 1e-12);
        let without_up = composed("<t><lookat origin='1 2 3' target='4 5 6'/></t>").unwrap();
        assert!((without_up.determinant() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn matrices_are_read_row_by_row() {
        let m = composed("<t><matrix value='1 0 0 7 0 1 0 8 0 0 1 9 0 0 0 1'/></t>").unwrap();
        assert_eq!(m.transform_point3(DVec3::ZERO), DVec3::new(7.0, 8.0, 9.0));
        let m = composed("<t><matrix value='0 1 0 0 0 1 1 0 0'/></t>").unwrap();
        assert_eq!(
            m.transform_vector3(DVec3::new(1.0, 2.0, 3.0)),
            DVec3::new(2.0, 3.0, 1.0)
        );
    }

    #[test]
    fn impossible_steps_are_errors() {
        for bad in [
            "<rotate angle='3'/>",
            "<rotate x='1'/>",
            "<lookat origin='0 0 0' target='0 0 0'/>",
            "<lookat origin='0 0 0' target='0 1 0' up='0 1 0'/>",
            "<matrix value='1 2 3'/>",
            "<translate x='a'/>",
            "<shear x='1'/>",
        ] {
            assert!(composed(&format!("<t>{bad}</t>")).is_err(), "{bad}");
        }
        let projective = DMat4::from_cols_array(&[1.0; 16]);
        assert!(affine(projective).is_err());
    }
}
