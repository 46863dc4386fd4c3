//! What the implicit rules share: one stage, solved by Newton's method.
//!
//! Every rule here looks for a stage x_s at which the forces balance the change of motion:
//!
//! r(x_s) = σ M (x_s − y) − F(x_s, v_s, t_s) = f_contact,  v_s = β (x_s − z),
//!
//! with numbers σ, β and vectors y, z that the rule works out of the state and of what it remembers. Where F has a
//! potential U, the stage is the minimum of the incremental potential Φ = ½ σ |x_s − y|²_M + U(x_s).
//!
//! | file | what it does |
//! |---|---|
//! | `settings` | the parameters that all rules have: accuracy, solver, what to do when it does not converge |
//! | `step` | a step of a rule from start to ledger, and the guards around its minimiser |
//! | `balance` | the balance of a stage, and what an iteration reports |
//! | `stage` | a stage as it is evaluated: forces, matrix, incremental potential, contacts |
//! | `rule` | what a rule says of a step |
//! | `minimiser` | what finds the stage of a rule: `newton`, or `real_time` |
//! | `convergence`, `energy` | guards that refuse what a minimiser found |
//! | `theta` | the θ-method, which rules that damp nothing turn to in contact |
//! | `newton` | the exact iteration: derivatives, direction, line search |
//! | `direction` | one direction of it |
//! | `initial_guess` | where that begins |
//! | `line_search` | how far a step is gone |
//! | `rounding` | balances whose forces are as small as their rounding |
//! | `rigid` | the motions of a body as a whole, whose balance rounding does not hide |
//! | `rigid_motion` | these motions themselves |
//! | `rigid_balance` | whether that holds where an iteration ends |
//! | `mixing` | what the matrix leaves out, from the iterations before |
//! | `real_time` | the iteration with a fixed budget |
//! | `fallback` | the guard around it: steps that it leads astray are made by `newton` |
//! | `reused_matrix` | the matrix that it keeps from step to step |
//! | `linear` | the direction: conjugate gradients or sparse Cholesky |
//! | `step_limit` | what keeps statics, without inertia, out of obstacles |
//! | `contact` | which nodes obstacles hold, and whether they stick or slip |
//! | `contact_query` | where nodes are within a step, as obstacles see it |
//! | `contact_derivatives` | what the forces of contacts change by with positions |
//! | `growth` | refuses what accepted steps blow up |
//! | `slenderness` | for which bodies the real-time setting factors its matrix |
//! | `impact` | what obstacles do at the end of a step: velocities and the ledger |
//!
//! **Newton.** The matrix is σM + βC + K with C = −∂F/∂v and K = ∂²U/∂x∂x: the exact one while it is positive definite, else
//! each element's block without its negative eigenvalues, for which every direction leads downhill. What the damping force
//! changes with position is left out of the matrix, and made up for by mixing iterations. The line search accepts a step when the
//! slope of Φ along it, less the work of friction and of the constraints, has fallen (Hager and Zhang 2005, approximate Wolfe
//! condition) and, where Φ is known, when Φ less that work has not risen. The iteration ends when the last correction is below `tolerance` times the extent of the body.
//!
//! **Contact.** Obstacles hold nodes by constraints, not by penalties: a node that would end inside is put onto the surface
//! within the iteration, all others follow as the elasticity wants, and the force of the constraint comes out of the
//! balance. In statics, where nothing else keeps a body that falls from falling through, a correction ends where it meets one. A node is released when that force pulls; it sticks while the tangential part obeys Coulomb's law |f_t| ≤ µ f_n
//! and slips against a friction of µ f_n beyond. This is the primal–dual active set, a semi-smooth Newton method
//! (Hintermüller, Ito, Kunisch 2003; Hüeber and Wohlmuth 2005), so contact costs few more iterations. Friction goes by the
//! force along the normal that the direction itself brings about. Velocities are dealt with at the end of the step: what a node
//! brings along the normal is lost or returned by the restitution, and friction takes µ times that change as well.

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
