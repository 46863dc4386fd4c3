//! Recording a world while a program steps it, and playing the recording: what the program did comes with it.
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

/// What it takes to write a byte of a state, with its coding [ns].
const BYTE: f64 = 2.1;
/// What it takes to keep a state, however small [ns].
const STATE: f64 = 3_000.0;
/// What a frame takes, however small [ns].
const FRAME: f64 = 4_000.0;
/// What a node, a cell and a facet of space add to a step of an explicit rule, at least [ns].
const WORK: [f64; 3] = [1.0, 3.0, 4.0];
/// How much more a step of an implicit rule takes, at least.
const IMPLICIT: f64 = 500.0;
/// The part of a run that keeping its states may take; the hashes of all frames take another.
const SHARE: f64 = 0.05;
/// The work that a kill may cost [ns]: to give each of many small frames to the system would take as long as to compute it.
const TOGETHER: f64 = 100_000.0;
/// The most frames from one state to the next: what the head of a recording can say.
const FARTHEST: f64 = u32::MAX as f64;

/// What a frame of a world takes on a common machine, at least [ns]. It follows from the scene alone: the same run gives the
/// same recording everywhere.
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

/// How many frames a state is to be kept, where nobody says it: so many that a run is less than a tenth slower by it and
/// by the hashes of all frames. To see a frame that is not kept takes as many frames at most, which is some twenty times
/// what it took to keep a state, whatever the scene: a twentieth of a second for a hundred thousand numbers.
pub fn states_apart(world: &dyn AnyWorld) -> u64 {
    let scene = world.scene();
    let nodes: usize = scene.bodies().map(|body| body.nodes()).sum();
    // Positions and velocities.
    let state = STATE + BYTE * (nodes * 2 * scene.dimension() * 8) as f64;
    let apart = (state / (SHARE * work(world))).ceil();
    if apart < FARTHEST { apart as u64 } else { FARTHEST as u64 }
}

/// How many frames go to the system together at most: what a kill costs. One, but of small scenes a tenth of a millisecond.
pub fn frames_together(world: &dyn AnyWorld) -> u64 {
    let together = TOGETHER / work(world);
    if together > 1.0 { together as u64 } else { 1 }
}

/// A recording that is being written: states of a world, and what the program does to it.
#[derive(Debug)]
pub struct Tape {
    file: RecordingFile,
    path: PathBuf,
    /// From one frame whose state is kept to the next.
    every: u64,
    /// Frames that go to the system together.
    together: u64,
    /// The first frame.
    first: u64,
    /// The last frame whose state was kept.
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
    /// What helps where a recording can go no further.
    pub enum TapeHint = "part.tape_hint" {
        RunEnded = "the run has ended here; --resume goes on from its checkpoint, with --record to another file",
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
    /// The world refuses.
    #[error(transparent)]
    World(#[from] WorldError),
}

impl Tape {
    /// Makes the file with its header; the world writes down from now on what the program does to it. The present frame
    /// is the first; what the program has done before is not in the recording.
    ///
    /// # Errors
    /// Those of [`RecordingFile::create`].
    pub fn begin(path: &Path, force: bool, header: &Header, world: &mut dyn AnyWorld) -> Result<Tape, WriteError> {
        let file = RecordingFile::create(path, force, header)?;
        world.keep_inputs();
        drop(world.take_inputs());
        let (first, together) = (world.frames(), frames_together(world));
        let mut tape = Tape { file, path: path.to_path_buf(), every: header.every, together, first, kept: first };
        tape.keep(world)?;
        Ok(tape)
    }

    /// Steps the world through a frame and adds that.
    ///
    /// # Errors
    /// Those of [`AnyWorld::frame`] and [`Tape::push`].
    pub fn step(&mut self, world: &mut dyn AnyWorld) -> Result<(), TapeError> {
        world.frame()?;
        Ok(self.push(world)?)
    }

    /// Adds the present frame of the world, which is the one behind the last, and before it what the program has done since
    /// then. Its state is kept where its turn has come, its hash in any case.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written, or for what cannot be recorded: bodies and forces that the program
    /// has made itself (`recording.input`), and for a frame that is not the next one. The frames before are whole.
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

    /// Adds what the program has done before a frame.
    fn inputs(&mut self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), WriteError> {
        for input in world.take_inputs() {
            let bytes = input.map_err(|error| WriteError::of(&self.path, TapeFault::Input { error }))?;
            self.file.input(frame, &bytes)?;
        }
        Ok(())
    }

    /// Writes the state of the last frame and the end; what the program did after that frame is in it.
    ///
    /// # Errors
    /// As [`Tape::push`].
    pub fn finish(mut self, world: &mut dyn AnyWorld) -> Result<u64, WriteError> {
        if world.frames() > self.kept {
            self.keep(world)?;
        }
        let behind = world.frames() + 1;
        self.inputs(world, behind)?;
        self.file.finish()
    }
}

/// A recording that is shown in a world of the same scene, or computed again.
#[derive(Debug)]
pub struct Playback<R> {
    recording: Recording<R>,
    /// What the program did, each with the frame that followed.
    inputs: Vec<(u64, Vec<u8>)>,
    /// The frame that was shown last, and the hash of its state, where the next one may be computed from it.
    shown: Option<(u64, u64)>,
}

impl<R: Read + Seek> Playback<R> {
    /// Reads what the program did up to a frame.
    ///
    /// # Errors
    /// [`TapeError`] where that part of the recording is damaged.
    pub fn of(mut recording: Recording<R>, last: u64) -> Result<Playback<R>, TapeError> {
        let frames: Vec<u64> = recording.inputs().take_while(|frame| *frame <= last).collect();
        let mut inputs = Vec::with_capacity(frames.len());
        for (number, frame) in frames.into_iter().enumerate() {
            inputs.push((frame, recording.input(number)?.to_vec()));
        }
        Ok(Playback { recording, inputs, shown: None })
    }

    /// Whether the state of a frame is in the recording, and not only what it is computed from.
    pub fn keeps(&self, frame: u64) -> bool {
        self.recording.kept(frame) == Ok(frame)
    }

    /// The bytes of a frame whose state is kept, as [`AnyWorld::snapshot`] gives them.
    ///
    /// # Errors
    /// [`RecordingError`] where there is no such state, or it is damaged.
    pub fn state(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        self.recording.read(frame)
    }

    /// The hash of a frame, as [`AnyWorld::frame_hash`] gives it: every frame has one.
    ///
    /// # Errors
    /// [`RecordingError`] where there is no such frame, or it is damaged.
    pub fn hash(&mut self, frame: u64) -> Result<u64, RecordingError> {
        self.recording.hash(frame)
    }

    /// Brings a world to a frame: without a step where its state is kept, else by steps from the last one that is.
    ///
    /// # Errors
    /// [`TapeError`]; if that is not a refused step, the world stays as it was.
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

    /// Computes a frame from the one before, in which the world is.
    ///
    /// # Errors
    /// [`WorldError`] where the world refuses what the program did, or the step.
    pub fn step(&self, world: &mut dyn AnyWorld, frame: u64) -> Result<(), WorldError> {
        let before = self.inputs.iter().filter(|(before, _)| *before == frame);
        before.into_iter().try_for_each(|(_, input)| world.repeat(input))?;
        world.frame()
    }
}
