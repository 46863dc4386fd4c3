//! Records a world while a program steps it, and plays the recording. The recording includes the actions of the program.
//!
//! ```
//! use opruga::io::recording::{Header, Recording};
//! use opruga::recordings::{Playback, Tape};
//! use opruga::{Options, catalogue, io::scene};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let text = opruga::scenes::find("ball").ok_or("there is no such scene")?;
//!     let read = || scene::read(text.as_bytes(), "ball.toml", &catalogue(), &scene::Options::default());
//!     let (blueprint, _) = read().map_err(|errors| errors[0].to_string())?;
//!     let file = std::env::temp_dir().join(format!("opruga-{}.rec", std::process::id()));
//!     let header = Header { name: "ball".into(), scene: text.into(), frame: blueprint.scene().time().frame, ..Header::default() };
//!
//!     let mut world = blueprint.clone().build(Options::default())?;
//!     let mut tape = Tape::begin(&file, true, &header, &mut *world)?;
//!     for frame in 0..20 {
//!         if frame == 10 {
//!             world.set("body.ball.models.mass_spring.stiffness", opruga::core::spec::Value::Number(900.0))?;
//!         }
//!         tape.step(&mut *world)?;
//!     }
//!     tape.finish(&mut *world)?;
//!
//!     // Another world shows any frame of it, or computes it again. `Header::every` keeps fewer states: those between are
//!     // computed as they are asked for.
//!     let mut again = blueprint.build(Options::default())?;
//!     let mut playback = Playback::of(Recording::open(std::fs::File::open(&file)?)?, 20)?;
//!     playback.show(&mut *again, 3)?;
//!     for frame in 4..=20 {
//!         playback.step(&mut *again, frame)?;
//!     }
//!     assert_eq!(again.state_hash(), world.state_hash());
//!     std::fs::remove_file(file)?;
//!     Ok(())
//! }
//! ```

use crate::WorldError;
use opruga_io::recording::{Header, Recording, RecordingError, RecordingFile};
use opruga_io::safe_write::WriteError;
use opruga_world::{AnyBody, AnyWorld};
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

/// The time to encode and write one byte of a state [ns].
const BYTE: f64 = 2.1;
/// The time to keep a state, however small it is [ns].
const STATE: f64 = 3_000.0;
/// The time [ns] that every frame takes, however small the scene is.
const FRAME: f64 = 4_000.0;
/// Lower bounds [ns] on the time that a node, a cell, and a facet in space each add to a step of an explicit integrator.
const WORK: [f64; 3] = [1.0, 3.0, 4.0];
/// A lower bound on the duration of a step of an implicit integrator, divided by the duration of a step of an explicit integrator.
const IMPLICIT: f64 = 500.0;
/// The fraction of the time of a run that may be spent on keeping states. The hashes of all frames may take the same fraction again.
const SHARE: f64 = 0.05;
/// The computing time [ns] whose results may be lost if the process is killed. Small frames are written in groups, because writing each of them
/// separately would take as long as computing it.
const TOGETHER: f64 = 100_000.0;
/// The largest number that the header of a recording can store for the frames from one kept state to the next.
const FARTHEST: f64 = u32::MAX as f64;

/// A lower bound [ns] on the time that a frame of a world takes on a common machine. The bound depends only on the scene, so that the same run gives
/// the same recording everywhere.
fn work(world: &dyn AnyWorld) -> f64 {
    let scene = world.scene();
    let dimension = scene.dimension();
    let step = |body: &dyn AnyBody| {
        let facets = if dimension == 3 { body.facets().len() / dimension + body.sheets().len() } else { 0 };
        let counts = [body.nodes(), body.cells().len(), facets].map(|count| count as f64);
        let work: f64 = counts.iter().zip(WORK).map(|(count, each)| count * each).sum();
        let rule = body.integrator().unwrap_or(scene.integrator());
        if world.is_implicit(rule) { IMPLICIT * work } else { work }
    };
    FRAME + f64::from(scene.time().substeps) * scene.bodies().map(step).sum::<f64>()
}

/// The default number of frames from one kept state to the next. With this number, keeping states and the hashes of all frames slows the run down by
/// less than a tenth. To show a frame that is not kept, at most this number of frames must be computed. In every scene, computing that many frames
/// takes about twenty times as long as keeping a state: 0.05 s for a state of 100,000 numbers.
pub fn states_apart(world: &dyn AnyWorld) -> u64 {
    let scene = world.scene();
    let nodes: usize = scene.bodies().map(|body| body.nodes()).sum();
    // Positions and velocities.
    let state = STATE + BYTE * (nodes * 2 * scene.dimension() * 8) as f64;
    let apart = (state / (SHARE * work(world))).ceil();
    if apart < FARTHEST { apart as u64 } else { FARTHEST as u64 }
}

/// The number of frames that are written together, and that may be lost if the process is killed. This is the number of frames that can be computed
/// in a tenth of a millisecond, but at least one.
pub fn frames_together(world: &dyn AnyWorld) -> u64 {
    let together = TOGETHER / work(world);
    if together > 1.0 { together as u64 } else { 1 }
}

/// A recording that is being written: the states of a world, and the actions of the program on it.
#[derive(Debug)]
pub struct Tape {
    file: RecordingFile,
    path: PathBuf,
    /// The number of frames from one kept state to the next.
    every: u64,
    /// The number of frames that are written together.
    together: u64,
    /// The first frame.
    first: u64,
    /// The latest frame whose state was kept.
    kept: u64,
}

opruga_math::messages! {
    /// Why a program cannot be recorded.
    #[derive(Clone, Debug, PartialEq)]
    pub enum TapeFault {
        "recording.input" #[error("{error}")] #[hint("commands, `set`, `set_node` and `remove_body` can be recorded")]
        Input { error: WorldError },
    }
}

opruga_math::terms! {
    /// The remedies if a recording cannot continue.
    pub enum TapeHint = "part.tape_hint" {
        RunEnded = "the run ended here; --resume continues from its checkpoint, and --record then needs another file",
    }
}

/// All messages of recordings, for tests of translations.
#[doc(hidden)]
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[TapeFault::VARIANTS, TapeHint::VARIANTS];

/// Why a recording was not written, or not played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TapeError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file could not be read.
    #[error(transparent)]
    Read(#[from] RecordingError),
    /// The world refused a step or an action.
    #[error(transparent)]
    World(#[from] WorldError),
}

impl Tape {
    /// Makes the file with its header. From now on the world logs the actions of the program. The recording begins with the present frame and does
    /// not contain earlier actions of the program.
    ///
    /// # Errors
    /// The errors of [`RecordingFile::create`].
    pub fn begin(path: &Path, force: bool, header: &Header, world: &mut dyn AnyWorld) -> Result<Tape, WriteError> {
        let file = RecordingFile::create(path, force, header)?;
        world.keep_inputs();
        drop(world.take_inputs());
        let (first, together) = (world.frames(), frames_together(world));
        let mut tape = Tape { file, path: path.to_path_buf(), every: header.every, together, first, kept: first };
        tape.keep(world)?;
        Ok(tape)
    }

    /// Steps the world through a frame and adds the frame.
    ///
    /// # Errors
    /// The errors of [`AnyWorld::frame`] and [`Tape::push`].
    pub fn step(&mut self, world: &mut dyn AnyWorld) -> Result<(), TapeError> {
        world.frame()?;
        Ok(self.push(world)?)
    }

    /// Adds the actions of the program since the previous frame, and then the present frame of the world, which must follow the previous one. The
    /// hash of the frame is always kept, its state only if one is due.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written, if the frame is not the next one, or if an action cannot be recorded (`recording.input`), such
    /// as a body that the program adds or a force that it defines. The earlier frames are intact.
    pub fn push(&mut self, world: &mut dyn AnyWorld) -> Result<(), WriteError> {
        let frame = world.frames();
        self.inputs(world, frame)?;
        let frames = frame.saturating_sub(self.first);
        if frames.is_multiple_of(self.every) {
            return self.keep(world);
        }
        self.file.push(world.frames(), world.frame_hash())?;
        if frames.is_multiple_of(self.together) { self.file.flush() } else { Ok(()) }
    }

    fn keep(&mut self, world: &dyn AnyWorld) -> Result<(), WriteError> {
        self.kept = world.frames();
        self.file.keep(world.frames(), world.frame_hash(), |out| world.snapshot_into(out))
    }

    /// Adds the actions that the program took before a frame.
    fn inputs(&mut self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), WriteError> {
        for input in world.take_inputs() {
            let bytes = input.map_err(|error| WriteError::of(&self.path, TapeFault::Input { error }))?;
            self.file.input(frame, &bytes)?;
        }
        Ok(())
    }

    /// Writes the state of the last frame, which includes the actions of the program after that frame, and the end of the file.
    ///
    /// # Errors
    /// The errors of [`Tape::push`].
    pub fn finish(mut self, world: &mut dyn AnyWorld) -> Result<u64, WriteError> {
        if world.frames() > self.kept {
            self.keep(world)?;
        }
        let behind = world.frames() + 1;
        self.inputs(world, behind)?;
        self.file.finish()
    }
}

/// A recording whose frames are shown in a world of the same scene, or computed again in it.
#[derive(Debug)]
pub struct Playback<R> {
    recording: Recording<R>,
    /// The actions of the program, each with the frame that followed.
    inputs: Vec<(u64, Vec<u8>)>,
    /// The frame that was shown last, and the hash of its state; none if the next frame cannot be computed from it.
    shown: Option<(u64, u64)>,
}

impl<R: Read + Seek> Playback<R> {
    /// Reads the actions of the program up to a frame.
    ///
    /// # Errors
    /// [`TapeError`] if that part of the recording is damaged.
    pub fn of(mut recording: Recording<R>, last: u64) -> Result<Playback<R>, TapeError> {
        let frames: Vec<u64> = recording.inputs().take_while(|frame| *frame <= last).collect();
        let mut inputs = Vec::with_capacity(frames.len());
        for (number, frame) in frames.into_iter().enumerate() {
            inputs.push((frame, recording.input(number)?.to_vec()));
        }
        Ok(Playback { recording, inputs, shown: None })
    }

    /// Whether the recording contains the state of a frame, so that it need not be computed.
    pub fn keeps(&self, frame: u64) -> bool {
        self.recording.kept(frame) == Ok(frame)
    }

    /// Returns the bytes of the state of a frame whose state is kept, as [`AnyWorld::snapshot`] returns them.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no such state, or it is damaged.
    pub fn state(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        self.recording.read(frame)
    }

    /// Returns the hash of a frame, as [`AnyWorld::frame_hash`] returns it. Every frame has a hash.
    ///
    /// # Errors
    /// [`RecordingError`] if there is no such frame, or it is damaged.
    pub fn hash(&mut self, frame: u64) -> Result<u64, RecordingError> {
        self.recording.hash(frame)
    }

    /// Brings a world to a frame. If the state of the frame is kept, no step is needed; otherwise, the world is stepped from the nearest kept state
    /// before the frame.
    ///
    /// # Errors
    /// [`TapeError`] if the frame cannot be read or computed. The world does not change, unless a step was refused.
    pub fn show(&mut self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), TapeError> {
        let kept = self.recording.kept(frame)?;
        let here = self.shown.filter(|(at, hash)| {
            (kept..=frame).contains(at) && world.frames() == *at && world.state_hash() == *hash && *at > kept
        });
        let from = match here {
            Some((at, _)) => at,
            None => {
                self.restore(world, kept)?;
                kept
            }
        };
        for next in from + 1..=frame {
            self.step(world, next)?;
        }
        self.shown = (frame > kept).then(|| (frame, world.state_hash()));
        Ok(())
    }

    /// Brings a world to a frame whose state is kept.
    fn restore(&mut self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), TapeError> {
        Ok(world.restore(self.recording.read(frame)?)?)
    }

    /// Computes a frame from the previous one, which is the present state of the world.
    ///
    /// # Errors
    /// [`WorldError`] if the world refuses an action of the program, or the step.
    pub fn step(&self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), WorldError> {
        let before = self.inputs.iter().filter(|(before, _)| *before == frame);
        before.into_iter().try_for_each(|(_, input)| world.repeat(input))?;
        world.frame()
    }
}
