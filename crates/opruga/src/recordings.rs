//! Recording a world while a program steps it, and playing the recording: what the program did comes with it.
//!
//! ```
//! use opruga::blueprint::{Action, AnyBlueprint, CommandBlueprint};
//! use opruga::io::recording::{Header, Recording};
//! use opruga::recordings::{Playback, Tape};
//! use opruga::{Options, World, catalogue, io::scene};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let text = opruga::scenes::find("ball").ok_or("there is no such scene")?;
//!     let read = || scene::read(text.as_bytes(), "ball.toml", &catalogue(), &scene::Options::default());
//!     let Ok((AnyBlueprint::Plane(blueprint), _)) = read() else { return Err("no plane scene".into()) };
//!     let file = std::env::temp_dir().join(format!("opruga-{}.rec", std::process::id()));
//!     let header = Header { name: "ball".into(), scene: text.into(), frame: blueprint.time.frame, ..Header::default() };
//!
//!     let mut world = World::new(blueprint.clone(), Options::default())?;
//!     let mut tape = Tape::begin(&file, true, &header, &mut world)?;
//!     for frame in 0..20 {
//!         if frame == 10 {
//!             world.set("body.ball.models.mass_spring.stiffness", opruga::core::spec::Value::Number(900.0))?;
//!         }
//!         tape.step(&mut world)?;
//!     }
//!     tape.finish(&mut world)?;
//!
//!     // Another world shows any frame of it, or computes it again.
//!     let mut again = World::new(blueprint, Options::default())?;
//!     let mut playback = Playback::of(Recording::open(std::fs::File::open(&file)?)?, 20)?;
//!     playback.show(&mut again, 3)?;
//!     for frame in 4..=20 {
//!         playback.step(&mut again, frame)?;
//!     }
//!     assert_eq!(again.state_hash(), world.state_hash());
//!     std::fs::remove_file(file)?;
//!     Ok(())
//! }
//! ```

use crate::{World, WorldError};
use opruga_io::recording::{Header, Recording, RecordingError, RecordingFile};
use opruga_io::safe_write::WriteError;
use opruga_world::Input;
use opruga_world::blueprint::CommandBlueprint;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

/// A recording that is being written: every frame of a world, and what the program does to it.
#[derive(Debug)]
pub struct Tape {
    file: RecordingFile,
    path: PathBuf,
}

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
    pub fn begin<const D: usize>(
        path: &Path,
        force: bool,
        header: &Header,
        world: &mut World<D>,
    ) -> Result<Tape, WriteError> {
        let file = RecordingFile::create(path, force, header)?;
        world.keep_inputs();
        drop(world.take_inputs());
        let mut tape = Tape { file, path: path.to_path_buf() };
        tape.push(world)?;
        Ok(tape)
    }

    /// Steps the world through a frame and adds that.
    ///
    /// # Errors
    /// Those of [`World::frame`] and [`Tape::push`].
    pub fn step<const D: usize>(&mut self, world: &mut World<D>) -> Result<(), TapeError> {
        world.frame()?;
        Ok(self.push(world)?)
    }

    /// Adds the present frame of the world, and before it what the program has done since the last one.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written, or for what cannot be recorded: bodies and forces that the program
    /// has made itself (`recording.input`). The frames before are whole.
    pub fn push<const D: usize>(&mut self, world: &mut World<D>) -> Result<(), WriteError> {
        self.inputs(world, world.frames())?;
        self.file.push(world.frames(), |out| world.snapshot_into(out))
    }

    /// Adds what the program has done before a frame.
    fn inputs<const D: usize>(&mut self, world: &mut World<D>, frame: u64) -> Result<(), WriteError> {
        for input in world.take_inputs() {
            let bytes = input.to_bytes().map_err(|e| WriteError {
                code: "recording.input",
                message: e.to_string(),
                path: self.path.clone(),
                bytes: 0,
                hint: Some("commands, `set`, `place_node` and `remove_body` can be recorded".into()),
            })?;
            self.file.input(frame, &bytes);
        }
        Ok(())
    }

    /// Writes the end; what the program did after the last frame is in it.
    ///
    /// # Errors
    /// As [`Tape::push`].
    pub fn finish<const D: usize>(mut self, world: &mut World<D>) -> Result<u64, WriteError> {
        self.inputs(world, world.frames() + 1)?;
        self.file.finish()
    }
}

/// A recording that is shown in a world of the same scene, or computed again.
#[derive(Debug)]
pub struct Playback<R, const D: usize> {
    recording: Recording<R>,
    /// What the program did, each with the frame that followed.
    inputs: Vec<(u64, Input<D>)>,
}

impl<R: Read + Seek, const D: usize> Playback<R, D> {
    /// Reads what the program did up to a frame.
    ///
    /// # Errors
    /// [`TapeError`] where that part of the recording is damaged.
    pub fn of(mut recording: Recording<R>, last: u64) -> Result<Playback<R, D>, TapeError> {
        let frames: Vec<u64> = recording.inputs().take_while(|frame| *frame <= last).collect();
        let mut inputs = Vec::with_capacity(frames.len());
        for (number, frame) in frames.into_iter().enumerate() {
            inputs.push((frame, Input::from_bytes(&recording.input(number)?)?));
        }
        Ok(Playback { recording, inputs })
    }

    /// The bytes of a frame, as [`World::snapshot`] gives them.
    ///
    /// # Errors
    /// [`RecordingError`] where there is no such frame, or it is damaged.
    pub fn state(&mut self, frame: u64) -> Result<&[u8], RecordingError> {
        self.recording.read(frame)
    }

    /// Brings a world to a frame, without a step.
    ///
    /// # Errors
    /// [`TapeError`]; the world stays as it was.
    pub fn show(&mut self, world: &mut World<D>, frame: u64) -> Result<(), TapeError> {
        let given: Vec<CommandBlueprint<D>> = self
            .inputs
            .iter()
            .take_while(|(before, _)| *before <= frame)
            .filter_map(|(_, input)| match input {
                Input::Command(command) => Some(command.clone()),
                _ => None,
            })
            .collect();
        Ok(world.restore_with(self.recording.read(frame)?, &given)?)
    }

    /// Computes a frame from the one before, in which the world is.
    ///
    /// # Errors
    /// [`WorldError`] where the world refuses what the program did, or the step.
    pub fn step(&self, world: &mut World<D>, frame: u64) -> Result<(), WorldError> {
        let before = self.inputs.iter().filter(|(before, _)| *before == frame);
        before.into_iter().try_for_each(|(_, input)| world.repeat(input))?;
        world.frame()
    }
}
