//! Which nodes obstacles hold within a step, and whether they stick or slip.
//!
//! ```text
//!         n ▲   f = λ n + t     active:   the node ends on the surface, λ ≥ 0
//!           │  ╱                stick:    |t| ≤ µ λ, it goes where the surface goes
//!     ──────●──────             slip:     t = µ λ s, s against its motion along the surface
//! ```
//!
//! Every Newton iteration decides whether a node is held, from the gap after the last correction and the force of the
//! constraint. A contact that changes too often slips, or is released, for the rest of the step. In any case the force stays
//! within Coulomb's cone, and no node may be inside an obstacle at the end.

use super::contact_query::ContactQuery;
use super::friction::{Followed, SlipRule, against_slide, projected};
use super::mixing::Mixing;
use opruga_core::contacts::Touch;
use opruga_math::Lane;
use opruga_solve::blocks::{Block, isotropic, nodes};

/// The nodes that obstacles hold.
#[derive(Debug, Default)]
pub(crate) struct Contacting<const D: usize> {
    pub(crate) contacts: Vec<Contact<D>>,
    /// The contacts before the last search.
    known: Vec<Contact<D>>,
    /// Buffer for the surfaces that one node touches.
    found: Vec<Touch<D>>,
    /// Buffers for the normal forces that determine friction, and for their changes.
    forces: [Vec<f64>; 3],
    /// Whether contacts, and directions of friction, no longer change in this step.
    pub(crate) is_settled: bool,
}

/// One node on one surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact<const D: usize> {
    pub(crate) node: usize,
    pub(super) touch: Touch<D>,
    pub(super) hold: Hold,
    /// The force along the normal in the last iteration [N].
    pub(super) normal_force: f64,
    /// The direction of the friction force, and how much this direction turned in the last iteration.
    pub(super) push: [f64; D],
    pub(super) turn: f64,
    /// How often the contact changed between held and released, or between stick and slip.
    changes: u8,
}

/// The changes that follow from the forces of the constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Verdict {
    /// Whether the set of held nodes must change, or the way in which a node is held.
    pub(crate) anew: bool,
    /// Whether the friction force or its direction changes.
    pub(crate) unsettled: bool,
}

/// How a node is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hold {
    /// The node is not held, because the surface would have to pull.
    Released,
    /// The node may move along the surface, against friction.
    Slip,
    /// The node moves with the surface.
    Stick,
}

/// After this many changes a contact slips or is released for good.
const MOST_CHANGES: u8 = 4;

/// Depths and slides below this fraction of the extent of a body count as zero.
pub(crate) const SMALL: f64 = 1e-9;

/// The least part of a direction that other held directions must leave free, so that it counts as a direction of its own.
const INDEPENDENT: f64 = 1e-6;

/// Whether pins alone determine the motion of a node along a normal. An obstacle then neither moves the node nor bears a force.
pub(super) fn pins_decide<const D: usize>(pin_displacement: &[f64], normal: &[f64; D]) -> bool {
    let free = |d: usize| if pin_displacement[d].is_nan() { normal[d] * normal[d] } else { 0.0 };
    (0..D).map(free).sum::<f64>() < INDEPENDENT * INDEPENDENT
}

pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for d in 0..D {
        sum += a[d] * b[d];
    }
    sum
}

impl<const D: usize> Contact<D> {
    pub(super) fn is_active(&self) -> bool {
        self.hold != Hold::Released
    }
    /// Whether the contact slips against friction.
    pub(super) fn rubs(&self) -> bool {
        self.hold == Hold::Slip && self.touch.friction > 0.0
    }
    /// The displacement along the surface in the stage, relative to the displacement of the surface.
    pub(super) fn slide(&self, u: &[f64], theta: f64, x0: &[f64]) -> [f64; D] {
        let (at, carried) = (self.node * D, &self.touch.carried);
        self.along(&core::array::from_fn(|d| u[at + d] - theta * (carried[d] - x0[at + d])))
    }
    /// The component of a vector along the surface.
    pub(super) fn along(&self, vector: &[f64; D]) -> [f64; D] {
        let normal = dot(vector, &self.touch.normal);
        core::array::from_fn(|d| vector[d] - normal * self.touch.normal[d])
    }
}

impl<const D: usize> Contacting<D> {
    /// Discards the contacts of an earlier step, and reserves memory for one per node.
    pub(crate) fn clear(&mut self, nodes: usize) {
        self.is_settled = false;
        for contacts in [&mut self.contacts, &mut self.known] {
            contacts.clear();
            contacts.reserve(nodes);
        }
        self.found.reserve(D);
        for forces in &mut self.forces {
            forces.clear();
            forces.reserve(nodes);
        }
    }
    /// Whether friction may change the direction of sliding nodes.
    pub(crate) fn any_turns(&self) -> bool {
        D > 2 && self.contacts.iter().any(Contact::rubs)
    }
    /// Whether any node is held.
    pub(crate) fn any(&self) -> bool {
        self.contacts.iter().any(Contact::is_active)
    }

    /// The directions in which nodes are held, or would be held by friction.
    pub(crate) fn directions(&self) -> Vec<(usize, [f64; D])> {
        let mut out = Vec::new();
        for contact in self.contacts.iter().filter(|contact| contact.is_active()) {
            out.push((contact.node, contact.touch.normal));
            for d in 0..if contact.touch.friction > 0.0 { D } else { 0 } {
                let mut axis = [0.0; D];
                axis[d] = 1.0;
                out.push((contact.node, axis));
            }
        }
        out
    }
    /// Whether some nodes are held, all of them by surfaces that do not move.
    pub(crate) fn any_at_rest(&self) -> bool {
        let rests = |contact: &Contact<D>| contact.touch.velocity.iter().all(|speed| *speed == 0.0);
        self.any() && self.contacts.iter().filter(|contact| contact.is_active()).all(rests)
    }

    /// Finds the contacts of nodes that move from x₀ to x₀ + u/θ. Nodes that end inside an obstacle are held from now on.
    /// Depths below a billionth of the extent do not count. Nodes that hit a surface with friction are first assumed to stick,
    /// or to slide if `impacts_slide` is set.
    pub(crate) fn look(&mut self, contact_query: &ContactQuery<'_, D>, impacts_slide: bool) -> bool {
        let ContactQuery { system, x0, u, pin_displacement, theta, h, extent } = *contact_query;
        let Some(obstacles) = &system.contacts else {
            self.contacts.clear();
            return false;
        };
        let (time, small) = (system.time + h, SMALL * extent);
        let mut changed = false;
        core::mem::swap(&mut self.known, &mut self.contacts);
        self.contacts.clear();
        let known = &self.known;
        let mut next = 0;
        for (node, (from, u)) in nodes::<D>(x0).iter().zip(nodes::<D>(u)).enumerate() {
            let to: [f64; D] = core::array::from_fn(|d| from[d] + u[d] / theta);
            if !to.iter().all(|x| x.is_finite()) {
                continue;
            }
            let first = next;
            while next < known.len() && known[next].node == node {
                next += 1;
            }
            let old = &known[first..next];
            // During the iteration a held node may be off a curved surface by more than rounding.
            let reach = if old.is_empty() { small } else { 0.1 * extent };
            self.found.clear();
            let found = &mut self.found;
            let pins = &pin_displacement[node * D..(node + 1) * D];
            obstacles.touch(from, &to, time, h, reach, &mut |touch| {
                if !pins_decide(pins, &touch.normal) {
                    found.push(touch);
                }
            });
            // If a fast node crossed a surface, its first contact comes from the crossing. From then on, the contact is found
            // where the node is near the surface.
            for contact in old {
                let beside: [f64; D] = core::array::from_fn(|d| to[d] + reach * contact.touch.normal[d]);
                obstacles.touch(&beside, &to, time, h, reach, &mut |touch| {
                    if touch.surface != contact.touch.surface {
                        return;
                    }
                    let Touch { gap_before, carried, .. } = contact.touch;
                    match found.iter_mut().find(|met| met.surface == touch.surface) {
                        Some(met) => *met = Touch { gap_before, carried, ..touch },
                        None => found.push(Touch { gap_before, carried, ..touch }),
                    }
                });
            }
            for touch in &self.found {
                let depth = small + touch.rounding;
                match old.iter().find(|contact| contact.touch.surface == touch.surface) {
                    Some(contact) => {
                        let mut contact = Contact { touch: *touch, ..*contact };
                        if !contact.is_active() && touch.gap < -depth && contact.changes < MOST_CHANGES {
                            contact.hold = if touch.friction > 0.0 { Hold::Stick } else { Hold::Slip };
                            contact.changes += 1;
                            changed = true;
                        }
                        self.contacts.push(contact);
                    }
                    // A node that rests on the surface is held until it turns out that it need not be.
                    None if touch.gap <= touch.rounding => {
                        changed = true;
                        let mut contact = Contact {
                            node,
                            touch: *touch,
                            hold: if touch.friction > 0.0 { Hold::Stick } else { Hold::Slip },
                            normal_force: 0.0,
                            push: [0.0; D],
                            turn: 1.0,
                            changes: 0,
                        };
                        // A node that slides on the surface is first assumed to keep sliding.
                        let slide = contact.along(&core::array::from_fn(|d| to[d] - touch.carried[d]));
                        let size = dot(&slide, &slide).sqrt();
                        let rests = touch.gap_before <= touch.rounding;
                        if touch.friction > 0.0 && (impacts_slide || rests) && size > 100.0 * small {
                            contact.hold = Hold::Slip;
                            contact.push = slide.map(|s| -s / size);
                        }
                        self.contacts.push(contact);
                    }
                    None => {}
                }
            }
            // A contact that is not found again is released but remembered: a node whose path just grazes a surface may come back
            // to it.
            for contact in old.iter().filter(|old| !self.found.iter().any(|t| t.surface == old.touch.surface)) {
                let lost = u8::from(contact.is_active());
                changed |= contact.is_active();
                let changes = contact.changes.saturating_add(lost);
                self.contacts.push(Contact { hold: Hold::Released, normal_force: 0.0, changes, ..*contact });
            }
        }
        changed
    }

    /// Removes the held directions from the free directions, and writes how far pinned nodes have to move in the stage.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn hold(
        &self,
        u: &[f64],
        theta: f64,
        pin_displacement: &[f64],
        x0: &[f64],
        free: &mut [bool],
        projectors: &mut [Block<D>],
        prescribed: &mut [f64],
    ) -> f64 {
        let mut farthest: f64 = 0.0;
        let mut next = 0;
        for node in 0..free.len() {
            let first = next;
            while next < self.contacts.len() && self.contacts[next].node == node {
                next += 1;
            }
            let at = node * D;
            let pinned = pin_displacement[at..at + D].iter().any(|x| !x.is_nan());
            prescribed[at..at + D].fill(0.0);
            free[node] = true;
            if first == next && !pinned {
                continue;
            }
            // The held directions, orthonormal, and the displacement along each.
            let mut basis = [[0.0; D]; D];
            let mut rank = 0;
            let mut displacement = [0.0; D];
            let mut require = |direction: &[f64; D], distance: f64, displacement: &mut [f64; D]| {
                let mut rest = *direction;
                for known in &basis[..rank] {
                    let along = dot(direction, known);
                    for d in 0..D {
                        rest[d] -= along * known[d];
                    }
                }
                let size = dot(&rest, &rest).sqrt();
                // A direction is not added if it is already held, or nearly so.
                if rank == D || size < INDEPENDENT {
                    return;
                }
                let missing = (distance - dot(direction, displacement)) / size;
                for d in 0..D {
                    rest[d] /= size;
                    displacement[d] += missing * rest[d];
                }
                basis[rank] = rest;
                rank += 1;
            };
            for d in 0..D {
                if !pin_displacement[at + d].is_nan() {
                    let mut axis = [0.0; D];
                    axis[d] = 1.0;
                    require(&axis, pin_displacement[at + d] - u[at + d], &mut displacement);
                }
            }
            let contacts = &self.contacts[first..next];
            for contact in contacts.iter().filter(|contact| contact.is_active()) {
                require(&contact.touch.normal, -theta * contact.touch.gap, &mut displacement);
            }
            for contact in contacts.iter().filter(|contact| contact.hold == Hold::Stick) {
                // The position to which the surface would carry the node.
                let carried = &contact.touch.carried;
                let slide: [f64; D] = core::array::from_fn(|d| theta * (carried[d] - x0[at + d]) - u[at + d]);
                for d in 0..D {
                    let mut axis = [0.0; D];
                    axis[d] = 1.0;
                    let axis = contact.along(&axis);
                    require(&axis, dot(&axis, &slide), &mut displacement);
                }
            }
            if rank == 0 {
                continue;
            }
            free[node] = false;
            let mut projector = isotropic::<D>(1.0);
            for known in &basis[..rank] {
                for i in 0..D {
                    for j in 0..D {
                        projector[i][j] -= known[i] * known[j];
                    }
                }
            }
            projectors[node] = projector;
            for d in 0..D {
                prescribed[at + d] = displacement[d];
                farthest = if displacement[d].abs() > farthest { displacement[d].abs() } else { farthest };
            }
        }
        farthest
    }

    /// Subtracts the friction forces of slipping nodes from the residual.
    pub(crate) fn subtract_friction(&self, residual: &mut [f64]) {
        for contact in self.contacts.iter().filter(|contact| contact.hold == Hold::Slip) {
            let strength = contact.touch.friction * contact.normal_force;
            for d in 0..D {
                residual[contact.node * D + d] -= strength * contact.push[d];
            }
        }
    }

    /// Decides the state of contacts from the forces of the constraints (`reaction`, per node) and from the displacements after
    /// the correction. Returns the changes. The `stiffness` of a node [N/m] determines how far friction alone would move the
    /// node.
    pub(crate) fn judge(
        &mut self,
        reaction: &[f64],
        contact_query: &ContactQuery<'_, D>,
        rule: SlipRule,
        stiffness: &dyn Fn(usize) -> f64,
    ) -> Verdict {
        let moves = |node: usize| match rule {
            SlipRule::AgainstSlide { tolerance } => tolerance * contact_query.extent * stiffness(node),
            SlipRule::Projected => 0.0,
        };
        let ContactQuery { x0, u, theta, extent, .. } = *contact_query;
        let small = SMALL * extent;
        let mut verdict = Verdict::default();
        for contacts in self.contacts.chunk_by_mut(|a, b| a.node == b.node) {
            let node = contacts[0].node;
            let force = nodes::<D>(reaction)[node];
            let normal_forces = split(contacts, &force);
            for (k, contact) in contacts.iter_mut().enumerate().filter(|(_, c)| c.is_active()) {
                let normal_force = normal_forces[k.min(D - 1)];
                if normal_force < 0.0 {
                    contact.hold = Hold::Released;
                    contact.normal_force = 0.0;
                    contact.changes = contact.changes.saturating_add(1);
                    verdict.anew = true;
                    continue;
                }
                if contact.touch.friction == 0.0 {
                    contact.normal_force = normal_force;
                    continue;
                }
                let most = contact.touch.friction * normal_force;
                match contact.hold {
                    Hold::Stick => {
                        let pull = contact.along(&force);
                        let size = dot(&pull, &pull).sqrt();
                        if size > most * (1.0 + 1e-12) {
                            contact.hold = Hold::Slip;
                            contact.push = pull.map(|p| p / size);
                            contact.changes = contact.changes.saturating_add(1);
                            verdict.anew = true;
                        }
                    }
                    _ => {
                        let slide = contact.slide(u, theta, x0);
                        let followed = match rule {
                            SlipRule::AgainstSlide { .. } => against_slide(&slide, &contact.push, small),
                            SlipRule::Projected => {
                                let before = contact.touch.friction * contact.normal_force;
                                let before = contact.along(&contact.push.map(|p| before * p));
                                projected(&slide, &before, stiffness(node), most)
                            }
                        };
                        match followed {
                            Followed::Sticks if contact.changes < MOST_CHANGES => {
                                contact.hold = Hold::Stick;
                                contact.changes += 1;
                                verdict.anew = true;
                            }
                            Followed::Pushes(push) => {
                                let turn: f64 = (0..D).map(|d| (push[d] - contact.push[d]).abs()).sum();
                                verdict.unsettled |= turn * most > moves(node);
                                (contact.push, contact.turn) = (push, turn);
                            }
                            Followed::Sticks | Followed::Rests => {}
                        }
                        let change = (normal_force - contact.normal_force).abs();
                        verdict.unsettled |= contact.touch.friction * change > moves(node);
                    }
                }
                contact.normal_force = normal_force;
            }
        }
        verdict
    }

    /// Adapts friction to the present forces of the constraints, and writes its change to `right`. Returns whether friction has
    /// changed by more than the fraction `tolerance`.
    pub(crate) fn follow(&mut self, reaction: &[f64], mixing: &mut Mixing, tolerance: f64, right: &mut [f64]) -> bool {
        let Contacting { contacts: all, forces: [state, change, plain], .. } = self;
        state.clear();
        change.clear();
        let (mut most, mut worst) = (0.0f64, 0.0f64);
        for contacts in all.chunk_by(|a, b| a.node == b.node).filter(|c| c.iter().any(Contact::rubs)) {
            let at = contacts[0].node * D;
            let normal_forces = split(contacts, &core::array::from_fn(|d| reaction[at + d]));
            for (k, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.rubs()) {
                // A surface does not pull.
                let normal_force = normal_forces[k.min(D - 1)].larger(0.0);
                most = normal_force.larger(contact.normal_force).larger(most);
                worst = (normal_force - contact.normal_force).abs().larger(worst);
                state.push(contact.normal_force);
                change.push(normal_force - contact.normal_force);
            }
        }
        if worst <= tolerance * most {
            return false;
        }
        mixing.note(state, change);
        plain.clear();
        plain.extend_from_slice(change);
        mixing.mix(change);
        // If friction and the normal force amplify each other, mixing may give values without meaning.
        if !state.iter().zip(&*change).all(|(force, change)| (force + change).abs() <= 4.0 * most) {
            change.copy_from_slice(plain);
        }
        right.fill(0.0);
        for (contact, change) in all.iter_mut().filter(|contact| contact.rubs()).zip(&*change) {
            let before = contact.normal_force;
            contact.normal_force = (before + change).larger(0.0);
            let strength = contact.touch.friction * (contact.normal_force - before);
            for d in 0..D {
                right[contact.node * D + d] += strength * contact.push[d];
            }
        }
        true
    }
}

/// Splits the normal part of a force on one node into forces along the normals of its held contacts.
pub(super) fn split<const D: usize>(contacts: &[Contact<D>], force: &[f64; D]) -> [f64; D] {
    let mut out = [0.0; D];
    let is_active = |k: &usize| contacts[*k].is_active();
    let mut all = (0..contacts.len().min(D)).filter(is_active);
    if let (Some(only), None) = (all.next(), all.next()) {
        out[only] = dot(force, &contacts[only].touch.normal);
        return out;
    }
    let active: Vec<usize> = (0..contacts.len().min(D)).filter(is_active).collect();
    let n = active.len();
    let normal = |k: usize| &contacts[active[k]].touch.normal;
    let gram: Vec<f64> = (0..n * n).map(|k| dot(normal(k / n), normal(k % n))).collect();
    if let Some(inverse) = opruga_solve::dense::inverse(&gram, n) {
        for i in 0..n {
            out[active[i]] = (0..n).map(|j| inverse[i * n + j] * dot(force, normal(j))).sum();
        }
    }
    out
}
