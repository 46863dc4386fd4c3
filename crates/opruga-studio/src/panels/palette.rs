//! Shapes that become bodies.

use crate::session::{Edit, Request};
use crate::shown::Shown;
use crate::words::Language;
use egui::Ui;
use toml_edit::{InlineTable, Value};

/// Name, shape with `X`, `Y`, `Z` for its middle, mass, models.
type Sample = (fn(Language) -> &'static str, &'static str, f64, &'static str);

const GAS: &str = "{ kind = \"mass_spring\", stiffness = 1600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 40.0 }, \
                   { kind = \"bending\", stiffness = 0.02 }";
const JELLY: &str = "{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5 }";
const ROPE: &str = "{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5 }";
const BALLOON: &str =
    "{ kind = \"mass_spring\", modulus = 300.0, damping = 0.02 }, { kind = \"pressure\", nRT = 40.0 }";
const CLOTH: &str = "{ kind = \"mass_spring\", modulus = 60.0, damping = 0.02 }";

/// Bodies of the plane.
const PLANE: [Sample; 6] = [
    (Language::of_ball, "{ kind = \"ring\", radius = 0.4, vertices = 36, center = [X, Y] }", 0.6, GAS),
    (
        Language::of_square,
        "{ kind = \"regular_polygon\", sides = 4, vertices_per_side = 9, radius = 0.5, start_angle = 0.785398, center = [X, Y] }",
        0.6,
        GAS,
    ),
    (
        Language::of_triangle,
        "{ kind = \"regular_polygon\", sides = 3, vertices_per_side = 12, radius = 0.5, start_angle = 1.570796, center = [X, Y] }",
        0.6,
        GAS,
    ),
    (Language::of_jelly, "{ kind = \"grid\", size = [0.8, 0.6], cells = [8, 6], corner = [X, Y] }", 0.8, JELLY),
    (Language::of_rope, "{ kind = \"line\", from = [X, Y], to = [X1, Y], segments = 30 }", 0.2, ROPE),
    (Language::of_big_ball, "{ kind = \"ring\", radius = 0.8, vertices = 72, center = [X, Y] }", 1.5, GAS),
];

/// Bodies of space.
const SPACE: [Sample; 4] = [
    (
        Language::of_balloon,
        "{ kind = \"icosphere\", radius = 0.4, subdivisions = 3, center = [X, Y, Z] }",
        0.4,
        BALLOON,
    ),
    (
        Language::of_tube,
        "{ kind = \"torus\", radius = 0.5, tube_radius = 0.16, nodes_around = 32, nodes_of_tube = 12, center = [X, Y, Z] }",
        0.4,
        BALLOON,
    ),
    (
        Language::of_cloth,
        "{ kind = \"sheet\", corner = [X, Y, Z], u = [1.2, 0.0, 0.0], v = [0.0, 0.0, 1.2], cells = [16, 16] }",
        0.3,
        CLOTH,
    ),
    (
        Language::of_jelly,
        "{ kind = \"grid\", size = [0.6, 0.6, 0.6], cells = [5, 5, 5], corner = [X, Y, Z] }",
        0.8,
        JELLY,
    ),
];

/// The menu of shapes; they are set down in the middle of what is seen.
pub fn menu(ui: &mut Ui, shown: &Shown, words: Language, middle: [f64; 3], asks: &mut Vec<Request>) {
    let samples: &[Sample] = if shown.dimension == 3 { &SPACE } else { &PLANE };
    ui.menu_button(words.add(), |ui| {
        for sample in samples {
            if ui.button(sample.0(words)).on_hover_text(words.add_hint()).clicked() {
                if let Some(table) = table(sample, words, middle) {
                    asks.push(Request::Edit(Edit::Add(table)));
                }
                ui.close();
            }
        }
    });
}

/// The table of a sample with its middle at a point, lengths rounded to a hundredth.
fn table(sample: &Sample, words: Language, at: [f64; 3]) -> Option<InlineTable> {
    let (name, shape, mass, models) = sample;
    let name = name(words);
    let number = |x: f64| format!("{:.2}", x);
    let shape = shape.replace("X1", &number(at[0] + 1.2)).replace('X', &number(at[0]));
    let shape = shape.replace('Y', &number(at[1])).replace('Z', &number(at[2]));
    let text = format!("{{ name = \"{name}\", shape = {shape}, mass = {mass}, models = [{models}] }}");
    text.parse::<Value>().ok()?.as_inline_table().cloned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_of_the_palette_is_a_body_that_can_be_added_to_a_scene() {
        for (scene, samples) in [("ball", &PLANE[..]), ("balloons", &SPACE[..])] {
            let languages = [Language::English, Language::Croatian];
            for (sample, words) in samples.iter().flat_map(|sample| languages.map(|words| (sample, words))) {
                let text = opruga::scenes::find(scene).expect("a scene");
                let files = opruga::scenes::files();
                let mut session = crate::session::Session::open(scene, text, files, Default::default()).expect("opens");
                session.handle(Request::Step);
                session.handle(Request::Edit(Edit::Add(table(sample, words, [2.0, 3.0, 0.5]).expect("a table"))));
                session.handle(Request::Step);
                let shown = session.shown();
                assert!(
                    shown.bodies.iter().any(|body| body.name.starts_with(sample.0(words))),
                    "{}: {:?}",
                    sample.0(words),
                    shown.message
                );
            }
        }
    }
}
