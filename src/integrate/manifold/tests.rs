//! Tests of specular chains.

use super::follow::{Cone, LONGEST, SpecularChain, follow, follow_differential};
use super::guess::Guess;
use super::newton::{curved, solve};
use super::ray_differential::RayDifferential;
use super::receiver::Receiver;
use crate::accel::{AnalyticKind, AnalyticShape, Backend, BuildSettings, Ray};
use crate::bsdf::material::{Conductor, Dielectric, Diffuse};
use crate::bsdf::{LobeFlags, Material, MaterialId, Materials};
use crate::light::{Emitter, SunSky};
use crate::math::{Affine3A, Rgb, Vec3};
use crate::scene::interaction::Interaction;
use crate::scene::{Description, Geometry, Scene, Shape};
use crate::texture::Texture;
use std::f32::consts::FRAC_PI_2;

#[test]
fn a_chain_is_the_same_from_both_ends() {
    let lobes = [
        LobeFlags::REFLECTION,
        LobeFlags::TRANSMISSION,
        LobeFlags::TRANSMISSION | LobeFlags::NULL,
    ];
    let from_vertex = lobes.iter().fold(SpecularChain::EMPTY, |k, &l| k.then(l));
    let from_light = lobes
        .iter()
        .rev()
        .fold(SpecularChain::EMPTY, |k, &l| k.before(l));
    assert_eq!(from_vertex, from_light);
    assert_eq!(from_vertex.len(), 3);
    assert!(SpecularChain::EMPTY.is_empty() && !from_vertex.is_empty());
    let other = SpecularChain::EMPTY
        .then(lobes[0])
        .then(lobes[2])
        .then(lobes[1]);
    assert_ne!(other, from_vertex);
}

#[test]
fn chains_that_are_too_long_are_no_chain_that_a_guess_has() {
    let mut kinds = [SpecularChain::EMPTY; 2];
    for _ in 0..LONGEST {
        kinds = [
            kinds[0].then(LobeFlags::REFLECTION),
            kinds[1].before(LobeFlags::REFLECTION),
        ];
    }
    assert_eq!(kinds[0], kinds[1]);
    assert_eq!(kinds[0].len(), LONGEST);
    for _ in 0..3 {
        kinds = [
            kinds[0].then(LobeFlags::REFLECTION),
            kinds[1].before(LobeFlags::REFLECTION),
        ];
        assert_eq!(kinds, [SpecularChain::LOST; 2]);
    }
}

/// Towards the sun.
const SUN: Vec3 = Vec3::new(0.2, 0.8, -0.55);
/// The mirror's axis is along x and goes through here.
const AXIS: Vec3 = Vec3::new(0.0, 2.0, 3.0);
const RADIUS: f32 = 0.5;

fn shape(kind: AnalyticKind, receiver: Affine3A, material: MaterialId) -> Shape {
    Shape {
        name: String::new(),
        geometry: Geometry::Analytic(AnalyticShape::new(kind, receiver)),
        material,
        emitter: None,
        flip_normals: false,
        group: None,
        boundary: None,
    }
}

fn grey(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

fn mirror() -> Material {
    Material::Conductor(Conductor {
        eta: grey(0.0),
        k: grey(1.0),
        specular_reflectance: grey(1.0),
    })
}

/// A floor, y = 0, and over it a cylinder that is a mirror, in the sun.
fn floor_and_mirror() -> Scene {
    let mut materials = Materials::default();
    let matt = materials.push(Diffuse {
        reflectance: grey(0.5),
    });
    let mirror = materials.push(mirror());
    let floor = Affine3A::from_rotation_x(-FRAC_PI_2) * Affine3A::from_scale(Vec3::splat(10.0));
    let cylinder = Affine3A::from_translation(AXIS - 10.0 * Vec3::X)
        * Affine3A::from_rotation_y(FRAC_PI_2)
        * Affine3A::from_scale(Vec3::new(RADIUS, RADIUS, 20.0));
    let mut description = Description {
        shapes: vec![
            shape(AnalyticKind::Rectangle, floor, matt),
            shape(AnalyticKind::Cylinder, cylinder, mirror),
        ],
        materials,
        emitters: vec![Emitter::SunSky {
            settings: SunSky {
                sky: false,
                sun: true,
                sun_direction: SUN.normalize(),
                turbidity: 3.0,
                albedo: Rgb::splat(0.2),
                sky_scale: 1.0,
                sun_scale: 1.0,
                sun_radius_degrees: 0.5,
                stretch: 1.0,
                z_up: false,
            },
            scale: 1.0,
            to_world: Affine3A::IDENTITY,
        }],
        ..Description::empty()
    };
    Scene::build(&mut description, BuildSettings::default(), Backend::Obvhs).unwrap()
}

/// What a ray meets.
fn met<'s>(scene: &'s Scene, ray: &Ray) -> Interaction<'s> {
    let hit = scene.first_hit(ray);
    let met = scene.surfaces.interaction(ray, &hit, 0.0);
    met.expect("something is there")
}

/// A place of the floor.
fn on_floor(scene: &Scene, x: f32, z: f32) -> Receiver {
    let ray = Ray::new(Vec3::new(x, 0.5, z), -Vec3::Y);
    let met = met(scene, &ray);
    Receiver::new(&met.point, &met.bsdf(&scene.surfaces), Vec3::Y)
}

/// The sun's image in a cylinder is as far away as the sun for who moves along it, and close behind
/// its surface, at half the radius times the cosine of incidence (Coddington's equation for the
/// plane of incidence), for who moves across.
#[test]
fn a_guess_follows_the_suns_image_in_a_cylinder() {
    let scene = floor_and_mirror();
    let caustic_emitters = scene.lights.caustic_emitters();
    let receiver = on_floor(&scene, 0.0, 0.0);
    // About where the mirror shows it.
    let normal = (SUN.normalize() - AXIS.normalize())
        .reject_from(Vec3::X)
        .normalize();
    let pane = AXIS + RADIUS * normal + 0.65 * Vec3::X;
    let to_pane = (pane - receiver.position).normalize();
    let chain = SpecularChain::EMPTY.then(LobeFlags::REFLECTION);
    let flat = Guess::new(receiver.position, to_pane, pane, chain, 0);
    let guess = curved(&scene, &receiver, &flat, &caustic_emitters[0]).expect("the sun is seen");

    let dir = guess.seen_from(receiver.position).normalize();
    let seen = |guess: &Guess, from: &Receiver| guess.seen_from(from.position).normalize();
    let along = on_floor(&scene, 0.4, 0.0);
    assert!(seen(&guess, &along).distance(dir) < 2e-3, "it goes along");
    assert!(seen(&flat, &along).distance(dir) > 0.05);

    // Everywhere near, searches begin where they end.
    for (x, z) in [(0.0, 0.1), (0.1, -0.1), (-0.3, 0.05)] {
        let from = on_floor(&scene, x, z);
        let image =
            solve(&scene, &from, &guess, &caustic_emitters[0], &mut 0).expect("the sun is seen");
        let off = image.middle().distance(seen(&guess, &from));
        assert!(off < 1e-3, "{off} at {x} {z}");
    }

    // In the plane across: by the distance of the image.
    let moved = on_floor(&scene, 0.0, 0.02);
    let sideways = Vec3::X.cross(dir).normalize();
    let turned = (seen(&guess, &moved) - dir).dot(sideways);
    let aside = (moved.position - receiver.position).dot(sideways);
    let mirror = met(&scene, &receiver.ray(dir)).point.p;
    let normal = (mirror - AXIS).reject_from(Vec3::X).normalize();
    let across = dir.reject_from(Vec3::X);
    let cosine = -across.normalize().dot(normal);
    // Distances as the plane across sees them.
    let distance = mirror.distance(receiver.position) * across.length() + 0.5 * RADIUS * cosine;
    let expected = -aside / distance * across.length();
    assert!(
        (turned / expected - 1.0).abs() < 0.02,
        "{turned} instead of {expected}"
    );
}

/// A ball of glass that is wider than long, and behind it a cylinder that is a mirror.
fn glass_and_mirror() -> Scene {
    let mut materials = Materials::default();
    let glass = materials.push(Dielectric {
        eta: 1.5,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    });
    let mirror = materials.push(mirror());
    let ball = Affine3A::from_rotation_x(0.3) * Affine3A::from_scale(Vec3::new(1.2, 1.0, 0.8));
    let cylinder = Affine3A::from_translation(Vec3::new(0.2, -20.0, 6.0))
        * Affine3A::from_rotation_x(-FRAC_PI_2)
        * Affine3A::from_scale(Vec3::new(1.5, 1.5, 40.0));
    let mut description = Description {
        shapes: vec![
            shape(AnalyticKind::Sphere, ball, glass),
            shape(AnalyticKind::Cylinder, cylinder, mirror),
        ],
        materials,
        ..Description::empty()
    };
    Scene::build(&mut description, BuildSettings::default(), Backend::Obvhs).unwrap()
}

/// Through the glass and off the mirror a ray differential is what rays beside each other trace,
/// and a ray of it arrives where they do.
#[test]
fn a_pencil_is_what_neighbours_trace() {
    const STEP: f32 = 1e-3;
    let scene = glass_and_mirror();
    let through = LobeFlags::TRANSMISSION;
    let chain = [through, through, LobeFlags::REFLECTION]
        .into_iter()
        .fold(SpecularChain::EMPTY, SpecularChain::then);
    let (org, dir) = (
        Vec3::new(0.3, 0.2, -3.0),
        Vec3::new(-0.02, 0.03, 1.0).normalize(),
    );
    let aside = Vec3::X.reject_from(dir).normalize();
    let axes = [aside, dir.cross(aside)];
    let end = |org: Vec3, dir: Vec3| {
        let ray = Ray::new(org, dir.normalize());
        let end = follow(&scene, ray, (chain, Cone::NONE), false, &mut |_, _| {})
            .expect("the chain leads on");
        (end.ray.org, end.ray.dir)
    };
    for (name, pencil) in [
        ("from a point", RayDifferential::from_point(axes)),
        ("aside", RayDifferential::aside(axes)),
    ] {
        let traced = follow_differential(&scene, Ray::new(org, dir), pencil, chain).unwrap();
        let found = traced.pencil.expect("nothing bends but the surfaces");
        for i in 0..2 {
            let [(from_org, from_dir), (to_org, to_dir)] = [-STEP, STEP]
                .map(|step| end(org + pencil.org[i] * step, dir + pencil.dir[i] * step));
            let change = (to_dir - from_dir) / (2.0 * STEP);
            let off = (found.dir[i] - change).length() / change.length();
            assert!(off < 0.01, "{name}: {} instead of {change}", found.dir[i]);
            // Along the ray they may start anywhere.
            let change = (to_org - from_org).reject_from(traced.ray.dir) / (2.0 * STEP);
            let org = found.org[i].reject_from(traced.ray.dir);
            let off = (org - change).length() / change.length();
            assert!(off < 0.01, "{name}: {org} instead of {change}");
        }
    }
}
