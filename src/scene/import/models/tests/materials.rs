//! What MTL files mean.

use super::*;
use crate::bsdf::Material;
use crate::bsdf::material::Dielectric;
use crate::math::Vec2;
use crate::texture::SurfacePoint;

/// A square with texture coordinates, of material m.
const SQUARE: &str = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// The parts of a square whose material is what the lines of `mtl` say.
fn square(folder: &Folder, mtl: &str) -> Parts {
    folder.write("square.obj", SQUARE);
    folder.write("m.mtl", format!("newmtl m\n{mtl}"));
    folder.load(&["square.obj"], None).unwrap()
}

fn material(parts: &Parts) -> &Material {
    parts.materials.get(parts.shapes[0].material)
}

/// The colour of the square in its middle.
fn in_the_middle(parts: &Parts) -> Rgb {
    let uvs = mesh(parts, 0).uvs.as_ref().unwrap();
    let middle = uvs.iter().copied().sum::<Vec2>() / uvs.len() as f32;
    let texture = reflectance(parts, parts.shapes[0].material);
    texture.eval(&SurfacePoint::at_uv(middle))
}

#[test]
fn images_are_scaled_and_moved_with_v_upwards() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    for (options, color) in [
        ("-s 0.5 0.5 1 -o 0.5 0.5 0", Rgb::Y),
        ("-o 0 0.5 -s 0.5 0.5", Rgb::X),
        ("-s 0.5 0.5 1", Rgb::Z),
        ("-s 0.5 0.5 -o 0.5", Rgb::ONE),
        // The middle once more, a quarter to the right and up, and beyond the edge.
        ("-o 0.25 0.25", Rgb::Y),
        ("-o -0.25 0.25", Rgb::X),
        ("-s 1 -1 1 -o 0.25 1.25", Rgb::Y),
        ("-o 0.25 1.25 -clamp on", Rgb::Y),
    ] {
        let parts = square(
            &folder,
            &format!("Kd 1 1 1\nKs 0 0 0\nmap_Kd {options} q.exr\n"),
        );
        assert_eq!(*parts.warnings, [""; 0]);
        assert_eq!(in_the_middle(&parts), color, "{options}");
    }
}

#[test]
fn an_alpha_below_one_is_opacity_unless_a_colour_is_let_through() {
    let folder = Folder::new();
    let base = "Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nNs 250\nNi 1.45\n";
    for (more, opacity) in [
        ("d 0.5\nillum 9\n", 0.5),
        ("d 0.25\nillum 6\n", 0.25),
        ("Tr 0.25\nillum 4\n", 0.75),
        ("d 0.5\nillum 2\n", 0.5),
    ] {
        let parts = square(&folder, &format!("{base}{more}"));
        let Material::Mask { opacity: o, inner } = material(&parts) else {
            panic!("{more}: {parts:?}")
        };
        assert_eq!(o.constant(), Some(Rgb::splat(opacity)), "{more}");
        let inner = parts.materials.get(*inner);
        assert!(matches!(inner, Material::TwoSided { .. }), "{more}");
    }
    for more in [
        "illum 9\n",
        "d 1\nillum 4\n",
        "Tr 0\nillum 7\n",
        "illum 6\nTf 1 1 1\n",
    ] {
        let parts = square(&folder, &format!("{base}{more}"));
        let glass = matches!(
            material(&parts),
            Material::Dielectric(Dielectric { eta: 1.45, .. })
        );
        assert!(glass, "{more}: {parts:?}");
    }
    let parts = square(&folder, "illum 9\nd 0.5\nTf 0.5 1 1\n");
    let Material::Mask { inner, .. } = material(&parts) else {
        panic!("{parts:?}")
    };
    let inner = parts.materials.get(*inner);
    assert!(matches!(inner, Material::Dielectric(_)), "{inner:?}");
}

#[test]
fn a_map_of_bumps_counts_where_it_holds_normals() {
    let folder = Folder::new();
    folder.quarters("heights.exr");
    let normals = crate::image::Image::from_rgb(1, 1, &[Rgb::new(0.6, 0.5, 0.98)]);
    let path = folder.0.path().join("normals.exr");
    crate::image::write(&path, &normals, &Default::default()).unwrap();
    let of = |mtl: &str| {
        let parts = square(&folder, &format!("Kd 1 1 1\nPr 0.5\n{mtl}\n"));
        let Material::TwoSided { front, .. } = material(&parts) else {
            panic!("{parts:?}")
        };
        let mapped = matches!(parts.materials.get(*front), Material::NormalMap { .. });
        (mapped, parts.warnings.join("\n"))
    };
    let (mapped, told) = of("map_Bump -bm 1.000000 normals.exr");
    assert!(mapped && told.contains("holds normals"), "{told}");
    let (mapped, told) = of("bump heights.exr");
    assert!(!mapped && told.contains("holds heights"), "{told}");
    // `norm` says it by itself; a path of another machine leads to the file beside.
    let (mapped, told) = of("norm C:\\textures\\normals.exr\nmap_Bump heights.exr");
    assert!(
        mapped && told.contains("for `C:\\textures\\normals.exr` stands"),
        "{told}"
    );
    assert!(!told.contains("heights"), "{told}");
}

#[test]
fn a_colour_let_through_beside_physical_statements_is_glass() {
    let folder = Folder::new();
    // As Blender writes a principled material of transmission 1.
    let blender = "Kd 0.8 0.8 0.8\nNi 1.45\nd 1\nillum 2\nPr 0\nPm 0\nTf 1 1 1\n";
    let parts = square(&folder, blender);
    assert!(
        matches!(material(&parts), Material::Dielectric(_)),
        "{parts:?}"
    );
    assert!(
        parts.warnings[0].contains("taken as glass"),
        "{:?}",
        parts.warnings
    );
    // As 3ds Max writes whatever is opaque.
    let parts = square(&folder, "Kd 0.8 0.8 0.8\nNs 10\nd 1\nillum 2\nTf 1 1 1\n");
    assert!(
        matches!(material(&parts), Material::TwoSided { .. }),
        "{parts:?}"
    );
}

#[test]
fn what_a_material_has_no_place_for_is_told() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    for (mtl, word) in [
        ("illum 4\nmap_Kd q.exr\n", "`map_kd` is left out"),
        ("illum 4\nNi 0.9\n", "1.5 instead"),
        ("Ks 1 0.5 0.1\n", "its luminance counts"),
        ("d 0\n", "cannot be seen"),
        ("Ke 0 0 0\nmap_Ke q.exr\n", "no effect"),
        ("Pr 0.5\nanisor 0.25\n", "anisor"),
    ] {
        let parts = square(&folder, mtl);
        let told = parts.warnings.join("\n");
        assert!(
            told.contains("m.mtl:1: material \"m\"") && told.contains(word),
            "{mtl}: {told}"
        );
    }
}

#[test]
fn the_extension_reaches_the_model_and_an_image_alone_glows() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    let parts = square(
        &folder,
        "Kd 0.5\nPr 0.25\nPs 0.5\nPc 1\nPcr 0.25\naniso 0.75\n",
    );
    let Material::TwoSided { front, .. } = material(&parts) else {
        panic!("{parts:?}")
    };
    let Material::Principled(p) = parts.materials.get(*front) else {
        panic!("{parts:?}")
    };
    let values = [
        &p.roughness,
        &p.sheen,
        &p.clearcoat,
        &p.clearcoat_gloss,
        &p.anisotropic,
    ];
    let values = values.map(|t| t.constant().unwrap().x);
    assert_eq!(values, [0.25, 0.5, 1.0, 0.75, 0.75]);
    let parts = square(&folder, "Kd 0.5\nmap_Ke -s 0.5 0.5 -o 0.5 0.5 q.exr\n");
    let Emitter::Area { radiance, .. } = &parts.emitters[0] else {
        panic!("{parts:?}")
    };
    let middle = SurfacePoint::at_uv(Vec2::splat(0.5));
    assert_eq!(radiance.eval(&middle), Rgb::Y);
}

#[test]
fn libraries_are_found_by_odd_names_and_missed_with_a_hint() {
    let folder = Folder::new();
    std::fs::create_dir(folder.0.path().join("sub")).unwrap();
    folder.write(
        "sub/red.mtl",
        "\u{feff}newmtl red\r\nKd 0.8 0.1 0.1\r\nillum 1\r\n",
    );
    folder.write("lamp one.mtl", "newmtl lamp\nKe 5 4 3\n");
    for name in [
        "sub/red.mtl lamp one.mtl",
        "sub\\red.mtl lamp one.mtl",
        "\"sub\\red.mtl\"\nmtllib \"lamp one.mtl\"",
        "lamp one.mtl sub\\red.mtl # two",
    ] {
        folder.write("a.obj", OBJ.replace("two.mtl", name));
        let parts = folder.load(&["a.obj"], None).unwrap();
        assert_eq!(*parts.warnings, [""; 0], "{name}");
        let red = reflectance(&parts, parts.shapes[0].material).constant();
        assert_eq!(red, Some(Rgb::new(0.8, 0.1, 0.1)));
        assert_eq!(parts.emitters.len(), 1);
    }
    for (name, hint) in [
        ("sub/RED.mtl", "sub/red.mtl (capital"),
        ("x/TWO.MTL", "two.mtl"),
    ] {
        folder.write("a.obj", OBJ.replace("two.mtl", name));
        let told = folder.load(&["a.obj"], None).unwrap().warnings;
        assert!(told[0].contains(hint), "{told:?}");
    }
    folder.write("two.obj", OBJ.replace("mtllib two.mtl\n", ""));
    let told = folder.load(&["two.obj"], None).unwrap().warnings;
    assert!(
        told[0].contains("mtllib") && told[0].contains("two.mtl is there"),
        "{told:?}"
    );
}

#[test]
fn an_image_that_is_missing_is_an_error_with_a_hint() {
    let folder = Folder::new();
    folder.quarters("Wood.exr");
    folder.write("square.obj", SQUARE);
    for name in ["wood.exr", "models\\WOOD.exr", "absent/wood.exr"] {
        folder.write("m.mtl", format!("newmtl m\nmap_Kd {name}\n"));
        let error = folder.load(&["square.obj"], None).unwrap_err().to_string();
        assert!(
            error.contains("there is") && error.contains("Wood.exr"),
            "{error}"
        );
    }
}

#[test]
fn files_without_an_end_are_refused_wherever_they_are_named() {
    let folder = Folder::new();
    folder.write("square.obj", SQUARE.replace("m.mtl", "/dev/zero"));
    let parts = folder.load(&["square.obj"], None).unwrap();
    assert!(
        parts.warnings[0].contains("a device, not a regular file"),
        "{parts:?}"
    );
    let pipe = folder.0.path().join("pipe.obj");
    rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, rustix::fs::Mode::RWXU).unwrap();
    for (name, mtl) in [
        ("pipe.obj", ""),
        ("square.obj", "newmtl m\nmap_Kd pipe.obj\n"),
    ] {
        folder.write("square.obj", SQUARE);
        folder.write("m.mtl", mtl);
        let error = folder.load(&[name], None).unwrap_err().to_string();
        assert!(error.contains("a pipe, not a regular file"), "{error}");
    }
}
