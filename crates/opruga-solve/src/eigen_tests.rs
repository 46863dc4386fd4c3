use super::*;
use crate::{BlockMatrix, Cholesky};
use core::cell::Cell;
use opruga_core::potential::Sink;

/// The number of points on an edge of the membrane below.
const EDGE: usize = 21;

/// ω² of a square membrane of springs with a fixed boundary: 4 sin²(iπ/2n) + 4 sin²(jπ/2n) with n = EDGE + 1, ascending. Pairs
/// (i, j) and (j, i) have the same frequency.
fn membrane() -> Vec<f64> {
    let part = |i: usize| {
        let sine = libm::sin(core::f64::consts::PI * i as f64 / (2 * (EDGE + 1)) as f64);
        4.0 * sine * sine
    };
    let mut squares: Vec<f64> = (0..EDGE * EDGE).map(|k| part(k % EDGE + 1) + part(k / EDGE + 1)).collect();
    squares.sort_by(f64::total_cmp);
    squares
}

fn stiffness_of_membrane(shift: f64) -> BlockMatrix<1> {
    let mut matrix = BlockMatrix::<1>::default();
    matrix.assemble(EDGE * EDGE, 0, |sink| {
        for a in 0..EDGE * EDGE {
            sink.add_diagonal(a, 4.0 + shift);
            let right = (a % EDGE + 1 < EDGE).then_some(a + 1);
            for b in right.into_iter().chain((a + EDGE < EDGE * EDGE).then_some(a + EDGE)) {
                sink.block(a, b, [[-1.0]]);
                sink.block(b, a, [[-1.0]]);
            }
        }
    });
    matrix
}

/// Finds the lowest modes of the membrane and checks their accuracy; returns the number of solved equations.
fn check(count: usize, coupled: bool) -> usize {
    let n = EDGE * EDGE;
    let (stiffness, shifted) = (stiffness_of_membrane(0.0), stiffness_of_membrane(1e-5));
    let mut factor = Cholesky::default();
    factor.update(&shifted).unwrap();
    let mass = vec![1.0; n];
    let solves = Cell::new(0);
    // A mass that couples coordinates and has the same eigenvectors: M = 1 + K/20. Then (K + s M) v = (1 + s/20) (K + s′ 1) v.
    let part = if coupled { 0.05 } else { 0.0 };
    let weigh = |x: &[f64], y: &mut [f64]| {
        stiffness.multiply(x, y);
        y.iter_mut().zip(x).for_each(|(y, x)| *y = *x + part * *y);
    };
    let shift = 1e-5 / (1.0 - part * 1e-5);
    let pencil = Pencil {
        mass: &mass,
        shift,
        known: &[],
        weigh: &weigh,
        solve: &|x| {
            solves.set(solves.get() + 1);
            factor.solve(x);
            x.iter_mut().for_each(|x| *x /= 1.0 + part * shift);
        },
        stiffness: &|x, y| stiffness.multiply(x, y),
    };
    let modes = lowest_modes(count, &pencil).unwrap();
    assert_eq!(modes.len(), count);
    let mut product = vec![0.0; n];
    for (k, (mode, square)) in modes.iter().zip(membrane()).enumerate() {
        let square = square / (1.0 + part * square);
        assert!((mode.square / square - 1.0).abs() < 1e-11, "{count} modes, the {k}-th: {} {square}", mode.square);
        assert!(mode.residual < 1e-9, "{count} modes, the {k}-th: residual {}", mode.residual);
        weigh(&mode.shape, &mut product);
        for (j, other) in modes.iter().enumerate().take(k + 1) {
            let expected = if j == k { 1.0 } else { 0.0 };
            assert!((dot(&other.shape, &product) - expected).abs() < 1e-9, "modes {j} and {k} of {count}");
        }
    }
    solves.get()
}

/// Each vector of a basis requires one solution of the equations. No frequency is missed, not even a double one.
#[test]
fn few_modes_take_a_basis_that_grows_with_their_number() {
    for count in [1, 30, 60] {
        let solves = check(count, false);
        assert!(solves <= 2 * count + 200, "{count} modes took {solves} solutions");
    }
    assert!(check(60, true) <= 320);
}

/// Many modes come from the dense matrix, which requires as many solutions as the body has coordinates.
#[test]
fn all_modes_take_as_many_solutions_as_there_are_coordinates() {
    for count in [300, EDGE * EDGE] {
        assert_eq!(check(count, false), EDGE * EDGE);
    }
    assert_eq!(check(EDGE * EDGE, true), EDGE * EDGE);
}
