//! Models and integrators as a scene writes them.

use super::toml;
use opruga::core::spec::{Value, Values};
use toml_edit::InlineTable;

/// A model or an integrator of a scene of so many dimensions as a table. What has no effect beside the other values, and is as it would be
/// by itself, is left out: whoever reads the scene would be warned of it.
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

#[cfg(test)]
mod tests {
    use super::kind_table;
    use opruga::core::spec::{Value, Values};

    #[test]
    fn what_has_no_effect_and_was_set_by_nobody_is_not_written() {
        let catalogue = opruga::catalogue();
        let spec = catalogue.models.iter().find(|spec| spec.kind == "pressure").expect("gas");
        let mut gas = Values::defaults(spec, 2);
        gas.set(spec, "nRT", Value::Number(20.0), 2).expect("allowed");
        let table = kind_table(&gas, 2);
        assert!(!table.contains_key("gamma") && table.contains_key("nRT") && table.contains_key("process"));
        // With another process it has one, and what a person has set is written wherever it stands.
        gas.set(spec, "process", Value::Text("adiabatic".into()), 2).expect("allowed");
        assert!(kind_table(&gas, 2).contains_key("gamma"));
        gas.set(spec, "gamma", Value::Number(1.2), 2).expect("allowed");
        gas.set(spec, "process", Value::Text("isothermal".into()), 2).expect("allowed");
        assert!(kind_table(&gas, 2).contains_key("gamma"));
    }
}
