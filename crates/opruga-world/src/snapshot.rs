//! The whole state of a world in bytes, and back.

use crate::blueprint::CommandBlueprint;
use crate::bytes::{Reader, Writer};
use crate::carried::BodyState;
use crate::changes::{Change, Source, Told};
use crate::commands::{Progress, Running};
use crate::error::WorldError;
use crate::ledger::Flows;
use crate::rebuild::Touched;
use crate::world::World;
use opruga_core::system::SolverWork;
use opruga_math::WIDTH;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

const VERSION: u64 = 7;

impl<const D: usize> World<D> {
    /// The whole state: time, positions, velocities, what models remember, how far commands have come, the ledger.
    ///
    /// A world built from the same blueprint that restores it goes on bit for bit, on any number of threads.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.snapshot_into(&mut out);
        out
    }

    pub(crate) fn snapshot_into_here(&self, out: &mut Vec<u8>) {
        let mut out = Writer(out);
        out.count(VERSION);
        out.count(D as u64);
        out.count(self.frames);
        out.count(self.changes.len() as u64);
        for change in &self.changes {
            match change {
                Change::Set { path, value, .. } => {
                    out.count(0);
                    out.text(path);
                    out.value(value);
                }
                Change::Added(Source::Command(number)) => {
                    out.count(1);
                    out.count(*number as u64);
                }
                Change::Added(Source::Program(number)) => {
                    out.count(2);
                    out.count(*number as u64);
                }
                Change::Became { command, .. } => {
                    out.count(3);
                    out.count(*command as u64);
                }
            }
        }
        out.count(self.alive.len() as u64);
        for (body, alive) in self.alive.iter().enumerate() {
            out.count(u64::from(*alive));
            if !alive {
                continue;
            }
            let (island, lane) = self.place[body];
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
            out.text(system.history.owner);
            out.count(system.history.columns.len() as u64);
            system.history.columns.iter().for_each(|columns| out.columns(columns, system, lane));
            out.numbers(&system.history.numbers);
        }
        out.count(self.running.len() as u64);
        for running in &self.running {
            match &running.progress {
                Progress::Waiting => out.count(0),
                // It ended before it began, with its body: that follows from what is there.
                Progress::Done if running.command.at > self.time() => out.count(0),
                Progress::Done => out.count(1),
                Progress::Acting { held, anchors } => {
                    out.count(2);
                    out.count(held.len() as u64);
                    for (node, share) in held {
                        out.count(u64::from(*node));
                        out.number(*share);
                    }
                    out.vectors(anchors);
                }
            }
        }
        let f = &self.flows;
        for x in [f.user, f.gas, f.damping, f.friction, f.contact, f.correction, f.start, f.changed, f.largest] {
            out.number(x);
        }
        for n in [f.limited_forces, f.limited_velocities, f.limited_pulls, f.lost_bodies, f.open_frames] {
            out.count(n);
        }
        let s = &f.solver;
        let counts =
            [s.steps, s.iterations, s.linear_iterations, s.accepted, s.halved, s.deepest, s.cut_off, s.disturbed];
        for n in counts.into_iter().chain([s.odd_rests, s.blurred]) {
            out.count(n);
        }
        out.number(s.residual);
        out.number(s.left);
        out.number(s.blur);
    }

    pub(crate) fn restore_here(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        let commands = self.running.iter().map(Running::anew).collect();
        self.restored(bytes, commands, false)
    }

    /// Goes to the state of a snapshot of a world with the same blueprint to which a program had given these commands, or
    /// the first of them.
    ///
    /// # Errors
    /// As [`World::restore`].
    pub fn restore_with(&mut self, bytes: &[u8], given: &[CommandBlueprint<D>]) -> Result<(), WorldError> {
        self.restore_given(bytes, given.to_vec())
    }

    pub(crate) fn restore_given_here(
        &mut self,
        bytes: &[u8],
        given: Vec<CommandBlueprint<D>>,
    ) -> Result<(), WorldError> {
        let commands = self.blueprint.commands.iter().cloned().chain(given).map(Running::waiting).collect();
        self.restored(bytes, commands, false)
    }

    pub(crate) fn rewind_here(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        let commands = self.running.iter().map(Running::anew).collect();
        self.restored(bytes, commands, true)
    }

    fn restored(&mut self, bytes: &[u8], commands: Vec<Running<D>>, other_future: bool) -> Result<(), WorldError> {
        if self.go_to_alike(bytes, &commands, other_future)? {
            return Ok(());
        }
        let kept = (self.blueprint.clone(), self.changes.clone(), self.colliders.clone(), self.running.clone());
        let bodies = (self.alive.clone(), self.generation.clone(), self.frames, self.flows);
        let islands =
            (std::mem::take(&mut self.islands), std::mem::take(&mut self.place), Arc::clone(&self.integrator));
        let outcome = self.go_to(bytes, &commands, other_future);
        if outcome.is_err() {
            (self.blueprint, self.changes, self.colliders, self.running) = kept;
            (self.alive, self.generation, self.frames, self.flows) = bodies;
            (self.islands, self.place, self.integrator) = islands;
            self.refresh_ledger();
        }
        outcome
    }

    /// What a snapshot says before its bodies: frames, and what had changed in the scene.
    fn read_head(reader: &mut Reader<'_>) -> Result<(u64, Vec<Told>), WorldError> {
        let refuse = |message: &str| Err(WorldError::Snapshot(message.into()));
        if reader.count()? != VERSION {
            return refuse(&format!("its version is not {VERSION}"));
        }
        if reader.count()? != D as u64 {
            return refuse("it has another dimension");
        }
        let frames = reader.count()?;
        let changes = reader.length()?;
        Ok((frames, (0..changes).map(|_| reader.change()).collect::<Result<_, _>>()?))
    }

    /// What a snapshot says of the bodies of the blueprint, the commands, and the ledger; those are known, and
    /// with another future those that had not begun may be others.
    fn read_rest(
        &self,
        reader: &mut Reader<'_>,
        commands: &[Running<D>],
        other_future: bool,
    ) -> Result<Rest<D>, WorldError> {
        let refuse = |message: &str| Err(WorldError::Snapshot(message.into()));
        if reader.count()? != self.blueprint.bodies.len() as u64 {
            return refuse("it has another number of bodies");
        }
        let mut rest = Rest::default();
        for (number, body) in self.blueprint.bodies.iter().enumerate() {
            rest.alive.push(reader.count()? == 1);
            if !rest.alive[number] {
                continue;
            }
            let x = reader.vectors::<D>()?;
            let v = reader.vectors::<D>()?;
            let models = reader.length()?;
            let mut memory = Vec::new();
            for _ in 0..models {
                memory.push(reader.numbers()?);
            }
            if x.len() != body.mesh.positions.len() || v.len() != x.len() || models != body.models.len() {
                return refuse(&format!("body `{}` has another shape", body.name));
            }
            if x.iter().chain(&v).flatten().any(|c| !c.is_finite()) {
                return refuse(&format!("body `{}` has a number that is not finite", body.name));
            }
            let history = reader.history()?;
            if history.columns.iter().any(|column| column.len() != x.len()) {
                return refuse(&format!("body `{}` has another shape", body.name));
            }
            rest.states.insert(number, BodyState { x, v, memory, history });
        }
        let count = reader.length()?;
        // Commands of a program may have come later, where they stand behind those of the scene and not among them.
        let acted = commands.iter().any(|known| known.acted);
        let least = if acted { commands.len() } else { self.blueprint.commands.len() };
        if !other_future && !(least..=commands.len()).contains(&count) {
            return refuse("it has another number of commands");
        }
        for _ in 0..count {
            rest.progress.push(match reader.count()? {
                0 => Progress::Waiting,
                1 => Progress::Done,
                2 => {
                    let n = reader.length()?;
                    let held =
                        (0..n)
                            .map(|_| Ok((reader.count()? as u32, reader.number()?)))
                            .collect::<Result<Vec<_>, WorldError>>()?;
                    Progress::Acting { held, anchors: reader.vectors::<D>()? }
                }
                _ => return refuse("a command is in an unknown state"),
            });
        }
        if other_future {
            // Commands stand in the order of time: those that have begun come first.
            if rest.progress.iter().skip(commands.len()).any(|progress| *progress != Progress::Waiting) {
                return refuse("it has another number of commands");
            }
            rest.progress.resize(commands.len(), Progress::Waiting);
        }
        let mut numbers = [0.0; 9];
        for x in &mut numbers {
            *x = reader.number()?;
        }
        let mut counts = [0; 5];
        for n in &mut counts {
            *n = reader.count()?;
        }
        let mut solver = [0; 10];
        for n in &mut solver {
            *n = reader.count()?;
        }
        let (residual, left, blur) = (reader.number()?, reader.number()?, reader.number()?);
        if !reader.0.is_empty() {
            return refuse("it goes on after its end");
        }
        let [user, gas, damping, friction, contact, correction, start, changed, largest] = numbers;
        let [limited_forces, limited_velocities, limited_pulls, lost_bodies, open_frames] = counts;
        let [steps, iterations, linear_iterations, accepted, halved, deepest, cut_off, disturbed, odd_rests, blurred] =
            solver;
        rest.flows = Flows {
            user,
            gas,
            damping,
            friction,
            contact,
            correction,
            start,
            changed,
            largest,
            limited_forces,
            limited_velocities,
            limited_pulls,
            lost_bodies,
            open_frames,
            solver: SolverWork {
                steps,
                iterations,
                linear_iterations,
                residual,
                accepted,
                halved,
                deepest,
                cut_off,
                left,
                disturbed,
                odd_rests,
                blurred,
                blur,
            },
        };
        Ok(rest)
    }

    /// Commands with how far they had come, as far as that is known.
    fn commands_then(commands: &[Running<D>], rest: &Rest<D>) -> Vec<Running<D>> {
        let running = |(known, progress): (&Running<D>, &Progress<D>)| {
            let gone = known.command.action.body().is_some_and(|body| rest.alive.get(body) == Some(&false));
            let progress = if gone && *progress == Progress::Waiting { Progress::Done } else { progress.clone() };
            Running { progress, ..known.anew() }
        };
        commands.iter().zip(&rest.progress).map(running).collect()
    }

    /// Goes to a snapshot that differs in motion alone: the islands stay as they are. False where more differs.
    fn go_to_alike(&mut self, bytes: &[u8], commands: &[Running<D>], other_future: bool) -> Result<bool, WorldError> {
        let mut reader = Reader(bytes);
        let (frames, changes) = Self::read_head(&mut reader)?;
        if changes != self.changes.iter().map(Change::told).collect::<Vec<_>>() {
            return Ok(false);
        }
        let rest = self.read_rest(&mut reader, commands, other_future)?;
        let fits = |number: &usize| {
            let (island, lane) = self.place[*number];
            let (state, system) = (&rest.states[number], &self.islands[island].system);
            let mut models = state.memory.iter().zip(&system.members);
            let alike = models.all(|(kept, member)| kept.len() == member.memory.iter().skip(lane).step_by(WIDTH).len());
            alike && state.history.fits(system)
        };
        if rest.alive != self.alive || self.islands.is_empty() || !rest.states.keys().all(fits) {
            return Ok(false);
        }
        let running = Self::commands_then(commands, &rest);
        let alike = |(a, b): (&Running<D>, &Running<D>)| a.command == b.command && a.progress == b.progress;
        if running.len() != self.running.len() || !running.iter().zip(&self.running).all(alike) {
            return Ok(false);
        }
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
                    let place = layout.place(node, l);
                    island.system.state.x.set(place, state.x[node]);
                    island.system.state.v.set(place, state.v[node]);
                }
                state.history.restore(&mut island.system, l);
                for (member, kept) in island.system.members.iter_mut().zip(&state.memory) {
                    member.memory.iter_mut().skip(l).step_by(WIDTH).zip(kept).for_each(|(to, from)| *to = *from);
                }
            }
            let first = &rest.states[&island.bodies[0]];
            for place in nodes * layout.stride()..layout.places(nodes) {
                island.system.state.x.set(place, first.x[nodes - 1]);
            }
            island.system.time = time;
            island.outcome = Ok(());
            island.refresh();
        }
        self.limited_pulls.store(rest.flows.limited_pulls, Ordering::Relaxed);
        self.flows = rest.flows;
        self.refresh_ledger();
        // What is in motion now is not measured again: the time of a frame and of its last substep differ by rounding.
        self.flows.largest = rest.flows.largest;
        Ok(true)
    }

    fn go_to(&mut self, bytes: &[u8], commands: &[Running<D>], other_future: bool) -> Result<(), WorldError> {
        let mut reader = Reader(bytes);
        let (frames, changes) = Self::read_head(&mut reader)?;
        let changed = !changes.is_empty() || !self.changes.is_empty();
        // Bodies that commands add are found by the numbers of those.
        self.running = commands.iter().map(Running::anew).collect();
        self.replay(changes)?;
        let rest = self.read_rest(&mut reader, commands, other_future)?;
        self.running = Self::commands_then(commands, &rest);
        self.alive = rest.alive;
        self.generation.resize(self.alive.len(), 0);
        self.frames = frames;
        self.looks.fresh = false;
        self.regroup(&Touched::All, &rest.states)?;
        if changed {
            self.check_stability()?;
        }
        self.limited_pulls.store(rest.flows.limited_pulls, Ordering::Relaxed);
        self.flows = rest.flows;
        self.refresh_ledger();
        // What is in motion now is not measured again: the time of a frame and of its last substep differ by rounding.
        self.flows.largest = rest.flows.largest;
        Ok(())
    }
}

/// What a snapshot says behind its head.
#[derive(Debug, Default)]
struct Rest<const D: usize> {
    alive: Vec<bool>,
    states: BTreeMap<usize, BodyState<D>>,
    progress: Vec<Progress<D>>,
    flows: Flows,
}
