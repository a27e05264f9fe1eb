//! How many paths were traced for training, and how many there will be: for whoever shows progress.

use std::sync::atomic::{AtomicU64, Ordering};

/// Photons and camera paths that have been traced to learn from.
static TRACED: AtomicU64 = AtomicU64::new(0);
/// Photons that there will be in all, as things look; 0 where nothing tells yet.
static EXPECTED: AtomicU64 = AtomicU64::new(0);

/// Photons and camera paths that this program has traced so far to learn from, those of images left
/// out: for whoever shows that learning goes on.
pub fn traced() -> u64 {
    TRACED.load(Ordering::Relaxed)
}

/// Photons that there will be in all, as things look; `None` where nothing tells yet.
pub fn expected() -> Option<u64> {
    Some(EXPECTED.load(Ordering::Relaxed)).filter(|photons| *photons > 0)
}

/// Takes note of photons or camera paths that were traced.
pub(super) fn add_traced(count: u64) {
    TRACED.fetch_add(count, Ordering::Relaxed);
}

/// Takes note of how many photons there will be in all.
pub(super) fn expect_photons(count: u64) {
    EXPECTED.store(count, Ordering::Relaxed);
}
