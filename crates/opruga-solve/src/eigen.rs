//! The lowest natural frequencies: K φ = ω² M φ.
//!
//! Both methods find the largest eigenvalues θ = 1/(ω² + s) of A = (K + s M)⁻¹ M, which belong to the lowest frequencies. The
//! shift s > 0 allows K to be singular, as for a free body.
//!
//! * *Few modes*: a block Lanczos recurrence. A block of several vectors also finds frequencies that occur several times, such as the frequencies of
//!   round bodies. Every block is orthogonalised against all previous ones (twice), so no frequency is found again. The products of the
//!   orthogonalisation give the projection T = Qᵀ M A Q. The projection is decomposed only when the basis has grown by a fraction of its size.
//! * *Many modes*: with M = R Rᵀ, all eigenvectors of the dense symmetric matrix Rᵀ (K + s M)⁻¹ R.
//!
//! Products of dense matrices and their eigenvectors come from faer, so results have the same bits only on processors of one
//! class.
//!
//! Source: Grimes, Lewis, Simon 1994; Parlett, *The symmetric eigenvalue problem*, 13.

use crate::{Indefinite, dot};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

/// One natural frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// ω² [1/s²]; negative if the state is unstable.
    pub square: f64,
    /// The shape φ with φᵀMφ = 1.
    pub shape: Vec<f64>,
    /// |K φ − ω² M φ| in the norm of the inverse lumped masses [1/s²].
    pub residual: f64,
}

/// The matrices K and M of a body, as functions of vectors of all its coordinates.
pub struct Pencil<'a> {
    /// Lumped masses, zero for pinned coordinates; residuals are measured with them.
    pub mass: &'a [f64],
    /// The shift s, with which K + s M is positive definite [1/s²].
    pub shift: f64,
    /// M-orthonormal shapes that are already known, so that the search leaves them out.
    pub known: &'a [Vec<f64>],
    /// Writes M x; M has no rows and columns of pinned coordinates.
    pub weigh: &'a dyn Fn(&[f64], &mut [f64]),
    /// Replaces b by (K + s M)⁻¹ b.
    pub solve: &'a dyn Fn(&mut [f64]),
    /// Writes K x.
    pub stiffness: &'a dyn Fn(&[f64], &mut [f64]),
}

/// The number of vectors of a block.
const BLOCK: usize = 6;

/// A Ritz pair whose residual is below this fraction of θ is as accurate as rounding permits.
const CONVERGED: f64 = 1e-12;

/// The basis is first decomposed when it has twice as many vectors as there are requested modes (fewer have never been enough). The basis is
/// decomposed again each time it has grown by this fraction of its size. Each decomposition costs the cube of the size.
const GROWTH: f64 = 0.1;

/// Bodies with up to this many free coordinates are decomposed as a whole, because the dense matrix takes only milliseconds.
const SMALL: f64 = 240.0;

/// If more than this fraction of all modes is requested, the dense matrix costs less than a basis of twice as many vectors.
const MANY: f64 = 0.2;

/// If less than this fraction of a vector remains after orthogonalisation against others, it is in their space.
const SPENT: f64 = 1e-10;

/// If less than this fraction of a vector remains within its block, it is orthogonalised against the whole basis once more.
const CANCELLED: f64 = 1e-2;

/// The number of vectors that are tried in place of a spent one.
const ATTEMPTS: usize = 4;

/// The largest memory of the search for `count` modes of a body with `free` free coordinates [bytes].
pub fn memory(count: usize, free: usize) -> f64 {
    let (count, free) = (count.min(free) as f64, free as f64);
    // The dense matrix, its eigenvectors and the memory to compute them; or a basis that grows by reallocation, and its
    // projection.
    let vectors = if is_dense(count, free) { 5.0 * free * free } else { 3.0 * count * (2.0 * free + 12.0 * count) };
    8.0 * (vectors + 3.0 * count * free)
}

/// Whether all modes are found at once.
fn is_dense(count: f64, free: f64) -> bool {
    free <= SMALL || count > MANY * free
}

/// The lowest `count` modes, ascending; fewer if the body has fewer.
///
/// # Errors
/// [`Indefinite`] if the matrices have an entry that is not finite, because there are then no natural frequencies.
pub fn lowest_modes(count: usize, pencil: &Pencil) -> Result<Vec<Mode>, Indefinite> {
    let free = pencil.mass.iter().filter(|m| **m > 0.0).count();
    let freedom = free.saturating_sub(pencil.known.len());
    let count = count.min(freedom);
    if count == 0 {
        return Ok(Vec::new());
    }
    let shapes =
        if is_dense(count as f64, free as f64) { dense(count, pencil)? } else { lanczos(count, freedom, pencil)? };
    let mut modes: Vec<Mode> = shapes.into_iter().map(|shape| mode_of(shape, pencil)).collect();
    modes.sort_by(|a, b| a.square.total_cmp(&b.square));
    Ok(modes)
}

/// A mode with its Rayleigh quotient, which keeps the digits that 1/θ − s would lose.
fn mode_of(shape: Vec<f64>, pencil: &Pencil) -> Mode {
    let mut force = vec![0.0; shape.len()];
    (pencil.stiffness)(&shape, &mut force);
    let mut momentum = vec![0.0; shape.len()];
    (pencil.weigh)(&shape, &mut momentum);
    let square = dot(&shape, &force) / dot(&shape, &momentum);
    let mut residual = 0.0;
    for ((f, p), m) in force.iter().zip(&momentum).zip(pencil.mass) {
        if *m > 0.0 {
            let rest = f - square * p;
            residual += rest * rest / m;
        }
    }
    Mode { square, shape, residual: residual.sqrt() }
}

/// Vectors of equal length side by side: a matrix by columns.
struct Vectors {
    rows: usize,
    entries: Vec<f64>,
}

impl Vectors {
    fn new(rows: usize) -> Vectors {
        Vectors { rows, entries: Vec::new() }
    }
    fn zeros(rows: usize, count: usize) -> Vectors {
        Vectors { rows, entries: vec![0.0; rows * count] }
    }
    fn len(&self) -> usize {
        self.entries.len() / self.rows
    }
    fn push(&mut self, vector: &[f64]) {
        self.entries.extend_from_slice(vector);
    }
    fn at(&self, k: usize) -> &[f64] {
        &self.entries[k * self.rows..][..self.rows]
    }
    fn at_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.entries[k * self.rows..][..self.rows]
    }
    fn matrix(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.entries, self.rows, self.len())
    }
    fn matrix_mut(&mut self) -> MatMut<'_, f64> {
        let columns = self.len();
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, columns)
    }
    /// The product Aᵀ B of two sets of vectors.
    fn products(&self, other: &Vectors) -> Mat<f64> {
        let mut out = Mat::zeros(self.len(), other.len());
        matmul(&mut out, Accum::Replace, self.matrix().transpose(), other.matrix(), 1.0, Par::Seq);
        out
    }
    /// Subtracts A C, for another set A of vectors.
    fn subtract(&mut self, others: &Vectors, weights: &Mat<f64>) {
        matmul(self.matrix_mut(), Accum::Add, others.matrix(), weights, -1.0, Par::Seq);
    }
    /// The combinations A C, one vector for each column of C.
    fn combined(&self, weights: MatRef<'_, f64>) -> Vectors {
        let mut out = Vectors::zeros(self.rows, weights.ncols());
        matmul(out.matrix_mut(), Accum::Replace, self.matrix(), weights, 1.0, Par::Seq);
        out
    }
    fn weighed(&self, pencil: &Pencil) -> Vectors {
        let mut out = Vectors::zeros(self.rows, self.len());
        for k in 0..self.len() {
            (pencil.weigh)(self.at(k), out.at_mut(k));
        }
        out
    }
}

/// Eigenvalues, ascending, and eigenvectors as columns.
fn eigen(matrix: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), Indefinite> {
    let found = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| Indefinite)?;
    let values: Vec<f64> = found.S().column_vector().iter().copied().collect();
    if values.iter().any(|value| !value.is_finite()) {
        return Err(Indefinite);
    }
    Ok((values, found.U().to_owned()))
}

/// The shapes of the lowest modes by a block Lanczos recurrence.
fn lanczos(count: usize, freedom: usize, pencil: &Pencil) -> Result<Vec<Vec<f64>>, Indefinite> {
    let rows = pencil.mass.len();
    let mut known = Vectors::new(rows);
    for shape in pencil.known {
        known.push(shape);
    }
    let mut basis = Vectors::new(rows);
    // The columns of T from the top to below the diagonal; the rest follows from symmetry.
    let mut projected: Vec<Vec<f64>> = Vec::new();
    let mut seed = 0;
    let mut block = Vectors::new(rows);
    for _ in 0..BLOCK {
        block.push(&start(pencil.mass, seed));
        seed += 1;
    }
    let mut looked = 0;
    // Nothing precedes the first block, so every vector counts in full.
    orthogonalise(&mut block, &known, &basis, pencil);
    let mut lengths = vec![0.0; BLOCK];
    loop {
        // Makes the vectors of the block orthonormal to one another; spent vectors are replaced.
        let fresh = basis.len();
        for k in 0..block.len().min(freedom - fresh) {
            let mut vector = block.at(k).to_vec();
            let mut accepted = orthonormalise_among(&mut vector, lengths[k], fresh, &known, &basis, pencil);
            for _ in 0..ATTEMPTS {
                if accepted {
                    break;
                }
                vector = start(pencil.mass, seed);
                seed += 1;
                accepted = orthonormalise(&mut vector, &known, &basis, pencil);
            }
            if accepted {
                basis.push(&vector);
            }
        }
        let size = basis.len();
        // The images A q of the block, their components in the basis, and the remainder for the next block.
        block = Vectors::new(rows);
        for k in fresh..size {
            let mut image = vec![0.0; rows];
            (pencil.weigh)(basis.at(k), &mut image);
            (pencil.solve)(&mut image);
            for (entry, m) in image.iter_mut().zip(pencil.mass) {
                *entry = if *m > 0.0 { *entry } else { 0.0 };
            }
            block.push(&image);
        }
        if block.entries.iter().any(|entry| !entry.is_finite()) {
            return Err(Indefinite);
        }
        lengths = (0..block.len()).map(|k| length(block.at(k), pencil)).collect();
        let within = orthogonalise(&mut block, &known, &basis, pencil);
        for k in 0..size - fresh {
            projected.push(within.col(k).iter().copied().collect());
        }
        let exhausted = size == fresh || size == freedom;
        if !exhausted && (size < 2 * count || (size as f64) < (1.0 + GROWTH) * looked as f64) {
            continue;
        }
        looked = size;
        // The entry (i, j) is in the later of the two columns.
        let t = Mat::from_fn(size, size, |i, j| if i <= j { projected[j][i] } else { projected[i][j] });
        let (theta, vectors) = eigen(&t)?;
        let left = block.products(&block.weighed(pencil));
        let converged = |k: usize| {
            // |A Q w − θ Q w| = |rest · (the last block of w)|, in the norm of M.
            let last: Vec<f64> = (fresh..size).map(|row| vectors[(row, k)]).collect();
            let mut square = 0.0;
            for (i, a) in last.iter().enumerate() {
                for (j, b) in last.iter().enumerate() {
                    square += a * left[(i, j)] * b;
                }
            }
            square <= (CONVERGED * theta[k]) * (CONVERGED * theta[k])
        };
        let wanted = count.min(size);
        if exhausted || (size - wanted..size).all(converged) {
            let shapes = basis.combined(vectors.subcols(size - wanted, wanted));
            return Ok((0..wanted).rev().map(|k| shapes.at(k).to_vec()).collect());
        }
    }
}

/// Subtracts from vectors their components in two M-orthonormal sets, twice; returns the components in the second set.
fn orthogonalise(block: &mut Vectors, known: &Vectors, basis: &Vectors, pencil: &Pencil) -> Mat<f64> {
    let mut parts = Mat::zeros(basis.len(), block.len());
    for _ in 0..2 {
        let momentum = block.weighed(pencil);
        if known.len() > 0 {
            let along = known.products(&momentum);
            block.subtract(known, &along);
        }
        if basis.len() > 0 {
            let along = basis.products(&momentum);
            block.subtract(basis, &along);
            parts += along;
        }
    }
    parts
}

/// The length of a vector in the scalar product of M.
fn length(vector: &[f64], pencil: &Pencil) -> f64 {
    let mut momentum = vec![0.0; vector.len()];
    (pencil.weigh)(vector, &mut momentum);
    dot(vector, &momentum).sqrt()
}

/// Normalises a vector that is orthogonal to the basis before `fresh`, and makes it orthogonal to the rest of the basis; returns
/// false if nothing remains of it, compared with its length `before`.
fn orthonormalise_among(
    vector: &mut [f64],
    before: f64,
    fresh: usize,
    known: &Vectors,
    basis: &Vectors,
    pencil: &Pencil,
) -> bool {
    let whole = length(vector, pencil);
    if !(whole > SPENT * before && whole.is_finite()) {
        return false;
    }
    vector.iter_mut().for_each(|v| *v /= whole);
    let mut momentum = vec![0.0; vector.len()];
    for _ in 0..2 {
        for k in fresh..basis.len() {
            (pencil.weigh)(vector, &mut momentum);
            let along = dot(basis.at(k), &momentum);
            vector.iter_mut().zip(basis.at(k)).for_each(|(v, b)| *v -= along * b);
        }
    }
    let after = length(vector, pencil);
    if whole * after <= SPENT * before {
        return false;
    }
    if after < CANCELLED {
        // The rounding error in the directions of the earlier basis has been amplified.
        return orthonormalise(vector, known, basis, pencil);
    }
    vector.iter_mut().for_each(|v| *v /= after);
    true
}

/// Makes one vector orthogonal to others and of length one in the scalar product of M; returns false if nothing remains of it.
fn orthonormalise(vector: &mut [f64], known: &Vectors, basis: &Vectors, pencil: &Pencil) -> bool {
    let before = length(vector, pencil);
    if !(before > 0.0 && before.is_finite()) {
        return false;
    }
    let mut one = Vectors { rows: vector.len(), entries: vector.iter().map(|v| v / before).collect() };
    orthogonalise(&mut one, known, basis, pencil);
    let after = length(&one.entries, pencil);
    if after < SPENT {
        return false;
    }
    for (out, v) in vector.iter_mut().zip(&one.entries) {
        *out = v / after;
    }
    true
}

/// The shapes of the lowest modes, from all modes.
fn dense(count: usize, pencil: &Pencil) -> Result<Vec<Vec<f64>>, Indefinite> {
    let rows = pencil.mass.len();
    let free: Vec<usize> = (0..rows).filter(|k| pencil.mass[*k] > 0.0).collect();
    let n = free.len();
    let root = root_of_mass(&free, pencil)?;
    let gathered = |vector: &[f64], out: &mut [f64]| out.iter_mut().zip(&free).for_each(|(o, k)| *o = vector[*k]);
    // Y = (K + s M)⁻¹ R, column by column, then H = Rᵀ Y.
    let mut images = Vectors::zeros(n, n);
    let mut column = vec![0.0; rows];
    for j in 0..n {
        column.fill(0.0);
        match &root {
            Root::Diagonal(root) => column[free[j]] = root[j],
            Root::Lower(root) => (j..n).for_each(|i| column[free[i]] = root[(i, j)]),
        }
        (pencil.solve)(&mut column);
        gathered(&column, images.at_mut(j));
    }
    let mut h = root.transposed_product(images.matrix());
    for j in 0..n {
        for i in 0..j {
            let mean = 0.5 * (h[(i, j)] + h[(j, i)]);
            (h[(i, j)], h[(j, i)]) = (mean, mean);
        }
    }
    // Known modes are moved to the end of the spectrum: H ← (1 − Q Qᵀ) H (1 − Q Qᵀ) with Q = Rᵀ · known.
    if !pencil.known.is_empty() {
        let mut known = Vectors::zeros(n, pencil.known.len());
        for (k, shape) in pencil.known.iter().enumerate() {
            gathered(shape, known.at_mut(k));
        }
        let q = root.transposed_product(known.matrix());
        let hq = &h * &q;
        let middle = q.transpose() * &hq;
        h = &h - &hq * q.transpose() - &q * hq.transpose() + &q * middle * q.transpose();
    }
    let (_, vectors) = eigen(&h)?;
    let mut shapes = Vec::with_capacity(count);
    for k in 0..count {
        let mut found: Vec<f64> = vectors.col(n - 1 - k).iter().copied().collect();
        root.solve_transposed(&mut found);
        let mut shape = vec![0.0; rows];
        free.iter().zip(&found).for_each(|(at, value)| shape[*at] = *value);
        shapes.push(shape);
    }
    Ok(shapes)
}

/// A root R of the masses of free coordinates, M = R Rᵀ.
enum Root {
    Diagonal(Vec<f64>),
    Lower(Mat<f64>),
}

impl Root {
    /// The product Rᵀ B.
    fn transposed_product(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        match self {
            Root::Diagonal(root) => Mat::from_fn(b.nrows(), b.ncols(), |i, j| root[i] * b[(i, j)]),
            Root::Lower(root) => root.transpose() * b,
        }
    }
    /// Replaces x by R⁻ᵀ x.
    fn solve_transposed(&self, x: &mut [f64]) {
        match self {
            Root::Diagonal(root) => x.iter_mut().zip(root).for_each(|(x, root)| *x /= root),
            Root::Lower(root) => {
                for i in (0..x.len()).rev() {
                    let mut rest = x[i];
                    for j in i + 1..x.len() {
                        rest -= root[(j, i)] * x[j];
                    }
                    x[i] = rest / root[(i, i)];
                }
            }
        }
    }
}

fn root_of_mass(free: &[usize], pencil: &Pencil) -> Result<Root, Indefinite> {
    let (rows, n) = (pencil.mass.len(), free.len());
    let (mut unit, mut product) = (vec![0.0; rows], vec![0.0; rows]);
    let mut mass = Mat::<f64>::zeros(n, n);
    let mut coupled = false;
    for (j, at) in free.iter().enumerate() {
        unit[*at] = 1.0;
        (pencil.weigh)(&unit, &mut product);
        unit[*at] = 0.0;
        for (i, at) in free.iter().enumerate() {
            mass[(i, j)] = product[*at];
            coupled |= i != j && product[*at] != 0.0;
        }
    }
    if coupled {
        return Ok(Root::Lower(mass.llt(Side::Lower).map_err(|_| Indefinite)?.L().to_owned()));
    }
    Ok(Root::Diagonal((0..n).map(|k| mass[(k, k)].sqrt()).collect()))
}

/// A vector of pseudo-random entries, always the same for the same number.
fn start(mass: &[f64], number: usize) -> Vec<f64> {
    let entry = |(k, m): (usize, &f64)| {
        // SplitMix64 (Steele, Lea, Flood 2014).
        let mut z = ((number + 1) as u64 * 0x51_7c_c1_b7 + k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let random = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        if *m > 0.0 { random } else { 0.0 }
    };
    mass.iter().enumerate().map(entry).collect()
}

#[cfg(test)]
#[path = "eigen_tests.rs"]
mod tests;
