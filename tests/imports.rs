//! Which module imports which: never upward in the order of CONTRIBUTING's "The house", never in a
//! circle.
//!
//! `use` lines and written-out paths count, those of tests do not. A name that another module
//! re-exports counts as an import of the module that defines it; that a module re-exports its own
//! children's names counts for nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::{self, Visit};
use syn::{Attribute, File, Item, ItemMod, ItemUse, UseTree, Visibility};

/// The folders of `src`, from the top; those of one line do not import each other.
const ORDER: [&[&str]; 10] = [
    &["cli"],
    &["report", "make"],
    &["integrate"],
    &["photon"],
    &["guide", "scene"],
    &["bsdf", "light", "camera", "film"],
    &["medium"],
    &["texture"],
    &["accel", "image"],
    &["math"],
];

/// Modules by path below the crate ("integrate::wave"), with what they import.
type Graph = BTreeMap<String, BTreeSet<String>>;

#[test]
fn no_module_imports_upward() {
    let rank = |module: &str| {
        let folder = module.split("::").next().unwrap();
        ORDER.iter().position(|line| line.contains(&folder))
    };
    let mut upward = Vec::new();
    for (module, imports) in &graph() {
        for import in imports {
            let (a, b) = (rank(module), rank(import));
            let beside = a == b && module.split("::").next() != import.split("::").next();
            if a > b || beside {
                upward.push(format!("{module} imports {import}"));
            }
        }
    }
    assert!(
        upward.is_empty(),
        "upward or sideways:\n{}",
        upward.join("\n")
    );
}

#[test]
fn no_modules_import_each_other_in_a_circle() {
    let graph = graph();
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        graph.keys().map(|m| (&m[..], reached(&graph, m))).collect();
    let mut circles = BTreeSet::new();
    for (module, there) in &reach {
        let circle: BTreeSet<&str> = there
            .iter()
            .copied()
            .filter(|m| reach[m].contains(module))
            .collect();
        if !circle.is_empty() {
            circles.insert(circle);
        }
    }
    let lines = |circle: &BTreeSet<&str>| {
        let inside = circle.iter().map(|m| {
            let to: Vec<_> = graph[*m]
                .iter()
                .filter(|i| circle.contains(&i[..]))
                .cloned()
                .collect();
            format!("  {m} -> {}", to.join(", "))
        });
        format!(
            "{} modules:\n{}",
            circle.len(),
            inside.collect::<Vec<_>>().join("\n")
        )
    };
    let text: Vec<String> = circles.iter().map(lines).collect();
    assert!(circles.is_empty(), "{}", text.join("\n"));
}

/// What a module imports, and what that imports, and so on; itself only if it comes back to it.
fn reached<'g>(graph: &'g Graph, from: &str) -> BTreeSet<&'g str> {
    let mut found = BTreeSet::new();
    let mut next: Vec<&str> = graph[from].iter().map(|m| &m[..]).collect();
    while let Some(module) = next.pop() {
        if found.insert(module) {
            next.extend(graph[module].iter().map(|m| &m[..]));
        }
    }
    found
}

fn graph() -> Graph {
    let mut sources = BTreeMap::new();
    read(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")),
        "",
        &mut sources,
    );
    assert!(sources.len() > 100, "{} modules", sources.len());
    let found: BTreeMap<String, Found> = sources
        .iter()
        .map(|(name, file)| (name.clone(), Found::of(name, file)))
        .collect();
    let graph: Graph = found
        .iter()
        .map(|(name, f)| (name.clone(), f.imports(name, &found)))
        .collect();
    let imports: usize = graph.values().map(BTreeSet::len).sum();
    assert!(imports > sources.len(), "{imports} imports");
    graph
}

/// Reads the modules of a folder, tests left out.
fn read(folder: &Path, prefix: &str, sources: &mut BTreeMap<String, File>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let name = |stem: &str| match prefix {
            "" => stem.to_owned(),
            _ => format!("{prefix}::{stem}"),
        };
        if stem == "tests" || stem == "main" || stem == "lib" {
            continue;
        }
        if path.is_dir() {
            read(&path, &name(&stem), sources);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let module = if stem == "mod" {
                prefix.to_owned()
            } else {
                name(&stem)
            };
            let text = std::fs::read_to_string(&path).unwrap();
            sources.insert(module, syn::parse_file(&text).unwrap());
        }
    }
}

/// The paths that a module names, from the crate's root.
#[derive(Default)]
struct Found {
    module: Vec<String>,
    /// Modules written inside the file.
    inner: Vec<String>,
    used: Vec<Vec<String>>,
    /// By the name that it gives to the outside.
    exported: BTreeMap<String, Vec<String>>,
}

impl Found {
    fn of(module: &str, file: &File) -> Self {
        let mut found = Self {
            module: module.split("::").map(str::to_owned).collect(),
            ..Self::default()
        };
        found.visit_file(file);
        found
    }

    /// The path from the crate's root; none for one that begins with another crate.
    fn absolute(&self, path: &[String]) -> Option<Vec<String>> {
        let mut base = [&self.module[..], &self.inner].concat();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => {
                base.clear();
                rest = &rest[1..];
            }
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|s| s == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            _ => return None,
        }
        Some([&base, rest].concat())
    }

    fn add_use(&mut self, tree: &UseTree, before: &[String], is_public: bool) {
        match tree {
            UseTree::Path(p) => self.add_use(
                &p.tree,
                &[before, &[p.ident.to_string()]].concat(),
                is_public,
            ),
            UseTree::Group(g) => g
                .items
                .iter()
                .for_each(|t| self.add_use(t, before, is_public)),
            UseTree::Glob(_) => self.add(before, None, is_public),
            UseTree::Name(n) => {
                let name = n.ident.to_string();
                self.add(
                    &[before, std::slice::from_ref(&name)].concat(),
                    Some(name),
                    is_public,
                )
            }
            UseTree::Rename(r) => {
                let path = [before, &[r.ident.to_string()]].concat();
                self.add(&path, Some(r.rename.to_string()), is_public)
            }
        }
    }

    fn add(&mut self, path: &[String], name: Option<String>, is_public: bool) {
        // `use child::Name` names a module of one's own.
        let own = || [&["self".to_owned()], path].concat();
        let is_relative = !matches!(path[0].as_str(), "crate" | "self" | "super");
        let Some(full) = self.absolute(&if is_relative { own() } else { path.to_vec() }) else {
            return;
        };
        // `pub(super) use name;` names a macro of the module itself.
        if full.len() == self.module.len() + 1 && full.starts_with(&self.module) && is_relative {
            return;
        }
        if let (true, Some(name)) = (is_public, name) {
            self.exported.insert(name, full.clone());
        }
        let re_exports = is_public && full.starts_with(&self.module);
        if !is_relative && !re_exports {
            self.used.push(full);
        }
    }

    fn imports(&self, name: &str, all: &BTreeMap<String, Found>) -> BTreeSet<String> {
        let defined = self.used.iter().filter_map(|path| defining(path, all));
        defined.filter(|module| module != name).collect()
    }
}

/// The module that defines what a path names.
fn defining(path: &[String], all: &BTreeMap<String, Found>) -> Option<String> {
    let lengths = (1..=path.len()).rev();
    let (length, module) = lengths
        .map(|n| (n, path[..n].join("::")))
        .find(|(_, module)| all.contains_key(module))?;
    let exported = path
        .get(length)
        .and_then(|name| all[&module].exported.get(name));
    match exported {
        Some(target) => defining(&[target, &path[length + 1..]].concat(), all).or(Some(module)),
        None => Some(module),
    }
}

impl<'a> Visit<'a> for Found {
    fn visit_item(&mut self, item: &'a Item) {
        let attributes: &[Attribute] = match item {
            Item::Mod(i) => &i.attrs,
            Item::Use(i) => &i.attrs,
            Item::Fn(i) => &i.attrs,
            Item::Impl(i) => &i.attrs,
            _ => &[],
        };
        let is_test = |a: &Attribute| {
            a.path().is_ident("cfg") && a.meta.require_list().unwrap().tokens.to_string() == "test"
        };
        if !attributes.iter().any(is_test) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'a ItemMod) {
        if item.content.is_some() {
            self.inner.push(item.ident.to_string());
            visit::visit_item_mod(self, item);
            self.inner.pop();
        }
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        self.add_use(&item.tree, &[], !matches!(item.vis, Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if let Some(full) = self.absolute(&segments).filter(|_| segments.len() > 1) {
            self.used.push(full);
        }
        visit::visit_path(self, path);
    }
}
