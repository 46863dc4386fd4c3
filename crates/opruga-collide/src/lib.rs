//! # Obstacles
//!
//! Contact of rigid bodies, at rest or with a prescribed motion, with the nodes of deformable bodies: one pass per substep over
//! the nodes after their free motion. For a node at x with velocity v, a collider with signed distance g and normal n at the end
//! of the step, and the velocity v_c of the collider there:
//!
//! ```text
//! contact          g(x) < thickness
//! relative speed   u = v − v_c,  u_n = u·n
//! impact, u_n < 0  u_n' = e s       if it is one, else 0          (restitution)
//! friction         |Δu_t| = min(µ (u_n' − u_n), |u_t|), against u_t  (Coulomb: what sticks stops fully)
//! position         onto the surface
//! ```
//!
//! **Rest.** An approach is an impact if the node was off the surface at the start of the step and is faster than `rest_speed`. (If it was on the
//! surface, its whole normal speed comes from the step itself: from weight or from the body behind it.) In all other contacts, nodes do not bounce.
//! With `rest_speed = 0`, every crossing is an impact, even if the node lies on the floor. This is the rule v = −e v of the thesis.
//!
//! **Speed of an impact.** The force acts for the whole step, but the node meets the surface within it. The speed s of the impact therefore follows
//! from s² = u² + 2 a g, with the approach u and the gap g at the start of the step and the acceleration a towards the surface. The speed is limited
//! to the range between the approaches at both ends of the step. An impact therefore returns e² of the incoming energy, and forces do not create
//! energy. With `rest_speed = 0`, the rule of the thesis, s is the approach at the end of the step.
//!
//! **Position.** Without friction the node is moved along the normal onto the surface, and its tangential motion does not change
//! in any bit. With friction, a node that does not bounce moves from its previous position (carried along by the collider) with
//! its new tangential velocity, and then onto the surface. On a slope of angle θ, sticking nodes therefore do not creep by h² g
//! sin θ per step.
//!
//! **Energy.** With v₀ before the step, v₁ after it, v̄ = ½ (v₀ + v₁) and the impulse J of the obstacle, the kinetic energy
//! changes by (J + hF)·v̄. J·v̄ is work_colliders − loss_contact − loss_friction. Here work_colliders is J·v_c. The two losses
//! are the parts of −J·(v̄ − v_c) along the normal and along the surface: ½ m (u_n² − u_n'²) and ½ m (u_t² − u_t'²) if no force
//! acts. The rest of the change of the potential energy, F·(h v̄ − x₁ + x₀), is work_correction: the effect of moving the node
//! back to the surface. A node at rest exchanges no energy. F is the mean force of the step, m (v − v₀)/h with the velocity v
//! before contact.
//!
//! **Walking.** On a slope only a little less steep than the angle of friction, a vibrating soft body creeps down: it slips where it presses less,
//! and gravity supplies the energy that damping dissipates. This is not an error of the step. A block of 1 m × 0.5 m is placed suddenly on a slope of
//! tan θ = ½ with µ = 0.6. The block walks at 0.0682, 0.0683, 0.0683 and 0.0683 m/s with steps of 1/3840 s to 1/30720 s. With velocity Verlet and
//! Runge–Kutta the block walks at 0.0681 m/s. With cells of half the size it walks at 0.0654 m/s. With µ = 0.65 it comes to rest. Once at rest, it
//! stays at rest with any damping.
//!
//! **Fast nodes.** A half-space has no far side. A node that could cross a ball, box, capsule or convex body within a step is
//! stopped where it entered. Polylines and triangle meshes are thin and act on both sides. The segment from the previous to the
//! present position of the node (in the frame of the collider) is intersected with them. A node that would still end on the
//! other side (in a narrow groove) stays where it was.
//!
//! **Order.** Colliders act in the order of the scene, up to four times, so that a node in a corner satisfies all of its walls.
//! The result for a node depends only on the node: not on the tile, the layout or the vector instructions.
//!
//! **Deformable bodies.** [`Surface`] holds the features of bodies that touch one another, [`Candidates`] holds the pairs that
//! may touch, [`Gap`] is the distance of a pair, and [`vertex_meets_facet`] and [`edge_meets_edge`] find whether and when a pair
//! meets within a step.
//!
//! **Whole obstacles.** If bodies meet one another, corners and edges of obstacles ([`Outline`]) are part of the surfaces, with zero inverse mass.
//! These corners and edges meet the facets and edges of bodies in the same way as those of another body do. Nodes meet obstacles as above.
//!
//! **Limits.** If bodies do not meet one another, only nodes meet colliders, so an obstacle finer than the mesh can pass between two nodes. A tilted
//! or curved surface is evaluated at the end of the step. This evaluation is an approximation of first order in h.

// Units are in brackets, [m], which rustdoc takes for links.
#![allow(rustdoc::broken_intra_doc_links)]

mod active_nodes;
mod barrier;
mod began_inside;
mod blocks;
mod body_pairs;
mod bounds;
mod candidates;
mod ccd;
mod close_bodies;
mod close_pair;
mod closest;
mod collider;
mod comparison;
mod contacts;
mod counts;
mod coupled;
mod creases;
mod distances;
mod elimination;
mod entries;
mod facet_contacts;
mod facets;
mod finder;
mod found;
mod gap;
mod grid;
mod growth;
mod hull;
mod impact;
mod impulses;
mod inside;
mod kept;
mod last_impulse;
mod law;
mod least_parts;
mod lists;
mod motion;
mod newton;
mod obstacle_rows;
mod order;
mod outline;
mod overlaps;
mod pass;
mod passages;
mod picture;
mod positions;
mod reach;
#[doc(hidden)]
pub mod refusals;
mod reports;
mod response;
mod row;
mod rows;
mod search;
mod settle;
mod shape;
pub mod spec;
mod spread;
mod subspace;
mod surface;
mod sweeps;
mod touch;
mod touching;
mod turns;
mod unclear;
mod vector;
mod working_set;
mod zones;

pub use barrier::{Barrier, Pressed, Rubbing};
pub use candidates::Candidates;
pub use ccd::{edge_meets_edge, vertex_meets_facet};
pub use closest::{closest_of_segments, closest_on_facet, closest_on_segment, facet_normal};
pub use contacts::Colliders;
pub use counts::Counts;
pub use coupled::{Coupled, Respond};
pub use gap::Gap;
pub use inside::Buried;
pub use law::{Laws, PairLaw};
pub use outline::Outline;
pub use picture::Picture;
pub use positions::Positions;
pub use refusals::Refused;
pub use reports::Report;
pub use spec::all;
pub use surface::Surface;
pub use touching::{Obstacles, Touching, Trouble};
