//! What `twintree render -h` shows, and how `--help` groups the rest.

use clap::{Arg, Command};

/// Options of `render` that everybody needs: those of `-h`.
const ESSENTIAL: [&str; 11] = [
    "output", "quality", "spp", "time", "noise", "width", "height", "exposure", "guide", "seed",
    "resume",
];
/// Options that only research on guiding touches.
const RESEARCH: [&str; 12] = [
    "photons",
    "paths",
    "train",
    "batches",
    "guide_memory",
    "guide_model",
    "mixture",
    "roulette",
    "reuse",
    "manifold",
    "adaptive",
    "trial",
];

/// The command line with its options in groups for people.
pub fn grouped(command: Command) -> Command {
    command.mut_subcommand("render", |render| render.mut_args(group))
}

fn group(arg: Arg) -> Arg {
    let is_one_of = |ids: &[&str]| ids.contains(&arg.get_id().as_str());
    let (essential, research) = (is_one_of(&ESSENTIAL), is_one_of(&RESEARCH));
    let hidden = !essential && !arg.is_positional();
    let arg = arg.hide_short_help(hidden);
    match research {
        true => arg.help_heading("Guiding, for research"),
        false => arg,
    }
}

#[cfg(test)]
mod tests {
    use super::super::args::Cli;
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_lists_name_options_and_the_short_help_has_only_the_essential_ones() {
        let command = grouped(Cli::command());
        let render = command.find_subcommand("render").unwrap();
        let ids: Vec<&str> = render
            .get_arguments()
            .map(|a| a.get_id().as_str())
            .collect();
        for id in ESSENTIAL.iter().chain(&RESEARCH) {
            assert!(ids.contains(id), "{id}");
        }
        let mut render = render.clone();
        let (short, long) = (render.render_help().to_string(), render.render_long_help());
        assert!(short.contains("--quality") && !short.contains("--mixture"));
        assert!(short.lines().count() < 50, "{short}");
        let long = long.to_string();
        let research = long.split("Guiding, for research:").nth(1).unwrap();
        assert!(research.contains("--mixture") && !research.contains("--field"));
    }
}
