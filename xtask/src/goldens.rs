//! Writes the golden hashes of the scenes.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Runs the test that compares the hashes in a mode in which it writes them. Reports which hashes have changed.
pub(crate) fn write() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the workspace has no folder")?;
    let file = root.join("scenes/golden.txt");
    let read = || std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()));
    let before = hashes(&read()?);
    let status = Command::new(env!("CARGO"))
        .args([
            "test",
            "--package",
            "opruga",
            "--test",
            "all",
            "--",
            "--ignored",
            "golden_hashes::every_scene_ends_with_its_golden_hash_in_all_ways",
        ])
        .env("OPRUGA_GOLDENS", "write")
        .current_dir(root)
        .status()
        .map_err(|e| format!("cargo test: {e}"))?;
    if !status.success() {
        return Err("the scenes do not run, or threads and vector instructions disagree: nothing is written".into());
    }
    let after = hashes(&read()?);
    let changes = changes(&before, &after);
    println!("{} of {} hashes have changed in {}", changes.len(), after.len(), file.display());
    for change in changes {
        println!("{change}");
    }
    Ok(())
}

/// Reads the frames and the hash of every scene.
fn hashes(text: &str) -> BTreeMap<String, String> {
    let lines = text.lines().filter(|l| !l.starts_with('#'));
    lines.filter_map(|l| l.trim().split_once(' ')).map(|(name, rest)| (name.into(), rest.into())).collect()
}

/// Added, removed and changed entries, one line each.
fn changes(before: &BTreeMap<String, String>, after: &BTreeMap<String, String>) -> Vec<String> {
    let mut out = Vec::new();
    for (name, now) in after {
        match before.get(name) {
            Some(then) if then == now => {}
            Some(then) => out.push(format!("  {name}: {then} -> {now}")),
            None => out.push(format!("  {name}: new, {now}")),
        }
    }
    out.extend(before.keys().filter(|name| !after.contains_key(*name)).map(|name| format!("  {name}: gone")));
    out
}

#[cfg(test)]
mod tests {
    use super::{changes, hashes};

    #[test]
    fn changed_new_and_lost_hashes_are_told() {
        let before = hashes("# head\na 1 00\nb 2 11\nc 3 22\n");
        let after = hashes("# head\na 1 00\nb 2 12\nd 4 33\n");
        assert_eq!(changes(&before, &after), ["  b: 2 11 -> 2 12", "  d: new, 4 33", "  c: gone"]);
    }
}
