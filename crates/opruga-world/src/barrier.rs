//! One substep of all bodies that have implicit integrators and that a barrier keeps apart.
//!
//! Each body begins its step, [`Search`] finds the common end, and each body ends its step with the forces of the others. In statics the end of a
//! step is the common equilibrium.

use crate::barrier_search::{Kept, Opened, Refused, Search, scaled};
use crate::island::Island;
use crate::meeting::{Meeting, Substep};
use crate::pair_stiffness::PairStiffness;
use crate::refusals::Refusal;
use crate::staying::Staying;
use opruga_collide::{Touching, Trouble};
use opruga_core::error::StepError;
use opruga_core::system::{Stage, System, Workspace};
use opruga_math::WIDTH;
use opruga_solve::Directions;

impl<const D: usize> Meeting<D> {
    /// Makes a substep of all bodies that the barrier keeps apart. If one of them fails, its outcome contains the error.
    pub(crate) fn step_with_barrier(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
    ) -> Result<(), Trouble> {
        let Some(mut kept) = self.barrier.take() else { return Ok(()) };
        let outcome = self.search_with_barrier(islands, step, &mut kept);
        self.barrier = Some(kept);
        match outcome {
            Ok(()) => Ok(()),
            Err(Refused::Trouble(trouble)) => Err(trouble),
            Err(Refused::Step(error)) => {
                for pushed in &self.pushed {
                    islands[pushed.island].refuse(error.clone());
                }
                Ok(())
            }
        }
    }

    fn search_with_barrier(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
        kept: &mut Kept<D>,
    ) -> Result<(), Refused> {
        kept.workspaces.resize_with(self.pushed.len(), Workspace::default);
        for (pushed, workspace) in self.pushed.iter().zip(&mut kept.workspaces) {
            islands[pushed.island].system.exchange(workspace);
            islands[pushed.island].begin_as_one(step.plan, step.number);
        }
        let outcome = self.advance_as_one(islands, step, kept, (step.plan.h, step.time), 0);
        for (pushed, workspace) in self.pushed.iter().zip(&mut kept.workspaces) {
            islands[pushed.island].system.exchange(workspace);
        }
        outcome
    }

    /// Whether the steps of all bodies have a budget of iterations.
    fn have_budget(&self, islands: &[&mut Island<D>]) -> bool {
        let has = |island: &Island<D>| island.integrator.has_budget() && !island.system.exact;
        self.pushed.iter().all(|pushed| has(islands[pushed.island]))
    }

    /// Makes a step of length h that ends at a given time [s]. If the search fails, repeats steps in real time with exact steps. If the scene allows it,
    /// makes two steps of half the length instead of a step that does not converge.
    fn advance_as_one(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
        kept: &mut Kept<D>,
        (h, time): (f64, f64),
        halvings: u32,
    ) -> Result<(), Refused> {
        let multipliers = kept.multipliers.clone();
        kept.most_halvings = 0;
        let outcome = self.find_common_end(islands, kept, (h, time), step.plan.h);
        let failed = matches!(&outcome, Err(Refused::Step(error)) if *error != StepError::BrokenOff {});
        let has_budget = self.have_budget(islands);
        if !failed || !has_budget && halvings >= kept.most_halvings {
            return outcome;
        }
        kept.multipliers = multipliers;
        self.pushed.iter().for_each(|pushed| islands[pushed.island].rewind());
        if has_budget {
            // A budget may be too small for obstacles that press hard (`plates_that_press_hard_in_long_steps_arrive_under_a_barrier`).
            self.pushed.iter().for_each(|pushed| islands[pushed.island].system.exact = true);
            let outcome = self.advance_as_one(islands, step, kept, (h, time), halvings);
            self.pushed.iter().for_each(|pushed| islands[pushed.island].system.exact = false);
            return outcome;
        }
        for pushed in &self.pushed {
            let solver = &mut islands[pushed.island].system.work.solver;
            solver.halved += 1;
            solver.deepest = solver.deepest.max(u64::from(halvings) + 1);
        }
        self.advance_as_one(islands, step, kept, (0.5 * h, time - 0.5 * h), halvings + 1)?;
        self.pushed.iter().for_each(|pushed| islands[pushed.island].keep_path(step.plan));
        self.set_out(islands);
        self.advance_as_one(islands, step, kept, (0.5 * h, time), halvings + 1)
    }

    /// Makes a step of length h that ends at a given time [s]. The step may be a part of the substep, which is `whole` [s] long.
    fn find_common_end(
        &mut self,
        islands: &mut [&mut Island<D>],
        kept: &mut Kept<D>,
        (h, time): (f64, f64),
        whole: f64,
    ) -> Result<(), Refused> {
        let staying = self.at_rest.then(|| Staying::new(self.pushed.iter().map(|pushed| &*islands[pushed.island])));
        let points = self.touching.inverse_mass.len();
        let (mut opened, mut coordinates, mut first) = (Vec::new(), vec![None; points], 0);
        for (body, pushed) in self.pushed.iter().enumerate() {
            let island = &mut islands[pushed.island];
            island.system.pushes = Some(Vec::new());
            // Bodies with explicit integrators are refused before the run.
            let Some(begun) = island.integrator.open(&mut island.system, h) else { continue };
            for (p, index) in self.touching.coupled.points_of(body).zip(&pushed.indices) {
                coordinates[p] = Some((opened.len(), first + *index as usize * D));
            }
            opened.push(Opened { island: pushed.island, first, step: begun? });
            first += island.system.nodes * D;
        }
        let has_budget = self.have_budget(islands);
        kept.most_halvings = opened.iter().map(|open: &Opened<D>| open.step.most_halvings()).min().unwrap_or(0);
        let mut x = self.touching.before[0].clone();
        self.touching.surface.follow(&mut x);
        self.move_outlines(time);
        let ahead = (0..points).map(|p| match self.touching.surface.is_of_obstacle(p as u32) {
            false => [0.0; D],
            true => std::array::from_fn(|d| self.touching.after[0][p][d] - x[p][d]),
        });
        let mut search = Search {
            ahead: ahead.collect(),
            islands,
            touching: &mut self.touching,
            barrier: &mut kept.barrier,
            opened,
            coordinates,
            moved: vec![[0.0; D]; points],
            trial: x.clone(),
            x,
            pressed: Vec::new(),
            rubbing: Vec::new(),
            stiffness: PairStiffness::default(),
            directions: Directions::default(),
            length: first,
            iterations: 0,
            has_budget,
            converged: true,
            stretch: 1.0,
            by_obstacles: 0.0,
            unprescribed: 0.0,
            sticking: 1.0,
            staying,
        };
        search.find_softness()?;
        search.find_end(h, std::mem::take(&mut kept.multipliers))?;
        kept.multipliers = search.multipliers();
        search.close(whole)?;
        Ok(())
    }
}

impl<const D: usize> Search<'_, '_, D> {
    /// Ends the steps of all bodies. Reports the forces that the bodies exert on one another as the impulses of a whole substep of h [s].
    fn close(self, h: f64) -> Result<(), Refused> {
        let (iterations, converged, moves) = (self.iterations, self.converged, self.staying.is_none());
        let Search { islands, touching, barrier, opened, coordinates, moved, x, pressed, rubbing, .. } = self;
        let mut forces = vec![[0.0; D]; x.len()];
        let mut losses = vec![[0.0; 2]; x.len()];
        let surface = &touching.surface;
        let mut enter = |points: &[u32; 4], weights: &[f64; 4], force: &[f64; D], account: usize| {
            for (p, w) in points.iter().zip(weights) {
                surface.visit_nodes(*p, |node, share| {
                    let node = node as usize;
                    for d in 0..D {
                        forces[node][d] += w * share * force[d];
                        losses[node][account] -= w * share * force[d] * moved[node][d];
                    }
                });
            }
        };
        for pair in &pressed {
            enter(&pair.points, &pair.weights, &scaled(&pair.normal, pair.force), 0);
            for (k, fading) in pair.fading.iter().enumerate() {
                let mut one = [0.0; 4];
                one[k] = 1.0;
                enter(&pair.points, &one, &scaled(fading, -1.0), 0);
            }
        }
        for rub in &rubbing {
            enter(&rub.points, &rub.weights, &rub.force(&rub.slip(&moved)), 1);
        }
        // The work that moving obstacles do on the bodies, against the barrier and by friction.
        let mut by_obstacles = [0.0; 2];
        for p in (0..x.len()).filter(|p| surface.is_of_obstacle(*p as u32)) {
            (0..2).for_each(|account| by_obstacles[account] += losses[p][account]);
        }
        if let Some(Opened { island, .. }) = opened.first().filter(|_| moves) {
            let work = &mut islands[*island].system.work;
            work.user[0] += by_obstacles[0] + by_obstacles[1];
            work.contact[0] += by_obstacles[0];
            work.friction[0] += by_obstacles[1];
        }
        touching.after[0].copy_from_slice(&x);
        touching.take_pressed(h, &pressed, &rubbing, &moved);
        for (body, Opened { island, first, step }) in opened.into_iter().enumerate() {
            let system = &mut islands[island].system;
            let mut pushes = Vec::new();
            for (p, of_point) in coordinates.iter().enumerate() {
                let Some((of, at)) = *of_point else { continue };
                if of != body || forces[p] == [0.0; D] {
                    continue;
                }
                let node = (at - first) / D;
                pushes.push((node, forces[p]));
                // In statics all work counts as work of the user who moves the bodies.
                if moves {
                    system.work.contact[node % WIDTH] += losses[p][0];
                    system.work.friction[node % WIDTH] += losses[p][1];
                }
            }
            pushes.sort_by_key(|(node, _)| *node);
            system.pushes = Some(pushes);
            step.close(system, iterations, converged)?;
            refuse_inverted_cells(system)?;
            // After the search, obstacles move nodes to their surface; bodies must not pass through one another in this move
            // either.
            for (p, of_point) in coordinates.iter().enumerate() {
                if let Some((_, at)) = of_point.filter(|(of, _)| *of == body) {
                    touching.after[0][p] = system.state.x.at((at - first) / D);
                }
            }
        }
        touching.surface.follow(&mut touching.after[0]);
        let Touching { surface, laws, most, after: [end, _], .. } = &*touching;
        barrier.look(surface, laws, [&x, end], *most)?;
        if barrier.free_part(surface, laws, [&x, end]) < 1.0 {
            return Err(StepError::of("contact", Refusal::Pushed {}).into());
        }
        Ok(())
    }
}

/// Refuses a body with inverted cells: a barrier cannot keep it apart from anything.
fn refuse_inverted_cells<const D: usize>(system: &System<D>) -> Result<(), StepError> {
    let view = system.view(Stage::Current, system.time);
    for member in &system.members {
        let cells = member.potential.cell_states(&view, 0);
        if let Some(cell) =
            cells.iter().find(|cell| cell.smallest_volume_ratio <= 0.0 || cell.smallest_volume_ratio.is_nan())
        {
            let (cell, ratio) = (cell.cell, cell.smallest_volume_ratio);
            return Err(StepError::of(member.potential.properties().name, Refusal::InvertedByBarrier { cell, ratio }));
        }
    }
    Ok(())
}
