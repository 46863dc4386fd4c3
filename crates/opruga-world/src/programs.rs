//! Scenes that a program builds without a file: values by name, and blueprints with the defaults of the scene format.

use crate::blueprint::{Blueprint, BodyBlueprint, ColliderBlueprint, Mass, Surroundings, Time};
use crate::error::{Part, WorldError};
use crate::refusals::Refusal;
use crate::registry::Registry;
use opruga_core::error::BuildError;
use opruga_core::spec::{Spec, Value, Values};
use opruga_math::message::AnyMessage;
use opruga_mesh::Mesh;
use std::sync::Arc;

/// The values of one kind: its defaults, replaced by the fields that the program sets.
fn values<const D: usize>(
    kind: &str,
    what: &'static str,
    specs: &[&'static Spec],
    fields: &[(&str, Value)],
) -> Result<Values, WorldError> {
    let refuse = |about: AnyMessage| {
        Err(WorldError::Build { part: Part::Section { path: what }, source: BuildError::of(kind, about) })
    };
    let Some(spec) = specs.iter().find(|spec| spec.kind == kind) else {
        let known = specs.iter().map(|spec| spec.kind).collect::<Vec<_>>().join(", ");
        return refuse(Refusal::NoKindHere { what, known }.into());
    };
    let mut values = Values::defaults(spec, D);
    for (name, value) in fields {
        if let Err(error) = values.set(spec, name, value.clone(), D) {
            return refuse(error.into());
        }
    }
    match values.missing(spec).first() {
        Some(name) => refuse(Refusal::NoFieldGiven { name }.into()),
        None => match values.check_choices(spec) {
            Ok(()) => Ok(values),
            Err(source) => Err(WorldError::Build { part: Part::Section { path: what }, source }),
        },
    }
}

impl<const D: usize> Registry<D> {
    /// The values of a model: its defaults, replaced by the given fields.
    ///
    /// # Errors
    /// [`WorldError::Build`] if there is no such model or field, if a value is not allowed, or if a required field is missing.
    pub fn model_values(&self, kind: &str, fields: &[(&str, Value)]) -> Result<Values, WorldError> {
        values::<D>(kind, "model", &self.models(), fields)
    }
    /// The values of an integrator: its defaults, replaced by the given fields.
    ///
    /// # Errors
    /// The errors of [`Registry::model_values`].
    pub fn integrator_values(&self, kind: &str, fields: &[(&str, Value)]) -> Result<Values, WorldError> {
        values::<D>(kind, "integrator", &self.integrators(), fields)
    }
}

impl<const D: usize> Blueprint<D> {
    /// A scene of 10 s without bodies, obstacles or gravity, with the frames of the scene format: 1/60 s, 16 substeps.
    pub fn new(name: &str, integrator: Values) -> Blueprint<D> {
        Blueprint {
            name: name.into(),
            title: String::new(),
            length_unit: "m".into(),
            credit: String::new(),
            picture: Default::default(),
            seed: 0,
            time: Time { seconds: 10.0, frame: 1.0 / 60.0, substeps: 16 },
            surroundings: Surroundings {
                gravity: [0.0; D],
                drag: 0.0,
                largest_force: None,
                largest_velocity: None,
                largest_distance: None,
                unfold: false,
            },
            integrator,
            bodies: Vec::new(),
            colliders: Vec::new(),
            contact: None,
            loads: Vec::new(),
            commands: Vec::new(),
            probes: Vec::new(),
        }
    }
}

impl<const D: usize> BodyBlueprint<D> {
    /// A body at rest at the position of its mesh, with the integrator of the scene.
    pub fn new(name: &str, mesh: Mesh<D>, mass: Mass, models: Vec<Values>) -> BodyBlueprint<D> {
        BodyBlueprint {
            name: name.into(),
            mesh: Arc::new(mesh),
            translation: [0.0; D],
            velocity: [0.0; D],
            angular_velocity: Vec::new(),
            velocity_gradient: [[0.0; D]; D],
            node_velocities: Arc::from([]),
            mass,
            thickness: 1.0,
            integrator: None,
            models,
            pins: Vec::new(),
            contact: None,
        }
    }
}

impl ColliderBlueprint {
    /// An obstacle of a scene in `D` dimensions: the defaults of its kind, replaced by the given fields.
    ///
    /// # Errors
    /// The errors of [`Registry::model_values`].
    pub fn new<const D: usize>(kind: &str, fields: &[(&str, Value)]) -> Result<ColliderBlueprint, WorldError> {
        Ok(ColliderBlueprint { values: values::<D>(kind, "collider", &opruga_collide::all(D), fields)? })
    }
}
