//! Shows a recorded run in the window. The first action of the user starts a different run from the displayed state.

use super::{KEYFRAME_BYTES, Session};
use crate::document::Document;
use crate::report::Report;
use crate::setting::Setting;
use crate::shown::{Offer, Severity};
use crate::view_errors::ViewError;
use opruga::WorldError;
use opruga::io::Files;
use opruga::io::recording::{Ending, Recording};
use std::io::{Read, Seek};

/// A recording that is viewed: frames with recorded states are not computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewed {
    /// The last frame that still agrees with the recording.
    until: u64,
    /// Whether the user has started a different run.
    left: bool,
}

impl Session {
    /// Opens a recorded run at its first frame. As many of its states are kept as fit into the memory for keyframes; the states between them are
    /// computed.
    ///
    /// # Errors
    /// The reason why it cannot be viewed: a program controlled the run, this version cannot read the scene, or the recording is damaged.
    pub fn view<R: Read + Seek>(mut recording: Recording<R>, setting: impl Into<Setting>) -> Result<Session, Report> {
        let header = recording.header().clone();
        if recording.inputs().next().is_some() {
            return Err(ViewError::Led {}.into());
        }
        let text = core::str::from_utf8(&header.scene).map_err(|_| ViewError::SceneNotUtf8 {})?;
        let files = header.assets.iter().map(|asset| (asset.name.clone(), asset.bytes.as_slice().into()));
        let files = Files::in_memory(files);
        let mut document = Document::new(&header.name, text)?;
        for (path, value) in &header.overrides {
            document.take_override(path, value)?;
        }
        let mut setting = setting.into();
        setting.options.allow_unstable |= header.allow_unstable;
        let mut session = Session::open(&header.name, &document.text(), files, setting)?;
        let damaged = |cause| ViewError::State { cause };
        let frames = recording.frames();
        let kept: Vec<u64> = frames.clone().filter(|frame| recording.kept(*frame) == Ok(*frame)).collect();
        let Some(first) = kept.first() else { return Err(ViewError::Empty {}.into()) };
        let size = recording.read(*first).map_err(damaged)?.len();
        let apart = (kept.len() * size).div_ceil(KEYFRAME_BYTES).max(1);
        for frame in kept.into_iter().step_by(apart) {
            let state = recording.read(frame).map_err(damaged)?.to_vec();
            if frame == 0 {
                // The scene in the recording must lead to the first recorded state. Otherwise, another program recorded the run.
                let hash = session.hash();
                session.engine.rewind(&state.into())?;
                if session.hash() != hash {
                    return Err(ViewError::OtherProgram {}.into());
                }
                continue;
            }
            session.keyframes.keep(frame, state);
        }
        session.latest = frames.end.saturating_sub(1);
        session.recording = Some(Viewed { until: session.latest, left: false });
        if let Ending::Damaged(cause) = recording.ending() {
            return Err(ViewError::DamagedBehind { frame: session.latest, cause: cause.clone() }.into());
        }
        session.seek(frames.start);
        Ok(session)
    }

    /// Takes the next frame from the recording, if the state of this frame was recorded and the pointer holds nothing.
    pub(super) fn recorded_frame(&mut self) -> Result<bool, WorldError> {
        let next = self.engine.frames() + 1;
        if self.recording.is_none() || self.grabbed.is_some() || next > self.latest {
            return Ok(false);
        }
        match self.keyframes.before(next) {
            Some((frame, state)) if frame == next => self.engine.rewind(state).map(|()| true),
            _ => Ok(false),
        }
    }

    /// The last frame that still agrees with the recording.
    pub(super) fn recorded_until(&self) -> Option<u64> {
        self.recording.map(|viewed| viewed.until).filter(|until| *until > 0)
    }

    /// Whether a recording is viewed and the user has not started a different run.
    pub(super) fn is_as_recorded(&self) -> bool {
        self.recording.is_some_and(|viewed| !viewed.left)
    }

    /// Stops time at the end of a recording, because the following frames were not recorded, and asks the user whether to continue.
    pub(super) fn stops_at_the_end(&mut self) -> bool {
        let stops = self.is_as_recorded() && self.engine.frames() >= self.latest && self.grabbed.is_none();
        if stops {
            self.playing = false;
            let time = self.engine.time();
            self.report(Severity::Done, Report::RecordingEnds(time), Some(Offer::GoOn));
        }
        stops
    }

    /// Starts a different run from a frame on.
    pub(super) fn leave_the_recording(&mut self, frame: u64) {
        let Some(viewed) = &mut self.recording else { return };
        let first = !viewed.left;
        (viewed.until, viewed.left) = (viewed.until.min(frame), true);
        if first {
            let time = self.time_of(frame);
            self.report(Severity::Done, Report::OwnCourse(time), None);
        }
    }
}
