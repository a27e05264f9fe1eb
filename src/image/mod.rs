//! Images: reading, writing and cached texture look-ups through Debian's OpenImageIO.

/// An image could not be read or written. Names the file and what the library said.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct ImageError {
    /// The file.
    pub path: String,
    /// What went wrong.
    pub reason: String,
}
