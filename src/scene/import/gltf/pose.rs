//! Animations at a moment (glTF 2.0, 3.11 and appendix C): they write the nodes' own transforms and
//! the weights of morph targets, before anything is placed.

use super::accessor::Accessors;
use super::container::Container;
use super::schema::{Animation, AnimationChannel, AnimationSampler, GltfNode};
use super::{error, hint};
use crate::scene::import::ImportError;
use glam::{DQuat, DVec4};
use std::str::FromStr;

/// A moment of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The animation's name or number; `None` is the first.
    pub animation: Option<String>,
    /// Seconds from its start.
    pub seconds: f64,
}

impl FromStr for Moment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (animation, seconds) = match text.rsplit_once(':') {
            Some((name, seconds)) if !name.is_empty() => (Some(name.to_owned()), seconds),
            _ => (None, text),
        };
        let expected = || "expected seconds such as 1.5, or Walk:1.5".to_owned();
        let seconds: f64 = seconds.parse().map_err(|_| expected())?;
        match seconds.is_finite() {
            true => Ok(Self { animation, seconds }),
            false => Err(expected()),
        }
    }
}

/// What a channel moves a node's part to.
enum Moved {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
    Weights(Vec<f64>),
}

/// Moves the nodes of a file to where they are at that moment. Returns what is to be told.
///
/// # Errors
/// When there is no such animation, or one of its channels makes no sense.
pub(super) fn strike(
    container: &mut Container,
    moment: &Moment,
) -> Result<Vec<String>, ImportError> {
    let animations = &container.document.animations;
    if animations.is_empty() {
        return Ok(vec!["has no animation: --at has no effect on it".into()]);
    }
    let index = find(container, moment)?;
    let mut told = Vec::new();
    if moment.animation.is_none() && animations.len() > 1 {
        let names = names(animations).join(", ");
        told.push(format!(
            "the first of its animations is shown ({names}): --at NAME:SECONDS shows another"
        ));
    }
    let mut moved = Vec::new();
    let mut others = 0;
    for channel in &animations[index].channels {
        match channel_at(container, &animations[index], channel, moment.seconds)? {
            Some(change) => moved.push(change),
            None => others += 1,
        }
    }
    if others > 0 {
        told.push(format!(
            "{others} channels of animation {index} move something else than nodes (KHR_animation_pointer): left out"
        ));
    }
    for (node, change) in moved {
        let node = &mut container.document.nodes[node];
        apply(node, change);
    }
    Ok(told)
}

fn names(animations: &[Animation]) -> Vec<String> {
    let name = |(i, a): (usize, &Animation)| a.name.clone().unwrap_or_else(|| i.to_string());
    animations.iter().enumerate().map(name).collect()
}

/// The number of the animation that is asked for.
fn find(container: &Container, moment: &Moment) -> Result<usize, ImportError> {
    let Some(asked) = &moment.animation else {
        return Ok(0);
    };
    let animations = &container.document.animations;
    let by_name = animations
        .iter()
        .position(|a| a.name.as_ref() == Some(asked));
    let number = || asked.parse().ok().filter(|i| *i < animations.len());
    by_name.or_else(number).ok_or_else(|| {
        let message = format!("has no animation \"{asked}\"");
        let help = format!("its animations are {}", names(animations).join(", "));
        hint(&container.path, message, &help)
    })
}

fn apply(node: &mut GltfNode, change: Moved) {
    // A node that is animated has no matrix (3.11): what it is at rest counts for the other parts.
    if let Some(matrix) = node.matrix.take() {
        let matrix = glam::DMat4::from_cols_array(&matrix);
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        node.scale = Some(scale.to_array());
        node.rotation = Some(rotation.to_array());
        node.translation = Some(translation.to_array());
    }
    match change {
        Moved::Translation(v) => node.translation = Some(v),
        Moved::Rotation(v) => node.rotation = Some(v),
        Moved::Scale(v) => node.scale = Some(v),
        Moved::Weights(v) => node.weights = Some(v),
    }
}

/// What a channel does to which node; `None` where that is no node's own part.
fn channel_at(
    container: &Container,
    animation: &Animation,
    channel: &AnimationChannel,
    seconds: f64,
) -> Result<Option<(usize, Moved)>, ImportError> {
    let fail = |message: &str| error(&container.path, message);
    let target = &channel.target;
    let Some(node) = target.node else {
        return Ok(None);
    };
    let Some(of) = container.document.nodes.get(node) else {
        return Err(fail(&format!(
            "an animation moves node {node}, which is not there"
        )));
    };
    let sampler = animation.samplers.get(channel.sampler);
    let sampler = sampler.ok_or_else(|| fail("a channel of an animation has no sampler"))?;
    let track = |width: usize| Track::read(container, sampler, width, target.path == "rotation");
    let three = |values: Vec<f64>| [values[0], values[1], values[2]];
    Ok(match target.path.as_str() {
        "translation" => Some(Moved::Translation(three(track(3)?.at(seconds)))),
        "scale" => Some(Moved::Scale(three(track(3)?.at(seconds)))),
        "rotation" => {
            let q = track(4)?.at(seconds);
            Some(Moved::Rotation([q[0], q[1], q[2], q[3]]))
        }
        "weights" => match targets(container, of) {
            0 => {
                return Err(fail(&format!(
                    "node {node} has no morph targets to animate"
                )));
            }
            count => Some(Moved::Weights(track(count)?.at(seconds))),
        },
        _ => None,
    }
    .map(|change| (node, change)))
}

/// How many morph targets a node's mesh has.
fn targets(container: &Container, node: &GltfNode) -> usize {
    let mesh = node.mesh.and_then(|m| container.document.meshes.get(m));
    let primitives = mesh.map_or(&[][..], |m| m.primitives.as_slice());
    primitives
        .iter()
        .map(|p| p.targets.len())
        .max()
        .unwrap_or(0)
}

/// How values between two keys are found.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Step,
    Linear,
    Cubic,
}

/// The keys of a channel.
struct Track {
    times: Vec<f32>,
    /// For each key `width` numbers, or the tangent before it, they, and the tangent behind it.
    values: Vec<f64>,
    width: usize,
    way: Way,
    /// The numbers are a quaternion.
    turns: bool,
}

impl Track {
    fn read(
        container: &Container,
        sampler: &AnimationSampler,
        width: usize,
        turns: bool,
    ) -> Result<Self, ImportError> {
        let accessors = Accessors { container };
        let times = accessors.floats::<1>(sampler.input)?;
        let times: Vec<f32> = times.into_iter().flatten().collect();
        let way = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Way::Linear,
            Some("STEP") => Way::Step,
            Some("CUBICSPLINE") => Way::Cubic,
            Some(other) => {
                let message =
                    format!("an animation is interpolated in the unknown way \"{other}\"");
                return Err(error(&container.path, message));
            }
        };
        let values = match accessors.width(sampler.output)? {
            3 => flat(accessors.floats::<3>(sampler.output)?),
            4 => flat(accessors.floats::<4>(sampler.output)?),
            _ => flat(accessors.floats::<1>(sampler.output)?),
        };
        let each = width * if way == Way::Cubic { 3 } else { 1 };
        let needed = times.len().checked_mul(each);
        let sound = times.iter().all(|t| t.is_finite()) && times.is_sorted();
        if times.is_empty() || needed.is_none_or(|n| n > values.len()) || !sound {
            let message = format!(
                "an animation's {} values do not go with its {} keys",
                values.len(),
                times.len()
            );
            return Err(error(&container.path, message));
        }
        Ok(Self {
            times,
            values,
            width,
            way,
            turns,
        })
    }

    /// Part `part` of key `key`: of splines 0 is the tangent before it, 1 the value, 2 the tangent
    /// behind it.
    fn key(&self, key: usize, part: usize) -> &[f64] {
        let (each, part) = match self.way {
            Way::Cubic => (3, part),
            _ => (1, 0),
        };
        let start = (key * each + part) * self.width;
        &self.values[start..start + self.width]
    }

    /// The value at a moment; that of the first key before it, and that of the last one behind it.
    fn at(&self, seconds: f64) -> Vec<f64> {
        let behind = self.times.partition_point(|t| f64::from(*t) <= seconds);
        let last = self.times.len() - 1;
        if behind == 0 {
            return self.key(0, 1).to_vec();
        }
        let before = behind - 1;
        if before == last || self.way == Way::Step {
            return self.key(before, 1).to_vec();
        }
        let start = f64::from(self.times[before]);
        let length = f64::from(self.times[behind]) - start;
        let t = ((seconds - start) / length).clamp(0.0, 1.0);
        let (a, b) = (self.key(before, 1), self.key(behind, 1));
        if self.way == Way::Cubic {
            let (out, into) = (self.key(before, 2), self.key(behind, 0));
            return spline([a, out, into, b], t, length);
        }
        if self.turns {
            return slerp(a, b, t).to_vec();
        }
        a.iter().zip(b).map(|(a, b)| a + (b - a) * t).collect()
    }
}

fn flat<const N: usize>(values: Vec<[f32; N]>) -> Vec<f64> {
    values.into_iter().flatten().map(f64::from).collect()
}

/// Hermite's spline from the value `a`, leaving it with the tangent `out`, to `b`, reached with
/// `into`; tangents are changes a second (appendix C.5).
fn spline([a, out, into, b]: [&[f64]; 4], t: f64, length: f64) -> Vec<f64> {
    let (t2, t3) = (t * t, t * t * t);
    let value = |i: usize| {
        (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
            + length * (t3 - 2.0 * t2 + t) * out[i]
            + (3.0 * t2 - 2.0 * t3) * b[i]
            + length * (t3 - t2) * into[i]
    };
    (0..a.len()).map(value).collect()
}

/// The rotation between two, along the shorter way (appendix C.4).
fn slerp(a: &[f64], b: &[f64], t: f64) -> [f64; 4] {
    let of = |q: &[f64]| DVec4::new(q[0], q[1], q[2], q[3]).normalize_or(DVec4::W);
    let [a, b] = [of(a), of(b)].map(DQuat::from_vec4);
    a.slerp(b, t).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(way: Way, width: usize, values: &[f64]) -> Track {
        Track {
            times: vec![1.0, 3.0],
            values: values.to_vec(),
            width,
            way,
            turns: width == 4,
        }
    }

    #[test]
    fn values_lie_between_their_keys_in_all_three_ways() {
        let step = track(Way::Step, 1, &[5.0, 9.0]);
        assert_eq!(
            [0.0, 1.0, 2.9, 3.0, 8.0].map(|t| step.at(t)[0]),
            [5.0, 5.0, 5.0, 9.0, 9.0]
        );
        let linear = track(Way::Linear, 1, &[5.0, 9.0]);
        assert_eq!(
            [0.0, 1.5, 2.0, 9.0].map(|t| linear.at(t)[0]),
            [5.0, 6.0, 7.0, 9.0]
        );
        // A parabola from 0 to 4, x^2 over two seconds: changes of 0 and 4 a second at its ends.
        let cubic = track(Way::Cubic, 1, &[7.0, 0.0, 0.0, 4.0, 4.0, 7.0]);
        for x in [0.0, 0.3, 1.0, 1.7, 2.0] {
            assert!((cubic.at(1.0 + x)[0] - x * x).abs() < 1e-12, "{x}");
        }
        assert_eq!((cubic.at(0.0)[0], cubic.at(9.0)[0]), (0.0, 4.0));
    }

    #[test]
    fn rotations_go_the_shorter_way_at_constant_speed() {
        let half = std::f64::consts::FRAC_PI_8;
        let quarter = [0.0, (2.0 * half).sin(), 0.0, (2.0 * half).cos()];
        // The same rotation has two quaternions: this one's negative lies nearer.
        let far = quarter.map(|x| -x);
        let turning = track(Way::Linear, 4, &[[0.0, 0.0, 0.0, 1.0], far].concat());
        let middle = DQuat::from_slice(&turning.at(2.0));
        let wanted = DQuat::from_rotation_y(2.0 * half);
        assert!(middle.dot(wanted).abs() > 1.0 - 1e-12, "{middle}");
    }

    #[test]
    fn moments_are_seconds_of_the_first_or_of_a_named_animation() {
        let of = |name: Option<&str>, seconds| {
            let animation = name.map(str::to_owned);
            Ok(Moment { animation, seconds })
        };
        assert_eq!("1.5".parse(), of(None, 1.5));
        assert_eq!("Walk:0.25".parse(), of(Some("Walk"), 0.25));
        assert_eq!("A:b:2".parse(), of(Some("A:b"), 2.0));
        for text in ["", "Walk", "Walk:", "inf", "nan", "1s"] {
            assert!(text.parse::<Moment>().is_err(), "{text}");
        }
    }
}
