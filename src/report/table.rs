//! Tables in Markdown, aligned so that they read well in a terminal, too.

use std::fmt::Write as _;

/// A table: a head and rows of as many cells. The first column is for names and stands left,
/// numbers stand right.
pub fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let length = |text: &str| text.chars().count();
    let widths: Vec<usize> = head
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let cells = rows.iter().filter_map(|row| row.get(i));
            cells
                .map(|c| length(c))
                .fold(length(name).max(2), usize::max)
        })
        .collect();
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (i, (name, width)) in head.iter().zip(&widths).enumerate() {
        let _ = if i == 0 {
            write!(text, "| {name:<width$} |")
        } else {
            write!(text, " {name:>width$} |")
        };
    }
    text.push('\n');
    for (i, width) in widths.iter().enumerate() {
        let dashes = "-".repeat(width - usize::from(i > 0));
        let _ = if i == 0 {
            write!(text, "| {dashes} |")
        } else {
            write!(text, " {dashes}: |")
        };
    }
    text.push('\n');
    for row in rows {
        for (i, (cell, width)) in row.iter().zip(&widths).enumerate() {
            // A bar would end the cell.
            let cell = cell.replace('|', "/");
            let _ = if i == 0 {
                write!(text, "| {cell:<width$} |")
            } else {
                write!(text, " {cell:>width$} |")
            };
        }
        text.push('\n');
    }
    text
}

/// A number in four digits: `0.01234`, `12.34`, `1.234e-6`; `inf` and `-` for what is none.
pub fn number(x: f64) -> String {
    if x.is_nan() {
        return "-".into();
    }
    if x.is_infinite() {
        return if x > 0.0 { "inf" } else { "-inf" }.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{x:.3e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_numbers_stand_right() {
        let rows =
            [["a.exr", "1.5"], ["longer.exr", "0.125"]].map(|r| r.map(String::from).to_vec());
        let expected = "| image      |    L1 |\n\
                        | ---------- | ----: |\n\
                        | a.exr      |   1.5 |\n\
                        | longer.exr | 0.125 |\n";
        assert_eq!(markdown(&["image", "L1"], &rows), expected);
    }

    #[test]
    fn numbers_have_four_digits() {
        for (x, expected) in [
            (0.0, "0"),
            (0.0123456, "0.01235"),
            (1.0, "1.000"),
            (-12.3456, "-12.35"),
            (123456.7, "123457"),
            (1.2345e-6, "1.234e-6"),
            (5e9, "5.000e9"),
            (f64::NAN, "-"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(x), expected);
        }
    }
}
