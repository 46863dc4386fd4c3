//! The common part of the implicit integrators: one stage, solved by Newton's method.
//!
//! Every rule here defines a stage x_s at which the forces balance the change of motion:
//!
//! r(x_s) = σ M (x_s − y) − F(x_s, v_s, t_s) = f_contact,  v_s = β (x_s − z),
//!
//! with numbers σ, β and vectors y, z that the rule computes from the state and its memory. If F has a potential U, the stage is
//! the minimum of the incremental potential Φ = ½ σ |x_s − y|²_M + U(x_s).
//!
//! | file | content |
//! |---|---|
//! | `settings` | the parameters that all rules have: accuracy, solver, what to do when a step does not converge |
//! | `step` | a step of a rule, from its start to its entry in the ledger, and the guards around its minimiser |
//! | `balance` | the balance of a stage, and the result of an iteration |
//! | `stage` | evaluation of a stage: forces, matrix, incremental potential, contacts |
//! | `rule` | the interface of a rule |
//! | `minimiser` | the interface of methods that find the stage: `newton`, or `real_time` |
//! | `convergence`, `energy` | guards that may refuse the stage of a minimiser |
//! | `theta` | the θ-method, which undamped rules use in contact |
//! | `newton` | the exact iteration: derivatives, direction, line search |
//! | `direction` | one direction of the exact iteration |
//! | `initial_guess` | the initial guess of the exact iteration |
//! | `line_search` | the length of a step along its direction |
//! | `rounding` | equilibria whose forces are as small as their rounding |
//! | `rigid` | the balance of a body in its rigid motions, which rounding does not hide |
//! | `rigid_motion` | rigid motions: translations and rotations |
//! | `rigid_balance` | whether that balance holds at the end of an iteration |
//! | `mixing` | an estimate of what the matrix leaves out, from previous iterations |
//! | `real_time` | the iteration with a fixed budget |
//! | `fallback` | the guard of `real_time`: if `real_time` gives a wrong result, `newton` makes the step |
//! | `reused_matrix` | the matrix that `real_time` keeps from step to step |
//! | `linear` | the linear solver of a direction: conjugate gradients or sparse Cholesky |
//! | `step_limit` | limits of corrections in statics, which keep bodies without inertia out of obstacles |
//! | `contact` | which nodes obstacles hold, and whether they stick or slip |
//! | `contact_query` | the positions of nodes within a step, as obstacles see them |
//! | `contact_derivatives` | derivatives of contact forces by positions |
//! | `growth` | refuses bodies that have become too large in accepted steps |
//! | `slenderness` | for which bodies the real-time setting factors its matrix |
//! | `impact` | effects of obstacles at the end of a step: velocities and the ledger |
//!
//! **Newton.** The matrix is σM + βC + K with C = −∂F/∂v and K = ∂²U/∂x∂x. The exact matrix is used while it is positive
//! definite. Otherwise the block of each element is used without its negative eigenvalues, so that every direction leads
//! downhill. The derivative of the damping force with respect to position is omitted from the matrix, and mixing of iterations
//! compensates for it. The line search accepts a step if the slope of Φ along it, minus the work of friction and of the
//! constraints, has fallen (Hager and Zhang 2005, approximate Wolfe condition) and, if Φ is known, Φ minus that work has not
//! risen. The iteration ends when the last correction is below `tolerance` times the extent of the body.
//!
//! **Contact.** Obstacles hold nodes by constraints, not by penalties: a node that would end inside an obstacle is moved to the
//! surface within the iteration. All other nodes follow by elasticity, and the force of the constraint follows from the
//! balance. A node is released when that force pulls. A node sticks while the tangential part of the force obeys Coulomb's law
//! |f_t| ≤ µ f_n, and otherwise slips against a friction of µ f_n. In statics, a correction ends at the first obstacle that it
//! meets, because nothing else would keep a falling body from passing through. This treatment of contact is the primal–dual
//! active set method, a semi-smooth Newton method (Hintermüller, Ito, Kunisch 2003; Hüeber and Wohlmuth 2005), so contact costs
//! few additional iterations. The friction in a direction uses the normal force that the same direction causes. Velocities are
//! corrected at the end of the step. The incoming normal velocity is lost or returned according to the restitution. Friction
//! reduces the tangential velocity by µ times the change of the normal velocity.

mod answer;
mod answer_matrix;
pub(crate) mod balance;
pub(crate) mod contact;
mod contact_derivatives;
mod contact_forces;
pub(crate) mod contact_query;
pub(crate) mod convergence;
pub(crate) mod direction;
pub(crate) mod ends;
mod energy;
mod fallback;
pub(crate) mod friction;
mod growth;
pub(crate) mod holding;
pub(crate) mod impact;
mod initial_guess;
mod instability;
mod line_search;
pub(crate) mod linear;
pub(crate) mod memory;
pub(crate) mod minimiser;
mod mixing;
pub(crate) mod newton;
pub(crate) mod open;
mod own_loss;
mod real_time;
mod reused_matrix;
mod rigid;
mod rigid_balance;
mod rigid_motion;
mod rounding;
pub(crate) mod rule;
pub(crate) mod settings;
mod slenderness;
pub(crate) mod stage;
pub(crate) mod step;
pub(crate) mod step_limit;
pub(crate) mod theta;
pub(crate) mod workspace;
