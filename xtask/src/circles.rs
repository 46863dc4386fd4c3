//! Finds import cycles: groups of files of one crate that all import each other, directly or through other files of the group.
//!
//! An import is a `use`, or a path in code that begins with `crate::` or `super::`. Tests are ignored, and so are imports between a module and the
//! modules that contain it.

use crate::workspace;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The allowed number of cycles, and the allowed number of files in one of them. Lower these numbers when a cycle is removed.
const ALLOWED: [usize; 2] = [1, 3];

/// The path of a module in its crate; empty for the crate's root.
type Module = Vec<String>;

/// `cargo xtask circles`: lists all cycles; returns an error if there are more, or larger ones, than allowed.
pub(crate) fn check() -> Result<(), String> {
    let mut sizes = Vec::new();
    for folder in workspace::entries(&workspace::root()?.join("crates"))? {
        for circle in circles(&modules(&folder.join("src"))?) {
            let names: Vec<String> = circle.iter().map(|module| module.join("::")).collect();
            println!("{} {} {}", workspace::name(&folder), circle.len(), names.join(" "));
            sizes.push(circle.len());
        }
    }
    let (count, largest) = (sizes.len(), sizes.into_iter().max().unwrap_or(0));
    println!("{count} circles, the largest of {largest} files");
    let [most, files] = ALLOWED;
    if count > most || largest > files {
        return Err(format!("allowed are {most} circles of at most {files} files each (xtask/src/circles.rs)"));
    }
    Ok(())
}

/// The modules of a crate with their text, without tests.
fn modules(source: &Path) -> Result<BTreeMap<Module, String>, String> {
    let mut out = BTreeMap::new();
    for path in workspace::rust_files(source)? {
        let inside = path.strip_prefix(source).map_err(|e| e.to_string())?.with_extension("");
        let mut module: Module = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        if module.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
            module.pop();
        }
        if !module.iter().any(|part| ["tests", "testing", "test"].contains(&part.as_str())) {
            out.insert(module, workspace::read(&path)?);
        }
    }
    Ok(out)
}

/// The cycles, each with its modules sorted by name.
fn circles(modules: &BTreeMap<Module, String>) -> Vec<Vec<&Module>> {
    let mut imports: BTreeMap<&Module, BTreeSet<&Module>> = BTreeMap::new();
    for (module, text) in modules {
        let others = imported(module, text, modules);
        imports
            .insert(module, others.filter(|other| !module.starts_with(other) && !other.starts_with(module)).collect());
    }
    let reached: BTreeMap<&Module, BTreeSet<&Module>> =
        modules.keys().map(|from| (from, reach(from, &imports))).collect();
    let mut out: Vec<Vec<&Module>> = Vec::new();
    for module in modules.keys() {
        let mutual = |other: &&Module| reached[module].contains(other) && reached[other].contains(module);
        let circle: Vec<&Module> = modules.keys().filter(mutual).collect();
        // A module that reaches itself does so through other modules, because no module imports itself.
        if circle.first() == Some(&module) {
            out.push(circle);
        }
    }
    out
}

/// All modules that a module imports, directly or through others.
fn reach<'m>(from: &'m Module, imports: &BTreeMap<&'m Module, BTreeSet<&'m Module>>) -> BTreeSet<&'m Module> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(module) = open.pop() {
        open.extend(imports[module].iter().copied().filter(|next| found.insert(*next)));
    }
    found
}

/// The modules of the crate that the text of a module names.
fn imported<'m>(
    module: &Module,
    text: &str,
    modules: &'m BTreeMap<Module, String>,
) -> impl Iterator<Item = &'m Module> {
    let text = without_comments(without_tests(text));
    let paths = [used(&text), named(&text)].concat();
    paths.into_iter().filter_map(|path| resolve(module, &path, modules)).collect::<Vec<_>>().into_iter()
}

/// The module that a path names, or the module that contains the item that it names.
fn resolve<'m>(module: &Module, path: &str, modules: &'m BTreeMap<Module, String>) -> Option<&'m Module> {
    let mut parts = path.split("::").map(str::trim).peekable();
    let mut full = match *parts.peek()? {
        "crate" => {
            parts.next();
            Module::new()
        }
        "super" | "self" => {
            let mut base = module.clone();
            while let Some(part) = parts.next_if(|part| ["super", "self"].contains(part)) {
                if part == "super" {
                    base.pop();
                }
            }
            base
        }
        first => {
            let child = [module.as_slice(), &[first.to_string()]].concat();
            if !modules.contains_key(&child) {
                return None;
            }
            module.clone()
        }
    };
    full.extend(parts.map(String::from));
    while !full.is_empty() && !modules.contains_key(&full) {
        full.pop();
    }
    modules.get_key_value(&full).map(|(module, _)| module)
}

/// The text before its test module.
fn without_tests(text: &str) -> &str {
    const MARK: &str = "#[cfg(test)]";
    let is_module = |rest: &str| {
        let name = rest[MARK.len()..].trim_start().strip_prefix("mod ");
        name.is_some_and(|name| name.trim_start_matches(is_word).trim_start().starts_with('{'))
    };
    let cut = text.match_indices(MARK).map(|(at, _)| at).find(|at| is_module(&text[*at..]));
    &text[..cut.unwrap_or(text.len())]
}

/// The text without comments that begin with `//`.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn is_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// The first word of a text from a position on: where it begins and ends.
fn next_word(text: &str, from: usize) -> Option<(usize, usize)> {
    let begin = from + text[from..].find(is_word)?;
    Some((begin, text[begin..].find(|letter| !is_word(letter)).map_or(text.len(), |length| begin + length)))
}

/// The paths in all `use` declarations.
fn used(text: &str) -> Vec<String> {
    let (mut out, mut at) = (Vec::new(), 0);
    while let Some((begin, end)) = next_word(text, at) {
        at = end;
        if &text[begin..end] == "use" && text[end..].starts_with(char::is_whitespace) {
            let Some(length) = text[end..].find(';') else { break };
            expand(&text[end..end + length], "", &mut out);
            at = end + length;
        }
    }
    out
}

/// The paths in code that begin with `crate::` or `super::`.
fn named(text: &str) -> Vec<String> {
    let (mut out, mut at) = (Vec::new(), 0);
    while let Some((begin, mut end)) = next_word(text, at) {
        let first = end;
        if ["crate", "super"].contains(&&text[begin..end]) {
            while text[end..].starts_with("::") && text[end + 2..].starts_with(is_word) {
                end = next_word(text, end + 2).map_or(end, |(_, end)| end);
            }
            if end > first {
                out.push(text[begin..end].to_string());
            }
        }
        at = end;
    }
    out
}

/// Every path of a tree: `a::{b, c::{d, e}}` contains `a::b`, `a::c::d` and `a::c::e`.
fn expand(tree: &str, before: &str, out: &mut Vec<String>) {
    let Some((head, rest)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        out.push(format!("{before}{}", path.trim()));
        return;
    };
    let before = format!("{before}{}", head.trim());
    let inside = rest.rsplit_once('}').map_or(rest, |(inside, _)| inside);
    let (mut depth, mut start) = (0, 0);
    for (at, letter) in inside.char_indices().chain([(inside.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inside[start..at].trim().is_empty() {
                    expand(&inside[start..at], &before, out);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crate_of(files: &[(&str, &str)]) -> BTreeMap<Module, String> {
        let path = |name: &str| name.split("::").filter(|part| !part.is_empty()).map(String::from).collect();
        files.iter().map(|(name, text)| (path(name), text.to_string())).collect()
    }

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let modules = crate_of(files);
        let join = |circle: Vec<&Module>| circle.iter().map(|m| m.join("::")).collect::<Vec<_>>().join(" ");
        circles(&modules).into_iter().map(join).collect()
    }

    #[test]
    fn trees_of_imports_are_expanded() {
        let mut out = Vec::new();
        expand("a::{b, c::{d as x,\n e}, self}", "", &mut out);
        assert_eq!(out, ["a::b", "a::c::d", "a::c::e", "a::self"]);
    }

    #[test]
    fn imports_and_paths_close_circles() {
        let files = [
            ("", "mod a; mod b; mod c; use a::A;"),
            ("a", "use crate::b::{B, other};\npub struct A;"),
            ("b", "fn f() { super::c::g() }"),
            ("c", "use super::a::A;"),
            ("d", "use crate::a::A;"),
        ];
        assert_eq!(found(&files), ["a b c"]);
    }

    #[test]
    fn tests_comments_and_ancestors_close_none() {
        let files = [
            ("", ""),
            ("a", "use crate::b::B;"),
            ("b", "// crate::a::A\n#[cfg(test)]\nmod tests { use crate::a::A; }"),
            ("c", "mod d; use d::D;"),
            ("c::d", "use super::C; use crate::c::C2;"),
        ];
        assert!(found(&files).is_empty());
    }

    #[test]
    fn two_circles_are_two() {
        let files = [
            ("a", "use crate::b::B;"),
            ("b", "use crate::a::A; use crate::x::X;"),
            ("x", "use super::y::Y;"),
            ("y", "use crate::x::X as Z;"),
        ];
        assert_eq!(found(&files), ["a b", "x y"]);
    }
}
