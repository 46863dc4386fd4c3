//! Draws the pictures of the documentation again, and writes them or compares them with the existing ones.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// A picture that is not the film strip of a scene.
struct Made {
    /// The file in `docs/pictures`.
    file: &'static str,
    /// The arguments of the program.
    call: &'static [&'static str],
    /// The output file of the program that becomes the picture.
    from: &'static str,
}

/// Pictures that are not the film strip of the scene with the same name.
const OTHERS: [Made; 5] = [
    Made { file: "side-by-side.gif", call: &["run", "docs/scenes/side-by-side.toml", "--gif"], from: "video.gif" },
    Made {
        file: "pressures-arrows.png",
        call: &["run", "pressures", "--arrows", "--seconds", "1.5"],
        from: "strip.png",
    },
    Made { file: "balloons-plots.svg", call: &["run", "balloons"], from: "plots.svg" },
    Made {
        file: "sweep-map.svg",
        call: &[
            "sweep",
            "ball",
            "--set",
            "body.ball.models.pressure.nRT=20..200:5",
            "--set",
            "collider.0.restitution=0..0.8:5",
            "--metric",
            "bounce_height",
            "--metric",
            "equilibrium_radius",
            "--seconds",
            "3",
        ],
        from: "plots.svg",
    },
    // This is the sweep in the first lines of the scene, but only over the number of vertices and without speeds, which depend on the machine.
    Made {
        file: "sweep-vertices.svg",
        call: &[
            "sweep",
            "scenes/sweeps/thesis-4-3.toml",
            "--set",
            "body.ball.shape.vertices=8..512:log:7",
            "--metric",
            "bounce_height",
            "--metric",
            "settling_time",
            "--metric",
            "equilibrium_radius",
            "--metric",
            "energy_drift",
        ],
        from: "plots.svg",
    },
];

/// Pictures that are not drawn here, and how they are made. They show windows on a screen, speeds of a machine, or a report that takes minutes.
const ELSEWHERE: [(&str, &str); 3] = [
    ("studio", ".ci/studio and cargo xtask web-trial"),
    ("speed.svg", "opruga bench vertices --plot"),
    ("verification.svg", "opruga verify --report"),
];

/// One picture to be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Task {
    file: String,
    call: Vec<String>,
    from: &'static str,
}

/// `cargo xtask gallery [--check] [PICTURE …]`.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    let check = arguments.iter().any(|argument| argument == "--check");
    let wanted: Vec<&String> = arguments.iter().filter(|argument| *argument != "--check").collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the workspace has no folder")?;
    let pictures = root.join("docs/pictures");
    let known = tasks(&names(&pictures)?, &scenes(root)?)?;
    if let Some(unknown) = wanted.iter().find(|name| !known.iter().any(|task| is_called(task, name))) {
        let allowed: Vec<&str> = known.iter().map(|task| task.file.as_str()).collect();
        return Err(format!("there is no picture `{unknown}`; allowed: --check, {}", allowed.join(", ")));
    }
    let chosen: Vec<&Task> =
        known.iter().filter(|task| wanted.is_empty() || wanted.iter().any(|name| is_called(task, name))).collect();
    let opruga = program(root)?;
    let drawn = opruga.parent().and_then(Path::parent).ok_or("the program lies in no folder")?.join("gallery");
    std::fs::create_dir_all(&drawn).map_err(|e| format!("{}: {e}", drawn.display()))?;
    let (queue, differing, failed) = (Mutex::new(chosen.iter()), Mutex::new(Vec::new()), Mutex::new(Vec::new()));
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let Some(task) = queue.lock().ok().and_then(|mut queue| queue.next()) else { return };
                    let outcome = draw(root, &opruga, task, &drawn)
                        .and_then(|new| compare(&pictures.join(&task.file), new, check));
                    match outcome {
                        Ok(None) => println!("{:<32} as it was", task.file),
                        Ok(Some(how)) => {
                            println!("{:<32} {how}", task.file);
                            differing.lock().map(|mut list| list.push(task.file.clone())).unwrap_or_default();
                        }
                        Err(message) => failed.lock().map(|mut list| list.push(message)).unwrap_or_default(),
                    }
                }
            });
        }
    });
    let failed = failed.into_inner().unwrap_or_default();
    if !failed.is_empty() {
        return Err(failed.join("\n"));
    }
    let mut differing = differing.into_inner().unwrap_or_default();
    differing.sort();
    if check && !differing.is_empty() {
        return Err(format!(
            "{} of {} pictures are not what the program draws: {}; the new ones lie in {}, `cargo xtask gallery` writes them",
            differing.len(),
            chosen.len(),
            differing.join(", "),
            drawn.display()
        ));
    }
    println!("{} pictures, {} of them new", chosen.len(), if check { 0 } else { differing.len() });
    Ok(())
}

/// Whether a name, with or without ending, means a picture.
fn is_called(task: &Task, name: &str) -> bool {
    task.file == name || task.file.rsplit_once('.').is_some_and(|(stem, _)| stem == name)
}

/// The files in a folder.
fn names(folder: &Path) -> Result<BTreeSet<String>, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    entries.map(|entry| entry.map(|e| e.file_name().to_string_lossy().into_owned()).map_err(failed)).collect()
}

/// The scenes that come with the program.
fn scenes(root: &Path) -> Result<BTreeSet<String>, String> {
    let files = names(&root.join("scenes"))?;
    Ok(files.iter().filter_map(|file| file.strip_suffix(".toml")).map(String::from).collect())
}

/// The task for every picture; a picture of unknown origin is an error.
fn tasks(pictures: &BTreeSet<String>, scenes: &BTreeSet<String>) -> Result<Vec<Task>, String> {
    let mut tasks = Vec::new();
    for file in pictures {
        if let Some(made) = OTHERS.iter().find(|made| made.file == file) {
            let call = made.call.iter().map(|word| (*word).into()).collect();
            tasks.push(Task { file: file.clone(), call, from: made.from });
        } else if let Some(scene) = file.strip_suffix(".png").filter(|name| scenes.contains(*name)) {
            tasks.push(Task { file: file.clone(), call: vec!["run".into(), scene.into()], from: "strip.png" });
        } else if !ELSEWHERE.iter().any(|(name, _)| file.starts_with(name)) {
            return Err(format!(
                "docs/pictures/{file}: nobody knows how it is drawn; xtask/src/gallery.rs says it of others"
            ));
        }
    }
    Ok(tasks)
}

/// Builds the program, and returns its path.
fn program(root: &Path) -> Result<PathBuf, String> {
    let built =
        Command::new(env!("CARGO")).args(["build", "--workspace", "--bin", "opruga"]).current_dir(root).status();
    if !built.is_ok_and(|status| status.success()) {
        return Err("opruga does not build".into());
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    Ok(target.join("debug/opruga"))
}

/// Draws a picture, with paths relative to the root. Returns the path of the picture.
fn draw(root: &Path, opruga: &Path, task: &Task, folder: &Path) -> Result<PathBuf, String> {
    let out = folder.join(&task.file);
    let mut call = Command::new(opruga);
    call.current_dir(root).args(&task.call).args(["--threads", "1", "--force", "--out"]).arg(&out);
    let output = call.output().map_err(|e| format!("{}: {e}", opruga.display()))?;
    if !output.status.success() {
        return Err(format!("{}: {}", task.file, String::from_utf8_lossy(&output.stderr)));
    }
    Ok(out.join(task.from))
}

/// Reports how a picture differs from the new one and, unless it is only checked, replaces it.
fn compare(old: &Path, new: PathBuf, check: bool) -> Result<Option<String>, String> {
    let read = |path: &Path| std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()));
    let (before, after) = (read(old)?, read(&new)?);
    let how = if old.extension().is_some_and(|ending| ending == "png") {
        difference(&pixels(&before, old)?, &pixels(&after, &new)?)
    } else {
        (before != after).then(|| "another text".into())
    };
    if how.is_some() && !check {
        std::fs::write(old, after).map_err(|e| format!("{}: {e}", old.display()))?;
    }
    Ok(how)
}

/// The width and the pixels of a picture.
type Pixels = ([u32; 2], Vec<u8>);

fn pixels(bytes: &[u8], path: &Path) -> Result<Pixels, String> {
    let failed = |e: png::DecodingError| format!("{}: {e}", path.display());
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(failed)?;
    let mut found = vec![0; reader.output_buffer_size().ok_or_else(|| format!("{}: too large", path.display()))?];
    let info = reader.next_frame(&mut found).map_err(failed)?;
    found.truncate(info.buffer_size());
    Ok(([info.width, info.height], found))
}

/// Describes the difference of two pictures; none if they are equal.
fn difference((size, before): &Pixels, (other, after): &Pixels) -> Option<String> {
    if size != other {
        return Some(format!("{} x {} pixels instead of {} x {}", other[0], other[1], size[0], size[1]));
    }
    let differing = before.iter().zip(after).filter(|(a, b)| a != b).count();
    let share = 100.0 * differing as f64 / before.len().max(1) as f64;
    (differing > 0 || before.len() != after.len()).then(|| format!("{share:.3} % of its values differ"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_every_picture_in_the_documentation_somebody_knows_how_it_is_drawn() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let pictures = names(&root.join("docs/pictures")).expect("the pictures");
        let found = tasks(&pictures, &scenes(root).expect("the scenes")).expect("all are known");
        assert!(OTHERS.iter().all(|made| found.iter().any(|task| task.file == made.file)), "{found:?}");
        assert!(found.len() > 20);
        let stranger = BTreeSet::from(["stranger.png".to_string()]);
        assert!(tasks(&stranger, &BTreeSet::new()).is_err());
    }

    #[test]
    fn a_picture_that_nobody_shows_is_not_kept() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let mut texts = std::fs::read_to_string(root.join("README.md")).expect("the README");
        for name in names(&root.join("docs")).expect("the documentation").iter().filter(|name| name.ends_with(".md")) {
            texts += &std::fs::read_to_string(root.join("docs").join(name)).expect("a page");
        }
        for picture in names(&root.join("docs/pictures")).expect("the pictures") {
            assert!(texts.contains(&format!("pictures/{picture})")), "{picture} is on no page");
        }
    }

    #[test]
    fn one_value_that_differs_is_a_difference() {
        let old = ([2, 1], vec![1, 2, 3, 4, 5, 6]);
        let mut new = old.clone();
        assert_eq!(difference(&old, &new), None);
        new.1[5] += 1;
        assert!(difference(&old, &new).is_some());
        assert_eq!(difference(&old, &([1, 2], old.1.clone())), Some("1 x 2 pixels instead of 2 x 1".into()));
    }
}
