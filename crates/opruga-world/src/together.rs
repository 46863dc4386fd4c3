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
        step_freely(islands, plan, substep, workspaces, threaded);
        if islands.iter().any(|island| island.outcome.is_err()) {
            return Ok(());
        }
        let time = plan.start + f64::from(substep + 1) * plan.h;
        meeting.take(islands, time);
        if !meeting.touching.after.iter().flatten().flatten().all(|c| c.is_finite()) {
            islands.iter_mut().for_each(|island| island.end_together(plan));
            return Ok(());
        }
        let step = Substep { plan, number: substep, time, obstacles: contacts.as_deref() };
        meeting.resolve(islands, &step, &mut lock(&workspaces[0])).map_err(|trouble| (trouble, time))?;
        if islands.iter().any(|island| island.outcome.is_err()) {
            return Ok(());
        }
        islands.iter_mut().for_each(|island| island.look_together(plan, substep));
    }
    islands.iter_mut().for_each(|island| island.end_together(plan));
    Ok(())
}

/// One substep without contact between bodies.
fn step_freely<const D: usize>(
    islands: &mut [Island<D>],
    plan: &FramePlan<'_, D>,
    substep: u32,
    workspaces: &[Mutex<Workspace<D>>],
    threaded: bool,
) {
    if !threaded {
        islands.iter_mut().for_each(|island| island.step_together(plan, substep, &mut lock(&workspaces[0])));
        return;
    }
    let (threads, count) = (rayon::current_num_threads(), islands.len());
    for island in islands.iter_mut().filter(|island| island.is_shared_by(threads, count)) {
        island.system.threads = threads;
        together(threads, || island.step_together(plan, substep, &mut lock(&workspaces[0])));
        island.system.threads = 1;
    }
    islands.par_iter_mut().filter(|island| !island.is_shared_by(threads, count)).for_each(|island| {
        let thread = rayon::current_thread_index().unwrap_or(0);
        island.step_together(plan, substep, &mut lock(&workspaces[thread]));
    });
}
