//! Messages for the person at the terminal, on standard error.
//!
//! Logging goes through `tracing`; this is what makes lines of it: `warning: ...`, `error: ...`,
//! and plain sentences for what is merely told. Lines move a progress bar out of their way.
//!
//! Standard error may be closed, full, or a terminal that has gone. What cannot be written is lost
//! then, and nothing else: no render ends because nobody listens.

use super::bar;
use clap::{Args, ValueEnum};
use indicatif::{MultiProgress, ProgressDrawTarget, TermLike};
use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::sync::mpsc;
use std::time::Duration;
use tracing::field::{Field, Visit};
use tracing::level_filters::LevelFilter;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields, MakeWriter};
use tracing_subscriber::registry::LookupSpan;

/// How much to say.
#[derive(Args, Debug)]
#[command(next_help_heading = "Messages")]
pub struct TalkArgs {
    /// Print errors only
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Least important messages that are printed
    #[arg(long, global = true, value_name = "LEVEL", default_value = "info")]
    pub log_level: LogLevel,
}

/// Importance of a message.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// What ends the program.
    Error,
    /// What is odd.
    Warn,
    /// What is done.
    Info,
    /// How it is done.
    Debug,
}

/// Where messages and progress go.
#[derive(Clone)]
pub struct Console {
    bars: MultiProgress,
    level: LogLevel,
}

impl Console {
    /// Starts logging at the level asked for.
    pub fn start(talk: &TalkArgs) -> Self {
        let level = if talk.quiet {
            LogLevel::Error
        } else {
            talk.log_level
        };
        let target = match has_terminal() {
            true => ProgressDrawTarget::term_like_with_hz(Box::new(Terminal::new()), REDRAWS),
            false => ProgressDrawTarget::hidden(),
        };
        let console = Self {
            bars: MultiProgress::with_draw_target(target),
            level,
        };
        let filter = match level {
            LogLevel::Error => LevelFilter::ERROR,
            LogLevel::Warn => LevelFilter::WARN,
            LogLevel::Info => LevelFilter::INFO,
            LogLevel::Debug => LevelFilter::DEBUG,
        };
        let subscriber = tracing_subscriber::fmt()
            .with_max_level(filter)
            .event_format(Sentence)
            .with_writer(console.clone())
            .finish();
        // Fails only where a program that embeds this one has set its own subscriber: then that one
        // counts.
        let _ = tracing::subscriber::set_global_default(subscriber);
        console
    }

    /// Whether progress is to be shown at all.
    pub fn shows_progress(&self) -> bool {
        self.level >= LogLevel::Info
    }

    /// Whether standard error is a terminal that can show a bar.
    pub fn has_terminal(&self) -> bool {
        has_terminal()
    }

    /// Tells something at the end, in lines that fit a terminal.
    pub fn tell(&self, sentence: &str) {
        match self.has_terminal() {
            true => tracing::info!("{}", bar::folded(sentence, bar::columns())),
            false => tracing::info!("{sentence}"),
        }
    }

    /// Takes the bars away before the program ends. Waits for a moment only: whoever draws at them
    /// may be waiting for the terminal.
    pub fn leave(&self) {
        let (sender, done) = mpsc::channel();
        let bars = self.bars.clone();
        let clear = move || {
            let _ = bars.clear();
            // Nobody draws them again.
            bars.set_draw_target(ProgressDrawTarget::hidden());
            let _ = sender.send(());
        };
        if std::thread::Builder::new().spawn(clear).is_ok() {
            let _ = done.recv_timeout(PATIENCE);
        }
    }

    /// The progress bars.
    pub fn bars(&self) -> &MultiProgress {
        &self.bars
    }
}

/// Most redraws of the bars in a second.
const REDRAWS: u8 = 10;
/// Longest wait for a terminal that the program wants to leave clean.
const PATIENCE: Duration = Duration::from_millis(300);

/// Whether standard error is a terminal that moves its cursor as it is told.
fn has_terminal() -> bool {
    let kind = std::env::var("TERM").unwrap_or_default();
    io::stderr().is_terminal() && !matches!(kind.as_str(), "" | "dumb")
}

/// Whatever came of it: it was only for somebody to read.
fn heedless(result: io::Result<()>) -> io::Result<()> {
    let _ = result;
    Ok(())
}

/// Standard error as a terminal for bars, which drops what cannot be written: `indicatif` panics at
/// errors.
#[derive(Debug)]
struct Terminal(::console::Term);

impl Terminal {
    fn new() -> Self {
        Self(::console::Term::buffered_stderr())
    }
}

impl TermLike for Terminal {
    fn width(&self) -> u16 {
        self.0.size().1
    }

    fn height(&self) -> u16 {
        self.0.size().0
    }

    fn move_cursor_up(&self, n: usize) -> io::Result<()> {
        heedless(self.0.move_cursor_up(n))
    }

    fn move_cursor_down(&self, n: usize) -> io::Result<()> {
        heedless(self.0.move_cursor_down(n))
    }

    fn move_cursor_right(&self, n: usize) -> io::Result<()> {
        heedless(self.0.move_cursor_right(n))
    }

    fn move_cursor_left(&self, n: usize) -> io::Result<()> {
        heedless(self.0.move_cursor_left(n))
    }

    fn write_line(&self, s: &str) -> io::Result<()> {
        heedless(self.0.write_line(s))
    }

    fn write_str(&self, s: &str) -> io::Result<()> {
        heedless(self.0.write_str(s))
    }

    fn clear_line(&self) -> io::Result<()> {
        heedless(self.0.clear_line())
    }

    fn flush(&self) -> io::Result<()> {
        heedless(self.0.flush())
    }
}

/// `tracing-subscriber` would print its own errors of writing, and panic over that.
impl Write for Console {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        heedless(self.bars.suspend(|| io::stderr().write_all(line)))?;
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        heedless(io::stderr().flush())
    }
}

impl MakeWriter<'_> for Console {
    type Writer = Self;

    fn make_writer(&self) -> Self {
        self.clone()
    }
}

/// Formats an event as a sentence: its importance where that matters, the message, its fields.
struct Sentence;

impl<S, N> FormatEvent<S, N> for Sentence
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        _: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> std::fmt::Result {
        let mut text = Text::default();
        event.record(&mut text);
        let level = *event.metadata().level();
        if level == Level::ERROR {
            writer.write_str("error: ")?;
        } else if level == Level::WARN {
            writer.write_str("warning: ")?;
        } else if level >= Level::DEBUG {
            write!(writer, "debug: {}: ", event.metadata().target())?;
        }
        writeln!(writer, "{}{}", text.message, text.fields)
    }
}

/// The message of an event and the fields beside it.
#[derive(Default)]
struct Text {
    message: String,
    fields: String,
}

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        // Writing to a string cannot fail.
        let _ = if field.name() == "message" {
            write!(self.message, "{value:?}")
        } else {
            write!(self.fields, " {}={value:?}", field.name())
        };
    }
}

/// Prints an error. Also works where logging was never started; a closed standard error is ignored.
pub fn print_error(text: &str) {
    let _ = writeln!(io::stderr(), "error: {text}");
}

/// Prints `text` on standard output. A reader that has gone (`twintree info ... | head`) is no
/// error.
///
/// # Errors
/// When standard output refuses for another reason.
pub fn print_result(text: &str) -> Result<(), super::Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(super::Failure::Refused(format!(
            "standard output cannot be written: {e}"
        ))),
        _ => Ok(()),
    }
}

/// Makes a panic an error message that asks for a report.
pub fn report_panics() {
    std::panic::set_hook(Box::new(|info| {
        let payload = info.payload();
        let owned = payload.downcast_ref::<String>().map(String::as_str);
        let what = owned.or_else(|| payload.downcast_ref::<&str>().copied());
        let what = what.unwrap_or("no message");
        let place = info.location().map(ToString::to_string);
        let place = place.unwrap_or_else(|| "an unknown place".into());
        let backtrace = std::backtrace::Backtrace::capture();
        let mut text = format!(
            "internal error at {place}: {what}\n  help: this is a bug in twintree {}: please report it with \
             this message, the command line and the scene",
            env!("CARGO_PKG_VERSION")
        );
        if backtrace.status() == std::backtrace::BacktraceStatus::Captured {
            let _ = write!(text, "\n{backtrace}");
        }
        print_error(&text);
    }));
}
