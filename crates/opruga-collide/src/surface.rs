//! The surface of deformable bodies: the features that take part in contact.

use crate::order::{Kind, Ordered, shorter};
use crate::outline::Outline;
use opruga_mesh::{Carrier, Mesh, TouchingSurface};

/// Points, edges and facets of the surfaces of some bodies, in a uniform form for contact.
///
/// Points are nodes of the bodies that belong to a boundary, an open surface or a wire, or fixed combinations of nodes: [`Carrier`]. In 2D
/// facets are edges, in 3D triangles.
#[derive(Clone, Debug, Default)]
pub struct Surface<const D: usize> {
    /// The body of every point.
    pub body: Vec<u32>,
    /// The corners of every facet. The facets of a closed boundary have the inside to their left (2D) or on the side from which they appear clockwise
    /// (3D).
    pub facets: Vec<[u32; D]>,
    /// Whether a facet is part of a closed boundary and so has an inside; others act on both sides.
    pub closed: Vec<bool>,
    /// Edges in 3D, each once; empty in 2D, where facets are the edges.
    pub edges: Vec<[u32; 2]>,
    /// The facets with an inside at each edge, as numbers of facets; `u32::MAX` for none.
    pub sides: Vec<[u32; 2]>,
    /// The start of the points, facets, edges and vertices of each body. Points before its vertices only carry others.
    starts: Vec<[u32; 4]>,
    /// The points that are carried by others, ascending, and their carriers. Carriers refer to points that move independently.
    carried: Vec<u32>,
    carriers: Vec<Carrier>,
    /// For each body in the order of addition, whether its vertices touch faces of obstacles; otherwise obstacles hold its nodes.
    touch_faces: Vec<bool>,
    /// The first body that is an obstacle, and its first point.
    obstacles: Option<[u32; 2]>,
    /// For each body, the vertices, facets and edges in an order in which neighbours follow one another; empty if that is the order of their numbers.
    /// The order changes only the run time.
    orders: Vec<[Vec<u32>; 3]>,
    /// The facets around a point: `around[ring[p]..ring[p + 1]]`, ascending.
    ring: Vec<u32>,
    around: Vec<u32>,
}

impl<const D: usize> Surface<D> {
    /// The number of points.
    pub fn points(&self) -> usize {
        self.body.len()
    }

    /// The points of the body that was added with this number. The points that are nodes come before the points that nodes carry.
    pub fn points_of(&self, number: usize) -> core::ops::Range<usize> {
        self.range(number, 0, self.points())
    }

    /// The points of a body that take part in contact: all except those that only carry others.
    pub fn vertices_of(&self, number: usize) -> core::ops::Range<usize> {
        let points = self.points_of(number);
        self.starts.get(number).map_or(points.end, |start| start[3] as usize)..points.end
    }

    /// The points of the features of a body. Facets of obstacles may have corners that are no vertices.
    pub(crate) fn feature_points_of(&self, number: usize) -> core::ops::Range<usize> {
        if self.is_obstacle(number as u32) { self.points_of(number) } else { self.vertices_of(number) }
    }

    /// The facets of the body that was added with this number.
    pub fn facets_of(&self, number: usize) -> core::ops::Range<usize> {
        self.range(number, 1, self.facets.len())
    }

    /// The edges of the body that was added with this number.
    pub fn edges_of(&self, number: usize) -> core::ops::Range<usize> {
        self.range(number, 2, self.edges.len())
    }

    fn range(&self, number: usize, what: usize, end: usize) -> core::ops::Range<usize> {
        let at = |k: usize| self.starts.get(k).map_or(end, |start| start[what] as usize);
        at(number)..at(number + 1)
    }

    /// The number of added bodies.
    pub fn bodies(&self) -> usize {
        self.starts.len()
    }

    /// Adds the surface of a body: boundary, open surfaces, wires, or its nodes as points if there are none of these. Returns the
    /// nodes of the first added points, in order.
    pub fn add(&mut self, mesh: &Mesh<D>, body: u32) -> Vec<u32> {
        self.add_surface(mesh.touching_surface(true), &mesh.positions, body)
    }

    /// Adds the surface of a body whose nodes are at `rest` without forces [m]. Returns the nodes of the first added points, in order; carried points
    /// follow.
    pub fn add_surface(&mut self, own: TouchingSurface<D>, rest: &[[f64; D]], body: u32) -> Vec<u32> {
        let at = own.positions(rest);
        let start = self.points() as u32;
        let first_facet = self.facets.len();
        self.starts.push([start, first_facet as u32, self.edges.len() as u32, start + own.carrying as u32]);
        let points = own.points();
        self.body.resize(start as usize + points, body);
        self.facets.extend(own.facets.iter().map(|facet| facet.map(|p| start + p)));
        self.closed.resize(first_facet + own.closed, true);
        self.closed.resize(self.facets.len(), false);
        self.carried.extend(start + own.nodes.len() as u32..start + points as u32);
        self.carriers.extend(own.carried.iter().map(|own| Carrier { nodes: own.nodes.map(|p| start + p), ..*own }));
        let wires = own.wires.iter().map(|wire| wire.map(|p| start + p)).collect();
        self.join(first_facet, wires, points);
        self.put_in_order(&at);
        own.nodes
    }

    /// Adds the surface of an obstacle, after all bodies, with only the edges and corners of its outline.
    pub fn add_obstacle(&mut self, outline: &Outline<D>, body: u32) {
        let (point, first) = (self.points() as u32, self.edges.len());
        self.obstacles.get_or_insert([body, point]);
        self.add(&outline.mesh, body);
        if let Some(start) = self.starts.last_mut() {
            start[3] += outline.within_faces as u32;
        }
        let is_kept = |edge: &[u32; 2]| outline.edges.binary_search(&edge.map(|p| p - point)).is_ok();
        let all = self.edges.drain(first..).zip(self.sides.drain(first..));
        let (edges, sides): (Vec<_>, Vec<_>) = all.filter(|(edge, _)| is_kept(edge)).unzip();
        self.edges.extend(edges);
        self.sides.extend(sides);
        self.orders.pop();
        self.put_in_order(&outline.mesh.positions);
    }

    /// Determines the orders of the features of the last body, whose points are at `rest` without forces [m].
    fn put_in_order(&mut self, rest: &[[f64; D]]) {
        let number = self.bodies() - 1;
        let first = self.points_of(number).start;
        let at = |p: u32| rest[p as usize - first];
        self.orders.push([
            shorter(self.vertices_of(number), |p| at(p as u32)),
            shorter(self.facets_of(number), |facet| at(self.facets[facet][0])),
            shorter(self.edges_of(number), |edge| at(self.edges[edge][0])),
        ]);
    }

    /// The features of one kind of the body that was added with this number, in an order in which neighbours follow one another.
    pub(crate) fn ordered(&self, number: usize, kind: Kind) -> Ordered<'_> {
        let order = &self.orders[number][kind as usize];
        if !order.is_empty() {
            return Ordered::Along(order);
        }
        Ordered::ByNumber(match kind {
            Kind::Vertices => self.vertices_of(number),
            Kind::Facets => self.facets_of(number),
            Kind::Edges => self.edges_of(number),
        })
    }

    /// Lets the vertices of a body touch faces of obstacles. Bodies are numbered in the order in which they were added. Otherwise obstacles hold its
    /// nodes directly.
    pub fn touch_faces(&mut self, number: usize) {
        self.touch_faces.resize(self.touch_faces.len().max(number + 1), false);
        self.touch_faces[number] = true;
    }

    /// Whether the body that was added with this number touches faces of obstacles.
    pub(crate) fn touches_faces(&self, number: u32) -> bool {
        self.touch_faces.get(number as usize).is_some_and(|touches| *touches)
    }

    /// Whether a body is an obstacle.
    pub fn is_obstacle(&self, body: u32) -> bool {
        self.obstacles.is_some_and(|[first, _]| body >= first)
    }

    /// Whether a point belongs to an obstacle.
    #[inline]
    pub fn is_of_obstacle(&self, point: u32) -> bool {
        self.obstacles.is_some_and(|[_, first]| point >= first)
    }

    /// Finds the edges of all facets from `first_facet` on, and the facets around every point.
    fn join(&mut self, first_facet: usize, wires: Vec<[u32; 2]>, points: usize) {
        let mut edges: Vec<([u32; 2], u32)> = Vec::new();
        for (number, facet) in self.facets.iter().enumerate().skip(first_facet) {
            let side = if self.closed[number] { number as u32 } else { u32::MAX };
            for k in 0..if D == 2 { 1 } else { D } {
                let (a, b) = (facet[k], facet[(k + 1) % D]);
                edges.push((if a < b { [a, b] } else { [b, a] }, side));
            }
        }
        edges.extend(wires.into_iter().map(|[a, b]| (if a < b { [a, b] } else { [b, a] }, u32::MAX)));
        edges.sort_unstable();
        for same in edges.chunk_by(|a, b| a.0 == b.0).filter(|_| D == 3) {
            let side = |k: usize| same.get(k).map_or(u32::MAX, |(_, side)| *side);
            self.edges.push(same[0].0);
            self.sides.push([side(0), side(1)]);
        }
        let facets = self.facets.iter().enumerate().skip(first_facet);
        let mut corners: Vec<(u32, u32)> = facets.flat_map(|(k, f)| f.map(|p| (p, k as u32))).collect();
        corners.sort_unstable();
        if self.ring.is_empty() {
            self.ring.push(0);
        }
        let mut k = 0;
        let start = (self.ring.len() - 1) as u32;
        for p in start..start + points as u32 {
            while let Some((_, facet)) = corners.get(k).filter(|(a, _)| *a == p) {
                self.around.push(*facet);
                k += 1;
            }
            self.ring.push(self.around.len() as u32);
        }
    }

    /// The points of both features of a pair: a vertex and a facet, or two edges.
    pub(crate) fn points_of_features<'a>(&'a self, pair: &'a [u32; 2], with_facet: bool) -> [&'a [u32]; 2] {
        let [a, b] = pair.map(|feature| feature as usize);
        if with_facet { [&pair[..1], &self.facets[b]] } else { [&self.edges[a], &self.edges[b]] }
    }

    /// The facets that have a point as a corner, ascending.
    pub fn facets_around(&self, point: u32) -> &[u32] {
        &self.around[self.ring[point as usize] as usize..self.ring[point as usize + 1] as usize]
    }

    /// Whether a point is on a closed boundary, and on nothing else.
    pub fn is_closed(&self, point: u32) -> bool {
        let around = self.facets_around(point);
        !around.is_empty() && around.iter().all(|facet| self.closed[*facet as usize])
    }

    /// The carrier of a point; `None` if it is a node.
    #[inline]
    pub fn carrier_of(&self, point: u32) -> Option<&Carrier> {
        self.carried.binary_search(&point).ok().map(|k| &self.carriers[k])
    }

    /// The points that nodes carry, ascending.
    pub fn carried(&self) -> impl Iterator<Item = (usize, &Carrier)> {
        self.carried.iter().map(|p| *p as usize).zip(&self.carriers)
    }

    /// Whether nodes carry any of the given points.
    #[inline]
    pub(crate) fn carries_any(&self, points: &[u32]) -> bool {
        !self.carried.is_empty() && points.iter().any(|p| self.carried.binary_search(p).is_ok())
    }

    /// Calls `visit` with the independent points that determine the given point, and with their weights.
    #[inline]
    pub fn visit_nodes(&self, point: u32, mut visit: impl FnMut(u32, f64)) {
        match if self.carried.is_empty() { None } else { self.carrier_of(point) } {
            None => visit(point, 1.0),
            Some(Carrier { nodes, weights }) => {
                let own = nodes.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
                own.for_each(|(node, weight)| visit(*node, *weight));
            }
        }
    }

    /// Computes vectors of carried points from the vectors of the nodes: positions, velocities, displacements.
    pub fn follow(&self, vectors: &mut [[f64; D]]) {
        for (p, carrier) in self.carried() {
            let mut sum = [0.0; D];
            for (node, weight) in carrier.nodes.iter().zip(&carrier.weights) {
                for d in 0..D {
                    sum[d] += weight * vectors[*node as usize][d];
                }
            }
            vectors[p] = sum;
        }
    }

    /// Whether two features of one body share a point, or whether a node carries points of both.
    pub(crate) fn share(&self, a: &[u32], b: &[u32]) -> bool {
        if a.iter().any(|p| b.contains(p)) {
            return true;
        }
        if !self.carries_any(a) && !self.carries_any(b) {
            return false;
        }
        let mut found = false;
        for p in a {
            self.visit_nodes(*p, |own, _| {
                b.iter().for_each(|q| self.visit_nodes(*q, |other, _| found |= own == other))
            });
        }
        found
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        4 * (self.body.capacity() + D * self.facets.capacity() + 4 * self.edges.capacity())
            + self.closed.capacity()
            + 4 * (4 * self.starts.capacity() + self.ring.capacity() + self.around.capacity() + self.carried.capacity())
            + core::mem::size_of::<Carrier>() * self.carriers.capacity()
            + self
                .orders
                .iter()
                .map(|orders| size_of_val(orders) + orders.iter().map(|o| 4 * o.capacity()).sum::<usize>())
                .sum::<usize>()
    }
}
