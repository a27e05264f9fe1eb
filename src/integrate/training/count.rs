//! How many paths were traced for training: for whoever shows progress.

use std::sync::atomic::{AtomicU64, Ordering};

/// Photons and camera paths that have been traced to learn from.
static TRACED: AtomicU64 = AtomicU64::new(0);

/// Photons and camera paths that this program has traced so far to learn from, those of images left
/// out: for whoever shows that learning goes on.
pub fn traced() -> u64 {
    TRACED.load(Ordering::Relaxed)
}

/// Takes note of photons or camera paths that were traced.
pub(super) fn add_traced(count: u64) {
    TRACED.fetch_add(count, Ordering::Relaxed);
}
