//! Limits on corrections towards obstacles if there is no inertia.

use super::balance::Balance;
use super::contact::{Contact, Contacting, pins_decide};
use super::contact_query::ContactQuery;
use super::workspace::Workspace;
use opruga_core::contacts::Touch;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::blocks::nodes;

/// The longest correction of a node in statics, as a fraction of the extent of the body.
const LONGEST: f64 = 0.5;

/// The depth up to which nodes are caught, as a fraction of the extent of the body. If whole rows of nodes behind a surface
/// were all moved onto it, the resulting shape would be unusable.
const CAUGHT: f64 = 1e-3;

/// The number of bisections of the fraction of a step. With this number, half the extent is resolved more finely than `CAUGHT`.
const BISECTIONS: usize = 12;

/// The largest number of moves that lift a body as a whole out of obstacles, from surface to surface.
const MOST_LIFTS: u32 = 32;

/// The largest depth of a node in equilibrium, as a fraction of the extent of the body.
const LEFT: f64 = 1e-6;

/// If a body without pins begins deep in obstacles, moves the whole body out of them in `workspace.u`, before the iteration.
/// Moving deep nodes onto the surface one by one would tear the body.
pub(crate) fn lift_out<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>, h: f64) {
    if system.contacts.is_none() || workspace.pin_displacement.iter().any(|displacement| !displacement.is_nan()) {
        return;
    }
    let mut lift = [0.0; D];
    for count in 0..MOST_LIFTS {
        let deep = if count == 0 { CAUGHT * workspace.extent } else { 0.0 };
        let Some(touch) = deepest(system, workspace, &|_, d| lift[d], h).filter(|touch| touch.gap < -deep) else {
            for u in workspace.u.as_chunks_mut::<D>().0 {
                *u = lift;
            }
            return;
        };
        for d in 0..D {
            lift[d] -= touch.gap * touch.normal[d];
        }
    }
    // The obstacles leave no space for the body, so it begins at its present position.
}

/// Whether the displacement in `workspace.u` leaves a node inside an obstacle because its contact changed too often. Only nodes
/// that nothing else holds are considered.
pub(crate) fn leaves_nodes_inside<const D: usize>(system: &System<D>, workspace: &Workspace<D>, h: f64) -> bool {
    let most = LEFT * workspace.extent;
    deepest(system, workspace, &|node, d| workspace.u[node * D + d], h).is_some_and(|touch| touch.gap < -most)
}

/// The contact of the node that is deepest inside an obstacle, among nodes without pins. Returns `None` if all of these nodes
/// are outside. `displacement` is a function of node and axis.
fn deepest<const D: usize>(
    system: &System<D>,
    workspace: &Workspace<D>,
    displacement: &dyn Fn(usize, usize) -> f64,
    h: f64,
) -> Option<Touch<D>> {
    let obstacles = system.contacts.as_ref()?;
    let mut deepest: Option<Touch<D>> = None;
    for (node, (from, targets)) in
        nodes::<D>(&workspace.x0).iter().zip(nodes::<D>(&workspace.pin_displacement)).enumerate()
    {
        if targets.iter().any(|displacement| !displacement.is_nan()) {
            continue;
        }
        let at: [f64; D] = core::array::from_fn(|d| from[d] + displacement(node, d));
        obstacles.touch(&at, &at, system.time + h, h, 0.0, &mut |touch| {
            if touch.gap < -touch.rounding && deepest.is_none_or(|other| touch.gap < other.gap) {
                deepest = Some(touch);
            }
        });
    }
    deepest
}

/// The largest fraction of the step in `workspace.step` that may be applied in statics. The largest displacement of the step is
/// `longest`. The limited step is not longer than the body and does not lead through obstacles.
pub(super) fn part_without_inertia<const D: usize>(
    system: &System<D>,
    workspace: &Workspace<D>,
    balance: &Balance,
    longest: f64,
) -> f64 {
    let part = (LONGEST * workspace.extent / longest).smaller(1.0);
    if system.contacts.is_none() {
        return part;
    }
    let step: Vec<f64> = workspace.step.iter().map(|s| part * s).collect();
    let state = [&workspace.x0[..], &workspace.u, &workspace.pin_displacement];
    let contact_query = ContactQuery::new(system, balance, state, workspace.extent);
    part * workspace.contacting.part_to_obstacles(&contact_query, &step)
}

impl<const D: usize> Contacting<D> {
    /// The fraction of a step at which the first free node enters an obstacle, or 1 if no node enters one.
    fn part_to_obstacles(&self, contact_query: &ContactQuery<'_, D>, step: &[f64]) -> f64 {
        if !self.comes_in(contact_query, step, 1.0) {
            return 1.0;
        }
        let (mut allowed, mut refused) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (allowed + refused);
            if self.comes_in(contact_query, step, middle) {
                refused = middle;
            } else {
                allowed = middle;
            }
        }
        allowed
    }

    /// Whether a fraction of a step moves a free node deeper into an obstacle.
    fn comes_in(&self, contact_query: &ContactQuery<'_, D>, step: &[f64], part: f64) -> bool {
        let ContactQuery { system, x0, u, pin_displacement, theta, h, extent } = *contact_query;
        let Some(obstacles) = &system.contacts else { return false };
        let time = system.time + h;
        let caught = CAUGHT * extent;
        let displacements = nodes::<D>(u).iter().zip(nodes::<D>(step));
        nodes::<D>(x0).iter().zip(displacements).enumerate().any(|(node, (from, (u, step)))| {
            let at = |part: f64| -> [f64; D] { core::array::from_fn(|d| from[d] + (u[d] + part * step[d]) / theta) };
            let mut deep = None;
            obstacles.touch(from, &at(part), time, h, 0.0, &mut |touch| {
                let is_active = |c: &Contact<D>| c.node == node && c.touch.surface == touch.surface && c.is_active();
                let pinned = pins_decide(&pin_displacement[node * D..(node + 1) * D], &touch.normal);
                if touch.gap < -caught && !pinned && !self.contacts.iter().any(is_active) {
                    deep = Some(touch);
                }
            });
            let Some(deep) = deep else { return false };
            let mut before = 0.0;
            obstacles.touch(from, &at(0.0), time, h, 0.0, &mut |touch| {
                if touch.surface == deep.surface && touch.gap < before {
                    before = touch.gap;
                }
            });
            deep.gap < before - caught
        })
    }
}
