//! Models that consist of stencils: few nodes each, with one formula for all of them.
//!
//! A [`Kernel`] is the energy of one stencil of N nodes with its gradient, written once over [`Lane`]. [`Stencils`] turns it into
//! a [`Potential`] of a whole body, or of eight identical ones:
//!
//! ```text
//! elements, sorted by their lowest node      0 1 2 3 4 5 6 7 …     eight at a time through the kernel
//!                                            │ │ │ │ │ │ │ │
//! slots: the force on each node of each      ▼ ▼ ▼ ▼ ▼ ▼ ▼ ▼
//!                                             \│/     \│/
//! nodes: slots by ascending element, corner    ●       ●           added up one after the other
//! ```
//!
//! Every tile evaluates all elements that touch it. Elements across the border of two tiles are evaluated by both. Therefore, a node receives the
//! same numbers in the same order, whatever the tiles and the layout, and its force has the same bits.

mod clamp;
mod dual;
mod kernel;

pub use clamp::clamp;
pub use dual::Dual;
pub use kernel::{Blocks, Kernel};

use crate::potential::{Definiteness, Observe, Potential, Properties, Sink, Views};
use crate::state::{At, Layout, OrderedSum, Parameter, View};
use crate::tile::{TILE, Tile};
use core::marker::PhantomData;
use opruga_math::{Lane, Pack, Register, Simd, WIDTH, Work};

/// All stencils of one kernel on one body, or on eight identical ones.
#[derive(Debug)]
pub struct Stencils<L, const N: usize, const K: usize> {
    kernel: PhantomData<L>,
    layout: Layout,
    nodes: usize,
    /// The nodes of each element. Elements are sorted by their lowest node, and elements with the same lowest node are in lexicographic order.
    elements: Vec<[u32; N]>,
    parameters: [Parameter; K],
    damped: bool,
    /// The start of the elements of each block of [`TILE`] indices in `list`, and the end of the last.
    blocks: Vec<u32>,
    /// The elements that touch a block, ascending; for one body, filled up to whole packs with the last element.
    list: Vec<u32>,
    /// For each pack of `list`: whether its eight elements and all of their nodes are consecutive.
    straight: Vec<bool>,
    /// The start of the slots of each node in `share`, and the end of the last.
    share_start: Vec<u32>,
    /// The slots that a node sums: local node (upper bits) and index in the list of its block (lower bits).
    share: Vec<u32>,
}

/// The number of bits of a share that hold the index in the list.
const SHARE_BITS: u32 = 28;

impl<L, const N: usize, const K: usize> Stencils<L, N, K> {
    /// Lays out stencils; `parameters` returns the parameters of an element (given by its number in `elements`) of a body.
    ///
    /// [`Kernel::damping`] is evaluated only if `damped` is set.
    pub fn new(
        layout: Layout,
        nodes: usize,
        elements: &[[u32; N]],
        damped: bool,
        mut parameters: impl FnMut(usize, usize) -> [f64; K],
    ) -> Stencils<L, N, K> {
        assert!(N < 1 << (32 - SHARE_BITS), "a stencil has at most 15 nodes");
        let lowest = |e: &[u32; N]| e.iter().copied().min().unwrap_or(0);
        let mut order: Vec<u32> = (0..elements.len() as u32).collect();
        order.sort_by_key(|&e| (lowest(&elements[e as usize]), elements[e as usize], e));
        let sorted: Vec<[u32; N]> = order.iter().map(|&e| elements[e as usize]).collect();
        let parameters = core::array::from_fn(|k| {
            Parameter::from_items(layout, order.len(), |element, body| parameters(order[element] as usize, body)[k])
        });

        // The elements of every block, and for every node the slots in the block of the node.
        let block_nodes = TILE / layout.stride();
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); nodes.div_ceil(block_nodes)];
        let mut share_start = vec![0u32; nodes + 1];
        for (number, element) in sorted.iter().enumerate() {
            for &node in element {
                share_start[node as usize + 1] += 1;
                let list = &mut lists[node as usize / block_nodes];
                if list.last() != Some(&(number as u32)) {
                    list.push(number as u32);
                }
            }
        }
        for node in 0..nodes {
            share_start[node + 1] += share_start[node];
        }
        let mut next = share_start.clone();
        let mut share = vec![0u32; share_start[nodes] as usize];
        for (block, list) in lists.iter().enumerate() {
            for (k, &element) in list.iter().enumerate() {
                for (local, &node) in sorted[element as usize].iter().enumerate() {
                    if node as usize / block_nodes == block {
                        share[next[node as usize] as usize] = (local as u32) << SHARE_BITS | k as u32;
                        next[node as usize] += 1;
                    }
                }
            }
        }

        // One list for all blocks.
        let mut blocks = vec![0u32];
        let mut list = Vec::new();
        for part in lists {
            list.extend_from_slice(&part);
            if let (Layout::Single, Some(&last)) = (layout, part.last()) {
                list.resize(list.len().next_multiple_of(WIDTH), last);
            }
            blocks.push(list.len() as u32);
        }
        let mut straight = Vec::new();
        if layout == Layout::Single {
            for pack in list.chunks(WIDTH) {
                straight.push(pack.iter().enumerate().all(|(l, &element)| {
                    let (first, this) = (&sorted[pack[0] as usize], &sorted[element as usize]);
                    element == pack[0] + l as u32 && (0..N).all(|a| this[a] == first[a] + l as u32)
                }));
            }
        }
        let kernel = PhantomData;
        Stencils {
            kernel,
            layout,
            nodes,
            elements: sorted,
            parameters,
            damped,
            blocks,
            list,
            straight,
            share_start,
            share,
        }
    }

    /// The nodes of every element, in the order of evaluation.
    pub fn elements(&self) -> &[[u32; N]] {
        &self.elements
    }

    /// Adds the forces of one block to its nodes in the range of the tile.
    #[inline(always)]
    fn add_block<P: Pack, const D: usize>(&self, block: usize, view: &View<D>, tile: &mut Tile<D>)
    where
        L: Kernel<D, N, K>,
    {
        let (from, until) = (self.blocks[block] as usize, self.blocks[block + 1] as usize);
        let count = until - from;
        let stride = self.layout.stride();
        tile.slots.grow(N * D * count * stride);
        let slots = &mut tile.slots[..N * D * count * stride];

        // Forces of all elements, written to slots.
        let step = if self.layout == Layout::Single { WIDTH } else { 1 };
        for k in (0..count).step_by(step) {
            let items = &self.list[from + k..from + k + step];
            let eight = match self.layout {
                Layout::Single if !self.straight[(from + k) / WIDTH] => self.scattered(items),
                _ => self.in_a_row(items[0]),
            };
            let mut powers = [0.0; WIDTH];
            // Elements are processed register by register, because kernels need more values at a time than a processor has
            // registers for whole packs.
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let (p, x) = (eight.parameters(&self.parameters, offset), eight.read::<P::Part, D>(&view.x, offset));
                let gradient = L::gradient::<P::Part>(&p, &x);
                let mut force = [[P::Part::zero(); D]; N];
                for a in 0..N {
                    for d in 0..D {
                        force[a][d] = -gradient[a][d];
                    }
                }
                if self.damped {
                    let (drag, power) = L::damping::<P::Part>(&p, &x, &eight.read::<P::Part, D>(&view.v, offset));
                    for a in 0..N {
                        for d in 0..D {
                            force[a][d] += drag[a][d];
                        }
                    }
                    power.store(&mut powers[offset..]);
                }
                for a in 0..N {
                    for d in 0..D {
                        force[a][d].store(&mut slots[((a * D + d) * count + k) * stride + offset..]);
                    }
                }
            }
            if self.damped {
                // The power of an element belongs to the block of its first node, if the tile covers it.
                let own = (block * TILE).max(tile.range.start)..((block + 1) * TILE).min(tile.range.end);
                for l in 0..WIDTH {
                    let item = items[l.min(step - 1)];
                    let filling = step > 1 && l > 0 && item == items[l - 1];
                    let owner = self.elements[item as usize][0] as usize * stride;
                    if own.contains(&owner) && !filling {
                        tile.power[l] += powers[l];
                    }
                }
            }
        }

        // Add the slots to the forces on the nodes.
        let start = (block * TILE).max(tile.range.start) / stride;
        let end = ((block + 1) * TILE).min(tile.range.end).div_ceil(stride).min(self.nodes);
        for node in start..end {
            let shares = &self.share[self.share_start[node] as usize..self.share_start[node + 1] as usize];
            let first = node * stride - tile.range.start;
            for d in 0..D {
                match self.layout {
                    Layout::Single => {
                        let mut sum = tile.force[d][first];
                        for &share in shares {
                            let (local, k) = split(share);
                            sum += slots[(local * D + d) * count + k];
                        }
                        tile.force[d][first] = sum;
                    }
                    Layout::Batch => {
                        let mut sum = P::load(&tile.force[d][first..]);
                        for &share in shares {
                            let (local, k) = split(share);
                            sum += P::load(&slots[((local * D + d) * count + k) * WIDTH..]);
                        }
                        sum.store(&mut tile.force[d][first..]);
                    }
                }
            }
        }
    }

    /// Eight consecutive elements, whose nodes are consecutive too, or one element of eight bodies.
    #[inline(always)]
    fn in_a_row(&self, first: u32) -> Eight<'_, N> {
        let stride = self.layout.stride();
        let nodes = self.elements[first as usize].map(|node| node as usize * stride);
        Eight { items: At::Run(first as usize * stride), nodes: Nodes::InARow(nodes) }
    }

    /// Eight elements of one body, with arbitrary indices.
    #[inline(always)]
    fn scattered<'a>(&self, items: &'a [u32]) -> Eight<'a, N> {
        let mut nodes = [[0u32; WIDTH]; N];
        for l in 0..WIDTH {
            let element = &self.elements[items[l] as usize];
            for a in 0..N {
                nodes[a][l] = element[a];
            }
        }
        Eight { items: At::Each(items), nodes: Nodes::Scattered(nodes) }
    }

    /// The energy of all elements, with bits that do not depend on the layout.
    #[inline(always)]
    fn sum<P: Pack, const D: usize>(&self, view: &View<D>) -> P
    where
        L: Kernel<D, N, K>,
    {
        let mut sum = OrderedSum::<P>::new(self.layout);
        let count = self.elements.len();
        let (step, width) = if self.layout == Layout::Single { (WIDTH, 1) } else { (1, WIDTH) };
        let mut energy = [0.0; WIDTH];
        for k in (0..count).step_by(step) {
            let items: [u32; WIDTH] = core::array::from_fn(|l| (k + l).min(count - 1) as u32);
            let eight = match self.layout {
                Layout::Single => self.scattered(&items),
                Layout::Batch => self.in_a_row(items[0]),
            };
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let (p, x) = (eight.parameters(&self.parameters, offset), eight.read::<P::Part, D>(&view.x, offset));
                L::energy::<P::Part>(&p, &x).store(&mut energy[offset..]);
            }
            sum.add(k * width, count * width, P::from_array(energy));
        }
        sum.total()
    }
}

/// Eight elements of one body, or one of eight bodies.
struct Eight<'a, const N: usize> {
    items: At<'a>,
    nodes: Nodes<N>,
}

/// The indices of the nodes of eight elements: only the first index if they are consecutive, otherwise every index.
enum Nodes<const N: usize> {
    InARow([usize; N]),
    Scattered([[u32; WIDTH]; N]),
}

impl<const N: usize> Eight<'_, N> {
    /// The parameters of the elements that start at `offset`.
    #[inline(always)]
    fn parameters<R: Register, const K: usize>(&self, parameters: &[Parameter; K], offset: usize) -> [R; K] {
        let mut out = [R::zero(); K];
        for k in 0..K {
            out[k] = parameters[k].load_part(self.items, offset);
        }
        out
    }
    /// A vector at every node of the elements that start at `offset`.
    #[inline(always)]
    fn read<R: Register, const D: usize>(&self, columns: &[&[f64]; D], offset: usize) -> [[R; D]; N] {
        let mut out = [[R::zero(); D]; N];
        match &self.nodes {
            Nodes::InARow(first) => {
                for a in 0..N {
                    for d in 0..D {
                        out[a][d] = R::load(&columns[d][first[a] + offset..]);
                    }
                }
            }
            Nodes::Scattered(indices) => {
                for a in 0..N {
                    for d in 0..D {
                        out[a][d] = R::gather(columns[d], &indices[a][offset..]);
                    }
                }
            }
        }
        out
    }
}

/// Local node and index in the list of the block.
#[inline(always)]
fn split(share: u32) -> (usize, usize) {
    ((share >> SHARE_BITS) as usize, (share & ((1 << SHARE_BITS) - 1)) as usize)
}

impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize> Potential<D> for Stencils<L, N, K> {
    fn properties(&self) -> Properties {
        Properties::new(L::NAME, Views { energy: true, hessian: true, symmetric: true, damping: self.damped })
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.elements.iter().for_each(|element| visit(element));
    }
    fn add_force(&self, simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        simd.run(Force { stencils: self, view, tile });
    }
    fn energy(&self, simd: Simd, view: &View<D>, _scratch: &[f64]) -> [f64; WIDTH] {
        simd.run(Energy { stencils: self, view })
    }
    fn hessian(&self, view: &View<D>, _scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let bodies = self.layout.stride();
        let indices =
            |item: usize| self.elements[item / bodies].map(|node| self.layout.index(node as usize, item % bodies));
        let (mut first, all) = (0, self.elements.len() * bodies);
        let mut matrices = Vec::with_capacity(WIDTH);
        while first < all {
            matrices.clear();
            for item in first..(first + WIDTH).min(all) {
                let parameters = self.parameters.each_ref().map(|p| p.at(item));
                matrices.push(L::hessian(&parameters, &indices(item).map(|p| view.position(p))));
            }
            if keep == Definiteness::Clamped {
                clamp(&mut matrices);
            }
            for (k, blocks) in matrices.iter().enumerate() {
                let indices = indices(first + k);
                for a in 0..N {
                    for b in 0..N {
                        sink.block(indices[a], indices[b], blocks[a][b]);
                    }
                }
            }
            first += WIDTH;
        }
    }
    fn damping_matrix(&self, view: &View<D>, _scratch: &[f64], sink: &mut dyn Sink<D>) {
        if !self.damped {
            return;
        }
        for (number, nodes) in self.elements.iter().enumerate() {
            for body in 0..self.layout.stride() {
                let parameters = self.parameters.each_ref().map(|p| p.at(self.layout.index(number, body)));
                let indices = nodes.map(|n| self.layout.index(n as usize, body));
                let blocks = L::damping_matrix(&parameters, &indices.map(|p| view.position(p)));
                for a in 0..N {
                    for b in 0..N {
                        sink.block(indices[a], indices[b], blocks[a][b]);
                    }
                }
            }
        }
    }
}

impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize> Observe<D> for Stencils<L, N, K> {
    fn heap_bytes(&self) -> usize {
        let numbers =
            self.blocks.capacity() + self.list.capacity() + self.share_start.capacity() + self.share.capacity();
        let parameters: usize = self.parameters.iter().map(Parameter::heap_bytes).sum();
        4 * (numbers + N * self.elements.capacity()) + self.straight.capacity() + parameters
    }
}

struct Force<'a, 'b, 'c, L, const D: usize, const N: usize, const K: usize> {
    stencils: &'a Stencils<L, N, K>,
    view: &'a View<'a, D>,
    tile: &'b mut Tile<'c, D>,
}
impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize> Work for Force<'_, '_, '_, L, D, N, K> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        self.tile.settle_by::<P>();
        let blocks = self.stencils.blocks.len() - 1;
        let last = self.tile.range.end.div_ceil(TILE).min(blocks);
        for block in self.tile.range.start / TILE..last {
            self.stencils.add_block::<P, D>(block, self.view, self.tile);
        }
    }
}

struct Energy<'a, L, const D: usize, const N: usize, const K: usize> {
    stencils: &'a Stencils<L, N, K>,
    view: &'a View<'a, D>,
}
impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize> Work for Energy<'_, L, D, N, K> {
    type Output = [f64; WIDTH];
    #[inline(always)]
    fn run<P: Pack>(self) -> [f64; WIDTH] {
        let sum = self.stencils.sum::<P, D>(self.view);
        let mut out = [0.0; WIDTH];
        match self.stencils.layout {
            Layout::Single => out[0] = sum.to_array()[0],
            Layout::Batch => sum.store(&mut out),
        }
        out
    }
}
