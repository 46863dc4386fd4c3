//! A scene that runs while a person works on it, without any window: everything that is done is written into the text of
//! the scene as a command, so that the command line computes the same bits from it.
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

/// What the keyframes may take [bytes]; less on a page, which may be open on a phone.
const KEYFRAME_BYTES: usize = if cfg!(target_arch = "wasm32") { 64 << 20 } else { 256 << 20 };

/// The most frames that are computed to go to a moment before the interface is served again.
const SEEK_BUDGET: Duration = Duration::from_millis(40);

/// What can be asked of a session.
#[derive(Clone, Debug)]
pub enum Request {
    /// Open a scene.
    Open {
        /// Its name.
        name: String,
        /// Its text.
        text: String,
        /// Where the files are that it names.
        files: Files,
    },
    /// Take a shape from a file into the scene, with its middle at a point and of this size [m]; where it is of the other dimension,
    /// open a scene around it with as many substeps as it needs.
    Take(Shape, [f64; 3], f64),
    /// Let time pass, or not.
    Play(bool),
    /// One frame.
    Step,
    /// To the start, without what was done since.
    Reset,
    /// To the start, with what was done since: it happens again.
    Replay,
    /// To a frame.
    Seek(u64),
    /// Simulated seconds in a real one.
    Speed(f64),
    /// Take hold of a body at a point.
    Grab(Grip, usize, [f64; 3]),
    /// Take hold of a body at a point of the scene beside it: what is done there is done to both.
    GrabBeside(Grip, usize, [f64; 3]),
    /// The pointer has moved.
    Lead([f64; 3]),
    /// Let go.
    Release,
    /// Let go of a pinned point.
    Unpin(usize, u32),
    /// Set a parameter.
    Set(String, Value),
    /// Give a field of an obstacle no longer.
    Unset(String),
    /// Set a parameter by a hand that is down since the press of this number: all that it sets is undone as one.
    Draw(u64, String, Value),
    /// Give a body other models.
    Models(usize, Vec<Values>),
    /// Give the scene (none) or a body another integrator.
    Integrator(Option<usize>, Values),
    /// Give a body the integrator of the scene again.
    AsTheScene(usize),
    /// Change which bodies there are, and where.
    Edit(Edit),
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// Accept what a message offers.
    Accept(Offer),
    /// What shall be seen.
    Show(Show),
    /// Show the scene twice, side by side, or no longer.
    Compare(bool),
    /// Let the right one differ in this.
    Differ(Difference),
    /// The scene of this mark was saved.
    Saved(u64),
}

impl Request {
    /// Whether it cannot wait until a frame is done that takes long.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn breaks_off(&self) -> bool {
        use Request::{Accept, Draw, Open, Play, Replay, Reset, Seek};
        let now = matches!(self, Open { .. } | Play(false) | Replay | Reset | Seek(_) | Accept(_));
        // What a hand draws comes with every picture: no frame would ever be done.
        now || self.is_edit() && !matches!(self, Draw(..))
    }

    /// Whether it changes the scene.
    fn is_edit(&self) -> bool {
        use Request::{AsTheScene, Compare, Differ, Draw, Edit, Integrator, Models, Redo, Set, Take, Undo, Unset};
        let sets = matches!(self, Set(..) | Unset(..) | Draw(..) | Models(..) | Integrator(..) | AsTheScene(..));
        sets || matches!(self, Take(..) | Edit(..) | Undo | Redo | Compare(..) | Differ(..))
    }
}

/// A scene that runs while a person works on it.
pub struct Session {
    document: Document,
    files: Files,
    setting: Setting,
    engine: Box<dyn Engine>,
    /// In what the scene on the right differs, where there is one.
    differences: Option<Vec<Difference>>,
    /// Bodies that were set down anew under another name: old and new.
    renamed: Vec<(String, String)>,
    /// The last body that was added or copied, with a number that counts them.
    newest: Option<(u64, String)>,
    /// Commands that the scene had when it was opened; those behind them were recorded.
    own_commands: usize,
    /// The scene as it begins, without anything that was recorded: what a reset comes back to. A hand that takes over from a
    /// recorded one changes the commands of the scene itself.
    start: Document,
    keyframes: Keyframes,
    /// The curves; the interface reads them.
    samples: Arc<RwLock<Samples>>,
    /// The last frame of this course of things.
    latest: u64,
    /// Where to go, frame by frame.
    goal: Option<u64>,
    undo: Vec<Past>,
    redo: Vec<Past>,
    grabbed: Option<Grabbed>,
    /// Pulls that ended of late.
    released: Vec<pointer::Released>,
    /// Points that are pinned, and those that were.
    pins: Vec<pointer::Pinned>,
    playing: bool,
    speed: f64,
    pacing: Pacing,
    /// What a frame took of late [s], also while one is computed.
    cost: f64,
    show: Show,
    message: Option<Message>,
    messages: u64,
    opened: u64,
    /// How often another state took the place of the one before at once.
    replaced: u64,
    /// How often a person went back to the start and left what was done.
    resets: u64,
    /// What was told of the end of the scene.
    ends: ends::Ends,
    /// A mark of the text of the scene as it was opened or saved.
    clean: u64,
    /// What was refused because its step was too long, or was broken off because a frame of it took too long.
    refused: Option<Request>,
    patience: Patience,
    /// The recording that it was opened from.
    recording: Option<recorded::Viewed>,
    /// The session before another scene was opened, where something had been done in it.
    before: Option<Box<Session>>,
}

impl core::fmt::Debug for Session {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Session").field("scene", &self.document.name).field("frame", &self.engine.frames()).finish()
    }
}

/// A mark of a text.
fn mark(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

impl Session {
    /// Opens a scene: by [`opruga::Options`] alone, with the models and integrators of the library.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn open(name: &str, text: &str, files: Files, setting: impl Into<Setting>) -> Result<Session, Report> {
        let setting = setting.into();
        let document = Document::unread(name, text, &files, &setting.registries, None)?;
        Session::begin(document, files, setting)
    }

    /// A session of a text that was read.
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

    /// Does what is asked. What cannot be done is told by [`Shown::message`] and leaves everything as it was.
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
            // What was refused before is over where something else was accepted.
            Ok(()) if edits && self.messages == before => {
                self.message = self.message.take().filter(|message| message.severity != Severity::Refused);
            }
            Ok(()) => {}
            Err(Report::World(WorldError::BrokenOff {})) => self.broken_off(again),
            Err(Report::World(error)) => self.refuse(&error, Some(again)),
            Err(report) => self.report(Severity::Refused, report, None),
        }
    }

    /// Lets real time pass; at most `budget` is spent on frames, as `clock` measures them.
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
            // A frame may have stopped time by itself.
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

    /// One frame, with the pointer led before it and a keyframe behind it.
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

    /// Keeps the numbers of the curves for the present frame, if they are not known.
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
