//! The whole state of a world in bytes, and back.

use crate::build::BodyState;
use crate::changes::{Change, Source, Told};
use crate::commands::Progress;
use crate::error::WorldError;
use crate::ledger::Flows;
use crate::rebuild::Touched;
use crate::world::World;
use opruga_core::spec::Value;
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::WIDTH;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Little-endian numbers, one after the other.
struct Writer<'a>(&'a mut Vec<u8>);

impl Writer<'_> {
    fn count(&mut self, n: u64) {
        self.0.extend(n.to_le_bytes());
    }
    fn number(&mut self, x: f64) {
        self.0.extend(x.to_le_bytes());
    }
    fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.0.extend(text.as_bytes());
    }
    fn numbers(&mut self, numbers: &[f64]) {
        self.count(numbers.len() as u64);
        numbers.iter().for_each(|x| self.number(*x));
    }
    fn value(&mut self, value: &Value) {
        match value {
            Value::Number(x) => {
                self.count(0);
                self.number(*x);
            }
            Value::Integer(n) => {
                self.count(1);
                self.count(*n as u64);
            }
            Value::Boolean(b) => {
                self.count(2);
                self.count(u64::from(*b));
            }
            Value::Text(text) => {
                self.count(3);
                self.text(text);
            }
            Value::Numbers(numbers) => {
                self.count(4);
                self.numbers(numbers);
            }
            Value::Integers(numbers) => {
                self.count(5);
                self.count(numbers.len() as u64);
                numbers.iter().for_each(|n| self.count(u64::from(*n)));
            }
            Value::Rows(rows) => {
                self.count(6);
                self.count(rows.len() as u64);
                rows.iter().for_each(|row| self.numbers(row));
            }
        }
    }
    fn vectors<const D: usize>(&mut self, vectors: &[[f64; D]]) {
        self.count(vectors.len() as u64);
        for x in vectors.iter().flatten() {
            self.number(*x);
        }
    }
    /// The vectors of the nodes of one body; room is made once, for this is most of a snapshot.
    fn columns<const D: usize>(&mut self, columns: &Columns<D>, system: &System<D>, lane: usize) {
        self.count(system.nodes as u64);
        let from = self.0.len();
        self.0.resize(from + system.nodes * D * 8, 0);
        let (bytes, _) = self.0[from..].as_chunks_mut::<8>();
        let (nodes, _) = bytes.as_chunks_mut::<D>();
        for (node, to) in nodes.iter_mut().enumerate() {
            *to = columns.at(system.layout.place(node, lane)).map(f64::to_le_bytes);
        }
    }
}

struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn eight(&mut self) -> Result<[u8; 8], WorldError> {
        let (head, tail) =
            self.0.split_first_chunk::<8>().ok_or_else(|| WorldError::Snapshot("it ends too early".into()))?;
        self.0 = tail;
        Ok(*head)
    }
    fn count(&mut self) -> Result<u64, WorldError> {
        Ok(u64::from_le_bytes(self.eight()?))
    }
    /// A count of things that each take at least eight bytes: never more than there are bytes.
    fn length(&mut self) -> Result<usize, WorldError> {
        let n = self.count()?;
        if n > self.0.len() as u64 / 8 {
            return Err(WorldError::Snapshot(format!("it promises {n} numbers, more than it holds")));
        }
        Ok(n as usize)
    }
    fn number(&mut self) -> Result<f64, WorldError> {
        Ok(f64::from_le_bytes(self.eight()?))
    }
    fn text(&mut self) -> Result<String, WorldError> {
        let n = self.count()?;
        let promised = || WorldError::Snapshot(format!("it promises a text of {n} bytes, more than it holds"));
        let n = usize::try_from(n).map_err(|_| promised())?;
        let (head, tail) = self.0.split_at_checked(n).ok_or_else(promised)?;
        self.0 = tail;
        String::from_utf8(head.to_vec()).map_err(|_| WorldError::Snapshot("a text is no UTF-8".into()))
    }
    fn numbers(&mut self) -> Result<Vec<f64>, WorldError> {
        let n = self.length()?;
        (0..n).map(|_| self.number()).collect()
    }
    fn value(&mut self) -> Result<Value, WorldError> {
        Ok(match self.count()? {
            0 => Value::Number(self.number()?),
            1 => Value::Integer(self.count()? as i64),
            2 => Value::Boolean(self.count()? == 1),
            3 => Value::Text(self.text()?),
            4 => Value::Numbers(self.numbers()?),
            5 => {
                let n = self.length()?;
                Value::Integers((0..n).map(|_| Ok(self.count()? as u32)).collect::<Result<_, WorldError>>()?)
            }
            6 => {
                let n = self.length()?;
                Value::Rows((0..n).map(|_| self.numbers()).collect::<Result<_, _>>()?)
            }
            _ => return Err(WorldError::Snapshot("a value is of an unknown kind".into())),
        })
    }
    fn change(&mut self) -> Result<Told, WorldError> {
        Ok(match self.count()? {
            0 => Told::Set(self.text()?, self.value()?),
            1 => Told::Added(Source::Command(self.count()? as usize)),
            2 => Told::Added(Source::Program(self.count()? as usize)),
            3 => Told::Became(self.count()? as usize),
            _ => return Err(WorldError::Snapshot("a change is of an unknown kind".into())),
        })
    }
    fn vectors<const D: usize>(&mut self) -> Result<Vec<[f64; D]>, WorldError> {
        let n = self.length()?;
        let mut out = Vec::with_capacity(n);
        for _ in 0..n {
            let mut vector = [0.0; D];
            for x in &mut vector {
                *x = self.number()?;
            }
            out.push(vector);
        }
        Ok(out)
    }
}

const VERSION: u64 = 3;

impl<const D: usize> World<D> {
    /// The whole state: time, positions, velocities, what models remember, how far commands have come, the ledger.
    ///
    /// A world built from the same blueprint that restores it goes on bit for bit, on any number of threads.
    pub fn snapshot(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.snapshot_into(&mut out);
        out
    }

    /// Appends the bytes of [`World::snapshot`]: for those who take one every frame.
    pub fn snapshot_into(&self, out: &mut Vec<u8>) {
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
        for x in [f.user, f.gas, f.damping, f.friction, f.contact, f.correction, f.start, f.largest] {
            out.number(x);
        }
        for n in [f.limited_forces, f.limited_velocities, f.limited_pulls, f.lost_bodies, f.open_frames] {
            out.count(n);
        }
    }

    /// Goes to the state of a snapshot of a world with the same blueprint.
    ///
    /// # Errors
    /// [`WorldError::Snapshot`] if the bytes belong to another scene or are damaged; the world stays as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.restored(bytes, false)
    }

    /// Goes to the state of a snapshot of a world whose commands up to then were the same: those that had not begun may
    /// be others, and more or fewer.
    ///
    /// # Errors
    /// As [`World::restore`].
    pub fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.restored(bytes, true)
    }

    fn restored(&mut self, bytes: &[u8], other_future: bool) -> Result<(), WorldError> {
        let kept = (self.blueprint.clone(), self.changes.clone(), self.colliders.clone(), self.running.clone());
        let bodies = (self.alive.clone(), self.generation.clone(), self.frames, self.flows);
        let islands =
            (std::mem::take(&mut self.islands), std::mem::take(&mut self.place), Arc::clone(&self.integrator));
        let outcome = self.go_to(bytes, other_future);
        if outcome.is_err() {
            (self.blueprint, self.changes, self.colliders, self.running) = kept;
            (self.alive, self.generation, self.frames, self.flows) = bodies;
            (self.islands, self.place, self.integrator) = islands;
            self.refresh_ledger();
        }
        outcome
    }

    fn go_to(&mut self, bytes: &[u8], other_future: bool) -> Result<(), WorldError> {
        let refuse = |message: &str| Err(WorldError::Snapshot(message.into()));
        let mut reader = Reader(bytes);
        if reader.count()? != VERSION {
            return refuse("its version is not 3");
        }
        if reader.count()? != D as u64 {
            return refuse("it has another dimension");
        }
        let frames = reader.count()?;
        let changes = reader.length()?;
        let changes: Vec<Told> = (0..changes).map(|_| reader.change()).collect::<Result<_, _>>()?;
        let changed = !changes.is_empty() || !self.changes.is_empty();
        self.replay(changes)?;
        if reader.count()? != self.blueprint.bodies.len() as u64 {
            return refuse("it has another number of bodies");
        }
        let mut states = BTreeMap::new();
        let mut alive = Vec::new();
        for (number, body) in self.blueprint.bodies.iter().enumerate() {
            alive.push(reader.count()? == 1);
            if !alive[number] {
                continue;
            }
            let x = reader.vectors::<D>()?;
            let v = reader.vectors::<D>()?;
            let models = reader.length()?;
            let mut memory = Vec::new();
            for _ in 0..models {
                let n = reader.length()?;
                memory.push((0..n).map(|_| reader.number()).collect::<Result<Vec<f64>, _>>()?);
            }
            if x.len() != body.mesh.positions.len() || v.len() != x.len() || models != body.models.len() {
                return refuse(&format!("body `{}` has another shape", body.name));
            }
            if x.iter().chain(&v).flatten().any(|c| !c.is_finite()) {
                return refuse(&format!("body `{}` has a number that is not finite", body.name));
            }
            states.insert(number, BodyState { x, v, memory });
        }
        let commands = reader.length()?;
        if commands != self.running.len() && !other_future {
            return refuse("it has another number of commands");
        }
        let mut progress = Vec::new();
        for _ in 0..commands {
            progress.push(match reader.count()? {
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
        // Commands stand in the order of time: those that have begun come first.
        if progress.iter().skip(self.running.len()).any(|progress| *progress != Progress::Waiting) {
            return refuse("it has another number of commands");
        }
        progress.resize(self.running.len(), Progress::Waiting);
        let mut numbers = [0.0; 8];
        for x in &mut numbers {
            *x = reader.number()?;
        }
        let mut counts = [0; 5];
        for n in &mut counts {
            *n = reader.count()?;
        }
        if !reader.0.is_empty() {
            return refuse("it goes on after its end");
        }
        self.alive = alive;
        self.generation.resize(self.alive.len(), 0);
        self.frames = frames;
        for (running, progress) in self.running.iter_mut().zip(progress) {
            let gone = running.command.action.body().is_some_and(|b| self.alive.get(b) == Some(&false));
            running.progress = if gone && progress == Progress::Waiting { Progress::Done } else { progress };
        }
        self.regroup(&Touched::All, &states)?;
        if changed {
            self.check_stability()?;
        }
        let [user, gas, damping, friction, contact, correction, start, largest] = numbers;
        let [limited_forces, limited_velocities, limited_pulls, lost_bodies, open_frames] = counts;
        self.limited_pulls.store(limited_pulls, Ordering::Relaxed);
        self.flows = Flows {
            user,
            gas,
            damping,
            friction,
            contact,
            correction,
            start,
            largest,
            limited_forces,
            limited_velocities,
            limited_pulls,
            lost_bodies,
            open_frames,
        };
        self.refresh_ledger();
        Ok(())
    }
}
