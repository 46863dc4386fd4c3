//! The argument of the program: a scene file, a scene that comes with the program, a recorded run, or the file of a shape.

use crate::dropping;
use crate::report::Report;
use crate::session::{Request, Session};
use crate::setting::Setting;
use opruga::io::recording::{MAGIC, Recording, RecordingError};
use opruga::io::{Files, SceneError, scene, shapes};
use std::path::Path;

/// Opens what the argument names.
///
/// # Errors
/// All errors in the file; if there is nothing with this name, an error with the names that may have been meant.
pub fn open(wanted: &str, setting: impl Into<Setting>) -> Result<Session, Report> {
    let (path, setting) = (Path::new(wanted), setting.into());
    if let Some(text) = opruga::scenes::find(wanted).filter(|_| !path.is_file()) {
        return Session::open(wanted, text, opruga::scenes::files(), setting);
    }
    let refused = |error: SceneError| Report::Scene(vec![SceneError { file: wanted.into(), ..error }]);
    if !path.exists() {
        return Err(refused(opruga::scenes::missing(wanted)));
    }
    if is_recording(path) {
        let damaged = |error: RecordingError| refused(SceneError::from(&error));
        let file = std::fs::File::open(path).map_err(|error| damaged(error.into()))?;
        let recording = Recording::open(std::io::BufReader::new(file)).map_err(damaged)?;
        return Session::view(recording, setting).map_err(|report| Report::Inside(wanted.into(), report.into()));
    }
    if path.is_file() && shapes::kind_of_file(wanted).is_some() {
        let taken = dropping::take(path)?;
        if let Request::Take(shape, ..) = taken {
            return Session::around(&shape, &setting);
        }
    }
    let bytes = scene::bytes_of(path, &scene::Limits::default()).map_err(refused)?;
    let text = String::from_utf8(bytes).map_err(|_| Report::NoText(wanted.into()))?;
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned());
    Session::open(&name, &text, Files::beside(path), setting)
}

/// Whether a file begins like a recording.
fn is_recording(path: &Path) -> bool {
    use std::io::Read as _;
    let mut head = [0; MAGIC.len()];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *MAGIC
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
        let report = open(&put("star.svg", b"<svg"), Setting::default()).expect_err("it is cut off").to_string();
        assert!(report.starts_with("star.svg:1:1: error[svg.syntax]") && !report.contains("star.toml"), "{report}");
        std::fs::remove_dir_all(&folder).expect("the folder goes");
    }
}
