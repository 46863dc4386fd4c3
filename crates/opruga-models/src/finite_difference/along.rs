//! The forces of a curve in one walk along it, for nodes that are numbered along the curve.
//!
//! Stretch and bending cause a force N in every edge, which follows from g = (x₊ − x)/L and ∂U/∂g of the edge. The force on a
//! node is N of the edge after it minus N of the edge before it:
//!
//! ```text
//!   ── i−1 ──Nᵢ₋₁── i ──Nᵢ── i+1 ──        Fᵢ = Nᵢ − Nᵢ₋₁,  Nᵢ = EA ε g + (∂U/∂b of the bend at i + ∂U/∂a of that at i + 1)/L
//! ```
//!
//! Every node is computed once, eight nodes at a time. The neighbours of a node are in the registers, so no index is needed.
//! The edge that closes a ring is computed separately. The forces equal those of the stencils in [`super::curve`] up to rounding.
//! Energy and Hessian come from the stencils.

use crate::vectors::{cross, dot, in_space, inverse};
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::tile::Tile;
use opruga_math::{Lane, Pack, Register, RepeatStrip, Simd, Strip, StripMut, WIDTH, Work, lanes};

/// The data of a node and the edge after it: see [`Along::numbers`].
pub(super) const NUMBERS: usize = 6;
/// The numbers are: 1/L [1/m] of the edge; for the bend, the share of the previous edge in the tangent, 1/ℓ [1/m] and B₀ [1/m];
/// for damping, L and ℓ [m]. A missing edge has 1/L = 0; a missing bend has 1/ℓ = B₀ = 0.
const INVERSE: usize = 0;
const SHARE: usize = 1;
const PER_MEAN: usize = 2;
const REST: usize = 3;
const LENGTH: usize = 4;
const MEAN: usize = 5;

/// The curve of one body, or of eight identical ones.
#[derive(Debug)]
pub(super) struct Along {
    layout: Layout,
    nodes: usize,
    /// The data of every node, by its index.
    numbers: [Parameter; NUMBERS],
    /// EA [N], EI [N·m²] and the retardation time τ [s] of each body.
    section: [Parameter; 3],
    damped: bool,
    /// For a ring, the data of its last node with the closing edge, and of its first node.
    closing: Option<[[Parameter; NUMBERS]; 2]>,
}

/// The section of a curve, for eight lanes or fewer.
#[derive(Clone, Copy)]
struct Section<S> {
    stretch: S,
    bending: S,
    retardation: S,
}

/// The edges on both sides of a node: g of each edge, and its rate.
#[derive(Clone, Copy)]
struct Sides<S, const D: usize> {
    before: [S; D],
    behind: [S; D],
    rate_before: [S; D],
    rate_behind: [S; D],
}

/// The tension of an edge, EA (ε + τ dε/dt) g, and the power that damping dissipates [W].
#[inline(always)]
fn tension<S: Lane, const D: usize>(
    g: &[S; D],
    rate: &[S; D],
    of: &Section<S>,
    length: S,
    damped: bool,
) -> ([S; D], S) {
    let (mut square, mut change) = (S::zero(), S::zero());
    for d in 0..D {
        square += g[d] * g[d];
    }
    let mut strain = S::splat(0.5) * (square - S::one());
    let mut power = S::zero();
    if damped {
        for d in 0..D {
            change += g[d] * rate[d];
        }
        let viscous = of.retardation * change;
        power = of.stretch * viscous * change * length;
        strain += viscous;
    }
    let stress = of.stretch * strain;
    (lanes!(S, d => stress * g[d]), power)
}

/// ∂U/∂a and ∂U/∂b of the bend between two edges, with its damping, and the power that damping dissipates [W]. The formulas are
/// those of [`super::curve::Bend`].
#[inline(always)]
fn bend<S: Lane, const D: usize>(
    sides: &Sides<S, D>,
    numbers: &[S; NUMBERS],
    of: &Section<S>,
    damped: bool,
) -> ([[S; D]; 2], S) {
    let (of_a, of_b) = (numbers[SHARE], S::one() - numbers[SHARE]);
    let tangent = lanes!(S, d => of_a * sides.before[d] + of_b * sides.behind[d]);
    // The squared length of the tangent, and the length times its rate.
    let (mut square, mut longer) = (S::zero(), S::zero());
    for d in 0..D {
        square += tangent[d] * tangent[d];
        if damped {
            longer += tangent[d] * (of_a * sides.rate_before[d] + of_b * sides.rate_behind[d]);
        }
    }
    let mut out = [[S::zero(); D]; 2];
    let mut power = S::zero();
    let real = S::splat(f64::MIN_POSITIVE).less_or_equal(square);
    if D == 2 {
        let (a, b) = (&sides.before, &sides.behind);
        let per_length = S::one() / S::select(real, square, S::one()).sqrt();
        let per_square = S::select(real, per_length * per_length, S::zero());
        let normal = a[0] * b[1] - a[1] * b[0];
        let size = numbers[PER_MEAN] * per_length;
        let curvature = normal * size;
        let mut moment = curvature - numbers[REST];
        if damped {
            let (da, db) = (&sides.rate_before, &sides.rate_behind);
            let turn = (b[1] * da[0] - b[0] * da[1]) + (a[0] * db[1] - a[1] * db[0]);
            let rate = size * turn - curvature * per_square * longer;
            let viscous = of.retardation * rate;
            power = of.bending * viscous * rate * numbers[MEAN];
            moment += viscous;
        }
        let scale = of.bending * moment * per_length;
        let less = scale * normal * per_square;
        let along = lanes!(S, d => less * tangent[d]);
        let across = [[b[1], -b[0]], [-a[1], a[0]]];
        for d in 0..2 {
            out[0][d] = scale * across[0][d] - of_a * along[d];
            out[1][d] = scale * across[1][d] - of_b * along[d];
        }
        return (out, power);
    }
    let (a, b) = (in_space(&sides.before), in_space(&sides.behind));
    let per_square = S::select(real, S::one() / S::select(real, square, S::one()), S::zero());
    let normal = cross(&a, &b);
    let (by_a, by_b) = (cross(&b, &normal), cross(&normal, &a));
    let normal_square = dot(&normal, &normal);
    let curvature_square = numbers[PER_MEAN] * numbers[PER_MEAN] * per_square * normal_square;
    let positive = S::zero().less(curvature_square);
    let curvature = S::select(positive, S::select(positive, curvature_square, S::one()).sqrt(), S::zero());
    let per_curvature = inverse(curvature);
    // If the curve is straight at rest, the force is smooth in the straight state. If the curve is bent at rest, the force has
    // no direction in the straight state.
    let curved = S::zero().less(numbers[REST]);
    let mut part = S::one() - S::select(curved, numbers[REST] * per_curvature, S::zero());
    let scale = numbers[PER_MEAN] * per_square;
    let less = normal_square * per_square;
    if damped {
        let turn = dot(&by_a, &in_space(&sides.rate_before)) + dot(&by_b, &in_space(&sides.rate_behind));
        let rate = per_curvature * numbers[PER_MEAN] * scale * (turn - less * longer);
        let viscous = of.retardation * rate;
        power = of.bending * viscous * rate * numbers[MEAN];
        part += viscous * per_curvature;
    }
    let factor = of.bending * part * scale;
    for d in 0..D {
        out[0][d] = factor * (by_a[d] - less * of_a * tangent[d]);
        out[1][d] = factor * (by_b[d] - less * of_b * tangent[d]);
    }
    (out, power)
}

impl Along {
    /// Builds the walk if edges and bends follow the numbers of the nodes (open or closed), and returns `None` otherwise.
    /// `of_node` gives the six numbers of a node from the edges before and after it, one of which may be missing.
    pub(super) fn new(
        layout: Layout,
        nodes: usize,
        edges: &[[u32; 2]],
        section: [Parameter; 3],
        damped: bool,
        of_node: impl Fn(Option<[u32; 2]>, Option<[u32; 2]>) -> [f64; NUMBERS],
    ) -> Option<Along> {
        let last = nodes as u32 - 1;
        let closed = edges.len() == nodes;
        let in_order = |(k, edge): (usize, &[u32; 2])| {
            let k = k as u32;
            *edge == if k < last { [k, k + 1] } else { [last, 0] }
        };
        let follows = edges.len() + 1 >= nodes && edges.len() <= nodes && edges.iter().enumerate().all(in_order);
        if !follows || nodes < if closed { 3 } else { 2 } {
            return None;
        }
        let edge = |from: usize| (from + 1 < nodes).then_some([from as u32, from as u32 + 1]);
        let numbers_of = |node: usize| match node {
            0 => of_node(None, edge(0)),
            _ => of_node(edge(node - 1), edge(node)),
        };
        let each: Vec<[f64; NUMBERS]> = (0..nodes).map(numbers_of).collect();
        // The values read after the last node have no effect.
        let none = [0.0; NUMBERS];
        let packed = nodes.next_multiple_of(WIDTH) + 2 * WIDTH;
        let numbers = core::array::from_fn(|k| {
            Parameter::from_items(layout, packed, |node, _| each.get(node).unwrap_or(&none)[k])
        });
        let closing = closed.then(|| {
            let closing = Some([last, 0]);
            [of_node(edge(nodes - 2), closing), of_node(closing, edge(0))].map(|own| own.map(Parameter::uniform))
        });
        Some(Along { layout, nodes, numbers, section, damped, closing })
    }

    /// Adds the forces on the nodes of a tile.
    pub(super) fn add_force<const D: usize>(&self, simd: Simd, view: &View<D>, tile: &mut Tile<D>) {
        match (self.layout, self.damped) {
            (Layout::Single, false) => simd.run(Force::<D, false, false> { along: self, view, tile }),
            (Layout::Single, true) => simd.run(Force::<D, false, true> { along: self, view, tile }),
            (Layout::Batch, false) => simd.run(Force::<D, true, false> { along: self, view, tile }),
            (Layout::Batch, true) => simd.run(Force::<D, true, true> { along: self, view, tile }),
        }
    }
    pub(super) fn heap_bytes(&self) -> usize {
        self.numbers.iter().map(Parameter::heap_bytes).sum()
    }
}

struct Force<'a, 'b, 'c, const D: usize, const BATCH: bool, const DAMPED: bool> {
    along: &'a Along,
    view: &'a View<'a, D>,
    tile: &'b mut Tile<'c, D>,
}
impl<const D: usize, const BATCH: bool, const DAMPED: bool> Work for Force<'_, '_, '_, D, BATCH, DAMPED> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Force { along, view, tile } = self;
        let mut power = P::load(tile.power);
        walk::<P, D, BATCH, DAMPED>(along, view, tile, &mut power);
        if along.closing.is_some() {
            close::<P, D, BATCH, DAMPED>(along, view, tile, &mut power);
        }
        power.store(tile.power);
    }
}

/// The results of the previous nodes that the next nodes need: g of their edges, its rate, 1/L, the known part of N, and N of the
/// edges before them.
///
/// For bodies side by side, each result is a pack with the numbers of the previous node of each body. For one body, each result
/// is the previous register, stored in the first part of each pack.
struct Walker<'a, P, const D: usize> {
    x: Strip<'a, D>,
    v: Strip<'a, D>,
    numbers: [RepeatStrip<'a>; NUMBERS],
    section: Section<P>,
    /// The last index from which a pack can be read.
    end: usize,
    g: [P; D],
    rate: [P; D],
    inverse: P,
    edge: [P; D],
    before: [P; D],
}

/// The numbers of the previous node.
#[inline(always)]
fn back<R: Register, const BATCH: bool>(now: R, previous: R) -> R {
    if BATCH { previous } else { now.after(previous) }
}

impl<P: Pack, const D: usize> Walker<'_, P, D> {
    /// Processes one part of eight nodes from index `k` of the strips on. Returns the forces on the previous nodes, shifted by
    /// one, and the power that damping dissipates. The loop proceeds register by register, because the data of a bend fit into
    /// the registers of any processor.
    #[inline(always)]
    fn step<const BATCH: bool, const DAMPED: bool>(&mut self, k: usize, part: usize) -> ([P::Part; D], P::Part) {
        let (next, slot) = if BATCH { (WIDTH, part) } else { (1, 0) };
        // For bodies side by side, no data follow the padding, in which 1/L is zero.
        let there = if BATCH && k + next > self.end { self.end } else { k + next };
        let mut numbers = [P::Part::zero(); NUMBERS];
        for n in 0..if DAMPED { NUMBERS } else { LENGTH } {
            numbers[n] = self.numbers[n].load_part::<P>(k, part);
        }
        let per_length = numbers[INVERSE];
        let (x, v) = (&self.x, &self.v);
        let behind =
            lanes!(P::Part, d => (x.load_part::<P>(d, there, part) - x.load_part::<P>(d, k, part)) * per_length);
        let rate_behind = lanes!(P::Part, d => if DAMPED {
            (v.load_part::<P>(d, there, part) - v.load_part::<P>(d, k, part)) * per_length
        } else {
            P::Part::zero()
        });
        let before = lanes!(P::Part, d => back::<P::Part, BATCH>(behind[d], self.g[d].part(slot)));
        let rate_before = lanes!(P::Part, d => if DAMPED {
            back::<P::Part, BATCH>(rate_behind[d], self.rate[d].part(slot))
        } else {
            P::Part::zero()
        });
        let section = Section {
            stretch: self.section.stretch.part(part),
            bending: self.section.bending.part(part),
            retardation: self.section.retardation.part(part),
        };
        let (pull, loss) = tension(&behind, &rate_behind, &section, numbers[LENGTH], DAMPED);
        let sides = Sides { before, behind, rate_before, rate_behind };
        let ([by_a, by_b], more) = bend(&sides, &numbers, &section, DAMPED);
        let edge = lanes!(P::Part, d => pull[d] + by_b[d] * per_length);
        let inverse_before = back::<P::Part, BATCH>(per_length, self.inverse.part(slot));
        let whole = lanes!(P::Part, d => {
            back::<P::Part, BATCH>(edge[d], self.edge[d].part(slot)) + by_a[d] * inverse_before
        });
        let force = lanes!(P::Part, d => whole[d] - back::<P::Part, BATCH>(whole[d], self.before[d].part(slot)));
        self.inverse.set_part(slot, per_length);
        for d in 0..D {
            self.g[d].set_part(slot, behind[d]);
            self.rate[d].set_part(slot, rate_behind[d]);
            self.edge[d].set_part(slot, edge[d]);
            self.before[d].set_part(slot, whole[d]);
        }
        (force, loss + more)
    }
    /// Processes all parts, but does not compute forces.
    #[inline(always)]
    fn lead<const BATCH: bool, const DAMPED: bool>(&mut self, k: usize) -> P {
        let mut power = P::zero();
        for part in 0..P::PARTS {
            let (_, loss) = self.step::<BATCH, DAMPED>(k, part);
            power.set_part(part, loss);
        }
        power
    }
    /// Starts at the first node of a curve and copies its values to all lanes.
    #[inline(always)]
    fn begin<const DAMPED: bool>(&mut self) -> P {
        let per_length = P::splat(self.numbers[INVERSE].load::<P>(0).to_array()[0]);
        for d in 0..D {
            let (x, v) = (self.x.load::<P>(d, 0).to_array(), self.v.load::<P>(d, 0).to_array());
            self.g[d] = (P::splat(x[1]) - P::splat(x[0])) * per_length;
            if DAMPED {
                self.rate[d] = (P::splat(v[1]) - P::splat(v[0])) * per_length;
            }
        }
        let length = P::splat(self.numbers[LENGTH].load::<P>(0).to_array()[0]);
        let (edge, power) = tension(&self.g, &self.rate, &self.section, length, DAMPED);
        (self.inverse, self.edge) = (per_length, edge);
        P::select(P::first(1), power, P::zero())
    }
}

/// The section of eight bodies, or of one.
#[inline(always)]
fn section<P: Pack>(along: &Along) -> Section<P> {
    let [stretch, bending, retardation] = &along.section;
    Section { stretch: stretch.load(0), bending: bending.load(0), retardation: retardation.load(0) }
}

#[inline(always)]
fn walk<P: Pack, const D: usize, const BATCH: bool, const DAMPED: bool>(
    along: &Along,
    view: &View<D>,
    tile: &mut Tile<D>,
    power: &mut P,
) {
    let next = if BATCH { WIDTH } else { 1 };
    let (start, length) = (tile.range.start, tile.range.len());
    // The walk starts before the first node of the tile, with the nodes whose edges exert forces on it: two nodes for bodies side
    // by side, or those of one pack.
    let from = start.saturating_sub(if BATCH { 2 * WIDTH } else { WIDTH - 1 });
    let lead = start - from;
    let read = (lead + length + 2 * next).min(view.x[0].len() - from);
    let mut walker = Walker {
        x: Strip::new(&view.x, from, read),
        v: Strip::new(&view.v, from, read),
        numbers: along.numbers.each_ref().map(|numbers| numbers.strip(from, lead + length + next)),
        section: section::<P>(along),
        end: read - WIDTH,
        g: [P::zero(); D],
        rate: [P::zero(); D],
        inverse: P::zero(),
        edge: [P::zero(); D],
        before: [P::zero(); D],
    };
    if BATCH {
        for k in (0..=lead).step_by(WIDTH) {
            let own = walker.lead::<BATCH, DAMPED>(k);
            if DAMPED && start == 0 {
                *power += own;
            }
        }
    } else if start == 0 {
        let own = walker.begin::<DAMPED>();
        if DAMPED {
            *power += own;
        }
    } else {
        walker.lead::<BATCH, DAMPED>(0);
    }
    let mut force = StripMut::<D>::new(tile.force.each_mut().map(|f| &mut **f), 0, length);
    for k in (0..length).step_by(WIDTH) {
        let mut all = P::zero();
        for part in 0..P::PARTS {
            let (own, loss) = walker.step::<BATCH, DAMPED>(lead + k + next, part);
            for d in 0..D {
                force.store_part::<P>(d, k, part, force.load_part::<P>(d, k, part) + own[d]);
            }
            all.set_part(part, loss);
        }
        if DAMPED {
            *power += all;
        }
    }
}

/// Adds the forces of the edge that closes a ring and of the bends at its two ends, and the power that their damping dissipates.
#[inline(always)]
fn close<P: Pack, const D: usize, const BATCH: bool, const DAMPED: bool>(
    along: &Along,
    view: &View<D>,
    tile: &mut Tile<D>,
    power: &mut P,
) {
    let Some(closing) = &along.closing else { return };
    let (stride, count) = (along.layout.stride(), along.nodes);
    let nodes = [count - 2, count - 1, 0, 1];
    if !nodes.iter().any(|node| tile.range.contains(&(node * stride))) {
        return;
    }
    let section = section::<P>(along);
    let numbers = closing.each_ref().map(|own| {
        let mut out = [P::zero(); NUMBERS];
        for n in 0..NUMBERS {
            out[n] = own[n].load(0);
        }
        out
    });
    let of_edge = |node: usize| match along.layout {
        Layout::Single => P::splat(along.numbers[INVERSE].at(node)),
        Layout::Batch => along.numbers[INVERSE].load(node * WIDTH),
    };
    let inverses = [of_edge(count - 2), numbers[0][INVERSE], of_edge(0)];
    let difference = |columns: &[&[f64]; D], k: usize| {
        let at = |node: usize, d: usize| match along.layout {
            Layout::Single => P::splat(columns[d][node]),
            Layout::Batch => P::load(&columns[d][node * WIDTH..]),
        };
        lanes!(P, d => (at(nodes[k + 1], d) - at(nodes[k], d)) * inverses[k])
    };
    let g = [difference(&view.x, 0), difference(&view.x, 1), difference(&view.x, 2)];
    let mut rate = [[P::zero(); D]; 3];
    if DAMPED {
        for k in 0..3 {
            rate[k] = difference(&view.v, k);
        }
    }
    let sides = |k: usize| Sides { before: g[k], behind: g[k + 1], rate_before: rate[k], rate_behind: rate[k + 1] };
    let (pull, loss) = tension(&g[1], &rate[1], &section, numbers[0][LENGTH], DAMPED);
    let ([low_a, low_b], low) = bend(&sides(0), &numbers[0], &section, DAMPED);
    let ([high_a, high_b], high) = bend(&sides(1), &numbers[1], &section, DAMPED);
    for d in 0..D {
        let before = low_a[d] * inverses[0];
        let own = pull[d] + (low_b[d] + high_a[d]) * inverses[1];
        let behind = high_b[d] * inverses[2];
        let forces = [before, own - before, behind - own, -behind];
        for (node, force) in nodes.into_iter().zip(forces) {
            let index = node * stride;
            if !tile.range.contains(&index) {
                continue;
            }
            let to = &mut tile.force[d][index - tile.range.start..];
            match along.layout {
                Layout::Single => to[0] += force.to_array()[0],
                Layout::Batch => (P::load(to) + force).store(to),
            }
        }
    }
    if DAMPED && tile.range.contains(&((count - 1) * stride)) {
        let own = loss + (low + high);
        *power += if BATCH { own } else { P::select(P::first(1), own, P::zero()) };
    }
}
