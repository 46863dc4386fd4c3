//! The dimension of a scene, and the other errors of a scene that does not give its dimension.

use super::errors::{FieldError, SceneHint};
use super::reader::Reader;
use super::scene;
use crate::document::{Data, Entry, Location, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::nearest;
use opruga_world::blueprint::AnyBlueprint;
use opruga_world::schema;

/// The result of reading `dimension`, after its errors have been reported.
enum Dimension {
    /// 2 or 3.
    Known(usize),
    /// Neither 2 nor 3. The fields are the key that was written instead, which is empty if there is none, and the value that was probably meant.
    Wrong(String, Option<usize>),
}

/// Reads everything below the format of a scene. If the dimension is not known, reports the errors that the rest of the scene has in both dimensions.
pub(super) fn read(reader: &mut Reader<'_>, root: &Node) -> Option<AnyBlueprint> {
    match dimension_of(reader, root) {
        Dimension::Known(dimension) => within(reader, root, dimension),
        Dimension::Wrong(key, Some(likely)) => within(reader, &as_if(root, &key, likely), likely),
        Dimension::Wrong(key, None) => {
            wrong_in_both(reader, root, &key);
            None
        }
    }
}

fn within(reader: &mut Reader<'_>, root: &Node, dimension: usize) -> Option<AnyBlueprint> {
    reader.dimension = dimension;
    match dimension {
        2 => scene::<2>(reader, root).map(AnyBlueprint::Plane),
        _ => scene::<3>(reader, root).map(AnyBlueprint::Space),
    }
}

fn dimension_of(reader: &mut Reader<'_>, root: &Node) -> Dimension {
    match root.get("dimension").map(|node| (&node.data, node)) {
        Some((Data::Integer(Some(d @ (2 | 3)), _), _)) => Dimension::Known(*d as usize),
        Some((_, node)) => {
            let error = SceneError::of(FieldError::WrongDimension { value: node.shown() }).path("dimension");
            reader.report(node.location, error);
            Dimension::Wrong("dimension".into(), likely(node))
        }
        None => {
            let error = SceneError::of(FieldError::NoDimension {}).path("dimension");
            let known = |key: &str| {
                let fields = schema::SCENE.spec.fields.iter().map(|field| field.name);
                fields.chain(schema::SCENE.children.iter().map(|child| child.name)).any(|name| name == key)
            };
            let keys = root.entries().iter().map(|entry| entry.key.as_str()).filter(|key| !known(key));
            let Some(entry) = nearest("dimension", keys).and_then(|key| root.entry(&key)) else {
                reader.report(Location::Bytes(0, 0), error);
                return Dimension::Wrong(String::new(), None);
            };
            let key = visible(&entry.key);
            reader.report(entry.location, error.value(key.clone()).advice(SceneHint::Misspelt { word: key }));
            Dimension::Wrong(entry.key.clone(), likely(&entry.value))
        }
    }
}

/// The dimension that a value probably means.
fn likely(node: &Node) -> Option<usize> {
    let number = match &node.data {
        Data::Integer(Some(x), _) => *x as f64,
        Data::Number(x, _) => *x,
        Data::Text(text) => text.trim().parse().ok()?,
        _ => return None,
    };
    [2, 3].into_iter().find(|dimension| *dimension as f64 == number)
}

/// The same scene with a key replaced by a dimension.
fn as_if(root: &Node, key: &str, dimension: usize) -> Node {
    let mut root = root.clone();
    let value = Node { location: root.location, data: Data::Integer(Some(dimension as i64), dimension.to_string()) };
    if let Data::Table(entries) = &mut root.data {
        entries.retain(|entry| entry.key != key);
        entries.push(Entry { key: "dimension".into(), location: root.location, value });
    }
    root
}

/// Reports the errors that a scene has both in the plane and in space. An error that occurs in only one dimension may not be an error of this scene.
fn wrong_in_both(reader: &mut Reader<'_>, root: &Node, key: &str) {
    let [plane, space] = [2, 3].map(|dimension| {
        let mut trial = Reader::new(reader.source, reader.catalogue, reader.options, Vec::new());
        within(&mut trial, &as_if(root, key, dimension), dimension);
        reader.files.append(&mut trial.files);
        for name in trial.unread {
            if !reader.unread.contains(&name) {
                reader.unread.push(name);
            }
        }
        trial.errors
    });
    let about = |error: &SceneError| (error.code, error.line, error.column, error.path.clone(), error.message.clone());
    for error in plane {
        let Some(other) = space.iter().find(|other| about(other) == about(&error)) else { continue };
        // What is allowed may differ between the two dimensions.
        let (allowed, hint) = (error.allowed == other.allowed, error.hint == other.hint);
        let mut error = error;
        error.allowed = error.allowed.filter(|_| allowed);
        error.hint = error.hint.filter(|_| hint);
        // The error already has its location.
        reader.report(Location::Bytes(0, 0), error);
    }
}
