//! The light tree against the sum over all lights, and against simpler choices.

use super::scenes::*;
use super::*;
use crate::light::cluster::Cluster;
use crate::light::tree::LightTree;
use crate::math::distribution::Discrete;
use crate::math::luminance;

/// Triangles of very different brightness on and around a sphere.
fn many(count: usize) -> Setup {
    let mut rng = Pcg32::new(77, 3);
    let shapes = (0..10)
        .map(|i| {
            let brightness = 10f32.powf(rng.next_f32() * 2.0);
            (strewn(count / 10, 0.03, i), constant(brightness))
        })
        .collect();
    setup(shapes, vec![])
}

/// Irradiance at `p` from every leaf by a few samples each.
fn brute_force(s: &Setup, p: Vec3, n: Vec3) -> f64 {
    let leaves = s.lights.local.as_ref().unwrap().leaves.len();
    let mut rng = Pcg32::new(5, 5);
    let mut sum = 0.0;
    for i in 0..leaves {
        for _ in 0..16 {
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            sum += contribution(s, i, p, n, u) / 16.0;
        }
    }
    sum
}

/// A leaf's irradiance at `p`, by the sample `u`.
fn contribution(s: &Setup, leaf: usize, p: Vec3, n: Vec3, u: Vec2) -> f64 {
    let (emitter, leaf) = &s.lights.local.as_ref().unwrap().leaves[leaf];
    let Some(i) = leaf.sample(p, u) else {
        return 0.0;
    };
    let area = s.lights.areas[*emitter as usize].as_ref().unwrap();
    let radiance = area.radiance_at(p + i.dir * i.distance, -i.dir, i.place);
    f64::from(luminance(radiance) * i.dir.dot(n).max(0.0) / i.pdf)
}

/// Mean and relative variance of one-sample estimates.
fn estimate(draws: u32, mut one: impl FnMut(&mut Pcg32) -> f64) -> (f64, f64) {
    let mut rng = Pcg32::new(31, 7);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..draws {
        let value = one(&mut rng);
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(draws);
    (mean, squares / f64::from(draws) / (mean * mean) - 1.0)
}

#[test]
fn ten_thousand_triangles_add_up() {
    let s = many(10_000);
    let local = s.lights.local.as_ref().unwrap();
    assert!(local.leaves.len() > 9_900);
    for (p, n) in [
        (Vec3::ZERO, Vec3::Z),
        (Vec3::new(2.5, 0.3, 0.1), Vec3::NEG_X),
        (Vec3::new(1.0, -1.9, 0.0), Vec3::ONE.normalize()),
    ] {
        let exact = brute_force(&s, p, n);
        let draws = 100_000;
        let (mean, variance) = estimate(draws, |rng| {
            let u = [(); 3].map(|()| rng.next_f32());
            s.lights.sample(p, n, &mut (), u).map_or(0.0, |l| {
                f64::from(luminance(s.lights.radiance(&l.incoming)) * l.dir.dot(n).max(0.0) / l.pdf)
            })
        });
        let error = mean * (variance / f64::from(draws)).sqrt();
        assert!(error < 0.02 * exact, "{mean} +- {error}");
        // The sum itself is good to about a per cent: a few triangles are close.
        assert!(
            (mean - exact).abs() < 4.0 * error + 0.01 * exact,
            "{mean} {exact}"
        );
        let equal = vec![1.0; local.leaves.len()];
        let power: Vec<f64> = (local.leaves.iter())
            .map(|(e, leaf)| {
                let radiance = s.lights.areas[*e as usize].as_ref().unwrap();
                let radiance =
                    radiance.radiance_at(Vec3::ZERO, Vec3::Z, incident::EmitterPlace::Surface);
                f64::from(luminance(radiance) * leaf.area())
            })
            .collect();
        let [uniform, power] = [equal, power].map(|weights| {
            let choice = Discrete::new(&weights).unwrap();
            let one = |rng: &mut Pcg32| {
                let c = choice.sample(u64::from(rng.next_u32()) << 32);
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                contribution(&s, c.index, p, n, u) / f64::from(c.probability)
            };
            estimate(draws, one).1
        });
        println!(
            "at {p}: relative variance {variance:.2}, by power {power:.2}, uniform {uniform:.2}"
        );
        assert!(variance < 0.5 * power);
        assert!(variance < 0.25 * uniform);
    }
}

/// The probabilities of all leaves sum to what is drawn, and each is what sampling reports.
#[test]
fn probabilities_of_leaves() {
    probabilities_by(None);
    let mut rng = Pcg32::new(4, 8);
    let factors = [[(); CHILDREN]; 1 + CHILDREN].map(|node| node.map(|()| 0.05 + rng.next_f32()));
    probabilities_by(Some(&factors));
}

fn probabilities_by(mut selection: Option<&ClusterFactors>) {
    let s = many(300);
    let local = s.lights.local.as_ref().unwrap();
    let (tree, leaves) = (&local.tree, local.leaves.len());
    let mut rng = Pcg32::new(3, 8);
    for p in [Vec3::ZERO, Vec3::new(4.0, 1.0, 0.0)] {
        for n in [Vec3::ZERO, Vec3::Y] {
            let sum: f64 = (0..leaves)
                .map(|i| f64::from(tree.probability(p, n, &selection, i)))
                .sum();
            let (mut drawn, draws) = (0, 20_000);
            for _ in 0..draws {
                if let Some((leaf, probability)) =
                    tree.sample(p, n, &mut selection, f64::from(rng.next_f32()))
                {
                    let again = tree.probability(p, n, &selection, leaf);
                    assert!(probability > 0.0 && (again / probability - 1.0).abs() < 1e-5);
                    drawn += 1;
                }
            }
            let drawn = f64::from(drawn) / f64::from(draws);
            assert!(
                sum < 1.0 + 1e-4 && (sum - drawn).abs() < 0.02,
                "{sum} {drawn}"
            );
        }
    }
}

/// Importance is 0 only where nothing can arrive: no group hides a light of its own that shines on
/// the point.
#[test]
fn groups_never_hide_a_light() {
    let s = many(500);
    let local = s.lights.local.as_ref().unwrap();
    let mut rng = Pcg32::new(9, 9);
    let mut checked = 0;
    for _ in 0..300 {
        let mut number = || rng.next_f32() * 2.0 - 1.0;
        let p = Vec3::new(number(), number(), number()) * 3.0;
        let n = Vec3::new(number(), number(), number()).normalize();
        for (i, (_, leaf)) in local.leaves.iter().enumerate() {
            let shines = leaf
                .sample(p, Vec2::new(0.4, 0.6))
                .is_some_and(|l| l.dir.dot(n) > 1e-3);
            if shines {
                assert!(
                    local.tree.probability(p, n, &(), i) > 0.0,
                    "leaf {i} at {p}"
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 10_000);
}

/// Lights in one place, equal lights, and a chain that splits badly all make a tree within its
/// depth.
#[test]
fn degenerate_arrangements_build() {
    let same = vec![Cluster::ball(Vec3::ONE, 0.0, 1.0); 1000];
    let chain: Vec<Cluster> = (0..100)
        .map(|i| Cluster::ball(Vec3::X * 2f32.powi(i - 50), 0.0, 1.0))
        .collect();
    for clusters in [same, chain] {
        let tree = LightTree::build(&clusters).unwrap();
        let p = Vec3::new(0.1, 5.0, 0.2);
        let sum: f32 = (0..clusters.len())
            .map(|i| tree.probability(p, Vec3::ZERO, &(), i))
            .sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
    }
}
