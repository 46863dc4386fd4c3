//! Reports to the user, as data: the interface puts them into words of its language ([`crate::words`]).

use crate::exploded::Exploded;
use crate::view_errors::ViewError;
use crate::words::Language;
use opruga::draw::DrawError;
use opruga::io::SceneError;
use opruga::io::safe_write::WriteError;
use opruga::{Warning, WorldError};

/// An action that can be undone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A parameter was set, by its path.
    Set(String),
    /// The models of a body were changed.
    Models,
    /// The integrator of the scene or of a body was changed.
    Integrator,
    /// A body was added.
    Add,
    /// A body was copied.
    Duplicate,
    /// A body was moved.
    Move,
    /// A body was rotated.
    Turn,
    /// A body was scaled.
    Scale,
    /// Contact was switched on or off.
    Contact,
    /// A field of a body's shape was changed.
    Shape(&'static str),
    /// A body was deleted.
    Delete,
    /// A scene was opened instead of the scene of this name.
    Open(String),
    /// A body was pulled with the pointer.
    Pull,
    /// A body was pushed with the pointer.
    Push,
    /// A point was pinned, either where it was or after it was moved.
    Pin,
    /// A point was unpinned.
    Unpin,
    /// Everything that was recorded was removed.
    Reset,
    /// The comparison of the scene with itself was switched on or off.
    Compare,
    /// The right side was changed in this respect.
    Differ(String),
}

/// The contents of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// The errors of a scene or its files.
    Scene(Vec<SceneError>),
    /// An error of the world.
    World(WorldError),
    /// Why a recorded run cannot be viewed.
    Recording(ViewError),
    /// A file cannot be written.
    NotWritten(WriteError),
    /// A picture or a film cannot be made.
    NotDrawn(DrawError),
    /// An error in the contents of the file with this name.
    Inside(String, Box<Report>),
    /// A scene cannot be compressed.
    NotCompressed,
    /// A body has grown to many times its size, and time was stopped.
    Exploded(Exploded),
    /// This was undone; the scene is at this time \[s\].
    Undone(Step, f64),
    /// This was redone; the scene is at this time \[s\].
    Redone(Step, f64),
    /// The scene starts again, without the pins that were set with the pointer.
    PinsLetGo,
    /// The body of this name continues to move with other models.
    GoesOn(String),
    /// All bodies continue to move with an integrator of this kind.
    AllGoOn(String),
    /// A body was replaced.
    SetDown,
    /// The field with this path can be added or removed only at the start.
    AtTheStartAlone(String),
    /// Contact between bodies can be switched on and off only at the start.
    ContactAtTheStartAlone,
    /// The scene has reached its end, at this time \[s\], with these warnings.
    AtTheEnd(f64, Vec<Warning>),
    /// The recording that is viewed ends at this time \[s\].
    RecordingEnds(f64),
    /// The user's action starts a run that differs from the recording from this time \[s\] on.
    OwnCourse(f64),
    /// A frame takes longer than this many seconds, and the page cannot respond in the meantime.
    TakesLong(f64),
    /// There is no body of this name.
    NoBody(String),
    /// The body of this name has no shape that can be changed.
    NoShape(String),
    /// The body of this name is one of several copies.
    Copy(String),
    /// A body cannot be scaled by this factor.
    Scaled(f64),
    /// The requested difference of the two sides concerns a value that is not written in the scene itself.
    NoDifference(String),
    /// The file with this name does not contain text.
    NoText(String),
    /// A file is neither a scene nor a shape. Contains the name of the file and the endings of scenes and shapes.
    NoShapeFile(String, String),
    /// The name of a file cannot be used in a scene.
    NameOfFile(String),
    /// A file is too large. Contains the name and the size of the file, and the limit [bytes].
    TooLarge(String, u64, u64),
    /// A file cannot be read.
    Unreadable(String),
    /// Files were written.
    Written(Vec<String>),
    /// The folder cannot be made, with the reason.
    NoFolder(String, String),
    /// The folder has no free name left.
    FolderFull(String),
    /// The browser did not accept a file for download.
    NoDownload(String),
    /// There is nothing to draw.
    NothingToDraw,
    /// The link was copied.
    LinkCopied,
    /// A scene has too many characters for an address. Contains the number of characters and the limit.
    AddressTooLong(usize, usize),
    /// The address names no known scene. Contains the names that an address may contain.
    AddressUnknown(String),
    /// The scene in the address is truncated.
    AddressCut,
    /// The scene in the address is larger than this many bytes.
    AddressTooLarge(u64),
    /// The browser did not change its address.
    AddressStays,
    /// The previous window was lost; its work is saved in this file.
    WindowLost(String),
}

impl core::fmt::Display for Report {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&Language::English.report(self))
    }
}

impl From<Vec<SceneError>> for Report {
    fn from(errors: Vec<SceneError>) -> Report {
        Report::Scene(errors)
    }
}

impl From<ViewError> for Report {
    fn from(error: ViewError) -> Report {
        Report::Recording(error)
    }
}

impl From<WriteError> for Report {
    fn from(error: WriteError) -> Report {
        Report::NotWritten(error)
    }
}

impl From<DrawError> for Report {
    fn from(error: DrawError) -> Report {
        Report::NotDrawn(error)
    }
}

impl From<WorldError> for Report {
    fn from(error: WorldError) -> Report {
        Report::World(error)
    }
}
