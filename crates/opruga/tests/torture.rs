//! Bad parameters and bad states, from the text of a scene to its frames. The numbers are rows of a list of torments:
//! 43–58 parameters, 61–78 states and contact. (Rows that need finite elements, shape matching, contact between bodies
//! or mesh files come with those.)

mod common;
use common::*;
use opruga::core::spec::Value;
use opruga::{Options, World, WorldError};

/// A ring above a floor; `more` follows its fields.
fn ring(substeps: u32, models: &str, more: &str) -> String {
    format!(
        "{}[[body]]\nname = \"b\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 24, center = [0, 0.6] }}\n\
         models = [{models}]\n{more}\n",
        head(1.0 / 60.0, substeps, -9.81, "symplectic_euler")
    )
}

const BALL: &str = "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 30.0 }";
const FLOOR: &str =
    "[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.5\nrestitution = 0.2\n";

fn said(text: &str) -> String {
    match read(text) {
        Ok(_) => match World::new(plane(text), Options::default()) {
            Ok(_) => "nothing".into(),
            Err(error) => format!("{}: {error}", error.code()),
        },
        Err(errors) => errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
    }
}

fn finite(world: &World<2>) -> bool {
    world.bodies().all(|b| {
        (0..world.node_count(b) as u32)
            .all(|n| world.position(b, n).iter().chain(&world.velocity(b, n)).all(|x| x.is_finite()))
    })
}

/// Rows 43 to 58: what is said about parameters that make no sense.
#[test]
fn parameters_that_make_no_sense() {
    let chain = |points: &str, models: &str| {
        format!(
            "{}[[body]]\nname = \"c\"\nmass = 1\nshape = {{ kind = \"polyline\", points = {points} }}\nmodels = [{models}]\n",
            head(1.0 / 60.0, 16, 0.0, "symplectic_euler")
        )
    };
    let springs = "{ kind = \"mass_spring\", stiffness = 10.0 }";
    let cases = [
        // 43: springs without length
        (chain("[[0, 0], [0, 0]]", springs), "error[scene.shape]: points 0 and 1 follow each other at the same place"),
        (
            chain("[[0, 0], [1, 0], [1, 0]]", springs),
            "error[scene.shape]: points 1 and 2 follow each other at the same place",
        ),
        // 44, 46: masses and constants
        (ring(16, BALL, "").replace("mass = 1", "mass = 0"), "error[scene.range]: `mass` is 0"),
        (ring(16, "{ kind = \"mass_spring\", stiffness = -1 }", ""), "error[scene.range]: `stiffness` is -1"),
        (
            ring(16, "{ kind = \"mass_spring\" }", ""),
            "model.one_of: body `b`: mass_spring: exactly one of `stiffness` and `modulus` must be given",
        ),
        (
            ring(16, "{ kind = \"mass_spring\", stiffness = 1, modulus = 1 }", ""),
            "exactly one of `stiffness` and `modulus` must be given",
        ),
        (ring(16, "{ kind = \"bending\", stiffness = -0.1 }", ""), "error[scene.range]: `stiffness` is -0.1"),
        (ring(16, BALL, &FLOOR.replace("friction = 0.5", "friction = -0.5")), "error[scene.range]: `friction` is -0.5"),
        (ring(16, BALL, &FLOOR.replace("normal = [0, 1]", "normal = [0, 0]")), "normal"),
        // 48, 50: steps that are too long, told before the run
        (
            ring(1, BALL, ""),
            "step.unstable: the step h = 0.0166667 s of `symplectic_euler` is unstable for body `b`: the largest stable step is ",
        ),
        (
            ring(16, "{ kind = \"mass_spring\", stiffness = 1e300 }", ""),
            "step.not_finite: body `b`: stability: the forces around the state are not finite",
        ),
        (ring(16, "{ kind = \"mass_spring\", stiffness = 1, damping = 1e12 }", ""), "step.unstable: the step h = "),
        // 53: gas
        (ring(16, "{ kind = \"pressure\", nRT = -1 }", ""), "error[scene.range]: `nRT` is -1"),
        (ring(16, "{ kind = \"pressure\", nRT = 1, gamma = 1 }", ""), "error[scene.range]: `gamma` is 1"),
        (ring(16, "{ kind = \"pressure\", nRT = 1, ramp = -1 }", ""), "error[scene.range]: `ramp` is -1"),
        (ring(16, "{ kind = \"pressure\" }", ""), "nRT"),
        (ring(16, "{ kind = \"pressure\", nRT = 1, pressure = 1 }", ""), "nRT"),
        (chain("[[0, 0], [1, 0], [1, 1]]", "{ kind = \"pressure\", nRT = 1 }"), "pressure"),
        // 56: gravity
        (ring(16, BALL, "").replace("gravity = [0, -9.81]", "gravity = [0, inf]"), "error[scene.not_finite]"),
    ];
    for (text, expected) in cases {
        let said = said(&text);
        println!("{said}\n");
        assert!(said.contains(expected), "expected {expected}, said: {said}\n{text}");
        assert!(!said.contains("NaN") && said.len() < 2000, "{said}");
    }
}

/// Rows 44 to 58: what looks odd and runs.
#[test]
fn parameters_that_are_odd_but_fine() {
    let heavy = |mass: &str, x: f64| {
        format!(
            "[[body]]\nname = \"m{mass}\"\nmass = {mass}\nposition = [{x:?}, 0]\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 12 }}\n"
        )
    };
    let cases = [
        // 43: a rest length of nearly nothing, 45: masses of 1e-9 kg beside 1000 kg
        ring(64, "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0, rest_scale = 1e-6 }", FLOOR),
        ring(16, BALL, &format!("{}{}", heavy("1e-9", 3.0), heavy("1e3", 6.0))),
        // 48: nothing is too soft
        ring(16, "{ kind = \"mass_spring\", stiffness = 1e-300 }", FLOOR),
        ring(16, "{ kind = \"mass_spring\", stiffness = 0 }", FLOOR),
        // 53: no ramp, hardly any gas, a vacuum that is pressed flat
        ring(32, "{ kind = \"mass_spring\", stiffness = 600.0 }, { kind = \"pressure\", nRT = 1e-12 }", FLOOR),
        ring(
            64,
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 1, ambient = 200.0 }",
            FLOOR,
        ),
        // 56: no gravity and a great deal
        ring(32, BALL, FLOOR).replace("-9.81", "0"),
        ring(32, BALL, FLOOR).replace("-9.81", "-1e6"),
        // 58: all nodes held; neighbours forced apart; a node led through the floor
        ring(32, BALL, &format!("pin = [{{ select = {{ all = true }} }}]\n{FLOOR}")),
        ring(
            64,
            BALL,
            &format!(
                "pin = [{{ select = {{ node = 0 }}, motion = [[0, 0, 0], [1, 9, 0]] }}, {{ select = {{ node = 1 }}, motion = [[0, 0, 0], [1, -9, 0]] }}]\n{FLOOR}"
            ),
        ),
        ring(64, BALL, &format!("pin = [{{ select = {{ node = 18 }}, motion = [[0, 0, 0], [1, 0, -3]] }}]\n{FLOOR}")),
        // 70: ice and glue
        ring(32, BALL, &FLOOR.replace("0.5", "0")),
        ring(32, BALL, &FLOOR.replace("0.5", "1e6")),
        // 71: the same node pinned twice, loads that cancel
        ring(
            32,
            BALL,
            "[[load]]\nkind = \"force\"\nbody = \"b\"\nvalue = [1e3, 0]\n[[load]]\nkind = \"force\"\nbody = \"b\"\nvalue = [-1e3, 0]\n",
        ),
    ];
    for text in cases {
        let mut world = built(plane(&text));
        for _ in 0..90 {
            world.frame().unwrap_or_else(|e| panic!("{e}\n{text}"));
        }
        assert!(finite(&world), "{text}");
    }
}

/// Row 50: integrators without any stable step say so, and how fast it grows.
#[test]
fn integrators_without_a_stable_step_warn() {
    for rule in ["explicit_euler", "heun"] {
        let text = ring(64, "{ kind = \"mass_spring\", stiffness = 600.0 }", "").replace("symplectic_euler", rule);
        let world = built(plane(&text));
        let warnings = world.warnings();
        let warning = warnings.iter().find(|w| w.code == "step.no_stable_step").expect("a warning");
        let expected = format!("`{rule}` has no stable step for body `b` (ω = ");
        assert!(
            warning.message.starts_with(&expected) && warning.message.contains("grows as exp("),
            "{}",
            warning.message
        );
    }
}

/// Row 43 and 62: nodes in one place, on a line, in a point, mirrored, at random: finite at every frame, and back in shape.
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
            world.place_node(0, node, spoil(node, x), [0.0; 2]).expect("a node");
        }
        for frame in 0..600 {
            world.frame().unwrap_or_else(|e| panic!("{name}, frame {frame}: {e}"));
            assert!(finite(&world), "{name}");
        }
        let now = world.readings(0)[0].1;
        println!("{name}: {:.4} of its area", now / volume);
        // What does not come back says why: it was inside out, or enclosed nothing.
        let told = world.warnings().iter().any(|w| w.code == "pressure.inverted" && w.count > 0);
        assert!((now / volume - 1.0).abs() < 1e-3 || !recovers && told, "{name}: {now} of {volume} m²");
    }
}

/// Row 54: a ring that is turned inside out is counted, and no energy is made of it.
#[test]
fn a_chamber_turned_inside_out_is_counted_and_makes_no_energy() {
    let models =
        "{ kind = \"mass_spring\", stiffness = 600.0 }, { kind = \"pressure\", nRT = 30.0, largest_pressure = 500.0 }";
    let text =
        ring(512, models, "").replace("gravity = [0, -9.81]", "gravity = [0, 0]").replace("symplectic_euler", "verlet");
    let mut world = built(plane(&text));
    for node in 0..24 {
        let [x, y] = world.position(0, node);
        world.place_node(0, node, [-0.9 * x, y], [0.0; 2]).expect("a node");
    }
    assert!(world.readings(0)[0].1 < 0.0, "{:?}", world.readings(0));
    let start = world.energy().total();
    for _ in 0..120 {
        world.frame().expect("a frame");
        let now = world.energy();
        assert!((now.total() - start).abs() < 1e-2 * (start.abs() + now.kinetic), "{now:?} of {start} J");
    }
    let warnings = world.warnings();
    let warning = warnings.iter().find(|w| w.code == "pressure.inverted").expect("a warning");
    assert!(warning.count > 0 && warning.message.contains("inside out"), "{warning:?}");
}

/// Row 62 in space: a balloon squeezed to a sheet, a needle, a point, mirrored, at random.
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
            world.place_node(0, node, spoil(x), [0.0; 3]).expect("a node");
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

/// Row 63: far away and falling for ever; row 64: no node goes through a floor, however fast.
#[test]
fn far_and_fast() {
    for far in [1e6, 1e12] {
        let mut world =
            built(plane(&ring(64, BALL, "").replace("center = [0, 0.6]", &format!("center = [{far:?}, {far:?}]"))));
        frames(&mut world, 30);
        assert!(finite(&world));
    }
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

/// Row 61: a number that is none, from outside or from a user's law: refused with body and node, the world as it was.
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
            let error = world.place_node(0, 3, x, v).expect_err("no number");
            assert!(error.to_string().starts_with("`body 0, node 3`: "), "{error}");
        }
    }
    assert!(world.place_node(0, 24, [0.0; 2], [0.0; 2]).is_err(), "there is no such node");
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
            WorldError::Diverged { body, node, time, last } => {
                assert_eq!((body.as_str(), node), ("c", 7));
                assert!(time >= late - 1e-3 && last <= late, "{time} {last}");
            }
            other => panic!("{other}"),
        }
        assert_eq!((world.state_hash(), world.frames()), (hash, frame), "the last good frame");
    }
}

/// Row 63: what falls for ever is taken away, counted, and the same on any number of threads and after a restored snapshot.
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
    // 30 m below the start after √(2·30/9.81) = 2.47 s; the last of the row first, since it is farther away.
    let first = counts.iter().position(|c| c.0 < 9).expect("the row goes");
    assert!((125..150).contains(&first), "frame {first}");
    assert!(counts[first].0 > 0 && counts[179].0 == 0 && warning == Some(9), "{warning:?}");
    assert_eq!((end(3, false), end(1, true)), ((counts.clone(), warning), (counts, warning)));
}

/// Row 71: a million steps at rest in a corner: no drift, no jitter.
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

/// Row 72: a pointer of 10 km/s, one that stands still far away, one on the node itself.
#[test]
fn pointers_pull_within_bounds() {
    for (path, most) in [
        ("[[0, 0, 0], [0.5, 5000, 0], [1, -5000, 0]]", "largest_force = 40.0"),
        ("[[0, 1e9, 1e9], [1, 1e9, 1e9]]", "largest_force = 40.0"),
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

/// Row 72: several pulls at once, on one node and on neighbours in a batch; a body that is taken away ends its pull.
#[test]
fn several_pulls_act_at_once() {
    let pull = |body: usize, x: f64| {
        format!(
            "[[command]]\ndo = \"drag\"\nat = 0\nuntil = 1\nbody = \"b[{body}]\"\nnode = 0\npath = [[0, {x:?}, 0.6], [1, {x:?}, 0.6]]\nstiffness = 20.0\n"
        )
    };
    let scene = |pulls: &str| {
        let copies = format!("copies = {{ count = [4], spacing = [2, 0] }}\n{pulls}");
        // Without gas the rest shape is at rest.
        plane(&ring(32, "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }", &copies).replace("-9.81", "0"))
    };
    // Node 0 of ball k lies at 2k + 0.5; two equal pulls to both sides leave it there.
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

/// Row 78: numbers of threads.
#[test]
fn numbers_of_threads() {
    let scene = || plane(&ring(32, BALL, FLOOR));
    for threads in [0, 257, 10_000] {
        let error = World::new(scene(), Options { threads, ..Options::default() }).expect_err("no such number");
        assert_eq!(
            error,
            WorldError::Path { path: "threads".into(), message: format!("is {threads}; allowed: 1 to 256") }
        );
    }
    let hash = |threads| {
        let mut world = World::new(scene(), Options { threads, ..Options::default() }).expect("a world");
        frames(&mut world, 30);
        world.state_hash()
    };
    assert_eq!(hash(1), hash(256));
}

/// Bodies that a command adds are drawn from then on, in a resumed world too.
#[test]
fn bodies_that_come_later_are_drawn() {
    let late = "[[command]]\ndo = \"add\"\nat = 0.05\nbody = { name = \"late\", mass = 1, position = [3, 1], \
                shape = { kind = \"ring\", radius = 0.5, vertices = 7 } }\n";
    let scene = || plane(&ring(32, BALL, late));
    let mut world = built(scene());
    let scenery = opruga::pictures::Scenery::new(&world);
    let drawn = |scenery: &opruga::pictures::Scenery, world: &mut World<2>| {
        scenery.picture(&scenery.capture(world, false)).bodies.len()
    };
    assert_eq!(drawn(&scenery, &mut world), 1);
    frames(&mut world, 6);
    assert_eq!(drawn(&scenery, &mut world), 2);
    let bytes = world.snapshot();
    let mut other = built(scene());
    other.restore(&bytes).expect("its own snapshot");
    assert_eq!(drawn(&opruga::pictures::Scenery::new(&other), &mut other), 2);
}

/// Row 73: while a frame runs nobody can add or take bodies away: a law that wants to is no program
/// (`World::add_force` shows it); between frames both are as good as in a scene.
#[test]
fn bodies_come_and_go_between_frames_without_a_trace_on_others() {
    let scene = || plane(&ring(32, BALL, FLOOR));
    let mut quiet = built(scene());
    frames(&mut quiet, 60);
    let mut busy = built(scene());
    let body = busy.blueprint().bodies[0].clone();
    for k in 0..60 {
        let mut guest = body.clone();
        guest.name = "guest".into();
        guest.translation[0] += 5.0;
        let number = busy.add_body(guest.clone()).expect("a body");
        let handle = busy.handle(number).expect("it is there");
        assert!(busy.add_body(guest).is_err(), "the name is taken");
        assert_eq!(busy.islands(), 2);
        busy.frame().expect("a frame");
        busy.remove_body("guest").expect("it is there");
        assert!(busy.resolve(handle).is_none() && busy.remove_body("guest").is_err(), "{k}");
    }
    for node in 0..24 {
        assert_eq!(busy.position(0, node), quiet.position(0, node));
        assert_eq!(busy.velocity(0, node), quiet.velocity(0, node));
    }
}

/// Row 78: threads change between frames, by way of a snapshot: the bits stay.
#[test]
fn threads_change_in_the_middle_of_a_run() {
    let scene = || plane(&ring(32, BALL, &format!("copies = {{ count = [5], spacing = [2, 0] }}\n{FLOOR}")));
    let mut one = built(scene());
    frames(&mut one, 60);
    let mut bytes = built(scene()).snapshot();
    for threads in [2, 7, 1, 5] {
        let mut world = World::new(scene(), Options { threads, ..Options::default() }).expect("a world");
        world.restore(&bytes).expect("its own snapshot");
        frames(&mut world, 15);
        bytes = world.snapshot();
    }
    let mut last = built(scene());
    last.restore(&bytes).expect("its own snapshot");
    assert_eq!((last.state_hash(), last.energy()), (one.state_hash(), one.energy()));
}

/// A body at rest, with a load on it: what damping, loads and obstacles do to it takes and gives nothing, by every rule, and no
/// ledger is open.
#[test]
fn a_body_that_lies_still_takes_and_gives_no_energy() {
    // With stages, nodes beside those that lie keep velocities of some 1e-7 m/s without moving.
    for (rule, most) in [("symplectic_euler", 1e-8), ("verlet", 1e-5), ("runge_kutta", 1e-5), ("heun", 1e-5)] {
        let models =
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 0.5 }, { kind = \"pressure\", nRT = 30.0 }";
        let floor = FLOOR.replace("0.2", "0");
        let load = "[[load]]\nkind = \"force\"\nbody = \"b\"\nvalue = [0.0, -0.5]\n";
        let mut world = built(plane(&ring(64, models, &format!("{floor}{load}")).replace("symplectic_euler", rule)));
        world.set("world.drag", Value::Number(3.0)).expect("a parameter");
        frames(&mut world, 1200);
        let before = world.energy();
        frames(&mut world, 60);
        let after = world.energy();
        // Per second.
        for (name, flow) in [
            ("damping", after.loss_damping - before.loss_damping),
            ("loads", after.work_user - before.work_user),
            ("put back", after.work_correction - before.work_correction),
            ("impacts", after.loss_contact - before.loss_contact),
            ("friction", after.loss_friction - before.loss_friction),
            ("unexplained", after.loss_integrator - before.loss_integrator),
        ] {
            println!("{rule}: {name} {flow:.1e} J/s");
            assert!(flow.abs() < most, "{rule}: {name} {flow:.3e} J/s");
        }
        assert!(world.warnings().iter().all(|w| w.code != "ledger.closure"), "{rule}");
    }
}

/// A block of springs that friction holds on a slope: nothing flows, however long it lies there.
#[test]
fn a_block_held_by_friction_takes_and_gives_no_energy() {
    let mut world = built(plane(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 9.0\nsubsteps = 64\n[world]\n\
         gravity = [4.387157534545926, -8.77433466235913]\n[integrator]\nkind = \"symplectic_euler\"\n[[body]]\nname = \"block\"\n\
         mass = 1.0\nshape = { kind = \"grid\", size = [1.0, 0.5], cells = [8, 4] }\n\
         models = [{ kind = \"mass_spring\", stiffness = 2000.0, damping = 10.0, edges = \"shear\" }]\n[[collider]]\n\
         kind = \"half_space\"\npoint = [0.0, 0.0]\nnormal = [0.0, 1.0]\nfriction = 0.6\n",
    ));
    frames(&mut world, 180);
    let before = world.energy();
    frames(&mut world, 300);
    let after = world.energy();
    assert!(after.kinetic < 1e-12, "{after:?}");
    assert!((after.loss_friction - before.loss_friction).abs() < 1e-9, "{before:?} {after:?}");
    assert!((after.loss_integrator - before.loss_integrator).abs() < 1e-9, "{before:?} {after:?}");
}

/// Explicit Euler makes energy: the ledger stays open, and says so; symplectic Euler closes that of the same ball.
#[test]
fn a_ledger_that_stays_open_is_warned_of() {
    for (rule, closes) in [("symplectic_euler", true), ("explicit_euler", false)] {
        let models =
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 0.05 }, { kind = \"pressure\", nRT = 30.0 }";
        let mut world = built(plane(&ring(64, models, FLOOR).replace("symplectic_euler", rule)));
        frames(&mut world, 180);
        let warned = world.warnings().into_iter().any(|w| w.code == "ledger.closure" && w.count > 10);
        assert!((world.energy().closure < 0.1) == closes && warned != closes, "{rule}: {:?}", world.energy());
    }
}
