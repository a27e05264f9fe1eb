//! One line for each figure that is held.

use twintree::film::Film;

/// Figures of one test. All are printed; those beyond their limits fail the test at its end.
#[derive(Default)]
pub struct Table {
    beyond: Vec<String>,
}

impl Table {
    /// `reached` must not exceed `limit`. What is not a number exceeds every limit.
    pub fn hold(&mut self, id: &str, what: &str, who: &str, limit: f64, reached: f64) {
        let number = |x: f64| match x {
            0.0 => "0".to_owned(),
            x if (0.001..1000.0).contains(&x) => format!("{x:.4}"),
            x => format!("{x:.1e}"),
        };
        let line = format!(
            "| {id} | {what} | {who} | {} | {} |",
            number(limit),
            number(reached)
        );
        println!("{line}");
        if reached.is_nan() || reached > limit {
            self.beyond.push(line);
        }
    }

    /// No sample of the film may have been left out.
    pub fn finite(&mut self, id: &str, what: &str, who: &str, film: &Film) {
        if film.invalid_samples() > 0 {
            let first = film.first_invalid();
            self.beyond.push(format!(
                "{id} {what} {who}: {} samples are not finite, the first is {first:?}",
                film.invalid_samples()
            ));
        }
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.beyond.is_empty(), "{:#?}", self.beyond);
        }
    }
}
