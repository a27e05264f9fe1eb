//! Numbers in text, alike in all scene files.

/// Words between blanks and commas.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',')
        .filter(|w| !w.is_empty())
}

/// A finite number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let trimmed = text.trim();
    match trimmed.parse::<f64>() {
        Ok(v) if v.is_finite() && v.abs() <= f64::from(f32::MAX) => Ok(v),
        Ok(_) => Err(format!("\"{trimmed}\" is not a finite number")),
        Err(_) => Err(format!("\"{trimmed}\" is not a number")),
    }
}

/// All numbers of a list.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    words(text).map(number).collect()
}

/// Checks samples of a spectrum: (wavelength in nm, value), by wavelength.
pub(super) fn increasing(samples: Vec<(f64, f64)>) -> Result<Vec<(f64, f64)>, String> {
    if samples.len() < 2 {
        return Err("a sampled spectrum needs at least two wavelengths".into());
    }
    if samples.windows(2).any(|w| w[0].0 >= w[1].0) {
        return Err("the wavelengths of a spectrum must increase".into());
    }
    Ok(samples)
}

/// Text of a `.spd` file: a wavelength and a value a line, `#` begins a comment.
pub(super) fn samples(text: &str) -> Result<Vec<(f64, f64)>, String> {
    let lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .map(|l| l.split('#').next().unwrap_or("").trim());
    let mut list = Vec::new();
    for line in lines.filter(|l| !l.is_empty()) {
        match numbers(line)?.as_slice() {
            &[w, v] => list.push((w, v)),
            _ => {
                return Err(format!(
                    "expected a wavelength and a value, found \"{line}\""
                ));
            }
        }
    }
    increasing(list)
}
