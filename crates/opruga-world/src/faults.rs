//! Messages about errors in a blueprint.

use opruga_math::messages;
use opruga_math::words::number;

/// The characters and lengths that names may have.
const NAMES: &str = "1 to 256 bytes without control characters and . , [ ] = quotes; not only digits";

/// The line in which a name first occurs.
fn first_in(line: &Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(", first in line {line}"))
}

/// The characters that distinguish a name from another one.
fn points(points: &Option<String>) -> &str {
    points.as_deref().unwrap_or("nothing")
}

messages! {
    /// Errors of a name.
    #[derive(Clone, Debug, PartialEq)]
    pub enum NameFault {
        "scene.name" #[error("the name is empty")] #[value("")] #[allowed("{NAMES}")]
        Empty {},
        "scene.name" #[error("the name contains `{letter}`")] #[allowed("{NAMES}")]
        Contains { letter: String },
        "scene.name" #[error("the name is a number, but a number means the index of a body")] #[allowed("{NAMES}")]
        Number {},
        "scene.duplicate_name" #[error("two bodies are called `{name}`{}", first_in(line))] #[value("{name}")]
        TwoBodies { name: String, line: Option<usize> },
        "scene.duplicate_name" #[error("two probes are called `{name}`{}", first_in(line))] #[value("{name}")]
        TwoProbes { name: String, line: Option<usize> },
        "scene.duplicate_name"
        #[error("the names of two bodies look alike and differ only in Unicode normalisation, {} here and {} there: `{name}`{}", points(here), points(there), first_in(line))]
        #[value("{name}")]
        AlikeBodies { name: String, here: Option<String>, there: Option<String>, line: Option<usize> },
        "scene.duplicate_name"
        #[error("the names of two probes look alike and differ only in Unicode normalisation, {} here and {} there: `{name}`{}", points(here), points(there), first_in(line))]
        #[value("{name}")]
        AlikeProbes { name: String, here: Option<String>, there: Option<String>, line: Option<usize> },
    }

    /// Errors in the numbers of a blueprint, or in the names that its parts refer to.
    #[derive(Clone, Debug, PartialEq)]
    pub enum BlueprintFault {
        "scene.range" #[error("a step of {} s is lost in rounding at t = {} s: time would not advance", number(*h), number(*seconds))]
        #[value("{frame}")] #[allowed("a step that changes the time")]
        LostStep { h: f64, seconds: f64, frame: String },
        "scene.range" #[error("a run of {} s would have {} frames", number(*seconds), number(*frames))] #[value("{frame}")] #[allowed("at most 1e12 frames")]
        ManyFrames { seconds: f64, frames: f64, frame: String },
        "scene.range" #[error("body `{body}` has no node {node}")] #[value("{node}")] #[allowed("nodes from 0 to {last}")]
        NoNode { body: String, node: u32, last: usize },
        "scene.unknown_name" #[error("the mesh of `{body}` has no group `{group}`")] #[value("{group}")] #[allowed("{known}")]
        NoGroup { body: String, group: String, known: String },
        "scene.unknown_name" #[error("the mesh of `{body}` has no group `{group}`")] #[value("{group}")] #[allowed("it has no groups")]
        NoGroups { body: String, group: String },
        "scene.selects_nothing" #[error("the selector selects no node of `{body}`")]
        SelectsNothing { body: String },
        "scene.unknown_name" #[error("no body is in the group `{group}`")] #[value("{group}")] #[allowed("{known}")]
        NoMember { group: String, known: String },
        "scene.conflict" #[error("a pair of the groups `{first}` and `{second}` was given before{}", first_in(line))]
        #[value("{first}, {second}")] #[allowed("at most one pair of the same two groups, in either order")] #[hint("put all values for these groups into one `[[contact.pair]]`")]
        SamePair { first: String, second: String, line: Option<usize> },
        "scene.unknown_name" #[error("there is no body {index}")] #[value("{index}")] #[allowed("0 to {last}")]
        NoBody { index: usize, last: usize },
        "scene.unknown_name" #[error("there is no body {index}")] #[value("{index}")] #[allowed("the scene has no bodies")]
        NoBodies { index: usize },
        "scene.shape" #[error("the shape has no nodes")] #[allowed("at least one node")]
        NoNodes {},
        "scene.shape" #[error("node {node} lies at {position}")] #[allowed("coordinates within 1e70 m of the origin of the shape")]
        FarNode { node: usize, position: String },
        "scene.length" #[error("the list has {count} numbers")] #[value("{count}")] #[allowed("one for each of {cells} cells")]
        Densities { count: usize, cells: usize },
        "scene.length" #[error("{count} nodes have a velocity")] #[value("{count}")] #[allowed("none, or each of {nodes} nodes")]
        NodeVelocities { count: usize, nodes: usize },
        "scene.length" #[error("`angular_velocity` has {count} numbers")] #[value("{count}")] #[parameters("angular_velocity")] #[allowed("{wanted}")]
        AngularVelocity { count: usize, wanted: usize },
    }
}
