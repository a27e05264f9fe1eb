//! Colours: triples, temperatures, curves and names of curves, in linear sRGB.
//!
//! pbrt scales every light so that its own spectrum has luminance 1 ("SpectrumToPhotometric" in its
//! source) before the scale that the scene gives. Of an RGB triple that spectrum is the white of
//! the colour space, so the triple itself comes out in the picture; a curve or a temperature comes
//! out with luminance 1.

use super::color_space::of_chromaticity;
use super::importer::{Importer, Role};
use super::named_spectra::{D_LINE, GLASSES, ILLUMINANTS, metal};
use super::parameter::{Kind, Parameter, Values};
use super::params::Params;
use crate::math::{Rgb, luminance};
use crate::scene::import::spectrum::{self, Weighting};
use crate::scene::import::{named, numbers};

/// Every kind that can stand for a colour.
pub(super) const COLORS: &[Kind] = &[Kind::Rgb, Kind::Xyz, Kind::Blackbody, Kind::Spectrum];

/// A colour before it is known what it is for.
enum Color {
    Rgb(Rgb),
    /// Luminance 1, of light; white as a factor.
    Light(Rgb),
    /// Planck's law at kelvin.
    Blackbody(f64),
    /// A curve over the wavelength.
    Curve(Vec<(f64, f64)>),
    /// A value per channel as it is: eta and k of metals.
    Channels(Rgb),
    /// The same at all wavelengths.
    Uniform(f64),
}

impl<'s> Importer<'s> {
    /// A factor or an index, if it is given as a colour; one number stands for all channels.
    pub fn factor_of(
        &mut self,
        p: &Params<'_, 's>,
        given: &'s Parameter,
        role: Role,
    ) -> Option<Rgb> {
        let space = p.definition.color_space;
        let color = match self.color(p, given)? {
            Color::Rgb(rgb) => space.factor(rgb),
            Color::Light(_) => Rgb::ONE,
            Color::Channels(rgb) => rgb,
            Color::Uniform(value) => Rgb::splat(value as f32),
            Color::Curve(curve) => spectrum::sampled(Weighting::Reflectance, &curve),
            Color::Blackbody(_) => {
                let message = format!("\"{}\" cannot be a temperature", given.name);
                self.source
                    .fault(given.at, message, "the default takes its place");
                return None;
            }
        };
        Some(self.bounded(color, role, given))
    }

    /// A colour cut to the range of its role, with a warning where it leaves that.
    fn bounded(&mut self, color: Rgb, role: Role, given: &Parameter) -> Rgb {
        let most = match role {
            Role::Reflectance => 1.0,
            Role::Unbounded | Role::Number => f32::MAX,
        };
        let cut = color.clamp(Rgb::ZERO, Rgb::splat(most));
        // What rounding and narrow gamuts leave outside is cut without a word.
        if (cut - color).abs().max_element() > 0.01 {
            let name = &given.name;
            self.warn_at(
                given.at,
                &format!("\"{name}\" is {color}; it was cut to {cut}"),
            );
        }
        cut
    }

    /// Light: its colour with the scale that pbrt gives it, see the head of this file. White of the
    /// colour space by default.
    pub fn light(&mut self, p: &Params<'_, 's>, name: &'static str) -> Rgb {
        let space = p.definition.color_space;
        let white = space.light(Rgb::ONE);
        let Some(given) = p.find(name, &[COLORS, &[Kind::Float]].concat()) else {
            return white;
        };
        let Some(color) = self.color(p, given) else {
            return white;
        };
        let color = match color {
            Color::Rgb(rgb) => space.light(rgb),
            Color::Light(rgb) | Color::Channels(rgb) => normalized(rgb),
            Color::Uniform(_) => normalized(spectrum::equal_energy(1.0)),
            Color::Blackbody(kelvin) => normalized(spectrum::black_body(kelvin)),
            Color::Curve(curve) => normalized(spectrum::integrate(Weighting::Emission, |w| {
                spectrum::interpolate(&curve, w)
            })),
        };
        let shown = color.max(Rgb::ZERO);
        if (shown - color).max_element() > 0.01 * color.max_element() {
            self.warn_at(
                given.at,
                &format!("\"{name}\" is {color}, which sRGB cannot show; it was cut to {shown}"),
            );
        }
        shown
    }

    /// An index of refraction that is one number, of glass at the d line.
    pub fn index(&mut self, p: &Params<'_, 's>, name: &'static str, default: f64) -> f32 {
        let kinds = [COLORS, &[Kind::Float, Kind::Texture]].concat();
        let Some(given) = p.find(name, &kinds) else {
            return default as f32;
        };
        let value = match self.color(p, given) {
            Some(Color::Uniform(value)) => value,
            Some(Color::Rgb(rgb) | Color::Channels(rgb)) => f64::from(luminance(rgb)),
            Some(Color::Curve(curve)) => {
                self.warn_at(
                    given.at,
                    &format!(
                        "\"{name}\" is taken at {D_LINE} nm: glass does not disperse light here"
                    ),
                );
                spectrum::interpolate(&curve, D_LINE)
            }
            _ => default,
        };
        if value > 0.0 {
            return value as f32;
        }
        p.wrong(name, format!("\"{name}\" is {value}; it must be above 0"));
        default as f32
    }

    fn color(&mut self, p: &Params<'_, 's>, given: &'s Parameter) -> Option<Color> {
        let result = match (&given.values, given.kind) {
            (Values::Floats(list), Kind::Spectrum) => curve(list),
            (Values::Floats(list), Kind::Blackbody) => match **list {
                // v3 has a factor behind the temperature.
                [kelvin] | [kelvin, _] if kelvin > 0.0 => Ok(Color::Blackbody(kelvin.into())),
                _ => Err("a temperature above 0 is expected".to_owned()),
            },
            (Values::Floats(list), Kind::Float) => match **list {
                [value] => Ok(Color::Uniform(value.into())),
                _ => Err(format!("one number is expected, not {}", list.len())),
            },
            (Values::Floats(list), kind) => match **list {
                [x, y, z] if kind == Kind::Xyz => {
                    let xyz = Rgb::new(x, y, z).as_dvec3();
                    Ok(Color::Rgb(spectrum::xyz_to_rgb(xyz)))
                }
                [r, g, b] => Ok(Color::Rgb(Rgb::new(r, g, b))),
                _ => Err(format!("three numbers are expected, not {}", list.len())),
            },
            (Values::Texts(list), Kind::Spectrum) => match list.as_slice() {
                [name] => self.named_spectrum(p, given, name),
                _ => Err("one name is expected".to_owned()),
            },
            _ => Err("a colour is expected".to_owned()),
        };
        result
            .map_err(|message| {
                let message = format!("\"{}\": {message}", given.name);
                self.source
                    .fault(given.at, message, "the default takes its place");
            })
            .ok()
    }

    /// A spectrum that pbrt has a name for, or that a file holds.
    fn named_spectrum(
        &mut self,
        p: &Params,
        given: &Parameter,
        name: &str,
    ) -> Result<Color, String> {
        if let Some((_, index)) = GLASSES.iter().find(|(known, _)| *known == name) {
            self.warn_at(given.at, &format!(
                "\"{name}\" is taken at {D_LINE} nm ({index}): glass does not disperse light here"
            ));
            return Ok(Color::Uniform(*index));
        }
        if let Some((_, [x, y])) = ILLUMINANTS.iter().find(|(known, _)| *known == name) {
            return Ok(Color::Light(of_chromaticity(*x, *y)));
        }
        if let Some(metal) = metal(name) {
            return Ok(Color::Channels(metal));
        }
        let path = p.source.resolve(given.at, name);
        let is_file = name.ends_with(".spd") || path.exists();
        if !is_file {
            let glasses = GLASSES.iter().map(|g| g.0);
            let known = glasses.chain(ILLUMINANTS.iter().map(|i| i.0));
            let help = named::did_you_mean(name, known);
            let help = help.map_or(String::new(), |h| format!("; {h}"));
            return Err(format!("there is no spectrum \"{name}\"{help}"));
        }
        let text = crate::image::regular::read_to_string(&path).map_err(|e| {
            let hint = named::hint_of(&path);
            format!("cannot read the spectrum {}: {e}{hint}", path.display())
        })?;
        let samples = numbers::samples(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Color::Curve(samples))
    }
}

/// Wavelengths and values in turn.
fn curve(list: &[f32]) -> Result<Color, String> {
    if list.is_empty() || list.len() % 2 != 0 {
        return Err("wavelengths and values are expected in turn".into());
    }
    let pairs = list.chunks_exact(2);
    let samples = pairs.map(|pair| (f64::from(pair[0]), f64::from(pair[1])));
    numbers::increasing(samples.collect()).map(Color::Curve)
}

/// The same colour with luminance 1; black stays black.
fn normalized(rgb: Rgb) -> Rgb {
    let y = luminance(rgb);
    if y > 0.0 { rgb / y } else { Rgb::ZERO }
}
