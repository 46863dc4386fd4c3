//! Bodies that begin without volume, or tangled, and never come to rest: they leave that shape, or it is said that they stay.

mod common;

use common::{solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::{Options, World};

/// A free cube of 1 m of 2 × 2 × 2 cells that begins in a shape.
fn cube(material: &str, simplices: bool, shape: &dyn Fn([f64; 3], usize) -> [f64; 3]) -> World<3> {
    let boxes = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a grid");
    let mesh = if simplices { boxes.into_simplices().expect("tetrahedra") } else { boxes };
    let positions = mesh.positions.clone();
    let blueprint = solid(
        mesh,
        "backward_euler",
        &[("when_not_converged", text("halve"))],
        &[
            ("material", text(material)),
            ("youngs_modulus", Value::Number(1e4)),
            ("poissons_ratio", Value::Number(0.4)),
            ("damping", Value::Number(0.02)),
        ],
    );
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    for (node, at) in positions.iter().enumerate() {
        world.place_node(0, node as u32, shape(*at, node), [0.0; 3]).expect("placed");
    }
    world
}

fn volume_ratio(world: &World<3>) -> f64 {
    let cells = world.cell_states(0);
    cells.iter().map(|c| c.volume_ratio * c.measure).sum::<f64>() / cells.iter().map(|c| c.measure).sum::<f64>()
}

/// What lies on a line swings along it for a long time, which is no way out of it. What folds on its way says so.
#[test]
fn bodies_on_a_line_leave_it_though_they_swing_along_it() {
    for (simplices, seconds) in [(true, 12), (false, 90)] {
        let mut world = cube("stable_neo_hookean", simplices, &|x, _| [x[0], 0.5, 0.5]);
        let mut reason = None;
        let back = (0..60 * seconds).position(|_| {
            world.frame().expect("a frame");
            let told = world.warnings().into_iter().find(|warning| warning.code == "step.odd_rest");
            reason = told.map(|warning| warning.message);
            reason.is_some() || (volume_ratio(&world) - 1.0).abs() < 1e-3
        });
        println!("simplices: {simplices}: {:?} frames, V/V₀ = {}, {reason:?}", back, volume_ratio(&world));
        assert!(back.is_some() && (reason.is_none() || !simplices), "simplices: {simplices}: {}", volume_ratio(&world));
        assert!(world.solver_work().disturbed > 0, "simplices: {simplices}");
    }
}
