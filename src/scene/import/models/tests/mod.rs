//! Model files as the command line names them.

use super::*;
use crate::bsdf::material::Diffuse;
use crate::scene::import::ImportOptions;
use crate::texture::TextureStore;
use std::path::PathBuf;

mod colors;
mod materials;

/// A quad of two triangles, the second of another material.
const OBJ: &str = "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
    usemtl red\nf 1 2 3\nusemtl lamp\nf 1 3 4\n";
const MTL: &str = "newmtl red\nillum 1\nKd 0.8 0.1 0.1\nnewmtl lamp\nKe 5 4 3\n";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("two.obj", OBJ);
        folder.write("two.mtl", MTL);
        folder
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), bytes).unwrap();
    }

    /// A picture of four colours: red and green above, blue and white below.
    fn quarters(&self, name: &str) {
        let color = |i: usize| match (i % 8 < 4, i / 8 < 4) {
            (true, true) => Rgb::X,
            (false, true) => Rgb::Y,
            (true, false) => Rgb::Z,
            (false, false) => Rgb::ONE,
        };
        let pixels: Vec<Rgb> = (0..64).map(color).collect();
        let image = crate::image::Image::from_rgb(8, 8, &pixels);
        let path = self.0.path().join(name);
        crate::image::write(&path, &image, &Default::default()).unwrap();
    }

    /// Loads models named as on the command line, in this folder.
    fn load(&self, words: &[&str], material: Option<&str>) -> Result<Parts, ImportError> {
        let named = |word: &&str| {
            let mut source: ModelSource = word.parse().unwrap();
            source.path = self.0.path().join(source.path);
            source
        };
        let sources: Vec<ModelSource> = words.iter().map(named).collect();
        let models = ModelOptions {
            show: Default::default(),
            material: material.map(|m| m.parse().unwrap()),
            z_up: false,
        };
        let options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
        super::load(&sources, &models, &options, Parts::default())
    }
}

fn mesh(parts: &Parts, shape: usize) -> &Mesh {
    match &parts.shapes[shape].geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

fn reflectance(parts: &Parts, id: MaterialId) -> &Texture {
    use crate::bsdf::Material;
    match parts.materials.get(id) {
        Material::TwoSided { front, .. } => reflectance(parts, *front),
        Material::Diffuse(Diffuse { reflectance }) => reflectance,
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_obj_file_falls_apart_into_its_materials() {
    let parts = Folder::new().load(&["two.obj"], None).unwrap();
    assert_eq!(*parts.warnings, [""; 0]);
    assert_eq!(parts.shapes.len(), 2);
    let red = reflectance(&parts, parts.shapes[0].material).constant();
    assert_eq!(red, Some(Rgb::new(0.8, 0.1, 0.1)));
    assert_eq!(parts.shapes[0].emitter, None);
    assert_eq!(parts.shapes[1].emitter, Some(0));
    let Emitter::Area {
        shape: 1, radiance, ..
    } = &parts.emitters[0]
    else {
        panic!("{:?}", parts.emitters)
    };
    assert_eq!(radiance.constant(), Some(Rgb::new(5.0, 4.0, 3.0)));
    // A paint takes the place of all.
    let parts = Folder::new()
        .load(&["two.obj@material=clay"], Some("gold"))
        .unwrap();
    assert_eq!((parts.shapes.len(), parts.emitters.len()), (1, 0));
    reflectance(&parts, parts.shapes[0].material);
}

#[test]
fn a_library_that_is_missing_is_a_warning_and_clay() {
    let folder = Folder::new();
    std::fs::remove_file(folder.0.path().join("two.mtl")).unwrap();
    let parts = folder.load(&["two.obj"], None).unwrap();
    assert!(
        parts.warnings[0].contains("two.mtl"),
        "{:?}",
        parts.warnings
    );
    let clay = reflectance(&parts, parts.shapes[0].material);
    assert!(clay.constant().is_some());
}

#[test]
fn a_file_named_twice_is_loaded_once_unless_it_glows() {
    let folder = Folder::new();
    let words = [
        "two.obj@material=clay;translate=1,0,0",
        "two.obj@material=clay",
    ];
    let parts = folder.load(&words, None).unwrap();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (1, 2));
    assert_eq!(parts.instances[0].1.translation.x, 1.0);
    let bounds = parts.bounds();
    assert_eq!((bounds.min.x, bounds.max.x), (0.0, 2.0));
    let words = ["two.obj@translate=1,0,0", "two.obj"];
    let parts = folder.load(&words, None).unwrap();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (4, 0));
    assert_eq!(parts.emitters.len(), 2);
    let bounds = parts.bounds();
    assert_eq!((bounds.min.x, bounds.max.x), (0.0, 2.0));
    // Flat is another mesh.
    let words = ["two.obj@material=clay;flat", "two.obj@material=clay"];
    let parts = folder.load(&words, None).unwrap();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (2, 0));
    assert!(mesh(&parts, 0).normals.is_none() && mesh(&parts, 1).normals.is_some());
}

#[test]
fn colours_of_vertices_are_used_and_leave_the_screens_curve() {
    let folder = Folder::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 188 0 255\n1 0 0 188 0 255\n0 1 0 188 0 255\n3 0 1 2\n";
    folder.write("a.ply", ply);
    let parts = folder.load(&["a.ply"], None).unwrap();
    let attribute = &mesh(&parts, 0).attributes.list[0];
    let color = attribute.values[0];
    assert!(
        (color - Rgb::new(0.5029, 0.0, 1.0)).length() < 1e-3,
        "{color}"
    );
    let Texture::MeshAttribute(name) = reflectance(&parts, parts.shapes[0].material) else {
        panic!("{parts:?}")
    };
    assert_eq!(**name, attribute.name);
}

#[test]
fn what_is_no_model_or_has_no_triangle_is_an_error() {
    let folder = Folder::new();
    let fail = |word: &str| folder.load(&[word], None).unwrap_err().to_string();
    let error = fail("two.mtl");
    assert!(
        error.contains("no model") && error.contains(".stl"),
        "{error}"
    );
    folder.write("empty.stl", "solid\nendsolid\n");
    assert!(fail("empty.stl").contains("no triangle"));
    assert!(fail("absent.glb").contains("absent.glb"));
    let kind = ModelKind::from_path(&PathBuf::from("A.GLB"));
    assert_eq!(kind, Some(ModelKind::Gltf));
}
