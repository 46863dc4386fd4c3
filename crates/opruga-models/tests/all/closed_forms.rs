//! Springs and gas against closed forms (thesis §4, validation B3 and B4).
#![allow(clippy::disallowed_methods)] // sines and powers for expected values

use crate::support;

use crate::support::models::{MassSpring, Pressure};
use opruga_core::system::{Stage, System};
use opruga_mesh::{Cells, Mesh, signed_volume};
use std::f64::consts::PI;
use support::{Part, energy, forces, hessian, newton, system, system_with_mass};

fn edge(ring: &System<2>, a: usize, b: usize) -> f64 {
    let (a, b) = (ring.state.x.at(a), ring.state.x.at(b));
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// A reading of a model in the present state.
fn reading<const D: usize>(system: &mut System<D>, model: usize, name: &str) -> f64 {
    system.forces(false).unwrap();
    let member = &system.members[model];
    let view = system.view(Stage::Current, system.time);
    let readings = member.potential.readings(&view, &member.scratch, &member.memory, 0);
    readings.iter().find(|r| r.0 == name).unwrap().1
}

/// A ring of N = 36 in equilibrium, started from a state that is flattened by a tenth.
fn settled(gas: opruga_core::spec::Values, k: f64) -> System<2> {
    let mesh = Mesh::ring(0.5, 36, [0.0; 2], 0.0).unwrap();
    let mut ring = system(&mesh, &[(&MassSpring, values!(mass_spring, stiffness: k)), (&Pressure, gas)]);
    for node in 0..36 {
        let x = ring.state.x.at(node);
        ring.state.x.set(node, [1.3 * x[0], 1.2 * x[1]]);
    }
    let residual = newton(&mut ring, &[0.0; 72], &[], 1e-6 * k);
    assert!(residual < 1e-10, "{residual}");
    ring
}

/// k (l − l₀) = 2 nRT/(N l), so l = (l₀ + √(l₀² + 8 nRT/(kN)))/2, to 1e-9.
#[test]
fn ring_in_equilibrium() {
    let (k, amount) = (1600.0, 100.0);
    let mut ring = settled(values!(pressure, nRT: amount), k);
    let rest = 2.0 * 0.5 * (PI / 36.0).sin();
    let expected = 0.5 * (rest + (rest * rest + 8.0 * amount / (k * 36.0)).sqrt());
    for node in 0..36 {
        let l = edge(&ring, node, (node + 1) % 36);
        assert!((l / expected - 1.0).abs() < 1e-9, "{l} {expected}");
    }
    // R = l / (2 sin(π/N)), A = N l²/(4 tan(π/N)).
    let area = 36.0 * expected * expected / (4.0 * (PI / 36.0).tan());
    assert!((reading(&mut ring, 1, "volume") / area - 1.0).abs() < 1e-9);
    assert!((reading(&mut ring, 1, "pressure") * area / amount - 1.0).abs() < 1e-9);
}

/// k (l − l₀) = (P − P_a) l / (2 tan(π/N)) at every vertex, with ambient pressure and adiabatic gas.
#[test]
fn balance_at_every_vertex() {
    for gas in [
        values!(pressure, pressure: 150.0, ambient: 50.0),
        values!(pressure, pressure: 150.0, ambient: 50.0, process: "adiabatic", gamma: 1.4),
    ] {
        let mut ring = settled(gas, 900.0);
        let (l, rest) = (edge(&ring, 7, 8), (PI / 36.0).sin());
        let gauge = reading(&mut ring, 1, "pressure") - 50.0;
        let (tension, push) = (900.0 * (l - rest), gauge * l / (2.0 * (PI / 36.0).tan()));
        assert!((tension / push - 1.0).abs() < 1e-9, "{tension} {push}");
    }
}

/// ω² = (4 sin²(π/N)/m) [k + ((2γ − 1) P + P_a)/(2 tan(π/N))].
#[test]
fn breathing_mode() {
    for (gamma, ambient) in [(1.0, 0.0), (1.0, 50.0), (1.4, 0.0), (1.4, 50.0)] {
        let (k, m) = (900.0, 1.0);
        let gas = if gamma > 1.0 {
            values!(pressure, pressure: 150.0, ambient: ambient, process: "adiabatic", gamma: gamma)
        } else {
            values!(pressure, pressure: 150.0, ambient: ambient)
        };
        let mut ring = settled(gas, k);
        let pressure = reading(&mut ring, 1, "pressure");
        // The breathing mode is an eigenvector of the Hessian.
        let mut center = [0.0; 2];
        for node in 0..36 {
            let x = ring.state.x.at(node);
            center = [center[0] + x[0] / 36.0, center[1] + x[1] / 36.0];
        }
        let mut u = Vec::new();
        for node in 0..36 {
            let x = ring.state.x.at(node);
            let d = [x[0] - center[0], x[1] - center[1]];
            let r = (d[0] * d[0] + d[1] * d[1]).sqrt();
            u.extend([d[0] / r, d[1] / r]);
        }
        let product = hessian(&mut ring).times(&u);
        let square = product.iter().zip(&u).map(|(a, b)| a * b).sum::<f64>() / 36.0 / m;
        let across = product.iter().zip(&u).fold(0.0f64, |w, (p, u)| w + (p - square * m * u).powi(2));
        let (sin, tan) = ((PI / 36.0).sin(), (PI / 36.0).tan());
        let expected = 4.0 * sin * sin / m * (k + ((2.0 * gamma - 1.0) * pressure + ambient) / (2.0 * tan));
        println!("breathing γ = {gamma}, P_a = {ambient}: ω² = {square}, error {:.1e}", square / expected - 1.0);
        assert!((square / expected - 1.0).abs() < 1e-6, "{square} {expected}");
        assert!(across.sqrt() < 1e-6 * expected, "no eigenvector: {across}");
    }
}

/// A gas ring and a gas balloon without springs, P_a = P₀: ω = √(4πγP₀/M) and √(12πγP₀R/M).
#[test]
fn breathing_of_gas_alone() {
    let gas = || values!(pressure, pressure: 300.0, ambient: 300.0, process: "adiabatic", gamma: 1.4);
    let n = 400;
    let ring = Mesh::ring(0.5, n, [0.0; 2], 0.0).unwrap();
    let sphere = Mesh::icosphere(0.5, 3).unwrap();
    let mass = 2.0;
    let mut plane = system_with_mass(&ring, &[(&Pressure, gas())], mass / f64::from(n));
    let u: Vec<f64> = ring.positions.iter().flatten().map(|c| c / 0.5).collect();
    let square = hessian(&mut plane).times(&u).iter().zip(&u).map(|(a, b)| a * b).sum::<f64>() / mass;
    assert!((square / (4.0 * PI * 1.4 * 300.0 / mass) - 1.0).abs() < 1e-3, "{square}");
    let mut space = system_with_mass(&sphere, &[(&Pressure, gas())], mass / sphere.positions.len() as f64);
    let u: Vec<f64> = sphere.positions.iter().flatten().map(|c| c / 0.5).collect();
    let square = hessian(&mut space).times(&u).iter().zip(&u).map(|(a, b)| a * b).sum::<f64>() / mass;
    // To rounding with the volume of the polyhedron, 9γPV/(R²M); to 2 % with that of the sphere.
    let volume = signed_volume(&sphere.facets, &sphere.positions);
    assert!((square / (9.0 * 1.4 * 300.0 * volume / (0.25 * mass)) - 1.0).abs() < 1e-12);
    assert!((square / (12.0 * PI * 1.4 * 300.0 * 0.5 / mass) - 1.0).abs() < 0.02, "{square}");
}

/// A patch of the regular triangular lattice. Every second row is shifted by half an edge, so the patch is nearly a rectangle.
fn lattice(n: u32) -> Mesh<2> {
    let h = 0.75f64.sqrt();
    let mut positions = Vec::new();
    for j in 0..n {
        for i in 0..n {
            positions.push([f64::from(i) + 0.5 * f64::from(j % 2), h * f64::from(j)]);
        }
    }
    let mut triangles = Vec::new();
    for j in 0..n - 1 {
        for i in 0..n - 1 {
            let (a, d) = (j * n + i, (j + 1) * n + i);
            let (b, c) = (a + 1, d + 1);
            triangles.extend(if j % 2 == 0 { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    let mut mesh = Mesh { positions, cells: Cells { triangles, ..Cells::default() }, ..Mesh::default() };
    mesh.facets = mesh.facets_from_cells().unwrap();
    mesh
}

/// The lattice of springs k behaves like a sheet with E₂D = 2k/√3 and ν = 1/3, if the springs on the boundary have k/2.
#[test]
fn lattice_modulus() {
    let mesh = lattice(9);
    let (modulus, nu) = (800.0, 1.0 / 3.0);
    let area = signed_volume(&mesh.facets, &mesh.positions);
    let mut sheet = system(&mesh, &[(&MassSpring as _, values!(mass_spring, modulus: modulus))]);
    let small = 1e-4;
    for [ex, ey, shear] in [[1.0, 0.0, 0.0], [0.3, -0.7, 0.0], [0.0, 0.0, 1.0], [0.4, 0.9, -0.6]] {
        // The mean over a strain and its opposite has no third-order term.
        let mut mean = 0.0;
        for sign in [-small, small] {
            for (node, x) in mesh.positions.iter().enumerate() {
                let moved =
                    [x[0] + sign * (ex * x[0] + 0.5 * shear * x[1]), x[1] + sign * (ey * x[1] + 0.5 * shear * x[0])];
                sheet.state.x.set(node, moved);
            }
            mean += 0.5 * energy(&mut sheet) / (small * small);
        }
        // Plane stress.
        let axial = 0.5 * modulus / (1.0 - nu * nu) * (ex * ex + ey * ey + 2.0 * nu * ex * ey);
        let expected = area * (axial + 0.25 * modulus / (1.0 + nu) * shear * shear);
        println!("lattice: error {:.1e}", mean / expected - 1.0);
        assert!((mean / expected - 1.0).abs() < 1e-6, "{mean} {expected}");
    }
    // An inner spring has k = √3/2 E₂D: one stretched by 1 % has ½ k 1e-4.
    let pair = Mesh::<2> { wires: vec![[0, 1]], positions: vec![[0.0, 0.0], [1.0, 0.0]], ..Mesh::default() };
    let k = 0.75f64.sqrt() * modulus;
    let mut spring = system(&pair, &[(&MassSpring as _, values!(mass_spring, stiffness: k))]);
    spring.state.x.set(1, [1.01, 0.0]);
    assert!((energy(&mut spring) - 0.5 * k * 1e-4).abs() < 1e-12);
}

/// A mesh whose nodes are displaced at random by a tenth.
fn shaken<const D: usize>(mesh: &Mesh<D>, parts: &[Part<D>], seed: u64) -> System<D> {
    let mut random = opruga_core::check::Random::new(seed);
    let mut body = system(mesh, parts);
    for (node, x) in mesh.positions.iter().enumerate() {
        let noise: [f64; D] = random.vector();
        body.state.x.set(node, core::array::from_fn(|d| x[d] + 0.05 * noise[d]));
    }
    body
}

/// The force is the gauge pressure times ∂V/∂x, without net force and torque, on a torus far from the origin.
#[test]
fn force_is_pressure_times_the_change_of_volume() {
    let mut mesh = Mesh::torus(1.0, 0.4, [12, 8]).unwrap();
    mesh.translate([300.0, -200.0, 100.0]);
    let mut torus = shaken(&mesh, &[(&Pressure as _, values!(pressure, nRT: 90.0, ambient: 11.0))], 3);
    let force = forces(&mut torus);
    let gauge = reading(&mut torus, 0, "pressure") - 11.0;
    let mut x: Vec<[f64; 3]> = (0..torus.nodes).map(|n| torus.state.x.at(n)).collect();
    let largest = force.iter().fold(0.0f64, |m, f| if f.abs() > m { f.abs() } else { m });
    let (mut net, mut torque) = ([0.0; 3], [0.0; 3]);
    for node in 0..torus.nodes {
        let (f, r) = (&force[3 * node..3 * node + 3], x[node]);
        let arm = [r[0] - 300.0, r[1] + 200.0, r[2] - 100.0];
        for d in 0..3 {
            let (e, g) = ((d + 1) % 3, (d + 2) % 3);
            net[d] += f[d];
            torque[d] += arm[e] * f[g] - arm[g] * f[e];
            // The volume is linear in each coordinate.
            x[node][d] = r[d] + 0.1;
            let more = signed_volume(&mesh.facets, &x);
            x[node][d] = r[d] - 0.1;
            let slope = (more - signed_volume(&mesh.facets, &x)) / 0.2;
            x[node][d] = r[d];
            assert!((f[d] - gauge * slope).abs() < 1e-9 * largest, "{} {}", f[d], gauge * slope);
        }
    }
    for d in 0..3 {
        assert!(net[d].abs() < 1e-12 * largest && torque[d].abs() < 1e-12 * largest, "{net:?} {torque:?}");
    }
}

/// P V and P V^γ stay constant, to 1e-12, down to the smallest volume that the scene allows. The energy of the gas falls by the work that it does:
/// P₀V₀ ln(V/V₀) at constant temperature, and (P₀V₀ − P V)/(γ − 1) without heat.
#[test]
fn gas_laws() {
    let mesh = Mesh::icosphere(0.5, 2).unwrap();
    for gamma in [1.0, 1.4, 1.67] {
        let gas = if gamma > 1.0 {
            values!(pressure, pressure: 100.0, ambient: 0.0, process: "adiabatic", gamma: gamma, smallest_volume: 1e-3)
        } else {
            values!(pressure, pressure: 100.0, ambient: 0.0, smallest_volume: 1e-3)
        };
        let mut balloon = system(&mesh, &[(&Pressure as _, gas)]);
        let start = reading(&mut balloon, 0, "volume");
        let (product, energy_at_start) = (100.0 * start, energy(&mut balloon));
        for factor in [0.2, 0.5f64.cbrt(), 1.1, 3.0] {
            for (node, x) in mesh.positions.iter().enumerate() {
                balloon.state.x.set(node, x.map(|c| factor * c));
            }
            let ratio = reading(&mut balloon, 0, "volume") / start;
            let pressure = reading(&mut balloon, 0, "pressure");
            assert!((ratio / factor.powi(3) - 1.0).abs() < 1e-12);
            assert!((pressure * ratio.powf(gamma) / 100.0 - 1.0).abs() < 1e-12, "{pressure}");
            let work =
                if gamma > 1.0 { (product - pressure * ratio * start) / (gamma - 1.0) } else { product * ratio.ln() };
            let fall = energy_at_start - energy(&mut balloon);
            assert!((fall - work).abs() < 1e-12 * product, "{gamma} {factor}: {fall} {work}");
        }
    }
}

/// Velocity Verlet on springs and gas; returns the energy at each step relative to the initial one, and the smallest volume.
fn thrown<const D: usize>(
    mesh: &Mesh<D>,
    gas: opruga_core::spec::Values,
    speed: f64,
    h: f64,
    time: f64,
) -> (Vec<f64>, f64) {
    let springs = values!(mass_spring, stiffness: 20.0);
    let mut body = shaken(mesh, &[(&MassSpring, springs), (&Pressure, gas)], 9);
    let n = body.nodes;
    for node in 0..n {
        // Left and right are exchanged.
        let x = body.state.x.at(node);
        body.state.v.set(node, core::array::from_fn(|d| if d == 0 { -speed * x[0] } else { -0.1 * x[d] }));
    }
    let kinetic =
        |body: &System<D>| (0..n).map(|k| 0.5 * body.state.v.at(k).iter().map(|c| c * c).sum::<f64>()).sum::<f64>();
    let start = energy(&mut body) + kinetic(&body);
    let (mut energies, mut least) = (Vec::new(), f64::INFINITY);
    let mut force = forces(&mut body);
    for _ in 0..(time / h) as usize {
        for node in 0..n {
            let (x, v) = (body.state.x.at(node), body.state.v.at(node));
            let half: [f64; D] = core::array::from_fn(|d| v[d] + 0.5 * h * force[node * D + d]);
            body.state.v.set(node, half);
            body.state.x.set(node, core::array::from_fn(|d| x[d] + h * half[d]));
        }
        force = forces(&mut body);
        assert!(force.iter().all(|f| f.is_finite()));
        for node in 0..n {
            let v = body.state.v.at(node);
            body.state.v.set(node, core::array::from_fn(|d| v[d] + 0.5 * h * force[node * D + d]));
        }
        energies.push((energy(&mut body) + kinetic(&body)) / start);
        let volume = reading(&mut body, 1, "volume");
        least = if volume < least { volume } else { least };
    }
    (energies, least)
}

/// A body thrown through its own middle inverts: the energy is conserved to second order in the step, without NaN.
#[test]
fn collapse_makes_no_energy() {
    let worst =
        |energies: &[f64]| energies.iter().fold(0.0f64, |m, e| if (e - 1.0).abs() > m { (e - 1.0).abs() } else { m });
    let ring = Mesh::ring(0.5, 16, [0.0; 2], 0.0).unwrap();
    let sphere = Mesh::icosphere(0.5, 1).unwrap();
    for process in ["isothermal", "adiabatic"] {
        let gas = || values!(pressure, pressure: 0.6, ambient: 0.2, process: process, smallest_volume: 0.02);
        let (coarse, inside) = thrown(&ring, gas(), 12.0, 4e-4, 4.0);
        let (fine, _) = thrown(&ring, gas(), 12.0, 1e-4, 4.0);
        println!("{process} ring: error {:.1e}, {:.1e}; least volume {inside:.3}", worst(&coarse), worst(&fine));
        assert!(inside < -0.05, "did not turn inside out: {inside}");
        assert!(worst(&fine) < 1e-4 && worst(&fine) < 0.4 * worst(&coarse));
        let (coarse, inside) = thrown(&sphere, gas(), 12.0, 4e-4, 2.0);
        let (fine, _) = thrown(&sphere, gas(), 12.0, 1e-4, 2.0);
        println!("{process} ball: error {:.1e}, {:.1e}; least volume {inside:.3}", worst(&coarse), worst(&fine));
        assert!(inside < -0.05, "did not turn inside out: {inside}");
        assert!(worst(&fine) < 1e-4 && worst(&fine) < 0.4 * worst(&coarse));
    }
}
