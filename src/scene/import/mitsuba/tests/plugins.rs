//! Plugins of every family, by their numbers.

use super::super::names;
use super::Stage;
use crate::accel::AnalyticKind;
use crate::bsdf::Material;
use crate::bsdf::material::{
    Conductor, Diffuse, Distribution, Plastic, RoughDielectric, RoughPlastic,
};
use crate::light::Emitter;
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::{Description, Geometry};
use crate::texture::{Filter, Texture, Wrap};

/// The material of the first shape.
fn material(d: &Description) -> &Material {
    d.materials.get(d.shapes[0].material)
}

fn on_sphere(bsdf: &str) -> String {
    format!("<shape type='sphere'>{bsdf}</shape>")
}

fn constant(texture: &Texture) -> Rgb {
    texture
        .constant()
        .unwrap_or_else(|| panic!("{texture:?} is not constant"))
}

#[test]
fn both_dialects_make_the_same_plastic() {
    let stage = Stage::new();
    let old = stage.classic(&on_sphere(
        "<bsdf type='roughplastic'><float name='intIOR' value='1.6'/><float name='extIOR' value='1'/><float name='alpha' value='0.3'/><string name='distribution' value='ggx'/><boolean name='nonlinear' value='true'/><rgb name='diffuseReflectance' value='.1 .2 .3'/></bsdf>",
    ));
    let new = stage.modern(&on_sphere(
        "<bsdf type='roughplastic'><float name='int_ior' value='1.6'/><float name='ext_ior' value='1'/><float name='alpha' value='0.3'/><string name='distribution' value='ggx'/><boolean name='nonlinear' value='true'/><rgb name='diffuse_reflectance' value='.1 .2 .3'/></bsdf>",
    ));
    for d in [old, new] {
        assert_eq!(d.warnings, [""; 0]);
        let Material::RoughPlastic(RoughPlastic {
            eta,
            roughness,
            diffuse_reflectance,
            nonlinear,
            ..
        }) = material(&d)
        else {
            panic!("{:?}", material(&d));
        };
        assert_eq!((*eta, *nonlinear), (1.6, true));
        assert_eq!(roughness.distribution, Distribution::Ggx);
        assert_eq!(constant(&roughness.alpha_v), Rgb::splat(0.3));
        assert_eq!(constant(diffuse_reflectance), Rgb::new(0.1, 0.2, 0.3));
    }
}

/// Values that Mitsuba 3.9.1 shows by `mi.traverse`.
#[test]
fn defaults_are_mitsubas() {
    let stage = Stage::new();
    let d = stage.modern(&on_sphere("<bsdf type='plastic'/>"));
    let Material::Plastic(Plastic { eta, .. }) = material(&d) else {
        panic!()
    };
    assert!((eta - 1.489_587_3).abs() < 1e-6, "{eta}");
    let d = stage.modern(&on_sphere("<bsdf type='roughdielectric'/>"));
    let Material::RoughDielectric(RoughDielectric { eta, roughness, .. }) = material(&d) else {
        panic!()
    };
    assert!((eta - 1.504_183_3).abs() < 1e-6, "{eta}");
    assert_eq!(constant(&roughness.alpha_u), Rgb::splat(0.1));
    let d = stage.modern(&on_sphere("<bsdf type='conductor'/>"));
    let Material::Conductor(Conductor { eta, k, .. }) = material(&d) else {
        panic!()
    };
    assert_eq!((constant(eta), constant(k)), (Rgb::ZERO, Rgb::ONE));
    let d = stage.classic(&on_sphere("<bsdf type='conductor'/>"));
    let Material::Conductor(Conductor { eta, .. }) = material(&d) else {
        panic!()
    };
    assert!((constant(eta).x - 0.201).abs() < 1e-3, "copper in 0.x");
    let d = stage.modern(&on_sphere("<bsdf type='principled'/>"));
    let Material::Principled(p) = material(&d) else {
        panic!()
    };
    assert!((p.eta - 1.5).abs() < 1e-6, "{}", p.eta);
    let d = stage.modern(&on_sphere(""));
    let Material::Diffuse(Diffuse { reflectance }) = material(&d) else {
        panic!()
    };
    assert_eq!(constant(reflectance), Rgb::splat(0.5));
    let d = stage.modern(&on_sphere("<emitter type='area'/>"));
    let Material::Diffuse(Diffuse { reflectance }) = material(&d) else {
        panic!()
    };
    assert_eq!(
        constant(reflectance),
        Rgb::ZERO,
        "a lamp without a bsdf is black"
    );
}

/// Every material that has no parameter it cannot do without.
#[test]
fn every_material_is_read() {
    let diffuse = "<bsdf type='diffuse'/>";
    let texture = "<texture type='checkerboard'/>";
    let tables = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/vectors/measured/isotropic.bsdf"
    );
    let around = [
        (
            "measured",
            format!("<string name='filename' value='{tables}'/>"),
        ),
        ("mask", diffuse.to_owned()),
        ("twosided", diffuse.to_owned()),
        ("twosided", diffuse.repeat(2)),
        ("coating", diffuse.to_owned()),
        ("roughcoating", diffuse.to_owned()),
        ("clearcoat", diffuse.to_owned()),
        ("sheen", diffuse.to_owned()),
        ("bumpmap", format!("{diffuse}{texture}")),
        ("normalmap", format!("{texture}{diffuse}")),
        (
            "blendbsdf",
            format!("<float name='weight' value='.3'/>{}", diffuse.repeat(2)),
        ),
        ("blendbsdf", format!("{texture}{}", diffuse.repeat(2))),
        (
            "mixturebsdf",
            format!(
                "<string name='weights' value='.2, .8'/>{}",
                diffuse.repeat(2)
            ),
        ),
    ];
    let is_plain = |plugin: &&&str| around.iter().all(|(a, _)| a != *plugin);
    let plain = names::plugins("bsdf").unwrap().iter().filter(is_plain);
    let plain = plain.map(|plugin| format!("<bsdf type='{plugin}'/>"));
    let inside = |(plugin, inside): &(_, _)| format!("<bsdf type='{plugin}'>{inside}</bsdf>");
    for bsdf in plain.chain(around.iter().map(inside)) {
        for d in [
            Stage::new().modern(&on_sphere(&bsdf)),
            Stage::new().classic(&on_sphere(&bsdf)),
        ] {
            assert_eq!(d.warnings, [""; 0], "{bsdf}");
        }
    }
}

#[test]
fn references_go_forwards_and_backwards_and_share() {
    let d = Stage::new().modern(
        "<shape type='sphere'><ref id='late'/></shape><bsdf type='diffuse' id='late'/><alias id='late' as='same'/><shape type='disk'><ref id='same'/></shape>",
    );
    assert_eq!(d.shapes[0].material, d.shapes[1].material);
    assert_eq!(d.materials.len(), 1);
}

#[test]
fn bitmaps_get_their_settings() {
    let stage = Stage::new();
    stage.file("t.png", "");
    let bitmap = |inside: &str| {
        on_sphere(&format!(
            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='t.png'/>{inside}</texture></bsdf>"
        ))
    };
    let d = stage.classic(&bitmap("<string name='filterType' value='nearest'/><string name='wrapModeU' value='clamp'/><float name='gamma' value='1.0'/><float name='uscale' value='2'/><float name='voffset' value='0.25'/>"));
    assert_eq!(d.warnings, [""; 0]);
    stage.modern(&bitmap("<boolean name='raw' value='true'/><string name='wrap_mode' value='mirror'/><transform name='to_uv'><translate x='0.5'/><scale x='4'/></transform>"));
    let asked = stage.textures.0.lock().unwrap();
    assert_eq!(
        (asked[0].filter, asked[0].wrap_u),
        (Filter::Nearest, Wrap::Clamp)
    );
    assert_eq!((asked[0].wrap_v, asked[0].gamma), (Wrap::Repeat, Some(1.0)));
    let uv = asked[0].to_uv.0.transform_point2(Vec2::new(0.5, 0.5));
    assert_eq!(uv, Vec2::new(1.0, 0.75));
    assert!(asked[1].raw && asked[1].wrap_v == Wrap::Mirror);
    let uv = asked[1].to_uv.0.transform_point2(Vec2::new(0.25, 0.5));
    assert_eq!(uv, Vec2::new(3.0, 0.5));
    assert!(asked[1].path.ends_with("t.png"));
}

#[test]
fn shapes_stand_where_the_scene_says() {
    let d = Stage::new().modern(
        "<shape type='sphere'><point name='center' x='1' y='2' z='3'/><float name='radius' value='2'/><boolean name='flip_normals' value='true'/></shape>
         <shape type='cylinder'><point name='p0' x='1' y='0' z='0'/><point name='p1' x='1' y='5' z='0'/><float name='radius' value='3'/></shape>
         <shape type='rectangle'><transform name='to_world'><scale x='2' y='3' z='0'/></transform></shape>",
    );
    assert_eq!(d.warnings, [""; 0]);
    let exact = |i: usize| match &d.shapes[i].geometry {
        Geometry::Analytic(shape) => *shape,
        Geometry::Mesh(_) => panic!("not exact"),
    };
    let sphere = exact(0);
    assert_eq!(sphere.kind, AnalyticKind::Sphere);
    assert_eq!(
        sphere.to_world.transform_point3(Vec3::X),
        Vec3::new(3.0, 2.0, 3.0)
    );
    assert!(d.shapes[0].flip_normals);
    let cylinder = exact(1).to_world;
    assert_eq!(cylinder.transform_point3(Vec3::Z), Vec3::new(1.0, 5.0, 0.0));
    let rim = cylinder.transform_vector3(Vec3::X);
    assert!(
        (rim.length() - 3.0).abs() < 1e-5 && rim.y.abs() < 1e-5,
        "{rim}"
    );
}

/// Each face of a cube looks outwards, whatever mirrors it; `flip_normals` turns them all.
#[test]
fn cubes_are_closed_and_turned_outwards() {
    for (inside, sign) in [
        ("", 1.0),
        (
            "<transform name='to_world'><scale x='-1'/></transform>",
            1.0,
        ),
        ("<boolean name='flip_normals' value='true'/>", -1.0),
    ] {
        let d = Stage::new().modern(&format!("<shape type='cube'>{inside}</shape>"));
        let Geometry::Mesh(mesh) = &d.shapes[0].geometry else {
            panic!()
        };
        let (mut area, mut volume) = (0.0, 0.0);
        for i in 0..mesh.triangles.triangles().len() {
            let [a, b, c] = mesh.triangles.corners(i as u32);
            area += 0.5 * (b - a).cross(c - a).length();
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!((area - 24.0).abs() < 1e-4, "{area}");
        // The signed volume is positive where the normals point outwards (divergence theorem).
        assert!((volume - 8.0 * sign).abs() < 1e-4, "{inside}: {volume}");
    }
}

/// Vertices and texture coordinates of Mitsuba 3.9.1's cube: per face, the corners at (0, 1), (1, 1),
/// (1, 0) and (0, 0) (`mi.traverse(mi.load_dict({"type": "cube"}))`).
#[test]
fn textures_lie_on_cubes_as_in_mitsuba() {
    let expected = [
        [[1, -1, -1], [1, -1, 1], [-1, -1, 1], [-1, -1, -1]],
        [[1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, 1, 1]],
        [[1, -1, -1], [1, 1, -1], [1, 1, 1], [1, -1, 1]],
        [[1, -1, 1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]],
        [[-1, -1, 1], [-1, 1, 1], [-1, 1, -1], [-1, -1, -1]],
        [[1, 1, -1], [1, -1, -1], [-1, -1, -1], [-1, 1, -1]],
    ];
    let d = Stage::new().modern("<shape type='cube'/>");
    let Geometry::Mesh(mesh) = &d.shapes[0].geometry else {
        panic!()
    };
    let found: Vec<_> = mesh
        .triangles
        .positions()
        .chunks(4)
        .map(|face| face.iter().map(|p| p.as_ivec3().to_array()).collect())
        .collect::<Vec<Vec<_>>>();
    for face in expected {
        assert!(found.contains(&face.to_vec()), "{face:?} in {found:?}");
    }
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let uvs = mesh.uvs.as_ref().unwrap();
    assert!(
        uvs.chunks(4)
            .all(|face| face.iter().map(|uv| uv.to_array()).eq(corners))
    );
}

#[test]
fn groups_are_imported_once_and_placed_often() {
    let d = Stage::new().modern(
        "<shape type='shapegroup' id='g'><shape type='sphere'/><shape type='cube'/></shape>
         <shape type='instance'><ref id='g'/><transform name='to_world'><translate x='3'/></transform></shape>
         <shape type='instance'><ref id='g'/></shape>
         <shape type='disk'/>",
    );
    assert_eq!(d.warnings, [""; 0]);
    let groups: Vec<_> = d.shapes.iter().map(|s| s.group).collect();
    assert_eq!(groups, [Some(0), Some(0), None]);
    assert_eq!((d.groups, d.instances.len()), (1, 2));
    assert_eq!(d.instances[0].1.translation.x, 3.0);
}

#[test]
fn the_same_mesh_is_loaded_once() {
    let stage = Stage::new();
    stage.file("m.obj", "");
    let shape = "<shape type='obj'><string name='filename' value='m.obj'/></shape>";
    let moved = "<shape type='obj'><string name='filename' value='m.obj'/><transform name='to_world'><translate x='1'/></transform></shape>";
    let d = stage.modern(&format!("{shape}{shape}{moved}"));
    let mesh = |i: usize| match &d.shapes[i].geometry {
        Geometry::Mesh(mesh) => std::sync::Arc::as_ptr(mesh),
        Geometry::Analytic(_) => panic!("not a mesh"),
    };
    assert_eq!(mesh(0), mesh(1));
    assert_ne!(mesh(0), mesh(2));
    assert_eq!(d.shapes[0].name, "m.obj");
}

#[test]
fn spectra_mean_what_they_are_used_for() {
    let stage = Stage::new();
    let d = stage.modern(
        "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' value='360:0.5, 830:0.5'/></bsdf>
         <emitter type='area'><spectrum name='radiance' value='360:0.5, 830:0.5'/></emitter></shape>",
    );
    let Material::Diffuse(Diffuse { reflectance }) = material(&d) else {
        panic!()
    };
    assert!((constant(reflectance) - 0.5).abs().max_element() < 1e-3);
    let Emitter::Area { radiance, .. } = &d.emitters[0] else {
        panic!()
    };
    let expected = Rgb::new(0.602_442, 0.474_114, 0.454_633);
    assert!((constant(radiance) - expected).abs().max_element() < 1e-3);
    let d = stage.modern("<emitter type='constant'><spectrum name='radiance' type='d65'><float name='scale' value='2'/></spectrum></emitter>");
    let Emitter::Constant { radiance } = &d.emitters[0] else {
        panic!()
    };
    assert_eq!(*radiance, Rgb::splat(2.0));
}

#[test]
fn reflectances_beyond_1_are_cut_with_a_warning() {
    let d = Stage::new().modern(&on_sphere(
        "<bsdf type='diffuse'><rgb name='reflectance' value='2, .5, -.1'/></bsdf>",
    ));
    let Material::Diffuse(Diffuse { reflectance }) = material(&d) else {
        panic!()
    };
    assert_eq!(constant(reflectance), Rgb::new(1.0, 0.5, 0.0));
    assert_eq!(d.warnings.len(), 1, "{:?}", d.warnings);
}
