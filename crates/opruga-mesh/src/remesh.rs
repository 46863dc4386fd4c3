//! Remeshing of closed surfaces to nearly equilateral triangles of a given size.
//!
//! Each round consists of four operations: edges that are too long are split, edges that are too short are collapsed, edges are flipped to get six
//! triangles at every node, and nodes move within the surface to the mean of their neighbours and back onto the original surface. No operation opens
//! the surface, turns a triangle over, or merges two edges into one. If operations together make the surface cross itself, those around the crossing
//! are undone.

use crate::geometry::{cross, dot, norm, subtract};
use crate::mesh::{limit_nodes, positive};
use crate::nearest::Nearest;
use crate::{Mesh, MeshError, Quantity};
use std::collections::BTreeMap;

/// The number of rounds of the four operations.
const ROUNDS: usize = 6;
/// Edges longer than this times the target length are split.
const LONG: f64 = 4.0 / 3.0;
/// Edges shorter than this times the target length are collapsed.
const SHORT: f64 = 4.0 / 5.0;
/// Cosine of the angle between neighbouring normals below which their edge is sharp: 40°.
const SHARP: f64 = 0.766;
/// Cosine of the largest angle by which an operation may rotate a triangle: 60°.
const TURN: f64 = 0.5;

type Point = [f64; 3];
type Edge = [u32; 2];

fn edge(a: u32, b: u32) -> Edge {
    if a < b { [a, b] } else { [b, a] }
}

fn middle(a: Point, b: Point) -> Point {
    core::array::from_fn(|d| 0.5 * (a[d] + b[d]))
}

fn unit(v: Point) -> Option<Point> {
    let length = norm(v);
    (length > 0.0).then(|| v.map(|x| x / length))
}

/// A surface whose triangles are added and removed.
#[derive(Clone)]
struct Work {
    positions: Vec<Point>,
    /// The node groups to which each node belongs, by number.
    groups: Vec<Vec<u32>>,
    /// None if a triangle was removed.
    triangles: Vec<Option<[u32; 3]>>,
    /// The triangles at every node.
    fans: Vec<Vec<u32>>,
    /// Edges that are kept; their ends stay on them.
    sharp: BTreeMap<Edge, ()>,
    /// Nodes that are temporarily neither moved, added nor removed, because the surface crossed itself there; ascending.
    locked: Vec<u32>,
}

impl Mesh<3> {
    /// This closed surface with edges of about the given length [m]; if the shape permits, nearly all of them have 0.6 to 1.45 times this length.
    /// Edges between triangles that meet at more than 40° are kept, and their corners do not move. If this surface does not cross itself, the result
    /// does not either. Where the result would otherwise cross itself, its triangles remain smaller.
    ///
    /// Nodes are renumbered. A group keeps its old nodes; a new node belongs to it if both ends of the edge that it divides do.
    ///
    /// # Errors
    /// The errors of [`Mesh::components`] for surfaces that are not closed; [`MeshError::Size`] for a length that is not
    /// positive, [`MeshError::TooManyNodes`] for one that is too small.
    ///
    /// # Source
    /// M. Botsch, L. Kobbelt, "A remeshing approach to multiresolution modeling", Symposium on Geometry Processing (2004), section 4.
    pub fn remeshed(&self, length: f64) -> Result<Mesh<3>, MeshError> {
        positive(Quantity::LengthEdges, length)?;
        self.components()?;
        limit_nodes(self.remesh_estimate(length) as u64)?;
        let surface = Nearest::to(self);
        let mut work = Work::of(self);
        // A surface that already crosses itself may continue to do so.
        let guarded = work.crossing().is_empty();
        for _ in 0..ROUNDS {
            work.split(LONG * length);
            work.guard(guarded, |work| work.collapse(SHORT * length, LONG * length));
            work.guard(guarded, Work::flip);
            work.guard(guarded, |work| work.relax(&surface));
        }
        Ok(work.finish(self))
    }

    /// The approximate number of nodes of [`Mesh::remeshed`]: one for every two equilateral triangles.
    pub fn remesh_estimate(&self, length: f64) -> f64 {
        let mut area = 0.0;
        for facet in &self.facets {
            let [a, b, c] = facet.map(|node| self.positions[node as usize]);
            area += crate::geometry::triangle_area(a, b, c);
        }
        crate::mesh::estimated(1.155 * area / (length * length) + 4.0)
    }
}

impl Work {
    fn of(mesh: &Mesh<3>) -> Work {
        let mut groups = vec![Vec::new(); mesh.nodes()];
        for (number, nodes) in mesh.groups.values().enumerate() {
            nodes.iter().for_each(|node| groups[*node as usize].push(number as u32));
        }
        let mut fans = vec![Vec::new(); mesh.nodes()];
        for (number, facet) in mesh.facets.iter().enumerate() {
            facet.iter().for_each(|node| fans[*node as usize].push(number as u32));
        }
        let triangles = mesh.facets.iter().copied().map(Some).collect();
        let mut work = Work {
            positions: mesh.positions.clone(),
            groups,
            triangles,
            fans,
            sharp: BTreeMap::new(),
            locked: Vec::new(),
        };
        for edge in work.edges() {
            let normals = work.beside(edge).map(|[s, t]| [s, t].map(|k| work.normal_of(k).and_then(unit)));
            if let Some([Some(n), Some(m)]) = normals
                && dot(n, m) < SHARP
            {
                work.sharp.insert(edge, ());
            }
        }
        work
    }

    /// Applies operations that add no nodes, except those that make the surface cross itself. For this purpose, the operations are repeated with the
    /// nodes of crossing triangles locked, then with the nodes around them locked too, until nothing crosses.
    fn guard(&mut self, guarded: bool, moves: impl Fn(&mut Work)) {
        let before = guarded.then(|| self.clone());
        moves(self);
        let Some(before) = before else { return };
        let mut locked: Vec<u32> = Vec::new();
        loop {
            let crossing = self.crossing();
            if crossing.is_empty() {
                break;
            }
            let known = locked.len();
            locked.extend(crossing);
            locked.sort_unstable();
            locked.dedup();
            if locked.len() == known {
                // The crossing triangles are already locked, so their surroundings must have moved.
                let around: Vec<u32> = locked.iter().flat_map(|node| before.neighbours(*node)).collect();
                locked.extend(around);
                locked.sort_unstable();
                locked.dedup();
                if locked.len() == known {
                    *self = before;
                    break;
                }
            }
            self.clone_from(&before);
            self.locked.clone_from(&locked);
            moves(self);
        }
        self.locked.clear();
    }

    /// Nodes of triangles that cross, touch or overlap others.
    fn crossing(&self) -> Vec<u32> {
        let facets = self.triangles.iter().copied().flatten().collect();
        let mesh = Mesh::<3> { positions: self.positions.clone(), facets, ..Mesh::default() };
        let pairs = mesh.crossing_facets().pairs;
        pairs.iter().flatten().flat_map(|facet| mesh.facets[*facet as usize]).collect()
    }

    fn is_locked(&self, node: u32) -> bool {
        self.locked.binary_search(&node).is_ok()
    }

    fn at(&self, node: u32) -> Point {
        self.positions[node as usize]
    }

    fn length(&self, [a, b]: Edge) -> f64 {
        norm(subtract(self.at(a), self.at(b)))
    }

    /// All edges, ascending.
    fn edges(&self) -> Vec<Edge> {
        let sides = self.triangles.iter().flatten().flat_map(|[a, b, c]| [edge(*a, *b), edge(*b, *c), edge(*c, *a)]);
        let mut edges: Vec<Edge> = sides.collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The two triangles at an edge: the one that runs from its first node to its second, then the other.
    fn beside(&self, [a, b]: Edge) -> Option<[u32; 2]> {
        let mut found = [None; 2];
        for &triangle in &self.fans[a as usize] {
            let Some(corners) = self.triangles[triangle as usize] else { continue };
            let Some(index) = corners.iter().position(|node| *node == a) else { continue };
            if corners[(index + 1) % 3] == b {
                found[0] = Some(triangle);
            } else if corners[(index + 2) % 3] == b {
                found[1] = Some(triangle);
            }
        }
        Some([found[0]?, found[1]?])
    }

    /// The corner of a triangle opposite an edge.
    fn across(&self, triangle: u32, edge: Edge) -> Option<u32> {
        self.triangles[triangle as usize]?.into_iter().find(|node| !edge.contains(node))
    }

    fn normal(&self, [a, b, c]: [u32; 3]) -> Point {
        cross(subtract(self.at(b), self.at(a)), subtract(self.at(c), self.at(a)))
    }

    fn normal_of(&self, triangle: u32) -> Option<Point> {
        self.triangles[triangle as usize].map(|corners| self.normal(corners))
    }

    /// Neighbours of a node, ascending.
    fn neighbours(&self, node: u32) -> Vec<u32> {
        let corners = self.fans[node as usize].iter().filter_map(|t| self.triangles[*t as usize]).flatten();
        let mut out: Vec<u32> = corners.filter(|other| *other != node).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The number of sharp edges at a node.
    fn sharpness(&self, node: u32) -> usize {
        self.neighbours(node).into_iter().filter(|other| self.sharp.contains_key(&edge(node, *other))).count()
    }

    fn add(&mut self, corners: [u32; 3]) {
        let number = self.triangles.len() as u32;
        self.triangles.push(Some(corners));
        corners.iter().for_each(|node| self.fans[*node as usize].push(number));
    }

    fn remove(&mut self, triangle: u32) {
        if let Some(corners) = self.triangles[triangle as usize].take() {
            corners.iter().for_each(|node| self.fans[*node as usize].retain(|t| *t != triangle));
        }
    }

    /// Splits edges longer than a length at their midpoints, the longest first.
    fn split(&mut self, length: f64) {
        loop {
            let mut long: Vec<Edge> = self.edges().into_iter().filter(|e| self.length(*e) > length).collect();
            if long.is_empty() {
                return;
            }
            long.sort_by(|e, f| self.length(*f).total_cmp(&self.length(*e)).then(e.cmp(f)));
            for [a, b] in long {
                let Some([s, t]) = self.beside([a, b]) else { continue };
                let (Some(c), Some(d)) = (self.across(s, [a, b]), self.across(t, [a, b])) else { continue };
                let new = self.positions.len() as u32;
                self.positions.push(middle(self.at(a), self.at(b)));
                self.fans.push(Vec::new());
                let both = self.groups[a as usize].iter().filter(|g| self.groups[b as usize].contains(g));
                self.groups.push(both.copied().collect());
                self.remove(s);
                self.remove(t);
                for corners in [[a, new, c], [new, b, c], [b, new, d], [new, a, d]] {
                    self.add(corners);
                }
                if self.sharp.remove(&[a, b]).is_some() {
                    self.sharp.insert(edge(a, new), ());
                    self.sharp.insert(edge(b, new), ());
                }
            }
        }
    }

    /// Collapses edges shorter than a length, if no edge becomes longer than another length.
    fn collapse(&mut self, short: f64, long: f64) {
        let mut edges: Vec<Edge> = self.edges().into_iter().filter(|e| self.length(*e) < short).collect();
        edges.sort_by(|e, f| self.length(*e).total_cmp(&self.length(*f)).then(e.cmp(f)));
        for [a, b] in edges {
            if self.beside([a, b]).is_none() || self.length([a, b]) >= short || self.is_locked(a) || self.is_locked(b) {
                continue;
            }
            // The node with more constraints stays in place.
            let bound = [self.sharpness(a), self.sharpness(b)];
            let (kept, gone, position) = match bound {
                [0, 0] => (a, b, middle(self.at(a), self.at(b))),
                [_, 0] => (a, b, self.at(a)),
                [0, _] => (b, a, self.at(b)),
                _ if !self.sharp.contains_key(&[a, b]) => continue,
                [_, 2] => (a, b, self.at(a)),
                [2, _] => (b, a, self.at(b)),
                _ => continue,
            };
            if self.may_merge(kept, gone, position, long) {
                self.merge(kept, gone, position);
            }
        }
    }

    /// Whether the surface stays valid if two neighbours become one node at a position.
    fn may_merge(&self, kept: u32, gone: u32, position: Point, long: f64) -> bool {
        let (around, other) = (self.neighbours(kept), self.neighbours(gone));
        let common: Vec<u32> = around.iter().copied().filter(|node| other.contains(node)).collect();
        // Their common neighbours are the opposite corners; each of these must keep at least four triangles.
        if common.len() != 2 || common.iter().any(|node| self.neighbours(*node).len() < 5) {
            return false;
        }
        let far = |node: &u32| norm(subtract(self.at(*node), position)) > long;
        if around.iter().chain(&other).filter(|node| **node != kept && **node != gone).any(far) {
            return false;
        }
        // A crease must hardly change its shape: one of its nodes may be removed only if it is nearly on a line with its neighbours on the crease.
        if self.sharpness(gone) == 2 {
            let along: Vec<u32> =
                other.iter().copied().filter(|node| self.sharp.contains_key(&edge(gone, *node))).collect();
            let [p, q] = along[..] else { return false };
            let (u, v) = (subtract(self.at(p), self.at(gone)), subtract(self.at(gone), self.at(q)));
            if !unit(u).zip(unit(v)).is_some_and(|(u, v)| dot(u, v) > 0.9) {
                return false;
            }
        }
        let sound = |node: u32, partner: u32| {
            self.fans[node as usize].iter().filter_map(|t| self.triangles[*t as usize]).all(|corners| {
                if corners.contains(&partner) {
                    return true;
                }
                let [p, q, r] = corners.map(|corner| if corner == node { position } else { self.at(corner) });
                let after = cross(subtract(q, p), subtract(r, p));
                let before = self.normal(corners);
                unit(before).zip(unit(after)).is_some_and(|(n, m)| dot(n, m) > TURN)
            })
        };
        sound(kept, gone) && sound(gone, kept)
    }

    fn merge(&mut self, kept: u32, gone: u32, position: Point) {
        self.positions[kept as usize] = position;
        let groups = std::mem::take(&mut self.groups[gone as usize]);
        self.groups[kept as usize].extend(groups);
        self.groups[kept as usize].sort_unstable();
        self.groups[kept as usize].dedup();
        for other in self.neighbours(gone) {
            if self.sharp.remove(&edge(gone, other)).is_some() && other != kept {
                self.sharp.insert(edge(kept, other), ());
            }
        }
        for triangle in self.fans[gone as usize].clone() {
            let Some(corners) = self.triangles[triangle as usize] else { continue };
            self.remove(triangle);
            if !corners.contains(&kept) {
                self.add(corners.map(|node| if node == gone { kept } else { node }));
            }
        }
    }

    /// Flips edges if this brings their four nodes closer to six neighbours each.
    fn flip(&mut self) {
        for [a, b] in self.edges() {
            if self.sharp.contains_key(&[a, b]) || self.is_locked(a) || self.is_locked(b) {
                continue;
            }
            let Some([s, t]) = self.beside([a, b]) else { continue };
            let (Some(c), Some(d)) = (self.across(s, [a, b]), self.across(t, [a, b])) else { continue };
            let count = |node: u32| self.fans[node as usize].len() as i64;
            let off = |node: u32, change: i64| (count(node) + change - 6).abs();
            let before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
            let after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
            if after >= before || count(a) < 5 || count(b) < 5 || self.neighbours(c).contains(&d) {
                continue;
            }
            let (old, new) = ([[a, b, c], [b, a, d]], [[c, d, b], [d, c, a]]);
            let normals = |triangles: [[u32; 3]; 2]| triangles.map(|corners| unit(self.normal(corners)));
            let ([Some(n), Some(m)], [Some(p), Some(q)]) = (normals(old), normals(new)) else { continue };
            let least =
                [dot(p, n), dot(p, m), dot(q, n), dot(q, m)].into_iter().fold(1.0, |l, x| if x < l { x } else { l });
            // The normals of thin triangles are dominated by rounding, and such triangles are no improvement.
            if least < SHARP || self.smallest_height(new) < 0.5 * self.smallest_height(old) {
                continue;
            }
            self.remove(s);
            self.remove(t);
            new.into_iter().for_each(|corners| self.add(corners));
        }
    }

    /// The ratio of twice the area to the square of the longest side, for the one of two triangles for which this ratio is smaller.
    fn smallest_height(&self, triangles: [[u32; 3]; 2]) -> f64 {
        let quality = |corners: [u32; 3]| {
            let [a, b, c] = corners;
            let mut longest = 0.0;
            for side in [[a, b], [b, c], [c, a]] {
                let length = self.length(side);
                longest = if length > longest { length } else { longest };
            }
            norm(self.normal(corners)) / (longest * longest)
        };
        let [one, two] = triangles.map(quality);
        if one < two { one } else { two }
    }

    /// Moves nodes that are not on creases to the mean of their neighbours, within the surface.
    fn relax(&mut self, surface: &Nearest) {
        for node in 0..self.positions.len() as u32 {
            let fan = self.fans[node as usize].clone();
            if fan.is_empty() || self.sharpness(node) > 0 || self.is_locked(node) {
                continue;
            }
            let around = self.neighbours(node);
            let share = 1.0 / around.len() as f64;
            let mean: Point = core::array::from_fn(|d| around.iter().map(|n| self.at(*n)[d]).sum::<f64>() * share);
            let position = surface.point(mean);
            let before: Vec<Option<Point>> = fan.iter().map(|t| self.normal_of(*t).and_then(unit)).collect();
            let old = std::mem::replace(&mut self.positions[node as usize], position);
            let turned = fan.iter().zip(before).any(|(t, before)| {
                let after = self.normal_of(*t).and_then(unit);
                !before.zip(after).is_some_and(|(n, m)| dot(n, m) > TURN)
            });
            if turned {
                self.positions[node as usize] = old;
            }
        }
    }

    /// The mesh of the remaining nodes and triangles, in their order.
    fn finish(self, given: &Mesh<3>) -> Mesh<3> {
        let mut numbers = vec![u32::MAX; self.positions.len()];
        let mut mesh = Mesh::<3>::default();
        let names: Vec<&String> = given.groups.keys().collect();
        names.iter().for_each(|name| _ = mesh.groups.insert((*name).clone(), Vec::new()));
        for (node, fan) in self.fans.iter().enumerate().filter(|(_, fan)| !fan.is_empty()) {
            debug_assert!(fan.len() > 2);
            numbers[node] = mesh.positions.len() as u32;
            for group in &self.groups[node] {
                if let Some(nodes) = mesh.groups.get_mut(names[*group as usize]) {
                    nodes.push(numbers[node]);
                }
            }
            mesh.positions.push(self.positions[node]);
        }
        mesh.facets = self.triangles.into_iter().flatten().map(|t| t.map(|node| numbers[node as usize])).collect();
        mesh
    }
}
