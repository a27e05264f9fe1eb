//! What ends the program early, and the exit code that stands for it.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the machine refused: an output cannot be written, memory ran out, an internal error; an image passes a limit |
//! | 2 | the command line or the scene is wrong; nothing was rendered |
//! | 3 | with `--strict`: samples were not finite; the image was written without them |
//! | 75 | interrupted, with a checkpoint written: the same command with `--resume` goes on |
//! | 130 | interrupted; an image that had begun was written |

use crate::accel::AccelError;
use crate::guide::GuideError;
use crate::image::ImageError;
use crate::scene::import::ImportError;

/// Exit code when the machine refused, or a limit is passed.
pub const FAILED: u8 = 1;
/// Exit code when the command line or the scene is wrong.
pub const WRONG: u8 = 2;
/// Exit code when samples were not finite and `--strict` asks.
pub const INVALID: u8 = 3;
/// Exit code after an interrupt with a checkpoint: BSD's EX_TEMPFAIL, "try again", which queues
/// know.
pub const CHECKPOINTED: u8 = 75;
/// Exit code after Ctrl-C or SIGTERM: 128 and the number of SIGINT, as shells have it.
pub const INTERRUPTED: u8 = 130;

/// Why a command did not come to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The command line or the scene is wrong.
    Wrong(String),
    /// The machine refused.
    Refused(String),
    /// Samples were left out, and that was asked to be an error; how many.
    Invalid(String),
    /// All was done, and a limit that was asked for is passed.
    Passed(String),
    /// The user asked for it; all is said already.
    Interrupted,
    /// The same, and a checkpoint keeps the work.
    Checkpointed,
}

impl Failure {
    /// Something typed or loaded is wrong, with what to do about it.
    pub fn wrong(message: impl std::fmt::Display, help: impl std::fmt::Display) -> Self {
        Self::Wrong(format!("{message}\n  help: {help}"))
    }

    /// Something could not be done, with what to do about it.
    pub fn refused(message: impl std::fmt::Display, help: impl std::fmt::Display) -> Self {
        Self::Refused(format!("{message}\n  help: {help}"))
    }

    /// What to print; `None` where nothing is left to say.
    pub fn text(&self) -> Option<String> {
        match self {
            Self::Wrong(text) | Self::Refused(text) | Self::Invalid(text) | Self::Passed(text) => {
                Some(text.clone())
            }
            Self::Interrupted | Self::Checkpointed => None,
        }
    }

    /// The exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Wrong(_) => WRONG,
            Self::Refused(_) | Self::Passed(_) => FAILED,
            Self::Invalid(_) => INVALID,
            Self::Interrupted => INTERRUPTED,
            Self::Checkpointed => CHECKPOINTED,
        }
    }
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        Self::Wrong(error.to_string())
    }
}

/// What a field is asked for comes from the command line.
impl From<GuideError> for Failure {
    fn from(error: GuideError) -> Self {
        Self::Wrong(error.to_string())
    }
}

/// An image that a scene asks for is part of the scene.
impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        Self::Wrong(error.to_string())
    }
}

impl From<AccelError> for Failure {
    fn from(error: AccelError) -> Self {
        let text = error.to_string();
        match error {
            AccelError::Device(_) | AccelError::OutOfMemory { .. } | AccelError::Build { .. } => {
                Self::Refused(text)
            }
            _ => Self::Wrong(text),
        }
    }
}
