//! Warnings of a world as values.

use crate::error::{Crossing, Part, WorldError};
use crate::faults::{BlueprintFault, NameFault};
use crate::path_faults::{Content, PathFault, Promised, SnapshotFault};
use crate::refusals::Refusal;
use opruga_math::message::{AnyMessage, IntoField, Replacing, if_any};
use opruga_math::words::{counted, number, rounded};
use opruga_math::{messages, terms};

/// All messages of this crate, for tests of translations.
#[doc(hidden)]
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    Difference::VARIANTS,
    ErrorHint::VARIANTS,
    DampingHint::VARIANTS,
    BudgetHint::VARIANTS,
    CellHint::VARIANTS,
    BendingHint::VARIANTS,
    UnfoldHint::VARIANTS,
    InvertedCells::VARIANTS,
    Lay::VARIANTS,
    Remedy::VARIANTS,
    WorstCell::VARIANTS,
    WorldWarning::VARIANTS,
    Refusal::VARIANTS,
    Part::VARIANTS,
    Crossing::VARIANTS,
    WorldError::VARIANTS,
    PathFault::VARIANTS,
    SnapshotFault::VARIANTS,
    Promised::VARIANTS,
    Content::VARIANTS,
    NameFault::VARIANTS,
    BlueprintFault::VARIANTS,
];

/// A warning, and how often it occurred.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// A stable code.
    pub code: String,
    /// What happened, in English.
    pub message: String,
    /// The number of times that it happened.
    pub count: u64,
    /// What happened, as a value; `None` if there is only the text.
    pub about: Option<AnyMessage>,
}

impl Warning {
    /// A warning with a message.
    pub fn new(about: impl Into<AnyMessage>, count: u64) -> Warning {
        let about = about.into();
        Warning { code: about.code().into(), message: about.in_full(), count, about: Some(about) }
    }

    /// The same warning with other settings and names.
    #[must_use]
    pub fn replaced(self, by: &Replacing<'_>) -> Warning {
        let Some(about) = self.about.as_ref().map(|about| about.replaced(by)) else { return self };
        if self.about.as_ref() == Some(&about) {
            return self;
        }
        Warning { message: about.in_full(), about: Some(about), ..self }
    }

    /// The text of the field with this name, which is the same in all languages.
    pub fn field(&self, name: &str) -> Option<String> {
        let fields = self.about.as_ref()?.fields();
        fields.iter().find(|(known, _)| *known == name).map(|(_, value)| value.to_string())
    }

    /// Whether the warning has this code, and its field with this name has this text.
    pub fn is_about(&self, code: &str, name: &str, value: &str) -> bool {
        self.code == code && self.field(name).as_deref() == Some(value)
    }
}

terms! {
    /// How the energy of a frame differs from its account.
    pub enum Difference = "part.difference" { Gained = "gained", Lost = "lost" }
}

terms! {
    /// What reduces the error of an integrator.
    pub enum ErrorHint = "part.error_hint" {
        RealTime = "with implicit integrators, it comes from the residual of their equations; use `accuracy = \"exact\"`, or more substeps",
        Exact = "with implicit integrators, it comes from the residual of their equations; use a smaller `tolerance`, or more substeps",
        Contact = "bodies met obstacles or one another; in contact, this error is proportional to the step with every integrator, so use more substeps",
        ContactOfOthers = "bodies met obstacles or one another; in contact, this error is proportional to the step with every integrator, but smallest with `verlet`",
        Explicit = "use more substeps, or an integrator of higher order",
    }
}

terms! {
    /// What reduces the energy that implicit integrators themselves remove or add.
    pub enum DampingHint = "part.damping_hint" {
        Substeps = "more substeps reduce this",
        Undamped = "more substeps reduce this, and `implicit_midpoint` or `newmark` remove less",
        RealTime = "more substeps reduce this, and `bdf2` removes less",
        Radius = "more substeps or a larger `spectral_radius` reduce this",
        Damped = "more substeps reduce this, and `backward_euler` damps motion that would grow",
        Exact = "`accuracy = \"exact\"` prevents this; with more substeps, steps in real time may add more",
    }
}

terms! {
    /// Why real-time steps used up their budget, and what helps.
    pub enum BudgetHint = "part.budget_hint" {
        Stiff = "the body is too stiff or too slender for the step; use more substeps, `linear_solver = \"cholesky\"`, or `accuracy = \"exact\"`",
        Factored = "the body is too stiff or too slender for the step; use more substeps, or `accuracy = \"exact\"`",
        Touching = "contact changes the forces during the step, or a body is too stiff or too slender for the step; use more substeps, more `iterations`, or `accuracy = \"exact\"`",
    }
}

terms! {
    /// Measures against inverted cells.
    pub enum CellHint = "part.cell_hint" {
        Smaller = "smaller cells, or less compression",
        Farther = "smaller cells, or a material that restores cells even after a stronger inversion (`fixed_corotated`)",
        Material = "or a material that restores such cells (`stable_neo_hookean`, `fixed_corotated`)",
    }
}

terms! {
    /// Cells that are better in bending.
    pub enum BendingHint = "part.bending_hint" {
        Quadratic = "use quadratic cells (`order = 2`), quadrilaterals or hexahedra",
        Hexahedra = "use hexahedra, or shorter cells",
    }
}

terms! {
    /// The hint that the scene setting `unfold` may help against inverted cells.
    pub enum UnfoldHint = "part.unfold_hint" { Unfold = ", or `unfold = true` in `[world]`" }
}

messages! {
    /// The number of inverted cells.
    #[derive(Clone, Debug, PartialEq)]
    pub enum InvertedCells {
        "part.inverted_cells" #[error("{}", cells_are(*count))]
        Certain { count: u64 },
        "part.inverted_cells" #[error("perhaps {}", cells_are(*count))]
        Perhaps { count: u64 },
        "part.inverted_cells" #[error("{count} and perhaps {perhaps} more cells are")]
        Both { count: u64, perhaps: u64 },
    }

    /// The position of a node for which obstacles leave no space.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Lay {
        "part.lay" #[error("was {} m inside the first obstacle", number(*depth))]
        Inside { depth: f64 },
        "part.lay" #[error("was where the obstacles meet")]
        Between {},
    }

    /// What frees a body that starts inside an obstacle.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Remedy {
        "part.remedy" #[error("a shift by ({shift}) m would free the body")]
        Moved { shift: String },
        "part.remedy" #[error("no shift along the surrounding surfaces would free the body")]
        Nowhere {},
    }

    /// The cell whose volume differs most from its volume at rest.
    #[derive(Clone, Debug, PartialEq)]
    pub enum WorstCell {
        "part.worst_cell" #[error("; the cell whose volume has changed most is now cell {cell} of body `{body}`, with J = {ratio:.4}")]
        Cell { cell: u32, body: String, ratio: f64 },
    }

    /// A warning of a world.
    #[derive(Clone, Debug, PartialEq)]
    pub enum WorldWarning {
        "limit.force" #[error("forces were limited to `world.largest_force`")]
        ForcesLimited {},
        "limit.velocity" #[error("velocities were limited to `world.largest_velocity`")]
        VelocitiesLimited {},
        "limit.drag"
        #[error("pulls were limited to their `largest_force`; its default is the force of the spring stretched by ten times the size of the body")]
        PullsLimited {},
        "limit.distance" #[error("bodies went farther than `world.largest_distance` and were removed")]
        BodiesLost {},
        "ledger.numerical_damping"
        #[error("the implicit integrators themselves removed {} J (`loss_numerical`), more than a twentieth of the energy in motion, and more than damping, friction and impacts together. Motion that is fast compared with the step decays because of the integrator, not because of physics", number(*energy))]
        #[hint("{help}")]
        TakenByRules { energy: f64, help: DampingHint },
        "ledger.numerical_damping"
        #[error("the implicit integrators themselves added {} J (`loss_numerical`), more than a twentieth of the energy in motion. Motion that is fast compared with the step grows because of the integrator, not because of physics", number(*energy))]
        #[hint("{help}")]
        MadeByRules { energy: f64, help: DampingHint },
        "ledger.closure"
        #[error("a frame ended with more than a tenth of the energy in motion unexplained (`closure`): {} J {difference} so far by the error of the integrator; {help}", number(*energy))]
        Unexplained { energy: f64, difference: Difference, help: ErrorHint },
        "step.not_converged" #[error("a step was accepted although it had not converged: `when_not_converged` is `\"accept\"`, or friction under a barrier still changed by more than a thousandth after thirty rounds")]
        #[hint("use more substeps")]
        Accepted {},
        "step.halved"
        #[error("a step of {} s (in statics, the load and the motion of pins that it adds) was halved, repeatedly if needed, down to {} s, 1/{parts} of it, because Newton's method did not converge over the whole step or a model is undefined in a state within it (`when_not_converged = \"halve\"`, or real time). The result is as good as with such short steps, but took longer", number(*h), number(*shortest))]
        #[hint("more substeps (in statics, more `load_steps` or frames) avoid the failed attempts")]
        Halved { h: f64, shortest: f64, parts: u64 },
        "step.cut_off"
        #[error("a real-time step used up its budget, or needed so many products with the matrix that slow motions may have a large residual: the residual forces would move single nodes by up to {} m", number(*left))]
        #[hint("{help}")]
        CutOff { left: f64, help: BudgetHint },
        "statics.blurred"
        #[error("an equilibrium was found in which forces are as small as their rounding errors, but the residual could still move nodes by up to {} m. Positions have sixteen digits, which is too few for a body so slender, for cells so thin or for positions so far from the origin. Details of the result that are smaller than this are meaningless", number(*error_estimate))]
        #[hint("use cells that are shorter relative to their thickness, or move the scene to the origin")]
        Estimated { error_estimate: f64 },
        "conditioning"
        #[error("a body is so stiff for its mass that rounding its positions to sixteen digits causes forces up to {} times as large as the largest load on any node during a step. The motion of the body as a whole is balanced separately and is correct. The positions of its nodes are correct except for the last digit, but its stresses are meaningless", number(*times))]
        #[hint("use larger cells or a less stiff body, or move the scene closer to the origin")]
        Conditioning { times: f64 },
        "step.disturbed"
        #[error("a body at rest in a degenerate, inverted or folded shape was disturbed at random, by 1e-4 of its size, then by a hundredth and by a tenth")]
        #[hint("a body that has left such a shape swings until its motion is damped; `backward_euler` and `damping` of the material damp it fastest")]
        Disturbed {},
        "step.odd_rest"
        #[error("a body stayed at rest in a degenerate, inverted or folded shape, in an equilibrium that disturbances of up to a tenth of its size did not end{}", if_any(worst))]
        #[hint("use another initial state, or a material that restores such cells (`fixed_corotated`)")]
        DegenerateRest { worst: Option<WorstCell> },
        "restore.no_force" #[error("a snapshot does not contain forces that the program defines, and a body had one: add it again (`World::add_force`)")]
        NoForce {},
        "statics.load_left"
        #[error("the run ends before the whole load is applied: the last state of body `{body}` is the equilibrium under {} of the load (`load_factor`)", number(*part))]
        #[hint("use more frames, or a longer `arc_length`")]
        LoadLeft { body: String, part: f64 },
        "units.sag"
        #[error("body `{body}` of {} kg would sag by about {} m under its weight, more than its size of {} m: are its units mixed (metres, kilograms, newtons per metre)?", number(*mass), rounded(*sag, 2), number(*size))]
        Sag { body: String, mass: f64, sag: f64, size: f64 },
        "contact.starts_inside"
        #[error("body `{body}` begins inside obstacle {collider} ({kind}): {}, up to {} m deep (node {deepest}); {remedy}", counted(*nodes as u64, "node", "nodes"), number(*depth))]
        StartsInside { body: String, collider: usize, kind: String, nodes: usize, deepest: u32, depth: f64, remedy: Remedy },
        "contact.starts_across"
        #[error("body `{body}` begins across obstacle {collider} ({kind}), which has no inside: every node stays on the side where it begins, so the obstacle pinches the body")]
        #[hint("move the body or the obstacle")]
        StartsAcross { body: String, collider: usize, kind: String },
        "contact.starts_overlapping"
        #[error("{} inside or across one another, near ({position}) m", overlapping(*pairs, body, other))]
        #[hint("move the bodies apart; contact separates solids slowly (`recovery_speed`), and leaves open surfaces and wires crossed")]
        StartsOverlapping { body: String, other: String, pairs: u64, position: String },
        "contact.none"
        #[error("at t = {} s, {} through one another (first: `{first}` and `{second}`)", number(*time), if *pairs == 1 { "two bodies pass".into() } else { format!("{pairs} pairs of bodies pass") })]
        #[hint("a section `[contact]` keeps bodies apart")]
        NoContact { time: f64, pairs: u64, first: String, second: String },
        "contact.mixed"
        #[error("at t = {} s, body `{first}` ({first_rule}) touches body `{second}` ({second_rule}): contact is solved for both together, but each body is stepped by its own integrator, so neither the order nor the damping of either integrator applies to the pair (counted once per frame and pair of bodies)", number(*time))]
        #[hint("use the same integrator for bodies that touch")]
        Mixed { time: f64, first: String, first_rule: String, second: String, second_rule: String },
        "cells.slender"
        #[error("body `{body}` bends or twists too stiffly: the longest edges of its cells are {} m on average, {} times its thickness of {} m; at a ratio of {limit}, the first frequencies of plates were measured to be {error} % too high, and the error grows with the ratio", rounded(*length, 3), rounded(*times, 3), rounded(*thickness, 3))]
        #[hint("{help}")]
        Slender { body: String, length: f64, times: f64, thickness: f64, limit: f64, error: f64, help: BendingHint },
        "cells.inverted"
        #[error("at t = {} s, {cells} inverted; the first is cell {cell} of body `{body}`, with J = {}", number(*time), number(*ratio))]
        #[hint("use more substeps, {help}{}", if_any(unfold))]
        Inverted { time: f64, cells: InvertedCells, cell: u32, body: String, ratio: f64, help: CellHint, unfold: Option<UnfoldHint> },
        "cells.other_balance"
        #[error("at t = {} s, {} contains {} J, of which the forces account for {} J. Its volume is {} times that at rest, and det F is {} in cell {cell}", number(*time), at_rest(*count, body), rounded(*energy, 4), rounded(*accounted, 4), rounded(*volume, 4), rounded(*ratio, 4))]
        #[hint("if this is not intended, start from the rest shape, with more damping or more substeps{}", if_any(unfold))]
        OtherBalance { time: f64, count: u64, body: String, energy: f64, accounted: f64, volume: f64, cell: u32, ratio: f64, unfold: Option<UnfoldHint> },
        "law.turned"
        #[error("at t = {} s, cell {cell} of body `{body}` is rotated by {}°, which its law `linear` treats as a strain of {} % (counted once per frame and body)", number(*time), rounded(*angle, 3), rounded(*strain, 3))]
        #[hint("use `corotated`, the same law in axes that rotate with every cell")]
        Turned { time: f64, cell: u32, body: String, angle: f64, strain: f64 },
        "contact.no_room"
        #[error("at t = {} s, obstacles {first} ({first_kind}) and {second} ({second_kind}) left no room for body `{body}`: node {node} {lay}. Moving obstacles must stay apart (counted once per frame and body)", number(*time))]
        NoRoom { time: f64, first: usize, first_kind: String, second: usize, second_kind: String, body: String, node: u32, lay: Lay },
        "command.no_body" #[error("commands on body `{body}` ended when it was removed")]
        CommandsEnded { body: String },
        "command.no_body" #[error("commands on other bodies ended when those bodies were removed")]
        OtherCommandsEnded {},
        "step.no_stable_step"
        #[error("`{integrator}` has no stable step for body `{body}` (ω = {} rad/s): a motion grows as exp({} t)", number(*omega), number(*growth))]
        NoStableStep { integrator: &'static str, body: String, omega: f64, growth: f64 },
        "step.outgrown"
        #[error("at t = {} s, the largest stable step of body `{body}` had fallen to {} s, below h = {} s: compressed or stretched parts are stiffer than at rest; substeps >= {substeps} are stable in this state", number(*time), number(*limit), number(*h))]
        Outgrown { time: f64, body: String, limit: f64, h: f64, substeps: f64 },
    }
}

fn cells_are(count: u64) -> String {
    if count == 1 { "1 cell is".into() } else { format!("{count} cells are") }
}

fn overlapping(pairs: u64, body: &str, other: &str) -> String {
    match pairs {
        1 => format!("the bodies `{body}` and `{other}` begin"),
        _ => format!(
            "{pairs} pairs of bodies begin inside or across one another; the first, `{body}` and `{other}`, begin"
        ),
    }
}

fn at_rest(count: u64, body: &str) -> String {
    let shapes = "snapped through, or are folded, inverted or twisted";
    match count {
        1 => format!(
            "body `{body}` has come to rest with more energy in its cells than the forces account for: parts of it have {shapes}. It"
        ),
        _ => format!(
            "{count} bodies have come to rest with more energy in their cells than the forces account for: parts of them have {shapes}. The first, \
body `{body}`,"
        ),
    }
}
