//! Rows 43 to 58: invalid parameters, and unusual valid ones.

use super::*;

/// A falling block of finite elements with these fields of its model.
fn solid(fields: &str) -> String {
    format!("{}{}", head(1.0 / 60.0, 64, -9.81, "symplectic_euler"), block(fields))
}

fn block(fields: &str) -> String {
    format!(
        "[[body]]\nname = \"s\"\nmass = 1\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2] }}\n\
         simplices = true\n\
         models = [{{ kind = \"fem\", {fields} }}]\n"
    )
}

/// Rows 43 to 58: messages about invalid parameters.
#[test]
#[expect(clippy::too_many_lines, reason = "a table: one row for every parameter")]
fn parameters_that_make_no_sense() {
    let chain = |points: &str, models: &str| {
        format!(
            "{}[[body]]\nname = \"c\"\nmass = 1\nshape = {{ kind = \"polyline\", points = {points} }}\nmodels = [{models}]\n",
            head(1.0 / 60.0, 16, 0.0, "symplectic_euler")
        )
    };
    let springs = "{ kind = \"mass_spring\", stiffness = 10.0 }";
    let cases = [
        // 43: springs of zero length
        (
            chain("[[0, 0], [0, 0]]", springs),
            "error[scene.shape]: the consecutive points 0 and 1 are at the same position",
        ),
        (
            chain("[[0, 0], [1, 0], [1, 0]]", springs),
            "error[scene.shape]: the consecutive points 1 and 2 are at the same position",
        ),
        // 47: Poisson's ratio of finite elements, 46 and 48: their modulus
        (solid("youngs_modulus = 1e5, poissons_ratio = 0.5"), "error[scene.range]: `poissons_ratio` is 0.5"),
        (solid("youngs_modulus = 1e5, poissons_ratio = -1"), "error[scene.range]: `poissons_ratio` is -1"),
        (solid("youngs_modulus = 1e5, poissons_ratio = 0.6"), "error[scene.range]: `poissons_ratio` is 0.6"),
        (
            solid("youngs_modulus = 1e5, poissons_ratio = 0.4999999").replace("mass = 1", "mass = 1\norder = 1"),
            "`poissons_ratio` is 0.4999999 for linear triangles, which lock near incompressibility; allowed: at most 0.45",
        ),
        (solid("youngs_modulus = 0"), "error[scene.range]: `youngs_modulus` is 0"),
        (solid("youngs_modulus = -1"), "error[scene.range]: `youngs_modulus` is -1"),
        (solid("youngs_modulus = 1e300"), "not_finite"),
        (solid("youngs_modulus = 1e30"), "step.unstable: the step h = "),
        // 44, 46: masses and constants
        (ring(16, BALL, "").replace("mass = 1", "mass = 0"), "error[scene.range]: `mass` is 0"),
        (ring(16, "{ kind = \"mass_spring\", stiffness = -1 }", ""), "error[scene.range]: `stiffness` is -1"),
        (
            ring(16, "{ kind = \"mass_spring\" }", ""),
            "error[model.one_of]: exactly one of `stiffness`, `modulus` must be given; none of them is",
        ),
        (
            ring(16, "{ kind = \"mass_spring\", stiffness = 1, modulus = 1 }", ""),
            "exactly one of `stiffness`, `modulus` must be given, not `stiffness`, `modulus`",
        ),
        (ring(16, "{ kind = \"bending\", stiffness = -0.1 }", ""), "error[scene.range]: `stiffness` is -0.1"),
        (ring(16, BALL, &FLOOR.replace("friction = 0.5", "friction = -0.5")), "error[scene.range]: `friction` is -0.5"),
        (ring(16, BALL, &FLOOR.replace("normal = [0, 1]", "normal = [0, 0]")), "normal"),
        // 48, 50: steps that are too long, reported before the run
        (
            ring(1, BALL, ""),
            "step.unstable: the step h = 0.0166667 s of `symplectic_euler` is unstable for body `b`; allowed: h <= ",
        ),
        (
            ring(16, "{ kind = \"mass_spring\", stiffness = 1e300 }", ""),
            "step.not_finite: body `b`: stability: the forces near the present state are not finite, so no stable step can be computed; allowed: \
             forces, stiffnesses and their ratios to the masses of nodes below 1e300; hint: the largest number in the models of the body is \
             `stiffness` = 1e300 of `mass_spring`, and its lightest node has a mass of 0.0416667 kg",
        ),
        // 58: pins that prescribe two positions of a node
        (
            ring(
                16,
                BALL,
                "pin = [{ select = { nodes = [0, 1] }, motion = [[0, 0, 0], [1, 1, 0]] }, { select = { nodes = [1, 2] }, motion = [[0, 0, 0], [1, -1, 0]] }]",
            ),
            "error[scene.conflict]: node 1 of body `b` is also held by `body.0.pin.0.select` in line ",
        ),
        (
            ring(
                16,
                BALL,
                "fixed = true\npin = [{ select = { node = 3 }, axes = \"y\", motion = [[0, 5, 0], [1, 5, 1]] }]",
            ),
            ", which moves it elsewhere along y at t = 1 s",
        ),
        // 63: so far away that an element is a few rounding units wide
        (
            ring(64, BALL, "").replace("center = [0, 0.6]", "center = [1e12, 0.6]"),
            "scene.range: body `b`: position: the body begins 1e12 m from the origin along an axis",
        ),
        // so fast that it leaves that region within a step
        (
            ring(64, BALL, "velocity = [1e300, 0]"),
            "scene.range: body `b`: velocity: `velocity` and `angular_velocity` give the body an initial speed of 1e300 m/s along an axis; ",
        ),
        (ring(64, BALL, "angular_velocity = 1e200"), "hint: are the units mixed (metres, seconds, radians)?"),
        (
            ring(64, BALL, "rotation = 1e200"),
            "error[scene.range]: `rotation` is 1e200: rounding loses the direction of so large an angle",
        ),
        (
            ring(64, BALL, "scale = 1e-320"),
            "error[scene.range]: `scale` is 1e-320: products of such small lengths are zero",
        ),
        // 72: a drag that would end at its beginning
        (
            ring(16, BALL, "[[command]]\ndo = \"drag\"\nat = 1\nbody = \"b\"\npath = [[1, 0, 0]]"),
            "error[scene.missing]: `until` is missing: a path of one point does not define when the drag ends",
        ),
        (
            ring(16, BALL, "[[command]]\ndo = \"push\"\nat = 1\nuntil = 1\nbody = \"b\"\nforce = [1, 0]"),
            "error[scene.range]: the command ends at 1 s, as soon as it begins at 1 s",
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

/// All errors of a body are reported at once: choices in its models, the direction of an obstacle, and every model that refuses the mesh; bodies with
/// errors of their own still count as existing.
#[test]
fn everything_that_is_wrong_is_said_at_once() {
    let text = ring(
        16,
        "{ kind = \"mass_spring\" }, { kind = \"pressure\", nRT = 1, pressure = 1 }, { kind = \"bending\" }",
        FLOOR,
    )
    .replace("point = [0, 0]", "point = [0, inf]")
    .replace("normal = [0, 1]", "normal = [0, 0]");
    let said = said(&text);
    println!("{said}");
    assert_eq!(said.matches("error[model.one_of]").count(), 3, "{said}");
    assert!(said.contains("`normal` is [0, 0]") && said.contains("`point` is not finite"), "{said}");
    let misspelt = super::said(&ring(16, "{ kind = \"mass_spring\", stifness = 1 }", ""));
    assert!(misspelt.contains("there is no field `stifness`") && !misspelt.contains("model.one_of"), "{misspelt}");
    let broken = ring(16, "{ kind = \"mass_spring\" }", "[[command]]\ndo = \"remove\"\nat = 1\nbody = \"c\"\n");
    let said = super::said(&broken.replace("radius = 0.5", "radius = -1"));
    assert!(said.contains("there is no body `c`") && !said.contains("has no bodies"), "{said}");

    // Springs, gas and bending all lack what they need in a point cloud of one chain.
    let chain = format!(
        "{}[[body]]\nname = \"c\"\nmass = 1\nshape = {{ kind = \"polyline\", points = [[0, 0], [1, 0]] }}\n\
         models = [{{ kind = \"mass_spring\", modulus = 1 }}, {{ kind = \"pressure\", nRT = 1 }}, {{ kind = \"bending\", stiffness = 1 }}]\n",
        head(1.0 / 60.0, 16, 0.0, "symplectic_euler")
    );
    let problems = World::problems(&plane(&chain), &Options::default(), &Default::default());
    let codes: Vec<&str> = problems.iter().map(opruga::WorldError::code).collect();
    assert_eq!(codes, ["model.no_area", "model.open_surface", "model.no_hinges"], "{problems:?}");
}

/// Rows 44 to 58: unusual parameters that work.
#[test]
fn parameters_that_are_odd_but_fine() {
    let heavy = |mass: &str, x: f64| {
        format!(
            "[[body]]\nname = \"m{mass}\"\nmass = {mass}\nposition = [{x:?}, 0]\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 12 }}\n"
        )
    };
    let cases = [
        // 43: a rest length of zero: the springs contract until their ends coincide
        ring(64, "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0, rest_scale = 0 }", FLOOR),
        // 47, 48: no stiffness is too small; a body of 1 Pa next to one of 10¹² Pa
        solid("youngs_modulus = 1e-300"),
        solid("youngs_modulus = 1e5, poissons_ratio = 0.4999999")
            .replace("symplectic_euler", "backward_euler")
            .replace("substeps = 64", "substeps = 1"),
        format!(
            "{}{}",
            solid("youngs_modulus = 1"),
            block("youngs_modulus = 1")
                .replace("name = \"s\"", "name = \"hard\"")
                .replace("youngs_modulus = 1", "youngs_modulus = 1e12")
        )
        .replace("symplectic_euler", "backward_euler")
        .replace("substeps = 64", "substeps = 1"),
        // 43: a rest length of nearly zero, 45: masses of 1e-9 kg next to 1000 kg
        ring(64, "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0, rest_scale = 1e-6 }", FLOOR),
        ring(16, BALL, &format!("{}{}", heavy("1e-9", 3.0), heavy("1e3", 6.0))),
        // 48: no stiffness is too small
        ring(16, "{ kind = \"mass_spring\", stiffness = 1e-300 }", FLOOR),
        ring(16, "{ kind = \"mass_spring\", stiffness = 0 }", FLOOR),
        // 53: no ramp, hardly any gas, a vacuum that is compressed flat
        ring(32, "{ kind = \"mass_spring\", stiffness = 600.0 }, { kind = \"pressure\", nRT = 1e-12 }", FLOOR),
        ring(
            64,
            "{ kind = \"mass_spring\", stiffness = 600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 1, ambient = 200.0 }",
            FLOOR,
        ),
        // 56: no gravity and very strong gravity
        ring(32, BALL, FLOOR).replace("-9.81", "0"),
        ring(32, BALL, FLOOR).replace("-9.81", "-1e6"),
        // 58: all nodes pinned; neighbours forced apart; a node moved through the floor
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
        // 71: the same node pinned twice, loads that cancel each other
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

/// Row 50: integrators without any stable step report this, with the rate of growth.
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

/// Row 54: an inverted ring is counted, and creates no energy.
#[test]
fn a_chamber_turned_inside_out_is_counted_and_makes_no_energy() {
    let models =
        "{ kind = \"mass_spring\", stiffness = 600.0 }, { kind = \"pressure\", nRT = 30.0, largest_pressure = 500.0 }";
    let text =
        ring(512, models, "").replace("gravity = [0, -9.81]", "gravity = [0, 0]").replace("symplectic_euler", "verlet");
    let mut world = built(plane(&text));
    for node in 0..24 {
        let [x, y] = world.position(0, node);
        world.set_node(0, node, [-0.9 * x, y], [0.0; 2]).expect("a node");
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
    assert!(warning.count > 0 && warning.message.contains("was inverted"), "{warning:?}");
}

/// Rows 54 and 72: a ball of gas that is flattened, by a wall or by a shaking pointer, keeps within the energy that it was given. The gas once pushed
/// a thousand times as hard there, and each passage of the volume through zero added energy that the step could not resolve.
#[test]
fn a_ball_of_gas_that_is_flattened_gains_no_energy_without_bound() {
    let ball = |substeps: u32, motion: &str, command: &str| {
        format!(
            "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 8\nframe = 0.016666666666666666\nsubsteps = {substeps}\n[world]\n\
             gravity = [0.0, -9.81]\n[integrator]\nkind = \"verlet\"\n[[body]]\nname = \"b\"\nshape = {{ kind = \"ring\", radius = \
             0.5, vertices = 36, center = [0.0, 0.6] }}\nmass = 1.0\n{motion}models = [{{ kind = \"mass_spring\", stiffness = 1600.0, \
             damping = 1.0 }}, {{ kind = \"pressure\", nRT = 55.0 }}, {{ kind = \"bending\", stiffness = 0.02 }}]\n[[collider]]\n\
             kind = \"half_space\"\nnormal = [0.0, 1.0]\nrestitution = 0.3\nfriction = 0.4\n{command}"
        )
    };
    let to_and_fro: Vec<String> = (0..8)
        .map(|k| format!("[{}, {}, 1.0]", 0.2 + 0.1 * f64::from(k), if k % 2 == 0 { 3.0 } else { -3.0 }))
        .collect();
    let shaken = format!("[[command]]\nat = 0.2\ndo = \"drag\"\nbody = \"b\"\npath = [{}]\n", to_and_fro.join(", "));
    for (name, text) in [
        ("thrown at 80 m/s", ball(32, "velocity = [0.0, -80.0]\n", "")),
        ("thrown at 100 m/s", ball(32, "velocity = [0.0, -100.0]\n", "")),
        ("shaken", ball(32, "", &shaken)),
        ("shaken in finer steps", ball(64, "", &shaken)),
    ] {
        let mut world = built(plane(&text));
        let mut moving = 0.0f64;
        for _ in 0..480 {
            world.frame().expect("a frame");
            let now = world.energy().kinetic;
            moving = if now > moving { now } else { moving };
            let unexplained = world.energy().loss_integrator;
            assert!(
                moving < 2e4 && unexplained.abs() < 0.2 * moving + 10.0,
                "{name}: {unexplained} J of {moving} J at {} s",
                world.time()
            );
        }
        assert!(world.energy().kinetic < 100.0, "{name}: {:?}", world.energy());
    }
}
