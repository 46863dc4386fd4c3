//! A solid of finite elements, free and without weight, that tests hold and burden as they like.
#![allow(dead_code, reason = "every test file uses its own part")]

use opruga_core::spec::{Spec, Value, Values};
use opruga_mesh::Mesh;
use opruga_world::Registry;
use opruga_world::blueprint::*;
use std::sync::Arc;

/// A word as a value.
pub(crate) fn text(value: &str) -> Value {
    Value::Text(value.into())
}

fn values(spec: &'static Spec, set: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 3);
    for (name, value) in set {
        values.set(spec, name, value.clone(), 3).expect("a field of the test's own");
    }
    values
}

/// A body of 1000 kg/m³ under an integrator, with fields of both, at steps of 1/60 s.
pub(crate) fn solid(mesh: Mesh<3>, rule: &str, of_rule: &[(&str, Value)], material: &[(&str, Value)]) -> Blueprint<3> {
    let registry = Registry::<3>::default();
    Blueprint {
        name: "test".into(),
        title: String::new(),
        length_unit: "m".into(),
        seed: 0,
        time: Time { seconds: 1e3, frame: 1.0 / 60.0, substeps: 1 },
        surroundings: Surroundings {
            gravity: [0.0; 3],
            drag: 0.0,
            largest_force: None,
            largest_velocity: None,
            largest_distance: None,
        },
        integrator: values(registry.integrator(rule).expect("an integrator").spec(), of_rule),
        bodies: vec![BodyBlueprint {
            name: "body".into(),
            mesh: Arc::new(mesh),
            translation: [0.0; 3],
            velocity: [0.0; 3],
            angular_velocity: Vec::new(),
            mass: Mass::Density(1000.0),
            thickness: 1.0,
            integrator: None,
            models: vec![values(registry.model("fem").expect("a model").spec(), material)],
            pins: Vec::new(),
        }],
        colliders: Vec::new(),
        loads: Vec::new(),
        commands: Vec::new(),
        probes: Vec::new(),
    }
}

/// Holds the nodes of the left side.
pub(crate) fn clamp() -> Vec<PinBlueprint<3>> {
    vec![PinBlueprint { select: Selector::Side("left".into()), axes: [true; 3], motion: Vec::new() }]
}
