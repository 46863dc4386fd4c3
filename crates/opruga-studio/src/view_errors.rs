//! Why a recorded run cannot be viewed.

use opruga::io::recording::RecordingError;

opruga::math::messages! {
    /// Why a recorded run cannot be viewed.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ViewError {
        /// What a program did during the run is no part of its scene.
        "recording.led" #[error("a program has led this run, which the text of a scene cannot say")] #[hint("`opruga replay` shows it")]
        Led {},
        /// The scene is no text.
        "recording.scene" #[error("the scene inside is no text in UTF-8")]
        SceneNotUtf8 {},
        /// What the call of the run set has no value.
        "recording.override" #[error("`{path}` is set to `{value}`, which is no value")]
        NoValue { path: String, value: String },
        /// What the call of the run set is not there.
        "recording.override" #[error("`{path}` leads to nothing in the scene")]
        NoPath { path: String },
        /// None of its states is there.
        "recording.no_frame" #[error("the recording holds no frame")]
        Empty {},
        /// The scene inside and the states do not agree.
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
