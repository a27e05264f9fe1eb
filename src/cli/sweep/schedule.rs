//! The order of a sweep's runs, and the words and files of each.

use super::args::SweepArgs;
use crate::report::sweep::{Configuration, Setting};
use std::path::PathBuf;

/// Seeds of the rounds follow this one: references are rendered with small ones.
const SEEDS: u64 = 1000;

/// The configurations of a round. The first stays first; the others begin elsewhere each time, and
/// go backwards every other round, so that none always follows the same.
pub fn order(configurations: &[Configuration], round: u32) -> Vec<&Configuration> {
    let mut list: Vec<&Configuration> = configurations.iter().collect();
    let others = list.get_mut(1..).unwrap_or_default();
    if round % 2 == 1 {
        others.reverse();
    }
    if !others.is_empty() {
        others.rotate_left(round as usize * 7 % others.len());
    }
    list
}

/// A file of a configuration in the directory of the report.
pub fn file(args: &SweepArgs, configuration: &Configuration, ending: &str) -> PathBuf {
    let name = format!("{}.{ending}", configuration.name);
    args.output.join("runs").join(name)
}

/// The words of a run.
pub fn words_of(
    setting: &Setting,
    args: &SweepArgs,
    configuration: &Configuration,
    round: u32,
) -> Vec<String> {
    let path = |ending| file(args, configuration, ending).display().to_string();
    let mut words = vec!["render".to_owned(), setting.scene.clone()];
    words.extend(setting.common.iter().cloned());
    words.extend(configuration.options.iter().cloned());
    words.push(format!("--seed={}", SEEDS + 1 + u64::from(round)));
    words.push(format!("--time={}", setting.seconds));
    words.push(format!("--reference={}", setting.reference.path));
    words.push(format!("--stats={}", path("json")));
    words.push(format!("--output={}", path("exr")));
    words
}
