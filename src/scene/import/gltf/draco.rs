//! `KHR_draco_mesh_compression`: primitives whose attributes and indices are one stream of Draco.
//!
//! Draco's own decoder is C++ (the crate that decodes without it needs a newer Rust than this
//! program): it is there with the feature `draco`. Without it such primitives are refused, unless
//! the file has their vertices without compression as well.

use super::container::{Container, Unpacked};
#[cfg(not(feature = "draco"))]
use super::hint;
use super::schema::Primitive;
use crate::scene::import::ImportError;
use std::collections::HashMap;

#[cfg(feature = "draco")]
#[path = "../../../../ffi/draco.rs"]
mod library;

/// The name of the extension.
const NAME: &str = "KHR_draco_mesh_compression";

/// Accessors by number, and what they hold.
type Accessors = HashMap<usize, Unpacked>;

/// Decodes what Draco compressed in a file.
///
/// # Errors
/// When a stream cannot be decoded, or this build cannot decode any.
pub(super) fn unpack(container: &Container) -> Result<Accessors, ImportError> {
    let meshes = container.document.meshes.iter().enumerate();
    let primitives = meshes.flat_map(|(i, m)| m.primitives.iter().map(move |p| (i, p)));
    let packed: Vec<_> = primitives
        .filter(|(_, p)| p.extensions.contains_key(NAME))
        .collect();
    decode(container, &packed)
}

/// Whether the file has the primitive's vertices without compression.
#[cfg(not(feature = "draco"))]
fn has_plain(container: &Container, primitive: &Primitive) -> bool {
    let position = primitive.attributes.get("POSITION");
    let accessor = position.and_then(|p| container.document.accessors.get(*p));
    accessor.is_some_and(|a| a.buffer_view.is_some())
}

#[cfg(not(feature = "draco"))]
fn decode(container: &Container, packed: &[(usize, &Primitive)]) -> Result<Accessors, ImportError> {
    match packed.iter().find(|(_, p)| !has_plain(container, p)) {
        None => Ok(HashMap::new()),
        Some((mesh, _)) => Err(hint(
            &container.path,
            format!("mesh {mesh} is compressed with Draco ({NAME}), which this build cannot read"),
            "build twintree with --features draco (Debian's package libdraco-dev), or export the file without compression of meshes",
        )),
    }
}

#[cfg(feature = "draco")]
use streams::decode;

#[cfg(feature = "draco")]
mod streams {
    use super::super::accessor::{Component, components};
    use super::super::error;
    use super::*;
    use rayon::prelude::*;
    use serde::Deserialize;
    use std::collections::BTreeMap;

    /// glTF's code of 32-bit unsigned numbers.
    const U32: u32 = 5125;
    /// Bytes that the decoder takes for a face and a point, at the least.
    const FACE_BYTES: u64 = 64;
    const POINT_BYTES: u64 = 32;

    /// The extension's object.
    #[derive(Debug, Default, Deserialize)]
    #[serde(rename_all = "camelCase", default)]
    struct Stream {
        buffer_view: usize,
        /// Attributes and their unique ids.
        attributes: BTreeMap<String, u32>,
    }

    pub(super) fn decode(
        container: &Container,
        packed: &[(usize, &Primitive)],
    ) -> Result<Accessors, ImportError> {
        let decoded: Vec<_> = packed
            .par_iter()
            .map(|(mesh, primitive)| {
                stream(container, primitive).map_err(|why| {
                    let message =
                        format!("mesh {mesh}, compressed with Draco, cannot be read: {why}");
                    error(&container.path, message)
                })
            })
            .collect::<Result<_, ImportError>>()?;
        Ok(decoded.into_iter().flatten().collect())
    }

    /// The accessors of one primitive.
    fn stream(
        container: &Container,
        primitive: &Primitive,
    ) -> Result<Vec<(usize, Unpacked)>, String> {
        let extension = primitive.extensions.get(NAME).cloned().unwrap_or_default();
        let stream: Stream = serde_json::from_value(extension).map_err(|e| e.to_string())?;
        let bytes = container.view(stream.buffer_view).map_err(|e| e.message)?;
        let (faces, points) = promised(bytes).unwrap_or_default();
        let needed = faces.saturating_mul(FACE_BYTES);
        let needed = needed.saturating_add(points.saturating_mul(POINT_BYTES));
        let needed = usize::try_from(needed).unwrap_or(usize::MAX);
        container.unpack(needed, 1).map_err(|e| e.message)?;
        let mesh = library::Decoded::new(bytes)?;
        let mut all = Vec::new();
        for (name, id) in &stream.attributes {
            let Some(&index) = primitive.attributes.get(name) else {
                continue;
            };
            let accessor = container.document.accessors.get(index);
            let accessor = accessor.ok_or_else(|| format!("there is no accessor {index}"))?;
            let code = accessor.component_type;
            let kind = Component::of(code).zip(components(&accessor.kind));
            let (component, count) = kind.ok_or(format!("accessor {index} is of no known type"))?;
            let bytes = mesh.attribute(*id, count, (code, component.size()))?;
            all.push((index, Unpacked { code, bytes }));
        }
        if let Some(index) = primitive.indices {
            let indices = mesh.indices()?;
            let bytes = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
            all.push((index, Unpacked { code: U32, bytes }));
        }
        Ok(all)
    }

    /// Faces and points that the head of a stream promises (Draco's specification, 4 and 5), so
    /// that a short file does not ask for much memory; `None` where the decoder will not read it.
    fn promised(bytes: &[u8]) -> Option<(u64, u64)> {
        const HEAD: usize = 11;
        const METADATA: u16 = 0x8000;
        const EDGEBREAKER: u8 = 1;
        let head = bytes.get(..HEAD)?;
        let flags = u16::from_le_bytes([head[9], head[10]]);
        let mut rest = bytes.get(HEAD..)?;
        if flags & METADATA != 0 {
            // What lies behind metadata is not looked for: their length is bounded by the file's.
            return None;
        }
        let second = |first: u64, rest: &mut &[u8]| Some((first, number(rest)?));
        if head[8] == EDGEBREAKER {
            let (_traversal, behind) = rest.split_first()?;
            rest = behind;
            let points = number(&mut rest)?;
            let (points, faces) = second(points, &mut rest)?;
            return Some((faces, points));
        }
        let faces = number(&mut rest)?;
        second(faces, &mut rest)
    }

    /// A number of seven bits a byte.
    fn number(bytes: &mut &[u8]) -> Option<u64> {
        let mut value = 0u64;
        for shift in (0..35).step_by(7) {
            let (byte, rest) = bytes.split_first()?;
            *bytes = rest;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }
}
