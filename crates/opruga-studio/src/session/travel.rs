//! Goes back and forth in time: keyframes, different futures, undo and redo.

use super::pointer::Pinned;
use super::{KEYFRAME_BYTES, Session};
use crate::differences::Difference;
use crate::document::Document;
use crate::engine::Engine;
use crate::keyframes::Keyframes;
use crate::pair;
use crate::report::{Report, Step};
use crate::samples::Samples;
use crate::shown::Severity;

/// A moment to which the user can return.
#[derive(Clone, Debug)]
pub(super) struct Past {
    /// The action that followed this moment.
    pub(super) label: Step,
    pub(super) document: Document,
    pub(super) own_commands: usize,
    /// The scene at its start, as it was at this moment.
    pub(super) start: Document,
    pub(super) frame: u64,
    /// The frame up to which the run of this moment is identical to the run that replaced it.
    pub(super) common: u64,
    pub(super) pins: Vec<Pinned>,
    pub(super) differences: Option<Vec<Difference>>,
    /// The press during which a parameter was dragged, if any.
    pub(super) press: Option<u64>,
}

impl Session {
    /// Goes to a frame. Returns to the nearest keyframe before that frame if necessary, and computes the remaining frames in the next ticks.
    pub(super) fn seek(&mut self, frame: u64) {
        let frame = frame.min(self.latest);
        let now = self.engine.frames();
        if let Some((kept, state)) = self.keyframes.before(frame)
            && (frame < now || kept > now)
            && let Err(error) = self.engine.rewind(state)
        {
            self.refuse(&error, None);
            return;
        }
        self.head_for(frame);
    }

    /// Makes a frame the goal of the next ticks. If this frame has been reached already, arrives at once.
    fn head_for(&mut self, frame: u64) {
        self.replaced += 1;
        self.goal = (frame > self.engine.frames()).then_some(frame);
        self.sample();
        if self.goal.is_none() {
            self.arrive();
        }
        self.pacing.rest();
    }

    /// Arrives at a moment. At the end of the computed run, the commands that are due at this moment take effect at once. At an earlier moment, they
    /// take no effect, because new actions replace everything that followed it.
    pub(super) fn arrive(&mut self) {
        self.replaced += 1;
        self.goal = None;
        self.pacing.rest();
        if self.engine.frames() >= self.latest
            && let Err(error) = self.engine.begin_what_is_due()
        {
            self.refuse(&error, None);
        }
        self.stop_where_a_body_exploded();
    }

    /// Goes to the end of the scene, frame by frame, as if it had been computed already.
    pub fn go_to_the_end(&mut self) {
        let end = self.engine.shown(&self.show).seconds / self.engine.frame_seconds();
        self.latest = self.latest.max(end.round() as u64);
        self.seek(self.latest);
    }

    /// Starts a different future from here: new actions replace what was recorded later.
    pub(super) fn branch(&mut self) -> Result<(), Report> {
        let now = self.engine.frames();
        if now >= self.latest {
            self.leave_the_recording(now);
            return Ok(());
        }
        let mut document = self.document.clone();
        document.cut(self.own_commands, self.engine.time());
        let mut engine = self.build(&document)?;
        engine.rewind(&self.engine.snapshot()).map_err(Report::World)?;
        (self.document, self.engine) = (document, engine);
        self.cut_pins();
        self.released.clear();
        self.keyframes.forget_after(now);
        self.samples().forget_after(now);
        self.latest = now;
        self.goal = None;
        self.leave_the_recording(now);
        Ok(())
    }

    /// The present moment, to which the user can return. The pointer is then released.
    pub(super) fn past(&self, label: Step) -> Past {
        Past {
            label,
            document: self.let_go_of_all(),
            own_commands: self.own_commands,
            start: self.start.clone(),
            frame: self.engine.frames(),
            common: self.engine.frames(),
            pins: self.pins.clone(),
            differences: self.differences.clone(),
            press: None,
        }
    }

    /// Remembers the moment before an action.
    pub(super) fn remember(&mut self, past: Past) {
        // Dragging a slider is one edit from the press to the release, however much time passes in the scene. Adding two bodies at the same moment is
        // two edits.
        let together = |last: &Past| match (last.press, past.press) {
            (Some(one), Some(other)) => one == other,
            _ => last.frame == past.frame,
        };
        let same = |last: &Past| matches!(past.label, Step::Set(_)) && last.label == past.label && together(last);
        if !self.undo.last().is_some_and(same) {
            self.undo.push(past);
        }
        self.redo.clear();
        if self.undo.len() > 100 {
            self.undo.remove(0);
        }
    }

    /// Builds the world of a document and, if two scenes are side by side, that of the right scene.
    pub(super) fn build(&self, document: &Document) -> Result<Box<dyn Engine>, Report> {
        pair::build(document, self.differences.as_deref(), &self.files, &self.setting)
    }

    /// Shows the scene twice, the second time with these differences, or only once (`None`). The run is computed again from the start to the present
    /// moment, because the differences apply from the start.
    pub(super) fn compare(&mut self, differences: Option<Vec<Difference>>) -> Result<(), Report> {
        if differences == self.differences {
            return Ok(());
        }
        let newest = differences.as_ref().and_then(|list| list.last()).map(Difference::about);
        let past = self.past(newest.map_or(Step::Compare, Step::Differ));
        // If the session is still on the way to a moment, that moment remains the goal.
        let (latest, goal) = (self.latest, self.goal.unwrap_or(self.engine.frames()));
        self.with_differences(differences, |session| {
            session.take(session.document.clone(), session.own_commands, [latest; 2])?;
            session.goal = (goal > 0).then_some(goal);
            Ok(())
        })?;
        self.pins.clone_from(&past.pins);
        self.remember(past);
        Ok(())
    }

    /// Changes the differences and calls `act`. If `act` is refused, the differences stay as they were.
    fn with_differences(
        &mut self,
        differences: Option<Vec<Difference>>,
        act: impl FnOnce(&mut Session) -> Result<(), Report>,
    ) -> Result<(), Report> {
        if differences == self.differences {
            return act(self);
        }
        // The keyframes are set aside, because they belong to worlds with other differences.
        let keyframes = std::mem::replace(&mut self.keyframes, Keyframes::new(KEYFRAME_BYTES));
        let before = std::mem::replace(&mut self.differences, differences);
        let outcome = act(self);
        if outcome.is_err() {
            (self.keyframes, self.differences) = (keyframes, before);
        }
        outcome
    }

    /// Builds the world of a document and goes to a frame. Up to the frame `common`, the new run is identical to the present run.
    pub(super) fn take(
        &mut self,
        document: Document,
        own_commands: usize,
        [frame, common]: [u64; 2],
    ) -> Result<(), Report> {
        self.release();
        let mut engine = self.build(&document)?;
        let shared = frame.min(common).min(self.engine.frames().max(self.latest));
        let state = self.keyframes.before(shared).map(|(_, state)| state.clone());
        // If the start itself was changed, the runs have no common past, and everything is computed from the start.
        let common = shared > 0 && state.is_some_and(|state| engine.rewind(&state).is_ok());
        (self.document, self.engine, self.own_commands) = (document, engine, own_commands);
        if common {
            let kept = self.engine.frames();
            self.keyframes.forget_after(kept);
            self.samples().forget_after(kept);
        } else {
            self.keyframes = Keyframes::new(KEYFRAME_BYTES);
            *self.samples() = Samples::default();
            self.keep();
        }
        self.pins.clear();
        self.released.clear();
        if frame < self.latest {
            self.leave_the_recording(frame);
        }
        self.latest = frame;
        self.head_for(frame);
        Ok(())
    }

    pub(super) fn step_back(&mut self) -> Result<(), Report> {
        let Some(past) = self.undo.last().cloned() else {
            self.open_before();
            return Ok(());
        };
        // The two runs separate at the same frame, whether the user undoes or redoes the action.
        let present = Past { common: past.common, ..self.past(past.label.clone()) };
        self.with_differences(past.differences, |session| {
            session.take(past.document, past.own_commands, [past.frame, past.common])
        })?;
        (self.pins, self.start) = (past.pins, past.start);
        self.undo.pop();
        // The redo returns to the moment at which the undo was requested.
        self.redo.push(present);
        let time = self.time_of(past.frame);
        self.report(Severity::Done, Report::Undone(past.label, time), None);
        Ok(())
    }

    pub(super) fn step_forward(&mut self) -> Result<(), Report> {
        let Some(future) = self.redo.last().cloned() else { return Ok(()) };
        let present = Past { common: future.common, ..self.past(future.label.clone()) };
        self.with_differences(future.differences, |session| {
            session.take(future.document, future.own_commands, [future.frame, future.common])
        })?;
        (self.pins, self.start) = (future.pins, future.start);
        self.redo.pop();
        self.undo.push(present);
        let time = self.time_of(future.frame);
        self.report(Severity::Done, Report::Redone(future.label, time), None);
        Ok(())
    }

    pub(super) fn time_of(&self, frame: u64) -> f64 {
        frame as f64 * self.engine.frame_seconds()
    }

    pub(super) fn reset(&mut self) -> Result<(), Report> {
        self.resets += 1;
        if self.is_as_recorded() {
            self.release();
            self.seek(0);
            return Ok(());
        }
        // The run after the reset has nothing in common with the present one.
        let past = Past { common: 0, ..self.past(Step::Reset) };
        let start = self.start.clone();
        let own_commands = start.commands();
        // A pull may have ended a drag of the scene without recording anything, so the texts are compared.
        let recorded = past.document.text() != start.text();
        self.take(start, own_commands, [0; 2])?;
        if recorded {
            self.remember(past);
        }
        Ok(())
    }
}
