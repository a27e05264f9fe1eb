//! Materials and textures that are made of others: each definition is made once, and none grows
//! beyond bounds.

use std::collections::HashMap;
use std::hash::Hash;

/// How deep things may be nested, and of how many one may be made, those used twice counted twice:
/// sixty that each hold the next one twice would be 2^60.
pub(super) struct Limits {
    /// What they are called.
    pub things: &'static str,
    pub deepest: usize,
    pub most: usize,
}

/// How materials may hold others.
pub(super) const MATERIALS: Limits = Limits {
    things: "materials",
    deepest: 32,
    most: 128,
};

/// How textures may hold others.
pub(super) const TEXTURES: Limits = Limits {
    things: "textures",
    deepest: 64,
    most: 256,
};

/// What was made by definition, and how far the one that is being made has come.
pub(super) struct Nested<K, V> {
    limits: Limits,
    /// With how many each is made of.
    made: HashMap<K, (V, usize)>,
    /// Those that the one being made is made of so far.
    size: usize,
    depth: usize,
}

/// One that is being made.
pub(super) struct Begun {
    /// Those that what holds it is made of so far.
    outer: usize,
    /// It lies deeper than is allowed.
    pub too_deep: Result<(), String>,
}

impl<K: Eq + Hash, V: Clone> Nested<K, V> {
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            made: HashMap::new(),
            size: 0,
            depth: 0,
        }
    }

    /// The one of that definition, if it is made; it counts as part of what is being made.
    pub fn known(&mut self, key: &K) -> Option<V> {
        let (value, size) = self.made.get(key)?;
        self.size += size;
        Some(value.clone())
    }

    /// Begins to make one.
    pub fn begin(&mut self) -> Begun {
        self.depth += 1;
        let things = self.limits.things;
        Begun {
            outer: std::mem::replace(&mut self.size, 1),
            too_deep: match self.depth > self.limits.deepest {
                true => Err(format!("{things} are nested too deep, or hold themselves")),
                false => Ok(()),
            },
        }
    }

    /// Whether what was made in between is small enough.
    pub fn bounded(&self) -> Result<(), String> {
        let Limits { things, most, .. } = self.limits;
        match self.size > most {
            true => Err(format!(
                "this is made of more than {most} {things}, one that is used twice counted twice"
            )),
            false => Ok(()),
        }
    }

    /// Remembers what `begun` came to: the thing itself, or what takes its place.
    pub fn end(&mut self, begun: &Begun, key: K, value: &V, is_whole: bool) {
        self.depth -= 1;
        let size = if is_whole { self.size } else { 1 };
        self.size = begun.outer + size;
        self.made.insert(key, (value.clone(), size));
    }
}
