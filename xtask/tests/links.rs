//! README.md is short, and every relative link of the documentation has an existing target, file and heading.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").to_path_buf()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The pages: those of the root, and all below `docs`.
fn pages() -> Vec<PathBuf> {
    let root = root();
    let mut pages: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(|name| root.join(name)).collect();
    for folder in ["docs", "docs/adr"] {
        let entries = std::fs::read_dir(root.join(folder)).expect("a folder");
        pages.extend(
            entries
                .map(|entry| entry.expect("an entry").path())
                .filter(|path| path.extension().is_some_and(|ending| ending == "md")),
        );
    }
    pages
}

/// A page without its code blocks, which contain no links and no headings.
fn prose(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// The targets of the links of a text: the parts between `](` and the next `)`.
fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')').map(|(link, _)| link)).collect()
}

/// The anchors of the headings of a page, as made by GitHub and GitLab.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings
        .map(|heading| {
            let words = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

/// The errors in the relative links of a page in a folder.
fn broken(folder: &Path, own: &Path, text: &str) -> Vec<String> {
    let text = prose(text);
    let mut broken = Vec::new();
    for link in links(&text).into_iter().filter(|link| !link.contains("://")) {
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        let target = if file.is_empty() { own.to_path_buf() } else { folder.join(file) };
        let page = target.extension().is_some_and(|ending| ending == "md");
        if !target.exists() {
            broken.push(format!("`{link}`: there is no such file"));
        } else if page && !anchor.is_empty() && !anchors(&prose(&read(&target))).contains(anchor) {
            broken.push(format!("`{link}`: there is no such heading"));
        }
    }
    broken
}

#[test]
fn every_relative_link_leads_somewhere() {
    let mut found = 0;
    for page in pages() {
        let (text, folder) = (read(&page), page.parent().expect("a folder"));
        found += links(&prose(&text)).len();
        let broken = broken(folder, &page, &text);
        assert!(broken.is_empty(), "{}: {}", page.display(), broken.join("; "));
    }
    assert!(found > 100, "{found} links");
}

#[test]
fn a_broken_link_is_found() {
    let root = root();
    let text =
        "# One heading\n[a](README.md) [b](nowhere.md) [c](README.md#two-commands) [d](README.md#three-commands)";
    let broken = broken(&root, &root.join("README.md"), text);
    assert_eq!(broken.len(), 2, "{broken:?}");
    assert!(broken[0].contains("nowhere.md") && broken[1].contains("three-commands"), "{broken:?}");
}

#[test]
fn the_readme_has_at_most_six_hundred_words_and_every_example() {
    let readme = read(&root().join("README.md"));
    let words = readme.split_whitespace().count();
    assert!(words <= 600, "{words} words");
    let library = read(&root().join("docs/library.md"));
    for entry in std::fs::read_dir(root().join("crates/opruga/examples")).expect("the examples") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        assert!(readme.contains(&name) && library.contains(&name), "{name} is on README.md and docs/library.md");
    }
}
