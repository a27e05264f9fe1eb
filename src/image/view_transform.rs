//! How linear light is shown on an sRGB screen: what PNG and JPEG get.
//!
//! Light has no upper limit and a screen has. [`ViewTransform::Srgb`] cuts off what is brighter than
//! white, the others compress it, each in its own way. `tests/vectors/view_transform.py` makes the
//! values that they are tested against, from Blender's configuration of OpenColorIO.

use super::DisplayView;
use super::curve::linear_to_srgb;
use crate::math::{Mat3, Rgb, Vec3};

/// A way of showing linear light with Rec. 709 primaries.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ViewTransform {
    /// As it is, cut off at 1: colours below white are exact.
    #[default]
    Srgb,
    /// Khronos PBR Neutral: base colours under white light come out as they are, highlights are
    /// compressed and lose their colour.
    Neutral,
    /// AgX (Troy Sobotka, Eary Chow): 16.5 stops, bright colours go towards white as on film.
    Agx,
    /// The curve of John Hable, *Uncharted 2: HDR Lighting*, GDC 2010, white at 11.2.
    Filmic,
    /// The numbers themselves, cut off at 0 and 1, without the sRGB curve.
    Raw,
    /// A view of an OpenColorIO configuration.
    Display(DisplayView),
}

/// Light above this looks no different, and infinity has no ratio.
const BRIGHTEST: f32 = 1e10;

impl ViewTransform {
    /// Turns linear light into what to store, 0 to 1. A channel that is no number stays none:
    /// hiding it would hide a bug.
    ///
    /// # Errors
    /// What OpenColorIO says of a [`Self::Display`].
    pub fn apply(&self, pixels: &mut [[f32; 3]]) -> Result<(), String> {
        let unknown: Vec<[bool; 3]> = pixels.iter().map(|p| p.map(f32::is_nan)).collect();
        for x in pixels.as_flattened_mut() {
            *x = if x.is_nan() {
                0.0
            } else {
                x.clamp(0.0, BRIGHTEST)
            };
        }
        match self {
            Self::Raw => {}
            Self::Srgb => each(pixels, encoded),
            Self::Neutral => each(pixels, |light| encoded(neutral(light))),
            Self::Agx => each(pixels, |light| encoded(agx(light))),
            Self::Filmic => each(pixels, |light| encoded(filmic(light))),
            Self::Display(view) => view.apply(pixels)?,
        }
        let unknown = unknown.as_flattened();
        for (x, unknown) in pixels.as_flattened_mut().iter_mut().zip(unknown) {
            *x = if *unknown {
                f32::NAN
            } else {
                x.clamp(0.0, 1.0)
            };
        }
        Ok(())
    }
}

fn each(pixels: &mut [[f32; 3]], shown: impl Fn(Rgb) -> Rgb) {
    for pixel in pixels {
        *pixel = shown(Rgb::from_array(*pixel)).to_array();
    }
}

/// By the sRGB curve.
fn encoded(linear: Rgb) -> Rgb {
    linear.map(linear_to_srgb)
}

/// The specification's function (github.com/KhronosGroup/ToneMapping, `PBR_Neutral`): takes off the
/// 4 % that a dielectric reflects, and compresses what is brighter than `START`.
fn neutral(light: Rgb) -> Rgb {
    const FRESNEL: f32 = 0.04;
    const START: f32 = 0.8 - FRESNEL;
    const DESATURATION: f32 = 0.15;
    let least = light.min_element();
    let offset = match least < 2.0 * FRESNEL {
        true => least - least * least / (4.0 * FRESNEL),
        false => FRESNEL,
    };
    let light = light - offset;
    let peak = light.max_element();
    if peak < START {
        return light;
    }
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let grey = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    (light * (compressed / peak)).lerp(Rgb::splat(compressed), grey)
}

/// Rows of the matrices from Rec. 709 to Rec. 2020 and back (ITU-R BT.2087), and of AgX's inset,
/// which makes primaries less pure before the curve, and outset, which brings some of that back.
const TO_2020: [[f32; 3]; 3] = [
    [0.6274, 0.3293, 0.0433],
    [0.0691, 0.9195, 0.0113],
    [0.0164, 0.0880, 0.8956],
];
const FROM_2020: [[f32; 3]; 3] = [
    [1.6605, -0.5876, -0.0728],
    [-0.1246, 1.1329, -0.0083],
    [-0.0182, -0.1006, 1.1187],
];
const INSET: [[f32; 3]; 3] = [
    [0.856_627_15, 0.095_121_24, 0.048_251_606],
    [0.137_318_97, 0.761_242, 0.101_439_04],
    [0.111_898_21, 0.076_799_42, 0.811_302_37],
];
const OUTSET: [[f32; 3]; 3] = [
    [1.127_100_6, -0.110_606_64, -0.016_493_939],
    [-0.141_329_76, 1.157_823_7, -0.016_493_939],
    [-0.141_329_76, -0.110_606_64, 1.251_936_4],
];

fn multiplied(rows: &[[f32; 3]; 3], v: Vec3) -> Vec3 {
    Mat3::from_cols_array_2d(rows).transpose() * v
}

/// AgX: inset, the logarithm of 16.5 stops, a sigmoid through middle grey, outset. It lacks the part
/// of Blender's table that turns hues back and fits the gamut: colours differ by up to 0.035, greys
/// by less than 0.001.
fn agx(light: Rgb) -> Rgb {
    const STOPS: [f32; 2] = [-12.473_93, 4.026_069];
    const DISPLAY: f32 = 2.4;
    let inset = multiplied(&INSET, multiplied(&TO_2020, light));
    let curved = inset.max(Vec3::splat(1e-10)).to_array().map(|x| {
        let stops = x.log2().clamp(STOPS[0], STOPS[1]);
        sigmoid((stops - STOPS[0]) / (STOPS[1] - STOPS[0])).powf(DISPLAY)
    });
    multiplied(&FROM_2020, multiplied(&OUTSET, Vec3::from_array(curved)))
}

/// Two hyperbolas that meet at middle grey with the same slope, and end at (0, 0) and (1, 1)
/// (github.com/sobotka/SB2383-Configuration-Generation, `AgX.py`).
fn sigmoid(x: f32) -> f32 {
    const POWER: f32 = 1.5;
    const SLOPE: f32 = 2.4;
    // Middle grey: 10 of 16.5 stops above the darkest, 0.18 on a screen of gamma 2.4.
    const PIVOT: [f32; 2] = [10.0 / 16.5, 0.489_437_1];
    // Sizes of the hyperbolas, by which they end where they should (a test asks for it).
    const TOE: f32 = -0.565_676;
    const SHOULDER: f32 = 0.715_198;
    let side = if x < PIVOT[0] { TOE } else { SHOULDER };
    let t = SLOPE * (x - PIVOT[0]) / side;
    let y = side * t / (1.0 + t.powf(POWER)).powf(1.0 / POWER) + PIVOT[1];
    y.max(0.0)
}

/// Hable's curve of each channel, with his exposure of 2, over its value at white.
fn filmic(light: Rgb) -> Rgb {
    const WHITE: f32 = 11.2;
    const EXPOSURE: f32 = 2.0;
    let curve = |x: f32| {
        let (a, b, c, d, e, f) = (0.15, 0.5, 0.1, 0.2, 0.02, 0.3);
        (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
    };
    let shown = light.to_array().map(|x| curve(EXPOSURE * x) / curve(WHITE));
    Rgb::from_array(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(view: &ViewTransform, light: Rgb) -> [f32; 3] {
        let mut pixels = [light.to_array()];
        view.apply(&mut pixels).unwrap();
        pixels[0]
    }

    const ALL: [ViewTransform; 5] = [
        ViewTransform::Srgb,
        ViewTransform::Neutral,
        ViewTransform::Agx,
        ViewTransform::Filmic,
        ViewTransform::Raw,
    ];

    #[test]
    fn views_show_what_blender_shows() {
        let text = include_str!("../../tests/vectors/view_transform.json");
        let vectors: serde_json::Value = serde_json::from_str(text).unwrap();
        let rgb = |value: &serde_json::Value| {
            let of = |i: usize| value[i].as_f64().unwrap() as f32;
            Rgb::new(of(0), of(1), of(2))
        };
        // Blender reads the last two from tables: of grey 0.5, where the specification says 0.46,
        // it shows 0.4630, and where compression begins 0.8823 instead of 0.8860.
        for (name, view, greys, colours) in [
            ("Standard", ViewTransform::Srgb, 1e-3, 1e-3),
            ("Raw", ViewTransform::Raw, 1e-3, 1e-3),
            ("Khronos PBR Neutral", ViewTransform::Neutral, 5e-3, 1e-2),
            ("AgX", ViewTransform::Agx, 1e-3, 0.035),
        ] {
            let pairs = vectors[name].as_array().unwrap();
            assert!(pairs.len() > 10);
            for pair in pairs {
                let (light, theirs) = (rgb(&pair[0]), rgb(&pair[1]).min(Rgb::ONE));
                let ours = Rgb::from_array(shown(&view, light));
                let grey = light.min_element() == light.max_element();
                let bound = if grey { greys } else { colours };
                let error = (ours - theirs).abs().max_element();
                assert!(error < bound, "{name}: {light}: {ours}, not {theirs}");
            }
        }
    }

    #[test]
    fn the_neutral_view_has_the_values_of_its_specification() {
        // Below 0.8 the offset alone; white is 1 - 0.24^2 / (0.96 + 0.24 - 0.76).
        for (light, shown) in [(0.5, 0.46), (0.04, 0.01), (1.0, 0.869_090_9)] {
            let error = (neutral(Rgb::splat(light)).x - shown).abs();
            assert!(error < 1e-6, "{light}: {error}");
        }
        // Less 0.04 the peak is 4.96, compressed 0.987 03; 0.373 41 of that takes the colour's place.
        let shown = neutral(Rgb::new(5.0, 0.2, 0.1));
        let expected = Rgb::new(0.987_027, 0.388_519, 0.376_049);
        assert!((shown - expected).abs().max_element() < 1e-5, "{shown}");
    }

    #[test]
    fn the_sigmoid_begins_and_ends_at_the_ends_of_its_range() {
        assert!(sigmoid(0.0) < 1e-5 && (sigmoid(1.0) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn hables_curve_has_the_values_of_his_formula() {
        // 0.18 twice over: (0.36 * 0.104 + 0.004) / (0.36 * 0.554 + 0.06) - 1 / 15 = 0.093 06, over
        // the 0.725 13 of white.
        let shown = filmic(Rgb::splat(0.18)).x;
        assert!((shown - 0.093_06 / 0.725_13).abs() < 1e-4, "{shown}");
        assert!((filmic(Rgb::splat(5.6)).x - 1.0).abs() < 1e-6);
    }

    #[test]
    fn brighter_light_is_never_darker_and_no_number_is_lost() {
        for view in ALL {
            let mut last = 0.0;
            for i in 0..2000 {
                let x = (i as f32 * 0.02 - 20.0).exp2();
                let shown = shown(&view, Rgb::splat(x))[1];
                assert!(
                    (0.0..=1.0).contains(&shown) && shown >= last - 1e-6,
                    "{view:?} {x}"
                );
                last = shown;
            }
            for x in [
                f32::INFINITY,
                f32::MAX,
                -1.0,
                f32::NEG_INFINITY,
                f32::MIN_POSITIVE,
            ] {
                let shown = shown(&view, Rgb::new(x, 0.2, 1.0));
                assert!(
                    shown.iter().all(|v| (0.0..=1.0).contains(v)),
                    "{view:?} {x}: {shown:?}"
                );
            }
            let unknown = shown(&view, Rgb::new(f32::NAN, 0.0, 0.0));
            assert!(unknown[0].is_nan() && unknown[1] < 0.001);
        }
    }
}
