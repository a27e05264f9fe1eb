//! Tests of the importer as a whole, on files made here.

use super::{GltfOptions, load};
use crate::bsdf::Material;
use crate::camera::Projection;
use crate::image::ImageError;
use crate::image::decoded::DecodeLimit;
use crate::light::Emitter;
use crate::math::{DAffine3, DVec3, Rgb, Vec3};
use crate::scene::import::parts::Parts;
use crate::scene::import::{ImportError, ImportOptions, OpenTexture};
use crate::scene::{Geometry, Mesh};
use crate::texture::{BitmapSettings, Texture};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};

mod broken;
mod files;
mod layers;
mod looks;
mod packed;
mod placing;
mod showing;
mod sides;

/// Remembers what was asked for and opens nothing: every image is a grey of 0.5.
#[derive(Default)]
struct Asked(Mutex<Vec<BitmapSettings>>);

impl OpenTexture for Asked {
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        self.0.lock().unwrap().push(settings);
        Ok(Texture::Constant(Rgb::splat(0.5)))
    }
}

/// A file under construction.
struct File {
    json: Value,
    bytes: Vec<u8>,
}

impl File {
    /// With one node that holds mesh 0, whose primitive is a unit right triangle with corners 0, x,
    /// y.
    fn triangle() -> Self {
        let mut file = Self {
            json: json!({
                "asset": {"version": "2.0"},
                "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {}}]}],
                "bufferViews": [], "accessors": [],
            }),
            bytes: Vec::new(),
        };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let positions = file.floats(&corners);
        file.primitive()["attributes"]["POSITION"] = positions.into();
        file
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Appends bytes; the number of their view.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        let list = self.json["accessors"].as_array_mut().unwrap();
        list.push(accessor);
        list.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        let view = self.view(&bytes);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.accessor(json!({
            "bufferView": view, "componentType": 5126, "count": values.len(), "type": kind,
        }))
    }

    fn integers<T: bytemuck::Pod>(&mut self, code: u32, kind: &str, values: &[T]) -> usize {
        let count = match kind {
            "VEC2" => values.len() / 2,
            "VEC3" => values.len() / 3,
            _ => values.len(),
        };
        let view = self.view(bytemuck::cast_slice(values));
        self.accessor(json!({
            "bufferView": view, "componentType": code, "count": count, "type": kind,
        }))
    }

    /// The JSON with its buffer inside.
    fn text(&self) -> String {
        let mut json = self.json.clone();
        let data = BASE64_STANDARD.encode(&self.bytes);
        json["buffers"] = json!([{
            "byteLength": self.bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{data}"),
        }]);
        json.to_string()
    }

    fn load(&self) -> Parts {
        self.load_with(&DAffine3::IDENTITY)
            .unwrap_or_else(|e| panic!("{e}"))
    }

    fn error(&self) -> String {
        match self.load_with(&DAffine3::IDENTITY) {
            Ok(_) => panic!("this should not load"),
            Err(e) => e.to_string(),
        }
    }

    fn load_with(&self, to_world: &DAffine3) -> Result<Parts, ImportError> {
        let asked = Arc::new(Asked::default());
        load_text(&self.text(), to_world, asked)
    }

    fn load_as(&self, gltf: &GltfOptions) -> Result<Parts, ImportError> {
        load_bytes_as(self.text().as_bytes(), gltf, Arc::new(Asked::default()))
    }
}

fn load_text(text: &str, to_world: &DAffine3, asked: Arc<Asked>) -> Result<Parts, ImportError> {
    load_bytes(text.as_bytes(), to_world, asked)
}

fn load_bytes(text: &[u8], to_world: &DAffine3, asked: Arc<Asked>) -> Result<Parts, ImportError> {
    let gltf = GltfOptions {
        to_world: *to_world,
        ..GltfOptions::default()
    };
    load_bytes_as(text, &gltf, asked)
}

fn load_bytes_as(text: &[u8], gltf: &GltfOptions, asked: Arc<Asked>) -> Result<Parts, ImportError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let mut parts = Parts::default();
    let options = ImportOptions {
        decode: DecodeLimit { bytes: 16 << 20 },
        ..ImportOptions::new(asked)
    };
    load(&path, gltf, &options, &mut parts)?;
    Ok(parts)
}

fn mesh(parts: &Parts, shape: usize) -> &Mesh {
    match &parts.shapes[shape].geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// The corners of the first triangle of a shape.
fn corners(parts: &Parts, shape: usize) -> [Vec3; 3] {
    mesh(parts, shape).triangles.corners(0)
}
