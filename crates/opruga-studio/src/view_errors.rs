//! Why a recorded run cannot be viewed.

use opruga::io::recording::RecordingError;

opruga::math::messages! {
    /// Why a recorded run cannot be viewed.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ViewError {
        /// A program controlled the run, and its actions are not part of the scene.
        "recording.led" #[error("a program has led this run, which the text of a scene cannot say")] #[hint("`opruga replay` shows it")]
        Led {},
        /// The scene is not text.
        "recording.scene" #[error("the scene inside is no text in UTF-8")]
        SceneNotUtf8 {},
        /// An override of the run has an invalid value.
        "recording.override" #[error("`{path}` is set to `{value}`, which is no value")]
        NoValue { path: String, value: String },
        /// An override of the run names nothing in the scene.
        "recording.override" #[error("`{path}` leads to nothing in the scene")]
        NoPath { path: String },
        /// It contains no state.
        "recording.no_frame" #[error("the recording holds no frame")]
        Empty {},
        /// The scene inside and the states are inconsistent.
        "recording.other_program" #[error("its scene does not lead to its first state: another program has recorded it")]
        OtherProgram {},
        /// Its end is damaged.
        "recording.damaged" #[error("behind frame {frame}: {cause}")]
        DamagedBehind { frame: u64, cause: RecordingError },
        /// A state cannot be read.
        "recording.damaged" #[error("{cause}")]
        State { cause: RecordingError },
    }
}
