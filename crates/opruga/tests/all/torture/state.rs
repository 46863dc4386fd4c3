//! Rows 61 to 64: bodies that are collapsed, far away, fast, or contain NaN.

use super::*;
use opruga::WorldError;

/// Rows 43 and 62: nodes at one position, on a line, in a point, mirrored, at random: finite in every frame, and recovering their shape.
#[test]
fn collapsed_bodies_recover() {
    let mut number = 1u64;
    let mut random = move || {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    type Spoil<'a> = &'a mut dyn FnMut(u32, [f64; 2]) -> [f64; 2];
    let cases: [(&str, Spoil, bool); 6] = [
        ("two nodes in one place", &mut |n, x| if n == 1 { [0.5, 0.6] } else { x }, true),
        ("on a level line", &mut |_, x| [x[0], 0.6], true),
        ("on an upright line", &mut |_, x| [0.0, x[1]], true),
        ("squeezed to a hundredth", &mut |_, x| [0.01 * x[0], 0.6 + 0.01 * (x[1] - 0.6)], true),
        ("random", &mut |_, _| [random(), 0.6 + random()], false),
        ("in one point", &mut |_, _| [0.0, 0.6], false),
    ];
    for (name, spoil, recovers) in cases {
        let models = "{ kind = \"mass_spring\", stiffness = 600.0, damping = 2.0 }, { kind = \"pressure\", nRT = 30.0, largest_pressure = 500.0 }";
        let text = ring(256, models, "").replace("gravity = [0, -9.81]", "gravity = [0, 0]\ndrag = 3.0");
        let mut world = built(plane(&text));
        frames(&mut world, 300);
        let volume = world.readings(0)[0].1;
        let mut world = built(plane(&text));
        for node in 0..24 {
            let x = world.position(0, node);
            world.set_node(0, node, spoil(node, x), [0.0; 2]).expect("a node");
        }
        for frame in 0..600 {
            world.frame().unwrap_or_else(|e| panic!("{name}, frame {frame}: {e}"));
            assert!(finite(&world), "{name}");
        }
        let now = world.readings(0)[0].1;
        println!("{name}: {:.4} of its area", now / volume);
        // A body that does not recover reports why: it was inverted, or enclosed nothing.
        let told = world.warnings().iter().any(|w| w.code == "pressure.inverted" && w.count > 0);
        assert!((now / volume - 1.0).abs() < 1e-3 || !recovers && told, "{name}: {now} of {volume} m²");
    }
}

/// Row 62 in space: a balloon collapsed to a sheet, a needle or a point, mirrored, at random.
#[test]
fn collapsed_balloons_recover_or_say_why_not() {
    let text = format!(
        "{}[[body]]\nname = \"b\"\nmass = 1\nshape = {{ kind = \"icosphere\", radius = 0.5, subdivisions = 2 }}\nmodels = \
         [{{ kind = \"mass_spring\", stiffness = 300.0, damping = 1.0 }}, {{ kind = \"pressure\", nRT = 100.0, \
         largest_pressure = 2000.0 }}]\n",
        head(1.0 / 60.0, 128, 0.0, "symplectic_euler").replace("dimension = 2", "dimension = 3")
    )
    .replace("gravity = [0, 0.0]", "gravity = [0, 0, 0]\ndrag = 3.0");
    let built = || World::<3>::new(space(&text), Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let mut world = built();
    for _ in 0..300 {
        world.frame().expect("a frame");
    }
    let volume = world.readings(0)[0].1;
    let mut number = 1u64;
    let mut random = move || {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (number >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    type Spoil<'a> = &'a mut dyn FnMut([f64; 3]) -> [f64; 3];
    let cases: [(&str, Spoil, bool); 5] = [
        ("a sheet", &mut |x| [x[0], x[1], 0.0], true),
        ("a needle", &mut |x| [x[0], 0.0, 0.0], false),
        ("a point", &mut |_| [0.0; 3], false),
        ("mirrored", &mut |x| [-x[0], x[1], x[2]], false),
        ("random", &mut |_| [random(), random(), random()], false),
    ];
    for (name, spoil, recovers) in cases {
        let mut world = built();
        for node in 0..world.node_count(0) as u32 {
            let x = world.position(0, node);
            world.set_node(0, node, spoil(x), [0.0; 3]).expect("a node");
        }
        for frame in 0..400 {
            world.frame().unwrap_or_else(|e| panic!("{name}, frame {frame}: {e}"));
        }
        let now = world.readings(0)[0].1;
        let told = world.warnings().iter().any(|w| w.code == "pressure.inverted" && w.count > 0);
        println!("{name}: {:.4} of its volume", now / volume);
        assert!((now / volume - 1.0).abs() < 1e-3 || !recovers && told, "{name}: {now} of {volume} m³");
    }
}

/// Row 63: far away and falling for ever; row 64: no node passes through a floor, however fast.
#[test]
fn far_and_fast() {
    let mut world = built(plane(&ring(64, BALL, "").replace("center = [0, 0.6]", "center = [1e6, -1e6]")));
    frames(&mut world, 30);
    assert!(finite(&world));
    // Edges of 0.13 m are a million rounding units long up to 5.9e8 m: a body farther away has diverged, whatever the cause.
    let mut world = built(plane(&ring(64, BALL, "velocity = [3e9, 0]")));
    frames(&mut world, 10);
    let hash = world.state_hash();
    match (0..5).find_map(|_| world.frame().err()).expect("it gets too far") {
        WorldError::Diverged { body, range: Some(range), time, .. } => {
            assert!(
                body == "b" && (range / 5.9e8 - 1.0).abs() < 0.01 && (time - range / 3e9).abs() < 1e-3,
                "{range} {time}"
            );
        }
        other => panic!("{other}"),
    }
    assert!(world.state_hash() != hash && world.position(0, 0)[0] < 5.9e8, "the last good frame");
    let mut world = built(plane(&ring(32, BALL, "")));
    frames(&mut world, 6000);
    assert!(finite(&world) && (world.momentum().linear.0[1] + 981.0).abs() < 1e-6, "100 s of free fall");
    for speed in [1e2, 1e3, 1e4] {
        let velocity = format!("velocity = [0, {:?}]\n{FLOOR}", -speed);
        let mut blueprint = plane(&ring(64, "{ kind = \"mass_spring\", stiffness = 600.0 }", &velocity));
        blueprint.surroundings.gravity = [0.0; 2];
        let mut world = built(blueprint);
        for _ in 0..30 {
            if let Err(error) = world.frame() {
                panic!("{speed} m/s: {error}");
            }
            for node in 0..24 {
                assert!(world.position(0, node)[1] >= -1e-9, "{speed} m/s: node {node} is below the floor");
            }
        }
    }
}

/// Row 61: NaN, from outside or from a user's law, is refused with body and node, and the world stays as it was.
#[test]
fn numbers_that_are_none_are_refused_and_leave_the_world_whole() {
    let two = ring(64, BALL, FLOOR).replace(FLOOR, "position = [3, 0]\n") + FLOOR;
    let two =
        format!("{two}[[body]]\nname = \"c\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 24 }}\n");
    let mut world = built(plane(&two));
    frames(&mut world, 5);
    let (hash, energy) = (world.state_hash(), world.energy());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (x, v) in [([bad, 0.0], [0.0; 2]), ([0.0; 2], [0.0, bad])] {
            let error = world.set_node(0, 3, x, v).expect_err("no number");
            assert!(error.to_string().starts_with("`body.0.node.3`: "), "{error}");
        }
    }
    assert!(world.set_node(0, 24, [0.0; 2], [0.0; 2]).is_err(), "there is no such node");
    assert!(world.add_force(2, std::sync::Arc::new(|_, _, _, _| [0.0; 2])).is_err(), "there is no such body");
    assert_eq!((world.state_hash(), world.energy()), (hash, energy));
    // A law that fails in the third frame from now, at one node of the second body.
    let late = world.time() + 2.5 / 60.0;
    let law =
        move |node: u32, _: [f64; 2], _: [f64; 2], t: f64| [if node == 7 && t > late { f64::NAN } else { 0.0 }, 0.0];
    world.add_force(1, std::sync::Arc::new(law)).expect("a body");
    frames(&mut world, 2);
    let (hash, frame) = (world.state_hash(), world.frames());
    for _ in 0..2 {
        match world.frame().expect_err("the law gives no number") {
            WorldError::Diverged { body, node, time, last, range: None } => {
                assert_eq!((body.as_str(), node), ("c", 7));
                assert!(time >= late - 1e-3 && last <= late, "{time} {last}");
            }
            other => panic!("{other}"),
        }
        assert_eq!((world.state_hash(), world.frames()), (hash, frame), "the last good frame");
    }
}

/// Row 63: bodies that fall for ever are removed and counted, in the same way for any number of threads and after a restored snapshot.
#[test]
fn bodies_beyond_the_largest_distance_are_taken_away() {
    let text = ring(16, "", "velocity = [2, 0]\ncopies = { count = [9], spacing = [2, 0] }\n")
        .replace("gravity = [0, -9.81]", "gravity = [0, -9.81]\nlargest_distance = 30");
    let end = |threads, restart: bool| {
        let mut world = World::new(plane(&text), Options { threads, ..Options::default() }).expect("a world");
        let mut counts = Vec::new();
        for frame in 0..180 {
            world.frame().expect("a frame");
            if restart && frame == 130 {
                let bytes = world.snapshot();
                world = built(plane(&text));
                world.restore(&bytes).expect("its own snapshot");
            }
            counts.push((world.bodies().count(), world.state_hash()));
        }
        let warning = world.warnings().into_iter().find(|w| w.code == "limit.distance").map(|w| w.count);
        (counts, warning)
    };
    let (counts, warning) = end(1, false);
    // 30 m below the start after √(2·30/9.81) = 2.47 s; the last body of the row is removed first, because it is farther from the origin.
    let first = counts.iter().position(|c| c.0 < 9).expect("the row goes");
    assert!((125..150).contains(&first), "frame {first}");
    assert!(counts[first].0 > 0 && counts[179].0 == 0 && warning == Some(9), "{warning:?}");
    assert_eq!((end(3, false), end(1, true)), ((counts.clone(), warning), (counts, warning)));
}
