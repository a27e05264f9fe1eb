//! Standard error that nobody reads: closed, full, or a terminal; and what a terminal shows.

use super::support::{Place, Ran, signal, wait};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use std::fs::File;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A terminal, and the program on it: its standard error, and nothing else.
struct Terminal {
    master: File,
    child: Child,
}

impl Terminal {
    fn start(place: &Place, words: &str, kind: &str) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let slave = File::options().write(true).open(name.to_str().unwrap());
        let child = place
            .command(words)
            .env("TERM", kind)
            .stdout(Stdio::null())
            .stderr(slave.unwrap())
            .spawn()
            .unwrap();
        Self {
            master: master.into(),
            child,
        }
    }

    /// Makes it so many columns wide.
    fn resize(&self, columns: u16) {
        let size = Winsize {
            ws_row: 24,
            ws_col: columns,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&self.master, size).unwrap();
    }

    /// What it shows until that is in it.
    fn until(&mut self, part: &str) -> String {
        let (mut text, mut bytes) = (String::new(), [0; 4096]);
        let start = Instant::now();
        while !text.contains(part) {
            assert!(start.elapsed() < Duration::from_secs(60), "{text}");
            let n = self.master.read(&mut bytes).unwrap();
            text += &String::from_utf8_lossy(&bytes[..n]);
        }
        text
    }

    /// What it shows from here to the end of the program, and how that ended.
    fn rest(mut self) -> (String, Ran) {
        let (mut text, mut bytes) = (String::new(), [0; 4096]);
        // An error says that nobody writes any more.
        while let Ok(n @ 1..) = self.master.read(&mut bytes) {
            text += &String::from_utf8_lossy(&bytes[..n]);
        }
        (text, wait(self.child))
    }
}

/// Renders that say much must come to their end whatever becomes of what they say.
#[test]
fn no_work_ends_because_nobody_listens() {
    let place = Place::new();
    let closed = || {
        let (reader, writer) = rustix::pipe::pipe().unwrap();
        drop(reader);
        Stdio::from(writer)
    };
    let full = || Stdio::from(File::options().write(true).open("/dev/full").unwrap());
    for (words, made) in [
        (
            "render scene.xml -o a.exr --time 1500ms --log-level debug",
            "a.exr",
        ),
        (
            "render scene.xml -o b.exr --guide double --photons 3000 --spp 9",
            "b.exr",
        ),
        (
            "train scene.xml -o c.field --photons 3000 --paths 3000",
            "c.field",
        ),
        ("make mesh --kind terrain --triangles 2k -o d.ply", "d.ply"),
    ] {
        for stderr in [closed(), full()] {
            let _ = std::fs::remove_file(place.path(made));
            let mut command = place.command(words);
            let status = command.stdout(Stdio::null()).stderr(stderr).status();
            assert_eq!(status.unwrap().code(), Some(0), "{words}");
            assert!(place.path(made).exists(), "{words}");
        }
    }
    // An error keeps its exit code.
    for stderr in [closed(), full()] {
        let mut command = place.command("render missing.xml");
        assert_eq!(command.stderr(stderr).status().unwrap().code(), Some(2));
    }
}

#[test]
fn a_terminal_that_goes_away_leaves_a_checkpoint() {
    // One SIGHUP by the terminal and one by the shell in it are one; SIGTERM twice is `timeout`.
    for signals in [
        vec!["HUP"],
        vec!["HUP", "HUP"],
        vec!["TERM", "TERM"],
        vec!["TERM", "HUP"],
    ] {
        if signals.iter().all(|s| *s == "HUP") && hangups_are_ignored() {
            eprintln!("skipped: SIGHUP is ignored here (nohup)");
            continue;
        }
        let place = Place::new();
        let words = "render scene.xml -o a.exr --spp 1000000000 --checkpoint 60s";
        let mut terminal = Terminal::start(&place, words, "xterm");
        terminal.until(" left");
        let Terminal { master, child } = terminal;
        drop(master);
        // The next lines and bars go nowhere.
        std::thread::sleep(Duration::from_millis(500));
        // One after the other, at once: by one shell.
        let kills = signals
            .iter()
            .map(|name| format!("kill -{name} {}; ", child.id()));
        let kills = Command::new("sh")
            .args(["-c", &kills.collect::<String>()])
            .status();
        assert!(kills.unwrap().success());
        let ran = wait(child);
        assert_eq!(ran.code, Some(75), "{signals:?}");
        assert_eq!(place.files(), ["a.exr", "a.exr.checkpoint", "scene.xml"]);
    }
}

/// Whether the tests run under `nohup`: then what they start ignores SIGHUP, as it should.
fn hangups_are_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 1 == 1)
}

#[test]
fn a_hang_up_ends_nothing_under_nohup() {
    let place = Place::new();
    let program = assert_cmd::cargo::cargo_bin!("twintree")
        .display()
        .to_string();
    // What nohup does before it becomes the program.
    let line = format!("trap '' HUP; exec '{program}' render scene.xml -o a.exr --time 3s");
    let child = Command::new("sh")
        .args(["-c", &line])
        .current_dir(place.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    signal(&child, "HUP");
    let ran = wait(child).ok();
    ran.says(&["the time is up", "wrote a.exr"]);
}

#[test]
fn a_dead_terminal_alone_ends_nothing() {
    for quiet in ["", "--quiet"] {
        let place = Place::new();
        let words = format!("render scene.xml -o a.exr --time 2s {quiet}");
        let terminal = Terminal::start(&place, &words, "xterm");
        drop(terminal.master);
        assert_eq!(wait(terminal.child).code, Some(0));
        assert!(place.path("a.exr").exists());
    }
}

#[test]
fn a_bar_fits_80_columns_and_is_gone_in_the_end() {
    let place = Place::new();
    let words = "render scene.xml -o a.exr --time 3s";
    let (text, ran) = Terminal::start(&place, words, "xterm").rest();
    assert_eq!(ran.code, Some(0), "{text}");
    assert!(text.contains("spp") && text.contains('%'), "{text}");
    // The bars and the last line.
    for line in plain(&text).iter().filter(|line| line.contains("spp")) {
        assert!(line.chars().count() <= 80, "{line}");
    }
    assert_nothing_left(&text);
}

/// Bars and the last sentences, also in a terminal that gets narrower.
#[test]
fn lines_fit_narrow_terminals() {
    let place = Place::new();
    let words = "render scene.xml -o a.exr --time 3s --guide none";
    let mut terminal = Terminal::start(&place, words, "xterm");
    terminal.resize(44);
    terminal.until("spp");
    let wide = terminal.until("left");
    terminal.resize(30);
    // What was drawn at the moment of the change.
    std::thread::sleep(Duration::from_millis(500));
    let mut bytes = [0; 1 << 16];
    let _ = terminal.master.read(&mut bytes).unwrap();
    let (narrow, ran) = terminal.rest();
    assert_eq!(ran.code, Some(0), "{narrow}");
    for (text, columns) in [(wide, 44), (narrow, 30)] {
        let lines = plain(&text);
        assert!(lines.iter().any(|line| line.contains(" left")), "{text}");
        for line in lines.iter().filter(|line| !line.contains("wrote")) {
            assert!(line.chars().count() <= columns, "{columns}: {line}");
        }
    }
}

#[test]
fn nothing_of_the_bar_is_left_by_ctrl_c() {
    let place = Place::new();
    let words = "render scene.xml -o a.exr --spp 1000000000";
    let mut terminal = Terminal::start(&place, words, "xterm");
    let mut text = terminal.until(" left");
    signal(&terminal.child, "INT");
    let (rest, ran) = terminal.rest();
    text += &rest;
    assert_eq!(ran.code, Some(130));
    assert_nothing_left(&text);
}

#[test]
fn a_dumb_terminal_gets_lines() {
    for kind in ["dumb", ""] {
        let place = Place::new();
        let words = "render scene.xml -o a.exr --time 2500ms";
        let (text, ran) = Terminal::start(&place, words, kind).rest();
        assert_eq!(ran.code, Some(0), "{text}");
        assert!(!text.contains('\x1b'), "{text:?}");
        assert!(
            text.contains(" left") && text.contains("wrote a.exr"),
            "{text}"
        );
    }
}

#[test]
fn learning_shows_how_far_it_is() {
    let place = Place::new();
    let words = "train scene.xml -o a.field --photons 3000000 --paths 0";
    let mut terminal = Terminal::start(&place, words, "xterm");
    terminal.until("of 3.00 M photons and paths");
    signal(&terminal.child, "INT");
    let (text, ran) = terminal.rest();
    assert_eq!(ran.code, Some(130), "{text}");
    assert_eq!(place.files(), ["scene.xml"]);
}

/// The lines that are written, without what moves the cursor.
fn plain(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut in_code = false;
    for c in text.chars() {
        match c {
            '\x1b' => in_code = true,
            _ if in_code => {
                // A code ends with a letter, and what it clears is a new line here.
                if c.is_ascii_alphabetic() {
                    in_code = false;
                    lines.push(String::new());
                }
            }
            '\r' | '\n' => lines.push(String::new()),
            c => lines.last_mut().unwrap().push(c),
        }
    }
    lines
}

/// Whatever was drawn last is cleared.
fn assert_nothing_left(text: &str) {
    let cleared = text.rfind("\x1b[2K").expect("bars are cleared");
    assert!(!text[cleared..].contains('%'), "{:?}", &text[cleared..]);
}
