//! Files and directories that must not outlive the program, whichever way it ends.
//!
//! Destructors take them away when a function returns. A program that is told to quit at once runs
//! none: [`clear`] takes away what is left then.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What has been made and not yet taken away.
static LEFT: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn left() -> MutexGuard<'static, Vec<PathBuf>> {
    LEFT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Stands for a file or directory as long as that is there for a while only. It does not take it
/// away: that is its maker's business.
#[derive(Debug)]
pub struct Passing(PathBuf);

impl Passing {
    /// Makes something and notes its path. No end of the program can come between the two.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn make<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<(T, Self)> {
        let mut left = left();
        let made = make()?;
        let path = made.as_ref().to_owned();
        left.push(path.clone());
        Ok((made, Self(path)))
    }
}

impl Drop for Passing {
    fn drop(&mut self) {
        left().retain(|path| *path != self.0);
    }
}

/// Takes away all that is left, for a program that ends now: nothing more can be made after that.
pub fn clear() {
    let mut left = left();
    for path in left.drain(..) {
        // Whatever fails is gone already, or cannot be helped.
        let _ = match path.is_dir() {
            true => std::fs::remove_dir_all(&path),
            false => std::fs::remove_file(&path),
        };
    }
    // Whoever wants to make a file now waits for the end.
    std::mem::forget(left);
}
