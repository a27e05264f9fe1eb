//! Participating media and their phase functions.

use super::importer::Importer;
use super::params::Params;
use super::role::Role;
use super::value::Value;
use crate::math::Rgb;
use crate::medium::{Boundary, Homogeneous, Medium, MediumId, PhaseFunction, PhaseLobe, VACUUM};
use crate::scene::import::ImportError;

/// Blends of phase functions inside of blends.
const MOST_NESTED: u32 = 8;

impl<'a> Importer<'a> {
    /// The media inside and outside of a shape; `None` if it names neither.
    pub fn boundary(&mut self, p: &Params<'a>) -> Option<Boundary> {
        let media = p.children("medium");
        let mut boundary = Boundary {
            interior: VACUUM,
            exterior: VACUUM,
        };
        for (property, index) in &media {
            let medium = self.medium(*index);
            match property.name.as_str() {
                "interior" => boundary.interior = medium,
                "exterior" => boundary.exterior = medium,
                name => {
                    let message =
                        format!("a shape's medium is \"interior\" or \"exterior\", not \"{name}\"");
                    let error = self.document.error(property.at, message);
                    p.fault(property.at, error);
                }
            }
        }
        (!media.is_empty()).then_some(boundary)
    }

    /// The medium that object `index` describes. The same object gives the same medium.
    pub fn medium(&mut self, index: usize) -> MediumId {
        if let Some(&id) = self.medium_of.get(&index) {
            return id;
        }
        let made = self.make_medium(index).map(|medium| {
            self.media.list.push(medium);
            self.media.list.len() as MediumId - 1
        });
        let id = self.or_instead(index, made, "nothing takes its place", |_| VACUUM);
        self.medium_of.insert(index, id);
        id
    }

    fn make_medium(&mut self, index: usize) -> Result<Medium, ImportError> {
        let p = Params::new(self.document, index);
        if p.plugin() != "homogeneous" {
            let message = format!(
                "medium \"{}\" is not read, only \"homogeneous\"",
                p.plugin()
            );
            return Err(p.error(message));
        }
        // How to sample is the renderer's decision, and what is the same everywhere has no place.
        p.ignore(&["sample_emitters", "has_spectral_extinction", "to_world"]);
        let extinction = self.coefficients(&p)?;
        let phase = match p.child("phase")? {
            Some(phase) => self.phase(phase, 0),
            None => PhaseFunction::isotropic(),
        };
        let name = self.name_of(index, p.plugin());
        self.done(&p);
        Ok(Medium {
            name,
            extinction,
            phase,
        })
    }

    /// Extinction and albedo, by themselves or as coefficients of scattering and absorption.
    fn coefficients(&mut self, p: &Params<'a>) -> Result<Homogeneous, ImportError> {
        let scale = p.float_in("scale", 1.0, 0.0..=f64::from(f32::MAX)) as f32;
        if p.has("material") {
            let message =
                "the presets of \"material\" are not read: give \"sigma_t\" and \"albedo\"";
            return Err(p.error(message));
        }
        if p.has("sigma_a") || p.has("sigma_s") {
            let absorbed = self.coefficient(p, "sigma_a", 0.0)?;
            let scattered = self.coefficient(p, "sigma_s", 0.0)?;
            let sum = absorbed + scattered;
            let share = |c: usize| {
                if sum[c] > 0.0 {
                    scattered[c] / sum[c]
                } else {
                    0.0
                }
            };
            return Ok(Homogeneous {
                extinction: (sum * scale).min(Rgb::MAX),
                albedo: Rgb::new(share(0), share(1), share(2)),
            });
        }
        let extinction = self.coefficient(p, "sigma_t", 1.0)? * scale;
        let albedo = self.volume(p, "albedo", Role::Reflectance)?;
        Ok(Homogeneous {
            extinction: extinction.min(Rgb::MAX),
            albedo: albedo
                .unwrap_or(Rgb::splat(0.75))
                .clamp(Rgb::ZERO, Rgb::ONE),
        })
    }

    /// A coefficient, which is not negative.
    fn coefficient(
        &mut self,
        p: &Params<'a>,
        name: &'static str,
        default: f32,
    ) -> Result<Rgb, ImportError> {
        let given = self.volume(p, name, Role::Number)?;
        let value = given.unwrap_or(Rgb::splat(default));
        if value.is_finite() && value.min_element() >= 0.0 {
            return Ok(value);
        }
        let message = format!("\"{name}\" must be 0 or more, not {value}");
        Err(self.document.error(p.place_of(name), message))
    }

    /// A colour, by itself or as a volume that is the same everywhere.
    fn volume(
        &mut self,
        p: &Params<'a>,
        name: &'static str,
        role: Role,
    ) -> Result<Option<Rgb>, ImportError> {
        let Some(property) = p.find(name) else {
            return Ok(None);
        };
        let Value::Object(index) = property.value else {
            return Ok(self.color(p, name, role));
        };
        if self.document.objects[index].tag != "volume" {
            return Ok(self.color(p, name, role));
        }
        let inner = Params::new(self.document, index);
        if inner.plugin() != "constvolume" {
            let message = format!("volume \"{}\" is not read here", inner.plugin());
            return Err(inner.error(message));
        }
        let value = self.color(&inner, "value", role);
        self.done(&inner);
        Ok(value)
    }

    fn phase(&mut self, index: usize, nested: u32) -> PhaseFunction {
        let made = self.make_phase(index, nested);
        let isotropic = |_: &mut Self| PhaseFunction::isotropic();
        self.or_instead(index, made, "an isotropic one takes its place", isotropic)
    }

    fn make_phase(&mut self, index: usize, nested: u32) -> Result<PhaseFunction, ImportError> {
        let p = Params::new(self.document, index);
        let phase = match p.plugin() {
            "isotropic" => PhaseFunction::isotropic(),
            "hg" => {
                let g = p.float_in("g", 0.8, -1.0..=1.0) as f32;
                PhaseLobe::henyey_greenstein(g).into()
            }
            "rayleigh" => PhaseLobe::Rayleigh.into(),
            "blendphase" if nested >= MOST_NESTED => {
                return Err(p.error("phase functions hold each other too often"));
            }
            "blendphase" => {
                let weight = p.float_in("weight", 0.5, 0.0..=1.0) as f32;
                let [(_, first), (_, second)] = p.children("phase")[..] else {
                    return Err(p.error("a blend is of two phase functions"));
                };
                let (first, second) = (
                    self.phase(first, nested + 1),
                    self.phase(second, nested + 1),
                );
                let blend = PhaseFunction::blend(&first, &second, weight);
                blend.map_err(|why| p.error(why))?
            }
            plugin => {
                let message = format!(
                    "phase function \"{plugin}\" is not read: \
                     isotropic, hg, rayleigh and blendphase are"
                );
                return Err(p.error(message));
            }
        };
        self.done(&p);
        Ok(phase)
    }
}
