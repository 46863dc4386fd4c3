//! The parameters that all implicit integrators have.

use super::friction::SlipRule;
use super::slenderness::is_slender;
use crate::refusals::{Refusal, StepHint};
use opruga_core::error::BuildError;
use opruga_core::spec::{Allowed, Bound, Default, Field, Values};
use opruga_core::system::System;

/// The fraction of the residual at which an iteration is good enough, and the fraction that may remain after the last one.
const ENOUGH: [f64; 2] = [0.2, 0.2];

/// The same fractions, for a rule that damps slow motions only a little. The residual of such a rule acts with a delay, in
/// the next step, and pushes in the direction of the motion. With a fiftieth as the first fraction, a beam of 10 × 2
/// quadrilaterals still gained energy under `bdf2`.
const ENOUGH_UNDAMPED: [f64; 2] = [1e-3, 0.05];

/// The default of the largest number of iterations for a step whose end is found together with the ends of other bodies, unless the step has a budget.
pub(super) const COMMON_ITERATIONS: u32 = 100;

/// How the equations of a step are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    /// The largest number of Newton iterations.
    pub(crate) iterations: u32,
    /// The largest number of iterations for a step whose end is found together with the ends of other bodies.
    pub(crate) common_iterations: u32,
    /// The correction below which the iteration ends, as a fraction of the extent of the body.
    pub(crate) tolerance: f64,
    /// Whether a step has a fixed budget of iterations, and counts as converged when the budget is spent.
    pub(crate) real_time: bool,
    /// The fraction of the residual at which a step in real time ends, and the largest fraction that may remain when its
    /// iterations are spent.
    pub(crate) leaves: [f64; 2],
    pub(crate) solver: Solver,
    pub(crate) otherwise: Otherwise,
}

/// The linear solver that the scene chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solver {
    /// The solver follows from the size and the dimension of the body.
    Auto,
    /// Conjugate gradients on the assembled matrix.
    ConjugateGradients,
    /// Conjugate gradients without a matrix.
    MatrixFree,
    /// The sparse Cholesky factor.
    Cholesky,
}

/// What to do if a step does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Otherwise {
    /// Return an error. The state does not change.
    Error,
    /// Make the step in two halves, and halve these again if necessary.
    Halve,
    /// Accept the step, and count it.
    Accept,
}

/// The largest number of halvings of a step.
pub(crate) const MOST_HALVINGS: u32 = 8;

/// The number of Newton iterations.
pub(crate) const ITERATIONS: Field = Field::new(
    "iterations",
    Allowed::Integer { least: 1, greatest: 1000 },
    "",
    Default::Absent,
    "The largest number of iterations of Newton's method. The default is 100; with `accuracy = \"real_time\"`, it is 3, or 10 with a barrier between \
bodies.",
);
/// When the iteration ends.
pub(crate) const TOLERANCE: Field = Field::new(
    "tolerance",
    Allowed::Number { least: Bound::Closed(1e-14), greatest: Bound::Closed(0.1) },
    "",
    Default::Number(1e-9),
    "The iteration ends when no node is corrected by more than this fraction of the body's extent.",
);
/// The allowed solvers, in words.
macro_rules! solvers {
    () => {
        "The solver of the linear equations in each iteration. Conjugate gradients, with or without a matrix, give the same bits on every processor. \
If conjugate gradients would need more than a thousand products with a matrix, for example for a nearly incompressible solid, a complete factor of \
the matrix is used instead, provided that it fits into 100 MB. This factor is computed in a fixed order, so it also gives the same bits on every \
processor. The sparse Cholesky factor gives the same bits only on processors of the same class. \"auto\" uses the Cholesky factor for bodies in the \
plane with 200 nodes or more and for bodies in space with 200 to 3000 nodes. \"matrix_free\" stores no matrix and needs several times as many \
products; with quadratic cells, these products take dozens of times as long. Use \"matrix_free\" for bodies whose matrix does not fit into memory."
    };
}

/// The linear solver.
pub(crate) const LINEAR_SOLVER: Field = Field::new(
    "linear_solver",
    Allowed::Choice(&["auto", "conjugate_gradients", "matrix_free", "cholesky"]),
    "",
    Default::Text("auto"),
    solvers!(),
);
/// What to do if a step does not converge.
pub(crate) const OTHERWISE: Field = Field::new(
    "when_not_converged",
    Allowed::Choice(&["error", "halve", "accept"]),
    "",
    Default::Text("error"),
    "What happens if a step does not converge: \"error\" gives an error and leaves the state unchanged, \"halve\" replaces the step by two steps of \
half the length (which may be halved again, down to 1/256), and \"accept\" accepts the step and counts it in a warning.",
);

/// The number of Newton iterations in statics.
pub(crate) const ITERATIONS_OF_STATICS: Field = Field::new(
    "iterations",
    Allowed::Integer { least: 1, greatest: 1000 },
    "",
    Default::Integer(200),
    "The largest number of iterations of Newton's method for every part of the load.",
);
/// The linear solver of statics.
pub(crate) const LINEAR_SOLVER_OF_STATICS: Field = Field {
    documentation: concat!(
        solvers!(),
        " Statics has no inertia, so conjugate gradients need many products for a slender body, most of all with \"matrix_free\". `arc_length` \
factors a matrix and cannot be combined with \"matrix_free\"."
    ),
    ..LINEAR_SOLVER
};
/// What to do in statics if a step does not converge.
pub(crate) const OTHERWISE_OF_STATICS: Field = Field {
    documentation: "What happens if no equilibrium is found: \"error\" gives an error and leaves the state unchanged, \"halve\" replaces the step by \
two steps with half of the load and half of the motion of pins (which may be halved again, down to 1/256), and \"accept\" accepts the state and \
counts it in a warning. With `arc_length`, the step along the curve is halved regardless of this setting.",
    ..OTHERWISE
};

/// The fields of an integrator or of statics. The list contains the integrator's own fields, and the fields that determine
/// how its equations are solved.
macro_rules! fields {
    (of_time $(, $own:expr)*) => {{
        use $crate::implicit::settings::{ACCURACY, ITERATIONS, LINEAR_SOLVER, OTHERWISE, TOLERANCE};
        &[$($own,)* ACCURACY, ITERATIONS, TOLERANCE, LINEAR_SOLVER, OTHERWISE]
    }};
    (of_statics $(, $own:expr)*) => {{
        use $crate::implicit::settings::{
            ITERATIONS_OF_STATICS, LINEAR_SOLVER_OF_STATICS, OTHERWISE_OF_STATICS, TOLERANCE,
        };
        &[$($own,)* ITERATIONS_OF_STATICS, TOLERANCE, LINEAR_SOLVER_OF_STATICS, OTHERWISE_OF_STATICS]
    }};
}
pub(crate) use fields;

/// Whether steps are solved exactly or in real time.
pub(crate) const ACCURACY: Field = Field::new(
    "accuracy",
    Allowed::Choice(&["exact", "real_time"]),
    "",
    Default::Text("exact"),
    "\"exact\" iterates until the equations of the step hold within `tolerance`. \"real_time\" has a fixed budget: three iterations, which start \
from the motion of the previous step. Each iteration solves its equations with the factor of a matrix, or with at most 1000 products with the \
matrix. The matrix is kept as long as the steps converge with it. Up to a fifth of the unbalanced forces may remain as a residual, and the following \
steps correct it. `bdf2` damps slow motions little, so it aims at a residual of a thousandth of the unbalanced forces, and at most a twentieth may \
remain. If the residual would create energy, for example when a soft body strikes the floor, the step is solved exactly, which takes several times \
as long. With a barrier between bodies, iterations that the barrier cuts short do not count towards the budget, and at most a twentieth of the \
unbalanced forces may remain. Steps that exceed these bounds on the residual are counted in a warning (`step.cut_off`), which reports the size of \
the residual. For clamped cubes and beams that swing under their weight, the results agree with those of exact steps of the same length: amplitudes \
within 3 % and periods within 1 %. The final state of rest agrees with statics within 1 %. Do not use this setting for results that are compared \
with other results, for slender bodies of many thousand nodes, or for motions that depend on small differences, such as buckling. \
`implicit_midpoint` and `newmark` refuse this setting, because they would accumulate residuals: `implicit_midpoint` damps nothing, and `newmark` \
keeps the residual in its acceleration.",
);

/// Integrators that would accumulate the residuals of steps.
const UNDAMPED: [&str; 2] = ["implicit_midpoint", "newmark"];

/// Integrators that damp slow motions little.
const DAMPING_LITTLE: [&str; 1] = ["bdf2"];

impl Settings {
    /// Reads the settings of an integrator.
    ///
    /// # Errors
    /// [`BuildError`] if parameters exclude one another.
    pub(crate) fn of_rule(kind: &'static str, values: &Values) -> Result<Settings, BuildError> {
        let settings = Settings::new(values);
        if settings.real_time && UNDAMPED.contains(&kind) {
            return Err(BuildError::of(
                kind,
                match values.number("spectral_radius") {
                    // The remembered acceleration follows from the displacement, even if forces do not balance there, and the
                    // next step begins with this acceleration.
                    Some(radius) if radius < 1.0 => Refusal::DampsLittle { integrator: kind, radius },
                    _ => Refusal::DampsNothing { integrator: kind },
                },
            ));
        }
        if settings.real_time && settings.solver == Solver::MatrixFree {
            return Err(BuildError::of(kind, Refusal::MatrixFreeInRealTime {}));
        }
        Ok(settings)
    }
    /// Reads the parameters of a scene.
    pub(crate) fn new(values: &Values) -> Settings {
        let real_time = values.text("accuracy") == Some("real_time");
        let iterations = |own: u32| values.integer("iterations").map_or(own, |n| n as u32);
        Settings {
            iterations: iterations(if real_time { 3 } else { 100 }),
            common_iterations: iterations(if real_time { 10 } else { COMMON_ITERATIONS }),
            tolerance: values.number("tolerance").unwrap_or(1e-9),
            real_time,
            leaves: if DAMPING_LITTLE.contains(&values.kind()) { ENOUGH_UNDAMPED } else { ENOUGH },
            solver: match values.text("linear_solver") {
                Some("conjugate_gradients") => Solver::ConjugateGradients,
                Some("matrix_free") => Solver::MatrixFree,
                Some("cholesky") => Solver::Cholesky,
                _ => Solver::Auto,
            },
            otherwise: match values.text("when_not_converged") {
                Some("halve") => Otherwise::Halve,
                Some("accept") => Otherwise::Accept,
                _ => Otherwise::Error,
            },
        }
    }
}

impl Settings {
    /// The rule of friction if the matrix contains its derivatives.
    pub(crate) fn against_slide(&self) -> SlipRule {
        SlipRule::AgainstSlide { tolerance: self.tolerance }
    }
    /// The hint for a step that did not converge.
    pub(crate) fn hint(&self) -> StepHint {
        match (self.real_time, self.otherwise) {
            (true, _) => StepHint::Exact {},
            (_, Otherwise::Halve) => StepHint::Iterations {},
            _ => StepHint::Halve {},
        }
    }
    /// The hint if no equilibrium is found. If `alone` is true, there are no obstacles.
    pub(crate) fn hint_of_statics(&self, by_arc: bool, alone: bool) -> StepHint {
        match (by_arc, self.otherwise, alone) {
            (true, ..) => StepHint::ShorterArc {},
            (_, Otherwise::Halve, true) => StepHint::Arc {},
            (_, Otherwise::Halve, false) => StepHint::ThroughTime {},
            (_, _, true) => StepHint::LoadStepsOrArc {},
            (_, _, false) => StepHint::LoadSteps {},
        }
    }
}

impl Solver {
    /// Whether the sparse factor is used for a body in real time, where the factor is kept. The factor is used for small
    /// stiff bodies and for slender ones.
    pub(crate) fn is_direct_in_real_time<const D: usize>(self, system: &System<D>) -> bool {
        match self {
            Solver::Cholesky => true,
            Solver::ConjugateGradients | Solver::MatrixFree => false,
            Solver::Auto => system.nodes >= 50 && (D == 2 || system.nodes <= 600 || is_slender(system)),
        }
    }
    /// Whether the sparse factor is used for a body.
    pub(crate) fn is_direct<const D: usize>(self, nodes: usize) -> bool {
        match self {
            Solver::Cholesky => true,
            Solver::ConjugateGradients | Solver::MatrixFree => false,
            Solver::Auto => nodes >= 200 && (D == 2 || nodes <= 3000),
        }
    }
}
