//! Bodies that are stepped together, and the stepping of one frame for them alone.

use crate::blueprint::BodyBlueprint;
use crate::ledger::{Stock, Survey, survey, take_stock, total_of};
use crate::path::{Bounds, Path};
use opruga_collide::Colliders;
use opruga_core::error::StepError;
use opruga_core::history::History;
use opruga_core::integrator::Integrator;
use opruga_core::potential::Reading;
use opruga_core::stability::Stability;
use opruga_core::state::{Columns, View};
use opruga_core::system::{Member, System, Work8, Workspace};
use opruga_math::Lane;
use std::sync::Arc;

/// One body, or up to eight bodies of the same kind side by side.
#[derive(Debug)]
pub(crate) struct Island<const D: usize> {
    pub(crate) system: System<D>,
    pub(crate) integrator: Arc<dyn Integrator<D>>,
    /// The estimate of its stable step, once it has been made.
    pub(crate) stability: Option<Stability>,
    /// The bodies, by their index in the world.
    pub(crate) bodies: Vec<usize>,
    pub(crate) stock: Stock,
    pub(crate) survey: Survey<D>,
    /// The distance from the origin along an axis up to which its positions keep their digits [m].
    pub(crate) range: f64,
    pub(crate) work: Work8,
    /// The potential energy at the start of the last frame [J].
    pub(crate) potential_before: f64,
    /// The region that its bodies passed through in the last frame, if it was recorded.
    pub(crate) path: Path<D>,
    /// The result of the last frame.
    pub(crate) outcome: Result<(), StepError>,
    last: Option<Saved<D>>,
    /// The states that were kept within the last frame.
    looks: Vec<Saved<D>>,
    /// The state at the start of a substep that may be repeated.
    pub(crate) substep_start: Option<Saved<D>>,
}

/// The state at the last good frame, or within a frame.
#[derive(Debug)]
pub(crate) struct Saved<const D: usize> {
    x: Columns<D>,
    v: Columns<D>,
    memory: Vec<Vec<f64>>,
    history: History<D>,
    time: f64,
    /// The work and losses since the start of the frame.
    pub(crate) work: Work8,
}

impl<const D: usize> Saved<D> {
    pub(crate) fn of(system: &System<D>, time: f64) -> Self {
        Saved {
            x: system.state.x.clone(),
            v: system.state.v.clone(),
            memory: system.members.iter().map(|m| m.memory.clone()).collect(),
            history: system.history.clone(),
            time,
            work: system.work,
        }
    }

    /// Stores another state in the same memory.
    ///
    /// The columns are swapped, and the system continues with a copy. The stored state is therefore not written to memory a second time.
    pub(crate) fn take(&mut self, system: &mut System<D>, time: f64) {
        std::mem::swap(&mut self.x, &mut system.state.x);
        std::mem::swap(&mut self.v, &mut system.state.v);
        for d in 0..D {
            system.state.x.0[d].copy_from_slice(&self.x.0[d]);
            system.state.v.0[d].copy_from_slice(&self.v.0[d]);
        }
        self.memory.resize(system.members.len(), Vec::new());
        for (kept, member) in self.memory.iter_mut().zip(&system.members) {
            kept.clone_from(&member.memory);
        }
        self.history.copy_from(&system.history);
        (self.time, self.work) = (time, system.work);
    }

    /// Writes the state into a system.
    pub(crate) fn write_into(&self, system: &mut System<D>) {
        for d in 0..D {
            system.state.x.0[d].copy_from_slice(&self.x.0[d]);
            system.state.v.0[d].copy_from_slice(&self.v.0[d]);
        }
        for (member, kept) in system.members.iter_mut().zip(&self.memory) {
            member.memory.clone_from(kept);
        }
        system.history.copy_from(&self.history);
        system.time = self.time;
    }

    /// Swaps the state with the state of a system.
    fn swap(&mut self, system: &mut System<D>) {
        std::mem::swap(&mut self.x, &mut system.state.x);
        std::mem::swap(&mut self.v, &mut system.state.v);
        for (kept, member) in self.memory.iter_mut().zip(&mut system.members) {
            std::mem::swap(kept, &mut member.memory);
        }
        std::mem::swap(&mut self.history, &mut system.history);
        std::mem::swap(&mut self.time, &mut system.time);
    }
}

/// The smallest number of nodes of a body on which threads work together.
const SHARED_FROM: usize = 1000;

/// The data that an island needs to step through a frame.
#[derive(Clone, Copy)]
pub(crate) struct FramePlan<'a, const D: usize> {
    pub(crate) colliders: Option<&'a Arc<Colliders<D>>>,
    pub(crate) start: f64,
    pub(crate) substeps: u32,
    pub(crate) h: f64,
    /// Substeps between two kept states within the frame; 0: none.
    pub(crate) look_every: u32,
    /// Whether islands record the region that their bodies pass through ([`Island::path`]).
    pub(crate) watched: bool,
    /// The bodies of the world, if bodies that rest in a degenerate shape are to be displaced.
    pub(crate) unfold: Option<&'a [BodyBlueprint<D>]>,
}

impl<const D: usize> FramePlan<'_, D> {
    /// The same frame with each substep divided into `parts`, without kept states in between.
    pub(crate) fn in_parts(&self, parts: u32) -> Self {
        FramePlan { substeps: self.substeps * parts, h: self.h / f64::from(parts), look_every: 0, ..*self }
    }
}

impl<const D: usize> Island<D> {
    /// An island of bodies whose positions keep their digits within `range` of the origin [m].
    pub(crate) fn new(system: System<D>, integrator: Arc<dyn Integrator<D>>, bodies: Vec<usize>, range: f64) -> Self {
        let survey = survey(&system);
        let mut island = Island {
            system,
            integrator,
            stability: None,
            bodies,
            stock: Stock::default(),
            survey,
            range,
            work: Work8::default(),
            potential_before: 0.0,
            path: Path::default(),
            outcome: Ok(()),
            last: None,
            looks: Vec::new(),
            substep_start: None,
        };
        island.stock = take_stock(&mut island.system);
        island
    }

    /// Whether this many threads work on this island together. The island must be large, and its integrator must support this. If there are fewer
    /// islands than threads, support by a model is enough, although the threads then share only a part of the work of an explicit step.
    pub(crate) fn is_shared_by(&self, threads: usize, islands: usize) -> bool {
        let models = || self.system.members.iter().any(|member| member.potential.properties().shares_threads);
        let known = || self.integrator.shares_threads() || islands < threads && models();
        threads > 1 && self.system.nodes >= SHARED_FROM && known()
    }

    /// Updates all quantities that depend on the state, after the state was changed from outside.
    pub(crate) fn refresh(&mut self) {
        self.survey = survey(&self.system);
        self.stock = take_stock(&mut self.system);
    }

    /// The potential energy of the present state [J].
    pub(crate) fn potential(&self) -> f64 {
        self.stock.elastic + self.stock.gas + self.survey.gravity
    }

    /// The numerical loss of the integrator since the start of the last frame [J], if the integrator measures it and every model reports the work of
    /// its forces. `work` contains the work and losses since then.
    pub(crate) fn numerical_loss(&self, work: &Work8) -> f64 {
        if !self.integrator.measures_its_damping() || !self.system.has_energy() {
            return 0.0;
        }
        let [entered, gas, correction] =
            [&work.numerical, &work.gas, &work.correction].map(|parts| total_of(&self.system, parts));
        entered + gas + correction + (self.potential_before - self.potential())
    }

    /// The readings of the models of one of the bodies.
    pub(crate) fn readings(&mut self, lane: usize, time: f64) -> Vec<Reading> {
        let mut out = Vec::new();
        self.ask(time, |member, view| {
            out.extend(member.potential.readings(view, &member.scratch, &member.memory, lane));
        });
        out.extend(self.integrator.readings(&self.system));
        out
    }

    /// The pressure of the gas at the nodes of one of the bodies [Pa].
    pub(crate) fn node_pressures(&mut self, lane: usize, time: f64) -> Vec<(u32, f64)> {
        let mut out = Vec::new();
        self.ask(time, |member, view| out.extend(member.potential.node_pressures(view, &member.scratch, lane)));
        out
    }

    /// Prepares every model for the present state and passes it to `question`.
    fn ask(&mut self, time: f64, mut question: impl FnMut(&Member<D>, &View<D>)) {
        let system = &mut self.system;
        let view = View {
            x: system.state.x.slices(),
            v: system.state.v.slices(),
            nodes: system.nodes,
            layout: system.layout,
            time,
            threads: 1,
        };
        for member in &mut system.members {
            if member.potential.prepare(system.simd, &view, &member.memory, &mut member.scratch).is_ok() {
                question(member, &view);
            }
        }
    }

    /// Steps through a frame with a borrowed workspace. On failure the island is at its last good frame, and the error names substep and node.
    pub(crate) fn frame(&mut self, plan: &FramePlan<D>, workspace: &mut Workspace<D>) {
        self.system.exchange(workspace);
        self.outcome = self.step_through(plan);
        self.system.exchange(workspace);
    }

    fn step_through(&mut self, plan: &FramePlan<D>) -> Result<(), StepError> {
        self.save(plan.start);
        self.potential_before = self.potential();
        let swept = self.swept_bounds(plan);
        let may_touch = self.reaches(plan, &swept);
        let mut outcome = self.attempt(plan, may_touch);
        // A body that left the region swept by its velocities, or whose step found no end, might have met an obstacle: repeat the frame and check all
        // obstacles.
        if !may_touch
            && plan.colliders.is_some()
            && outcome.as_ref().map_or(true, |after| left(&swept, &after.position))
        {
            self.restore();
            outcome = self.attempt(plan, true);
        }
        if plan.unfold.is_some() && outcome.is_ok() {
            outcome = self.recover(plan, may_touch);
        }
        match outcome {
            Ok(survey) => {
                self.survey = survey;
                self.system.time = plan.start + f64::from(plan.substeps) * plan.h;
                self.work = std::mem::take(&mut self.system.work);
                self.stock = take_stock(&mut self.system);
                Ok(())
            }
            Err(error) => {
                self.restore();
                let named = match error {
                    StepError::BrokenOff {} => error,
                    error => self.name_culprit(plan).unwrap_or(error),
                };
                self.restore();
                self.system.work = Work8::default();
                Err(named)
            }
        }
    }

    /// Lets a body leave a degenerate shape at the end of a frame; surveys the state again.
    fn recover(&mut self, plan: &FramePlan<D>, meets: bool) -> Result<Survey<D>, StepError> {
        if self.integrator.is_static() {
            let start = self.survey.kinetic + self.potential_before;
            self.unfold_statics(plan, meets, start)?;
        } else if let Some(last) = self.last.take() {
            let outcome = self.unfold(plan, &last.v);
            self.last = Some(last);
            outcome?;
        }
        Ok(survey(&self.system))
    }

    pub(crate) fn attempt(&mut self, plan: &FramePlan<D>, may_touch: bool) -> Result<Survey<D>, StepError> {
        self.system.work = Work8::default();
        self.system.contacts = None;
        if let (true, Some(colliders)) = (may_touch, plan.colliders) {
            self.system.contacts = Some(Arc::clone(colliders).into_contacts());
        }
        self.begin_path(plan);
        for substep in 0..plan.substeps {
            self.system.go_on()?;
            self.set_out(plan, substep);
            self.integrator.step(&mut self.system, plan.h)?;
            self.keep_path(plan);
            let done = substep + 1;
            if plan.look_every > 0 && done.is_multiple_of(plan.look_every) && done < plan.substeps {
                self.keep_look((done / plan.look_every - 1) as usize);
            }
        }
        self.surveyed(plan.start)
    }

    /// Surveys all nodes; refuses values that are not finite or out of range.
    pub(crate) fn surveyed(&self, start: f64) -> Result<Survey<D>, StepError> {
        let survey = survey(&self.system);
        let [low, high] = &survey.position;
        let far = (0..D).any(|d| low[d] < -self.range || high[d] > self.range);
        if survey.finite && !far {
            return Ok(survey);
        }
        let range = survey.finite.then_some(self.range);
        Err(self.culprit(start).unwrap_or(StepError::Diverged { body: 0, node: 0, time: start, range }))
    }

    /// Sets the system to the beginning of a substep.
    pub(crate) fn set_out(&mut self, plan: &FramePlan<D>, substep: u32) {
        self.system.time = plan.start + f64::from(substep) * plan.h;
        self.system.lead_pins(plan.h);
        if substep == 0 {
            self.system.take_hold();
        }
    }

    /// Repeats the frame, checks every substep, and returns the first error.
    fn name_culprit(&mut self, plan: &FramePlan<D>) -> Option<StepError> {
        self.system.contacts = plan.colliders.map(|c| Arc::clone(c).into_contacts());
        for substep in 0..plan.substeps {
            self.set_out(plan, substep);
            let time = self.system.time;
            if let Err(error) = self.integrator.step(&mut self.system, plan.h) {
                return Some(error);
            }
            if let Some(error) = self.culprit(time) {
                return Some(error);
            }
        }
        None
    }

    /// The first node that is not finite or is out of range.
    fn culprit(&self, time: f64) -> Option<StepError> {
        let system = &self.system;
        for node in 0..system.nodes {
            for body in 0..system.bodies {
                let index = system.layout.index(node, body);
                let (x, v) = (system.state.x.at(index), system.state.v.at(index));
                let finite = x.iter().chain(&v).all(|c| c.is_finite());
                if !finite || x.iter().any(|c| c.abs() > self.range) {
                    let range = finite.then_some(self.range);
                    return Some(StepError::Diverged { body, node: node as u32, time, range });
                }
            }
        }
        None
    }

    /// Begins to record the region that bodies pass through in a frame, if that is requested.
    pub(crate) fn begin_path(&mut self, plan: &FramePlan<D>) {
        self.path = Path::default();
        self.keep_path(plan);
    }

    /// Adds the present positions of the bodies.
    pub(crate) fn keep_path(&mut self, plan: &FramePlan<D>) {
        if plan.watched {
            self.path.include(&self.system, &self.system.state.x);
        }
    }

    pub(crate) fn save(&mut self, time: f64) {
        match &mut self.last {
            Some(saved) => saved.take(&mut self.system, time),
            None => self.last = Some(Saved::of(&self.system, time)),
        }
    }

    /// Keeps the state in the middle of a frame.
    pub(crate) fn keep_look(&mut self, number: usize) {
        let time = self.system.time;
        match self.looks.get_mut(number) {
            Some(look) => look.take(&mut self.system, time),
            None => self.looks.push(Saved::of(&self.system, time)),
        }
    }

    /// Swaps the state with a kept one; a second call undoes the swap. Returns the work and losses up to the kept state.
    pub(crate) fn swap_look(&mut self, number: usize) -> Option<Work8> {
        let look = self.looks.get_mut(number)?;
        look.swap(&mut self.system);
        Some(look.work)
    }

    /// Restores a kept state, with the work and losses up to it.
    pub(crate) fn return_to(&mut self, mut kept: Saved<D>) {
        kept.swap(&mut self.system);
        (self.system.time, self.system.work) = (kept.time, kept.work);
    }

    /// Restores the last good frame.
    pub(crate) fn restore(&mut self) {
        if let Some(saved) = &self.last {
            saved.write_into(&mut self.system);
        }
    }

    /// Whether the bodies may meet an obstacle within the frame.
    fn reaches(&self, plan: &FramePlan<D>, swept: &[[f64; D]; 2]) -> bool {
        let Some(colliders) = plan.colliders else { return false };
        self.integrator.is_static()
            || colliders.reach(plan.start, plan.start + f64::from(plan.substeps) * plan.h, &swept[0], &swept[1])
    }

    /// The bounding box swept within the frame: the present one, moved by v·dt + ½g·dt², plus a margin for the deformation of the bodies.
    ///
    /// This box determines whether obstacles are checked, and therefore how implicit steps are solved. For this reason it depends only on positions
    /// and velocities, which snapshots contain: earlier frames of an island must not enlarge it.
    fn swept_bounds(&self, plan: &FramePlan<D>) -> [[f64; D]; 2] {
        self.sweep(plan, self.survey.position, self.survey.velocity)
    }

    /// The box that points sweep if they lie in a box and their velocities are in a range [m/s].
    fn sweep(&self, plan: &FramePlan<D>, [mut low, mut high]: Bounds<D>, [slow, fast]: Bounds<D>) -> Bounds<D> {
        let dt = f64::from(plan.substeps) * plan.h;
        for d in 0..D {
            let fall = 0.5 * self.system.gravity[d] * dt * dt;
            // A body at the turning point of an oscillation is slow but may move far within the frame; a tenth of its size is a generous margin.
            let margin = 0.1 * (high[d] - low[d]) + fall.abs();
            low[d] += (slow[d] * dt).smaller(0.0) - margin;
            high[d] += (fast[d] * dt).larger(0.0) + margin;
        }
        [low, high]
    }

    /// The boxes that its bodies sweep within the frame, lane by lane; [`Island::swept_bounds`] returns the box of all together.
    pub(crate) fn swept_by_bodies(&self, plan: &FramePlan<D>, mut visit: impl FnMut(usize, Bounds<D>)) {
        if self.integrator.is_static() {
            // In statics, a body may move to any position of equilibrium.
            let everywhere = [[f64::NEG_INFINITY; D], [f64::INFINITY; D]];
            (0..self.bodies.len()).for_each(|lane| visit(lane, everywhere));
            return;
        }
        let (mut x, mut v) = (Path::default(), Path::default());
        x.include(&self.system, &self.system.state.x);
        v.include(&self.system, &self.system.state.v);
        let layout = self.system.layout;
        for lane in 0..self.bodies.len() {
            visit(lane, self.sweep(plan, x.of(layout, lane), v.of(layout, lane)));
        }
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let kept: usize = self.last.iter().chain(&self.looks).map(|s| 2 * D * s.x.0[0].heap_bytes()).sum();
        self.system.heap_bytes() + kept
    }
}

/// Whether positions are outside a region.
fn left<const D: usize>(region: &[[f64; D]; 2], position: &[[f64; D]; 2]) -> bool {
    (0..D).any(|d| position[0][d] < region[0][d] || position[1][d] > region[1][d])
}
