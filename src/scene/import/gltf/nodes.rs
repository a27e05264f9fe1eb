//! The tree of nodes: where meshes, cameras and lights stand.

use super::accessor::Accessors;
use super::error;
use super::schema::{Document, GltfNode};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::ImportError;
use glam::{DMat4, DQuat};
use serde_json::Value;
use std::path::Path;

/// A mesh in the world.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    pub node: usize,
    pub mesh: usize,
    pub to_world: DAffine3,
}

/// Everything that stands in a scene.
#[derive(Debug, Default)]
pub(super) struct Standing {
    pub meshes: Vec<Placement>,
    /// Camera, and the node it belongs to.
    pub cameras: Vec<(usize, usize)>,
    /// Light, and the node it belongs to.
    pub lights: Vec<(usize, usize)>,
    /// To the world, for each node; identity for nodes that are not in the scene.
    pub to_world: Vec<DAffine3>,
    /// Whether each node is in the scene.
    pub stands: Vec<bool>,
}

/// The local transform of a node.
fn local(node: &GltfNode) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(matrix));
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, DQuat::from_array);
    let length = rotation.length_squared();
    let rotation = if length > 0.0 && length.is_finite() {
        rotation.normalize()
    } else {
        DQuat::IDENTITY
    };
    DAffine3::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, DVec3::from),
        rotation,
        node.translation.map_or(DVec3::ZERO, DVec3::from),
    )
}

/// Nodes that no other node has as a child.
fn roots(document: &Document) -> Vec<usize> {
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|n| &n.children) {
        if let Some(flag) = is_child.get_mut(child) {
            *flag = true;
        }
    }
    (0..is_child.len()).filter(|&i| !is_child[i]).collect()
}

/// Walks the tree of the scene `scene`, or of all nodes.
pub(super) fn walk(
    document: &Document,
    scene: Option<usize>,
    accessors: Accessors,
    root: &DAffine3,
    path: &Path,
) -> Result<Standing, ImportError> {
    let scene = scene.and_then(|s| document.scenes.get(s));
    let start = scene.map_or_else(|| roots(document), |s| s.nodes.clone());
    let count = document.nodes.len();
    let mut standing = Standing {
        to_world: vec![DAffine3::IDENTITY; count],
        ..Standing::default()
    };
    let mut visited = vec![false; count];
    // The first of the list is the last to be pushed: nodes are met in the file's order.
    let mut waiting: Vec<(usize, DAffine3, bool)> =
        start.iter().rev().map(|&n| (n, *root, true)).collect();
    while let Some((index, parent, shown)) = waiting.pop() {
        let Some(node) = document.nodes.get(index) else {
            return Err(error(path, format!("there is no node {index}")));
        };
        if std::mem::replace(&mut visited[index], true) {
            let message = format!("node {index} stands in the tree twice");
            return Err(error(path, message));
        }
        let to_world = parent * local(node);
        standing.to_world[index] = to_world;
        let shown = shown && is_shown(node);
        collect(&mut standing, (node, index, shown), accessors, path)?;
        waiting.extend(node.children.iter().rev().map(|&n| (n, to_world, shown)));
    }
    standing.stands = visited;
    Ok(standing)
}

/// Whether a node itself is to be seen (`KHR_node_visibility`).
fn is_shown(node: &GltfNode) -> bool {
    let extension = node.extensions.get("KHR_node_visibility");
    let shown = extension.and_then(|e| e.get("visible")?.as_bool());
    shown.unwrap_or(true)
}

/// Notes what stands at a node. Cameras do where nothing is shown, too.
fn collect(
    standing: &mut Standing,
    (node, index, shown): (&GltfNode, usize, bool),
    accessors: Accessors,
    path: &Path,
) -> Result<(), ImportError> {
    let to_world = standing.to_world[index];
    standing.cameras.extend(node.camera.map(|c| (c, index)));
    if !shown {
        return Ok(());
    }
    if let Some(mesh) = node.mesh {
        let places = match node.extensions.get("EXT_mesh_gpu_instancing") {
            Some(extension) => crowd(extension, accessors).and_then(|places| {
                places.ok_or_else(|| {
                    let message = format!("the instances of node {index} differ in number");
                    error(path, message)
                })
            })?,
            None => vec![DAffine3::IDENTITY],
        };
        standing
            .meshes
            .extend(places.into_iter().map(|place| Placement {
                node: index,
                mesh,
                to_world: to_world * place,
            }));
    }
    if let Some(light) = node.extensions.get("KHR_lights_punctual") {
        let light = light.get("light").and_then(Value::as_u64);
        let light = light.and_then(|l| usize::try_from(l).ok());
        let light = light.ok_or_else(|| {
            let message = format!("node {index} names a light by no number");
            error(path, message)
        })?;
        standing.lights.push((light, index));
    }
    Ok(())
}

/// Many places of one mesh (`EXT_mesh_gpu_instancing`); `None` where its lists differ in length.
fn crowd(extension: &Value, accessors: Accessors) -> Result<Option<Vec<DAffine3>>, ImportError> {
    let named = |name: &str| {
        let index = extension.get("attributes")?.get(name)?.as_u64()?;
        usize::try_from(index).ok()
    };
    let translations = named("TRANSLATION")
        .map(|a| accessors.floats::<3>(a))
        .transpose()?;
    let rotations = named("ROTATION")
        .map(|a| accessors.floats::<4>(a))
        .transpose()?;
    let scales = named("SCALE")
        .map(|a| accessors.floats::<3>(a))
        .transpose()?;
    let lengths = [
        translations.as_ref().map_or(0, Vec::len),
        rotations.as_ref().map_or(0, Vec::len),
        scales.as_ref().map_or(0, Vec::len),
    ];
    let count = lengths.into_iter().max().unwrap_or(0);
    if lengths.iter().any(|n| *n != 0 && *n != count) {
        return Ok(None);
    }
    let vector = |list: &Option<Vec<[f32; 3]>>, i: usize| {
        let value = list.as_ref()?.get(i)?;
        Some(DVec3::from_array(value.map(f64::from)))
    };
    let node = |i: usize| GltfNode {
        translation: vector(&translations, i).map(|v| v.to_array()),
        rotation: rotations
            .as_ref()
            .and_then(|list| list.get(i))
            .map(|q| q.map(f64::from)),
        scale: vector(&scales, i).map(|v| v.to_array()),
        ..GltfNode::default()
    };
    Ok(Some((0..count).map(|i| local(&node(i))).collect()))
}
