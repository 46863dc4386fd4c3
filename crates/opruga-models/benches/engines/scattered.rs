//! Evaluates every stencil once, as sections of finite elements do: positions are copied to rows, and forces are added to rows of
//! nodes.

use opruga_core::error::StepError;
use opruga_core::potential::{Observe, Potential, Properties, Views};
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::stencil::Kernel;
use opruga_core::tile::Tile;
use opruga_math::{Column, Lane, Pack, ROW, Register, Simd, WIDTH, Work, fetch_early, sum_in_fixed_order};
use std::marker::PhantomData;

/// The length of the partial sums of the energies of eight bodies.
const ENERGY: usize = WIDTH * WIDTH;

/// Data are prefetched this number of packs ahead.
const AHEAD: usize = 4;

/// All stencils of one kind. The first `FIXED` parameters belong to the rest shape, which eight bodies share.
#[derive(Debug)]
pub(crate) struct Scattered<L, const N: usize, const K: usize, const FIXED: usize> {
    kernel: PhantomData<L>,
    layout: Layout,
    nodes: usize,
    elements: Vec<[u32; N]>,
    /// The nodes of every pack: `[node][lane]` for one body, `[node]` for eight.
    list: Vec<u32>,
    /// The first `FIXED` parameters of every pack: `[parameter][lane]` for one body, `[parameter]` for eight.
    fixed: Column,
    others: Vec<Parameter>,
}

impl<L, const N: usize, const K: usize, const FIXED: usize> Scattered<L, N, K, FIXED> {
    pub(crate) fn new(
        layout: Layout,
        nodes: usize,
        elements: &[[u32; N]],
        parameters: impl Fn(usize, usize) -> [f64; K],
    ) -> Self {
        let mut order: Vec<usize> = (0..elements.len()).collect();
        order.sort_by_key(|e| (elements[*e].iter().copied().min(), elements[*e]));
        let lanes = if layout == Layout::Single { WIDTH } else { 1 };
        let packs = order.len().div_ceil(lanes);
        let (mut list, mut fixed) = (vec![0; packs * N * lanes], Column::zeros(packs * FIXED * lanes));
        for pack in 0..packs {
            for lane in 0..lanes {
                let element = order[(pack * lanes + lane).min(order.len() - 1)];
                for a in 0..N {
                    list[(pack * N + a) * lanes + lane] = elements[element][a];
                }
                for k in 0..FIXED {
                    fixed[(pack * FIXED + k) * lanes + lane] = parameters(element, 0)[k];
                }
            }
        }
        let other =
            |k: usize| Parameter::from_items(layout, order.len(), |item, body| parameters(order[item], body)[k]);
        let others = (FIXED..K).map(other).collect();
        let elements = order.iter().map(|e| elements[*e]).collect();
        Scattered { kernel: PhantomData, layout, nodes, elements, list, fixed, others }
    }

    fn rows(&self) -> usize {
        if self.layout == Layout::Single { self.nodes * ROW } else { 0 }
    }
    fn forces<const D: usize>(&self) -> usize {
        self.nodes * if self.layout == Layout::Single { ROW } else { D * WIDTH }
    }

    #[inline(always)]
    fn parameters<R: Register>(&self, pack: usize, offset: usize) -> [R; K] {
        let mut out = [R::zero(); K];
        let single = self.layout == Layout::Single;
        for k in 0..FIXED {
            out[k] = if single {
                R::load(&self.fixed[(pack * FIXED + k) * WIDTH + offset..])
            } else {
                R::splat(self.fixed[pack * FIXED + k])
            };
        }
        for k in FIXED..K {
            out[k] = self.others[k - FIXED].load_part(opruga_core::state::At::Run(pack * WIDTH), offset);
        }
        out
    }

    #[inline(always)]
    fn gather<R: Register, const D: usize>(
        &self,
        view: &View<D>,
        rows: &[f64],
        pack: usize,
        offset: usize,
    ) -> [[R; D]; N] {
        let mut x = [[R::zero(); D]; N];
        for a in 0..N {
            if self.layout == Layout::Single {
                let list = &self.list[(pack * N + a) * WIDTH + offset..][..R::NUMBERS];
                x[a].copy_from_slice(&R::gather_rows(rows, list)[..D]);
            } else {
                let index = self.list[pack * N + a] as usize * WIDTH + offset;
                for d in 0..D {
                    x[a][d] = R::load(&view.x[d][index..]);
                }
            }
        }
        x
    }

    #[inline(always)]
    fn scatter<P: Pack, const D: usize>(&self, pack: usize, slots: &[[P; D]; N], force: &mut [f64]) {
        if self.layout == Layout::Batch {
            for a in 0..N {
                let first = self.list[pack * N + a] as usize * D;
                for i in 0..D {
                    let at = &mut force[(first + i) * WIDTH..][..WIDTH];
                    (P::load(at) + slots[a][i]).store(at);
                }
            }
            return;
        }
        let list = &self.list[pack * N * WIDTH..(pack + 1) * N * WIDTH];
        let mut rows = [[[0.0; ROW]; WIDTH]; N];
        for a in 0..N {
            for part in 0..P::PARTS {
                let mut columns = [P::Part::zero(); ROW];
                for i in 0..D {
                    columns[i] = slots[a][i].part(part);
                }
                P::Part::store_rows(columns, rows[a][part * P::Part::NUMBERS..].as_flattened_mut());
            }
        }
        for l in 0..(self.elements.len() - pack * WIDTH).min(WIDTH) {
            for a in 0..N {
                let node = &mut force[list[a * WIDTH + l] as usize * ROW..][..ROW];
                for i in 0..ROW {
                    node[i] += rows[a][l][i];
                }
            }
        }
    }
}

struct Evaluate<'a, L, const D: usize, const N: usize, const K: usize, const FIXED: usize> {
    stencils: &'a Scattered<L, N, K, FIXED>,
    view: &'a View<'a, D>,
    rows: &'a [f64],
    energy: &'a mut [f64],
    force: &'a mut [f64],
}
impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize, const FIXED: usize> Work
    for Evaluate<'_, L, D, N, K, FIXED>
{
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let own = self.stencils;
        let single = own.layout == Layout::Single;
        let packs = if single { own.elements.len().div_ceil(WIDTH) } else { own.elements.len() };
        let lanes = if single { WIDTH } else { 1 };
        for pack in 0..packs {
            let (later, end) = (pack + AHEAD, pack + AHEAD + 1);
            fetch_early(&own.list, later * N * lanes..end * N * lanes);
            fetch_early(&own.fixed, later * FIXED * lanes..end * FIXED * lanes);
            let (mut slots, mut energy) = ([[P::zero(); D]; N], P::zero());
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let x = own.gather::<P::Part, D>(self.view, self.rows, pack, offset);
                let p = own.parameters::<P::Part>(pack, offset);
                energy.set_part(part, L::energy(&p, &x));
                let gradient = L::gradient(&p, &x);
                for a in 0..N {
                    for i in 0..D {
                        slots[a][i].set_part(part, -gradient[a][i]);
                    }
                }
            }
            if single {
                energy = P::select(P::first(own.elements.len() - pack * WIDTH), energy, P::zero());
            }
            let sum = &mut self.energy[if single { 0 } else { pack % WIDTH * WIDTH }..][..WIDTH];
            (P::load(sum) + energy).store(sum);
            own.scatter(pack, &slots, self.force);
        }
    }
}

impl<L: Kernel<D, N, K>, const D: usize, const N: usize, const K: usize, const FIXED: usize> Potential<D>
    for Scattered<L, N, K, FIXED>
{
    fn properties(&self) -> Properties {
        let views = Views { energy: true, hessian: false, symmetric: false, damping: false };
        Properties {
            scratch_len: ENERGY + self.rows() + self.forces::<D>(),
            forces_in_prepare: true,
            ..Properties::new("scattered", views)
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.elements.iter().for_each(|element| visit(element));
    }
    fn prepare(&self, simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (energy, rest) = scratch.split_at_mut(ENERGY);
        let (rows, force) = rest.split_at_mut(self.rows());
        for (node, row) in rows.chunks_exact_mut(ROW).enumerate() {
            for d in 0..D {
                row[d] = view.x[d][node];
            }
        }
        energy.fill(0.0);
        force.fill(0.0);
        simd.run(Evaluate { stencils: self, view, rows, energy, force });
        Ok(())
    }
    fn add_force(&self, _simd: Simd, _view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let (force, range) = (&scratch[ENERGY + self.rows()..], tile.range.clone());
        if self.layout == Layout::Single {
            let own = range.start..range.end.min(self.nodes).max(range.start);
            for (k, row) in force[own.start * ROW..own.end * ROW].chunks_exact(ROW).enumerate() {
                for d in 0..D {
                    tile.force[d][k] += row[d];
                }
            }
            return;
        }
        for node in range.start / WIDTH..(range.end / WIDTH).min(self.nodes) {
            for d in 0..D {
                let from = &force[(node * D + d) * WIDTH..][..WIDTH];
                for (to, from) in tile.force[d][node * WIDTH - range.start..][..WIDTH].iter_mut().zip(from) {
                    *to += from;
                }
            }
        }
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        match self.layout {
            Layout::Single => core::array::from_fn(|l| scratch[l]),
            Layout::Batch => {
                core::array::from_fn(|l| sum_in_fixed_order(&core::array::from_fn(|slot| scratch[slot * WIDTH + l])))
            }
        }
    }
}

impl<L, const D: usize, const N: usize, const K: usize, const FIXED: usize> Observe<D> for Scattered<L, N, K, FIXED> {
    fn heap_bytes(&self) -> usize {
        let others: usize = self.others.iter().map(Parameter::heap_bytes).sum();
        4 * (self.list.capacity() + N * self.elements.capacity()) + self.fixed.heap_bytes() + others
    }
}
