//! What is reported to the person, as data: the interface puts it into words of its language ([`crate::words`]).

use crate::exploded::Exploded;
use crate::view_errors::ViewError;
use crate::words::Language;
use opruga::draw::DrawError;
use opruga::io::SceneError;
use opruga::io::safe_write::WriteError;
use opruga::{Warning, WorldError};

/// A thing that was done and can be undone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// A parameter was set, by its path.
    Set(String),
    /// A body has other models.
    Models,
    /// The scene or a body has another integrator.
    Integrator,
    /// A body was added.
    Add,
    /// A body was copied.
    Duplicate,
    /// A body was moved.
    Move,
    /// A body was turned.
    Turn,
    /// A body was scaled.
    Scale,
    /// Contact was switched on or off.
    Contact,
    /// A field of a body's shape was changed.
    Shape(&'static str),
    /// A body was taken away.
    Delete,
    /// Another scene was opened instead of the one of this name.
    Open(String),
    /// A body was pulled by a hand.
    Pull,
    /// A body was pushed by a hand.
    Push,
    /// A point was pinned, or taken elsewhere and pinned there.
    Pin,
    /// A point was let go.
    Unpin,
    /// Everything that was recorded was taken back.
    Reset,
    /// The scene was shown twice, or no longer.
    Compare,
    /// The right side differs in this.
    Differ(String),
}

/// What a message says.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// What is wrong with a scene or its files.
    Scene(Vec<SceneError>),
    /// What a world refuses.
    World(WorldError),
    /// Why a recorded run cannot be viewed.
    Recording(ViewError),
    /// A file cannot be written.
    NotWritten(WriteError),
    /// A picture or a film cannot be made.
    NotDrawn(DrawError),
    /// This is wrong with what lies in a file of this name.
    Inside(String, Box<Report>),
    /// A scene cannot be compressed.
    NotCompressed,
    /// A body has grown beyond every measure, and time stands.
    Exploded(Exploded),
    /// This was undone, and the scene is at this time \[s\].
    Undone(Step, f64),
    /// This was done again, and the scene is at this time \[s\].
    Redone(Step, f64),
    /// The scene begins anew, without the pins of the pointer.
    PinsLetGo,
    /// A body of this name moves on with other models.
    GoesOn(String),
    /// All bodies move on with an integrator of this kind.
    AllGoOn(String),
    /// A body was set down anew.
    SetDown,
    /// A field, by its path, that is given or not from the start on.
    AtTheStartAlone(String),
    /// Contact between bodies is switched on and off at the start alone.
    ContactAtTheStartAlone,
    /// The scene is at its end, at this time \[s\], and attracts attention by this.
    AtTheEnd(f64, Vec<Warning>),
    /// The recording that is viewed ends at this time \[s\].
    RecordingEnds(f64),
    /// What was done begins a new course at this time of the recording \[s\].
    OwnCourse(f64),
    /// A frame takes longer than so many seconds, and nothing can be asked for meanwhile.
    TakesLong(f64),
    /// There is no body of this name.
    NoBody(String),
    /// A body of this name has no shape that could be changed.
    NoShape(String),
    /// A body of this name is one of several copies.
    Copy(String),
    /// A body cannot be scaled by this.
    Scaled(f64),
    /// What both sides shall differ in stands nowhere in the scene itself.
    NoDifference(String),
    /// A file is no text.
    NoText(String),
    /// A file is neither a scene nor a shape; the endings that are.
    NoShapeFile(String, String),
    /// A file whose name a scene cannot hold.
    NameOfFile(String),
    /// A file of so many bytes is too large; the most that are allowed.
    TooLarge(String, u64, u64),
    /// A file cannot be read.
    Unreadable(String),
    /// Files were written.
    Written(Vec<String>),
    /// The folder cannot be made, and why.
    NoFolder(String, String),
    /// The folder has no free name left.
    FolderFull(String),
    /// A browser does not take a file.
    NoDownload(String),
    /// There is nothing to draw.
    NothingToDraw,
    /// The link was copied.
    LinkCopied,
    /// A scene has too many letters for an address; the most that are allowed.
    AddressTooLong(usize, usize),
    /// The address names no scene; those that it could name.
    AddressUnknown(String),
    /// The scene in the address is not whole.
    AddressCut,
    /// The scene in the address is larger than so many bytes.
    AddressTooLarge(u64),
    /// The browser keeps its address.
    AddressStays,
    /// The window before was lost; what was done in it is saved in this file.
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
