//! Actions on moving bodies: drag, push, pin, free, set, add, remove.

use crate::blueprint::{Action, BodyBlueprint, CommandBlueprint, Selector};
use crate::changes::Source;
use crate::error::WorldError;
use crate::inputs::Input;
use crate::loads::{NodeForces, Pull};
use crate::path_faults::PathFault;
use crate::running::{Progress, Running};
use crate::selection::longest_side;
use crate::slots::Origin;
use crate::world::World;
use opruga_core::state::View;
use opruga_core::system::{Pin, System};
use opruga_mesh::Mesh;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, PoisonError};

/// By default, the largest force of a pull is the force of its spring when stretched by this multiple of the size of the body.
const FARTHEST_PULL: f64 = 10.0;

impl<const D: usize> Action<D> {
    /// The number of the body on which the action acts; `None` if it changes a parameter, adds a body, or removes one by name.
    pub fn body(&self) -> Option<usize> {
        match self {
            Action::Drag { body, .. }
            | Action::Push { body, .. }
            | Action::Pin { body, .. }
            | Action::Free { body, .. }
            | Action::Change { body, .. } => Some(*body),
            Action::Set { .. } | Action::Add(_) | Action::Remove { .. } => None,
        }
    }

    /// Whether the action lasts for a period with an end, rather than acting instantaneously.
    pub fn lasts(&self) -> bool {
        matches!(self, Action::Drag { .. } | Action::Push { .. } | Action::Pin { .. })
    }

    /// The word for the action in scene files.
    pub fn word(&self) -> &'static str {
        match self {
            Action::Drag { .. } => "drag",
            Action::Push { .. } => "push",
            Action::Pin { .. } => "pin",
            Action::Free { .. } => "free",
            Action::Set { .. } => "set",
            Action::Change { .. } => "change",
            Action::Add(_) => "add",
            Action::Remove { .. } => "remove",
        }
    }
}

impl<const D: usize> World<D> {
    /// The command that the last call of [`World::frame`] refused, which is the cause of its error.
    pub fn refused_command(&self) -> Option<&CommandBlueprint<D>> {
        self.refused.as_deref()
    }

    /// The default stiffness [N/m] and largest force [N] of a pull on a body; `None` if there is no such body.
    pub fn usual_pull(&self, body: usize) -> Option<[f64; 2]> {
        self.handle(body)?;
        let (island, lane) = self.locations[body];
        Some(usual_pull(&self.islands[island].system, lane, &self.blueprint.bodies[body]))
    }

    /// Gives the world a command. The command begins at the start of the first frame that is not before its time. Once the command is over, the world
    /// keeps nothing of it.
    ///
    /// # Errors
    /// [`WorldError`] if it refers to a body that does not exist, or if a scene could not contain it.
    pub fn command(&mut self, command: CommandBlueprint<D>) -> Result<(), WorldError> {
        if let Some(body) = command.action.body()
            && !self.slots.is_there(body)
        {
            return Err(WorldError::path(format!("body.{body}"), PathFault::NoBody {}));
        }
        crate::validity::given(&command)?;
        self.write_down(|| Input::Command(command.clone()));
        self.running.push(Running::given(command, Progress::Waiting));
        Ok(())
    }

    /// Gives the world a command that begins now, as if the scene had contained it from the start; returns its number.
    ///
    /// Commands of the scene that are due begin before this command. The number stays the same until the world is rebuilt.
    ///
    /// # Errors
    /// [`WorldError`] if the time of the command is not that of the coming frame, or if the command is refused. The command then has no effect.
    pub fn act(&mut self, command: CommandBlueprint<D>) -> Result<usize, WorldError> {
        let (at, now) = (command.at, self.time());
        if (at - now).abs() > 1e-9 * self.blueprint.time.frame {
            return Err(WorldError::path("at", PathFault::NotNow { at, now }));
        }
        crate::validity::given(&command)?;
        self.begin_what_is_due()?;
        self.write_down(|| Input::Act);
        // The position that it would have in a scene file: in order of time, after the commands that begin at the same time.
        let number = self.running.iter().rposition(|r| !r.given && r.command.at <= at).map_or(0, |last| last + 1);
        let generation = self.slots.next_of_act();
        self.running.insert(number, Running { acted: true, generation, ..Running::waiting(command) });
        self.renumber(number, 1);
        let outcome = self.begin(number).and_then(|body| self.rebuild(&body.into_iter().collect()));
        if let Err(error) = outcome {
            self.running.remove(number);
            self.renumber(number, -1);
            return Err(error);
        }
        Ok(number)
    }

    /// Extends the path of the pointer of a drag: adds a row `[t, x, y(, z)]` to its end.
    ///
    /// Earlier steps are not affected if the row is later than the next frame.
    ///
    /// # Errors
    /// [`WorldError::Path`] if the command is not a drag, if the time does not increase, or if a number is not finite.
    pub fn lead(&mut self, number: usize, row: Vec<f64>) -> Result<(), WorldError> {
        let refuse = |fault: PathFault| WorldError::path(format!("command.{number}"), fault);
        let running = self.running.get_mut(number).ok_or_else(|| refuse(PathFault::NoCommand {}))?;
        let Action::Drag { path, .. } = &mut running.command.action else {
            return Err(refuse(PathFault::NoDrag {}));
        };
        let rises = path.last().is_none_or(|last| last[0] < row[0]);
        if row.len() != D + 1 || !rises || !row.iter().all(|x| x.is_finite()) {
            return Err(refuse(PathFault::Row {}));
        }
        path.push(row.clone());
        running.path.write().unwrap_or_else(PoisonError::into_inner).push(row);
        Ok(())
    }

    /// Ends a command at a given time [s] instead of its own end.
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no such command, or if it would not end after its beginning.
    pub fn finish(&mut self, number: usize, until: f64) -> Result<(), WorldError> {
        match self.running.get_mut(number) {
            Some(running) if until > running.command.at => {
                running.command.until = until;
                Ok(())
            }
            Some(running) => {
                let fault = PathFault::CannotEnd { at: running.command.at, until };
                Err(WorldError::path(format!("command.{number}"), fault))
            }
            None => Err(WorldError::path(format!("command.{number}"), PathFault::NoCommand {})),
        }
    }

    /// Begins and ends the commands that are due now, without waiting for the coming frame, which does not repeat them. Call this method to see the
    /// effect of commands at a moment to which the world was rewound.
    ///
    /// # Errors
    /// [`WorldError`] of the first command that is refused; the others begin nevertheless.
    pub fn begin_what_is_due(&mut self) -> Result<(), WorldError> {
        let now = self.time();
        // A frame begins at a multiple of its length; times given in decimals may differ from it by rounding.
        let soon = now + 1e-9 * self.blueprint.time.frame;
        let mut touched = BTreeSet::new();
        let mut failed = Ok(());
        self.refused = None;
        for number in 0..self.running.len() {
            let running = &self.running[number];
            let over = soon >= running.command.until && running.command.until > running.command.at;
            match running.progress {
                Progress::Waiting if over => self.running[number].progress = Progress::Done,
                Progress::Waiting if soon >= running.command.at => match self.begin(number) {
                    Ok(body) => touched.extend(body),
                    // The error is reported once; the other commands that are due begin nevertheless.
                    Err(error) => {
                        self.running[number].progress = Progress::Done;
                        if failed.is_ok() {
                            self.refused = Some(Box::new(self.running[number].command.clone()));
                        }
                        failed = failed.and(Err(error));
                    }
                },
                Progress::Acting { .. } if over => {
                    self.running[number].progress = Progress::Done;
                    touched.extend(self.running[number].command.action.body());
                }
                _ => {}
            }
        }
        self.rebuild(&touched)?;
        self.forget_commands();
        failed
    }

    /// Removes commands of the program that are over.
    pub(crate) fn forget_commands(&mut self) {
        self.running.retain(|running| !running.given || running.progress != Progress::Done);
    }

    /// Updates the command numbers that added bodies refer to, when a command is inserted or removed.
    fn renumber(&mut self, from: usize, by: isize) {
        for origin in &mut self.slots.origin {
            if let Origin::Command(number) = origin
                && *number >= from
            {
                *number = number.saturating_add_signed(by);
            }
        }
    }

    /// Begins a command. Returns the body on which the command acts from now on.
    fn begin(&mut self, number: usize) -> Result<Option<usize>, WorldError> {
        let command = self.running[number].command.clone();
        if let Some(body) = command.action.body()
            && self.handle(body).is_none()
        {
            let path = self.blueprint.bodies.get(body).map_or(format!("body.{body}"), |b| b.name.clone());
            return Err(WorldError::path(path, PathFault::NoBodyThen { time: self.time() }));
        }
        let acting = match &command.action {
            Action::Drag { body, node, facet, path, .. } => {
                let pointer = opruga_core::system::along_path::<D>(path, self.time()).0;
                let targets = match node {
                    Some(node) => vec![(*node, 1.0)],
                    None => self.nearest(*body, pointer, *facet),
                };
                Progress::Acting { targets, anchors: Vec::new() }
            }
            Action::Push { body, select, .. } | Action::Free { body, select } => {
                let targets = self.selected(*body, select).into_iter().map(|n| (n, 1.0)).collect();
                Progress::Acting { targets, anchors: Vec::new() }
            }
            Action::Pin { body, select, .. } => {
                let targets: Vec<(u32, f64)> = self.selected(*body, select).into_iter().map(|n| (n, 1.0)).collect();
                let anchors = targets.iter().map(|(n, _)| self.position(*body, *n)).collect();
                Progress::Acting { targets, anchors }
            }
            Action::Set { path, value } => {
                self.running[number].progress = Progress::Done;
                self.set_now(path, value.clone())?;
                return Ok(None);
            }
            Action::Change { body, models, integrator } => {
                self.running[number].progress = Progress::Done;
                self.become_other(*body, models.clone(), integrator.clone())?;
                return Ok(None);
            }
            Action::Add(body) => {
                self.running[number].progress = Progress::Done;
                self.include((**body).clone(), Source::Command(number))?;
                return Ok(None);
            }
            Action::Remove { name } => {
                self.running[number].progress = Progress::Done;
                self.remove_now(name)?;
                return Ok(None);
            }
        };
        self.running[number].progress = acting;
        Ok(command.action.body())
    }

    /// The nodes of a body that a selector selects, by its rest shape.
    pub(crate) fn selected(&self, body: usize, select: &Selector<D>) -> Vec<u32> {
        let blueprint = &self.blueprint.bodies[body];
        select.resolve(&blueprint.mesh, &blueprint.translation)
    }

    /// The node nearest to a point or, if `facet` is set, the corners of the nearest facet with the weights of its nearest point.
    fn nearest(&self, body: usize, point: [f64; D], facet: bool) -> Vec<(u32, f64)> {
        let distance = |x: [f64; D]| (0..D).map(|d| (x[d] - point[d]) * (x[d] - point[d])).sum::<f64>();
        let mesh = Arc::clone(&self.blueprint.bodies[body].mesh);
        if facet && !mesh.facets.is_empty() {
            let mut best: Option<(f64, Vec<(u32, f64)>)> = None;
            for corners in &mesh.facets {
                let corners: Vec<u32> = corners.to_vec();
                let points: Vec<[f64; D]> = corners.iter().map(|n| self.position(body, *n)).collect();
                let shares = nearest_shares(&points, &point);
                let mut x = [0.0; D];
                for (corner, share) in points.iter().zip(&shares) {
                    for d in 0..D {
                        x[d] += share * corner[d];
                    }
                }
                let far = distance(x);
                if best.as_ref().is_none_or(|(least, _)| far < *least) {
                    best = Some((far, corners.into_iter().zip(shares).filter(|(_, s)| *s > 0.0).collect()));
                }
            }
            return best.map(|(_, shares)| shares).unwrap_or_default();
        }
        let mut best = (f64::INFINITY, 0);
        for node in 0..mesh.positions.len() as u32 {
            let far = distance(self.position(body, node));
            if far < best.0 {
                best = (far, node);
            }
        }
        vec![(best.1, 1.0)]
    }

    /// Adds the effects of active commands to the systems of a newly built island.
    pub(crate) fn apply_running(&mut self, island: usize) {
        let bodies = self.islands[island].bodies.clone();
        for number in 0..self.running.len() {
            let running = &self.running[number];
            let Progress::Acting { targets, anchors } = &running.progress else { continue };
            let action = &running.command.action;
            let Some(lane) = bodies.iter().position(|b| Some(*b) == action.body()) else { continue };
            let system = &mut self.islands[island].system;
            let layout = system.layout;
            let index = |node: u32| layout.index(node as usize, lane);
            match action {
                Action::Drag { .. } => {
                    let limited = Arc::clone(&self.limited_pulls);
                    system.add(Box::new(pull_of(running, system, lane, &self.blueprint.bodies[bodies[lane]], limited)));
                }
                Action::Push { force, .. } => {
                    let mut entries: Vec<(usize, [f64; D])> =
                        targets.iter().map(|(n, _)| (index(*n), *force)).collect();
                    entries.sort_by_key(|e| e.0);
                    system.add(Box::new(NodeForces { entries, curve: Vec::new() }));
                }
                // Pins of the body and of earlier commands are already present; those of later commands are not.
                Action::Free { .. } => {
                    let free: BTreeSet<usize> = targets.iter().map(|(node, _)| index(*node)).collect();
                    system.pins.retain(|pin| !free.contains(&pin.index));
                }
                Action::Pin { axes, .. } => {
                    for ((node, _), anchor) in targets.iter().zip(anchors) {
                        system.pins.push(Pin {
                            index: index(*node),
                            axes: *axes,
                            anchor: *anchor,
                            motion: Arc::new(Vec::new()),
                        });
                    }
                }
                _ => {}
            }
        }
        for (handle, law) in self.user_forces.iter().filter(|(handle, _)| self.slots.is_of(*handle)) {
            if let Some(lane) = bodies.iter().position(|b| *b == handle.index) {
                let system = &mut self.islands[island].system;
                let layout = system.layout;
                system.add(Box::new(crate::loads::UserForce { law: Arc::clone(law), layout, body: lane }));
            }
        }
        let island = &mut self.islands[island];
        island.system.equip(&*island.integrator);
    }

    /// Pulls that act now: grabbed point, pointer, force [N].
    pub fn pulls(&self) -> Vec<([f64; D], [f64; D], [f64; D])> {
        let mut out = Vec::new();
        for running in &self.running {
            let (Progress::Acting { .. }, Action::Drag { body, .. }) = (&running.progress, &running.command.action)
            else {
                continue;
            };
            let (island, lane) = self.locations[*body];
            let system = &self.islands[island].system;
            let pull = pull_of(running, system, lane, &self.blueprint.bodies[*body], Arc::default());
            let view = View {
                x: system.state.x.slices(),
                v: system.state.v.slices(),
                nodes: system.nodes,
                layout: system.layout,
                time: self.time(),
                threads: 1,
            };
            let (x, pointer, force, _) = pull.force(&view);
            out.push((x, pointer, force));
        }
        out
    }
}

/// The default stiffness [N/m] and largest force [N] of a pull.
///
/// With this stiffness the whole body would oscillate on the spring twice a second. The largest force is the force of the spring when it is stretched
/// by [`FARTHEST_PULL`] sizes of the body at rest, wherever the pointer goes.
fn usual_pull<const D: usize>(system: &System<D>, lane: usize, body: &BodyBlueprint<D>) -> [f64; 2] {
    let whole: f64 = (0..system.nodes).map(|n| system.mass.at(system.layout.index(n, lane))).sum();
    let stiffness = whole * 157.913_670_417_429_74;
    [stiffness, farthest_pull(&body.mesh, stiffness)]
}

/// The default largest force of a pull with a given stiffness [N].
fn farthest_pull<const D: usize>(mesh: &Mesh<D>, stiffness: f64) -> f64 {
    let size = longest_side(mesh);
    // A single point has no size that could limit the pull.
    if size > 0.0 { FARTHEST_PULL * size * stiffness } else { f64::INFINITY }
}

/// The pull of a drag that acts on the body in a lane of a system.
fn pull_of<const D: usize>(
    running: &Running<D>,
    system: &System<D>,
    lane: usize,
    body: &BodyBlueprint<D>,
    limited: Arc<AtomicU64>,
) -> Pull<D> {
    let (targets, stiffness, largest_force) = match (&running.progress, &running.command.action) {
        (Progress::Acting { targets, .. }, Action::Drag { stiffness, largest_force, .. }) => {
            (targets.as_slice(), *stiffness, *largest_force)
        }
        _ => (&[][..], None, None),
    };
    let layout = system.layout;
    let grabbed: Vec<(usize, f64)> = targets.iter().map(|(n, s)| (layout.index(*n as usize, lane), *s)).collect();
    let mass: f64 = grabbed.iter().map(|(p, s)| s * system.mass.at(*p)).sum();
    let stiffness = stiffness.unwrap_or_else(|| usual_pull(system, lane, body)[0]);
    let farthest = farthest_pull(&body.mesh, stiffness);
    Pull {
        grabbed,
        path: Arc::clone(&running.path),
        stiffness,
        damping: 2.0 * (stiffness * mass).sqrt(),
        largest_force: largest_force.unwrap_or(farthest),
        limited,
    }
}

/// The weights of the corners at the point of a segment or triangle that is nearest to a given point.
fn nearest_shares<const D: usize>(corners: &[[f64; D]], point: &[f64; D]) -> Vec<f64> {
    let dot = |a: &[f64; D], b: &[f64; D]| (0..D).map(|d| a[d] * b[d]).sum::<f64>();
    let minus = |a: &[f64; D], b: &[f64; D]| -> [f64; D] { core::array::from_fn(|d| a[d] - b[d]) };
    let on_segment = |a: &[f64; D], b: &[f64; D]| {
        let edge = minus(b, a);
        let square = dot(&edge, &edge);
        let s = if square > 0.0 { dot(&minus(point, a), &edge) / square } else { 0.0 };
        s.clamp(0.0, 1.0)
    };
    if corners.len() == 2 {
        let s = on_segment(&corners[0], &corners[1]);
        return vec![1.0 - s, s];
    }
    // Barycentric coordinates of the foot of the perpendicular; if it is outside the triangle, those of the nearest point of the edges.
    let (u, w, r) = (minus(&corners[1], &corners[0]), minus(&corners[2], &corners[0]), minus(point, &corners[0]));
    let (uu, uw, ww, ru, rw) = (dot(&u, &u), dot(&u, &w), dot(&w, &w), dot(&r, &u), dot(&r, &w));
    let determinant = uu * ww - uw * uw;
    if determinant > 0.0 {
        let (s, t) = ((ww * ru - uw * rw) / determinant, (uu * rw - uw * ru) / determinant);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return vec![1.0 - s - t, s, t];
        }
    }
    let mut best = (f64::INFINITY, vec![1.0, 0.0, 0.0]);
    for [a, b] in [[0, 1], [1, 2], [2, 0]] {
        let s = on_segment(&corners[a], &corners[b]);
        let foot: [f64; D] = core::array::from_fn(|d| corners[a][d] + s * (corners[b][d] - corners[a][d]));
        let far = minus(&foot, point);
        let square = dot(&far, &far);
        if square < best.0 {
            let mut shares = vec![0.0; 3];
            shares[a] = 1.0 - s;
            shares[b] = s;
            best = (square, shares);
        }
    }
    best.1
}
