//! Random bytes and mutated scenes are read or refused, and never cause a panic.

use crate::common;
use common::*;
use opruga_io::scene::{Limits, Options, read};
use proptest::prelude::*;

fn options() -> Options {
    // Small limits: a mutation may ask for a billion nodes.
    Options {
        limits: Limits { nodes: 20_000, bodies: 2_000, memory_bytes: 64 << 20, ..Limits::default() },
        ..Options::default()
    }
}

fn survives(bytes: &[u8]) {
    if let Err(errors) = read(bytes, "scene.toml", &catalogue(), &options()) {
        assert!(!errors.is_empty());
        for error in errors {
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()), "{error:?}");
        }
    }
}

/// Words that a mutation may insert.
const WORDS: [&str; 24] = [
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    ".",
    "\"",
    "'",
    "\n",
    "#",
    "nan",
    "-1",
    "1e308",
    "9223372036854775807",
    "[[body]]\n",
    "\"\"\"",
    "true",
    "\u{202e}",
    "body = \"row\"",
    "select = { all = true }",
    "[0]",
    "\u{0}",
    "0",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        survives(&bytes);
    }

    #[test]
    fn random_toml(text in "[\\[\\]{}=,.\"'# \na-c0-9]{0,200}") {
        survives(text.as_bytes());
    }

    #[test]
    fn mutated_scenes(changes in proptest::collection::vec((0..FULL.len(), 0..4usize, 0..WORDS.len(), any::<u8>(), 0..30usize), 1..6)) {
        let mut bytes = FULL.as_bytes().to_vec();
        for (at, how, word, byte, length) in changes {
            let at = at.min(bytes.len().saturating_sub(1));
            let end = (at + length).min(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => { bytes.splice(at..end, WORDS[word].bytes()); }
                2 => { bytes.splice(at..at, WORDS[word].bytes()); }
                _ => { let piece = bytes[at..end].to_vec(); bytes.splice(at..at, piece); }
            }
        }
        survives(&bytes);
    }

    #[test]
    fn random_overrides(path in "[a-z0-9.\\[\\]]{0,30}", value in "[\\[\\]{}=,.\"a-c0-9]{0,20}") {
        let options = Options { overrides: vec![(path, value)], ..options() };
        let _ = read(FULL.as_bytes(), "scene.toml", &catalogue(), &options);
    }
}
