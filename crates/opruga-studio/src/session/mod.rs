//! A scene that runs while the user works on it, without a window. Every action is written into the text of the scene as a command, so that the
//! command line computes the same bits from it.
//!
//! ```text
//! text ─read→ world ─frames→ keyframes        a new command behind the present: `act`, and its table into the text
//!   ↑ undo: an earlier text          ↑ rewind: the nearest keyframe before, then frame by frame
//! ```

mod edits;
mod ends;
mod exploded;
mod landing;
mod offers;
mod opening;
mod patience;
mod pointer;
mod read;
mod recorded;
mod seen;
#[cfg(test)]
mod tests;
mod titles;
mod travel;

pub use edits::{Edit, Placed};
pub use patience::by_the_clock;
pub use pointer::Grip;

use crate::differences::{Difference, add_difference};
use crate::document::Document;
use crate::engine::Engine;
use crate::keyframes::Keyframes;
use crate::pacing::Pacing;
use crate::pair;
use crate::report::Report;
use crate::samples::Samples;
use crate::setting::Setting;
use crate::shape_file::Shape;
use crate::shown::{Message, Offer, Severity, Show};
use crate::words::Language;
use opruga::WorldError;
use opruga::core::spec::{Value, Values};
use opruga::io::Files;
use patience::Patience;
use pointer::Grabbed;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, PoisonError, RwLock, RwLockWriteGuard};
use std::time::Duration;
use travel::Past;

/// The memory budget of the keyframes [bytes]. The budget is smaller on a web page, which may be open on a phone.
const KEYFRAME_BYTES: usize = if cfg!(target_arch = "wasm32") { 64 << 20 } else { 256 << 20 };

/// How long frames are computed on the way to another moment before the next picture is shown.
const SEEK_BUDGET: Duration = Duration::from_millis(40);

/// A request to a session.
#[derive(Clone, Debug)]
pub enum Request {
    /// Open a scene.
    Open {
        /// The name of the scene.
        name: String,
        /// The text of the scene.
        text: String,
        /// The location of the files that the scene names.
        files: Files,
    },
    /// Add a shape from a file to the scene, with its centre at a point and with this size [m]. If its dimension differs from that of the scene, open
    /// a new scene around it, with as many substeps as this scene needs.
    Take(Shape, [f64; 3], f64),
    /// Start or stop time.
    Play(bool),
    /// Compute one frame.
    Step,
    /// Return to the start and remove what was recorded since.
    Reset,
    /// Return to the start and replay what was recorded since then.
    Replay,
    /// Go to a frame.
    Seek(u64),
    /// Set the number of simulated seconds per real second.
    Speed(f64),
    /// Grab a body at a point.
    Grab(Grip, usize, [f64; 3]),
    /// Grab a body at a point of the scene on the right. The action applies to both scenes.
    GrabBeside(Grip, usize, [f64; 3]),
    /// Move the pointer to a point.
    Lead([f64; 3]),
    /// Release.
    Release,
    /// Unpin a point.
    Unpin(usize, u32),
    /// Set a parameter.
    Set(String, Value),
    /// Remove a field of an obstacle.
    Unset(String),
    /// Set a parameter by dragging during the press with this number. Everything that is set during one press is undone
    /// together.
    Draw(u64, String, Value),
    /// Change the models of a body.
    Models(usize, Vec<Values>),
    /// Change the integrator of the scene (none) or of a body.
    Integrator(Option<usize>, Values),
    /// Reset the integrator of a body to that of the scene.
    AsTheScene(usize),
    /// Add, remove or move bodies.
    Edit(Edit),
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// Accept the offer of a message.
    Accept(Offer),
    /// Set the display options.
    Show(Show),
    /// Show the scene twice, side by side, or only once.
    Compare(bool),
    /// Add a difference of the right scene.
    Differ(Difference),
    /// Records that the scene with this fingerprint was saved.
    Saved(u64),
}

impl Request {
    /// Whether a long frame should be interrupted for this request.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn breaks_off(&self) -> bool {
        use Request::{Accept, Draw, Open, Play, Replay, Reset, Seek};
        let now = matches!(self, Open { .. } | Play(false) | Replay | Reset | Seek(_) | Accept(_));
        // While a slider is dragged, values come with every picture. If they interrupted frames, no frame would ever be completed.
        now || self.is_edit() && !matches!(self, Draw(..))
    }

    /// Whether this request changes the scene.
    fn is_edit(&self) -> bool {
        use Request::{AsTheScene, Compare, Differ, Draw, Edit, Integrator, Models, Redo, Set, Take, Undo, Unset};
        let sets = matches!(self, Set(..) | Unset(..) | Draw(..) | Models(..) | Integrator(..) | AsTheScene(..));
        sets || matches!(self, Take(..) | Edit(..) | Undo | Redo | Compare(..) | Differ(..))
    }
}

/// A scene that runs while the user works on it.
pub struct Session {
    document: Document,
    files: Files,
    setting: Setting,
    engine: Box<dyn Engine>,
    /// How the scene on the right differs from the scene on the left; `None` if only one scene is shown.
    differences: Option<Vec<Difference>>,
    /// Bodies that were renamed when they were replaced: old and new names.
    renamed: Vec<(String, String)>,
    /// The last body that was added or copied, with a running number.
    newest: Option<(u64, String)>,
    /// The number of commands of the scene itself. The commands after these were recorded.
    own_commands: usize,
    /// The scene at its start, without anything that was recorded. A reset restores it, also if the commands of the scene have changed because the
    /// user has grabbed a body that the scene itself drags.
    start: Document,
    keyframes: Keyframes,
    /// The samples of the curves, which the interface reads.
    samples: Arc<RwLock<Samples>>,
    /// The last computed frame of this run.
    latest: u64,
    /// The frame to which the session is going; none if it has arrived.
    goal: Option<u64>,
    undo: Vec<Past>,
    redo: Vec<Past>,
    grabbed: Option<Grabbed>,
    /// Pulls that have ended recently.
    released: Vec<pointer::Released>,
    /// Points that are or were pinned.
    pins: Vec<pointer::Pinned>,
    playing: bool,
    speed: f64,
    pacing: Pacing,
    /// The recent computing time of a frame [s], also while a frame is being computed.
    cost: f64,
    show: Show,
    message: Option<Message>,
    messages: u64,
    opened: u64,
    /// How often the state was suddenly replaced by a different one.
    replaced: u64,
    /// How often the user has reset the scene to its start.
    resets: u64,
    /// The warnings at the end of the scene.
    ends: ends::Ends,
    /// A fingerprint of the text of the scene as it was opened or saved.
    clean: u64,
    /// The last request that was refused because the step is too long for it, or interrupted because a frame took too long.
    refused: Option<Request>,
    patience: Patience,
    /// The recording from which the session was opened, if there is one.
    recording: Option<recorded::Viewed>,
    /// The session that was open before another scene was opened, if it contained work.
    before: Option<Box<Session>>,
}

impl core::fmt::Debug for Session {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Session").field("scene", &self.document.name).field("frame", &self.engine.frames()).finish()
    }
}

/// The fingerprint of a text.
fn mark(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

impl Session {
    /// Opens a scene. `setting` is either [`opruga::Options`], which means the models and integrators of the library, or a [`Setting`].
    ///
    /// # Errors
    /// All errors in the text or in the files.
    pub fn open(name: &str, text: &str, files: Files, setting: impl Into<Setting>) -> Result<Session, Report> {
        let setting = setting.into();
        let document = Document::unread(name, text, &files, &setting.registries, None)?;
        Session::begin(document, files, setting)
    }

    /// Makes a session from a document.
    fn begin(document: Document, files: Files, setting: Setting) -> Result<Session, Report> {
        let engine = pair::build(&document, None, &files, &setting)?;
        let mut session = Session {
            ends: ends::Ends::of(engine.warnings()),
            clean: mark(&document.text()),
            own_commands: document.commands(),
            start: document.clone(),
            document,
            files,
            setting,
            engine,
            differences: None,
            renamed: Vec::new(),
            newest: None,
            keyframes: Keyframes::new(KEYFRAME_BYTES),
            samples: Arc::default(),
            latest: 0,
            goal: None,
            undo: Vec::new(),
            redo: Vec::new(),
            grabbed: None,
            released: Vec::new(),
            pins: Vec::new(),
            playing: false,
            speed: 1.0,
            pacing: Pacing::default(),
            cost: 0.0,
            show: Show::default(),
            message: None,
            messages: 0,
            opened: 1,
            replaced: 0,
            resets: 0,
            refused: None,
            patience: Patience::ENDLESS,
            recording: None,
            before: None,
        };
        session.keep();
        Ok(session)
    }

    /// Handles a request. If the request cannot be carried out, [`Shown::message`] reports this, and nothing changes.
    pub fn handle(&mut self, request: Request) {
        let again = request.clone();
        let (before, edits) = (self.messages, request.is_edit());
        let outcome = match request {
            Request::Open { name, text, files } => self.open_another(&name, &text, files),
            Request::Take(shape, middle, size) => self.take_shape(&shape, middle, size),
            Request::Play(playing) => {
                self.playing = playing;
                self.pacing.rest();
                if !playing {
                    self.look_where_time_stands();
                }
                Ok(())
            }
            Request::Step => {
                self.playing = false;
                if self.stops_at_the_end() { Ok(()) } else { self.frame().map_err(Report::World) }
            }
            Request::Reset => self.reset(),
            Request::Replay => {
                self.release();
                self.seek(0);
                self.playing = true;
                Ok(())
            }
            Request::Seek(frame) => {
                self.release();
                self.seek(frame);
                Ok(())
            }
            Request::Speed(speed) => {
                self.speed = speed.clamp(0.01, 10.0);
                self.pacing.rest();
                Ok(())
            }
            Request::Grab(grip, body, point) => self.grab(grip, body, point, false),
            Request::GrabBeside(grip, body, point) => self.grab(grip, body, point, true),
            Request::Lead(point) => {
                self.lead(point);
                Ok(())
            }
            Request::Release => {
                self.release();
                Ok(())
            }
            Request::Unpin(body, node) => self.let_go(body, node),
            Request::Set(path, value) => self.set(&path, value, None),
            Request::Unset(path) => self.unset(&path),
            Request::Draw(press, path, value) => self.set(&path, value, Some(press)),
            Request::Models(body, models) => self.change(body, Some(models), None),
            Request::Integrator(Some(body), values) => self.change(body, None, Some(values)),
            Request::Integrator(None, values) => self.integrator(&values),
            Request::AsTheScene(body) => self.as_the_scene(body),
            Request::Edit(edit) => self.edit(&edit),
            Request::Undo => self.step_back(),
            Request::Redo => self.step_forward(),
            Request::Accept(offer) => self.accept(&offer),
            Request::Show(show) => {
                self.show = show;
                Ok(())
            }
            Request::Saved(mark) => {
                self.clean = mark;
                Ok(())
            }
            Request::Compare(wanted) => self.compare(wanted.then(Vec::new)),
            Request::Differ(difference) => {
                let mut differences = self.differences.clone().unwrap_or_default();
                add_difference(&mut differences, difference);
                self.compare(Some(differences))
            }
        };
        match outcome {
            // When another edit was accepted, an earlier refusal is obsolete.
            Ok(()) if edits && self.messages == before => {
                self.message = self.message.take().filter(|message| message.severity != Severity::Refused);
            }
            Ok(()) => {}
            Err(Report::World(WorldError::BrokenOff {})) => self.broken_off(again),
            Err(Report::World(error)) => self.refuse(&error, Some(again)),
            Err(report) => self.report(Severity::Refused, report, None),
        }
    }

    /// Lets real time pass. Frames are computed for at most `budget`, measured by `clock`.
    pub fn tick(&mut self, elapsed: Duration, budget: Duration, clock: &dyn Fn() -> Duration) {
        if self.goal.is_some() {
            let start = clock();
            while let Some(goal) = self.goal
                && clock().saturating_sub(start) < SEEK_BUDGET
            {
                if self.engine.frames() >= goal {
                    self.arrive();
                } else if let Err(error) = self.frame() {
                    if error == (WorldError::BrokenOff {}) {
                        return self.broken_off(Request::Seek(goal));
                    }
                    self.goal = None;
                    self.refuse(&error, None);
                }
            }
            return;
        }
        if !self.playing || self.stops_at_the_end() {
            return;
        }
        let (length, speed) = (self.engine.frame_seconds(), self.speed);
        self.cost = self.pacing.cost();
        let mut pacing = std::mem::take(&mut self.pacing);
        let outcome = pacing.run(elapsed, speed, length, budget, || {
            let start = clock();
            // Time may have been stopped during a frame.
            if !self.playing || self.stops_at_the_end() {
                return Err(None);
            }
            self.frame().map(|()| clock().saturating_sub(start)).map_err(Some)
        });
        self.pacing = pacing;
        match outcome {
            Err(Some(WorldError::BrokenOff {})) => self.broken_off(Request::Play(true)),
            Err(Some(error)) => {
                self.playing = false;
                self.refuse(&error, None);
            }
            Ok(_) | Err(None) => {}
        }
    }

    /// Computes one frame. Updates the pointer before the frame, and keeps a keyframe after it if one is due.
    fn frame(&mut self) -> Result<(), WorldError> {
        if self.recorded_frame()? {
            self.sample();
            self.look_at_the_end();
            return Ok(());
        }
        self.lead_grabbed();
        self.look_at_the_clock();
        self.engine.frame()?;
        let is_new = self.engine.frames() > self.latest;
        self.latest = self.latest.max(self.engine.frames());
        self.keep();
        self.look_at_the_end();
        if is_new {
            self.stop_where_a_body_exploded();
        }
        Ok(())
    }

    fn keep(&mut self) {
        let frame = self.engine.frames();
        if self.keyframes.wants(frame) {
            self.keyframes.keep(frame, self.engine.snapshot());
        }
        self.sample();
    }

    fn samples(&self) -> RwLockWriteGuard<'_, Samples> {
        self.samples.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds the sample of the present frame to the curves, unless it exists already.
    fn sample(&mut self) {
        if self.samples().wants(self.engine.frames()) {
            let mut sample = self.engine.sample();
            sample.cost = 1e3 * self.cost;
            self.samples().keep(sample);
        }
    }

    fn report(&mut self, severity: Severity, report: Report, offer: Option<Offer>) {
        self.messages += 1;
        let report = self.titled(report);
        let text = Language::English.report(&report);
        self.message = Some(Message { number: self.messages, severity, report, text, offer, frame_seconds: None });
    }
}
