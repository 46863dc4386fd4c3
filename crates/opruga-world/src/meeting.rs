//! The surfaces of bodies that may touch, together with the islands that own their nodes.

use crate::barrier_search::Kept;
use crate::blueprint::Blueprint;
use crate::island::{FramePlan, Island};
use crate::scene_contact::{Cluster, SceneContact};
use opruga_collide::{Colliders, Obstacles, Outline, Touching, Trouble};
use opruga_core::contacts::Contacts;
use opruga_core::system::Workspace;
use opruga_math::WIDTH;
use std::sync::Arc;

/// Bodies of a cluster. The bodies are stepped through a frame together because they may touch.
#[derive(Debug)]
pub(crate) struct Meeting<const D: usize> {
    pub(crate) touching: Touching<D>,
    /// The members of the cluster, and their numbers in the scene: bodies, then obstacles.
    pub(crate) cluster: Cluster,
    numbers: Vec<u32>,
    colliders: Option<Arc<Colliders<D>>>,
    /// The obstacles without their faces, for nodes of bodies whose surfaces are in contact with these faces.
    pub(crate) without_faces: Option<Arc<dyn Contacts<D>>>,
    /// For every island of the group, body by body: the first point of the body, and the indices of its nodes in the columns of the island.
    columns: Vec<Vec<(u32, Vec<u32>)>>,
    /// The island of every point and its index in the columns of that island; `u32::MAX` for a point whose position follows from nodes.
    points: Vec<(u32, u32)>,
    /// The bodies that touch, by their index in the scene.
    pub(crate) bodies: Vec<usize>,
    /// The integrators of the bodies, if there are several: equal numbers mean the same integrator.
    rules: Vec<u32>,
    /// The bodies with different integrators that met in the frame, by their index in the scene, ascending.
    pub(crate) mixed: Vec<[usize; 2]>,
    /// The corners and edges of obstacles, each with the number of its first point. The points of obstacles follow the points of bodies.
    pub(crate) outlines: Vec<(Arc<Outline<D>>, usize)>,
    /// The bodies whose steps include contact forces in their balance of forces.
    pub(crate) pushed: Vec<Pushed<D>>,
    /// Whether the bodies use statics and have a common equilibrium.
    pub(crate) at_rest: bool,
    /// The barrier that keeps the bodies apart instead of impulses, if the scene has one.
    pub(crate) barrier: Option<Kept<D>>,
    /// A workspace for bodies that repeat their steps.
    pub(crate) workspace: Workspace<D>,
}

/// A body whose step includes contact forces in its balance of forces.
#[derive(Debug)]
pub(crate) struct Pushed<const D: usize> {
    pub(crate) island: usize,
    /// The indices of its points in the columns of the island.
    pub(crate) indices: Vec<u32>,
    /// The impulses that were applied in its step, by its points [N s].
    pub(crate) applied: Vec<(usize, [f64; D])>,
    /// The number of the matrix that gives the response of the body to impulses; `None` if no response has been requested since the last step.
    pub(crate) matrix: Option<u64>,
}

impl<const D: usize> Pushed<D> {
    pub(crate) fn new(island: usize, indices: Vec<u32>) -> Self {
        Pushed { island, indices, applied: Vec::new(), matrix: None }
    }

    /// Repeats the step of the body without contact forces.
    pub(crate) fn step_without(&mut self, island: &mut Island<D>, step: &Substep<'_, D>, workspace: &mut Workspace<D>) {
        island.system.pushes = Some(Vec::new());
        island.rewind();
        island.step_together(step.plan, step.number, workspace);
        self.applied.clear();
        self.matrix = None;
    }

    /// The forces of its impulses in a substep of h [s], by their index into the columns of its island [N].
    pub(crate) fn forces(&self, h: f64) -> Vec<(usize, [f64; D])> {
        let force = |(point, impulse): &(usize, [f64; D])| (self.indices[*point] as usize, impulse.map(|c| c / h));
        self.applied.iter().map(force).collect()
    }
}

/// A substep that the bodies have made independently of one another.
#[derive(Clone, Copy)]
pub(crate) struct Substep<'a, const D: usize> {
    pub(crate) plan: &'a FramePlan<'a, D>,
    pub(crate) number: u32,
    /// The time at its end [s].
    pub(crate) time: f64,
    pub(crate) obstacles: Option<&'a dyn Contacts<D>>,
}

impl<const D: usize> Substep<'_, D> {
    /// Runs a computation with a function that finds the obstacles that a single point touches in this substep.
    pub(crate) fn with_obstacles<R>(&self, work: impl FnOnce(Option<Obstacles<'_, D>>) -> R) -> R {
        let Some(obstacles) = self.obstacles else { return work(None) };
        let (time, h) = (self.time, self.plan.h);
        work(Some(&|_, from, to, reach, visit| obstacles.touch(from, to, time, h, reach, visit)))
    }
}

impl<const D: usize> Meeting<D> {
    /// The surfaces of a cluster, whose bodies are in the given islands of the scene.
    pub(crate) fn of(
        blueprint: &Blueprint<D>,
        scene: &SceneContact<D>,
        all: &[Island<D>],
        islands: &[usize],
        cluster: Cluster,
    ) -> Meeting<D> {
        let first_outline = scene.bodies.len() as u32;
        let mut numbers = cluster.bodies.clone();
        numbers.extend(cluster.outlines.iter().map(|outline| first_outline + outline));
        let mut touching = Touching::<D>::default();
        touching.use_simd(scene.simd);
        let (mut columns, mut points, mut pushed) = (vec![Vec::new(); islands.len()], Vec::new(), Vec::new());
        let mut pushed_bodies = Vec::new();
        let mut workspace = Workspace::default();
        for (own, number) in cluster.bodies.iter().enumerate() {
            let (island, lane) = scene.seats[*number as usize];
            let first = touching.surface.points() as u32;
            let body = &blueprint.bodies[scene.bodies[*number as usize]];
            let nodes = touching.surface.add_surface(body.touching_surface(), &body.mesh.positions, own as u32);
            let Island { system, integrator, .. } = &all[island];
            let island = islands.binary_search(&island).unwrap_or(0);
            let indices: Vec<u32> = nodes.iter().map(|n| system.layout.index(*n as usize, lane) as u32).collect();
            for index in &indices {
                let mut inverse = [system.inverse_mass.at(*index as usize); D];
                for pin in system.pins.iter().filter(|pin| pin.index == *index as usize) {
                    (0..D).filter(|d| pin.axes[*d]).for_each(|d| inverse[d] = 0.0);
                }
                touching.inverse_mass.push(inverse);
                points.push((island as u32, *index));
            }
            touching.kicked_by_first_force.push(integrator.kicks_by_first_force());
            if integrator.takes_pushes() {
                touching.coupled.add(first as usize..first as usize + indices.len());
                pushed.push(Pushed::new(island, indices.clone()));
                pushed_bodies.push(own);
                workspace.fit(system);
            }
            points.resize(touching.surface.points(), (island as u32, u32::MAX));
            touching.inverse_mass.resize(touching.surface.points(), [0.0; D]);
            columns[island].push((first, indices));
        }
        let mut outlines = Vec::new();
        for (k, number) in cluster.outlines.iter().enumerate() {
            let (outline, first) = (&scene.outlines[*number as usize], touching.surface.points());
            touching.surface.add_obstacle(outline, (cluster.bodies.len() + k) as u32);
            touching.inverse_mass.resize(touching.surface.points(), [0.0; D]);
            outlines.push((Arc::clone(outline), first));
        }
        touching.laws = scene.laws.of_some(&numbers);
        (touching.margin, touching.most) = (scene.margin, scene.most);
        for columns in touching.before.iter_mut().chain(&mut touching.after) {
            columns.resize(touching.inverse_mass.len(), [0.0; D]);
        }
        let at_rest = pushed.iter().any(|pushed| all[islands[pushed.island]].integrator.is_static());
        if at_rest {
            touching.come_to_rest();
        }
        touching.has_budget = pushed.iter().all(|pushed| all[islands[pushed.island]].integrator.has_budget());
        // Contact cannot lift a node off an obstacle that holds it within the step. Near an edge, contacts and held nodes would therefore contradict
        // each other. So bodies with implicit steps touch the faces of obstacles like the faces of bodies.
        let mut without_faces = None;
        if let Some(colliders) = scene.colliders().filter(|_| (!at_rest || scene.reach.is_some()) && !pushed.is_empty())
        {
            without_faces = Some(Arc::new(colliders.without_faces()).into_contacts());
            pushed_bodies.into_iter().for_each(|own| touching.surface.touch_faces(own));
        }
        let mut rules: Vec<u32> = cluster.bodies.iter().map(|number| scene.rules[*number as usize]).collect();
        if rules.iter().all(|rule| *rule == rules[0]) {
            rules.clear();
        }
        Meeting {
            touching,
            bodies: cluster.bodies.iter().map(|number| scene.bodies[*number as usize]).collect(),
            numbers,
            cluster,
            colliders: scene.colliders().cloned(),
            without_faces,
            columns,
            points,
            rules,
            mixed: Vec::new(),
            outlines,
            pushed,
            at_rest,
            barrier: scene.reach.map(|reach| Kept::new(reach, scene.simd)),
            workspace,
        }
    }

    /// Whether its bodies make their substeps jointly: bodies that a barrier keeps apart, and bodies that come to rest on one another.
    pub(crate) fn is_one(&self) -> bool {
        self.barrier.is_some() || self.at_rest
    }

    /// Whether an island makes its substeps jointly with others.
    pub(crate) fn steps_as_one(&self, island: usize) -> bool {
        self.is_one() && self.pushed.iter().any(|pushed| pushed.island == island)
    }

    /// Returns the error with the numbers that bodies and obstacles have in the scene.
    pub(crate) fn in_scene(&self, trouble: Trouble) -> Trouble {
        let all = |bodies: [u32; 2]| bodies.map(|body| self.numbers[body as usize]);
        match trouble {
            Trouble::TooMany | Trouble::BrokenOff => trouble,
            Trouble::Meet { bodies } => Trouble::Meet { bodies: all(bodies) },
            Trouble::LedThrough { bodies } => Trouble::LedThrough { bodies: all(bodies) },
        }
    }

    /// Reads positions and velocities at a time [s], after the free motion or at the beginning of a frame.
    pub(crate) fn take(&mut self, islands: &[&mut Island<D>], time: f64) {
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

    /// Moves corners of obstacles to their positions at a time [s].
    pub(crate) fn move_outlines(&mut self, time: f64) {
        let [x, v] = &mut self.touching.after;
        for (outline, first) in &self.outlines {
            let points = *first..*first + outline.mesh.positions.len();
            if let Some(colliders) = &self.colliders {
                let state = [&mut x[points.clone()], &mut v[points]];
                colliders.move_points(outline.collider, time, &outline.mesh.positions, state);
            }
        }
    }

    /// Adds the contact forces of the last substep of h [s] on the nodes of a body [N], except for the forces of obstacles on nodes. `stride` is the
    /// number of bodies side by side in its island.
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

    /// Begins the next step where the previous one ended.
    pub(crate) fn set_out(&mut self, islands: &mut [&mut Island<D>]) {
        let Touching { before, after, .. } = &mut self.touching;
        std::mem::swap(before, after);
        self.mark(islands);
    }

    /// Whether some of its bodies respond to contact as a whole, so that steps and contact are solved in turn.
    pub(crate) fn is_pushed(&self) -> bool {
        !self.pushed.is_empty()
    }

    /// Solves the contact of bodies that have made the substep independently; [`Meeting::write_back`] applies the result to them.
    pub(crate) fn solve(&mut self, step: &Substep<'_, D>) -> Result<(), Trouble> {
        self.touching.begin_step();
        step.with_obstacles(|touch| self.touching.find_impulses(step.plan.h, touch, None))?;
        self.touching.end_step(step.plan.h);
        Ok(())
    }

    /// Solves the contact of bodies that respond as a whole, and repeats their steps with the resulting forces. If the step of a body fails, the
    /// outcome of this body contains the error.
    pub(crate) fn solve_in_turn(
        &mut self,
        islands: &mut [&mut Island<D>],
        step: &Substep<'_, D>,
    ) -> Result<(), Trouble> {
        let h = step.plan.h;
        self.touching.begin_step();
        let agreed = step.with_obstacles(|touch| self.iterate_with_contact(islands, step, touch))?;
        if !agreed && !self.repeat_exactly(islands, step)? {
            self.part(islands, step);
            if islands.iter().any(|island| island.outcome.is_err()) {
                return Ok(());
            }
            step.with_obstacles(|touch| self.touching.find_impulses(h, touch, None))?;
        }
        self.touching.end_step(h);
        self.write_back(islands);
        self.end_pushes(islands, h);
        Ok(())
    }

    /// Records bodies with different integrators that met in the substep.
    fn note_mixed(&mut self) {
        let Meeting { touching, rules, mixed, bodies, .. } = self;
        if rules.is_empty() {
            return;
        }
        touching.visit_pairs(|a, b| {
            let mut pair = [a, b].map(|body| bodies[body as usize]);
            pair.sort_unstable();
            if rules[a as usize] != rules[b as usize]
                && let Err(at) = mixed.binary_search(&pair)
            {
                mixed.insert(at, pair);
            }
        });
    }

    /// Writes the results of contact into the islands of the bodies, and records the work.
    pub(crate) fn write_back(&mut self, islands: &mut [&mut Island<D>]) {
        self.note_mixed();
        let Touching { changed, losses, after: [x, v], .. } = &self.touching;
        for (p, [contact, friction, user, correction]) in changed.iter().zip(losses) {
            // The losses of contact at points of obstacles are assigned to the first island.
            let point = self.points.get(*p as usize).copied();
            let (island, index) = point.unwrap_or_default();
            let (island, index) = (&mut islands[island as usize], index as usize);
            if point.is_some() {
                island.path.include_one(index, &x[*p as usize]);
            }
            let system = &mut island.system;
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
