//! A free and weightless solid of finite elements, to which tests add pins and loads.
#![allow(dead_code, reason = "every test file uses its own part")]

use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;
use opruga_world::Registry;
use opruga_world::blueprint::*;

/// A word as a value.
pub(crate) fn text(value: &str) -> Value {
    Value::Text(value.into())
}

pub(crate) fn values<const D: usize>(spec: &'static Spec, set: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, D);
    for (name, value) in set {
        values.set(spec, name, value.clone(), D).expect("a field of the test's own");
    }
    values
}

/// A body of 1000 kg/m³ with given fields of its model and of the integrator, in steps of 1/60 s.
pub(crate) fn solid<const D: usize>(
    mesh: Mesh<D>,
    rule: &str,
    of_rule: &[(&str, Value)],
    material: &[(&str, Value)],
) -> Blueprint<D> {
    let registry = Registry::<D>::default();
    let models = vec![values::<D>(registry.model("fem").expect("a model").spec(), material)];
    let integrator = values::<D>(registry.integrator(rule).expect("an integrator").spec(), of_rule);
    Blueprint {
        time: Time { seconds: 1e3, frame: 1.0 / 60.0, substeps: 1 },
        bodies: vec![BodyBlueprint::new("body", mesh, Mass::Density(1000.0), models)],
        ..Blueprint::new("test", integrator)
    }
}

/// Pins the nodes of the left side.
pub(crate) fn clamp<const D: usize>() -> Vec<PinBlueprint<D>> {
    vec![PinBlueprint { select: Selector::Side("left".into()), axes: [true; D], motion: Vec::new() }]
}
