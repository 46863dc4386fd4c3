//! The window, pressed and looked at as a person does, without a screen.
#![allow(missing_docs)]
// No physics here.
#![allow(clippy::disallowed_methods)]

mod screen;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use opruga::Options;
use opruga_studio::app::Studio;
use opruga_studio::session::{Request, Session};
use opruga_studio::shown::{Severity, Shown};
use opruga_studio::words::Language;
use screen::{Screen, Textures};
use std::sync::Arc;
use std::time::{Duration, Instant};

struct Window {
    harness: Harness<'static, Option<Studio>>,
    textures: Textures,
}

impl Window {
    fn open(scene: &str, size: [f32; 2]) -> Window {
        let text = opruga::scenes::find(scene).expect("a scene of the program");
        let session = Session::open(scene, text, opruga::scenes::files(), Options::default()).expect("it opens");
        let textures = Textures::default();
        let mut session = Some(session);
        let show = move |ui: &mut egui::Ui, studio: &mut Option<Studio>| {
            if let Some(session) = session.take() {
                *studio = Some(Studio::new(session, ui.ctx()).expect("a thread"));
            }
            studio.as_mut().expect("a window").show(ui);
        };
        let harness = Harness::builder()
            .with_size(Vec2::from(size))
            .with_step_dt(1.0 / 60.0)
            .renderer(textures.clone())
            .build_ui_state(show, None);
        let mut window = Window { harness, textures };
        window.frames(3);
        window
    }

    fn frames(&mut self, count: usize) {
        (0..count).for_each(|_| self.harness.step());
    }

    fn studio(&self) -> &Studio {
        self.harness.state().as_ref().expect("a window")
    }

    fn shown(&self) -> Arc<Shown> {
        self.studio().shown()
    }

    /// Shows frames until something holds.
    fn until(&mut self, what: &str, holds: impl Fn(&Shown) -> bool) {
        let begin = Instant::now();
        while !holds(&self.shown()) {
            assert!(begin.elapsed() < Duration::from_secs(20), "{what}: {:?}", self.shown().message);
            std::thread::sleep(Duration::from_millis(2));
            self.frames(1);
        }
        self.frames(2);
    }

    /// Shows frames until nothing is drawn on other threads any more.
    fn rest(&mut self) {
        let begin = Instant::now();
        self.frames(2);
        while self.studio().is_drawing() {
            assert!(begin.elapsed() < Duration::from_secs(60), "it is still drawing");
            std::thread::sleep(Duration::from_millis(2));
            self.frames(1);
        }
        self.frames(2);
    }

    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.frames(3);
    }

    /// The middle of the part where the scene is.
    fn canvas(&self) -> egui::Rect {
        self.harness.get_by_label("canvas").rect()
    }

    fn pointer(&mut self, at: Pos2) {
        self.harness.event(Event::PointerMoved(at));
        self.frames(1);
    }

    fn button(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event_modifiers(Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        self.frames(1);
    }

    fn drag(&mut self, path: &[Pos2], button: PointerButton, modifiers: Modifiers) {
        self.pointer(path[0]);
        self.button(path[0], button, true, modifiers);
        for at in path {
            self.pointer(*at);
        }
        let last = path[path.len() - 1];
        self.button(last, button, false, modifiers);
        self.frames(2);
    }

    fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.frames(3);
    }

    fn picture(&self) -> Screen {
        Screen::of(&self.harness, &self.textures)
    }
}

/// Where the highest node of the first body is in the window.
fn top_of(window: &Window) -> Pos2 {
    let shown = window.shown();
    let positions = &shown.picture.bodies[0].positions;
    let top = positions.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])).expect("a node");
    window.studio().on_screen(top).expect("in sight")
}

const SIZE: [f32; 2] = [1280.0, 720.0];

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
        window.studio().ask(Request::Step);
        window.frames(3);
        std::thread::sleep(Duration::from_millis(20));
        window.frames(2);
        pulled |= window.shown().pulls.len() == 1;
        window.button(at, PointerButton::Primary, false, Modifiers::NONE);
    }
    assert!(pulled);
}
