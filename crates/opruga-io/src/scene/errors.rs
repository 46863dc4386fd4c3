//! Errors and warnings of the scene reader, by subject.

use opruga_core::spec;
use opruga_math::message::{AnyMessage, Field, IntoField};
use opruga_math::words::{counted, number};
use opruga_math::{messages, terms};
use opruga_mesh::MeshError;

/// `is` or `are`.
fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// Returns a phrase that names a line; empty if the line is unknown.
fn in_line(line: &Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(" in line {line}"))
}

/// The fields for the mass of a body, of which exactly one is given.
const MASSES: &str = "mass, density, density_of_cells, node_mass";

terms! {
    /// The type of a value in a scene.
    pub(crate) enum ValueKind = "part.value_kind" {
        Table = "a table",
        List = "a list",
        Text = "a text",
        Whole = "a whole number",
        Number = "a number",
        Truth = "a truth value",
        Date = "a date",
    }
}

terms! {
    /// What is expected at some point of a scene.
    pub(crate) enum Wanted = "part.wanted" {
        Table = "a table",
        Tables = "a list of tables",
        Text = "a text",
        Selector = "a table such as {{ all = true }}",
        Selectors = "a list of selectors",
        Node = "the number of a node, \"nearest\" or \"nearest_facet\"",
        Counts = "a list of whole numbers such as [10, 5]",
        Recorded = "a list of any of position, velocity, reaction, contact, stress, volume_ratio",
        Body = "the name of a body or its number",
    }
}

terms! {
    /// What a table of a scene describes.
    pub(crate) enum Part = "part.scene_part" {
        Shape = "shape",
        Model = "model",
        Integrator = "integrator",
        Collider = "collider",
        Load = "load",
        Command = "command",
    }
}

/// A field of a kind or of a section. Translations list such a field among the names of kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FieldOf {
    /// What the kind belongs to; none for a section of the format.
    pub part: Option<Part>,
    pub kind: &'static str,
    pub about: &'static spec::Field,
}

impl IntoField for FieldOf {
    fn field(&self) -> Field {
        let part = match self.part {
            Some(Part::Shape) => "shape",
            Some(Part::Model) => "model",
            Some(Part::Integrator) => "integrator",
            Some(Part::Collider) => "obstacle",
            Some(Part::Load | Part::Command) | None => "scene",
        };
        Field::Text(format!("{part}-{}-{}", self.kind.replace('.', "_"), self.about.name))
    }
}

messages! {
    /// What is allowed, if the message does not say it.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SceneAllowed {
        "part.scene_allowed" #[error("whole numbers between -9007199254740992 and 9007199254740992 (2^53)")]
        Wholes {},
        "part.scene_allowed" #[error("the angle in radians, counter-clockwise")]
        Angle {},
        "part.scene_allowed" #[error("the angular velocity in rad/s, counter-clockwise")]
        Spin {},
        "part.scene_allowed" #[error("three numbers: the axis multiplied by the angle about it in radians")]
        AngleInSpace {},
        "part.scene_allowed" #[error("three numbers: the axis multiplied by the angular speed about it in rad/s")]
        SpinInSpace {},
        "part.scene_allowed" #[error("1 to {dimension} whole numbers, each at least 1")]
        Counts { dimension: usize },
        "part.scene_allowed" #[error("exactly one of {fields}")]
        OneOf { fields: String },
        "part.scene_allowed" #[error("none: there is nothing to change")]
        NothingToChange {},
        "part.scene_allowed" #[error("the scene has no bodies")]
        NoBodies {},
        "part.scene_allowed" #[error("{count} bodies, by name or by number from 0 to {last}")]
        Bodies { count: usize, last: usize },
        "part.scene_allowed" #[error("there are none")]
        ThereAreNone {},
        "part.scene_allowed" #[error("rings apart from each other, or one inside the other")]
        RingsApart {},
        "part.scene_allowed" #[error("only holes (negative radius) inside a ring, and only rings inside a hole")]
        HolesInRings {},
        "part.scene_allowed" #[error("holes inside a ring of positive radius")]
        HolesInside {},
    }

    /// A property of a body that a field requires.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum BodyCondition {
        "part.condition" #[error("for a body that a lattice fills")]
        Lattice {},
    }

    /// What helps, if the message does not say it.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SceneHint {
        "part.scene_hint" #[error("{}", field.about.documentation)]
        Purpose { field: FieldOf },
        "part.scene_hint" #[error("write it without quotes")]
        NoQuotes {},
        "part.scene_hint" #[error("write larger numbers with a decimal point")]
        DecimalPoint {},
        "part.scene_hint" #[error("`{word}` is misspelt")]
        Misspelt { word: String },
        "part.scene_hint" #[error("begin the file with format = \"{format}\"")]
        BeginFormat { format: &'static str },
        "part.scene_hint" #[error("write [{name}]")]
        Section { name: String },
        "part.scene_hint" #[error("write [[{name}]]")]
        Sections { name: String },
        "part.scene_hint" #[error("write {name} = [ {{ … }} ]")]
        Inline { name: String },
        "part.scene_hint" #[error("`contact = {{ touch = false }}` lets the body pass through all others, `contact = {{ self = false }}` through itself; `[[contact.pair]]` with `touch = false` lets two groups pass through one another")]
        PassThrough {},
        "part.scene_hint" #[error("a section `[contact]` keeps all bodies apart; values in `contact = {{ … }}` of a body replace those of the section")]
        KeepApart {},
        "part.scene_hint" #[error("leave out the section `[contact]`, and bodies pass through one another")]
        NoSection {},
        "part.scene_hint" #[error("`{table}.kind` was set to `{kind}`, but the other fields were kept; --set {table}={kind} uses the defaults of this kind")]
        KindSet { table: String, kind: &'static str },
        "part.scene_hint" #[error("`{table}.kind` was set to `{kind}`, but the other fields were kept; --set '{table}={{kind=\"{kind}\"{needed}}}' replaces them")]
        KindSetWith { table: String, kind: &'static str, needed: String },
        "part.scene_hint" #[error("`{name}` has {count} copies: `{name}[0]` … `{name}[{last}]`")]
        Copies { name: String, count: usize, last: usize },
        "part.scene_hint" #[error("1.5708 is a quarter of a turn (90°)")]
        QuarterTurn {},
        "part.scene_hint" #[error("[0, 0, 1.5708] turns by 90° about z, [0.5236, 0, 0] by 30° about x; 1° is 0.0174533")]
        TurnsInSpace {},
        "part.scene_hint" #[error("[0, 0, 6.2832] turns once a second about z")]
        SpinsInSpace {},
        "part.scene_hint" #[error("at the start, the body lies between {low} and {high}")]
        Extent { low: String, high: String },
        "part.scene_hint" #[error("every body needs a unique name; use `copies` for many identical bodies")]
        OwnName {},
        "part.scene_hint" #[error("the command `do = \"change\"` gives a body other models or another integrator")]
        Change {},
        "part.scene_hint" #[error("`simplices = true` cuts them into triangles or tetrahedra")]
        Simplices {},
        "part.scene_hint" #[error("rings are counted from 0; `centers` moves them")]
        Centers {},
        "part.scene_hint" #[error("rings are counted from 0; to keep two chambers of gas apart, put a hole between them or use two bodies")]
        TwoChambers {},
        "part.scene_hint" #[error("[[0.1, 0], [0, 0]] stretches along x, [[0, 1], [0, 0]] shears")]
        Gradient {},
        "part.scene_hint" #[error("[[0.1, 0, 0], [0, 0, 0], [0, 0, 0]] stretches along x")]
        GradientInSpace {},
        "part.scene_hint" #[error("`opruga list` shows the scenes that come with the program")]
        ListScenes {},
        "part.scene_hint" #[error("commands begin and end with the first frame that begins at their time or later; here a frame begins every {} s", number(*frame))]
        Frames { frame: f64 },
    }

    /// Errors in a field of any table.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum FieldError {
        "scene.range" #[error("`{field}` is {value}")] #[value("{value}")]
        Is { field: String, value: String },
        "scene.type" #[error("`{field}` is {kind}")] #[value("{value}")]
        Type { field: String, kind: ValueKind, value: String },
        "scene.unknown_word" #[error("`{field}` is {value}")] #[value("{value}")]
        Word { field: String, value: String },
        "scene.not_finite" #[error("`{field}` is not finite")] #[value("{value}")]
        NotFiniteField { field: String, value: String },
        "scene.not_finite" #[error("`{field}` is too large for a 64-bit number")] #[value("{value}")]
        TooLarge { field: String, value: String },
        "scene.length" #[error("`{field}` has {}", counted(*count as u64, "number", "numbers"))] #[value("{value}")]
        Length { field: String, count: usize, value: String },
        "scene.range" #[error("t does not increase: {time} follows {before}")] #[value("{value}")]
        NotRising { time: f64, before: f64, value: String },
        "scene.type" #[error("`{field}` is a list of lists")] #[value("{value}")]
        #[hint("write the numbers of all lists one after another, in a single list")]
        Lists { field: String, value: String },
        "scene.range" #[error("`rotation` is {value}: rounding loses the direction of so large an angle")] #[value("{value}")]
        #[allowed("angles within 1e6 radians")] #[hint("whole turns of 6.283185307179586 radians change nothing")]
        Angle { value: String },
        "scene.missing" #[error("{fields} {} missing from `{table}`", are(*count))]
        Missing { fields: String, count: usize, table: &'static str },
        "scene.missing" #[error("{fields} {} missing from the scene", are(*count))]
        MissingInScene { fields: String, count: usize },
        "scene.missing" #[error("`{tag}` is missing from `{table}`")]
        NoTag { tag: String, table: Part },
        "scene.dimension" #[error("`{kind}` does not exist in {dimension}D")] #[value("{kind}")] #[allowed("dimension {dimensions}")]
        KindDimension { kind: &'static str, dimension: usize, dimensions: String },
        "scene.unknown_kind" #[error("there is no {table} `{word}`")] #[value("{word}")]
        NoKind { table: Part, word: String },
        "scene.unknown_field" #[error("there is no field `{field}` in `{table}`")] #[value("{field}")]
        NoField { field: String, table: &'static str },
        "scene.unknown_field" #[error("there is no field `{field}`")] #[value("{field}")]
        NoFieldInScene { field: String },
        "scene.no_effect" #[error("`{field}` has no effect here; it has an effect only {condition}")] #[value("{value}")]
        NoEffect { field: &'static str, condition: AnyMessage, value: String },
        "scene.format" #[error("the format is {value}")] #[value("{value}")] #[allowed("{readable}")]
        #[hint("this version reads opruga-1 only; another version of the program may read this scene")]
        Format { value: String, readable: String },
        "scene.format" #[error("the format is missing")] #[allowed("{readable}")]
        NoFormat { readable: String },
        "scene.dimension" #[error("`dimension` is {value}")] #[value("{value}")] #[allowed("2 or 3")]
        WrongDimension { value: String },
        "scene.missing" #[error("`dimension` is missing")] #[allowed("2 or 3")]
        NoDimension {},
        "scene.more" #[error("and {count} more")] #[value("{count}")]
        More { count: usize },
    }

    /// Errors in a body, its shape or its initial motion.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum BodyError {
        "scene.not_here" #[error("a body that a command adds cannot have copies")] #[hint("write one command for every body")]
        NoCopies {},
        "scene.no_values" #[error("the cells of the mesh have no numbers `{name}`")] #[value("{name}")]
        NoCellNumbers { name: String },
        "scene.range" #[error("the density of cell {cell} is {density} kg/m³")] #[value("{density}")] #[allowed("a number > 0")]
        Density { cell: usize, density: f64 },
        "scene.missing" #[error("the body has no mass")] #[allowed("exactly one of {MASSES}")] #[hint("a body that never moves has `fixed = true`")]
        NoMass {},
        "scene.conflict" #[error("the body has `{first}` and `{second}`")] #[allowed("exactly one of {MASSES}")]
        SeveralMasses { first: String, second: String },
        "scene.shape" #[error("`{field}` applies to cells, but the shape has none")]
        #[hint("filled shapes are `grid`, files with a `filling`, and `mesh`")]
        NoCells { field: &'static str },
        "scene.range" #[error("`scale` is {value}: products of such small lengths are zero")] #[value("{value}")] #[allowed("from 1e-70")]
        #[hint("coordinates are in metres: `scale = 1e-6` turns them into micrometres")]
        Tiny { value: String },
        "scene.range" #[error("`{field}` is {value}: products of such lengths overflow")] #[value("{value}")]
        #[allowed("coordinates within 1e70 m of the origin of the shape")]
        Vast { field: String, value: String },
        "scene.range" #[error("`{field}` makes the shape too large: products of such lengths overflow")] #[value("{value}")]
        #[allowed("coordinates within 1e70 m of the origin of the shape")]
        MadeVast { field: &'static str, value: String },
        "scene.missing" #[error("`density` of a wire needs its width, which `thickness` gives")] #[allowed("a number > 0")]
        #[hint("or give the `mass` of the whole body")]
        WireWidth {},
        "scene.missing" #[error("`density` of a sheet needs its `thickness`")] #[allowed("a number > 0")]
        #[hint("or give the `mass` of the whole body")]
        SheetThickness {},
        "scene.missing" #[error("the body is hollow, and `density` of a hollow body needs the `thickness` of its wall")] #[allowed("a number > 0")]
        #[hint("or give the `mass` of the whole body, or fill it: with a `filling` of its shape, or as a `grid`")]
        WallThickness {},
        "scene.shape" #[error("a coordinate of the shape is {value}")] #[allowed("finite coordinates")]
        NotFiniteShape { value: f64 },
        "shape.flipped" #[error("the points of `{body}` run clockwise")] #[hint("the edges of the outline run counter-clockwise, against the order of the points")]
        Clockwise { body: String },
        "scene.conflict" #[error("the body has `angular_velocity` and `velocity.angular`")] #[value("{value}")] #[allowed("one of them")]
        TwoSpins { value: String },
        "scene.length" #[error("`gradient` has {}", counted(*count as u64, "row", "rows"))] #[value("{value}")]
        #[allowed("{dimension} rows of {dimension} finite numbers: the derivatives of each component of the velocity along the axes")]
        Gradient { count: usize, dimension: usize, value: String },
        "scene.no_values" #[error("the nodes of the mesh have no vectors `{name}`")] #[value("{name}")]
        #[hint("vectors of nodes come from `$NodeData` in Gmsh files, `POINT_DATA` in VTK files and `<PointData>` in VTU files")]
        NoNodeVectors { name: String },
        "scene.no_values" #[error("`{name}` must come from a mesh file, but the shape is a `{kind}`")] #[value("{name}")]
        #[hint("`kind = \"mesh\"` reads one")]
        NotAMeshFile { name: String, kind: String },
        "scene.length" #[error("`{name}` has {} per node", counted(*components as u64, "number", "numbers"))] #[value("{components}")]
        #[allowed("2, or 3 of which the last is 0")] #[hint("a velocity is a vector")]
        ComponentsInPlane { name: String, components: usize },
        "scene.length" #[error("`{name}` has {} per node", counted(*components as u64, "number", "numbers"))] #[value("{components}")]
        #[allowed("3")] #[hint("a velocity is a vector")]
        ComponentsInSpace { name: String, components: usize },
        "scene.not_finite" #[error("`{name}` of node {node} is {value}")] #[value("{value}")]
        #[allowed("finite numbers for every node")] #[hint("nodes are counted from 0")]
        NodeValue { name: String, node: usize, value: String },
        "scene.dimension" #[error("`{name}` of node {node} leaves the plane")] #[value("{z}")] #[allowed("0 along z")]
        #[hint("nodes are counted from 0; a 3D scene has `dimension = 3` at its top")]
        LeavesPlane { name: String, node: usize, z: f64 },
        "scene.range" #[error("{problem}")]
        Rotation { problem: MeshError },
        "scene.range" #[error("`{name}` becomes {value} when it is rotated with the body")] #[value("{value}")] #[allowed("finite numbers")]
        Turned { name: String, value: f64 },
        "scene.conflict"
        #[error("node {node} of body `{body}` is also held by `{pin}`{}, which moves it elsewhere along {axis} at t = {time} s", in_line(line))]
        #[allowed("one motion for every node along every axis")]
        #[hint("use selectors without common nodes, or give the pins different `axes`")]
        PinnedTwice { node: u32, body: String, pin: String, line: Option<usize>, axis: &'static str, time: f64 },
        "scene.range" #[error("`axes` is \"{letters}\"")] #[value("{letters}")] #[allowed("one of \"x\", \"y\", \"xy\"")] #[hint("there is no z in 2D")]
        Axes { letters: String },
    }

    /// Errors in a command.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CommandError {
        "scene.missing" #[error("`until` is missing: a path of one point does not define when the drag ends")]
        #[allowed("a time after {at}")] #[hint("a path of several points ends the drag at its last point")]
        NoEnd { at: f64 },
        "scene.range" #[error("the command ends at {until} s, before it begins at {at} s")] #[value("{until}")] #[allowed("a time from {at}")]
        EndsBefore { until: f64, at: f64 },
        "scene.range" #[error("the command ends at {until} s, before it begins at {at} s")] #[value("{until}")] #[allowed("a time after {at}")]
        LastsNegative { until: f64, at: f64 },
        "scene.range" #[error("the command ends at {until} s, as soon as it begins at {at} s")] #[value("{until}")] #[allowed("a time after {at}")]
        EndsAtOnce { until: f64, at: f64 },
        "scene.missing" #[error("the command changes nothing")] #[allowed("`models`, `integrator` or both")]
        ChangesNothing {},
        "scene.range" #[error("the command begins at {at} s, before `{body}` is added at {added} s")] #[value("{at}")] #[allowed("a time from {added}")]
        BeforeAdded { at: f64, body: String, added: f64 },
        "scene.range" #[error("the command begins at {at} s, after `{body}` is removed at {removed} s")] #[value("{at}")]
        #[allowed("a time before {removed}")]
        AfterRemoved { at: f64, body: String, removed: f64 },
        "command.never" #[error("the command begins at {at} s, but the run ends at {end} s")] #[value("{at}")]
        #[hint("it takes effect only in a run with a larger --seconds")]
        AfterEnd { at: f64, end: f64 },
        "command.never" #[error("the command begins at {at} s, and no frame of the run begins then or later")] #[value("{at}")]
        #[hint("commands begin with a frame; this one takes effect only in a run with a larger --seconds")]
        NoFrame { at: f64 },
        "command.never" #[error("the command begins at {at} s and ends at {until} s, and no frame begins in between")] #[value("{until}")]
        BetweenFrames { at: f64, until: f64 },
        "command.never" #[error("`{parameter}` is set at {first} s and again at {second} s, and no frame begins in between")] #[value("{first}")]
        SetAgain { parameter: String, first: f64, second: f64 },
        "scene.range" #[error("`{parameter}` cannot be {value}")] #[value("{value}")]
        CannotBe { parameter: String, value: String },
        "scene.unknown_parameter" #[error("`{parameter}` is not a parameter that can change during a run")]
        NotInRun { parameter: String },
        "scene.unknown_parameter" #[error("there is no collider `{collider}`")]
        NoCollider { collider: String },
        "scene.unknown_parameter" #[error("this body has no model `{model}`")]
        NoModel { model: String },
        "scene.unknown_parameter" #[error("there is no body `{body}`")]
        NoBodyOfPath { body: String },
        "scene.unknown_parameter" #[error("there is no parameter `{parameter}` of `{kind}`")]
        NoParameter { parameter: String, kind: &'static str },
        "scene.unknown_parameter" #[error("body `{body}` has no integrator of its own")] #[allowed("integrator.FIELD")]
        NoIntegrator { body: String },
        "scene.unknown_parameter" #[error("`{parameter}` is not a parameter")]
        NotAParameter { parameter: String },
    }

    /// Errors in the references of a load, a probe or a selector, or in a picture.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ReferenceError {
        "scene.unknown_name" #[error("there is no body `{body}`")] #[value("{body}")]
        NoBodyCalled { body: String },
        "scene.unknown_name" #[error("there is no body {index}")] #[value("{index}")]
        NoBodyAt { index: i64 },
        "scene.selects_nothing" #[error("no facet of the boundary of `{body}` has all of its nodes selected by the load")]
        #[allowed("all nodes of at least one facet: an edge of the outline, or a triangle of the surface")]
        #[hint("`side`, `group` and `boundary` select whole sides; `kind = \"force\"` acts on nodes")]
        NoFacet { body: String },
        "scene.selects_nothing" #[error("no facet of the boundary of `{body}` has all of its nodes selected by the load")]
        #[allowed("bodies that have a boundary")] #[hint("a chain has none; `kind = \"force\"` acts on nodes")]
        NoBoundary { body: String },
        "scene.selects_nothing" #[error("the load acts on the volume of cells, and `{body}` has no cells")] #[value("\"body_force\"")]
        #[allowed("filled bodies: `grid`, shapes with a `filling`, volume meshes")]
        #[hint("`kind = \"force\"` acts on nodes; `world.gravity` acts on everything that has mass")]
        NoCellsToLoad { body: String },
        "scene.selects_nothing" #[error("no cell of `{body}` has all of its nodes selected by the load")]
        #[allowed("all nodes of at least one cell")]
        #[hint("without `select` the load acts on all cells; `group` selects those of a mesh file")]
        NoCell { body: String },
        "scene.length" #[error("`record` is empty")] #[value("[]")]
        RecordsNothing {},
        "scene.duplicate_name" #[error("`record` contains `{word}` twice")] #[value("{word}")]
        RecordedTwice { word: &'static str },
        "scene.unknown_word" #[error("`record` contains {value}")] #[value("{value}")]
        Records { value: String },
        "scene.no_stress" #[error("`{word}` is recorded for `{body}`, none of whose models computes stress")] #[value("{word}")]
        #[allowed("bodies with a model of the kind {kinds}")] #[hint("`reaction` and `contact` are forces, which every body has")]
        NoStress { word: &'static str, body: String, kinds: String },
        "scene.selector" #[error("a selector must have exactly one key, but this one has {count}")] #[value("{value}")]
        #[hint("combine sets with {{ and = [ … ] }} or {{ or = [ … ] }}")]
        Keys { count: usize, value: String },
        "scene.selector" #[error("`{field}` is {value}")] #[value("{value}")] #[allowed("true")]
        NotTrue { field: String, value: String },
        "scene.length" #[error("`box` has {count} corners")] #[value("{value}")] #[allowed("two opposite corners")]
        Corners { count: usize, value: String },
        "scene.range" #[error("`normal` is zero")] #[allowed("a vector that is not zero")]
        NoNormal {},
        "scene.length" #[error("`{field}` is empty")] #[value("[]")] #[allowed("a list of at least one selector")]
        NoSelectors { field: String },
        "scene.unknown_field" #[error("there is no selector `{word}`")] #[value("{word}")]
        NoSelector { word: String },
        "scene.missing" #[error("`{one}` is one corner of a box, but the other corner, `{other}`, is missing")]
        #[hint("give both corners, or neither to show everything")]
        OneCorner { one: &'static str, other: &'static str },
        "scene.range" #[error("the box that pictures show is empty")] #[value("{high}")] #[allowed("on every axis more than `low` = {low}")]
        EmptyBox { low: String, high: String },
        "scene.dimension" #[error("`{field}` turns the camera, which only 3D scenes have")] #[allowed("in scenes with `dimension = 3`")]
        Camera { field: &'static str },
    }
}

/// All messages of the scene reader.
pub(crate) const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    ValueKind::VARIANTS,
    Wanted::VARIANTS,
    Part::VARIANTS,
    SceneAllowed::VARIANTS,
    SceneHint::VARIANTS,
    BodyCondition::VARIANTS,
    FieldError::VARIANTS,
    BodyError::VARIANTS,
    CommandError::VARIANTS,
    ReferenceError::VARIANTS,
];

impl Wanted {
    /// Whether a number would be accepted.
    pub(crate) fn takes_numbers(self) -> bool {
        matches!(self, Wanted::Node | Wanted::Counts | Wanted::Body)
    }
}
