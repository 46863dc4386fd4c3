//! Commands as a scene writes them.

use super::{kind_table, numbers, toml};
use opruga::blueprint::{Action, CommandBlueprint, Selector};
use opruga::core::spec::Value;
use toml_edit::{Array, InlineTable, Item, Table, Value as Toml};

/// A command as the scene file writes it, on the body of this name; none for what has no such form.
pub fn command_table<const D: usize>(command: &CommandBlueprint<D>, body: &str) -> Option<Table> {
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    let word = match &command.action {
        Action::Drag { .. } => "drag",
        Action::Push { .. } => "push",
        Action::Pin { .. } => "pin",
        Action::Free { .. } => "free",
        Action::Set { .. } => "set",
        Action::Remove { .. } => "remove",
        Action::Change { .. } => "change",
        Action::Add(_) => return None,
    };
    table["do"] = toml_edit::value(word);
    table["at"] = toml_edit::value(command.at);
    if matches!(word, "drag" | "push" | "pin") {
        table["until"] = toml_edit::value(command.until);
    }
    let select = |select: &Selector<D>| match select {
        Selector::Nodes(nodes) => {
            let mut inline = InlineTable::new();
            inline.insert("nodes", Toml::Array(nodes.iter().map(|n| i64::from(*n)).collect()));
            Some(inline)
        }
        _ => None,
    };
    if !matches!(word, "set") {
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
            table["path"] = Item::Value(toml(&Value::Rows(path.clone())));
        }
        Action::Push { select: nodes, force, .. } => {
            table["select"] = toml_edit::value(select(nodes)?);
            table["force"] = toml_edit::value(numbers(force));
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
                let list: Array = models.iter().map(|model| Toml::InlineTable(kind_table(model, D))).collect();
                table["models"] = toml_edit::value(list);
            }
            if let Some(integrator) = integrator {
                table["integrator"] = toml_edit::value(kind_table(integrator, D));
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
