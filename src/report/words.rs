//! Numbers in words for people.

/// A large number with three digits and a unit: `950`, `1.23 M`.
pub fn count(number: f64) -> String {
    const UNITS: [&str; 5] = ["", " k", " M", " G", " T"];
    if !number.is_finite() {
        return "-".into();
    }
    scaled(number, 1000.0, &UNITS)
}

/// Errors of the means over blocks, from small to large ones; `-` where there are no such blocks.
pub fn errors_of_blocks(errors: [Option<f64>; 2]) -> String {
    let one = |e: Option<f64>| e.map_or("-".into(), super::table::number);
    errors.map(one).join(", ")
}

/// An amount of memory: `512 B`, `1.50 GiB`.
pub fn bytes(number: u64) -> String {
    scaled(
        number as f64,
        1024.0,
        &[" B", " KiB", " MiB", " GiB", " TiB"],
    )
}

/// Divides by `base` until three digits are enough. Whole numbers keep no decimals.
fn scaled(mut number: f64, base: f64, units: &[&str]) -> String {
    let mut unit = 0;
    // 999.5 would round to four digits.
    while number >= base - 0.5 && unit + 1 < units.len() {
        number /= base;
        unit += 1;
    }
    let decimals = match number {
        _ if unit == 0 => 0,
        n if n < 9.995 => 2,
        n if n < 99.95 => 1,
        _ => 0,
    };
    format!("{number:.decimals$}{}", units[unit])
}

/// A time in seconds: `0.25 s`, `12.3 s`, `2 min 05 s`, `1 h 30 min`.
pub fn time(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "-".into();
    }
    if seconds < 9.995 {
        return format!("{seconds:.2} s");
    }
    if seconds < 59.95 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    if whole < 3600 {
        return format!("{} min {:02} s", whole / 60, whole % 60);
    }
    format!("{} h {:02} min", whole / 3600, whole % 3600 / 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        for (number, expected) in [
            (0.0, "0"),
            (999.0, "999"),
            (999.7, "1.00 k"),
            (1234.0, "1.23 k"),
            (12_345.0, "12.3 k"),
            (123_456.0, "123 k"),
            (9_999_999.0, "10.0 M"),
            (f64::INFINITY, "-"),
        ] {
            assert_eq!(count(number), expected);
        }
        assert_eq!(bytes(1023), "1023 B");
        assert_eq!(bytes(1536), "1.50 KiB");
        assert_eq!(bytes(u64::MAX), "16777216 TiB");
    }

    #[test]
    fn times_grow_their_units() {
        for (seconds, expected) in [
            (0.0, "0.00 s"),
            (12.34, "12.3 s"),
            (59.99, "1 min 00 s"),
            (125.0, "2 min 05 s"),
            (5400.0, "1 h 30 min"),
        ] {
            assert_eq!(time(seconds), expected);
        }
    }
}
