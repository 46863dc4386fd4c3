//! The panels while bodies are replaced by others.

use super::screen::window::{SIZE, Window, top_of};
use egui::{Key, Modifiers, PointerButton, Role, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use opruga::core::spec::Value;
use opruga_studio::report::Report;
use opruga_studio::session::{Edit, Request};
use opruga_studio::shown::Severity;

/// So tall that scrolling is not necessary.
const TALL: [f32; 2] = [1280.0, 1600.0];

fn finer(name: &str) -> Request {
    Request::Edit(Edit::Shape(name.into(), "vertices", Value::Integer(48)))
}

#[test]
fn a_body_stays_selected_and_its_sections_open_when_it_is_set_down_anew_and_when_that_is_undone() {
    let mut window = Window::open("ball", TALL);
    window.studio().ask(Request::Step);
    window.until("it moves", |shown| shown.frames == 1);
    window.click("Shape: ring");
    window.frames(30);
    let is_open = |window: &Window| {
        window.harness.query_by_role_and_label(Role::Slider, "stiffness [N/m]").is_some()
            && window.harness.query_by_role_and_label(Role::Slider, "vertices").is_some()
    };
    assert!(is_open(&window));
    window.studio().ask(finer("ball"));
    window.until("another body", |shown| shown.bodies[0].name == "ball-2");
    window.frames(30);
    assert!(is_open(&window), "after another resolution");
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("undone", |shown| shown.bodies[0].name == "ball");
    window.frames(30);
    assert!(is_open(&window), "after undo");
    window.key(Modifiers::COMMAND, Key::D);
    window.until("two of them", |shown| shown.bodies.len() == 2);
    window.frames(30);
    let copy = window.shown().bodies[1].title.clone();
    assert!(window.harness.query_by_label(&copy).is_some(), "the copy {copy} is selected");
}

#[test]
fn substeps_that_are_too_few_leave_those_from_before_and_not_what_the_hand_has_passed() {
    let mut window = Window::open("ball", TALL);
    let rect = window.harness.get_by_role_and_label(Role::Slider, "Substeps").rect();
    let at = |x: f32| egui::pos2(rect.left() + x, rect.center().y);
    let way: Vec<egui::Pos2> = (0..=20).map(|k| at(110.0 - 6.0 * k as f32)).collect();
    window.drag(&way, PointerButton::Primary, Modifiers::NONE);
    window.until("a refusal", |shown| shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused));
    window.frames(3);
    let shown = window.shown();
    assert_eq!((shown.substeps, shown.undo.is_none()), (32, true));
    let node = window.harness.get_by_role_and_label(Role::Slider, "Substeps");
    assert_eq!(node.accesskit_node().numeric_value(), Some(32.0));
    // Only the value at the release of the pointer is applied.
    window.drag(&[at(110.0), at(120.0), at(130.0), at(140.0)], PointerButton::Primary, Modifiers::NONE);
    window.until("more substeps", |shown| shown.substeps > 32);
}

#[test]
fn a_push_of_the_right_button_begins_without_force_and_grows_with_the_way() {
    let mut window = Window::open("ball", SIZE);
    // Slightly beside the node, as users press.
    let at = top_of(&window) + Vec2::new(4.0, 5.0);
    window.pointer(at);
    window.button(at, PointerButton::Secondary, true, Modifiers::NONE);
    window.studio().ask(Request::Step);
    window.until("a frame", |shown| shown.frames == 1);
    assert!(window.shown().pushes.is_empty());
    let metre = {
        let place = |x: f64| window.studio().on_screen([x, 2.0, 0.0]).expect("in sight").x;
        place(1.0) - place(0.0)
    };
    window.pointer(at + Vec2::new(0.5 * metre, 0.0));
    window.until("a push", |shown| shown.pushes.len() == 1);
    let [.., force] = window.shown().pushes[0];
    assert!((force[0] - 10.0).abs() < 0.1 && force[1].abs() < 0.1, "{force:?}");
    window.studio().ask(Request::Step);
    window.until("it is written down", |shown| shown.frames == 2 && shown.recorded == 1);
    window.button(at, PointerButton::Secondary, false, Modifiers::NONE);
    window.until("it is over", |shown| shown.pushes.is_empty());
}

/// The rate counts only consecutive pictures.
#[test]
fn the_time_in_which_nothing_was_drawn_is_not_counted_in_the_rate_of_pictures() {
    let mut window = Window::open("ball", SIZE);
    let mut time = 100.0;
    let mut rate = |after: f64| {
        time += after;
        window.harness.input_mut().time = Some(time);
        window.frames(1);
        let told = ["60 FPS", "– FPS"].map(|text| window.harness.query_by_label(text).is_some());
        assert!(told[0] != told[1], "{told:?}");
        told[0]
    };
    for _ in 0..20 {
        assert!(!rate(3.0), "nobody knows");
        assert!(rate(1.0 / 60.0) && rate(1.0 / 60.0));
    }
}

#[test]
fn models_whose_law_needs_one_of_two_fields_are_added_and_the_fields_take_each_others_place() {
    let mut window = Window::open("ball", TALL);
    window.click("pressure [Pa] instead of nRT");
    window.until("a pressure", |shown| {
        let gas = &shown.bodies[0].models[1];
        gas.number("pressure").is_some() && gas.number("nRT").is_none()
    });
    window.frames(10);
    window.click("nRT [J] instead of pressure");
    window.until("a quantity", |shown| shown.bodies[0].models[1].number("nRT").is_some());
    assert!(window.shown().message.as_ref().is_none_or(|message| message.severity == Severity::Done));
}

#[test]
fn a_slider_that_is_drawn_while_time_passes_is_one_edit() {
    let mut window = Window::open("ball", TALL);
    window.studio().ask(Request::Play(true));
    window.until("time passes", |shown| shown.frames > 2);
    let rect = window.harness.get_by_role_and_label(Role::Slider, "stiffness [N/m]").rect();
    let at = |x: f32| egui::pos2(rect.left() + x, rect.center().y);
    window.pointer(at(100.0));
    window.button(at(100.0), PointerButton::Primary, true, Modifiers::NONE);
    for k in 1..8u8 {
        let frame = window.shown().frames;
        window.pointer(at(100.0 - 3.0 * f32::from(k)));
        window.until("a frame passes", |shown| shown.frames > frame + 1);
    }
    window.button(at(79.0), PointerButton::Primary, false, Modifiers::NONE);
    window.studio().ask(Request::Play(false));
    window.until("it was set", |shown| !shown.playing && shown.undo.is_some());
    assert_ne!(window.shown().bodies[0].models[0].number("stiffness"), Some(1600.0));
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("undone", |shown| shown.undo.is_none());
    window.until("as it was", |shown| shown.bodies[0].models[0].number("stiffness") == Some(1600.0));
}

#[test]
fn what_the_window_says_is_seen_after_what_the_session_has_said() {
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Set("world.gravity".into(), Value::Number(1.0)));
    window.until("a refusal", |shown| shown.message.is_some());
    let says = |window: &Window| window.harness.query_by_label_contains("The link has been copied").is_some();
    assert!(!says(&window));
    window.harness.state_mut().as_mut().expect("a window").report(Severity::Done, Report::LinkCopied);
    window.frames(3);
    assert!(says(&window));
    // A later message of the session is newer.
    let first = window.shown().message.as_ref().map(|message| message.number);
    window.studio().ask(Request::Set("world.gravity".into(), Value::Number(2.0)));
    window.until("another refusal", |shown| shown.message.as_ref().map(|message| message.number) != first);
    window.frames(3);
    assert!(!says(&window));
}

#[test]
fn the_keys_fit_into_a_low_window() {
    let mut window = Window::open("ball", [640.0, 400.0]);
    window.key(Modifiers::NONE, Key::Questionmark);
    window.frames(30);
    let first = window.harness.get_by_label_contains("play or pause").rect();
    assert!(first.top() > 0.0 && first.bottom() < 400.0, "{first:?}");
    window.harness.get_by_label("this help").scroll_to_me();
    window.frames(60);
    let last = window.harness.get_by_label("this help").rect();
    assert!(last.top() > 0.0 && last.bottom() < 400.0, "{last:?}");
}

/// On a phone held upright, two scenes are one above the other, each with half of the small area.
#[test]
fn two_scenes_one_above_the_other_hide_nothing_of_one_another() {
    let mut window = Window::open("implicit-integrators", [400.0, 720.0]);
    window.click("Hrvatski");
    for _ in 0..30 {
        window.studio().ask(Request::Step);
    }
    window.until("thirty frames", |shown| shown.frames == 30);
    window.click("Usporedi");
    window.until("two scenes", |shown| shown.beside.is_some() && shown.frames == 30);
    window.key(Modifiers::COMMAND, Key::Z);
    window.until("one scene", |shown| shown.beside.is_none() && shown.message.is_some());
    window.key(Modifiers::COMMAND, Key::Y);
    window.until("two scenes", |shown| shown.beside.is_some() && shown.frames == 30);
    // The report is shown between the bodies, and not over them.
    let close = window.harness.get_by_label("Zatvori").rect();
    let canvas = window.canvas();
    let down = Vec2::new(0.0, 0.5 * canvas.height());
    for body in &window.shown().picture.bodies {
        for position in &body.positions {
            let at = window.studio().on_screen(*position).expect("in sight");
            let free = |at: egui::Pos2| !close.expand(8.0).contains(at) && canvas.contains(at);
            assert!(free(at) && free(at + down), "{at:?}");
        }
    }
}

#[test]
fn the_keys_are_seen_without_scrolling_on_a_small_laptop() {
    for language in ["English", "Hrvatski"] {
        let mut window = Window::open("ball", SIZE);
        if language == "Hrvatski" {
            window.click(language);
        }
        window.click("?");
        window.frames(5);
        let last = if language == "Hrvatski" { "ova pomoć" } else { "this help" };
        let low = window.harness.get_by_label(last).rect().bottom();
        let first =
            window.harness.get_by_label_contains(if language == "Hrvatski" { "pokreni ili" } else { "play or" });
        let high = first.rect().top();
        // The window is at the centre of the screen and shows all of them; if scrolling were necessary, the last ones would be below it.
        let off = 0.5 * (low + high) - 0.5 * SIZE[1];
        assert!(low < SIZE[1] && low - high > 300.0 && off.abs() < 30.0, "from {high} to {low}");
    }
}

/// If a screen draws rarely, both ends of a tap arrive with one picture.
#[test]
fn a_tap_shorter_than_a_picture_sets_a_slider() {
    let mut window = Window::open("ball", TALL);
    (0..20).for_each(|_| window.studio().ask(Request::Step));
    window.until("twenty frames", |shown| shown.frames == 20);
    let tap = |window: &mut Window, name: &str, along: f32| {
        let rect = window.harness.get_by_role_and_label(Role::Slider, name).rect();
        let pos = egui::pos2(rect.left() + along, rect.center().y);
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        let press = |pressed| egui::Event::PointerButton { pos, button, pressed, modifiers };
        // Before that, the pointer was elsewhere.
        window.pointer(egui::pos2(500.0, 500.0));
        window.harness.input_mut().events.extend([egui::Event::PointerMoved(pos), press(true), press(false)]);
        window.frames(3);
    };
    tap(&mut window, "Time", 30.0);
    window.until("another moment", |shown| shown.frames > 0 && shown.frames < 15);
    tap(&mut window, "stiffness [N/m]", 100.0);
    window.until("another stiffness", |shown| shown.bodies[0].models[0].number("stiffness") != Some(1600.0));
    tap(&mut window, "Substeps", 140.0);
    window.until("more substeps", |shown| shown.substeps > 32);
    tap(&mut window, "Speed", 20.0);
    window.until("more slowly", |shown| shown.speed < 0.5);
}

#[test]
fn language_and_theme_are_those_of_the_window_before() {
    let folder = std::env::temp_dir().join(format!("opruga-preferred-{}", std::process::id()));
    let store = || opruga_studio::preferences::Store::File(folder.join("studio.toml"));
    let open = || {
        let mut window = Window::open("ball", SIZE);
        let context = window.harness.ctx.clone();
        window.harness.state_mut().as_mut().expect("a window").prefer(store(), &context);
        window.frames(3);
        window
    };
    let mut window = open();
    assert!(window.harness.query_by_label("Play").is_some() && window.harness.ctx.theme() == egui::Theme::Dark);
    window.click("Hrvatski");
    window.click("Svijetlo");
    let mut window = open();
    assert!(window.harness.query_by_label("Pokreni").is_some() && window.harness.ctx.theme() == egui::Theme::Light);
    window.click("English");
    let window = open();
    assert!(window.harness.query_by_label("Play").is_some() && window.harness.ctx.theme() == egui::Theme::Light);
    std::fs::remove_dir_all(&folder).expect("it goes");
}

#[test]
fn what_is_to_be_dropped_has_a_hint_of_its_own_and_lies_where_the_pointer_is() {
    let mut window = Window::open("ball", SIZE);
    window.frames(3);
    let says = |window: &Window, wanted: &str| {
        fn texts(shape: &egui::Shape, found: &mut Vec<String>) {
            match shape {
                egui::Shape::Text(text) => found.push(text.galley.text().to_string()),
                egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
                _ => {}
            }
        }
        let mut found = Vec::new();
        window.harness.output().shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut found));
        found.iter().any(|text| text.contains(wanted))
    };
    assert!(says(&window, "drag me") && !says(&window, "Drop a scene"));
    window.harness.input_mut().hovered_files.push(egui::HoveredFile::default());
    window.frames(2);
    assert!(!says(&window, "drag me") && says(&window, "Drop a scene"));
    window.harness.input_mut().hovered_files.clear();
    window.frames(2);
    assert!(says(&window, "drag me"));
}
