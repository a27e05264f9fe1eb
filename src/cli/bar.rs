//! What moves on a terminal while one waits: bars and spinners.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Steps of the bar.
pub const STEPS: u64 = 1000;
/// Time between two looks at a bar.
pub const BAR_INTERVAL: Duration = Duration::from_millis(200);
/// A line comes after this time, even without a tenth.
pub const LONGEST_SILENCE: Duration = Duration::from_secs(10);

/// Columns of a bar before its message.
const BEFORE_MESSAGE: usize = 16;
/// Columns that stay free behind it, for the `^C` that a terminal shows: no line is to wrap.
const BEHIND_MESSAGE: usize = 4;

/// A bar of [`STEPS`] with a message.
pub fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:8} {percent:>3} %  {msg}");
    let bar = ProgressBar::new(STEPS);
    // The template is this line's own: were it refused, indicatif's default would serve.
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// A line that moves, for work of unknown length.
pub fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    let style = ProgressStyle::with_template("{spinner} {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
    bar
}

/// A message as long as the terminal has room for behind a bar.
pub fn fitting(message: String) -> String {
    let columns = usize::from(::console::Term::stderr().size().1);
    cut(message, columns)
}

/// What fits into so many columns, bar and all.
fn cut(mut message: String, columns: usize) -> String {
    let room = columns.saturating_sub(BEFORE_MESSAGE + BEHIND_MESSAGE);
    if let Some((end, _)) = message.char_indices().nth(room) {
        message.truncate(end);
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_fits_the_terminal() {
        let long = "16384/16384 spp  99.9 k samples/s  noise 0.0123  9.99 s left";
        assert_eq!(cut(long.into(), 80), long);
        assert_eq!(cut(long.into(), 40).len(), 20);
        assert_eq!(cut("äöü".into(), 22), "äö");
        assert_eq!(cut(long.into(), 10), "");
    }
}
