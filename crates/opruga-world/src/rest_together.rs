//! The common equilibrium of bodies at rest that touch.
//!
//! ```text
//! (K + σM) d = F(x) + f',   x' = x + d
//! ```
//!
//! This is the correction d of one body from the positions x, with its stiffness matrix K at x and its mass matrix M. The contact forces f' at the
//! end of the correction follow from the gaps at x and the answers (K + σM)⁻¹ of all bodies, as in a common step of implicit integrators.
//!
//! Newton's method finds the equilibrium of all bodies at once. Positions and contact forces are unknowns of the same linear problem, so a body that
//! only lies on others is supported by them in every correction. If each body instead found its own end of the correction under given forces, errors
//! of these forces would move the body as far as σ permits.
//!
//! σ ([`Staying`]) falls as the forces at the end of corrections approach the predicted ones. Friction opposes the sliding of each correction.
//!
//! Contact within a correction is solved as for implicit integrators, by the method of the same publication (see `pushes.rs`).

use crate::barrier_search::{Opened, Refused};
use crate::island::Island;
use crate::meeting::{Meeting, Pushed, Substep};
use crate::refusals::Refusal;
use crate::staying::{BALANCED, Staying, norm};
use opruga_collide::{Respond, Touching, Trouble};
use opruga_core::error::StepError;
use opruga_core::integrator::next_matrix_number;
use opruga_core::system::{System, Workspace};
use opruga_math::Lane;

/// Two limits for the error of the predicted forces at the end of a correction, relative to the forces that act in it: the largest allowed error, and
/// the error below which σ falls.
const FORESEEN: f64 = 0.5;
const WELL_FORESEEN: f64 = 0.1;

/// The factor by which σ grows if a correction was not predicted well, and the largest σ, at which nodes hardly move.
const HARDER: f64 = 16.0;
const MOST: f64 = 1e6;

/// The maximum number of corrections, including refused ones. Stacks of five bodies need fewer than forty; a body that slides for ever would use all
/// of them.
const MOST_CORRECTIONS: usize = 200;

/// The longest correction, as a fraction of the extent of the body.
const LONGEST: f64 = 0.5;

/// The largest correction after which the bodies count as being at rest, relative to the thickness of surfaces.
const AT_REST: f64 = 1e-7;

/// The residual, relative to the forces on a body, that is accepted if rounding keeps it from falling further, and the number of corrections after
/// which it is accepted.
const NEARLY_BALANCED: f64 = 1e-6;
const MOST_AT_REST: usize = 10;

/// The forces of other bodies, by nodes [N].
type Pushes<const D: usize> = Vec<(usize, [f64; D])>;

/// A body on its way to equilibrium.
struct Body<const D: usize> {
    open: Opened<D>,
    /// The range of its points, and the index of the first coordinate of each point among the coordinates of its nodes.
    points: std::ops::Range<usize>,
    coordinates: Vec<usize>,
    /// Its extent [m].
    extent: f64,
    /// The residual, and the size of the forces that balance [N].
    rest: f64,
    size: f64,
    /// The part of the residual that is due to rounding of positions [N]. Without this floor, a body without forces would be judged by its rounding
    /// errors and would keep all others from equilibrium (`bodies_without_forces_do_not_keep_others_from_their_balance`).
    rounding: f64,
    /// Whether obstacles hold other nodes than before, or hold them differently.
    constraints_changed: bool,
}

/// The search for the common equilibrium.
struct Search<'a, 'b, const D: usize> {
    islands: &'a mut [&'b mut Island<D>],
    touching: &'a mut Touching<D>,
    bodies: Vec<Body<D>>,
    h: f64,
    staying: Staying,
    /// The number of the present matrices.
    matrix: u64,
}

/// Obtains the responses of bodies to impulses.
struct Answers<'a, const D: usize> {
    bodies: &'a [Body<D>],
    vector: Vec<f64>,
    h: f64,
    /// The number of the matrices of all bodies.
    matrix: u64,
}

impl<const D: usize> Body<D> {
    fn solve(&self, vector: &mut [f64]) {
        self.open.step.filter(vector);
        self.open.step.solve(vector);
        self.open.step.filter(vector);
    }

    /// The forces of other bodies in the form of [`System::pushes`], from the impulses on all points [N].
    fn pushes(&self, impulses: &[[f64; D]], h: f64) -> Pushes<D> {
        let own = self.coordinates.iter().zip(&impulses[self.points.clone()]);
        own.filter(|(_, impulse)| **impulse != [0.0; D]).map(|(at, p)| (at / D, p.map(|c| c / h))).collect()
    }

    /// Computes forces and the matrix at the present positions, and from them the correction with the present contact forces; returns whether the
    /// matrix can be factored.
    fn begin_correction(&mut self, system: &mut System<D>, sigma: f64) -> Result<bool, StepError> {
        system.go_on()?;
        let step = &mut self.open.step;
        step.stay(sigma);
        step.evaluate(system, 0.0)?;
        self.constraints_changed |= step.look(system);
        if !step.factor(system, true) {
            return Ok(false);
        }
        let (none, mut displacement) = (vec![0.0; step.displacements().len()], vec![0.0; step.displacements().len()]);
        step.right_side(system, &none, &mut displacement);
        self.rest = norm(&displacement);
        let pushes: f64 = system.pushes.iter().flatten().flat_map(|(_, force)| force).map(|c| c * c).sum();
        self.size = norm(step.residual()) + pushes.sqrt();
        self.rounding = step.rounding_of_forces(system);
        self.solve(&mut displacement);
        let step = &mut self.open.step;
        displacement
            .iter_mut()
            .zip(step.prescribed())
            .for_each(|(displacement, prescribed)| *displacement += prescribed);
        step.correction().copy_from_slice(&displacement);
        Ok(true)
    }

    /// Adds the effect of new contact forces to the correction, and computes the forces at its end. Returns the largest displacement [m] and the part
    /// of the forces that was not predicted; `None` if the correction is too long or if a model is not defined at its end.
    fn end_correction(&mut self, system: &mut System<D>, pushes: Pushes<D>) -> Option<(f64, f64)> {
        let mut change = vec![0.0; self.open.step.displacements().len()];
        for (of, sign) in [(&pushes, 1.0), (system.pushes.as_ref().unwrap_or(&Vec::new()), -1.0)] {
            of.iter().for_each(|(node, force)| (0..D).for_each(|d| change[node * D + d] += sign * force[d]));
        }
        let mut added = change.clone();
        self.solve(&mut added);
        let step = &mut self.open.step;
        step.correction().iter_mut().zip(&added).for_each(|(c, added)| *c += added);
        if !self.is_short() {
            return None;
        }
        // Constraints on nodes also take up the forces between bodies.
        let step = &mut self.open.step;
        let without: Vec<f64> = change.iter().map(|c| -c).collect();
        self.constraints_changed = step.follow(system, &without, BALANCED, &mut added);
        system.pushes = Some(pushes);
        step.evaluate(system, 1.0).ok()?;
        step.filter(&mut change);
        let acting = self.rest + norm(&change);
        // The right-hand side of another correction is the residual with the terms of the prescribed motion. This correction has already made that
        // motion, so its terms are removed.
        let (mut left, mut done) = (vec![0.0; change.len()], vec![0.0; change.len()]);
        step.multiply(system, step.prescribed(), &mut done);
        step.filter(&mut done);
        change.fill(0.0);
        step.right_side(system, &change, &mut left);
        left.iter_mut().zip(&done).for_each(|(left, done)| *left += done);
        let left = norm(&left);
        Some((self.longest_displacement(), if self.is_balance(left, BALANCED) { 0.0 } else { left / acting }))
    }

    /// Whether a residual is at most the given fraction of the forces on the body, or rounding.
    fn is_balance(&self, left: f64, part: f64) -> bool {
        left <= part * self.size || left <= self.rounding
    }

    fn is_short(&mut self) -> bool {
        let most = LONGEST * self.extent;
        self.open.step.correction().iter().all(|c| c.abs() <= most)
    }

    /// The largest displacement of the correction [m].
    fn longest_displacement(&mut self) -> f64 {
        self.open.step.correction().iter().fold(0.0, |most: f64, c| c.abs().larger(most))
    }
}

impl<const D: usize> Respond<D> for Answers<'_, D> {
    fn matrix(&mut self, _body: usize) -> Option<u64> {
        Some(self.matrix)
    }
    fn respond(&mut self, body: usize, point: usize, out: &mut [[[f64; D]; D]]) -> bool {
        let body = &self.bodies[body];
        for d in 0..D {
            self.vector.clear();
            self.vector.resize(body.open.step.displacements().len(), 0.0);
            self.vector[body.coordinates[point] + d] = 1.0 / self.h;
            body.solve(&mut self.vector);
            for (out, at) in out.iter_mut().zip(&body.coordinates) {
                for i in 0..D {
                    out[d][i] = self.vector[at + i] / self.h;
                }
            }
        }
        self.vector.iter().all(|x| x.is_finite())
    }
}

impl<const D: usize> Meeting<D> {
    /// Brings bodies at rest into their common equilibrium. If there is no such equilibrium, the outcome of an island contains the error.
    pub(crate) fn come_to_balance(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
    ) -> Result<(), Trouble> {
        let staying = Staying::new(self.pushed.iter().map(|pushed| &*islands[pushed.island]));
        let mut workspaces: Vec<Workspace<D>> = self.pushed.iter().map(|_| Workspace::default()).collect();
        exchange(&self.pushed, islands, &mut workspaces);
        self.move_outlines(step.time);
        let mut search =
            Search { islands, touching: &mut self.touching, bodies: Vec::new(), h: step.plan.h, staying, matrix: 0 };
        let outcome = search.begin(&self.pushed, step).and_then(|()| search.find_balance());
        let outcome = outcome.and_then(|iterations| search.close(iterations));
        let farthest = search.farthest();
        exchange(&self.pushed, islands, &mut workspaces);
        match outcome {
            Ok(()) => Ok(()),
            Err(Refused::Trouble(trouble)) => Err(trouble),
            Err(Refused::Step(error)) => {
                islands[self.pushed[farthest].island].refuse(error);
                Ok(())
            }
        }
    }
}

impl<const D: usize> Search<'_, '_, D> {
    /// Begins the steps of all bodies, and reads the positions of their points.
    fn begin(&mut self, pushed: &[Pushed<D>], step: &Substep<'_, D>) -> Result<(), Refused> {
        let [x0, v0] = &mut self.touching.before;
        for v in v0.iter_mut() {
            *v = [0.0; D];
        }
        for (number, pushed) in pushed.iter().enumerate() {
            let island = &mut self.islands[pushed.island];
            island.system.pushes = Some(Vec::new());
            island.begin_as_one(step.plan, step.number);
            // Bodies with explicit integrators are refused before the run.
            let Some(begun) = island.integrator.open(&mut island.system, self.h) else { continue };
            let points = self.touching.coupled.points_of(number);
            let mut extent: f64 = 0.0;
            for d in 0..D {
                let own = x0[points.clone()].iter().map(|x| x[d]);
                let (low, high) =
                    own.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (x.smaller(low), x.larger(high)));
                extent = (high - low).larger(extent);
            }
            self.bodies.push(Body {
                open: Opened { island: pushed.island, first: 0, step: begun? },
                points,
                coordinates: pushed.indices.iter().map(|index| *index as usize * D).collect(),
                extent,
                rest: f64::INFINITY,
                size: 0.0,
                rounding: 0.0,
                constraints_changed: false,
            });
        }
        self.touching.begin_step();
        self.touching.given.clear();
        let extent = self.bodies.iter().fold(0.0, |most: f64, body| body.extent.larger(most));
        self.touching.farthest = 2.0 * LONGEST * extent;
        Ok(())
    }

    /// Finds the equilibrium; returns the number of corrections.
    fn find_balance(&mut self) -> Result<u32, Refused> {
        let goal = AT_REST * self.touching.laws.largest_thickness()[0];
        let (mut moved, mut at_rest) = (f64::INFINITY, 0);
        for number in 0..MOST_CORRECTIONS {
            let factored = self.begin_correction()?;
            if factored && moved <= goal && !self.bodies.iter().any(|body| body.constraints_changed) {
                at_rest += 1;
                let part = if at_rest > MOST_AT_REST { NEARLY_BALANCED } else { BALANCED };
                if self.bodies.iter().all(|body| body.is_balance(body.rest, part)) {
                    return Ok(number as u32);
                }
            }
            match if factored { self.correct()? } else { None } {
                Some((displacement, unforeseen)) if unforeseen <= FORESEEN => {
                    self.go();
                    if displacement > moved {
                        self.staying.firm_up();
                    } else if unforeseen <= WELL_FORESEEN {
                        self.staying.loosen();
                    }
                    moved = displacement;
                }
                _ => {
                    self.staying.part *= HARDER;
                    if self.staying.part > MOST {
                        return Err(StepError::of("contact", Refusal::NoAgreementAtRest {}).into());
                    }
                    self.put_pushes_back();
                }
            }
        }
        Err(StepError::of("contact", Refusal::NoCommonBalance { steps: MOST_CORRECTIONS, moved }).into())
    }

    /// Computes forces and matrices at the present positions; returns whether the matrices can be factored.
    fn begin_correction(&mut self) -> Result<bool, Refused> {
        self.matrix = next_matrix_number();
        for (number, body) in self.bodies.iter_mut().enumerate() {
            if !body.begin_correction(&mut self.islands[body.open.island].system, self.staying.sigma(number))? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Finds the correction of all bodies, with the contact forces at its end. Returns the largest displacement [m] and the part of the forces that
    /// was not predicted; `None` if the correction is not possible.
    fn correct(&mut self) -> Result<Option<(f64, f64)>, Refused> {
        let Search { islands, touching, bodies, h, matrix, .. } = &mut *self;
        let (h, matrix) = (*h, *matrix);
        let Touching { before: [x0, _], after: [x1, v1], .. } = &mut **touching;
        for body in bodies.iter_mut() {
            if !body.is_short() {
                return Ok(None);
            }
            let displacement = body.open.step.correction();
            for (p, at) in body.points.clone().zip(&body.coordinates) {
                x1[p] = std::array::from_fn(|d| x0[p][d] + displacement[at + d]);
            }
        }
        for ((x0, x1), v1) in x0.iter().zip(x1.iter()).zip(v1.iter_mut()) {
            *v1 = std::array::from_fn(|d| (x1[d] - x0[d]) / h);
        }
        let mut answers = Answers { bodies, vector: Vec::new(), h, matrix };
        if !touching.find_impulses(h, None, Some(&mut answers))? {
            return Ok(None);
        }
        let mut impulses = vec![[0.0; D]; touching.inverse_mass.len()];
        touching.visit_impulses(|point, impulse| (0..D).for_each(|d| impulses[point][d] += impulse[d]));
        let (mut displacement, mut unforeseen): (f64, f64) = (0.0, 0.0);
        for body in bodies.iter_mut() {
            let pushes = body.pushes(&impulses, h);
            let end = body.end_correction(&mut islands[body.open.island].system, pushes);
            let Some((own, part)) = end else { return Ok(None) };
            (displacement, unforeseen) = (own.larger(displacement), part.larger(unforeseen));
        }
        Ok(Some((displacement, unforeseen)))
    }

    /// Applies the corrections.
    fn go(&mut self) {
        let (h, touching) = (self.h, &mut *self.touching);
        let mut given = Vec::new();
        for body in &mut self.bodies {
            let Opened { island, step, .. } = &mut body.open;
            step.advance(1.0);
            let system = &self.islands[*island].system;
            body.constraints_changed |= step.judge(system, 0);
            let displacement = step.correction();
            for (p, at) in body.points.clone().zip(&body.coordinates) {
                (0..D).for_each(|d| touching.before[0][p][d] += displacement[at + d]);
            }
            let first = body.points.start;
            // Coordinates and forces are both in the order of the points.
            let mut points = body.coordinates.iter().enumerate();
            for (node, force) in system.pushes.iter().flatten() {
                if let Some((k, _)) = points.find(|(_, at)| *at / D == *node) {
                    given.push(((first + k) as u32, force.map(|c| c * h)));
                }
            }
        }
        touching.given = given;
        // Obstacles are moved to their positions at the end of the step.
        let Touching { surface, before: [x0, _], after: [x1, _], .. } = &mut *touching;
        for p in (0..x0.len()).filter(|p| surface.is_of_obstacle(*p as u32)) {
            x0[p] = x1[p];
        }
    }

    /// Restores the contact forces at the beginning of a refused correction.
    fn put_pushes_back(&mut self) {
        for body in &self.bodies {
            let mut pushes = Vec::new();
            for (point, impulse) in self.touching.given.iter().filter(|(p, _)| body.points.contains(&(*p as usize))) {
                pushes.push((body.coordinates[*point as usize - body.points.start] / D, impulse.map(|c| c / self.h)));
            }
            self.islands[body.open.island].system.pushes = Some(pushes);
        }
    }

    /// The body whose last correction was the longest.
    fn farthest(&mut self) -> usize {
        let mut most = (0, 0.0);
        for (number, body) in self.bodies.iter_mut().enumerate() {
            let displacement = body.longest_displacement();
            if displacement > most.1 {
                most = (number, displacement);
            }
        }
        most.0
    }

    /// Ends the steps of all bodies.
    fn close(&mut self, iterations: u32) -> Result<(), Refused> {
        self.touching.after[0].clone_from(&self.touching.before[0]);
        self.touching.end_step(self.h);
        for body in std::mem::take(&mut self.bodies) {
            let Opened { island, step, .. } = body.open;
            step.close(&mut self.islands[island].system, iterations, true)?;
        }
        Ok(())
    }
}

/// Exchanges the workspace of each body with the one that is lent to it.
fn exchange<const D: usize>(pushed: &[Pushed<D>], islands: &mut [&mut Island<D>], lent: &mut [Workspace<D>]) {
    for (pushed, workspace) in pushed.iter().zip(lent) {
        islands[pushed.island].system.exchange(workspace);
    }
}
