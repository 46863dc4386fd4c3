//! The inside of a closed surface as tetrahedra with guaranteed angles.

use crate::geometry::{Point, dot, subtract, tetrahedron_volume};
use crate::lattice_bcc::{Key, Lattice};
use crate::skin::Inside;
use crate::{Mesh, MeshError, Must, Quantity};
use std::collections::BTreeMap;

/// The smallest angle between two faces of the tetrahedra of [`Mesh::tetrahedra_filling`] [°].
pub const SMALLEST_DIHEDRAL_ANGLE: f64 = 10.7;

/// The largest angle between two faces of the tetrahedra of [`Mesh::tetrahedra_filling`] [°].
pub const LARGEST_DIHEDRAL_ANGLE: f64 = 164.8;

/// A lattice point moves to the point at which the surface cuts one of its edges if that point is close enough: closer than the first fraction of a
/// long edge, or than the second fraction of a short edge.
///
/// Of the pairs on a grid with steps of 0.003 and 0.005, this one gives the largest minimum angle, 10.76°, with a maximum angle of 164.38°. The test
/// below measures both angles over all stencils, with cuts at and around these limits.
const WARP_LIMITS: [f64; 2] = [0.284, 0.400];

/// The number of halvings that locate the intersection of an edge with the surface, to within 10⁻¹² of the length of the edge.
const HALVINGS: u32 = 40;

/// The side of the surface on which a lattice point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Outside,
    On,
    Inside,
}

/// A corner of a tetrahedron: a lattice point, or a point at which the surface cuts an edge. Such a cut is identified by the sum of both ends of the
/// edge, which is unique.
type Corner = [i32; 3];

impl Mesh<3> {
    /// The inside of this closed surface as tetrahedra without sharp or flat angles, whose boundary follows the surface.
    ///
    /// The nodes are a body-centred cubic lattice of cubes of side `spacing` [m]. If the surface cuts an edge of the lattice close to an end, this
    /// end moves to the cut; otherwise the cut becomes a node. All angles between faces are between [`SMALLEST_DIHEDRAL_ANGLE`] and
    /// [`LARGEST_DIHEDRAL_ANGLE`] for any surface. All boundary nodes are on the surface. Sharp edges and corners of the surface, however, are cut
    /// off within a spacing, and parts thinner than a spacing may be lost: compare the volumes. If parts of the body would touch only along an edge,
    /// the tetrahedra of the smaller part at that edge are removed.
    ///
    /// # Errors
    /// The errors of [`Mesh::components`]; [`MeshError::Size`] for a spacing that is not positive, or so large that nothing remains;
    /// [`MeshError::Torn`] if the filling has more or fewer pieces than the surface; [`MeshError::TooManyNodes`].
    ///
    /// # Source
    /// F. Labelle, J. R. Shewchuk, "Isosurface stuffing: fast tetrahedral meshes with good dihedral angles", ACM Trans. Graphics 26 (2007), the
    /// uniform variant (table 1 has the same bounds). The stencils of this method are cut here by one rule; see `Stuffing::diagonal`.
    pub fn tetrahedra_filling(&self, spacing: f64) -> Result<Mesh<3>, MeshError> {
        let lattice = Lattice::around(self, spacing)?;
        let inside = Inside::of(self)?;
        let mut stuffing = Stuffing::new(&lattice, |point| inside.contains(point));
        stuffing.find_cuts(|point| inside.contains(point));
        stuffing.warp();
        let mut tetrahedra = stuffing.tetrahedra();
        while stuffing.part_at_edges(&mut tetrahedra) {}
        if tetrahedra.is_empty() {
            return Err(MeshError::Size { what: Quantity::Spacing, value: spacing, must: Must::BelowBody });
        }

        // Nodes in the order of the lattice, with z varying slowest.
        let mut corners: Vec<Corner> = tetrahedra.iter().flatten().copied().collect();
        let order = |corner: &Corner| (corner[2], corner[1], corner[0]);
        corners.sort_unstable_by_key(order);
        corners.dedup();
        let number = |corner: &Corner| corners.binary_search_by_key(&order(corner), order).unwrap_or(0) as u32;
        let mut mesh =
            Mesh::<3> { positions: corners.iter().map(|c| stuffing.position(*c)).collect(), ..Mesh::default() };
        mesh.cells.tetrahedra = tetrahedra.iter().map(|corners| corners.map(|corner| number(&corner))).collect();
        mesh.facets = mesh.facets_from_cells()?;
        let parts = self.components()?.iter().filter(|component| component.signed_volume > 0.0).count();
        let pieces = pieces(&mesh);
        if pieces == parts { Ok(mesh) } else { Err(MeshError::Torn { spacing, pieces, parts }) }
    }
}

/// The number of pieces. The tetrahedra of different pieces share no node.
fn pieces(mesh: &Mesh<3>) -> usize {
    let mut parent: Vec<u32> = (0..mesh.nodes() as u32).collect();
    let root = |parent: &mut Vec<u32>, mut node: u32| {
        while parent[node as usize] != node {
            parent[node as usize] = parent[parent[node as usize] as usize];
            node = parent[node as usize];
        }
        node
    };
    let mut pieces = mesh.nodes();
    for &[first, ref others @ ..] in &mesh.cells.tetrahedra {
        for &other in others {
            let (a, b) = (root(&mut parent, first), root(&mut parent, other));
            if a != b {
                parent[usize::max(a as usize, b as usize)] = u32::min(a, b);
                pieces -= 1;
            }
        }
    }
    pieces
}

struct Stuffing<'a> {
    lattice: &'a Lattice,
    /// Sides of corners, then of centres of cubes; x varies fastest.
    sides: Vec<Side>,
    /// Lattice points that have moved to the surface.
    moved: BTreeMap<Key, Point>,
    /// The intersections of the surface with edges from a point inside to one outside, by the sum of their ends.
    cuts: BTreeMap<Corner, Point>,
}

/// The 14 neighbours of a lattice point: along the axes (long edges), and along diagonals (short ones).
fn neighbours(key: Key) -> impl Iterator<Item = (Key, usize)> {
    let long = (0..6).map(move |k| {
        let mut other = key;
        other[k / 2] += if k % 2 == 0 { -2 } else { 2 };
        (other, 0)
    });
    let short = (0..8).map(move |k: i32| (core::array::from_fn(|d| key[d] + if k >> d & 1 == 0 { -1 } else { 1 }), 1));
    long.chain(short)
}

fn sum(a: Key, b: Key) -> Corner {
    core::array::from_fn(|d| a[d] + b[d])
}

fn distance_square(a: Point, b: Point) -> f64 {
    let offset = subtract(a, b);
    dot(offset, offset)
}

impl<'a> Stuffing<'a> {
    fn new(lattice: &'a Lattice, mut inside: impl FnMut(Point) -> bool) -> Stuffing<'a> {
        let mut stuffing = Stuffing { lattice, sides: Vec::new(), moved: BTreeMap::new(), cuts: BTreeMap::new() };
        for (counts, shift) in [(lattice.counts.map(|n| n + 1), 0), (lattice.counts, 1)] {
            for z in 0..counts[2] {
                for y in 0..counts[1] {
                    for x in 0..counts[0] {
                        let point = lattice.at([2 * x + shift, 2 * y + shift, 2 * z + shift]);
                        stuffing.sides.push(if inside(point) { Side::Inside } else { Side::Outside });
                    }
                }
            }
        }
        stuffing
    }

    /// The index of a lattice point in `sides`; none outside the lattice.
    fn index(&self, key: Key) -> Option<usize> {
        let shift = key[0].rem_euclid(2);
        let counts = self.lattice.counts.map(|n| n + 1 - shift);
        let at = key.map(|x| (x - shift) / 2);
        if (0..3).any(|d| key[d] < 0 || at[d] >= counts[d]) {
            return None;
        }
        let own = (at[0] as usize) + counts[0] as usize * (at[1] as usize + counts[1] as usize * at[2] as usize);
        let corners: usize = self.lattice.counts.iter().map(|n| *n as usize + 1).product();
        Some(if shift == 0 { own } else { corners + own })
    }

    fn side(&self, key: Key) -> Side {
        self.index(key).map_or(Side::Outside, |index| self.sides[index])
    }

    /// All lattice points inside.
    fn inner(&self) -> Vec<Key> {
        let [x, y, z] = self.lattice.counts;
        let corners = (0..=z).flat_map(|k| (0..=y).flat_map(move |j| (0..=x).map(move |i| [2 * i, 2 * j, 2 * k])));
        corners.chain(self.lattice.centers()).filter(|key| self.side(*key) == Side::Inside).collect()
    }

    /// Finds the intersections of the surface with edges from a point inside to one outside.
    fn find_cuts(&mut self, mut inside: impl FnMut(Point) -> bool) {
        for key in self.inner() {
            for (other, _) in neighbours(key) {
                if self.side(other) == Side::Outside {
                    let cut = self.cut(key, other, &mut inside);
                    self.cuts.insert(sum(key, other), cut);
                }
            }
        }
    }

    fn cut(&self, inner: Key, outer: Key, inside: &mut impl FnMut(Point) -> bool) -> Point {
        let (mut near, mut far) = (self.lattice.at(inner), self.lattice.at(outer));
        for _ in 0..HALVINGS {
            let middle = core::array::from_fn(|d| 0.5 * (near[d] + far[d]));
            if inside(middle) {
                near = middle;
            } else {
                far = middle;
            }
        }
        core::array::from_fn(|d| 0.5 * (near[d] + far[d]))
    }

    /// Moves lattice points that are close to a cut of one of their edges to the nearest cut; the other cuts of a moved point are removed.
    fn warp(&mut self) {
        let mut ends: Vec<Key> = Vec::new();
        for key in self.inner() {
            let outer =
                neighbours(key).map(|(other, _)| other).filter(|other| self.cuts.contains_key(&sum(key, *other)));
            let before = ends.len();
            ends.extend(outer);
            if ends.len() > before {
                ends.push(key);
            }
        }
        ends.sort_unstable_by_key(|[x, y, z]| (*z, *y, *x));
        ends.dedup();
        for key in ends {
            let here = self.lattice.at(key);
            let mut nearest: Option<(f64, Point)> = None;
            for (other, short) in neighbours(key) {
                let Some(cut) = self.cuts.get(&sum(key, other)) else { continue };
                let (square, whole) = (distance_square(here, *cut), distance_square(here, self.lattice.at(other)));
                let close = square < WARP_LIMITS[short] * WARP_LIMITS[short] * whole;
                if close && nearest.is_none_or(|(least, _)| square < least) {
                    nearest = Some((square, *cut));
                }
            }
            if let (Some((_, cut)), Some(index)) = (nearest, self.index(key)) {
                self.sides[index] = Side::On;
                self.moved.insert(key, cut);
                for (other, _) in neighbours(key) {
                    self.cuts.remove(&sum(key, other));
                }
            }
        }
    }

    /// The position of a corner.
    fn position(&self, corner: Corner) -> Point {
        if let Some(cut) = self.cuts.get(&corner) {
            return *cut;
        }
        let key = corner.map(|x| x / 2);
        self.moved.get(&key).copied().unwrap_or_else(|| self.lattice.at(key))
    }

    /// The inside part of every tetrahedron of the lattice, as tetrahedra of positive volume.
    fn tetrahedra(&self) -> Vec<[Corner; 4]> {
        let mut out = Vec::new();
        for center in self.lattice.centers() {
            for axis in 0..3 {
                if center[axis] + 2 > 2 * self.lattice.counts[axis] {
                    continue;
                }
                for tetrahedron in self.lattice.beyond(center, axis) {
                    self.part(tetrahedron, &mut out);
                }
            }
        }
        for corners in &mut out {
            let [a, b, c, d] = corners.map(|corner| self.position(corner));
            if tetrahedron_volume(a, b, c, d) < 0.0 {
                corners.swap(2, 3);
            }
        }
        out
    }

    /// If tetrahedra at an edge form several fans that share no face with one another, removes all fans but the largest; returns whether it removed
    /// any.
    fn part_at_edges(&self, tetrahedra: &mut Vec<[Corner; 4]>) -> bool {
        let crowded = self.crowded_edges(tetrahedra);
        let mut gone = vec![false; tetrahedra.len()];
        for edge in &crowded {
            let at: Vec<usize> = (0..tetrahedra.len())
                .filter(|k| !gone[*k] && edge.iter().all(|corner| tetrahedra[*k].contains(corner)))
                .collect();
            // Fans: tetrahedra that share a third corner share a face.
            let mut fan: Vec<usize> = (0..at.len()).collect();
            for i in 0..at.len() {
                for j in 0..i {
                    let shared = tetrahedra[at[i]].iter().filter(|corner| tetrahedra[at[j]].contains(corner)).count();
                    if shared == 3 && fan[i] != fan[j] {
                        let (from, to) = (usize::max(fan[i], fan[j]), usize::min(fan[i], fan[j]));
                        fan.iter_mut().filter(|own| **own == from).for_each(|own| *own = to);
                    }
                }
            }
            let volume = |of: usize| -> f64 {
                let own = at.iter().zip(&fan).filter(|(_, fan)| **fan == of);
                own.map(|(k, _)| {
                    let [a, b, c, d] = tetrahedra[*k].map(|corner| self.position(corner));
                    tetrahedron_volume(a, b, c, d)
                })
                .sum()
            };
            let mut largest = 0;
            for of in 1..at.len() {
                if volume(of) > volume(largest) {
                    largest = of;
                }
            }
            at.iter().zip(&fan).filter(|(_, fan)| **fan != largest).for_each(|(k, _)| gone[*k] = true);
        }
        let mut kept = gone.iter();
        tetrahedra.retain(|_| !kept.next().is_some_and(|gone| *gone));
        !crowded.is_empty()
    }

    /// Edges at which more than two triangles of the boundary meet.
    fn crowded_edges(&self, tetrahedra: &[[Corner; 4]]) -> Vec<[Corner; 2]> {
        let mut faces: Vec<[Corner; 3]> = Vec::with_capacity(4 * tetrahedra.len());
        for tetrahedron in tetrahedra {
            for face in crate::geometry::TETRAHEDRON_FACES {
                let mut corners = face.map(|k| tetrahedron[k]);
                corners.sort_unstable();
                faces.push(corners);
            }
        }
        faces.sort_unstable();
        let outer = faces.chunk_by(|p, q| p == q).filter(|group| group.len() == 1).map(|group| group[0]);
        let mut edges: Vec<[Corner; 2]> = outer.flat_map(|[a, b, c]| [[a, b], [b, c], [a, c]]).collect();
        edges.sort_unstable();
        edges.chunk_by(|p, q| p == q).filter(|group| group.len() > 2).map(|group| group[0]).collect()
    }

    /// The inside part of one tetrahedron: the whole, or a part cut off at the edges that the surface cuts.
    fn part(&self, keys: [Key; 4], out: &mut Vec<[Corner; 4]>) {
        let of = |side: Side| keys.into_iter().filter(|key| self.side(*key) == side).collect::<Vec<Key>>();
        let (inner, on, outer) = (of(Side::Inside), of(Side::On), of(Side::Outside));
        let own = |key: Key| sum(key, key);
        match (&inner[..], &on[..], &outer[..]) {
            ([], ..) => {}
            (_, _, []) => out.push(keys.map(own)),
            // A single corner: its edges end at the surface.
            (&[p], on, outer) => {
                let ends: Vec<Corner> =
                    on.iter().map(|key| own(*key)).chain(outer.iter().map(|key| sum(p, *key))).collect();
                out.push([own(p), ends[0], ends[1], ends[2]]);
            }
            // A pyramid over the quadrilateral that the surface leaves of a face.
            (&[p, q], &[apex], &[m]) => {
                let (a, b, c, d) = (own(p), own(q), sum(q, m), sum(p, m));
                if self.diagonal(p, q, m) {
                    out.extend([[a, b, c, own(apex)], [a, c, d, own(apex)]])
                } else {
                    out.extend([[a, b, d, own(apex)], [b, c, d, own(apex)]])
                }
            }
            // A wedge: ends p and q, each with two cuts.
            (&[p, q], [], &[m, n]) => {
                let ends = [[own(p), sum(p, m), sum(p, n)], [own(q), sum(q, m), sum(q, n)]];
                let (first, last) = (self.diagonal(p, q, m), !self.diagonal(p, q, n));
                // The third side is on the surface and is not shared: use the shorter diagonal if both are possible.
                let [[_, a, b], [_, c, d]] = ends;
                let length = |p: Corner, q: Corner| distance_square(self.position(p), self.position(q));
                let free = if first == last { !first } else { length(a, d) <= length(b, c) };
                prism(ends, [first, free, last], out);
            }
            // A corner is cut off.
            (&[p, q, r], _, &[m]) => {
                let ends = [[own(p), own(q), own(r)], [sum(p, m), sum(q, m), sum(r, m)]];
                prism(ends, [self.diagonal(p, q, m), self.diagonal(q, r, m), self.diagonal(r, p, m)], out);
            }
            _ => {}
        }
    }

    /// Whether the diagonal of the quadrilateral p, q, cut of qm, cut of pm on a face of the lattice starts at p; otherwise it starts at q. Both
    /// tetrahedra at the face make the same choice.
    ///
    /// If pm or qm is a long edge, the diagonal ends at the cut on this edge. If both edges are short, the diagonal starts at the point, p or q, for
    /// which an even number of coordinates are greater than those of m. The diagonals of the two faces at p and q of a tetrahedron then start at
    /// different points (the parity rule of Labelle and Shewchuk).
    fn diagonal(&self, p: Key, q: Key, m: Key) -> bool {
        let long = |a: Key, b: Key| (a[0] - b[0]).rem_euclid(2) == 0;
        if long(p, m) {
            false
        } else if long(q, m) {
            true
        } else {
            (0..3).filter(|d| p[*d] > m[*d]).count().is_multiple_of(2)
        }
    }
}

/// A prism with ends a and b, cut into three tetrahedra. Its side k is cut from a\[k\] to b\[k + 1\] if `forward[k]` is true, and from a\[k + 1\] to
/// b\[k\] if it is false.
///
/// The diagonals of the three sides must not form a cycle.
fn prism(ends: [[Corner; 3]; 2], forward: [bool; 3], out: &mut Vec<[Corner; 4]>) {
    for end in 0..2 {
        for k in 0..3 {
            // Corner k of this end is between sides k and k − 1; check whether it is an end of both diagonals.
            let (own, other) = (ends[end], ends[1 - end]);
            let touches_next = forward[k] == (end == 0);
            let touches_last = forward[(k + 2) % 3] != (end == 0);
            if touches_next && touches_last {
                // Tetrahedra of this corner with the other end, and with both halves of the opposite side.
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                out.push([own[k], other[0], other[1], other[2]]);
                if forward[next] == (end == 0) {
                    out.extend([
                        [own[k], own[next], own[last], other[last]],
                        [own[k], own[next], other[last], other[next]],
                    ]);
                } else {
                    out.extend([
                        [own[k], own[next], own[last], other[next]],
                        [own[k], own[last], other[last], other[next]],
                    ]);
                }
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::dihedral_angles;

    /// Numbers of SplitMix64 in [0, 1).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
        }
    }

    /// The bounds follow from the stencils alone: they hold for any sides of lattice points, and for cuts anywhere on their edges, in particular
    /// close to the limits at which points move.
    #[test]
    fn angles_keep_their_bounds_for_any_sides_and_cuts() {
        let lattice = Lattice { counts: [4; 3], origin: [0.0; 3], spacing: 1.0 };
        let mut random = Random(1);
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0f64);
        for trial in 0..4000 {
            let share = [0.2, 0.5, 0.8][trial % 3];
            let margin = |point: Point| point.iter().all(|x| (0.75..3.25).contains(x));
            let mut stuffing = Stuffing::new(&lattice, |point| margin(point) && random.next() < share);
            for key in stuffing.inner() {
                for (other, short) in neighbours(key) {
                    if stuffing.side(other) == Side::Outside {
                        // Fractions at and around the thresholds, and anywhere.
                        let near = WARP_LIMITS[short];
                        let t = match (random.next() * 6.0) as u32 {
                            0 => near - 1e-9,
                            1 => near + 1e-9,
                            2 => 1.0 - near - 1e-9,
                            3 => 1.0 - near + 1e-9,
                            4 => 1e-9,
                            _ => random.next(),
                        };
                        let (p, q) = (lattice.at(key), lattice.at(other));
                        stuffing.cuts.insert(sum(key, other), core::array::from_fn(|d| p[d] + t * (q[d] - p[d])));
                    }
                }
            }
            stuffing.warp();
            for corners in stuffing.tetrahedra() {
                for angle in dihedral_angles(corners.map(|corner| stuffing.position(corner))) {
                    let degrees = angle * 180.0 / core::f64::consts::PI;
                    smallest = if degrees < smallest { degrees } else { smallest };
                    largest = if degrees > largest { degrees } else { largest };
                }
            }
        }
        assert!(smallest >= SMALLEST_DIHEDRAL_ANGLE && largest <= LARGEST_DIHEDRAL_ANGLE, "{smallest}° to {largest}°");
        // The bounds are nearly attained, so they could not be tighter.
        assert!(smallest < SMALLEST_DIHEDRAL_ANGLE + 0.5 && largest > LARGEST_DIHEDRAL_ANGLE - 1.0);
    }
}
