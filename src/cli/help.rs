//! What `twintree render -h` shows, and which options belong together.

use clap::{Arg, Args, Command};

/// Options of `render` that everybody needs: those of `-h`.
const ESSENTIAL: [&str; 12] = [
    "output", "denoise", "quality", "spp", "time", "noise", "width", "height", "exposure", "guide",
    "seed", "resume",
];

/// The command line, whose `render -h` is short.
pub fn abridged(command: Command) -> Command {
    command.mut_subcommand("render", |render| render.mut_args(shorten))
}

fn shorten(arg: Arg) -> Arg {
    let essential = ESSENTIAL.contains(&arg.get_id().as_str());
    let hidden = !essential && !arg.is_positional();
    arg.hide_short_help(hidden)
}

/// The options that a group of arguments has.
pub fn options_of<A: Args>() -> Vec<Arg> {
    let alone = A::augment_args(Command::new("group"));
    alone.get_arguments().cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::super::args::Cli;
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_short_help_has_only_the_essential_options_and_those_of_research_come_last() {
        let command = abridged(Cli::command());
        let render = command.find_subcommand("render").unwrap();
        let ids: Vec<&str> = render
            .get_arguments()
            .map(|a| a.get_id().as_str())
            .collect();
        for id in ESSENTIAL {
            assert!(ids.contains(&id), "{id}");
        }
        let mut render = render.clone();
        let (short, long) = (render.render_help().to_string(), render.render_long_help());
        assert!(short.contains("--quality") && !short.contains("--mixture"));
        assert!(short.lines().count() < 50, "{short}");
        let long = long.to_string();
        let research = long.split("Guiding, for research:").nth(1).unwrap();
        assert!(research.contains("--mixture") && research.contains("--photons"));
        assert!(!research.contains("--field"));
    }
}
