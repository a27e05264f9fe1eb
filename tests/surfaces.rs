//! Which side of a surface is its front: lamps, photons, light samples, materials and normals agree,
//! whatever the format, the order of corners, the mirror and the ray tracer.

mod support;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use support::{Built, SceneMaker, film_mean, grey, how, settings};
use twintree::accel::{Backend, BuildSettings, ExactKind, Hit, Ray};
use twintree::bsdf::material::{Distribution, Roughness};
use twintree::bsdf::{Material, Transport};
use twintree::camera::Camera;
use twintree::integrate::learn::learn;
use twintree::light::Emitter;
use twintree::math::{Affine3A, DAffine3, Pcg32, Rgb, Vec3};
use twintree::scene::import::gltf::{self, GltfOptions};
use twintree::scene::import::parts::Parts;
use twintree::scene::import::{ImportOptions, mitsuba};
use twintree::scene::surface::DARK;
use twintree::scene::{Description, Scene};
use twintree::texture::{BitmapSettings, Filter, Texture, TextureStore, UvTransform, Wrap};

/// The square `[-1, 1]^2` in z = 0, its corners counter-clockwise as they are seen from +z.
const CORNERS: [[f32; 3]; 4] = [[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]];
const LAMP: &str =
    "<bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='1'/></emitter>";

fn options() -> ImportOptions {
    ImportOptions::new(Arc::new(TextureStore::new(1 << 20)))
}

/// Triangles of the square, in the order of its corners or against it.
fn triangles(against: bool) -> [[u32; 3]; 2] {
    let turn = |[a, b, c]: [u32; 3]| if against { [a, c, b] } else { [a, b, c] };
    [turn([0, 1, 2]), turn([0, 2, 3])]
}

fn obj(against: bool, normals: bool) -> Vec<u8> {
    let mut text = String::new();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    text += "vn 0 0 1\n";
    for t in triangles(against) {
        let corner = |i: u32| match normals {
            true => format!(" {0}//1", i + 1),
            false => format!(" {}", i + 1),
        };
        text += &format!("f{}\n", t.map(corner).concat());
    }
    text.into_bytes()
}

fn ply(against: bool, normals: bool) -> Vec<u8> {
    let mut text = String::from("ply\nformat ascii 1.0\nelement vertex 4\n");
    let names: &[&str] = match normals {
        true => &["x", "y", "z", "nx", "ny", "nz"],
        false => &["x", "y", "z"],
    };
    for name in names {
        text += &format!("property float {name}\n");
    }
    text += "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}{}\n", if normals { " 0 0 1" } else { "" });
    }
    for [a, b, c] in triangles(against) {
        text += &format!("3 {a} {b} {c}\n");
    }
    text.into_bytes()
}

fn serialized(against: bool, normals: bool) -> Vec<u8> {
    let mut body: Vec<u8> = (0x1000 | u32::from(normals)).to_le_bytes().to_vec();
    body.push(0);
    body.extend(4u64.to_le_bytes());
    body.extend(2u64.to_le_bytes());
    body.extend(CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes()));
    if normals {
        body.extend(
            [[0f32, 0., 1.]; 4]
                .iter()
                .flatten()
                .flat_map(|x| x.to_le_bytes()),
        );
    }
    let indices = triangles(against).into_iter().flatten();
    body.extend(indices.flat_map(u32::to_le_bytes));
    let mut file = vec![0x1c, 0x04, 4, 0];
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    zlib.write_all(&body).unwrap();
    file.extend(zlib.finish().unwrap());
    file.extend(0u64.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    file
}

fn gltf_file(against: bool, normals: bool, mirror: bool, double_sided: bool) -> String {
    let mut bytes: Vec<u8> = CORNERS
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(
        [[0f32, 0., 1.]; 4]
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes()),
    );
    bytes.extend(
        triangles(against)
            .into_iter()
            .flatten()
            .flat_map(u32::to_le_bytes),
    );
    let mut attributes = json!({"POSITION": 0});
    if normals {
        attributes["NORMAL"] = 1.into();
    }
    let accessor = |view: usize, code: u32, count: usize, kind: &str| json!({"bufferView": view, "componentType": code, "count": count, "type": kind});
    let view =
        |at: usize, length: usize| json!({"buffer": 0, "byteOffset": at, "byteLength": length});
    let data = BASE64_STANDARD.encode(&bytes);
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [if mirror { -1 } else { 1 }, 1, 1]}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
        "materials": [{"emissiveFactor": [1, 0.5, 0.25], "doubleSided": double_sided}],
        "accessors": [accessor(0, 5126, 4, "VEC3"), accessor(1, 5126, 4, "VEC3"),
            accessor(2, 5125, 6, "SCALAR")],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 24)],
        "buffers": [{"byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{data}")}],
    })
    .to_string()
}

/// A scene of shapes in Mitsuba's language.
fn scene(dir: &Path, shapes: &str) -> Description {
    let path = dir.join("scene.xml");
    let text = format!("<scene version='3.0.0'><sensor type='perspective'/>{shapes}</scene>");
    std::fs::write(&path, text).unwrap();
    mitsuba::load(&path, &options()).unwrap_or_else(|e| panic!("{e}"))
}

fn gltf_scene(dir: &Path, text: &str) -> Description {
    let path = dir.join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let mut parts = Parts::default();
    let how = GltfOptions {
        to_world: DAffine3::IDENTITY,
        material: None,
    };
    gltf::load(&path, &how, &options(), &mut parts).unwrap_or_else(|e| panic!("{e}"));
    Description {
        shapes: parts.shapes,
        groups: parts.groups,
        instances: parts.instances,
        materials: parts.materials,
        emitters: parts.emitters,
        ..scene(dir, "<shape type='sphere'/>")
    }
}

fn backends() -> Vec<Backend> {
    match cfg!(feature = "embree") {
        true => vec![Backend::Embree, Backend::Obvhs],
        false => vec![Backend::Obvhs],
    }
}

fn built(load: &dyn Fn() -> Description) -> Vec<Scene> {
    let build = |backend| {
        let scene = Scene::build(&mut load(), BuildSettings::default(), backend);
        scene.unwrap_or_else(|e| panic!("{e}"))
    };
    backends().into_iter().map(build).collect()
}

/// Which side of a surface is met.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Seen {
    Front,
    Back,
}

/// Everything that has to do with sides, at one ray.
fn expect(what: &str, scene: &Scene, (from, to): (Vec3, Vec3), seen: Seen, both_glow: bool) {
    let ray = Ray::new(from, (to - from).normalize());
    let mut hits = [Hit::NONE];
    scene.rays.intersect_batch(&[ray], &mut hits);
    assert!(hits[0].is_some(), "{what}: nothing is met");
    let (hit, wo) = (&hits[0], -ray.dir);
    let point = scene.surfaces.point(&ray, hit, 0.0);
    let front = seen == Seen::Front;
    assert_eq!(point.ng.dot(wo) > 0.0, front, "{what}: geometric normal");
    assert_eq!(point.frame.n.dot(wo) > 0.0, front, "{what}: shading normal");
    let surface = &scene.surfaces.list[hit.shape as usize];
    let bsdf = scene
        .surfaces
        .materials
        .resolve(surface.material, &point, wo);
    let reflected = bsdf.eval(wo, wo, Transport::Radiance).max_element() > 0.0;
    // Only glTF's lamps glow on both sides here, and its materials have two.
    assert_eq!(reflected, front || both_glow, "{what}: material");
    if surface.emitter == DARK {
        return;
    }
    let glows = front || both_glow;
    let (lights, emitter) = (&scene.lights, surface.emitter);
    let emitted = lights.emitted(emitter, &point, wo).max_element() > 0.0;
    assert_eq!(emitted, glows, "{what}: what is met");
    let density = lights.pdf_area(from, Vec3::ZERO, emitter, point.prim, point.p, point.ng);
    assert_eq!(density > 0.0, glows, "{what}: density");
    let mut rng = Pcg32::new(7, 1);
    for _ in 0..64 {
        let u = [(); 3].map(|()| rng.next_f32());
        let sample = lights.sample(from, Vec3::ZERO, u);
        let bright = sample.is_some_and(|s| lights.radiance(&s.incoming).max_element() > 0.0);
        assert_eq!(bright, glows, "{what}: light sample");
    }
}

/// Photons leave to the front; to both sides alike if both glow. `front` points to its side of a place.
fn expect_photons(what: &str, scene: &Scene, front: &dyn Fn(Vec3) -> Vec3, both_glow: bool) {
    let mut rng = Pcg32::new(9, 1);
    let (mut ahead, count) = (0, 400);
    for _ in 0..count {
        let photon = scene.lights.emit([(); 5].map(|()| rng.next_f32())).unwrap();
        assert!(photon.dir.dot(photon.ng) > 0.0, "{what}: a photon's way");
        ahead += i32::from(photon.ng.dot(front(photon.org)) > 0.0);
    }
    match both_glow {
        // Four standard deviations of a fair coin.
        true => assert!((ahead - count / 2).abs() < 40, "{what}: {ahead} photons"),
        false => assert_eq!(ahead, count, "{what}: photons"),
    }
}

/// A square seen from above and from below; its front is up, or down.
fn expect_square(what: &str, load: &dyn Fn() -> Description, up: bool, both_glow: bool) {
    for scene in built(load) {
        let what = format!("{what}, {}", scene.rays.name());
        for (z, seen) in [(3.0, Seen::Front), (-3.0, Seen::Back)] {
            let seen = match (up, seen) {
                (true, seen) => seen,
                (false, Seen::Front) => Seen::Back,
                (false, Seen::Back) => Seen::Front,
            };
            let way = (Vec3::new(0.3, -0.2, z), Vec3::new(0.2, 0.1, 0.0));
            expect(&what, &scene, way, seen, both_glow);
        }
        if !scene.lights.is_empty() {
            let normal = if up { Vec3::Z } else { Vec3::NEG_Z };
            expect_photons(&what, &scene, &|_| normal, both_glow);
        }
    }
}

const MIRROR: &str = "<transform name='to_world'><scale x='-1'/></transform>";

#[test]
fn given_normals_win_over_the_order_of_corners_in_every_format() {
    type Write = fn(bool, bool) -> Vec<u8>;
    let formats: [(&str, Write); 3] = [("obj", obj), ("ply", ply), ("serialized", serialized)];
    let dir = tempfile::tempdir().unwrap();
    for (kind, write) in formats {
        for i in 0..16 {
            let [against, normals, mirror, flip] = [1, 2, 4, 8].map(|bit| i & bit != 0);
            std::fs::write(dir.path().join("mesh"), write(against, normals)).unwrap();
            let mirrored = if mirror { MIRROR } else { "" };
            let shape = format!(
                "<shape type='{kind}'><string name='filename' value='mesh'/>{mirrored}
                 <boolean name='flip_normals' value='{flip}'/>{LAMP}</shape>"
            );
            let up = (normals || !against) != flip;
            let what = format!(
                "{kind}, against {against}, normals {normals}, mirror {mirror}, flip {flip}"
            );
            expect_square(&what, &|| scene(dir.path(), &shape), up, false);
        }
    }
}

#[test]
fn gltf_lamps_shine_from_their_front_and_from_both_sides_if_they_say_so() {
    let dir = tempfile::tempdir().unwrap();
    for i in 0..8 {
        let [against, normals, mirror] = [1, 2, 4].map(|bit| i & bit != 0);
        let what = format!("gltf, against {against}, normals {normals}, mirror {mirror}");
        let text = gltf_file(against, normals, mirror, true);
        let up = normals || !against;
        expect_square(&what, &|| gltf_scene(dir.path(), &text), up, true);
    }
}

#[test]
fn flat_shapes_and_mirrored_instances_keep_their_front() {
    let dir = tempfile::tempdir().unwrap();
    for kind in ["rectangle", "disk"] {
        for i in 0..4 {
            let [mirror, flip] = [1, 2].map(|bit| i & bit != 0);
            let mirrored = if mirror { MIRROR } else { "" };
            let shape = format!(
                "<shape type='{kind}'><boolean name='flip_normals' value='{flip}'/>{mirrored}{LAMP}</shape>"
            );
            let what = format!("{kind}, mirror {mirror}, flip {flip}");
            expect_square(&what, &|| scene(dir.path(), &shape), !flip, false);
        }
    }
    for (i, bytes) in [obj(true, true), obj(false, false), obj(false, true)]
        .iter()
        .enumerate()
    {
        std::fs::write(dir.path().join("mesh"), bytes).unwrap();
        let shapes = format!(
            "<shape type='shapegroup' id='g'><shape type='obj'>
               <string name='filename' value='mesh'/><bsdf type='diffuse'/></shape></shape>
             <shape type='instance'><ref id='g'/>{MIRROR}</shape>"
        );
        let what = format!("instance {i}");
        expect_square(&what, &|| scene(dir.path(), &shapes), true, false);
    }
}

#[test]
fn closed_shapes_shine_outwards_unless_they_are_flipped() {
    let dir = tempfile::tempdir().unwrap();
    for kind in ["sphere", "cylinder", "cube"] {
        for i in 0..8 {
            let [mirror, flip, stretched] = [1, 2, 4].map(|bit| i & bit != 0);
            let x = if mirror { -1.0 } else { 1.0 };
            let z = if stretched { 1.5 } else { 1.0 };
            let shape = format!(
                "<shape type='{kind}'><boolean name='flip_normals' value='{flip}'/>
                   <transform name='to_world'><translate z='-0.1'/><scale x='{x}' z='{z}'/></transform>
                   {LAMP}</shape>"
            );
            let what = format!("{kind}, mirror {mirror}, flip {flip}, stretched {stretched}");
            for scene in built(&|| scene(dir.path(), &shape)) {
                let (outside, middle) = (Vec3::new(4.0, 0.4, 0.3), Vec3::new(0.05, 0.0, 0.2));
                let seen = |front| if front { Seen::Front } else { Seen::Back };
                expect(&what, &scene, (outside, middle), seen(!flip), false);
                expect(&what, &scene, (middle, outside), seen(flip), false);
                // All of them stand around the axis of z.
                let side = if flip { -1.0 } else { 1.0 };
                let out = |p: Vec3| match kind {
                    "cylinder" => p.with_z(0.0) * side,
                    "sphere" => (p + Vec3::Z * 0.1 * z) * side,
                    _ => p * side,
                };
                expect_photons(&what, &scene, &out, false);
            }
        }
    }
}

/// A description as its own sensor sees it.
fn seen(mut description: Description, backend: Backend) -> Built {
    let film = description.film.clone();
    let camera = Camera::new(&description.camera, film.width, film.height);
    let scene = Scene::build(&mut description, BuildSettings::default(), backend);
    Built {
        scene: scene.unwrap_or_else(|e| panic!("{e}")),
        camera,
        film,
    }
}

/// A lamp in a box that shines at the ceiling: its mesh is mirrored and wound against its normals.
fn lamp_in_a_box(dir: &Path) -> Description {
    std::fs::write(dir.join("mesh"), obj(true, true)).unwrap();
    let text = format!(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='60'/>
           <transform name='to_world'><lookat origin='0,-0.9,0' target='0,1,0' up='0,0,1'/></transform>
           <film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/>
             <rfilter type='box'/></film></sensor>
         <shape type='cube'><boolean name='flip_normals' value='true'/><bsdf type='diffuse'/></shape>
         <shape type='obj'><string name='filename' value='mesh'/>
           <transform name='to_world'><scale x='-0.3' y='0.3'/><translate y='0.2' z='0.1'/></transform>
           {LAMP}</shape></scene>"
    );
    let path = dir.join("box.xml");
    std::fs::write(&path, text).unwrap();
    mitsuba::load(&path, &options()).unwrap_or_else(|e| panic!("{e}"))
}

/// Photons teach a field of the same light that paths find, from a lamp whose front its normals tell and
/// from one that glows on both sides.
#[test]
fn photons_leave_the_sides_that_shine() {
    let dir = tempfile::tempdir().unwrap();
    let mut path = settings();
    path.max_depth = 6;
    for both in [false, true] {
        let mut description = lamp_in_a_box(dir.path());
        if let Some(Emitter::Area { both_sides, .. }) = description.emitters.first_mut() {
            *both_sides = both;
        }
        let built = seen(description, Backend::default());
        let field = learn(&built.view(&path, None), &how(100_000, 0)).expect("a field");
        path.seed = 1;
        let (plain, _) = built.render(&path, 256);
        path.seed = 2;
        let (guided, _) = built.render_guided(&path, 128, Some(&field.guide));
        support::agree(&format!("both sides {both}"), &guided, &plain);
    }
}

/// Opacity is no matter of what a lamp emits: rays that meet a half-there lamp and samples of its light
/// bring the same together as those of a whole one.
#[test]
fn a_masked_lamp_lights_as_a_whole_one_does() {
    let mean = |opacity: Option<f32>| {
        let eye = Vec3::new(0.0, 0.1, 0.9);
        let mut maker = SceneMaker::new(eye, Vec3::ZERO, 60.0, 16);
        let floor = maker.diffuse(0.5);
        let black = maker.diffuse(0.0);
        let cover = opacity.map(|opacity| Material::Mask {
            opacity: grey(opacity),
            inner: black,
        });
        let cover = cover.map_or(black, |cover| maker.material(cover));
        let ground = maker.exact(ExactKind::Rectangle, Affine3A::from_scale(Vec3::splat(4.0)));
        maker.shape(ground, floor, None, false);
        let above = Affine3A::from_translation(Vec3::Z);
        let lamp = maker.exact(ExactKind::Disk, above);
        maker.shape(lamp, cover, Some(1.0), true);
        let path = twintree::integrate::PathSettings {
            max_depth: 2,
            ..settings()
        };
        maker.build(Backend::default()).mean(&path, 256)
    };
    let (whole, whole_error) = mean(None);
    for opacity in [0.3, 0.7] {
        let (half, error) = mean(Some(opacity));
        let z = (half - whole) / error.hypot(whole_error);
        assert!(z.abs() < 4.0, "{opacity}: {half} instead of {whole}: {z}");
        assert!(error < 0.002 * whole, "too noisy to tell: {error}");
    }
}

/// A texture of waves with 64 by 64 texels, many of them across a surface.
fn waves(dir: &Path, store: &TextureStore, value: impl Fn(f32, f32) -> [f32; 3]) -> Texture {
    let path = dir.join(format!("{}.exr", store.file_count()));
    exr::prelude::write_rgb_file(&path, 64, 64, |x, y| {
        let angle = |i: usize| i as f32 * (std::f32::consts::TAU / 64.0) * 4.0;
        let [r, g, b] = value(angle(x), angle(y));
        (r, g, b)
    })
    .unwrap();
    let settings = BitmapSettings {
        path,
        raw: true,
        gamma: None,
        filter: Filter::Linear,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        to_uv: UvTransform(glam::Affine2::from_scale(glam::Vec2::splat(8.0))),
        channel: None,
    };
    store.open(settings).unwrap_or_else(|e| panic!("{e}"))
}

fn metal(alpha: Texture) -> Material {
    Material::RoughConductor {
        eta: grey(0.2),
        k: grey(3.9),
        roughness: Roughness {
            distribution: Distribution::Ggx,
            alpha_u: alpha.clone(),
            alpha_v: alpha,
        },
        specular_reflectance: grey(1.0),
    }
}

/// A wall of that material under a lamp from the side, `size` pixels wide.
fn wall(size: u32, make: &dyn Fn(&mut SceneMaker) -> Material) -> Built {
    let eye = Vec3::new(0.0, -2.0, 3.0);
    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 30.0, size);
    let material = make(&mut maker);
    let material = maker.material(material);
    let square = maker.exact(ExactKind::Rectangle, Affine3A::from_scale(Vec3::splat(4.0)));
    maker.shape(square, material, None, false);
    maker.emitter(Emitter::Directional {
        direction: Vec3::new(0.0, -0.8, -0.6),
        irradiance: Rgb::ONE,
    });
    maker.build(Backend::default())
}

/// What enters the light in another way than linearly is not averaged over a pixel: the mean over an
/// image does not depend on how many pixels it has.
#[test]
fn walls_are_as_bright_in_few_pixels_as_in_many() {
    let dir = tempfile::tempdir().unwrap();
    let store = TextureStore::new(16 << 20);
    let heights = waves(dir.path(), &store, |x, y| [0.01 * x.sin() * y.cos(); 3]);
    let normals = waves(dir.path(), &store, |x, y| {
        [0.5 + 0.3 * x.sin(), 0.5 + 0.3 * y.cos(), 0.9]
    });
    let alphas = waves(dir.path(), &store, |x, y| {
        [0.3 + 0.25 * (x.sin() * y.sin()).signum(); 3]
    });
    let under = |maker: &mut SceneMaker| maker.material(metal(grey(0.3)));
    let cases: [(&str, &dyn Fn(&mut SceneMaker) -> Material); 3] = [
        ("bumps", &|maker| Material::BumpMap {
            displacement: heights.clone(),
            scale: 10.0,
            inner: maker.diffuse(0.5),
        }),
        ("normals", &|maker| Material::NormalMap {
            normals: normals.clone(),
            inner: under(maker),
        }),
        ("roughness", &|_| metal(alphas.clone())),
    ];
    for (what, make) in cases {
        let path = twintree::integrate::PathSettings {
            max_depth: 2,
            ..settings()
        };
        let (few, few_error) = film_mean(&wall(8, make).render(&path, 8192).0);
        let (many, error) = film_mean(&wall(128, make).render(&path, 32).0);
        let z = (few - many) / error.hypot(few_error);
        println!("{what}: {few} +- {few_error}, {many} +- {error}");
        assert!(
            z.abs() < 4.0,
            "{what}: {few} and {many}, {z} standard errors"
        );
        assert!(few_error < 0.004 * few, "{what}: too noisy to tell");
    }
}
