//! What moves on a terminal while one waits: bars and spinners, as wide as the terminal has room.

use ::console::{measure_text_width, truncate_str};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Time between two looks at a bar.
pub const BAR_INTERVAL: Duration = Duration::from_millis(200);
/// A line comes after this time, even without a tenth.
pub const LONGEST_SILENCE: Duration = Duration::from_secs(10);

/// Cells of a bar.
const CELLS: usize = 8;
/// Columns that stay free behind a line, for the `^C` that a terminal shows: no line is to wrap.
const BEHIND: usize = 4;
/// A bar is drawn where so many columns are left for what it means.
const ROOM: usize = 16;
/// Between two parts of a line.
const GAP: &str = "  ";

/// A part of a line: what it says, and how much that matters. The smallest rank stays longest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// What it says.
    pub text: String,
    /// How much that matters.
    pub rank: u8,
}

impl Part {
    /// A part.
    pub fn new(rank: u8, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { text, rank }
    }
}

/// A line that is drawn again and again.
pub fn line() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    // The template is this line's own: were it refused, indicatif's default would serve.
    let style = ProgressStyle::with_template("{msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar
}

/// Columns of the terminal at this moment.
pub fn columns() -> usize {
    usize::from(::console::Term::stderr().size().1)
}

/// A bar with so much of it done, and the parts behind it that a terminal of so many columns has
/// room for.
pub fn drawn(done: f64, parts: &[Part], columns: usize) -> String {
    let room = columns.saturating_sub(BEHIND);
    let done = done.clamp(0.0, 1.0);
    let percent = format!("{:>3.0} %", (done * 100.0).floor());
    let full = (done * CELLS as f64) as usize;
    let cells = "█".repeat(full) + &"░".repeat(CELLS - full);
    let before = match room >= CELLS + 1 + percent.len() + GAP.len() + ROOM {
        true => format!("{cells} {percent}{GAP}"),
        false => format!("{percent}{GAP}"),
    };
    let rest = room.saturating_sub(measure_text_width(&before));
    truncate_str(&(before + &fitting(parts, rest)), room, "").into_owned()
}

/// The parts that so many columns have room for, in their order. Where there is no room even for
/// the one that matters most, its beginning.
pub fn fitting(parts: &[Part], columns: usize) -> String {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&i| parts[i].rank);
    let mut kept: Vec<usize> = Vec::new();
    let mut width = 0;
    for i in order {
        let gap = if kept.is_empty() { 0 } else { GAP.len() };
        let wider = width + gap + measure_text_width(&parts[i].text);
        if wider <= columns || kept.is_empty() {
            kept.push(i);
            width = wider;
        }
    }
    kept.sort_unstable();
    let texts: Vec<&str> = kept.iter().map(|&i| parts[i].text.as_str()).collect();
    truncate_str(&texts.join(GAP), columns, "").into_owned()
}

/// A sentence in lines of at most so many columns, cut between words; all but the first are
/// indented. A word that is longer than a line stays whole.
pub fn folded(sentence: &str, columns: usize) -> String {
    let mut lines = String::new();
    let mut width = 0;
    for word in sentence.split(' ') {
        let wide = measure_text_width(word);
        if width > 0 && width + 1 + wide > columns {
            lines.push_str("\n  ");
            width = 2;
        } else if width > 0 {
            lines.push(' ');
            width += 1;
        }
        lines.push_str(word);
        width += wide;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts() -> Vec<Part> {
        vec![
            Part::new(1, "16384/16384 spp"),
            Part::new(3, "99.9 k samples/s"),
            Part::new(2, "noise 0.0123 of 0.01"),
            Part::new(0, "9.99 s left"),
        ]
    }

    #[test]
    fn a_line_fits_any_terminal() {
        for columns in 0..200 {
            for done in [0.0, 0.5, 1.0, 7.0, f64::NAN] {
                let line = drawn(done, &parts(), columns);
                let width = measure_text_width(&line);
                assert!(width <= columns.saturating_sub(4), "{columns}: {line}");
            }
        }
    }

    #[test]
    fn what_matters_most_stays_longest() {
        let of = |columns| drawn(0.5, &parts(), columns);
        let all = "16384/16384 spp  99.9 k samples/s  noise 0.0123 of 0.01  9.99 s left";
        assert_eq!(of(120), format!("████░░░░  50 %  {all}"));
        assert_eq!(
            of(80),
            "████░░░░  50 %  16384/16384 spp  noise 0.0123 of 0.01  9.99 s left"
        );
        assert_eq!(of(50), "████░░░░  50 %  16384/16384 spp  9.99 s left");
        assert_eq!(of(40), "████░░░░  50 %  9.99 s left");
        assert_eq!(of(30), " 50 %  9.99 s left");
        assert_eq!(of(16), " 50 %  9.99 ");
        assert_eq!(of(4), "");
    }

    #[test]
    fn letters_of_many_bytes_are_one_column() {
        let parts = [Part::new(0, "äöü"), Part::new(1, "x")];
        assert_eq!(fitting(&parts, 6), "äöü  x");
        assert_eq!(fitting(&parts, 5), "äöü");
        assert_eq!(fitting(&parts, 2), "äö");
    }

    #[test]
    fn a_sentence_is_folded_between_words() {
        let sentence = "all samples are taken: 64 spp in 1.23 s, noise 0.0123";
        assert_eq!(folded(sentence, 80), sentence);
        let lines = folded(sentence, 24);
        assert!(lines.lines().all(|line| line.len() <= 24), "{lines}");
        assert_eq!(lines.replace("\n ", ""), sentence);
        assert_eq!(folded("unbreakable", 3), "unbreakable");
    }
}
