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
        #[error("`accuracy` is \"real_time\", whose steps leave a part out of balance; `{integrator}` with `spectral_radius` = {} damps slow motions hardly, and hands that part on with the acceleration that it remembers", number(*radius))] #[value("\"real_time\"")] #[parameters("accuracy", "spectral_radius")]
        #[allowed("\"exact\"")] #[hint("`backward_euler` and `bdf2` have a real-time setting")]
        DampsLittle { integrator: &'static str, radius: f64 },
        /// Real time with an integrator that damps nothing.
        "integrator.real_time"
        #[error("`accuracy` is \"real_time\", whose steps leave a part out of balance; `{integrator}` damps nothing, and would add it up without end")] #[value("\"real_time\"")] #[parameters("accuracy")]
        #[allowed("\"exact\"")] #[hint("`backward_euler` and `bdf2` have a real-time setting")]
        DampsNothing { integrator: &'static str },
        /// Real time without a matrix to keep.
        "integrator.no_matrix" #[error("`linear_solver` is \"matrix_free\", and `accuracy` is \"real_time\", which keeps a matrix")] #[value("\"matrix_free\"")] #[parameters("linear_solver", "accuracy")]
        #[allowed("\"auto\", \"conjugate_gradients\", \"cholesky\"")]
        MatrixFreeInRealTime {},
        /// `arc_length` without a matrix to factor.
        "integrator.no_matrix" #[error("`linear_solver` is \"matrix_free\", and `arc_length` factors a matrix")] #[value("\"matrix_free\"")] #[parameters("linear_solver", "arc_length")]
        #[allowed("\"auto\", \"conjugate_gradients\", \"cholesky\"")]
        MatrixFreeByArc {},
        /// A matrix that is not symmetric, as conjugate gradients require.
        "integrator.no_matrix"
        #[error("`linear_solver` is \"matrix_free\", whose conjugate gradients need a symmetric matrix, and that of the body is not symmetric")] #[value("\"matrix_free\"")] #[parameters("linear_solver")]
        #[allowed("\"auto\"")]
        Unsymmetric {},
        /// A body that nothing holds.
        "static.rigid_modes" #[error("nothing holds the body against {motions}: {}; an equilibrium needs a body that is held", modes(*count))]
        #[hint("pin as many axes of nodes as there are rigid modes, or give it something to rest on")]
        Free { motions: AnyMessage, count: usize },
        /// A body whose linear forces let it rotate without end.
        "static.rigid_modes"
        #[error("nothing holds the body against {motions}: {}, since its forces are linear: what turns it turns it without end, and no weight brings it back as it does a pendulum; an equilibrium needs a body that is held", modes(*count))]
        #[hint("pin as many axes of nodes as there are rigid modes, or take a material for large rotations, such as `neo_hookean`")]
        Endless { motions: AnyMessage, count: usize },
        /// A piece that nothing holds.
        "static.rigid_modes"
        #[error("the body is in {pieces} pieces, and nothing holds that of {} about {center} against {motions}: {}; an equilibrium needs every piece held", of_nodes(*nodes), modes(*count))]
        #[hint("pin as many axes of its nodes as it has rigid modes, join it to the others, or leave it out")]
        FreePiece { pieces: usize, nodes: usize, center: String, motions: AnyMessage, count: usize },
        /// A curve of equilibria that begins where nothing holds the body.
        "static.arc_length_and_obstacles"
        #[error("`arc_length` is given, and pins do not hold the body, which nothing presses onto obstacles where the curve begins, without any load")] #[parameters("arc_length")]
        #[allowed("pins that hold it, or the whole load at once, in as many `load_steps` as it takes")]
        LooseByArc {},
        /// A body that can slide on an obstacle.
        "run.model"
        #[error("the body lies on an obstacle, and neither that nor pins hold it against {motions}; an equilibrium needs a body that is held")]
        #[hint("pin an axis of a node for each, or let the obstacle rub (`friction`)")]
        Slides { motions: AnyMessage },
        /// A piece that can slide on an obstacle.
        "run.model"
        #[error("the body is in {pieces} pieces, and that of {} about {center} lies on an obstacle, and neither that nor pins hold it against {motions}; an equilibrium needs every piece held", of_nodes(*nodes))]
        #[hint("pin an axis of a node for each, or let the obstacle rub (`friction`)")]
        PieceSlides { pieces: usize, nodes: usize, center: String, motions: AnyMessage },
        /// A curve of equilibria without a load.
        "run.model"
        #[error("no load acts on what is free at t = {} s, and `arc_length` goes by the part of the load that is on", number(*time))]
        #[allowed("weight or loads")] #[hint("without `arc_length` every step ends where pins and gases balance")]
        NoLoad { time: f64 },
        /// A curve of equilibria that cannot be followed.
        "run.model"
        #[error("the curve of equilibria turns back or sharply aside at {} of the load, however short the step, down to a thousandth of `arc_length`; a branch of another form may begin here", number(*load))]
        #[hint("a small force or a shape that leads onto one branch, or the whole load at once, without `arc_length`")]
        TurnsBack { load: f64 },
    }

    /// Hints for a step whose end is not found.
    #[derive(Clone, Debug, PartialEq)]
    pub enum StepHint {
        "part.step_hint" #[error("more substeps, or `accuracy = \"exact\"`; the step was already halved down to 1/256")]
        Exact {},
        "part.step_hint" #[error("more substeps, or more `iterations`; the step was already halved down to 1/256")]
        Iterations {},
        "part.step_hint" #[error("more substeps, more `iterations`, or `when_not_converged = \"halve\"`")]
        Halve {},
        "part.step_hint"
        #[error("steps that counted though they had not converged have made the body a hundred times as large as it was: more substeps, or `when_not_converged = \"halve\"`")]
        Grown {},
        "part.step_hint" #[error("a shorter `arc_length`, or more `iterations`")]
        ShorterArc {},
        "part.step_hint"
        #[error("more `iterations`; the load was already halved down to 1/256: where a body gives way, `arc_length` follows it through its snap")]
        Arc {},
        "part.step_hint"
        #[error("more `iterations`; the load was already halved down to 1/256: a rule that steps through time with damping finds a state of rest")]
        ThroughTime {},
        "part.step_hint" #[error("`when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`; where a body gives way, `arc_length`")]
        LoadStepsOrArc {},
        "part.step_hint" #[error("`when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`")]
        LoadSteps {},
        "part.step_hint"
        #[error("positions have sixteen digits here, which leave {} m and forces of {} N open: a larger `tolerance`, a scene nearer to the origin, larger cells, or a body that is less stiff", number(*of_positions), number(*of_forces))]
        Rounding { of_positions: f64, of_forces: f64 },
    }
}

/// All messages of this crate, for tests of translations.
pub const MESSAGES: &[&[opruga_math::message::Variant]] =
    &[MotionName::VARIANTS, Refusal::VARIANTS, StepHint::VARIANTS];
