//! What pbrt's documentation says of lights, films and names, and the manual of all names.

use super::load;
use crate::camera::{FovAxis, Projection};
use crate::image::ImageError;
use crate::light::Emitter;
use crate::math::{Rgb, luminance};
use crate::scene::Description;
use crate::scene::import::{ImportError, ImportOptions, OpenTexture};
use crate::texture::{BitmapSettings, Texture};
use std::f32::consts::PI;
use std::sync::{Arc, Mutex};

/// Opens nothing: remembers what was asked for.
#[derive(Default)]
struct Asked(Mutex<Vec<BitmapSettings>>);

impl OpenTexture for Asked {
    fn open(&self, settings: BitmapSettings) -> Result<Texture, ImageError> {
        self.0.lock().unwrap().push(settings);
        Ok(Texture::Constant(Rgb::splat(0.25)))
    }
}

fn try_load(text: &str) -> (Result<Description, ImportError>, Vec<BitmapSettings>) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.pbrt");
    std::fs::write(&path, text).unwrap();
    std::fs::write(dir.path().join("a.png"), "").unwrap();
    std::fs::write(dir.path().join("d65.spd"), "# light\n380 1\n780 1\n").unwrap();
    let asked = Arc::new(Asked::default());
    let loaded = load(&path, &ImportOptions::new(asked.clone()));
    let list = asked.0.lock().unwrap().clone();
    (loaded, list)
}

fn scene(text: &str) -> Description {
    try_load(text).0.unwrap_or_else(|e| panic!("{e}"))
}

fn near(a: Rgb, b: Rgb) {
    assert!(
        (a - b).abs().max_element() < 2e-3 * b.max_element(),
        "{a} for {b}"
    );
}

/// The radiance of the one sky of a world.
fn sky(before: &str, light: &str) -> Rgb {
    let d = scene(&format!(
        "{before} WorldBegin LightSource \"infinite\" {light}"
    ));
    match &d.emitters[0] {
        Emitter::Constant { radiance } => *radiance,
        other => panic!("{other:?}"),
    }
}

#[test]
fn rgb_light_is_that_colour_and_spectra_have_luminance_one() {
    near(sky("", "\"rgb L\" [1 2 3]"), Rgb::new(1.0, 2.0, 3.0));
    near(
        sky("", "\"rgb L\" [1 2 3] \"float scale\" 2"),
        Rgb::new(2.0, 4.0, 6.0),
    );
    near(sky("", ""), Rgb::ONE);
    for spectrum in [
        "\"blackbody L\" 3000",
        "\"blackbody L\" [6500]",
        "\"spectrum L\" [400 3 700 9]",
        "\"spectrum L\" \"d65.spd\"",
        "\"spectrum L\" \"stdillum-A\"",
        "\"spectrum L\" \"stdillum-F4\"",
    ] {
        let rgb = sky("", spectrum);
        assert!((luminance(rgb) - 1.0).abs() < 2e-3, "{spectrum}: {rgb}");
    }
    near(sky("", "\"spectrum L\" \"stdillum-D65\""), Rgb::ONE);
    // Illuminant A is a black body of 2856 K.
    let a = sky("", "\"spectrum L\" \"stdillum-A\"");
    let body = sky("", "\"blackbody L\" 2856");
    assert!((a - body).abs().max_element() < 0.02, "{a} {body}");
    near(sky("", "\"float illuminance\" 6.2831853"), Rgb::splat(2.0));
}

#[test]
fn the_sensor_multiplies_light_by_exposure_and_iso() {
    let camera = "Camera \"perspective\" \"float shutterclose\" .5";
    let film = "Film \"rgb\" \"float iso\" 400";
    near(sky(&format!("{camera} {film}"), ""), Rgb::splat(2.0));
    near(sky(film, "\"float scale\" .5"), Rgb::splat(2.0));
    near(
        sky("Film \"rgb\" \"string sensor\" \"cie1931\"", ""),
        Rgb::ONE,
    );
    let d = scene("Film \"rgb\" \"string sensor\" \"canon_eos_100d\" WorldBegin Shape \"sphere\"");
    assert!(d.warnings[0].contains("canon_eos_100d"), "{:?}", d.warnings);
}

#[test]
fn power_is_spread_over_what_shines() {
    let intensity = |light: &str| {
        let d = scene(&format!("WorldBegin LightSource {light}"));
        match &d.emitters[0] {
            Emitter::Point { intensity, .. } | Emitter::Spot { intensity, .. } => *intensity,
            other => panic!("{other:?}"),
        }
    };
    near(
        intensity("\"point\" \"float power\" 100"),
        Rgb::splat(100.0 / (4.0 * PI)),
    );
    near(
        intensity("\"point\" \"rgb I\" [1 0 0] \"float power\" 100 \"float scale\" 2"),
        Rgb::X * (200.0 / (4.0 * PI)),
    );
    // A cone of 60 degrees, half of the light beyond 30: its mean is a half there.
    let cone = 2.0 * PI * ((1.0 - 0.866_025_4) + (0.866_025_4 - 0.5) / 2.0);
    let spot = "\"spot\" \"float coneangle\" 60 \"float conedeltaangle\" 30 \"float power\" 10";
    near(intensity(spot), Rgb::splat(10.0 / cone));
    // A sphere of radius 2 as a whole, on both sides.
    let d = scene(
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 100 \"bool twosided\" true Shape \
         \"sphere\" \"float radius\" 2",
    );
    let Emitter::Area {
        radiance,
        both_sides,
        ..
    } = &d.emitters[0]
    else {
        panic!()
    };
    let area = 16.0 * PI;
    near(
        radiance.constant().unwrap(),
        Rgb::splat(100.0 / (2.0 * PI * area)),
    );
    assert!(both_sides);
}

#[test]
fn films_and_cameras_are_read() {
    let d = scene("LookAt 0 0 -5 0 0 0 0 1 0 Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100
        \"float cropwindow\" [.1 .5 0 1] \"string filename\" \"a.exr\"
        Sampler \"zsobol\" \"integer pixelsamples\" 77 Integrator \"volpath\" \"integer maxdepth\" 9
        Camera \"perspective\" \"float fov\" 90 WorldBegin Shape \"sphere\"");
    assert!(d.warnings.is_empty(), "{:?}", d.warnings);
    assert_eq!(
        (d.film.width, d.film.height, d.film.crop),
        (200, 100, Some([20, 0, 100, 100]))
    );
    assert_eq!((d.render.spp, d.render.max_depth), (77, Some(10)));
    // 90 degrees across the shorter side: tan 45 = 1, twice as wide.
    let Projection::Perspective {
        fov_degrees,
        fov_axis: FovAxis::X,
        ..
    } = d.camera.projection
    else {
        panic!()
    };
    assert!((fov_degrees - 2.0 * 2f64.atan().to_degrees()).abs() < 1e-9);
    let d = scene("WorldBegin Shape \"sphere\"");
    assert_eq!(
        (
            d.film.width,
            d.film.height,
            d.render.spp,
            d.render.max_depth
        ),
        (1280, 720, 16, Some(6))
    );
}

#[test]
fn images_stand_upright_and_are_read_with_their_encoding() {
    let (loaded, asked) = try_load("WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"
        \"float uscale\" 2 \"float vdelta\" .25 \"string encoding\" \"linear\" \"string wrap\" \"clamp\"
        Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
    loaded.unwrap();
    let settings = &asked[0];
    assert!(settings.raw);
    let at = settings.to_uv.0.transform_point2(glam::Vec2::new(0.5, 0.5));
    assert_eq!(at, glam::Vec2::new(1.0, 0.25));
}

#[test]
fn motion_is_named_and_left_out() {
    let d = scene(
        "WorldBegin ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Shape \"sphere\"",
    );
    assert!(
        d.warnings[0].contains("motion of this shape"),
        "{:?}",
        d.warnings
    );
}

#[test]
fn names_are_used_before_they_are_defined() {
    let d = scene(
        "WorldBegin NamedMaterial \"m\" Shape \"sphere\" MakeNamedMaterial \"m\" \"string type\" \
         \"dielectric\"",
    );
    assert_eq!(d.materials.get(d.shapes[0].material).name(), "dielectric");
}

#[test]
fn curves_that_follow_each_other_are_one_mesh() {
    let curve =
        "Shape \"curve\" \"point3 P\" [0 0 0 0 0 1 0 0 2 0 0 3] \"string type\" \"cylinder\" ";
    let d = scene(&format!(
        "WorldBegin {} Material \"hair\" {curve}",
        curve.repeat(100)
    ));
    assert_eq!(d.shapes.len(), 2);
}

/// The manual has every name that the importer knows.
#[test]
fn the_manual_names_everything() {
    let page = include_str!("../../../manual/pbrt.md");
    let mut names: Vec<&str> = super::statement::DIRECTIVES.iter().map(|d| d.0).collect();
    for list in [
        super::shapes::SHAPES,
        super::lights::LIGHTS,
        super::materials::MATERIALS,
        super::materials_v3::MATERIALS,
        super::textures::TEXTURES,
        super::media::MEDIA,
        super::camera::CAMERAS,
        super::film::FILMS,
        super::film::FILTERS,
        super::film::SAMPLERS,
        super::film::INTEGRATORS,
    ] {
        names.extend(list);
    }
    names.extend(super::color_space::COLOR_SPACES.iter().map(|c| c.0));
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with('|')).collect();
    for name in names {
        let written = format!("`{name}`");
        assert!(
            rows.iter().any(|row| row.contains(&written)),
            "the manual has no row for {name}"
        );
    }
}

/// Every kind in the tables is taken by the importer, and no other.
#[test]
fn every_name_of_the_tables_is_known() {
    let unknown = |text: String| {
        let error = try_load(&text)
            .0
            .err()
            .map(|e| e.to_string())
            .unwrap_or_default();
        error.contains("there is no") && error.contains("of the kind")
            || error.contains("are not read")
    };
    for kind in super::shapes::SHAPES {
        assert!(!unknown(format!("WorldBegin Shape \"{kind}\"")), "{kind}");
    }
    for kind in super::lights::LIGHTS {
        assert!(
            !unknown(format!("WorldBegin LightSource \"{kind}\"")),
            "{kind}"
        );
    }
    for kind in super::materials::MATERIALS
        .iter()
        .chain(super::materials_v3::MATERIALS)
    {
        assert!(
            !unknown(format!("WorldBegin Material \"{kind}\" Shape \"sphere\"")),
            "{kind}"
        );
    }
    for kind in super::textures::TEXTURES {
        let text = format!(
            "WorldBegin Texture \"t\" \"spectrum\" \"{kind}\" Material \"diffuse\" \"texture \
             reflectance\" \"t\" Shape \"sphere\""
        );
        assert!(!unknown(text), "{kind}");
    }
    assert!(unknown("WorldBegin Shape \"nurbs\"".into()));
    assert!(unknown(
        "WorldBegin Material \"disney\" Shape \"sphere\"".into()
    ));
}
