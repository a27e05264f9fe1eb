//! A thread that dies in the middle of a render: the render ends, and nothing that it held is
//! spoiled.

use crate::scenes::{backends, differing_pixels, room, seed};
use crate::table::Table;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};
use twintree::film::Film;
use twintree::integrate::progress::{Limits, Observer, Progress, Spent};
use twintree::integrate::render::{render, resume};

/// Panics on the thread that asks for the tile of that number.
struct Bomb {
    asked: AtomicU32,
    at: u32,
}

impl Observer for Bomb {
    fn pass_done(&self, _: &Progress, _: &Film) {}

    fn should_stop(&self) -> bool {
        let asked = self.asked.fetch_add(1, Ordering::Relaxed);
        assert!(asked != self.at, "the thread dies, as the test wants");
        false
    }
}

/// The film of a render that panicked holds whole tiles alone: it goes on to the bits of a render
/// that was left in peace, with the same scene and on the same threads.
#[test]
fn a_thread_that_dies_spoils_nothing() {
    let limits = |spp| Limits {
        spp,
        time: None,
        noise: None,
    };
    let mut table = Table::default();
    for (name, backend) in backends() {
        let built = room(backend);
        let path = seed(1);
        let view = built.view(&path, None);
        let (reference, _) = built.render(&path, 32);
        let mut film = Film::new(&built.film);
        // Four tiles are asked for anew each time.
        for (spp, at) in [(8, 0), (16, 1), (32, 3)] {
            let asked = AtomicU32::new(0);
            let bomb = Bomb { asked, at };
            let died = catch_unwind(AssertUnwindSafe(|| {
                render(&view, &mut film, &limits(spp), &bomb);
            }));
            assert!(died.is_err(), "the panic of tile {at} reaches the caller");
        }
        let asked = AtomicU32::new(0);
        let never = Bomb {
            asked,
            at: u32::MAX,
        };
        resume(
            &view,
            None,
            &mut film,
            &limits(32),
            Spent::default(),
            &never,
        );
        let what = "a thread that dies thrice, and a render that goes on: pixels of other bits";
        table.hold("S22", what, name, 0.0, differing_pixels(&reference, &film));
    }
}
