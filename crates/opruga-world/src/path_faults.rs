//! Messages about invalid names of parts of a world that a program or a command gives, and about errors in snapshots.

use opruga_core::spec::AllowedValues;
use opruga_math::words::number;
use opruga_math::{messages, terms};

/// The forms of the paths of parameters that may change.
pub(crate) const FORMS: &str = "body.NAME.models.KIND.FIELD, body.NAME.integrator.FIELD, integrator.FIELD, collider.NUMBER.FIELD, contact.FIELD, world.gravity, world.drag, \
                     world.largest_force, world.largest_velocity, world.largest_distance, \
                     world.unfold, time.substeps";

/// The hint that names the nearest word; empty if there is none.
fn did_you_mean(word: &Option<String>) -> String {
    word.as_ref().map_or_else(String::new, |word| format!("did you mean `{word}`?"))
}

messages! {
    /// Reasons why a path, a name or a value does not fit a world.
    #[derive(Clone, Debug, PartialEq)]
    pub enum PathFault {
        "part.path" #[error("there is no such body")]
        NoBody {},
        "part.path" #[error("there is no body `{name}`")] #[hint("{}", did_you_mean(nearest))]
        NoBodyCalled { name: String, nearest: Option<String> },
        "part.path" #[error("there is no such body at t = {} s, when a command begins", number(*time))]
        NoBodyThen { time: f64 },
        "part.path" #[error("body `{body}` has no model `{kind}`")] #[allowed("{known}")]
        NoModel { body: String, kind: String, known: String },
        "part.path" #[error("body `{body}` uses the integrator of the scene; its parameter is integrator.{field}")]
        FollowsScene { body: String, field: String },
        "part.path" #[error("there is no such integrator")]
        NoSuchIntegrator {},
        "part.path" #[error("there is no collider {collider}")] #[allowed("the scene has none")]
        NoColliders { collider: String },
        "part.path" #[error("there is no collider {collider}")] #[allowed("0 to {last}")]
        NoCollider { collider: String, last: usize },
        "part.path" #[error("there is no such kind of collider")]
        NoColliderKind {},
        "part.path" #[error("the scene has no `[contact]`, without which bodies pass through one another")] #[allowed("in a scene with `[contact]`")]
        NoContact {},
        "part.path" #[error("is {value}")] #[allowed("{allowed}")]
        Is { value: String, allowed: AllowedValues },
        "part.path" #[error("is {value}")] #[allowed("{allowed}")]
        IsText { value: String, allowed: String },
        "part.path" #[error("is {value}")] #[allowed("a vector with a length above 0")]
        NoDirection { value: String },
        "part.path" #[error("is {value}")] #[allowed("finite numbers")]
        NotFinite { value: String },
        "part.path" #[error("there is no `{field}` in `world`")] #[allowed("{known}")] #[hint("{}", did_you_mean(nearest))]
        NoFieldOfWorld { field: String, known: String, nearest: Option<String> },
        "part.path" #[error("it is not a parameter")] #[allowed("{FORMS}")]
        NotAParameter {},
        "part.path" #[error("there is no such node")] #[allowed("0 to {last}")]
        NoNode { last: usize },
        "part.path" #[error("{value} is neither a position nor a velocity")] #[allowed("finite numbers")]
        NoPosition { value: f64 },
        "part.path" #[error("the threads cannot start: {reason}")]
        Threads { reason: String },
        "part.path" #[error("the name is taken")]
        Taken {},
        "part.path" #[error("the command must begin now, at {now} s, but it begins at {at} s")]
        NotNow { at: f64, now: f64 },
        "part.path" #[error("there is no such command")]
        NoCommand {},
        "part.path" #[error("only a drag has a path")]
        NoDrag {},
        "part.path" #[error("each row of the path must contain a time that is later than in the row before, and a point; all numbers must be finite")]
        Row {},
        "part.path" #[error("it begins at {at} s and cannot end at {until} s")]
        CannotEnd { at: f64, until: f64 },
        "part.path" #[error("a force that the program defines cannot be recorded")]
        ForceUnrecorded {},
        "part.path" #[error("a command that the program controls while it acts cannot be recorded")] #[hint("save the scene with it instead")]
        ActUnrecorded {},
        "part.path" #[error("a body that the program adds cannot be recorded")]
        BodyUnrecorded {},
        "part.path" #[error("models that the program gives a body cannot be recorded")]
        ModelsUnrecorded {},
        "part.path" #[error("this cannot be recorded")]
        Unrecorded {},
        "part.path" #[error("a scene file cannot express it")]
        NoForm {},
        "part.path" #[error("the scene has another dimension")]
        OtherDimension {},
        "part.path" #[error("no command of the scene has added a body yet")]
        AddsNothing {},
        "part.path" #[error("no cell of the body has all of its nodes selected")] #[allowed("all nodes of at least one cell")]
        NoCells {},
        "part.path" #[error("no facet of the boundary has all of its nodes selected")] #[allowed("all nodes of at least one facet")]
        NoFacets {},
    }

    /// Errors in a snapshot.
    #[derive(Clone, Debug, PartialEq)]
    pub enum SnapshotFault {
        "part.snapshot" #[error("it declares {count} {what}, more than it contains")]
        Promises { count: u64, what: Promised },
        "part.snapshot" #[error("it ends too early")]
        EndsEarly {},
        "part.snapshot" #[error("a text is not valid UTF-8")]
        Text {},
        "part.snapshot" #[error("a value is of an unknown kind")]
        Value {},
        "part.snapshot" #[error("the channel `{channel}` is of an unknown type")]
        Channel { channel: String },
        "part.snapshot" #[error("the channel `{channel}` holds {number}")]
        ChannelNumber { channel: String, number: f64 },
        "part.snapshot" #[error("it contains {what} of an unknown kind")]
        Unknown { what: Content },
        "part.snapshot" #[error("it contains `{kind}`, which is an unknown kind")]
        UnknownKind { kind: String },
        "part.snapshot" #[error("its gravity is missing")]
        Gravity {},
        "part.snapshot" #[error("it has more substeps than a frame may have")]
        Substeps {},
        "part.snapshot" #[error("it changes an obstacle that does not exist")]
        NoObstacle {},
        "part.snapshot" #[error("it changes a body that does not exist")]
        NoBody {},
        "part.snapshot" #[error("it contains a body that no command of this scene adds")]
        NotAdded {},
        "part.snapshot" #[error("a body uses the mesh of a body that does not exist")]
        NoMesh {},
        "part.snapshot" #[error("the origin of a body is of an unknown kind")]
        FromNowhere {},
        "part.snapshot" #[error("in `{kind}`, {problem}")]
        Field { kind: String, problem: opruga_core::spec::ValueError },
        "part.snapshot" #[error("an input of a program is of an unknown kind")]
        Input {},
        "part.snapshot" #[error("its version is not {version}")]
        Version { version: u64 },
        "part.snapshot" #[error("its contact impulses are invalid")]
        Contact {},
        "part.snapshot" #[error("it has another dimension")]
        Dimension {},
        "part.snapshot" #[error("it has a different number of bodies")]
        BodyCount {},
        "part.snapshot" #[error("a body and its slot contradict each other")]
        BodyPlace {},
        "part.snapshot" #[error("the generation of a body is higher than any assigned so far")]
        Generation {},
        "part.snapshot" #[error("body `{body}` has another shape")]
        OtherShape { body: String },
        "part.snapshot" #[error("body `{body}` has a number that is not finite")]
        NotFinite { body: String },
        "part.snapshot" #[error("it has a different number of commands")]
        CommandCount {},
        "part.snapshot" #[error("a command refers to something that does not exist")]
        CommandHolds {},
        "part.snapshot" #[error("a command is in an unknown state")]
        CommandState {},
        "part.snapshot" #[error("bytes follow its end")]
        GoesOn {},
        "part.snapshot" #[error("bytes follow the end of the part about the scene")]
        SceneGoesOn {},
        "part.snapshot" #[error("it does not belong to two scenes side by side")]
        NoPair {},
    }
}

terms! {
    /// The content that a snapshot announces.
    pub enum Promised = "part.promised" { Bytes = "bytes", Numbers = "numbers", Letters = "bytes of a text" }
}

terms! {
    /// The content of a snapshot that is of an unknown kind.
    pub enum Content = "part.content" { Body = "a body", Mass = "a mass", Pin = "a pin", Command = "a command" }
}
