//! Volumes of nodes, for linear triangles and tetrahedra near incompressibility.
//!
//! Cells with one integration point cannot both bend and keep their volume, because there are more cells than degrees of
//! freedom. There are fewer nodes than cells, so the volumetric stiffness beyond λ′ = min(λ, 2μ) acts on the volumes of the
//! nodes instead (Bonet and Burton 1998). A node has an equal share V/(D + 1) of every cell around it, and
//!
//! U = Σₐ ½ κₐ Vₐ (Jₐ − 1)²,  Jₐ = Σ share · det F / Vₐ,  Vₐ = Σ share,  κₐ = Σ share · (λ − λ′) / Vₐ.
//!
//! In every cell, this energy causes an isotropic stress p, the mean of κₐ (Jₐ − 1) over the corners of the cell, with P = p cof
//! F. Under `linear` det F is 1 + tr (F − 1).
//!
//! First, J is computed for all cells. Second, every node sums over the cells around it. Third, the cells are evaluated as
//! usual, with p cof F added to the stress of their law ([`super::pressures`]).
//!
//! The second derivatives couple every node with all nodes of the cells around its neighbours. These derivatives form wide
//! rows, which are not sums of matrices of cells.

use super::elements::rest_gradient;
use super::numbers::beyond;
use opruga_core::potential::{CellState, Sink};
use opruga_core::state::{Layout, View};
use opruga_core::threads::each_part;
use opruga_math::WIDTH;
use opruga_math::matrix::{self, Matrix};

/// The cells of a body whose nodes resist changes of volume.
#[derive(Debug)]
pub(super) struct NodalVolumes<const D: usize> {
    layout: Layout,
    /// Whether the law accounts for rotations.
    turns: bool,
    /// The number of nodes of the body.
    nodes: usize,
    cells: Vec<Simplex>,
    /// ∂Nₐ/∂X of the corners of the cells, D + 1 each [1/m].
    slopes: Vec<[f64; D]>,
    /// Vₐ [m³].
    volumes: Vec<f64>,
    /// κₐ [Pa], node by node and body by body.
    moduli: Vec<f64>,
    /// The cells around each node: the start of its list, and the lists.
    start: Vec<u32>,
    around: Vec<u32>,
    /// The location of J − 1 of each of these cells in the scratch. The list is empty until it is set.
    grown: Vec<u32>,
    /// The start of the energies and pressures of every block of nodes in the scratch.
    starts: Vec<usize>,
}

/// The number of nodes that one thread processes at a time.
const BLOCK: usize = 512;

/// The pressures of the nodes [Pa].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pressures<'a> {
    scratch: &'a [f64],
    bodies: usize,
}

impl<'a> Pressures<'a> {
    pub(super) fn is_empty(&self) -> bool {
        self.scratch.is_empty()
    }
    /// The pressures of a node, body by body.
    #[inline(always)]
    pub(super) fn of(&self, node: usize) -> &'a [f64] {
        let block = node / BLOCK * (WIDTH + BLOCK * self.bodies) + WIDTH;
        &self.scratch[block + node % BLOCK * self.bodies..][..self.bodies]
    }
}

/// A cell.
#[derive(Clone, Copy, Debug)]
struct Simplex {
    /// The number of the cell in the mesh.
    number: u32,
    /// The nodes, D + 1 of them.
    nodes: [u32; 4],
    /// The share of each corner in the measure of the cell [m³]: the measure divided by D + 1.
    share: f64,
}

impl<const D: usize> NodalVolumes<D> {
    /// Makes the volumes of the nodes from the cells of a mesh, with μ and λ of each cell of each body.
    pub(super) fn new<const N: usize>(
        layout: Layout,
        turns: bool,
        positions: &[[f64; D]],
        thickness: f64,
        cells: impl Iterator<Item = (u32, [u32; N])>,
        lame: &dyn Fn(u32, usize) -> [f64; 2],
    ) -> Self {
        let (nodes, bodies) = (positions.len(), layout.stride());
        let mut out = NodalVolumes {
            layout,
            turns,
            nodes,
            cells: Vec::new(),
            slopes: Vec::new(),
            volumes: vec![0.0; nodes],
            moduli: vec![0.0; nodes * bodies],
            start: vec![0; nodes + 1],
            around: Vec::new(),
            grown: Vec::new(),
            starts: (0..nodes.div_ceil(BLOCK)).map(|block| block * (WIDTH + BLOCK * bodies)).collect(),
        };
        // ∂N/∂ξ of the reference simplex.
        let reference: [[f64; D]; N] = core::array::from_fn(|a| {
            core::array::from_fn(|j| if a == 0 { -1.0 } else { f64::from(u8::from(a == j + 1)) })
        });
        for (number, corners) in cells {
            let rest = corners.map(|node| positions[node as usize]);
            let (inverse, determinant) = rest_gradient(&rest, &reference);
            let share = thickness * determinant / [6.0, 24.0][D - 2];
            for row in &reference {
                out.slopes.push(core::array::from_fn(|j| (0..D).map(|k| row[k] * inverse[k][j]).sum()));
            }
            let mut own = Simplex { number, nodes: [0; 4], share };
            own.nodes[..N].copy_from_slice(&corners);
            for node in corners {
                out.volumes[node as usize] += share;
                out.start[node as usize + 1] += 1;
                for body in 0..bodies {
                    let [mu, lambda] = lame(number, body);
                    out.moduli[node as usize * bodies + body] += share * beyond(mu, lambda);
                }
            }
            out.cells.push(own);
        }
        for node in 0..nodes {
            out.start[node + 1] += out.start[node];
            let volume = if out.volumes[node] > 0.0 { out.volumes[node] } else { 1.0 };
            out.moduli[node * bodies..(node + 1) * bodies].iter_mut().for_each(|modulus| *modulus /= volume);
        }
        let mut next = out.start.clone();
        out.around = vec![0; out.start[nodes] as usize];
        for (k, cell) in out.cells.iter().enumerate() {
            for node in &cell.nodes[..N] {
                out.around[next[*node as usize] as usize] = k as u32;
                next[*node as usize] += 1;
            }
        }
        out
    }

    fn bodies(&self) -> usize {
        self.layout.stride()
    }

    fn corners<'a>(&'a self, cell: &'a Simplex) -> &'a [u32] {
        &cell.nodes[..D + 1]
    }

    /// F of a cell of a body.
    fn gradient(&self, view: &View<D>, cell: usize, body: usize) -> Matrix<f64, D> {
        let nodes = self.cells[cell].nodes;
        let at = |a: usize, i: usize| view.x[i][self.layout.index(nodes[a] as usize, body)];
        let mut out = matrix::zeros::<f64, D>();
        for i in 0..D {
            for a in 1..=D {
                let from_first = at(a, i) - at(0, i);
                for j in 0..D {
                    out[i][j] += from_first * self.slopes[cell * (D + 1) + a][j];
                }
            }
        }
        out
    }

    /// ∂J/∂F of a cell.
    fn cofactors(&self, view: &View<D>, cell: usize, body: usize) -> Matrix<f64, D> {
        if self.turns { matrix::cofactor(&self.gradient(view, cell, body)) } else { matrix::identity() }
    }

    /// ∂J/∂x of a corner of a cell.
    fn slope(&self, cell: usize, corner: usize, cofactors: &Matrix<f64, D>) -> [f64; D] {
        let own = &self.slopes[cell * (D + 1) + corner];
        core::array::from_fn(|i| (0..D).map(|j| cofactors[i][j] * own[j]).sum())
    }

    /// Records where the scratch of the cells of a solid contains the values J − 1 of the packs of cells.
    pub(super) fn locate(&mut self, grown_at: impl Fn(usize) -> Option<usize>) {
        let offset = |cell: u32| {
            let (pack, lane) = match self.layout {
                Layout::Single => (cell as usize / WIDTH, cell as usize % WIDTH),
                Layout::Batch => (cell as usize, 0),
            };
            (grown_at(pack).unwrap_or(0) + lane) as u32
        };
        self.grown = self.around.iter().map(|cell| offset(*cell)).collect();
    }

    /// The length of the scratch of [`NodalVolumes::press`]: energies and pressures for every block of nodes.
    pub(super) fn scratch_len(&self) -> usize {
        self.starts.len() * (WIDTH + BLOCK * self.bodies())
    }

    /// Computes κₐ (Jₐ − 1) of all nodes from J − 1 of their cells. Returns the energies of the bodies [J].
    pub(super) fn press(&self, threads: usize, grown: &[f64], scratch: &mut [f64]) -> [f64; WIDTH] {
        let bodies = self.bodies();
        each_part(threads, scratch, &self.starts, |block, scratch| {
            let (energies, pressures) = scratch.split_at_mut(WIDTH);
            energies.fill(0.0);
            let nodes = block * BLOCK..((block + 1) * BLOCK).min(self.nodes);
            for (node, pressures) in nodes.zip(pressures.chunks_exact_mut(bodies)) {
                let list = self.start[node] as usize..self.start[node + 1] as usize;
                let mut sums = [0.0; WIDTH];
                for (cell, at) in self.around[list.clone()].iter().zip(&self.grown[list]) {
                    let share = self.cells[*cell as usize].share;
                    for (sum, grown) in sums.iter_mut().zip(&grown[*at as usize..][..bodies]) {
                        *sum += share * grown;
                    }
                }
                let volume = self.volumes[node];
                for (body, pressure) in pressures.iter_mut().enumerate() {
                    let grown = if volume > 0.0 { sums[body] / volume } else { 0.0 };
                    *pressure = self.moduli[node * bodies + body] * grown;
                    energies[body] += 0.5 * volume * *pressure * grown;
                }
            }
        });
        let mut energy = [0.0; WIDTH];
        for start in &self.starts {
            for (sum, own) in energy.iter_mut().zip(&scratch[*start..*start + WIDTH]) {
                *sum += own;
            }
        }
        energy
    }

    /// Returns the results of [`NodalVolumes::press`].
    pub(super) fn pressures<'a>(&self, scratch: &'a [f64]) -> Pressures<'a> {
        Pressures { scratch, bodies: self.bodies() }
    }

    /// The pressure of a cell: the mean over its corners.
    fn pressure(&self, cell: &Simplex, pressures: &Pressures<'_>, body: usize) -> f64 {
        let sum: f64 = self.corners(cell).iter().map(|node| pressures.of(*node as usize)[body]).sum();
        sum / (D + 1) as f64
    }

    /// Visits the nodes of all cells around a node, for every node.
    pub(super) fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        let mut nodes = Vec::new();
        for node in 0..self.nodes {
            nodes.clear();
            for cell in &self.around[self.start[node] as usize..self.start[node + 1] as usize] {
                nodes.extend_from_slice(self.corners(&self.cells[*cell as usize]));
            }
            nodes.sort_unstable();
            nodes.dedup();
            visit(&nodes);
        }
    }

    /// Delivers κ V ∂J/∂x ∂J/∂x for every node. The products of the pressures with the second derivatives of J are delivered with
    /// the cells.
    pub(super) fn hessian(&self, view: &View<D>, sink: &mut dyn Sink<D>) {
        let bodies = self.bodies();
        // The index of a node in the list of nodes around another node.
        let mut seat = vec![u32::MAX; self.nodes];
        let mut around: Vec<(usize, [f64; D])> = Vec::new();
        let mut slopes = vec![[0.0; D]; self.slopes.len()];
        for body in 0..bodies {
            // ∂J/∂x of the corners of all cells.
            for (k, slopes) in slopes.chunks_exact_mut(D + 1).enumerate() {
                let cofactors = self.cofactors(view, k, body);
                for (corner, slope) in slopes.iter_mut().enumerate() {
                    *slope = self.slope(k, corner, &cofactors);
                }
            }
            for node in (0..self.nodes).filter(|node| self.moduli[node * bodies + body] > 0.0) {
                around.clear();
                for cell in &self.around[self.start[node] as usize..self.start[node + 1] as usize] {
                    let (k, own) = (*cell as usize, &self.cells[*cell as usize]);
                    for (other, slope) in self.corners(own).iter().zip(&slopes[k * (D + 1)..]) {
                        let other = *other as usize;
                        if seat[other] == u32::MAX {
                            seat[other] = around.len() as u32;
                            around.push((other, [0.0; D]));
                        }
                        let sum = &mut around[seat[other] as usize].1;
                        (0..D).for_each(|d| sum[d] += own.share * slope[d]);
                    }
                }
                // ∂J/∂x of the node is the sum divided by V.
                let factor = self.moduli[node * bodies + body] / self.volumes[node];
                for (a, u) in &around {
                    for (b, v) in &around {
                        let block = u.map(|x| v.map(|y| factor * x * y));
                        sink.block(self.layout.index(*a, body), self.layout.index(*b, body), block);
                    }
                }
                around.iter().for_each(|(other, _)| seat[*other] = u32::MAX);
            }
        }
    }

    /// Adds the pressure of the nodes to the stresses of the cells of a body.
    pub(super) fn add_stresses(&self, pressures: &Pressures<'_>, body: usize, states: &mut [CellState]) {
        let mut of_cell = std::collections::BTreeMap::new();
        for cell in &self.cells {
            of_cell.insert(cell.number, self.pressure(cell, pressures, body));
        }
        for state in states {
            let pressure = of_cell.get(&state.cell).copied().unwrap_or(0.0);
            (0..3).for_each(|d| state.stress[d][d] += pressure);
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        size_of::<Simplex>() * self.cells.capacity()
            + 8 * (D * self.slopes.capacity() + self.volumes.capacity() + self.moduli.capacity())
            + 4 * (self.start.capacity() + self.around.capacity() + self.grown.capacity())
            + size_of::<usize>() * self.starts.capacity()
    }
}
