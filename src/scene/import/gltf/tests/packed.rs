//! Meshes and textures that the formats' own encoders compressed (tests/vectors).

use super::*;
use crate::image;
use std::path::{Path, PathBuf};

fn vector(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/vectors")
        .join(name)
}

fn open(path: &Path) -> Result<Parts, ImportError> {
    let options = ImportOptions::new(Arc::new(Asked::default()));
    let mut parts = Parts::default();
    load(path, &GltfOptions::default(), &options, &mut parts)?;
    Ok(parts)
}

#[cfg(not(feature = "draco"))]
#[test]
fn without_its_feature_draco_is_refused_by_name() {
    let error = open(&vector("draco/edgebreaker.glb"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("--features draco") && error.contains("libdraco-dev"),
        "{error}"
    );
}

#[cfg(feature = "draco")]
mod draco {
    use super::*;
    use crate::math::Vec2;

    /// The middle of a triangle, its mean normal and its mean texture coordinates.
    fn triangles(parts: &Parts) -> Vec<(Vec3, Vec3, Vec2)> {
        let mesh = mesh(parts, 0);
        let positions = mesh.triangles.positions();
        let (normals, uvs) = (mesh.normals.as_ref().unwrap(), mesh.uvs.as_ref().unwrap());
        let of = |t: &[u32; 3]| {
            let corners = t.map(|i| i as usize);
            let position: Vec3 = corners.iter().map(|i| positions[*i]).sum();
            let normal: Vec3 = corners.iter().map(|i| normals[*i]).sum();
            let uv: Vec2 = corners.iter().map(|i| uvs[*i]).sum();
            (position / 3.0, normal.normalize(), uv / 3.0)
        };
        mesh.triangles.triangles().iter().map(of).collect()
    }

    #[test]
    fn a_mesh_that_draco_compressed_is_the_one_that_it_was() {
        let whole = triangles(&open(&vector("draco/torus.glb")).unwrap());
        let packed = triangles(&open(&vector("draco/edgebreaker.glb")).unwrap());
        assert_eq!(packed.len(), whole.len());
        for (p, n, uv) in &packed {
            let near = |t: &&(Vec3, Vec3, Vec2)| (t.0 - *p).length() < 1e-3;
            let same = whole
                .iter()
                .filter(near)
                .find(|t| (t.2 - *uv).length() < 2e-3);
            let (_, normal, _) = same.unwrap_or_else(|| panic!("no triangle at {p}"));
            // 8 bits a normal.
            assert!(normal.dot(*n) > 0.999, "{normal} {n}");
        }
    }

    #[test]
    fn damaged_streams_are_errors_or_other_meshes_and_no_more_memory() {
        let bytes = std::fs::read(vector("draco/edgebreaker.glb")).unwrap();
        let start = bytes.windows(5).position(|w| w == b"DRACO").unwrap();
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.glb");
        let mut rng = crate::math::rng::Pcg32::new(3, 4);
        let mut refused = 0;
        for round in 0..2000 {
            let mut broken = bytes.clone();
            // The head more often than the rest.
            let room = if round % 2 == 0 {
                64
            } else {
                broken.len() - start
            };
            for _ in 0..1 + rng.next_u32() % 4 {
                let at = start + rng.next_u32() as usize % room;
                broken[at] = rng.next_u32() as u8;
            }
            std::fs::write(&path, &broken).unwrap();
            refused += usize::from(open(&path).is_err());
        }
        assert!(refused > 500, "{refused}");
    }
}

/// What a material's image becomes: the file that the texture loader is given, read anew.
fn unpacked(file: &Path) -> Result<image::Image, ImportError> {
    struct Reads(Mutex<Option<image::Image>>);
    impl OpenTexture for Reads {
        fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
            *self.0.lock().unwrap() = Some(image::read(&settings.path)?);
            Ok(Texture::Constant(Rgb::ONE))
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let mut gltf = File::triangle();
    let uvs = gltf.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    gltf.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    gltf.primitive()["material"] = 0.into();
    gltf.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    let uri = file.to_str().unwrap();
    gltf.json["images"] = json!([{"uri": uri, "mimeType": "image/ktx2"}]);
    gltf.json["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    gltf.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    let path = dir.path().join("a.gltf");
    std::fs::write(&path, gltf.text()).unwrap();
    let reads = Arc::new(Reads(Mutex::new(None)));
    let options = ImportOptions::new(reads.clone());
    load(
        &path,
        &GltfOptions::default(),
        &options,
        &mut Parts::default(),
    )?;
    let image = reads.0.lock().unwrap().take();
    Ok(image.unwrap())
}

#[test]
fn textures_of_basis_universal_are_what_its_own_decoder_makes_of_them() {
    for name in ["etc1s", "uastc", "opaque"] {
        let ours = unpacked(&vector(&format!("basisu/{name}.ktx2"))).unwrap();
        let theirs = image::read(&vector(&format!("basisu/{name}.png"))).unwrap();
        assert_eq!((ours.width, ours.height), (40, 24));
        // Theirs always has an opacity, ours where it says something.
        let channels = if name == "opaque" { 3 } else { 4 };
        assert_eq!(ours.channels.len(), channels, "{name}");
        let mut pairs = ours.pixels.chunks(channels).zip(theirs.pixels.chunks(4));
        assert!(pairs.all(|(a, b)| a == &b[..channels]), "{name}");
    }
}

#[test]
fn damaged_textures_are_errors_or_other_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.ktx2");
    let mut rng = crate::math::rng::Pcg32::new(5, 6);
    for name in ["etc1s", "uastc"] {
        let bytes = std::fs::read(vector(&format!("basisu/{name}.ktx2"))).unwrap();
        let mut refused = 0;
        for round in 0..1000 {
            let mut broken = bytes.clone();
            let room = if round % 2 == 0 { 200 } else { broken.len() };
            for _ in 0..1 + rng.next_u32() % 4 {
                let at = rng.next_u32() as usize % room;
                broken[at] = if rng.next_u32() % 3 == 0 {
                    255
                } else {
                    rng.next_u32() as u8
                };
            }
            if round % 10 == 0 {
                broken.truncate(rng.next_u32() as usize % bytes.len());
            }
            std::fs::write(&path, &broken).unwrap();
            refused += usize::from(unpacked(&path).is_err());
        }
        assert!(refused > 100, "{name}: {refused}");
    }
    // Texels of Vulkan's own formats are named.
    let mut bytes = std::fs::read(vector("basisu/uastc.ktx2")).unwrap();
    bytes[12] = 37;
    std::fs::write(&path, &bytes).unwrap();
    let error = unpacked(&path).unwrap_err().to_string();
    assert!(
        error.contains("format 37") && error.contains("ktx extract"),
        "{error}"
    );
}
