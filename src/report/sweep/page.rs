//! `index.html`: the template beside this file, filled in. One file, which needs no network and no
//! other file beside it.

use super::analysis::Findings;
use super::html::{escape, table};
use super::pictures::{Picture, Pictures};
use super::sections;
use super::{Clock, Sweep};
use crate::report::table::number;
use crate::report::words;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page.
pub fn page(sweep: &Sweep, findings: &Findings, pictures: &Pictures) -> String {
    let scene = sweep.setting.scene.as_str();
    let conclusion = sentence(sweep, findings, |w| format!("<code>{}</code>", escape(w)));
    let parts = [
        ("style", STYLE.to_owned()),
        ("script", SCRIPT.to_owned()),
        ("scene", escape(scene)),
        ("conclusion", conclusion),
        ("caveats", caveats(sweep, findings)),
        ("overview", sections::overview(findings)),
        ("knobs", sections::knobs(sweep, findings)),
        ("table", sections::everything(findings)),
        ("pictures", gallery(pictures, findings)),
        ("options", choices(pictures)),
        ("slider", slider(pictures)),
        ("field", sections::fields(sweep)),
        ("machine", machine(sweep)),
        ("failures", failures(sweep)),
        ("command", escape(&sweep.command)),
        ("commands", commands(sweep)),
    ];
    fill(TEMPLATE, &parts)
}

/// Puts the parts where the template names them: `{{name}}`. What is put in is not looked at again.
fn fill(template: &str, parts: &[(&str, String)]) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        text += before;
        let Some((name, after)) = after.split_once("}}") else {
            break;
        };
        let part = parts.iter().find(|p| p.0 == name);
        text += part.map_or("", |p| p.1.as_str());
        rest = after;
    }
    text + rest
}

/// The sentence that says what to use, as plain text.
pub fn conclusion(sweep: &Sweep, findings: &Findings) -> String {
    sentence(sweep, findings, str::to_owned)
}

fn sentence(sweep: &Sweep, findings: &Findings, code: impl Fn(&str) -> String) -> String {
    let advice = findings.advice.iter().map(|a| {
        let mut list = sweep.setting.configurations.iter();
        let options = list.find(|c| c.name == a.name).map(|c| c.options.join(" "));
        let options = match options.as_deref() {
            None | Some("") => "no options".to_owned(),
            Some(options) => code(options),
        };
        let about = if a.measured { "" } else { "about " };
        let article = if a.purpose == "draft" {
            "a draft"
        } else {
            a.purpose
        };
        let article = match article {
            "normal" => "a normal render",
            "final" => "a final render",
            other => other,
        };
        format!(
            "for {article} (noise {:.0} %) use {options}, which takes {about}{}",
            100.0 * a.noise,
            words::time(a.seconds)
        )
    });
    let list: Vec<String> = advice.collect();
    let size = &sweep.setting.reference;
    let threads = sweep.runs.iter().filter_map(|r| r.stats.as_ref());
    let threads = threads.map(|s| s.threads).next().unwrap_or(0);
    format!(
        "Of {} at {} x {} pixels on {threads} threads: {}.",
        code(&sweep.setting.scene),
        size.width,
        size.height,
        list.join("; ")
    )
}

/// What weakens the conclusion, a paragraph each.
fn caveats(sweep: &Sweep, findings: &Findings) -> String {
    let mut list = Vec::new();
    let total = sweep.setting.configurations.len() * sweep.setting.rounds as usize;
    if sweep.runs.len() < total {
        list.push(format!(
            "{} of {total} runs were made: the same command goes on with the others.",
            sweep.runs.len()
        ));
    }
    if findings.configurations.iter().all(|f| f.runs < 2) {
        list.push("Every configuration ran once: no difference can be called clear.".into());
    }
    if sweep.setting.clock == Clock::Processors {
        list.push(
            "Times are what the processors spent, divided by the threads: what one would wait at the least \
             if nothing else ran."
                .into(),
        );
    } else if let Some(share) = findings.processor_share.filter(|s| *s < 0.8) {
        list.push(format!(
            "The machine was busy with other things: one of the runs got {:.0} % of the processors. \
             Runs of a round stand close together, so that comparisons suffer less than times; \
             --clock processors goes by what the processors spent.",
            100.0 * share
        ));
    }
    if findings.advice.iter().any(|a| !a.measured) {
        list.push(
            "Times that begin with “about” lie beyond the runs: they assume that the error halves as time \
             doubles."
                .into(),
        );
    }
    match sweep.setting.reference.relmse {
        None => list.push(
            "The reference has no variance layer, so nobody knows how clean it is: render it with \
             --aov variance."
                .into(),
        ),
        Some(own) if findings.advice.iter().any(|a| !a.certain) => list.push(format!(
            "The reference itself has a relMSE of {}: errors near that say nothing, and times for the \
             final render are too long. A cleaner reference helps.",
            number(own)
        )),
        Some(_) => {}
    }
    let items = list.iter().map(|c| format!("<li>{}</li>", escape(c)));
    match list.is_empty() {
        true => String::new(),
        false => format!("<ul class=\"caveats\">{}</ul>", items.collect::<String>()),
    }
}

fn image(picture: &Picture, data: &str, alt: &str, id: &str) -> String {
    let (width, height) = picture.size;
    // Few pixels are drawn large, and are to be seen as they are.
    let class = if width < 320 { "small" } else { "large" };
    format!(
        "<img class=\"{class}\" id=\"{id}\" src=\"{data}\" width=\"{width}\" height=\"{height}\" alt=\"{}\">",
        escape(alt)
    )
}

fn gallery(pictures: &Pictures, findings: &Findings) -> String {
    let reference = &pictures.reference;
    let mut text = format!(
        "<figure>{}<figcaption><b>reference</b></figcaption></figure>\n",
        image(
            reference,
            &reference.data,
            "the reference",
            "picture-reference"
        )
    );
    for picture in &pictures.list {
        let name = &picture.name;
        let finding = findings.get(name);
        let spp = finding.map_or(0.0, |f| f.spp);
        let (heat, mean) = picture.flip.clone().unwrap_or_default();
        text += &format!(
            "<figure>{}<figcaption><b>{}</b>, {spp:.0} spp</figcaption></figure>\n\
             <figure>{}<figcaption>its FLIP errors, mean {mean:.4}</figcaption></figure>\n",
            image(
                picture,
                &picture.data,
                &format!("rendered with {name}"),
                &format!("picture-{name}")
            ),
            escape(name),
            image(
                picture,
                &heat,
                &format!(
                    "map of the errors of {name}: dark where it is right, bright where it is wrong"
                ),
                &format!("flip-{name}")
            ),
        );
    }
    text
}

fn choices(pictures: &Pictures) -> String {
    let names = pictures.list.iter().map(|p| p.name.as_str());
    let all = std::iter::once("reference").chain(names);
    let option = |name: &str| {
        let name = escape(name);
        format!("<option value=\"{name}\">{name}</option>")
    };
    all.map(option).collect()
}

/// The two images of the slider: before anything is chosen, the first configuration and the
/// reference.
fn slider(pictures: &Pictures) -> String {
    let left = pictures.list.first().unwrap_or(&pictures.reference);
    let right = &pictures.reference;
    image(right, &right.data, "the image on the right", "slider-right")
        + &image(left, &left.data, "the image on the left", "slider-left")
}

fn machine(sweep: &Sweep) -> String {
    let machine = &sweep.machine;
    let runs = sweep.runs.iter().filter_map(|r| r.stats.as_ref());
    let first = runs.clone().next();
    let rows = [
        ("processor", machine.processor.clone()),
        ("its threads", machine.threads.to_string()),
        (
            "threads that rendered",
            first.map_or("-".into(), |s| s.threads.to_string()),
        ),
        (
            "memory",
            machine.memory_bytes.map_or("-".into(), words::bytes),
        ),
        ("system", machine.system.clone()),
        ("kernel", machine.kernel.clone()),
        ("twintree", sweep.setting.version.clone()),
        ("ray tracer", first.map_or("-".into(), |s| s.accel.clone())),
        ("libraries", machine.libraries.join(", ")),
    ];
    let rows = rows.map(|(what, value)| vec![what.to_owned(), escape(&value)]);
    table("the machine", &["", ""], &rows)
}

fn failures(sweep: &Sweep) -> String {
    let failed = sweep
        .runs
        .iter()
        .filter_map(|r| Some((r, r.failure.as_ref()?)));
    let rows = failed.map(|(run, why)| {
        let command = format!("<code>{}</code>", escape(&run.command));
        vec![escape(&run.configuration), escape(why), command]
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = ["configuration", "what happened", "command"];
    let list = table("runs that failed", &head, &rows);
    format!(
        "<section><h2>Runs that failed</h2><p>{} of {} runs ended without measurements. They count \
         nowhere above.</p>{list}</section>",
        rows.len(),
        sweep.runs.len()
    )
}

fn commands(sweep: &Sweep) -> String {
    let lines: Vec<String> = sweep.runs.iter().map(|r| escape(&r.command)).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_into_the_template_is_not_looked_at_again() {
        let parts = [("a", "{{b}}".to_owned()), ("b", "x".to_owned())];
        assert_eq!(fill("1 {{a}} 2 {{b}} {{c}} }}", &parts), "1 {{b}} 2 x  }}");
    }

    #[test]
    fn the_template_names_only_what_there_is() {
        let names = [
            "style",
            "script",
            "scene",
            "conclusion",
            "caveats",
            "overview",
            "knobs",
            "table",
            "pictures",
            "options",
            "slider",
            "field",
            "machine",
            "failures",
            "command",
            "commands",
        ];
        for part in TEMPLATE.split("{{").skip(1) {
            let name = part.split("}}").next().unwrap();
            assert!(names.contains(&name), "{name}");
        }
    }
}
