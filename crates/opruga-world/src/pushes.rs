//! Contact forces on bodies with implicit integrators.
//!
//! ```text
//! step      x₁(f): the end of a step in which the forces f = p/h act on the nodes, p the impulses of contact
//! answer    x₁(f + Δf) ≈ x₁(f) + A⁻¹ Δf/θ, with the matrix A of the step
//! contact   p from the gaps, the free motion x₁(f) − A⁻¹ f/θ and the answer
//! ```
//!
//! Steps and contact are solved in turn until they agree on the end of the step; this is Newton's method for f. The initial values are the forces of
//! the previous substep, so bodies that rest on one another need only one step.
//!
//! Source: M. Otaduy, R. Tamstorf, D. Steinemann, M. Gross, Implicit contact handling for deformable objects, Computer Graphics Forum 28 (2009)
//! 559–568.

use crate::island::Island;
use crate::meeting::{Meeting, Pushed, Substep};
use opruga_collide::{Obstacles, Respond, Touching, Trouble};
use opruga_core::system::Workspace;
use opruga_math::{Lane, WIDTH};
use std::sync::Arc;

/// Each pair is a number of rounds and the tolerance that applies until this number is reached. Steps and contact agree if no point ends farther than
/// the tolerance, relative to the thickness of surfaces, from the position that the impulses should give it. Exact steps reach the first tolerance in
/// two or three rounds, and steps with a budget reach the second tolerance. If contacts, or the nodes that obstacles hold, change in every round, the
/// last tolerance is sufficient; surfaces begin to overlap at this size.
const AGREED: [(usize, f64); 3] = [(3, 1e-7), (6, 1e-4), (MOST_ROUNDS, 1e-2)];

/// The same pairs for bodies that all have a budget. Surfaces with a thickness then keep half of it between them.
const AGREED_IN_BUDGET: [(usize, f64); 1] = [(MOST_ROUNDS, 0.5)];

/// The maximum number of rounds.
const MOST_ROUNDS: usize = 12;

/// Obtains the responses of bodies to impulses.
struct Answers<'a, 'b, const D: usize> {
    islands: &'a mut [&'b mut Island<D>],
    pushed: &'a mut [Pushed<D>],
    workspace: &'a mut Workspace<D>,
    h: f64,
    vector: Vec<f64>,
}

impl<const D: usize> Answers<'_, '_, D> {
    /// The displacements at the end of the step that impulses on points of a body cause, node by node in `self.vector`. Returns whether the body
    /// responds.
    fn displace(&mut self, body: usize, impulses: impl Iterator<Item = (usize, [f64; D])>) -> bool {
        if self.matrix(body).is_none() {
            return false;
        }
        let pushed = &self.pushed[body];
        let island = &mut self.islands[pushed.island];
        self.vector.clear();
        self.vector.resize(island.system.nodes * D, 0.0);
        for (point, impulse) in impulses {
            let node = pushed.indices[point] as usize;
            for d in 0..D {
                self.vector[node * D + d] += impulse[d] / self.h;
            }
        }
        island.integrator.answer(&mut island.system, &mut self.vector, 1)
    }
}

impl<const D: usize> Respond<D> for Answers<'_, '_, D> {
    fn matrix(&mut self, body: usize) -> Option<u64> {
        let pushed = &mut self.pushed[body];
        if pushed.matrix.is_none() {
            let island = &mut self.islands[pushed.island];
            island.system.exchange(self.workspace);
            pushed.matrix = island.integrator.prepare_answer(&mut island.system).unwrap_or(None);
            island.system.exchange(self.workspace);
        }
        pushed.matrix
    }
    fn respond(&mut self, body: usize, point: usize, out: &mut [[[f64; D]; D]]) -> bool {
        if self.matrix(body).is_none() {
            return false;
        }
        let pushed = &self.pushed[body];
        let island = &mut self.islands[pushed.island];
        let (size, node) = (island.system.nodes * D, pushed.indices[point] as usize);
        self.vector.clear();
        self.vector.resize(D * size, 0.0);
        (0..D).for_each(|d| self.vector[d * size + node * D + d] = 1.0 / self.h);
        let answered = island.integrator.answer(&mut island.system, &mut self.vector, D);
        for (out, index) in out.iter_mut().zip(&pushed.indices) {
            for (d, vector) in self.vector.chunks_exact(size).enumerate() {
                for i in 0..D {
                    out[d][i] = vector[*index as usize * D + i] / self.h;
                }
            }
        }
        answered
    }
}

/// Whether the steps of bodies were repeated because they did not end where the impulses should have taken them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Again {
    No,
    Yes,
    /// The repeated steps end farther away than the first ones, and by more than the distance up to which surfaces count as close. The bodies then
    /// respond so differently from the linear prediction that further rounds would move them ever farther.
    Diverges,
}

impl<const D: usize> Meeting<D> {
    /// Begins a frame and discards the results of the previous one.
    pub(crate) fn begin(&mut self, islands: &[&mut Island<D>]) {
        self.touching.begin();
        if let Some(island) = islands.first() {
            self.touching.break_off = Arc::clone(&island.system.break_off);
        }
        self.mixed.clear();
    }

    /// Ends a frame and removes the contact forces, so that queries between frames do not include them.
    pub(crate) fn end(&mut self, islands: &mut [&mut Island<D>]) {
        self.pushed.iter().for_each(|pushed| islands[pushed.island].system.pushes = None);
    }

    /// Keeps the states that bodies return to within the substep.
    pub(crate) fn mark(&mut self, islands: &mut [&mut Island<D>]) {
        for (body, pushed) in self.pushed.iter_mut().enumerate() {
            let island = &mut islands[pushed.island];
            island.mark();
            pushed.matrix = None;
            if pushed.applied.is_empty() {
                island.system.pushes = None;
            }
            // The velocities are those of the body, not the mean velocities of its last step.
            for (p, index) in self.touching.coupled.points_of(body).zip(&pushed.indices) {
                self.touching.before[1][p] = island.system.state.v.at(*index as usize);
            }
        }
    }

    /// Repeats the steps and the solution of contact until both agree; returns whether they do.
    pub(crate) fn iterate_with_contact(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
        obstacles: Option<Obstacles<'_, D>>,
    ) -> Result<bool, Trouble> {
        let h = step.plan.h;
        let thickness = self.touching.laws.largest_thickness()[0];
        for round in 0..=MOST_ROUNDS {
            if round > 0 {
                self.take(islands, step.time);
            }
            self.take_mean_velocities(h);
            let Meeting { touching, pushed, workspace, .. } = &mut *self;
            let mut answers = Answers { islands, pushed, workspace, h, vector: Vec::new() };
            if !free_motion(touching, &mut answers) || !touching.find_impulses(h, obstacles, Some(&mut answers))? {
                return Ok(false);
            }
            // In the last round, no step is repeated: the end of the present step must only be free of penetration. The remaining error is left to
            // the next substep.
            let agreed: &[_] = if self.touching.has_budget { &AGREED_IN_BUDGET } else { &AGREED };
            let agreed = agreed.iter().find(|(before, _)| round < *before);
            let enough = agreed.map_or(f64::INFINITY, |(_, part)| part * thickness);
            let again = self.step_again(islands, step, enough);
            if again == Again::Diverges {
                return Ok(false);
            }
            if again == Again::No {
                let nobody_pushes = (0..self.pushed.len()).all(|body| {
                    self.pushed[body].applied.is_empty() && self.touching.coupled.impulses_on(body).next().is_none()
                });
                if nobody_pushes {
                    return Ok(true);
                }
                // The agreement has an error, so the agreed motion must also be free of penetration.
                self.take(islands, step.time);
                self.take_mean_velocities(h);
                if !self.touching.passes(h) {
                    return Ok(true);
                }
            }
            if self.pushed.iter().any(|pushed| islands[pushed.island].outcome.is_err()) {
                return Ok(false);
            }
        }
        Ok(false)
    }

    /// Repeats the substep with exact steps if steps with a budget do not agree with contact; returns whether exact steps agree.
    ///
    /// The residual that a budget leaves would otherwise create energy without limit
    /// (`fingers_that_press_hard_in_real_time_do_not_cross_the_ring`).
    pub(crate) fn repeat_exactly(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
    ) -> Result<bool, Trouble> {
        if !self.touching.has_budget {
            return Ok(false);
        }
        let Meeting { touching, pushed, workspace, .. } = &mut *self;
        for pushed in pushed.iter_mut() {
            let island = &mut islands[pushed.island];
            island.system.exact = true;
            pushed.step_without(island, step, workspace);
        }
        touching.has_budget = false;
        touching.start_without_impulses();
        self.take(islands, step.time);
        let agreed = step.with_obstacles(|touch| self.iterate_with_contact(islands, step, touch));
        self.touching.has_budget = true;
        self.pushed.iter().for_each(|pushed| islands[pushed.island].system.exact = false);
        agreed
    }

    /// The largest distance between the end positions of points and those to which the impulses should take them [m].
    fn missed(&self, islands: &[&mut Island<D>]) -> f64 {
        let mut most: f64 = 0.0;
        for (body, Pushed { island, indices, .. }) in self.pushed.iter().enumerate() {
            let x = &islands[*island].system.state.x;
            most = self.touching.missed_by(body, indices.iter().map(|k| x.at(*k as usize))).larger(most);
        }
        most
    }

    /// Repeats the steps of bodies that do not end where the impulses should take them.
    fn step_again(&mut self, islands: &mut [&mut Island<D>], step: &Substep<'_, D>, enough: f64) -> Again {
        let most = self.missed(islands);
        let as_before = (0..self.pushed.len()).all(|body| {
            self.touching.coupled.impulses_on(body).next().is_some() != self.pushed[body].applied.is_empty()
        });
        if most <= enough && (as_before || enough == f64::INFINITY) {
            return Again::No;
        }
        // All bodies whose impulses have changed, because impulses act in pairs.
        for (body, pushed) in self.pushed.iter_mut().enumerate() {
            let impulses: Vec<_> = self.touching.coupled.impulses_on(body).collect();
            if impulses == pushed.applied {
                continue;
            }
            let island = &mut islands[pushed.island];
            pushed.applied = impulses;
            island.system.pushes = Some(pushed.forces(step.plan.h));
            island.rewind();
            island.step_together(step.plan, step.number, &mut self.workspace);
            pushed.matrix = None;
        }
        let now = self.missed(islands);
        if now > most && now > self.touching.margin {
            self.take_back_pushes(islands, step);
            return Again::Diverges;
        }
        Again::Yes
    }

    /// Repeats the steps of pushed bodies without contact forces.
    fn take_back_pushes(&mut self, islands: &mut [&mut Island<D>], step: &Substep<'_, D>) {
        for pushed in self.pushed.iter_mut().filter(|pushed| !pushed.applied.is_empty()) {
            pushed.step_without(islands[pushed.island], step, &mut self.workspace);
        }
    }

    /// Lets contact change velocities after the steps if steps and contact do not agree. If all bodies of the meeting have implicit integrators, they
    /// keep their last result, which nearly agrees with contact. If bodies with explicit integrators have also responded to the impulses, or if a
    /// step failed, all return to a step without contact forces.
    pub(crate) fn part(&mut self, islands: &mut [&mut Island<D>], step: &Substep<'_, D>) {
        let failed = self.pushed.iter().any(|pushed| islands[pushed.island].outcome.is_err());
        let back = failed || self.pushed.len() < self.bodies.len();
        for (body, pushed) in self.pushed.iter_mut().enumerate() {
            let island = &mut islands[pushed.island];
            if pushed.applied.is_empty() && island.outcome.is_ok() {
                continue;
            }
            if back {
                pushed.step_without(island, step, &mut self.workspace);
            } else {
                let first = self.touching.coupled.points_of(body).start;
                for (point, impulse) in &pushed.applied {
                    let (index, from) = (pushed.indices[*point] as usize, &self.touching.before[0][first + point]);
                    let to = island.system.state.x.at(index);
                    let lost: f64 = (0..D).map(|d| impulse[d] * (from[d] - to[d])).sum();
                    island.system.work.contact[index % WIDTH] += lost / step.plan.h;
                }
            }
            pushed.applied.clear();
        }
        self.touching.part_coupled();
        self.take(islands, step.time);
    }

    /// Sets the velocities of pushed bodies to their mean velocities in the step.
    fn take_mean_velocities(&mut self, h: f64) {
        let Touching { coupled, before: [from, _], after: [x, v], .. } = &mut self.touching;
        for p in (0..coupled.count()).flat_map(|body| coupled.points_of(body)) {
            v[p] = std::array::from_fn(|d| (x[p][d] - from[p][d]) / h);
        }
    }

    /// Ends a substep: applies the remaining impulses, and the displacements that separate overlapping bodies.
    pub(crate) fn end_pushes(&mut self, islands: &mut [&mut Island<D>], h: f64) {
        // Bodies with explicit integrators have responded to the impulses of the last solution. The impulses of the step differ from these by a
        // remainder.
        let mixed = self.pushed.len() < self.bodies.len();
        for (body, pushed) in self.pushed.iter().enumerate() {
            let system = &mut islands[pushed.island].system;
            let first = self.touching.coupled.points_of(body).start;
            let found = self.touching.coupled.impulses_on(body);
            let given = pushed.applied.iter().map(|(point, impulse)| (*point, *impulse, -1.0));
            for (point, impulse, sign) in found.map(|(point, impulse)| (point, impulse, 1.0)).chain(given) {
                let (p, index) = (first + point, pushed.indices[point] as usize);
                // Contact has recorded the work of the impulses of the solution, along the expected motion.
                let mean = if sign > 0.0 { self.touching.velocity_found(p) } else { self.touching.after[1][p] };
                let mut entered = 0.0;
                for d in 0..D {
                    entered += sign * impulse[d] * mean[d];
                    if mixed {
                        let v = &mut system.state.v.0[d][index];
                        let change = sign * impulse[d] * self.touching.inverse_mass[p][d];
                        entered -= sign * impulse[d] * (*v + 0.5 * change);
                        *v += change;
                    }
                }
                system.work.numerical[index % WIDTH] += entered;
            }
            for (p, index) in self.touching.coupled.points_of(body).zip(&pushed.indices) {
                let index = *index as usize;
                let moved = self.touching.moved_of(p);
                if moved == [0.0; D] {
                    continue;
                }
                let push = system.pushes.iter().flatten().find(|(other, _)| *other == index).map_or([0.0; D], |p| p.1);
                for d in (0..D).filter(|d| self.touching.inverse_mass[p][*d] > 0.0) {
                    let change = system.state.v.0[d][index] - self.touching.before[1][p][d];
                    let force = change / (self.touching.inverse_mass[p][d] * h) - push[d];
                    system.work.correction[index % WIDTH] -= force * moved[d];
                    system.state.x.0[d][index] += moved[d];
                    self.touching.after[0][p][d] = system.state.x.0[d][index];
                }
            }
        }
    }
}

/// Subtracts from the motion what pushes have added to it, to first order; returns whether bodies respond.
fn free_motion<const D: usize>(touching: &mut Touching<D>, answers: &mut Answers<'_, '_, D>) -> bool {
    for body in 0..answers.pushed.len() {
        let applied = std::mem::take(&mut answers.pushed[body].applied);
        let answered = applied.is_empty() || answers.displace(body, applied.iter().copied());
        answers.pushed[body].applied = applied;
        if !answered {
            return false;
        }
        if answers.pushed[body].applied.is_empty() {
            continue;
        }
        let Touching { coupled, after: [x, v], .. } = &mut *touching;
        for (p, index) in coupled.points_of(body).zip(&answers.pushed[body].indices) {
            for d in 0..D {
                let added = answers.vector[*index as usize * D + d];
                x[p][d] -= added;
                v[p][d] -= added / answers.h;
            }
        }
    }
    true
}
