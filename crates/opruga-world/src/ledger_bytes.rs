//! Writes the flows of the ledger to the bytes of a snapshot, and reads them back.

use crate::bytes::{Reader, Writer};
use crate::error::WorldError;
use crate::ledger::Flows;
use opruga_core::system::SolverWork;

impl Flows {
    /// Writes all its numbers.
    pub(crate) fn write(&self, out: &mut Writer<'_>) {
        let mut flows = *self;
        let (sums, counts, estimates) = in_order(&mut flows);
        sums.into_iter().for_each(|x| out.number(*x));
        counts.into_iter().for_each(|n| out.count(*n));
        estimates.into_iter().for_each(|x| out.number(*x));
    }

    /// Reads what [`Flows::write`] wrote.
    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Flows, WorldError> {
        let mut flows = Flows::default();
        let (sums, counts, estimates) = in_order(&mut flows);
        for x in sums {
            *x = reader.number()?;
        }
        for n in counts {
            *n = reader.count()?;
        }
        for x in estimates {
            *x = reader.number()?;
        }
        Ok(flows)
    }
}

/// All numbers in the order of their bytes: energies, counts, and what solvers report.
fn in_order(flows: &mut Flows) -> ([&mut f64; 10], [&mut u64; 17], [&mut f64; 4]) {
    let Flows {
        user,
        gas,
        damping,
        friction,
        contact,
        correction,
        numerical,
        start,
        changed,
        largest,
        limited_forces,
        limited_velocities,
        limited_pulls,
        lost_bodies,
        open_frames,
        damped_frames,
        solver:
            SolverWork {
                steps,
                iterations,
                linear_iterations,
                accepted,
                halved,
                deepest,
                cut_off,
                disturbed,
                stayed_degenerate,
                estimated,
                conditioned,
                residual,
                left,
                error_estimate,
                conditioning,
            },
    } = flows;
    (
        [user, gas, damping, friction, contact, correction, numerical, start, changed, largest],
        [
            limited_forces,
            limited_velocities,
            limited_pulls,
            lost_bodies,
            open_frames,
            damped_frames,
            steps,
            iterations,
            linear_iterations,
            accepted,
            halved,
            deepest,
            cut_off,
            disturbed,
            stayed_degenerate,
            estimated,
            conditioned,
        ],
        [residual, left, error_estimate, conditioning],
    )
}
