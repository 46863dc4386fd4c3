//! Bodies with many chambers of gas, each of which adds a term of rank one to the matrix.

use crate::common;
use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::Blueprint;
use opruga_world::{Options, Registry, World};
use std::time::Instant;

/// A square of `across` by `across` chambers, with walls of the same width, each of `fine` by `fine` cells; clamped at the left.
fn porous(across: u32, fine: u32, rule: &str, solver: &str) -> Blueprint<2> {
    let side = (2 * across + 1) * fine;
    let grid = Mesh::<2>::grid([0.0; 2], [1.0; 2], [side; 2]).expect("a grid");
    // The number of a wall or of a chamber along an axis.
    let number = |x: f64| (x * f64::from(side) / f64::from(fine)) as u32;
    let is_wall = |cell: &[u32; 4]| {
        let middle = |d: usize| cell.iter().map(|node| grid.positions[*node as usize][d]).sum::<f64>() / 4.0;
        (0..2).any(|d| number(middle(d)).is_multiple_of(2))
    };
    let mut mesh = Mesh::<2>::default();
    let mut numbers = vec![None; grid.positions.len()];
    for cell in grid.cells.quadrilaterals.iter().filter(|cell| is_wall(cell)) {
        mesh.cells.quadrilaterals.push(cell.map(|node| {
            *numbers[node as usize].get_or_insert_with(|| {
                mesh.positions.push(grid.positions[node as usize]);
                mesh.positions.len() as u32 - 1
            })
        }));
    }
    mesh.facets = mesh.facets_from_cells().expect("a boundary");
    let material = [("youngs_modulus", Value::Number(1e6)), ("poissons_ratio", Value::Number(0.3))];
    let mut body = solid(mesh, rule, &[("linear_solver", text(solver))], &material);
    let gas = [("pressure", 1.1e5.into()), ("ambient", 1e5.into()), ("inside", text("cavities"))];
    body.bodies[0].models.push(Registry::<2>::default().model_values("pressure", &gas).expect("gas"));
    body.surroundings.gravity = [0.0, -9.81];
    body.bodies[0].pins = clamp();
    body
}

/// The position of the last node of such a body after the frames, and the time that they took [ms each].
fn run(across: u32, fine: u32, rule: &str, solver: &str, frames: u32) -> ([f64; 2], usize, f64) {
    let options = Options { threads: 1, ..Options::default() };
    let mut world = World::new(porous(across, fine, rule, solver), options).expect("a world");
    let start = Instant::now();
    (0..frames).for_each(|_| world.frame().expect("a frame"));
    let spent = start.elapsed().as_secs_f64() * 1e3 / f64::from(frames);
    let nodes = world.node_count(0);
    (world.position(0, nodes as u32 - 1), nodes, spent)
}

/// Nine by nine chambers have more terms than the limit for a sparse factor.
#[test]
fn every_solver_finds_the_same_balance_of_a_body_of_many_chambers() {
    let solvers = ["auto", "cholesky", "conjugate_gradients", "matrix_free"];
    let [first, others @ ..] = solvers.map(|solver| run(9, 1, "equilibrium", solver, 1).0);
    for (other, solver) in others.iter().zip(&solvers[1..]) {
        assert!((0..2).all(|d| (first[d] - other[d]).abs() < 1e-8), "{solver}: {other:?}, not {first:?}");
    }
}

#[test]
#[ignore = "a measurement"]
fn time_of_bodies_of_many_chambers() {
    for (across, fine) in [(2, 4), (4, 4), (8, 4), (4, 2), (8, 2), (8, 1), (10, 1), (14, 1), (20, 1)] {
        for (rule, frames) in [("backward_euler", 3), ("equilibrium", 1)] {
            let [(_, nodes, factor), (_, _, gradients)] =
                ["cholesky", "conjugate_gradients"].map(|solver| run(across, fine, rule, solver, frames));
            println!(
                "{} chambers, {nodes} nodes, {rule}: {factor:.1} ms by the factor, {gradients:.1} ms by gradients",
                across * across
            );
        }
    }
}
