//! `twintree generate`: man pages and shell completions, from the same definitions as `--help`.
//!
//! Hidden in `--help`: packages want these files once, at build time. Completions are for the
//! shells that Debian has, under the names that these shells look for.

use super::{Failure, console};
use clap::{Args, Command, ValueEnum};
use clap_complete::Shell;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Arguments of `twintree generate`.
#[derive(Args, Debug)]
pub struct GenerateArgs {
    /// What to write
    pub what: Manual,
    /// Directory; made if there is none
    pub directory: PathBuf,
}

/// What can be generated.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manual {
    /// A man page for the program and one for each subcommand
    Man,
    /// Completions for bash, zsh and fish
    Completions,
}

/// Shells that get completions.
const SHELLS: [Shell; 3] = [Shell::Bash, Shell::Zsh, Shell::Fish];

/// What a man page says after the options.
const EXIT_STATUS: &str = r#".SH "EXIT STATUS"
.TP
0
done
.TP
1
the machine refused: an output cannot be written, memory ran out, an internal error
.TP
2
the command line or the scene is wrong; nothing was rendered
.TP
75
interrupted, with a checkpoint written: the same command with --resume goes on
.TP
130
interrupted; the image so far was written if rendering had begun
"#;

/// Writes the files about `all` commands into the directory, which is made if there is none, and prints their names.
///
/// # Errors
/// When the directory cannot be written.
pub fn run(args: &GenerateArgs, all: &Command) -> Result<(), Failure> {
    let shown = shown(all);
    let written = match args.what {
        Manual::Man => man_pages(&shown, &args.directory),
        Manual::Completions => completions(shown, &args.directory),
    };
    let names = written.map_err(|e| {
        Failure::refused(
            format!("cannot write into {}: {e}", args.directory.display()),
            "name a directory that can be written",
        )
    })?;
    console::print_result(&(names.join("\n") + "\n"))
}

/// The program as `--help` shows it: hidden subcommands are no part of the manual.
fn shown(all: &Command) -> Command {
    let subcommands = all.get_subcommands().filter(|s| !s.is_hide_set());
    let mut shown = Command::new("twintree")
        .version(env!("CARGO_PKG_VERSION"))
        .about(env!("CARGO_PKG_DESCRIPTION"))
        .args(all.get_arguments().cloned())
        .subcommands(subcommands.cloned())
        .disable_help_subcommand(true);
    shown.build();
    shown
}

/// One page for the program and one for each subcommand: `twintree-render.1`.
fn man_pages(program: &Command, directory: &Path) -> io::Result<Vec<String>> {
    fs::create_dir_all(directory)?;
    let subcommands = program.get_subcommands().cloned();
    let pages = std::iter::once(program.clone()).chain(subcommands);
    pages.map(|command| man_page(command, directory)).collect()
}

fn man_page(command: Command, directory: &Path) -> io::Result<String> {
    let page = clap_mangen::Man::new(command).manual("User Commands");
    let name = page.get_filename();
    let mut text = Vec::new();
    page.render(&mut text)?;
    text.extend_from_slice(EXIT_STATUS.as_bytes());
    fs::write(directory.join(&name), text)?;
    Ok(name)
}

fn completions(mut shown: Command, directory: &Path) -> io::Result<Vec<String>> {
    fs::create_dir_all(directory)?;
    let write = |shell| {
        let path = clap_complete::generate_to(shell, &mut shown, "twintree", directory)?;
        Ok(path
            .file_name()
            .map_or_else(String::new, |n| n.to_string_lossy().into_owned()))
    };
    SHELLS.into_iter().map(write).collect()
}
