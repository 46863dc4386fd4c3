//! Passes over the elements of a section: forces, matrices, stresses.
//!
//! All passes process a few packs of elements at a time: they write deformation gradients to a buffer, apply a law to the buffer,
//! and compute their results from it.

use super::boxes::{self, Deform, DeformRates, KEPT, Of, Push, Rates};
use super::contraction::{Contract, ContractInvariants, ContractPrincipal};
use super::elements::Shape;
use super::group::Group;
use super::nodal_volume::Pressures;
use super::pressures::{Means, PressedStress, PressedTangents};
use super::section::{Section, Share};
use super::totals::Totals;
use super::work::{Forces, Gradients, Nodes, ViscousStress, ViscousTangents, parameters_of_points};
use crate::materials::law::Form;
use crate::materials::points::{MOST_PACKS, PARAMETERS, PackBuffer, Points};
use core::marker::PhantomData;
use core::ops::Range;
use opruga_core::error::StepError;
use opruga_core::potential::{CellState, Definiteness, StencilPack, StencilPacks};
use opruga_core::state::{Layout, View};
use opruga_math::{Simd, WIDTH};

/// The number of packs of points whose tangents are kept at a time if elements have one point. That many tangents fit into the
/// first-level cache.
const TANGENTS: usize = 4;

/// The largest number of packs of boxes that are processed together. The instructions of all steps of a pass over hexahedra do not
/// fit into the first-level cache, so every step works on two packs before the next one begins.
const MOST_BOXES: usize = 2;

/// The largest number of packs of points whose data a pass keeps.
const MOST_POINTS: usize = MOST_BOXES * MOST_PACKS;

/// A pass, with the buffers that it needs.
pub(super) struct Pass<'a, E, const D: usize, const N: usize> {
    section: &'a Section<E, D, N>,
    simd: Simd,
    gradient: PackBuffer<{ MOST_POINTS * 9 * WIDTH }>,
    /// The data that are kept for boxes.
    kept: PackBuffer<{ MOST_BOXES * KEPT * WIDTH }>,
    numbers: PackBuffer<{ MOST_POINTS * PARAMETERS * WIDTH }>,
    times: PackBuffer<{ MOST_POINTS * WIDTH }>,
    /// Pressures of cells whose nodes resist changes of volume.
    pressures: PackBuffer<{ MOST_PACKS * WIDTH }>,
}

/// The largest number of packs of points whose forces are computed together.
fn most_points<E: Shape<D, N>, const D: usize, const N: usize>(section: &Section<E, D, N>) -> usize {
    if E::BOX { MOST_BOXES * section.points } else { MOST_PACKS }
}

/// The buffers that only the forces of a damped section need.
struct DampingBuffers {
    rate: PackBuffer<{ MOST_POINTS * 9 * WIDTH }>,
    kept_rate: PackBuffer<{ MOST_BOXES * KEPT * WIDTH }>,
    power: PackBuffer<{ MOST_POINTS * WIDTH }>,
}

impl DampingBuffers {
    fn new() -> Self {
        DampingBuffers {
            rate: PackBuffer([0.0; MOST_POINTS * 9 * WIDTH]),
            kept_rate: PackBuffer([0.0; MOST_BOXES * KEPT * WIDTH]),
            power: PackBuffer([0.0; MOST_POINTS * WIDTH]),
        }
    }
}

/// What a matrix is computed from: tangents at the points, or damping.
#[derive(Clone, Copy, Debug)]
enum Matrix {
    Hessian(Definiteness),
    Damping,
}

impl<'a, E: Shape<D, N>, const D: usize, const N: usize> Pass<'a, E, D, N> {
    pub(super) fn new(section: &'a Section<E, D, N>, simd: Simd) -> Self {
        let mut pass = Pass {
            section,
            simd,
            gradient: PackBuffer([0.0; MOST_POINTS * 9 * WIDTH]),
            kept: PackBuffer([0.0; MOST_BOXES * KEPT * WIDTH]),
            numbers: PackBuffer([0.0; MOST_POINTS * PARAMETERS * WIDTH]),
            times: PackBuffer([0.0; MOST_POINTS * WIDTH]),
            pressures: PackBuffer([0.0; MOST_PACKS * WIDTH]),
        };
        // Parameters that hold for all elements are written once.
        if section.uniform && section.packs() > 0 {
            let together = (most_points(section) / section.points).max(1);
            pass.read_parameters(&section.group(0, together));
        }
        pass
    }

    fn read_parameters(&mut self, group: &Group<'_>) {
        parameters_of_points(group, E::POINTS, &mut self.numbers.0, &mut self.times.0);
    }

    /// Computes deformation gradients and parameters at the points of some packs of elements.
    fn deform(&mut self, group: &Group<'_>, nodes: Nodes<'_, D>, pressures: Pressures<'_>) {
        let (of, shape, gradient) = (*group, PhantomData, &mut self.gradient.0);
        if E::BOX {
            let kept = &mut self.kept.0;
            self.simd.run(Deform::<E, D, N> { shape, group: of, positions: nodes, gradient, kept });
        } else {
            self.simd.run(Gradients::<E, D, N> { shape, group: of, nodes, gradient });
        }
        if E::SIMPLEX && self.section.nodal && !pressures.is_empty() {
            let means = &mut self.pressures.0;
            self.simd.run(Means::<E, D, N> { shape, group: of, nodes, pressures, means });
        }
        if !self.section.uniform {
            self.read_parameters(group);
        }
    }

    fn points(&self, group: &Group<'_>) -> Points<'_> {
        Points { count: group.packs * group.points, gradient: &self.gradient.0, parameters: &self.numbers.0 }
    }

    /// Adds the forces and totals of a share.
    pub(super) fn forces(
        mut self,
        share: &Share,
        view: &View<D>,
        [positions, velocities]: [Nodes<'_, D>; 2],
        pressures: Pressures<'_>,
        totals: &mut Totals,
        force: &mut [f64],
    ) -> Result<(), StepError> {
        let (section, simd) = (self.section, self.simd);
        let mut damping = section.damped.then(DampingBuffers::new);
        let mut stress = PackBuffer([0.0; MOST_POINTS * 9 * WIDTH]);
        let mut density = PackBuffer([0.0; MOST_POINTS * WIDTH]);
        for group in section.groups(share, most_points(section)) {
            self.deform(&group, positions, pressures);
            let points = self.points(&group);
            for (k, points) in points.chunks::<D>().enumerate() {
                let first = k * MOST_PACKS * WIDTH;
                section.law.stress(simd, points, &mut density.0[first..], &mut stress.0[first * D * D..]);
            }
            if section.nodal {
                let (turns, pressures, stress) = (group.turns, &self.pressures.0, &mut stress.0);
                simd.run(PressedStress::<D> { points, turns, pressures, stress });
            }
            if let Some(DampingBuffers { rate, kept_rate, power }) = &mut damping {
                let (shape, nodes, gradient, times) = (PhantomData, velocities, &mut rate.0, &self.times.0);
                if E::BOX {
                    let (kept, kept_rate, rate) = (&self.kept.0, &mut kept_rate.0, gradient);
                    simd.run(DeformRates::<E, D, N> { shape, group, velocities: nodes, kept, rate, kept_rate });
                } else {
                    simd.run(Gradients::<E, D, N> { shape, group, nodes, gradient });
                }
                let (stress, power) = (&mut stress.0, &mut power.0);
                simd.run(ViscousStress::<D> { points, rate: &rate.0, times, stress, power });
            }
            let (shape, stress, density, force) = (PhantomData, &stress.0, &mut density.0, &mut *force);
            if E::BOX {
                let (kept, times) = (&self.kept.0, &self.times.0);
                let rates = damping.as_mut().map(|of| Rates { kept: &of.kept_rate.0, times, power: &mut of.power.0 });
                simd.run(Push::<E, D, N> { shape, group, kept, stress, density, rates, force });
            } else {
                let power = damping.as_mut().map(|of| &mut of.power.0[..]);
                simd.run(Forces::<E, D, N> { shape, group, stress, density, power, force });
            }
            for k in 0..group.packs {
                let row = match section.layout {
                    Layout::Single => 0,
                    Layout::Batch => (group.first + k) % WIDTH,
                };
                let energy = &density[k * WIDTH..(k + 1) * WIDTH];
                for (total, energy) in totals.energy[row].iter_mut().zip(energy) {
                    *total += energy;
                }
                if let Some(DampingBuffers { power, .. }) = &damping {
                    for (total, power) in totals.power[row].iter_mut().zip(&power.0[k * WIDTH..]) {
                        *total += power;
                    }
                }
                if section.may_refuse()
                    && energy.iter().any(|energy| energy.is_nan())
                    && let Some(refusal) = section.refusal(view, group.first + k, energy)
                {
                    return Err(refusal);
                }
            }
        }
        Ok(())
    }

    /// Delivers the matrices of every pack of the share that contains one of the given nodes.
    fn assemble(
        &mut self,
        share: &Share,
        positions: Nodes<'_, D>,
        pressures: Pressures<'_>,
        matrix: Matrix,
        rows: &Range<usize>,
        to: &mut dyn FnMut(usize, &StencilPack<'_>),
    ) {
        let (section, simd) = (self.section, self.simd);
        let mut tangent = PackBuffer([0.0; MOST_PACKS * 81 * WIDTH]);
        let tangent = &mut tangent.0;
        let mut stress = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut density = PackBuffer([0.0; MOST_PACKS * WIDTH]);
        let mut blocks = vec![0.0; N * N * D * D * WIDTH];
        for group in section.groups(share, TANGENTS) {
            let mut indices = [[[0; WIDTH]; N]; TANGENTS];
            let mut wanted = [false; TANGENTS];
            for pack in 0..group.packs {
                indices[pack] = section.indices(group.first + pack);
                wanted[pack] = indices[pack].as_flattened().iter().any(|index| rows.contains(&(*index as usize)));
            }
            if wanted == [false; TANGENTS] {
                continue;
            }
            self.deform(&group, positions, pressures);
            let points = self.points(&group);
            // The products of the pressures with the second derivatives of J may have negative eigenvalues.
            let pressed = section.nodal && group.turns && matches!(matrix, Matrix::Hessian(Definiteness::Exact));
            let form = match matrix {
                Matrix::Hessian(keep) if E::SIMPLEX && !pressed => {
                    section.law.short_tangent(simd, points, keep, tangent)
                }
                Matrix::Hessian(keep) => {
                    section.law.tangent(simd, points, keep, tangent);
                    Form::Whole
                }
                Matrix::Damping => {
                    simd.run(ViscousTangents::<D> { points, times: &self.times.0, tangent });
                    Form::Whole
                }
            };
            if pressed {
                simd.run(PressedTangents::<D> { points, pressures: &self.pressures.0, tangent });
            }
            // Boxes rotate and stretch the strains of their points, so the stress is needed too.
            if E::BOX && matches!(matrix, Matrix::Hessian(Definiteness::Exact)) {
                section.law.stress(simd, points, &mut density.0, &mut stress.0);
            }
            for pack in (0..group.packs).filter(|pack| wanted[*pack]) {
                let (shape, blocks) = (PhantomData, &mut blocks);
                if E::BOX {
                    let of = match matrix {
                        Matrix::Hessian(keep) => Of::Energy(keep),
                        Matrix::Damping => Of::Damping,
                    };
                    let (kept, stress, times) = (&self.kept.0, &stress.0, &self.times.0);
                    simd.run(boxes::Contract::<E, D, N> {
                        shape,
                        group,
                        pack,
                        of,
                        kept,
                        stress,
                        tangent,
                        times,
                        blocks,
                    });
                } else {
                    match form {
                        Form::Whole => simd.run(Contract::<E, D, N> { shape, group, pack, tangent, blocks }),
                        Form::Principal => {
                            simd.run(ContractPrincipal::<E, D, N> { shape, group, pack, principal: tangent, blocks })
                        }
                        Form::Invariants => {
                            let gradient = points.gradient;
                            simd.run(ContractInvariants::<E, D, N> {
                                shape,
                                group,
                                pack,
                                gradient,
                                invariants: tangent,
                                blocks,
                            });
                        }
                    }
                }
                let count = group.present(group.first + pack);
                let indices = indices[pack].as_flattened();
                to(group.first + pack, &StencilPack { nodes: N, count, indices, blocks });
            }
        }
    }

    /// Stress and volume ratio of the cells of a share, of one body.
    pub(super) fn cell_states(mut self, share: &Share, positions: Nodes<'_, D>, body: usize, out: &mut Vec<CellState>) {
        let (section, simd, turns) = (self.section, self.simd, self.section.law.turns());
        let mut in_space = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut stress = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let mut density = PackBuffer([0.0; MOST_PACKS * WIDTH]);
        let mut across = PackBuffer([1.0; MOST_PACKS * WIDTH]);
        for group in section.groups(share, 1) {
            self.deform(&group, positions, Pressures::default());
            let points = self.points(&group);
            // Stresses have three rows and columns if the law in space is evaluated.
            let axes = if let Some(law) = &section.law_in_space {
                raise::<D>(&self.gradient.0, section.points, &mut in_space.0);
                law.stress(simd, Points { gradient: &in_space.0, ..points }, &mut density.0, &mut stress.0);
                3
            } else {
                section.law.stress(simd, points, &mut density.0, &mut stress.0);
                // Forces in plane stress refer to the rest thickness, the Cauchy stress to the present thickness.
                section.law.thickness(simd, points, &mut across.0);
                D
            };
            for l in 0..WIDTH {
                let (element, of) = section.item(group.first, l);
                let Some(cell) = section.cells.get(element).filter(|_| of == body) else { continue };
                let at = |node: u32, axis: usize| positions.columns[axis][section.layout.index(node as usize, body)];
                let (mut measure, mut sum, mut now) = (0.0, [[0.0; 3]; 3], 0.0);
                let mut smallest = f64::INFINITY;
                // NaN is kept.
                let mut look =
                    |ratio: f64| smallest = if ratio < smallest || ratio.is_nan() { ratio } else { smallest };
                for q in 0..section.points {
                    let weight = section.measure(group.first, q, l);
                    let f = |i: usize, j: usize| match (i < D, j < D) {
                        (true, true) => self.gradient.0[(q * D * D + i * D + j) * WIDTH + l],
                        _ if i == j => across.0[q * WIDTH + l],
                        _ => 0.0,
                    };
                    let matrix: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| f(i, j)));
                    let ratio = opruga_math::matrix::determinant(&matrix);
                    look(ratio);
                    // The mean of a box repeats its points, so it is not counted again.
                    if q < E::POINTS {
                        measure += weight;
                        now += weight * ratio;
                    }
                    // ∫ P Fᵀ over the rest shape equals ∫ σ over the present shape. A law for small motions has only one shape
                    // and one symmetric stress.
                    for i in 0..axes {
                        for j in 0..3 {
                            for k in 0..axes {
                                let along = if turns { f(j, k) } else { f64::from(u8::from(j == k)) };
                                sum[i][j] += weight * stress.0[(q * axes * axes + i * axes + k) * WIDTH + l] * along;
                            }
                        }
                    }
                }
                // In boxes, F at the points contains bending in the form that the mean gradient has transformed. Its
                // determinant may be positive where the cell itself is inverted, so the true J is checked too.
                for (q, slopes) in E::SLOPES.iter().enumerate().filter(|_| E::BOX) {
                    let side = |i: usize, j: usize| match (i < D, j < D) {
                        (true, true) => (0..N).map(|a| at(cell.nodes[a], i) * slopes[a][j]).sum(),
                        _ if i == j => across.0[q * WIDTH + l],
                        _ => 0.0,
                    };
                    let sides = core::array::from_fn(|i| core::array::from_fn(|j| side(i, j)));
                    let rest = section.measure(group.first, q, l) / (E::WEIGHTS[q] * section.thickness);
                    look(opruga_math::matrix::determinant::<f64, 3>(&sides) / rest);
                }
                let over = if turns { now } else { measure };
                let stress = sum.map(|row| row.map(|s| s / over));
                let (cell, volume_ratio) = (cell.number, now / measure);
                // A simplex has only one J. It is taken from the mean, so that both values have the same rounding.
                let smallest_volume_ratio = if E::SIMPLEX { volume_ratio } else { smallest };
                out.push(CellState { cell, stress, volume_ratio, smallest_volume_ratio, measure });
            }
        }
    }
}

/// The matrices of the elements of a section in the last evaluated state.
#[derive(Debug)]
pub(super) struct Matrices<'a, E, const D: usize, const N: usize> {
    section: &'a Section<E, D, N>,
    view: &'a View<'a, D>,
    pressures: Pressures<'a>,
    scratch: &'a [f64],
    matrix: Matrix,
}

impl<'a, E: Shape<D, N>, const D: usize, const N: usize> Matrices<'a, E, D, N> {
    /// ∂²U/∂x∂x.
    pub(super) fn hessian(
        section: &'a Section<E, D, N>,
        view: &'a View<'a, D>,
        pressures: Pressures<'a>,
        scratch: &'a [f64],
        keep: Definiteness,
    ) -> Self {
        Matrices { section, view, pressures, scratch, matrix: Matrix::Hessian(keep) }
    }
    /// −∂F/∂v.
    pub(super) fn damping(section: &'a Section<E, D, N>, view: &'a View<'a, D>, scratch: &'a [f64]) -> Self {
        // Damping does not depend on the pressures.
        Matrices { section, view, pressures: Pressures::default(), scratch, matrix: Matrix::Damping }
    }
}

impl<E: Shape<D, N>, const D: usize, const N: usize> StencilPacks<D> for Matrices<'_, E, D, N> {
    fn nodes(&self) -> usize {
        N
    }
    fn stencils(&self) -> usize {
        self.section.cells.len() * self.section.layout.stride()
    }
    fn are_at(&self, indices: &[u32]) -> bool {
        let packs = indices.chunks(N * WIDTH);
        packs.len() == self.section.packs()
            && packs.enumerate().all(|(pack, indices)| self.section.indices(pack).as_flattened() == indices)
    }
    fn deliver(&self, rows: &Range<usize>, to: &mut dyn FnMut(usize, &StencilPack<'_>)) {
        let stride = self.section.layout.stride();
        let mut pass = Pass::new(self.section, Simd::best());
        for share in &self.section.shares {
            let from = share.nodes.partition_point(|node| (*node as usize + 1) * stride <= rows.start);
            if share.nodes.get(from).is_some_and(|node| *node as usize * stride < rows.end) {
                let positions = self.section.positions(share, self.view, self.scratch);
                pass.assemble(share, positions, self.pressures, self.matrix, rows, to);
            }
        }
    }
}

/// Extends deformation gradients in the plane to space, without motion out of the plane.
fn raise<const D: usize>(plane: &[f64], points: usize, space: &mut [f64]) {
    space.fill(0.0);
    for q in 0..points {
        for l in 0..WIDTH {
            let mut put = |i: usize, j: usize, value: f64| space[(q * 9 + i * 3 + j) * WIDTH + l] = value;
            put(2, 2, 1.0);
            for i in 0..D {
                for j in 0..D {
                    put(i, j, plane[(q * D * D + i * D + j) * WIDTH + l]);
                }
            }
        }
    }
}
