//! Checks that every dependency has a licence that is compatible with MIT or Apache-2.0.

use serde_json::Value;
use std::process::Command;

/// The permitted licences. One of several alternatives (`OR`) is sufficient, but all parts of a conjunction (`AND`) are required.
const ALLOWED: [&str; 15] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "Unicode-3.0",
    "Unlicense",
    "CC0-1.0",
    "0BSD",
    "BSL-1.0",
    "OFL-1.1",
    // This is the licence of a font of the window's toolkit. It permits redistribution, as OFL-1.1 does.
    "Ubuntu-font-1.0",
];

/// Reads the dependency graph and refuses unknown licences.
pub(crate) fn check() -> Result<(), String> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--all-features"])
        .output()
        .map_err(|e| format!("cargo metadata: {e}"))?;
    let metadata: Value = serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))?;
    let packages = metadata["packages"].as_array().ok_or("cargo metadata names no packages")?;
    let mut refused = Vec::new();
    for package in packages {
        let licence = package["license"].as_str().unwrap_or("none stated");
        if !permitted(licence) {
            refused.push(format!("{} {}: {licence}", package["name"], package["version"]));
        }
    }
    if refused.is_empty() {
        println!("{} packages, all with permitted licences", packages.len());
        return Ok(());
    }
    Err(format!("licences that are not permitted:\n{}", refused.join("\n")))
}

/// Whether a licence expression can be satisfied with permitted licences.
fn permitted(expression: &str) -> bool {
    let plain = expression.replace(['(', ')'], " ").replace('/', " OR ");
    plain.split(" AND ").all(|sum| sum.split(" OR ").any(|one| ALLOWED.contains(&one.trim())))
}

#[cfg(test)]
mod tests {
    use super::permitted;

    #[test]
    fn one_permitted_alternative_is_enough_and_every_part_of_a_sum_is_needed() {
        assert!(permitted("MIT OR Apache-2.0"));
        assert!(permitted("MIT/Apache-2.0"));
        assert!(permitted("GPL-3.0 OR MIT"));
        assert!(permitted("(MIT OR Apache-2.0) AND Unicode-3.0"));
        assert!(!permitted("MIT AND GPL-3.0"));
        assert!(!permitted("none stated"));
    }
}
