//! Altered scenes, read with everything that the library has, built, and run for a few frames: the result is a world, an error with its location, or
//! a body that diverges, but never a panic and never a number that is not finite.
//!
//! The mutations are the same in every run; `fuzz/` searches for new ones.

use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::scene::{Limits, Options as Reading, read};
use opruga::{Options, World, catalogue, scenes};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn runs<const D: usize>(mut blueprint: Blueprint<D>) {
    // A mutation may ask for a million substeps, and a step of an implicit integrator costs as much as hundreds of explicit ones.
    let explicit = ["explicit_euler", "symplectic_euler", "heun", "verlet", "runge_kutta"];
    let (most, frames) = if explicit.contains(&blueprint.integrator.kind()) { (64, 3) } else { (1, 1) };
    blueprint.time.substeps = blueprint.time.substeps.min(most);
    let Ok(mut world) = World::new(blueprint, Options { allow_unstable: true, ..Options::default() }) else { return };
    for _ in 0..frames {
        let hash = world.state_hash();
        if world.frame().is_err() {
            assert_eq!(world.state_hash(), hash, "a frame that fails is undone");
        }
        for body in world.bodies().collect::<Vec<_>>() {
            let _ = world.readings(body);
            for node in 0..world.node_count(body) as u32 {
                assert!(world.position(body, node).iter().chain(&world.velocity(body, node)).all(|x| x.is_finite()));
            }
        }
        for probe in 0..world.blueprint().probes.len() {
            let _ = world.probe(probe);
        }
    }
    let bytes = world.snapshot();
    let hash = world.state_hash();
    world.restore(&bytes).expect("its own snapshot");
    assert_eq!(world.state_hash(), hash);
}

fn survives(text: &str, overrides: Vec<(String, String)>) {
    let limits = Limits { nodes: 3_000, bodies: 200, memory_bytes: 32 << 20, ..Limits::default() };
    match read(
        text.as_bytes(),
        "fuzz.toml",
        &catalogue(),
        &Reading { limits, overrides, files: scenes::files(), ..Reading::default() },
    ) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => runs(blueprint),
        Ok((AnyBlueprint::Space(blueprint), _)) => runs(blueprint),
        Err(errors) => assert!(!errors.is_empty()),
    }
}

/// The text of a scene without contact: bodies that explode collide in every step, which takes seconds.
fn text_of(name: &str) -> String {
    let text = scenes::find(name).expect("a scene");
    let Some((before, section)) = text.split_once("[contact]") else { return text.to_string() };
    let after = section.find("\n[").map_or("", |next| &section[next + 1..]);
    format!("{before}{after}")
}

/// Scenes small enough for the limits above.
const SCENES: [&str; 14] = [
    "ball",
    "ball-as-published",
    "pressures",
    "integrators",
    "leaking-tyre",
    "two-chambers",
    "hanging-net",
    "cloth-over-ball",
    "balloons",
    "heart",
    "fish",
    "torus-tube",
    "country",
    "word",
];

/// The replacements of a number in a scene.
const NUMBERS: [&str; 18] = [
    "0", "0.0", "-0.0", "1", "-1", "2", "3", "1e-300", "5e-324", "1e-9", "1e9", "1e30", "1e150", "1e300", "-1e300",
    "100", "7", "0.5",
];

/// The ranges of numbers in a text: from a digit or sign to the character that ends it.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let inside = |c: u8| c.is_ascii_digit() || b".eE+-_".contains(&c);
    let mut out = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let begins = (bytes[at].is_ascii_digit() || bytes[at] == b'-') && at > 0 && b" [=".contains(&bytes[at - 1]);
        let end = at + bytes[at..].iter().take_while(|c| inside(**c)).count();
        if begins {
            out.push((at, end));
        }
        at = end.max(at + 1);
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn scenes_with_other_numbers(scene in 0..SCENES.len(), changes in proptest::collection::vec((any::<u16>(), 0..NUMBERS.len()), 1..4)) {
        let mut text = text_of(SCENES[scene]);
        for (place, number) in changes {
            let places = numbers(&text);
            let (from, to) = places[usize::from(place) % places.len()];
            text.replace_range(from..to, NUMBERS[number]);
        }
        survives(&text, Vec::new());
    }

    #[test]
    fn scenes_with_lines_lost_or_doubled(scene in 0..SCENES.len(), changes in proptest::collection::vec((any::<u16>(), any::<u16>(), 0..3u8), 1..4)) {
        let text = text_of(SCENES[scene]);
        let mut lines: Vec<&str> = text.lines().collect();
        for (from, to, how) in changes {
            let (from, to) = (usize::from(from) % lines.len(), usize::from(to) % lines.len());
            match how {
                0 => drop(lines.remove(from)),
                1 => lines.insert(to, lines[from]),
                _ => lines.swap(from, to),
            }
        }
        survives(&lines.join("\n"), Vec::new());
    }
}

/// Every scene with every integrator, and every scene with every model under two integrators; over all scenes, every model occurs with every
/// integrator.
#[test]
fn scenes_with_other_integrators_and_models() {
    with_other_integrators_and_models(|number| number % 5 == 0);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn scenes_with_other_integrators_and_models_whole_sweep() {
    with_other_integrators_and_models(|number| number % 5 != 0);
}

/// The combinations with selected numbers.
fn with_other_integrators_and_models(chosen: fn(usize) -> bool) {
    let known = catalogue();
    let rules = &known.integrators;
    let under = |rule: usize| vec![("integrator.kind".to_string(), rules[rule % rules.len()].kind.to_string())];
    for (k, scene) in SCENES.iter().enumerate() {
        let text = &text_of(scene);
        for rule in (0..rules.len()).filter(|rule| chosen(k + rule)) {
            survives(text, under(rule));
        }
        for (m, model) in known.models.iter().enumerate().filter(|(m, _)| chosen(k + m)) {
            let text = text.replacen("mass_spring", model.kind, 1);
            survives(&text, under(k + m));
            survives(&text, under(k + m + rules.len() / 2));
        }
    }
}
