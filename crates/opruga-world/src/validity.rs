//! The rules that every blueprint must satisfy, whoever made it: the ranges of [`crate::schema`], names, indices, finite numbers. The reader of
//! scenes applies the same rules, and adds lines and columns.

use crate::blueprint::{
    Action, Blueprint, BodyBlueprint, CommandBlueprint, LoadBlueprint, LoadKind, Mass, PinBlueprint, Selector,
    Surroundings, Time,
};
use crate::error::{Part, WorldError};
use crate::schema::{self, Section};
use opruga_core::error::BuildError;
use opruga_core::spec::{Allowed, Value, ValueError, Values};
use opruga_math::message::AnyMessage;
use opruga_mesh::outline::OutlineError;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The largest coordinate of a shape [m]; powers of lengths up to the fourth are then finite.
pub const LONGEST: f64 = 1e70;

/// The maximum number of frames of a run.
const MOST_FRAMES: f64 = 1e12;

pub use crate::faults::{BlueprintFault, NameFault};

/// An error in a field of a part of the blueprint.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The name of the field.
    pub field: &'static str,
    /// The error in the field, as a message.
    pub about: AnyMessage,
}

impl Fault {
    fn new(field: &'static str, about: impl Into<AnyMessage>) -> Fault {
        Fault { field, about: about.into() }
    }
    /// Converts it to the error of a part of the blueprint.
    fn at(self, part: Part) -> WorldError {
        WorldError::Build { part, source: BuildError::of(self.field, self.about) }
    }
}

/// Checks a field of a section against its range.
fn field<const D: usize>(section: &Section, name: &'static str, value: Value) -> Result<(), Fault> {
    let Some(field) = section.spec.fields.iter().find(|field| field.name == name) else { return Ok(()) };
    range::<D>(&field.range, name, value)
}

fn range<const D: usize>(range: &Allowed, name: &'static str, value: Value) -> Result<(), Fault> {
    let refused = |(value, allowed)| Fault::new(name, ValueError::NotAllowed { name: name.into(), value, allowed });
    range.accept(value, D).map(|_| ()).map_err(refused)
}

/// Whether a character could change the display of the rest of a line.
pub fn unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{61c}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}')
}

/// The fault of a name, if it has one. Names occur in paths and in the headers of tables, so they must not contain the separators of these. The
/// number of a copy, `name[3]`, is not part of its name.
pub fn name_fault(name: &str) -> Option<NameFault> {
    let bad = name.chars().find(|c| unprintable(*c) || ".,[]\"'=".contains(*c));
    if name.is_empty() {
        return Some(NameFault::Empty {});
    }
    if let Some(c) = bad {
        let letter = if unprintable(c) { c.escape_unicode().to_string() } else { c.to_string() };
        return Some(NameFault::Contains { letter });
    }
    let number = name.chars().all(|c| c.is_ascii_digit());
    number.then_some(NameFault::Number {})
}

/// The fault of time settings with which the frames would not end or time would not advance, although every field is within its range.
pub fn time_fault(time: &Time) -> Option<Fault> {
    let Time { seconds, frame, substeps } = *time;
    let h = frame / f64::from(substeps);
    let shown = format!("{frame:e}");
    let about = if seconds <= 0.0 {
        return None;
    } else if seconds + h == seconds {
        BlueprintFault::LostStep { h, seconds, frame: shown }
    } else if seconds / frame > MOST_FRAMES {
        BlueprintFault::ManyFrames { seconds, frames: seconds / frame, frame: shown }
    } else {
        return None;
    };
    Some(Fault::new("frame", about))
}

/// The reasons why a set of nodes does not fit a body.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SelectorFault {
    /// The set contains a node that does not exist.
    NoNode(u32),
    /// The set names a group that the mesh does not have.
    NoGroup(String),
    /// The set selects no node.
    Nothing,
}

impl SelectorFault {
    /// The fault as a message; `shown` makes names printable.
    pub fn about<const D: usize>(&self, body: &BodyBlueprint<D>, shown: &dyn Fn(&str) -> String) -> BlueprintFault {
        let name = shown(&body.name);
        match self {
            SelectorFault::NoNode(node) => {
                let last = body.mesh.positions.len().saturating_sub(1);
                BlueprintFault::NoNode { body: name, node: *node, last }
            }
            SelectorFault::NoGroup(group) if body.mesh.groups.is_empty() => {
                BlueprintFault::NoGroups { body: name, group: shown(group) }
            }
            SelectorFault::NoGroup(group) => {
                let known = body.mesh.groups.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
                BlueprintFault::NoGroup { body: name, group: shown(group), known }
            }
            SelectorFault::Nothing => BlueprintFault::SelectsNothing { body: name },
        }
    }
}

impl<const D: usize> Selector<D> {
    /// The reason why the set is not valid for a body; `None` if it is.
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
    match select.fault(body) {
        None => Ok(()),
        Some(fault) => Err(Fault::new("select", fault.about(body, &str::to_string))),
    }
}

/// Refuses a blueprint that a scene file could not express.
///
/// # Errors
/// [`WorldError::Build`] for the first fault, with the code that the reader of scenes uses.
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
            mesh(one).map_err(|fault| fault.at(Part::body(&one.name)))?;
        }
        numbers(one).map_err(|fault| fault.at(Part::body(&one.name)))?;
        if !names.insert(one.name.as_str()) {
            let about = NameFault::TwoBodies { name: one.name.clone(), line: None };
            return Err(Fault::new("name", about).at(Part::body(&one.name)));
        }
    }
    contact(scene, &bodies)?;
    for (k, one) in scene.loads.iter().enumerate() {
        load(one, &bodies).map_err(|fault| fault.at(Part::Load { index: k }))?;
    }
    for (k, one) in scene.commands.iter().enumerate() {
        command(one).map_err(|fault| fault.at(Part::Command { index: k }))?;
    }
    names.clear();
    for probe in &scene.probes {
        let part = || Part::Probe { name: probe.name.clone() };
        if !names.insert(probe.name.as_str()) {
            let about = NameFault::TwoProbes { name: probe.name.clone(), line: None };
            return Err(Fault::new("name", about).at(part()));
        }
        let body = body_of(probe.body, &bodies).map_err(|fault| fault.at(part()))?;
        select(&probe.select, body).map_err(|fault| fault.at(part()))?;
    }
    Ok(())
}

/// Refuses a body that no scene file could describe, whose parts do not fit one another, or whose numbers are not finite.
///
/// # Errors
/// The errors of [`blueprint`].
pub(crate) fn body<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), WorldError> {
    mesh(body).and_then(|()| numbers(body)).map_err(|fault| fault.at(Part::body(&body.name)))
}

/// The two groups of a pair of contact in alphabetical order, which are the same for pairs of the same groups.
pub fn groups_of_pair(pair: &Values) -> [&str; 2] {
    let mut groups = ["first", "second"].map(|field| pair.text(field).unwrap_or(""));
    groups.sort_unstable();
    groups
}

/// Refuses pairs of groups without bodies, and several pairs of the same groups.
fn contact<const D: usize>(scene: &Blueprint<D>, bodies: &[&BodyBlueprint<D>]) -> Result<(), WorldError> {
    let groups: BTreeSet<&str> = bodies.iter().map(|body| body.contact_group()).collect();
    let mut known = BTreeSet::new();
    for (k, pair) in scene.contact.iter().flat_map(|contact| contact.pairs.iter().enumerate()) {
        for field in ["first", "second"] {
            let group = pair.text(field).unwrap_or("");
            if !groups.contains(group) {
                let known = groups.iter().copied().collect::<Vec<_>>().join(", ");
                let fault = Fault::new(field, BlueprintFault::NoMember { group: group.into(), known });
                return Err(fault.at(Part::Pair { index: k }));
            }
        }
        if !known.insert(groups_of_pair(pair)) {
            let [first, second] = groups_of_pair(pair).map(String::from);
            let fault = Fault::new("second", BlueprintFault::SamePair { first, second, line: None });
            return Err(fault.at(Part::Pair { index: k }));
        }
    }
    Ok(())
}

fn body_of<'b, const D: usize>(number: usize, bodies: &[&'b BodyBlueprint<D>]) -> Result<&'b BodyBlueprint<D>, Fault> {
    bodies.get(number).copied().ok_or_else(|| {
        let about = match bodies.len() {
            0 => BlueprintFault::NoBodies { index: number },
            count => BlueprintFault::NoBody { index: number, last: count - 1 },
        };
        Fault::new("body", about)
    })
}

pub(crate) fn time<const D: usize>(time: &Time) -> Result<(), WorldError> {
    let all = || {
        field::<D>(&schema::TIME, "seconds", Value::Number(time.seconds))?;
        field::<D>(&schema::TIME, "frame", Value::Number(time.frame))?;
        field::<D>(&schema::TIME, "substeps", Value::Integer(time.substeps.into()))?;
        time_fault(time).map_or(Ok(()), Err)
    };
    all().map_err(|fault| fault.at(Part::Section { path: "time" }))
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
    check().map_err(|fault: Fault| fault.at(Part::Section { path: "world" }))
}

/// Checks the mesh of a body, so that all code that reads it can rely on it.
fn mesh<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), Fault> {
    if body.mesh.positions.is_empty() {
        return Err(Fault::new("shape", BlueprintFault::NoNodes {}));
    }
    body.mesh.validate().map_err(|error| Fault::new("shape", OutlineError::Mesh { error }))?;
    // This form treats NaN as too far.
    let far = |x: &f64| (x.abs() <= LONGEST).then_some(()).is_none();
    match body.mesh.positions.iter().position(|x| x.iter().any(far)) {
        Some(node) => {
            let position = format!("{:?}", body.mesh.positions[node]);
            Err(Fault::new("shape", BlueprintFault::FarNode { node, position }))
        }
        None => Ok(()),
    }
}

/// Checks the numbers of a body.
fn numbers<const D: usize>(body: &BodyBlueprint<D>) -> Result<(), Fault> {
    // The name of a copy ends in its number.
    let common = body.name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    let common = common.filter(|(_, copy)| !copy.is_empty() && copy.bytes().all(|b| b.is_ascii_digit()));
    let name = common.map_or(body.name.as_str(), |(name, _)| name);
    if let Some(fault) = name_fault(name) {
        return Err(Fault::new("name", fault));
    }
    field::<D>(&schema::BODY, "name", Value::Text(body.name.clone()))?;
    match &body.mass {
        Mass::Total(mass) => field::<D>(&schema::BODY, "mass", Value::Number(*mass))?,
        Mass::Density(density) => field::<D>(&schema::BODY, "density", Value::Number(*density))?,
        Mass::Node(mass) => field::<D>(&schema::BODY, "node_mass", Value::Number(*mass))?,
        Mass::DensityOfCells(densities) => {
            if densities.len() != body.mesh.cells.len() {
                let (count, cells) = (densities.len(), body.mesh.cells.len());
                return Err(Fault::new("density_of_cells", BlueprintFault::Densities { count, cells }));
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
        let (count, nodes) = (body.node_velocities.len(), body.mesh.nodes());
        return Err(Fault::new("velocity", BlueprintFault::NodeVelocities { count, nodes }));
    }
    for velocity in body.node_velocities.iter() {
        range::<D>(&Allowed::Vector, "velocity", Value::Numbers(velocity.to_vec()))?;
    }
    let turns = if D == 2 { 1 } else { 3 };
    if !(body.angular_velocity.is_empty() || body.angular_velocity.len() == turns) {
        let count = body.angular_velocity.len();
        return Err(Fault::new("angular_velocity", BlueprintFault::AngularVelocity { count, wanted: turns }));
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

/// Checks a command alone; the existence of its body is checked when the command begins.
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

/// Refuses an invalid command of a program.
///
/// # Errors
/// The errors of [`blueprint`].
pub(crate) fn given<const D: usize>(given: &CommandBlueprint<D>) -> Result<(), WorldError> {
    command(given).map_err(|fault| fault.at(Part::Section { path: "command" }))?;
    match &given.action {
        Action::Add(added) => body(added),
        _ => Ok(()),
    }
}
