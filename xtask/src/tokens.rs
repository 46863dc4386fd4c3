//! Measures the size of the product code: Rust tokens outside tests and comments, and long functions, per crate.
//!
//! The text is not parsed: a few lexical rules separate tokens. Only the change from commit to commit matters.

use crate::workspace;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// A function with at least this number of lines counts as long. The lines of its head and its body count, without that of the last brace.
const LONG: usize = 60;

/// The size of a crate, or of all.
#[derive(Clone, Debug, Default, PartialEq)]
struct Size {
    tokens: usize,
    /// Names and lines of the long functions.
    long: Vec<(String, usize)>,
}

impl Size {
    fn add(&mut self, other: Size) {
        self.tokens += other.tokens;
        self.long.extend(other.long);
    }
}

/// `cargo xtask tokens [BASE] [--long]`.
pub(crate) fn report(arguments: &[String]) -> Result<(), String> {
    let words: Vec<&String> = arguments.iter().filter(|word| *word != "--long").collect();
    if words.len() > 1 {
        return Err(format!("`{}` says nothing here: one commit is compared", words[1]));
    }
    let now = sizes(&present()?);
    let before =
        words.first().map(|name| Ok::<_, String>(sizes(&of_commit(&workspace::commit(name)?)?))).transpose()?;
    print!("{}", table(&now, before.as_ref()));
    if arguments.len() > words.len() {
        for (name, size) in &now {
            size.long.iter().for_each(|(function, lines)| println!("{name}: {function}, {lines} lines"));
        }
    }
    Ok(())
}

/// Makes a table with a row for every crate and one for all. The changes since a commit are next to the figures.
fn table(now: &BTreeMap<String, Size>, before: Option<&BTreeMap<String, Size>>) -> String {
    let with_sum = |sizes: &BTreeMap<String, Size>| {
        let mut sum = Size::default();
        sizes.values().for_each(|size| sum.add(size.clone()));
        sizes.clone().into_iter().chain([("all".to_string(), sum)]).collect::<Vec<_>>()
    };
    let before: Option<BTreeMap<String, Size>> = before.map(|before| with_sum(before).into_iter().collect());
    let mut rows = with_sum(now);
    // The rows of removed crates come before the sum.
    let gone = before.iter().flat_map(BTreeMap::keys).filter(|name| *name != "all" && !now.contains_key(*name));
    let gone: Vec<_> = gone.map(|name| (name.clone(), Size::default())).collect();
    rows.splice(now.len()..now.len(), gone);
    let mut text = format!("{:<20} {:>9} {:>9}", "crate", "tokens", format!("> {LONG}"));
    text += if before.is_some() { "   change   change\n" } else { "\n" };
    for (name, size) in rows {
        text += &format!("{name:<20} {:>9} {:>9}", size.tokens, size.long.len());
        if let Some(before) = &before {
            let then = before.get(&name).cloned().unwrap_or_default();
            let change = |now: usize, then: usize| now as i64 - then as i64;
            let [tokens, long] = [change(size.tokens, then.tokens), change(size.long.len(), then.long.len())];
            text += &format!("{tokens:>+9}{long:>+9}");
        }
        text += "\n";
    }
    text
}

/// The sizes of the crates that contain these files.
fn sizes(files: &[(String, String)]) -> BTreeMap<String, Size> {
    let mut out: BTreeMap<String, Size> = BTreeMap::new();
    for (path, text) in files {
        if let Some(name) = counted(path) {
            out.entry(name.into()).or_default().add(size(text));
        }
    }
    out
}

/// The crate of a file that is counted: Rust below `crates/NAME/src`, without `tests` and `testing`.
fn counted(path: &str) -> Option<&str> {
    let parts: Vec<&str> = path.strip_suffix(".rs")?.split('/').collect();
    match parts[..] {
        ["crates", name, "src", ref inside @ ..] => {
            let is_test = inside.iter().any(|part| ["tests", "testing"].contains(part));
            (!is_test).then_some(name)
        }
        _ => None,
    }
}

/// The files of the working tree.
fn present() -> Result<Vec<(String, String)>, String> {
    let root = workspace::root()?;
    let text = |path: &Path| {
        let name = path.strip_prefix(&root).map_err(|e| e.to_string())?;
        let name: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
        Ok((name.join("/"), workspace::read(path)?))
    };
    workspace::rust_files(&root.join("crates"))?.iter().map(|path| text(path)).collect()
}

/// The files of a commit.
fn of_commit(commit: &str) -> Result<Vec<(String, String)>, String> {
    let list = workspace::git(&["ls-tree", "-r", "--name-only", commit, "crates"])?;
    let paths: Vec<&str> = list.lines().filter(|path| counted(path).is_some()).collect();
    let failed = |e: std::io::Error| format!("git cat-file: {e}");
    let mut git = Command::new("git")
        .args(["cat-file", "--batch"])
        .current_dir(workspace::root()?)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    let input = git.stdin.take();
    let asked: String = paths.iter().map(|path| format!("{commit}:{path}\n")).collect();
    // Git answers while it receives requests. Without a second thread, both sides would wait for each other.
    let asking = std::thread::spawn(move || input.map_or(Ok(()), |mut input| input.write_all(asked.as_bytes())));
    let answer = git.wait_with_output().map_err(failed)?.stdout;
    asking.join().map_err(|_| "git cat-file was not asked")?.map_err(failed)?;
    let mut rest = &answer[..];
    let mut out = Vec::with_capacity(paths.len());
    for path in paths {
        let (text, behind) = answered(rest).ok_or_else(|| format!("git cat-file does not know {path}"))?;
        out.push((path.to_string(), String::from_utf8_lossy(text).into_owned()));
        rest = behind;
    }
    Ok(out)
}

/// Splits off one answer of `git cat-file --batch`: the line `HASH blob BYTES`, the bytes and a line end. Returns the bytes and the remaining text.
fn answered(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    let length: usize = head.split(' ').nth(2)?.parse().ok()?;
    let (text, rest) = bytes[end + 1..].split_at_checked(length)?;
    Some((text, rest.get(1..)?))
}

/// The code of a file without comments and tests.
pub(crate) fn product(text: &str) -> String {
    without_tests(&without_comments(text))
}

/// The size of a file.
fn size(text: &str) -> Size {
    let body = product(text);
    let (mut tokens, mut rest) = (0, body.as_str());
    while let Some(first) = rest.chars().next() {
        let length = token(rest);
        tokens += usize::from(length > 0);
        rest = &rest[if length > 0 { length } else { first.len_utf8() }..];
    }
    Size { tokens, long: long_functions(&body) }
}

/// The text without comments. In a line with quotes, `//` may be part of a text, so such a line is removed only if it begins with `//`.
fn without_comments(text: &str) -> String {
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some((before, inside)) = rest.split_once("/*") {
        let Some((_, behind)) = inside.split_once("*/") else { break };
        out.push_str(before);
        out.push(' ');
        rest = behind;
    }
    out.push_str(rest);
    let code = |line: &str| match line.find("//") {
        Some(at) if !line.contains('"') || line[..at].trim().is_empty() => line[..at].to_string(),
        _ => line.to_string(),
    };
    out.split('\n').map(code).collect::<Vec<_>>().join("\n")
}

/// The text without the items that `#[cfg(test)]` marks.
fn without_tests(text: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(MARK) {
        let behind = at + MARK.len();
        match item(&rest[behind..]) {
            Some(head) => {
                out.push_str(&rest[..at]);
                rest = &rest[behind + head + item_body(&rest[behind + head..])..];
            }
            None => {
                out.push_str(&rest[..behind]);
                rest = &rest[behind..];
            }
        }
    }
    out + rest
}

/// The length of further attributes, of `pub` and of the keyword of an item at the beginning of a text.
fn item(text: &str) -> Option<usize> {
    let mut rest = text.trim_start();
    while let Some(attribute) = rest.strip_prefix("#[") {
        rest = attribute.split_once(']')?.1.trim_start();
    }
    if let Some(public) = rest.strip_prefix("pub") {
        let inner = public.strip_prefix('(').and_then(|inner| inner.split_once(')')).map_or(public, |(_, rest)| rest);
        rest = if inner.starts_with(char::is_whitespace) { inner.trim_start() } else { rest };
    }
    let length = rest.find(|letter| !is_word(letter)).unwrap_or(rest.len());
    let items = ["mod", "fn", "use", "impl", "struct", "const", "static", "type", "enum", "trait"];
    items.contains(&&rest[..length]).then(|| text.len() - rest.len() + length)
}

/// The length of an item after its keyword: up to its semicolon or the end of its braces.
fn item_body(text: &str) -> usize {
    let mut depth = 0;
    for (at, letter) in text.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth > 0 => {
                depth -= 1;
                if depth == 0 {
                    return at + 1;
                }
            }
            ';' if depth == 0 => return at + 1,
            _ => {}
        }
    }
    text.len()
}

fn is_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

fn begins_word(text: &str) -> bool {
    text.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_')
}

/// The length of the token at the beginning of a text; 0 if there is none.
fn token(text: &str) -> usize {
    let Some(first) = text.chars().next() else { return 0 };
    let word = |from: usize, ends: fn(char) -> bool| text[from..].find(ends).map_or(text.len(), |length| from + length);
    if let Some(length) = raw_text(text).or_else(|| quoted(text)).or_else(|| letter(text)) {
        length
    } else if first == '\'' && begins_word(&text[1..]) {
        word(1, |letter| !is_word(letter))
    } else if begins_word(text) {
        word(0, |letter| !is_word(letter))
    } else if first.is_ascii_digit() {
        word(0, |letter| !is_word(letter) && letter != '.')
    } else if let Some(sign) = ["=>", "->", "::", "..=", ".."].iter().find(|sign| text.starts_with(**sign)) {
        sign.len()
    } else if "-+*/%&|^=!<>".contains(first) {
        1 + usize::from(text[1..].starts_with('='))
    } else if first.is_whitespace() || is_word(first) {
        0
    } else {
        first.len_utf8()
    }
}

/// The length of a raw text at the beginning: `r"…"`, also with hashes.
fn raw_text(text: &str) -> Option<usize> {
    let behind = text.strip_prefix('r')?;
    let inside = behind.trim_start_matches('#');
    let end = format!("\"{}", "#".repeat(behind.len() - inside.len()));
    let inside = inside.strip_prefix('"')?;
    Some(text.len() - inside.len() + inside.find(&end)? + end.len())
}

/// The length of a text at the beginning: `"…"` or `b"…"`.
fn quoted(text: &str) -> Option<usize> {
    let inside = text.strip_prefix('b').unwrap_or(text).strip_prefix('"')?;
    let mut letters = inside.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\\' => drop(letters.next()?),
            '"' => return Some(text.len() - inside.len() + at + 1),
            _ => {}
        }
    }
    None
}

/// The length of a character at the beginning: `'x'`, `b'x'` or `'\n'`.
fn letter(text: &str) -> Option<usize> {
    let inside = text.strip_prefix('b').unwrap_or(text).strip_prefix('\'')?;
    let mut letters = inside.chars();
    match letters.next()? {
        '\'' => return None,
        '\\' => drop(letters.next()?),
        _ => {}
    }
    letters.as_str().strip_prefix('\'').map(|rest| text.len() - rest.len())
}

/// Names and lines of the long functions. The text is formatted, so the body of a function ends at the first brace with the indentation of its head.
fn long_functions(text: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = text.split('\n').collect();
    let mut out = Vec::new();
    for (begin, line) in lines.iter().enumerate() {
        let Some((indent, name)) = function(line) else { continue };
        let head_ends = |line: &&str| line.trim_end().ends_with(['{', ';']);
        let Some(head) = lines[begin..].iter().position(head_ends) else { continue };
        if lines[begin + head].trim_end().ends_with(';') {
            continue;
        }
        let last = format!("{indent}}}");
        let length = lines[begin + head..].iter().position(|line| line.trim_end() == last);
        if let Some(length) = length.map(|length| head + length).filter(|length| *length > LONG) {
            out.push((name.to_string(), length));
        }
    }
    out
}

/// Indentation and name of the function whose head begins on a line.
fn function(line: &str) -> Option<(&str, &str)> {
    let mut rest = line.trim_start();
    let indent = &line[..line.len() - rest.len()];
    if let Some(public) = rest.strip_prefix("pub ") {
        rest = public;
    } else if let Some(public) = rest.strip_prefix("pub(") {
        rest = public.split_once(") ")?.1;
    }
    while let Some(behind) =
        ["default ", "const ", "async ", "unsafe ", "extern \"C\" "].iter().find_map(|word| rest.strip_prefix(word))
    {
        rest = behind;
    }
    let name = rest.strip_prefix("fn ")?;
    let length = name.find(|letter| !is_word(letter)).unwrap_or(name.len());
    (length > 0).then(|| (indent, &name[..length]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> usize {
        size(text).tokens
    }

    #[test]
    fn tokens_are_words_numbers_signs_and_texts() {
        assert_eq!(tokens("let x = a.b + 1.5e3;"), 9);
        assert_eq!(tokens("for i in 0..n { x += f(i)?; }"), 14, "a range of a number is one");
        assert_eq!(tokens(r##"s("a \" b", r#"c " d"#, 'e', '\n', b'f', &'g h)"##), 16);
        assert_eq!(tokens("a => b -> c :: d ..= e .. f == g"), 13);
    }

    #[test]
    fn comments_and_tests_do_not_count() {
        assert_eq!(tokens("/// a b c\nlet x = 1; // d\n/* e\nf */ y();"), tokens("let x = 1; y();"));
        assert_eq!(tokens("let x = \"http://y\"; // d"), 8, "behind a text nothing is taken for a comment");
        let item = "#[cfg(test)]\n#[allow(x)]\npub(crate) mod tests { fn f() { g(); } }\n";
        assert_eq!(tokens(&format!("fn a() {{}}\n{item}fn b() {{}}")), 12);
        assert_eq!(tokens("#[cfg(test)]\nuse a::b;\nfn c() {}"), 6);
    }

    #[test]
    fn long_functions_are_found_by_their_indentation() {
        let body = |lines: usize| "        x();\n".repeat(lines);
        let text = format!(
            "impl A {{\n    pub(crate) const fn long(\n        a: u32,\n    ) {{\n{}    }}\n    fn short() {{\n{}    }}\n}}\n",
            body(LONG),
            body(LONG - 1)
        );
        assert_eq!(size(&text).long, [("long".to_string(), LONG + 3)]);
    }

    #[test]
    fn files_belong_to_crates() {
        assert_eq!(counted("crates/a/src/b/c.rs"), Some("a"));
        for path in ["crates/a/src/b/tests.rs", "crates/a/src/testing/c.rs", "crates/a/tests/c.rs", "xtask/src/d.rs"] {
            assert_eq!(counted(path), None, "{path}");
        }
    }

    #[test]
    fn changes_are_told_of_crates_that_come_and_go_too() {
        let sizes = |names: &[(&str, usize)]| -> BTreeMap<String, Size> {
            names.iter().map(|(name, tokens)| (name.to_string(), Size { tokens: *tokens, long: Vec::new() })).collect()
        };
        let text = table(&sizes(&[("a", 5), ("c", 2)]), Some(&sizes(&[("a", 7), ("b", 1)])));
        let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split_whitespace().collect()).collect();
        assert_eq!(
            rows,
            [
                ["a", "5", "0", "-2", "+0"],
                ["c", "2", "0", "+2", "+0"],
                ["b", "0", "0", "-1", "+0"],
                ["all", "7", "0", "-1", "+0"]
            ]
        );
    }
}
