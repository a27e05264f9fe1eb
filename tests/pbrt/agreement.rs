//! Scenes written twice: what both importers make of them looks the same. Lights that show images are
//! in [`super::agreement_images`], v3's materials in [`super::agreement_v3`].

use super::pair::{
    CAMERA, SENSOR, SKY, ball, compare, compare_within, lit, lit_within, mitsuba, pbrt,
};

#[test]
fn opaque_materials_agree() {
    ball(
        "diffuse",
        "<bsdf type='diffuse'><rgb name='reflectance' value='.7 .4 .1'/></bsdf>",
        "Material \"diffuse\" \"rgb reflectance\" [.7 .4 .1]",
    );
    ball(
        "default",
        "<bsdf type='diffuse'><rgb name='reflectance' value='.5'/></bsdf>",
        "",
    );
    ball(
        "conductor",
        "<bsdf type='conductor'><rgb name='eta' value='.133 .3996 1.583'/><rgb name='k' value='7.137 2.321 1.724'/></bsdf>",
        "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"",
    );
    // alpha is the root of the roughness.
    ball(
        "rough conductor",
        "<bsdf type='roughconductor'><rgb name='eta' value='.2243 .9777 1.214'/><rgb name='k' value='4.308 2.623 2.369'/><string name='distribution' value='ggx'/>
         <float name='alpha_u' value='.3'/><float name='alpha_v' value='.5'/></bsdf>",
        "Material \"conductor\" \"float uroughness\" .09 \"float vroughness\" .25",
    );
    ball(
        "roughness as it is",
        "<bsdf type='roughconductor'><rgb name='eta' value='.2243 .9777 1.214'/><rgb name='k' value='4.308 2.623 2.369'/><string name='distribution' value='ggx'/>
         <float name='alpha' value='.3'/></bsdf>",
        "Material \"conductor\" \"float roughness\" .3 \"bool remaproughness\" false",
    );
    ball(
        "coated diffuse",
        "<bsdf type='roughplastic'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>
         <string name='distribution' value='ggx'/><float name='alpha' value='.2'/><boolean name='nonlinear' value='true'/>
         <rgb name='diffuse_reflectance' value='.6 .3 .2'/></bsdf>",
        "Material \"coateddiffuse\" \"rgb reflectance\" [.6 .3 .2] \"float roughness\" .04 \
         \"float thickness\" 0",
    );
}

#[test]
fn clear_materials_agree() {
    let iors = "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>";
    ball(
        "dielectric",
        &format!("<bsdf type='dielectric'>{iors}</bsdf>"),
        "Material \"dielectric\"",
    );
    ball(
        "rough dielectric",
        &format!(
            "<bsdf type='roughdielectric'>{iors}<string name='distribution' value='ggx'/><float \
             name='alpha' value='.3'/></bsdf>"
        ),
        "Material \"dielectric\" \"float roughness\" .09 \"float eta\" 1.5",
    );
    ball(
        "thin dielectric",
        &format!("<bsdf type='thindielectric'>{iors}</bsdf>"),
        "Material \"thindielectric\"",
    );
    ball(
        "diffuse transmission",
        "<bsdf type='blendbsdf'><float name='weight' value='.5'/>
         <bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='.6 .4 .2'/></bsdf></bsdf>
         <bsdf type='difftrans'><rgb name='transmittance' value='.2 .4 .6'/></bsdf></bsdf>",
        "Material \"diffusetransmission\" \"rgb reflectance\" [.3 .2 .1] \"rgb transmittance\" \
         [.1 .2 .3]",
    );
    ball(
        "mix",
        "<bsdf type='blendbsdf'><float name='weight' value='.3'/>
         <bsdf type='diffuse'><rgb name='reflectance' value='.9 .1 .1'/></bsdf>
         <bsdf type='diffuse'><rgb name='reflectance' value='.1 .1 .9'/></bsdf></bsdf>",
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [.9 .1 .1]
         MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [.1 .1 .9]
         MakeNamedMaterial \"c\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .3
         NamedMaterial \"c\"",
    );
    for tables in ["isotropic", "anisotropic"] {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/measured");
        let file = format!("\"filename\" \"{folder}/{tables}.bsdf\"");
        let xml = format!("<string name='filename' value='{folder}/{tables}.bsdf'/>");
        ball(
            "measured",
            &format!("<bsdf type='twosided'><bsdf type='measured'>{xml}</bsdf></bsdf>"),
            &format!(
                "Material \"measured\" {}",
                file.replacen('"', "\"string ", 1)
            ),
        );
    }
    ball(
        "alpha",
        "<bsdf type='mask'><float name='opacity' value='.4'/><bsdf type='twosided'><bsdf \
         type='diffuse'/></bsdf></bsdf>",
        "Shape \"sphere\" \"float alpha\" .4 Translate 0 -100 0",
    );
}

#[test]
fn lights_agree() {
    lit("sky and point", SKY[0], SKY[1]);
    lit(
        "directional",
        "<emitter type='directional'><vector name='direction' x='1' y='-2' z='-1'/><rgb \
         name='irradiance' value='3 2 1'/></emitter>",
        "LightSource \"distant\" \"point3 from\" [0 0 0] \"point3 to\" [1 -2 -1] \"rgb L\" [3 2 1]",
    );
    // Without a falloff both are the same.
    lit(
        "spot",
        "<emitter type='spot'><transform name='to_world'><lookat origin='2 3 2' target='0 0 0' up='0 1 0'/></transform>
         <float name='cutoff_angle' value='15'/><float name='beam_width' value='15'/><rgb name='intensity' value='30 20 10'/></emitter>",
        "LightSource \"spot\" \"point3 from\" [2 3 2] \"point3 to\" [0 0 0] \"float coneangle\" 15
         \"float conedeltaangle\" 0 \"rgb I\" [30 20 10]",
    );
    lit(
        "lamp",
        "<shape type='sphere'><point name='center' x='2' y='3' z='1'/><float name='radius' value='.3'/>
         <bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='20 15 10'/></emitter></shape>",
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [2 1.5 1] \"float scale\" 10
         Translate 2 3 1 Shape \"sphere\" \"float radius\" .3 AttributeEnd",
    );
    // A square of 2 by 2 that faces down. pbrt gives each of the two triangles the whole power:
    // 2 * pi * 10 over an area of 4 is a radiance of 5.
    lit_within(
        "lamp of triangles by its power",
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate y='3'/></transform>
         <bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>",
        "AttributeBegin AreaLightSource \"diffuse\" \"float power\" 31.415927 ReverseOrientation
         Shape \"trianglemesh\" \"point3 P\" [-1 3 -1 -1 3 1 1 3 1 1 3 -1] \"integer indices\" [0 1 2 0 2 3]
         AttributeEnd",
        (1024, 1e-2),
    );
    // Illuminance pi of a sky is radiance 1; a point of 4 pi has intensity 1.
    lit(
        "lights by their power",
        "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>
         <emitter type='point'><point name='position' x='2' y='3' z='2'/><rgb name='intensity' value='10'/></emitter>",
        "LightSource \"infinite\" \"float illuminance\" 3.14159265
         AttributeBegin Translate 2 3 2 LightSource \"point\" \"float power\" 125.66371 AttributeEnd",
    );
}

fn seen(name: &str, sensor: &str, camera: &str) {
    let film = "<film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/><rfilter type='box'/></film>
        <sampler type='independent'/></sensor>";
    let ball = "<shape type='sphere'><bsdf type='diffuse'/></shape>";
    let xml = mitsuba(&format!("{sensor}{film}"), &format!("{}{ball}", SKY[0]));
    let text = pbrt(camera, &format!("{} Shape \"sphere\"", SKY[1]));
    compare(name, &xml, &text, &[]);
}

#[test]
fn cameras_agree() {
    let place =
        "<transform name='to_world'><lookat origin='1 2 5' target='0 0 0' up='0 1 0'/></transform>";
    let view = "Scale -1 1 1 LookAt 1 2 5 0 0 0 0 1 0";
    seen(
        "lens",
        &format!(
            "<sensor type='thinlens'>{place}<float name='fov' value='30'/><float \
             name='aperture_radius' value='.2'/><float name='focus_distance' value='4'/>"
        ),
        &format!(
            "{view} Camera \"perspective\" \"float fov\" 30 \"float lensradius\" .2 \"float \
             focaldistance\" 4"
        ),
    );
    seen(
        "orthographic",
        "<sensor type='orthographic'><transform name='to_world'><scale x='2' y='2'/><lookat \
         origin='1 2 5' target='0 0 0' up='0 1 0'/></transform>",
        &format!("{view} Camera \"orthographic\" \"float screenwindow\" [-2 2 -2 2]"),
    );
    // The middle of Mitsuba's panorama is ahead, pbrt's begins at the right: a quarter turn.
    seen(
        "spherical",
        "<sensor type='spherical'><transform name='to_world'><lookat origin='1 2 5' target='0 0 \
         0' up='0 1 0'/></transform>",
        "Rotate -90 0 1 0 LookAt 1 2 5 0 0 0 0 1 0 Camera \"spherical\" \"string mapping\" \
         \"equirectangular\"",
    );
    // A window that is a half of the picture shows what half the tangent does.
    let half = (2.0 * (20f64.to_radians().tan() / 2.0).atan().to_degrees()).to_string();
    seen(
        "screen window",
        &format!("<sensor type='perspective'>{place}<float name='fov' value='{half}'/>"),
        &format!(
            "{view} Camera \"perspective\" \"float fov\" 40 \"float screenwindow\" [-.5 .5 -.5 .5]"
        ),
    );
    seen(
        "shifted window",
        &format!(
            "<sensor type='perspective'>{place}<float name='fov' value='40'/><float \
             name='principal_point_offset_x' value='.1'/><float name='principal_point_offset_y' \
                value='-.2'/>"
        ),
        &format!(
            "{view} Camera \"perspective\" \"float fov\" 40 \"float screenwindow\" [-.8 1.2 -.6 \
             1.4]"
        ),
    );
}

#[test]
fn shapes_and_instances_agree() {
    let wide = "<shape type='shapegroup' id='g'><shape type='cylinder'><point name='p0' x='0' y='0' z='-1'/><point name='p1' x='0' y='0' z='1'/>
        <float name='radius' value='.5'/><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape></shape>
        <shape type='instance'><ref id='g'/><transform name='to_world'><rotate y='1' angle='50'/><translate x='-1'/></transform></shape>
        <shape type='instance'><ref id='g'/><transform name='to_world'><scale x='-1' y='1' z='1'/><rotate y='1' angle='50'/><translate x='1'/></transform></shape>
        <shape type='disk'><transform name='to_world'><scale value='.7'/><translate z='1'/></transform><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape>";
    let text = "ObjectBegin \"g\" Shape \"cylinder\" \"float radius\" .5 ObjectEnd
        AttributeBegin Translate -1 0 0 Rotate 50 0 1 0 ObjectInstance \"g\" AttributeEnd
        AttributeBegin Translate 1 0 0 Rotate 50 0 1 0 Scale -1 1 1 ObjectInstance \"g\" AttributeEnd
        Shape \"disk\" \"float radius\" .7 \"float height\" 1";
    let xml = mitsuba(SENSOR, &format!("{}{wide}", SKY[0]));
    compare(
        "instances",
        &xml,
        &pbrt(CAMERA, &format!("{} {text}", SKY[1])),
        &[],
    );
    // A sphere in two parts of triangles is nearly the whole one.
    let ball = "<shape type='sphere'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape>";
    let xml = mitsuba(SENSOR, &format!("{}{ball}", SKY[0]));
    let parts = "Shape \"sphere\" \"float zmin\" -.3 Shape \"sphere\" \"float zmax\" -.3 \"float phimax\" 180
        Rotate 180 0 0 1 Shape \"sphere\" \"float zmax\" -.3 \"float phimax\" 180";
    let text = pbrt(CAMERA, &format!("{} {parts}", SKY[1]));
    compare_within("parts", &xml, &text, &["part of a sphere"; 3], (64, 2e-2));
}

#[test]
fn media_agree() {
    let fog = "<shape type='sphere'><float name='radius' value='1.2'/><bsdf type='null'/><medium name='interior' type='homogeneous'>
        <rgb name='sigma_t' value='1.2 .9 .7'/><rgb name='albedo' value='.8333333 .7777778 .5714286'/>
        <phase type='hg'><float name='g' value='.4'/></phase></medium></shape>";
    let text = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .1 .15] \"rgb sigma_s\" [.5 .35 .2]
        \"float scale\" 2 \"float g\" .4
        MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\" \"float radius\" 1.2";
    let xml = mitsuba(SENSOR, &format!("{}{fog}", SKY[0]));
    compare(
        "fog",
        &xml,
        &pbrt(CAMERA, &format!("{} {text}", SKY[1])),
        &[],
    );
}
