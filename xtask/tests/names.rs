//! Names have no more words that the glossary replaces than are allowed: `ALLOWED` in `xtask/src/names.rs`.

use std::process::Command;

#[test]
fn no_new_names_have_replaced_words() {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("names").output().expect("xtask runs");
    let [found, refused] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{found}{refused}");
    assert!(found.lines().any(|line| line.starts_with("place: ")), "{found}");
}
