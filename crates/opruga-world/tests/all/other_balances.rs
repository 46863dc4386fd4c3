//! Bodies that end in another equilibrium than that of their own shape are reported, whatever acts on them. Bodies that loads, pins and gas deform
//! are not.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

use crate::common;

use common::{clamp, solid, text};
use core::f64::consts::PI;
use opruga_core::spec::{Value, Values};
use opruga_math::Lane;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Blueprint, PinBlueprint, Selector};
use opruga_world::{Options, Registry, World};

const MATERIALS: [&str; 6] =
    ["stable_neo_hookean", "fixed_corotated", "neo_hookean", "corotated", "mooney_rivlin", "st_venant_kirchhoff"];

/// A body of 10 kPa with little damping.
fn body<const D: usize>(mesh: Mesh<D>, material: &str) -> Blueprint<D> {
    let fields = [
        ("material", text(material)),
        ("youngs_modulus", Value::Number(1e4)),
        ("poissons_ratio", Value::Number(0.4)),
        ("damping", Value::Number(0.05)),
    ];
    solid(mesh, "backward_euler", &[("when_not_converged", text("halve"))], &fields)
}

/// Moves the nodes of the only body to positions that depend on their rest positions.
fn place<const D: usize>(world: &mut World<D>, positions: &[[f64; D]], shape: &dyn Fn([f64; D]) -> [f64; D]) {
    for (node, at) in positions.iter().enumerate() {
        world.set_node(0, node as u32, shape(*at), [0.0; D]).expect("placed");
    }
}

/// The warning about a body in a given shape.
fn told<const D: usize>(mesh: &Mesh<D>, material: &str, shape: &dyn Fn([f64; D]) -> [f64; D]) -> Option<String> {
    let mut world = World::new(body(mesh.clone(), material), Options::default()).expect("a world");
    place(&mut world, &mesh.positions, shape);
    world.other_balances().map(|warning| warning.message)
}

/// Boxes, and tetrahedra of first and second order.
fn bars(size: [f64; 3], cells: [u32; 3]) -> Vec<(&'static str, Mesh<3>)> {
    let boxes = Mesh::<3>::grid([0.0; 3], size, cells).expect("a grid");
    let simplices = boxes.clone().into_simplices().expect("tetrahedra");
    let quadratic = simplices.clone().into_quadratic().expect("quadratic tetrahedra");
    vec![("boxes", boxes), ("linear", simplices), ("quadratic", quadratic)]
}

type Shape = Box<dyn Fn([f64; 3]) -> [f64; 3]>;

/// External forces hold such shapes, so their energies are accounted for.
#[test]
fn what_is_stretched_squeezed_bent_or_twisted_from_outside_is_accounted_for() {
    accounted_for(&MATERIALS[..1]);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn what_is_stretched_squeezed_bent_or_twisted_from_outside_is_accounted_for_whole_sweep() {
    accounted_for(&MATERIALS[1..]);
}

fn accounted_for(materials: &[&str]) {
    let affine = |a: f64, b: f64, c: f64| -> Shape { Box::new(move |x| [a * x[0], b * x[1], c * x[2]]) };
    let bent = |angle: f64| -> Shape {
        Box::new(move |x| {
            let (r, t) = (8.0 / angle - (x[1] - 0.5), angle * x[0] / 8.0);
            [r * t.sin(), -r * t.cos(), x[2]]
        })
    };
    let twisted = |angle: f64| -> Shape {
        Box::new(move |x| {
            let (t, y, z) = (angle * x[0] / 8.0, x[1] - 0.5, x[2] - 0.5);
            [x[0], t.cos() * y - t.sin() * z, t.sin() * y + t.cos() * z]
        })
    };
    let shapes: Vec<(&str, Shape)> = vec![
        ("as it is", affine(1.0, 1.0, 1.0)),
        ("moved and turned", Box::new(|x| [5.0 - x[1], 3.0 + x[0], x[2]])),
        ("drawn tenfold", affine(10.0, 0.1_f64.sqrt(), 0.1_f64.sqrt())),
        ("drawn tenfold, not thinned", affine(10.0, 1.0, 1.0)),
        ("pressed to 0.3", affine(0.3, 1.8, 1.8)),
        ("pressed to 0.3, not thickened", affine(0.3, 1.0, 1.0)),
        ("pressed from all sides", affine(0.6, 0.6, 0.6)),
        ("blown up", affine(2.0, 2.0, 2.0)),
        ("sheared", Box::new(|x| [x[0] + 1.5 * x[1], x[1], x[2]])),
        ("sheared a little", Box::new(|x| [x[0] + 0.01 * x[1], x[1], x[2]])),
        ("bent", bent(0.5)),
        ("bent by half a turn", bent(PI)),
        ("rolled up", bent(2.0 * PI)),
        ("twisted", twisted(1.0)),
        ("twisted by half a turn", twisted(PI)),
        ("drawn unevenly", Box::new(|x| [x[0] + x[0] * x[0] / 8.0, x[1], x[2]])),
    ];
    for (cells, mesh) in bars([8.0, 1.0, 1.0], [16, 2, 2]) {
        for material in materials {
            for (name, shape) in &shapes {
                assert_eq!(told(&mesh, material, shape), None, "{cells}, {material}, {name}");
            }
        }
    }
}

/// The ends of the bar are where they would be without twist, but after one full turn by pins it rests in another equilibrium. The law of small
/// strain has none.
#[test]
fn what_is_twisted_once_round_or_drawn_to_a_point_is_told_of() {
    let twisted = |x: [f64; 3]| {
        let (t, y, z) = (2.0 * PI * x[0] / 4.0, x[1] - 0.5, x[2] - 0.5);
        [x[0], 0.5 + t.cos() * y - t.sin() * z, 0.5 + t.sin() * y + t.cos() * z]
    };
    let mesh = Mesh::<3>::grid([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).expect("a grid");
    for (law, told) in [("stable_neo_hookean", true), ("linear", false)] {
        let mut blueprint = body(mesh.clone(), law);
        let right = PinBlueprint { select: Selector::Side("right".into()), axes: [true; 3], motion: Vec::new() };
        blueprint.bodies[0].pins = clamp().into_iter().chain([right]).collect();
        let mut world = World::new(blueprint, Options::default()).expect("a world");
        place(&mut world, &mesh.positions, &twisted);
        settle(&mut world, 300);
        assert_eq!(
            codes(&world).contains(&"cells.other_balance".into()),
            told,
            "{law}: {:?}",
            world.warnings_at_the_end()
        );
    }
    let [(_, boxes), ..] = &bars([1.0; 3], [2; 3])[..] else { panic!("boxes") };
    // In a body that is collapsed to a point, this law has no force.
    let said = told(boxes, "stable_neo_hookean", &|_| [0.5; 3]).expect("a body in a point");
    assert!(
        said.contains(
            "of which the forces account for 0 J. Its volume is 0 times that at rest, and det F is 0 in cell 0;"
        ),
        "{said}"
    );
}

/// A body with internal motion is still moving and is not reported; rigid flight and rotation do not matter.
#[test]
fn bodies_that_move_within_themselves_are_not_told_of() {
    let [(_, boxes), ..] = &bars([1.0; 3], [2; 3])[..] else { panic!("boxes") };
    let mut world = World::new(body(boxes.clone(), "stable_neo_hookean"), Options::default()).expect("a world");
    for (strain, told) in [(0.0, true), (5.0, false)] {
        for (node, at) in boxes.positions.iter().enumerate() {
            let x = at.map(|x| 1e-3 * x);
            let v = [30.0 - 7e3 * x[1] + strain * node as f64, 10.0 + 7e3 * x[0], 0.0];
            world.set_node(0, node as u32, x, v).expect("placed");
        }
        assert_eq!(world.other_balances().is_some(), told, "strain {strain}");
    }
}

/// Eight alike bodies side by side are judged individually.
#[test]
fn copies_are_counted_and_the_first_is_named() {
    let mesh = plate([2, 2], [1.0, 1.0]);
    let mut blueprint = body(mesh.clone(), "stable_neo_hookean");
    let own = blueprint.bodies[0].clone();
    blueprint.bodies = (0..8)
        .map(|k| opruga_world::blueprint::BodyBlueprint {
            name: format!("body[{k}]"),
            translation: [3.0 * f64::from(k), 0.0],
            ..own.clone()
        })
        .collect();
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    assert_eq!(world.other_balances(), None);
    for body in [5, 2] {
        for (node, _) in mesh.positions.iter().enumerate() {
            world.set_node(body, node as u32, [9.0, 1.0], [0.0; 2]).expect("placed");
        }
    }
    let told = world.other_balances().expect("two bodies in a point");
    assert_eq!(told.count, 2);
    assert!(
        told.message.starts_with("at t = 0 s, 2 bodies have come to rest with more energy in their cells"),
        "{}",
        told.message
    );
    assert!(told.message.contains("The first, body `body[2]`, contains"), "{}", told.message);
}

/// Steps a body so that it comes to rest.
fn settle<const D: usize>(world: &mut World<D>, frames: usize) {
    (0..frames).for_each(|_| world.frame().expect("a frame"));
}

fn plate(cells: [u32; 2], size: [f64; 2]) -> Mesh<2> {
    Mesh::<2>::grid([0.0; 2], size, cells).expect("a grid").into_simplices().expect("triangles")
}

fn codes<const D: usize>(world: &World<D>) -> Vec<String> {
    world.warnings_at_the_end().into_iter().map(|warning| warning.code).collect()
}

/// A clamped square whose free nodes start in one point comes to rest folded, without inverted cells, so no other warning reports it.
#[test]
fn a_held_body_that_rests_folded_is_told_of() {
    let mesh = plate([3, 3], [1.0, 1.0]);
    let mut blueprint = body(mesh.clone(), "fixed_corotated");
    blueprint.bodies[0].pins = clamp();
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    place(&mut world, &mesh.positions, &|x| if x[0] == 0.0 { x } else { [0.5, 0.5] });
    settle(&mut world, 600);
    assert!(world.cell_states(0).iter().all(|cell| cell.smallest_volume_ratio > 0.5));
    assert_eq!(codes(&world), ["cells.other_balance"]);
    let told = world.other_balances().expect("a folded body").message;
    for words in ["twisted. It contains 969.9 J", "volume is 0.9146 times that at rest, and det F is 0.6772 in cell 17"]
    {
        assert!(told.contains(words), "{told}");
    }
}

/// A box has the volume of its mean deformation, but may be inverted at its integration points.
#[test]
fn boxes_inside_out_at_a_point_are_odd() {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [1, 1]).expect("a square");
    let mut world = World::new(body(mesh.clone(), "corotated"), Options::default()).expect("a world");
    place(&mut world, &mesh.positions, &|x| if x == [1.0, 1.0] { [0.3, 0.3] } else { x });
    let [cell] = world.cell_states(0)[..] else { panic!("one cell") };
    // The bilinear map has J = 1 − 0.7 (ξ + η) at ξ, η from 0 to 1.
    let corner = 0.5 + 0.5 / 3.0_f64.sqrt();
    assert!(cell.volume_ratio > 0.1, "{cell:?}");
    assert!((cell.smallest_volume_ratio - (1.0 - 1.4 * corner)).abs() < 1e-12, "{cell:?}");
    let told = world.inverted_cells().expect("a cell inside out").message;
    // The warning contains the minimum over the whole cell, at the corner.
    assert!(told.contains("1 cell is inverted; the first is cell 0 of body `body`, with J = -0.4"), "{told}");
    // Skewed boxes are undeformed at rest.
    let mut mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a grid");
    mesh.positions
        .iter_mut()
        .for_each(|x| *x = [x[0] + 0.3 * x[1] * x[2], x[1] - 0.2 * x[0] * x[2], x[2] + 0.1 * x[0] * x[1]]);
    let world = World::new(body(mesh, "corotated"), Options::default()).expect("a world");
    assert!(world.cell_states(0).iter().all(|cell| (cell.smallest_volume_ratio - 1.0).abs() < 1e-12));
}

/// An arch between two walls that has snapped through is in a valid equilibrium, but not in that of its own shape.
#[test]
fn an_arch_that_snapped_through_is_told_of_and_not_shaken() {
    let mut mesh = plate([40, 2], [2.0, 0.05]).into_quadratic().expect("quadratic triangles");
    let rise = |x: f64| 0.15 * (1.0 - (PI * x).cos());
    mesh.positions.iter_mut().for_each(|x| x[1] += rise(x[0]));
    let mut blueprint = body(mesh.clone(), "stable_neo_hookean");
    let right = PinBlueprint { select: Selector::Side("right".into()), axes: [true; 2], motion: Vec::new() };
    blueprint.bodies[0].pins = clamp().into_iter().chain([right]).collect();
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    settle(&mut world, 30);
    assert_eq!(codes(&world), [""; 0], "in its own shape");
    place(&mut world, &mesh.positions, &|x| [x[0], x[1] - 2.0 * rise(x[0])]);
    settle(&mut world, 3000);
    let lowest = (0..mesh.positions.len()).map(|n| world.position(0, n as u32)[1]).fold(0.0, Lane::smaller);
    assert!(lowest < -0.15, "it stayed snapped through: {lowest} m");
    assert_eq!(codes(&world), ["cells.other_balance"]);
}

/// A body that hangs, stands or bends under its weight ends in the equilibrium of its own shape; it is not reported during its motion either.
#[test]
fn bodies_under_their_weight_are_not_told_of() {
    for (name, down, stiffness, size) in [
        ("a hanging bar", [9.81, 0.0], 3e4, [2.0, 0.2]),
        ("a bar that stands", [-9.81, 0.0], 3e4, [0.6, 0.4]),
        ("a cantilever", [0.0, -9.81], 1e5, [1.0, 0.1]),
        ("a limp cantilever", [0.0, -9.81], 1e4, [1.0, 0.1]),
    ] {
        let mesh = Mesh::<2>::grid([0.0; 2], size, [20, 4]).expect("a grid");
        let mut blueprint = body(mesh, "stable_neo_hookean");
        blueprint.surroundings.gravity = down;
        blueprint.bodies[0].pins = clamp();
        let mut world = World::new(blueprint, Options::default()).expect("a world");
        world.set("body.body.models.fem.youngs_modulus", Value::Number(stiffness)).expect("a parameter");
        for _ in 0..10 {
            settle(&mut world, 60);
            assert_eq!(world.other_balances(), None, "{name} at {} s", world.time());
        }
    }
}

/// A thick tube that gas inflates to several times its area has an energy that the gas accounts for.
#[test]
fn a_thick_balloon_full_of_gas_is_not_told_of() {
    let mesh = tube(24).into_simplices().expect("triangles").into_quadratic().expect("quadratic triangles");
    let mut blueprint = body(mesh, "stable_neo_hookean");
    let mut gas = Values::defaults(Registry::<2>::default().model("pressure").expect("a gas").spec(), 2);
    let spec = Registry::<2>::default().model("pressure").expect("a gas").spec();
    for (name, value) in [("nRT", Value::Number(6e3)), ("inside", text("cavities"))] {
        gas.set(spec, name, value, 2).expect("a field of the test's own");
    }
    blueprint.bodies[0].models.push(gas);
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    for _ in 0..5 {
        settle(&mut world, 60);
        // Damping removes more energy than the integrator, so there is no warning.
        assert_eq!(codes(&world), [""; 0], "at {} s", world.time());
    }
    let widest = (0..world.node_count(0)).map(|n| world.position(0, n as u32)[0]).fold(0.0, Lane::larger);
    // The cavity is then about twice as wide as at rest.
    assert!(widest > 1.25, "it was blown up to {widest} m");
}

/// A tube with radii of 0.5 and 1 m, with `around` quadrilaterals in the circumference.
fn tube(around: u32) -> Mesh<2> {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [around, 2]).expect("a grid");
    let row = around + 1;
    // Around and inwards: the last column of nodes coincides with the first.
    let kept = |node: u32| node % row % around + node / row * around;
    let positions = (0..3 * around).map(|k| {
        let (angle, radius) =
            (2.0 * PI * f64::from(k % around) / f64::from(around), 1.0 - 0.25 * f64::from(k / around));
        [radius * angle.cos(), radius * angle.sin()]
    });
    mesh.positions = positions.collect();
    mesh.groups.clear();
    mesh.facets.retain(|[a, b]| a / row == b / row);
    mesh.facets.iter_mut().for_each(|facet| *facet = facet.map(kept));
    mesh.cells.quadrilaterals.iter_mut().for_each(|cell| *cell = cell.map(kept));
    mesh
}
