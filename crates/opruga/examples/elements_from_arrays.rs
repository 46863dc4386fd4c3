//! A body of finite elements from arrays of nodes and cells: a bar of six tetrahedra is pinned at one end and pulled at the other.

use opruga::blueprint::{Blueprint, BodyBlueprint, LoadBlueprint, LoadKind, Mass, PinBlueprint, Selector};
use opruga::mesh::{Cells, Mesh};
use opruga::{Options, Registry, World};

/// The corners of a box of 1 m × 0.2 m × 0.2 m [m].
const NODES: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.2, 0.0],
    [0.0, 0.2, 0.0],
    [0.0, 0.0, 0.2],
    [1.0, 0.0, 0.2],
    [1.0, 0.2, 0.2],
    [0.0, 0.2, 0.2],
];

/// Six tetrahedra around the diagonal from node 0 to node 6; (X₁ − X₀) · ((X₂ − X₀) × (X₃ − X₀)) > 0.
const TETRAHEDRA: [[u32; 4]; 6] = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

/// Pulls along the bar with 1 kPa; returns its elongation [m], and σ L / E [m].
pub(crate) fn run() -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let cells = Cells { tetrahedra: TETRAHEDRA.to_vec(), ..Cells::default() };
    let mut mesh = Mesh::<3> { positions: NODES.to_vec(), cells, ..Mesh::default() };
    mesh.facets = mesh.facets_from_cells()?; // the boundary, for contact, gas and pictures
    mesh.validate()?;

    let registry = Registry::<3>::default();
    let rubber = [("youngs_modulus", 1e5.into()), ("poissons_ratio", 0.0.into()), ("material", "linear".into())];
    let rubber = registry.model_values("fem", &rubber)?;
    let mut bar = BodyBlueprint::new("bar", mesh, Mass::Density(1000.0), vec![rubber]);
    let held = Selector::Nodes(vec![0, 3, 4, 7]);
    bar.pins.push(PinBlueprint { select: held, axes: [true; 3], motion: Vec::new() });

    let pull = LoadKind::Traction([1000.0, 0.0, 0.0]);
    let pull = LoadBlueprint { body: 0, select: Selector::Nodes(vec![1, 2, 5, 6]), kind: pull, curve: Vec::new() };

    let mut scene = Blueprint::new("bar", registry.integrator_values("equilibrium", &[])?);
    scene.bodies.push(bar);
    scene.loads.push(pull);
    let mut world = World::new(scene, Options::default())?;
    world.frame()?;
    Ok([world.position(0, 6)[0] - 1.0, 1000.0 * 1.0 / 1e5])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [found, expected] = run()?;
    println!("the bar gets {:.3} mm longer; σ L / E = {:.3} mm", 1e3 * found, 1e3 * expected);
    Ok(())
}
