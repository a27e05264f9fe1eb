//! Renders that are made up: what is left of them is known.

use super::*;

const SAMPLES: Goal = Goal {
    spp: 1024.0,
    seconds: None,
    noise: None,
};

/// A render of `cost(n)` seconds for sample n, whose samples have the variance `variance(n)`,
/// up to `end` samples.
fn render(end: u32, cost: impl Fn(u32) -> f64, variance: impl Fn(u32) -> f64) -> (History, Mark) {
    let mut history = History::from(0.0);
    let (mut now, mut sum, mut pass) = (Mark::default(), 0.0, 1);
    for n in 0..end {
        now.spp += 1.0;
        now.drawing += cost(n);
        sum += variance(n);
        if n + 1 == pass {
            now.noise = Some(f64::sqrt(sum) / now.spp);
            history.add(now);
            pass += pass.min(64);
        }
    }
    (history, now)
}

fn total(range: std::ops::Range<u32>, cost: impl Fn(u32) -> f64) -> f64 {
    range.map(cost).sum()
}

fn assert_near(left: Option<f64>, truth: f64) {
    let left = left.expect("it is known");
    assert!(
        (left / truth - 1.0).abs() < 0.1,
        "{left} instead of {truth}"
    );
}

#[test]
fn samples_of_one_price_are_counted() {
    let (history, now) = render(100, |_| 0.25, |_| 1.0);
    let left = history.left(&SAMPLES, now, 25.0).unwrap();
    assert!((left - 924.0 * 0.25).abs() < 1e-9, "{left}");
}

/// Guiding learns: the first passes cost four times as much a sample as the others.
#[test]
fn dear_first_passes_do_not_count_for_the_others() {
    let cost = |n| if n < 31 { 1.0 } else { 0.25 };
    let (history, now) = render(110, cost, |_| 1.0);
    assert_near(history.left(&SAMPLES, now, 0.0), total(110..1024, cost));
}

#[test]
fn what_is_left_to_learn_counts_and_what_was_learned_does_not() {
    let (mut history, now) = render(64, |_| 0.5, |_| 1.0);
    let left = |lessons| {
        history.lessons = lessons;
        history.left(&SAMPLES, now, 38.0).unwrap() - 960.0 * 0.5
    };
    let (seconds, gain) = (1.5, 0.25);
    let of = |share| Lessons {
        seconds,
        gain,
        share,
    };
    assert_eq!([0.25, 0.6, 1.0].map(of).map(left), [4.5, 3.0, 0.0]);
}

/// 64, 128 and so on up to 960 samples a pixel teach, and not the last.
#[test]
fn nothing_is_learned_for_samples_that_do_not_come() {
    let (mut history, now) = render(32, |_| 0.5, |_| 1.0);
    history.lessons = Lessons {
        seconds: 2.0,
        gain: 0.001,
        share: 0.01,
    };
    for (spp, lessons) in [
        (64.0, 0.0),
        (65.0, 2.0),
        (128.0, 2.0),
        (129.0, 4.0),
        (1024.0, 30.0),
    ] {
        let goal = Goal { spp, ..SAMPLES };
        let left = history.left(&goal, now, 22.0).unwrap();
        let drawing = (spp - 32.0) * 0.5;
        assert!((left - drawing - lessons).abs() < 1e-9, "{spp}: {left}");
    }
}

#[test]
fn looks_come_after_passes_that_double_up_to_their_largest() {
    for (end, looks) in [(1.0, 0.0), (2.0, 1.0), (3.0, 2.0), (64.0, 6.0), (65.0, 7.0)] {
        assert_eq!(looks_before(0.0, end), looks, "{end}");
    }
    assert_eq!(looks_before(960.0, 1024.0), 0.0);
    assert_eq!(look_after(0.0, 20.0), 32.0);
    assert_eq!(look_after(64.0, 400.0), 448.0);
    assert_eq!(look_after(128.0, 100.0), 128.0);
}

#[test]
fn the_limit_that_comes_first_counts() {
    let (history, now) = render(100, |_| 0.25, |_| 1.0);
    let soon = Goal {
        seconds: Some(40.0),
        ..SAMPLES
    };
    assert_eq!(history.left(&soon, now, 25.0), Some(15.0));
    assert_eq!(history.left(&soon, now, 45.0), Some(0.0));
    let late = Goal {
        seconds: Some(4000.0),
        ..SAMPLES
    };
    assert_eq!(history.left(&late, now, 25.0), Some(231.0));
    let never = Goal {
        spp: f64::INFINITY,
        ..SAMPLES
    };
    assert_eq!(history.left(&never, now, 25.0), None);
    // Before the first sample nothing tells.
    let begun = History::from(0.0);
    assert_eq!(begun.left(&SAMPLES, Mark::default(), 1.0), None);
}

/// Variance 4 a sample: a noise of 0.1 takes 400 samples, found at the look after 448.
#[test]
fn noise_falls_with_the_root_of_the_samples() {
    let (history, now) = render(64, |_| 0.5, |_| 4.0);
    let goal = Goal {
        noise: Some(0.1),
        ..SAMPLES
    };
    let left = history.left(&goal, now, 32.0).unwrap();
    assert!((left - (448.0 - 64.0) * 0.5).abs() < 1e-6, "{left}");
    let few = Goal {
        noise: Some(0.01),
        ..SAMPLES
    };
    // The samples end first.
    assert_eq!(history.left(&few, now, 32.0), Some(960.0 * 0.5));
}

/// The first samples were ten times as noisy as those that a learned field makes.
#[test]
fn samples_to_come_are_as_noisy_as_the_last() {
    let variance = |n| if n < 16 { 40.0 } else { 4.0 };
    let (history, now) = render(128, |_| 0.5, variance);
    let goal = Goal {
        noise: Some(0.1),
        ..SAMPLES
    };
    let mut needed = 128;
    while f64::sqrt(total(0..needed, variance)) / f64::from(needed) > 0.1 {
        needed += 64;
    }
    let truth = f64::from(needed - 128) * 0.5;
    assert_near(history.left(&goal, now, 64.0), truth);
}

#[test]
fn a_render_that_goes_on_counts_its_own_samples() {
    let mut history = History::from(500.0);
    let now = Mark {
        spp: 564.0,
        drawing: 32.0,
        noise: None,
    };
    history.add(now);
    assert_eq!(history.left(&SAMPLES, now, 300.0), Some(230.0));
}
