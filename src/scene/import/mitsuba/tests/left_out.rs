//! Nothing that a scene asks for is left out without a word.

use super::Stage;
use crate::bsdf::Material;
use crate::bsdf::material::{Diffuse, InvalidNormals};
use crate::camera::Projection;
use crate::light::Emitter;
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::Description;
use crate::texture::{SurfacePoint, Texture};

fn material(d: &Description) -> &Material {
    d.materials.get(d.shapes[0].material)
}

fn on_sphere(bsdf: &str) -> String {
    format!("<shape type='sphere'>{bsdf}</shape>")
}

/// The one warning of a scene with `inside` has these words.
fn warns(inside: &str, words: &[&str]) {
    let d = Stage::new().modern(inside);
    assert_eq!(d.warnings.len(), 1, "{inside}: {:?}", d.warnings);
    for word in words {
        assert!(d.warnings[0].contains(word), "{word}: {}", d.warnings[0]);
    }
    assert!(d.warnings[0].contains("scene.xml:1:"), "{}", d.warnings[0]);
}

fn scene(sensor: &str) -> Description {
    let text = format!(
        "<scene version='0.6.0'>{sensor}<shape type='sphere'/><emitter type='constant'/></scene>"
    );
    Stage::new().load(&text).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn formats_without_alpha_and_other_curves_are_told_of() {
    for (film, words) in [
        (
            "<string name='pixelFormat' value='rgba'/>",
            "has alpha, which images have where emitters are hidden",
        ),
        (
            "<string name='pixelFormat' value='luminance'/>",
            "images are R G B",
        ),
        (
            "<string name='tonemapMethod' value='reinhard'/><float name='key' value='0.2'/>",
            "reinhard",
        ),
        ("<float name='gamma' value='1.8'/>", "\"gamma\" 1.8"),
    ] {
        let d = scene(&format!(
            "<sensor type='perspective'><film type='ldrfilm'>{film}</film></sensor>"
        ));
        assert_eq!(d.warnings.len(), 1, "{film}: {:?}", d.warnings);
        assert!(d.warnings[0].contains(words), "{film}: {:?}", d.warnings);
    }
    for film in [
        "<string name='pixelFormat' value='rgb'/>",
        "<string name='tonemapMethod' value='gamma'/><float name='gamma' value='-1'/>",
        "<float name='gamma' value='2.2'/><boolean name='banner' value='false'/>",
    ] {
        let d = scene(&format!(
            "<sensor type='perspective'><film type='ldrfilm'>{film}</film></sensor>"
        ));
        assert_eq!(d.warnings, [""; 0], "{film}");
    }
}

#[test]
fn suns_and_coats_tell_what_they_leave_out() {
    warns(
        "<emitter type='sunsky'><boolean name='complex_sun' value='true'/></emitter><shape type='sphere'/>",
        &["\"complex_sun\" is left out"],
    );
    warns(
        "<emitter type='sky'><boolean name='extend' value='true'/></emitter><shape type='sphere'/>",
        &["\"extend\" is left out"],
    );
    warns(
        &on_sphere(
            "<bsdf type='roughplastic'><float name='specular_transmittance' value='0.2'/></bsdf>",
        ),
        &["no parameter \"specular_transmittance\""],
    );
    warns(
        &on_sphere("<emitter type='directionalarea'/>"),
        &["directionalarea", "dark"],
    );
}

/// Constants are normals as well as textures, in every way that Mitsuba takes them.
#[test]
fn normal_maps_may_be_constant() {
    for normals in [
        "<rgb name='normalmap' value='0.9,0.5,0.7'/>",
        "<texture name='normalmap' type='rawconstant'><vector name='value' value='0.9,0.5,0.7'/></texture>",
        "<texture name='normalmap' type='rawconstant'><rgb name='value' value='0.9,0.5,0.7'/></texture>",
        "<spectrum name='normalmap' type='srgb'><rgb name='color' value='0.9,0.5,0.7'/></spectrum>",
    ] {
        let d = Stage::new().modern(&on_sphere(&format!(
            "<bsdf type='normalmap'>{normals}<bsdf type='diffuse'/></bsdf>"
        )));
        assert_eq!(d.warnings, [""; 0], "{normals}");
        let Material::NormalMap {
            normals: texture,
            invalid_normals,
            ..
        } = material(&d)
        else {
            panic!("{:?}", material(&d));
        };
        assert_eq!(
            texture.constant(),
            Some(Rgb::new(0.9, 0.5, 0.7)),
            "{normals}"
        );
        assert_eq!(*invalid_normals, InvalidNormals::default());
    }
}

/// The value of a material that turns the normal, for light from above at a slant. Mitsuba 3.9.1's
/// (`scalar_rgb`), with the normal (0.8, 0, 0.4) of length 0.89.
#[test]
fn turned_normals_do_as_the_scene_says() {
    for (flags, expected) in [
        ("", [0.101, 0.07118, 0.13573]),
        (
            "<boolean name='use_shadowing_function' value='false'/>",
            [0.158_28, 0.07118, 0.15099],
        ),
        (
            "<boolean name='flip_invalid_normals' value='false'/>",
            [0.101, 0.0, 0.0],
        ),
        (
            "<boolean name='flip_invalid_normals' value='false'/><boolean name='use_shadowing_function' value='false'/>",
            [0.158_28, 0.0, 0.0],
        ),
    ] {
        let d = Stage::new().modern(&on_sphere(&format!(
            "<bsdf type='normalmap'>{flags}<rgb name='normalmap' value='0.9,0.5,0.7'/><bsdf type='diffuse'/></bsdf>"
        )));
        assert_eq!(d.warnings, [""; 0], "{flags}");
        let point = SurfacePoint::at_uv(Vec2::splat(0.3));
        let id = d.shapes[0].material;
        let value = |wo: Vec3, wi: Vec3| {
            let (wo, wi) = (wo.normalize(), wi.normalize());
            let bsdf = d.materials.resolve(id, &point, wo);
            bsdf.eval_pdf(wo, wi, crate::bsdf::Transport::Radiance).0.x
        };
        let behind = Vec3::new(-0.8, 0.0, 0.6);
        let found = [
            value(Vec3::Z, Vec3::new(0.8, 0.0, 0.3)),
            value(behind, Vec3::Z),
            value(behind, Vec3::new(-0.5, 0.0, 0.5)),
        ];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 2e-4,
                "{flags}: {found} {expected}"
            );
        }
        let bump = Stage::new().modern(&on_sphere(&format!(
            "<bsdf type='bumpmap'>{flags}<texture type='checkerboard'/><bsdf type='diffuse'/></bsdf>"
        )));
        assert_eq!(bump.warnings, [""; 0], "{flags}");
        let Material::BumpMap {
            invalid_normals, ..
        } = material(&bump)
        else {
            panic!("{:?}", material(&bump));
        };
        assert_eq!(invalid_normals.flip, !flags.contains("flip"));
        assert_eq!(invalid_normals.shadow, !flags.contains("use"));
    }
}

/// Mitsuba 3's checkerboard swaps its colours where one number is asked of it; Mitsuba 0.x's does
/// not.
#[test]
fn checkerboards_swap_numbers_in_mitsuba_3() {
    let bsdf = "<bsdf type='mask'><texture type='checkerboard' name='opacity'><float name='color0' value='0.1'/><float name='color1' value='0.9'/></texture><bsdf type='diffuse'/></bsdf>";
    let opacity = |d: &Description| {
        let Material::Mask { opacity, .. } = material(d) else {
            panic!("{:?}", material(d));
        };
        let point = SurfacePoint::at_uv(Vec2::splat(0.2));
        (opacity.eval(&point).x, opacity.eval_scalar(&point))
    };
    assert_eq!(opacity(&Stage::new().modern(&on_sphere(bsdf))), (0.1, 0.9));
    assert_eq!(opacity(&Stage::new().classic(&on_sphere(bsdf))), (0.1, 0.1));
}

/// A texture that reaches above 1 is cut, and told of, as a colour is: bitmaps, and what is made of
/// them.
#[test]
fn reflectances_above_1_are_cut_with_a_warning() {
    let stage = Stage::new().with_files();
    stage.exr("two.exr", 4, 2.0);
    stage.exr("half.exr", 4, 0.5);
    let bitmap = |name: &str, file: &str| {
        format!(
            "<texture type='bitmap' name='{name}'><string name='filename' value='{file}.exr'/></texture>"
        )
    };
    let scaled = |file: &str, factor: f32| {
        let inner = bitmap("", file);
        format!(
            "<texture type='scale' name='reflectance'>{inner}<float name='scale' value='{factor}'/></texture>"
        )
    };
    let board = format!(
        "<texture type='checkerboard' name='reflectance'>{}</texture>",
        bitmap("color0", "two")
    );
    for (texture, warned, value) in [
        (bitmap("reflectance", "two"), true, 1.0),
        (bitmap("reflectance", "half"), false, 0.5),
        (scaled("half", 3.0), true, 1.0),
        (scaled("two", 0.4), false, 0.8),
        (board, true, 1.0),
    ] {
        let d = stage.modern(&on_sphere(&format!(
            "<bsdf type='diffuse'>{texture}</bsdf>"
        )));
        assert_eq!(
            d.warnings.len(),
            usize::from(warned),
            "{texture}: {:?}",
            d.warnings
        );
        if warned {
            assert!(
                d.warnings[0].contains("cut to the range 0 to 1"),
                "{:?}",
                d.warnings
            );
        }
        let Material::Diffuse(Diffuse { reflectance }) = material(&d) else {
            panic!("{:?}", material(&d));
        };
        let found = reflectance.eval(&SurfacePoint::at_uv(Vec2::splat(0.2)));
        assert!(
            (found - Rgb::splat(value)).abs().max_element() < 1e-6,
            "{texture}: {found}"
        );
    }
    // Light and numbers may be as large as they like.
    let lamp = format!(
        "<shape type='sphere'><emitter type='area'>{}</emitter></shape>",
        bitmap("radiance", "two")
    );
    let d = stage.modern(&lamp);
    assert_eq!(d.warnings, [""; 0]);
    let Emitter::Area {
        radiance: Texture::Bitmap(radiance),
        ..
    } = &d.emitters[0]
    else {
        panic!("{:?}", d.emitters);
    };
    assert_eq!(radiance.mean(), Rgb::splat(2.0));
}

#[test]
fn texels_and_windows_that_are_odd_are_told_of() {
    let stage = Stage::new().with_files();
    let pixel = |x, _| {
        if x == 0 {
            (-1.0f32, f32::NAN, 0.5f32)
        } else {
            (0.5, 0.5, 0.5)
        }
    };
    exr::prelude::write_rgb_file(stage.path("bad.exr"), 4, 4, pixel).unwrap();
    part_of_a_picture(&stage.path("part.exr"));
    let texture = |file: &str| {
        on_sphere(&format!(
            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='{file}'/></texture></bsdf>"
        ))
    };
    let sky = |file: &str| {
        format!(
            "<shape type='sphere'/><emitter type='envmap'><string name='filename' value='{file}'/></emitter>"
        )
    };
    for (inside, words) in [
        (texture("bad.exr"), "4 texels hold negative"),
        (texture("part.exr"), "data window"),
        (sky("bad.exr"), "values are negative"),
        (sky("part.exr"), "of a picture of 8 x 6"),
    ] {
        let d = stage.modern(&inside);
        assert_eq!(d.warnings.len(), 1, "{inside}: {:?}", d.warnings);
        assert!(d.warnings[0].contains(words), "{words}: {:?}", d.warnings);
    }
}

/// Two rows of four pixels, in a picture of eight by six.
fn part_of_a_picture(path: &std::path::Path) {
    use exr::prelude::*;
    let channels = SpecificChannels::rgb(|_: Vec2<usize>| (0.5f32, 0.5f32, 0.5f32));
    let attributes = LayerAttributes {
        layer_position: Vec2(3, 1),
        ..LayerAttributes::default()
    };
    let layer = Layer::new((4, 2), attributes, Encoding::FAST_LOSSLESS, channels);
    let window = IntegerBounds::from_dimensions((8, 6));
    let image = Image::empty(ImageAttributes::new(window)).with_layer(layer);
    image.write().to_file(path).unwrap();
}

#[test]
fn area_lights_by_themselves_are_for_those_who_refer_to_them() {
    let d = Stage::new().modern(
        "<shape type='rectangle'><ref id='lamp'/></shape><shape type='sphere'><ref id='lamp'/></shape>
         <emitter type='area' id='lamp'><rgb name='radiance' value='1 2 3'/></emitter>",
    );
    assert_eq!(d.warnings, [""; 0]);
    assert_eq!(d.emitters.len(), 2);
    let d = Stage::new().modern(
        "<film type='hdrfilm' id='film'/><sensor type='perspective'><ref id='film'/></sensor><shape type='sphere'/>",
    );
    assert!(
        d.warnings.iter().all(|w| !w.contains("no meaning")),
        "{:?}",
        d.warnings
    );
}

#[test]
fn spherical_cameras_and_tiled_films_are_read() {
    let d = scene(
        "<sensor type='spherical'><film type='tiledhdrfilm'><integer name='width' value='8'/><integer name='height' value='4'/></film></sensor>",
    );
    assert_eq!(d.warnings, [""; 0]);
    assert_eq!(d.camera.projection, Projection::Spherical);
    // Mitsuba 0.6's has no clip planes.
    assert_eq!((d.camera.near_clip, d.camera.far_clip), (0.0, 1e30));
    assert_eq!((d.film.width, d.film.height), (8, 4));
}

#[test]
fn scenes_of_other_programs_are_named() {
    for (file, words) in [
        ("LookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n", "pbrt"),
        ("#usda 1.0\n", "USD"),
        (
            "version https://git-lfs.github.com/spec/v1\n",
            "git lfs pull",
        ),
        ("<!DOCTYPE html><html><body>404</body></html>", "web page"),
        ("BLENDER-v293", "glTF"),
        ("{\"bsdfs\": []}", "Tungsten"),
    ] {
        let error = Stage::new().load(file).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("scene.xml"),
            "{error}"
        );
        let stage = Stage::new().with_files();
        stage.file("a.obj", file);
        let shape = "<shape type='obj'><string name='filename' value='a.obj'/></shape>";
        let mesh = stage.error(shape).to_string();
        assert!(mesh.contains("a.obj"), "{mesh}");
        // A mesh of JSON or of pbrt's words is no special mistake.
        assert!(
            mesh.contains(words) || words == "pbrt" || words == "Tungsten",
            "{mesh}"
        );
    }
}
