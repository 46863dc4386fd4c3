//! Writes commands, models and integrators as a scene does: the inverse of `actions`.

use opruga_core::spec::{Value, Values};
use opruga_world::blueprint::{Action, CommandBlueprint, Selector};
use toml_edit::{Array, InlineTable, Item, Table, Value as Toml};

/// Several numbers as a list.
pub fn numbers(of: &[f64]) -> Array {
    of.iter().copied().collect()
}

/// A value of a parameter as TOML.
pub fn toml(value: &Value) -> Toml {
    match value {
        Value::Number(x) => Toml::from(*x),
        Value::Integer(x) => Toml::from(*x),
        Value::Boolean(x) => Toml::from(*x),
        Value::Text(x) => Toml::from(x.as_str()),
        Value::Numbers(x) => Toml::Array(numbers(x)),
        Value::Integers(x) => Toml::Array(x.iter().map(|n| i64::from(*n)).collect()),
        Value::Rows(rows) => Toml::Array(rows.iter().map(|row| Toml::Array(numbers(row))).collect()),
    }
}

/// A model or an integrator as a table of a scene of this dimension. Default values of fields that have no effect together with the other values are
/// omitted, because a reader of the scene would get a warning about them.
pub fn kind_table(values: &Values, dimension: usize) -> InlineTable {
    let spec = values.spec();
    let defaults = Values::defaults(spec, dimension);
    let idle = |name: &str, value: &Value| {
        let field = spec.fields.iter().find(|field| field.name == name);
        field.is_some_and(|field| field.without_effect(values, dimension).is_some())
            && defaults.get(name) == Some(value)
    };
    let mut table = InlineTable::new();
    table.insert("kind", values.kind().into());
    for (name, value) in values.iter().filter(|(name, value)| !idle(name, value)) {
        table.insert(name, toml(value));
    }
    table
}

/// A command as a table in the file of a scene of this dimension, for the body of this name; none if the command has no such form.
pub fn command_table(command: &CommandBlueprint<3>, dimension: usize, body: &str) -> Option<Table> {
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    if matches!(command.action, Action::Add(_)) {
        return None;
    }
    table["do"] = toml_edit::value(command.action.word());
    table["at"] = toml_edit::value(command.at);
    if command.action.lasts() {
        table["until"] = toml_edit::value(command.until);
    }
    let select = |select: &Selector<3>| match select {
        Selector::Nodes(nodes) => {
            let mut inline = InlineTable::new();
            inline.insert("nodes", Toml::Array(nodes.iter().map(|n| i64::from(*n)).collect()));
            Some(inline)
        }
        _ => None,
    };
    if !matches!(command.action, Action::Set { .. }) {
        table["body"] = toml_edit::value(body);
    }
    match &command.action {
        Action::Drag { node, path, stiffness, .. } => {
            match node {
                Some(node) => table["node"] = toml_edit::value(i64::from(*node)),
                None => table["node"] = toml_edit::value("nearest"),
            }
            if let Some(stiffness) = stiffness {
                table["stiffness"] = toml_edit::value(*stiffness);
            }
            let rows = path.iter().map(|row| row[..row.len().min(1 + dimension)].to_vec()).collect();
            table["path"] = Item::Value(toml(&Value::Rows(rows)));
        }
        Action::Push { select: nodes, force, .. } => {
            table["select"] = toml_edit::value(select(nodes)?);
            table["force"] = toml_edit::value(numbers(&force[..dimension]));
        }
        Action::Pin { select: nodes, .. } | Action::Free { select: nodes, .. } => {
            table["select"] = toml_edit::value(select(nodes)?)
        }
        Action::Set { path, value } => {
            table["path"] = toml_edit::value(path.as_str());
            table["value"] = Item::Value(toml(value));
        }
        Action::Change { models, integrator, .. } => {
            if let Some(models) = models {
                let list: Array = models.iter().map(|model| Toml::InlineTable(kind_table(model, dimension))).collect();
                table["models"] = toml_edit::value(list);
            }
            if let Some(integrator) = integrator {
                table["integrator"] = toml_edit::value(kind_table(integrator, dimension));
            }
        }
        Action::Remove { .. } | Action::Add(_) => {}
    }
    Some(table)
}

/// A command that adds a body.
pub fn add_table(at: f64, body: &InlineTable) -> Table {
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    table["do"] = toml_edit::value("add");
    table["at"] = toml_edit::value(at);
    table["body"] = toml_edit::value(body.clone());
    table
}
