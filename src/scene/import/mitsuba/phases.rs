//! Phase functions.

use super::importer::Importer;
use super::params::Params;
use crate::medium::{PhaseFunction, PhaseLobe};
use crate::scene::import::ImportError;

/// Blends of phase functions inside of blends.
const MOST_NESTED: u32 = 8;

impl Importer<'_> {
    /// The phase function that object `index` describes.
    pub fn phase(&mut self, index: usize) -> PhaseFunction {
        self.nested_phase(index, 0)
    }

    fn nested_phase(&mut self, index: usize, nested: u32) -> PhaseFunction {
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
                    self.nested_phase(first, nested + 1),
                    self.nested_phase(second, nested + 1),
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
