//! What a blueprint must keep to, whoever made it: the ranges of [`crate::schema`], names, indices, finite numbers. The reader of
//! scenes asks the same questions, and adds lines and columns.

use crate::blueprint::{
    Action, Blueprint, BodyBlueprint, CommandBlueprint, LoadBlueprint, LoadKind, Mass, PinBlueprint, Selector,
    Surroundings, Time,
};
use crate::error::WorldError;
use crate::schema::{self, Section};
use opruga_core::error::BuildError;
use opruga_core::spec::{Allowed, Value};
use opruga_math::words::number;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The largest coordinate of a shape [m]: powers of lengths up to the fourth are numbers then.
pub const LONGEST: f64 = 1e70;

/// The most frames of a run.
const MOST_FRAMES: f64 = 1e12;

/// What is allowed in names.
pub const NAMES: &str = "1 to 256 bytes without control characters and . , [ ] = quotes; not only digits";

/// What is wrong with something, in the words of errors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// A stable code.
    pub code: &'static str,
    /// The field.
    pub field: &'static str,
    /// What is wrong.
    pub message: String,
    /// The offending value.
    pub value: String,
    /// What is allowed; empty where that goes without saying.
    pub allowed: String,
}

impl Fault {
    /// The error about it in a part of the blueprint.
    fn in_part(self, place: &str) -> WorldError {
        let allowed = if self.allowed.is_empty() { String::new() } else { format!("; allowed: {}", self.allowed) };
        let source = BuildError::new(self.field, self.code, format!("{}{allowed}", self.message));
        WorldError::Build { place: place.into(), source }
    }
}

/// A field of a section, by its range there.
fn field<const D: usize>(section: &Section, name: &'static str, value: Value) -> Result<(), Fault> {
    let Some(field) = section.spec.fields.iter().find(|field| field.name == name) else { return Ok(()) };
    range::<D>(&field.range, name, value)
}

fn range<const D: usize>(range: &Allowed, name: &'static str, value: Value) -> Result<(), Fault> {
    range.accept(value, D).map(|_| ()).map_err(|(value, allowed)| Fault {
        code: "scene.range",
        field: name,
        message: format!("`{name}` is {value}"),
        value,
        allowed,
    })
}

/// Whether a character could change how the rest of a line is shown.
pub fn unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{61c}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}')
}

/// What is wrong with a name: names stand in paths and in the heads of tables, and keep clear of what separates those. The number
/// of a copy, `name[3]`, is no part of its name.
pub fn name_fault(name: &str) -> Option<String> {
    let bad = name.chars().find(|c| unprintable(*c) || ".,[]\"'=".contains(*c));
    if name.is_empty() {
        return Some("the name is empty".into());
    }
    if let Some(c) = bad {
        let shown = if unprintable(c) { c.escape_unicode().to_string() } else { c.to_string() };
        return Some(format!("the name contains `{shown}`"));
    }
    let number = name.chars().all(|c| c.is_ascii_digit());
    number.then(|| "the name is a number, which would be the place of a body".into())
}

/// What is wrong with how time passes, beyond the ranges of its fields: the frames would not end, or time would stand still.
pub fn time_fault(time: &Time) -> Option<Fault> {
    let Time { seconds, frame, substeps } = *time;
    let h = frame / f64::from(substeps);
    let (message, allowed) = if seconds <= 0.0 {
        return None;
    } else if seconds + h == seconds {
        let message = format!("a step of {} s is lost in {} s: time would stand still", number(h), number(seconds));
        (message, "a step that changes the time")
    } else if seconds / frame > MOST_FRAMES {
        (format!("{} s are {} frames", number(seconds), number(seconds / frame)), "at most 1e12 frames")
    } else {
        return None;
    };
    Some(Fault { code: "scene.range", field: "frame", message, value: format!("{frame:e}"), allowed: allowed.into() })
}

/// How a set of nodes does not fit a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SelectorFault {
    /// It names a node that is not there.
    NoNode(u32),
    /// It names a group that the mesh does not have.
    NoGroup(String),
    /// It selects no node.
    Nothing,
}

impl<const D: usize> Selector<D> {
    /// Why the set cannot be one of nodes of a body; none where it can.
    pub fn fault(&self, body: &BodyBlueprint<D>) -> Option<SelectorFault> {
        let (mut node, mut group) = (None, None);
        self.visit(&mut |part| match part {
            Selector::Nodes(nodes) => {
                let count = body.mesh.positions.len();
                node = node.or(nodes.iter().copied().find(|n| *n as usize >= count));
            }
            Selector::Group(name) if !body.mesh.groups.contains_key(name) => group = Some(name.clone()),
            _ => {}
        });
        match (node, group) {
            (Some(node), _) => Some(SelectorFault::NoNode(node)),
            (_, Some(group)) => Some(SelectorFault::NoGroup(group)),
            _ => self.resolve(&body.mesh, &body.translation).is_empty().then_some(SelectorFault::Nothing),
        }
    }

    fn visit(&self, each: &mut impl FnMut(&Selector<D>)) {
        each(self);
        match self {
            Selector::And(sets) | Selector::Or(sets) => sets.iter().for_each(|set| set.visit(each)),
            Selector::Not(set) => set.visit(each),
            _ => {}
        }
    }
}

/// Refuses a set that does not fit a body.
fn select<const D: usize>(select: &Selector<D>, body: &BodyBlueprint<D>) -> Result<(), Fault> {
    let name = &body.name;
    let (code, message, value, allowed) = match select.fault(body) {
        None => return Ok(()),
        Some(SelectorFault::NoNode(node)) => {
            let allowed = format!("nodes from 0 to {}", body.mesh.positions.len().saturating_sub(1));
            ("scene.range", format!("body `{name}` has no node {node}"), node.to_string(), allowed)
        }
        Some(SelectorFault::NoGroup(group)) => {
            let groups: Vec<&str> = body.mesh.groups.keys().map(String::as_str).collect();
            let allowed = if groups.is_empty() { "it has no groups".into() } else { groups.join(", ") };
            ("scene.unknown_name", format!("the mesh of `{name}` has no group `{group}`"), group, allowed)
        }
        Some(SelectorFault::Nothing) => {
            let message = format!("the selector selects no node of `{name}`");
            ("scene.selects_nothing", message, String::new(), String::new())
        }
    };
    Err(Fault { code, field: "select", message, value, allowed })
}

/// Refuses what a scene file could not say.
///
/// # Errors
/// [`WorldError::Build`] of the first fault, with the code that the reader of scenes gives it.
pub(crate) fn blueprint<const D: usize>(scene: &Blueprint<D>) -> Result<(), WorldError> {
    time::<D>(&scene.time)?;
    surroundings(&scene.surroundings)?;
    let mut names = BTreeSet::new();
    let mut meshes = BTreeSet::new();
    let added = scene.commands.iter().filter_map(|command| match &command.action {
        Action::Add(body) => Some(&**body),
        _ => None,
    });
    let bodies: Vec<&BodyBlueprint<D>> = scene.bodies.iter().chain(added).collect();
    for one in &bodies {
        // Copies share their mesh.
        if meshes.insert(Arc::as_ptr(&one.mesh)) {
            mesh(one).map_err(|fault| fault.in_part(&format!("body `{}`", one.name)))?;
        }
        numbers(one).map_err(|fault| fault.in_part(&format!("body `{}`", one.name)))?;
        if !names.insert(one.name.as_str()) {
            let message = format!("two bodies are called `{}`", one.name);
            return Err(duplicate(message, &one.name).in_part(&format!("body `{}`", one.name)));
        }
    }
    contact(scene, &bodies)?;
    for (k, one) in scene.loads.iter().enumerate() {
        load(one, &bodies).map_err(|fault| fault.in_part(&format!("load {k}")))?;
    }
    for (k, one) in scene.commands.iter().enumerate() {
        command(one).map_err(|fault| fault.in_part(&format!("command {k}")))?;
    }
    names.clear();
    for probe in &scene.probes {
        let place = format!("probe `{}`", probe.name);
        if !names.insert(probe.name.as_str()) {
            return Err(duplicate(format!("two probes are called `{}`", probe.name), &probe.name).in_part(&place));
        }
        let body = body_of(probe.body, &bodies).map_err(|fault| fault.in_part(&place))?;
        select(&probe.select, body).map_err(|fault| fault.in_part(&place))?;
    }
    Ok(())
}

/// Refuses a body that no scene file could describe, whose parts do not fit one another, or whose numbers are none.
///
/// # Errors
/// As [`blueprint`].
pub(crate) fn body<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), WorldError> {
    mesh(body).and_then(|()| numbers(body)).map_err(|fault| fault.in_part(&format!("body `{}`", body.name)))
}

/// Refuses pairs of groups that no body is in.
fn contact<const D: usize>(scene: &Blueprint<D>, bodies: &[&BodyBlueprint<D>]) -> Result<(), WorldError> {
    let groups: BTreeSet<&str> = bodies.iter().map(|body| body.contact_group()).collect();
    for (k, pair) in scene.contact.iter().flat_map(|contact| contact.pairs.iter().enumerate()) {
        for field in ["first", "second"] {
            let group = pair.text(field).unwrap_or("");
            if !groups.contains(group) {
                let (message, value) = (format!("no body is in the group `{group}`"), group.to_string());
                let allowed = groups.iter().copied().collect::<Vec<_>>().join(", ");
                let fault = Fault { code: "scene.unknown_name", field, message, value, allowed };
                return Err(fault.in_part(&format!("contact.pair {k}")));
            }
        }
    }
    Ok(())
}

fn duplicate(message: String, name: &str) -> Fault {
    Fault { code: "scene.duplicate_name", field: "name", message, value: name.into(), allowed: String::new() }
}

fn body_of<'b, const D: usize>(number: usize, bodies: &[&'b BodyBlueprint<D>]) -> Result<&'b BodyBlueprint<D>, Fault> {
    bodies.get(number).copied().ok_or_else(|| Fault {
        code: "scene.unknown_name",
        field: "body",
        message: format!("there is no body {number}"),
        value: number.to_string(),
        allowed: match bodies.len() {
            0 => "the scene has no bodies".into(),
            n => format!("0 to {}", n - 1),
        },
    })
}

pub(crate) fn time<const D: usize>(time: &Time) -> Result<(), WorldError> {
    let all = || {
        field::<D>(&schema::TIME, "seconds", Value::Number(time.seconds))?;
        field::<D>(&schema::TIME, "frame", Value::Number(time.frame))?;
        field::<D>(&schema::TIME, "substeps", Value::Integer(time.substeps.into()))?;
        time_fault(time).map_or(Ok(()), Err)
    };
    all().map_err(|fault| fault.in_part("time"))
}

pub(crate) fn surroundings<const D: usize>(all: &Surroundings<D>) -> Result<(), WorldError> {
    let limits = [
        ("largest_force", all.largest_force),
        ("largest_velocity", all.largest_velocity),
        ("largest_distance", all.largest_distance),
    ];
    let check = || {
        field::<D>(&schema::WORLD, "gravity", Value::Numbers(all.gravity.to_vec()))?;
        field::<D>(&schema::WORLD, "drag", Value::Number(all.drag))?;
        for (name, limit) in limits {
            limit.map_or(Ok(()), |limit| field::<D>(&schema::WORLD, name, Value::Number(limit)))?;
        }
        Ok(())
    };
    check().map_err(|fault: Fault| fault.in_part("world"))
}

/// What the mesh of a body must keep to, so that nobody who reads it goes astray.
fn mesh<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), Fault> {
    let fault = |message: String, allowed: &str| {
        let (value, allowed) = (String::new(), allowed.into());
        Fault { code: "scene.shape", field: "shape", message, value, allowed }
    };
    if body.mesh.positions.is_empty() {
        return Err(fault("it has no nodes".into(), "one node at least"));
    }
    body.mesh.validate().map_err(|error| fault(error.to_string(), ""))?;
    // Written so that what is no number is too far.
    let far = |x: &f64| (x.abs() <= LONGEST).then_some(()).is_none();
    match body.mesh.positions.iter().position(|x| x.iter().any(far)) {
        Some(node) => {
            let message = format!("node {node} lies at {:?}", body.mesh.positions[node]);
            Err(fault(message, "coordinates within 1e70 m of the origin of the shape"))
        }
        None => Ok(()),
    }
}

/// The numbers of a body.
fn numbers<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), Fault> {
    // That of copies ends in their number.
    let common = body.name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    let common = common.filter(|(_, copy)| !copy.is_empty() && copy.bytes().all(|b| b.is_ascii_digit()));
    let name = common.map_or(body.name.as_str(), |(name, _)| name);
    if let Some(message) = name_fault(name) {
        let (value, allowed) = (body.name.clone(), NAMES.into());
        return Err(Fault { code: "scene.name", field: "name", message, value, allowed });
    }
    field::<D>(&schema::BODY, "name", Value::Text(body.name.clone()))?;
    match &body.mass {
        Mass::Total(mass) => field::<D>(&schema::BODY, "mass", Value::Number(*mass))?,
        Mass::Density(density) => field::<D>(&schema::BODY, "density", Value::Number(*density))?,
        Mass::Node(mass) => field::<D>(&schema::BODY, "node_mass", Value::Number(*mass))?,
        Mass::DensityOfCells(densities) => {
            if densities.len() != body.mesh.cells.len() {
                return Err(Fault {
                    code: "scene.length",
                    field: "density_of_cells",
                    message: format!("it has {} numbers", densities.len()),
                    value: densities.len().to_string(),
                    allowed: format!("one for each of {} cells", body.mesh.cells.len()),
                });
            }
            for density in densities.iter() {
                range::<D>(&Allowed::POSITIVE, "density_of_cells", Value::Number(*density))?;
            }
        }
    }
    field::<D>(&schema::BODY, "thickness", Value::Number(body.thickness))?;
    field::<D>(&schema::BODY, "position", Value::Numbers(body.translation.to_vec()))?;
    range::<D>(&Allowed::Vector, "velocity", Value::Numbers(body.velocity.to_vec()))?;
    let gradient = body.velocity_gradient.iter().map(|row| row.to_vec()).collect();
    range::<D>(&Allowed::Points, "velocity", Value::Rows(gradient))?;
    if !(body.node_velocities.is_empty() || body.node_velocities.len() == body.mesh.nodes()) {
        return Err(Fault {
            code: "scene.length",
            field: "velocity",
            message: format!("{} nodes have a velocity", body.node_velocities.len()),
            value: body.node_velocities.len().to_string(),
            allowed: format!("none, or each of {} nodes", body.mesh.nodes()),
        });
    }
    for velocity in body.node_velocities.iter() {
        range::<D>(&Allowed::Vector, "velocity", Value::Numbers(velocity.to_vec()))?;
    }
    let turns = if D == 2 { 1 } else { 3 };
    if !(body.angular_velocity.is_empty() || body.angular_velocity.len() == turns) {
        return Err(Fault {
            code: "scene.length",
            field: "angular_velocity",
            message: format!("`angular_velocity` has {} numbers", body.angular_velocity.len()),
            value: body.angular_velocity.len().to_string(),
            allowed: turns.to_string(),
        });
    }
    range::<D>(&Allowed::Numbers, "angular_velocity", Value::Numbers(body.angular_velocity.clone()))?;
    body.pins.iter().try_for_each(|one| pin(one, body))
}

fn pin<const D: usize>(pin: &PinBlueprint<D>, body: &BodyBlueprint<D>) -> Result<(), Fault> {
    if !pin.motion.is_empty() {
        range::<D>(&Allowed::Path, "motion", Value::Rows(pin.motion.clone()))?;
    }
    select(&pin.select, body)
}

fn load<const D: usize>(load: &LoadBlueprint<D>, bodies: &[&BodyBlueprint<D>]) -> Result<(), Fault> {
    let body = body_of(load.body, bodies)?;
    let value = match load.kind {
        LoadKind::Force(value) | LoadKind::Traction(value) | LoadKind::BodyForce(value) => value.to_vec(),
        LoadKind::Pressure(value) | LoadKind::Central { value, .. } => vec![value],
    };
    range::<D>(&Allowed::Numbers, "value", Value::Numbers(value))?;
    if let LoadKind::Central { center, .. } = load.kind {
        range::<D>(&Allowed::Vector, "center", Value::Numbers(center.to_vec()))?;
    }
    if !load.curve.is_empty() {
        range::<D>(&Allowed::Curve, "curve", Value::Rows(load.curve.clone()))?;
    }
    select(&load.select, body)
}

/// What a command must keep to by itself; whether its body is there is seen when it begins.
pub(crate) fn command<const D: usize>(command: &CommandBlueprint<D>) -> Result<(), Fault> {
    range::<D>(&Allowed::ANY, "at", Value::Number(command.at))?;
    range::<D>(&Allowed::ANY, "until", Value::Number(command.until))?;
    match &command.action {
        Action::Drag { path, stiffness, largest_force, .. } => {
            range::<D>(&Allowed::Path, "path", Value::Rows(path.clone()))?;
            for (name, value) in [("stiffness", stiffness), ("largest_force", largest_force)] {
                value.map_or(Ok(()), |value| range::<D>(&Allowed::POSITIVE, name, Value::Number(value)))?;
            }
            Ok(())
        }
        Action::Push { force, .. } => range::<D>(&Allowed::Vector, "force", Value::Numbers(force.to_vec())),
        _ => Ok(()),
    }
}

/// Refuses a command that a program gives.
///
/// # Errors
/// As [`blueprint`].
pub(crate) fn given<const D: usize>(given: &CommandBlueprint<D>) -> Result<(), WorldError> {
    command(given).map_err(|fault| fault.in_part("command"))?;
    match &given.action {
        Action::Add(added) => body(added),
        _ => Ok(()),
    }
}
