//! Quadrilaterals and hexahedra: they bend correctly for every Poisson's ratio, and no deformation of them is without stiffness.

use crate::sparse;
use crate::support;

use crate::support::models::Fem;
use opruga_core::potential::Model;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use opruga_models::materials::NAMES;
use support::{eigenvalues_below, forces, hessian, system};

const RATIOS: [f64; 5] = [0.0, 0.3, 0.45, 0.49, 0.4999];

/// The dimensions of the bar, and the number of its cells.
const LENGTH: f64 = 1.0;
const HEIGHT: f64 = 0.1;

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |m, x| if x.abs() > m { x.abs() } else { m })
}

/// For a bar with E = 1 that is displaced by a field: the largest force on the nodes between its ends, the largest force on all
/// nodes, and the moment on its right end.
fn bent<const D: usize>(mesh: &Mesh<D>, values: Values, field: impl Fn([f64; D]) -> [f64; D]) -> (f64, f64, f64)
where
    Fem: Model<D>,
{
    let mut system = system(mesh, &[(&Fem as &dyn Model<D>, values)]);
    for node in 0..mesh.positions.len() {
        let (x, u) = (mesh.positions[node], field(mesh.positions[node]));
        system.state.x.set(node, core::array::from_fn(|d| x[d] + u[d]));
    }
    let all = forces(&mut system);
    let between = |k: &usize| {
        let x = mesh.positions[k / D][0];
        x > 1e-9 && x < LENGTH - 1e-9
    };
    let inner = largest((0..all.len()).filter(between).map(|k| all[k]));
    // The moment on the right end about its centre.
    let right = (0..mesh.positions.len()).filter(|n| mesh.positions[*n][0] > LENGTH - 1e-9);
    let moment = right.map(|n| -all[n * D] * (mesh.positions[n][D - 1] - 0.5 * HEIGHT)).sum();
    (inner, largest(all.iter().copied()), moment)
}

/// A moment M = E I κ bends a straight bar to the curvature κ; across, it curves by −νκ. No node between the ends has a force.
#[test]
fn a_moment_bends_a_bar_exactly_for_every_poissons_ratio() {
    let curvature = 1e-3;
    for ratio in RATIOS {
        for across in [1, 2, 4] {
            let along = 4 * across;
            for (plane, modulus, contraction) in
                [("strain", 1.0 / (1.0 - ratio * ratio), ratio / (1.0 - ratio)), ("stress", 1.0, ratio)]
            {
                let mesh = Mesh::<2>::grid([0.0; 2], [LENGTH, HEIGHT], [along, across]).unwrap();
                let values = values!(fem, material: "linear", youngs_modulus: 1.0, poissons_ratio: ratio, plane: plane);
                let (inner, most, moment) = bent(&mesh, values, |[x, y]| {
                    let y = y - 0.5 * HEIGHT;
                    [curvature * x * y, -0.5 * curvature * (x * x + contraction * y * y)]
                });
                // At λ = 1666 E, displacements of 1e-10 m matter, and positions keep six digits of these.
                assert!(inner < 1e-6 * most, "{plane}, ν = {ratio}, {across} across: {inner:e} of {most:e}");
                let expected = curvature * modulus * HEIGHT * HEIGHT * HEIGHT / 12.0;
                assert!((moment / expected - 1.0).abs() < 1e-6, "{plane}, ν = {ratio}: {moment} {expected}");
            }
            let mesh = Mesh::<3>::grid([0.0; 3], [LENGTH, 0.15, HEIGHT], [along, across, across]).unwrap();
            let values = values!(fem, material: "linear", youngs_modulus: 1.0, poissons_ratio: ratio);
            let (inner, most, moment) = bent(&mesh, values, |[x, y, z]| {
                let (y, z) = (y - 0.075, z - 0.5 * HEIGHT);
                let down = x * x + ratio * (z * z - y * y);
                [curvature * x * z, -ratio * curvature * y * z, -0.5 * curvature * down]
            });
            assert!(inner < 1e-6 * most, "ν = {ratio}, {across} across: {inner:e} of {most:e}");
            let expected = curvature * 0.15 * HEIGHT * HEIGHT * HEIGHT / 12.0;
            assert!((moment / expected - 1.0).abs() < 1e-6, "ν = {ratio}: {moment} {expected}");
        }
    }
}

/// The deflection of the end of a beam under a force of 1e-7 at the end, over P L³/3EI + 6PL/5GA; the root slides freely in its
/// plane.
fn sunk<const D: usize>(cells: [u32; D], ratio: f64, plane: &str) -> f64
where
    Fem: Model<D>,
{
    let mut size = [HEIGHT; D];
    size[0] = LENGTH;
    let mesh = Mesh::<D>::grid([0.0; D], size, cells).unwrap();
    let values = values!(fem, material: "linear", youngs_modulus: 1.0, poissons_ratio: ratio, plane: plane);
    let mut system = system(&mesh, &[(&Fem as &dyn Model<D>, values)]);
    let (up, force) = (D - 1, 1e-7);
    let end = |x: &[f64; D], at: f64| (x[0] - at).abs() < 1e-9;
    let right: Vec<u32> =
        (0..mesh.positions.len() as u32).filter(|n| end(&mesh.positions[*n as usize], LENGTH)).collect();
    let shares = mesh.boundary_shares(&right);
    let whole: f64 = shares.values().sum();
    let mut load = vec![0.0; D * mesh.positions.len()];
    for (node, share) in &shares {
        load[D * *node as usize + up] = force * share / whole;
    }
    // At the root, no node moves along the beam, the nodes of the lower edge do not move up, and one node does not move sideways.
    let held: Vec<bool> = (0..load.len())
        .map(|k| {
            let (x, d) = (&mesh.positions[k / D], k % D);
            end(x, 0.0) && (d == 0 || (d == up && x[up] == 0.0) || x[1..].iter().all(|c| *c == 0.0))
        })
        .collect();
    sparse::equilibrium(&mut system, &load, &held);
    let tip: f64 = right.iter().map(|n| system.state.x.at(*n as usize)[up] - mesh.positions[*n as usize][up]).sum();
    let modulus = if D == 2 && plane == "strain" { 1.0 / (1.0 - ratio * ratio) } else { 1.0 };
    let area = if D == 2 { HEIGHT } else { HEIGHT * HEIGHT };
    let bending = force * LENGTH * LENGTH * LENGTH / (3.0 * modulus * area * HEIGHT * HEIGHT / 12.0);
    let shear = 1.2 * force * LENGTH / (area * 0.5 / (1.0 + ratio));
    tip / right.len() as f64 / (bending + shear)
}

/// A force at the end: within 2 % with one cell across that is twice as long as thick, and closer with more cells.
#[test]
fn beams_with_few_cells_across_sink_as_they_should() {
    for ratio in RATIOS {
        let mut rows = Vec::new();
        for plane in ["strain", "stress"] {
            rows.push((plane, [sunk([5, 1], ratio, plane), sunk([10, 2], ratio, plane), sunk([20, 4], ratio, plane)]));
        }
        rows.push(("space", [sunk([5, 1, 1], ratio, "strain"), sunk([10, 2, 2], ratio, "strain"), f64::NAN]));
        for (name, found) in rows {
            println!("ν = {ratio}, {name}: {found:?}");
            for sunk in found.into_iter().filter(|s| !s.is_nan()) {
                assert!((sunk - 1.0).abs() < 0.02, "ν = {ratio}, {name}: {found:?}");
            }
            assert!((found[1] - 1.0).abs() < 0.9 * (found[0] - 1.0).abs(), "ν = {ratio}, {name}: {found:?}");
        }
    }
}

/// At rest only rigid motion has zero energy, in one cell and in a block of cells.
#[test]
fn no_motion_but_rigid_ones_is_free() {
    let values = |ratio: f64| values!(fem, material: "neo_hookean", youngs_modulus: 1.0, poissons_ratio: ratio);
    let rigid = |free: usize, system: &mut opruga_core::system::System<3>| {
        let scale = largest(hessian(system).entries.iter().copied());
        assert_eq!(eigenvalues_below(system, 1e-9 * scale), free);
    };
    for ratio in [0.0, 0.4999] {
        for cells in [[1, 1, 1], [4, 4, 4]] {
            let mesh = Mesh::<3>::grid([0.0; 3], [1.0, 0.7, 0.4], cells).unwrap();
            rigid(6, &mut system(&mesh, &[(&Fem as &dyn Model<3>, values(ratio))]));
        }
        for cells in [[1, 1], [4, 4]] {
            let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.4], cells).unwrap();
            let mut system = system(&mesh, &[(&Fem as &dyn Model<2>, values(ratio))]);
            let scale = largest(hessian(&mut system).entries.iter().copied());
            assert_eq!(eigenvalues_below(&mut system, 1e-9 * scale), 3);
        }
    }
}

/// Damping brakes bending too. With every material, a bending cell dissipates as much as a stretched one does with the same
/// energy.
#[test]
fn bending_is_damped_as_stretching_is() {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.5], [1, 1]).unwrap();
    for material in NAMES {
        let time = 0.01;
        let values = values!(fem, material: *material, youngs_modulus: 50.0, poissons_ratio: 0.3, damping: time);
        let mut system = system(&mesh, &[(&Fem as &dyn Model<2>, values)]);
        // u = κ x y about the centre: the energy ½ k and the power τ k of the same amplitude.
        let field = |x: [f64; 2]| [1e-4 * (x[0] - 0.5) * (x[1] - 0.25), 0.0];
        for node in 0..4 {
            system.state.v.set(node, field(mesh.positions[node]));
        }
        let drag = system.forces(true).unwrap();
        let power: f64 = (0..4).map(|n| -drag.at(n)[0] * system.state.v.at(n)[0]).sum();
        for node in 0..4 {
            let (x, u) = (mesh.positions[node], field(mesh.positions[node]));
            system.state.x.set(node, [x[0] + u[0], x[1] + u[1]]);
            system.state.v.set(node, [0.0; 2]);
        }
        let energy = support::energy(&mut system);
        assert!((power / (2.0 * time * energy) - 1.0).abs() < 1e-3, "{material}: {power} {energy}");
    }
}
