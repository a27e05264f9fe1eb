//! Materials of pbrt's version 3 written twice: what they become is what the same would be in
//! Mitsuba's language.

use super::pair::{ball, ball_told};

/// Width of facets that v3 makes of a roughness (its source, `RoughnessToAlpha`).
fn alpha(roughness: f64) -> f64 {
    let x = roughness.ln();
    1.62142 + 0.819955 * x + 0.1734 * x * x + 0.0171201 * x.powi(3) + 0.000640711 * x.powi(4)
}

const INDEX: &str = "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>";

fn rough(roughness: f64) -> String {
    let alpha = alpha(roughness);
    format!("<string name='distribution' value='ggx'/><float name='alpha' value='{alpha}'/>")
}

#[test]
fn exact_materials_of_version_3_agree() {
    ball(
        "matte",
        "<bsdf type='diffuse'><rgb name='reflectance' value='.6 .3 .2'/></bsdf>",
        "Material \"matte\" \"rgb Kd\" [.6 .3 .2]",
    );
    // A deviation of slopes of 20 degrees; Mitsuba's alpha is that times the root of 2.
    let slopes = 20f64.to_radians() * std::f64::consts::SQRT_2;
    ball(
        "rough matte",
        &format!(
            "<bsdf type='roughdiffuse'><rgb name='reflectance' value='.6 .3 .2'/>
             <float name='alpha' value='{slopes}'/><boolean name='useFastApprox' value='true'/></bsdf>"
        ),
        "Material \"matte\" \"rgb Kd\" [.6 .3 .2] \"float sigma\" 20",
    );
    ball(
        "mirror",
        "<bsdf type='conductor'><string name='material' value='none'/>
         <rgb name='specular_reflectance' value='.9 .8 .7'/></bsdf>",
        "Material \"mirror\" \"rgb Kr\" [.9 .8 .7]",
    );
    ball(
        "metal",
        &format!(
            "<bsdf type='roughconductor'><rgb name='eta' value='.2 .9 1.1'/>
             <rgb name='k' value='3.9 2.4 2.1'/>{}</bsdf>",
            rough(0.1)
        ),
        "Material \"metal\" \"rgb eta\" [.2 .9 1.1] \"rgb k\" [3.9 2.4 2.1] \"float roughness\" .1",
    );
    ball(
        "glass",
        &format!(
            "<bsdf type='dielectric'>{INDEX}<rgb name='specular_reflectance' value='.9 .8 .7'/>
             <rgb name='specular_transmittance' value='.7 .8 .9'/></bsdf>"
        ),
        "Material \"glass\" \"rgb Kr\" [.9 .8 .7] \"rgb Kt\" [.7 .8 .9]",
    );
    ball(
        "rough glass",
        &format!("<bsdf type='roughdielectric'>{INDEX}{}</bsdf>", rough(0.2)),
        "Material \"glass\" \"float uroughness\" .2 \"float vroughness\" .2 \"float index\" 1.5",
    );
}

#[test]
fn the_nearest_of_version_3s_coats_agree() {
    let coat = |roughness: f64, diffuse: &str, specular: &str| {
        format!(
            "<bsdf type='roughplastic'>{INDEX}{}<rgb name='diffuse_reflectance' value='{diffuse}'/>
             <rgb name='specular_reflectance' value='{specular}'/></bsdf>",
            rough(roughness)
        )
    };
    ball_told(
        "plastic",
        &coat(0.1, ".6 .3 .2", ".25"),
        "Material \"plastic\" \"rgb Kd\" [.6 .3 .2]",
        &["\"plastic\" is rendered as a coat"],
    );
    ball_told(
        "uber",
        &coat(0.2, ".25", ".8 .7 .6"),
        "Material \"uber\" \"rgb Ks\" [.8 .7 .6] \"float roughness\" .2 \"rgb Kr\" [.1 .1 .1]",
        &["\"Kr\" is left out", "\"uber\" is rendered as a coat"],
    );
    ball_told(
        "substrate",
        &coat(0.1, ".6 .3 .2", ".5"),
        "Material \"substrate\" \"rgb Kd\" [.6 .3 .2]",
        &["\"substrate\" is rendered as a coat"],
    );
    ball_told(
        "translucent",
        "<bsdf type='blendbsdf'><float name='weight' value='.5'/>
         <bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='.48 .48 .48'/></bsdf></bsdf>
         <bsdf type='difftrans'><rgb name='transmittance' value='.64 .32 .16'/></bsdf></bsdf>",
        "Material \"translucent\" \"rgb Kd\" [.8 .8 .8] \"rgb reflect\" [.3 .3 .3] \"rgb transmit\" [.4 .2 .1]",
        &["without its glossy part"],
    );
}
