//! One minimisation for all bodies that have implicit integrators and that a barrier keeps apart. Its result is the end of a substep.
//!
//! ```text
//! Σ Φ(u) + B(x₀ + u) + D(u) → min    Φ of each body, B the barrier, D friction at given normal forces
//! ```
//!
//! Newton's method with conjugate gradients finds a direction. The matrix of all bodies consists of the matrices of the bodies, each with its own
//! factor, and of the second derivatives of B and D, which form a sparse matrix of their own. A correction ends before any pair meets, and it reduces the sum.
//! Surfaces that are apart at the start of a substep are therefore apart at its end. Outer rounds find the friction multipliers and the normal forces
//! on which friction depends.
//!
//! Source: M. Li and others, Incremental potential contact, ACM Trans. Graph. 39 (2020), algorithm 1.

use crate::island::Island;
use crate::pair_stiffness::{PairStiffness, Points};
use crate::refusals::Refusal;
use crate::staying::{BALANCED, Staying, norm};
use opruga_collide::{Barrier, Pressed, Rubbing, Touching, Trouble};
use opruga_core::error::StepError;
use opruga_core::open_step::OpenStep;
use opruga_core::system::Workspace;
use opruga_math::{Lane, Simd};
use opruga_solve::{Directions, Preconditioner, conjugate_gradients, dot};

/// The tolerance of the linear solver in the first iteration, relative to its right-hand side. The tolerance falls with the residual, as for a single
/// body.
const LEFT: f64 = 1e-2;

/// The smallest tolerance of the linear solver. Below it the residuals of stiff bodies (1e7 Pa) are rounding errors, and directions computed from
/// them are useless.
const LEAST_LEFT: f64 = 1e-9;

/// The maximum number of matrix products in the method of conjugate gradients. Each pair under a large force needs about one product.
const MOST_PRODUCTS: u32 = 2000;

/// The maximum number of iterations of a search with a budget, including those that do not count against the budget. This maximum equals the limit
/// for exact steps without friction.
const MOST_IN_BUDGET: u32 = 100;

/// The maximum number of rounds of friction, and the relative change of the friction force at which they end.
pub(crate) const MOST_ROUNDS: u32 = 30;
pub(crate) const SETTLED: f64 = 1e-3;

/// The fraction of the largest residual, and of the forces on the bodies, at which a search with a budget ends. With 0.2 instead, the impact of 27 cubes
/// creates 4 % of the energy in motion, and the ledger of a tower closes to 2 % (`a_barrier_with_a_budget_leaves_bodies_where_exact_steps_do`). The
/// largest residual alone is no measure where obstacles or pins move: a twentieth of the residual that closing plates cause throws the block between
/// them (`plates_lift_a_block_in_real_time_under_a_barrier`).
const ENOUGH: f64 = 0.05;

/// The tolerance of the linear solver relative to `ENOUGH`, and its largest value relative to the right-hand side. These two numbers reduce
/// iterations at the price of more products, or the reverse. The residual at which a search ends does not depend on them.
const LINEAR_SHARE: f64 = 0.5;
const MOST_LEFT: f64 = 0.1;

/// The data that a scene keeps for its barrier.
#[derive(Debug, Default)]
pub(crate) struct Kept<const D: usize> {
    pub(crate) barrier: Barrier<D>,
    /// The friction forces of the previous substep [N], in ascending order of the features of the pairs.
    pub(crate) multipliers: Vec<(u64, [f64; D])>,
    pub(crate) workspaces: Vec<Workspace<D>>,
    /// The maximum number of times that a substep is halved if its search does not converge.
    pub(crate) most_halvings: u32,
}

impl<const D: usize> Kept<D> {
    pub(crate) fn new(reach: f64, simd: Simd) -> Self {
        Kept { barrier: Barrier::new(reach, simd), ..Kept::default() }
    }
}

/// Errors that end a substep for all bodies.
pub(crate) enum Refused {
    Step(StepError),
    Trouble(Trouble),
}
impl From<StepError> for Refused {
    fn from(error: StepError) -> Self {
        Refused::Step(error)
    }
}
impl From<Trouble> for Refused {
    fn from(trouble: Trouble) -> Self {
        Refused::Trouble(trouble)
    }
}

/// A body whose step has begun, and the index of its first coordinate in the long vectors.
pub(crate) struct Opened<const D: usize> {
    pub(crate) island: usize,
    pub(crate) first: usize,
    pub(crate) step: Box<dyn OpenStep<D>>,
}

/// The search for the common end of a substep.
pub(crate) struct Search<'a, 'b, const D: usize> {
    pub(crate) islands: &'a mut [&'b mut Island<D>],
    pub(crate) touching: &'a mut Touching<D>,
    pub(crate) barrier: &'a mut Barrier<D>,
    pub(crate) opened: Vec<Opened<D>>,
    /// The body and first coordinate index of every point of the surfaces; `None` for points of obstacles.
    pub(crate) coordinates: Vec<Option<(usize, usize)>>,
    /// Displacements of all points since the start of the step, and their positions.
    pub(crate) moved: Vec<[f64; D]>,
    pub(crate) x: Vec<[f64; D]>,
    pub(crate) trial: Vec<[f64; D]>,
    /// The remaining displacements of obstacles [m].
    pub(crate) ahead: Vec<[f64; D]>,
    pub(crate) pressed: Vec<Pressed<D>>,
    pub(crate) rubbing: Vec<Rubbing<D>>,
    /// Second derivatives of the energies between bodies at the point where the last correction was computed.
    pub(crate) stiffness: PairStiffness<D>,
    pub(crate) directions: Directions,
    pub(crate) length: usize,
    pub(crate) iterations: u32,
    /// Whether all bodies have a budget (`accuracy = "real_time"`).
    pub(crate) has_budget: bool,
    /// Whether the search has converged, including friction.
    pub(crate) converged: bool,
    /// The factor by which the next correction is lengthened.
    pub(crate) stretch: f64,
    /// The work that the motion of obstacles is expected to do along the correction, with the forces at its end [J]. Like the work of pins and of
    /// friction on obstacles, it raises the sum of the energies without being a reason to shorten the correction.
    pub(crate) by_obstacles: f64,
    /// With a budget, the norm of the residual at the start, without the motion that pins and obstacles prescribe [N].
    pub(crate) unprescribed: f64,
    /// The factor by which sticking is stiffer than at first.
    pub(crate) sticking: f64,
    /// The terms that keep bodies at rest near their present positions during a correction; `None` for moving bodies.
    pub(crate) staying: Option<Staying>,
}

/// The residual of an iteration.
struct Residual {
    /// The forces between bodies with their sign reversed, ∂(B + D)/∂u [N].
    gradient: Vec<f64>,
    /// The displacements that obstacles and pins prescribe for nodes [m].
    prescribed: Vec<f64>,
    /// The right-hand side for the correction [N].
    right: Vec<f64>,
    /// The norm of the right-hand side, relative to its largest value in this search. With a budget, relative to the forces on the bodies if these are
    /// smaller.
    share: f64,
    /// Whether bodies at rest are in equilibrium.
    balanced: bool,
}

/// The points of a pair and their weights.
type Weighted<'a> = (&'a [u32; 4], &'a [f64; 4]);

/// The factors of the matrices of all bodies, which together precondition the common system of equations.
struct Factors<'a, const D: usize>(&'a [Opened<D>]);

impl<const D: usize> Preconditioner for Factors<'_, D> {
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        z.copy_from_slice(r);
        for Opened { first, step, .. } in self.0 {
            step.solve(&mut z[*first..first + step.displacements().len()]);
        }
    }
}

impl<const D: usize> Search<'_, '_, D> {
    /// Finds the compliance of the points from the matrices at the start of the step.
    pub(crate) fn find_softness(&mut self) -> Result<(), Refused> {
        self.barrier.softness.clear();
        self.barrier.softness.resize(self.coordinates.len(), 0.0);
        self.stay()?;
        for Opened { island, step, .. } in &mut self.opened {
            step.look(&self.islands[*island].system);
        }
        self.factor(false)?;
        for (p, of_point) in self.coordinates.iter().enumerate() {
            let Some((body, at)) = *of_point else { continue };
            let Opened { island, first, step } = &self.opened[body];
            let stiffness = step.stiffness(&self.islands[*island].system, (at - first) / D);
            self.barrier.softness[p] = if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 };
        }
        for (p, carrier) in self.touching.surface.carried() {
            let own = carrier.nodes.iter().zip(&carrier.weights);
            self.barrier.softness[p] = own.map(|(node, w)| w * w * self.barrier.softness[*node as usize]).sum();
        }
        Ok(())
    }

    /// Adds σ times the masses to the matrices of bodies at rest, which keeps these bodies near their present positions.
    fn stay(&mut self) -> Result<(), StepError> {
        let Some(staying) = &self.staying else { return Ok(()) };
        for (body, Opened { island, step, .. }) in self.opened.iter_mut().enumerate() {
            step.stay(staying.sigma(body));
            step.evaluate(&mut self.islands[*island].system, 0.0)?;
        }
        Ok(())
    }

    /// Computes the derivatives of all bodies and factors their matrices.
    fn factor(&mut self, exact: bool) -> Result<(), Refused> {
        let islands = &self.islands;
        let refused = self.opened.iter_mut().position(|open| !open.step.factor(&islands[open.island].system, exact));
        refused.map_or(Ok(()), |body| Err(self.not_definite(body)))
    }

    fn not_definite(&self, body: usize) -> Refused {
        let name = self.opened.get(body).map_or("", |open| self.islands[open.island].integrator.name());
        StepError::of(name, Refusal::NoFactor {}).into()
    }

    /// Minimises the sum at given friction by Newton's method. If `precise` is set, continues until the residual is below the tolerance of the
    /// bodies. Otherwise makes a single correction. Returns whether a minimum was found. After a single correction, this means that the forces on the
    /// bodies were in balance before it, to within a fraction of these forces.
    pub(crate) fn find_minimum(&mut self, precise: bool) -> Result<bool, Refused> {
        let (mut first, mut counted, mut decisions) = (0.0, 0, 0);
        self.stretch = if precise { 1.0 } else { self.stretch };
        let (most, accepts) = self.most_iterations();
        loop {
            if counted >= most || self.has_budget && self.iterations >= MOST_IN_BUDGET {
                return self.accept_or_refuse(accepts);
            }
            self.iterations += 1;
            self.stay()?;
            let mut changed = false;
            for Opened { island, step, .. } in &mut self.opened {
                let system = &self.islands[*island].system;
                system.go_on()?;
                changed |= step.look(system);
            }
            if self.has_budget && self.iterations == 1 {
                self.unprescribed = self.unprescribed_residual();
            }
            let balanced = if precise { BALANCED } else { SETTLED };
            if self.has_budget && self.iterations > 1 && self.have_arrived() {
                let left = self.find_residual(&mut first, balanced);
                if left.share <= ENOUGH {
                    return Ok(true);
                }
            }
            // Near the minimum, use exact derivatives; if the sum does not fall along their direction, use derivatives without negative eigenvalues.
            // With a budget, use the latter at once.
            let mut direction = None;
            for exact in [true, false].into_iter().skip(usize::from(self.has_budget)) {
                // The matrices at the start are already known, because the compliance of the points was computed from them.
                if !self.has_budget || self.iterations > 1 || changed {
                    self.factor(exact)?;
                }
                let left = self.find_residual(&mut first, balanced);
                direction = self.find_direction(&left).map(|slope| (slope, left.balanced));
                if direction.is_some_and(|(slope, _)| slope <= 0.0) {
                    break;
                }
            }
            let Some((slope, balanced)) = direction else { return Err(self.not_definite(0)) };
            let part = self.go(slope)?;
            // A correction that was shortened, because pairs would meet or the sum would rise, does not count against a budget. Otherwise bodies
            // would stop in mid-flight.
            counted += u32::from(part == 1.0 || !self.has_budget);
            if let Some(staying) = self.staying.as_mut().filter(|_| part == 1.0) {
                staying.loosen();
            }
            decisions += 1;
            for Opened { island, step, .. } in &mut self.opened {
                changed |= step.judge(&self.islands[*island].system, decisions);
            }
            if !precise {
                return Ok(balanced && !changed);
            }
            let small = self.opened.iter_mut().all(|open| {
                let goal = open.step.goal();
                open.step.correction().iter().all(|c| c.abs() <= goal)
            });
            if small && balanced && !changed {
                return Ok(true);
            }
            if part == 0.0 && !changed {
                return self.accept_or_refuse(accepts);
            }
        }
    }

    /// The largest number of iterations of any body, and whether all bodies accept a search that has not converged by then.
    pub(crate) fn most_iterations(&self) -> (u32, bool) {
        let each = self.opened.iter().map(|open| open.step.most_iterations());
        each.fold((0, true), |(most, all), (iterations, accepts)| (most.max(iterations), all && accepts))
    }

    /// Accepts a result that is not a minimum, if the scene allows it and obstacles have arrived at their positions. In the next step they would
    /// start there, inside bodies that have not made way.
    pub(crate) fn accept_or_refuse(&mut self, accepts: bool) -> Result<bool, Refused> {
        self.converged = false;
        if accepts && self.have_arrived() { Ok(true) } else { Err(self.no_end(self.iterations)) }
    }

    /// Whether all obstacles have arrived at the positions that their motion prescribes for the end of the step.
    fn have_arrived(&self) -> bool {
        self.ahead.iter().all(|ahead| *ahead == [0.0; D])
    }

    fn no_end(&self, iterations: u32) -> Refused {
        let name = self.opened.first().map_or("", |open| self.islands[open.island].integrator.name());
        StepError::of(name, Refusal::NoCommonEnd { iterations }).into()
    }

    /// Whether the forces on every body at rest balance, without the terms that keep it near its present position. `gradient` contains the forces
    /// between bodies, `left` the residual, and `most` the largest allowed residual relative to the forces.
    fn is_balance(&self, gradient: &[f64], left: &[f64], most: f64) -> bool {
        let balances = |open: &Opened<D>| {
            let (left, range) = (norm(&left[open.range()]), open.range());
            let size = norm(open.step.residual()) + norm(&gradient[range]);
            left <= most * size || left <= open.step.rounding_of_forces(&self.islands[open.island].system)
        };
        self.staying.is_none() || self.opened.iter().all(balances)
    }

    /// Distributes a force of a pair over the nodes of its points, by weight.
    fn scatter(&self, (points, weights): Weighted<'_>, force: &[f64; D], to: &mut [f64]) {
        for (p, w) in points.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            self.touching.surface.visit_nodes(*p, |node, share| {
                if let Some((_, at)) = self.coordinates[node as usize] {
                    (0..D).for_each(|d| to[at + d] += w * share * force[d]);
                }
            });
        }
    }

    /// ∂(B + D)/∂u [N].
    pub(crate) fn gradient(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.length];
        for pair in &self.pressed {
            self.scatter((&pair.points, &pair.weights), &scaled(&pair.normal, -pair.force), &mut out);
            for (k, fading) in pair.fading.iter().enumerate() {
                let mut one = [0.0; 4];
                one[k] = 1.0;
                self.scatter((&pair.points, &one), fading, &mut out);
            }
        }
        for rub in &self.rubbing {
            let force = rub.force(&rub.slip(&self.moved));
            self.scatter((&rub.points, &rub.weights), &scaled(&force, -1.0), &mut out);
        }
        out
    }

    /// The slope of B + D along the remaining motion of obstacles [J].
    pub(crate) fn slope_of_obstacles(&self) -> f64 {
        let along = |p: u32, w: f64, force: &[f64; D]| w * dot(&self.ahead[p as usize], force);
        let of_pair = |points: &[u32; 4], weights: &[f64; 4], force: &[f64; D]| -> f64 {
            points.iter().zip(weights).map(|(p, w)| along(*p, *w, force)).sum()
        };
        let mut slope = 0.0;
        for pair in &self.pressed {
            slope += of_pair(&pair.points, &pair.weights, &scaled(&pair.normal, -pair.force));
            slope += pair.points.iter().zip(&pair.fading).map(|(p, fading)| along(*p, 1.0, fading)).sum::<f64>();
        }
        for rub in &self.rubbing {
            slope -= of_pair(&rub.points, &rub.weights, &rub.force(&rub.slip(&self.moved)));
        }
        slope
    }

    /// Finds the residual. `first` is its largest norm so far; `balanced` is the largest residual, relative to the forces, at which bodies at rest
    /// count as being in equilibrium.
    fn find_residual(&mut self, first: &mut f64, balanced: f64) -> Residual {
        let gradient = self.gradient();
        let between = (&self.pressed[..], &self.rubbing[..]);
        let Search { stiffness, touching, coordinates, ahead, moved, .. } = self;
        let points = Points { surface: &touching.surface, coordinates, ahead };
        stiffness.take(between, moved, &points, self.length);
        let mut prescribed = vec![0.0; self.length];
        for open in &self.opened {
            prescribed[open.range()].copy_from_slice(open.step.prescribed());
        }
        let mut forces = gradient.clone();
        self.stiffness.multiply(&prescribed, true, &mut forces);
        let mut right = vec![0.0; self.length];
        for open in &mut self.opened {
            let range = open.range();
            open.step.right_side(&self.islands[open.island].system, &forces[range.clone()], &mut right[range]);
        }
        let (size, balanced) = (norm(&right), self.is_balance(&gradient, &right, balanced));
        *first = size.larger(*first);
        let mut whole = *first;
        if self.has_budget {
            whole = self.size_of_forces(&gradient).larger(self.unprescribed).smaller(whole);
        }
        let share = if whole > 0.0 { (size / whole).larger(1e-9) } else { 1.0 };
        Residual { gradient, prescribed, right, share, balanced }
    }

    /// The sum of the sizes of the forces on every body [N]: of its own forces together, and of the forces of other bodies and obstacles.
    fn size_of_forces(&self, gradient: &[f64]) -> f64 {
        self.opened.iter().map(|open| norm(open.step.residual()) + norm(&gradient[open.range()])).sum()
    }

    /// The norm of the residual without the motion that pins and obstacles prescribe [N].
    fn unprescribed_residual(&self) -> f64 {
        let mut left = self.gradient();
        for open in &self.opened {
            let left = &mut left[open.range()];
            left.iter_mut().zip(open.step.residual()).for_each(|(left, own)| *left += own);
            open.step.filter(left);
        }
        norm(&left)
    }

    /// Finds the correction of all bodies. Returns the slope of the sum along it, if the sum falls.
    fn find_direction(&mut self, left: &Residual) -> Option<f64> {
        let Residual { gradient, prescribed, right, share, .. } = left;
        let (linear, settled) = if self.has_budget {
            let enough = (LINEAR_SHARE * ENOUGH / share).smaller(MOST_LEFT);
            (enough, enough)
        } else {
            ((LEFT * share).larger(LEAST_LEFT), LEFT * share)
        };
        let mut step = self.solve(right, linear)?;
        for _ in 0..MOST_ROUNDS {
            let mut whole: Vec<f64> = step.iter().zip(prescribed).map(|(s, p)| self.stretch * s + p).collect();
            for open in &mut self.opened {
                let range = open.range();
                open.step.correction().copy_from_slice(&whole[range]);
            }
            // Constraints on nodes also take up the forces between bodies.
            let mut between = gradient.clone();
            self.stiffness.multiply(&whole, true, &mut between);
            let mut changed = false;
            whole.fill(0.0);
            for open in &mut self.opened {
                let range = open.range();
                let system = &self.islands[open.island].system;
                let follows = open.step.follow(system, &between[range.clone()], settled, &mut whole[range.clone()]);
                if !follows {
                    whole[range].fill(0.0);
                }
                changed |= follows;
            }
            if !changed {
                break;
            }
            // There may be no solution if the change of friction is only a rounding error.
            let Some(more) = self.solve(&whole, LEFT.larger(linear)) else { break };
            step.iter_mut().zip(&more).for_each(|(s, more)| *s += more);
        }
        let mut whole = vec![0.0; self.length];
        for open in &mut self.opened {
            let range = open.range();
            whole[range].copy_from_slice(open.step.correction());
        }
        self.by_obstacles = self.slope_of_obstacles() + self.stiffness.work_on_obstacles(&whole);
        Some(self.slope(gradient))
    }

    /// Solves the linear system with the matrix of all bodies and of the energies between them by conjugate gradients. Returns none if the result is
    /// not a direction of descent.
    fn solve(&mut self, right: &[f64], tolerance: f64) -> Option<Vec<f64>> {
        let mut out = vec![0.0; self.length];
        let mut directions = std::mem::take(&mut self.directions);
        let multiply = |x: &[f64], y: &mut [f64]| {
            for open in &self.opened {
                let range = open.range();
                open.step.multiply(&self.islands[open.island].system, &x[range.clone()], &mut y[range]);
            }
            self.stiffness.multiply(x, false, y);
            for open in &self.opened {
                open.step.filter(&mut y[open.range()]);
            }
        };
        let by = Factors(&self.opened);
        let ended = conjugate_gradients(multiply, &by, right, &mut out, tolerance, MOST_PRODUCTS, &mut directions);
        self.directions = directions;
        // Near the solution the directions consist of rounding errors, but the result so far may still be a direction of
        // descent.
        let leads_down = ended.is_ok() || dot(right, &out) > 0.0;
        (leads_down && out.iter().all(|x| x.is_finite())).then_some(out)
    }
}

impl<const D: usize> Opened<D> {
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.step.displacements().len()
    }
}

pub(crate) fn scaled<const D: usize>(a: &[f64; D], s: f64) -> [f64; D] {
    a.map(|c| c * s)
}
