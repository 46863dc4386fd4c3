//! The window is built when it is first used.

use super::*;

/// The output of cargo is visible, because nothing else is seen for minutes.
#[test]
#[cfg(unix)]
fn what_cargo_says_while_it_builds_the_window_is_seen() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let cargo = folder.path().join("cargo");
    // Cargo is replaced by a script that prints its arguments where cargo shows its progress.
    std::fs::write(&cargo, "#!/bin/sh\necho \"   Compiling $*\" >&2\n").expect("a file");
    std::fs::set_permissions(&cargo, std::fs::Permissions::from_mode(0o755)).expect("it is one's own");
    for call in [&[][..], &["studio", "heart"]] {
        let mut command = program(folder.path(), call);
        command.env("CARGO", &cargo).env("CARGO_MANIFEST_DIR", env!("CARGO_MANIFEST_DIR")).env("DISPLAY", ":99");
        let output = command.output().expect("it runs");
        assert_eq!(code(&output), 0, "{}", said(&output));
        let said = said(&output);
        let line = said.lines().find(|line| line.starts_with("   Compiling run ")).unwrap_or_else(|| panic!("{said}"));
        assert!(line.contains("--package opruga-studio") && line.ends_with(call.last().unwrap_or(&"--")), "{line}");
        assert!(!line.split(' ').any(|word| matches!(word, "--quiet" | "-q")), "{line}");
    }
}
