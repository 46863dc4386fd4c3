//! Why a recorded run cannot be viewed.

use opruga::io::recording::RecordingError;

opruga::math::messages! {
    /// Why a recorded run cannot be viewed.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ViewError {
        /// A program controlled the run, and its actions are not part of the scene.
        "recording.led" #[error("a program controlled this run, and a scene file cannot express that")] #[hint("`opruga replay` shows the run")]
        Led {},
        /// The scene in the recording is not text.
        "recording.scene" #[error("the scene inside is not UTF-8 text")]
        SceneNotUtf8 {},
        /// An override of the run has an invalid value.
        "recording.override" #[error("`{path}` is set to `{value}`, which is not a value")]
        NoValue { path: String, value: String },
        /// An override of the run names nothing in the scene.
        "recording.override" #[error("`{path}` names nothing in the scene")]
        NoPath { path: String },
        /// The recording contains no state.
        "recording.no_frame" #[error("the recording contains no frame")]
        Empty {},
        /// The scene in the recording does not lead to the recorded states.
        "recording.other_program" #[error("the recorded scene does not lead to the first recorded state: another program wrote the recording")]
        OtherProgram {},
        /// The end of the recording is damaged.
        "recording.damaged" #[error("after frame {frame}: {cause}")]
        DamagedBehind { frame: u64, cause: RecordingError },
        /// A state cannot be read.
        "recording.damaged" #[error("{cause}")]
        State { cause: RecordingError },
    }
}
