//! Bending against closed forms: the buckling ring, clamped strips, the elastica.
#![allow(clippy::disallowed_methods)] // sines for expected values

use crate::support;

use crate::support::models::{Bending, MassSpring, Pressure};
use opruga_mesh::Mesh;
use std::f64::consts::PI;
use support::{Part, eigenvalues_below, forces, newton, refusal, system};

/// The outer pressure at which a ring of n nodes with R = 1 and EI = 10⁶·0.1³/12 buckles [Pa].
fn buckling_pressure(n: u32) -> f64 {
    let mesh = Mesh::ring(1.0, n, [0.0, 0.0], 0.0).unwrap();
    let stiffness = 1e8;
    let (mut low, mut high) = (100.0, 500.0);
    for _ in 0..30 {
        let outside = 0.5 * (low + high);
        // No gas inside: only the ambient pressure acts.
        let parts: Vec<Part<2>> = vec![
            (&MassSpring, values!(mass_spring, stiffness: stiffness)),
            (&Pressure, values!(pressure, nRT: 0.0, ambient: outside)),
            (&Bending, values!(bending, modulus: 1e6, thickness: 0.1)),
        ];
        let mut ring = system(&mesh, &parts);
        // Balance at every vertex: k (l − l₀) = −p l / (2 tan(π/n)), thesis §4.
        let shrunk = stiffness / (stiffness + outside / (2.0 * (PI / f64::from(n)).tan()));
        for node in 0..ring.nodes {
            let x = ring.state.x.at(node);
            ring.state.x.set(node, x.map(|c| c * shrunk));
        }
        let residual = forces(&mut ring).iter().fold(0.0f64, |m, f| if f.abs() > m { f.abs() } else { m });
        assert!(residual < 1e-6, "not in equilibrium: {residual}");
        // The three rigid motions are zero to rounding, far above this.
        if eigenvalues_below(&mut ring, -1e-3) > 0 {
            high = outside;
        } else {
            low = outside;
        }
    }
    low
}

/// Lévy 1884: fluid pressure 3EI/R³ = 250 Pa.
#[test]
fn ring_buckles_at_three_ei_over_r_cubed() {
    let coarse = (buckling_pressure(32) - 250.0) / 250.0;
    let fine = (buckling_pressure(64) - 250.0) / 250.0;
    println!("buckling: error {coarse:.2e} at 32 nodes, {fine:.2e} at 64, order {:.2}", (coarse / fine).abs().log2());
    assert!(fine.abs() < 0.02, "{fine}");
    assert!((coarse / fine).abs() > 3.0);
}

/// A strip of `n` edges, clamped by its first two nodes; returns the tip deflection under a transverse load P.
fn cantilever<const D: usize>(n: u32, bending: opruga_core::spec::Values, load: f64, stages: u32) -> [f64; D] {
    let end = core::array::from_fn(|d| if d == 0 { 1.0 } else { 0.0 });
    let mesh = Mesh::line([0.0; D], end, n).unwrap();
    let parts: Vec<Part<D>> = vec![(&MassSpring, values!(mass_spring, stiffness: 1e7)), (&Bending, bending)];
    let mut strip = system(&mesh, &parts);
    let mut right = vec![0.0; strip.nodes * D];
    let across = (strip.nodes - 1) * D + D - 1;
    let held: Vec<usize> = (0..2 * D).collect();
    for stage in 1..=stages {
        right[across] = load * f64::from(stage) / f64::from(stages);
        let residual = newton(&mut strip, &right, &held, 0.0);
        assert!(residual < 1e-8, "{residual}");
    }
    strip.state.x.at(strip.nodes - 1)
}

/// The length from the middle of the clamped edge to the tip.
fn effective(n: u32) -> f64 {
    1.0 - 0.5 / f64::from(n)
}

/// Euler–Bernoulli: PL³/3EI at small load.
#[test]
fn clamped_strip_in_the_plane() {
    for n in [10, 40] {
        let (ei, load, l) = (2e5 * 1e-3 / 12.0, 1e-3, effective(n));
        let tip = cantilever::<2>(n, values!(bending, modulus: 2e5, thickness: 0.1), load, 1)[1];
        let expected = load * l * l * l / (3.0 * ei);
        let error = (tip - expected) / expected;
        println!("strip of {n}: error {error:.2e}");
        assert!(error.abs() < 0.01, "{error}");
    }
}

/// A round wire in space: EI = E π t⁴/64.
#[test]
fn clamped_wire_in_space() {
    let (n, t, load) = (40, 0.1f64, 1e-3);
    let ei = 2e6 * PI * t.powi(4) / 64.0;
    let tip = cantilever::<3>(n, values!(bending, modulus: 2e6, thickness: t), load, 1)[2];
    let expected = load * effective(n).powi(3) / (3.0 * ei);
    assert!(((tip - expected) / expected).abs() < 0.01, "{tip} {expected}");
}

/// Bisshopp and Drucker 1945: PL²/EI = 1 and 4 → deflection 0.301721 L and 0.669964 L (validation.md B1).
#[test]
fn elastica() {
    let n = 60;
    let l = effective(n);
    for (alpha, deflection) in [(1.0, 0.301721), (4.0, 0.669964)] {
        let ei = 2e5 * 1e-3 / 12.0;
        let tip = cantilever::<2>(n, values!(bending, modulus: 2e5, thickness: 0.1), alpha * ei / (l * l), 40)[1];
        let error = tip / l / deflection - 1.0;
        println!("elastica {alpha}: error {error:.2e}");
        assert!(error.abs() < 2e-3, "{error}");
    }
}

/// The tip deflection of a clamped sheet, over P L³ / (3 EI) with EI = E t³/12 per width.
fn sheet(cells: [u32; 2], alternating: bool) -> f64 {
    let width = f64::from(cells[1]) / f64::from(cells[0]);
    let mut mesh = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, width, 0.0]], cells).unwrap();
    if !alternating {
        let halves = mesh.sheet_quadrilaterals.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        mesh.sheets = halves.collect();
    }
    let parts: Vec<Part<3>> = vec![
        (&MassSpring, values!(mass_spring, stiffness: 1e5, edges: "shear")),
        (&Bending, values!(bending, modulus: 2e5, thickness: 0.1)),
    ];
    let mut sheet = system(&mesh, &parts);
    let mut right = vec![0.0; sheet.nodes * 3];
    let (mut held, mut tips) = (Vec::new(), Vec::new());
    for (node, x) in mesh.positions.iter().enumerate() {
        if x[0] < 1.5 / f64::from(cells[0]) {
            held.extend(3 * node..3 * node + 3);
        }
        if x[0] > 1.0 - 1e-9 {
            tips.push(3 * node + 2);
        }
    }
    let (load, last) = (1e-4, tips.len() - 1);
    for (k, tip) in tips.iter().enumerate() {
        // Each cell distributes its load equally to its two corners.
        right[*tip] = load / f64::from(cells[1]) * if k == 0 || k == last { 0.5 } else { 1.0 };
    }
    assert!(newton(&mut sheet, &right, &held, 0.0) < 1e-9);
    let expected = load * effective(cells[0]).powi(3) / (3.0 * 2e5 * 1e-3 / 12.0 * width);
    let mean = tips.iter().map(|t| sheet.state.x.at(t / 3)[2]).sum::<f64>() / tips.len() as f64;
    mean / expected
}

/// On right triangles bending couples to twist: a strip that may warp has 4/5 of E t³/12 (see the documentation).
///
/// For each cell with curvatures κ₁, κ₂ and twist τ, U = ½ B ((κ₁ + τ)² + (κ₂ + τ)² + 4τ²), which is minimal at κ₂ = −τ = κ₁/5.
#[test]
fn clamped_sheet_in_space() {
    let (few, many) = (sheet([12, 2], false), sheet([20, 3], false));
    println!("sheet: deflection times {few:.4}, {many:.4}; with alternating diagonals {:.4}", sheet([12, 2], true));
    assert!((1.15..1.26).contains(&few) && (1.15..1.26).contains(&many));
}

/// A tube of regular triangles, `n` around and `rows` along it. The edges of one direction run either around the tube or along
/// it.
fn tube(n: u32, rows: u32, around: bool) -> (Mesh<3>, f64) {
    // A lattice with rows √3/2 apart, rolled up along its rows or across them.
    let h = 0.75f64.sqrt();
    let (count, turn) = if around { ([n, rows], f64::from(n)) } else { ([rows, n], f64::from(n) * h) };
    let radius = turn / (2.0 * PI);
    let mut mesh = Mesh::<3>::default();
    let wrapped = |i: u32, j: u32| if around { j * count[0] + i % n } else { (j % n) * count[0] + i };
    for j in 0..count[1] {
        for i in 0..count[0] {
            let (u, v) = (f64::from(i) + 0.5 * f64::from(j % 2), h * f64::from(j));
            let (arc, along) = if around { (u, v) } else { (v, u) };
            mesh.positions.push([radius * (arc / radius).cos(), radius * (arc / radius).sin(), along]);
        }
    }
    let (last_i, last_j) = if around { (n, rows - 1) } else { (rows - 1, n) };
    for j in 0..last_j {
        for i in 0..last_i {
            let (a, b, c, d) = (wrapped(i, j), wrapped(i + 1, j), wrapped(i + 1, j + 1), wrapped(i, j + 1));
            mesh.sheets.extend(if j % 2 == 0 { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    let area = 0.25 * 3f64.sqrt() * mesh.sheets.len() as f64;
    (mesh, 0.5 * area / (radius * radius))
}

/// U = ½ B A/R² for a sheet rolled into a tube, in both directions of the lattice (Seung and Nelson 1988).
#[test]
fn rolled_up_sheet() {
    for around in [true, false] {
        let (mesh, expected) = tube(60, 40, around);
        // B = E t³/12 = 1.
        let bending = values!(bending, modulus: 12.0, thickness: 1.0, rest: "straight");
        let mut tube = system(&mesh, &[(&Bending as _, bending)]);
        let ratio = support::energy(&mut tube) / expected;
        println!("tube: energy {ratio:.4}");
        // Edges at the two ends do not bend.
        assert!((ratio - 1.0).abs() < 0.03, "{around} {ratio}");
    }
}

/// There is no force at rest; rotating a bent outline does not change its energy.
#[test]
fn rest_shape_is_at_rest() {
    let mesh = Mesh::icosphere(0.7, 2).unwrap();
    let mut shell = system(&mesh, &[(&Bending as _, values!(bending, stiffness: 1.0))]);
    let force = forces(&mut shell).iter().fold(0.0f64, |m, f| if f.abs() > m { f.abs() } else { m });
    assert!(force < 1e-13, "{force}");
}

/// Refusals name the problem.
#[test]
fn refusals() {
    let line = Mesh::<2>::line([0.0; 2], [1.0, 0.0], 1).unwrap();
    let ring = Mesh::ring(1.0, 9, [0.0; 2], 0.0).unwrap();
    let both = "model.one_of bending: exactly one of `stiffness`, `modulus` must be given";
    assert!(
        refusal(&line, &Bending, values!(bending, stiffness: 1.0)).starts_with("model.no_hinges bending: the body has")
    );
    assert_eq!(refusal(&ring, &Bending, values!(bending)), both);
    assert_eq!(refusal(&ring, &Bending, values!(bending, stiffness: 1.0, modulus: 1.0, thickness: 1.0)), both);
    let thin = refusal(&ring, &Bending, values!(bending, modulus: 1.0));
    assert_eq!(thin, "model.one_of bending: `modulus` needs `thickness`");
    let thick = refusal(&ring, &Bending, values!(bending, stiffness: 1.0, thickness: 0.1));
    assert_eq!(thick, "model.one_of bending: `thickness` goes with `modulus`, not with `stiffness`");
}
