//! Sections of the page: curves, what each setting does, tables.

use super::Sweep;
use super::analysis::{Findings, FrontPoint};
use super::curve::Scale;
use super::finding::{Finding, Speed};
use super::html::{escape, table};
use super::plot::{BASE, FAINT, LINES, Line, log_log};
use crate::report::table::number;
use crate::report::words;
use plotters::style::RGBColor;

/// Sizes of a drawing: for wide and for narrow screens. The style sheet shows one of them.
const SIZES: [(&str, (u32, u32)); 2] = [("wide", (760, 400)), ("narrow", (350, 320))];

/// A drawing for screens of either width.
fn drawing(name: &str, lines: &[Line]) -> String {
    let draw = |(class, size): (&str, (u32, u32))| {
        let svg = log_log(size, name, lines).unwrap_or_default();
        format!("<div class=\"plot {class}\">{svg}</div>\n")
    };
    SIZES.map(draw).concat()
}

/// Size of a drawing of a coarser scale: two fit beside each other.
const SMALL: (u32, u32) = (350, 240);

/// The same lines at the coarser scales, side by side; nothing where the images are too small.
fn drawings_of_blocks(name: &str, base: Option<&Finding>, own: &[&Finding]) -> String {
    let draw = |scale: Scale| {
        let curve = |f: &Finding| {
            let of = f.blocks.iter().find(|b| b.scale == scale)?;
            Some(of.curve.0.clone())
        };
        let mut curves: Vec<_> = base
            .and_then(curve)
            .map(|c| (c, BASE))
            .into_iter()
            .collect();
        let others = own.iter().enumerate();
        curves.extend(others.filter_map(|(i, f)| Some((curve(f)?, color(i)))));
        let lines: Vec<Line> = curves.iter().map(|(c, color)| line(c, *color, 2)).collect();
        let what = scale.name();
        let svg = log_log(
            SMALL,
            &format!("Error of {what} over time by {name}"),
            &lines,
        )?;
        Some(format!(
            "<figure class=\"plot\">{svg}<figcaption>{what}</figcaption></figure>\n"
        ))
    };
    let drawings = [Scale::Blocks4, Scale::Blocks16]
        .into_iter()
        .filter_map(draw);
    let drawings: String = drawings.collect();
    match drawings.is_empty() {
        true => drawings,
        false => format!("<div class=\"scales\">{drawings}</div>\n"),
    }
}

/// An entry of a legend; its text is HTML.
fn entry(class: &str, text: &str) -> String {
    format!("<li><span class=\"swatch {class}\"></span>{text}</li>\n")
}

/// All curves, and the front that none of them passes.
pub fn overview(findings: &Findings) -> String {
    let stretches = stretches(&findings.front);
    let mut lines: Vec<Line> = findings
        .configurations
        .iter()
        .map(|f| line(&f.curve.0, FAINT, 1))
        .collect();
    let points: Vec<Vec<[f64; 2]>> = stretches
        .iter()
        .map(|s| s.iter().map(|p| [p.seconds, p.error]).collect())
        .collect();
    let names = front_names(&stretches);
    let place = |name: &str| names.iter().position(|n| n == name).unwrap_or(0);
    for (stretch, points) in stretches.iter().zip(&points) {
        let name = stretch.first().map_or("", |p| p.name.as_str());
        lines.push(Line {
            dots: true,
            ..line(points, color(place(name)), 3)
        });
    }
    let entries: String = names
        .iter()
        .enumerate()
        .map(|(i, name)| entry(&class(i), &held(name, &stretches)))
        .collect();
    let drawing = drawing(
        "Error over time of every configuration, and the front of the best",
        &lines,
    );
    format!(
        "{drawing}<ul class=\"legend\">{entries}{}</ul>",
        entry("faint", "all configurations, each a median of its runs")
    )
}

fn line(points: &[[f64; 2]], color: RGBColor, width: u32) -> Line<'_> {
    Line {
        points,
        color,
        width,
        // A line of one point is not seen.
        dots: points.len() < 3,
    }
}

/// Colours come around again where there are more lines.
fn color(i: usize) -> RGBColor {
    LINES[i % LINES.len()]
}

fn class(i: usize) -> String {
    format!("line{}", i % LINES.len())
}

/// The front cut where it goes over from one configuration to another.
fn stretches(front: &[FrontPoint]) -> Vec<&[FrontPoint]> {
    front.chunk_by(|a, b| a.name == b.name).collect()
}

/// The configurations of the front, each once.
fn front_names(stretches: &[&[FrontPoint]]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for point in stretches.iter().filter_map(|s| s.first()) {
        if !names.contains(&point.name) {
            names.push(point.name.clone());
        }
    }
    names
}

/// When a configuration is ahead.
fn held(name: &str, stretches: &[&[FrontPoint]]) -> String {
    let own = stretches
        .iter()
        .filter(|s| s.first().is_some_and(|p| p.name == name));
    let spans = own.filter_map(|s| {
        let (first, last) = (s.first()?, s.last()?);
        let (from, to) = (words::time(first.seconds), words::time(last.seconds));
        Some(if from == to {
            format!("at {from}")
        } else {
            format!("from {from} to {to}")
        })
    });
    let spans: Vec<String> = spans.collect();
    format!("<b>{}</b>, ahead {}", escape(name), spans.join(", "))
}

/// What each setting does, one after the other.
pub fn knobs(sweep: &Sweep, findings: &Findings) -> String {
    let plan = &sweep.setting.configurations;
    let Some(first) = plan.first() else {
        return String::new();
    };
    let mut knobs: Vec<&str> = Vec::new();
    for configuration in &plan[1..] {
        if !knobs.contains(&configuration.knob.as_str()) {
            knobs.push(&configuration.knob);
        }
    }
    let base = findings.get(&first.name);
    let section = |knob: &str| {
        let own = plan[1..].iter().filter(|c| c.knob == knob);
        let own: Vec<&Finding> = own.filter_map(|c| findings.get(&c.name)).collect();
        (!own.is_empty()).then(|| self::knob(knob, base, &own))
    };
    knobs.into_iter().filter_map(section).collect()
}

fn knob(name: &str, base: Option<&Finding>, own: &[&Finding]) -> String {
    let mut lines: Vec<Line> = base.iter().map(|f| line(&f.curve.0, BASE, 2)).collect();
    lines.extend(
        own.iter()
            .enumerate()
            .map(|(i, f)| line(&f.curve.0, color(i), 2)),
    );
    let mut entries: String = base
        .iter()
        .map(|f| entry("base", &format!("<b>{}</b>", escape(&f.name))))
        .collect();
    for (i, finding) in own.iter().enumerate() {
        let said = finding
            .speed
            .map_or("not comparable".into(), |s| compared(&s, finding.runs));
        entries += &entry(
            &class(i),
            &format!("<b>{}</b>: {said}", escape(&finding.name)),
        );
    }
    let drawing = drawing(&format!("Error over time by {name}"), &lines)
        + &drawings_of_blocks(name, base, own);
    format!(
        "<article><h3>{}</h3><p>{}</p>{drawing}<ul class=\"legend\">{entries}</ul></article>\n",
        escape(name),
        verdict(own)
    )
}

/// What to do about a setting.
fn verdict(own: &[&Finding]) -> String {
    let clear = |faster: bool| {
        let list = own.iter().filter(move |f| {
            let speed = f.speed.filter(|s| s.clear);
            speed.is_some_and(|s| (s.median > 1.0) == faster)
        });
        let mut list: Vec<&&Finding> = list.collect();
        list.sort_by(|a, b| {
            let speed = |f: &Finding| f.speed.map_or(1.0, |s| s.median);
            speed(b).total_cmp(&speed(a))
        });
        list
    };
    let (faster, slower) = (clear(true), clear(false));
    if let Some(best) = faster.first() {
        return format!(
            "<strong>Worth changing:</strong> {} gets there faster.",
            escape(&best.name)
        );
    }
    match (slower.len(), own.len()) {
        (0, _) => "Makes no clear difference here.".into(),
        (n, all) if n == all => "Leave it: everything else is slower.".into(),
        _ => "Leave it: nothing that was tried is clearly faster, and some is slower.".into(),
    }
}

fn compared(speed: &Speed, runs: usize) -> String {
    let span = match runs {
        0 | 1 => "one run".into(),
        n => format!("{:.2} to {:.2} over {n} runs", speed.least, speed.most),
    };
    match (speed.clear, speed.median) {
        (false, m) => format!("no clear difference, {m:.2} times as fast ({span})"),
        (true, m) if m > 1.0 => {
            format!("<strong>{m:.2} times as fast</strong> to the same error ({span})")
        }
        (true, m) => format!(
            "takes {:.2} times as long to the same error ({:.2} times as fast; {span})",
            1.0 / m,
            m
        ),
    }
}

/// A bar behind a number: `share` of the cell's width.
fn bar(share: f64, text: &str) -> String {
    let percent = (100.0 * share).clamp(0.0, 100.0);
    format!("<span class=\"bar\" style=\"--share:{percent:.1}%\">{text}</span>")
}

/// How fast in a cell of the table.
fn ratio(speed: Option<Speed>) -> String {
    speed.map_or("-".into(), |s| {
        format!("{:.2}{}", s.median, if s.clear { "" } else { " ?" })
    })
}

/// A row a configuration, the best first.
pub fn everything(findings: &Findings) -> String {
    let mut list: Vec<&Finding> = findings.configurations.iter().collect();
    list.sort_by(|a, b| a.error.total_cmp(&b.error));
    let largest = |of: &dyn Fn(&Finding) -> f64| list.iter().map(|f| of(f)).fold(1e-9, f64::max);
    let (error, peak, field) = (
        largest(&|f| f.error),
        largest(&|f| f.peak_memory_bytes.unwrap_or(0.0)),
        largest(&|f| f.field_memory_bytes),
    );
    let blocks = |f: &Finding, scale| {
        let of = f.blocks.iter().find(|b| b.scale == scale);
        ratio(of.and_then(|b| b.speed))
    };
    let row = |f: &&Finding| {
        let peak_text = f
            .peak_memory_bytes
            .map_or("-".into(), |b| words::bytes(b as u64));
        vec![
            escape(&f.name),
            bar(f.error / error, &number(f.error)),
            format!(
                "{} to {}",
                number(f.error_range[0]),
                number(f.error_range[1])
            ),
            number(f.relmse),
            ratio(f.speed),
            blocks(f, Scale::Blocks4),
            blocks(f, Scale::Blocks16),
            format!("{:.0}", f.spp),
            bar(f.train_share, &format!("{:.0} %", 100.0 * f.train_share)),
            words::time(f.build_seconds),
            bar(f.peak_memory_bytes.unwrap_or(0.0) / peak, &peak_text),
            bar(
                f.field_memory_bytes / field,
                &words::bytes(f.field_memory_bytes as u64),
            ),
            words::bytes(f.accel_memory_bytes as u64),
            match f.failures {
                0 => f.runs.to_string(),
                n => format!("{} ({n} failed)", f.runs),
            },
        ]
    };
    let rows: Vec<Vec<String>> = list.iter().map(row).collect();
    let head = [
        "configuration",
        "relMSE trimmed",
        "of its runs",
        "relMSE",
        "speed",
        "4x4",
        "16x16",
        "spp",
        "learning",
        "build",
        "peak memory",
        "field",
        "ray tracer",
        "runs",
    ];
    format!(
        "<p>Errors after {}, the time that all runs have reached; <i>relMSE</i>, <i>spp</i> and memory at the \
         end. <i>Speed</i> is against the first configuration of the plan, by the errors of pixels and of means \
         over blocks; a question mark says that the runs do not agree on it.</p>{}",
        words::time(findings.seconds),
        table("all configurations", &head, &rows)
    )
}

/// The fields that were learned.
pub fn fields(sweep: &Sweep) -> String {
    let rows = sweep.setting.configurations.iter().filter_map(|c| {
        let (_, stats) = sweep.runs_of(&c.name).last()?;
        let field = stats.field.as_ref()?;
        let paid = stats.trial.map_or("not tried".into(), |t| {
            let ratio = t.unguided / t.guided.max(f64::MIN_POSITIVE);
            format!("{} / {}", number(ratio), number(t.light_found))
        });
        Some(vec![
            escape(&c.name),
            words::count(field.space_cells as f64),
            words::count(field.links as f64),
            format!("{:.1}", field.links_per_cell),
            words::bytes(stats.field_memory_bytes),
            words::bytes(field.training_bytes),
            paid,
        ])
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return "<p>No run has learned a field.</p>".into();
    }
    let head = [
        "configuration",
        "cells of space",
        "links",
        "links a point",
        "field",
        "while learning",
        "trial: variance saved / light found unguided",
    ];
    table("the learned fields", &head, &rows)
}
