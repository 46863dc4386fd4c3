//! Assembly, compared with a dense matrix, and all solvers compared with one another.

use super::*;
use crate::{
    BlockJacobi, Cholesky, Directions, Factors, IncompleteCholesky, Packed, Preconditioner, conjugate_gradients,
};
use opruga_core::threads::together;
use opruga_math::{Lane, Simd};

/// A chain of springs in the plane with a gas that couples all of its nodes; `order` reverses the calls.
fn deliver(nodes: usize, order: bool, sink: &mut BlockMatrix<2>) {
    let spring = |k: usize| {
        let (c, s) = (libm::cos(k as f64), libm::sin(k as f64));
        let k = 3.0 + k as f64;
        [[k * c * c + 0.5, k * c * s], [k * c * s, k * s * s + 0.5]]
    };
    let numbers: Vec<usize> = if order { (0..nodes - 1).rev().collect() } else { (0..nodes - 1).collect() };
    for k in numbers {
        let block = spring(k);
        let minus = block.map(|row| row.map(|x| -x));
        sink.block(k, k, block);
        sink.block(k + 1, k + 1, block);
        sink.block(k, k + 1, minus);
        sink.block(k + 1, k, minus);
    }
    let u: Vec<(usize, [f64; 2])> = (0..nodes).map(|k| (k, [0.1 * k as f64, 1.0 - 0.2 * k as f64])).collect();
    sink.low_rank(0.7, &u);
    sink.scale(2.0);
    sink.low_rank(0.1, &u[1..3]);
    sink.scale(1.0);
    for k in 0..nodes {
        sink.add_diagonal(k, 0.3);
    }
}

fn matrix(nodes: usize) -> BlockMatrix<2> {
    let mut matrix = BlockMatrix::default();
    matrix.assemble(nodes, 0, |sink| deliver(nodes, false, sink));
    matrix
}

/// The matrix as a dense one, from its products.
fn dense(matrix: &BlockMatrix<2>) -> Vec<Vec<f64>> {
    let size = 2 * matrix.rows();
    (0..size)
        .map(|k| {
            let (mut x, mut y) = (vec![0.0; size], vec![0.0; size]);
            x[k] = 1.0;
            matrix.multiply(&x, &mut y);
            y
        })
        .collect()
}

#[test]
fn assembly_is_the_same_first_replayed_reversed_and_out_of_turn() {
    let first = matrix(9);
    let expected = dense(&first);
    for row in 0..18 {
        for column in 0..18 {
            assert!((expected[row][column] - expected[column][row]).abs() < 1e-13);
        }
    }
    let mut again = first.clone();
    again.assemble(9, 0, |sink| deliver(9, false, sink));
    assert_eq!(dense(&again), expected);
    again.assemble(9, 1, |sink| deliver(9, true, sink));
    again.assemble(9, 1, |sink| deliver(9, true, sink));
    // The order of additions is different, so results differ by rounding.
    let close =
        |a: &[Vec<f64>], b: &[Vec<f64>]| a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-13);
    assert!(close(&dense(&again), &expected));
    // An order of calls that differs from the script.
    again.assemble(9, 0, |sink| deliver(9, true, sink));
    assert!(close(&dense(&again), &expected));
    // New blocks.
    let mut more = first;
    more.assemble(9, 0, |sink| {
        deliver(9, false, sink);
        sink.block(0, 8, [[1.0, 0.0], [0.0, 0.0]]);
        sink.block(8, 0, [[1.0, 0.0], [0.0, 0.0]]);
    });
    assert!((dense(&more)[0][16] - expected[0][16] - 1.0).abs() < 1e-14);
}

#[test]
fn every_solver_finds_the_same_solution() {
    for nodes in [3, 9, 60] {
        let matrix = matrix(nodes);
        let wanted: Vec<f64> = (0..2 * nodes).map(|k| libm::sin(k as f64 * 1.7)).collect();
        let mut b = vec![0.0; 2 * nodes];
        matrix.multiply(&wanted, &mut b);
        let check = |x: &[f64], name: &str| {
            let error = x.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, Lane::larger);
            assert!(error < 1e-9, "{name}, {nodes} nodes: {error}");
        };
        let mut cholesky = Cholesky::default();
        cholesky.update(&matrix).unwrap();
        let mut x = b.clone();
        cholesky.solve(&mut x);
        check(&x, "cholesky");
        let mut factors = Factors::default();
        factors.update(&matrix).unwrap();
        let mut x = b.clone();
        assert!(factors.solve(&mut x));
        check(&x, "lu");
        let (mut jacobi, mut incomplete) = (BlockJacobi::default(), IncompleteCholesky::default());
        jacobi.update((0..nodes).map(|node| matrix.diagonal_block(node))).unwrap();
        incomplete.update(&matrix).unwrap();
        let mut counts = Vec::new();
        let preconditioners: [&dyn Preconditioner; 2] = [&jacobi, &incomplete];
        for preconditioner in preconditioners {
            let mut x = vec![0.0; 2 * nodes];
            let multiply = |x: &[f64], y: &mut [f64]| matrix.multiply(x, y);
            let mut workspace = Directions::default();
            let ended = conjugate_gradients(multiply, preconditioner, &b, &mut x, 1e-13, 1000, &mut workspace).unwrap();
            check(&x, "conjugate gradients");
            counts.push(ended.iterations);
        }
        // The same with entries in single precision, as packs store them.
        let mut matrix = matrix;
        for entry in matrix.values.iter_mut().flatten().flatten() {
            *entry = f64::from(*entry as f32);
        }
        matrix.multiply(&wanted, &mut b);
        // In packs, the bits are the same with every set of instructions and number of threads, and the solution is correct.
        let mut bits = Vec::new();
        for simd in Simd::available() {
            for threads in [1, 2, 3] {
                together(threads, || {
                    let mut packed = Packed::default();
                    packed.take(&matrix, threads);
                    packed.hold(threads, &matrix, &vec![true; nodes], &vec![isotropic(1.0); nodes]).unwrap();
                    let mut x = vec![0.0; 2 * nodes];
                    let size = packed.begin(simd, threads, &b);
                    let reached = packed.solve(simd, threads, 1e-13 * size, 1000, &mut x).unwrap();
                    check(&x, "packed");
                    // The method is the same, but its sums have another order, which makes a difference as soon as vectors are
                    // no longer conjugate.
                    assert!(reached.iterations.abs_diff(counts[0]) <= counts[0] / 10, "{reached:?}");
                    bits.push(x.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
                    let (mut whole, mut product) = (vec![0.0; 2 * nodes], vec![0.0; 2 * nodes]);
                    matrix.multiply(&b, &mut whole);
                    packed.multiply(simd, threads, &b, &mut product);
                    assert!(whole.iter().zip(&product).all(|(a, b)| (a - b).abs() < 1e-13 * (1.0 + a.abs())));
                });
            }
        }
        assert!(bits.iter().all(|x| *x == bits[0]));
        // A chain is factored exactly, so only the two rank-one terms remain.
        assert!(counts[1] <= 4, "{counts:?}");
    }
}

#[test]
fn an_indefinite_matrix_is_reported() {
    let mut matrix = BlockMatrix::<2>::default();
    matrix.assemble(2, 0, |sink| {
        sink.block(0, 0, [[1.0, 0.0], [0.0, -1.0]]);
        sink.block(1, 1, [[1.0, 0.0], [0.0, 1.0]]);
    });
    assert!(Cholesky::default().update(&matrix).is_err());
    assert!(BlockJacobi::default().update((0..2).map(|node| matrix.diagonal_block(node))).is_err());
    assert!(IncompleteCholesky::default().update(&matrix).is_err());
    assert!(Factors::default().update(&matrix).is_ok());
    // The matrix is positive except for a negative rank-one term: 1 − 2.
    matrix.assemble(2, 0, |sink| {
        sink.block(0, 0, [[1.0, 0.0], [0.0, 1.0]]);
        sink.block(1, 1, [[1.0, 0.0], [0.0, 1.0]]);
        sink.low_rank(-2.0, &[(0, [1.0, 0.0])]);
    });
    assert!(Cholesky::default().update(&matrix).is_err());
    matrix.assemble(2, 0, |sink| {
        sink.block(0, 0, [[1.0, 0.0], [0.0, 1.0]]);
        sink.block(1, 1, [[1.0, 0.0], [0.0, 1.0]]);
        sink.low_rank(-0.5, &[(0, [1.0, 0.0])]);
    });
    let mut cholesky = Cholesky::default();
    cholesky.update(&matrix).unwrap();
    let mut x = vec![1.0, 1.0, 0.0, 0.0];
    cholesky.solve(&mut x);
    assert!((x[0] - 2.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14, "{x:?}");
}

#[test]
fn directions_that_are_taken_out_stay_out() {
    let mut matrix = matrix(9);
    let full = dense(&matrix);
    let s = core::f64::consts::FRAC_1_SQRT_2;
    let mut free = [true; 9];
    let mut projectors = [isotropic(1.0); 9];
    (free[0], projectors[0]) = (false, isotropic(0.0));
    // Node 4 slides only along the diagonal.
    (free[4], projectors[4]) = (false, [[0.5, 0.5], [0.5, 0.5]]);
    matrix.constrain(&free, &projectors);
    let mut cholesky = Cholesky::default();
    cholesky.update(&matrix).unwrap();
    let mut x: Vec<f64> = (0..18).map(|k| libm::cos(k as f64)).collect();
    (x[0], x[1]) = (0.0, 0.0);
    let along = 0.5 * (x[8] + x[9]);
    (x[8], x[9]) = (along, along);
    let b = x.clone();
    cholesky.solve(&mut x);
    assert!(x[0].abs() < 1e-14 && x[1].abs() < 1e-14 && ((x[8] - x[9]) * s).abs() < 1e-13);
    // The free rows satisfy the original matrix.
    for row in (0..18).filter(|row| ![0, 1, 8, 9].contains(row)) {
        let product: f64 = (0..18).map(|column| full[row][column] * x[column]).sum();
        assert!((product - b[row]).abs() < 1e-11);
    }
}

#[test]
fn modes_of_a_free_ring_come_in_pairs() {
    // A ring of masses on springs, one coordinate each: ω² = 4 sin²(πk/N), k = 0, 1, 1, 2, 2, …
    let nodes = 40;
    let mut matrix = BlockMatrix::<1>::default();
    let fill = |matrix: &mut BlockMatrix<1>, shift: f64| {
        matrix.assemble(nodes, 0, |sink| {
            for a in 0..nodes {
                let b = (a + 1) % nodes;
                sink.block(a, a, [[1.0]]);
                sink.block(b, b, [[1.0]]);
                sink.block(a, b, [[-1.0]]);
                sink.block(b, a, [[-1.0]]);
                sink.add_diagonal(a, shift);
            }
        });
    };
    let mut shifted = BlockMatrix::<1>::default();
    fill(&mut shifted, 0.01);
    fill(&mut matrix, 0.0);
    let mut cholesky = Cholesky::default();
    cholesky.update(&shifted).unwrap();
    let mass = vec![1.0; nodes];
    let weigh = |x: &[f64], y: &mut [f64]| y.iter_mut().zip(x).zip(&mass).for_each(|((y, x), m)| *y = m * x);
    let stiffness = |x: &[f64], y: &mut [f64]| matrix.multiply(x, y);
    let pencil = crate::eigen::Pencil {
        mass: &mass,
        shift: 0.01,
        known: &[],
        weigh: &weigh,
        solve: &|x| cholesky.solve(x),
        stiffness: &stiffness,
    };
    let modes = crate::eigen::lowest_modes(9, &pencil).unwrap();
    assert_eq!(modes.len(), 9);
    for (number, mode) in modes.iter().enumerate() {
        let k = number.div_ceil(2) as f64;
        let sine = libm::sin(core::f64::consts::PI * k / nodes as f64);
        assert!((mode.square - 4.0 * sine * sine).abs() < 1e-12, "{number}: {}", mode.square);
        for other in &modes[..number] {
            assert!(crate::dot(&mode.shape, &other.shape).abs() < 1e-10);
        }
    }
}

/// An unsymmetric matrix: the factors solve with it and not with its transpose.
#[test]
fn factors_of_an_unsymmetric_matrix_solve_with_it() {
    let deliver = |sink: &mut dyn Sink<2>| {
        sink.block(0, 0, [[4.0, 1.0], [-2.0, 5.0]]);
        sink.block(0, 1, [[0.5, -1.0], [2.0, 0.0]]);
        sink.block(1, 0, [[-1.0, 3.0], [0.0, 0.25]]);
        sink.block(1, 1, [[6.0, -2.0], [1.0, 3.0]]);
        sink.low_rank(0.7, &[(0, [1.0, 2.0]), (1, [0.5, -1.0])]);
    };
    let mut matrix = BlockMatrix::<2>::default();
    matrix.assemble(2, 0, |matrix| deliver(matrix));
    let x = [1.0, -2.0, 0.5, 3.0];
    let mut b = [0.0; 4];
    matrix.multiply(&x, &mut b);
    let mut factors = Factors::default();
    factors.update_any(&matrix, false).unwrap();
    assert!(factors.solve(&mut b));
    for (found, expected) in b.iter().zip(x) {
        assert!((found - expected).abs() < 1e-13, "{b:?}");
    }
}
