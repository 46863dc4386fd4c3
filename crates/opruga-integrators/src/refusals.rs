//! Why integrators refuse a body or a state, and hints if a step fails, as messages.

use opruga_math::message::AnyMessage;
use opruga_math::messages;
use opruga_math::words::{counted, number};

/// The number of rigid modes, in words.
fn modes(count: usize) -> String {
    counted(count as u64, "rigid mode", "rigid modes")
}

/// The number of nodes, in words.
fn of_nodes(count: usize) -> String {
    counted(count as u64, "node", "nodes")
}

messages! {
    /// A rigid motion of a body.
    #[derive(Clone, Debug, PartialEq)]
    pub enum MotionName {
        "part.motion" #[error("translation along {axis}")]
        Translation { axis: String },
        "part.motion" #[error("rotation")]
        Rotation {},
        "part.motion" #[error("rotation about an axis along {axis}")]
        RotationAbout { axis: String },
        "part.motion" #[error("{first}, {rest}")]
        List { first: AnyMessage, rest: AnyMessage },
    }

    /// Why an integrator refuses a body, its parameters or a state.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// Real time with an integrator that damps slow motions little.
        "integrator.real_time"
        #[error("`accuracy` is \"real_time\", whose steps leave a residual; `{integrator}` with `spectral_radius` = {} hardly damps slow motions and carries the residual over to the next step in its acceleration", number(*radius))] #[value("\"real_time\"")] #[parameters("accuracy", "spectral_radius")]
        #[allowed("\"exact\"")] #[hint("`backward_euler` and `bdf2` have a real-time setting")]
        DampsLittle { integrator: &'static str, radius: f64 },
        /// Real time with an integrator that damps nothing.
        "integrator.real_time"
        #[error("`accuracy` is \"real_time\", whose steps leave a residual; `{integrator}` damps nothing, so the residuals would accumulate without bound")] #[value("\"real_time\"")] #[parameters("accuracy")]
        #[allowed("\"exact\"")] #[hint("`backward_euler` and `bdf2` have a real-time setting")]
        DampsNothing { integrator: &'static str },
        /// Real time without a matrix to keep.
        "integrator.no_matrix" #[error("`linear_solver` is \"matrix_free\", but `accuracy` is \"real_time\", which keeps a matrix")] #[value("\"matrix_free\"")] #[parameters("linear_solver", "accuracy")]
        #[allowed("\"auto\", \"conjugate_gradients\", \"cholesky\"")]
        MatrixFreeInRealTime {},
        /// `arc_length` without a matrix to factor.
        "integrator.no_matrix" #[error("`linear_solver` is \"matrix_free\", but `arc_length` factors a matrix")] #[value("\"matrix_free\"")] #[parameters("linear_solver", "arc_length")]
        #[allowed("\"auto\", \"conjugate_gradients\", \"cholesky\"")]
        MatrixFreeByArc {},
        /// A matrix that is not symmetric, although conjugate gradients require symmetry.
        "integrator.no_matrix"
        #[error("`linear_solver` is \"matrix_free\", whose conjugate gradients need a symmetric matrix, but the matrix of the body is not symmetric")] #[value("\"matrix_free\"")] #[parameters("linear_solver")]
        #[allowed("\"auto\"")]
        Unsymmetric {},
        /// A body that nothing holds.
        "static.rigid_modes" #[error("nothing prevents {motions}: {}; an equilibrium exists only for a body that cannot move freely", modes(*count))]
        #[hint("pin as many axes of nodes as there are rigid modes, or give the body something to rest on")]
        Free { motions: AnyMessage, count: usize },
        /// A body that its linear forces let rotate for ever.
        "static.rigid_modes"
        #[error("nothing prevents {motions}: {}. The forces of this body are linear, so a moment would rotate it for ever, and its weight does not bring it back, unlike the weight of a pendulum. It has no equilibrium unless pins hold it", modes(*count))]
        #[hint("pin as many axes of nodes as there are rigid modes, or use a material for large rotations, such as `neo_hookean`")]
        Endless { motions: AnyMessage, count: usize },
        /// A piece that nothing holds.
        "static.rigid_modes"
        #[error("the body is in {pieces} pieces. For the piece of {} around {center}, nothing prevents {motions}: {}; an equilibrium exists only if no piece can move freely", of_nodes(*nodes), modes(*count))]
        #[hint("pin as many axes of its nodes as it has rigid modes, join it to the others, or leave it out")]
        FreePiece { pieces: usize, nodes: usize, center: String, motions: AnyMessage, count: usize },
        /// A curve of equilibria that begins where nothing holds the body.
        "static.arc_length_and_obstacles"
        #[error("with `arc_length`, pins must hold the body: the load starts at zero, when nothing presses the body onto obstacles")] #[parameters("arc_length")]
        #[allowed("pins that hold the body, or no `arc_length` and as many `load_steps` as needed")]
        LooseByArc {},
        /// A body that can slide on an obstacle.
        "run.model"
        #[error("the body lies on an obstacle, but neither the obstacle nor a pin prevents {motions}; an equilibrium exists only for a body that cannot move freely")]
        #[hint("pin an axis of a node for each of these motions, or give the obstacle `friction`")]
        Slides { motions: AnyMessage },
        /// A piece that can slide on an obstacle.
        "run.model"
        #[error("the body is in {pieces} pieces. The piece of {} around {center} lies on an obstacle, but neither the obstacle nor a pin prevents {motions}; an equilibrium exists only if no piece can move freely", of_nodes(*nodes))]
        #[hint("pin an axis of a node for each of these motions, or give the obstacle `friction`")]
        PieceSlides { pieces: usize, nodes: usize, center: String, motions: AnyMessage },
        /// A curve of equilibria without a load.
        "run.model"
        #[error("no load acts on free nodes at t = {} s, but `arc_length` needs a load that it can apply in parts", number(*time))]
        #[allowed("weight or loads")] #[hint("without `arc_length`, every step ends in the equilibrium of pins and gases")]
        NoLoad { time: f64 },
        /// A curve of equilibria that cannot be followed.
        "run.model"
        #[error("the curve of equilibria turns back or bends sharply at {} of the load, even with steps down to a thousandth of `arc_length`; a branch with another shape may begin here", number(*load))]
        #[hint("add a small force or change the shape, so that one branch is preferred, or apply the whole load at once, without `arc_length`")]
        TurnsBack { load: f64 },
    }

    /// Hints for a step whose end is not found.
    #[derive(Clone, Debug, PartialEq)]
    pub enum StepHint {
        "part.step_hint" #[error("use more substeps, or `accuracy = \"exact\"`; the step was already halved down to 1/256")]
        Exact {},
        "part.step_hint" #[error("use more substeps, or more `iterations`; the step was already halved down to 1/256")]
        Iterations {},
        "part.step_hint" #[error("use more substeps, more `iterations`, or `when_not_converged = \"halve\"`")]
        Halve {},
        "part.step_hint"
        #[error("steps that were accepted although they had not converged have made the body a hundred times as large as it was in its first step; use more substeps, or `when_not_converged = \"halve\"`")]
        Grown {},
        "part.step_hint" #[error("use a shorter `arc_length`, or more `iterations`")]
        ShorterArc {},
        "part.step_hint"
        #[error("use more `iterations`; the load was already halved down to 1/256; if the body snaps through, `arc_length` follows it")]
        Arc {},
        "part.step_hint"
        #[error("use more `iterations`; the load was already halved down to 1/256; an integrator that steps through time with damping can find a state of rest")]
        ThroughTime {},
        "part.step_hint" #[error("use `when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`; if the body snaps through, use `arc_length`")]
        LoadStepsOrArc {},
        "part.step_hint" #[error("use `when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`")]
        LoadSteps {},
        "part.step_hint"
        #[error("positions have sixteen digits, so rounding errors of {} m in positions and {} N in forces are unavoidable here; use a larger `tolerance`, larger cells or a less stiff body, or move the scene closer to the origin", number(*of_positions), number(*of_forces))]
        Rounding { of_positions: f64, of_forces: f64 },
    }
}

/// All messages of this crate, for tests of translations.
pub const MESSAGES: &[&[opruga_math::message::Variant]] =
    &[MotionName::VARIANTS, Refusal::VARIANTS, StepHint::VARIANTS];
