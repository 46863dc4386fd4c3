//! The actions of the pointer on bodies: pulling, pushing and pinning.

use super::Session;
use crate::document::Document;
use crate::engine::Given;
use crate::report::{Report, Step};
use crate::shown::Severity;
use opruga::WorldError;

/// The stiffness of a push [N/m]: its force for each metre between the pointer and the point of the press.
const PUSH_STIFFNESS: f64 = 20.0;

/// The action of a press of the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// Pull the nearest node with a spring.
    Pull,
    /// Push the nearest node with a force proportional to the displacement of the pointer from the point of the press.
    Push,
    /// Pin the nearest node, or move a pinned node.
    Pin,
}

/// The node that the pointer holds, and the action on it.
#[derive(Clone, Debug)]
pub(super) struct Grabbed {
    grip: Grip,
    body: usize,
    node: u32,
    /// The numbers of the command in the world and in the document; none while a push has no force.
    command: Option<[usize; 2]>,
    /// The frame at which that command began.
    since: u64,
    /// The point of the body that was pressed [m].
    pressed: [f64; 3],
    pointer: [f64; 3],
    /// Whether the pointer has moved since the present force of the push was set.
    moved: bool,
    /// Whether a push has acted since the press.
    has_pushed: bool,
    /// The frame up to which the path is known.
    led: u64,
}

impl Grabbed {
    /// The force of a push [N]. The force depends only on the pointer, and not on the motion of the node.
    fn force(&self) -> [f64; 3] {
        [0, 1, 2].map(|d| PUSH_STIFFNESS * (self.pointer[d] - self.pressed[d]))
    }
}

/// A pull that has ended. The world removes the pull in its next frame, but the pull is no longer displayed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Released {
    body: usize,
    node: u32,
    /// The frame at which the pull was released, and the last frame in which it acts.
    at: [u64; 2],
}

/// A point that the user has pinned.
#[derive(Clone, Debug)]
pub(super) struct Pinned {
    body: usize,
    node: u32,
    command: [usize; 2],
    /// The frame at which the point was pinned.
    at: u64,
    /// The frame at which the point was unpinned.
    until: Option<u64>,
}

impl Pinned {
    /// Whether the point is pinned at the start of a frame.
    fn holds(&self, frame: u64) -> bool {
        self.at <= frame && self.until.is_none_or(|until| until > frame)
    }
}

impl Session {
    /// Adds a command to the document. Returns the numbers of the command in the world and in the document.
    pub(super) fn write(&mut self, given: Given) -> [usize; 2] {
        [given.number, self.document.push_command(given.table)]
    }

    pub(super) fn grab(&mut self, grip: Grip, body: usize, point: [f64; 3], beside: bool) -> Result<(), Report> {
        self.release();
        self.branch()?;
        let engine = &self.engine;
        let node = if beside { engine.nearest_beside(body, point) } else { engine.nearest(body, point) };
        let node = node.ok_or_else(|| Report::NoBody(body.to_string()))?;
        let now = self.engine.frames();
        let mut grabbed = Grabbed {
            grip,
            body,
            node,
            command: None,
            since: now,
            pressed: point,
            pointer: point,
            moved: false,
            has_pushed: false,
            led: now + 1,
        };
        match grip {
            Grip::Pull => {
                let past = self.past(Step::Pull);
                self.take_over(body)?;
                match self.engine.pull(body, node, point) {
                    Ok(given) => grabbed.command = Some(self.write(given)),
                    Err(error) => {
                        self.back_to(past)?;
                        return Err(Report::World(error));
                    }
                }
                self.remember(past);
            }
            // A push begins when the pointer moves.
            Grip::Push => {}
            Grip::Pin => {
                let past = self.past(Step::Pin);
                if self.pinned(body, node).is_none() {
                    self.pin(body, node)?;
                    self.remember(past);
                    return Ok(());
                }
                // A pinned point moves with the pointer, and is pinned again where the pointer is released.
                self.take_over(body)?;
                self.unpin(body, node)?;
                let given = self.engine.pull(body, node, point)?;
                grabbed.command = Some(self.write(given));
                self.remember(past);
            }
        }
        self.grabbed = Some(grabbed);
        Ok(())
    }

    /// Returns the document as it would be after the pointer is released. Without this, the node that the pointer holds would be held for ever.
    pub(super) fn let_go_of_all(&self) -> Document {
        let mut document = self.document.clone();
        if let Some((grabbed, [_, written])) =
            self.grabbed.as_ref().and_then(|grabbed| Some((grabbed, grabbed.command?)))
        {
            let now = self.engine.frames();
            // A command that has just begun acts for one frame.
            let until = if grabbed.since < now { self.engine.time() } else { self.time_of(now + 1) };
            document.end_command(written, until);
        }
        document
    }

    fn pin(&mut self, body: usize, node: u32) -> Result<(), WorldError> {
        let given = self.engine.pin(body, node)?;
        let command = self.write(given);
        self.pins.push(Pinned { body, node, command, at: self.engine.frames(), until: None });
        Ok(())
    }

    /// The index of the pin that holds a node now, if the user has set one.
    fn pinned(&self, body: usize, node: u32) -> Option<usize> {
        let now = self.engine.frames();
        self.pins.iter().position(|pin| (pin.body, pin.node) == (body, node) && pin.holds(now))
    }

    /// Unpins a node that the user or the scene has pinned.
    pub(super) fn let_go(&mut self, body: usize, node: u32) -> Result<(), Report> {
        // The second press of a double click has grabbed the node, so it is released first.
        self.release();
        self.branch()?;
        let past = self.past(Step::Unpin);
        self.unpin(body, node).map_err(Report::World)?;
        self.remember(past);
        Ok(())
    }

    fn unpin(&mut self, body: usize, node: u32) -> Result<(), WorldError> {
        if let Some(index) = self.pinned(body, node) {
            self.end(self.pins[index].command)?;
            self.pins[index].until = Some(self.engine.frames());
        } else {
            // A pin of the scene itself.
            let given = self.engine.free(body, node)?;
            self.write(given);
        }
        Ok(())
    }

    /// Drops the pins that belong to a future that is dropped. Points that are pinned now stay pinned.
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
        if let Some(grabbed) = &mut self.grabbed
            && point.iter().all(|x| x.is_finite())
        {
            grabbed.moved |= grabbed.pointer != point;
            grabbed.pointer = point;
        }
    }

    /// Prepares a frame: extends the path of a pull by a row, or updates the force of a push.
    pub(super) fn lead_grabbed(&mut self) {
        let Some(mut grabbed) = self.grabbed.take() else { return };
        match (grabbed.grip, grabbed.command) {
            (Grip::Push, command) if grabbed.moved => {
                if let Some(command) = command
                    && let Err(error) = self.end(command)
                {
                    self.refuse(&error, None);
                }
                self.begin_to_push(&mut grabbed);
                (grabbed.since, grabbed.moved) = (self.engine.frames(), false);
            }
            (Grip::Push, _) => {}
            (_, Some([number, written])) if grabbed.led <= self.engine.frames() + 1 => {
                if let Ok(row) = self.engine.lead(number, grabbed.pointer) {
                    self.document.lead_command(written, &row);
                    grabbed.led = self.engine.frames() + 2;
                }
            }
            _ => {}
        }
        self.grabbed = Some(grabbed);
    }

    /// Updates the force of a push. The first force after the press is a step that can be undone.
    fn begin_to_push(&mut self, grabbed: &mut Grabbed) {
        let first = (!grabbed.has_pushed && grabbed.force() != [0.0; 3]).then(|| self.past(Step::Push));
        if first.is_some()
            && let Err(report) = self.take_over(grabbed.body)
        {
            self.report(Severity::Refused, report, None);
        }
        grabbed.command = self.push_now(grabbed);
        if let Some(past) = first.filter(|_| grabbed.command.is_some()) {
            grabbed.has_pushed = true;
            self.remember(past);
        }
    }

    /// Ends the drags that the scene itself applies to a body, because the user has grabbed the body. The ended drags do not resume, but a reset
    /// restores them.
    fn take_over(&mut self, body: usize) -> Result<(), Report> {
        let Some(name) = self.engine.name(body) else { return Ok(()) };
        let times = [self.engine.time(), self.time_of(self.engine.frames() + 1)];
        let mut document = self.document.clone();
        let Some(gone) = document.take_over(self.own_commands, &name, times) else { return Ok(()) };
        self.go_on_with(document, gone)
    }

    /// Removes later actions of the scene on a body that is removed now.
    pub(super) fn forget_later(&mut self, name: &str) -> Result<(), Report> {
        let mut document = self.document.clone();
        match document.forget_later(self.own_commands, name, self.engine.time()) {
            0 => Ok(()),
            gone => self.go_on_with(document, gone),
        }
    }

    /// Continues from here with a document from which `gone` commands of the scene itself were removed.
    fn go_on_with(&mut self, document: Document, gone: usize) -> Result<(), Report> {
        let mut engine = self.build(&document)?;
        engine.rewind(&self.engine.snapshot()).map_err(Report::World)?;
        (self.document, self.engine) = (document, engine);
        // Recorded commands follow those of the scene.
        self.own_commands -= gone;
        for pin in &mut self.pins {
            pin.command[1] -= gone;
        }
        Ok(())
    }

    /// Begins a push with the present force. Returns the two numbers of the command of the push; none if the pointer is back at the point of the
    /// press.
    fn push_now(&mut self, grabbed: &Grabbed) -> Option<[usize; 2]> {
        let force = grabbed.force();
        if force == [0.0; 3] {
            return None;
        }
        let given = self.engine.push(grabbed.body, grabbed.node, force).ok()?;
        Some(self.write(given))
    }

    pub(super) fn release(&mut self) {
        let Some(grabbed) = self.grabbed.take() else { return };
        let now = self.engine.frames();
        if grabbed.grip != Grip::Push {
            self.released.retain(|other| other.at[1] >= now);
            self.released.push(Released {
                body: grabbed.body,
                node: grabbed.node,
                at: [now, now.max(grabbed.since + 1)],
            });
        }
        if let Some(command) = grabbed.command
            && let Err(error) = self.end(command)
        {
            self.refuse(&error, None);
        }
        if grabbed.grip == Grip::Pin
            && let Err(error) = self.pin(grabbed.body, grabbed.node)
        {
            self.refuse(&error, None);
        }
    }

    /// Changes the displayed pulls to the present action of the pointer, which the world receives only in its next frame. While time is stopped, a
    /// pull follows the pointer. A released pull is not shown. `position_of` returns the position of a node in the scene to which these pulls belong.
    pub(super) fn show_hand(
        &self,
        pulls: &mut Vec<[[f64; 3]; 3]>,
        position_of: &dyn Fn(usize, u32) -> Option<[f64; 3]>,
    ) {
        let now = self.engine.frames();
        for over in self.released.iter().filter(|over| (over.at[0]..=over.at[1]).contains(&now)) {
            let position = position_of(over.body, over.node);
            // If the same node was grabbed again, its new pull is later in the list than the one that has ended.
            if let Some(first) = pulls.iter().position(|[node, ..]| Some(*node) == position) {
                pulls.remove(first);
            }
        }
        let grabbed = self.grabbed.as_ref().filter(|grabbed| grabbed.grip != Grip::Push && !self.is_moving());
        let Some((grabbed, [stiffness, most])) =
            grabbed.and_then(|grabbed| Some((grabbed, self.engine.usual_pull(grabbed.body)?)))
        else {
            return;
        };
        let position = position_of(grabbed.body, grabbed.node);
        let Some([_, pointer, force]) = pulls.iter_mut().rfind(|[node, ..]| Some(*node) == position) else { return };
        let stretched = [0, 1, 2].map(|d| force[d] + stiffness * (grabbed.pointer[d] - pointer[d]));
        let share = (most / stretched.iter().map(|f| f * f).sum::<f64>().sqrt()).min(1.0);
        (*pointer, *force) = (grabbed.pointer, stretched.map(|f| share * f));
    }

    /// The push of the pointer: the position of its node [m], the end of its arrow [m], and its force [N].
    pub(super) fn push_shown(&self, position_of: &dyn Fn(usize, u32) -> Option<[f64; 3]>) -> Option<[[f64; 3]; 3]> {
        let grabbed =
            self.grabbed.as_ref().filter(|grabbed| grabbed.grip == Grip::Push && grabbed.pointer != grabbed.pressed)?;
        let node = position_of(grabbed.body, grabbed.node)?;
        Some([node, [0, 1, 2].map(|d| node[d] + grabbed.pointer[d] - grabbed.pressed[d]), grabbed.force()])
    }

    pub(super) fn pins_shown(&self) -> Vec<(usize, u32, [f64; 3])> {
        let at = |pin: &Pinned| Some((pin.body, pin.node, self.engine.position(pin.body, pin.node)?));
        let now = self.engine.frames();
        self.pins.iter().filter(|pin| pin.holds(now)).filter_map(at).collect()
    }
}
