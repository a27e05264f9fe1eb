//! Which lights to sample: factors for the light tree's topmost clusters, learned for each cell of
//! R from what light samples brought, visibility included.
//!
//! One of several strata is best chosen in proportion to the root of the second moment of what a
//! sample in it brings (Vevoda, Kondapaneni, Krivanek, "Bayesian online regression for adaptive
//! direct illumination sampling", 2018). The light tree already chooses cluster k with the
//! probability q_k that its importance gives it; a sample c drawn with p_k instead tells
//! y = c p_k / q_k, and sqrt(E\[y^2\]) is the factor by which the importance is wrong: 0 for lamps
//! in the next room. What a cell has not seen often is taken to be like its siblings.

use super::bytes::{Reader, Writer};
use crate::light::{CHILDREN, ClusterFactors, LightSelection};
use crate::math::Pcg32;
use std::sync::Arc;

/// Samples like those of all siblings that are taken for granted in the beginning.
const PRIOR: f64 = 4.0;

/// No factor is lower than this against the best sibling's: the cell may have been unlucky so far.
const LEAST: f64 = 0.05;

/// What a part of a divided cell keeps of it: parts may differ.
const KEPT: f64 = 0.25;

/// Marks a level of the tree on which nothing was chosen.
const NOTHING: u8 = u8::MAX;

/// The clusters out of which a light was sampled, down to the root's grandchildren.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChoice {
    /// The root's child and that one's, by place.
    cluster: [u8; 2],
    /// The probability of each over what the tree alone gives it.
    ratio: [f32; 2],
}

impl Default for LightChoice {
    fn default() -> Self {
        Self::NONE
    }
}

impl LightChoice {
    /// No light of the scene was sampled, or there is only one.
    pub const NONE: Self = Self {
        cluster: [NOTHING; 2],
        ratio: [0.0; 2],
    };

    /// A child of the root and one of its children, as the tree alone would have chosen them.
    #[cfg(test)]
    pub(crate) fn of(child: u8, grandchild: u8) -> Self {
        Self {
            cluster: [child, grandchild],
            ratio: [1.0; 2],
        }
    }

    /// What it chose: node, child and ratio.
    fn levels(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let at = self.cluster.map(usize::from);
        let node = [0, 1 + at[0]];
        let levels = [0, 1].map(|i| (node[i], at[i], f64::from(self.ratio[i])));
        levels.into_iter().filter(|l| l.1 < CHILDREN)
    }
}

/// Chooses by what a cell has learned, and keeps what was chosen.
#[derive(Clone, Copy, Debug, Default)]
pub struct LearnedSelection<'a> {
    /// None before anything was learned.
    pub factors: Option<&'a ClusterFactors>,
    /// What was chosen.
    pub choice: LightChoice,
}

impl LightSelection for LearnedSelection<'_> {
    #[inline]
    fn weighed(&self, node: usize, importance: [f32; CHILDREN]) -> [f32; CHILDREN] {
        self.factors.weighed(node, importance)
    }

    #[inline]
    fn chosen(&mut self, node: usize, child: usize, ratio: impl FnOnce() -> f32) {
        let level = usize::from(node > 0);
        self.choice.cluster[level] = child as u8;
        self.choice.ratio[level] = if self.factors.is_some() { ratio() } else { 1.0 };
    }
}

/// What light samples out of the clusters brought in a cell.
#[derive(Clone, Debug, PartialEq)]
struct Moments {
    /// Samples, and the sum of their y^2.
    sums: [[[f64; 2]; CHILDREN]; 1 + CHILDREN],
    factors: ClusterFactors,
}

impl Moments {
    const NONE: Self = Self {
        sums: [[[0.0; 2]; CHILDREN]; 1 + CHILDREN],
        factors: [[1.0; CHILDREN]; 1 + CHILDREN],
    };

    /// Adds a light sample that brought `light`.
    fn add(&mut self, choice: &LightChoice, light: f32) {
        for (node, child, ratio) in choice.levels() {
            let y = f64::from(light) * ratio;
            if y.is_finite() {
                self.sums[node][child][0] += 1.0;
                self.sums[node][child][1] += y * y;
            }
        }
    }

    /// Takes the factors from the sums.
    fn refit(&mut self) {
        for (factors, sums) in self.factors.iter_mut().zip(&self.sums) {
            *factors = factors_of(sums);
        }
    }

    /// Appends the sums of those children that were chosen.
    fn write(&self, w: &mut Writer) {
        for node in &self.sums {
            let chosen = |i: &usize| node[*i][0] > 0.0;
            w.u8((0..CHILDREN).filter(chosen).map(|i| 1 << i).sum());
            for i in (0..CHILDREN).filter(chosen) {
                node[i].iter().for_each(|&v| w.f64(v));
            }
        }
    }

    /// Reads what `write` wrote, if it is a state that sums can be in.
    fn read(r: &mut Reader) -> Option<Self> {
        let mut moments = Self::NONE;
        let sound = |v: &f64| v.is_finite() && *v >= 0.0;
        for node in &mut moments.sums {
            let chosen = r.u8()?;
            for (i, sums) in node.iter_mut().enumerate() {
                if chosen >> i & 1 != 0 {
                    *sums = [r.f64().filter(sound)?, r.f64().filter(sound)?];
                }
            }
        }
        moments.refit();
        Some(moments)
    }

    fn scale(&mut self, by: f64) {
        let sums = self.sums.as_flattened_mut().as_flattened_mut();
        sums.iter_mut().for_each(|v| *v *= by);
    }
}

/// The factors of a node's children.
fn factors_of(sums: &[[f64; 2]; CHILDREN]) -> [f32; CHILDREN] {
    let total = |i: usize| sums.iter().map(|s| s[i]).sum::<f64>();
    let mean = total(1) / total(0);
    if !(mean > 0.0 && mean.is_finite()) {
        return [1.0; CHILDREN];
    }
    let roots = sums.map(|[n, squares]| ((squares + PRIOR * mean) / (n + PRIOR)).sqrt());
    let most = roots.iter().fold(0.0, |a: f64, &b| a.max(b));
    roots.map(|r| (r / most).max(LEAST) as f32)
}

/// What the light samples of a cell have taught. Parts of a divided cell share it until one of them
/// learns more.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LightClusters {
    moments: Option<Arc<Moments>>,
    /// How often the cell was divided since.
    divisions: u8,
}

impl LightClusters {
    /// Factors that know nothing of any scene, in all their range.
    pub fn random(seed: u64) -> Self {
        let mut rng = Pcg32::new(seed, 0x006c_6967);
        let mut moments = Moments::NONE;
        for factor in moments.factors.as_flattened_mut() {
            *factor = LEAST as f32 + (1.0 - LEAST as f32) * rng.next_f32();
        }
        Self {
            moments: Some(Arc::new(moments)),
            divisions: 0,
        }
    }

    /// The factors, if anything was learned.
    #[inline]
    pub fn factors(&self) -> Option<&ClusterFactors> {
        self.moments.as_ref().map(|m| &m.factors)
    }

    /// Takes in what light samples brought, each as it counted in the image for the throughput 1.
    pub fn learn(&mut self, samples: impl Iterator<Item = (LightChoice, f32)>) {
        let mut samples = samples.filter(|s| s.0 != LightChoice::NONE).peekable();
        if samples.peek().is_none() {
            return;
        }
        let mut moments = self.moments.as_deref().unwrap_or(&Moments::NONE).clone();
        moments.scale(KEPT.powi(self.divisions.into()));
        samples.for_each(|(choice, light)| moments.add(&choice, light));
        moments.refit();
        self.moments = Some(Arc::new(moments));
        self.divisions = 0;
    }

    /// What a part of the cell starts with.
    pub fn of_part(&self) -> Self {
        Self {
            moments: self.moments.clone(),
            divisions: (self.divisions + 1).min(MOST_DIVISIONS),
        }
    }

    /// Appends it; what it shares with the cell before is written once.
    pub fn write(&self, w: &mut Writer, before: Option<&Self>) {
        let Some(moments) = &self.moments else {
            w.u8(NONE);
            return;
        };
        let shared = before
            .and_then(|b| b.moments.as_ref())
            .is_some_and(|b| Arc::ptr_eq(b, moments));
        w.u8(if shared { SHARED } else { OWN });
        w.u8(self.divisions);
        if !shared {
            moments.write(w);
        }
    }

    /// Reads what `write` wrote, if it is sound.
    pub fn read(r: &mut Reader, before: Option<&Self>) -> Option<Self> {
        let kind = r.u8()?;
        if kind == NONE {
            return Some(Self::default());
        }
        let divisions = r.u8().filter(|&d| d <= MOST_DIVISIONS)?;
        let moments = match kind {
            SHARED => before?.moments.clone()?,
            OWN => Arc::new(Moments::read(r)?),
            _ => return None,
        };
        Some(Self {
            moments: Some(moments),
            divisions,
        })
    }
}

/// In a file: nothing learned, the same as the cell before, its own.
const NONE: u8 = 0;
const SHARED: u8 = 1;
const OWN: u8 = 2;

/// After so many divisions without a record nothing is left of what was learned.
const MOST_DIVISIONS: u8 = 32;

#[cfg(test)]
mod tests {
    use super::*;

    /// Light samples of a cell: those out of the child `hidden` bring nothing, the others 1.
    fn learned(hidden: u8, ratio: f32) -> LightClusters {
        let mut clusters = LightClusters::default();
        let sample = |i: u32| {
            let child = (i % 4) as u8;
            let choice = LightChoice {
                ratio: [ratio, 1.0],
                ..LightChoice::of(child, 0)
            };
            (choice, if child == hidden { 0.0 } else { 1.0 / ratio })
        };
        clusters.learn((0..40_000).map(sample));
        clusters
    }

    #[test]
    fn lamps_that_are_hidden_are_sampled_least() {
        for ratio in [0.1, 1.0, 7.0] {
            let factors = learned(2, ratio).factors().unwrap()[0];
            for i in [0, 1, 3] {
                assert!((factors[i] - 1.0).abs() < 1e-3, "{factors:?}");
            }
            assert_eq!(factors[2], LEAST as f32);
            // Never sampled: like the mean of all.
            assert!((factors[7] - 0.75f32.sqrt()).abs() < 1e-3, "{factors:?}");
        }
    }

    #[test]
    fn a_few_samples_decide_nothing() {
        let mut clusters = LightClusters::default();
        let hidden = (LightChoice::of(1, 0), 0.0);
        clusters.learn([(LightChoice::of(0, 0), 1.0), hidden].into_iter());
        let factors = clusters.factors().unwrap()[0];
        assert!(factors[1] > 0.8 * factors[0], "{factors:?}");
        let before = clusters.clone();
        clusters.learn([(LightChoice::NONE, 3.0)].into_iter());
        assert_eq!(clusters, before);
    }

    #[test]
    fn a_part_forgets_most_of_it_once_it_learns_more() {
        let whole = learned(2, 1.0);
        let mut part = whole.of_part();
        assert_eq!(part.factors(), whole.factors());
        part.learn([(LightChoice::of(0, 0), 1.0)].into_iter());
        let n = part.moments.unwrap().sums[0][0][0];
        assert_eq!(n, 10_000.0 * KEPT + 1.0);
    }

    #[test]
    fn numbers_that_are_no_numbers_are_ignored() {
        let mut clusters = learned(2, 1.0);
        let before = clusters.factors().copied();
        let hostile = [f32::NAN, f32::INFINITY].map(|light| (LightChoice::of(0, 0), light));
        clusters.learn(hostile.into_iter());
        assert_eq!(clusters.factors().copied(), before);
    }
}
