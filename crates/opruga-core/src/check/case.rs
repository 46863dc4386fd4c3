//! A built model with the state in which it is evaluated, and the comparison of results.

use super::Options;
use super::random::{Random, dot, times};
use crate::potential::Potential;
use crate::state::{Columns, Layout, Parameter, View};
use crate::tile::{TILE, Tile, Weight};
use core::ops::Range;
use opruga_math::{Column, Lane, Simd, WIDTH, sum_in_fixed_order};
use opruga_mesh::Mesh;

/// The state of one body.
#[derive(Clone, Debug)]
pub(super) struct Body<const D: usize> {
    pub(super) x: Vec<[f64; D]>,
    pub(super) v: Vec<[f64; D]>,
    pub(super) mass: Vec<f64>,
}

/// Returns the view of positions and velocities that a model receives, for one thread.
fn view<'a, const D: usize>(
    x: &'a Columns<D>,
    v: &'a Columns<D>,
    nodes: usize,
    layout: Layout,
    time: f64,
) -> View<'a, D> {
    View { x: x.slices(), v: v.slices(), nodes, layout, time, threads: 1 }
}

/// The mean length of the edges of a mesh.
pub(super) fn mean_edge<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let edges = mesh.edges(opruga_mesh::EdgeSet::All);
    let mut sum = 0.0;
    for &[a, b] in &edges {
        let (a, b) = (mesh.positions[a as usize], mesh.positions[b as usize]);
        let d: [f64; D] = core::array::from_fn(|i| a[i] - b[i]);
        sum += dot(&d, &d).sqrt();
    }
    if edges.is_empty() { 1.0 } else { sum / edges.len() as f64 }
}

impl<const D: usize> Body<D> {
    pub(super) fn new(mesh: &Mesh<D>, options: &Options, random: &mut Random) -> Body<D> {
        let nodes = mesh.positions.len();
        let edge = mean_edge(mesh);
        let mut center = [0.0; D];
        for p in &mesh.positions {
            for d in 0..D {
                center[d] += p[d] / nodes as f64;
            }
        }
        // A random deformation of the whole body, then of every node.
        let mut affine = [[0.0; D]; D];
        for (i, row) in affine.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let one = if i == j { options.stretch } else { 0.0 };
                *entry = one + 0.2 * options.stretch * random.signed();
            }
            if options.mirrored && i == 0 {
                *row = row.map(|c| -c);
            }
        }
        let mut x = Vec::with_capacity(nodes);
        for p in &mesh.positions {
            let from_center: [f64; D] = core::array::from_fn(|d| p[d] - center[d]);
            let moved = times(&affine, &from_center);
            let noise: [f64; D] = random.vector();
            x.push(core::array::from_fn(|d| center[d] + moved[d] + noise[d] * options.noise * edge));
        }
        let v = (0..nodes).map(|_| random.vector::<D>().map(|c| c * edge)).collect();
        let mass = (0..nodes).map(|_| 1.0 + 0.5 * random.signed()).collect();
        Body { x, v, mass }
    }
    pub(super) fn still(&self) -> Body<D> {
        Body { v: vec![[0.0; D]; self.x.len()], ..self.clone() }
    }
}

/// A built model with the state in which it is evaluated.
pub(super) struct Case<'a, const D: usize> {
    pub(super) potential: &'a dyn Potential<D>,
    pub(super) layout: Layout,
    pub(super) nodes: usize,
    pub(super) x: Columns<D>,
    pub(super) v: Columns<D>,
    memory: Vec<f64>,
    pub(super) scratch: Column,
    time: f64,
}

pub(super) type Answer<T> = Result<T, String>;

impl<'a, const D: usize> Case<'a, D> {
    pub(super) fn new(potential: &'a dyn Potential<D>, layout: Layout, bodies: &[&Body<D>], time: f64) -> Case<'a, D> {
        let nodes = bodies[0].x.len();
        let index_count = layout.index_count(nodes);
        let (mut x, mut v) = (Columns::zeros(index_count), Columns::zeros(index_count));
        for node in 0..nodes {
            for (l, body) in bodies.iter().enumerate().take(layout.stride()) {
                x.set(layout.index(node, l), body.x[node]);
                v.set(layout.index(node, l), body.v[node]);
            }
        }
        // Padding repeats the last node.
        for index in nodes * layout.stride()..index_count {
            x.set(index, bodies[0].x[nodes - 1]);
        }
        let (memory, scratch) = (potential.initial_memory(), Column::zeros(potential.properties().scratch_len));
        Case { potential, layout, nodes, x, v, memory, scratch, time }
    }
    pub(super) fn index_count(&self) -> usize {
        self.layout.index_count(self.nodes)
    }
    pub(super) fn prepare(&mut self, simd: Simd) -> Answer<()> {
        let view = view(&self.x, &self.v, self.nodes, self.layout, self.time);
        self.potential.prepare(simd, &view, &self.memory, &mut self.scratch).map_err(|e| e.to_string())
    }
    pub(super) fn view(&self) -> View<'_, D> {
        view(&self.x, &self.v, self.nodes, self.layout, self.time)
    }
    pub(super) fn energy(&mut self, simd: Simd) -> Answer<[f64; WIDTH]> {
        self.prepare(simd)?;
        Ok(self.potential.energy(simd, &self.view(), &self.scratch))
    }
    /// Computes force and power, with the indices divided into tiles. If there is a `weight`, the forces begin with it; if
    /// `fused` is set, the model itself adds it.
    pub(super) fn forces(
        &mut self,
        simd: Simd,
        tiles: &[Range<usize>],
        weight: Option<(&Parameter, [f64; D], bool)>,
    ) -> Answer<(Columns<D>, [f64; WIDTH])> {
        self.prepare(simd)?;
        let mut out = Columns::zeros(self.index_count());
        let mut power = [0.0; WIDTH];
        let mut slots = Column::default();
        for range in tiles {
            let mut buffers: [Vec<f64>; D] = core::array::from_fn(|_| vec![0.0; range.len() + WIDTH]);
            let mut heaviness = weight.map(|(mass, gravity, _)| Weight { mass, gravity });
            if let Some((_, _, false)) = weight {
                let force = buffers.each_mut().map(Vec::as_mut_slice);
                let weight = heaviness.take();
                let mut tile = Tile { range: range.clone(), force, power: &mut power, weight, slots: &mut slots };
                tile.settle(simd);
            }
            let force = buffers.each_mut().map(Vec::as_mut_slice);
            let mut tile =
                Tile { range: range.clone(), force, power: &mut power, weight: heaviness, slots: &mut slots };
            self.potential.add_force(simd, &self.view(), &self.scratch, &mut tile);
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&buffers[d][..range.len()]);
            }
        }
        Ok((out, power))
    }
    /// Computes the forces on one body, node by node, with the tiles of a step.
    pub(super) fn plain(&mut self, simd: Simd) -> Answer<(Vec<[f64; D]>, f64)> {
        let tiles = regular(self.index_count(), TILE);
        let (columns, power) = self.forces(simd, &tiles, None)?;
        Ok((by_node(&columns, self.layout, self.nodes, 0), sum_in_fixed_order(&power)))
    }
}

pub(super) fn regular(index_count: usize, length: usize) -> Vec<Range<usize>> {
    (0..index_count).step_by(length).map(|s| s..(s + length).min(index_count)).collect()
}

/// Returns tiles of random sizes in random order.
pub(super) fn irregular(index_count: usize, random: &mut Random) -> Vec<Range<usize>> {
    let mut tiles = Vec::new();
    let mut start = 0;
    while start < index_count {
        let most = 1 << (random.bits() % 7);
        let end = (start + WIDTH * (1 + random.bits() as usize % most)).min(index_count);
        tiles.push(start..end);
        start = end;
    }
    tiles.reverse();
    tiles
}

pub(super) fn by_node<const D: usize>(
    columns: &Columns<D>,
    layout: Layout,
    nodes: usize,
    body: usize,
) -> Vec<[f64; D]> {
    (0..nodes).map(|n| columns.at(layout.index(n, body))).collect()
}

pub(super) fn unequal_bits<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count() as f64
}

/// The largest entry by absolute value.
pub(super) fn largest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    let mut out = 0.0;
    for n in numbers {
        out = if n.is_nan() { f64::NAN } else { Lane::larger(n.abs(), out) };
        if out.is_nan() {
            break;
        }
    }
    out
}

/// The largest difference between `a` and `b`, relative to the largest entry of `b` or to `scale`, whichever is larger.
pub(super) fn difference(a: &[f64], b: &[f64], scale: f64) -> f64 {
    let errors: Vec<f64> = a.iter().zip(b).map(|(x, y)| x - y).collect();
    let scale = Lane::larger(largest(b), scale);
    let error = largest(&errors);
    if error == 0.0 { 0.0 } else { error / scale }
}
