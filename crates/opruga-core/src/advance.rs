//! One sweep over a system: forces of a tile, then the integrator on the tiles that are complete, then obstacles.

use crate::contacts::Moved;
use crate::error::StepError;
use crate::potential::Account;
use crate::state::{Layout, Parameter};
use crate::system::{Stage, State, System, Update, view};
use crate::tile::{Tile, Weight};
use core::ops::Range;
use opruga_math::{Pack, Strip, StripMut, WIDTH, Work};

impl<const D: usize> System<D> {
    /// Evaluates forces in one stage and moves every node by an update: gradient → update → collide, tile by tile.
    ///
    /// `weight` [s] is the part of the step that this evaluation represents when power is integrated to work. If the update
    /// ends the substep, `step` is the length of the substep [s], and obstacles act on the nodes.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub fn advance<U: Update<D>>(
        &mut self,
        evaluate: Stage,
        time: f64,
        weight: f64,
        step: Option<f64>,
        update: &U,
    ) -> Result<(), StepError> {
        let now = self.time + time;
        self.ensure_workspace();
        self.prepare(evaluate, now)?;
        if self.stages > 0 && evaluate == Stage::Current {
            self.step_work = Default::default();
        }
        let pinned = !self.pins.is_empty();
        if pinned && step.is_some() {
            self.take_pinned_motion(0..self.index_count());
        }
        let hindered = self.contacts.is_some() || self.stabilisers.largest_velocity.is_some();
        // If there are several stages, no single force has moved the nodes. Obstacles then use the mean force.
        let several = step.is_some() && evaluate != Stage::Current && self.contacts.is_some();
        let mut contact_lanes = 0;
        for tile in 0..self.plan.len() {
            self.add_forces(evaluate, now, weight, tile);
            for k in 0..self.plan.released_after(tile).len() {
                let done = self.plan.released_after(tile)[k] as usize;
                if several {
                    for d in 0..D {
                        let range = self.plan.range(done);
                        self.velocity_before[d][..range.len()].copy_from_slice(&self.state.v.0[d][range]);
                    }
                }
                if step.is_some() {
                    self.keep_positions(done);
                }
                self.update_tile(done, update);
                if let Some(h) = step.filter(|_| hindered) {
                    if several {
                        self.take_mean_force(done, h);
                    }
                    contact_lanes |= self.collide(done, h);
                }
            }
        }
        if let Some(h) = step
            && contact_lanes != 0
            && several
        {
            // If bodies are side by side, every lane belongs to one body. Otherwise all lanes belong to the same body.
            let lanes = if self.layout == Layout::Batch { contact_lanes } else { u8::MAX };
            let [damping, user] = self.step_work;
            damping.count_by_start(h, lanes, &mut self.work.damping);
            user.count_by_start(h, lanes, &mut self.work.user);
        }
        if pinned {
            self.hold_pins(update.writes(), self.time + update.time());
            if step.is_some() {
                self.give_pinned_motion(0..self.index_count());
            }
        }
        Ok(())
    }

    /// Calls `prepare` of every model.
    pub(crate) fn prepare(&mut self, stage: Stage, time: f64) -> Result<(), StepError> {
        let view = view(&self.state, self.nodes, self.layout, stage, time, self.threads);
        for member in &mut self.members {
            member.potential.prepare(self.simd, &view, &member.memory, &mut member.scratch)?;
        }
        Ok(())
    }

    /// Adds up the forces of all models on the nodes of one tile.
    #[inline]
    pub(crate) fn add_forces(&mut self, stage: Stage, time: f64, weight: f64, tile: usize) {
        let view = view(&self.state, self.nodes, self.layout, stage, time, self.threads);
        let range = self.plan.range(tile);
        let buffer = self.plan.buffer(tile);
        let mut force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
        let mut power = [0.0; WIDTH];
        let mut tile = Tile {
            range: range.clone(),
            force: force.each_mut().map(|f| &mut **f),
            power: &mut power,
            weight: Some(Weight { mass: self.weighing.as_ref().unwrap_or(&self.mass), gravity: self.gravity }),
            slots: &mut self.slots,
        };
        if !self.members.first().is_some_and(|m| m.begins_tiles) {
            tile.settle(self.simd);
        }
        for member in &self.members {
            member.potential.add_force(self.simd, &view, &member.scratch, &mut tile);
            if let Some(account) = member.flows {
                let [of_damping, of_user] = &mut self.step_work;
                let (account, step_work) = match account {
                    Account::User => (&mut self.work.user, of_user),
                    _ => (&mut self.work.damping, of_damping),
                };
                if self.stages > 0 {
                    step_work.note(tile.power, weight, stage == Stage::Current);
                }
                for l in 0..WIDTH {
                    account[l] += weight * tile.power[l];
                    tile.power[l] = 0.0;
                }
            }
        }
        // A pin balances the forces of the models, not yet limited by the stabiliser.
        let force_on = |d: usize, index: usize| force[d][index - range.start];
        self.pinned_nodes.add_work_against(&range, weight, force_on, view.v, &mut self.work.user);
        if let Some(limit) = self.stabilisers.largest_force {
            let is_node = |k: usize| is_node(self.layout, self.nodes, self.bodies, range.start + k);
            self.work.limited_forces += limit_lengths(&mut force, range.len(), limit, is_node);
        }
    }

    /// Stores the positions of the nodes of a tile, because obstacles use the paths from these positions.
    #[inline]
    fn keep_positions(&mut self, tile: usize) {
        if self.contacts.is_some() {
            let range = self.plan.range(tile);
            for d in 0..D {
                self.before[d][..range.len()].copy_from_slice(&self.state.x.0[d][range.clone()]);
            }
        }
    }

    /// Lets the integrator move the nodes of a tile.
    #[inline]
    fn update_tile<U: Update<D>>(&mut self, tile: usize, update: &U) {
        let range = self.plan.range(tile);
        let buffer = self.plan.buffer(tile);
        let force = self.forces.each_ref().map(|f| &f[buffer..buffer + range.len() + WIDTH]);
        self.simd.run(Move { update, range, force, inverse_mass: &self.inverse_mass, state: &mut self.state });
    }

    /// Replaces the force of the last stage by m Δv/h, the mean force over the step of length `h` [s], which obstacles use.
    fn take_mean_force(&mut self, tile: usize, h: f64) {
        let range = self.plan.range(tile);
        let buffer = self.plan.buffer(tile);
        let force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
        let before = self.velocity_before.each_ref().map(|column| &**column);
        self.simd.run(MeanForce { range, force, before, mass: &self.mass, after: self.state.v.slices(), h });
    }

    /// Applies obstacles to the nodes of a tile; returns the lanes in which they acted, one bit each.
    #[inline]
    fn collide(&mut self, tile: usize, h: f64) -> u8 {
        let range = self.plan.range(tile);
        self.limit_velocities_of(range.clone());
        if self.contacts.is_none() {
            return 0;
        }
        // If an obstacle changes the motion of a pinned node, the pin restores this motion.
        self.give_pinned_motion(range.clone());
        let contact_lanes = self.resolve_contacts(tile, h);
        self.take_pinned_motion(range);
        contact_lanes
    }

    /// Limits the velocities of all nodes.
    pub(crate) fn limit_velocities(&mut self) {
        self.limit_velocities_of(0..self.index_count());
    }

    #[inline]
    fn limit_velocities_of(&mut self, range: Range<usize>) {
        if let Some(limit) = self.stabilisers.largest_velocity {
            let mut columns = self.state.v.0.each_mut().map(|c| &mut c[range.clone()]);
            let is_node = |k: usize| is_node(self.layout, self.nodes, self.bodies, range.start + k);
            self.work.limited_velocities += limit_lengths(&mut columns, range.len(), limit, is_node);
        }
    }

    fn resolve_contacts(&mut self, tile: usize, h: f64) -> u8 {
        let Some(contacts) = &self.contacts else { return 0 };
        let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
        contacts.resolve(
            self.simd,
            &mut Moved {
                range: range.clone(),
                padding_start: self.nodes * self.layout.stride(),
                before: self.before.each_ref().map(|b| &**b),
                x: &mut self.state.x,
                v: &mut self.state.v,
                force: self.forces.each_ref().map(|f| &f[buffer..buffer + range.len() + WIDTH]),
                mass: &self.mass,
                layout: self.layout,
                time: self.time + h,
                h,
                loss_contact: &mut self.work.contact,
                loss_friction: &mut self.work.friction,
                work_colliders: &mut self.work.user,
                work_correction: &mut self.work.correction,
            },
        )
    }
}

/// Passes a tile to the integrator.
struct Move<'a, U, const D: usize> {
    update: &'a U,
    range: Range<usize>,
    force: [&'a [f64]; D],
    inverse_mass: &'a Parameter,
    state: &'a mut State<D>,
}
impl<U: Update<D>, const D: usize> Work for Move<'_, U, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        self.update.tile::<P>(self.range, &self.force, self.inverse_mass, self.state);
    }
}

/// Computes the mean force of a step from the velocities before and after it.
struct MeanForce<'a, const D: usize> {
    range: Range<usize>,
    force: [&'a mut [f64]; D],
    before: [&'a [f64]; D],
    after: [&'a [f64]; D],
    mass: &'a Parameter,
    h: f64,
}
impl<const D: usize> Work for MeanForce<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (start, length) = (self.range.start, self.range.len());
        let (before, after) = (Strip::<D>::new(&self.before, 0, length), Strip::<D>::new(&self.after, start, length));
        let mass = self.mass.strip(start, length);
        let mut force = StripMut::<D>::new(self.force, 0, length);
        let rate = P::splat(1.0 / self.h);
        for k in (0..length).step_by(WIDTH) {
            let factor = mass.load::<P>(k) * rate;
            for d in 0..D {
                force.store(d, k, (after.load::<P>(d, k) - before.load::<P>(d, k)) * factor);
            }
        }
    }
}

/// Whether an index holds a node of a body. All other indices only fill up packs.
fn is_node(layout: Layout, nodes: usize, bodies: usize, index: usize) -> bool {
    match layout {
        Layout::Single => index < nodes,
        Layout::Batch => index % WIDTH < bodies && index / WIDTH < nodes,
    }
}

/// Shortens vectors longer than a limit; returns how many of them belong to nodes.
fn limit_lengths<const D: usize>(
    columns: &mut [&mut [f64]; D],
    count: usize,
    limit: f64,
    is_node: impl Fn(usize) -> bool,
) -> u64 {
    let mut acted = 0;
    for k in 0..count {
        let mut square = 0.0;
        for column in columns.iter() {
            square += column[k] * column[k];
        }
        if square > limit * limit {
            let factor = limit / square.sqrt();
            for column in columns.iter_mut() {
                column[k] *= factor;
            }
            acted += u64::from(is_node(k));
        }
    }
    acted
}
