//! What is there of a sweep already: `report.json`.

use crate::cli::{Failure, output};
use crate::report::sweep::analysis::Findings;
use crate::report::sweep::{Setting, Sweep};
use std::path::Path;

/// The sweep in that directory, if there is one of the same scene, reference and plan.
///
/// # Errors
/// When it is of others, or cannot be read.
pub fn read(directory: &Path, wanted: &Setting) -> Result<Option<Sweep>, Failure> {
    let path = directory.join("report.json");
    let bytes = match crate::image::regular::read(&path) {
        Ok(bytes) => bytes,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(Failure::Refused(format!("{}: {e}", path.display()))),
    };
    let help = "name another directory with -o, or remove this one";
    let sweep: Sweep = serde_json::from_slice(&bytes)
        .map_err(|e| Failure::wrong(format!("{} is no report: {e}", path.display()), help))?;
    let differences = differences(&sweep.setting, wanted);
    if differences.is_empty() {
        return Ok(Some(sweep));
    }
    let list = differences.join("\n  ");
    let message = format!("{} is of another sweep:\n  {list}", path.display());
    Err(Failure::wrong(message, help))
}

/// Writes the state and the table.
///
/// # Errors
/// When the system refuses.
pub fn write(directory: &Path, sweep: &Sweep) -> Result<(), Failure> {
    let findings = Findings::of(sweep);
    output::write_file(&directory.join("report.json"), sweep.to_json(&findings))?;
    output::write_file(&directory.join("runs.csv"), sweep.to_csv())
}

/// A sentence for each thing that differs between the report and the command line.
fn differences(there: &Setting, here: &Setting) -> Vec<String> {
    let mut list = Vec::new();
    let mut compare = |what: &str, there: &str, here: &str| {
        if there != here {
            list.push(format!("{what} is {here} here and {there} there"));
        }
    };
    compare("the version", &there.version, &here.version);
    compare("the scene", &there.scene, &here.scene);
    let (a, b) = (&there.reference, &here.reference);
    compare("the reference", &a.path, &b.path);
    compare(
        "the words of every run",
        &there.common.join(" "),
        &here.common.join(" "),
    );
    let clock = |of: &Setting| format!("{:?}", of.clock).to_lowercase();
    compare("--clock", &clock(there), &clock(here));
    compare(
        "--rounds",
        &there.rounds.to_string(),
        &here.rounds.to_string(),
    );
    // Without --time the command line leaves it to the report.
    if here.seconds > 0.0 {
        compare(
            "--time",
            &there.seconds.to_string(),
            &here.seconds.to_string(),
        );
    }
    if there.scene_fingerprint != here.scene_fingerprint {
        list.push("the scene has changed since".into());
    }
    if a.fingerprint != b.fingerprint {
        list.push("the reference has changed since".into());
    }
    if there.configurations != here.configurations {
        let absent = |from: &Setting, of: &Setting| {
            let missing = |c: &&_| !from.configurations.contains(c);
            let names = of.configurations.iter().filter(missing);
            names
                .map(|c| c.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        };
        list.push(format!(
            "the plan has changed: new here: {}; only there: {}",
            absent(there, here),
            absent(here, there)
        ));
    }
    list
}
