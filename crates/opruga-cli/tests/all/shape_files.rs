//! Scenes that name files, as their users see them: where files are looked up, what is refused, what a checkpoint contains.
#![allow(clippy::disallowed_methods)] // no physics here

use std::path::Path;
use std::process::{Command, Output};

const HEART: &[u8] = include_bytes!("../../../../scenes/shapes/heart.svg");

fn opruga(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_opruga")).args(arguments).current_dir(folder).output().expect("the program runs")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with a scene in `scenes`, the drawing in `scenes/art`, and a copy of it outside.
fn folder(file: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("scenes/art")).expect("folders");
    std::fs::write(folder.path().join("scenes/art/heart.svg"), HEART).expect("a drawing");
    std::fs::write(folder.path().join("secret.svg"), "root:x:0:0 is no drawing").expect("a secret");
    let scene = format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.2\n[integrator]\nkind = \"symplectic_euler\"\n\
         [world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"heart\"\nnode_mass = 0.01\n\
         shape = {{ kind = \"svg\", file = \"{file}\", spacing = 0.1, size = 1.0, filling = \"triangles\" }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 50.0 }}]\n"
    );
    std::fs::write(folder.path().join("scenes/mine.toml"), scene).expect("a scene");
    folder
}

#[test]
fn files_are_looked_up_beside_the_scene_wherever_the_program_is_started() {
    let folder = folder("art/heart.svg");
    let output = opruga(folder.path(), &["run", "scenes/mine.toml", "--out", "a", "--no-pictures"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let output = opruga(&folder.path().join("scenes"), &["check", "mine.toml"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
}

#[test]
fn a_missing_file_is_told_with_the_nearest_name_and_exit_code_4() {
    let folder = folder("art/haert.svg");
    let output = opruga(folder.path(), &["run", "scenes/mine.toml", "--out", "a"]);
    let told = text(&output.stderr);
    assert_eq!(code(&output), 4, "{told}");
    assert!(told.contains("scenes/mine.toml:12:") && told.contains("did you mean `art/heart.svg`?"), "{told}");
    assert!(!folder.path().join("a").exists(), "nothing is written");
}

#[test]
fn a_misspelt_word_beside_a_file_is_the_only_error_and_hides_no_other() {
    let folder = folder("art/heart.svg");
    let path = folder.path().join("scenes/mine.toml");
    let scene = std::fs::read_to_string(&path).expect("the scene");
    std::fs::write(&path, scene.replace("node_mass = 0.01", "node_mass = 0.01\nmas = 3")).expect("a scene");
    let output = opruga(folder.path(), &["check", "scenes/mine.toml"]);
    let told = text(&output.stderr);
    assert_eq!(code(&output), 2, "{told}");
    assert!(told.contains("there is no field `mas`") && !told.contains("scene.shape"), "{told}");
    std::fs::write(&path, scene.replace("node_mass = 0.01", "node_mass = 0.01\nmas = 3").replace("heart", "hart"))
        .expect("a scene");
    let told = text(&opruga(folder.path(), &["check", "scenes/mine.toml"]).stderr);
    assert!(told.contains("there is no field `mas`") && told.contains("hart.svg"), "{told}");
}

#[test]
fn files_outside_of_the_folder_are_refused_and_never_shown() {
    let links = folder("art/link.svg");
    #[cfg(unix)]
    std::os::unix::fs::symlink(links.path().join("secret.svg"), links.path().join("scenes/art/link.svg"))
        .expect("a link");
    let absolute = folder("PLACE");
    let place = absolute.path().join("secret.svg").display().to_string().replace('\\', "/");
    let scene = absolute.path().join("scenes/mine.toml");
    let changed = std::fs::read_to_string(&scene).expect("a scene").replace("PLACE", &place);
    std::fs::write(&scene, changed).expect("a scene");
    for folder in [folder("../secret.svg"), folder("art/../../secret.svg"), folder("C:\\\\secret.svg"), links, absolute]
    {
        let output = opruga(folder.path(), &["check", "scenes/mine.toml"]);
        let told = text(&output.stderr);
        assert_eq!(code(&output), 2, "{told}");
        assert!(told.contains("shape.outside") && told.contains("--allow-outside"), "{told}");
        assert!(!told.contains("root:x"), "{told}");
    }
    // If allowed, it is read, but is not a drawing.
    let output = opruga(folder("../secret.svg").path(), &["check", "scenes/mine.toml", "--allow-outside"]);
    assert!(code(&output) == 2 && text(&output.stderr).contains("svg.syntax"), "{}", text(&output.stderr));
}

#[cfg(unix)]
#[test]
fn folders_and_devices_are_no_shapes() {
    let devices = folder("art/zero.svg");
    std::os::unix::fs::symlink("/dev/zero", devices.path().join("scenes/art/zero.svg")).expect("a link");
    for (folder, more) in [(folder("art"), "--strict"), (devices, "--allow-outside")] {
        let output = opruga(folder.path(), &["check", "scenes/mine.toml", more]);
        let told = text(&output.stderr);
        assert!(code(&output) == 4 && told.contains("read.not_regular_file"), "{told}");
    }
}

#[test]
fn a_checkpoint_keeps_the_files_of_its_scene() {
    let folder = folder("art/heart.svg");
    let run = |arguments: &[&str]| {
        let output = opruga(folder.path(), arguments);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    };
    run(&["run", "scenes/mine.toml", "--out", "whole", "--seconds", "0.4", "--no-pictures"]);
    run(&["run", "scenes/mine.toml", "--out", "half", "--seconds", "0.2", "--no-pictures"]);
    std::fs::remove_dir_all(folder.path().join("scenes")).expect("the scene goes");
    run(&["run", "--resume", "half/checkpoint", "--out", "rest", "--seconds", "0.4", "--no-pictures"]);
    let last = |name: &str| std::fs::read_to_string(folder.path().join(name).join("final.csv")).expect("a table");
    assert_eq!(last("whole"), last("rest"));
}
