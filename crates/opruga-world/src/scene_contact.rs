//! The data for contact in a scene that do not depend on which bodies meet.

use crate::blueprint::Blueprint;
use crate::contact_laws::{edges_of, laws, reach_of};
use crate::island::{FramePlan, Island};
use crate::path::{Bounds, overlap, wider};
use opruga_collide::{Colliders, Laws, Outline};
use opruga_core::spec::Values;
use opruga_math::{Lane, Simd};
use std::sync::Arc;

/// The margin of the search for candidates, relative to the mean edge. Between two searches, points may move by half of this margin: a quarter of an
/// edge, which is about the size of the gaps that are considered at all.
const MARGIN_OF_EDGE: f64 = 0.5;

/// The bodies of a scene that may touch, and their contact laws.
#[derive(Debug)]
pub(crate) struct SceneContact<const D: usize> {
    made_for: MadeFor<D>,
    /// The bodies, by their index in the scene, ascending. The numbers in the other fields refer to this list.
    pub(crate) bodies: Vec<usize>,
    /// The island and the lane of each body.
    pub(crate) seats: Vec<(usize, usize)>,
    /// The integrators of the bodies: equal numbers mean the same integrator.
    pub(crate) rules: Vec<u32>,
    /// Corners and edges of obstacles; their numbers follow the numbers of the bodies.
    pub(crate) outlines: Vec<Arc<Outline<D>>>,
    pub(crate) laws: Laws,
    /// The margin of the search for candidates [m].
    pub(crate) margin: f64,
    /// The maximum number of candidates.
    pub(crate) most: usize,
    /// The vector instructions of the world.
    pub(crate) simd: Simd,
    /// The reach of the barrier [m]; `None` if impulses keep bodies apart.
    pub(crate) reach: Option<f64>,
    /// The distance from their present positions within which bodies may touch others [m].
    distance: f64,
}

/// The state of the scene for which the data for contact were made. The data are rebuilt if this state changes.
#[derive(Clone, Debug)]
pub(crate) struct MadeFor<const D: usize> {
    /// The number of islands that had been built when the data were made.
    pub(crate) built: u64,
    /// The number of islands.
    pub(crate) islands: usize,
    /// The obstacles of the scene at that time.
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

impl<const D: usize> SceneContact<D> {
    /// The contact of a scene in its present state; `None` without `[contact]`, or if no two bodies may touch.
    pub(crate) fn of(
        scene: &Blueprint<D>,
        islands: &[Island<D>],
        made_for: MadeFor<D>,
        simd: Simd,
    ) -> Option<SceneContact<D>> {
        let contact = scene.contact.as_ref()?;
        // In the order of the bodies, so that results do not depend on batches.
        let mut seated: Vec<(usize, (usize, usize))> = Vec::new();
        for (number, island) in islands.iter().enumerate() {
            seated.extend(island.bodies.iter().enumerate().map(|(lane, body)| (*body, (number, lane))));
        }
        seated.retain(|(body, _)| scene.bodies[*body].touches());
        seated.sort_unstable();
        let (bodies, seats): (Vec<usize>, Vec<_>) = seated.into_iter().unzip();
        let (mut length, mut edges, mut shortest) = (0.0, 0, f64::INFINITY);
        let mut known: Vec<&Values> = Vec::new();
        let mut rules = Vec::with_capacity(bodies.len());
        for body in &bodies {
            let blueprint = &scene.bodies[*body];
            let own = edges_of(&blueprint.touching_surface(), &blueprint.mesh);
            (length, edges) = (length + own.sum, edges + own.count);
            shortest = own.shortest.smaller(shortest);
            let rule = scene.bodies[*body].integrator.as_ref().unwrap_or(&scene.integrator);
            let number = known.iter().position(|other| *other == rule).unwrap_or_else(|| {
                known.push(rule);
                known.len() - 1
            });
            rules.push(number as u32);
        }
        let mean_edge = if edges > 0 { length / edges as f64 } else { 1.0 };
        let mut laws = laws(scene, contact, &bodies, mean_edge);
        let outlines: Vec<Arc<Outline<D>>> =
            made_for.colliders.iter().flat_map(|colliders| colliders.outlines()).map(Arc::new).collect();
        let thickness = laws.largest_thickness()[0];
        outlines.iter().for_each(|outline| laws.add_obstacle(outline.law));
        let reach = reach_of(contact, mean_edge, shortest);
        laws.any_meet().then_some(SceneContact {
            made_for,
            bodies,
            seats,
            rules,
            outlines,
            laws,
            margin: MARGIN_OF_EDGE * mean_edge,
            most: contact.values.number("most_pairs").unwrap_or(0.0) as usize,
            simd,
            reach,
            distance: thickness + reach.unwrap_or(0.0),
        })
    }

    /// Whether the data were made for these islands and obstacles.
    pub(crate) fn is_for(&self, made_for: &MadeFor<D>) -> bool {
        self.made_for.is(made_for)
    }

    /// The obstacles for which the data were made; `None` if the scene has no obstacles.
    pub(crate) fn colliders(&self) -> Option<&Arc<Colliders<D>>> {
        self.made_for.colliders.as_ref()
    }

    /// The name of a body or an obstacle.
    pub(crate) fn name_of(&self, number: u32, blueprint: &Blueprint<D>) -> String {
        match (self.bodies.get(number as usize), self.collider(number)) {
            (Some(body), _) => blueprint.bodies[*body].name.clone(),
            (None, Some(collider)) => format!("collider {collider}"),
            (None, None) => String::new(),
        }
    }

    /// The index of an obstacle in the scene; `None` for a body.
    pub(crate) fn collider(&self, number: u32) -> Option<usize> {
        let number = (number as usize).checked_sub(self.bodies.len())?;
        self.outlines.get(number).map(|outline| outline.collider)
    }

    /// Whether a body touches itself.
    fn touches_itself(&self, number: usize) -> bool {
        self.laws.meet(number as u32, number as u32)
    }

    /// The outlines that bodies in a box may meet during a frame.
    fn visit_outlines(&self, plan: &FramePlan<'_, D>, [low, high]: &Bounds<D>, mut visit: impl FnMut(u32)) {
        let Some(colliders) = self.colliders() else { return };
        let end = plan.start + f64::from(plan.substeps) * plan.h;
        for (number, outline) in self.outlines.iter().enumerate() {
            if colliders.one_reaches(outline.collider, plan.start, end, low, high) {
                visit(number as u32);
            }
        }
    }
}

/// The partition of bodies into those that are stepped through a frame together: bodies that may touch one another, directly or through other bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Partition {
    /// Another body of the same cluster, or the body itself.
    parent: Vec<u32>,
    /// Pairs of a body and an outline that it may meet, ascending.
    outlines: Vec<(u32, u32)>,
}

/// Bodies that are stepped through a frame together, and outlines that they may meet; ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cluster {
    pub(crate) bodies: Vec<u32>,
    pub(crate) outlines: Vec<u32>,
}

/// The maximum number of corners of an obstacle that several clusters may meet separately: about as many as a small body has points.
const MOST_COPIED: usize = 64;

impl Partition {
    /// Puts every body into a cluster of its own.
    pub(crate) fn begin(&mut self, bodies: usize) {
        self.parent.clear();
        self.parent.extend(0..bodies as u32);
        self.outlines.clear();
    }

    fn root(&self, mut body: u32) -> u32 {
        while self.parent[body as usize] != body {
            body = self.parent[body as usize];
        }
        body
    }

    /// Joins bodies whose swept boxes come close to one another, and lists the obstacles close to them; returns whether there are new ones. `order`
    /// is scratch memory.
    pub(crate) fn join<const D: usize>(
        &mut self,
        scene: &SceneContact<D>,
        plan: &FramePlan<'_, D>,
        boxes: &[Bounds<D>],
        order: &mut Vec<u32>,
    ) -> bool {
        let mut any = false;
        let wide = |number: u32| wider(boxes[number as usize], scene.distance);
        // Bodies are compared along the axis along which all of them together extend farthest, in the order of their lower
        // ends.
        let extent = |d: usize| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for one in boxes {
                (low, high) = (one[0][d].smaller(low), one[0][d].larger(high));
            }
            high - low
        };
        let axis = (1..D).fold(0, |most, d| if extent(d) > extent(most) { d } else { most });
        order.clear();
        order.extend(0..boxes.len() as u32);
        order.sort_unstable_by(|a, b| {
            let [a, b] = [a, b].map(|number| boxes[*number as usize][0][axis]);
            a.total_cmp(&b)
        });
        for (k, first) in order.iter().enumerate() {
            let own = wide(*first);
            let close = order[k + 1..].iter().take_while(|other| wide(**other)[0][axis] <= own[1][axis]);
            for other in close {
                if overlap(&own, &wide(*other)) && scene.laws.meet(*first, *other) {
                    any |= self.join_two(*first, *other);
                }
            }
            scene.visit_outlines(plan, &own, |outline| any |= self.add_outline(scene, *first, outline));
        }
        // Refer every body to the lowest body of its cluster.
        for body in 0..self.parent.len() {
            self.parent[body] = self.parent[self.parent[body] as usize];
        }
        any
    }

    fn add_outline<const D: usize>(&mut self, scene: &SceneContact<D>, body: u32, outline: u32) -> bool {
        let Err(at) = self.outlines.binary_search(&(body, outline)) else { return false };
        self.outlines.insert(at, (body, outline));
        // Every cluster has its own copy of the corners of an obstacle. If there are many corners, the copies cost more than they save.
        if scene.outlines[outline as usize].mesh.positions.len() > MOST_COPIED {
            let other = self.outlines.iter().find(|(other, number)| *number == outline && *other != body);
            if let Some((other, _)) = other.copied() {
                self.join_two(body, other);
            }
        }
        true
    }

    fn join_two(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
        a != b
    }

    /// The clusters of bodies that may touch anything, in the order of their first bodies.
    pub(crate) fn clusters<const D: usize>(&self, scene: &SceneContact<D>) -> Vec<Cluster> {
        let mut out: Vec<Cluster> = Vec::new();
        let mut number = vec![usize::MAX; self.parent.len()];
        for body in 0..self.parent.len() {
            let root = self.parent[body] as usize;
            if root == body {
                number[body] = out.len();
                out.push(Cluster::default());
            }
            out[number[root]].bodies.push(body as u32);
        }
        for (body, outline) in &self.outlines {
            out[number[self.parent[*body as usize] as usize]].outlines.push(*outline);
        }
        for cluster in &mut out {
            cluster.outlines.sort_unstable();
            cluster.outlines.dedup();
        }
        let touches = |cluster: &Cluster| {
            cluster.bodies.len() > 1
                || !cluster.outlines.is_empty()
                || cluster.bodies.iter().any(|body| scene.touches_itself(*body as usize))
        };
        out.retain(touches);
        out
    }
}
