//! Faults of a scene that are about contact are reported with the line of their cause, the value and what would help.

use crate::common;
use common::*;
use opruga::blueprint::AnyBlueprint;
use opruga::io::refusals::in_scene;
use opruga::io::{SceneError, scene};
use opruga::{Options, World, WorldError, catalogue};
use std::sync::Arc;

/// The errors of the reader.
fn refusals(text: &str) -> Vec<SceneError> {
    read(text).err().unwrap_or_default()
}

/// An error of a world, with its line in the scene.
fn located(error: &WorldError, text: &str) -> SceneError {
    in_scene(error.into(), text, "test.toml", &[])
}

/// All errors of a scene in the plane whose world cannot be built.
fn problems(text: &str) -> Vec<SceneError> {
    let problems = World::problems(&plane(text), &Options::default(), &Arc::default());
    problems.iter().map(|error| located(error, text)).collect()
}

/// The number of the only line that begins with these words.
fn line(text: &str, words: &str) -> Option<usize> {
    assert_eq!(text.lines().filter(|line| line.starts_with(words)).count(), 1, "{words}");
    text.lines().position(|line| line.starts_with(words)).map(|line| line + 1)
}

/// A block of four cells, with its lower left corner and more lines.
fn block(name: &str, corner: [f64; 2], more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2], corner = {corner:?} }}\ndensity = 100.0\n{more}\
         models = [{{ kind = \"fem\", youngs_modulus = 1e4 }}]\n"
    )
}

fn start(rule: &str, contact: &str) -> String {
    head(0.01, 4, 0.0, rule) + &format!("[contact]\n{contact}")
}

/// Two bodies that are apart.
fn two(rule: &str, contact: &str, more: &str) -> String {
    start(rule, contact) + &block("a", [0.0, 0.0], "") + &block("b", [3.0, 0.0], more)
}

#[test]
fn two_pairs_of_the_same_groups_are_refused_at_the_second() {
    let pair = |first: &str, second: &str, friction: f64| {
        format!("[[contact.pair]]\nfirst = \"{first}\"\nsecond = \"{second}\"\nfriction = {friction:?}\n")
    };
    for (first, second) in [("a", "b"), ("b", "a")] {
        let pairs = pair("a", "b", 0.1) + &pair("a", "a", 0.2) + &pair(first, second, 0.3);
        let text = two("verlet", &pairs, "");
        let found = refusals(&text);
        let [error] = found.as_slice() else { panic!("{found:?}") };
        let entries: Vec<usize> =
            (1..).zip(text.lines()).filter(|(_, l)| l.starts_with("second = ")).map(|e| e.0).collect();
        assert_eq!((error.code, error.line), ("scene.conflict", Some(entries[2])), "{error}");
        assert!(error.message.contains(&format!("line {}", entries[0])), "{error}");
        assert!(error.value.is_some() && error.allowed.is_some() && error.hint.is_some(), "{error}");
    }
    // A program gets the same error.
    let mut scene = plane(&two("verlet", &pair("a", "b", 0.1), ""));
    let contact = scene.contact.as_mut().expect("contact");
    contact.pairs.push(contact.pairs[0].clone());
    let error = World::new(scene, Options::default()).expect_err("two pairs of the same groups");
    assert_eq!(error.code(), "scene.conflict");
}

#[test]
fn a_truth_value_instead_of_contact_settings_gets_a_hint_with_the_right_field() {
    let hint = |text: &str| {
        let found = refusals(text);
        let [error] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((error.code, error.line.is_some()), ("scene.type", true), "{error}");
        error.hint.clone().unwrap_or_default()
    };
    let of_body = |value: &str| hint(&two("verlet", "", &format!("contact = {value}\n")));
    assert!(of_body("false").contains("contact = { touch = false }"));
    assert!(of_body("true").contains("[contact]"));
    let of_scene =
        |value: &str| hint(&format!("contact = {value}\n{}", two("verlet", "", "").replace("[contact]\n", "")));
    assert!(of_scene("true").contains("[contact]"));
    assert!(of_scene("false").contains("leave out"));
}

#[test]
fn an_integrator_that_contact_refuses_is_refused_at_its_own_line() {
    let own = |kind: &str, more: &str| format!("integrator = {{ kind = \"{kind}\"{more} }}\n");
    let at = |text: &str, code: &str, words: &str| {
        let error = World::new(plane(text), Options::default()).expect_err("refused");
        let error = located(&error, text);
        assert_eq!((error.code, error.line), (code, line(text, words)), "{error}");
        assert!(error.allowed.is_some() && error.hint.is_some(), "{error}");
    };
    let barrier = "response = \"barrier\"\n";
    at(&two("backward_euler", barrier, &own("verlet", "")), "contact.barrier", "integrator = ");
    at(&two("verlet", barrier, ""), "contact.barrier", "response");
    at(&two("verlet", "", &own("equilibrium", "")), "contact.implicit", "integrator = ");
    at(&two("equilibrium", "", &own("verlet", "")), "contact.implicit", "integrator = ");
    at(&two("equilibrium", "", &own("equilibrium", ", load_steps = 2")), "contact.implicit", "integrator = ");
    let parts = two("equilibrium", "", "").replace("\"equilibrium\"", "\"equilibrium\"\nload_steps = 2");
    at(&parts, "contact.implicit", "load_steps");
}

#[test]
fn every_body_that_is_too_fine_for_the_thickness_is_listed() {
    let body = |k: usize| block(["a", "b", "c"][k], [3.0 * k as f64, 0.0], "");
    let text = start("verlet", "thickness = 0.6\n") + &body(0) + &body(1) + &body(2);
    let found = problems(&text);
    assert_eq!(found.len(), 3, "{found:?}");
    for (error, name) in found.iter().zip(["`a`", "`b`", "`c`"]) {
        assert_eq!((error.code, error.line), ("contact.thickness", line(&text, "thickness")), "{error}");
        assert!(error.message.contains(name), "{error}");
    }
}

#[test]
fn the_density_of_a_hollow_box_asks_for_the_thickness_of_its_wall() {
    let text = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n[[body]]\nname = \"b\"\n\
        shape = { kind = \"box\", size = [1, 1, 1], cells = [2, 2, 2]FILLING }\ndensity = 100.0\n\
        models = [{ kind = \"mass_spring\", stiffness = 100.0 }]\n";
    let found = refusals(&text.replace("FILLING", ""));
    let [error] = found.as_slice() else { panic!("{found:?}") };
    assert!(!error.message.contains("sheet") && error.message.contains("hollow"), "{error}");
    assert!(error.hint.as_deref().is_some_and(|hint| hint.contains("filling")), "{error}");
    let filled = text.replace("FILLING", ", filling = \"lattice\", spacing = 0.5");
    assert!(refusals(&filled).is_empty(), "{:?}", refusals(&filled));
}

/// A ball between a pin that pulls it and the corners of an obstacle.
#[test]
fn an_obstacle_that_a_pin_leads_a_body_through_is_named_with_its_kind_and_line() {
    let pin = "pin = [{ select = { side = \"right\" }, axes = \"xy\", motion = [[0, 0, 0], [1, 4, 0]] }]\n";
    let wall = "[[collider]]\nkind = \"box\"\nmin = [1.5, -3.0]\nmax = [1.7, 3.0]\n";
    let text = start("backward_euler", "") + &block("a", [0.0, 0.0], pin) + wall;
    let mut world = built(plane(&text));
    let error = loop {
        if let Err(error) = world.frame() {
            break error;
        }
        assert!(world.time() < 1.0, "the pin is beyond the wall");
    };
    let error = located(&error, &text);
    assert_eq!((error.code, error.line), ("contact.led_through", line(&text, "[[collider]]")), "{error}");
    assert!(error.message.contains("0 (box)") && error.message.contains("`a`"), "{error}");
}

/// The warnings at the start.
fn at_the_start(text: &str) -> Vec<(String, String)> {
    let AnyBlueprint::Plane(blueprint) = read(text).unwrap_or_else(|errors| panic!("{errors:?}")) else {
        return built(space(text)).warnings().into_iter().map(|warning| (warning.code, warning.message)).collect();
    };
    built(blueprint).warnings().into_iter().map(|warning| (warning.code, warning.message)).collect()
}

#[test]
fn bodies_that_begin_inside_one_another_are_reported_once_with_both_names_and_the_position() {
    let scene = |corners: &[[f64; 2]]| {
        let bodies = corners.iter().zip(["a", "b", "c"]).map(|(corner, name)| block(name, *corner, ""));
        start("verlet", "") + &bodies.collect::<String>()
    };
    let overlapping = at_the_start(&scene(&[[0.0, 0.0], [0.9, 0.1], [3.0, 0.0]]));
    let [(code, message)] = overlapping.as_slice() else { panic!("{overlapping:?}") };
    assert_eq!(code, "contact.starts_overlapping");
    assert!(message.contains("`a` and `b`") && message.contains("near ("), "{message}");
    // Three bodies at one position are three pairs.
    let heap = at_the_start(&scene(&[[0.0, 0.0], [0.9, 0.1], [0.45, 0.8]]));
    assert!(heap.len() == 1 && heap[0].1.contains("3 pairs"), "{heap:?}");
    // A body that lies inside another one crosses no surface.
    let inner = "[[body]]\nname = \"inner\"\nshape = { kind = \"ring\", radius = 0.1, vertices = 8, center = [0.5, 0.5] }\nmass = 1.0\n";
    let nested = at_the_start(&(start("verlet", "") + &block("outer", [0.0, 0.0], "") + inner));
    assert!(nested.len() == 1 && nested[0].1.contains("`outer` and `inner`"), "{nested:?}");
    // Bodies that only touch, even to rounding errors, or that pass through one another.
    for corner in [[1.0, 0.0], [1.0 - 1e-12, 0.3], [1.0, 1.0]] {
        assert_eq!(at_the_start(&scene(&[[0.0, 0.0], corner])), []);
    }
    let apart = two("verlet", "", "contact = { touch = false }\nposition = [-2.5, 0.0]\n");
    assert_eq!(at_the_start(&apart), []);
}

#[test]
fn solids_in_space_that_begin_inside_one_another_are_reported_and_stacked_ones_are_not() {
    let cube = |name: &str, corner: [f64; 3]| {
        format!(
            "[[body]]\nname = \"{name}\"\nshape = {{ kind = \"grid\", size = [1, 1, 1], cells = [2, 2, 2], corner = {corner:?} }}\ndensity = 100.0\n\
             models = [{{ kind = \"fem\", youngs_modulus = 1e5 }}]\n"
        )
    };
    let head = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nsubsteps = 40\n[integrator]\nkind = \"verlet\"\n[contact]\n";
    for (height, told) in [(0.95, true), (1.0, false), (1.5, false)] {
        let found = at_the_start(&(head.to_string() + &cube("a", [0.0; 3]) + &cube("b", [0.0, 0.0, height])));
        assert_eq!(found.iter().any(|(code, _)| code == "contact.starts_overlapping"), told, "{height}: {found:?}");
    }
}

#[test]
fn no_shipped_scene_begins_with_bodies_inside_one_another() {
    for name in opruga::scenes::names() {
        let text = opruga::scenes::find(name).expect("a scene");
        if text.contains("\n[contact]") {
            let found = at_the_start(text);
            assert!(found.iter().all(|(code, _)| code != "contact.starts_overlapping"), "{name}: {found:?}");
        }
    }
}

/// The reading of a scene gives its notices.
#[test]
fn a_choice_of_surface_without_a_lattice_is_reported_and_with_a_lattice_it_is_not() {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let told = |text: &str| {
        let (_, notices) = scene::read(text.as_bytes(), "test.toml", &catalogue(), &options).expect("a scene");
        notices
            .into_iter()
            .any(|notice| notice.about.code == "scene.no_effect" && notice.about.path.ends_with("surface"))
    };
    let cells = "contact = { surface = \"cells\" }\n";
    assert!(told(&two("verlet", "", cells)));
    let filled = "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n[contact]\n[[body]]\nname = \"b\"\n\
        shape = { kind = \"icosphere\", radius = 1.0, subdivisions = 1, filling = \"lattice\", spacing = 0.5 }\ndensity = 100.0\n";
    assert!(!told(&format!("{filled}{cells}")));
}

/// A clamped bar under a sudden weight, which one iteration leaves far out of balance, alone and beside a body that it may touch.
#[test]
fn a_step_that_used_up_its_budget_where_bodies_touch_is_not_blamed_on_stiffness_alone() {
    let settings = "accuracy = \"real_time\"\niterations = 1\n";
    let bar = "[[body]]\nname = \"bar\"\nshape = { kind = \"grid\", size = [1, 0.1], cells = [8, 2] }\ndensity = 1000.0\n\
        pin = [{ select = { side = \"left\" }, axes = \"xy\" }]\nmodels = [{ kind = \"fem\", youngs_modulus = 1e6 }]\n";
    let advice = |contact: &str| {
        let text = head(1.0 / 60.0, 1, -50.0, "backward_euler").replace("[world]", &format!("{settings}[world]"));
        let mut world = built(plane(&(text + contact + bar + &block("b", [0.0, 3.0], ""))));
        frames(&mut world, 1);
        let warning = world.warnings().into_iter().find(|warning| warning.code == "step.cut_off").expect("a warning");
        warning.field("help").expect("advice")
    };
    assert!(advice("[contact]\n").contains("contact"), "{}", advice("[contact]\n"));
    assert!(!advice("").contains("contact"), "{}", advice(""));
}
