//! Controls that stay where they are while a scene runs, and messages that disappear after they were read.

use super::screen::window::{SIZE, Window};
use egui::{Key, Modifiers, Rect, Role};
use egui_kittest::kittest::Queryable;
use opruga::core::spec::Values;
use opruga_studio::session::{Edit, Request};
use opruga_studio::shown::Severity;

/// The rectangles of controls that a user may be about to press.
fn controls(window: &Window) -> Vec<Rect> {
    let sliders = window.harness.get_all_by_role(Role::Slider).map(|slider| slider.rect());
    let tools = ["Pull", "Plots", "canvas"].map(|name| window.harness.get_by_label(name).rect());
    tools.into_iter().chain(sliders).collect()
}

#[test]
fn no_control_moves_while_numbers_grow_and_warnings_come() {
    for size in [[360.0, 844.0], [450.0, 844.0], [720.0, 600.0], SIZE] {
        let mut window = Window::open("ball", size);
        if size[0] < 700.0 {
            window.click("Properties");
            window.frames(30);
        }
        let before = controls(&window);
        window.studio().ask(Request::Play(true));
        window.until("time passes", |shown| shown.frames > 20);
        assert_eq!(controls(&window), before, "{size:?}: numbers");
        window.studio().ask(Request::Play(false));
        // An integrator that causes a warning, slower than the clock.
        let kinds = opruga::Registry::<2>::default().integrators();
        let heun = kinds.into_iter().find(|spec| spec.kind == "heun").expect("it is registered");
        window.studio().ask(Request::Integrator(None, Values::defaults(heun, 2)));
        window.until("a warning", |shown| !shown.warnings.is_empty());
        let top = |list: &[Rect]| list.iter().take(3).copied().collect::<Vec<_>>();
        assert_eq!(top(&controls(&window)), top(&before), "{size:?}: a warning");
    }
}

#[test]
fn a_warning_is_read_in_full_where_it_is_pressed() {
    let mut window = Window::open("ball", SIZE);
    let kinds = opruga::Registry::<2>::default().integrators();
    let heun = kinds.into_iter().find(|spec| spec.kind == "heun").expect("it is registered");
    window.studio().ask(Request::Integrator(None, Values::defaults(heun, 2)));
    window.until("a warning", |shown| !shown.warnings.is_empty());
    let all = window.shown().warnings[0].message.clone();
    let whole = |window: &Window| window.harness.query_by_label_contains(&all).is_some();
    assert!(!whole(&window));
    window.harness.get_by_label_contains("Warning (").click();
    window.frames(5);
    assert!(whole(&window), "{all}");
}

#[test]
fn escape_puts_a_message_away() {
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Edit(Edit::Delete("nobody".into())));
    window.until("a refusal", |shown| shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused));
    window.frames(3);
    assert!(window.harness.query_by_label("Close").is_some());
    window.key(Modifiers::NONE, Key::Escape);
    window.frames(3);
    assert!(window.harness.query_by_label("Close").is_none());
}

#[test]
fn the_hash_is_computed_while_somebody_looks_at_it() {
    let mut window = Window::open("ball", [1280.0, 1600.0]);
    assert_eq!(window.shown().hash, None);
    window.click("State hash");
    window.until("a hash", |shown| shown.hash.is_some());
    window.frames(20);
    let hash = format!("{:016x}", window.shown().hash.expect("it is there"));
    assert!(window.harness.query_by_label(&hash).is_some(), "{hash}");
    window.click("State hash");
    window.until("no hash", |shown| shown.hash.is_none());
}

#[test]
fn arrows_have_a_key_with_their_unit() {
    let mut window = Window::open("ball", SIZE);
    window.click("Show");
    // One after the other, without opening the menu again.
    window.click("Velocities");
    window.click("Contact forces");
    window.key(Modifiers::NONE, Key::Escape);
    (0..12).for_each(|_| window.studio().ask(Request::Step));
    window.until("it falls", |shown| shown.frames == 12);
    window.rest();
    window.picture().assert_like("arrows");
}

#[test]
fn an_optional_field_of_an_obstacle_is_given_no_longer_by_its_cross() {
    let ball = opruga::scenes::find("ball").expect("it comes with the program");
    let text =
        format!("{ball}\n[[collider]]\nkind = \"box\"\ncenter = [9.0, 0.5]\nsize = [1.0, 1.0]\nrotation = 0.3\n");
    let session =
        opruga_studio::session::Session::open("it", &text, opruga::scenes::files(), opruga::Options::default());
    let mut window = Window::on(session.expect("it opens"), [1280.0, 2400.0], 1.0);
    window.click("Obstacle: box");
    window.frames(30);
    // The name is above its slider.
    let slider = window.harness.get_by_role_and_label(Role::Slider, "rotation [rad]").rect();
    let crosses: Vec<Rect> = window.harness.get_all_by_label("×").map(|cross| cross.rect()).collect();
    let above = |rect: &&Rect| (slider.top() - 30.0..slider.top()).contains(&rect.center().y);
    let at = crosses.iter().find(above).unwrap_or_else(|| panic!("{slider:?}: {crosses:?}")).center();
    window.drag(&[at], egui::PointerButton::Primary, Modifiers::NONE);
    window.until("no rotation", |shown| {
        shown.obstacles.iter().all(|obstacle| obstacle.values.number("rotation").is_none())
    });
    window.frames(30);
    assert!(window.harness.query_by_label("+ rotation [rad]").is_some());
}
