//! The solid of one body: the part that is common to all kinds of cells.

use super::SPEC;
use super::nodal_volume::{NodalVolumes, Pressures};
use super::part::Part;
use super::section::FORCES;
use opruga_core::error::StepError;
use opruga_core::potential::{CellState, Definiteness, Observe, Potential, Properties, Sink, Views};
use opruga_core::state::{Layout, View};
use opruga_core::threads::each_part;
use opruga_core::tile::Tile;
use opruga_math::{ROW, Simd, WIDTH};
use std::sync::{Mutex, PoisonError};

/// The solid of one body, or of eight identical ones.
#[derive(Debug)]
pub struct Solid<const D: usize> {
    layout: Layout,
    nodes: usize,
    parts: Vec<Box<dyn Part<D>>>,
    /// The shares of all parts.
    shares: Vec<Task>,
    /// The offset of the scratch of each share, counted from the end of the sums of the whole solid.
    starts: Vec<usize>,
    sums: Sums,
    /// The consistent mass matrix minus the lumped masses.
    inertia: Vec<(u32, u32, f64)>,
    /// The resistance of nodes to changes of volume.
    volumes: Option<NodalVolumes<D>>,
    damped: bool,
    /// The value of [`Potential::energy_parts`] [J].
    energy_parts: f64,
}

/// The data from which a solid is built.
pub(super) struct Built<const D: usize> {
    pub(super) parts: Vec<Box<dyn Part<D>>>,
    pub(super) inertia: Vec<(u32, u32, f64)>,
    pub(super) volumes: Option<NodalVolumes<D>>,
    pub(super) energy_parts: f64,
}

impl<const D: usize> Built<D> {
    pub(super) const NOTHING: Built<D> =
        Built { parts: Vec::new(), inertia: Vec::new(), volumes: None, energy_parts: 0.0 };
}

/// A share of one of the parts, and the location of its scratch.
#[derive(Clone, Copy, Debug)]
struct Task {
    part: usize,
    share: usize,
    start: usize,
    length: usize,
}

/// The location of the forces of the nodes in the scratch.
#[derive(Debug)]
enum Sums {
    /// The forces of all nodes are consecutive from this index.
    Whole(usize),
    /// The rows of the shares that add up to the force of each node: the start of the list of every node, and the lists of row
    /// indices in units of [`ROW`].
    Listed { start: Vec<u32>, rows: Vec<u32> },
}

impl Sums {
    fn new<const D: usize>(layout: Layout, nodes: usize, parts: &[Box<dyn Part<D>>], tasks: &[Task]) -> Sums {
        let touched = |task: &Task| &parts[task.part].shares()[task.share].nodes;
        if let [task] = tasks
            && touched(task).len() == nodes
        {
            return Sums::Whole(task.start + FORCES);
        }
        let row = if layout == Layout::Single { 1 } else { D * WIDTH / ROW };
        let mut start = vec![0; nodes + 1];
        for node in tasks.iter().flat_map(touched) {
            start[*node as usize + 1] += 1;
        }
        for node in 0..nodes {
            start[node + 1] += start[node];
        }
        let (mut next, mut rows) = (start.clone(), vec![0; start[nodes] as usize]);
        for task in tasks {
            for (k, node) in touched(task).iter().enumerate() {
                let next = &mut next[*node as usize];
                rows[*next as usize] = ((task.start + FORCES) / ROW + k * row) as u32;
                *next += 1;
            }
        }
        Sums::Listed { start, rows }
    }
    fn heap_bytes(&self) -> usize {
        match self {
            Sums::Whole(_) => 0,
            Sums::Listed { start, rows } => 4 * (start.capacity() + rows.capacity()),
        }
    }
}

impl<const D: usize> Potential<D> for Solid<D> {
    fn properties(&self) -> Properties {
        Properties {
            scratch_len: self.cells_len() + self.volumes.as_ref().map_or(0, NodalVolumes::scratch_len),
            shares_threads: self.shares.len() > 1,
            forces_in_prepare: true,
            judges_balance: true,
            ..Properties::new(SPEC.kind, Views { energy: true, hessian: true, symmetric: true, damping: self.damped })
        }
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.parts.iter().for_each(|part| part.stencils(visit));
        if let Some(volumes) = &self.volumes {
            volumes.stencils(visit);
        }
    }
    fn inertia(&self) -> &[(u32, u32, f64)] {
        &self.inertia
    }
    fn energy_parts(&self) -> f64 {
        self.energy_parts
    }
    /// Evaluates every element once: energies, powers and the forces of all nodes.
    fn prepare(&self, simd: Simd, view: &View<D>, _memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        let (cells, of_volumes) = scratch.split_at_mut(self.cells_len());
        let (sums, rest) = cells.split_at_mut(FORCES);
        let volumes = self.press(simd, view, rest, of_volumes);
        let pressures = self.pressures(of_volumes);
        let refused: Mutex<Option<(usize, StepError)>> = Mutex::new(None);
        each_part(view.threads, rest, &self.starts, |number, scratch| {
            let part = &self.parts[self.shares[number].part];
            let share = &part.shares()[self.shares[number].share];
            if let Err(error) = part.evaluate(share, simd, view, pressures, scratch) {
                let mut first = refused.lock().unwrap_or_else(PoisonError::into_inner);
                if first.as_ref().is_none_or(|(other, _)| number < *other) {
                    *first = Some((number, error));
                }
            }
        });
        if let Some((_, error)) = refused.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        sums.fill(0.0);
        for task in &self.shares {
            let own = &rest[task.start - FORCES..][..FORCES];
            for (sum, own) in sums.iter_mut().zip(own) {
                *sum += own;
            }
        }
        for (sum, own) in sums.iter_mut().zip(volumes) {
            *sum += own;
        }
        Ok(())
    }
    fn add_force(&self, _simd: Simd, _view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        let range = tile.range.clone();
        match (self.layout, &self.sums) {
            (Layout::Single, Sums::Whole(at)) => {
                let own = range.start..range.end.min(self.nodes).max(range.start);
                for (k, row) in scratch[at + own.start * ROW..at + own.end * ROW].chunks_exact(ROW).enumerate() {
                    for d in 0..D {
                        tile.force[d][k] += row[d];
                    }
                }
            }
            (Layout::Single, Sums::Listed { start, rows }) => {
                for node in range.start..range.end.min(self.nodes) {
                    let mut sum = [0.0; ROW];
                    for row in &rows[start[node] as usize..start[node + 1] as usize] {
                        let row = &scratch[*row as usize * ROW..][..ROW];
                        for d in 0..ROW {
                            sum[d] += row[d];
                        }
                    }
                    for d in 0..D {
                        tile.force[d][node - range.start] += sum[d];
                    }
                }
            }
            (Layout::Batch, sums) => {
                for node in range.start / WIDTH..(range.end / WIDTH).min(self.nodes) {
                    let first = node * WIDTH - range.start;
                    let mut sum = [[0.0; WIDTH]; D];
                    let mut add = |from: usize| {
                        for (sum, force) in sum.iter_mut().zip(scratch[from..].chunks_exact(WIDTH)) {
                            for l in 0..WIDTH {
                                sum[l] += force[l];
                            }
                        }
                    };
                    match sums {
                        Sums::Whole(at) => add(at + node * D * WIDTH),
                        Sums::Listed { start, rows } => {
                            let own = &rows[start[node] as usize..start[node + 1] as usize];
                            own.iter().for_each(|row| add(*row as usize * ROW));
                        }
                    }
                    for d in 0..D {
                        for (to, sum) in tile.force[d][first..first + WIDTH].iter_mut().zip(&sum[d]) {
                            *to += sum;
                        }
                    }
                }
            }
        }
        // The first tile reports the power of the whole body.
        if range.start == 0 {
            for l in 0..WIDTH {
                tile.power[l] += scratch[WIDTH + l];
            }
        }
    }
    fn energy(&self, _simd: Simd, _view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        core::array::from_fn(|l| scratch[l])
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let pressures = self.pressures(&scratch[self.cells_len()..]);
        for (part, scratch) in self.parts_in(scratch) {
            part.hessian(view, pressures, scratch, keep, sink);
        }
        if let Some(volumes) = &self.volumes {
            volumes.hessian(view, sink);
        }
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        for (part, scratch) in self.parts_in(scratch) {
            part.damping_matrix(view, scratch, sink);
        }
    }
}

impl<const D: usize> Observe<D> for Solid<D> {
    fn cell_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        let mut out = Vec::new();
        for part in &self.parts {
            part.cell_states(view, body, &mut out);
        }
        if let Some(volumes) = &self.volumes {
            let mut scratch = vec![0.0; self.properties().scratch_len];
            let (cells, of_volumes) = scratch.split_at_mut(self.cells_len());
            self.press(Simd::best(), view, &mut cells[FORCES..], of_volumes);
            volumes.add_stresses(&volumes.pressures(of_volumes), body, &mut out);
        }
        out
    }
    fn heap_bytes(&self) -> usize {
        self.parts.iter().map(|part| part.heap_bytes()).sum::<usize>()
            + self.sums.heap_bytes()
            + self.volumes.as_ref().map_or(0, NodalVolumes::heap_bytes)
    }
}

impl<const D: usize> Solid<D> {
    /// Makes a solid from its parts, one for each kind of cells.
    pub(super) fn new(layout: Layout, nodes: usize, built: Built<D>, damped: bool) -> Self {
        let Built { parts, inertia, mut volumes, energy_parts } = built;
        let (mut shares, mut starts) = (Vec::<Task>::new(), Vec::new());
        let mut start = FORCES;
        for (part, own) in parts.iter().enumerate() {
            for (share, list) in own.shares().iter().enumerate() {
                let length = own.scratch_len(list);
                shares.push(Task { part, share, start, length });
                starts.push(start - FORCES);
                start += length;
            }
        }
        if let Some(volumes) = &mut volumes {
            // The data of the shares follow the sums of the whole solid.
            let start =
                |part: usize| shares.iter().find(|task| task.part == part).map_or(0, |task| task.start - FORCES);
            let mut of_parts = parts.iter().enumerate();
            let own = of_parts.find(|(_, part)| part.grown_at(0).is_some());
            volumes.locate(|pack| own.and_then(|(k, part)| Some(start(k) + part.grown_at(pack)?)));
        }
        let sums = Sums::new(layout, nodes, &parts, &shares);
        Solid { layout, nodes, parts, shares, starts, sums, inertia, volumes, damped, energy_parts }
    }

    /// Computes the pressures of the nodes that resist changes of volume, in the scratch of these nodes. Returns the energies of
    /// the bodies [J].
    fn press(&self, simd: Simd, view: &View<D>, cells: &mut [f64], of_volumes: &mut [f64]) -> [f64; WIDTH] {
        let Some(volumes) = &self.volumes else { return [0.0; WIDTH] };
        each_part(view.threads, cells, &self.starts, |number, scratch| {
            let part = &self.parts[self.shares[number].part];
            part.grow(&part.shares()[self.shares[number].share], simd, view, scratch);
        });
        volumes.press(view.threads, cells, of_volumes)
    }

    fn pressures<'a>(&self, of_volumes: &'a [f64]) -> Pressures<'a> {
        self.volumes.as_ref().map_or(Pressures::default(), |volumes| volumes.pressures(of_volumes))
    }

    /// The length of the scratch of the cells.
    fn cells_len(&self) -> usize {
        self.shares.last().map_or(FORCES, |task| task.start + task.length)
    }

    /// The parts, each with its scratch.
    fn parts_in<'a>(&'a self, scratch: &'a [f64]) -> impl Iterator<Item = (&'a dyn Part<D>, &'a [f64])> {
        self.shares.iter().filter(|task| task.share == 0).map(|task| (&*self.parts[task.part], &scratch[task.start..]))
    }
}
