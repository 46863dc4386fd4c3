//! The direction of an iteration: (σM + βC + K) Δ = b in the free directions.

use super::settings::{Settings, Solver};
use opruga_core::potential::{Definiteness, DensePart, Sink};
use opruga_core::system::{Stage, System};
use opruga_math::Lane;
use opruga_solve::blocks::{Block, constrained_block, isotropic, nodes, nodes_mut, times};
use opruga_solve::{
    BlockJacobi, BlockMatrix, Cholesky, Directions, Factors, FilledCholesky, IncompleteCholesky, Indefinite,
    Preconditioner, conjugate_gradients,
};

/// The matrix of an iteration, and its solvers.
#[derive(Debug, Default)]
pub(crate) struct Linear<const D: usize> {
    /// The whole matrix.
    full: BlockMatrix<D>,
    /// The matrix without the held directions.
    constrained: BlockMatrix<D>,
    /// The diagonal blocks, and the blocks that were added to them, if the whole matrix is not assembled.
    diagonal: Vec<Block<D>>,
    added: Vec<(usize, Block<D>)>,
    jacobi: BlockJacobi<D>,
    incomplete: IncompleteCholesky<D>,
    /// The complete factor, whether it is valid for the present matrix, and whether it is used because earlier solutions needed
    /// many products.
    filled: FilledCholesky<D>,
    is_filled: bool,
    is_slow: bool,
    /// Whether the matrix differs from its transpose, as for forces without an energy.
    is_unsymmetric: bool,
    cholesky: Cholesky,
    factors: Factors,
    directions: Directions,
}

/// The largest number of iterations of conjugate gradients.
const MOST_PRODUCTS: u32 = 20_000;

/// The largest number of rank-one terms for which a sparse factor is worthwhile. Each term costs one more solution, and each
/// pair of terms one more number.
const MOST_PARTS: usize = 64;

/// After this many products, the complete factor is used. A nearly incompressible solid needs thousands of products with an
/// incomplete factor.
const MANY_PRODUCTS: u32 = 1000;

/// The fraction of the residual that the linear solver may leave in the first iteration.
pub(super) const LINEAR_TOLERANCE: f64 = 1e-2;

/// The relative rounding of a number.
pub(super) const EPSILON: f64 = 0.5 * f64::EPSILON;

/// If the stiffness of a matrix is q times its mass, its solution contains rigid motions with a relative error of about q ε. If
/// q ε is above this limit, the rigid motions are solved for separately. With a larger limit, every step would add such an
/// error to a free fall (`tests/all/stiff_bodies.rs`). For steel in cells of a centimetre, q ε is 1e-9.
pub(super) const HIDDEN: f64 = 1e-6;

/// The terms of a matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mixture<'a, const D: usize> {
    pub(crate) system: &'a System<D>,
    pub(crate) sigma: f64,
    pub(crate) beta: f64,
    /// The fraction at which the loads act.
    pub(crate) load: f64,
    pub(crate) mass: &'a [f64],
    pub(crate) stage: Stage,
    pub(crate) time: f64,
    pub(crate) keep: Definiteness,
    /// Whether products are computed without a matrix.
    pub(crate) matrix_free: bool,
}

/// The free directions of each node: all directions, or the directions of its projector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filter<'a, const D: usize> {
    pub(crate) free: &'a [bool],
    pub(crate) projectors: &'a [Block<D>],
}

impl<const D: usize> Filter<'_, D> {
    /// Projects a vector onto the free directions.
    pub(crate) fn apply(&self, vector: &mut [f64]) {
        self.apply_from(0, vector);
    }
    /// Projects the part of a vector that begins with a given node.
    pub(crate) fn apply_from(&self, first: usize, vector: &mut [f64]) {
        for (node, x) in (first..).zip(nodes_mut::<D>(vector)) {
            if !self.free[node] {
                *x = times(&self.projectors[node], x);
            }
        }
    }
}

/// Multiplies delivered blocks with a vector.
struct ProductSink<'a, const D: usize> {
    factor: f64,
    x: &'a [[f64; D]],
    y: &'a mut [[f64; D]],
}

impl<const D: usize> Sink<D> for ProductSink<'_, D> {
    fn block(&mut self, a: usize, b: usize, value: Block<D>) {
        let part = times(&value, &self.x[b]);
        for d in 0..D {
            self.y[a][d] += self.factor * part[d];
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        let mut along = 0.0;
        for (index, entry) in u {
            for d in 0..D {
                along += entry[d] * self.x[*index][d];
            }
        }
        for (index, entry) in u {
            for d in 0..D {
                self.y[*index][d] += self.factor * c * along * entry[d];
            }
        }
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        let x = self.x;
        let product = part.product(|index| x[index]);
        for (index, value) in part.indices.iter().zip(product) {
            for d in 0..D {
                self.y[*index as usize][d] += self.factor * value[d];
            }
        }
    }
}

/// Stores the diagonal blocks of the delivered matrix.
struct DiagonalSink<'a, const D: usize> {
    factor: f64,
    blocks: &'a mut [Block<D>],
}

impl<const D: usize> Sink<D> for DiagonalSink<'_, D> {
    fn block(&mut self, a: usize, b: usize, value: Block<D>) {
        if a == b {
            for i in 0..D {
                for j in 0..D {
                    self.blocks[a][i][j] += self.factor * value[i][j];
                }
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        for (index, entry) in u {
            for i in 0..D {
                for j in 0..D {
                    self.blocks[*index][i][j] += self.factor * c * entry[i] * entry[j];
                }
            }
        }
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        for (number, index) in part.indices.iter().enumerate() {
            Sink::<D>::block(self, *index as usize, *index as usize, part.block(number, number));
        }
        for (c, u) in part.parts_of_rank_one() {
            self.low_rank(c, &u);
        }
    }
}

impl<const D: usize> Mixture<'_, D> {
    /// Delivers K, C, and the terms that a consistent mass matrix adds to the masses of the nodes. Calls `scale` with the
    /// factor of the terms that follow.
    fn deliver<S: Sink<D>>(&self, sink: &mut S, scale: impl Fn(&mut S, f64)) {
        self.system.hessian(self.stage, self.time, self.keep, sink);
        if self.load != 1.0 {
            scale(sink, self.load - 1.0);
            self.system.outer_hessian(self.stage, self.time, self.keep, sink);
            scale(sink, 1.0);
        }
        if self.beta != 0.0 {
            scale(sink, self.beta);
            self.system.damping_matrix(self.stage, self.time, sink);
            scale(sink, 1.0);
        }
        if self.sigma != 0.0
            && let Some(inertia) = &self.system.inertia
        {
            for node in 0..inertia.nodes() {
                for (other, mass) in inertia.row(node) {
                    sink.block(node, other, isotropic(self.sigma * mass));
                }
            }
        }
    }

    /// The diagonal entry of the mass matrix at a node [kg].
    fn mass_at(&self, node: usize) -> f64 {
        let beside = self.system.inertia.iter().flat_map(|inertia| inertia.row(node));
        self.mass[node] + beside.filter(|(other, _)| *other == node).map(|(_, mass)| mass).sum::<f64>()
    }
}

impl<const D: usize> Linear<D> {
    /// Discards how many products earlier iterations needed, because a step must depend only on the state.
    pub(crate) fn begin(&mut self) {
        (self.is_filled, self.is_slow) = (false, false);
    }

    /// Assembles the derivatives in a state, after its forces have been evaluated.
    pub(crate) fn assemble(&mut self, mixture: &Mixture<D>) {
        self.added.clear();
        self.is_unsymmetric = !has_symmetric_matrix(mixture.system);
        if mixture.matrix_free {
            self.added.reserve(mixture.mass.len());
            self.diagonal.clear();
            self.diagonal.extend(mixture.mass.iter().map(|mass| isotropic::<D>(mixture.sigma * mass)));
            let mut sink = DiagonalSink { factor: 1.0, blocks: &mut self.diagonal };
            mixture.deliver(&mut sink, |sink, factor| sink.factor = factor);
            return;
        }
        let script = usize::from(mixture.keep == Definiteness::Clamped);
        self.full.assemble(mixture.mass.len(), script, |matrix| {
            mixture.deliver(matrix, BlockMatrix::scale);
            for (node, mass) in mixture.mass.iter().enumerate() {
                matrix.add_diagonal(node, mixture.sigma * mass);
            }
        });
    }

    /// Copies the whole matrix of another `Linear`.
    pub(crate) fn take(&mut self, other: &Linear<D>) {
        self.full.copy_from(&other.full);
        self.is_unsymmetric = other.is_unsymmetric;
    }

    /// Adds a block to the diagonal of a node.
    pub(crate) fn add_block(&mut self, mixture: &Mixture<D>, node: usize, block: &Block<D>) {
        if !mixture.matrix_free {
            return self.full.block(node, node, *block);
        }
        self.added.push((node, *block));
        for i in 0..D {
            for j in 0..D {
                self.diagonal[node][i][j] += block[i][j];
            }
        }
    }

    /// Raises the diagonal by a fraction of itself.
    pub(crate) fn raise(&mut self, part: f64) {
        for node in 0..self.full.rows() {
            let size = self.full.diagonal_size(node);
            self.full.add_diagonal(node, part * if size > 0.0 { size } else { 1.0 });
        }
        // If there is no matrix, products have to include this block.
        for (node, block) in self.diagonal.iter_mut().enumerate() {
            let size = (0..D).map(|d| block[d][d].abs()).sum::<f64>() / D as f64;
            let more = part * if size > 0.0 { size } else { 1.0 };
            for d in 0..D {
                block[d][d] += more;
            }
            self.added.push((node, isotropic(more)));
        }
    }

    /// Computes y = A x with the whole matrix.
    pub(crate) fn multiply(&self, mixture: &Mixture<D>, x: &[f64], y: &mut [f64]) {
        if !mixture.matrix_free {
            return self.full.multiply(x, y);
        }
        let (x, y) = (nodes::<D>(x), nodes_mut::<D>(y));
        for ((y, x), mass) in y.iter_mut().zip(x).zip(mixture.mass) {
            *y = x.map(|x| mixture.sigma * mass * x);
        }
        let mut sink = ProductSink { factor: 1.0, x, y };
        mixture.deliver(&mut sink, |sink, factor| sink.factor = factor);
        for (node, block) in &self.added {
            sink.block(*node, *node, *block);
        }
    }

    /// The size of the diagonal block of a node.
    pub(crate) fn size_at(&self, mixture: &Mixture<D>, node: usize) -> f64 {
        if !mixture.matrix_free {
            return D as f64 * self.full.diagonal_size(node);
        }
        let block = &self.diagonal[node];
        let mut size = 0.0;
        for d in 0..D {
            size += block[d][d].abs();
        }
        size
    }

    /// The size of the diagonal block of a node without its mass.
    pub(crate) fn stiffness_at(&self, mixture: &Mixture<D>, node: usize) -> f64 {
        (self.size_at(mixture, node) - D as f64 * mixture.sigma * mixture.mass_at(node)).larger(0.0)
    }

    /// Solves for the correction. The vector b and the result are in the free directions. Returns the number of products.
    pub(crate) fn solve(
        &mut self,
        mixture: &Mixture<D>,
        filter: &Filter<D>,
        settings: &Settings,
        tolerance: f64,
        b: &[f64],
        out: &mut [f64],
    ) -> Result<u32, Indefinite> {
        if mixture.matrix_free {
            for (node, block) in self.diagonal.iter_mut().enumerate().filter(|(node, _)| !filter.free[*node]) {
                *block = constrained_block(block, &filter.projectors[node]);
            }
            self.jacobi.update(self.diagonal.iter())?;
        } else if self.is_unsymmetric {
            self.factor(filter)?;
        } else {
            self.constrain(filter);
            self.is_filled = false;
            if self.is_direct(settings.solver) {
                out.copy_from_slice(b);
                self.cholesky.update_and_solve(&self.constrained, out)?;
                return if out.iter().all(|x| x.is_finite()) { Ok(1) } else { Err(Indefinite) };
            } else if self.constrained.has_dense() {
                self.jacobi.update(self.constrained.diagonal_blocks().iter())?;
            } else {
                self.is_filled = self.is_slow && self.filled.update(&self.constrained).is_ok();
                if !self.is_filled {
                    self.incomplete.update(&self.constrained)?;
                }
            }
        }
        self.solve_again(mixture, filter, settings, tolerance, b, out)
    }

    /// Solves with the same matrix for another right-hand side.
    pub(crate) fn solve_again(
        &mut self,
        mixture: &Mixture<D>,
        filter: &Filter<D>,
        settings: &Settings,
        tolerance: f64,
        b: &[f64],
        out: &mut [f64],
    ) -> Result<u32, Indefinite> {
        let most = MOST_PRODUCTS;
        let products = if mixture.matrix_free {
            let mut directions = std::mem::take(&mut self.directions);
            let multiply = |x: &[f64], y: &mut [f64]| {
                self.multiply(mixture, x, y);
                filter.apply(y);
            };
            let ended = conjugate_gradients(multiply, &self.jacobi, b, out, tolerance, most, &mut directions);
            self.directions = directions;
            ended?.iterations
        } else if self.is_unsymmetric {
            out.copy_from_slice(b);
            self.solve_by_factors(out)?;
            1
        } else if self.is_direct(settings.solver) {
            out.copy_from_slice(b);
            self.cholesky.solve(out);
            1
        } else {
            self.by_gradients(tolerance, b, out)?
        };
        if out.iter().all(|x| x.is_finite()) { Ok(products) } else { Err(Indefinite) }
    }

    /// Whether the sparse factor is used.
    fn is_direct(&self, solver: Solver) -> bool {
        // The factor of a dense part stays valid while the body rotates.
        let dense = solver == Solver::Auto && self.full.has_dense();
        solver == Solver::Cholesky
            || dense
            || (solver.is_direct::<D>(self.full.rows()) && self.full.parts() <= MOST_PARTS)
    }

    /// Solves by conjugate gradients, with the complete factor if the incomplete one converges too slowly.
    fn by_gradients(&mut self, tolerance: f64, b: &[f64], out: &mut [f64]) -> Result<u32, Indefinite> {
        let mut products = 0;
        // The complete factor is tried once. If it does not exist, only convergence or the largest number of products ends the
        // iteration.
        for most in [if self.is_slow { MOST_PRODUCTS } else { MANY_PRODUCTS }, MOST_PRODUCTS] {
            let Linear { constrained, incomplete, filled, is_filled, directions, jacobi, .. } = self;
            let by: &dyn Preconditioner = match (constrained.has_dense(), *is_filled) {
                (true, _) => jacobi,
                (false, true) => filled,
                (false, false) => incomplete,
            };
            let multiply = |x: &[f64], y: &mut [f64]| constrained.multiply(x, y);
            let ended = conjugate_gradients(multiply, by, b, out, tolerance, most, directions)?;
            products += ended.iterations;
            if ended.residual <= tolerance || most == MOST_PRODUCTS || constrained.has_dense() {
                break;
            }
            self.is_slow = true;
            self.is_filled = self.filled.update(&self.constrained).is_ok();
        }
        Ok(products)
    }

    /// The whole matrix.
    pub(crate) fn full(&self) -> &BlockMatrix<D> {
        &self.full
    }
    /// The matrix without the directions that the latest filter held.
    pub(crate) fn constrained(&self) -> &BlockMatrix<D> {
        &self.constrained
    }

    /// Removes the held directions from the matrix.
    pub(crate) fn constrain(&mut self, filter: &Filter<D>) {
        self.constrained.copy_from(&self.full);
        self.constrained.constrain(filter.free, filter.projectors);
    }

    /// Factors the constrained matrix, which has to be symmetric and positive definite.
    pub(crate) fn factor_positive(&mut self, filter: &Filter<D>) -> Result<(), Indefinite> {
        if self.is_unsymmetric {
            return Err(Indefinite);
        }
        self.constrain(filter);
        self.cholesky.update(&self.constrained)
    }
    /// Solves in place with the factor of [`Linear::factor_positive`], for `count` consecutive right-hand sides.
    pub(crate) fn solve_positive(&self, x: &mut [f64], count: usize) {
        self.cholesky.solve_all(x, count);
    }
    /// Factors the constrained matrix, whatever the signs of its eigenvalues.
    pub(crate) fn factor(&mut self, filter: &Filter<D>) -> Result<(), Indefinite> {
        self.constrain(filter);
        self.factors.update_any(&self.constrained, !self.is_unsymmetric)
    }
    /// Solves in place with the factors of [`Linear::factor`].
    pub(crate) fn solve_by_factors(&self, x: &mut [f64]) -> Result<(), Indefinite> {
        if self.factors.solve(x) { Ok(()) } else { Err(Indefinite) }
    }
}

/// Whether the second derivatives of all models form a symmetric matrix.
pub(crate) fn has_symmetric_matrix<const D: usize>(system: &System<D>) -> bool {
    let views = system.members.iter().map(|member| member.potential.properties().views);
    views.into_iter().all(|views| views.symmetric || !views.hessian)
}

/// Whether the solver of a body works without a matrix.
pub(crate) fn is_matrix_free(solver: Solver) -> bool {
    solver == Solver::MatrixFree
}

/// The largest ratio of the stiffness of a matrix to its masses.
pub(super) fn contrast<const D: usize>(linear: &Linear<D>, mixture: &Mixture<D>) -> f64 {
    let mut most: f64 = 0.0;
    for (node, mass) in mixture.mass.iter().enumerate() {
        most = (linear.size_at(mixture, node) / (mixture.sigma * mass)).larger(most);
    }
    most
}

/// Whether a solution with a matrix is too inaccurate in the rigid motions.
pub(super) fn hides_rigid_motions<const D: usize>(linear: &Linear<D>, mixture: &Mixture<D>) -> bool {
    mixture.sigma != 0.0 && EPSILON * contrast(linear, mixture) > HIDDEN
}
