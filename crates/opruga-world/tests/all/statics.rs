//! Statics: which bodies are held and by what; loads in halves; solvers; the ledger.

use crate::common;
use opruga_math::message::Message;

use common::{clamp, solid, text};
use opruga_core::spec::{Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, World, WorldError};

const MATERIAL: [(&str, Value); 2] = [("youngs_modulus", Value::Number(1e6)), ("poissons_ratio", Value::Number(0.3))];

fn statics<const D: usize>(mesh: Mesh<D>, fields: &[(&str, Value)]) -> Blueprint<D> {
    solid(mesh, "equilibrium", fields, &MATERIAL)
}

fn square() -> Blueprint<2> {
    statics(Mesh::<2>::grid([0.0; 2], [1.0; 2], [2; 2]).unwrap(), &[])
}

fn cube() -> Blueprint<3> {
    statics(Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).unwrap(), &[])
}

/// The unconstrained motions that a world reports; none if it accepts the scene.
fn refusal<const D: usize>(blueprint: &Blueprint<D>) -> Option<String> {
    match World::new(blueprint.clone(), Options::default()) {
        Ok(_) => None,
        Err(WorldError::Build { source, .. }) => {
            assert_eq!(source.code(), "static.rigid_modes", "{source}");
            let told = source.about.to_string();
            let told = told.split(';').next().unwrap_or_default();
            Some(told.trim_start_matches("nothing prevents ").to_string())
        }
        Err(other) => panic!("{other}"),
    }
}

fn nodes<const D: usize>(list: &[u32]) -> Selector<D> {
    Selector::Nodes(list.to_vec())
}

fn pin<const D: usize>(blueprint: &mut Blueprint<D>, node: u32, axes: [bool; D]) {
    blueprint.bodies[0].pins.push(PinBlueprint { select: nodes(&[node]), axes, motion: Vec::new() });
}

fn load<const D: usize>(blueprint: &mut Blueprint<D>, select: Selector<D>, kind: LoadKind<D>) {
    blueprint.loads.push(LoadBlueprint { body: 0, select, kind, curve: Vec::new() });
}

const ONE: Option<&str> = Some("rotation: 1 rigid mode");

#[test]
fn a_pressure_holds_nothing_whatever_its_strength() {
    for pressure in [0.0, 1.0, -1.0, 1e5] {
        let mut free = cube();
        load(&mut free, Selector::Boundary, LoadKind::Pressure(pressure));
        let told = refusal(&free).expect("a refusal");
        assert!(told.ends_with(": 6 rigid modes"), "{pressure}: {told}");
        let mut hung = square();
        pin(&mut hung, 0, [true, true]);
        load(&mut hung, Selector::Boundary, LoadKind::Pressure(pressure));
        assert_eq!(refusal(&hung).as_deref(), ONE, "{pressure}");
        // On one side only, the pressure drives the square in circles.
        hung.loads[0].select = Selector::Side("top".into());
        assert_eq!(refusal(&hung).as_deref(), ONE, "{pressure}");
        let mut hung = cube();
        pin(&mut hung, 0, [true; 3]);
        load(&mut hung, Selector::Side("top".into()), LoadKind::Pressure(pressure));
        assert!(refusal(&hung).is_some_and(|told| told.ends_with(": 3 rigid modes")), "{pressure}");
        // Pins at three corners hold the cube.
        pin(&mut hung, 2, [false, true, true]);
        pin(&mut hung, 6, [false, false, true]);
        assert_eq!(refusal(&hung), None, "{pressure}");
    }
}

#[test]
fn a_dead_load_holds_what_turns_unless_it_acts_where_that_is_held_or_along_its_axis() {
    let force = |select: Selector<2>, force: [f64; 2]| {
        let mut hung = square();
        pin(&mut hung, 0, [true, true]);
        load(&mut hung, select, LoadKind::Force(force));
        hung
    };
    assert_eq!(refusal(&force(nodes(&[8]), [1.0, 0.0])), None);
    assert_eq!(refusal(&force(nodes(&[8]), [0.0, 0.0])).as_deref(), ONE);
    assert_eq!(refusal(&force(nodes(&[0]), [1.0, 0.0])).as_deref(), ONE);
    // A couple of dead loads rotates the square until they pull against each other.
    let mut couple = force(nodes(&[2]), [1.0, 0.0]);
    load(&mut couple, nodes(&[6]), LoadKind::Force([-1.0, 0.0]));
    assert_eq!(refusal(&couple), None);
    // Two loads that cancel have no effect.
    couple.loads[1].select = nodes(&[2]);
    assert_eq!(refusal(&couple).as_deref(), ONE);
    // A load that begins at zero.
    let mut later = force(nodes(&[8]), [1.0, 0.0]);
    later.loads[0].curve = vec![vec![0.0, 0.0], vec![1.0, 1.0]];
    assert_eq!(refusal(&later), None);
    // A traction is a dead load too.
    let mut drawn = square();
    pin(&mut drawn, 0, [true, true]);
    load(&mut drawn, Selector::Side("right".into()), LoadKind::Traction([1.0, 0.0]));
    assert_eq!(refusal(&drawn), None);

    // In space a weight does not prevent rotation about its own axis, whatever the initial orientation of the body.
    for (gravity, told) in [
        ([0.0, -9.81, 0.0], "rotation about an axis along y: 1 rigid mode"),
        ([-9.81, 0.0, 0.0], "rotation about an axis along x: 1 rigid mode"),
        ([3.0, -4.0, 0.0], "rotation about an axis along (-0.600, 0.800, 0.000): 1 rigid mode"),
    ] {
        for node in [0, 8, 26] {
            let mut hung = cube();
            hung.surroundings.gravity = gravity;
            pin(&mut hung, node, [true; 3]);
            let found = refusal(&hung).expect("a refusal");
            let turned = told.replace("-0.600, 0.800", "0.600, -0.800");
            assert!(found == told || found == turned, "{found}");
        }
    }
    // A body pinned at its centre has no restoring force; pinned at an edge it swings.
    let mut middle = cube();
    middle.surroundings.gravity = [0.0, -9.81, 0.0];
    pin(&mut middle, 13, [true; 3]);
    assert!(refusal(&middle).is_some_and(|told| told.ends_with("3 rigid modes")));
    let mut hinge = cube();
    hinge.surroundings.gravity = [0.0, -9.81, 0.0];
    pin(&mut hinge, 0, [true; 3]);
    pin(&mut hinge, 2, [true; 3]);
    assert_eq!(refusal(&hinge), None);
    // A body in free fall rotates freely.
    let mut falling = cube();
    falling.surroundings.gravity = [0.0, -9.81, 0.0];
    assert!(refusal(&falling).is_some_and(|told| told.ends_with("6 rigid modes")), "{:?}", refusal(&falling));
}

/// Half of the work of a weight that is lowered slowly is not stored, and no damping is recorded for a body without damping.
#[test]
fn the_ledger_of_statics_counts_no_damping_of_a_body_that_has_none() {
    let mut beam = statics(Mesh::<3>::grid([0.0; 3], [1.0, 0.2, 0.2], [8, 2, 2]).unwrap(), &[]);
    beam.surroundings.gravity = [0.0, -9.81, 0.0];
    beam.bodies[0].pins = clamp();
    let mut beam = World::new(beam, Options::default()).unwrap();
    let before = beam.energy();
    beam.frame().unwrap();
    let after = beam.energy();
    assert!(after.elastic > 0.01, "{after:?}");
    assert_eq!((after.loss_damping, after.loss_contact, after.loss_friction), (0.0, 0.0, 0.0));
    let change = after.elastic + after.gravity - before.elastic - before.gravity;
    assert!((after.work_user / change - 1.0).abs() < 1e-9 && change < 0.0, "{after:?}");
    assert!(after.closure < 1e-9, "{after:?}");
}

#[test]
fn every_solver_is_taken_at_its_word_and_finds_the_same_balance() {
    let tip = |solver: &str| {
        let mesh = Mesh::<3>::grid([0.0; 3], [1.0, 0.4, 0.4], [5, 2, 2]).unwrap();
        let mut beam = statics(mesh, &[("linear_solver", text(solver))]);
        beam.surroundings.gravity = [0.0, -9.81, 0.0];
        beam.bodies[0].pins = clamp();
        let mut beam = World::new(beam, Options::default()).unwrap();
        beam.frame().unwrap();
        (beam.position(0, beam.node_count(0) as u32 - 1), beam.solver_work())
    };
    let (wanted, of_factor) = tip("cholesky");
    let (assembled, of_assembled) = tip("conjugate_gradients");
    let (free, of_free) = tip("matrix_free");
    for d in 0..3 {
        assert!((assembled[d] - wanted[d]).abs() < 1e-8 && (free[d] - wanted[d]).abs() < 1e-8, "{d}: {free:?}");
    }
    // The factor needs one product per iteration; without a matrix there is no incomplete factor to help.
    assert_eq!(of_factor.linear_iterations, of_factor.iterations);
    assert!(of_free.linear_iterations > of_assembled.linear_iterations, "{of_free:?} {of_assembled:?}");
    let mut arc = statics(
        Mesh::<2>::grid([0.0; 2], [1.0; 2], [2; 2]).unwrap(),
        &[("linear_solver", text("matrix_free")), ("arc_length", Value::Number(0.1))],
    );
    arc.bodies[0].pins = clamp();
    let error = World::new(arc, Options::default()).expect_err("a refusal");
    assert_eq!(error.code(), "integrator.no_matrix");
}

/// A beam under many times its weight: the load is too large for few iterations at once, and is either applied in halves, or the error reports how
/// far it went.
#[test]
fn what_is_too_much_at_once_is_put_on_by_halves_or_said_to_have_gone_so_far() {
    let bent = |iterations: i64, policy: &str, weight: f64| {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.1], [16, 2]).unwrap();
        let mut beam = statics(
            mesh,
            &[
                ("iterations", Value::Integer(iterations)),
                ("when_not_converged", text(policy)),
                ("tolerance", Value::Number(1e-6)),
            ],
        );
        beam.surroundings.gravity = [0.0, -weight];
        beam.bodies[0].pins = clamp();
        let mut beam = World::new(beam, Options::default()).unwrap();
        let outcome = beam.frame();
        let tip = beam.position(0, beam.node_count(0) as u32 - 1);
        (outcome.map_err(|error| error.in_full()), tip, beam.solver_work(), beam.warnings())
    };
    let (outcome, wanted, ..) = bent(200, "error", 10.0);
    outcome.unwrap();
    let (outcome, ..) = bent(6, "error", 10.0);
    let told = outcome.expect_err("a refusal");
    assert!(
        told.contains("did not converge in 6 iterations") && told.contains("when_not_converged = \"halve\""),
        "{told}"
    );
    let (outcome, found, work, warnings) = bent(6, "halve", 10.0);
    outcome.unwrap();
    let halved = warnings.iter().find(|warning| warning.code == "step.halved").expect("a warning");
    assert_eq!(halved.count, work.halved);
    let parts = 1 << work.deepest;
    assert!(
        (1..=8).contains(&work.deepest) && halved.message.contains("a step of 0.0166667 s (in statics, "),
        "{work:?} {halved:?}"
    );
    assert!(halved.message.contains(&format!(", 1/{parts} of it, because Newton's method")), "{halved:?}");
    for d in 0..2 {
        assert!((found[d] - wanted[d]).abs() < 1e-6, "{found:?} {wanted:?}");
    }
    let (outcome, _, work, _) = bent(1, "halve", 10.0);
    let told = outcome.expect_err("a refusal");
    assert_eq!(work.halved, 0, "a frame that fails leaves no trace");
    assert!(told.contains("already halved") && !told.contains("or `when_not_converged"), "{told}");
    let (outcome, _, work, _) = bent(2, "accept", 10.0);
    outcome.unwrap();
    assert_eq!(work.accepted, 1);
}

/// Three squares in a row without the middle one: one body of two pieces.
fn two_squares() -> Blueprint<2> {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [3.0, 1.0], [3, 1]).unwrap();
    mesh.cells.quadrilaterals.remove(1);
    statics(mesh, &[])
}

/// A piece that nothing holds has no equilibrium under its weight and many without weight, whatever holds the other pieces. The two squares share no
/// node, so the first one, which is clamped, does not support the second, which has the three rigid motions of the plane.
#[test]
fn every_piece_of_a_body_has_to_be_held_with_weight_and_without() {
    for weight in [0.0, 1.0] {
        let mut islands = two_squares();
        islands.surroundings.gravity = [0.0, -weight];
        islands.bodies[0].pins = clamp();
        let told = refusal(&islands).expect("a refusal");
        assert_eq!(
            told,
            "the body is in 2 pieces. For the piece of 4 nodes around (2.5, 0.5) m, nothing prevents translation along x, \
             translation along y, rotation: 3 rigid modes",
            "{weight}"
        );
        // A body without any support is reported as a whole.
        islands.bodies[0].pins.clear();
        assert!(refusal(&islands).is_some_and(|told| told.starts_with("translation along x")), "{weight}");
        // Node 2 is a corner of the second square: pinned there it rotates, and under its weight it hangs or stands.
        islands.bodies[0].pins = clamp();
        pin(&mut islands, 2, [true; 2]);
        let told = refusal(&islands);
        match weight {
            0.0 => assert!(told.is_some_and(|told| told.ends_with("prevents rotation: 1 rigid mode"))),
            _ => assert_eq!(told, None),
        }
        pin(&mut islands, 3, [false, true]);
        assert_eq!(refusal(&islands), None, "{weight}");
        let mut world = World::new(islands, Options::default()).unwrap();
        world.frame().unwrap();
    }
    // A body in one piece is not reported in pieces.
    let mut one = statics(Mesh::<2>::grid([0.0; 2], [3.0, 1.0], [3, 1]).unwrap(), &[]);
    one.bodies[0].pins = clamp();
    assert_eq!(refusal(&one), None);
}

/// The ground at height 0, without friction.
fn floor() -> ColliderBlueprint {
    let spec = opruga_collide::all(2).into_iter().find(|s| s.kind == "half_space").expect("a floor");
    let mut values = Values::defaults(spec, 2);
    for (name, value) in [("point", vec![0.0, 0.0]), ("normal", vec![0.0, 1.0])] {
        values.set(spec, name, Value::Numbers(value), 2).expect("a field");
    }
    ColliderBlueprint { values }
}

/// A piece on a floor without friction slides, although the other one is clamped.
#[test]
fn a_piece_that_a_smooth_floor_alone_holds_is_named_with_the_way_it_slides() {
    let mut islands = two_squares();
    islands.surroundings.gravity = [0.0, -1.0];
    islands.bodies[0].pins = clamp();
    islands.colliders = vec![floor()];
    let mut world = World::new(islands.clone(), Options::default()).unwrap();
    let told = world.frame().expect_err("a refusal").to_string();
    let wanted = "the body is in 2 pieces. The piece of 4 nodes around (2.5, 0.";
    assert!(told.contains(wanted) && told.contains("nor a pin prevents translation along x; "), "{told}");
    pin(&mut islands, 2, [true, false]);
    World::new(islands, Options::default()).unwrap().frame().unwrap();
}

/// A bar between a floor and a ceiling. It is a tenth of a metre thick and is compressed to half of that; it has no equilibrium if the ceiling is
/// below the floor.
#[test]
fn a_body_that_does_not_fit_between_obstacles_has_no_balance() {
    let squeezed = |gap: f64| {
        let mut bar = statics(Mesh::<2>::grid([0.0; 2], [1.0, 0.1], [8, 2]).unwrap(), &[]);
        bar.bodies[0].pins = clamp();
        let plane = |point: f64, normal: f64| {
            let fields = [("point", [0.0, point].into()), ("normal", [0.0, normal].into())];
            ColliderBlueprint::new::<2>("half_space", &fields).expect("a plane")
        };
        bar.colliders = vec![plane(0.0, 1.0), plane(gap, -1.0)];
        let mut bar = World::new(bar, Options::default()).unwrap();
        let outcome = bar.frame().map_err(|error| error.to_string());
        let heights: Vec<f64> = (0..bar.node_count(0) as u32).map(|node| bar.position(0, node)[1]).collect();
        (outcome, heights)
    };
    let (outcome, heights) = squeezed(0.05);
    outcome.unwrap();
    // Clamped nodes pass through obstacles.
    assert!(
        (0..27).filter(|node| node % 9 != 0).all(|node| (-1e-6..0.05 + 1e-6).contains(&heights[node])),
        "{heights:?}"
    );
    for gap in [-1e-3, -0.05] {
        let told = squeezed(gap).0.expect_err("nodes above the floor are in the ceiling");
        assert!(told.contains("did not converge"), "{gap}: {told}");
    }
}

/// A blade of 1 m, of equal cells, whose tip its weight would bend by `tip`: q L⁴ (1 − ν²)/(8 E I).
fn blade(law: &str, thickness: f64, cells: u32, tip: f64) -> Blueprint<2> {
    let modulus = 1e6;
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0, thickness], [cells, 1]).unwrap();
    let material =
        [("material", text(law)), ("youngs_modulus", Value::Number(modulus)), ("poissons_ratio", Value::Number(0.3))];
    let mut blade = solid(mesh, "equilibrium", &[], &material);
    blade.bodies[0].pins = clamp();
    blade.surroundings.gravity = [0.0, -tip * 8.0 * modulus * thickness * thickness / 12.0 / 0.91 / 1000.0];
    blade
}

/// A blade of 1 m by a quarter of a millimetre, of four cells a thousand times as long as thick, which its weight would bend by four times its
/// thickness, q L⁴ (1 − ν²)/(8 E I) = 1 mm. Its load of 1e-8 N is a thousandth of the rounding error of its forces. Earlier it was silently left out
/// of balance, with a tenth of the displacement; now it is balanced, and the uncertainty is reported.
#[test]
fn blades_of_slivers_carry_loads_below_rounding_and_say_what_is_in_doubt() {
    let tip = 1e-3;
    for law in ["fixed_corotated", "stable_neo_hookean", "neo_hookean"] {
        let mut world = World::new(blade(law, 0.25e-3, 4, tip), Options::default()).unwrap();
        world.frame().unwrap();
        let found = -world.position(0, 4)[1];
        assert!((found / tip - 1.0).abs() < 0.2, "{law}: {found} m");
        let told = world.warnings().into_iter().find(|warning| warning.code == "statics.blurred").expect("a warning");
        assert!(told.message.contains("could still move nodes by up to "), "{told:?}");
    }
}

/// Blades of a tenth of a millimetre in sixteen cells: their loads are a twenty-thousandth of the rounding error of their forces, which reduces the
/// bending of some of them by 6 to 19 per cent. The size of the cells causes an error of a thousandth.
#[test]
fn what_rounding_makes_of_thin_blades_is_no_more_than_they_say() {
    let tip = 1e-3;
    let run = |law: &str, thickness: f64| {
        let mut world = World::new(blade(law, thickness, 16, tip), Options::default()).unwrap();
        world.frame().unwrap();
        (-world.position(0, 16)[1], world.solver_work().error_estimate)
    };
    for law in ["fixed_corotated", "corotated", "stable_neo_hookean", "neo_hookean"] {
        let (found, estimate) = run(law, 1e-4);
        assert!((found - tip).abs() <= estimate + 1e-3 * tip, "{law}: {found} m, in doubt by {estimate} m");
        let (found, estimate) = run(law, 1e-2);
        assert!((found - tip).abs() <= 1e-3 * tip && estimate == 0.0, "{law}: {found} m, in doubt by {estimate} m");
    }
}

/// A steel wire, 10 m by 10 mm, stretched by its weight at a thousand times the gravity of the earth. The matrix at its start has no lateral
/// stiffness except that of bending, and would turn rounding errors into a displacement a thousand times as large.
#[test]
fn wires_under_tension_are_in_no_doubt() {
    let mesh = Mesh::<3>::grid([0.0; 3], [10.0, 0.01, 0.01], [50, 1, 1]).unwrap();
    let material = [
        ("material", text("corotated")),
        ("youngs_modulus", Value::Number(2e11)),
        ("poissons_ratio", Value::Number(0.0)),
    ];
    let (density, gravity, modulus) = (1000.0, 1e4, 2e11);
    let mut wire = solid(mesh, "equilibrium", &[], &material);
    wire.bodies[0].pins = clamp();
    wire.surroundings.gravity = [gravity, 0.0, 0.0];
    let mut world = World::new(wire, Options::default()).unwrap();
    world.frame().unwrap();
    // ρ g L²/(2 E) at the end.
    let (found, wanted) = (world.position(0, 50)[0] - 10.0, density * gravity * 100.0 / (2.0 * modulus));
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found} m, {wanted} m");
    assert!(!world.warnings().iter().any(|warning| warning.code == "statics.blurred"), "{:?}", world.warnings());
}

/// For a nearly incompressible solid conjugate gradients need as many products as there are unknowns. They then use a complete factor of their own,
/// which gives the same bits on every processor, and the same equilibrium as the sparse factor.
#[test]
fn nearly_incompressible_solids_are_solved_with_a_complete_factor() {
    let sagged = |solver: &str| {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.5], [32, 16]).unwrap().into_simplices().unwrap();
        let mut plate = statics(mesh.into_quadratic().unwrap(), &[("linear_solver", text(solver))]);
        plate.bodies[0].models[0] = {
            let spec = opruga_world::Registry::<2>::default().model("fem").expect("a model").spec();
            let mut values = opruga_core::spec::Values::defaults(spec, 2);
            for (name, value) in [
                ("material", text("neo_hookean")),
                ("youngs_modulus", Value::Number(1e5)),
                ("poissons_ratio", Value::Number(0.4999)),
            ] {
                values.set(spec, name, value, 2).expect("a field");
            }
            values
        };
        plate.surroundings.gravity = [0.0, -9.81];
        plate.bodies[0].pins = clamp();
        let mut plate = World::new(plate, Options::default()).unwrap();
        plate.frame().unwrap();
        let places: Vec<[f64; 2]> = (0..plate.node_count(0)).map(|k| plate.position(0, k as u32)).collect();
        (places, plate.solver_work(), plate.same_bits_everywhere())
    };
    let (wanted, _, everywhere) = sagged("cholesky");
    assert!(!everywhere);
    let (found, work, everywhere) = sagged("conjugate_gradients");
    assert!(everywhere);
    println!("{work:?}");
    // A thousand without success, and one or two for each iteration.
    assert!(work.linear_iterations < 1000 + 3 * work.iterations, "{work:?}");
    for (a, b) in found.iter().zip(&wanted) {
        assert!((a[0] - b[0]).abs() < 1e-7 && (a[1] - b[1]).abs() < 1e-7, "{a:?} {b:?}");
    }
}
