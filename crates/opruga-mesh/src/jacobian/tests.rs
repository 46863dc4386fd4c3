//! The minimum determinant of cells compared with differences of their maps.

use super::*;

/// Nodes of reference cells.
fn triangle() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]]
}
fn tetrahedron() -> Vec<[f64; 3]> {
    let mut out = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for [a, b] in TETRAHEDRON_EDGES {
        out.push(core::array::from_fn(|d| 0.5 * (out[a][d] + out[b][d])));
    }
    out
}
fn hexahedron() -> Vec<[f64; 3]> {
    let corner = |k: usize| [[0, 1, 1, 0][k % 4] as f64, [0, 0, 1, 1][k % 4] as f64, (k / 4) as f64];
    (0..8).map(corner).collect()
}

/// Pseudo-random numbers from −1 to 1, the same in every run.
fn chance(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// det ∂x/∂ξ from differences of x = Σ Nₐ xₐ, which are exact for polynomials of degree two.
fn by_differences<const D: usize>(nodes: &[[f64; D]], at: [f64; 4]) -> f64 {
    let is_box = nodes.len() == 1 << D;
    let x = |at: [f64; 4]| -> [f64; D] {
        let weight = |a: usize| -> f64 {
            if is_box {
                let high = [[false, true, true, false][a % 4], [false, false, true, true][a % 4], a / 4 == 1];
                return (0..D).map(|d| if high[d] { at[d] } else { 1.0 - at[d] }).product();
            }
            match a.checked_sub(D + 1) {
                None => at[a] * (2.0 * at[a] - 1.0),
                Some(k) => {
                    let [i, j] = if D == 2 { TRIANGLE_SIDES[k] } else { TETRAHEDRON_EDGES[k] };
                    4.0 * at[i] * at[j]
                }
            }
        };
        core::array::from_fn(|d| (0..nodes.len()).map(|a| weight(a) * nodes[a][d]).sum())
    };
    let columns: [[f64; D]; D] = core::array::from_fn(|k| {
        let h = 0.25;
        let (mut up, mut down) = (at, at);
        if is_box {
            (up[k], down[k]) = (at[k] + h, at[k] - h);
        } else {
            (up[k + 1], up[0]) = (at[k + 1] + h, at[0] - h);
            (down[k + 1], down[0]) = (at[k + 1] - h, at[0] + h);
        }
        less(&x(up), &x(down)).map(|x| x / (2.0 * h))
    });
    determinant(&columns)
}

/// Points inside a cell and on its edges.
fn sample_points(is_box: bool, dimension: usize) -> Vec<[f64; 4]> {
    const STEPS: usize = 8;
    let mut out = Vec::new();
    for code in 0..(STEPS + 1).pow(dimension as u32) {
        let x: Vec<f64> =
            (0..dimension).map(|d| (code / (STEPS + 1).pow(d as u32) % (STEPS + 1)) as f64 / STEPS as f64).collect();
        let rest = 1.0 - x.iter().sum::<f64>();
        if is_box {
            out.push(core::array::from_fn(|d| x.get(d).copied().unwrap_or(0.0)));
        } else if rest >= 0.0 {
            out.push(core::array::from_fn(|k| if k == 0 { rest } else { x.get(k - 1).copied().unwrap_or(0.0) }));
        }
    }
    out
}

fn agrees<const D: usize>(reference: &[[f64; D]], amount: f64, state: &mut u64) {
    let mut nodes = reference.to_vec();
    nodes.iter_mut().flatten().for_each(|x| *x += amount * chance(state));
    let net = Net::of(&nodes).expect("a cell");
    let least = least_jacobian(&nodes).expect("a cell");
    let mut sampled = f64::INFINITY;
    for at in sample_points(nodes.len() == 1 << D, D) {
        let expected = by_differences(&nodes, at);
        assert!((net.value(at) - expected).abs() < 1e-11, "{at:?}: {} {expected}", net.value(at));
        sampled = if expected < sampled { expected } else { sampled };
    }
    // The pieces represent the same polynomial.
    for half in net.halves().iter().flat_map(Net::halves) {
        for (value, at) in half.vertices() {
            assert!((value - net.value(at)).abs() < 1e-11);
        }
    }
    assert!(least.bound <= sampled + 1e-12, "{least:?} {sampled}");
    assert!((net.value(least.at) - least.found).abs() < 1e-11 && least.bound <= least.found);
    if sampled < -1e-12 {
        assert!(!least.is_upright(), "{least:?} {sampled}");
    }
    // If the sign is not determined, the bounds are close to each other.
    assert!(least.is_upright() || least.is_inverted() || least.found - least.bound < 2e-2, "{least:?}");
}

#[test]
fn the_least_jacobian_of_any_cell_is_bounded_from_both_sides() {
    let mut state = 7;
    for round in 0..200 {
        let amount = 0.02 + 0.002 * f64::from(round);
        agrees(&triangle(), amount, &mut state);
        agrees(&tetrahedron(), 0.5 * amount, &mut state);
        agrees(&hexahedron(), amount, &mut state);
        agrees(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], amount, &mut state);
    }
}

#[test]
fn a_cell_folded_between_its_nodes_is_found() {
    // The determinant is positive at all corners and midpoints of edges, but negative on a face between them.
    let mut nodes = tetrahedron();
    let mut state = 3;
    let found = (0..200_000).any(|_| {
        nodes = tetrahedron();
        nodes.iter_mut().flatten().for_each(|x| *x += 0.18 * chance(&mut state));
        let net = Net::of(&nodes).expect("a cell");
        let all = net.samples().into_iter().all(|at| net.value(at) > 1e-9);
        all && least_jacobian(&nodes).expect("a cell").is_inverted()
    });
    assert!(found);
    let least = least_jacobian(&nodes).expect("a cell");
    assert!(by_differences(&nodes, least.at) <= 0.0, "{least:?}");
}

#[test]
fn straight_cells_have_one_jacobian_and_flat_ones_have_none() {
    for (least, expected) in [
        (least_jacobian(&triangle()), 1.0),
        (least_jacobian(&tetrahedron()), 1.0),
        (least_jacobian(&hexahedron()), 1.0),
        (least_jacobian(&triangle()[..3]), 1.0),
    ] {
        let least = least.expect("a cell");
        assert!((least.bound - expected).abs() < 1e-14 && (least.found - expected).abs() < 1e-14, "{least:?}");
    }
    let flat: Vec<[f64; 2]> = triangle().iter().map(|x| [x[0], 0.0]).collect();
    let flat = least_jacobian(&flat).expect("a cell");
    assert!(!flat.is_positive() && flat.is_upright() && !flat.is_inverted(), "{flat:?}");
    // A corner in the plane of its neighbours is degenerate but not inverted, whatever its position.
    for shift in [0.0, 0.3, 1e3] {
        let mut cell = hexahedron();
        cell[6] = [2.0 / 3.0; 3];
        cell.iter_mut().for_each(|x| *x = x.map(|x| x / 3.0 + shift));
        let least = least_jacobian(&cell).expect("a cell");
        assert!(!least.is_positive() && least.is_upright() && !least.is_inverted(), "{least:?}");
        cell[6] = cell[6].map(|x| x - 1e-6);
        assert!(least_jacobian(&cell).expect("a cell").is_inverted());
    }
    let lost: Vec<[f64; 2]> = triangle().iter().map(|x| [x[0], f64::NAN]).collect();
    assert!(least_jacobian(&lost).expect("a cell").is_inverted());
    assert_eq!(least_jacobian(&triangle()[..2]), None);
}
