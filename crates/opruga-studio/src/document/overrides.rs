//! Writes the overrides of a call (`--set PATH=VALUE`) into the text, so that the visible scene is the one that was run.

use super::Document;
use crate::view_errors::ViewError;
use toml_edit::{Item, Table, TableLike, Value as Toml};

impl Document {
    /// Writes the value of an override at its path, interpreting both as the scene reader does.
    ///
    /// # Errors
    /// The path names nothing, or the value is invalid.
    pub fn take_override(&mut self, path: &str, value: &str) -> Result<(), ViewError> {
        let parts: Vec<&str> = path.split('.').collect();
        let word = || value.starts_with(char::is_alphabetic).then(|| Toml::from(value));
        let number = value
            .parse::<Toml>()
            .ok()
            .or_else(word)
            .ok_or_else(|| ViewError::NoValue { path: path.into(), value: value.into() })?;
        let lost = || ViewError::NoPath { path: path.into() };
        put(self.text.as_table_mut(), &parts, number).ok_or_else(lost)
    }
}

/// Walks through tables; missing ones are created.
fn put(table: &mut dyn TableLike, parts: &[&str], value: Toml) -> Option<()> {
    let (head, rest) = parts.split_first()?;
    if rest.is_empty() {
        table.insert(head, Item::Value(value));
        return Some(());
    }
    let item = table.entry(head).or_insert_with(|| Item::Table(Table::new()));
    // A single word is short for a table with this kind.
    if let Some(kind) = item.as_str().map(String::from) {
        let mut long = toml_edit::InlineTable::new();
        long.insert("kind", kind.into());
        *item = Item::Value(Toml::InlineTable(long));
    }
    match item {
        Item::ArrayOfTables(tables) => {
            let index = index_of(rest.first()?, tables.iter().map(|table| table as &dyn TableLike))?;
            put(tables.get_mut(index)?, &rest[1..], value)
        }
        Item::Value(Toml::Array(array)) => put_in(array, rest, value),
        other => put(other.as_table_like_mut()?, rest, value),
    }
}

/// Writes the value of an override within a list of tables or of numbers.
fn put_in(array: &mut toml_edit::Array, parts: &[&str], value: Toml) -> Option<()> {
    let (head, rest) = parts.split_first()?;
    if rest.is_empty() {
        array.replace(head.parse::<usize>().ok().filter(|index| *index < array.len())?, value);
        return Some(());
    }
    if array.iter().all(|entry| entry.is_inline_table()) {
        let tables = array.iter().filter_map(Toml::as_inline_table).map(|table| table as &dyn TableLike);
        let index = index_of(head, tables)?;
        return put(array.get_mut(index)?.as_inline_table_mut()?, rest, value);
    }
    put_in(array.get_mut(head.parse().ok()?)?.as_array_mut()?, rest, value)
}

/// The index of the list entry with this number, or whose field `name`, `kind` or `do` has this value.
fn index_of<'t>(name: &str, tables: impl Iterator<Item = &'t dyn TableLike>) -> Option<usize> {
    let label = |table: &dyn TableLike| {
        ["name", "kind", "do"].into_iter().find_map(|key| table.get(key)?.as_str().map(String::from))
    };
    let labels: Vec<Option<String>> = tables.map(label).collect();
    let number = name.parse::<usize>().ok().filter(|index| *index < labels.len());
    number.or_else(|| labels.iter().position(|label| label.as_deref() == Some(name)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::io::scene;

    /// For every path, reading the text that contains the value gives the same scene as reading the original text with the override.
    #[test]
    fn a_text_with_its_overrides_is_the_scene_that_was_run() {
        let ball = opruga::scenes::find("ball").expect("it comes with the program");
        let chambers = opruga::scenes::find("integrators").expect("it comes with the program");
        let cases = [
            (ball, "time.seconds", "3"),
            (ball, "world.drag", "0.5"),
            (ball, "integrator", "runge_kutta"),
            (ball, "integrator.kind", "heun"),
            (ball, "body.ball.mass", "2.5"),
            (ball, "body.0.shape.vertices", "48"),
            (ball, "body.ball.models.pressure.nRT", "40"),
            (ball, "body.ball.models.0.stiffness", "1e3"),
            (ball, "collider.half_space.friction", "0.1"),
            (ball, "command.drag.path", "[[3.5, 0.4, 1.0], [5.5, 0.9, 1.6]]"),
            (ball, "world.gravity", "[0.0, -3.7]"),
            (ball, "title", "\"another\""),
            (chambers, "body.0.integrator", "verlet"),
        ];
        for (text, path, value) in cases {
            let read = |text: &str, overrides| {
                let options = scene::Options { overrides, ..scene::Options::default() };
                scene::read(text.as_bytes(), "scene.toml", &opruga::catalogue(), &options)
                    .map(|(blueprint, _)| format!("{blueprint:?}"))
            };
            let mut document = Document::new("scene", text).expect("a scene");
            document.take_override(path, value).expect(path);
            let expected = read(text, vec![(path.into(), value.into())]).expect(path);
            assert_eq!(read(&document.text(), Vec::new()).expect(path), expected, "{path}");
            assert_ne!(read(text, Vec::new()).expect("a scene"), expected, "{path} changes something");
        }
        let mut document = Document::new("scene", ball).expect("a scene");
        assert!(document.take_override("body.bull.mass", "1").is_err());
        assert!(document.take_override("body.7.mass", "1").is_err());
        assert!(document.take_override("world.gravity.5", "1").is_err());
        assert_eq!(document.text(), ball, "what is refused changes nothing");
    }
}
