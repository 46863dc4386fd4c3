//! The interface between a solid and its cells of one kind.

use super::cell::Cell;
use super::cells::Cells;
use super::kernels::{Contract, Gradients, Group, Positions, Tractions};
use super::refusals::Refusal;
use crate::materials::law::Law;
use crate::materials::points::{MOST_PACKS, PARAMETERS, PackBuffer, Points};
use core::fmt::Debug;
use opruga_core::potential::{CellState, Definiteness, Sink, StencilPack};
use opruga_core::state::{Layout, View};
use opruga_math::{Simd, WIDTH, matrix};

/// The law of a solid, and its parameters.
#[derive(Debug)]
pub(super) struct Matter<const D: usize> {
    pub(super) law: Box<dyn Law<D>>,
    /// The same law in 3D, which gives the out-of-plane stress in plane strain. It is `None` in plane stress and in 3D.
    pub(super) in_space: Option<Box<dyn Law<3>>>,
    /// μ, λ, the material's own parameter and a thermal growth of one, for [`MOST_PACKS`] packs of points.
    pub(super) parameters: Vec<f64>,
}

impl<const D: usize> Matter<D> {
    fn points<'a>(&'a self, count: usize, gradient: &'a [f64]) -> Points<'a> {
        Points { count, gradient, parameters: &self.parameters[..count * PARAMETERS * WIDTH] }
    }
    /// Whether the law may have no value, as in plane stress.
    fn may_refuse(&self) -> bool {
        D == 2 && self.in_space.is_none()
    }
}

/// Cells of any kind.
pub(super) trait Part<const D: usize>: Send + Sync + Debug {
    /// Adds forces. For triangles and tetrahedra, also adds V ψ to eight partial sums for each body.
    fn evaluate(
        &self,
        matter: &Matter<D>,
        simd: Simd,
        view: &View<D>,
        rows: &[f64],
        forces: &mut [f64],
        energy: &mut [f64],
    ) -> Result<(), Refusal>;
    /// Delivers −∂f/∂x.
    fn tangent(&self, matter: &Matter<D>, positions: Positions<'_, D>, keep: Definiteness, sink: &mut dyn Sink<D>);
    /// Stress and volume ratio of the cells of a body.
    fn cell_states(&self, matter: &Matter<D>, positions: Positions<'_, D>, body: usize, out: &mut Vec<CellState>);
    /// Calls `visit` with the nodes of every cell.
    fn stencils(&self, visit: &mut dyn FnMut(&[u32]));
    /// Bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

/// The largest number of points in a cell: that of a hexahedron. The law is evaluated at half of these points at a time.
const MOST_POINTS: usize = 12;

/// The number of points of a pack at which the law is evaluated together.
const fn points_together<C: Cell<D, N>, const D: usize, const N: usize>() -> usize {
    if C::POINTS > MOST_PACKS { C::POINTS / 2 } else { C::POINTS }
}

/// Groups of packs whose tractions are added together: as many as the buffer holds.
fn groups<C: Cell<D, N>, const D: usize, const N: usize>(packs: usize) -> impl Iterator<Item = Group> {
    let together = (8 / C::POINTS).max(1);
    (0..packs)
        .step_by(together)
        .map(move |first| Group { packs: first..(first + together).min(packs), points: 0..C::POINTS })
}

impl<C: Cell<D, N>, const D: usize, const N: usize> Part<D> for Cells<C, D, N> {
    fn evaluate(
        &self,
        matter: &Matter<D>,
        simd: Simd,
        view: &View<D>,
        rows: &[f64],
        forces: &mut [f64],
        energy: &mut [f64],
    ) -> Result<(), Refusal> {
        let positions = Positions { rows, columns: view.x };
        let mut gradient = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut stress = PackBuffer([0.0; MOST_POINTS * 9 * WIDTH]);
        let mut density = PackBuffer([0.0; MOST_PACKS * WIDTH]);
        let points = points_together::<C, D, N>();
        for group in groups::<C, D, N>(self.packs()) {
            for q in (0..C::POINTS).step_by(points) {
                let part = Group { points: q..q + points, ..group.clone() };
                let (of, stress) = (part.len(), &mut stress.0[q * D * D * WIDTH..]);
                simd.run(Gradients { cells: self, group: part, positions, out: &mut gradient.0 });
                matter.law.stress(simd, matter.points(of, &gradient.0), &mut density.0, stress);
                if matter.may_refuse()
                    && let Some(at) = density.0[..of * WIDTH].iter().position(|psi| psi.is_nan())
                    && let Some((cell, _)) = self.item(group.packs.start + at / WIDTH / points, at % WIDTH)
                    && gradient.0.iter().all(|f| f.is_finite())
                {
                    return Err(Refusal::NoThickness { cell: self.first + cell, time: view.time });
                }
            }
            simd.run(Tractions { cells: self, group: group.clone(), stress: &stress.0, forces });
            if C::SIMPLEX {
                for (number, pack) in group.packs.enumerate() {
                    let slot = if self.layout == Layout::Single { 0 } else { pack % WIDTH };
                    for l in 0..WIDTH {
                        energy[slot * WIDTH + l] += self.volume[pack * WIDTH + l] * density.0[number * WIDTH + l];
                    }
                }
            }
        }
        Ok(())
    }

    fn tangent(&self, matter: &Matter<D>, positions: Positions<'_, D>, keep: Definiteness, sink: &mut dyn Sink<D>) {
        let simd = Simd::best();
        let mut gradient = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut tangent = vec![0.0; MOST_PACKS * 81 * WIDTH];
        let mut blocks = vec![0.0; N * N * D * D * WIDTH];
        let stride = self.layout.stride() as u32;
        let points = points_together::<C, D, N>();
        for pack in 0..self.packs() {
            blocks.fill(0.0);
            for q in (0..C::POINTS).step_by(points) {
                let group = Group { packs: pack..pack + 1, points: q..q + points };
                simd.run(Gradients { cells: self, group: group.clone(), positions, out: &mut gradient.0 });
                matter.law.tangent(simd, matter.points(group.len(), &gradient.0), keep, &mut tangent);
                simd.run(Contract { cells: self, group, tangent: &tangent, blocks: &mut blocks });
            }
            let count = (0..WIDTH).filter(|lane| self.item(pack, *lane).is_some()).count();
            let mut indices = [[0; WIDTH]; N];
            for a in 0..N {
                for (lane, index) in indices[a].iter_mut().enumerate() {
                    let body = if self.layout == Layout::Batch { lane as u32 } else { 0 };
                    *index = self.nodes[(pack * N + a) * WIDTH + lane] * stride + body;
                }
            }
            if C::SIMPLEX {
                sink.stencils(&StencilPack { nodes: N, count, indices: indices.as_flattened(), blocks: &blocks });
                continue;
            }
            for lane in 0..count {
                for a in 0..N {
                    for b in 0..N {
                        let block = |i: usize, j: usize| blocks[(((a * N + b) * D + i) * D + j) * WIDTH + lane];
                        let block = core::array::from_fn(|i| core::array::from_fn(|j| block(i, j)));
                        sink.block(indices[a][lane] as usize, indices[b][lane] as usize, block);
                    }
                }
            }
        }
    }

    fn cell_states(&self, matter: &Matter<D>, positions: Positions<'_, D>, body: usize, out: &mut Vec<CellState>) {
        let simd = Simd::best();
        let turns = matter.law.turns();
        let mut gradient = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut raised = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut stress = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut density = PackBuffer([0.0; MOST_PACKS * WIDTH]);
        let mut across = PackBuffer([1.0; MOST_PACKS * WIDTH]);
        let points = points_together::<C, D, N>();
        for pack in 0..self.packs() {
            let mut sums = [([[0.0; 3]; 3], 0.0, f64::INFINITY); WIDTH];
            for q in (0..C::POINTS).step_by(points) {
                let group = Group { packs: pack..pack + 1, points: q..q + points };
                simd.run(Gradients { cells: self, group: group.clone(), positions, out: &mut gradient.0 });
                let asked = matter.points(group.len(), &gradient.0);
                let axes = if let Some(law) = &matter.in_space {
                    raise::<D>(&gradient.0, group.len(), &mut raised.0);
                    law.stress(simd, Points { gradient: &raised.0, ..asked }, &mut density.0, &mut stress.0);
                    3
                } else {
                    matter.law.stress(simd, asked, &mut density.0, &mut stress.0);
                    matter.law.thickness(simd, asked, &mut across.0);
                    D
                };
                for (l, (sum, ratios, smallest)) in sums.iter_mut().enumerate() {
                    for q in 0..group.len() {
                        let f = |i: usize, j: usize| match (i < D, j < D) {
                            (true, true) => gradient.0[(q * D * D + i * D + j) * WIDTH + l],
                            _ if i == j => across.0[q * WIDTH + l],
                            _ => 0.0,
                        };
                        let ratio = matrix::determinant(&core::array::from_fn::<_, 3, _>(|i| {
                            core::array::from_fn::<_, 3, _>(|j| f(i, j))
                        }));
                        *ratios += ratio;
                        // NaN is kept.
                        *smallest = if ratio < *smallest || ratio.is_nan() { ratio } else { *smallest };
                        for i in 0..axes {
                            for j in 0..3 {
                                for k in 0..axes {
                                    let along = if turns { f(j, k) } else { f64::from(u8::from(j == k)) };
                                    sum[i][j] += stress.0[(q * axes * axes + i * axes + k) * WIDTH + l] * along;
                                }
                            }
                        }
                    }
                }
            }
            for (l, (sum, ratios, smallest)) in sums.iter().enumerate() {
                let Some((cell, _)) = self.item(pack, l).filter(|(_, of)| *of == body) else { continue };
                // ∫ P Fᵀ over the rest shape equals ∫ σ over the present shape. A law for small motions has only one shape.
                let over = if turns { *ratios } else { C::POINTS as f64 };
                out.push(CellState {
                    cell: (self.first + cell) as u32,
                    stress: sum.map(|row| row.map(|s| s / over)),
                    volume_ratio: ratios / C::POINTS as f64,
                    smallest_volume_ratio: *smallest,
                    measure: self.volume[pack * WIDTH + l],
                });
            }
        }
    }

    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.list.iter().for_each(|cell| visit(cell));
    }
    fn heap_bytes(&self) -> usize {
        Cells::heap_bytes(self)
    }
}

/// Deformation gradients in space, without motion out of the plane.
fn raise<const D: usize>(plane: &[f64], points: usize, space: &mut [f64]) {
    for point in 0..points {
        for i in 0..3 {
            for j in 0..3 {
                let to = &mut space[(point * 9 + i * 3 + j) * WIDTH..][..WIDTH];
                match (i < D && j < D, i == j) {
                    (true, _) => to.copy_from_slice(&plane[(point * D * D + i * D + j) * WIDTH..][..WIDTH]),
                    (false, diagonal) => to.fill(f64::from(u8::from(diagonal))),
                }
            }
        }
    }
}
