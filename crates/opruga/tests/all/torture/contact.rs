//! Rows 67 to 72: obstacles and pointers.

use super::*;
use opruga::core::spec::Value;

/// Row 71: a million steps at rest in a corner without drift or jitter.
#[test]
fn rest_in_a_corner_is_rest() {
    let corner = format!(
        "velocity = [2, 0]\n{FLOOR}[[collider]]\nkind = \"half_space\"\npoint = [1, 0]\nnormal = [-1, 0]\nfriction = 0.5\n"
    );
    let mut world = built(plane(&ring(40, BALL, &corner)));
    world.set("world.drag", Value::Number(2.0)).expect("a parameter");
    frames(&mut world, 1200);
    let before: Vec<[f64; 2]> = (0..24).map(|n| world.position(0, n)).collect();
    frames(&mut world, 25_000);
    let moved = largest((0..24).flat_map(|n| {
        let x = world.position(0, n);
        [x[0] - before[n as usize][0], x[1] - before[n as usize][1]]
    }));
    let speed = largest((0..24).flat_map(|n| world.velocity(0, n)));
    println!("moves by {moved:.1e} m, at most {speed:.1e} m/s");
    assert!(moved < 1e-6 && speed < 1e-6, "{moved:e} m, {speed:e} m/s");
}

/// An action of a person on a world.
type Change<'a> = &'a dyn Fn(&mut World<2>);

/// Row 71: a body at rest moves when gravity or its gas changes, or when it is placed elsewhere.
#[test]
fn what_rests_wakes_when_something_changes() {
    let models = BALL.replace("damping = 1.0", "damping = 5.0");
    let changes: [(&str, Change); 3] = [
        ("gravity", &|world| world.set("world.gravity", Value::Numbers(vec![0.0, 1.0])).expect("a parameter")),
        ("gas", &|world| world.set("body.b.models.pressure.nRT", Value::Number(60.0)).expect("a parameter")),
        ("place", &|world| {
            for node in 0..24 {
                let [x, y] = world.position(0, node);
                world.set_node(0, node, [x, y + 0.5], [0.0; 2]).expect("a node");
            }
        }),
    ];
    for (name, change) in changes {
        let mut world = built(plane(&ring(64, &models, &FLOOR.replace("restitution = 0.2", "restitution = 0"))));
        world.set("world.drag", Value::Number(5.0)).expect("a parameter");
        frames(&mut world, 900);
        let speed = |world: &World<2>| largest((0..24).flat_map(|n| world.velocity(0, n)));
        assert!(speed(&world) < 1e-4, "{name}: {} m/s at rest", speed(&world));
        change(&mut world);
        frames(&mut world, 3);
        assert!(speed(&world) > 1e-2, "{name}: {} m/s afterwards", speed(&world));
    }
}

/// A ball between a floor and a plate that descends by `way` [m] and stays there; the ball is 1 m high and begins at 0.1 m.
fn press(way: f64, more: &str) -> World<2> {
    let plates = format!(
        "{FLOOR}[[collider]]\nkind = \"half_space\"\npoint = [0, 1.1]\nnormal = [0, -1]\n\
         motion = [[0, 0, 0], [1.5, 0, {0:?}], [2, 0, {0:?}]]\n{more}",
        -way
    );
    built(plane(&ring(256, BALL, &plates)))
}

/// Row 67: compressed to a hundredth of its height, a ball stays between the plates and is not inverted.
#[test]
fn a_ball_is_pressed_to_a_hundredth_of_its_height() {
    let mut world = press(1.09, "");
    for _ in 0..120 {
        world.frame().expect("a frame");
        let gap = if world.time() < 1.5 { 1.1 - 1.09 * world.time() / 1.5 } else { 0.01 };
        for node in 0..24 {
            let y = world.position(0, node)[1];
            assert!((-1e-9..gap + 1e-9).contains(&y), "t = {}: node {node} at {y}, plates {gap} m apart", world.time());
        }
    }
    assert!(finite(&world) && world.readings(0)[0].1 > 0.0, "{:?}", world.readings(0));
    assert!(world.warnings().iter().all(|w| w.code != "contact.no_room"), "{:?}", world.warnings());
}

/// Row 67: if plates meet, there is no space for anything between them. This is reported with the time, the body and both plates, and numbers stay
/// finite.
#[test]
fn plates_that_meet_are_told_with_time_and_pair() {
    let mut world = press(1.2, "");
    frames(&mut world, 120);
    assert!(finite(&world));
    let warnings = world.warnings();
    let warning = warnings.iter().find(|w| w.code == "contact.no_room").expect("a warning");
    // They pass one another at 1.5 s · 1.1/1.2 = 1.375 s, and overlap by 0.1 m in the last half second.
    assert!((30..=38).contains(&warning.count), "{warning:?}");
    let said = &warning.message;
    let time: f64 = said["at t = ".len()..].split(' ').next().and_then(|t| t.parse().ok()).expect("a time");
    assert!((1.375..1.41).contains(&time), "{said}");
    assert!(said.contains("obstacles 0 (half_space) and 1 (half_space) left no room for body `b`: node "), "{said}");
    // Plates that just touch leave no space, either, nor do those that stop slightly before.
    for way in [1.1, 1.0999] {
        let mut world = press(way, "");
        frames(&mut world, 120);
        let warning = world.warnings().into_iter().find(|w| w.code == "contact.no_room").expect("a warning");
        assert!((30..=32).contains(&warning.count), "{warning:?}");
        assert!(warning.message.contains("was where the obstacles meet"), "{}", warning.message);
    }
    // Pinned nodes are where the pins put them, which is not a fault of the plates.
    let mut held = press(
        1.2,
        "[[body]]\nname = \"c\"\nfixed = true\nshape = { kind = \"ring\", radius = 0.5, vertices = 24, center = [9, 0.6] }\n",
    );
    held.remove_body("b").expect("it is there");
    frames(&mut held, 120);
    assert!(held.warnings().iter().all(|w| w.code != "contact.no_room"), "{:?}", held.warnings());
}

/// Row 68: a million nodes collide with a floor in one step; none is missed.
#[test]
fn a_million_contacts_in_one_step_are_all_held() {
    let text = format!(
        "{}[[body]]\nname = \"s\"\nnode_mass = 1e-6\nvelocity = [0, -1, 0]\nposition = [0, 1e-3, 0]\n\
         shape = {{ kind = \"sheet\", u = [10, 0, 0], v = [0, 0, 10], cells = [999, 999] }}\n\
         [[collider]]\nkind = \"half_space\"\nnormal = [0, 1, 0]\n",
        head(1.0 / 60.0, 2, 0.0, "symplectic_euler")
            .replace("dimension = 2", "dimension = 3")
            .replace("gravity = [0, 0.0]", "gravity = [0, 0, 0]")
    );
    let mut world = built(space(&text));
    world.frame().expect("a frame");
    assert_eq!(world.node_count(0), 1_000_000);
    for node in 0..1_000_000 {
        assert_eq!((world.position(0, node)[1], world.velocity(0, node)[1]), (0.0, 0.0), "node {node}");
    }
}

/// Row 72: a pointer at 10 km/s, one at rest far away, and one at the node itself.
#[test]
fn pointers_pull_within_bounds() {
    for (path, most) in [
        ("[[0, 0, 0], [0.5, 5000, 0], [1, -5000, 0]]", "largest_force = 40.0"),
        ("[[0, 1e9, 1e9], [1, 1e9, 1e9]]", "largest_force = 40.0"),
        // Without an explicit limit, the force of a pull is limited to that of a spring stretched by ten sizes of the body, and numbers stay finite.
        ("[[0, 0, 0], [1, 10000, 0]]", "# limited"),
        ("[[0, 1e300, -1e300], [1e-3, -1e300, 1e300]]\nuntil = 1", "# limited"),
        ("[[0, 0.5, 0.6], [1, 0.5, 0.6]]", ""),
    ] {
        let command = format!("{FLOOR}[[command]]\ndo = \"drag\"\nat = 0\nbody = \"b\"\npath = {path}\n{most}\n");
        let mut world = built(plane(&ring(64, BALL, &command)));
        for _ in 0..90 {
            world.frame().unwrap_or_else(|e| panic!("{path}: {e}"));
        }
        assert!(finite(&world));
        let counted = world.warnings().iter().any(|w| w.code == "limit.drag" && w.count > 0);
        assert_eq!(counted, !most.is_empty(), "{path}: {:?}", world.warnings());
    }
    let text =
        format!("{}[[command]]\ndo = \"drag\"\nat = 0\nbody = \"b\"\npath = [[0, nan, 0]]\n", ring(64, BALL, FLOOR));
    assert!(said(&text).contains("error[scene.not_finite]"), "{}", said(&text));
}

/// Row 72: several pulls at once, on one node and on neighbours in a batch; removing a body ends its pull.
#[test]
fn several_pulls_act_at_once() {
    let pull = |body: usize, x: f64| {
        format!(
            "[[command]]\ndo = \"drag\"\nat = 0\nuntil = 1\nbody = \"b[{body}]\"\nnode = 0\npath = [[0, {x:?}, 0.6], [1, {x:?}, 0.6]]\nstiffness = 20.0\n"
        )
    };
    let scene = |pulls: &str| {
        let copies = format!("copies = {{ count = [4], spacing = [2, 0] }}\n{pulls}");
        // Without gas the rest shape is an equilibrium.
        plane(&ring(32, "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }", &copies).replace("-9.81", "0"))
    };
    // Node 0 of ball k is at 2k + 0.5; two equal pulls to both sides leave it there.
    let mut world = built(scene(&(pull(0, 0.0) + &pull(0, 1.0) + &pull(2, 5.0))));
    frames(&mut world, 2);
    assert_eq!((world.islands(), world.pulls().len()), (1, 3));
    frames(&mut world, 10);
    let momentum = |world: &World<2>, body: usize| (0..24).map(|n| world.velocity(body, n)[0]).sum::<f64>() / 24.0;
    assert!(momentum(&world, 0).abs() < 1e-12, "{}", momentum(&world, 0));
    assert!(momentum(&world, 2) > 0.5, "{}", momentum(&world, 2));
    for untouched in [1, 3] {
        assert!(momentum(&world, untouched).abs() < 1e-12);
    }
    world.remove_body("b[0]").expect("a body");
    assert_eq!(world.pulls().len(), 1);
    assert!(world.warnings().iter().any(|w| w.code == "command.no_body" && w.count == 2), "{:?}", world.warnings());
    frames(&mut world, 30);
    assert!(finite(&world));
}
