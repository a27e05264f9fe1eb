//! What is half there.

use super::support::{SceneMaker, grey, settings};
use super::{backends, load, seen};
use std::path::Path;
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::Material;
use twintree::integrate::PathSettings;
use twintree::math::{Affine3A, Vec3};
use twintree::scene::Description;

/// A shape under a white sky, seen so closely that it fills the picture.
fn close_up(dir: &Path, shape: &str) -> Description {
    let text = format!(
        "<sensor type='perspective'><float name='fov' value='8'/>
           <transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>
           <film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/>
             <rfilter type='box'/></film></sensor>
         <emitter type='constant'/>{shape}"
    );
    load(dir, &text)
}

/// Round shapes: a ball, and a cylinder across the view.
const ROUND: [&str; 2] = [
    "type='sphere'>",
    "type='cylinder'><point name='p0' x='-2'/><point name='p1' x='2'/>",
];

#[test]
fn half_there_walls_let_a_quarter_through() {
    let dir = tempfile::tempdir().unwrap();
    let black = "<bsdf type='mask'><float name='opacity' value='0.5'/><bsdf type='twosided'>
        <bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf></bsdf>";
    for round in ROUND {
        let shape = format!("<shape {round}{black}</shape>");
        for backend in backends() {
            let built = seen(close_up(dir.path(), &shape), backend);
            let (mean, error) = built.mean(&settings(), 256);
            let z = (mean - 0.25) / error;
            assert!(z.abs() < 4.0, "{round} {backend:?}: {mean} +- {error}");
        }
    }
}

/// A mask is a blend with nothing.
#[test]
fn masked_glass_is_glass_blended_with_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let glass = "<bsdf type='dielectric'><rgb name='specular_transmittance' value='0.5'/></bsdf>";
    let mask = format!("<bsdf type='mask'><float name='opacity' value='0.6'/>{glass}</bsdf>");
    let blend = format!(
        "<bsdf type='blendbsdf'><float name='weight' value='0.6'/><bsdf type='null'/>{glass}</bsdf>"
    );
    for round in ROUND {
        for backend in backends() {
            let mean = |bsdf: &str| {
                let shape = format!("<shape {round}{bsdf}</shape>");
                seen(close_up(dir.path(), &shape), backend).mean(&settings(), 512)
            };
            let ((a, a_error), (b, b_error)) = (mean(&mask), mean(&blend));
            let z = (a - b) / a_error.hypot(b_error);
            assert!(z.abs() < 4.0, "{round} {backend:?}: {a} and {b}, z {z}");
        }
    }
}

/// Opacity is no matter of what a lamp emits: rays that meet a half-there lamp and samples of its
/// light bring the same together as those of a whole one.
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
        let ground = maker.exact(
            AnalyticKind::Rectangle,
            Affine3A::from_scale(Vec3::splat(4.0)),
        );
        maker.shape(ground, floor, None, false);
        let above = Affine3A::from_translation(Vec3::Z);
        let lamp = maker.exact(AnalyticKind::Disk, above);
        maker.shape(lamp, cover, Some(1.0), true);
        let path = PathSettings {
            max_depth: 2,
            ..settings()
        };
        maker.build(Backend::default()).mean(&path, 1024)
    };
    let (whole, whole_error) = mean(None);
    for opacity in [0.3, 0.7] {
        let (half, error) = mean(Some(opacity));
        let z = (half - whole) / error.hypot(whole_error);
        assert!(z.abs() < 4.0, "{opacity}: {half} instead of {whole}: {z}");
        assert!(error < 0.002 * whole, "too noisy to tell: {error}");
    }
}
