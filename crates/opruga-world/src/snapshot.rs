//! The whole state of a world as bytes, and its restoration.

use crate::blueprint::Action;
use crate::bytes::{Reader, Writer};
use crate::carried::BodyState;
use crate::contact_memory::ContactMemory;
use crate::error::WorldError;
use crate::ledger::Flows;
use crate::path_faults::SnapshotFault;
use crate::rebuild::Touched;
use crate::running::{Progress, Running};
use crate::slots::{ACTED, Origin};
use crate::world::World;
use opruga_math::WIDTH;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

const VERSION: u64 = 10;
/// Earlier versions that can be read. The first is the previous version, which has no state of contact. The second is the version before it, which
/// has no names of the channels of a history. A snapshot of that version can be read only if no integrator kept any data.
const BEFORE: [u64; 2] = [9, 8];

impl<const D: usize> World<D> {
    /// The whole state: time, positions, velocities, memory of models, progress of commands, the ledger.
    ///
    /// A world that was built from the same blueprint and restores the snapshot continues bit for bit, on any number of threads.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.snapshot_into(&mut out);
        out
    }

    /// Appends the bytes of [`World::snapshot`], for callers that take a snapshot every frame.
    pub fn snapshot_into(&self, out: &mut Vec<u8>) {
        let mut out = Writer(out);
        out.count(VERSION);
        out.count(D as u64);
        out.count(self.frames);
        let mut delta = Vec::new();
        self.write_delta(&mut Writer(&mut delta));
        out.bytes(&delta);
        out.count(self.slots.next);
        out.count(self.slots.len() as u64);
        for (body, alive) in self.slots.alive.iter().enumerate() {
            out.count(u64::from(*alive));
            if !alive {
                continue;
            }
            let (island, lane) = self.locations[body];
            let system = &self.islands[island].system;
            out.columns(&system.state.x, system, lane);
            out.columns(&system.state.v, system, lane);
            let models = self.blueprint.bodies[body].models.len();
            out.count(models as u64);
            for member in &system.members[..models] {
                let memory = member.memory.iter().skip(lane).step_by(WIDTH);
                out.count(memory.len() as u64);
                memory.for_each(|m| out.number(*m));
            }
            out.history(system, lane);
            out.count(self.laws_on(body));
        }
        let of_scene = self.running.iter().filter(|running| !running.given);
        out.count(of_scene.clone().count() as u64);
        for running in of_scene {
            match &running.progress {
                // The command ended before it began, because its body was removed; this follows from the rest of the state.
                Progress::Done if running.command.at > self.time() => out.count(0),
                progress => write_progress(&mut out, progress),
            }
        }
        let given = self.running.iter().filter(|running| running.given && running.progress != Progress::Done);
        out.count(given.clone().count() as u64);
        for running in given {
            out.command(&running.command);
            write_progress(&mut out, &running.progress);
        }
        self.flows.write(&mut out);
        self.contact_memory.write(&mut out);
    }

    /// Restores the state of a snapshot of a world with the same blueprint. Bodies that a program had added and commands that it had given are
    /// restored too; later ones are forgotten, and their handles become stale. Force laws of the program are not part of a snapshot: a restored body
    /// lacks its law, and a warning (`restore.no_force`) reports it.
    ///
    /// # Errors
    /// [`WorldError::Snapshot`] if the bytes belong to another scene or are damaged; the world is then unchanged.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.restored(bytes, false)
    }

    /// Restores the state of a snapshot of a world that had the same commands up to that time. Commands that had not begun may differ in content and
    /// number.
    ///
    /// # Errors
    /// The errors of [`World::restore`].
    pub fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.restored(bytes, true)
    }

    fn restored(&mut self, bytes: &[u8], other_future: bool) -> Result<(), WorldError> {
        self.forget_contacts();
        // Commands of the program are taken from the snapshot.
        let commands: Vec<Running<D>> = self.running.iter().filter(|r| !r.given).map(Running::anew).collect();
        if self.go_to_alike(bytes, &commands, other_future)? {
            return Ok(());
        }
        let kept = (self.blueprint.clone(), self.at_start.clone(), self.colliders.clone(), self.running.clone());
        let bodies = (self.slots.clone(), self.frames, self.flows);
        let islands =
            (std::mem::take(&mut self.islands), std::mem::take(&mut self.locations), Arc::clone(&self.integrator));
        let outcome = self.go_to(bytes, &commands, other_future);
        if outcome.is_err() {
            (self.blueprint, self.at_start, self.colliders, self.running) = kept;
            (self.slots, self.frames, self.flows) = bodies;
            (self.islands, self.locations, self.integrator) = islands;
            self.refresh_ledger();
        }
        outcome
    }

    /// Reads the part of a snapshot before its bodies.
    fn read_head<'b>(reader: &mut Reader<'b>) -> Result<Head<'b>, WorldError> {
        let refuse = |fault: SnapshotFault| Err(WorldError::snapshot(fault));
        let version = reader.count()?;
        if version != VERSION && !BEFORE.contains(&version) {
            return refuse(SnapshotFault::Version { version: VERSION });
        }
        if reader.count()? != D as u64 {
            return refuse(SnapshotFault::Dimension {});
        }
        Ok(Head { version, frames: reader.count()?, delta: reader.bytes()? })
    }

    /// Reads the bodies of the blueprint, the commands, and the ledger from a snapshot. `commands` are the commands of the scene. With
    /// `other_future`, the commands that had not begun at the time of the snapshot may differ.
    fn read_rest(
        &self,
        reader: &mut Reader<'_>,
        version: u64,
        commands: &[Running<D>],
        other_future: bool,
    ) -> Result<Rest<D>, WorldError> {
        let mut rest = Rest { next: reader.count()?, ..Rest::default() };
        self.read_bodies(reader, version, &mut rest)?;
        self.read_commands(reader, commands, other_future, &mut rest)?;
        rest.flows = Flows::read(reader)?;
        if version == VERSION {
            rest.contact = ContactMemory::read(reader)?;
        }
        if !reader.0.is_empty() {
            return Err(WorldError::snapshot(SnapshotFault::GoesOn {}));
        }
        Ok(rest)
    }

    /// Reads which bodies are alive, their states, and the numbers of their force laws.
    fn read_bodies(&self, reader: &mut Reader<'_>, version: u64, rest: &mut Rest<D>) -> Result<(), WorldError> {
        let refuse = |fault: SnapshotFault| Err(WorldError::snapshot(fault));
        if reader.count()? != self.blueprint.bodies.len() as u64 {
            return refuse(SnapshotFault::BodyCount {});
        }
        for (number, body) in self.blueprint.bodies.iter().enumerate() {
            rest.alive.push(reader.count()? == 1);
            let origin = self.slots.origin[number];
            if rest.alive[number] && !origin.is_taken() || !rest.alive[number] && origin == Origin::Program {
                return refuse(SnapshotFault::BodyPlace {});
            }
            if !rest.alive[number] {
                continue;
            }
            let generation = self.slots.generation[number];
            if origin == Origin::Program && generation >= rest.next || rest.next >= ACTED {
                return refuse(SnapshotFault::Generation {});
            }
            let x = reader.vectors::<D>()?;
            let v = reader.vectors::<D>()?;
            let models = reader.length()?;
            let mut memory = Vec::new();
            for _ in 0..models {
                memory.push(reader.numbers()?);
            }
            if x.len() != body.mesh.positions.len() || v.len() != x.len() || models != body.models.len() {
                return refuse(SnapshotFault::OtherShape { body: body.name.clone() });
            }
            if x.iter().chain(&v).flatten().any(|c| !c.is_finite()) {
                return refuse(SnapshotFault::NotFinite { body: body.name.clone() });
            }
            let history = match version {
                VERSION | 9 => reader.history()?,
                _ => match reader.empty_history()? {
                    Some(history) => history,
                    None => return refuse(SnapshotFault::Version { version: VERSION }),
                },
            };
            if !history.is_of_nodes(x.len()) {
                return refuse(SnapshotFault::OtherShape { body: body.name.clone() });
            }
            rest.states.insert(number, BodyState { x, v, memory, history });
            let laws = reader.count()?;
            if laws > 0 {
                rest.laws.insert(number, laws);
            }
        }
        Ok(())
    }

    /// Reads the progress of the commands of the scene, and the commands of the program, and checks that their nodes exist.
    fn read_commands(
        &self,
        reader: &mut Reader<'_>,
        commands: &[Running<D>],
        other_future: bool,
        rest: &mut Rest<D>,
    ) -> Result<(), WorldError> {
        let refuse = |fault: SnapshotFault| Err(WorldError::snapshot(fault));
        let count = reader.length()?;
        if !other_future && count != commands.len() {
            return refuse(SnapshotFault::CommandCount {});
        }
        for _ in 0..count {
            rest.progress.push(read_progress(reader)?);
        }
        if other_future {
            // Commands are ordered by time, so those that have begun come first.
            if rest.progress.iter().skip(commands.len()).any(|progress| *progress != Progress::Waiting) {
                return refuse(SnapshotFault::CommandCount {});
            }
            rest.progress.resize(commands.len(), Progress::Waiting);
        }
        for _ in 0..reader.length()? {
            let command = reader.command(&self.registry)?;
            rest.given.push(Running::given(command, read_progress(reader)?));
        }
        let of_scene = commands.iter().map(|known| &known.command).zip(&rest.progress);
        let of_program = rest.given.iter().map(|given| (&given.command, &given.progress));
        for (command, progress) in of_scene.chain(of_program) {
            let Progress::Acting { targets, anchors } = progress else { continue };
            let state = command.action.body().and_then(|body| rest.states.get(&body));
            let nodes = state.map_or(0, |state| state.x.len());
            let pinned = if let Action::Pin { .. } = command.action { targets.len() } else { 0 };
            if targets.iter().any(|(node, _)| *node as usize >= nodes) || anchors.len() != pinned {
                return refuse(SnapshotFault::CommandHolds {});
            }
        }
        Ok(())
    }

    /// The commands with the progress that they have in the snapshot, as far as the snapshot contains it. Commands of the program follow the commands
    /// of the scene.
    fn commands_then(&self, commands: &[Running<D>], rest: &Rest<D>) -> Vec<Running<D>> {
        let running = |(known, progress): (&Running<D>, &Progress<D>)| {
            // Bodies that will be added later do not count as gone.
            let is_gone = |body: usize| rest.alive.get(body) == Some(&false) && self.slots.origin[body].is_taken();
            let gone = known.command.action.body().is_some_and(is_gone);
            let progress = if gone && *progress == Progress::Waiting { Progress::Done } else { progress.clone() };
            Running { progress, ..known.anew() }
        };
        commands.iter().zip(&rest.progress).map(running).chain(rest.given.iter().cloned()).collect()
    }

    /// Restores a snapshot that differs only in motion; the islands are kept. Returns false if anything else differs.
    fn go_to_alike(&mut self, bytes: &[u8], commands: &[Running<D>], other_future: bool) -> Result<bool, WorldError> {
        let mut reader = Reader(bytes);
        let Head { version, frames, delta } = Self::read_head(&mut reader)?;
        let mut here = Vec::new();
        self.write_delta(&mut Writer(&mut here));
        if delta != here {
            return Ok(false);
        }
        let rest = self.read_rest(&mut reader, version, commands, other_future)?;
        let fits = |number: &usize| {
            let (island, lane) = self.locations[*number];
            let (state, system) = (&rest.states[number], &self.islands[island].system);
            let mut models = state.memory.iter().zip(&system.members);
            let alike = models.all(|(kept, member)| kept.len() == member.memory.iter().skip(lane).step_by(WIDTH).len());
            alike && state.history.fits(system)
        };
        if rest.alive != self.slots.alive || self.islands.is_empty() || !rest.states.keys().all(fits) {
            return Ok(false);
        }
        let running = self.commands_then(commands, &rest);
        let alike = |(a, b): (&Running<D>, &Running<D>)| a.command == b.command && a.progress == b.progress;
        if running.len() != self.running.len() || !running.iter().zip(&self.running).all(alike) {
            return Ok(false);
        }
        self.slots.next = self.slots.next.max(rest.next);
        self.laws_saved = rest.laws;
        self.frames = frames;
        self.looks.fresh = false;
        let time = self.time();
        for island in &mut self.islands {
            let layout = island.system.layout;
            let nodes = island.system.nodes;
            for l in 0..layout.stride() {
                // Unused lanes repeat the first body.
                let body = island.bodies.get(l).unwrap_or(&island.bodies[0]);
                let state = &rest.states[body];
                for node in 0..nodes {
                    let index = layout.index(node, l);
                    island.system.state.x.set(index, state.x[node]);
                    island.system.state.v.set(index, state.v[node]);
                }
                state.history.restore(&mut island.system, l);
                for (member, kept) in island.system.members.iter_mut().zip(&state.memory) {
                    member.memory.iter_mut().skip(l).step_by(WIDTH).zip(kept).for_each(|(to, from)| *to = *from);
                }
            }
            let first = &rest.states[&island.bodies[0]];
            for index in nodes * layout.stride()..layout.index_count(nodes) {
                island.system.state.x.set(index, first.x[nodes - 1]);
            }
            island.system.time = time;
            island.outcome = Ok(());
            island.refresh();
        }
        self.limited_pulls.store(rest.flows.limited_pulls, Ordering::Relaxed);
        self.flows = rest.flows;
        self.contact_memory = rest.contact;
        self.refresh_ledger();
        // The largest energy in motion is that of the snapshot. It is not measured again, because the time of a frame and that of its last substep
        // differ by rounding.
        self.flows.largest = rest.flows.largest;
        Ok(true)
    }

    fn go_to(&mut self, bytes: &[u8], commands: &[Running<D>], other_future: bool) -> Result<(), WorldError> {
        let mut reader = Reader(bytes);
        let Head { version, frames, delta } = Self::read_head(&mut reader)?;
        let mut here = Vec::new();
        self.write_delta(&mut Writer(&mut here));
        let changed = delta != here;
        let mut delta = Reader(delta);
        self.take_delta(&mut delta, commands)?;
        if !delta.0.is_empty() {
            return Err(WorldError::snapshot(SnapshotFault::SceneGoesOn {}));
        }
        let rest = self.read_rest(&mut reader, version, commands, other_future)?;
        self.running = self.commands_then(commands, &rest);
        self.slots.alive = rest.alive;
        self.slots.next = self.slots.next.max(rest.next);
        self.frames = frames;
        self.looks.fresh = false;
        self.regroup(&Touched::All, &rest.states)?;
        if changed {
            self.check_stability()?;
        }
        // Bodies of the scene return when a command adds them, and keep their laws.
        let slots = &self.slots;
        self.user_forces.retain(|(handle, _)| handle.is_of_scene() || slots.is_of(*handle));
        self.laws_saved = rest.laws;
        self.limited_pulls.store(rest.flows.limited_pulls, Ordering::Relaxed);
        self.flows = rest.flows;
        self.contact_memory = rest.contact;
        self.refresh_ledger();
        // The largest energy in motion is that of the snapshot. It is not measured again, because the time of a frame and that of its last substep
        // differ by rounding.
        self.flows.largest = rest.flows.largest;
        Ok(())
    }
}

/// The part of a snapshot before its bodies.
struct Head<'b> {
    version: u64,
    frames: u64,
    /// The differences between the scene and the scene at the start.
    delta: &'b [u8],
}

/// The part of a snapshot after its head.
#[derive(Debug, Default)]
struct Rest<const D: usize> {
    alive: Vec<bool>,
    states: BTreeMap<usize, BodyState<D>>,
    progress: Vec<Progress<D>>,
    /// Commands of the program that were not finished.
    given: Vec<Running<D>>,
    /// The generation of the next body of the program.
    next: u64,
    /// The number of force laws of the program on each body.
    laws: BTreeMap<usize, u64>,
    flows: Flows,
    /// The state of contact.
    contact: ContactMemory<D>,
}

fn write_progress<const D: usize>(out: &mut Writer<'_>, progress: &Progress<D>) {
    match progress {
        Progress::Waiting => out.count(0),
        Progress::Done => out.count(1),
        Progress::Acting { targets, anchors } => {
            out.count(2);
            out.count(targets.len() as u64);
            for (node, share) in targets {
                out.count(u64::from(*node));
                out.number(*share);
            }
            out.vectors(anchors);
        }
    }
}

fn read_progress<const D: usize>(reader: &mut Reader<'_>) -> Result<Progress<D>, WorldError> {
    Ok(match reader.count()? {
        0 => Progress::Waiting,
        1 => Progress::Done,
        2 => {
            let n = reader.length()?;
            let targets = (0..n)
                .map(|_| Ok((reader.count()? as u32, reader.number()?)))
                .collect::<Result<Vec<_>, WorldError>>()?;
            Progress::Acting { targets, anchors: reader.vectors::<D>()? }
        }
        _ => return Err(WorldError::snapshot(SnapshotFault::CommandState {})),
    })
}
