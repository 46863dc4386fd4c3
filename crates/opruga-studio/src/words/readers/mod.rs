//! What the readers of scenes, shapes and meshes say in English, in Croatian.

mod maps;
mod notices;
mod scenes;
mod shapes;

/// Whole sentences, by what says them: of these and of those of the engine the first that fits counts.
pub(super) const SENTENCES: [&[(&str, &str)]; 4] =
    [notices::SENTENCES, maps::SENTENCES, shapes::SENTENCES, scenes::SENTENCES];

/// Parts of sentences.
pub(super) const PARTS: [&[(&str, &str)]; 1] = [shapes::PARTS];

#[cfg(test)]
mod tests {
    use super::super::details::{croatian, part, parts, whole};
    use super::super::said_in_sources::{literals, sources};
    use std::path::Path;

    /// What is no sentence for people, or is only told where a file is read outside of the studio: notes on what the scene asks
    /// for itself, and what would help against what is merely odd. Endings of files and words of formats are those of every language.
    const NOT_SHOWN: [&str; 25] = [
        "node belongs",
        "nodes belong",
        "to no element, the first is node",
        "m would keep it",
        "what any of them covers is inside",
        "what an odd number of them encloses is inside",
        "outline crosses, covers",
        "outlines cross, cover",
        "outlines are left",
        "a smaller `spacing` keeps finer detail, `filling = \"lattice\"` carries all of it",
        "fill-rule=\"evenodd\"` or `fill-rule=\"nonzero\"` in the file says which is meant",
        "outer loop",
        "areas from",
        "remesh` makes nearly equilateral ones",
        "size` gives the length that is meant",
        "millimetres: `scale = 0.001",
        "kilometres: `scale = 1000.0",
        "m, where `size` is not given",
        "perhaps it is in",
        "its edges run against them",
        "bodies live in the plane or in space",
        "duplicate key",
        "at position",
        "expected nothing",
        "missing table open",
    ];

    /// A source without its messages that are values: they have Croatian texts of their own.
    fn without_messages(text: &str) -> String {
        let text = text.replace("terms! {", "messages! {");
        let mut blocks = text.split("messages! {");
        let first = blocks.next().unwrap_or_default().to_string();
        blocks.fold(first, |out, block| out + block.split_once("\n}\n").map_or("", |(_, rest)| rest))
    }

    /// The words of a text between what is put into it.
    fn fragments(text: &str) -> Vec<String> {
        let text = text.replace("{{", "(").replace("}}", ")");
        let mut all = vec![String::new()];
        let mut within = false;
        for letter in text.chars() {
            match letter {
                '{' => within = true,
                '}' => {
                    within = false;
                    all.push(String::new());
                }
                letter if !within => all.last_mut().expect("there is one").push(letter),
                _ => {}
            }
        }
        all.iter()
            .map(|text| text.trim_matches([' ', ',', ';', ':', '(', ')', '[', ']', '`', '.']).to_string())
            .collect()
    }

    #[test]
    fn whatever_a_reader_of_scenes_shapes_and_meshes_says_has_croatian_words() {
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
        let io = crates.join("opruga-io/src");
        let folders = [io.join("shapes"), io.join("scene"), crates.join("opruga-mesh/src")];
        let files = ["document.rs", "files.rs", "overrides.rs", "source.rs"].map(|name| io.join(name));
        let files: Vec<String> = files
            .into_iter()
            .chain([crates.join("opruga-world/src/validity.rs")])
            .map(|path| std::fs::read_to_string(path).expect("a source"))
            .collect();
        let said: Vec<String> = folders
            .iter()
            .flat_map(|folder| sources(folder))
            .chain(files)
            // What stands in tests is said to nobody.
            .flat_map(|text| literals(&without_messages(text.split("#[cfg(test)]").next().unwrap_or_default())))
            .flat_map(|text| fragments(&text))
            // Two words and more; single ones are names of fields and formats.
            .filter(|words| words.len() >= 10 && words.contains(' ') && words.split(' ').any(|word| word.len() > 2))
            .filter(|words| words.chars().filter(|letter| letter.is_ascii_lowercase()).count() > 6)
            .collect();
        assert!(said.len() > 300, "the sources are read: {}", said.len());
        let known: Vec<&str> = whole().chain(parts()).map(|(english, _)| *english).collect();
        let missing: std::collections::BTreeSet<&String> = said
            .iter()
            .filter(|words| !known.iter().any(|english| english.contains(words.as_str())))
            .filter(|words| !NOT_SHOWN.contains(&words.as_str()))
            .collect();
        assert!(missing.is_empty(), "in English only: {missing:#?}");
        let stale: Vec<&&str> = NOT_SHOWN.iter().filter(|words| !said.iter().any(|text| text == *words)).collect();
        assert!(stale.is_empty(), "nobody says this any more: {stale:#?}");
    }

    #[test]
    fn sentences_that_fit_much_stand_behind_those_that_fit_little() {
        for (english, wanted) in [
            ("primitives of mode 1 cannot be read", "primitive načina 1 ne mogu se pročitati"),
            ("`r` is negative", "`r` je negativno"),
            ("there is no body 7; did you mean `ball`?", "nema tijela 7; misliš li `ball`?"),
            (
                "the surface is not closed: 1 free boundary, through (0, 1)",
                "ploha nije zatvorena: slobodnih rubova: 1, kroz (0, 1)",
            ),
        ] {
            assert_eq!(croatian(english).as_deref(), Some(wanted), "{english}");
        }
        assert_eq!(part("at most two").as_deref(), Some("najviše dva"));
        assert_eq!(part("at most 8192 pixels").as_deref(), Some("najviše 8192 piksela"));
    }
}
