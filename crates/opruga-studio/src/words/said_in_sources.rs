//! The texts that sources say, for tests that look for them.

/// The sources in a folder and below.
pub(super) fn sources(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .flat_map(|entry| match entry.path() {
            path if path.is_dir() => sources(&path),
            path => std::fs::read_to_string(path).into_iter().collect(),
        })
        .collect()
}

/// The texts in quotes of a source, lines joined.
pub(super) fn literals(source: &str) -> Vec<String> {
    let (mut all, mut now, mut escaped) = (Vec::new(), None::<String>, false);
    let mut letters = source.chars().peekable();
    while let Some(letter) = letters.next() {
        match (&mut now, letter) {
            (Some(_), '\n') if escaped => {
                while letters.next_if(|next| next.is_whitespace()).is_some() {}
                escaped = false;
            }
            (Some(text), letter) if escaped => {
                text.push(letter);
                escaped = false;
            }
            (Some(_), '\\') => escaped = true,
            (Some(_), '"') => all.extend(now.take()),
            (Some(text), letter) => text.push(letter),
            (None, '\'') if letters.peek() == Some(&'"') => drop(letters.next()),
            (None, '/') if letters.peek() == Some(&'/') => while letters.next_if(|next| *next != '\n').is_some() {},
            (None, '"') => now = Some(String::new()),
            (None, _) => {}
        }
    }
    all
}
