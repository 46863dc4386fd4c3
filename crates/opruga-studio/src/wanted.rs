//! What a call of the program names: a scene file, a scene that comes with the program, a recorded run, or the file of a shape.

use crate::dropping;
use crate::session::{Request, Session};
use crate::setting::Setting;
use opruga::core::spec::all_near;
use opruga::io::problem::visible;
use opruga::io::recording::{MAGIC, Recording};
use opruga::io::{Files, scene, shapes};
use std::path::Path;

/// Opens what a call names.
///
/// # Errors
/// Everything that is wrong with it, as one text; where there is nothing of this name, what else could be meant.
pub fn open(wanted: &str, setting: impl Into<Setting>) -> Result<Session, String> {
    let (path, setting) = (Path::new(wanted), setting.into());
    if let Some(text) = opruga::scenes::find(wanted).filter(|_| !path.is_file()) {
        return Session::open(wanted, text, opruga::scenes::files(), setting).map_err(|said| said.to_string());
    }
    if !path.exists() {
        return Err(missing(wanted));
    }
    if is_recording(path) {
        let refused = |error: String| format!("{wanted}: {error}");
        let file = std::fs::File::open(path).map_err(|error| refused(error.to_string()))?;
        let recording = Recording::open(std::io::BufReader::new(file)).map_err(|error| refused(error.to_string()))?;
        return Session::view(recording, setting).map_err(|said| refused(said.to_string()));
    }
    if path.is_file() && shapes::kind_of_file(wanted).is_some() {
        let taken = dropping::take(path).map_err(|said| said.to_string())?;
        if let Request::Take(shape, ..) = taken {
            return Session::around(&shape, &setting).map_err(|said| said.to_string());
        }
    }
    let bytes = scene::bytes_of(path, &scene::Limits::default()).map_err(|error| format!("{wanted}: {error}"))?;
    let text = String::from_utf8(bytes).map_err(|_| format!("{wanted} is no text in UTF-8"))?;
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    Session::open(&name, &text, Files::beside(path), setting).map_err(|said| said.to_string())
}

/// Whether a file begins as recordings do.
fn is_recording(path: &Path) -> bool {
    use std::io::Read as _;
    let mut head = [0; MAGIC.len()];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *MAGIC
}

/// Neither a file nor a scene of the program: what else could be meant.
fn missing(wanted: &str) -> String {
    let folder = Path::new(wanted).parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten();
    let files = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let files = files.filter(|file| file.ends_with(".toml"));
    let files = files.map(|file| folder.map_or(file.clone(), |folder| folder.join(&file).display().to_string()));
    let known: Vec<String> = opruga::scenes::names().map(String::from).chain(files).collect();
    let with_ending = format!("{wanted}.toml");
    let near: Vec<String> = match known.contains(&with_ending) {
        true => vec![with_ending],
        false => all_near(wanted, known.iter().map(String::as_str)),
    };
    let near: Vec<String> = near.iter().map(|name| format!("`{}`", visible(name))).collect();
    let hint = match near.split_last() {
        Some((last, [])) => format!("did you mean {last}?"),
        Some((last, others)) => format!("did you mean {} or {last}?", others.join(", ")),
        None => {
            format!("scenes that come with the program: {}", opruga::scenes::names().collect::<Vec<_>>().join(", "))
        }
    };
    let wanted = visible(wanted);
    format!(
        "{wanted}: error[read.failed]: there is no such file, and no such scene comes with the program\n  = hint: {hint}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_nearly_that_of_a_scene_is_suggested_and_all_of_them_are_named_where_none_is_near() {
        let refused = |wanted: &str| open(wanted, Setting::default()).expect_err("there is none").to_string();
        assert!(refused("presures").ends_with("did you mean `pressures`?"), "{}", refused("presures"));
        assert!(refused("nosuchthingatall").contains("thousand-balls"), "{}", refused("nosuchthingatall"));
    }

    #[test]
    fn the_file_of_a_shape_is_opened_as_if_it_were_dropped_and_what_is_wrong_with_it_is_said_of_it() {
        let folder = std::env::temp_dir().join(format!("opruga-wanted-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let put = |name: &str, bytes: &[u8]| {
            let path = folder.join(name);
            std::fs::write(&path, bytes).expect("a file");
            path.display().to_string()
        };
        let svg =
            b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/></svg>";
        let mut session = open(&put("square.svg", svg), Setting::default()).expect("it opens");
        assert_eq!(session.shown().bodies.len(), 1);
        assert_eq!(session.name(), "square");
        let said = open(&put("star.svg", b"<svg"), Setting::default()).expect_err("it is cut off");
        assert!(said.starts_with("star.svg:1:1: error[svg.syntax]") && !said.contains("star.toml"), "{said}");
        std::fs::remove_dir_all(&folder).expect("the folder goes");
    }
}
