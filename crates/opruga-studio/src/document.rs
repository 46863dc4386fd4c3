//! The text of the scene. The actions of the user are written into this text, so saving only writes the text to a file, and the command line can
//! repeat what was done.

mod overrides;
mod taken_over;

use crate::report::Report;
use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Value, Values};
pub use opruga::io::scene::written::{add_table, command_table, kind_table, numbers, toml};
use opruga::io::{Files, Notice, SceneError, scene};
use opruga::{Registries, Warning, catalogue_of};
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value as Toml};

/// The text of a scene with its comments, and the name of the scene.
#[derive(Clone, Debug)]
pub struct Document {
    /// The name of the scene: that of its file, without the ending.
    pub name: String,
    text: DocumentMut,
}

/// Reads the text of a document, which may name the models and integrators of these registries. Also returns the notices about the text and its files
/// as warnings, except those about what the scene itself requests.
///
/// # Errors
/// All errors in the text.
pub fn read(
    document: &Document,
    files: &Files,
    registries: &Registries,
) -> Result<(AnyBlueprint, Vec<Warning>), Vec<SceneError>> {
    let reading = scene::Options { files: files.clone(), ..scene::Options::default() };
    let file = format!("{}.toml", document.name);
    let read = scene::read(document.text().as_bytes(), &file, &catalogue_of(registries), &reading);
    // The user's actions have changed the text, so its lines would mean nothing to the user.
    let (blueprint, notices) = read.map_err(|errors| without_lines(errors, &document.name, ""))?;
    // In the studio, time continues after the end that the scene gives for a run. Commands that begin later are therefore executed.
    let is_reported = |code: &str| !Notice::is_asked_for(code) && code != "command.never";
    let warnings = notices.into_iter().filter(|notice| is_reported(notice.about.code));
    Ok((blueprint, warnings.map(Warning::from).collect()))
}

/// The end time that is written for a command without an end [s].
pub const FOR_EVER: f64 = 1e9;

impl Document {
    /// Makes a document from a text that the scene reader has accepted.
    ///
    /// # Errors
    /// [`Report::Scene`] if the text is not TOML.
    pub fn new(name: impl Into<String>, text: &str) -> Result<Document, Report> {
        let name = name.into();
        let text = text.parse::<DocumentMut>().map_err(|error| {
            let bytes = error.span().unwrap_or_default();
            Report::Scene(vec![scene::not_toml(text, &format!("{name}.toml"), error.message(), bytes)])
        })?;
        Ok(Document { name, text })
    }

    /// Makes a document from a text that has not been read yet. The text is either that of a file, so that errors name its lines, or a text that the
    /// program made around the file of this name. In the second case errors name no lines, because the user does not know them.
    ///
    /// # Errors
    /// All errors in the text.
    pub fn unread(
        name: &str,
        text: &str,
        files: &Files,
        registries: &Registries,
        around: Option<&str>,
    ) -> Result<Document, Report> {
        // The scene reader detects more errors than the parser of documents.
        let reading = scene::Options { files: files.clone(), ..scene::Options::default() };
        let read = scene::read(text.as_bytes(), &format!("{name}.toml"), &catalogue_of(registries), &reading);
        read.map_err(|errors| match around {
            Some(file) => without_lines(errors, name, file),
            None => errors,
        })?;
        Document::new(name, text)
    }

    /// The text as a scene file for `opruga run`.
    pub fn text(&self) -> String {
        self.text.to_string()
    }

    /// The number of commands.
    pub fn commands(&self) -> usize {
        let Some(item) = self.text.get("command") else { return 0 };
        item.as_array_of_tables().map(ArrayOfTables::len).or(item.as_array().map(Array::len)).unwrap_or(0)
    }

    /// Adds a command at the end. Returns the number of the command, which [`Document::end_command`] needs.
    pub fn push_command(&mut self, table: Table) -> usize {
        let item = self.text.entry("command").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
        match tables(item) {
            Some(tables) => {
                tables.push(table);
                tables.len() - 1
            }
            None => 0,
        }
    }

    /// Removes the last command.
    pub fn pop_command(&mut self) {
        if let Some(tables) = self.text.get_mut("command").and_then(Item::as_array_of_tables_mut)
            && !tables.is_empty()
        {
            tables.remove(tables.len() - 1);
        }
    }

    /// Returns the last command if it sets this parameter at this time. A slider changes this command, so that only its final value is written and no
    /// intermediate one.
    pub fn last_set(&mut self, at: f64, path: &str) -> Option<&mut Table> {
        let tables = self.text.get_mut("command")?.as_array_of_tables_mut()?;
        let last = tables.len().checked_sub(1)?;
        let table = tables.get_mut(last)?;
        let entry = |key: &str| table.get(key).and_then(Item::as_str);
        let same = entry("do") == Some("set")
            && entry("path") == Some(path)
            && table.get("at").and_then(Item::as_float) == Some(at);
        same.then_some(table)
    }

    /// Adds a row to the path of a drag.
    pub fn lead_command(&mut self, number: usize, row: &[f64]) {
        if let Some(path) = self.command(number).and_then(|table| table.get_mut("path")?.as_array_mut()) {
            path.push(numbers(row));
        }
    }

    /// Writes the end time of a command [s].
    pub fn end_command(&mut self, number: usize, until: f64) {
        if let Some(table) = self.command(number) {
            table["until"] = toml_edit::value(until);
        }
    }

    fn command(&mut self, number: usize) -> Option<&mut Table> {
        self.text.get_mut("command")?.as_array_of_tables_mut()?.get_mut(number)
    }

    /// Removes what was recorded from a time on [s]. Of the commands after the first `kept`, those that begin at that time or later are removed, and
    /// those that are active at that time end then. Points that are pinned at that time stay pinned.
    pub fn cut(&mut self, kept: usize, time: f64) {
        let Some(tables) = self.text.get_mut("command").and_then(Item::as_array_of_tables_mut) else { return };
        for number in (kept..tables.len()).rev() {
            let Some(table) = tables.get_mut(number) else { continue };
            let number_of = |table: &Table, key: &str| {
                table.get(key).and_then(|v| v.as_float().or_else(|| v.as_integer().map(|i| i as f64)))
            };
            if number_of(table, "at").is_some_and(|at| at >= time) {
                tables.remove(number);
            } else if number_of(table, "until").is_some_and(|until| until > time) {
                let pin = table.get("do").and_then(Item::as_str) == Some("pin");
                table["until"] = toml_edit::value(if pin { FOR_EVER } else { time });
            }
        }
    }

    /// Removes the commands after the first `kept`.
    pub fn keep_commands(&mut self, kept: usize) {
        while self.commands() > kept {
            self.pop_command();
        }
    }

    /// Sets the duration of the scene [s].
    pub fn set_seconds(&mut self, seconds: f64) {
        if let Some(time) = self.text.get_mut("time") {
            time["seconds"] = toml_edit::value(seconds);
        }
    }

    /// The names of all bodies, including those that commands add.
    pub fn body_names(&self) -> Vec<String> {
        let name = |item: Option<&Item>| item.and_then(Item::as_str).map(String::from);
        let tables = |key: &str| self.text.get(key).and_then(Item::as_array_of_tables).into_iter().flatten();
        let present = tables("body").filter_map(|table| name(table.get("name")));
        let added = tables("command").filter_map(|table| {
            table.get("body").and_then(Item::as_table_like).and_then(|body| name(body.get("name")))
        });
        present.chain(added).collect()
    }

    /// Returns `like` or a similar name that no body has: `ball`, `ball-2`, `ball-3` …
    pub fn free_name(&self, like: &str) -> String {
        let taken = self.body_names();
        let stem = like.split('[').next().unwrap_or(like);
        let stem = match stem.rsplit_once('-') {
            Some((front, back)) if !front.is_empty() && back.bytes().all(|b| b.is_ascii_digit()) => front,
            _ => stem,
        };
        if !taken.iter().any(|name| name == stem) {
            return stem.to_string();
        }
        (2..).map(|n| format!("{stem}-{n}")).find(|name| !taken.contains(name)).unwrap_or_default()
    }

    /// Returns the table of a body, which is in the scene or in a command that adds the body; none for one of several copies.
    pub fn body(&self, name: &str) -> Option<InlineTable> {
        let tables = |key: &str| self.text.get(key).and_then(Item::as_array_of_tables).into_iter().flatten();
        let named = |table: &dyn toml_edit::TableLike| table.get("name").and_then(Item::as_str) == Some(name);
        if let Some(table) = tables("body").find(|table| named(*table)) {
            return (!table.contains_key("copies")).then(|| table.clone().into_inline_table());
        }
        tables("command").find_map(|table| {
            let body = table.get("body")?;
            named(body.as_table_like()?).then(|| body.clone().into_value().ok()?.as_inline_table().cloned())?
        })
    }

    /// Returns the shape of a body, without fields that are not plain values.
    pub fn shape(&self, name: &str, dimension: usize) -> Option<Values> {
        let body = self.body(name)?;
        let shape = body.get("shape")?.as_inline_table()?;
        let kind = shape.get("kind")?.as_str()?;
        let spec = opruga::shapes::all().into_iter().find(|spec| spec.kind == kind)?;
        let mut values = Values::defaults(spec, dimension);
        for (field, value) in shape.iter().filter(|(field, _)| *field != "kind") {
            if let Some(value) = plain(value) {
                // The reader has accepted these values; lists of other types are ignored.
                let _ = values.set(spec, field, value, dimension);
            }
        }
        Some(values)
    }

    /// Replaces the table of a body of the scene. Returns `false` if the body does not have its own table.
    pub fn replace_body(&mut self, name: &str, body: &InlineTable) -> bool {
        let Some(table) = self.own_body(name) else { return false };
        let decor = table.decor().clone();
        *table = body.clone().into_table();
        *table.decor_mut() = decor;
        true
    }

    /// Adds a body to the scene.
    pub fn push_body(&mut self, body: &InlineTable) {
        let mut table = body.clone().into_table();
        table.decor_mut().set_prefix("\n");
        let item = self.text.entry("body").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
        if let Some(tables) = item.as_array_of_tables_mut() {
            tables.push(table);
        }
    }

    /// Removes a body from the scene, with everything that names it. Returns `false` if the body does not have its own table.
    pub fn remove_body(&mut self, name: &str) -> bool {
        if self.own_body(name).is_none() {
            return false;
        }
        for key in ["body", "command", "load", "probe"] {
            let field = if key == "body" { "name" } else { "body" };
            if let Some(tables) = self.text.get_mut(key).and_then(Item::as_array_of_tables_mut) {
                tables.retain(|table| table.get(field).and_then(Item::as_str) != Some(name));
            }
        }
        true
    }

    /// Returns the scene with only the initial bodies, and without anything that names one of their nodes.
    pub fn without_nodes(&self) -> Document {
        let mut bare = self.clone();
        for key in ["command", "load", "probe"] {
            bare.text.remove(key);
        }
        if let Some(tables) = bare.text.get_mut("body").and_then(Item::as_array_of_tables_mut) {
            tables.iter_mut().for_each(|table| {
                table.remove("pin");
            });
        }
        bare
    }

    /// Returns the scene with only this body, and without anything that names a body.
    pub fn alone(&self, body: &InlineTable) -> Document {
        let mut alone = self.clone();
        for key in ["body", "command", "load", "probe"] {
            alone.text.remove(key);
        }
        let mut body = body.clone();
        // The pinned nodes of the body do not matter here.
        body.remove("pin");
        alone.push_body(&body);
        alone
    }

    /// Replaces the indices of a body's nodes wherever they occur.
    pub fn rename_nodes(&mut self, name: &str, other: &dyn Fn(u32) -> u32) {
        let renamed = |number: i64| u32::try_from(number).map_or(number, |node| i64::from(other(node)));
        for key in ["body", "command", "load", "probe"] {
            let field = if key == "body" { "name" } else { "body" };
            let Some(tables) = self.text.get_mut(key).and_then(Item::as_array_of_tables_mut) else { continue };
            let its_own = |table: &&mut Table| table.get(field).and_then(Item::as_str) == Some(name);
            for table in tables.iter_mut().filter(its_own) {
                if let Some(node) = table.get("node").and_then(Item::as_integer) {
                    table["node"] = toml_edit::value(renamed(node));
                }
                if let Some(select) = table.get_mut("select").and_then(Item::as_table_like_mut) {
                    rename_selected(select, &renamed);
                }
                let pins = table.get_mut("pin").and_then(Item::as_array_mut);
                for pin in pins.into_iter().flat_map(Array::iter_mut).filter_map(Toml::as_inline_table_mut) {
                    if let Some(select) = pin.get_mut("select").and_then(Toml::as_inline_table_mut) {
                        rename_selected(select, &renamed);
                    }
                }
            }
        }
    }

    fn own_body(&mut self, name: &str) -> Option<&mut Table> {
        let tables = self.text.get_mut("body")?.as_array_of_tables_mut()?;
        let found = |table: &&mut Table| table.get("name").and_then(Item::as_str) == Some(name);
        tables.iter_mut().find(found).filter(|table| !table.contains_key("copies"))
    }

    /// Writes a parameter into the scene itself. Returns `false` if the path names nothing that is written there.
    pub fn set(&mut self, path: &str, value: &Value) -> bool {
        let parts: Vec<&str> = path.split('.').collect();
        let put = |table: &mut dyn toml_edit::TableLike, field: &str| {
            table.insert(field, Item::Value(toml(value)));
            true
        };
        match parts.as_slice() {
            ["contact", field] => {
                let table = self.text.get_mut("contact").and_then(Item::as_table_like_mut);
                table.is_some_and(|table| put(table, field))
            }
            ["world" | "time", field] => {
                match self.text.entry(parts[0]).or_insert_with(toml_edit::table).as_table_like_mut() {
                    Some(table) => put(table, field),
                    None => false,
                }
            }
            ["integrator", field] => match self.text.get_mut("integrator") {
                Some(item) if item.is_str() => {
                    let kind = item.as_str().unwrap_or_default().to_string();
                    let mut table = InlineTable::new();
                    table.insert("kind", kind.into());
                    table.insert(*field, toml(value));
                    *item = Item::Value(Toml::InlineTable(table));
                    true
                }
                Some(item) => item.as_table_like_mut().is_some_and(|table| put(table, field)),
                None => false,
            },
            ["collider", number, field] => {
                let number = number.parse::<usize>().ok();
                let tables = self.text.get_mut("collider").and_then(Item::as_array_of_tables_mut);
                let table = number.and_then(|number| tables?.get_mut(number));
                table.is_some_and(|table| put(table, field))
            }
            ["body", name, "integrator", field] => {
                let Some(body) = self.own_body(name) else { return false };
                let table = body.get_mut("integrator").and_then(Item::as_inline_table_mut);
                table.is_some_and(|table| put(table, field))
            }
            ["body", name, "models", model, field] => {
                let Some(body) = self.own_body(name) else { return false };
                let models = body.get_mut("models").and_then(Item::as_array_mut);
                let kind = |value: &&mut Toml| {
                    value.as_inline_table().and_then(|t| t.get("kind")).and_then(Toml::as_str) == Some(model)
                };
                let table = models.and_then(|models| match model.parse::<usize>() {
                    Ok(number) => models.get_mut(number),
                    Err(_) => models.iter_mut().find(kind),
                });
                table.and_then(Toml::as_inline_table_mut).is_some_and(|table| put(table, field))
            }
            _ => false,
        }
    }

    /// Enables contact between bodies with default parameters, or disables it by removing its section.
    pub fn set_contact(&mut self, touch: bool) {
        if touch {
            self.text.entry("contact").or_insert_with(|| {
                let mut table = Table::new();
                table.decor_mut().set_prefix("\n");
                Item::Table(table)
            });
        } else {
            self.text.remove("contact");
        }
    }

    /// Removes a field of an obstacle or of contact from the scene itself. Returns `false` if the field is not written there.
    pub fn unset(&mut self, path: &str) -> bool {
        if let Some(field) = path.strip_prefix("contact.") {
            let table = self.text.get_mut("contact").and_then(Item::as_table_like_mut);
            return table.is_some_and(|table| table.remove(field).is_some());
        }
        let ["collider", number, field] = path.split('.').collect::<Vec<_>>()[..] else { return false };
        let tables = self.text.get_mut("collider").and_then(Item::as_array_of_tables_mut);
        let table = tables.zip(number.parse().ok()).and_then(|(tables, number)| tables.get_mut(number));
        table.is_some_and(|table| table.remove(field).is_some())
    }

    /// The dimension of the scene.
    pub fn dimension(&self) -> usize {
        let written = self.text.get("dimension").and_then(Item::as_integer);
        written.and_then(|dimension| usize::try_from(dimension).ok()).unwrap_or(2)
    }

    /// Gives the scene another integrator.
    pub fn set_integrator(&mut self, values: &Values) {
        let mut table = kind_table(values, self.dimension()).into_table();
        if let Some(old) = self.text.get("integrator").and_then(Item::as_table) {
            *table.decor_mut() = old.decor().clone();
        } else {
            table.decor_mut().set_prefix("\n");
        }
        self.text.insert("integrator", Item::Table(table));
    }
}

/// Removes the lines from errors in the text of a scene, because the user does not see this text. These errors name `file` instead, or no file if
/// `file` is empty. Errors in other files keep their lines.
pub(crate) fn without_lines(errors: Vec<SceneError>, scene: &str, file: &str) -> Vec<SceneError> {
    let own = format!("{scene}.toml");
    let without_own_lines = |error: SceneError| match error.file == own {
        true => SceneError { file: file.into(), line: None, column: None, excerpt: None, ..error },
        false => error,
    };
    errors.into_iter().map(without_own_lines).collect()
}

/// Returns the tables of a list. The form `command = [{ … }]` is first changed to `[[command]]`, which can be extended.
fn tables(item: &mut Item) -> Option<&mut ArrayOfTables> {
    if let Some(inline) = item.as_array().cloned() {
        let tables = inline.iter().filter_map(Toml::as_inline_table).map(|t| t.clone().into_table());
        *item = Item::ArrayOfTables(tables.collect());
    }
    item.as_array_of_tables_mut()
}

/// Replaces the indices of the nodes of a selection. If several indices become equal, only one of them remains.
fn rename_selected(select: &mut dyn toml_edit::TableLike, renamed: &dyn Fn(i64) -> i64) {
    if let Some(node) = select.get("node").and_then(Item::as_integer) {
        select.insert("node", toml_edit::value(renamed(node)));
    }
    if let Some(nodes) = select.get_mut("nodes").and_then(Item::as_array_mut) {
        let new: std::collections::BTreeSet<i64> = nodes.iter().filter_map(Toml::as_integer).map(renamed).collect();
        *nodes = new.into_iter().collect();
    }
}

/// A TOML value as a single value of a parameter; none for points and paths.
fn plain(value: &Toml) -> Option<Value> {
    match value {
        Toml::Float(x) => Some(Value::Number(*x.value())),
        Toml::Integer(x) => Some(Value::Integer(*x.value())),
        Toml::Boolean(x) => Some(Value::Boolean(*x.value())),
        Toml::String(x) => Some(Value::Text(x.value().clone())),
        Toml::Array(list) => {
            let number = |x: &Toml| x.as_float().or_else(|| x.as_integer().map(|i| i as f64));
            list.iter().map(number).collect::<Option<Vec<f64>>>().map(Value::Numbers)
        }
        _ => None,
    }
}
