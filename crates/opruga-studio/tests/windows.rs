//! The window, pressed and looked at as a person does, without a screen.
#![allow(missing_docs)]
// No physics here.
#![allow(clippy::disallowed_methods)]

mod screen;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use opruga_studio::session::Request;
use opruga_studio::shown::Severity;
use opruga_studio::words::Language;
use screen::window::{SIZE, Window, top_of};

#[test]
fn the_ball_is_pulled_by_the_pointer_and_a_rubber_line_shows_the_force() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    window.pointer(top);
    window.button(top, PointerButton::Primary, true, Modifiers::NONE);
    window.pointer(top + Vec2::new(60.0, -40.0));
    for _ in 0..6 {
        window.click("Step");
        window.harness.event(Event::PointerMoved(top + Vec2::new(60.0, -40.0)));
    }
    // Pressing a button of the window has let the ball go: it is recorded from its beginning to its end.
    window.until("a pull was recorded", |shown| shown.recorded == 1 && shown.frames >= 6);
    let mut window = Window::open("ball", SIZE);
    window.pointer(top);
    window.button(top, PointerButton::Primary, true, Modifiers::NONE);
    window.pointer(top + Vec2::new(60.0, -40.0));
    for _ in 0..12 {
        window.studio().ask(Request::Step);
    }
    window.until("the pull acts", |shown| shown.pulls.len() == 1 && shown.frames == 12);
    let [_, pointer, force] = window.shown().pulls[0];
    let newtons = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    assert!(newtons > 0.1 && pointer[0] > 0.2 && pointer[1] > 2.5, "{pointer:?} {force:?}");
    window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    window.studio().ask(Request::Step);
    window.until("it was let go", |shown| shown.pulls.is_empty() && shown.frames == 13);
}

/// A screen that draws seldom takes in a press together with the way that the pointer went since.
#[test]
fn a_body_is_held_where_it_was_pressed_however_far_the_pointer_has_gone_until_the_next_picture() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    let far = top + Vec2::new(240.0, -60.0);
    window.pointer(top + Vec2::new(0.0, 200.0));
    let press =
        Event::PointerButton { pos: top, button: PointerButton::Primary, pressed: true, modifiers: Modifiers::NONE };
    window.harness.input_mut().events.extend([Event::PointerMoved(top), press, Event::PointerMoved(far)]);
    window.frames(2);
    window.studio().ask(Request::Step);
    window.studio().ask(Request::Step);
    window.until("the ball is held", |shown| shown.pulls.len() == 1 && shown.frames == 2);
    window.button(far, PointerButton::Primary, false, Modifiers::NONE);
    window.until("it is let go", |shown| shown.recorded == 1);
}

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
fn outlines_become_bodies_and_those_that_cross_themselves_are_refused_with_a_reason() {
    let mut window = Window::open("ball", SIZE);
    window.key(Modifiers::NONE, Key::Num5);
    let middle = window.canvas().center() + Vec2::new(180.0, 60.0);
    let line = |of: &dyn Fn(f32) -> Vec2| -> Vec<Pos2> {
        (0..80).map(|k| middle + of(k as f32 / 80.0 * std::f32::consts::TAU)).collect()
    };
    window.drag(&line(&|t| 70.0 * Vec2::new(t.cos(), 0.7 * t.sin())), PointerButton::Primary, Modifiers::NONE);
    window.until("a drawn body", |shown| shown.bodies.len() == 2 && shown.bodies[1].name == "drawn");
    window.drag(&line(&|t| 70.0 * Vec2::new(t.sin(), (2.0 * t).sin())), PointerButton::Primary, Modifiers::NONE);
    assert!(window.harness.query_by_label_contains("crosses itself").is_some());
    assert_eq!(window.shown().bodies.len(), 2);
}

#[test]
fn pins_pushes_and_moves_are_done_by_the_pointer_and_written_down() {
    let mut window = Window::open("ball", SIZE);
    let top = top_of(&window);
    window.drag(&[top], PointerButton::Primary, Modifiers::SHIFT);
    window.until("a pin", |shown| shown.pins.len() == 1);
    for _ in 0..2 {
        window.button(top, PointerButton::Primary, true, Modifiers::NONE);
        window.button(top, PointerButton::Primary, false, Modifiers::NONE);
    }
    window.until("no pin", |shown| shown.pins.is_empty());
    window.key(Modifiers::COMMAND, Key::Z);
    window.studio().ask(Request::Reset);
    window.until("the start", |shown| shown.frames == 0 && shown.recorded == 0);
    window.click("Move");
    let there = top + Vec2::new(80.0, 0.0);
    window.drag(&[top, top + Vec2::new(40.0, 0.0), there], PointerButton::Primary, Modifiers::NONE);
    window.until("it was moved", |shown| shown.picture.bodies[0].positions[9][0] > 0.2);
    assert_eq!(window.shown().recorded, 0, "at the start it is written into the scene");
}

#[test]
fn a_selected_body_is_turned_and_scaled_by_its_handles_copied_and_looked_at() {
    let mut window = Window::open("ball", SIZE);
    window.click("Move");
    let shown = window.shown();
    let spots: Vec<Pos2> =
        shown.picture.bodies[0].positions.iter().filter_map(|p| window.studio().on_screen(*p)).collect();
    let around = egui::Rect::from_points(&spots).expand(8.0);
    // The corner of the box goes half as far again from its middle.
    let corner = around.right_bottom();
    let out = around.center() + 1.5 * (corner - around.center());
    window.drag(&[corner, corner + Vec2::splat(3.0), out], PointerButton::Primary, Modifiers::NONE);
    let width = |shown: &opruga_studio::shown::Shown| {
        let xs = shown.picture.bodies[0].positions.iter().map(|p| p[0]);
        xs.clone().fold(f64::MIN, f64::max) - xs.fold(f64::MAX, f64::min)
    };
    window.until("it has grown", |shown| (width(shown) - 1.5).abs() < 0.02);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("undone", |shown| (width(shown) - 1.0).abs() < 0.02);
    // The handle above the box, to the right of it: a quarter of a turn.
    let node = |shown: &opruga_studio::shown::Shown| shown.picture.bodies[0].positions[0];
    let (before, handle) = (node(&window.shown()), around.center_top() - Vec2::new(0.0, 24.0));
    let right = around.center() + Vec2::new(around.center().y - handle.y, 0.0);
    window.drag(&[handle, handle + Vec2::splat(4.0), right], PointerButton::Primary, Modifiers::NONE);
    window.until("it was turned", |shown| {
        let now = node(shown);
        // Clockwise as it is seen: what was on the right is below.
        (now[0] - (before[1] - 2.0)).abs() < 0.03 && (now[1] - 2.0 + before[0]).abs() < 0.03
    });
    window.harness.get_by_label("Duplicate").scroll_to_me();
    window.frames(30);
    window.click("Duplicate");
    window.until("two of them", |shown| shown.bodies.len() == 2);
    let apart = |window: &Window| {
        let at = |p: [f64; 3]| window.studio().on_screen(p).expect("in sight");
        at([0.5, 2.0, 0.0]).distance(at([-0.5, 2.0, 0.0]))
    };
    window.frames(2);
    let before = apart(&window);
    window.click("Focus");
    assert!(apart(&window) > 1.2 * before, "the body fills the window");
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
    assert!(window.harness.query_by_label("Distance of the sides [m]").is_some());
    window.click("Plots");
    // The right one is pulled as the left one is.
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
    window.click("Undo");
    window.click("Reset");
    window.until("the start", |shown| shown.recorded == 0 && shown.frames == 0);
    for _ in 0..30 {
        window.studio().ask(Request::Step);
    }
    window.until("thirty frames again", |shown| shown.frames == 30);
    // A press that comes in the same moment as the way to it does not take the view along.
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
fn a_pin_of_the_scene_is_freed_by_a_double_click() {
    let mut window = Window::open("hanging-net", SIZE);
    let shown = window.shown();
    let (node, count) = (shown.picture.bodies[0].pinned[0], shown.picture.bodies[0].pinned.len());
    let at = window.studio().on_screen(shown.picture.bodies[0].positions[node as usize]).expect("in sight");
    for _ in 0..2 {
        window.button(at, PointerButton::Primary, true, Modifiers::NONE);
        window.button(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    window.studio().ask(Request::Step);
    window.until("one pin fewer", |shown| shown.picture.bodies[0].pinned.len() == count - 1);
    assert!(!window.shown().picture.bodies[0].pinned.contains(&node));
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
    // A letter that no font can draw ends the test: kittest sees to that.
    for name in ["Grafovi", "?", "Vuci"] {
        window.click(name);
    }
    window.click("English");
    assert!(window.harness.query_by_label("Play").is_some());
}

/// What is left when names, symbols and numbers are taken away: words of which English ones would be found.
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
        all.filter_map(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value())).collect()
    };
    let english = |window: &Window| -> Vec<String> {
        told(window).into_iter().filter(|text| ENGLISH.iter().any(|word| text.contains(word))).collect()
    };
    assert!(told(&window).len() > 60, "the labels are read");
    assert_eq!(english(&window), Vec::<String>::new());
    // What the world refuses, what the studio says of a change, of an undo, and of a file.
    window.studio().ask(Request::Set("time.substeps".into(), opruga::core::spec::Value::Integer(1)));
    window.until("a refusal", |shown| shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused));
    assert!(told(&window).iter().any(|text| text.starts_with("Korak h = ")), "{:?}", told(&window));
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
    // What the machine says of its speed differs from run to run.
    window.studio().ask(Request::Reset);
    window.until("the start", |shown| shown.frames == 0 && shown.latest == 0);
    window.rest();
    let message = window.shown().message.clone();
    assert!(message.is_none_or(|m| m.severity == Severity::Told));
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
    // Somewhere on the middle row there is a balloon.
    let mut pulled = false;
    for k in 1..20 {
        let at = egui::pos2(canvas.left() + canvas.width() * k as f32 / 20.0, canvas.center().y);
        window.pointer(at);
        window.button(at, PointerButton::Primary, true, Modifiers::NONE);
        window.pointer(at + Vec2::new(5.0, -30.0));
        // The step comes after the press: once it is done, the press was heard.
        let next = window.shown().frames + 1;
        window.studio().ask(Request::Step);
        window.until("a step", |shown| shown.frames == next);
        pulled |= window.shown().pulls.len() == 1;
        window.button(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    assert!(pulled);
}
