//! The allowed dependencies between crates: unpack depends on none; math ← {mesh, video, words}, mesh ← core ← solve ← {models, integrators, collide}
//! ← world ← io ← draw ← opruga ← {studio, verify} ← cli.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The layer of each crate: a crate may depend only on lower layers, so siblings cannot depend on one another.
fn layers() -> BTreeMap<&'static str, u32> {
    BTreeMap::from([
        ("opruga-math", 0),
        ("opruga-video", 1),
        ("opruga-words", 1),
        ("opruga-unpack", 0),
        ("opruga-mesh", 1),
        ("opruga-core", 2),
        ("opruga-solve", 3),
        ("opruga-models", 4),
        ("opruga-integrators", 4),
        ("opruga-collide", 4),
        ("opruga-world", 5),
        ("opruga-io", 6),
        ("opruga-draw", 7),
        ("opruga", 8),
        ("opruga-studio", 9),
        ("opruga-verify", 9),
        ("opruga-cli", 10),
        ("xtask", 11),
    ])
}

#[test]
fn crates_depend_on_lower_layers_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace has a folder");
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root)
        .output()
        .expect("cargo runs");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON");
    let layers = layers();
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() >= 13, "the whole workspace is looked at");
    for package in packages {
        let name = package["name"].as_str().expect("a name");
        let layer =
            layers.get(name).unwrap_or_else(|| panic!("{name} has no layer: add it here and to ARCHITECTURE.md"));
        for dependency in package["dependencies"].as_array().expect("dependencies") {
            // Tests may depend on anything.
            if dependency["kind"].as_str() == Some("dev") {
                continue;
            }
            let other = dependency["name"].as_str().expect("a name");
            if let Some(below) = layers.get(other) {
                assert!(below < layer, "{name} (layer {layer}) must not depend on {other} (layer {below})");
            }
        }
    }
}

#[test]
fn physics_crates_do_no_input_or_output() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace has a folder");
    for name in [
        "opruga-math",
        "opruga-mesh",
        "opruga-core",
        "opruga-solve",
        "opruga-models",
        "opruga-integrators",
        "opruga-collide",
    ] {
        let mut folders = vec![root.join("crates").join(name).join("src")];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).expect("a folder of sources") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let text = std::fs::read_to_string(&path).expect("a source file");
                for word in ["std::fs", "std::net", "std::time::Instant", "SystemTime", "println!", "std::env"] {
                    assert!(!text.contains(word), "{} uses {word}", path.display());
                }
            }
        }
    }
}

/// Layers above models, integrators and obstacles ask for a role (`Spec::has_role`) or a capability, and do not compare the names of kinds.
/// Benchmarks choose theirs by name.
#[test]
fn layers_above_compare_no_model_and_no_integrator_by_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let kinds: Vec<String> = sources(&root.join("crates/opruga-models/src"))
        .into_iter()
        .chain(sources(&root.join("crates/opruga-integrators/src")))
        .flat_map(|(_, text)| {
            let words = text.split("kind: \"").skip(1).filter_map(|rest| rest.split('"').next().map(String::from));
            words.collect::<Vec<_>>()
        })
        .chain(["half_space", "capsule", "triangle_mesh"].map(String::from))
        .collect();
    assert!(kinds.iter().any(|kind| kind == "mass_spring") && kinds.iter().any(|kind| kind == "newmark"), "{kinds:?}");
    for name in ["opruga-world", "opruga-io", "opruga", "opruga-studio", "opruga-cli"] {
        for (path, text) in sources(&root.join("crates").join(name).join("src")) {
            let path = path.to_string_lossy().into_owned();
            if ["/tests", "/bench/", "tests.rs", "testing"].iter().any(|part| path.contains(part)) {
                continue;
            }
            let product = text.split("#[cfg(test)]").next().unwrap_or("");
            for kind in &kinds {
                // Words of selectors, commands, loads, readings and fields of `[world]` as well.
                let selects = kind == "half_space" && path.ends_with("selectors.rs");
                if selects || ["drag", "pressure"].contains(&kind.as_str()) {
                    continue;
                }
                for (before, after) in [("== ", ""), ("!= ", ""), ("Some(", ")"), ("model(", ""), ("integrator(", "")] {
                    let compared = format!("{before}\"{kind}\"{after}");
                    assert!(!product.contains(&compared), "{path} says {compared}");
                }
                for after in [" =>", " |"] {
                    let matched = format!("\"{kind}\"{after}");
                    assert!(!product.contains(&matched), "{path} says {matched}");
                }
            }
        }
    }
}

/// Programs choose the models and integrators of their scenes and pass them on; no layer in between uses those of the library by itself. Functions
/// that use them by default can be given others.
#[test]
fn registries_are_passed_in() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let defaults = [
        "opruga-world/src/registry.rs",
        "opruga-world/src/any_scene.rs",
        "opruga-world/src/start.rs",
        "opruga/src/lib.rs",
        "opruga/src/sweep/programs.rs",
        "opruga-verify/src/lab.rs",
    ];
    let programs = ["opruga-cli/src/main.rs", "opruga-studio/src/main.rs"];
    let mut found = Vec::new();
    for name in ["opruga-world", "opruga-io", "opruga-draw", "opruga", "opruga-verify", "opruga-studio", "opruga-cli"] {
        for (path, text) in sources(&root.join("crates").join(name).join("src")) {
            let path = path.strip_prefix(root.join("crates")).expect("a crate").to_string_lossy().replace('\\', "/");
            let product = text.split("#[cfg(test)]").next().unwrap_or("");
            let lines = product.lines().filter(|line| !line.trim_start().starts_with("//"));
            let taken = |line: &str| {
                [
                    "Registry::default()",
                    "Registries::default()",
                    "catalogue()",
                    "opruga_models::all",
                    "opruga_integrators::all",
                ]
                .iter()
                .any(|form| line.contains(form))
                    || line.contains("Registry::<") && line.contains("default()")
            };
            if !path.contains("/tests") && lines.into_iter().any(taken) {
                found.push(path);
            }
        }
    }
    found.sort_unstable();
    let mut known: Vec<&str> = defaults.into_iter().chain(programs).collect();
    known.sort_unstable();
    assert_eq!(found, known);
}

/// The sources of a folder and of the folders in it.
fn sources(folder: &Path) -> Vec<(std::path::PathBuf, String)> {
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            out.extend(sources(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = std::fs::read_to_string(&path).expect("a source file");
            out.push((path, text));
        }
    }
    out
}
