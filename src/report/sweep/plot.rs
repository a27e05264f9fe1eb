//! Curves drawn as SVG on log axes.
//!
//! Colours are those of the page's style sheet, which knows light and dark: what is written here
//! are names for them, which the style sheet looks for.

use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

/// A name of a colour.
const fn named(number: u8) -> RGBColor {
    RGBColor(0, 0, number)
}

/// Words.
const TEXT: RGBColor = named(1);
/// Axes.
const AXIS: RGBColor = named(2);
/// Lines of the grid.
const GRID: RGBColor = named(3);
/// More labels on an axis would stand in each other's way.
const MOST_LABELS: usize = 7;
/// What stays in the background.
pub const FAINT: RGBColor = named(4);
/// What others are compared with.
pub const BASE: RGBColor = named(5);
/// Lines that are told apart.
pub const LINES: [RGBColor; 6] = [
    named(11),
    named(12),
    named(13),
    named(14),
    named(15),
    named(16),
];

/// A curve.
pub struct Line<'a> {
    /// Seconds and errors, all positive.
    pub points: &'a [[f64; 2]],
    /// Name of its colour.
    pub color: RGBColor,
    /// Width in pixels.
    pub width: u32,
    /// Dots on its points.
    pub dots: bool,
}

/// A drawing of `size` pixels with a name for those who do not see it; `None` where there is
/// nothing to draw.
pub fn log_log(size: (u32, u32), name: &str, lines: &[Line]) -> Option<String> {
    let all = || lines.iter().flat_map(|l| l.points);
    let (x, y) = (range(all().map(|p| p[0]))?, range(all().map(|p| p[1]))?);
    let mut svg = String::new();
    // Drawing into a string cannot fail.
    draw(&mut svg, size, (x, y), lines).ok()?;
    let label = super::html::escape(name);
    // Inside a page its name space is known, and a page without addresses is seen to need no
    // network.
    let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    Some(svg.replacen(
        "<svg ",
        &format!("<svg role=\"img\" aria-label=\"{label}\" "),
        1,
    ))
}

type Range = (f64, f64);

/// The range of positive numbers, with a margin.
fn range(numbers: impl Iterator<Item = f64>) -> Option<Range> {
    let (least, most) = numbers.fold((f64::INFINITY, 0.0), |(a, b): Range, x| {
        (a.min(x), b.max(x))
    });
    (least <= most).then_some((least / 1.2, most * 1.2))
}

fn draw(
    svg: &mut String,
    size: (u32, u32),
    (x, y): (Range, Range),
    lines: &[Line],
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, size).into_drawing_area();
    let font = |pixels: u32| ("sans-serif", pixels).into_font().color(&TEXT);
    let mut chart = ChartBuilder::on(&root)
        .margin(6)
        .margin_right(14)
        .x_label_area_size(40)
        .y_label_area_size(62)
        .build_cartesian_2d(
            (x.0..x.1).log_scale().with_key_points(labels(x)),
            (y.0..y.1).log_scale().with_key_points(labels(y)),
        )?;
    chart
        .configure_mesh()
        .x_desc("seconds")
        .y_desc("relMSE")
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .label_style(font(14))
        .axis_desc_style(font(15))
        .axis_style(AXIS)
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .draw()?;
    for line in lines {
        let style = line.color.stroke_width(line.width);
        let points = || line.points.iter().map(|p| (p[0], p[1]));
        chart.draw_series(LineSeries::new(points(), style))?;
        if line.dots {
            let dot = |at| Circle::new(at, line.width + 1, line.color.filled());
            chart.draw_series(points().map(dot))?;
        }
    }
    root.present()?;
    Ok(())
}

/// Where a logarithmic axis has labels: at 1, 2 and 5 times the powers of ten, or at these alone.
fn labels(range: Range) -> Vec<f64> {
    let powers = range.0.log10().floor() as i32..=range.1.log10().ceil() as i32;
    let of = |steps: &[f64]| {
        let all = powers.clone().map(|p| 10f64.powi(p));
        let all = all.flat_map(|p| steps.iter().map(move |s| s * p));
        let inside = all.filter(|x| (range.0..=range.1).contains(x));
        inside.collect::<Vec<f64>>()
    };
    let many = of(&[1.0, 2.0, 5.0]);
    if many.len() > MOST_LABELS {
        return of(&[1.0]);
    }
    many
}

/// A number on an axis: `0.05`, `20`, `1e-5`.
fn short(x: f64) -> String {
    let digits = |text: String| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    };
    match x {
        x if !(1e-3..1e5).contains(&x) => format!("{x:.0e}"),
        x if x < 1.0 => digits(format!("{x:.4}")),
        x => digits(format!("{x:.1}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_has_a_name_and_every_line() {
        let points = [[0.1, 0.3], [1.0, 0.03], [10.0, 0.004]];
        let line = |color| Line {
            points: &points,
            color,
            width: 2,
            dots: false,
        };
        let svg = log_log((400, 300), "a < b", &[line(BASE), line(LINES[2])]).unwrap();
        assert!(svg.starts_with("<svg role=\"img\" aria-label=\"a &lt; b\""));
        for color in ["#000005", "#00000D", "#000001", "#000003"] {
            assert!(svg.contains(color), "{color}");
        }
        assert!(
            svg.contains(">seconds<") || svg.contains("seconds\n"),
            "{svg}"
        );
        assert!(log_log((400, 300), "", &[]).is_none());
    }

    #[test]
    fn numbers_on_axes_are_short() {
        let numbers = [
            (0.05, "0.05"),
            (1.0, "1"),
            (20.0, "20"),
            (1e-5, "1e-5"),
            (2.5, "2.5"),
        ];
        for (x, expected) in numbers {
            assert_eq!(short(x), expected);
        }
    }
}
