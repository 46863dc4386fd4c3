//! A shape from a file, with a scene around it.

use opruga::io::Files;
use toml_edit::{DocumentMut, InlineTable};

/// A shape from a file.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The name of the shape.
    pub name: String,
    /// The file of the shape.
    pub file: String,
    /// The text of a scene around the shape.
    pub text: String,
    /// Whether the scene is in space.
    pub space: bool,
    /// The location of the shape's file.
    pub files: Files,
}

impl Shape {
    /// Makes the table of the body, with this size [m], for a scene with other bodies. In that scene, the file has the name `file`.
    pub fn body(&self, file: &str, size: f64) -> Option<InlineTable> {
        let document: DocumentMut = self.text.parse().ok()?;
        let mut body = document.get("body")?.as_array_of_tables()?.get(0)?.clone().into_inline_table();
        body.insert("name", self.name.as_str().into());
        // The session later places the body where there is space.
        body.remove("position");
        let shape = body.get_mut("shape")?.as_inline_table_mut()?;
        shape.insert("file", file.into());
        shape.insert("size", size.into());
        if shape.contains_key("spacing") {
            shape.insert("spacing", (0.05 * size).into());
        }
        Some(body)
    }
}
