//! Layers of light in parts.

use super::Layers;
use super::table::single;
use crate::film::Extras;
use crate::image::Channel;

/// The parts that are written.
#[derive(Debug)]
pub(super) struct LightLayers {
    /// What each is called, and where its sums are among those of a pixel.
    list: Vec<(String, usize)>,
}

impl LightLayers {
    /// Those that the film carries: direct and indirect light if they were asked for, all others in
    /// any case, for they have to be asked for by a list.
    pub fn new(extras: &Extras, layers: Layers) -> Self {
        let begin = extras.lights().start;
        let wanted = |name: &str| match name {
            "direct" => layers.direct,
            "indirect" => layers.indirect,
            _ => true,
        };
        let list = extras.light.names().into_iter().zip((begin..).step_by(3));
        Self {
            list: list.filter(|(name, _)| wanted(name)).collect(),
        }
    }

    /// Their channels.
    pub fn channels(&self) -> impl Iterator<Item = Channel> + '_ {
        let of = |name: &str| ["R", "G", "B"].map(|color| Channel::new(format!("{name}.{color}")));
        self.list.iter().flat_map(move |(name, _)| of(name))
    }

    /// What a pixel of these sums and this weight has in them.
    pub fn read(&self, sums: &[f64], weight: f64, out: &mut Vec<f32>) {
        for (_, begin) in &self.list {
            let sums = sums.get(*begin..begin + 3).unwrap_or(&[0.0; 3]);
            let mean = |sum: &f64| match weight > 0.0 {
                // As the picture's mean is taken.
                true => single(sum * (1.0 / weight)),
                false => 0.0,
            };
            out.extend(sums.iter().map(mean));
        }
    }
}
