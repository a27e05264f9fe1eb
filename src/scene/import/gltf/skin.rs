//! Skins: vertices moved with joints (glTF 2.0, 3.7.3.3).

use super::accessor::Accessors;
use super::error;
use super::schema::Primitive;
use crate::math::{DAffine3, DVec3};
use crate::scene::import::ImportError;
use crate::scene::import::mesh::Buffers;

/// How far the weights of a vertex may be from one: quantised ones are not exact.
const SLACK: f64 = 0.05;

/// The joints of each vertex and their weights, four at a time.
struct Influences {
    joints: Vec<[f32; 4]>,
    weights: Vec<[f32; 4]>,
}

/// What was odd about the weights.
#[derive(Default)]
struct Odd {
    /// Weights on joints that the skin does not have.
    beyond: usize,
    /// Vertices whose weights do not sum to one.
    sums: usize,
    /// Vertices without any weight.
    none: usize,
}

/// Moves the vertices of `buffers` with `joints`, matrices to the world. Returns what is to be
/// told.
pub(super) fn bend(
    accessors: Accessors,
    primitive: &Primitive,
    joints: &[DAffine3],
    buffers: &mut Buffers,
) -> Result<Vec<String>, ImportError> {
    let sets = influences(accessors, primitive, buffers.positions.len())?;
    if sets.is_empty() {
        return Ok(vec![
            "it has a skin and no joints: it stands as it was made".into(),
        ]);
    }
    let mut odd = Odd::default();
    for (i, p) in buffers.positions.iter_mut().enumerate() {
        let Some(blended) = blend(&sets, i, joints, &mut odd) else {
            continue;
        };
        *p = blended.transform_point3(p.as_dvec3()).as_vec3();
        let normal = buffers.normals.as_mut().and_then(|n| n.get_mut(i));
        if let Some(n) = normal {
            let turned: DVec3 = blended.matrix3.inverse().transpose() * n.as_dvec3();
            *n = turned.normalize_or_zero().as_vec3();
        }
        let tangent = buffers.tangents.as_mut().and_then(|t| t.get_mut(i));
        if let Some(t) = tangent {
            let turned = (blended.matrix3 * t.truncate().as_dvec3()).as_vec3();
            *t = turned.extend(t.w);
        }
    }
    Ok(odd.told(joints.len()))
}

/// The sets of joints and weights of `count` vertices.
fn influences(
    accessors: Accessors,
    primitive: &Primitive,
    count: usize,
) -> Result<Vec<Influences>, ImportError> {
    let mut sets = Vec::new();
    loop {
        let named = |kind: &str| {
            let name = format!("{kind}_{}", sets.len());
            primitive.attributes.get(&name).copied()
        };
        let (Some(joints), Some(weights)) = (named("JOINTS"), named("WEIGHTS")) else {
            return Ok(sets);
        };
        let set = Influences {
            joints: accessors.floats(joints)?,
            weights: accessors.floats(weights)?,
        };
        if set.joints.len() != count || set.weights.len() != count {
            let message = "joints and weights of one primitive differ in length from its vertices";
            return Err(error(&accessors.container.path, message));
        }
        sets.push(set);
    }
}

/// The mean of the joints' matrices at vertex `i`; `None` where nothing moves it.
fn blend(sets: &[Influences], i: usize, joints: &[DAffine3], odd: &mut Odd) -> Option<DAffine3> {
    let mut blended = DAffine3::ZERO;
    let mut sum = 0.0;
    for set in sets {
        for (&joint, &weight) in set.joints[i].iter().zip(&set.weights[i]) {
            let weight = f64::from(weight);
            if weight == 0.0 || !weight.is_finite() {
                continue;
            }
            let Some(matrix) = joints.get(joint as usize) else {
                odd.beyond += 1;
                continue;
            };
            blended.matrix3 += matrix.matrix3 * weight;
            blended.translation += matrix.translation * weight;
            sum += weight;
        }
    }
    if sum <= 0.0 {
        odd.none += 1;
        return None;
    }
    odd.sums += usize::from((sum - 1.0).abs() > SLACK);
    blended.matrix3 *= 1.0 / sum;
    blended.translation /= sum;
    Some(blended)
}

impl Odd {
    fn told(&self, joints: usize) -> Vec<String> {
        let mut told = Vec::new();
        if self.beyond > 0 {
            let count = self.beyond;
            told.push(format!(
                "{count} weights are on joints that are not there (the skin has {joints}): left out"
            ));
        }
        if self.sums > 0 {
            let count = self.sums;
            told.push(format!(
                "the weights of {count} vertices do not sum to 1: divided by their sum"
            ));
        }
        if self.none > 0 {
            let count = self.none;
            told.push(format!(
                "{count} vertices have no weight on any joint: they stay where they were made"
            ));
        }
        told
    }
}
