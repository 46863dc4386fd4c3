//! Fields that have no effect together with the others are reported, with what they require.

use crate::common;
use common::*;
use opruga::catalogue;
use opruga::core::spec::{Allowed, Condition, Spec};
use opruga::io::scene;
use opruga::world::schema;

/// The notices of a scene: code and message.
fn notices(text: &str) -> Vec<(&'static str, String)> {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    match scene::read(text.as_bytes(), "test.toml", &catalogue(), &options) {
        Ok((_, notices)) => notices.into_iter().map(|notice| (notice.about.code, notice.about.message)).collect(),
        Err(errors) => panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

#[test]
fn a_field_that_another_switches_off_is_told_of_with_what_it_needs() {
    let body = |shape: &str, rest: &str, model: &str| {
        format!("[[body]]\nname = \"b\"\nshape = {shape}\ndensity = 1000.0\n{rest}\nmodels = [{{ {model} }}]\n")
    };
    let square = "{ kind = \"grid\", size = [1, 1], cells = [2, 2] }";
    let ring = "{ kind = \"ring\", radius = 0.5, vertices = 12 }";
    let fem = "kind = \"fem\", youngs_modulus = 1e5";
    let explicit = head(0.01, 10, 0.0, "verlet");
    let statics = head(0.01, 1, 0.0, "equilibrium");
    let obstacle = |fields: &str| {
        explicit.clone() + &format!("[[collider]]\nkind = \"ball\"\nradius = 1.0\ncenter = [9, 0]\n{fields}\n")
    };
    let contact = |fields: &str| explicit.clone() + &format!("[contact]\n{fields}\n");
    let cases = [
        (
            explicit.clone() + &body(square, "", &format!("{fem}, mooney_share = 0.3")),
            Some("if `material` is \"mooney_rivlin\""),
        ),
        (
            explicit.clone() + &body(square, "", &format!("{fem}, material = \"mooney_rivlin\", mooney_share = 0.3")),
            None,
        ),
        (explicit.clone() + &body(square, "tetrahedra_per_hexahedron = 5", fem), Some("in 3D")),
        (
            explicit.clone() + &body(ring, "thickness = 1.0", "kind = \"pressure\", nRT = 1.0, gamma = 1.2"),
            Some("if `process` is \"adiabatic\""),
        ),
        (
            explicit.clone()
                + &body(
                    ring,
                    "thickness = 1.0",
                    "kind = \"pressure\", nRT = 1.0, gamma = 1.2, process = \"adiabatic\"",
                ),
            None,
        ),
        (
            statics.replace("\"equilibrium\"", "\"equilibrium\"\narc_length = 0.1\nload_steps = 3")
                + &body(square, "", fem),
            Some("without `arc_length`"),
        ),
        (statics.replace("\"equilibrium\"", "\"equilibrium\"\nload_steps = 3") + &body(square, "", fem), None),
        (obstacle("pivot = [0, 0]") + &body(square, "", fem), Some("with `spin`")),
        (obstacle("pivot = [0, 0]\nspin = 1.0") + &body(square, "", fem), None),
        (obstacle("rest_speed = 0.1") + &body(square, "", fem), Some("if `restitution` is not 0")),
        (obstacle("rest_speed = 0.1\nrestitution = 0.5") + &body(square, "", fem), None),
        (explicit.clone() + &body(square, "contact = { group = \"a\" }", fem), Some("in a scene with `[contact]`")),
        (contact("") + &body(square, "contact = { group = \"a\" }", fem), None),
        (contact("") + &body(square, "contact = { touch = false, friction = 0.3 }", fem), Some("with `touch`")),
        (contact("restitution = 0.5"), None),
        (contact("response = \"barrier\"\nrestitution = 0.5"), Some("if `response` is \"constraint\"")),
        (contact("reach = 0.1"), Some("if `response` is \"barrier\"")),
    ];
    for (text, expected) in cases {
        let found = notices(&text);
        let told = found.iter().find(|(code, _)| *code == "scene.no_effect");
        match (told, expected) {
            (Some((_, message)), Some(words)) => assert!(message.ends_with(words), "{message}\n{text}"),
            (None, None) => {}
            _ => panic!("{found:?}, expected {expected:?}\n{text}"),
        }
    }
}

#[test]
fn no_shipped_scene_has_a_field_without_effect() {
    for name in opruga::scenes::names() {
        let text = opruga::scenes::find(name).expect("a scene");
        let found = notices(text);
        assert!(found.iter().all(|(code, _)| *code != "scene.no_effect"), "{name}: {found:?}");
    }
}

/// A condition names another field of the same table, and values that it can have.
#[test]
fn conditions_name_fields_and_words_that_exist() {
    let catalogue = catalogue();
    let of_contact = [schema::CONTACT, schema::CONTACT_PAIR, schema::BODY_CONTACT];
    let others = [schema::SCENE, schema::TIME, schema::WORLD, schema::BODY, schema::PIN, schema::COPIES];
    let sections = others.into_iter().chain(of_contact);
    let mut specs: Vec<&Spec> = sections.map(|section| section.spec).collect();
    specs.extend(catalogue.models.iter().chain(&catalogue.integrators).chain(&catalogue.colliders));
    specs.extend(opruga::shapes::all());
    let mut conditions = 0;
    for spec in specs {
        for field in spec.fields {
            for condition in field.applies {
                conditions += 1;
                let other = |name: &str| {
                    assert_ne!(name, field.name, "{}", spec.kind);
                    spec.fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("{}: `{name}`", spec.kind))
                };
                match *condition {
                    Condition::Dimension(d) => assert!(d == 2 || d == 3),
                    Condition::Word(name, words) => {
                        let Allowed::Choice(choice) = other(name).range else { panic!("{}: `{name}`", spec.kind) };
                        assert!(words.iter().all(|word| choice.contains(word)), "{}: {words:?}", spec.kind);
                    }
                    Condition::GivenOneOf(names) => names.iter().for_each(|name| {
                        other(name);
                    }),
                    Condition::Given(name) | Condition::NotGiven(name) | Condition::NotZero(name) => {
                        other(name);
                    }
                }
            }
        }
    }
    assert!(conditions >= 10, "{conditions}");
}

#[test]
fn what_has_no_effect_and_was_set_by_nobody_is_not_written() {
    use opruga::core::spec::{Value, Values};
    use opruga::io::scene::written;
    let catalogue = opruga::catalogue();
    let spec = catalogue.models.iter().find(|spec| spec.kind == "pressure").expect("gas");
    let mut gas = Values::defaults(spec, 2);
    gas.set(spec, "nRT", Value::Number(20.0), 2).expect("allowed");
    let table = written::kind_table(&gas, 2);
    assert!(!table.contains_key("gamma") && table.contains_key("nRT") && table.contains_key("process"));
    // With another process it has an effect, and a field that the user has set is always written.
    gas.set(spec, "process", Value::Text("adiabatic".into()), 2).expect("allowed");
    assert!(written::kind_table(&gas, 2).contains_key("gamma"));
    gas.set(spec, "gamma", Value::Number(1.2), 2).expect("allowed");
    gas.set(spec, "process", Value::Text("isothermal".into()), 2).expect("allowed");
    assert!(written::kind_table(&gas, 2).contains_key("gamma"));
}
