//! Lights (`KHR_lights_punctual`) and cameras.
//!
//! Light is taken in the file's units: one candela is one unit of radiant intensity, one lux one of
//! irradiance, as one nit of `KHR_materials_emissive_strength` is one of radiance. Pictures come
//! out proportional to luminance; how bright they are shown is a matter of exposure.

use super::schema::{Camera, Document};
use super::{Importer, error};
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::light::{Emitter, Falloff};
use crate::math::{Affine3A, DAffine3, DVec3, Rgb};
use crate::scene::import::ImportError;
use crate::scene::import::parts::NamedCamera;
use glam::DMat3;
use serde_json::Value;
use std::f32::consts::FRAC_PI_2;

/// glTF cameras and spots look along -z with +x to the right; ours along +z with +x to the left.
const TURN: DMat3 = DMat3::from_cols(
    DVec3::new(-1.0, 0.0, 0.0),
    DVec3::new(0.0, 1.0, 0.0),
    DVec3::new(0.0, 0.0, -1.0),
);

/// Place and directions of a node without its scale, in our orientation. `None` if it is squashed
/// flat.
fn rigid(to_world: &DAffine3) -> Option<DAffine3> {
    let forward = to_world.matrix3.z_axis.try_normalize()?;
    let right = to_world.matrix3.y_axis.cross(forward).try_normalize()?;
    let up = forward.cross(right);
    Some(DAffine3 {
        matrix3: DMat3::from_cols(right, up, forward) * TURN,
        translation: to_world.translation,
    })
}

fn number(value: &Value, key: &str, default: f64) -> f64 {
    value.get(key).and_then(Value::as_f64).unwrap_or(default)
}

impl Importer<'_> {
    /// Imports light `index`, which stands at a node.
    pub(super) fn light(&mut self, index: usize, to_world: &DAffine3) -> Result<(), ImportError> {
        let list = self.document().extensions.get("KHR_lights_punctual");
        let light = list.and_then(|e| e.get("lights")?.get(index)).cloned();
        let Some(light) = light else {
            return Err(error(self.path(), format!("there is no light {index}")));
        };
        let Some(place) = rigid(to_world) else {
            self.warn(format!("light {index} stands at a node without extent"));
            return Ok(());
        };
        let color: Option<[f32; 3]> = light
            .get("color")
            .and_then(|c| serde_json::from_value(c.clone()).ok());
        let color = Rgb::from(color.unwrap_or([1.0; 3]));
        let of = format!("light {index}");
        let color = self.light_color(&format!("{of}: color"), color);
        let intensity = number(&light, "intensity", 1.0) as f32;
        let intensity = self.within(&format!("{of}: intensity"), intensity, [0.0, 1e18]);
        let light_power = color * intensity;
        if light.get("range").is_some() {
            self.warn(
                "the range of lights is left out: light falls off with the square of the distance",
            );
        }
        let position = place.translation.as_vec3();
        let kind = light
            .get("type")
            .and_then(Value::as_str)
            .unwrap_or_default();
        let emitter = match kind {
            "directional" => Emitter::Directional {
                direction: place.matrix3.z_axis.as_vec3(),
                irradiance: light_power,
            },
            "point" => Emitter::Point {
                position,
                intensity: light_power,
            },
            "spot" => self.spot(&light, &place, light_power, &of),
            _ => {
                let message = format!("light {index} is of the unknown type \"{kind}\"");
                return Err(error(self.path(), message));
            }
        };
        let name = light.get("name").and_then(Value::as_str);
        let name = name.map_or_else(|| format!("light.{index}"), str::to_owned);
        self.parts.add_emitter(emitter, name);
        Ok(())
    }

    fn spot(&mut self, light: &Value, place: &DAffine3, intensity: Rgb, of: &str) -> Emitter {
        let cone = light.get("spot").cloned().unwrap_or_default();
        let outer = number(&cone, "outerConeAngle", std::f64::consts::FRAC_PI_4) as f32;
        let outer = self.within(&format!("{of}: outerConeAngle"), outer, [2e-4, FRAC_PI_2]);
        let inner = number(&cone, "innerConeAngle", 0.0) as f32;
        let inner = self.within(&format!("{of}: innerConeAngle"), inner, [0.0, outer]);
        let m = place.matrix3;
        Emitter::Spot {
            to_world: Affine3A::from_cols(
                m.x_axis.as_vec3a(),
                m.y_axis.as_vec3a(),
                m.z_axis.as_vec3a(),
                place.translation.as_vec3a(),
            ),
            intensity,
            cutoff_degrees: outer.to_degrees(),
            beam_degrees: inner.to_degrees(),
            falloff: Falloff::Linear,
            texture: None,
        }
    }

    /// Imports camera `index`, which stands at node `node`.
    pub(super) fn camera(
        &mut self,
        index: usize,
        node: usize,
        to_world: &DAffine3,
    ) -> Result<(), ImportError> {
        let document = self.document();
        let Some(camera) = document.cameras.get(index) else {
            return Err(error(self.path(), format!("there is no camera {index}")));
        };
        let Some(place) = rigid(to_world) else {
            self.warn(format!("camera {index} stands at a node without extent"));
            return Ok(());
        };
        let name = name_of(document, node, camera);
        let Some((description, aspect)) = describe(camera, place) else {
            let message = format!("camera {index} has no field of view");
            return Err(error(self.path(), message));
        };
        self.parts.cameras.push(NamedCamera {
            name,
            camera: description,
            aspect,
        });
        Ok(())
    }
}

/// The node's name, which is the one that people see in their modeller, or the camera's.
fn name_of(document: &Document, node: usize, camera: &Camera) -> String {
    let node = document.nodes.get(node).and_then(|n| n.name.clone());
    node.or_else(|| camera.name.clone()).unwrap_or_default()
}

/// The camera, and the width over height it was made for.
fn describe(camera: &Camera, to_world: DAffine3) -> Option<(CameraDescription, Option<f64>)> {
    let sane = |x: f64, default: f64| if x > 0.0 { x } else { default };
    if let Some(p) = &camera.perspective {
        let near_clip = sane(p.znear, 1e-3);
        let fov_degrees = p.yfov.to_degrees();
        let description = CameraDescription {
            to_world,
            projection: Projection::Perspective {
                fov_degrees: (fov_degrees > 0.0 && fov_degrees < 180.0).then_some(fov_degrees)?,
                fov_axis: FovAxis::Y,
                principal_point: [0.0; 2],
            },
            near_clip,
            far_clip: p
                .zfar
                .filter(|f| *f > near_clip)
                .unwrap_or(f64::MAX)
                .min(1e30),
        };
        return Some((description, p.aspect_ratio.filter(|a| *a > 0.0)));
    }
    let o = camera.orthographic.as_ref()?;
    // The film spans [-1, 1] in camera x: half the picture's width is the scale.
    let scale = DMat3::from_diagonal(DVec3::new(o.xmag, o.xmag, 1.0));
    let usable = o.xmag != 0.0 && o.xmag.is_finite();
    let to_world = DAffine3 {
        matrix3: to_world.matrix3 * scale,
        translation: to_world.translation,
    };
    let description = CameraDescription {
        to_world,
        projection: Projection::Orthographic,
        near_clip: o.znear.max(0.0),
        far_clip: sane(o.zfar, 1e30),
    };
    let aspect = (o.xmag / o.ymag).abs();
    let aspect = (aspect > 0.0 && aspect.is_finite()).then_some(aspect);
    usable.then_some((description, aspect))
}
