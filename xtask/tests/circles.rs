//! The files of a crate have no more import cycles than allowed: `ALLOWED` in `xtask/src/circles.rs`.

use std::process::Command;

#[test]
fn no_new_import_circles() {
    let output = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("circles").output().expect("xtask runs");
    let [found, refused] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(output.status.success(), "{found}{refused}");
    assert!(found.lines().last().is_some_and(|line| line.contains("circles, the largest of")), "{found}");
}
