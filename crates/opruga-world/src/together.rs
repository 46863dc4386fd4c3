//! Steps bodies that may touch through a frame. Their clusters advance substep by substep. All other bodies are stepped as if they were alone.

use crate::blueprint::Blueprint;
use crate::clusters::{Clusters, Group, Progress};
use crate::contact_memory::ContactMemory;
use crate::island::{FramePlan, Island};
use crate::meeting::{Meeting, Substep};
use crate::world::lock;
use opruga_collide::Trouble;
use opruga_core::system::Workspace;
use opruga_core::threads;
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// The smallest number of nodes of a group that uses more than one thread within a substep.
const SHARED_FROM: usize = 1000;

/// A group that is being stepped through the frame.
struct Job<'a, const D: usize> {
    islands: Vec<&'a mut Island<D>>,
    group: &'a mut Group<D>,
}

/// The available threads and workspaces.
#[derive(Clone, Copy)]
struct Hands<'a, const D: usize> {
    /// The state of contact of the last frame.
    memory: &'a ContactMemory<D>,
    workspaces: &'a [Mutex<Workspace<D>>],
    /// Whether this runs in the thread pool of the world.
    pooled: bool,
    /// Whether several threads may work on a substep.
    threaded: bool,
    /// All islands of the world.
    islands: usize,
}

/// Steps islands through a frame. If one fails, its outcome contains the error, and the others remain in their present state.
///
/// If bodies of different groups come close to one another, both groups return to the start of the frame and are stepped through it together.
///
/// # Errors
/// [`Trouble`] and its time [s], if the number of pairs that may touch exceeds the limit of the scene, or if pins and obstacles move bodies through
/// one another.
pub(crate) fn frame<const D: usize>(
    clusters: &mut Clusters<D>,
    (blueprint, memory, reported): (&Blueprint<D>, &ContactMemory<D>, bool),
    islands: &mut [Island<D>],
    plan: &FramePlan<'_, D>,
    workspaces: &[Mutex<Workspace<D>>],
    pooled: bool,
) -> Result<(), (Trouble, f64)> {
    let hands = Hands { memory, workspaces, pooled, threaded: pooled, islands: islands.len() };
    clusters.begin(blueprint, islands, plan);
    clusters.report(reported);
    go_through(clusters, islands, plan, hands);
    while clusters.merge(blueprint, islands, plan) {
        for island in
            clusters.groups.iter().filter(|group| group.progress == Progress::Waiting).flat_map(|g| &g.islands)
        {
            islands[*island].restore();
            islands[*island].refresh();
        }
        clusters.report(reported);
        go_through(clusters, islands, plan, hands);
    }
    let stuck = clusters.groups.iter().filter_map(|group| match group.progress {
        Progress::Stuck(trouble, time) => Some((trouble, time)),
        _ => None,
    });
    // The error that is first in time; if several are equal, the first in the order of the bodies.
    stuck.reduce(|first, other| if other.1 < first.1 { other } else { first }).map_or(Ok(()), Err)
}

/// Steps all waiting groups through the frame.
fn go_through<const D: usize>(
    clusters: &mut Clusters<D>,
    islands: &mut [Island<D>],
    plan: &FramePlan<'_, D>,
    hands: Hands<'_, D>,
) {
    let mut at_hand: Vec<Option<&mut Island<D>>> = islands.iter_mut().map(Some).collect();
    let mut jobs: Vec<Job<'_, D>> = Vec::new();
    for group in clusters.groups.iter_mut().filter(|group| group.progress == Progress::Waiting) {
        let islands = group.islands.iter().filter_map(|island| at_hand[*island].take()).collect();
        jobs.push(Job { islands, group });
    }
    if !hands.threaded {
        jobs.iter_mut().for_each(|job| job.run(plan, hands));
        return;
    }
    // Groups with large bodies are stepped one after another, each large body on all threads; then the others in parallel. A body that waits for its
    // threads must not be given another body that uses the same workspace.
    let number = rayon::current_num_threads();
    let is_shared = |job: &Job<'_, D>| job.islands.iter().any(|island| island.is_shared_by(number, hands.islands));
    jobs.iter_mut().filter(|job| is_shared(job)).for_each(|job| job.run(plan, hands));
    jobs.par_iter_mut().filter(|job| !is_shared(job)).for_each(|job| job.run(plan, hands));
}

impl<const D: usize> Job<'_, D> {
    fn run(&mut self, plan: &FramePlan<'_, D>, hands: Hands<'_, D>) {
        if self.group.meetings.is_empty() {
            self.islands
                .iter_mut()
                .for_each(|island| hands.lend(island, |island, workspace| island.frame(plan, workspace)));
            self.group.progress = Progress::Done;
            return;
        }
        let outcome = self.step_through(plan, hands);
        self.group.meetings.iter_mut().for_each(|meeting| meeting.end(&mut self.islands));
        self.group.progress = outcome.err().map_or(Progress::Done, |(trouble, time)| Progress::Stuck(trouble, time));
    }

    fn step_through(&mut self, plan: &FramePlan<'_, D>, hands: Hands<'_, D>) -> Result<(), (Trouble, f64)> {
        let nodes: usize = self.islands.iter().map(|island| island.system.nodes * island.system.bodies).sum();
        let hands = Hands { threaded: hands.threaded && nodes >= SHARED_FROM, ..hands };
        let Job { islands, group: Group { meetings, .. } } = self;
        let failed = |islands: &[&mut Island<D>]| islands.iter().any(|island| island.outcome.is_err());
        islands.iter_mut().for_each(|island| island.begin_together(plan));
        let contacts = plan.colliders.map(|colliders| Arc::clone(colliders).into_contacts());
        for meeting in meetings.iter_mut() {
            if let Some(contacts) = &meeting.without_faces {
                let own = meeting.pushed.iter();
                own.for_each(|pushed| islands[pushed.island].system.contacts = Some(Arc::clone(contacts)));
            }
            meeting.begin(islands);
            meeting.recall(hands.memory, islands, plan.h);
            meeting.take(islands, plan.start);
        }
        for substep in 0..plan.substeps {
            let time = plan.start + f64::from(substep + 1) * plan.h;
            let step = Substep { plan, number: substep, time, obstacles: contacts.as_deref() };
            for meeting in meetings.iter_mut() {
                meeting.set_out(islands);
                let stepped = if meeting.barrier.is_some() {
                    meeting.step_with_barrier(islands, &step)
                } else if meeting.at_rest {
                    meeting.come_to_balance(islands, &step)
                } else {
                    Ok(())
                };
                stepped.map_err(|trouble| (meeting.in_scene(trouble), time))?;
                if meeting.is_one() {
                    meeting.pushed.iter().for_each(|pushed| islands[pushed.island].keep_path(plan));
                }
            }
            hands.step_freely(islands, meetings, plan, substep);
            if failed(islands) {
                return Ok(());
            }
            for meeting in meetings.iter_mut() {
                meeting.take(islands, time);
            }
            // A body that leaves its range ends the frame and is refused, because contact would have to examine every pair that
            // contains it.
            if !islands.iter().all(|island| island.is_in_range()) {
                break;
            }
            touch(islands, meetings, &step, hands.threads())?;
            if failed(islands) {
                return Ok(());
            }
            islands.iter_mut().for_each(|island| island.look_together(plan, substep));
        }
        islands.iter_mut().for_each(|island| island.end_together(plan));
        Ok(())
    }
}

/// Solves the contact of the bodies of every cluster after a substep that each made independently.
fn touch<const D: usize>(
    islands: &mut [&mut Island<D>],
    meetings: &mut [Meeting<D>],
    step: &Substep<'_, D>,
    threads: usize,
) -> Result<(), (Trouble, f64)> {
    let solve = |meeting: &mut Meeting<D>| {
        let alone = !meeting.is_one() && !meeting.is_pushed();
        let outcome = if alone { meeting.solve(step) } else { Ok(()) };
        outcome.map_err(|trouble| (meeting.in_scene(trouble), step.time))
    };
    // Several clusters share the threads; a single one looks for its pairs on all of them.
    let several = meetings.len() > 1;
    meetings.iter_mut().for_each(|meeting| meeting.touching.threads = if several { 1 } else { threads });
    if several && threads > 1 {
        let outcomes: Vec<_> = meetings.par_iter_mut().map(solve).collect();
        outcomes.into_iter().collect::<Result<(), _>>()?;
    } else {
        meetings.iter_mut().try_for_each(solve)?;
    }
    for meeting in meetings.iter_mut().filter(|meeting| !meeting.is_one()) {
        if meeting.is_pushed() {
            let outcome = meeting.solve_in_turn(islands, step);
            outcome.map_err(|trouble| (meeting.in_scene(trouble), step.time))?;
        } else {
            meeting.write_back(islands);
        }
    }
    Ok(())
}

impl<const D: usize> Hands<'_, D> {
    fn threads(&self) -> usize {
        if self.threaded { rayon::current_num_threads() } else { 1 }
    }

    /// Runs work on an island in the workspace of the thread. All threads work together on a large island.
    fn lend(&self, island: &mut Island<D>, work: impl Fn(&mut Island<D>, &mut Workspace<D>) + Sync) {
        let thread = if self.pooled { rayon::current_thread_index().unwrap_or(0) } else { 0 };
        let number = self.threads();
        if !island.is_shared_by(number, self.islands) {
            return work(island, &mut lock(&self.workspaces[thread]));
        }
        island.system.threads = number;
        threads::together(number, || work(island, &mut lock(&self.workspaces[thread])));
        island.system.threads = 1;
    }

    /// One substep without contact between bodies, for bodies that did not make it jointly.
    fn step_freely(
        &self,
        islands: &mut [&mut Island<D>],
        meetings: &[Meeting<D>],
        plan: &FramePlan<'_, D>,
        substep: u32,
    ) {
        let any_is_one = meetings.iter().any(Meeting::is_one);
        let alone = |number: usize| !any_is_one || !meetings.iter().any(|meeting| meeting.steps_as_one(number));
        let step = |island: &mut Island<D>| {
            self.lend(island, |island, workspace| island.step_together(plan, substep, workspace));
            island.keep_path(plan);
        };
        let number = self.threads();
        let shared = |island: &Island<D>| island.is_shared_by(number, self.islands);
        let one_by_one = |island: &Island<D>| !self.threaded || shared(island);
        for (number, island) in islands.iter_mut().enumerate() {
            if one_by_one(island) && alone(number) {
                step(island);
            }
        }
        if self.threaded {
            let own = islands.par_iter_mut().enumerate().filter(|(number, island)| !shared(island) && alone(*number));
            own.for_each(|(_, island)| step(island));
        }
    }
}
