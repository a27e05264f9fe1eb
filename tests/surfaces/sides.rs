//! Fronts and backs.

use super::files::{gltf_file, gltf_scene, obj, ply, serialized};
use super::support::{agree, how, settings};
use super::{backends, load, seen};
use std::path::Path;
use twintree::accel::{Backend, BuildSettings, Hit, Ray};
use twintree::bsdf::Transport;
use twintree::integrate::training::learn;
use twintree::light::Emitter;
use twintree::math::{Pcg32, Vec3};
use twintree::scene::surface::DARK;
use twintree::scene::{Description, Scene};

const LAMP: &str =
    "<bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='1'/></emitter>";

/// Shapes, and a sensor that nobody looks through.
fn scene(dir: &Path, shapes: &str) -> Description {
    load(dir, &format!("<sensor type='perspective'/>{shapes}"))
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
fn expect(what: &str, scene: &Scene, (from, to): (Vec3, Vec3), side: Seen, both_glow: bool) {
    let ray = Ray::new(from, (to - from).normalize());
    let mut hits = [Hit::NONE];
    scene.rays.intersect_batch(&[ray], &mut hits);
    assert!(hits[0].is_some(), "{what}: nothing is met");
    let (hit, wo) = (&hits[0], -ray.dir);
    let point = scene.surfaces.point(&ray, hit, 0.0);
    let front = side == Seen::Front;
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
    let density = lights.pdf_area(
        (from, Vec3::ZERO),
        &(),
        (emitter, point.prim),
        (point.p, point.ng),
    );
    assert_eq!(density > 0.0, glows, "{what}: density");
    let mut rng = Pcg32::new(7, 1);
    let bright = (0..64).filter(|_| {
        let sample = lights.sample(from, Vec3::ZERO, &mut (), [(); 3].map(|()| rng.next_f32()));
        sample.is_some_and(|s| {
            let shadow = Ray {
                tmax: s.distance * 0.999_99,
                ..Ray::new(from, s.dir)
            };
            let bright = lights.radiance(&s.incoming).max_element() > 0.0;
            bright && !scene.rays.occluded(&shadow)
        })
    });
    // Some samples of closed shapes fall on walls behind others.
    assert_eq!(bright.count() > 0, glows, "{what}: light samples");
}

/// Photons leave to the front; to both sides alike if both glow. `front` points to its side of a
/// place.
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

/// A lamp in a box that shines at the ceiling: its mesh is mirrored and wound against its normals.
fn lamp_in_a_box(dir: &Path) -> Description {
    std::fs::write(dir.join("mesh"), obj(true, true)).unwrap();
    let text = format!(
        "<sensor type='perspective'><float name='fov' value='60'/>
           <transform name='to_world'><lookat origin='0,-0.9,0' target='0,1,0' up='0,0,1'/></transform>
           <film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/>
             <rfilter type='box'/></film></sensor>
         <shape type='cube'><boolean name='flip_normals' value='true'/><bsdf type='diffuse'/></shape>
         <shape type='obj'><string name='filename' value='mesh'/>
           <transform name='to_world'><scale x='-0.3' y='0.3'/><translate y='0.2' z='0.1'/></transform>
           {LAMP}</shape>"
    );
    load(dir, &text)
}

/// Photons teach a field of the same light that paths find, from a lamp whose front its normals
/// tell and from one that glows on both sides.
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
        agree(&format!("both sides {both}"), &guided, &plain);
    }
}
