//! The shape of a body: its file, if it has one, and its mesh.

use super::errors::{BodyError, Part, SceneAllowed, SceneHint};
use super::reader::{Reader, join};
use super::{Options, location_of};
use crate::catalogue::Catalogue;
use crate::document::{Data, Entry, Location, Node};
use crate::overrides;
use crate::problem::{Notice, SceneError, visible};
use crate::shapes::{Loaded, loss_notices};
use crate::source::Source;
use opruga_core::spec::Values;
use opruga_mesh::outline::OutlineError;
use opruga_mesh::{Mesh, MeshError};
use opruga_world::shapes;

/// The location of a shape in the scene.
pub(super) struct ShapeLocation<'a> {
    /// The name of the body with this shape.
    pub(super) name: &'a str,
    pub(super) location: Location,
    pub(super) path: String,
}

/// Reads the file of a shape, if the shape has one. The file is read only if the shape's own fields have no errors.
pub(super) fn loaded<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    shape: &Values,
    sound: bool,
) -> Option<Loaded> {
    if !shapes::is_from_file(shape.kind()) || !sound {
        return None;
    }
    let (at, here) = (node.get("shape")?, join(path, "shape"));
    match crate::shapes::load(shape, D, &mut |name| reader.file(name)) {
        Ok(loaded) => {
            for notice in &loaded.notices {
                reader.notice(at.location, notice.clone().path(&here));
            }
            Some(loaded)
        }
        Err(problem) => {
            let field = join(&here, problem.field);
            reader.report(location_of(at, problem.field), problem.about.path(field));
            None
        }
    }
}

/// Makes the mesh of a shape.
pub(super) fn mesh<const D: usize>(
    reader: &mut Reader<'_>,
    shape: &Values,
    loaded: Option<&Loaded>,
    transform: &shapes::Transform<'_>,
    at: &ShapeLocation<'_>,
) -> Option<Mesh<D>> {
    let made = match loaded {
        Some(loaded) => loaded.mesh::<D>(transform),
        // The reason why the file is missing has already been reported.
        None if shapes::is_from_file(shape.kind()) => return None,
        None => generated::<D>(shape, transform, at.name),
    };
    let (mesh, notices) = match made {
        Ok(made) => made,
        Err(error) => {
            reader.report(at.location, error.path(&at.path));
            return None;
        }
    };
    for notice in notices {
        reader.notice(at.location, notice.path(&at.path));
    }
    // Large factors may cause an overflow.
    if let Some(x) = mesh.positions.iter().flatten().find(|x| !x.is_finite()) {
        reader.report(at.location, SceneError::of(BodyError::NotFiniteShape { value: *x }).path(&at.path));
        return None;
    }
    Some(mesh)
}

/// Makes a shape without a file, with its notices.
fn generated<const D: usize>(
    shape: &Values,
    transform: &shapes::Transform<'_>,
    name: &str,
) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
    let made = shapes::mesh::<D>(shape, transform);
    let made = made.map_err(|refusal| {
        let error = SceneError::of(OutlineError::Mesh { error: refusal.clone() });
        match refusal {
            MeshError::RingsMeet { .. } => error.allows(SceneAllowed::RingsApart {}).advice(SceneHint::Centers {}),
            MeshError::RingsAlike { .. } => {
                error.allows(SceneAllowed::HolesInRings {}).advice(SceneHint::TwoChambers {})
            }
            MeshError::HoleInNothing { .. } => error.allows(SceneAllowed::HolesInside {}).advice(SceneHint::Centers {}),
            _ => error,
        }
    })?;
    let mut notices = Vec::new();
    if made.flipped {
        notices.push(SceneError::of(BodyError::Clockwise { body: visible(name) }));
    }
    notices.extend(made.loss.map(|loss| loss_notices::lost_volume(&made.mesh, loss, 1.0)));
    Ok((made.mesh, notices))
}

/// Makes a shape from its fields alone. Each field is given as a name and a value, as in `--set NAME=VALUE`; later ones replace earlier ones.
///
/// # Errors
/// All errors that scenes can have, each with the field that it is about.
pub fn of_fields(
    kind: &str,
    dimension: usize,
    fields: &[(String, String)],
) -> Result<(Values, Vec<Notice>), Vec<SceneError>> {
    let (source, options) = (Source { file: kind, text: "" }, Options::default());
    let catalogue = Catalogue { models: Vec::new(), integrators: Vec::new(), colliders: Vec::new() };
    let options = Options { overrides: fields.to_vec(), ..options };
    let mut table = Node { location: Location::Bytes(0, 0), data: Data::Table(Vec::new()) };
    overrides::apply_all(&mut table, &options.overrides)?;
    let word = Node { location: Location::Bytes(0, 0), data: Data::Text(kind.to_string()) };
    if let Data::Table(entries) = &mut table.data {
        entries.retain(|entry| entry.key != "kind");
        entries.push(Entry { key: "kind".into(), location: word.location, value: word });
    }
    let mut reader = Reader::new(&source, &catalogue, &options, Vec::new());
    reader.dimension = dimension;
    let values = reader.kind_table(&table, "", Part::Shape, &shapes::all());
    match (values, reader.finish()) {
        (Some(values), (errors, notices)) if errors.is_empty() => Ok((values, notices)),
        (_, (errors, _)) => Err(errors),
    }
}
