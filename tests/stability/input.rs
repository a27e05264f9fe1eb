//! S9, S10, S11: broken meshes, scenes without light, normals that are none.

use crate::scenes::{backends, differing_pixels, field_of, loaded, seed};
use crate::support::{SceneMaker, film_mean, mesh};
use crate::table::Table;
use std::process::Command;
use std::sync::Arc;
use twintree::accel::{Backend, TriangleMesh};
use twintree::film::Film;
use twintree::image::{Image, WriteOptions, write};
use twintree::light::Emitter;
use twintree::math::{Rgb, Vec3};
use twintree::scene::import::{ImportOptions, mitsuba};
use twintree::scene::{Geometry, Mesh};
use twintree::texture::TextureStore;

/// A pyramid over the origin.
const CLEAN: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n";

/// Renders the mesh of an OBJ file by a lamp; `Err` is what the loader says.
fn picture(obj: &str, lenient: bool, backend: Backend) -> Result<(Film, Vec<String>), String> {
    let directory = tempfile::tempdir().expect("a directory");
    std::fs::write(directory.path().join("mesh.obj"), obj).expect("the mesh is written");
    let scene = "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><float name='fov' value='40'/>
        <transform name='to_world'><lookat origin='0.3 -3 3' target='0 0 0.3' up='0 0 1'/></transform>
        <film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='box'/></film></sensor>
        <shape type='obj'><string name='filename' value='mesh.obj'/><boolean name='face_normals' value='true'/></shape>
        <emitter type='point'><point name='position' x='1' y='-2' z='4'/><rgb name='intensity' value='9'/></emitter></scene>";
    let path = directory.path().join("scene.xml");
    std::fs::write(&path, scene).expect("the scene is written");
    let mut options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
    options.lenient = lenient;
    let description = mitsuba::load(&path, &options).map_err(|e| e.to_string())?;
    let warnings = description.warnings.clone();
    let (film, _) = SceneMaker { description }
        .build(backend)
        .render(&seed(1), 16);
    Ok((film, warnings))
}

#[test]
fn s09_broken_triangles_leave_the_rest_as_it_was() {
    let far = "v 1e38 0 0\nv 0 1e38 0\nv 1e38 1e38 -1e38\nf -1 -2 -3\n";
    let line = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf -1 -2 -3\n";
    let many = line.repeat(20_000);
    let broken = [
        ("no area", line, false),
        ("one corner thrice", "f 1 1 1\nf 1 1 2\n", false),
        (
            "not a number",
            "v nan 0 0\nv 0 1 0\nv 0 0 1\nf -1 -2 -3\n",
            true,
        ),
        (
            "infinite",
            "v inf 0 0\nv 0 1 0\nv 0 0 1\nf -1 -2 -3\n",
            true,
        ),
        ("coordinates of 1e38", far, true),
        ("20 000 without area", many.as_str(), false),
    ];
    let mut table = Table::default();
    for (name, backend) in backends() {
        let (reference, _) = picture(CLEAN, false, backend).expect("the pyramid loads");
        assert!(film_mean(&reference).0 > 0.01);
        for (what, more, lenient) in &broken {
            let (film, warnings) = picture(&format!("{CLEAN}{more}"), *lenient, backend)
                .unwrap_or_else(|e| panic!("{what}: {e}"));
            let what = format!("mesh with triangles, {what}: pixels of other bits");
            assert!(!warnings.is_empty(), "{what}: nothing is said");
            table.finite("S9", &what, name, &film);
            table.hold("S9", &what, name, 0.0, differing_pixels(&reference, &film));
        }
    }
}

#[test]
fn s09_meshes_that_cannot_be_used_are_errors() {
    for (what, obj, said) in [
        ("no triangle", "v 0 0 0\n", "no"),
        (
            "index out of range",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4000000000\n",
            "mesh.obj:4:",
        ),
        (
            "not a number",
            "v nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n",
            "mesh.obj",
        ),
    ] {
        let error = picture(obj, false, Backend::default())
            .map(|_| ())
            .unwrap_err();
        assert!(
            error.contains(said) && error.contains("mesh.obj"),
            "{what}: {error}"
        );
    }
}

fn pile(count: usize) {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let sheet = |count: usize| {
            let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 40.0, 16);
            let matt = maker.diffuse(0.5);
            let corners = vec![
                Vec3::new(-1.0, -1.0, 0.0),
                Vec3::new(1.0, -1.0, 0.0),
                Vec3::Y,
            ];
            maker.shape(mesh(corners, vec![[0, 1, 2]; count]), matt, None, false);
            maker.emitter(Emitter::Point {
                position: Vec3::new(0.5, 0.0, 2.0),
                intensity: Rgb::ONE,
            });
            maker.build(backend).render(&seed(1), 4).0
        };
        let film = sheet(count);
        let what = format!("{count} triangles in one place: pixels of other bits");
        table.finite("S9", &what, name, &film);
        table.hold("S9", &what, name, 0.0, differing_pixels(&sheet(1), &film));
    }
}

#[test]
fn s09_many_triangles_in_one_place() {
    pile(50_000);
}

#[test]
#[ignore = "slow: a tree over a million triangles that cannot be told apart"]
fn s09_a_million_triangles_in_one_place() {
    pile(1_000_000);
}

/// A wall before a sky given by `emitter`, rendered by the program in a directory with `texels` as
/// `sky.exr`: exit code, messages and the largest number of the image.
fn dark(emitter: &str, texels: &[f32]) -> (Option<i32>, String, f32) {
    let directory = tempfile::tempdir().expect("a directory");
    let at = |name: &str| directory.path().join(name);
    let mut sky = Image::new(texels.len() as u32, 2, &["R", "G", "B"]);
    let row = texels.iter().flat_map(|t| [*t; 3]);
    sky.pixels = row.clone().chain(row).collect();
    write(&at("sky.exr"), &sky, &WriteOptions::default()).expect("the sky is written");
    let scene = format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><transform name='to_world'><lookat origin='0 0 3' target='0 0 0' up='0 1 0'/></transform>
        <film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/></film></sensor>
        <shape type='rectangle'/>{emitter}</scene>"
    );
    std::fs::write(at("scene.xml"), scene).expect("the scene is written");
    let ran = Command::new(env!("CARGO_BIN_EXE_twintree"))
        .args([
            "render",
            "scene.xml",
            "-o",
            "out.exr",
            "--spp",
            "4",
            "--guide",
            "double",
        ])
        .current_dir(directory.path())
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&ran.stderr).into_owned();
    let image = twintree::image::read(&at("out.exr"));
    let brightest = image.map_or(f32::NAN, |i| i.pixels.iter().copied().fold(0.0, f32::max));
    (ran.status.code(), said, brightest)
}

#[test]
fn s10_no_light_is_a_black_image() {
    let area = |value: &str| {
        format!(
            "<shape type='sphere'><emitter type='area'><rgb name='radiance' value='{value}'/></emitter></shape>"
        )
    };
    let map = "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>";
    let flat = "<shape type='disk'><transform name='to_world'><scale value='1e-30'/><translate z='1'/></transform><emitter type='area'/></shape>";
    let black: &[f32] = &[0.0; 4];
    let odd: &[f32] = &[0.0, f32::NAN, -1.0, f32::NEG_INFINITY];
    let mut table = Table::default();
    for (what, emitter, texels, said) in [
        (
            "no light",
            String::new(),
            black,
            "nothing in the scene shines",
        ),
        ("a black lamp", area("0"), black, ""),
        ("a lamp without area", flat.into(), black, ""),
        ("a black sky", map.into(), black, ""),
        ("a sky of odd numbers", map.into(), odd, "count as 0"),
    ] {
        let (code, messages, brightest) = dark(&emitter, texels);
        assert_eq!(code, Some(0), "{what}: {messages}");
        assert!(messages.contains(said), "{what}: {messages}");
        table.hold(
            "S10",
            &format!("{what}: brightest number"),
            "default, guided",
            0.0,
            brightest.into(),
        );
    }
}

/// A sphere of 24 by 12 quads whose normals are made by `normal` from the right ones.
fn ball(normal: impl Fn(Vec3) -> Vec3) -> Geometry {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=12u32 {
        for j in 0..24u32 {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / 12.0).sin_cos();
            let (y, x) = (std::f32::consts::TAU * j as f32 / 24.0).sin_cos();
            positions.push(Vec3::new(sin * x, sin * y, cos));
            if i < 12 {
                let (a, b) = (24 * i + j, 24 * i + (j + 1) % 24);
                triangles.extend([[a, a + 24, b + 24], [a, b + 24, b]]);
            }
        }
    }
    let normals = positions.iter().map(|p| normal(*p)).collect();
    let triangles = Arc::new(TriangleMesh::new(positions, triangles).expect("indices in range"));
    Geometry::Mesh(Arc::new(Mesh {
        triangles,
        normals: Some(normals),
        ..Mesh::default()
    }))
}

#[test]
fn s11_normals() {
    let tilt = |degrees: f32| {
        move |n: Vec3| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            n.any_orthonormal_vector() * sin + n * cos
        }
    };
    type Change = Box<dyn Fn(Vec3) -> Vec3>;
    let list: [(&str, Change); 5] = [
        ("right", Box::new(|n| n)),
        ("flipped", Box::new(|n: Vec3| -n)),
        ("zero", Box::new(|_| Vec3::ZERO)),
        ("tilted by 89.99 degrees", Box::new(tilt(89.99))),
        ("tilted by 120 degrees", Box::new(tilt(120.0))),
    ];
    let mut table = Table::default();
    for (name, backend) in backends() {
        for (what, change) in &list {
            let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 45.0, 16);
            let white = maker.diffuse(1.0);
            maker.shape(ball(change), white, None, false);
            maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
            let built = maker.build(backend);
            let guide = field_of(&built);
            let what = format!("white ball in constant light, normals {what}: gain");
            for (who, guide) in [("", None), (", guided", Some(&guide))] {
                let (film, _) = built.render_guided(&seed(1), 256, guide);
                let (mean, error) = film_mean(&film);
                let who = format!("{name}{who}");
                table.finite("S11", &what, &who, &film);
                assert!(error < 3e-3, "{what}, {who}: too noisy: {error}");
                table.hold("S11", &what, &who, 0.01, mean - 1.0);
            }
        }
    }
}

/// The loader makes normals of no length, and of none at all, into some.
#[test]
fn s11_normals_of_files() {
    let scene = "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'/>";
    let file = |normals: &str| {
        let directory = tempfile::tempdir().expect("a directory");
        let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{normals}f 1//1 2//1 3//1\n");
        let path = directory.path().join("mesh.obj");
        std::fs::write(&path, obj).expect("the mesh is written");
        let text = format!(
            "{scene}<shape type='obj'><string name='filename' value='{}'/></shape></scene>",
            path.display()
        );
        loaded(&text).description
    };
    for normals in [
        "vn 0 0 0\n",
        "vn 1e-30 0 0\n",
        "vn 1e30 1e30 0\n",
        "vn nan 0 0\n",
    ] {
        let description = file(normals);
        let Geometry::Mesh(mesh) = &description.shapes[0].geometry else {
            panic!("a mesh");
        };
        for n in mesh.normals.iter().flatten() {
            assert!((n.length() - 1.0).abs() < 1e-5, "{normals}: {n}");
        }
    }
}
