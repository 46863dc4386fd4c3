//! Bodies that start without volume, or tangled, and never come to rest: either they leave that shape, or a warning reports that they do not.

use crate::common;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::{Options, World};

/// A free cube of 1 m with 2 × 2 × 2 cells that starts in a given shape.
fn cube(material: &str, simplices: bool, unfold: bool, shape: &dyn Fn([f64; 3], usize) -> [f64; 3]) -> World<3> {
    let boxes = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a grid");
    let mesh = if simplices { boxes.into_simplices().expect("tetrahedra") } else { boxes };
    let positions = mesh.positions.clone();
    let mut blueprint = solid(
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
    blueprint.surroundings.unfold = unfold;
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    for (node, at) in positions.iter().enumerate() {
        world.set_node(0, node as u32, shape(*at, node), [0.0; 3]).expect("placed");
    }
    world
}

/// The counterpart of the test below: a body is not displaced unless the scene asks for it, and a warning names the body, the cells and the option.
#[test]
fn bodies_on_a_line_stay_there_and_are_warned_of_where_the_scene_does_not_unfold() {
    for simplices in [true, false] {
        let mut world = cube("stable_neo_hookean", simplices, false, &|x, _| [x[0], 0.5, 0.5]);
        (0..120).for_each(|_| world.frame().expect("a frame"));
        assert!(volume_ratio(&world).abs() < 1e-9, "simplices: {simplices}: {}", volume_ratio(&world));
        assert_eq!((world.solver_work().disturbed, world.solver_work().stayed_degenerate), (0, 0));
        let told = world.inverted_cells().expect("a warning");
        assert_eq!(told.count as usize, world.cell_states(0).len());
        assert!(
            told.message.contains("of body `body`") && told.message.contains("`unfold = true`"),
            "{}",
            told.message
        );
    }
}

fn volume_ratio(world: &World<3>) -> f64 {
    let cells = world.cell_states(0);
    cells.iter().map(|c| c.volume_ratio * c.measure).sum::<f64>() / cells.iter().map(|c| c.measure).sum::<f64>()
}

/// A body on a line oscillates along it for a long time without leaving it. A body that folds while leaving is reported.
#[test]
fn bodies_on_a_line_leave_it_though_they_swing_along_it() {
    for (simplices, seconds) in [(true, 12), (false, 90)] {
        let mut world = cube("stable_neo_hookean", simplices, true, &|x, _| [x[0], 0.5, 0.5]);
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

/// The initial displacements of the free nodes of a clamped cube of 2 × 2 × 2 boxes [m].
const SCATTERED: [[f64; 3]; 18] = [
    [0.103920, 0.625720, 0.065529],
    [-0.986832, 0.837469, 0.259354],
    [0.336461, -0.023647, 0.639068],
    [-0.849384, 0.134861, 0.868045],
    [-0.435969, -0.241770, 0.591100],
    [-0.698732, -0.968988, 0.865527],
    [0.214129, 0.921099, -0.105037],
    [-0.199091, 0.444621, 0.435587],
    [-0.283013, 0.465480, -0.063838],
    [-0.373352, -0.198974, 0.007243],
    [0.084252, -0.095798, 0.181982],
    [-0.071054, -0.143599, 0.490990],
    [0.464633, 0.904696, -0.430892],
    [-0.286183, 0.211125, -0.168392],
    [0.353942, 0.489806, -0.911482],
    [-0.199405, -0.089538, -0.849235],
    [-0.455810, -0.385467, -0.955060],
    [-0.281560, -0.669046, -0.119095],
];

/// A clamped cube with randomly displaced nodes: one of its boxes comes to rest inverted at its integration points, although its mean keeps a
/// thousandth of its volume, sometimes slightly more and sometimes slightly less. It is displaced exactly three times, and a warning reports that
/// this was in vain.
#[test]
fn disturbances_end_though_a_box_goes_to_and_fro_about_flatness() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a grid");
    let positions = mesh.positions.clone();
    let mut blueprint = solid(
        mesh,
        "backward_euler",
        &[],
        &[
            ("material", text("corotated")),
            ("youngs_modulus", Value::Number(1e4)),
            ("poissons_ratio", Value::Number(0.4)),
        ],
    );
    blueprint.bodies[0].pins = clamp();
    blueprint.surroundings.unfold = true;
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    let free = positions.iter().enumerate().filter(|(_, at)| at[0] > 0.0);
    for ((node, at), by) in free.zip(SCATTERED) {
        world.set_node(0, node as u32, core::array::from_fn(|d| at[d] + by[d]), [0.0; 3]).expect("placed");
    }
    for _ in 0..60 * 300 {
        world.frame().expect("a frame");
    }
    let (work, cells) = (world.solver_work(), world.cell_states(0));
    println!("{} {} {cells:?}", work.disturbed, work.stayed_degenerate);
    assert_eq!((work.disturbed, work.stayed_degenerate), (3, 1));
    assert!(cells.iter().any(|cell| cell.smallest_volume_ratio < 0.0 && cell.volume_ratio > 0.0));
    let codes: Vec<String> = world.warnings_at_the_end().into_iter().map(|warning| warning.code).collect();
    let expected =
        ["ledger.numerical_damping", "step.disturbed", "step.odd_rest", "cells.inverted", "cells.other_balance"];
    assert_eq!(codes, expected);
}
