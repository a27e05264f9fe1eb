//! At which levels of R the light of a point hangs: for reports and pictures.
//!
//! A point is served by all links whose cell of R holds it. Those high up in R are shared by many
//! cells: light that is the same over a region was learned once there. Where P divides space alone,
//! as with mixtures, one link of the point's own cell serves it.

use super::links::{ProductPosition, Split, step};
use super::train::Trainer;
use crate::math::{DVec3, Rgb, Vec3};

/// The links of a point that hang at one level of R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelShare {
    /// Level of their cells of R; the root has 0, and a level of normals counts.
    pub level: u8,
    /// How many there are.
    pub links: u32,
    /// Irradiance that they bring, in W/m^2.
    pub irradiance: Rgb,
}

impl Trainer {
    /// Where the light of a point hangs, from the root down; levels without links are left out.
    /// The normal only matters for fields split by normals.
    pub fn irradiance_by_level(&self, position: Vec3, normal: Vec3) -> Vec<LevelShare> {
        let density = self.densities();
        let key = self.space.grid.key(position, normal);
        let mut sums: Vec<(u32, DVec3)> = Vec::new();
        let mut stack = vec![ProductPosition::ROOT];
        while let Some(at) = stack.pop() {
            let node = self.product.nodes[at.node as usize];
            match node.split {
                Split::Leaf => {
                    let level = usize::from(at.space_level);
                    if sums.len() <= level {
                        sums.resize(level + 1, (0, DVec3::ZERO));
                    }
                    sums[level].0 += 1;
                    sums[level].1 += density[node.first as usize];
                }
                // The code of directions does not matter to a split of space.
                Split::Space => {
                    stack.extend(step(&self.product.nodes, &self.space.grid, key, 0, at));
                }
                Split::Direction => stack.extend((0..4).map(|child| ProductPosition {
                    node: node.first + child,
                    direction_level: at.direction_level + 1,
                    ..at
                })),
            }
        }
        let shares = (0..).zip(sums).filter(|(_, (links, _))| *links > 0);
        let share = |(level, (links, sum)): (u8, (u32, DVec3))| LevelShare {
            level,
            links,
            irradiance: sum.as_vec3(),
        };
        shares.map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::guide::tests::synthetic::{disk_light, unit_box};
    use crate::guide::{ModelKind, Settings, Trainer};
    use crate::math::{Rgb, Vec3};

    #[test]
    fn the_levels_share_out_the_irradiance_of_a_point() {
        for model in ModelKind::ALL {
            let mut trainer = Trainer::build(Settings {
                model: *model,
                ..unit_box()
            })
            .unwrap();
            for seed in 0..4 {
                trainer.train(&disk_light(Vec3::splat(0.6), 0.2, 20_000, seed), 20_000);
                trainer.refine();
            }
            let field = trainer.freeze();
            for point in [Vec3::splat(0.4), Vec3::new(0.6, 0.5, 0.61)] {
                let levels = trainer.irradiance_by_level(point, Vec3::Z);
                let sum: Rgb = levels.iter().fold(Rgb::ZERO, |sum, l| sum + l.irradiance);
                let local = field.at(point, None, Rgb::ONE);
                let error = (sum - local.irradiance()).abs().max_element();
                assert!(error <= 1e-5 * sum.max_element(), "{model:?}: {sum}");
                let links: u32 = levels.iter().map(|l| l.links).sum();
                assert_eq!(links as usize, local.links().len(), "{model:?}");
                if *model == ModelKind::Constant {
                    assert!(levels.len() > 1, "links hang on inner nodes: {levels:?}");
                }
            }
        }
    }
}
