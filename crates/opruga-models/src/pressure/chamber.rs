//! The boundary of a chamber: its volume and the derivatives of the volume.

use super::curved::{CurvedSides, second_of_pair, second_of_triple};
use opruga_core::pair::{PairLaw, PairTable, PairTerm};
use opruga_core::potential::Sink;
use opruga_core::state::{Layout, OrderedSum, Parameter, View, load};
use opruga_core::tile::Tile;
use opruga_math::{Lane, Pack, Simd, WIDTH, Work, lanes};
use opruga_mesh::Adjacency;

/// A closed boundary.
#[derive(Debug)]
pub(super) enum Boundary {
    /// Oriented edges in the plane, with the interior to their left.
    Plane(PairTable),
    /// The ring of neighbours of every node of a triangulated surface, counter-clockwise when seen from outside.
    Space(NodeRings),
    /// Sides of cells with curved sides.
    Curved(CurvedSides),
}

/// Rings of neighbours, for eight nodes side by side.
#[derive(Debug)]
pub(super) struct NodeRings {
    pub(super) width: usize,
    /// The length of the longest ring of each pack of nodes. The slots after it are not used.
    pub(super) widths: Vec<u32>,
    /// `[node / 8][slot][node % 8]`. A shorter ring repeats its first neighbour, which then contributes nothing to the sums.
    pub(super) neighbour: Vec<u32>,
    /// `[node / 8][slot]`: whether the eight neighbours are consecutive, so that they can be read at once.
    pub(super) together: Vec<bool>,
    pub(super) facets: Vec<[u32; 3]>,
}

/// The pressure on edges in the plane: each end gets half of the outward normal times the gauge pressure.
#[derive(Clone, Copy)]
struct EdgePush<'a> {
    layout: Layout,
    /// The gauge pressure of each body, times depth.
    gauge: &'a [f64],
}

impl<const D: usize> PairLaw<D> for EdgePush<'_> {
    const DAMPED: bool = false;
    const UNIFORM: bool = true;
    const SECOND: f64 = 1.0;
    const AHEAD: bool = false;
    #[inline(always)]
    fn parameters(&self) -> [&Parameter; 3] {
        [&Parameter::NONE; 3]
    }
    #[inline(always)]
    fn uniform<P: Pack>(&self) -> [P; 2] {
        let gauge: P = of_bodies(self.layout, self.gauge);
        [gauge * P::splat(0.5), gauge * P::splat(-0.5)]
    }
    #[inline(always)]
    fn ahead<S: Lane>(&self, _d: [S; D]) -> S {
        S::zero()
    }
    #[inline(always)]
    fn force<S: Lane>(&self, [_, half, minus_half]: [S; 3], d: [S; D], _rate: [S; D], _: S) -> ([S; D], S) {
        let mut force = [S::zero(); D];
        force[0] = d[1] * minus_half;
        force[1] = d[0] * half;
        (force, S::zero())
    }
}

/// Twice the area of the triangle between an edge and the origin.
#[derive(Clone, Copy)]
struct TwiceArea<'a, P, const D: usize> {
    origin: [P; D],
    none: &'a Parameter,
}

impl<P: Pack, const D: usize> PairTerm<P, D> for TwiceArea<'_, P, D> {
    #[inline(always)]
    fn parameters(&self) -> [&Parameter; 3] {
        [self.none; 3]
    }
    #[inline(always)]
    fn of(&self, _none: [P; 3], a: [P; D], b: [P; D]) -> P {
        let (xa, ya) = (a[0] - self.origin[0], a[1] - self.origin[1]);
        let (xb, yb) = (b[0] - self.origin[0], b[1] - self.origin[1]);
        xa * yb - xb * ya
    }
}

/// Loads one number of each body. For one body a single number is read, because a register load of eight numbers that were just
/// written one by one would stall.
#[inline(always)]
fn of_bodies<P: Pack>(layout: Layout, numbers: &[f64]) -> P {
    match layout {
        Layout::Single => P::splat(numbers[0]),
        Layout::Batch => P::load(numbers),
    }
}

/// Gauge pressure times the area vectors of the nodes of a tile.
struct Push<'a, 't, const D: usize> {
    layout: Layout,
    gauge: &'a [f64],
    area: &'a [f64],
    tile: &'a mut Tile<'t, D>,
}
impl<const D: usize> Work for Push<'_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let (gauge, tile): (P, _) = (of_bodies(self.layout, self.gauge), self.tile);
        let index_count = self.area.len() / D;
        for index in tile.range.clone().step_by(WIDTH) {
            let k = index - tile.range.start;
            for d in 0..D {
                let force = P::load(&tile.force[d][k..]) + gauge * P::load(&self.area[d * index_count + index..]);
                force.store(&mut tile.force[d][k..]);
            }
        }
    }
}

/// The position of the first node of each body. This position is subtracted, so that no digits are lost far from the origin.
#[inline(always)]
fn origin<P: Pack, const D: usize>(view: &View<D>) -> [P; D] {
    match view.layout {
        Layout::Single => lanes!(P, d => P::splat(view.x[d][0])),
        Layout::Batch => load(&view.x, 0),
    }
}

impl Boundary {
    /// Computes the volume of each body (area in the plane). In space, also writes ∂V/∂x of every node to `area`, column by
    /// column.
    #[inline(always)]
    pub(super) fn volume<P: Pack, const D: usize>(&self, view: &View<D>, area: &mut [f64]) -> P {
        let origin = origin::<P, D>(view);
        match self {
            Boundary::Plane(edges) => {
                let twice = edges.sum::<P, _, D>(view, TwiceArea { origin, none: &Parameter::NONE });
                twice * P::splat(0.5)
            }
            Boundary::Space(rings) => rings.volume::<P, D>(view, &origin, area),
            Boundary::Curved(sides) => {
                area.fill(0.0);
                let mut volumes = [0.0; WIDTH];
                for (body, volume) in volumes.iter_mut().enumerate().take(view.layout.stride()) {
                    *volume = sides.volume_of(view, body, area);
                }
                P::load(&volumes)
            }
        }
    }

    /// Adds gauge pressure times ∂V/∂x to the forces on the nodes of a tile.
    pub(super) fn add_force<const D: usize>(
        &self,
        simd: Simd,
        view: &View<D>,
        gauge: &[f64],
        area: &[f64],
        tile: &mut Tile<D>,
    ) {
        match self {
            Boundary::Plane(edges) => edges.add_force(simd, EdgePush { layout: view.layout, gauge }, view, tile),
            Boundary::Space(_) | Boundary::Curved(_) => simd.run(Push { layout: view.layout, gauge, area, tile }),
        }
    }

    /// ∂V/∂x of every node of the boundary of one body (per depth in the plane), index by index.
    pub(super) fn slope<const D: usize>(&self, view: &View<D>, body: usize) -> Vec<(usize, [f64; D])> {
        let mut slope: std::collections::BTreeMap<usize, [f64; D]> = std::collections::BTreeMap::new();
        let at = |node: u32| view.layout.index(node as usize, body);
        match self {
            Boundary::Plane(edges) => {
                for &[a, b] in edges.pairs() {
                    let (xa, xb) = (view.position(at(a)), view.position(at(b)));
                    for node in [a, b] {
                        let entry = slope.entry(at(node)).or_insert([0.0; D]);
                        entry[0] += 0.5 * (xb[1] - xa[1]);
                        entry[1] -= 0.5 * (xb[0] - xa[0]);
                    }
                }
            }
            Boundary::Curved(sides) => {
                sides.volume(
                    |node| view.position(at(node)),
                    |node, by| {
                        let entry = slope.entry(at(node)).or_insert([0.0; D]);
                        for d in 0..D {
                            entry[d] += by[d];
                        }
                    },
                );
            }
            Boundary::Space(rings) => {
                for facet in &rings.facets {
                    let [a, b, c] = facet.map(|n| view.position(at(n)));
                    for (node, [p, q]) in facet.iter().zip([[b, c], [c, a], [a, b]]) {
                        let entry = slope.entry(at(*node)).or_insert([0.0; D]);
                        for d in 0..3 {
                            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
                            entry[d] += (p[e] * q[f] - p[f] * q[e]) / 6.0;
                        }
                    }
                }
            }
        }
        slope.into_iter().collect()
    }

    /// Delivers `factor` times ∂²V/∂x∂x of one body (per depth in the plane).
    pub(super) fn second_derivatives<const D: usize>(
        &self,
        view: &View<D>,
        body: usize,
        factor: f64,
        sink: &mut dyn Sink<D>,
    ) {
        let at = |node: u32| view.layout.index(node as usize, body);
        match self {
            Boundary::Plane(edges) => edges.pairs().iter().for_each(|pair| second_of_pair(pair.map(at), factor, sink)),
            Boundary::Space(rings) => {
                rings.facets.iter().for_each(|facet| second_of_triple(view, facet.map(at), factor, sink));
            }
            Boundary::Curved(sides) => {
                for (nodes, weight) in &sides.terms {
                    if D == 2 {
                        second_of_pair([at(nodes[0]), at(nodes[1])], weight * factor, sink);
                    } else {
                        second_of_triple(view, nodes.map(at), weight * factor, sink);
                    }
                }
            }
        }
    }

    /// Visits the nodes of every facet.
    pub(super) fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        match self {
            Boundary::Plane(edges) => edges.pairs().iter().for_each(|edge| visit(edge)),
            Boundary::Space(rings) => rings.facets.iter().for_each(|facet| visit(facet)),
            Boundary::Curved(sides) => sides.terms.iter().for_each(|(nodes, _)| visit(nodes)),
        }
    }

    /// The nodes of the boundary. A node on several facets may be repeated.
    pub(super) fn nodes(&self) -> &[u32] {
        match self {
            Boundary::Plane(edges) => edges.pairs().as_flattened(),
            Boundary::Space(rings) => rings.facets.as_flattened(),
            Boundary::Curved(sides) => &sides.nodes,
        }
    }

    /// The length of the scratch for the area vectors.
    pub(super) fn area_len<const D: usize>(&self, layout: Layout, nodes: usize) -> usize {
        match self {
            Boundary::Plane(_) => 0,
            Boundary::Space(_) | Boundary::Curved(_) => D * layout.index_count(nodes),
        }
    }

    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        match self {
            Boundary::Plane(edges) => edges.heap_bytes(),
            Boundary::Space(rings) => {
                (rings.neighbour.capacity() + rings.widths.capacity()) * 4
                    + rings.together.capacity()
                    + rings.facets.capacity() * 12
            }
            Boundary::Curved(sides) => {
                sides.terms.capacity() * size_of::<([u32; 3], f64)>() + sides.nodes.capacity() * size_of::<u32>()
            }
        }
    }
}

impl NodeRings {
    /// Lays out the rings of neighbours. Nodes that are not on the boundary have an empty ring.
    pub(super) fn new(rings: &Adjacency, facets: Vec<[u32; 3]>) -> NodeRings {
        let nodes = rings.nodes();
        let width = (0..nodes as u32).map(|n| rings.of(n).len()).max().unwrap_or(0);
        let packs = nodes.div_ceil(WIDTH);
        let mut neighbour = vec![0; packs * width * WIDTH];
        for node in 0..packs * WIDTH {
            let ring = if node < nodes { rings.of(node as u32) } else { &[] };
            for slot in 0..width {
                let at = (node / WIDTH * width + slot) * WIDTH + node % WIDTH;
                neighbour[at] = ring.get(slot).or(ring.first()).copied().unwrap_or(0);
            }
        }
        let follow = |indices: &[u32]| indices.windows(2).all(|pair| pair[1] == pair[0] + 1);
        let together = neighbour.chunks(WIDTH).map(follow).collect();
        let longest = |pack: usize| {
            let nodes = pack * WIDTH..nodes.min((pack + 1) * WIDTH);
            nodes.map(|node| rings.of(node as u32).len()).max().unwrap_or(0) as u32
        };
        NodeRings { width, widths: (0..packs).map(longest).collect(), neighbour, together, facets }
    }

    /// V = Σ xᵢ·∂V/∂xᵢ / 3 with ∂V/∂xᵢ = ⅙ Σ x_k × x_{k+1} around the ring of node i.
    #[inline(always)]
    fn volume<P: Pack, const D: usize>(&self, view: &View<D>, origin: &[P; D], area: &mut [f64]) -> P {
        let index_count = view.layout.index_count(view.nodes);
        let end = view.nodes * view.layout.stride();
        let mut sum = OrderedSum::<P>::new(view.layout);
        let sixth = P::splat(1.0 / 6.0);
        for index in (0..index_count).step_by(WIDTH) {
            let mut total = [P::zero(); 3];
            let first = self.neighbour_position::<P, D>(view, origin, index, 0);
            let mut previous = first;
            let pack = index / WIDTH;
            let width = self.widths[if view.layout == Layout::Single { pack } else { pack / WIDTH }] as usize;
            for slot in 1..=width {
                let next =
                    if slot == width { first } else { self.neighbour_position::<P, D>(view, origin, index, slot) };
                total[0] += previous[1] * next[2] - previous[2] * next[1];
                total[1] += previous[2] * next[0] - previous[0] * next[2];
                total[2] += previous[0] * next[1] - previous[1] * next[0];
                previous = next;
            }
            let mut product = P::zero();
            for d in 0..3 {
                let vector = total[d] * sixth;
                vector.store(&mut area[d * index_count + index..]);
                product += vector * (P::load(&view.x[d][index..]) - origin[d]);
            }
            sum.add(index, end, product);
        }
        sum.total() * P::splat(1.0 / 3.0)
    }

    #[inline(always)]
    fn neighbour_position<P: Pack, const D: usize>(
        &self,
        view: &View<D>,
        origin: &[P; D],
        index: usize,
        slot: usize,
    ) -> [P; 3] {
        let mut out = [P::zero(); 3];
        match view.layout {
            Layout::Single => {
                let at = (index / WIDTH * self.width + slot) * WIDTH;
                let neighbours = &self.neighbour[at..at + WIDTH];
                if self.together[at / WIDTH] {
                    for d in 0..3 {
                        out[d] = P::load(&view.x[d][neighbours[0] as usize..]) - origin[d];
                    }
                } else {
                    for d in 0..3 {
                        out[d] = P::gather(view.x[d], neighbours) - origin[d];
                    }
                }
            }
            Layout::Batch => {
                let node = index / WIDTH;
                let at = (node / WIDTH * self.width + slot) * WIDTH + node % WIDTH;
                let from = self.neighbour[at] as usize * WIDTH;
                for d in 0..3 {
                    out[d] = P::load(&view.x[d][from..]) - origin[d];
                }
            }
        }
        out
    }
}
