//! Scenes that a program builds without a file: values by name, and blueprints with the defaults of the scene format.

use crate::blueprint::{Blueprint, BodyBlueprint, ColliderBlueprint, Mass, Surroundings, Time};
use crate::error::{Place, WorldError};
use crate::refusals::Refusal;
use crate::registry::Registry;
use opruga_core::error::BuildError;
use opruga_core::spec::{Spec, Value, Values};
use opruga_math::message::AnyMessage;
use opruga_mesh::Mesh;
use std::sync::Arc;

/// The values of one kind: its defaults, and the fields that the program sets.
fn values<const D: usize>(
    kind: &str,
    what: &'static str,
    specs: &[&'static Spec],
    fields: &[(&str, Value)],
) -> Result<Values, WorldError> {
    let refuse = |about: AnyMessage| {
        Err(WorldError::Build { place: Place::Section { path: what }, source: BuildError::of(kind, about) })
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
            Err(source) => Err(WorldError::Build { place: Place::Section { path: what }, source }),
        },
    }
}

impl<const D: usize> Registry<D> {
    /// The values of a model: its defaults, and these fields.
    ///
    /// # Errors
    /// [`WorldError::Build`] where there is no such model or field, a value is not allowed, or a required field is missing.
    pub fn model_values(&self, kind: &str, fields: &[(&str, Value)]) -> Result<Values, WorldError> {
        values::<D>(kind, "model", &self.models(), fields)
    }
    /// The values of an integrator: its defaults, and these fields.
    ///
    /// # Errors
    /// As [`Registry::model_values`].
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
    /// A body at rest where its mesh lies, with the integrator of the scene.
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
    /// An obstacle of a scene in `D` dimensions: the defaults of its kind, and these fields.
    ///
    /// # Errors
    /// As [`Registry::model_values`].
    pub fn new<const D: usize>(kind: &str, fields: &[(&str, Value)]) -> Result<ColliderBlueprint, WorldError> {
        Ok(ColliderBlueprint { values: values::<D>(kind, "collider", &opruga_collide::all(D), fields)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, World};

    #[test]
    fn fields_are_refused_as_the_reader_of_scenes_refuses_them() {
        let registry = Registry::<2>::default();
        let code = |kind, fields: &[(&str, Value)]| registry.model_values(kind, fields).expect_err("refused").code();
        assert_eq!(code("mass_sprong", &[]), "scene.unknown_name");
        assert_eq!(code("drag", &[]), "scene.missing");
        assert_eq!(code("mass_spring", &[]), "model.one_of");
        assert_eq!(code("mass_spring", &[("stiffness", (-1.0).into())]), "scene.range");
        assert_eq!(code("mass_spring", &[("stiffnes", 1.0.into())]), "scene.unknown_field");
        let floor = ColliderBlueprint::new::<2>("half_space", &[("normal", [0.0, 0.0].into())]);
        assert_eq!(floor.expect_err("no direction").code(), "scene.range");
    }

    #[test]
    fn a_blueprint_from_code_is_a_world() {
        let registry = Registry::<2>::default();
        let springs = registry.model_values("mass_spring", &[("stiffness", 100.0.into())]).expect("springs");
        let mut scene = Blueprint::new("test", registry.integrator_values("verlet", &[]).expect("a rule"));
        let ring = Mesh::ring(0.5, 12, [0.0; 2], 0.0).expect("a ring");
        let rest = ring.positions[3];
        scene.bodies.push(BodyBlueprint::new("ring", ring, Mass::Total(1.0), vec![springs]));
        let mut world = World::new(scene, Options::default()).expect("a world");
        assert_eq!(world.node_count(0), 12);
        world.frame().expect("a frame");
        let x = world.position(0, 3);
        assert!((0..2).all(|d| (x[d] - rest[d]).abs() < 1e-15), "nothing acts on it: {x:?}");
    }
}
