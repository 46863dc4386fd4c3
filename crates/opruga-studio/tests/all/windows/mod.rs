//! The window as a user sees and operates it, without a screen.
#![allow(missing_docs)]
// No physics here.
#![allow(clippy::disallowed_methods)]

mod panels;
mod pointer;
use crate::screen;
mod steady;

use egui::{Event, Key, Modifiers, PointerButton, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use opruga_studio::session::Request;
use opruga_studio::shown::Severity;
use opruga_studio::words::Language;
use screen::window::{SIZE, Window};

#[test]
fn every_tool_and_menu_can_be_pressed_by_its_name() {
    let mut window = Window::open("ball", SIZE);
    for tool in ["Push", "Pin", "Move", "Draw", "Pull"] {
        window.click(tool);
    }
    window.click("Add");
    window.click("square");
    window.until("a square was added", |shown| shown.bodies.len() == 2);
    window.click("Undo");
    window.until("it was undone", |shown| shown.bodies.len() == 1 && shown.redo.is_some());
    window.click("Redo");
    window.until("it was done again", |shown| shown.bodies.len() == 2);
    window.click("Play");
    window.until("time passes", |shown| shown.playing && shown.frames > 3);
    window.click("Pause");
    window.until("time stands", |shown| !shown.playing);
    let frame = window.shown().frames;
    window.click("Step");
    window.until("one frame", |shown| shown.frames == frame + 1);
    window.click("Reset");
    window.until("the start", |shown| shown.frames == 0);
    window.click("Colour: Strain");
    window.click("Speed of nodes");
    window.until("another colour", |shown| shown.picture.legend.as_ref().is_some_and(|l| l.label == "speed"));
    window.click("Plots");
    assert!(window.harness.query_by_label("Energy [J]").is_some());
    window.click("?");
    assert!(window.harness.query_by_label_contains("play or pause").is_some());
}

#[test]
fn escape_closes_the_help_and_the_gallery() {
    let mut window = Window::open("ball", SIZE);
    window.click("?");
    assert!(window.harness.query_by_label_contains("play or pause").is_some());
    window.key(Modifiers::NONE, Key::Escape);
    window.frames(30);
    assert!(window.harness.query_by_label_contains("play or pause").is_none());
    let card =
        |window: &Window| window.harness.query_by_role_and_label(egui::Role::Button, "ball-as-published").is_some();
    window.click("Scenes");
    window.frames(5);
    assert!(card(&window));
    window.key(Modifiers::NONE, Key::Escape);
    window.frames(30);
    assert!(!card(&window));
    assert_eq!(window.shown().name, "ball");
}

#[test]
fn parameters_models_and_integrators_change_on_the_running_body() {
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Step);
    window.until("it moves", |shown| shown.frames == 1);
    window.harness.get_by_role_and_label(egui::Role::Slider, "stiffness [N/m]").focus();
    window.frames(1);
    window.key(Modifiers::NONE, Key::ArrowRight);
    window
        .until("another stiffness", |shown| shown.bodies[0].models[0].number("stiffness").is_some_and(|k| k != 1600.0));
    window.harness.get_by_label("Add a model").scroll_to_me();
    window.frames(30);
    window.click("Add a model");
    window.harness.get_by_label("drag").scroll_to_me();
    window.frames(30);
    window.click("drag");
    window.until("another model", |shown| shown.bodies[0].models.len() == 4);
    assert_eq!(window.shown().frames, 1, "on the body as it is");
    window.click("Undo");
    window.until("undone", |shown| shown.bodies[0].models.len() == 3);
}

#[test]
fn two_configurations_stand_side_by_side_and_only_the_right_one_is_changed() {
    let mut window = Window::open("ball", SIZE);
    for _ in 0..30 {
        window.studio().ask(Request::Step);
    }
    window.until("thirty frames", |shown| shown.frames == 30);
    window.click("Side by side");
    window.until("two scenes", |shown| shown.beside.is_some() && shown.frames == 30);
    window.click("Right only");
    window.harness.get_by_role_and_label(egui::Role::Slider, "stiffness [N/m]").focus();
    window.frames(1);
    let right = |beside: &opruga_studio::shown::Beside| beside.right.bodies[0].models[0].number("stiffness");
    let mut before = 1600.0;
    for _ in 0..4 {
        window.key(Modifiers::NONE, Key::ArrowLeft);
        window.until("a softer one on the right", |shown| {
            shown.frames == 30 && shown.beside.as_ref().and_then(right).is_some_and(|k| k < before)
        });
        before = window.shown().beside.as_ref().and_then(right).expect("a right side");
    }
    let shown = window.shown();
    assert_eq!(shown.bodies[0].models[0].number("stiffness"), Some(1600.0), "the left one stays");
    assert!(shown.beside.as_ref().and_then(|b| b.distances).is_some_and(|[mean, _]| mean > 0.0));
    window.click("Plots");
    assert!(window.harness.query_by_label("Distance between the sides [m]").is_some());
    window.click("Plots");
    // The right side is pulled in the same way as the left one.
    let right = egui::pos2(window.canvas().right() - 0.25 * window.canvas().width(), window.canvas().center().y);
    let half = Vec2::new(0.5 * window.canvas().width(), 0.0);
    let there = window.shown().beside.as_ref().map(|beside| beside.right.picture.bodies[0].positions[9]);
    let top = window.studio().on_screen(there.expect("a right side")).expect("in sight") + half;
    window.drag(
        &[top, top + Vec2::new(20.0, -30.0), top + Vec2::new(40.0, -60.0)],
        PointerButton::Primary,
        Modifiers::NONE,
    );
    window.until("a pull of both", |shown| shown.recorded == 1);
    // The pull, and the last difference.
    window.click("Undo");
    window.until("no pull", |shown| shown.recorded == 0);
    window.click("Undo");
    window.click("Reset");
    window.until("the start", |shown| shown.recorded == 0 && shown.frames == 0);
    for _ in 0..30 {
        window.studio().ask(Request::Step);
    }
    window.until("thirty frames again", |shown| shown.frames == 30);
    // A press that arrives at the same moment as the movement to it does not move the view.
    let ball = window.shown().picture.bodies[0].positions[0];
    let before = window.studio().on_screen(ball);
    window.harness.event(Event::PointerMoved(right - Vec2::new(150.0, 150.0)));
    let pressed = |pressed| Event::PointerButton {
        pos: right - Vec2::new(150.0, 150.0),
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    window.harness.event(pressed(true));
    window.frames(1);
    window.harness.event(pressed(false));
    window.frames(1);
    assert_eq!(window.studio().on_screen(ball), before);
    window.click("Fit");
    window.rest();
    window.picture().assert_like("beside");
    window.click("Side by side");
    window.until("one scene", |shown| shown.beside.is_none());
}

#[test]
fn on_a_phone_held_upright_everything_fits_and_the_properties_are_in_a_drawer() {
    let size = [390.0, 780.0];
    let mut window = Window::open("ball", size);
    assert!(window.harness.query_by_label("stiffness [N/m]").is_none(), "the drawer is closed");
    window.click("Properties");
    window.frames(10);
    let labels =
        ["Play", "Step", "Reset", "Replay", "Pull", "Draw", "Focus", "Properties", "Side by side", "Plots", "?"];
    for label in labels {
        let rect = window.harness.get_by_label(label).rect();
        let inside = rect.left() >= 0.0 && rect.right() <= size[0] && rect.top() >= 0.0 && rect.bottom() <= size[1];
        assert!(inside, "{label}: {rect:?}");
    }
    let sliders: Vec<egui::Rect> = window.harness.get_all_by_role(egui::Role::Slider).map(|s| s.rect()).collect();
    assert!(sliders.len() >= 3 && sliders.iter().all(|rect| rect.right() <= size[0] + 1.0), "{sliders:?}");
    window.harness.get_by_role_and_label(egui::Role::Slider, "stiffness [N/m]").focus();
    window.frames(1);
    window.key(Modifiers::NONE, Key::ArrowRight);
    window.until("a stiffness from the drawer", |shown| {
        shown.bodies[0].models[0].number("stiffness").is_some_and(|k| k != 1600.0)
    });
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("undone", |shown| shown.bodies[0].models[0].number("stiffness") == Some(1600.0));
    window.rest();
    window.picture().assert_like("phone");
}

#[test]
fn every_overlay_and_every_map_of_colours_can_be_chosen_by_its_name() {
    let mut window = Window::open("hanging-net", SIZE);
    for label in ["Contact forces", "Normals", "Velocities", "Vertices"] {
        window.click("Show");
        window.click(label);
        window.key(Modifiers::NONE, Key::Escape);
        window.studio().ask(Request::Step);
        window.frames(4);
    }
    window.until("arrows", |shown| !shown.picture.arrows.is_empty() && shown.picture.bodies[0].nodes_drawn);
    for (label, map) in [
        ("Blue to yellow, for red-green blindness", opruga::draw::ColourMap::Cividis),
        ("Grey, without colours", opruga::draw::ColourMap::Grey),
        ("Violet to yellow", opruga::draw::ColourMap::Viridis),
    ] {
        window.harness.get_by_label_contains("Colour: ").click();
        window.frames(3);
        window.click(label);
        window.until(label, |shown| shown.picture.legend.as_ref().is_some_and(|legend| legend.map == map));
    }
}

#[test]
fn the_gallery_shows_a_picture_of_every_scene_and_opens_one() {
    let mut window = Window::open("ball", SIZE);
    window.click("Scenes");
    window.frames(5);
    window.harness.get_by_role_and_label(egui::Role::Button, "ball-as-published").click();
    window.until("another scene", |shown| shown.name == "ball-as-published");
}

#[test]
fn numbers_and_their_units_stay_on_one_line_however_narrow_the_window_is() {
    for wide in [360.0, 390.0, 420.0, 450.0] {
        let mut window = Window::open("ball", [wide, 844.0]);
        window.click("Hrvatski");
        for unit in ["FPS", " ms", "stvarno vrijeme", "čvorova", "koraka/s", "granica stabilnosti"] {
            let told = |said: &str| said.ends_with(unit) || said.starts_with(&format!("korak / {unit}:"));
            let mut texts = window.harness.query_all_by_role(egui::Role::Label);
            let place = texts.find(|node| {
                let node = node.accesskit_node();
                node.label().or_else(|| node.value()).is_some_and(|said| told(&said))
            });
            let place = place.map(|node| node.rect());
            let place = place.unwrap_or_else(|| panic!("{unit} is shown"));
            assert!(place.height() < 22.0 && place.right() <= wide, "{wide}: {unit} at {place:?}");
        }
    }
}

/// A second line would take the space of the curve.
#[test]
fn names_of_curves_stay_on_one_line_where_many_of_them_stand_side_by_side() {
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Step);
    window.click("Side by side");
    window.until("two scenes", |shown| shown.beside.is_some() && shown.frames == 1);
    window.click("Plots");
    window.frames(3);
    let place = window.harness.get_by_label_contains("Volume and pressure: ball").rect();
    assert!(place.height() < 22.0, "{place:?}");
}

#[test]
fn a_window_without_size_a_crowd_and_a_phone_are_shown_without_harm() {
    for size in [[1.0, 1.0], [4.0, 900.0], [360.0, 740.0], [3000.0, 40.0]] {
        let mut window = Window::open("two-chambers", size);
        window.studio().ask(Request::Step);
        window.frames(4);
        assert_eq!(window.shown().dimension, 2);
    }
    let mut window = Window::open("thousand-balls", SIZE);
    window.until("the crowd", |shown| shown.bodies.len() >= 1000);
    window.picture();
}

#[test]
fn a_parameter_without_effect_cannot_be_pressed_until_it_has_one() {
    let mut window = Window::open("ball", [1280.0, 1600.0]);
    let sliders = |window: &Window, name: &str| -> Vec<bool> {
        let all = window.harness.query_all_by_role_and_label(egui::Role::Slider, name);
        all.map(|node| node.accesskit_node().is_disabled()).collect()
    };
    assert_eq!(sliders(&window, "gamma"), [true], "gas at one temperature knows no ratio of heat capacities");
    let word = opruga::core::spec::Value::Text("adiabatic".into());
    window.studio().ask(Request::Set("body.ball.models.1.process".into(), word));
    window.until("another process", |shown| shown.bodies[0].models[1].text("process") == Some("adiabatic"));
    assert_eq!(sliders(&window, "gamma"), [false]);
}

#[test]
fn a_hundred_thousand_vertices_are_drawn_with_no_more_triangles_than_can_be_seen() {
    let mut window = Window::open("giant-ring", SIZE);
    assert_eq!(window.shown().picture.bodies[0].positions.len(), 100_000);
    window.frames(2);
    let output = window.harness.output();
    let corners = |primitive: egui::epaint::ClippedPrimitive| match primitive.primitive {
        egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
        egui::epaint::Primitive::Callback(_) => 0,
    };
    let drawn = window.harness.ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
    let count: usize = drawn.into_iter().map(corners).sum();
    assert!(count < 30_000, "{count} corners");
}

#[test]
fn every_word_has_letters_to_be_drawn_with_and_languages_change() {
    let mut window = Window::open("ball", SIZE);
    window.click("Hrvatski");
    assert_eq!(window.studio().language, Language::Croatian);
    assert!(window.harness.query_by_label("Pokreni").is_some());
    // A character that no font has ends the test: kittest ensures that.
    for name in ["Grafovi", "?", "Vuci"] {
        window.click(name);
    }
    window.click("English");
    assert!(window.harness.query_by_label("Play").is_some());
}

/// The words that remain without names, symbols and numbers, among which English ones would be found.
const ENGLISH: [&str; 14] = [
    "stiffness",
    "damping",
    "volume",
    "pressure ",
    "edges",
    "boundary",
    "isothermal",
    "mass spring",
    "bending",
    "friction",
    "nodes",
    "vertices",
    "the ",
    "step ",
];

#[test]
fn in_croatian_no_name_of_a_model_or_parameter_and_no_message_of_the_studio_is_english() {
    let mut window = Window::open("ball", [1280.0, 2400.0]);
    window.click("Hrvatski");
    window.click("Prepreka: poluprostor");
    window.click("Oblik: kružnica");
    window.frames(30);
    for name in ["krutost [N/m]", "opruge", "tlak plina", "trenje", "brzina mirovanja [m/s]", "vrhovi"] {
        assert!(window.harness.query_all_by_label_contains(name).next().is_some(), "{name} is shown");
    }
    let told = |window: &Window| -> Vec<String> {
        let all = window.harness.query_all_by(|_| true);
        let said = all.filter_map(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value()));
        // Parts that belong together are kept on one line.
        said.map(|text| text.replace('\u{a0}', " ")).collect()
    };
    let english = |window: &Window| -> Vec<String> {
        told(window).into_iter().filter(|text| ENGLISH.iter().any(|word| text.contains(word))).collect()
    };
    assert!(told(&window).len() > 60, "the labels are read");
    assert_eq!(english(&window), Vec::<String>::new());
    // Errors of the world, and reports of the studio about a change, an undo, and a file.
    window.studio().ask(Request::Set("time.substeps".into(), opruga::core::spec::Value::Integer(1)));
    window.until("a refusal", |shown| shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused));
    assert!(told(&window).iter().any(|text| text.to_lowercase().starts_with("korak h = ")), "{:?}", told(&window));
    assert_eq!(english(&window), Vec::<String>::new());
    window.studio().ask(Request::Step);
    window.studio().ask(Request::Set("body.ball.models.0.stiffness".into(), opruga::core::spec::Value::Number(1500.0)));
    window.studio().ask(Request::Undo);
    window.until("undone", |shown| shown.message.as_ref().is_some_and(|m| m.text.starts_with("Undone")));
    assert!(told(&window).iter().any(|text| text.starts_with("Poništeno: krutost")), "{:?}", told(&window));
    window.studio().ask(Request::Compare(true));
    let slower = opruga_studio::differences::Difference::Set(
        "body.ball.models.0.stiffness".into(),
        opruga::core::spec::Value::Number(900.0),
    );
    window.studio().ask(Request::Differ(slower));
    window.until("two sides", |shown| shown.beside.as_ref().is_some_and(|beside| beside.differences.len() == 1));
    assert_eq!(english(&window), Vec::<String>::new());
}

#[test]
fn the_window_looks_as_it_did_in_the_plane() {
    let mut window = Window::open("ball", SIZE);
    for _ in 0..40 {
        window.studio().ask(Request::Step);
    }
    window.until("forty frames", |shown| shown.frames == 40);
    // Reports about the speed of the machine differ from run to run.
    window.studio().ask(Request::Reset);
    window.until("the start", |shown| shown.frames == 0 && shown.latest == 0);
    window.rest();
    let message = window.shown().message.clone();
    assert!(message.is_none_or(|m| m.severity == Severity::Done));
    window.picture().assert_like("plane");
    window.click("Light");
    window.frames(30);
    window.picture().assert_like("plane-light");
}

#[test]
fn the_window_looks_as_it_did_in_space_and_bodies_are_pulled_there_too() {
    let mut window = Window::open("balloons", SIZE);
    window.rest();
    window.picture().assert_like("space");
    let canvas = window.canvas();
    // There is a balloon somewhere in the middle row.
    let mut pulled = false;
    for k in 1..20 {
        let at = egui::pos2(canvas.left() + canvas.width() * k as f32 / 20.0, canvas.center().y);
        window.pointer(at);
        window.button(at, PointerButton::Primary, true, Modifiers::NONE);
        window.pointer(at + Vec2::new(5.0, -30.0));
        // The step follows the press: once it is done, the press was handled.
        let next = window.shown().frames + 1;
        window.studio().ask(Request::Step);
        window.until("a step", |shown| shown.frames == next);
        pulled |= window.shown().pulls.len() == 1;
        window.button(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    assert!(pulled);
}
