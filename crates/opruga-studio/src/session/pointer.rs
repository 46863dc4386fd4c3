//! What the pointer does to bodies: it pulls, pushes and pins.

use super::Session;
use crate::engine::Given;
use crate::said::{Said, Step};
use opruga::WorldError;

/// The force of a push for each metre between the node and the pointer [N/m].
const PUSH_STIFFNESS: f64 = 20.0;

/// What a press of the pointer does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Pull the nearest node by a spring.
    Pull,
    /// Push the nearest node by a force that grows with the way.
    Push,
    /// Pin the nearest node, or take a pinned one elsewhere.
    Pin,
}

/// What the pointer holds.
#[derive(Clone, Debug)]
pub(super) struct Held {
    grip: Grip,
    body: usize,
    node: u32,
    /// Command of the world and of the document; none while a push has no force.
    command: Option<[usize; 2]>,
    pointer: [f64; 3],
    /// Whether the pointer has moved since the last push began.
    moved: bool,
    /// The frame up to which the path is known.
    led: u64,
}

/// A point that a person has pinned.
#[derive(Clone, Debug)]
pub(super) struct Pinned {
    body: usize,
    node: u32,
    command: [usize; 2],
    /// The frame at which it was pinned.
    at: u64,
    /// The frame at which it was let go.
    until: Option<u64>,
}

impl Pinned {
    /// Whether it is held before a frame.
    fn holds(&self, frame: u64) -> bool {
        self.at <= frame && self.until.is_none_or(|until| until > frame)
    }
}

impl Session {
    /// Writes a command down; its number in the document.
    pub(super) fn write(&mut self, given: Given) -> [usize; 2] {
        [given.number, self.document.push_command(given.table)]
    }

    pub(super) fn grab(&mut self, grip: Grip, body: usize, point: [f64; 3], beside: bool) -> Result<(), Said> {
        self.release();
        self.branch()?;
        let engine = &self.engine;
        let node = if beside { engine.nearest_beside(body, point) } else { engine.nearest(body, point) };
        let node = node.ok_or_else(|| Said::NoBody(body.to_string()))?;
        let now = self.engine.frames();
        let mut held = Held { grip, body, node, command: None, pointer: point, moved: false, led: now + 1 };
        match grip {
            Grip::Pull => {
                let given = self.engine.pull(body, node, point)?;
                held.command = Some(self.write(given));
            }
            Grip::Push => {}
            Grip::Pin => {
                if self.pinned(body, node).is_some() {
                    // A pinned point goes with the pointer and is pinned where that lets go.
                    self.unpin(body, node)?;
                    let given = self.engine.pull(body, node, point)?;
                    held.command = Some(self.write(given));
                } else {
                    self.pin(body, node)?;
                    return Ok(());
                }
            }
        }
        self.held = Some(held);
        Ok(())
    }

    fn pin(&mut self, body: usize, node: u32) -> Result<(), WorldError> {
        let given = self.engine.pin(body, node)?;
        let command = self.write(given);
        self.pins.push(Pinned { body, node, command, at: self.engine.frames(), until: None });
        Ok(())
    }

    /// The pin that holds a node now.
    fn pinned(&self, body: usize, node: u32) -> Option<usize> {
        let now = self.engine.frames();
        self.pins.iter().position(|pin| (pin.body, pin.node) == (body, node) && pin.holds(now))
    }

    /// Frees a node that a person or the scene has pinned.
    pub(super) fn let_go(&mut self, body: usize, node: u32) -> Result<(), Said> {
        self.branch()?;
        let past = self.past(Step::Unpin);
        self.unpin(body, node).map_err(Said::World)?;
        self.remember(past);
        Ok(())
    }

    fn unpin(&mut self, body: usize, node: u32) -> Result<(), WorldError> {
        if let Some(place) = self.pinned(body, node) {
            self.end(self.pins[place].command)?;
            self.pins[place].until = Some(self.engine.frames());
        } else {
            // A pin of the scene itself.
            let given = self.engine.free(body, node)?;
            self.write(given);
        }
        Ok(())
    }

    /// The pins of a future that is cut off: those that are held now stay.
    pub(super) fn cut_pins(&mut self) {
        let now = self.engine.frames();
        self.pins.retain(|pin| pin.at < now);
        for pin in &mut self.pins {
            pin.until = pin.until.filter(|until| *until < now);
        }
    }

    fn end(&mut self, [number, written]: [usize; 2]) -> Result<(), WorldError> {
        let until = self.engine.finish(number)?;
        self.document.end_command(written, until);
        Ok(())
    }

    pub(super) fn lead(&mut self, point: [f64; 3]) {
        if let Some(held) = &mut self.held
            && point.iter().all(|x| x.is_finite())
        {
            held.moved |= held.pointer != point;
            held.pointer = point;
        }
    }

    /// Before a frame: the path of a pull grows by a row, a push takes its new force.
    pub(super) fn lead_held(&mut self) {
        let Some(mut held) = self.held.take() else { return };
        match (held.grip, held.command) {
            (Grip::Push, command) if held.moved => {
                if let Some(command) = command
                    && let Err(error) = self.end(command)
                {
                    self.refuse(&error, None);
                }
                held.command = self.push_now(&held);
                held.moved = false;
            }
            (Grip::Push, _) => {}
            (_, Some([number, written])) if held.led <= self.engine.frames() + 1 => {
                if let Ok(row) = self.engine.lead(number, held.pointer) {
                    self.document.lead_command(written, &row);
                    held.led = self.engine.frames() + 2;
                }
            }
            _ => {}
        }
        self.held = Some(held);
    }

    /// A force toward the pointer, in proportion to the way.
    fn push_now(&mut self, held: &Held) -> Option<[usize; 2]> {
        let at = self.engine.position(held.body, held.node)?;
        let force = [0, 1, 2].map(|d| PUSH_STIFFNESS * (held.pointer[d] - at[d]));
        let given = self.engine.push(held.body, held.node, force).ok()?;
        Some(self.write(given))
    }

    pub(super) fn release(&mut self) {
        let Some(held) = self.held.take() else { return };
        if let Some(command) = held.command
            && let Err(error) = self.end(command)
        {
            self.refuse(&error, None);
        }
        if held.grip == Grip::Pin
            && let Err(error) = self.pin(held.body, held.node)
        {
            self.refuse(&error, None);
        }
    }

    pub(super) fn pins_shown(&self) -> Vec<(usize, u32, [f64; 3])> {
        let at = |pin: &Pinned| Some((pin.body, pin.node, self.engine.position(pin.body, pin.node)?));
        let now = self.engine.frames();
        self.pins.iter().filter(|pin| pin.holds(now)).filter_map(at).collect()
    }
}
