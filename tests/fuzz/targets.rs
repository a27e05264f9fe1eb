//! What is tried with an input: by the tests beside this file, and by the fuzzer.

#![allow(dead_code, missing_docs)]

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use twintree::accel::{Backend, BuildSettings};
use twintree::camera::Camera;
use twintree::film::Film;
use twintree::film::part::PartReader;
use twintree::guide::Trainer;
use twintree::image;
use twintree::image::decoded::DecodeLimit;
use twintree::integrate::View;
use twintree::integrate::progress::{Limits, Observer, Progress};
use twintree::integrate::render::render;
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::math::{Rgb, Vec2, Vec3};
use twintree::scene::import::default_scene::Studio;
use twintree::scene::import::gltf::{self, GltfOptions, Show};
use twintree::scene::import::mesh::{MeshKind, MeshOptions, read};
use twintree::scene::import::models::{self, ModelOptions, ModelSource};
use twintree::scene::import::parts::Parts;
use twintree::scene::import::{ImportError, ImportOptions, mitsuba, pbrt};
use twintree::scene::{Description, Mesh, Scene};
use twintree::texture::TextureStore;

struct Silent;

impl Observer for Silent {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

/// An error must say something, and where. A scene tells up to a hundred of its faults, a line or
/// two each.
fn worded(error: &dyn std::fmt::Display, place: &str) {
    let text = error.to_string();
    assert!(text.contains(place), "no place: {text}");
    let longest = text.lines().map(str::len).max().unwrap_or(0);
    assert!(longest < 4000, "{longest} bytes in a line of message");
    assert!(text.len() < 1 << 16, "{} bytes of message", text.len());
}

/// Loads a scene's text and renders a thumbnail of it; leniently, if it is refused otherwise.
/// Whether it is not.
pub fn xml(text: &[u8]) -> bool {
    scene(text, "scene.xml", mitsuba::load)
}

/// The same for a scene of pbrt.
pub fn pbrt(text: &[u8]) -> bool {
    scene(text, "scene.pbrt", pbrt::load)
}

type Load = fn(&Path, &ImportOptions) -> Result<Description, ImportError>;

fn scene(text: &[u8], name: &str, load: Load) -> bool {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join(name);
    std::fs::write(&path, text).expect("the scene is written");
    let mut options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
    for lenient in [false, true] {
        options.lenient = lenient;
        match load(&path, &options) {
            Err(error) => worded(&error, name),
            Ok(description) => {
                thumbnail(description);
                return !lenient;
            }
        }
    }
    false
}

/// Renders 4 x 4 pixels. All numbers of the image are finite.
fn thumbnail(mut description: Description) {
    let film = &mut description.film;
    (film.width, film.height, film.crop) = (4, 4, None);
    let camera = Camera::new(&description.camera, 4, 4);
    let scene = Scene::build(&mut description, BuildSettings::default(), Backend::Obvhs);
    let Ok(scene) = scene else { return };
    let settings = PathSettings {
        max_depth: description.render.max_depth.unwrap_or(8).min(8),
        rr_depth: description.render.rr_depth,
        hide_emitters: description.render.hide_emitters,
        hide_environment: false,
        strict_normals: description.render.strict_normals,
        sampler: description.render.sampler,
        seed: 1,
        guided: GuidedSettings::PLAIN,
    };
    let view = View {
        scene: &scene,
        camera: &camera,
        film: &description.film,
        settings: &settings,
        guide: None,
    };
    let limits = Limits {
        spp: 2,
        time: None,
        noise: None,
    };
    let mut film = Film::new(&description.film);
    render(&view, &mut film, &limits, &Silent);
    for (x, y) in (0..16).map(|i| (i % 4, i / 4)) {
        let mean = film.pixel(x, y).mean();
        assert!(mean.iter().all(|m| m.is_finite()), "{mean:?}");
    }
}

/// A model of four materials, with texture coordinates.
const OBJ: &str = "mtllib all.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n\
    usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/2\nusemtl c d\nf 1/1 2/2 4/3\n\
    usemtl glass\nf 2/1 3/2 4/3\n";

/// Loads a model with that file of materials, beside an image, and renders a thumbnail of it. What
/// is wrong with materials is a warning, a line each, but for images that are not there. Whether all
/// materials are there.
pub fn mtl(text: &[u8]) -> bool {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("model.obj");
    let ramp = include_bytes!("corpus/picture/ramp.png");
    for (name, bytes) in [
        ("model.obj", OBJ.as_bytes()),
        ("all.mtl", text),
        ("ramp.png", ramp),
    ] {
        std::fs::write(directory.path().join(name), bytes).expect("the file is written");
    }
    let options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
    let how = ModelOptions {
        material: None,
        z_up: false,
        show: Show::default(),
    };
    let source = [ModelSource::new(&path)];
    let parts = models::load(&source, &how, &options, Parts::default());
    let parts = match parts {
        Ok(parts) => parts,
        Err(error) => {
            worded(&error, "all.mtl");
            return false;
        }
    };
    for warning in &*parts.warnings {
        assert!(warning.len() < 4000 + path.as_os_str().len(), "{warning}");
    }
    let missing = |warning: &String| warning.contains("there is no material");
    let whole = !parts.warnings.iter().any(missing);
    thumbnail(
        Studio::default()
            .compose(parts)
            .expect("there is something to see"),
    );
    whole
}

/// Loads a glTF file at a moment of its animation, in a variant and without. Whether it could be
/// loaded.
pub fn gltf(text: &[u8]) -> bool {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("model.gltf");
    std::fs::write(&path, text).expect("the file is written");
    let options = ImportOptions {
        decode: DecodeLimit { bytes: 16 << 20 },
        ..ImportOptions::new(Arc::new(TextureStore::new(1 << 20)))
    };
    let mut loaded = false;
    for (variant, moment) in [(None, None), (Some("y".to_owned()), "0.7".parse().ok())] {
        let show = Show { variant, moment };
        let how = GltfOptions {
            show,
            ..GltfOptions::default()
        };
        match gltf::load(&path, &how, &options, &mut Parts::default()) {
            Err(error) => worded(&error, "model.gltf"),
            Ok(()) => loaded = true,
        }
    }
    loaded
}

/// Reads a mesh; the first byte chooses the format. Whether it could be read.
pub fn mesh(input: &[u8]) -> bool {
    let Some((&kind, bytes)) = input.split_first() else {
        return false;
    };
    match kind {
        b'0' => mesh_of(MeshKind::Obj, bytes),
        b'1' => mesh_of(MeshKind::Ply, bytes),
        b'2' => mesh_of(MeshKind::Serialized, bytes),
        _ => mesh_of(MeshKind::Serialized, &serialized(bytes)),
    }
}

/// A serialized file, version 4, with that content.
pub fn serialized(content: &[u8]) -> Vec<u8> {
    let mut file = vec![0x1c, 0x04, 4, 0];
    let mut zlib = flate2::write::ZlibEncoder::new(&mut file, flate2::Compression::fast());
    zlib.write_all(content).expect("memory takes it");
    zlib.finish().expect("memory takes it");
    file.extend(0u64.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    file
}

/// Reads a mesh, strictly and leniently.
pub fn mesh_of(kind: MeshKind, bytes: &[u8]) -> bool {
    let mut read_once = false;
    for lenient in [false, true] {
        let options = MeshOptions {
            lenient,
            max_smooth_angle: lenient.then_some(40.0),
            ..MeshOptions::default()
        };
        match read(bytes, kind, &options, Path::new("mesh.file")) {
            Err(error) => worded(&error, "mesh.file"),
            Ok(loaded) => {
                promises(&loaded.mesh);
                read_once = true;
            }
        }
    }
    read_once
}

/// What the loader promises of every mesh.
fn promises(mesh: &Mesh) {
    let positions = mesh.triangles.positions();
    assert!(positions.iter().all(|p| p.is_finite()));
    let indices = mesh.triangles.triangles().iter().flatten();
    assert!(indices.into_iter().all(|&i| (i as usize) < positions.len()));
    if let Some(normals) = &mesh.normals {
        assert_eq!(normals.len(), positions.len());
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    }
    let uvs = mesh.uvs.as_ref().map_or(positions.len(), |uvs| uvs.len());
    assert_eq!(uvs, positions.len());
}

/// Reads a field and draws from it.
pub fn field(bytes: &[u8]) -> bool {
    match Trainer::from_bytes(bytes) {
        Err(error) => {
            assert!(error.to_string().len() > 20, "{error}");
            false
        }
        Ok(trainer) => {
            let field = trainer.freeze();
            let local = field.at(Vec3::splat(0.4), Some(Vec3::Z), Rgb::ONE);
            let drawn = local.sample(Vec2::splat(0.5), Vec2::splat(0.3));
            assert!(drawn.direction.is_finite() && drawn.pdf > 0.0, "{drawn:?}");
            true
        }
    }
}

/// A field's file with the checksum and length mended, so that changes reach what is behind them.
pub fn mended_field(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.len() < 24 {
        return bytes;
    }
    let length = (bytes.len() - 24) as u64;
    bytes[12..20].copy_from_slice(&length.to_le_bytes());
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[24..]);
    bytes[20..24].copy_from_slice(&crc.sum().to_le_bytes());
    bytes
}

/// Reads a part of a render into a film, if it is of a small one.
pub fn part(bytes: &[u8]) -> bool {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("part.exr");
    std::fs::write(&path, bytes).expect("the part is written");
    let read = PartReader::open(&path).and_then(|reader| {
        let region = reader.record().region;
        if region[2].max(region[3]) > 1000 {
            return Ok(());
        }
        reader.read_into(&mut Film::vacant(region), &mut |_| Ok(()))
    });
    if let Err(error) = &read {
        worded(error, "part.exr");
    }
    read.is_ok()
}

/// Reads an image under a name of that ending.
pub fn image(bytes: &[u8], ending: &str) -> bool {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join(format!("image.{ending}"));
    std::fs::write(&path, bytes).expect("the image is written");
    match image::read(&path) {
        Err(error) => {
            worded(&error, "image.");
            false
        }
        Ok(image) => {
            let pixels = image.width as usize * image.height as usize;
            assert_eq!(image.pixels.len(), pixels * image.channels.len());
            true
        }
    }
}
