//! Every test of this crate that needs no process of its own, in one program: it is linked once.

mod acting;
mod any_world;
mod ball;
mod blueprints_of_programs;
mod common;
mod consistent_mass;
mod contact;
mod damped_bars;
mod far_from_the_origin;
mod flat_bodies;
mod handles;
mod interrupted_near_obstacles;
mod invariance_of_solids;
mod led_bodies;
mod looks;
mod other_balances;
mod pins_and_masses;
mod real_time;
mod refusals;
mod robust_steps;
mod shapes_of_cells;
mod slender_cells;
mod statics;
mod stiff_bodies;
mod torn_by_pins;
mod whole_obstacles;
