//! `$name` in attribute values: `<default>`s of the scene and definitions from the command line.

use crate::scene::import::named;
use std::collections::{BTreeSet, HashMap};

/// The longest text a substitution may give: defaults that name each other can double in length
/// each.
const MAX_LENGTH: usize = 1 << 20;

#[derive(Debug)]
struct Define {
    value: String,
    from_scene: bool,
    used: bool,
}

/// All names known so far. Of `$ab` and `$a`, `$abc` means the longer.
#[derive(Debug, Default)]
pub(super) struct Defines {
    by_name: HashMap<String, Define>,
    /// Lengths that names have, in bytes.
    lengths: BTreeSet<usize>,
    /// Names without a value that were asked for.
    missed: usize,
}

impl Defines {
    /// Starts with the command line's definitions. A name given twice has its last value.
    pub fn new(given: &[(String, String)]) -> Self {
        let mut defines = Self::default();
        for (name, value) in given.iter().rev() {
            defines.add(name, value, false);
        }
        defines
    }

    fn add(&mut self, name: &str, value: &str, from_scene: bool) {
        if self.by_name.contains_key(name) {
            return;
        }
        self.lengths.insert(name.len());
        let define = Define {
            value: value.to_owned(),
            from_scene,
            used: false,
        };
        self.by_name.insert(name.to_owned(), define);
    }

    /// The longest name that `text` begins with.
    fn named<'t>(&self, text: &'t str) -> Option<&'t str> {
        let lengths = self.lengths.iter().rev();
        let mut candidates = lengths.filter_map(|&length| text.get(..length));
        candidates.find(|name| self.by_name.contains_key(*name))
    }

    /// A `<default>`: counts only if the name has no value yet.
    pub fn add_default(&mut self, name: &str, value: &str) {
        self.add(name, value, true);
    }

    /// Puts values in for names. `\$` stands for a dollar sign.
    pub fn substitute(&mut self, text: &str) -> Result<String, String> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let (before, after) = (&rest[..dollar], &rest[dollar + 1..]);
            if let Some(unescaped) = before.strip_suffix('\\') {
                out.push_str(unescaped);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            let found = self.named(after);
            let Some(name) = found else {
                return Err(self.undefined(after));
            };
            if let Some(define) = self.by_name.get_mut(name) {
                define.used = true;
                out.push_str(&define.value);
            }
            rest = &after[name.len()..];
            if out.len() > MAX_LENGTH {
                return Err("the values put in for $names are longer than 1 MiB".into());
            }
        }
        out.push_str(rest);
        Ok(out)
    }

    fn undefined(&mut self, after: &str) -> String {
        self.missed += 1;
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let name = after.split(|c| !is_name(c)).next().unwrap_or("");
        // The order of a hash map is not the same twice; messages should be.
        let mut known: Vec<&str> = self.by_name.keys().map(String::as_str).collect();
        known.sort_unstable();
        // A hint costs a comparison with every name: a file full of mistakes gets some.
        known.truncate(if self.missed > 100 { 0 } else { known.len() });
        let hint = named::nearest(name, known)
            .map(|n| format!(" (did you mean ${n}?)"))
            .unwrap_or_default();
        format!("${name} has no value{hint}; give it one with <default> or -D {name}=VALUE")
    }

    /// Definitions from the command line that nothing asked for.
    pub fn unused(&self) -> Vec<&str> {
        let unused = self
            .by_name
            .iter()
            .filter(|(_, d)| !d.used && !d.from_scene);
        let mut names: Vec<&str> = unused.map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_wins_and_the_longest_name_too() {
        let mut d = Defines::new(&[("spp".into(), "16".into()), ("odd".into(), "1".into())]);
        d.add_default("spp", "64");
        d.add_default("s", "S");
        d.add_default("file", "$spp");
        assert_eq!(d.substitute("a$spp-$s$spp"), Ok("a16-S16".into()));
        assert_eq!(d.substitute(r"5 \$spp"), Ok("5 $spp".into()));
        assert_eq!(d.unused(), ["odd"]);
        let error = d.substitute("$Spp").unwrap_err();
        assert!(error.contains("did you mean $spp?"), "{error}");
    }

    #[test]
    fn doubling_defaults_are_stopped() {
        let mut d = Defines::default();
        d.add_default("a0", "0123456789");
        let mut failed = false;
        for i in 1..40 {
            match d.substitute(&format!("$a{}$a{}", i - 1, i - 1)) {
                Ok(v) => d.add_default(&format!("a{i}"), &v),
                Err(e) => {
                    assert!(e.contains("1 MiB"), "{e}");
                    failed = true;
                    break;
                }
            }
        }
        assert!(failed);
    }
}
