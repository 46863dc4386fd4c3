//! The menu of shapes that become bodies.

use crate::session::{Edit, Request};
use crate::shown::Shown;
use crate::words::Language;
use egui::Ui;
use toml_edit::{InlineTable, Value};

/// A sample body: its name, shape, mass and models.
type Sample = (fn(Language) -> &'static str, &'static str, f64, &'static str);

const GAS: &str = "{ kind = \"mass_spring\", stiffness = 1600.0, damping = 1.0 }, { kind = \"pressure\", nRT = 40.0 }, \
                   { kind = \"bending\", stiffness = 0.02 }";
/// The springs of a lattice. Without the springs along the diagonals (`edges = "shear"`), nothing would prevent the cells from folding flat.
const JELLY: &str = "{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5, edges = \"shear\" }";
const ROPE: &str = "{ kind = \"mass_spring\", stiffness = 800.0, damping = 0.5 }";
const BALLOON: &str =
    "{ kind = \"mass_spring\", modulus = 300.0, damping = 0.02 }, { kind = \"pressure\", nRT = 40.0 }";
const CLOTH: &str = "{ kind = \"mass_spring\", modulus = 60.0, damping = 0.02 }";

/// Bodies in the plane.
const PLANE: [Sample; 6] = [
    (Language::of_ball, "{ kind = \"ring\", radius = 0.4, vertices = 36 }", 0.6, GAS),
    (
        Language::of_square,
        "{ kind = \"regular_polygon\", sides = 4, vertices_per_side = 9, radius = 0.5, start_angle = 0.785398 }",
        0.6,
        GAS,
    ),
    (
        Language::of_triangle,
        "{ kind = \"regular_polygon\", sides = 3, vertices_per_side = 12, radius = 0.5, start_angle = 1.570796 }",
        0.6,
        GAS,
    ),
    (Language::of_jelly, "{ kind = \"grid\", size = [0.8, 0.6], cells = [8, 6] }", 0.8, JELLY),
    (Language::of_rope, "{ kind = \"line\", from = [0.0, 0.0], to = [1.2, 0.0], segments = 30 }", 0.2, ROPE),
    (Language::of_big_ball, "{ kind = \"ring\", radius = 0.8, vertices = 72 }", 1.5, GAS),
];

/// Bodies in space.
const SPACE: [Sample; 4] = [
    (Language::of_balloon, "{ kind = \"icosphere\", radius = 0.4, subdivisions = 3 }", 0.4, BALLOON),
    (
        Language::of_tube,
        "{ kind = \"torus\", radius = 0.5, tube_radius = 0.16, nodes_around = 32, nodes_of_tube = 12 }",
        0.4,
        BALLOON,
    ),
    (
        Language::of_cloth,
        "{ kind = \"sheet\", u = [1.2, 0.0, 0.0], v = [0.0, 0.0, 1.2], cells = [16, 16] }",
        0.3,
        CLOTH,
    ),
    (Language::of_jelly, "{ kind = \"grid\", size = [0.6, 0.6, 0.6], cells = [5, 5, 5] }", 0.8, JELLY),
];

/// Shows the menu of shapes. A chosen shape is placed at the point `at`, or near it if there is no space.
pub fn menu(ui: &mut Ui, shown: &Shown, words: Language, at: [f64; 3], asks: &mut Vec<Request>) {
    let samples: &[Sample] = if shown.dimension == 3 { &SPACE } else { &PLANE };
    ui.menu_button(words.add(), |ui| {
        for sample in samples {
            if ui.button(sample.0(words)).on_hover_text(words.add_hint()).clicked() {
                if let Some(table) = table(sample, words) {
                    asks.push(Request::Edit(Edit::Drop(table, at)));
                }
                ui.close();
            }
        }
    });
}

/// The table of a sample.
fn table(sample: &Sample, words: Language) -> Option<InlineTable> {
    let (name, shape, mass, models) = sample;
    let text = format!("{{ name = \"{}\", shape = {shape}, mass = {mass}, models = [{models}] }}", name(words));
    text.parse::<Value>().ok()?.as_inline_table().cloned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::draw::{BodyPicture, Facets};

    #[test]
    fn every_shape_of_the_palette_is_a_body_that_can_be_added_to_a_scene() {
        for (scene, samples) in [("ball", &PLANE[..]), ("balloons", &SPACE[..])] {
            let languages = [Language::English, Language::Croatian];
            for (sample, words) in samples.iter().flat_map(|sample| languages.map(|words| (sample, words))) {
                let text = opruga::scenes::find(scene).expect("a scene");
                let files = opruga::scenes::files();
                let mut session = crate::session::Session::open(scene, text, files, crate::setting::Setting::default())
                    .expect("opens");
                session.handle(Request::Step);
                session.handle(Request::Edit(Edit::Drop(table(sample, words).expect("a table"), [2.0, 3.0, 0.5])));
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

    /// The volume within a closed surface, the area within a closed outline or of an open surface, or the length of a line.
    fn enclosed(body: &BodyPicture) -> f64 {
        let at = |node: u32| body.positions[node as usize];
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let minus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|d| a[d] - b[d]);
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        match &body.facets {
            Facets::Edges(edges) if !edges.is_empty() => {
                edges.iter().map(|[a, b]| 0.5 * cross(at(*a), at(*b))[2]).sum::<f64>().abs()
            }
            Facets::Triangles(triangles) if !triangles.is_empty() => {
                let normal = |[a, b, c]: [u32; 3]| cross(minus(at(b), at(a)), minus(at(c), at(a)));
                let area: f64 = triangles.iter().map(|corners| 0.5 * size(normal(*corners))).sum();
                let part =
                    |corners: &[u32; 3]| (0..3).map(|d| at(corners[0])[d] * normal(*corners)[d]).sum::<f64>() / 6.0;
                let volume = triangles.iter().map(part).sum::<f64>().abs();
                // The volume of a flat sheet is nearly zero, wherever it is.
                if body.label.starts_with("cloth") { area } else { volume }
            }
            _ => body.segments.iter().map(|[a, b]| size(minus(at(*a), at(*b)))).sum(),
        }
    }

    #[test]
    fn every_shape_of_the_palette_keeps_most_of_what_it_encloses_while_it_falls_and_lies() {
        for (scene, samples) in [("ball", &PLANE[..]), ("balloons", &SPACE[..])] {
            let text = opruga::scenes::find(scene).expect("a scene");
            let mut session =
                crate::session::Session::open(scene, text, opruga::scenes::files(), crate::setting::Setting::default())
                    .expect("opens");
            for sample in samples {
                session.handle(Request::Edit(Edit::Drop(
                    table(sample, Language::English).expect("a table"),
                    [0.0, 1.0, 0.0],
                )));
            }
            let shown = session.shown();
            let added = shown.bodies.len() - samples.len();
            let bodies = |session: &mut crate::session::Session| -> Vec<(String, f64)> {
                let shown = session.shown();
                let seen = shown.bodies.iter().zip(&shown.picture.bodies).skip(added);
                seen.map(|(body, seen)| {
                    (body.name.clone(), enclosed(&BodyPicture { label: body.name.clone(), ..seen.clone() }))
                })
                .collect()
            };
            let before = bodies(&mut session);
            assert_eq!(before.len(), samples.len(), "{:?}", shown.message);
            let frames = (5.0 / shown.frame).round() as u64;
            for _ in 0..frames {
                session.handle(Request::Step);
            }
            assert_eq!(session.frames(), frames, "{:?}", session.shown().message);
            for ((name, before), (_, after)) in before.iter().zip(bodies(&mut session)) {
                assert!(*before > 0.0 && after > 0.7 * before, "{name}: {before} became {after}");
            }
        }
    }
}
