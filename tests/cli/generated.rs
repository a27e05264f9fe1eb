//! `twintree generate`: the manual as files.

use super::support::Place;
use std::process::{Command, Stdio};

const COMMANDS: [&str; 11] = [
    "render",
    "merge",
    "denoise",
    "farm",
    "info",
    "check",
    "train",
    "field",
    "merge-fields",
    "table1",
    "sweep",
];

#[test]
fn man_pages_cover_every_command_and_option_that_help_shows() {
    let place = Place::new();
    let names = place.run("generate man pages").ok().out;
    assert!(names.lines().any(|n| n == "twintree.1"), "{names}");
    for command in COMMANDS {
        let page = String::from_utf8(place.read(&format!("pages/twintree-{command}.1"))).unwrap();
        // In troff a minus that is to stay one is written `\-`.
        let page = page.replace(r"\-", "-");
        let help = place.run(&format!("{command} --help")).ok().out;
        let options: Vec<&str> = help
            .split_whitespace()
            .filter(|word| word.starts_with("--"))
            .map(|word| word.trim_end_matches([',', ')', '.', ';', ':', '/']))
            // An optional value.
            .filter_map(|word| word.split("[=").next())
            .collect();
        assert!(options.len() > 3, "{help}");
        for option in options {
            assert!(page.contains(option), "{command}: {option}\n{page}");
        }
        assert!(page.contains("EXIT STATUS"));
    }
    assert!(!names.contains("generate"), "{names}");
}

#[test]
fn completions_name_every_command_and_no_hidden_one() {
    let place = Place::new();
    let names = place.run("generate completions shells").ok().out;
    assert_eq!(names.lines().count(), 3, "{names}");
    for name in names.lines() {
        let script = String::from_utf8(place.read(&format!("shells/{name}"))).unwrap();
        for command in COMMANDS {
            assert!(script.contains(command), "{name} lacks {command}");
        }
        assert!(!script.contains("generate"), "{name}");
    }
}

#[test]
fn bash_completes_what_was_begun() {
    let place = Place::new();
    place.run("generate completions .").ok();
    let script = "source ./twintree.bash; COMP_WORDS=(twintree re); COMP_CWORD=1; \
                  _twintree twintree re twintree; echo \"${COMPREPLY[@]}\"";
    let bash = Command::new("bash")
        .args(["--norc", "-c", script])
        .current_dir(place.path("."))
        .stderr(Stdio::inherit())
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&bash.stdout).trim(), "render");
}

#[test]
fn a_directory_that_cannot_be_made_is_named() {
    let place = Place::new();
    place
        .run("generate man scene.xml/pages")
        .fails(1, &["scene.xml/pages", "help:"]);
}
