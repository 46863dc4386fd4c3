//! Computes solutions for a matrix whose frame follows its nodes, from solutions for the matrix in a fixed frame.
//!
//! A = Tᵀ K T + M + J Qᵀ + Q Jᵀ with T = 1 − V Jᵀ ([`Following`]) and S = K + M, whose inverse is known. With the spin θ = Jᵀ d, the strain
//! e = d − V θ and P = M V + Q, the equation A d = r becomes
//!
//! S e = r + J ν − P θ,  Jᵀ e = (1 − JᵀV) θ,  (1 − VᵀJ) ν + Pᵀ e + (VᵀP + QᵀV) θ = Vᵀ r,
//!
//! where ν denotes VᵀK e − Qᵀ d. Eliminating e leaves 2 equations in the plane or 6 in space, and K is not needed.

use crate::{Indefinite, dense, dot};
use opruga_core::potential::{Following, mixed};
use std::sync::Arc;

/// S⁻¹ applied to the vectors that a frame follows, except for the part that changes with the state ([`Following::base`]).
pub(crate) struct SolvedBase {
    base: Arc<Vec<f64>>,
    solved: Vec<f64>,
}

impl SolvedBase {
    pub(crate) fn new(following: &Following, solve: &dyn Fn(&mut [f64])) -> SolvedBase {
        let mut solved = following.base.to_vec();
        solve(&mut solved);
        SolvedBase { base: Arc::clone(&following.base), solved }
    }
    pub(crate) fn is_of(&self, following: &Following) -> bool {
        Arc::ptr_eq(&self.base, &following.base)
    }
}

/// The data with which A⁻¹ r is computed from S⁻¹ r. Vectors are consecutive, one for each axis.
pub(crate) struct FollowingFrame {
    length: usize,
    /// J and P, and the products of S⁻¹ with them.
    follows: Vec<f64>,
    forces: Vec<f64>,
    solved_follows: Vec<f64>,
    solved_forces: Vec<f64>,
    /// The matrix V.
    spins: Vec<f64>,
    /// The inverse of the matrix of ν and θ, by rows.
    core: Vec<f64>,
}

impl FollowingFrame {
    /// Makes the frame. Q is `factor` times the forces of `following`, and `masses` has the entry of M for each row. S has to be positive definite.
    /// `right` is an additional right-hand side, which is replaced by the solution A⁻¹ `right`.
    ///
    /// # Errors
    /// [`Indefinite`] if A is not positive definite.
    pub(crate) fn new(
        following: &Following,
        factor: f64,
        masses: &[f64],
        base: &SolvedBase,
        right: Option<&mut [f64]>,
        solve: &dyn Fn(&mut [f64]),
    ) -> Result<FollowingFrame, Indefinite> {
        let (length, spins) = (masses.len(), following.spins.clone());
        let axes = spins.len() / length;
        let forces: Vec<f64> = following.forces.iter().map(|q| factor * q).collect();
        let mut frame = FollowingFrame {
            length,
            follows: following.follows(length),
            forces: forces.iter().zip(&spins).enumerate().map(|(k, (q, v))| masses[k % length] * v + q).collect(),
            solved_follows: mixed(&following.mix, &base.solved, length),
            solved_forces: Vec::new(),
            spins,
            core: Vec::new(),
        };
        let along = right.as_ref().map(|right| frame.along(right));
        let mut sides = frame.forces.clone();
        sides.extend(right.iter().flat_map(|right| right.iter()));
        solve(&mut sides);
        let solved_right = sides.split_off(axes * length);
        frame.solved_forces = sides;

        let products = |a: &[f64], b: &[f64]| -> Vec<f64> {
            let row = |a| b.chunks_exact(length).map(move |b| dot(a, b));
            a.chunks_exact(length).flat_map(row).collect()
        };
        let follows = products(&frame.follows, &frame.solved_follows);
        let mixed = products(&frame.follows, &frame.solved_forces);
        let turned = products(&frame.follows, &frame.spins);
        let [own, inner, loads] = [
            products(&frame.forces, &frame.solved_forces),
            products(&frame.spins, &frame.forces),
            products(&forces, &frame.spins),
        ];
        let n = 2 * axes;
        let mut core = vec![0.0; n * n];
        for k in 0..axes {
            for l in 0..axes {
                let at = k * axes + l;
                let coupling = mixed[at] + if k == l { 1.0 } else { 0.0 } - turned[at];
                core[k * n + l] = follows[at];
                core[k * n + axes + l] = -coupling;
                core[(axes + l) * n + k] = -coupling;
                core[(axes + k) * n + axes + l] = own[at] - inner[at] - loads[at];
            }
        }
        // S is positive definite. So is A, if this matrix has as many positive eigenvalues as negative ones.
        if !dense::has_positive(&core, n, axes) {
            return Err(Indefinite);
        }
        frame.core = dense::inverse(&core, n).ok_or(Indefinite)?;
        if let (Some(right), Some(along)) = (right, along) {
            right.copy_from_slice(&solved_right);
            frame.correct(&along, right);
        }
        Ok(frame)
    }
    /// Returns Vᵀ r.
    pub(crate) fn along(&self, right: &[f64]) -> Vec<f64> {
        self.spins.chunks_exact(self.length).map(|v| dot(v, right)).collect()
    }
    /// Replaces x = S⁻¹ r by A⁻¹ r, given `along` = Vᵀ r.
    pub(crate) fn correct(&self, along: &[f64], x: &mut [f64]) {
        let axes = along.len();
        let mut right: Vec<f64> = self.follows.chunks_exact(self.length).map(|j| -dot(j, x)).collect();
        right.extend(self.forces.chunks_exact(self.length).zip(along).map(|(p, along)| dot(p, x) - along));
        let unknown = |k: usize| (0..2 * axes).map(|l| self.core[2 * axes * k + l] * right[l]).sum::<f64>();
        for k in 0..axes {
            let (push, spin) = (unknown(k), unknown(axes + k));
            let range = k * self.length..(k + 1) * self.length;
            let columns = self.solved_follows[range.clone()].iter().zip(&self.solved_forces[range.clone()]);
            for ((x, (y, w)), v) in x.iter_mut().zip(columns).zip(&self.spins[range]) {
                *x += push * y + spin * (v - w);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::dense_system::DenseFactors;
    use crate::{BlockMatrix, Cholesky, Factors};
    use opruga_core::dense::Dense;
    use opruga_core::potential::{DensePart, Following, Sink};
    use std::sync::Arc;

    const NODES: usize = 12;
    const SIZE: usize = 3 * NODES;

    /// Pseudo-random numbers between −1 and 1.
    fn number(k: usize) -> f64 {
        libm::sin(1.7 * k as f64 * k as f64 + 0.3 * k as f64)
    }

    struct Body {
        matrix: Arc<Dense>,
        following: Following,
        indices: Vec<u32>,
        frame: [[f64; 3]; 3],
    }

    impl Body {
        fn new(base: &Arc<Vec<f64>>, state: usize) -> Body {
            let entry = |i: usize, j: usize| 0.2 * number(i * 7 + j * 3) + if i == j { 4.0 } else { 0.0 };
            let matrix = Dense::of_lower(SIZE, entry);
            let length = matrix.padded();
            let vectors = |seed: usize, size: f64| -> Vec<f64> {
                let entry = |k: usize| if k % length < SIZE { size * number(k + seed) } else { 0.0 };
                (0..3 * length).map(entry).collect()
            };
            let mix = core::array::from_fn(|i| {
                core::array::from_fn(|j| number(state + 5 * i + j) + f64::from(u8::from(i == j)))
            });
            let (c, s) = (libm::cos(state as f64), libm::sin(state as f64));
            Body {
                following: Following {
                    base: Arc::clone(base),
                    mix,
                    spins: vectors(1000 + state, 0.4),
                    forces: vectors(2000 + state, 0.1),
                },
                matrix: Arc::new(matrix),
                indices: (0..NODES as u32).collect(),
                frame: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            }
        }
        fn deliver(&self, sink: &mut dyn Sink<3>) {
            let following = Some(&self.following);
            let (frame, indices) = (&self.frame, &self.indices);
            sink.dense(&DensePart { factor: 2.0, frame, indices, matrix: &self.matrix, following });
        }
    }

    /// The delivered entries.
    struct Entries(Vec<f64>);

    impl Sink<3> for Entries {
        fn block(&mut self, a: usize, b: usize, value: [[f64; 3]; 3]) {
            for i in 0..3 {
                (0..3).for_each(|j| self.0[(b * 3 + j) * SIZE + a * 3 + i] += value[i][j]);
            }
        }
        fn low_rank(&mut self, c: f64, u: &[(usize, [f64; 3])]) {
            for (a, x) in u {
                for (b, y) in u {
                    self.block(*a, *b, core::array::from_fn(|i| core::array::from_fn(|j| c * x[i] * y[j])));
                }
            }
        }
    }

    #[test]
    fn solutions_with_a_frame_that_follows_are_those_of_all_entries() {
        let length = SIZE.next_multiple_of(opruga_core::dense::SIDE);
        let base: Vec<f64> = (0..3 * length).map(|k| if k % length < SIZE { 0.1 * number(k) } else { 0.0 }).collect();
        let base = Arc::new(base);
        let (mut matrix, mut cholesky) = (BlockMatrix::<3>::default(), Cholesky::default());
        let right: Vec<f64> = (0..SIZE).map(|k| number(3 * k)).collect();
        let one = Body::new(&base, 1);
        // The inverse and the solutions for the base are kept between states of a body, but not between bodies.
        for body in [&one, &Body { matrix: Arc::clone(&one.matrix), ..Body::new(&base, 2) }, &Body::new(&base, 3)] {
            for pinned in [false, true] {
                matrix.assemble(NODES, 0, |sink| {
                    body.deliver(sink);
                    (0..NODES).for_each(|node| sink.add_diagonal(node, 0.5 + 0.1 * node as f64));
                });
                let mut entries = Entries(vec![0.0; SIZE * SIZE]);
                body.deliver(&mut entries);
                for k in 0..SIZE {
                    entries.0[k * SIZE + k] += 0.5 + 0.1 * (k / 3) as f64;
                }
                let (mut x, mut product) = (right.clone(), vec![0.0; SIZE]);
                matrix.multiply(&right, &mut product);
                for (row, found) in product.iter().enumerate() {
                    let expected: f64 = (0..SIZE).map(|k| entries.0[k * SIZE + row] * right[k]).sum();
                    assert!((found - expected).abs() < 1e-12);
                }
                if pinned {
                    let mut free = vec![true; NODES];
                    free[4] = false;
                    matrix.constrain(&free, &vec![[[0.0; 3]; 3]; NODES]);
                    for k in 12..15 {
                        (0..SIZE).for_each(|row| (entries.0[k * SIZE + row], entries.0[row * SIZE + k]) = (0.0, 0.0));
                        entries.0[k * SIZE + k] = 1.0;
                        x[k] = 0.0;
                    }
                }
                let mut expected = x.clone();
                DenseFactors::new(SIZE, entries.0).unwrap().solve(&mut expected);
                let is_solved = |x: &[f64]| x.iter().zip(&expected).all(|(x, e)| (x - e).abs() < 1e-11);
                let (mut again, mut any) = (x.clone(), x.clone());
                cholesky.update_and_solve(&matrix, &mut x).unwrap();
                cholesky.solve(&mut again);
                let mut factors = Factors::default();
                factors.update(&matrix).unwrap();
                factors.solve(&mut any);
                assert!(is_solved(&x) && is_solved(&again) && is_solved(&any), "pinned: {pinned}");
            }
        }
    }

    #[test]
    fn a_frame_whose_forces_make_a_body_unstable_is_told() {
        let length = SIZE.next_multiple_of(opruga_core::dense::SIDE);
        let base: Vec<f64> = (0..3 * length).map(|k| if k % length < SIZE { 0.1 * number(k) } else { 0.0 }).collect();
        let mut body = Body::new(&Arc::new(base), 1);
        body.following.forces.iter_mut().for_each(|force| *force *= 1000.0);
        let mut matrix = BlockMatrix::<3>::default();
        matrix.assemble(NODES, 0, |sink| {
            body.deliver(sink);
            (0..NODES).for_each(|node| sink.add_diagonal(node, 1.0));
        });
        assert!(Cholesky::default().update(&matrix).is_err());
    }
}
