//! The parameters of materials, as their models ask for them.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::textures::times;
use super::value::{Dialect, Value};
use crate::bsdf::MeasuredBrdf;
use crate::bsdf::material::{Distribution, Parameters, Roughness};
use crate::math::Rgb;
use crate::scene::import::{ior, measured, named};
use crate::texture::Texture;

/// The least roughness: a distribution of width 0 is not a function. Mitsuba's bound.
const MIN_ALPHA: f32 = 1e-4;

/// A material that is being read.
pub(super) struct Asking<'i, 'a> {
    importer: &'i mut Importer<'a>,
    p: &'i Params<'a>,
}

impl<'a> Importer<'a> {
    /// To be asked for the parameters of a material.
    pub fn asking<'i>(&'i mut self, p: &'i Params<'a>) -> Asking<'i, 'a> {
        Asking { importer: self, p }
    }
}

impl Asking<'_, '_> {
    /// An index of refraction, as a number or by name.
    fn ior(&self, name: &'static str, default: &'static str) -> f32 {
        let by_default = ior::dielectric(default).unwrap_or(1.0);
        let named = match self.p.find(name).map(|property| &property.value) {
            Some(Value::Text(text)) => text.as_str(),
            None | Some(Value::Broken) => return by_default,
            Some(_) => return self.p.positive(name, f64::from(by_default)) as f32,
        };
        ior::dielectric(named).unwrap_or_else(|| {
            self.unknown_ior("material", name, named, ior::dielectric_names());
            by_default
        })
    }

    /// Tells that nothing has the name that a parameter gives.
    fn unknown_ior(
        &self,
        what: &str,
        parameter: &str,
        named: &str,
        known: impl Iterator<Item = &'static str>,
    ) {
        let help = named::did_you_mean(named, known);
        let message = format!("no {what} is called \"{named}\"");
        let at = self.p.place_of(parameter);
        let error = self.p.document().error_help(at, message, help);
        self.p.fault(at, error);
    }

    fn texture_given(&mut self, name: &'static str) -> Option<Texture> {
        self.importer.texture_given(self.p, name, Role::Number)
    }
}

impl Parameters for Asking<'_, '_> {
    fn reflectance(&mut self, name: &'static str, default: f32) -> Texture {
        self.importer
            .texture(self.p, name, default, Role::Reflectance)
    }

    fn number(&mut self, name: &'static str, default: f32) -> Texture {
        self.importer.texture(self.p, name, default, Role::Number)
    }

    fn float(&self, name: &'static str, default: f32) -> f32 {
        self.p.float(name, f64::from(default)) as f32
    }

    fn boolean(&self, name: &'static str, default: bool) -> bool {
        self.p.boolean(name, default)
    }

    fn choice(&self, name: &'static str, words: &[&str]) -> Option<usize> {
        let choices = words.iter().copied().zip(0..).collect::<Vec<_>>();
        self.p.choice(name, &choices)
    }

    fn either(&self, names: &[&'static str]) -> &'static str {
        self.p.either(names)
    }

    fn ignore(&self, names: &[&'static str]) {
        self.p.ignore(names);
    }

    fn alphas(&mut self) -> [Texture; 2] {
        let alpha = self.number("alpha", 0.1);
        let given = ["alpha_u", "alpha_v"].map(|name| self.texture_given(name));
        given.map(|given| match given.unwrap_or_else(|| alpha.clone()) {
            Texture::Constant(c) => Texture::Constant(c.max(Rgb::splat(MIN_ALPHA))),
            varying => varying,
        })
    }

    fn roughness(&mut self) -> Roughness {
        let distributions = [
            ("beckmann", (Distribution::Beckmann, true)),
            ("ggx", (Distribution::Ggx, true)),
            ("phong", (Distribution::Beckmann, false)),
            ("as", (Distribution::Beckmann, false)),
        ];
        let chosen = self.p.choice("distribution", &distributions);
        let (distribution, exact) = chosen.unwrap_or((Distribution::Beckmann, true));
        if !exact {
            let at = self.p.place_of("distribution");
            let place = self.p.document().location(at);
            self.importer.warnings.tell(format!(
                "{place}: this distribution is rendered as \"beckmann\""
            ));
        }
        let [alpha_u, alpha_v] = self.alphas();
        Roughness {
            distribution,
            alpha_u,
            alpha_v,
        }
    }

    fn relative_ior(&mut self, inside: &'static str) -> f32 {
        self.ior("int_ior", inside) / self.ior("ext_ior", "air")
    }

    fn conductor_ior(&mut self) -> [Texture; 2] {
        let name = self.p.text("material");
        let by_default = match self.p.dialect() {
            Dialect::Classic => "cu",
            Dialect::Modern => "none",
        };
        let (eta, k) = ior::conductor(name.unwrap_or(by_default)).unwrap_or_else(|| {
            let name = name.unwrap_or_default();
            self.unknown_ior("conductor", "material", name, ior::conductor_names());
            (Rgb::ZERO, Rgb::ONE)
        });
        let given = ["eta", "k"].map(|name| self.texture_given(name));
        let outside = self.ior("ext_eta", "air");
        // Where "ext_eta" is left out, air is as good as vacuum for a metal: Mitsuba 3 uses 1.
        let outside = if self.p.has("ext_eta") { outside } else { 1.0 };
        let [given_eta, given_k] = given;
        [(given_eta, eta), (given_k, k)].map(|(given, named)| {
            let texture = given.unwrap_or(Texture::Constant(named));
            times(texture, Rgb::splat(1.0 / outside))
        })
    }

    fn principled_ior(&self) -> Result<f32, String> {
        Ok(match self.p.number("eta") {
            Some(_) if self.p.has("specular") => {
                return Err("\"eta\" and \"specular\" say the same; give one of them".into());
            }
            Some(_) => self.p.positive("eta", 1.5) as f32,
            None => {
                // Reflectance at normal incidence is 0.08 * specular (Burley 2012).
                let specular = self.p.float_in("specular", 0.5, 0.0..=1.0);
                (2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0) as f32
            }
        })
    }

    fn measured(&mut self, name: &'static str) -> Result<&'static MeasuredBrdf, String> {
        let given = self.p.text(name);
        let given = given.ok_or_else(|| format!("a measured material needs a \"{name}\""))?;
        measured::read(&self.p.document().resolve(self.p.place_of(name), given))
    }
}
