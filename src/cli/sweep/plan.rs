//! What is tried: the options that trade speed for accuracy, one changed at a time from a base, and
//! some that go together.
//!
//! The base is a guided render, for most options are about guiding. How many samples to take is no
//! option here: every run measures its error all the way.

use crate::cli::Failure;
use crate::cli::args::Cli;
use crate::report::sweep::Configuration;
use clap::{CommandFactory, Parser};
use serde::Deserialize;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Knob of the configurations that change several options.
pub const COMBINATION: &str = "combination";
/// Name of the configuration that the others are compared with.
const BASE: &str = "base";

/// A plan as a file says it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    /// Options of every configuration, unless a knob changes them.
    #[serde(default)]
    base: String,
    /// Values to try, by option without `--`; `on` for one that takes no value.
    #[serde(default)]
    knobs: BTreeMap<String, Vec<String>>,
    /// Options that are tried together, by name.
    #[serde(default)]
    combinations: BTreeMap<String, String>,
}

/// What the built-in plan has to know of a scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneTraits {
    /// Whether it has textures.
    pub textures: bool,
}

/// The plan of a file.
///
/// # Errors
/// When it cannot be read or makes no sense.
pub fn read(path: &Path) -> Result<Vec<Configuration>, Failure> {
    let name = path.display();
    let text = crate::image::regular::read_to_string(path)
        .map_err(|e| Failure::Wrong(format!("{name} cannot be read: {e}")))?;
    let help = r#"write something like {"base": "--guide double", "knobs": {"photons": ["100000"], "hide-emitters": ["on"]}, "combinations": {"plain": "--guide none"}}"#;
    let file: PlanFile =
        serde_json::from_str(&text).map_err(|e| Failure::wrong(format!("{name}: {e}"), help))?;
    let mut plan = Draft::new(&file.base);
    for (knob, values) in &file.knobs {
        values.iter().for_each(|value| plan.turn(knob, value));
    }
    for (name, options) in &file.combinations {
        plan.combine(name, options);
    }
    Ok(plan.list)
}

/// The built-in plan.
pub fn built_in(scene: SceneTraits) -> Vec<Configuration> {
    let mut plan = Draft::new("--guide double");
    plan.turn_all("guide", "double");
    plan.turn("photons", "50000");
    plan.turn("photons", "2000000");
    plan.turn("paths", "250000");
    plan.turn("paths", "16000000");
    plan.turn("batches", "4");
    plan.turn("batches", "12");
    plan.turn("guide-memory", "16M");
    plan.turn("guide-memory", "64M");
    plan.turn_all("guide-model", "gauss");
    plan.turn_all("train", "both");
    plan.turn("mixture", "0.25");
    plan.turn("mixture", "0.5");
    plan.turn("mixture", "0.75");
    plan.turn_all("roulette", "field");
    plan.turn("reuse", "1");
    plan.turn("reuse", "8");
    plan.turn_all("manifold", "auto");
    plan.turn_all("trial", "auto");
    // What paths have unless told otherwise.
    plan.turn_all("sampler", "sobol");
    if cfg!(feature = "embree") {
        plan.turn_all("accel", "embree");
    }
    plan.turn_all("accel-build", "balanced");
    if scene.textures {
        plan.turn("texture-memory", "2G:half");
    }
    plan.combine("plain-independent", "--guide none --sampler independent");
    plan.combine(
        "quick-learning",
        "--photons 50000 --paths 250000 --batches 4",
    );
    plan.combine("long-learning", "--photons 2000000 --paths 16000000");
    plan.combine("vmf-small", "--guide-model vmf --guide-memory 16M");
    plan.list
}

/// A plan in the making.
struct Draft {
    base: Vec<String>,
    list: Vec<Configuration>,
}

impl Draft {
    fn new(base: &str) -> Self {
        let base: Vec<String> = base.split_whitespace().map(str::to_owned).collect();
        let first = Configuration {
            name: BASE.into(),
            knob: BASE.into(),
            options: base.clone(),
        };
        Self {
            base,
            list: vec![first],
        }
    }

    /// The base with one option changed.
    fn turn(&mut self, knob: &str, value: &str) {
        let mut changed = vec![format!("--{knob}")];
        if value != "on" {
            changed.push(value.into());
        }
        // The name is one for files, too.
        let name = format!("{knob}-{}", value.replace(':', "-"));
        self.add(name, knob, changed);
    }

    /// The same for every value of an option but that of the base.
    fn turn_all(&mut self, knob: &str, base: &str) {
        let command = Cli::command();
        let mut render = command
            .get_subcommands()
            .filter(|c| c.get_name() == "render");
        let options = render
            .next()
            .into_iter()
            .flat_map(clap::Command::get_arguments);
        let options = options.filter(|option| option.get_long() == Some(knob));
        let values = options.flat_map(clap::Arg::get_possible_values);
        for value in values.filter(|value| value.get_name() != base) {
            self.turn(knob, value.get_name());
        }
    }

    fn combine(&mut self, name: &str, options: &str) {
        let changed = options.split_whitespace().map(str::to_owned).collect();
        self.add(name.into(), COMBINATION, changed);
    }

    fn add(&mut self, name: String, knob: &str, changed: Vec<String>) {
        self.list.push(Configuration {
            name,
            knob: knob.into(),
            options: merged(&self.base, changed),
        });
    }
}

/// The words of `base` whose options `changed` does not have, then `changed`. An option is a word
/// with `--`, and the words up to the next.
fn merged(base: &[String], changed: Vec<String>) -> Vec<String> {
    let option = |word: &str| word.split('=').next().unwrap_or_default().to_owned();
    let named = changed.iter().filter(|w| w.starts_with("--"));
    let named: HashSet<String> = named.map(|w| option(w)).collect();
    let mut kept = true;
    let mut words: Vec<String> = Vec::new();
    for word in base {
        if word.starts_with("--") {
            kept = !named.contains(&option(word));
        }
        if kept {
            words.push(word.clone());
        }
    }
    words.extend(changed);
    words
}

/// Tries every configuration on the command line's own parser.
///
/// # Errors
/// When it would not take one, or two have the same name or one that is no name for a file.
pub fn check(plan: &[Configuration], common: &[String]) -> Result<(), Failure> {
    let mut names = HashSet::new();
    for configuration in plan {
        let name = &configuration.name;
        let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        if name.is_empty() || !name.chars().all(plain) || name.starts_with('.') {
            let help = "use letters, digits, - and _";
            return Err(Failure::wrong(
                format!("{name:?} is no name for files"),
                help,
            ));
        }
        if !names.insert(name) {
            let help = "leave one of them away";
            return Err(Failure::wrong(format!("{name} is in the plan twice"), help));
        }
        let words = ["twintree", "render", "scene.xml"].map(String::from);
        let words = words.iter().chain(common).chain(&configuration.options);
        Cli::try_parse_from(words).map_err(|e| {
            let text = e.to_string();
            let text = text.trim_start_matches("error: ").trim_end();
            Failure::Wrong(format!("the configuration {name} of the plan: {text}"))
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn a_knob_replaces_the_option_of_the_base_with_its_value() {
        let base = words("--guide double --strict-normals --photons 5");
        assert_eq!(
            merged(&base, words("--guide none")),
            words("--strict-normals --photons 5 --guide none")
        );
        assert_eq!(
            merged(&base, words("--strict-normals")),
            words("--guide double --photons 5 --strict-normals")
        );
    }

    #[test]
    fn the_built_in_plan_is_one_that_the_command_line_takes() {
        for textures in [false, true] {
            let plan = built_in(SceneTraits { textures });
            check(&plan, &[]).unwrap();
            assert!(plan.len() > 20);
            assert!(
                plan.iter().all(|c| c.name != "sampler-sobol"),
                "the base has it"
            );
        }
    }

    #[test]
    fn plans_that_cannot_be_run_are_refused_with_the_reason() {
        let refused = |name: &str, options: &str| {
            let plan = [Configuration {
                name: name.into(),
                knob: COMBINATION.into(),
                options: words(options),
            }];
            check(&plan, &[]).unwrap_err().text().unwrap()
        };
        assert!(refused("a", "--photon 5").contains("--photons"));
        assert!(refused("a", "--photons many").contains("many"));
        assert!(refused("a/b", "").contains("a/b"));
    }
}
