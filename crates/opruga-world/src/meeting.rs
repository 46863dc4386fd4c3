//! The surfaces of all bodies that may touch, beside the islands that hold their nodes.

use crate::blueprint::Blueprint;
use crate::contact_laws::{barrier_of, edges_of, laws};
use crate::island::{FramePlan, Island};
use opruga_collide::{Colliders, Outline, Touching, Trouble};
use opruga_core::contacts::Contacts;
use opruga_core::system::Workspace;
use opruga_math::{Lane, WIDTH};
use std::sync::Arc;

/// The margin of the search for candidates, relative to the mean edge: half of that is what points go between two searches, a quarter of
/// an edge, about as far as gaps are taken at all.
const MARGIN_OF_EDGE: f64 = 0.5;

/// Bodies that are stepped together because they may touch.
#[derive(Debug)]
pub(crate) struct Meeting<const D: usize> {
    pub(crate) touching: Touching<D>,
    /// The islands and obstacles that it was made for.
    made_for: MadeFor<D>,
    /// For every island the first of its points and where their nodes lie in its columns, body by body.
    columns: Vec<Vec<(u32, Vec<u32>)>>,
    /// The island of every point and the index in its columns; `u32::MAX` for one that nodes carry.
    points: Vec<(u32, u32)>,
    /// The bodies that touch, by their place in the scene.
    pub(crate) bodies: Vec<usize>,
    /// Corners and edges of obstacles, which follow the bodies, and the first point of each.
    pub(crate) outlines: Vec<(Outline<D>, usize)>,
    /// The bodies that take pushes into the balance of forces of their steps.
    pub(crate) pushed: Vec<Pushed<D>>,
    /// What keeps them apart instead of impulses, if the scene says so.
    pub(crate) barrier: Option<crate::barrier_search::Kept<D>>,
}

/// A body that takes pushes into the balance of forces.
#[derive(Debug)]
pub(crate) struct Pushed<const D: usize> {
    pub(crate) island: usize,
    /// Where its points lie in the columns of the island.
    pub(crate) indices: Vec<u32>,
    /// The impulses that its step was made with, by its points [N s].
    pub(crate) applied: Vec<(usize, [f64; D])>,
    /// Whether the answer to impulses belongs to this substep.
    pub(crate) prepared: bool,
}

impl<const D: usize> Pushed<D> {
    pub(crate) fn new(island: usize, indices: Vec<u32>) -> Self {
        Pushed { island, indices, applied: Vec::new(), prepared: false }
    }
}

/// A substep that bodies have made without one another.
#[derive(Clone, Copy)]
pub(crate) struct Substep<'a, const D: usize> {
    pub(crate) plan: &'a FramePlan<'a, D>,
    pub(crate) number: u32,
    /// The time at its end [s].
    pub(crate) time: f64,
    pub(crate) obstacles: Option<&'a dyn Contacts<D>>,
}

/// What the surfaces were made for: they are made anew where it has changed.
#[derive(Clone, Debug)]
pub(crate) struct MadeFor<const D: usize> {
    /// How many islands were built by then.
    pub(crate) built: u64,
    /// How many there were.
    pub(crate) islands: usize,
    /// The obstacles.
    pub(crate) colliders: Option<Arc<Colliders<D>>>,
}

impl<const D: usize> MadeFor<D> {
    fn is(&self, other: &MadeFor<D>) -> bool {
        let same = match (&self.colliders, &other.colliders) {
            (None, None) => true,
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            _ => false,
        };
        same && self.built == other.built && self.islands == other.islands
    }
}

impl<const D: usize> Meeting<D> {
    /// The surfaces of the bodies of a scene as it is now; none where no two of them may touch.
    pub(crate) fn of(scene: &Blueprint<D>, islands: &[Island<D>], made_for: MadeFor<D>) -> Option<Meeting<D>> {
        let contact = scene.contact.as_ref()?;
        let mut touching = Touching::<D>::default();
        let (mut columns, mut points, mut bodies) = (vec![Vec::new(); islands.len()], Vec::new(), Vec::new());
        let mut pushed = Vec::new();
        let (mut length, mut edges, mut shortest) = (0.0, 0, f64::INFINITY);
        // In the order of the bodies: results depend on no batches.
        let mut seats: Vec<(usize, usize, usize)> = Vec::new();
        for (number, island) in islands.iter().enumerate() {
            seats.extend(island.bodies.iter().enumerate().map(|(lane, body)| (*body, number, lane)));
        }
        seats.sort_unstable();
        for (body, number, lane) in seats {
            let blueprint = &scene.bodies[body];
            if !blueprint.touches() {
                continue;
            }
            let surface = blueprint.touching_surface();
            let own = edges_of(&surface, &blueprint.mesh);
            (length, edges) = (length + own.sum, edges + own.count);
            shortest = own.shortest.smaller(shortest);
            let first = touching.surface.points() as u32;
            let nodes = touching.surface.add_surface(surface, bodies.len() as u32);
            bodies.push(body);
            let system = &islands[number].system;
            let indices: Vec<u32> = nodes.iter().map(|n| system.layout.place(*n as usize, lane) as u32).collect();
            for index in &indices {
                let mut inverse = [system.inverse_mass.at(*index as usize); D];
                for pin in system.pins.iter().filter(|pin| pin.place == *index as usize) {
                    (0..D).filter(|d| pin.axes[*d]).for_each(|d| inverse[d] = 0.0);
                }
                touching.inverse_mass.push(inverse);
                points.push((number as u32, *index));
            }
            if islands[number].integrator.takes_pushes() {
                touching.coupled.add(first as usize..first as usize + indices.len());
                pushed.push(Pushed::new(number, indices.clone()));
            }
            points.resize(touching.surface.points(), (number as u32, u32::MAX));
            touching.inverse_mass.resize(touching.surface.points(), [0.0; D]);
            columns[number].push((first, indices));
        }
        let mean_edge = if edges > 0 { length / edges as f64 } else { 1.0 };
        touching.laws = laws(scene, contact, &bodies, mean_edge);
        let mut outlines = Vec::new();
        for outline in made_for.colliders.iter().flat_map(|colliders| colliders.outlines()) {
            let first = touching.surface.points();
            touching.surface.add_obstacle(&outline.mesh, (bodies.len() + outlines.len()) as u32);
            touching.laws.add_obstacle(outline.law);
            touching.inverse_mass.resize(touching.surface.points(), [0.0; D]);
            outlines.push((outline, first));
        }
        touching.margin = MARGIN_OF_EDGE * mean_edge;
        touching.most = contact.values.number("most_pairs").unwrap_or(0.0) as usize;
        for columns in touching.before.iter_mut().chain(&mut touching.after) {
            columns.resize(touching.inverse_mass.len(), [0.0; D]);
        }
        let barrier = barrier_of(contact, mean_edge, shortest);
        touching.may_touch().then_some(Meeting {
            touching,
            made_for,
            columns,
            points,
            bodies,
            outlines,
            pushed,
            barrier,
        })
    }

    /// Whether an island makes its substeps as one with others that a barrier keeps apart.
    pub(crate) fn steps_as_one(&self, island: usize) -> bool {
        self.barrier.is_some() && self.pushed.iter().any(|pushed| pushed.island == island)
    }

    /// Whether it was made for these islands and obstacles.
    pub(crate) fn is_for(&self, made_for: &MadeFor<D>) -> bool {
        self.made_for.is(made_for)
    }

    /// What a body or an obstacle is called, by its number among those that touch.
    pub(crate) fn name_of(&self, number: u32, scene: &Blueprint<D>) -> String {
        let number = number as usize;
        match (self.bodies.get(number), self.outlines.get(number.saturating_sub(self.bodies.len()))) {
            (Some(body), _) => scene.bodies[*body].name.clone(),
            (None, Some((outline, _))) => format!("collider {}", outline.collider),
            (None, None) => String::new(),
        }
    }

    /// Takes positions and velocities at a time [s], after the free motion or at the beginning of a frame.
    pub(crate) fn take(&mut self, islands: &[Island<D>], time: f64) {
        self.move_outlines(time);
        let [x, v] = &mut self.touching.after;
        for (island, bodies) in islands.iter().zip(&self.columns) {
            let state = &island.system.state;
            for (first, indices) in bodies {
                for d in 0..D {
                    let (from_x, from_v) = (&state.x.0[d], &state.v.0[d]);
                    for (k, index) in indices.iter().enumerate() {
                        x[*first as usize + k][d] = from_x[*index as usize];
                        v[*first as usize + k][d] = from_v[*index as usize];
                    }
                }
            }
        }
    }

    /// Whether all bodies are where positions keep their digits, with velocities that are numbers.
    pub(crate) fn is_in_range(&self, islands: &[Island<D>]) -> bool {
        let [x, v] = &self.touching.after;
        let is_in = |(point, (island, _)): (usize, &(u32, u32))| {
            let range = islands[*island as usize].range;
            x[point].iter().all(|c| c.abs() <= range) && v[point].iter().all(|c| c.is_finite())
        };
        self.points.iter().enumerate().all(is_in)
    }

    /// Takes corners of obstacles to where they are at a time [s].
    pub(crate) fn move_outlines(&mut self, time: f64) {
        let [x, v] = &mut self.touching.after;
        for (outline, first) in &self.outlines {
            let points = *first..*first + outline.mesh.positions.len();
            if let Some(colliders) = &self.made_for.colliders {
                let state = [&mut x[points.clone()], &mut v[points]];
                colliders.move_points(outline.collider, time, &outline.mesh.positions, state);
            }
        }
    }

    /// Adds the forces of the last substep of h [s] on the nodes of a body [N], but for those of obstacles on nodes. `stride` is how many
    /// bodies lie side by side in its island.
    pub(crate) fn add_forces(&self, body: usize, h: f64, stride: usize, forces: &mut [[f64; D]]) {
        let Some(number) = self.bodies.iter().position(|other| *other == body) else { return };
        let own = self.touching.surface.points_of(number);
        self.touching.visit_impulses(|point, impulse| {
            if own.contains(&point) {
                let node = self.points[point].1 as usize / stride;
                for d in 0..D {
                    forces[node][d] += impulse[d] / h;
                }
            }
        });
    }

    /// Where the step that follows begins: where the last one ended.
    pub(crate) fn set_out(&mut self, islands: &mut [Island<D>]) {
        let Touching { before, after, .. } = &mut self.touching;
        std::mem::swap(before, after);
        self.mark(islands);
    }

    /// Lets the bodies touch after a substep that each made by itself. Where one of them fails in it, its outcome says so.
    pub(crate) fn resolve(
        &mut self,
        islands: &mut [Island<D>],
        step: &Substep<'_, D>,
        workspace: &mut Workspace<D>,
    ) -> Result<(), Trouble> {
        let (time, h) = (step.time, step.plan.h);
        let touch = step.obstacles.map(|obstacles| {
            move |_: u32, from: &[f64; D], to: &[f64; D], reach: f64, visit: &mut dyn FnMut(_)| {
                obstacles.touch(from, to, time, h, reach, visit);
            }
        });
        let touch = touch.as_ref().map(|touch| touch as _);
        self.touching.begin_step();
        if self.pushed.is_empty() {
            self.touching.find_impulses(h, touch, None)?;
        } else if !self.iterate_with_contact(islands, step, touch, workspace)? {
            self.part(islands, step, workspace);
            if islands.iter().any(|island| island.outcome.is_err()) {
                return Ok(());
            }
            self.touching.find_impulses(h, touch, None)?;
        }
        self.touching.end_step(h);
        self.write_back(islands);
        self.end_pushes(islands, h);
        Ok(())
    }

    /// Writes what contact made of the bodies into their islands, and enters its works.
    fn write_back(&mut self, islands: &mut [Island<D>]) {
        let Touching { changed, losses, after: [x, v], .. } = &self.touching;
        for (p, [contact, friction, user, correction]) in changed.iter().zip(losses) {
            // What contact takes at points of obstacles is booked with the first island.
            let point = self.points.get(*p as usize).copied();
            let (island, index) = point.unwrap_or_default();
            let (system, index) = (&mut islands[island as usize].system, index as usize);
            for d in (0..D).filter(|_| point.is_some() && !self.touching.follows(*p)) {
                system.state.x.0[d][index] = x[*p as usize][d];
                system.state.v.0[d][index] = v[*p as usize][d];
            }
            let lane = index % WIDTH;
            system.work.contact[lane] += contact;
            system.work.friction[lane] += friction;
            system.work.user[lane] += user;
            system.work.correction[lane] += correction;
        }
    }
}
