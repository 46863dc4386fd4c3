//! Handles files that are dropped on the window.

use crate::report::Report;
use crate::session::Request;
use crate::shape_file::Shape;
use opruga::io::{Files, SceneError, scene, shapes};
use std::path::Path;

/// The endings of files that become bodies, with the fields of their shapes.
const SHAPES: [(&str, &str, bool); 6] = [
    ("svg", "spacing = 0.05, size = 1.0, filling = \"triangles\"", false),
    ("obj", "size = 1.0", true),
    ("stl", "size = 1.0", true),
    ("ply", "size = 1.0", true),
    ("gltf", "size = 1.0", true),
    ("glb", "size = 1.0", true),
];

/// Returns the request for a dropped file: to open a scene, or to add the shape in the file to the scene. A file that is neither a scene nor a shape,
/// or that is too large, is refused before it is read.
///
/// # Errors
/// The reason why the file is refused.
pub fn take(path: &Path) -> Result<Request, Report> {
    let file = path.file_name().map(|f| f.to_string_lossy().into_owned()).unwrap_or_default();
    let refused = |error| Report::Scene(vec![SceneError { file: file.clone(), ..error }]);
    let bytes = || scene::bytes_of(path, &scene::Limits::default()).map_err(refused);
    request(&file, bytes, || Files::beside(path))
}

/// Returns the request for a file with this name from any source. The bytes of the file are read only if the file is a scene.
pub(crate) fn request(
    file: &str,
    bytes: impl FnOnce() -> Result<Vec<u8>, Report>,
    files: impl FnOnce() -> Files,
) -> Result<Request, Report> {
    let path = Path::new(file);
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let name = path.file_stem().map_or_else(|| "scene".into(), |s| s.to_string_lossy().into_owned());
    if ending == "toml" {
        let text = String::from_utf8(bytes()?).map_err(|_| Report::NoText(file.into()))?;
        return Ok(Request::Open { name, text, files: files() });
    }
    let Some((_, fields, space)) = SHAPES.iter().find(|(known, ..)| *known == ending) else {
        let known: Vec<&str> = SHAPES.iter().map(|(known, ..)| *known).collect();
        return Err(Report::NoShapeFile(file.into(), format!(".toml, .{}", known.join(", ."))));
    };
    if file.contains(['"', '\\']) {
        return Err(Report::NameOfFile(file.into()));
    }
    let (text, space) = (around(file, fields, *space), *space);
    Ok(Request::Take(Shape { name, file: file.into(), text, space, files: files() }, [0.0; 3], 1.0))
}

/// The text of a scene with one shape over a floor.
fn around(file: &str, fields: &str, space: bool) -> String {
    let (dimension, gravity, up, normal) = if space {
        (3, "[0.0, -9.81, 0.0]", "[0.0, 1.2, 0.0]", "[0.0, 1.0, 0.0]")
    } else {
        (2, "[0.0, -9.81]", "[0.0, 1.2]", "[0.0, 1.0]")
    };
    let kind = shapes::kind_of_file(file).unwrap_or_default();
    let models = if space {
        "{ kind = \"mass_spring\", modulus = 300.0, damping = 0.02 }, { kind = \"pressure\", nRT = 20.0, ambient = 40.0 }"
    } else {
        "{ kind = \"mass_spring\", stiffness = 1500.0, damping = 0.6 }"
    };
    let floor = if space { "[0.0, 0.0, 0.0]" } else { "[0.0, 0.0]" };
    format!(
        "# A shape from a file, dropped on the studio.\nformat = \"opruga-1\"\ntitle = \"{title}\"\ndimension = {dimension}\n\n\
         [time]\nseconds = 6.0\nframe = 0.016666666666666666\nsubsteps = 96\n\n[world]\ngravity = {gravity}\n\n\
         [integrator]\nkind = \"symplectic_euler\"\n\n[contact]\nfriction = 0.3\n\n[[body]]\nname = \"shape\"\n\
         shape = {{ kind = \"{kind}\", file = \"{file}\", {fields} }}\nposition = {up}\nmass = 1.0\nmodels = [{models}]\n\n\
         [[collider]]\nkind = \"half_space\"\npoint = {floor}\nnormal = {normal}\nrestitution = 0.2\nfriction = 0.5\n",
        title = file.chars().filter(|c| c.is_alphanumeric() || " ._-".contains(*c)).take(60).collect::<String>(),
    )
}
