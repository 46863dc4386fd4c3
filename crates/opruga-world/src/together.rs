//! A frame of bodies that touch: all islands go through it substep by substep.

use crate::island::{FramePlan, Island};
use crate::meeting::{Meeting, Substep};
use crate::world::lock;
use opruga_collide::Trouble;
use opruga_core::system::Workspace;
use opruga_core::threads::together;
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Steps islands through a frame. Where one fails, its outcome says so, and the others are wherever they were.
///
/// # Errors
/// [`Trouble`] where more pairs may touch than the scene allows, or pins and obstacles lead bodies through one another; with the time [s].
pub(crate) fn frame<const D: usize>(
    islands: &mut [Island<D>],
    meeting: &mut Meeting<D>,
    plan: &FramePlan<'_, D>,
    workspaces: &[Mutex<Workspace<D>>],
    threaded: bool,
) -> Result<(), (Trouble, f64)> {
    let outcome = step_through(islands, meeting, plan, workspaces, threaded);
    meeting.end(islands);
    outcome
}

fn step_through<const D: usize>(
    islands: &mut [Island<D>],
    meeting: &mut Meeting<D>,
    plan: &FramePlan<'_, D>,
    workspaces: &[Mutex<Workspace<D>>],
    threaded: bool,
) -> Result<(), (Trouble, f64)> {
    islands.iter_mut().for_each(|island| island.begin_together(plan));
    let contacts = plan.colliders.map(|colliders| Arc::clone(colliders).into_contacts());
    meeting.begin();
    meeting.take(islands, plan.start);
    for substep in 0..plan.substeps {
        meeting.set_out(islands);
        let time = plan.start + f64::from(substep + 1) * plan.h;
        let step = Substep { plan, number: substep, time, obstacles: contacts.as_deref() };
        meeting.step_with_barrier(islands, &step).map_err(|trouble| (trouble, time))?;
        step_freely(islands, meeting, plan, substep, workspaces, threaded);
        if islands.iter().any(|island| island.outcome.is_err()) {
            return Ok(());
        }
        meeting.take(islands, time);
        // What leaves its range ends the frame, and is refused there: contact would look at every pair of it.
        if !meeting.is_in_range(islands) {
            islands.iter_mut().for_each(|island| island.end_together(plan));
            return Ok(());
        }
        if meeting.barrier.is_none() {
            meeting.resolve(islands, &step, &mut lock(&workspaces[0])).map_err(|trouble| (trouble, time))?;
        }
        if islands.iter().any(|island| island.outcome.is_err()) {
            return Ok(());
        }
        islands.iter_mut().for_each(|island| island.look_together(plan, substep));
    }
    islands.iter_mut().for_each(|island| island.end_together(plan));
    Ok(())
}

/// One substep without contact between bodies, of those that did not make it together.
fn step_freely<const D: usize>(
    islands: &mut [Island<D>],
    meeting: &Meeting<D>,
    plan: &FramePlan<'_, D>,
    substep: u32,
    workspaces: &[Mutex<Workspace<D>>],
    threaded: bool,
) {
    let alone = |(number, _): &(usize, &mut Island<D>)| !meeting.steps_as_one(*number);
    if !threaded {
        let own = islands.iter_mut().enumerate().filter(alone);
        own.for_each(|(_, island)| island.step_together(plan, substep, &mut lock(&workspaces[0])));
        return;
    }
    let (threads, count) = (rayon::current_num_threads(), islands.len());
    let shared = islands.iter_mut().enumerate().filter(alone).map(|(_, island)| island);
    for island in shared.filter(|island| island.is_shared_by(threads, count)) {
        island.system.threads = threads;
        together(threads, || island.step_together(plan, substep, &mut lock(&workspaces[0])));
        island.system.threads = 1;
    }
    let own = islands.par_iter_mut().enumerate().filter(alone).map(|(_, island)| island);
    own.filter(|island| !island.is_shared_by(threads, count)).for_each(|island| {
        let thread = rayon::current_thread_index().unwrap_or(0);
        island.step_together(plan, substep, &mut lock(&workspaces[thread]));
    });
}
