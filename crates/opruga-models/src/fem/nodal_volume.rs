//! Volumes of nodes, for linear triangles and tetrahedra near incompressibility.
//!
//! A cell of one point cannot keep its volume and bend too: there are more cells than nodes have axes. So what resists volume
//! beyond λ′ = min(λ, 2μ) sees the volumes of nodes instead, of which there are fewer (Bonet and Burton 1998). A node has of
//! every cell around it an equal share, V/(D + 1), and
//!
//! U = Σₐ ½ κₐ Vₐ (Jₐ − 1)²,  Jₐ = Σ share · det F / Vₐ,  Vₐ = Σ share,  κₐ = Σ share · (λ − λ′) / Vₐ.
//!
//! In every cell that is a stress p in all directions, the mean of κₐ (Jₐ − 1) over its corners, with P = p cof F. Under `linear` det F is 1 + tr (F − 1).
//!
//! Its second derivatives tie every node to those of all cells that share a cell with it: wide rows, no matrix of cells.

use super::boxes::beyond;
use super::material::{Tangent, add_cofactor_derivative, no_tangent};
use super::section::rest_gradient;
use opruga_core::potential::{CellState, Definiteness, Sink};
use opruga_core::state::{Layout, View};
use opruga_math::WIDTH;
use opruga_math::matrix::{self, Matrix};

/// The cells of a body whose nodes resist their volume.
#[derive(Debug)]
pub(super) struct NodalVolumes<const D: usize> {
    layout: Layout,
    /// Whether the law knows of rotations.
    turns: bool,
    /// Nodes of the body.
    nodes: usize,
    cells: Vec<Simplex>,
    /// ∂Nₐ/∂X of the corners of the cells, D + 1 each [1/m].
    slopes: Vec<[f64; D]>,
    /// Vₐ [m³].
    volumes: Vec<f64>,
    /// κₐ [Pa], node by node and body by body.
    moduli: Vec<f64>,
    /// The cells around each node: where its list begins, and the lists.
    start: Vec<u32>,
    around: Vec<u32>,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
struct Simplex {
    /// Its number in the mesh.
    number: u32,
    /// D + 1 of them.
    nodes: [u32; 4],
    /// Its measure over D + 1: what each of its corners has of it [m³].
    share: f64,
}

impl<const D: usize> NodalVolumes<D> {
    /// Of the cells of a mesh, with μ and λ of a cell of a body.
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

    /// F of a cell of a body; without rotations the unit matrix, whose cofactors are those of the law of small strain.
    fn gradient(&self, view: &View<D>, cell: usize, body: usize) -> Matrix<f64, D> {
        let nodes = self.cells[cell].nodes;
        let at = |a: usize, i: usize| view.x[i][self.layout.place(nodes[a] as usize, body)];
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

    /// J − 1 of a cell, and ∂J/∂F.
    fn volume(&self, view: &View<D>, cell: usize, body: usize) -> (f64, Matrix<f64, D>) {
        let f = self.gradient(view, cell, body);
        if !self.turns {
            return (matrix::trace(&f) - D as f64, matrix::identity());
        }
        let cofactors = matrix::cofactor(&f);
        (matrix::determinant_by(&f, &cofactors) - 1.0, cofactors)
    }

    /// ∂J/∂x of a corner of a cell.
    fn slope(&self, cell: usize, corner: usize, cofactors: &Matrix<f64, D>) -> [f64; D] {
        let own = &self.slopes[cell * (D + 1) + corner];
        core::array::from_fn(|i| (0..D).map(|j| cofactors[i][j] * own[j]).sum())
    }

    /// Numbers that [`NodalVolumes::evaluate`] leaves: the pressures of the nodes, and the forces on them.
    pub(super) fn scratch_len(&self) -> usize {
        self.nodes * self.bodies() * (1 + D)
    }

    /// κₐ (Jₐ − 1) of all nodes, node by node and body by body; returns the energies of the bodies [J].
    fn pressures(&self, view: &View<D>, pressures: &mut [f64]) -> [f64; WIDTH] {
        let bodies = self.bodies();
        let mut energy = [0.0; WIDTH];
        pressures.fill(0.0);
        for (body, energy) in energy.iter_mut().enumerate().take(bodies) {
            for (k, cell) in self.cells.iter().enumerate() {
                let (grown, _) = self.volume(view, k, body);
                for node in self.corners(cell) {
                    pressures[*node as usize * bodies + body] += cell.share * grown;
                }
            }
            for node in (0..self.nodes).filter(|node| self.volumes[*node] > 0.0) {
                let (at, volume) = (node * bodies + body, self.volumes[node]);
                let grown = pressures[at] / volume;
                pressures[at] = self.moduli[at] * grown;
                *energy += 0.5 * volume * pressures[at] * grown;
            }
        }
        energy
    }

    /// The pressure of a cell: the mean of its corners'.
    fn pressure(&self, cell: &Simplex, pressures: &[f64], body: usize) -> f64 {
        let sum: f64 = self.corners(cell).iter().map(|node| pressures[*node as usize * self.bodies() + body]).sum();
        sum / (D + 1) as f64
    }

    /// Stresses in all directions, and forces, of all nodes; returns the energies of the bodies [J].
    pub(super) fn evaluate(&self, view: &View<D>, scratch: &mut [f64]) -> [f64; WIDTH] {
        let bodies = self.bodies();
        let (pressures, forces) = scratch.split_at_mut(self.nodes * bodies);
        let energy = self.pressures(view, pressures);
        forces.fill(0.0);
        for body in 0..bodies {
            for (k, cell) in self.cells.iter().enumerate() {
                let measure = cell.share * (D + 1) as f64;
                let pressure = measure * self.pressure(cell, pressures, body);
                let (_, cofactors) = self.volume(view, k, body);
                for (corner, node) in self.corners(cell).iter().enumerate() {
                    let slope = self.slope(k, corner, &cofactors);
                    for d in 0..D {
                        forces[(*node as usize * D + d) * bodies + body] -= pressure * slope[d];
                    }
                }
            }
        }
        energy
    }

    /// The force on a node of a body, after [`NodalVolumes::evaluate`].
    pub(super) fn force(&self, scratch: &[f64], node: usize, body: usize) -> [f64; D] {
        let bodies = self.bodies();
        let forces = &scratch[self.nodes * bodies..];
        core::array::from_fn(|d| forces[(node * D + d) * bodies + body])
    }

    /// Delivers the second derivatives: κ V ∂J/∂x ∂J/∂x of every node, and what the pressures make of those of det F.
    pub(super) fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        let bodies = self.bodies();
        // Where a node lies in the list of those around another.
        let mut seat = vec![u32::MAX; self.nodes];
        let mut around: Vec<(usize, [f64; D])> = Vec::new();
        for body in 0..bodies {
            for node in (0..self.nodes).filter(|node| self.moduli[node * bodies + body] > 0.0) {
                let cells = &self.around[self.start[node] as usize..self.start[node + 1] as usize];
                around.clear();
                for cell in cells {
                    let (k, own) = (*cell as usize, &self.cells[*cell as usize]);
                    let (_, cofactors) = self.volume(view, k, body);
                    for (corner, other) in self.corners(own).iter().enumerate() {
                        let other = *other as usize;
                        if seat[other] == u32::MAX {
                            seat[other] = around.len() as u32;
                            around.push((other, [0.0; D]));
                        }
                        let slope = self.slope(k, corner, &cofactors);
                        let sum = &mut around[seat[other] as usize].1;
                        (0..D).for_each(|d| sum[d] += own.share * slope[d]);
                    }
                }
                // ∂J/∂x is that over V.
                let factor = self.moduli[node * bodies + body] / self.volumes[node];
                for (a, u) in &around {
                    for (b, v) in &around {
                        let block = u.map(|x| v.map(|y| factor * x * y));
                        sink.block(self.layout.place(*a, body), self.layout.place(*b, body), block);
                    }
                }
                around.iter().for_each(|(other, _)| seat[*other] = u32::MAX);
            }
            if keep == Definiteness::Exact && self.turns {
                for k in 0..self.cells.len() {
                    self.bend(view, scratch, k, body, sink);
                }
            }
        }
    }

    /// p V ∂²J/∂x∂x of a cell.
    fn bend(&self, view: &View<D>, scratch: &[f64], k: usize, body: usize, sink: &mut dyn Sink<D>) {
        let cell = &self.cells[k];
        let pressure = cell.share * (D + 1) as f64 * self.pressure(cell, scratch, body);
        let mut tangent: Tangent<f64, D> = no_tangent();
        add_cofactor_derivative(&mut tangent, pressure, &self.gradient(view, k, body));
        let slopes = &self.slopes[k * (D + 1)..(k + 1) * (D + 1)];
        for (a, left) in self.corners(cell).iter().zip(slopes) {
            for (b, right) in self.corners(cell).iter().zip(slopes) {
                let mut block = [[0.0; D]; D];
                for i in 0..D {
                    for m in 0..D {
                        for j in 0..D {
                            for l in 0..D {
                                block[i][m] += left[j] * tangent[i][j][m][l] * right[l];
                            }
                        }
                    }
                }
                sink.block(self.layout.place(*a as usize, body), self.layout.place(*b as usize, body), block);
            }
        }
    }

    /// Adds its pressure to the stresses of the cells of a body.
    pub(super) fn add_stresses(&self, view: &View<D>, body: usize, states: &mut [CellState]) {
        let mut pressures = vec![0.0; self.nodes * self.bodies()];
        self.pressures(view, &mut pressures);
        let mut of_cell = std::collections::BTreeMap::new();
        for cell in &self.cells {
            of_cell.insert(cell.number, self.pressure(cell, &pressures, body));
        }
        for state in states {
            let pressure = of_cell.get(&state.cell).copied().unwrap_or(0.0);
            (0..3).for_each(|d| state.stress[d][d] += pressure);
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        size_of::<Simplex>() * self.cells.capacity()
            + 8 * (D * self.slopes.capacity() + self.volumes.capacity() + self.moduli.capacity())
            + 4 * (self.start.capacity() + self.around.capacity())
    }
}
