//! The window is asked to close.
#![allow(missing_docs)]

#[path = "all/screen/mod.rs"]
#[allow(dead_code, reason = "the pictures are compared elsewhere")]
mod screen;

use egui::{Key, Modifiers, ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::Queryable;
use opruga::core::spec::Value;
use opruga_studio::session::Request;
use screen::window::{SIZE, Window};

/// The reaction of the window when its close button is pressed: whether it stays open, and whether it then requests to be closed.
fn asked_to_close(window: &mut Window) -> [bool; 2] {
    let root = window.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    root.events.push(ViewportEvent::Close);
    window.frames(1);
    let answered = commands(window);
    // A question is laid out before it is visible.
    window.frames(3);
    answered
}

fn commands(window: &Window) -> [bool; 2] {
    let root = &window.harness.output().viewport_output[&ViewportId::ROOT];
    [ViewportCommand::CancelClose, ViewportCommand::Close].map(|wanted| root.commands.contains(&wanted))
}

fn question(window: &Window) -> bool {
    window.harness.query_by_label_contains("Save it before the window closes?").is_some()
}

/// A window in which gravity was changed after a few frames.
fn edited() -> Window {
    let mut window = Window::open("ball", SIZE);
    (0..5).for_each(|_| window.studio().ask(Request::Step));
    window.studio().ask(Request::Set("world.gravity".into(), Value::Numbers(vec![0.0, -3.0])));
    window.until("a command", |shown| shown.recorded == 1);
    window
}

/// Presses a button of the question, which may cover another one with the same name.
fn answer(window: &mut Window, name: &str) {
    let last = window.harness.get_all_by_label(name).last().expect("a button");
    last.click();
    window.frames(1);
}

#[test]
fn a_window_in_which_nothing_was_done_closes_at_once() {
    let mut window = Window::open("ball", SIZE);
    (0..5).for_each(|_| window.studio().ask(Request::Step));
    window.until("it moves", |shown| shown.frames == 5);
    assert_eq!(asked_to_close(&mut window), [false, false], "nobody holds it");
}

#[test]
fn a_window_with_something_to_be_saved_asks_and_discards_or_goes_on() {
    let mut window = edited();
    assert_eq!(asked_to_close(&mut window), [true, false]);
    assert!(question(&window));
    // However often it is asked: nothing is lost, not even by keys that otherwise have another meaning.
    assert_eq!(asked_to_close(&mut window), [true, false]);
    window.key(Modifiers::NONE, Key::Home);
    assert_eq!(window.shown().recorded, 1);
    answer(&mut window, "Cancel");
    window.frames(2);
    assert!(!question(&window) && commands(&window) == [false, false]);
    assert_eq!(asked_to_close(&mut window), [true, false]);
    window.key(Modifiers::NONE, Key::Escape);
    assert!(!question(&window));
    assert_eq!(asked_to_close(&mut window), [true, false]);
    answer(&mut window, "Discard");
    assert_eq!(commands(&window), [false, true]);
    assert_eq!(asked_to_close(&mut window), [false, false], "it closes now");
}

#[test]
fn a_window_saves_what_was_done_before_it_closes_and_stays_where_that_is_refused() {
    let folder = std::env::temp_dir().join(format!("opruga-closing-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    // The studio writes to a folder below the one in which it was started. No other test here reads or writes files.
    std::env::set_current_dir(&folder).expect("it is there");
    std::fs::write(folder.join("out"), b"").expect("a file where the folder should be");
    let mut window = edited();
    let ended = |window: &mut Window| {
        for _ in 0..2000 {
            let [_, closes] = commands(window);
            if closes || !question(window) && window.harness.query_by_label_contains("cannot be created").is_some() {
                return closes;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
            window.frames(1);
        }
        panic!("it neither closes nor says why not");
    };
    assert_eq!(asked_to_close(&mut window), [true, false]);
    answer(&mut window, "Save");
    assert!(!ended(&mut window), "it is told why, and the window stays");
    std::fs::remove_file(folder.join("out")).expect("it goes");
    assert_eq!(asked_to_close(&mut window), [true, false]);
    answer(&mut window, "Save");
    assert!(ended(&mut window));
    let saved = std::fs::read_to_string(folder.join("out/studio/ball.toml")).expect("a scene");
    assert!(saved.contains("world.gravity"), "{saved}");
    std::env::set_current_dir(std::env::temp_dir()).expect("it is there");
    std::fs::remove_dir_all(&folder).expect("it goes");
}
