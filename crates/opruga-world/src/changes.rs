//! Parameters of a scene that change during a run. Their values at the start are kept. A snapshot contains the differences from these values.
//! Therefore, a snapshot of a changed scene can be restored in a world of the original scene, and an earlier snapshot can be restored in a changed
//! world. The kept values take at most as much memory as the parameters of the scene, however often these are set.

use crate::at_start::AtStart;
use crate::blueprint::{Surroundings, Time};
use crate::build::build_colliders;
use crate::error::WorldError;
use crate::inputs::Input;
use crate::path_faults::PathFault;
use crate::rebuild::Touched;
use crate::schema::{CONTACT, MOST_SUBSTEPS};
use crate::slots::Origin;
use crate::world::World;
use opruga_core::spec::{Allowed, Spec, Value, Values, nearest};
use opruga_math::message::AnyMessage;
use std::collections::BTreeMap;

/// The origin of an added body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A command, by its number.
    Command(usize),
    /// A call of [`World::add_body`].
    Program,
}

/// The part of the scene that contains a parameter, as it was before the change.
#[derive(Clone, Debug)]
pub(crate) enum Before<const D: usize> {
    Models(Vec<(usize, Vec<Values>)>),
    Body { number: usize, models: Vec<Values>, integrator: Option<Values> },
    OwnIntegrators(Vec<(usize, Option<Values>)>),
    Integrator(Values),
    Surroundings(Surroundings<D>),
    Time(Time),
    Collider(usize, Values),
    Contact(Values),
}

/// The result of a change of the scene: the part of the scene before it, and the bodies whose islands must be updated.
pub(crate) type Changed<const D: usize> = Result<(Before<D>, Touched), WorldError>;

/// A parameter to be set: its path, the last name in the path, and its new value.
struct Setting<'a> {
    path: &'a str,
    field: &'a str,
    value: Value,
}

impl Setting<'_> {
    /// The error that explains why it cannot be set.
    fn refuse(&self, about: impl Into<AnyMessage>) -> WorldError {
        WorldError::path(self.path, about)
    }
    /// Writes the value into the parameters of a kind.
    fn write<const D: usize>(&self, values: &mut Values, spec: &Spec) -> Result<(), WorldError> {
        values.set_instead(spec, self.field, self.value.clone(), D).map_err(|fault| self.refuse(fault))
    }
    /// The value, if it is in the allowed range.
    fn accepted<const D: usize>(&self, range: Allowed) -> Result<Value, WorldError> {
        let refused = |(value, allowed)| self.refuse(PathFault::Is { value, allowed });
        range.accept(self.value.clone(), D).map_err(refused)
    }
}

impl<const D: usize> World<D> {
    /// Changes a parameter: `body.NAME.models.KIND.FIELD`, `body.NAME.integrator.FIELD`, `integrator.FIELD`, `collider.NUMBER.FIELD`,
    /// `contact.FIELD`, `world.gravity`, `world.drag`, `world.largest_force`, `world.largest_velocity`, `world.largest_distance`, `world.unfold`,
    /// `time.substeps`.
    ///
    /// The name of a body with copies means all of them, and `NAME[i]` means one of them. A body or a model may be given by its number. The stable
    /// step is estimated again.
    ///
    /// # Errors
    /// [`WorldError`] gives the cause; the world is then unchanged.
    pub fn set(&mut self, path: &str, value: Value) -> Result<(), WorldError> {
        self.set_now(path, value.clone())?;
        self.write_down(|| Input::Set { path: path.to_string(), value });
        Ok(())
    }

    /// Changes a parameter on behalf of the program or of a command.
    pub(crate) fn set_now(&mut self, path: &str, value: Value) -> Result<(), WorldError> {
        let (before, touched) = self.change(path, value.clone())?;
        let memory = self.contact_memory.clone();
        if let Err(error) = self.follow(&touched) {
            self.undo(before);
            self.follow(&touched)?;
            self.contact_memory = memory;
            return Err(error);
        }
        self.keep_start(before);
        Ok(())
    }

    /// Updates the islands and the estimates after a change of the scene.
    fn follow(&mut self, touched: &Touched) -> Result<(), WorldError> {
        self.regroup(touched, &BTreeMap::new()).and_then(|()| self.check_stability())
    }

    /// Changes only the scene. Returns the part of the scene before the change, and the bodies whose islands must be updated.
    pub(crate) fn change(&mut self, path: &str, value: Value) -> Changed<D> {
        let parts: Vec<&str> = path.split('.').collect();
        let setting = |field| Setting { path, field, value };
        match parts.as_slice() {
            ["body", name, "models", kind, field] => self.change_models(name, kind, setting(field)),
            ["body", name, "integrator", field] => self.change_own_integrators(name, setting(field)),
            ["integrator", field] => self.change_integrator(setting(field)),
            ["collider", number, field] => self.change_collider(number, setting(field)),
            ["contact", field] => self.change_contact(setting(field)),
            ["world", field] => self.change_surroundings(setting(field)),
            ["time", "substeps"] => self.change_substeps(setting("substeps")),
            _ => Err(WorldError::path(path, PathFault::NotAParameter {})),
        }
    }

    /// Changes a model of one body or of all copies of a body.
    fn change_models(&mut self, name: &str, kind: &str, setting: Setting<'_>) -> Changed<D> {
        let mut changed = Vec::new();
        for body in self.named_or_refused(name).map_err(|fault| setting.refuse(fault))? {
            let mut models = self.blueprint.bodies[body].models.clone();
            let number =
                kind.parse().ok().filter(|n| *n < models.len()).or(models.iter().position(|m| m.kind() == kind));
            let spec = number.and_then(|n| self.registry.model(models[n].kind())).map(|m| m.spec());
            let (Some(spec), Some(number)) = (spec, number) else {
                let kinds: Vec<&str> = models.iter().map(Values::kind).collect();
                let (body, kind, known) = (name.to_string(), kind.to_string(), kinds.join(", "));
                return Err(setting.refuse(PathFault::NoModel { body, kind, known }));
            };
            setting.write::<D>(&mut models[number], spec)?;
            changed.push((body, models));
        }
        for (body, models) in &mut changed {
            std::mem::swap(models, &mut self.blueprint.bodies[*body].models);
        }
        let touched = changed.iter().map(|(body, _)| *body).collect();
        Ok((Before::Models(changed), Touched::Bodies(touched)))
    }

    /// Changes the integrator of one body or of all copies of a body.
    fn change_own_integrators(&mut self, name: &str, setting: Setting<'_>) -> Changed<D> {
        let mut changed = Vec::new();
        for body in self.named_or_refused(name).map_err(|fault| setting.refuse(fault))? {
            let Some(mut values) = self.blueprint.bodies[body].integrator.clone() else {
                let (body, field) = (name.to_string(), setting.field.to_string());
                return Err(setting.refuse(PathFault::FollowsScene { body, field }));
            };
            let spec = self.registry.integrator(values.kind()).map(|i| i.spec());
            let spec = spec.ok_or_else(|| setting.refuse(PathFault::NoSuchIntegrator {}))?;
            setting.write::<D>(&mut values, spec)?;
            changed.push((body, Some(values)));
        }
        for (body, values) in &mut changed {
            std::mem::swap(values, &mut self.blueprint.bodies[*body].integrator);
        }
        let touched = changed.iter().map(|(body, _)| *body).collect();
        Ok((Before::OwnIntegrators(changed), Touched::Bodies(touched)))
    }

    /// Changes the integrator of the scene, which all bodies without their own use.
    fn change_integrator(&mut self, setting: Setting<'_>) -> Changed<D> {
        let spec = self.registry.integrator(self.blueprint.integrator.kind()).map(|i| i.spec());
        let spec = spec.ok_or_else(|| setting.refuse(PathFault::NoSuchIntegrator {}))?;
        let before = self.blueprint.integrator.clone();
        setting.write::<D>(&mut self.blueprint.integrator, spec)?;
        let follow = |b: &usize| self.blueprint.bodies[*b].integrator.is_none();
        let touched = self.bodies().filter(follow).collect();
        Ok((Before::Integrator(before), Touched::Bodies(touched)))
    }

    /// Changes an obstacle.
    fn change_collider(&mut self, number: &str, setting: Setting<'_>) -> Changed<D> {
        let count = self.blueprint.colliders.len();
        let found = number.parse::<usize>().ok().filter(|n| *n < count);
        let number = found.ok_or_else(|| {
            let collider = number.to_string();
            setting.refuse(match count {
                0 => PathFault::NoColliders { collider },
                n => PathFault::NoCollider { collider, last: n - 1 },
            })
        })?;
        let before = self.blueprint.colliders[number].values.clone();
        let spec = opruga_collide::all(D).into_iter().find(|s| s.kind == before.kind());
        let spec = spec.ok_or_else(|| setting.refuse(PathFault::NoColliderKind {}))?;
        setting.write::<D>(&mut self.blueprint.colliders[number].values, spec)?;
        match build_colliders(&self.blueprint) {
            Ok(colliders) => self.colliders = colliders,
            Err(error) => {
                self.blueprint.colliders[number].values = before;
                return Err(error);
            }
        }
        Ok((Before::Collider(number, before), Touched::Bodies(Vec::new())))
    }

    /// Changes the contact of bodies.
    fn change_contact(&mut self, setting: Setting<'_>) -> Changed<D> {
        let contact = self.blueprint.contact.as_mut().ok_or_else(|| setting.refuse(PathFault::NoContact {}))?;
        let before = contact.values.clone();
        setting.write::<D>(&mut contact.values, CONTACT.spec)?;
        // The clusters are rebuilt with the new laws.
        self.clusters = None;
        Ok((Before::Contact(before), Touched::Bodies(Vec::new())))
    }

    /// Changes gravity, drag, the limits of motion, or whether degenerate bodies unfold.
    fn change_surroundings(&mut self, setting: Setting<'_>) -> Changed<D> {
        let before = self.blueprint.surroundings;
        let number = |value: Value| match value {
            Value::Number(x) => Some(x),
            Value::Integer(x) => Some(x as f64),
            _ => None,
        };
        let now = &mut self.blueprint.surroundings;
        let mut touched = Touched::All;
        match setting.field {
            "gravity" => match setting.accepted::<D>(Allowed::Vector)? {
                Value::Numbers(g) if g.len() == D => now.gravity = core::array::from_fn(|d| g[d]),
                other => {
                    let (value, allowed) = (other.to_string(), Allowed::Vector.describe(D));
                    return Err(setting.refuse(PathFault::Is { value, allowed }));
                }
            },
            "drag" => now.drag = number(setting.accepted::<D>(Allowed::NOT_NEGATIVE)?).unwrap_or(0.0),
            "largest_force" => now.largest_force = number(setting.accepted::<D>(Allowed::POSITIVE)?),
            "largest_velocity" => now.largest_velocity = number(setting.accepted::<D>(Allowed::POSITIVE)?),
            "largest_distance" => {
                now.largest_distance = number(setting.accepted::<D>(Allowed::POSITIVE)?);
                touched = Touched::Bodies(Vec::new());
            }
            "unfold" => now.unfold = matches!(setting.accepted::<D>(Allowed::Boolean)?, Value::Boolean(true)),
            other => {
                let known = ["gravity", "drag", "largest_force", "largest_velocity", "largest_distance", "unfold"];
                let (nearest, known) = (nearest(other, known.into_iter()), known.join(", "));
                return Err(setting.refuse(PathFault::NoFieldOfWorld { field: other.into(), known, nearest }));
            }
        }
        Ok((Before::Surroundings(before), touched))
    }

    /// Changes the number of substeps of a frame.
    fn change_substeps(&mut self, setting: Setting<'_>) -> Changed<D> {
        match setting.value {
            Value::Integer(n) if (1..=i64::from(MOST_SUBSTEPS)).contains(&n) => {
                let before = self.blueprint.time;
                self.blueprint.time.substeps = n as u32;
                Ok((Before::Time(before), Touched::Bodies(Vec::new())))
            }
            ref other => {
                let allowed = Allowed::Integer { least: 1, greatest: i64::from(MOST_SUBSTEPS) }.describe(D);
                Err(setting.refuse(PathFault::Is { value: other.to_string(), allowed }))
            }
        }
    }

    fn named_or_refused(&self, name: &str) -> Result<Vec<usize>, PathFault> {
        let bodies = self.named(name);
        if bodies.is_empty() {
            let known = self.bodies().map(|b| self.blueprint.bodies[b].name.as_str());
            return Err(PathFault::NoBodyCalled { name: name.into(), nearest: nearest(name, known) });
        }
        Ok(bodies)
    }

    /// The bodies with a name: one body, all copies, or the body with that number.
    fn named(&self, name: &str) -> Vec<usize> {
        if let Some(body) = self.body(name) {
            return vec![body];
        }
        let copy = |full: &str| {
            let number = full.strip_prefix(name).and_then(|rest| rest.strip_prefix('[')?.strip_suffix(']'));
            number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        };
        let copies: Vec<usize> = self.bodies().filter(|b| copy(&self.blueprint.bodies[*b].name)).collect();
        if !copies.is_empty() {
            return copies;
        }
        name.parse().ok().filter(|b| self.handle(*b).is_some()).into_iter().collect()
    }

    /// Restores a part of the scene.
    pub(crate) fn undo(&mut self, before: Before<D>) {
        match before {
            Before::Models(changed) => {
                for (body, models) in changed {
                    self.blueprint.bodies[body].models = models;
                }
            }
            Before::Body { number, models, integrator } => {
                let body = &mut self.blueprint.bodies[number];
                (body.models, body.integrator) = (models, integrator);
            }
            Before::OwnIntegrators(changed) => {
                for (body, values) in changed {
                    self.blueprint.bodies[body].integrator = values;
                }
            }
            Before::Integrator(values) => self.blueprint.integrator = values,
            Before::Surroundings(surroundings) => self.blueprint.surroundings = surroundings,
            Before::Time(time) => self.blueprint.time = time,
            Before::Collider(number, values) => {
                self.blueprint.colliders[number].values = values;
                // The colliders were built from the same values before, so this succeeds.
                if let Ok(colliders) = build_colliders(&self.blueprint) {
                    self.colliders = colliders;
                }
            }
            Before::Contact(values) => {
                if let Some(contact) = &mut self.blueprint.contact {
                    contact.values = values;
                }
                self.clusters = None;
            }
        }
    }

    /// Keeps a part of the scene as it was at the start, when it changes for the first time.
    pub(crate) fn keep_start(&mut self, before: Before<D>) {
        let AtStart { integrator, surroundings, time, colliders, contact, bodies } = &mut self.at_start;
        match before {
            Before::Integrator(values) => _ = integrator.get_or_insert(values),
            Before::Surroundings(was) => _ = surroundings.get_or_insert(was),
            Before::Time(was) => _ = time.get_or_insert(was),
            Before::Collider(number, values) => _ = colliders.entry(number).or_insert(values),
            Before::Contact(values) => _ = contact.get_or_insert(values),
            Before::Models(changed) => {
                for (body, models) in changed {
                    let own = &self.blueprint.bodies[body].integrator;
                    bodies.entry(body).or_insert_with(|| (models, own.clone()));
                }
            }
            Before::OwnIntegrators(changed) => {
                for (body, own) in changed {
                    let models = &self.blueprint.bodies[body].models;
                    bodies.entry(body).or_insert_with(|| (models.clone(), own));
                }
            }
            Before::Body { number, models, integrator } => {
                bodies.entry(number).or_insert((models, integrator));
            }
        }
        // Bodies that the program has added keep their present values.
        bodies.retain(|body, _| self.slots.origin.get(*body) != Some(&Origin::Program));
    }

    /// Restores the scene as it was at the start, in the blueprint only.
    pub(crate) fn undo_all(&mut self) {
        let AtStart { integrator, surroundings, time, colliders, contact, bodies } = std::mem::take(&mut self.at_start);
        let scene = &mut self.blueprint;
        scene.integrator = integrator.unwrap_or_else(|| scene.integrator.clone());
        scene.surroundings = surroundings.unwrap_or(scene.surroundings);
        scene.time = time.unwrap_or(scene.time);
        for (number, values) in colliders {
            scene.colliders[number].values = values;
        }
        if let (Some(now), Some(values)) = (&mut scene.contact, contact) {
            now.values = values;
            self.clusters = None;
        }
        scene.bodies.truncate(self.slots.initial);
        for (number, (models, own)) in bodies {
            if let Some(body) = scene.bodies.get_mut(number) {
                (body.models, body.integrator) = (models, own);
            }
        }
        self.slots.truncate(self.slots.initial);
        self.slots.alive.fill(true);
    }
}
