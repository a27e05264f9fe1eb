//! The words of a `twintree render` command, taken apart: some are for the shards, some for the
//! merge.

use crate::cli::Failure;
use crate::cli::aov::Aov;
use crate::cli::args::Cli;
use crate::cli::guide_args::{Guide, LearnArgs};
use crate::cli::help::options_of;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, CommandFactory};

/// What `twintree render` was told, by the one who needs to know.
#[derive(Debug, Default, PartialEq)]
pub struct Words {
    /// The scene file, or the models.
    pub scene: Vec<String>,
    /// Options of training, where shards are guided by a field that is learned first.
    pub train: Option<Vec<String>>,
    /// Options of every shard: what shapes pixels, and how the machine is used.
    pub render: Vec<String>,
    /// Options of the merge: what is written, and how.
    pub merge: Vec<String>,
    /// The images.
    pub outputs: Vec<String>,
    /// The interval between checkpoints.
    pub checkpoint: Option<String>,
    /// The number of threads.
    pub threads: Option<String>,
}

/// Options that cannot be cut up, and why.
const REFUSED: [(&str, &str); 6] = [
    (
        "quality",
        "it stops by the clock or the noise: use --spp, --photons and --paths",
    ),
    (
        "reference",
        "no shard is a whole image: use \"twintree compare\"",
    ),
    (
        "shard",
        "the shards are made here: say how many with --shards before the scene",
    ),
    (
        "time",
        "shards that stop by the clock have no common number of samples: use --spp",
    ),
    ("noise", "no shard knows the noise of the image: use --spp"),
    ("preview", "shards have no image to show"),
];

/// Understands words as `twintree render` would.
///
/// # Errors
/// When it would not take them, or they make no sense for a shard.
pub fn sort(words: &[String]) -> Result<Words, Failure> {
    if let Some(odd) = words
        .iter()
        .find(|w| w.contains(char::is_control) || w.contains("{{"))
    {
        return Err(Failure::Wrong(format!(
            "{odd:?} cannot stand in a job file"
        )));
    }
    let mut command = Cli::command();
    command.build();
    let typed = ["twintree", "render"].into_iter().map(str::to_owned);
    let matches = command
        .clone()
        .try_get_matches_from(typed.chain(words.iter().cloned()))
        .map_err(|e| {
            Failure::Wrong(
                e.to_string()
                    .trim_start_matches("error: ")
                    .trim_end()
                    .into(),
            )
        })?;
    let mut sorted = Words::default();
    let (Some(train), Some(command), Some(matches)) = (
        command.find_subcommand("train"),
        command.find_subcommand("render"),
        matches.subcommand_matches("render"),
    ) else {
        return Ok(sorted);
    };
    let of_training = |id: &str| train.get_arguments().any(|arg| arg.get_id() == id);
    let guide = matches.get_one::<Guide>("guide").copied();
    let learns = guide == Some(Guide::Double) && !matches.contains_id("field");
    sorted.train = learns.then(Vec::new);
    for arg in command.get_arguments() {
        let id = arg.get_id().as_str();
        if matches.value_source(id) != Some(ValueSource::CommandLine) {
            continue;
        }
        if let Some((name, why)) = REFUSED.iter().find(|(name, _)| *name == id) {
            return Err(Failure::wrong(
                format!("--{name} cannot be used on a farm"),
                *why,
            ));
        }
        let values = values(matches, id, arg.get_value_delimiter());
        match (id, values.last()) {
            ("files", _) => sorted.scene = all_values(matches, id),
            ("output", _) => sorted.outputs = values,
            ("checkpoint", Some(interval)) => sorted.checkpoint = Some(interval.clone()),
            ("threads", Some(count)) => sorted.threads = Some(count.clone()),
            // Shards always go on where they were.
            ("resume", _) => {}
            ("guide", _) if learns => {}
            _ if arg.get_help_heading() == Some("Output") => {
                sorted.merge.extend(typed_again(arg, &values));
                let mut aovs = matches.get_many::<Aov>("aov").into_iter().flatten();
                if id == "aov" && aovs.any(|aov| aov.is_extra()) {
                    sorted.render.extend(typed_again(arg, &values));
                }
            }
            _ => {
                let words = typed_again(arg, &values);
                let teaches = of_training(id);
                if let Some(train) = sorted.train.as_mut().filter(|_| teaches) {
                    train.extend(words.iter().cloned());
                }
                // How to learn is nothing to a shard that gets a field.
                if !(learns && options_of::<LearnArgs>().contains(arg)) {
                    sorted.render.extend(words);
                }
            }
        }
    }
    Ok(sorted)
}

/// The values of an option, one for each time that it was given.
fn values(matches: &ArgMatches, id: &str, delimiter: Option<char>) -> Vec<String> {
    let occurrences = matches.get_raw_occurrences(id).into_iter().flatten();
    let between = delimiter.map(String::from).unwrap_or_default();
    occurrences
        .map(|values| {
            let texts: Vec<_> = values.map(|v| v.to_string_lossy().into_owned()).collect();
            texts.join(&between)
        })
        .collect()
}

/// All values of an argument that takes several at once.
fn all_values(matches: &ArgMatches, id: &str) -> Vec<String> {
    let values = matches.get_raw(id).into_iter().flatten();
    values.map(|v| v.to_string_lossy().into_owned()).collect()
}

/// An option as it may be typed.
fn typed_again(arg: &Arg, values: &[String]) -> Vec<String> {
    let name = format!("--{}", arg.get_long().unwrap_or_default());
    if matches!(arg.get_action(), ArgAction::SetTrue) {
        return vec![name];
    }
    let mut words = Vec::new();
    for value in values {
        // Options whose value may be left out have it behind an equals sign or not at all.
        if arg.is_require_equals_set() && value.is_empty() {
            words.push(name.clone());
        } else if arg.is_require_equals_set() || value.starts_with('-') {
            words.push(format!("{name}={value}"));
        } else {
            words.extend([name.clone(), value.clone()]);
        }
    }
    words
}
