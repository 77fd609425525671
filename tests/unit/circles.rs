//! Imports between files run one way, within a member as between members.
//!
//! What a file takes from the modules within its own folder is no arrow here, what they take from it is one. Names that a file re-exports count as those of the file that defines them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use super::house::{member_of, rust_files, source};

/// A module: its member, and the segments of its path below it.
type Module = Vec<String>;

/// What the imports of one file say.
#[derive(Default)]
struct Imports {
    /// Absolute paths that its code names.
    names: Vec<Module>,
    /// Names that it re-exports, with what they stand for.
    handed_on: BTreeMap<String, Module>,
}

#[test]
fn imports_run_in_no_circle() {
    let files = sources();
    let modules: BTreeSet<Module> = files.keys().cloned().collect();
    let imports: BTreeMap<&Module, Imports> = files.iter().map(|(own, text)| (own, imports_of(own, text, &modules))).collect();
    let arrows: BTreeMap<&Module, BTreeSet<Module>> = imports
        .iter()
        .map(|(own, found)| {
            let to = found.names.iter().filter_map(|path| defining(path, &imports, 0));
            (*own, to.filter(|to| !to.is_empty() && !to.starts_with(own)).collect())
        })
        .collect();
    assert!(arrows.values().map(BTreeSet::len).sum::<usize>() > 500, "the test reads the imports");

    let circles = circles(&arrows);
    let named: Vec<String> =
        circles.iter().map(|circle| circle.iter().map(|module| module.join("::")).collect::<Vec<_>>().join(", ")).collect();
    assert!(circles.is_empty(), "files that need each other: {named:#?}");
}

/// Code of every module, without comments and text in quotes.
fn sources() -> BTreeMap<Module, String> {
    let mut code: BTreeMap<Module, String> = BTreeMap::new();
    let source = source();
    for file in rust_files(&source).into_iter().filter(|file| !file.ends_with("main.rs") && !file.ends_with("build.rs")) {
        let path = file.strip_prefix(&source).unwrap();
        let within = path.strip_prefix(member_of(path)).unwrap_or(path).with_extension("");
        let parts = within.iter().map(|part| part.to_str().unwrap().to_owned()).filter(|part| part != "mod" && part != "lib");
        let module: Module = std::iter::once(member_of(path)).chain(parts).collect();
        code.entry(module).or_default().push_str(&bare(&fs::read_to_string(&file).unwrap()));
    }
    code
}

fn bare(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap());
    let text = lines.collect::<Vec<_>>().join("\n").replace("\\\"", "");
    text.split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
}

fn imports_of(own: &[String], text: &str, modules: &BTreeSet<Module>) -> Imports {
    let mut found = Imports::default();
    let mut code = String::new();
    for statement in text.split_inclusive(';') {
        let Some(start) = statement.find("use ").filter(|at| is_declaration(&statement[..*at])) else {
            code.push_str(statement);
            continue;
        };
        let is_public = statement[..start].trim_end().rsplit('\n').next().unwrap().trim_start().starts_with("pub");
        for path in paths_of(&statement[start + 4..statement.len() - 1]) {
            let Some(path) = absolute(own, &path, modules) else { continue };
            match path.last() {
                Some(name) if is_public => drop(found.handed_on.insert(name.clone(), path.clone())),
                _ => found.names.push(path),
            }
        }
    }
    let words = code.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
    let paths = words.filter(|word| word.contains("::")).map(|word| word.split("::").map(str::to_owned).collect::<Module>());
    found.names.extend(paths.filter_map(|path| absolute(own, &path, modules)));
    found
}

/// Whether what stands before a `use` leaves it a declaration: nothing, or a visibility, on its line.
fn is_declaration(before: &str) -> bool {
    let line = before.rsplit('\n').next().unwrap().trim();
    line.is_empty() || line == "pub" || line.starts_with("pub(")
}

/// `a::{b, c::d as e}` taken apart.
fn paths_of(tree: &str) -> Vec<Module> {
    let Some(open) = tree.find('{') else {
        let path = tree.trim().split(" as ").next().unwrap();
        return vec![path.split("::").filter(|part| !part.is_empty() && *part != "self").map(str::to_owned).collect()];
    };
    let head = paths_of(&tree[..open]).remove(0);
    let mut depth = 0;
    let within = &tree[open + 1..tree.rfind('}').unwrap()];
    let parts = within.split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    let parts = parts.filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| paths_of(part).into_iter().map(|path| [head.clone(), path].concat()).collect::<Vec<_>>()).collect()
}

fn absolute(own: &[String], path: &[String], modules: &BTreeSet<Module>) -> Option<Module> {
    let supers = path.iter().take_while(|part| *part == "super").count();
    match path.first()?.as_str() {
        "crate" => Some([&own[..1], &path[1..]].concat()),
        "super" => Some([&own[..own.len().checked_sub(supers)?], &path[supers..]].concat()),
        first if first.starts_with("perilife") => {
            let member = first.strip_prefix("perilife_").unwrap_or("program");
            Some([&[member.to_owned()], &path[1..]].concat())
        }
        first => {
            let child = [own, &[first.to_owned()]].concat();
            modules.contains(&child).then(|| [own, path].concat())
        }
    }
}

/// The module that defines what a path names.
fn defining(path: &[String], imports: &BTreeMap<&Module, Imports>, depth: usize) -> Option<Module> {
    let length = (0..=path.len()).rev().find(|length| imports.contains_key(&path[..*length].to_vec()))?;
    let module = path[..length].to_vec();
    let handed_on = path.get(length).and_then(|name| imports[&module].handed_on.get(name));
    match handed_on {
        Some(to) if depth < 8 => defining(&[to, &path[length + 1..]].concat(), imports, depth + 1),
        _ => Some(module),
    }
}

/// Sets of modules that reach each other, by what each reaches.
fn circles(arrows: &BTreeMap<&Module, BTreeSet<Module>>) -> Vec<Vec<Module>> {
    let reached = |from: &Module| {
        let mut reached = BTreeSet::new();
        let mut next: Vec<&Module> = arrows[from].iter().collect();
        while let Some(module) = next.pop() {
            if reached.insert(module.clone()) {
                next.extend(arrows[module].iter());
            }
        }
        reached
    };
    let reach: BTreeMap<&Module, BTreeSet<Module>> = arrows.keys().map(|module| (*module, reached(module))).collect();
    let around = |module: &Module| reach[module].iter().filter(|other| reach[*other].contains(module)).cloned().collect();
    let all: BTreeSet<Vec<Module>> =
        arrows.keys().filter(|module| reach[*module].contains(**module)).map(|module| around(module)).collect();
    all.into_iter().collect()
}

#[test]
fn imports_are_taken_apart() {
    let joined = |tree: &str| paths_of(tree).iter().map(|path| path.join("::")).collect::<Vec<_>>();
    assert_eq!(joined("crate::{a, b::{self, c as d}}"), ["crate::a", "crate::b", "crate::b::c"]);
    let modules: BTreeSet<Module> = [vec!["a".to_owned(), "b".to_owned()]].into();
    let own = ["a".to_owned()];
    let text = "pub use b::X; // use crate::c;\nlet y = \"crate::d::e\"; crate::z::f(); perilife_w::g();";
    let found = imports_of(&own, &bare(text), &modules);
    assert_eq!(found.handed_on["X"].join("::"), "a::b::X");
    let named = |path: [&str; 3]| path.map(str::to_owned).to_vec();
    assert_eq!(found.names, [named(["a", "z", "f"]), vec!["w".to_owned(), "g".to_owned()]]);
}
