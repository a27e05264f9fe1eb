//! Keyword arguments are the command line's options: `spp=16` is `--spp=16`, `strict=True` is
//! `--strict`, and a list is its items between commas. They are read by the command line's own
//! parser, so that there is one definition of every setting, of its default and of what is said
//! about a wrong one.

use crate::failure::{Fault, in_keywords};
use clap::CommandFactory;
use clap::error::ErrorKind;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString, PyTuple};
use std::ffi::OsString;
use twintree::cli::Cli;
use twintree::cli::args::Command;

/// The words of one keyword argument.
fn words_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let option = format!("--{}", name.replace('_', "-"));
    if value.is_none() {
        return Ok(Vec::new());
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(if flag.is_true() {
            vec![option]
        } else {
            Vec::new()
        });
    }
    Ok(vec![format!("{option}={}", text_of(name, value)?)])
}

/// A value as one would type it.
fn text_of(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let wrong = |what: String| Fault::Type(format!("{name}: {what}"));
    let text = if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items: PyResult<Vec<String>> = value
            .try_iter()?
            .map(|item| text_of(name, &item?))
            .collect();
        let list = items?.join(",");
        // A camera of three numbers stands there.
        if name == "camera" {
            format!("from:{list}")
        } else {
            list
        }
    } else if let Ok(text) = value.cast::<PyString>() {
        let text = text.extract::<String>();
        text.map_err(|_| wrong("is no text".into()))?
    } else if value.hasattr("__fspath__")? {
        value.call_method0("__fspath__")?.extract()?
    } else if value.hasattr("__float__")? || value.hasattr("__index__")? {
        // Numbers of Python and of numpy, and arrays of one.
        value.str()?.extract()?
    } else if value.hasattr("tolist")? {
        text_of(name, &value.call_method0("tolist")?)?
    } else {
        let kind = value.get_type().name()?;
        return Err(wrong(format!("a {kind} is no setting")).into());
    };
    if text.contains('\0') {
        return Err(wrong("the text contains a zero byte".into()).into());
    }
    Ok(text)
}

/// All keyword arguments as words.
pub fn words(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let mut words = Vec::new();
    for (name, value) in keywords.into_iter().flatten() {
        // numpy's arrays have __float__, whatever their size.
        let value = match value.hasattr("tolist")? {
            true => value.call_method0("tolist")?,
            false => value,
        };
        words.extend(words_of(&name.extract::<String>()?, &value)?);
    }
    Ok(words)
}

/// Options of the command line that say how files are read: of a scene file, all other keywords are
/// values for its `$names`.
const READING: [&str; 3] = ["lenient", "texture_memory", "limit_decoded"];

/// Keywords for a scene file: how it is read, and values of its `$names`.
pub fn scene_words(options: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<String>> {
    let Some(options) = options else {
        return Ok(Vec::new());
    };
    let reading = PyDict::new(options.py());
    let mut list = Vec::new();
    for (name, value) in options {
        let name: String = name.extract()?;
        match (READING.contains(&name.as_str()), name.as_str()) {
            (true, _) => reading.set_item(name, value)?,
            (false, "define") => {
                for (key, value) in value.cast::<PyDict>()? {
                    list.push(define(&key.extract::<String>()?, &value)?);
                }
            }
            _ => list.push(define(&name, &value)?),
        }
    }
    list.extend(words(Some(&reading))?);
    Ok(list)
}

fn define(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    // As scene files have it.
    let text = match value.extract::<bool>() {
        Ok(flag) => flag.to_string(),
        Err(_) => value.str()?.extract()?,
    };
    Ok(format!("--define={name}={text}"))
}

/// Reads a command, the words of its keyword arguments last; what is idle among them is logged.
pub fn read(command: &str, positional: &[OsString], keywords: &[String]) -> Result<Command, Fault> {
    let mut line: Vec<OsString> = vec!["twintree".into(), command.into()];
    line.extend(keywords.iter().map(OsString::from));
    line.push("--".into());
    line.extend(positional.iter().cloned());
    let cli = Cli::read_from(line).map_err(|e| told(&e))?;
    for idle in &cli.idle {
        tracing::warn!("{}", in_keywords(idle));
    }
    Ok(cli.command)
}

/// What clap says, without what belongs to a terminal.
fn told(error: &clap::Error) -> Fault {
    let text = error.render().to_string();
    let body = text.split("\n\nUsage:").next().unwrap_or_default();
    let body = body
        .split("\n\nFor more information")
        .next()
        .unwrap_or(body);
    let text = in_keywords(body.trim().trim_start_matches("error: "));
    match error.kind() {
        ErrorKind::UnknownArgument => Fault::Type(text),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            Fault::Type("help() and __version__ tell that".into())
        }
        _ => Fault::Value(text),
    }
}

/// Refuses options that have no meaning where there are no files.
pub fn refuse(keywords: &[String], names: &[&str], help: &str) -> Result<(), Fault> {
    for word in keywords {
        let name = word
            .trim_start_matches("--")
            .split('=')
            .next()
            .unwrap_or("");
        if names.contains(&name) {
            let name = name.replace('-', "_");
            return Err(Fault::Type(format!(
                "{name} is no setting here\n  help: {help}"
            )));
        }
    }
    Ok(())
}

/// The options of a command: a dictionary for each, with "name", "help", "value" (a word for what
/// it takes, such as "TIME"), "values" (the words that it takes, if these are few), "flag" and
/// "default".
#[pyfunction]
pub fn options(py: Python<'_>, command: &str) -> PyResult<Py<PyList>> {
    let whole = Cli::command();
    let Some(found) = whole.find_subcommand(command) else {
        return Err(Fault::Value(format!("there is no command \"{command}\"")).into());
    };
    let list = PyList::empty(py);
    for arg in found.get_arguments() {
        let Some(long) = arg.get_long() else { continue };
        let option = PyDict::new(py);
        option.set_item("name", long.replace('-', "_"))?;
        option.set_item(
            "help",
            in_keywords(&arg.get_help().map_or(String::new(), |h| h.to_string())),
        )?;
        let flag = !arg.get_action().takes_values();
        option.set_item("flag", flag)?;
        let of = arg.get_value_names().and_then(|names| names.first());
        option.set_item("value", of.filter(|_| !flag).map(|name| name.to_string()))?;
        let values = arg.get_possible_values();
        let values: Vec<String> = values.iter().map(|v| v.get_name().to_owned()).collect();
        option.set_item("values", if flag { Vec::new() } else { values })?;
        let default = arg.get_default_values().first();
        option.set_item("default", default.map(|d| d.to_string_lossy().into_owned()))?;
        list.append(option)?;
    }
    Ok(list.unbind())
}
