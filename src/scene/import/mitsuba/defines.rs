//! `$name` in attribute values: `<default>`s of the scene and definitions from the command line.

use super::names;

/// The longest text a substitution may give: defaults that name each other can double in length each.
const MAX_LENGTH: usize = 1 << 20;

#[derive(Debug)]
struct Define {
    name: String,
    value: String,
    from_scene: bool,
    used: bool,
}

/// All names known so far, longest first: of `$ab` and `$a`, `$abc` means the longer.
#[derive(Debug, Default)]
pub(super) struct Defines {
    list: Vec<Define>,
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
        if self.list.iter().any(|d| d.name == name) {
            return;
        }
        let place = self.list.partition_point(|d| d.name.len() >= name.len());
        let define = Define {
            name: name.to_owned(),
            value: value.to_owned(),
            from_scene,
            used: false,
        };
        self.list.insert(place, define);
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
            let found = self.list.iter_mut().find(|d| after.starts_with(&d.name));
            let Some(define) = found else {
                return Err(self.undefined(after));
            };
            define.used = true;
            out.push_str(&define.value);
            rest = &after[define.name.len()..];
            if out.len() > MAX_LENGTH {
                return Err("the values put in for $names are longer than 1 MiB".into());
            }
        }
        out.push_str(rest);
        Ok(out)
    }

    fn undefined(&self, after: &str) -> String {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let name = after.split(|c| !is_name(c)).next().unwrap_or("");
        let known = self.list.iter().map(|d| d.name.as_str());
        let hint = names::nearest(name, known)
            .map(|n| format!(" (did you mean ${n}?)"))
            .unwrap_or_default();
        format!("${name} has no value{hint}; give it one with <default> or -D {name}=VALUE")
    }

    /// Definitions from the command line that nothing asked for.
    pub fn unused(&self) -> impl Iterator<Item = &str> {
        let unused = self.list.iter().filter(|d| !d.used && !d.from_scene);
        unused.map(|d| d.name.as_str())
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
        assert_eq!(d.unused().collect::<Vec<_>>(), ["odd"]);
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
