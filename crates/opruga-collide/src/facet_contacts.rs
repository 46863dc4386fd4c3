//! The contact of nodes with obstacles of many facets. Nodes are processed one after the other, and a tree finds the facets.

use crate::active_nodes::{ActiveNodes, Meets};
use crate::collider::Law;
use crate::facets::Facets;
use crate::motion::{Carry, Pose};
use crate::response::{Face, Meeting, Surface, largest_rounding, meets, respond, rounding};
use crate::shape::{entry, is_on_edge, support};
use crate::vector::{dot, subtract};
use opruga_core::contacts::Moved;
use opruga_math::{Lane, WIDTH, lanes};

/// Facets in their positions at the end of the step.
pub(crate) struct Placed<'a, const D: usize> {
    pub(crate) facets: &'a Facets<D>,
    pub(crate) pose: &'a Pose<D>,
    pub(crate) margin: f64,
}

impl<const D: usize> Surface<f64, D> for Placed<'_, D> {
    fn find(&self, x: &[f64; D], before: &[f64; D], reach: f64) -> (f64, [f64; D]) {
        let (x, before) = (self.pose.inverse_transform(x), self.pose.inverse_transform(before));
        let (gap, normal) = self.facets.touch(&x, &before, self.margin, reach);
        (gap, self.pose.direct(&normal))
    }
}

/// Applies facets to the nodes of a tile, one node at a time; returns whether they touched any.
pub(crate) fn hold_back_by_facets<const D: usize>(
    surface: &Placed<D>,
    law: &Law,
    carry: &Carry<D>,
    moved: &mut Moved<D>,
    active: &mut ActiveNodes,
    used: usize,
    asked: Meets,
) -> bool {
    let lies = asked == Meets::WhatItLiesOn;
    if lies && !surface.facets.solid {
        return false;
    }
    let mut touched = false;
    for k in 0..used {
        let index = moved.range.start + k;
        let start: [f64; D] = lanes!(f64, d => moved.before[d][k]);
        let before: [f64; D] = carry.along(&start);
        let from = surface.pose.inverse_transform(&before);
        let force = lanes!(f64, d => moved.force[d][k]);
        let mass = moved.mass.at(index);
        let (lane, bit) = (index % WIDTH, 1u8 << (k % WIDTH));
        let is_active = |active: &ActiveNodes| active.0.get(k / WIDTH).is_some_and(|bits| bits & bit != 0);
        // One facet of a thin surface may push a node through another facet, which then also pushes the node.
        let mut through = false;
        for _ in 0..if surface.facets.solid { 1 } else { PUSHES } {
            let (x, v) = (moved.x.at(index), moved.v.at(index));
            let to = surface.pose.inverse_transform(&x);
            let finite = dot(&from, &from).is_finite() && dot(&to, &to).is_finite() && dot(&v, &v).is_finite();
            if !finite || !surface.facets.passes_bounds(&from, &to, surface.margin + largest_rounding(law)) {
                break;
            }
            let (mut gap, mut normal) = if lies {
                match support(surface.facets, surface.margin, rounding(law, &before), [&from, &to], is_active(active)) {
                    Some((gap, normal)) => (gap, surface.pose.direct(&normal)),
                    None => break,
                }
            } else {
                surface.find(&x, &before, largest_rounding(law))
            };
            if gap == f64::INFINITY {
                break;
            }
            let obstacle = surface.pose.velocity_at(&x);
            // As for other solids: if another contact keeps a node on the surface, the node may pass edges. A node exactly at
            // the junction of two solids that no contact keeps on the surface counts as inside both of them.
            if surface.facets.solid && !lies && gap.abs() <= surface.facets.grain().larger(rounding(law, &x)) {
                if !is_active(active) {
                    if let Some((behind, face)) = entry(surface.facets, surface.margin, &from, &to) {
                        (gap, normal) = (behind, surface.pose.direct(&face));
                    }
                } else if is_on_edge(surface.facets, surface.margin, &to) {
                    break;
                }
            }
            let was_active = f64::from(u8::from(is_active(active)));
            let meeting = Meeting {
                x,
                v,
                before,
                from: start,
                force,
                mass,
                gap,
                normal,
                obstacle,
                active: was_active,
                h: moved.h,
            };
            if !meets(law, &meeting) {
                break;
            }
            touched = true;
            if let Some(bits) = active.0.get_mut(k / WIDTH) {
                *bits |= bit;
            }
            let parting = if surface.facets.solid {
                respond(&Face { x, gap, normal }, law, true, &meeting)
            } else {
                respond(surface, law, true, &meeting)
            };
            moved.x.set(index, parting.x);
            moved.v.set(index, parting.v);
            moved.loss_contact[lane] += parting.loss_contact;
            moved.loss_friction[lane] += parting.loss_friction;
            moved.work_colliders[lane] += parting.work;
            moved.work_correction[lane] += parting.correction;
            through = !surface.facets.solid
                && surface.facets.crossed(&from, &surface.pose.inverse_transform(&parting.x)).is_some();
            if !through {
                break;
            }
        }
        // If facets leave no way out, the node stays where it was, and moves with the obstacle.
        if through {
            let (x, v, obstacle) = (moved.x.at(index), moved.v.at(index), surface.pose.velocity_at(&before));
            let stopped = subtract(&v, &obstacle);
            moved.x.set(index, before);
            moved.v.set(index, obstacle);
            moved.loss_contact[lane] += 0.5 * mass * dot(&stopped, &stopped);
            moved.work_colliders[lane] -= mass * dot(&stopped, &obstacle);
            moved.work_correction[lane] += dot(&force, &subtract(&x, &before));
        }
    }
    touched
}

/// The largest number of times that facets of one surface push a node within a pass.
const PUSHES: usize = 8;
