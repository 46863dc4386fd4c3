//! No call loses a file that it reads, or one of its outputs to another one, whatever `--force` allows; and files of killed processes are removed.

use crate::common;

use common::{code, contents, opruga, program, said, until};
use std::path::Path;

const SCENE: &str = r#"
format = "opruga-1"
dimension = 2
[time]
seconds = 0.1
[integrator]
kind = "symplectic_euler"
[[body]]
name = "b"
mass = 1.0
shape = { kind = "svg", file = "drawing.svg", spacing = 0.2, size = 1.0 }
models = [{ kind = "mass_spring", stiffness = 10.0 }]
"#;
const DRAWING: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10"><path d="M0 0H10V10H0Z"/></svg>"#;
const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/// Calls that are refused with this code, before anything is computed or created, and change nothing.
fn refused(at: &Path, word: &str, calls: &[&[&str]]) {
    for call in calls {
        let before = contents_below(at);
        let output = opruga(at, call);
        assert_eq!(code(&output), 4, "{call:?}: {}", said(&output));
        assert!(said(&output).contains(&format!("error[{word}]")), "{call:?}: {}", said(&output));
        assert_eq!(contents_below(at), before, "{call:?}");
    }
}

fn go_on<'w>(more: &[&'w str]) -> Vec<&'w str> {
    [&["run", "--no-pictures", "--force", "--seconds=0.3"][..], more].concat()
}

fn meshed<'w>(more: &[&'w str]) -> Vec<&'w str> {
    [&["mesh", "in.obj", "--size=0.06", "--force"][..], more].concat()
}

fn contents_below(at: &Path) -> Vec<(String, Vec<u8>)> {
    let folders = ["o", "folder"].map(|name| at.join(name)).into_iter().filter(|path| path.is_dir());
    let own = std::fs::read_dir(at).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut all: Vec<(String, Vec<u8>)> = own
        .filter(|path| path.is_file())
        .map(|path| (path.display().to_string(), std::fs::read(&path).expect("a file")))
        .collect();
    all.sort();
    folders.for_each(|folder| all.extend(contents(&folder)));
    all
}

#[test]
fn no_run_replaces_its_scene_a_file_that_this_names_or_one_of_its_outputs() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::create_dir(at.join("folder")).expect("a folder");
    std::fs::write(at.join("s.toml"), SCENE).expect("a file");
    std::fs::write(at.join("drawing.svg"), DRAWING).expect("a file");
    // A scene whose drawing has the name of a picture of its run.
    std::fs::write(at.join("plots.toml"), SCENE.replace("drawing.svg", "plots.svg")).expect("a file");
    std::fs::write(at.join("plots.svg"), DRAWING).expect("a file");
    std::fs::hard_link(at.join("s.toml"), at.join("hard")).expect("a link");
    #[cfg(unix)]
    std::os::unix::fs::symlink("../s.toml", at.join("folder/link")).expect("a link");
    refused(
        at,
        "write.input",
        &[
            &["run", "s.toml", "--force", "--record", "s.toml"],
            &["run", "s.toml", "--force", "--record", "./s.toml"],
            &["run", "s.toml", "--force", "--record", "folder/../s.toml"],
            &["run", "s.toml", "--force", "--record", "hard"],
            &["run", "s.toml", "--force", "--record", "drawing.svg"],
            &["run", "plots.toml", "--force", "--out", "."],
            &["run", "plots.toml", "--force", "--out", "folder/.."],
            &["sweep", "plots.toml", "--set=time.substeps=1,2", "--metric=energy_drift", "--force", "--out=."],
        ],
    );
    #[cfg(unix)]
    refused(at, "write.input", &[&["run", "s.toml", "--force", "--record", "folder/link"]]);
    refused(
        at,
        "write.twice",
        &[
            &["run", "s.toml", "--force", "--out", "folder", "--record", "folder/final.csv"],
            &["run", "s.toml", "--force", "--out", "folder", "--record", "folder/../folder/checkpoint"],
        ],
    );
    // A file that is not an input may be replaced.
    let out = ["run", "s.toml", "--no-pictures", "--out", "o", "--record", "o/run.rec", "--force"];
    for _ in 0..2 {
        let output = opruga(at, &out);
        assert_eq!(code(&output), 0, "{}", said(&output));
    }
    let onto = go_on(&["--resume", "o/checkpoint", "--out", "folder", "--record", "o/checkpoint"]);
    refused(at, "write.input", &[&onto]);
    std::fs::rename(at.join("o/run.rec"), at.join("folder/run.glb")).expect("another name");
    refused(at, "write.input", &[&["replay", "folder/run.glb", "--gltf", "--force", "--out", "folder"]]);
    // A run can be resumed in its own folder, as always.
    let output = opruga(at, &go_on(&["--resume", "o/checkpoint", "--out", "o"]));
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(at.join("o/checkpoint.previous").is_file());
    std::fs::write(at.join("modes.csv"), DRAWING).expect("a file");
    std::fs::write(at.join("m.toml"), SCENE.replace("drawing.svg", "modes.csv")).expect("a file");
    refused(at, "write.input", &[&["modes", "m.toml", "--force", "--out", "."]]);
}

#[test]
fn no_mesh_replaces_its_input_and_no_picture_its_mesh() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::write(at.join("in.obj"), TETRAHEDRON).expect("a file");
    let made = opruga(at, &meshed(&["-o", "t.node"]));
    assert_eq!(code(&made), 0, "{}", said(&made));
    std::fs::hard_link(at.join("in.obj"), at.join("hard.png")).expect("a link");
    refused(
        at,
        "write.input",
        &[
            &meshed(&["--picture", "in.obj"]),
            &meshed(&["--picture", "./in.obj"]),
            &meshed(&["--picture", "hard.png"]),
            &["mesh", "t.node", "--force", "-o", "t.node"],
            // The second file of a mesh, which the first one names.
            &["mesh", "t.node", "--force", "--picture", "t.ele"],
            &["mesh", "t.ele", "--force", "--picture", "t.node"],
        ],
    );
    refused(
        at,
        "write.twice",
        &[
            &meshed(&["-o", "q.msh", "--picture", "q.msh"]),
            &meshed(&["-o", "q.msh", "--picture", "./q.msh"]),
            &meshed(&["-o", "q.msh", "--picture", "Q.MSH"]),
            &meshed(&["-o", "q.node", "--picture", "q.ele"]),
        ],
    );
    assert_eq!(code(&opruga(at, &meshed(&["-o", "q.msh"]))), 0);
    assert!(at.join("q.msh").is_file() && at.join("q.msh.png").is_file());
}

/// A killed run leaves a lock and a half-written checkpoint. The next run in the folder removes them, even if it is refused; files that a living
/// process writes stay.
#[test]
fn what_a_killed_process_leaves_goes_with_the_next_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let out = at.join("o");
    let endless = ["run", "ball", "--seconds=1e6", "--no-pictures", "--checkpoint-every=1e-9", "--out=o"];
    let mut child = program(at, &endless).spawn().expect("it starts");
    until("a checkpoint", || out.join("checkpoint").is_file());
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    // A file as left by a kill during a write.
    std::fs::write(out.join(".checkpoint.7.writing"), "half").expect("a file");
    assert!(out.join(".opruga-lock").exists());
    let living = std::fs::File::create(out.join(".other.msh.8.writing")).expect("a file");
    living.lock().expect("a lock");
    let hidden = || {
        let entries = std::fs::read_dir(&out).expect("a folder").map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<String> = entries.filter_map(|name| name.into_string().ok()).collect();
        names.retain(|name| name.starts_with('.'));
        names
    };
    let refused = opruga(at, &["run", "ball", "--seconds=0", "--no-pictures", "--out=o"]);
    assert_eq!(code(&refused), 4, "{}", said(&refused));
    assert_eq!(hidden(), [".other.msh.8.writing"]);
    drop(living);
    let output = opruga(at, &["run", "ball", "--seconds=0", "--no-pictures", "--out=o", "--force"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(hidden().is_empty(), "{:?}", hidden());
    // Next to single files as well.
    std::fs::write(at.join("in.obj"), TETRAHEDRON).expect("a file");
    std::fs::write(at.join(".q.msh.7.writing"), "half").expect("a file");
    let output = opruga(at, &["mesh", "in.obj", "--size=0.06", "-o", "q.msh"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(!at.join(".q.msh.7.writing").exists());
}
