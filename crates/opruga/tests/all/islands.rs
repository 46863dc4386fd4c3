//! Which bodies are stepped together, with which integrator, and the cost of a change of one body for the others.

use crate::common;
use common::*;
use opruga::blueprint::{Action, CommandBlueprint};
use opruga::core::spec::Value;
use opruga::{Options, World};

const MODELS: &str =
    "{ kind = \"mass_spring\", stiffness = 600.0, damping = 0.5 }, { kind = \"pressure\", nRT = 30.0 }";

/// A ring with a name and an integrator, in a row of rings.
fn ring(name: &str, place: usize, rule: &str) -> String {
    let rule = if rule.is_empty() { String::new() } else { format!("integrator = {rule}\n") };
    format!(
        "[[body]]\nname = \"{name}\"\nmass = 1\nposition = [{:?}, 0.7]\n{rule}\
         shape = {{ kind = \"ring\", radius = 0.5, vertices = 24 }}\nmodels = [{MODELS}]\n",
        2.0 * place as f64
    )
}

const FLOOR: &str = "[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.5\n";

fn copies(count: usize) -> String {
    format!(
        "{}{FLOOR}[[body]]\nname = \"b\"\nmass = 1\nposition = [0, 0.7]\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 12 }}\n\
         models = [{MODELS}]\ncopies = {{ count = [{count}], spacing = [2, 0] }}\n",
        head(1.0 / 60.0, 32, -9.81, "symplectic_euler")
    )
}

fn drag(body: usize, world: &World<2>) -> CommandBlueprint<2> {
    let x = world.position(body, 0);
    let (at, until) = (world.time(), world.time() + world.blueprint().time.frame);
    CommandBlueprint {
        at,
        until,
        action: Action::Drag {
            body,
            node: Some(0),
            facet: false,
            stiffness: None,
            path: vec![vec![at, x[0], x[1] + 0.1]],
            largest_force: None,
        },
    }
}

#[test]
fn a_drag_on_one_body_of_a_thousand_builds_one_island_anew() {
    let mut world = built(plane(&copies(1000)));
    assert_eq!((world.islands(), world.islands_built()), (125, 125));
    for frame in 0..20 {
        let (before, command) = (world.islands_built(), drag(500, &world));
        world.command(command).expect("a body");
        world.frame().expect("a frame");
        // The drag of the last frame ends when that of this one begins: one rebuild for both.
        assert_eq!(world.islands_built() - before, 1, "frame {frame}");
    }
    assert!(world.energy().work_user > 0.0, "it was pulled");
}

#[test]
fn adding_removing_and_setting_leave_other_islands_alone() {
    let mut world = built(plane(&copies(64)));
    let mut count = world.islands_built();
    let mut built_by = |world: &World<2>| {
        let built = world.islands_built() - count;
        count = world.islands_built();
        built
    };
    world.remove_body("b[0]").expect("a body");
    assert_eq!((built_by(&world), world.islands()), (1, 8), "the first batch lost a body");
    world.remove_body("b[9]").expect("a body");
    assert_eq!((built_by(&world), world.islands()), (1, 8));
    let mut body = world.blueprint().bodies[20].clone();
    body.name = "late".into();
    world.add_body(body).expect("a body");
    assert_eq!((built_by(&world), world.islands()), (1, 9), "the last batch was full");
    world.set("body.b[17].models.mass_spring.stiffness", Value::Number(700.0)).expect("a parameter");
    assert_eq!(built_by(&world), 1);
    for (path, value) in [("collider.0.friction", Value::Number(0.1)), ("time.substeps", Value::Integer(40))] {
        world.set(path, value).expect("a parameter");
        assert_eq!(built_by(&world), 0, "{path}");
    }
    world.set("world.drag", Value::Number(0.1)).expect("a parameter");
    assert_eq!(built_by(&world), 9, "drag is everybody's");
    let names: Vec<u32> = (0..12).collect();
    world.set("body.b[17].models.mass_spring.stiffness", Value::Number(1e12)).expect_err("no stable step");
    assert_eq!(world.reaction(17, &names), [0.0; 2], "still there");
}

/// Bodies of a batch may differ in numbers: the stiffest must be found wherever it is.
#[test]
fn a_stiff_copy_in_a_later_batch_is_refused() {
    let mut world = built(plane(&copies(16)));
    let before = world.state_hash();
    let error = world.set("body.b[9].models.mass_spring.stiffness", Value::Number(1e9)).expect_err("no stable step");
    assert_eq!(error.code(), "step.unstable", "{error}");
    assert_eq!(world.state_hash(), before);
    frames(&mut world, 3);
}

#[test]
fn a_body_with_its_own_integrator_moves_as_in_a_scene_of_that_integrator() {
    let rules = ["symplectic_euler", "verlet", "{ kind = \"runge_kutta\" }", "heun", "verlet", "symplectic_euler"];
    let quoted = |rule: &str| if rule.starts_with('{') { rule.to_string() } else { format!("\"{rule}\"") };
    let together: String = rules.iter().enumerate().map(|(k, rule)| ring(&format!("r{k}"), k, &quoted(rule))).collect();
    let scene = |rule: &str, bodies: &str| format!("{}{FLOOR}{bodies}", head(1.0 / 60.0, 32, -9.81, rule));
    let mut mixed = built(plane(&scene("explicit_euler", &together)));
    frames(&mut mixed, 40);
    for (k, rule) in rules.iter().enumerate() {
        let rule = rule.trim_start_matches("{ kind = \"").trim_end_matches("\" }");
        let mut alone = built(plane(&scene(rule, &ring("r", k, ""))));
        frames(&mut alone, 40);
        for node in 0..24 {
            assert_eq!(mixed.position(k, node), alone.position(0, node), "{rule}, node {node}");
            assert_eq!(mixed.velocity(k, node), alone.velocity(0, node), "{rule}, node {node}");
        }
    }
    assert!(mixed.stability().len() >= 4, "{:?}", mixed.stability());
}

#[test]
fn bodies_of_different_integrators_share_no_island() {
    let rules: Vec<&str> = (0..16).map(|k| if k % 2 == 0 { "\"verlet\"" } else { "" }).collect();
    let mut scene = plane(&format!("{}{FLOOR}{}", head(1.0 / 60.0, 32, -9.81, "symplectic_euler"), ring("r", 0, "")));
    let first = scene.bodies[0].clone();
    let verlet =
        plane(&format!("{}{}", head(1.0, 1, 0.0, "verlet"), ring("r", 0, "\"verlet\""))).bodies[0].integrator.clone();
    scene.bodies = rules
        .iter()
        .enumerate()
        .map(|(k, rule)| opruga::blueprint::BodyBlueprint {
            name: format!("r{k}"),
            translation: [2.0 * k as f64, 0.7],
            integrator: if rule.is_empty() { None } else { verlet.clone() },
            ..first.clone()
        })
        .collect();
    let world = built(scene.clone());
    assert_eq!(world.islands(), 2, "eight and eight");
    let hash = |threads, batches| {
        let mut world = World::new(scene.clone(), Options { threads, batches, ..Options::default() }).expect("a world");
        frames(&mut world, 20);
        world.state_hash()
    };
    let expected = hash(1, false);
    assert_eq!([hash(1, true), hash(3, true), hash(8, false)], [expected; 3]);
}

#[test]
fn a_snapshot_of_mixed_integrators_goes_on_bit_for_bit() {
    let bodies: String =
        ["\"verlet\"", "", "\"runge_kutta\""].iter().enumerate().map(|(k, r)| ring(&format!("r{k}"), k, r)).collect();
    let scene = || plane(&format!("{}{FLOOR}{bodies}", head(1.0 / 60.0, 32, -9.81, "symplectic_euler")));
    let mut first = built(scene());
    frames(&mut first, 10);
    first.remove_body("r1").expect("a body");
    let bytes = first.snapshot();
    let mut second = built(scene());
    second.restore(&bytes).expect("its own snapshot");
    frames(&mut first, 20);
    frames(&mut second, 20);
    assert_eq!((first.state_hash(), first.energy()), (second.state_hash(), second.energy()));
}

#[test]
fn the_step_of_a_body_is_checked_with_its_own_integrator() {
    // 600 N/m between nodes of 1/24 kg: ω = 240 rad/s; Runge–Kutta is stable where symplectic Euler is not.
    let springs = "{ kind = \"mass_spring\", stiffness = 600.0 }";
    let scene = |rule: &str| {
        let ring = ring("r", 0, rule).replace(MODELS, springs);
        format!("{}{ring}", head(1.0 / 60.0, 2, 0.0, "runge_kutta"))
    };
    built(plane(&scene("")));
    let error = refused(&scene("\"symplectic_euler\""));
    assert!(error.to_string().contains("of `symplectic_euler` is unstable for body `r`"), "{error}");
    let growing = built(plane(&scene("\"explicit_euler\"")));
    assert!(growing.warnings().iter().any(|w| w.code == "step.no_stable_step"), "{:?}", growing.warnings());
}

#[test]
fn an_integrator_of_a_body_that_does_not_exist_is_told_with_its_place() {
    let scene = |rule: &str| format!("{}{}", head(1.0 / 60.0, 32, 0.0, "verlet"), ring("r", 0, rule));
    for (rule, expected) in [
        ("\"verlett\"", "error[scene.unknown_kind]"),
        ("{ kind = \"verlet\", order = 2 }", "error[scene.unknown_field]: there is no field `order` in `verlet`"),
        ("3", "error[scene.type]: `body.0.integrator` is a whole number"),
    ] {
        let errors = read(&scene(rule)).expect_err("no such integrator");
        let said: String = errors.iter().map(ToString::to_string).collect();
        assert!(said.contains(expected) && said.contains("test.toml:"), "{said}");
    }
    let mut world = built(plane(&scene("")));
    let error = world.set("body.r.integrator.order", Value::Integer(2)).expect_err("it has none of its own");
    assert!(error.to_string().contains("uses the integrator of the scene"), "{error}");
}
