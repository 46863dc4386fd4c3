//! The effect of pins on nodes that a consistent mass matrix couples to pinned nodes.
//!
//! From the moment at which it is pinned, a node has the velocity of its pin. In a step, the velocity of the pin is the mean
//! velocity w over the step. If the node had another velocity (because a body is caught in flight, or because a table of motion
//! has corners), the pin gives an impulse at the start of the step. The impulse acts only on the pinned node, but consistent
//! masses couple nodes, so its neighbours recoil, as a bat does beyond the grip:
//!
//! M_ff Δv_f + M_fp (w − v_p) = 0.
//!
//! Among all motions with these pins, the new motion is the nearest to the previous one in the norm of M. If the pins are at
//! rest, the new motion never has more energy than the previous one. Within the step pinned nodes do not accelerate, whatever
//! the rule is. At the end of the step they still have the velocity w. Otherwise each rule would treat a jump of velocity
//! within a step differently, and the motion would depend on the rule.
//!
//! With lumped masses no impulse reaches a neighbour, so these computations are not needed.

use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::WIDTH;
use opruga_solve::blocks::{Block, isotropic};
use opruga_solve::{BlockJacobi, Directions, conjugate_gradients};

/// Gives pinned nodes the velocities for the coming step of length `h`, and their neighbours the velocities that follow from
/// the masses. The change of kinetic energy is work of the pins. Afterwards `kick` holds the change of every velocity. It is
/// empty if no velocity has changed. Returns the previous velocities if they have changed.
pub(super) fn take_hold<const D: usize>(system: &mut System<D>, kick: &mut Vec<f64>, h: f64) -> Option<Columns<D>> {
    kick.clear();
    if system.inertia.is_none() || system.pins.is_empty() {
        return None;
    }
    let pinned = pinned_coordinates(system);
    let mut jumps = vec![0.0; pinned.len()];
    let mut any = false;
    for pin in &system.pins {
        let (target, _) = pin.target(system.time + h);
        for d in (0..D).filter(|d| pin.axes[*d]) {
            let (x, v) = (system.state.x.0[d][pin.index], system.state.v.0[d][pin.index]);
            let jump = (target[d] - x) / h - v;
            jumps[pin.index * D + d] = jump;
            any |= jump != 0.0;
        }
    }
    if !any {
        return None;
    }
    let before = (system.state.v.clone(), system.kinetic_energy());
    accelerations(system, &pinned, &vec![0.0; jumps.len()], &mut jumps);
    for node in 0..system.nodes {
        let v = system.state.v.at(node);
        system.state.v.set(node, core::array::from_fn(|d| v[d] + jumps[node * D + d]));
    }
    system.work.user[0] += system.kinetic_energy() - before.1;
    *kick = jumps;
    Some(before.0)
}

/// Records the work that pins do within a step against the inertia of the neighbours of their nodes, w · M_pf Δv_f.
pub(super) fn enter_work<const D: usize>(system: &mut System<D>, v0: &[f64], v1: &[f64]) {
    let Some(inertia) = system.inertia.as_ref().filter(|_| !system.pins.is_empty()) else { return };
    let change: Vec<f64> = v0.iter().zip(v1).map(|(before, after)| after - before).collect();
    let mut work = [0.0; WIDTH];
    system.pinned_axes(&mut |node, d| {
        let velocity = v0[node * D + d];
        if velocity != 0.0 {
            work[node % WIDTH] += velocity * inertia.product::<D>(node, &change)[d];
        }
    });
    for (user, work) in system.work.user.iter_mut().zip(work) {
        *user += work;
    }
}

/// Which coordinates are pinned.
pub(crate) fn pinned_coordinates<const D: usize>(system: &System<D>) -> Vec<bool> {
    let mut pinned = vec![false; system.nodes * D];
    system.pinned_axes(&mut |node, d| pinned[node * D + d] = true);
    pinned
}

/// Computes the accelerations of the free coordinates from the forces on them and from the accelerations of the pinned
/// coordinates: M_ff a_f = F_f − M_fp a_p. At the start, `a` holds the accelerations of the pinned coordinates; at the end, it
/// holds all accelerations. Changes of velocity by impulses follow from the same equation.
pub fn accelerations<const D: usize>(system: &System<D>, pinned: &[bool], force: &[f64], a: &mut [f64]) {
    let Some(inertia) = &system.inertia else {
        for (k, a) in a.iter_mut().enumerate().filter(|(k, _)| !pinned[*k]) {
            *a = force[k] * system.inverse_mass.at(k / D);
        }
        return;
    };
    a.iter_mut().zip(pinned).filter(|(_, pinned)| !**pinned).for_each(|(a, _)| *a = 0.0);
    let given = a.to_vec();
    let mut right = vec![0.0; pinned.len()];
    for node in 0..system.nodes {
        let coupled = inertia.product::<D>(node, &given);
        for d in (0..D).filter(|d| !pinned[node * D + d]) {
            right[node * D + d] = force[node * D + d] - coupled[d];
        }
    }
    // Pinned coordinates stay zero: their rows are those of the unit matrix.
    let multiply = |x: &[f64], y: &mut [f64]| {
        for node in 0..system.nodes {
            let (mass, coupled) = (system.mass.at(node), inertia.product::<D>(node, x));
            for d in 0..D {
                let k = node * D + d;
                y[k] = if pinned[k] { x[k] } else { mass * x[k] + coupled[d] };
            }
        }
    };
    let blocks: Vec<Block<D>> = (0..system.nodes).map(|node| isotropic(system.mass.at(node))).collect();
    let mut lumped = BlockJacobi::default();
    let mut out = vec![0.0; pinned.len()];
    // The mass matrix is as well conditioned as the mass matrix of a single cell. So the solution has all digits after some
    // tens of products.
    let solved = lumped.update(blocks.iter()).and_then(|()| {
        let mut workspace = Directions::default();
        conjugate_gradients(multiply, &lumped, &right, &mut out, 1e-14, 1000, &mut workspace)
    });
    if solved.is_ok() {
        for k in (0..out.len()).filter(|k| !pinned[*k]) {
            a[k] = out[k];
        }
    } else {
        // If the matrix is not a valid mass matrix, each node is accelerated by its own force alone.
        for k in (0..out.len()).filter(|k| !pinned[*k]) {
            a[k] = force[k] * system.inverse_mass.at(k / D);
        }
    }
}
