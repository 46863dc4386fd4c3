//! Forces and Hessians, compared with finite differences.

use super::Suite;
use super::case::{Answer, Body, Case, by_node, difference, largest, mean_edge};
use super::random::Random;
use crate::potential::{Definiteness, DensePart, Potential, Sink};
use crate::state::{Columns, Layout};
use opruga_math::{Lane, Simd, WIDTH, sum_in_fixed_order};

/// The Hessian of one body as a full matrix.
pub(super) struct Assembled<const D: usize> {
    size: usize,
    layout: Layout,
    entries: Vec<f64>,
}

impl<const D: usize> Assembled<D> {
    fn row(&self, index: usize, d: usize) -> Option<usize> {
        match self.layout {
            Layout::Single => Some(index * D + d),
            // The first of eight bodies.
            Layout::Batch if index.is_multiple_of(WIDTH) => Some(index / WIDTH * D + d),
            Layout::Batch => None,
        }
    }
    fn empty(case: &Case<D>) -> Assembled<D> {
        let size = case.nodes * D;
        Assembled::<D> { size, layout: case.layout, entries: vec![0.0; size * size] }
    }
    pub(super) fn of(case: &Case<D>, keep: Definiteness) -> Vec<f64> {
        let mut sink = Assembled::empty(case);
        case.potential.hessian(&case.view(), &case.scratch, keep, &mut sink);
        sink.entries
    }
    pub(super) fn of_damping(case: &Case<D>) -> Vec<f64> {
        let mut sink = Assembled::empty(case);
        case.potential.damping_matrix(&case.view(), &case.scratch, &mut sink);
        sink.entries
    }
}

/// Counts the entries of a Hessian that couple nodes without a declared stencil.
struct Undeclared {
    nodes: usize,
    stride: usize,
    declared: Vec<bool>,
    count: usize,
}

impl Undeclared {
    fn of<const D: usize>(case: &Case<D>) -> usize {
        let nodes = case.nodes;
        let mut declared = vec![false; nodes * nodes];
        case.potential.stencils(&mut |stencil| {
            for a in stencil {
                stencil.iter().for_each(|b| declared[*a as usize * nodes + *b as usize] = true);
            }
        });
        let mut sink = Undeclared { nodes, stride: case.layout.stride(), declared, count: 0 };
        case.potential.hessian(&case.view(), &case.scratch, Definiteness::Exact, &mut sink);
        sink.count
    }
}

impl<const D: usize> Sink<D> for Undeclared {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        let (a, b) = (a / self.stride, b / self.stride);
        let coupled = a != b && value.iter().flatten().any(|entry| *entry != 0.0);
        self.count += usize::from(coupled && !self.declared[a * self.nodes + b]);
    }
    // A coupling of all nodes is not a stencil.
    fn low_rank(&mut self, _: f64, _: &[(usize, [f64; D])]) {}
    fn dense(&mut self, _: &DensePart<'_, D>) {}
}

impl<const D: usize> Sink<D> for Assembled<D> {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                if let (Some(p), Some(q)) = (self.row(a, i), self.row(b, j)) {
                    self.entries[p * self.size + q] += value[i][j];
                }
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        for (a, ua) in u {
            for (b, ub) in u {
                self.block(*a, *b, core::array::from_fn(|i| core::array::from_fn(|j| c * ua[i] * ub[j])));
            }
        }
    }
}

/// Whether a symmetric matrix plus a small multiple of the unit matrix has a Cholesky factor.
fn is_positive(matrix: &[f64], size: usize, shift: f64) -> bool {
    let mut l = matrix.to_vec();
    for i in 0..size {
        for j in 0..=i {
            let mut sum = l[i * size + j] + if i == j { shift } else { 0.0 };
            for k in 0..j {
                sum -= l[i * size + k] * l[j * size + k];
            }
            if i == j {
                if sum.is_nan() || sum <= 0.0 {
                    return false;
                }
                l[i * size + i] = sum.sqrt();
            } else {
                l[i * size + j] = sum / l[j * size + j];
            }
        }
    }
    true
}

impl<const D: usize> Suite<'_, D> {
    pub(super) fn gradient(
        &self,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = self.bodies[0].still();
        let h = 2e-4 * mean_edge(self.mesh) * Lane::smaller(self.options.stretch, 1.0);
        let mut case = self.case(potential, &body);
        let (force, _) = case.plain(best)?;
        let mut expected = Vec::new();
        for node in 0..case.nodes {
            for d in 0..D {
                let at = case.x.0[d][node];
                let mut energy = |shift: f64| -> Answer<f64> {
                    case.x.0[d][node] = at + shift;
                    let energy = case.energy(best)?;
                    case.x.0[d][node] = at;
                    Ok(sum_in_fixed_order(&energy))
                };
                let inner = energy(h)? - energy(-h)?;
                let outer = energy(2.0 * h)? - energy(-2.0 * h)?;
                expected.push(-(8.0 * inner - outer) / (12.0 * h));
            }
        }
        let force: Vec<f64> = force.into_iter().flatten().collect();
        add("gradient", difference(&expected, &force, 1e-300), self.options.gradient_tolerance);
        Ok(())
    }

    pub(super) fn hessian(
        &self,
        random: &mut Random,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let body = self.bodies[0].still();
        let h = 2e-4 * mean_edge(self.mesh) * Lane::smaller(self.options.stretch, 1.0);
        let mut case = self.case(potential, &body);
        case.prepare(best)?;
        let matrix = Assembled::of(&case, Definiteness::Exact);
        let clamped = Assembled::of(&case, Definiteness::Clamped);
        let size = case.nodes * D;
        let scale = largest(&matrix);

        // Finite differences of forces, column by column.
        let mut expected = vec![0.0; size * size];
        for node in 0..case.nodes {
            for d in 0..D {
                let at = case.x.0[d][node];
                for (shift, weight) in [(h, -8.0), (-h, 8.0), (2.0 * h, 1.0), (-2.0 * h, -1.0)] {
                    case.x.0[d][node] = at + shift;
                    let (force, _) = case.plain(best)?;
                    for (row, f) in force.iter().flatten().enumerate() {
                        expected[row * size + node * D + d] += weight * f / (12.0 * h);
                    }
                }
                case.x.0[d][node] = at;
            }
        }
        case.prepare(best)?;
        add("hessian", difference(&expected, &matrix, 1e-300), self.options.hessian_tolerance);
        let transposed: Vec<f64> = (0..size * size).map(|k| matrix[k % size * size + k / size]).collect();
        if potential.properties().views.symmetric {
            add("symmetry", difference(&transposed, &matrix, 1e-300), 1e-11);
        }
        add("stencils", Undeclared::of(&case) as f64, 0.0);

        // The product with a vector, for one body and for eight.
        let all = self.build(None)?;
        let bodies: Vec<Body<D>> = self.bodies.iter().map(Body::still).collect();
        let mut eight = Case::new(&*all, Layout::Batch, &bodies.iter().collect::<Vec<_>>(), self.options.time);
        eight.prepare(best)?;
        let direction: Vec<f64> = (0..size).map(|_| random.signed()).collect();
        let assembled: Vec<f64> =
            (0..size).map(|p| (0..size).map(|q| matrix[p * size + q] * direction[q]).sum::<f64>()).collect();
        for case in [&case, &eight] {
            let length = case.index_count();
            let (mut along, mut out) = (Columns::<D>::zeros(length), Columns::<D>::zeros(length));
            for node in 0..case.nodes {
                let row = core::array::from_fn(|d| direction[node * D + d]);
                along.set(case.layout.index(node, 0), row);
            }
            let mut columns = out.0.each_mut().map(|c| &mut **c);
            case.potential.add_hessian_product(&case.view(), &case.scratch, &along.slices(), &mut columns);
            let product: Vec<f64> = by_node(&out, case.layout, case.nodes, 0).into_iter().flatten().collect();
            add("product", difference(&product, &assembled, scale), 1e-12);
        }
        let of_eight = Assembled::of(&eight, Definiteness::Exact);
        add("product", difference(&of_eight, &matrix, 1e-300), 1e-12);

        // If the tangent is not symmetric, clamped stresses do not give a positive matrix.
        if !potential.properties().views.symmetric {
            return Ok(());
        }
        let negative = scale > 0.0 && !is_positive(&clamped, size, 1e-9 * largest(&clamped) + 1e-300);
        add("clamped", if negative { 1.0 } else { 0.0 }, 0.0);
        Ok(())
    }

    pub(super) fn damping_matrix(
        &self,
        potential: &dyn Potential<D>,
        add: &mut dyn FnMut(&'static str, f64, f64),
    ) -> Answer<()> {
        let best = Simd::best();
        let mut case = self.case(potential, &self.bodies[0]);
        let size = case.nodes * D;
        let h = largest(case.v.0.iter().flat_map(|column| column.iter()));
        let mut expected = vec![0.0; size * size];
        for node in 0..case.nodes {
            for d in 0..D {
                let at = case.v.0[d][node];
                for (shift, weight) in [(h, -1.0), (-h, 1.0)] {
                    case.v.0[d][node] = at + shift;
                    let (force, _) = case.plain(best)?;
                    for (row, f) in force.iter().flatten().enumerate() {
                        expected[row * size + node * D + d] += weight * f / (2.0 * h);
                    }
                }
                case.v.0[d][node] = at;
            }
        }
        case.prepare(best)?;
        let matrix = Assembled::of_damping(&case);
        // Forces at rest cancel in the differences, but their rounding remains.
        let rest = 1e-8 * largest(case.plain(best)?.0.iter().flatten()) / h;
        add("damping matrix", difference(&expected, &matrix, rest), 1e-7);

        let all = self.build(None)?;
        let mut eight = Case::new(&*all, Layout::Batch, &self.bodies.iter().collect::<Vec<_>>(), self.options.time);
        eight.prepare(best)?;
        add("damping matrix", difference(&Assembled::of_damping(&eight), &matrix, 1e-300), 1e-12);
        Ok(())
    }
}
