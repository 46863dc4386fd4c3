//! No name contains a word that the glossary replaces.

use std::process::Command;

#[test]
fn no_name_has_a_replaced_word() {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("names").output().expect("xtask runs");
    let [found, refused] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{found}{refused}");
    let count: usize = found.split(' ').next().and_then(|count| count.parse().ok()).expect("a number of names");
    assert!(count > 10_000 && found.contains("names have none of"), "{found}");
}
