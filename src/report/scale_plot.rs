//! The curves of `twintree bench scale` as SVG: seconds, memory and rays over the number of
//! triangles, on logarithmic axes, where n log n is all but a straight line.

use super::scale::{ScaleBench, TracerRow};
use plotters::coord::combinators::IntoLogRange;
use plotters::prelude::*;

/// Size of the drawing, pixels.
const SIZE: (u32, u32) = (1200, 420);
/// Colours that readers with any colour vision tell apart (Okabe and Ito 2008).
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];
/// What stays in the background.
const GUIDE: RGBColor = RGBColor(150, 150, 150);
const GRID: RGBColor = RGBColor(225, 225, 225);

struct Curve {
    name: String,
    color: RGBColor,
    points: Vec<(f64, f64)>,
}

/// Draws the curves.
///
/// # Errors
/// When there is nothing to draw.
pub fn draw(report: &ScaleBench) -> Result<String, String> {
    let mut svg = String::new();
    let panels = [
        ("seconds", seconds(report)),
        ("bytes a triangle", memory(report)),
        ("million rays a second", rates(report)),
    ];
    let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(|e| e.to_string())?;
    for (area, (name, curves)) in root.split_evenly((1, panels.len())).iter().zip(&panels) {
        panel(area, name, curves).map_err(|e| e.to_string())?;
    }
    root.present().map_err(|e| e.to_string())?;
    drop(root);
    Ok(svg)
}

/// A curve over all sizes.
fn over_sizes(
    report: &ScaleBench,
    name: &str,
    color: RGBColor,
    value: impl Fn(&super::scale::SizeRow) -> f64,
) -> Curve {
    let points = report.sizes.iter().map(|s| (s.triangles as f64, value(s)));
    Curve {
        name: name.to_owned(),
        color,
        points: points.collect(),
    }
}

/// A curve over the sizes at which a ray tracer was measured.
fn of_tracer(
    report: &ScaleBench,
    tracer: &str,
    what: &str,
    color: RGBColor,
    value: impl Fn(&TracerRow, f64) -> f64,
) -> Curve {
    let points = report.sizes.iter().filter_map(|size| {
        let row = size.tracers.iter().find(|t| t.name == tracer)?;
        let triangles = size.triangles as f64;
        Some((triangles, value(row, triangles)))
    });
    Curve {
        name: format!("{tracer}{what}"),
        color,
        points: points.collect(),
    }
}

fn color(i: usize) -> RGBColor {
    COLORS[i % COLORS.len()]
}

fn seconds(report: &ScaleBench) -> Vec<Curve> {
    let mut curves = vec![
        over_sizes(report, "load", color(0), |s| s.load_seconds),
        over_sizes(report, "read and copy", color(4), |s| s.floor_seconds),
    ];
    for (i, name) in report.tracer_names().into_iter().enumerate() {
        let curve = of_tracer(report, name, ", build", color(1 + i), |t, _| {
            t.build_seconds
        });
        curves.push(curve);
    }
    // Through the last of the first tracer's points: what grows faster stands out.
    if let Some((at, seconds)) = curves.get(2).and_then(|c| c.points.last().copied()) {
        let scale = seconds / (at * at.ln());
        let mut guide = over_sizes(report, "n log n", GUIDE, |_| 0.0);
        for point in &mut guide.points {
            point.1 = scale * point.0 * point.0.ln();
        }
        curves.push(guide);
    }
    curves
}

fn memory(report: &ScaleBench) -> Vec<Curve> {
    let mesh = over_sizes(report, "mesh", color(0), |s| {
        s.mesh_bytes as f64 / s.triangles.max(1) as f64
    });
    let names = report.tracer_names().into_iter().enumerate();
    let trees = names.map(|(i, name)| {
        of_tracer(report, name, "", color(1 + i), |t, n| {
            t.memory_bytes as f64 / n
        })
    });
    std::iter::once(mesh).chain(trees).collect()
}

fn rates(report: &ScaleBench) -> Vec<Curve> {
    let names = report.tracer_names().into_iter().enumerate();
    let both = names.flat_map(|(i, name)| {
        let camera = of_tracer(report, name, ", camera", color(1 + i), |t, _| {
            1e-6 * t.camera
        });
        let diffuse = of_tracer(report, name, ", diffuse", color(4 + i), |t, _| {
            1e-6 * t.diffuse
        });
        [camera, diffuse]
    });
    both.collect()
}

/// The range of positive numbers, with a margin.
fn range(numbers: impl Iterator<Item = f64>, margin: f64) -> Option<(f64, f64)> {
    let positive = numbers.filter(|x| *x > 0.0 && x.is_finite());
    let (least, most) = positive.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| {
        (a.min(x), b.max(x))
    });
    (least <= most).then_some((least / margin, most * margin))
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn panel(area: &Area, name: &str, curves: &[Curve]) -> Result<(), Box<dyn std::error::Error>> {
    let points = || curves.iter().flat_map(|c| &c.points);
    let (Some(x), Some(y)) = (
        range(points().map(|p| p.0), 1.3),
        // Room above for the names of the curves.
        range(points().map(|p| p.1), 1.6),
    ) else {
        return Err("there is nothing to draw".into());
    };
    let mut chart = ChartBuilder::on(area)
        .caption(name, ("sans-serif", 16))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("triangles")
        .x_label_formatter(&|n| super::words::count(*n).replace(".00", ""))
        .y_label_formatter(&|y| short(*y))
        .x_labels(6)
        .y_labels(8)
        .bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .draw()?;
    for curve in curves {
        let style = curve.color.stroke_width(2);
        chart
            .draw_series(LineSeries::new(curve.points.iter().copied(), style))?
            .label(curve.name.clone())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    Ok(())
}

/// A number on an axis: `0.01`, `20`.
fn short(x: f64) -> String {
    match x {
        x if x < 1e-3 => format!("{x:.0e}"),
        x if x < 1.0 => format!("{x:.3}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        x => format!("{x:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::scale::SizeRow;
    use super::*;

    fn report() -> ScaleBench {
        let size = |triangles: u64| SizeRow {
            triangles,
            vertices: triangles / 2,
            file_bytes: 19 * triangles,
            mesh_bytes: 24 * triangles,
            floor_seconds: 1e-8 * triangles as f64,
            read_seconds: 1e-8 * triangles as f64,
            load_seconds: 2e-8 * triangles as f64,
            tracers: vec![TracerRow {
                name: "a < b".into(),
                build_seconds: 1e-7 * triangles as f64,
                memory_bytes: 80 * triangles,
                camera: 2e7,
                shadow: 2e7,
                diffuse: 1e7,
            }],
        };
        ScaleBench {
            version: "0".into(),
            shape: "terrain".into(),
            threads: 2,
            sizes: vec![size(1000), size(4000), size(16_000)],
        }
    }

    #[test]
    fn a_drawing_has_its_panels_and_curves() {
        let svg = draw(&report()).unwrap();
        for part in ["seconds", "bytes a triangle", "n log n", "a &lt; b, build"] {
            assert!(svg.contains(part), "{part} is missing");
        }
        // Three panels of 4 or 5, 2 and 2 curves.
        assert!(svg.matches("<polyline").count() >= 8, "{svg}");
        let empty = ScaleBench {
            sizes: Vec::new(),
            ..report()
        };
        assert!(draw(&empty).is_err());
    }

    #[test]
    fn the_table_has_a_row_for_each_tracer_and_size() {
        let table = report().to_table();
        assert_eq!(table.matches("a < b").count(), 3, "{table}");
        assert!(table.contains("| 1.00 k"), "{table}");
    }
}
