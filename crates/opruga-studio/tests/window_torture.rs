//! Faults that a window must survive, row by row of the torture list.
#![allow(missing_docs)]
// No physics here.
#![allow(clippy::disallowed_methods)]

#[path = "all/screen/mod.rs"]
#[allow(dead_code, reason = "the pictures are compared elsewhere")]
mod screen;

use egui::{Modifiers, PointerButton, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use opruga::Options;
use opruga::core::spec::Value;
use opruga::io::Files;
use opruga::io::scene::{self, Limits};
use opruga::world::schema::MOST_SUBSTEPS;
use opruga_studio::runner::sliced::Link;
use opruga_studio::session::{Request, Session};
use opruga_studio::shown::{Offer, Severity};
use opruga_studio::words::Language;
use screen::window::{SIZE, Window, top_of};
use std::cell::Cell;
use std::time::Duration;

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

fn no_time() -> Duration {
    Duration::ZERO
}

#[test]
fn row_92_a_window_without_size_a_huge_one_and_one_on_another_screen_are_shown_and_picking_stays_right() {
    for scene in ["ball", "balloons"] {
        let mut window = Window::open(scene, SIZE);
        for size in [[0.0, 0.0], [1.0, 1.0], [0.0, 400.0], [32_768.0, 60.0], [60.0, 32_768.0], [3.0, 3.0], SIZE] {
            window.harness.set_size(Vec2::from(size));
            window.studio().ask(Request::Step);
            window.frames(3);
        }
        window.rest();
    }
    // Screens with other numbers of pixels per point: the pointer acts on what is seen under it.
    for fine in [0.75, 1.25, 1.5, 3.0] {
        let mut window = Window::open_at("ball", SIZE, fine);
        let top = top_of(&window);
        window.pointer(top);
        window.button(top, PointerButton::Primary, true, Modifiers::NONE);
        window.studio().ask(Request::Step);
        window.until("a pull", |shown| shown.pulls.len() == 1);
        let [node, ..] = window.shown().pulls[0];
        let highest = window.shown().picture.bodies[0].positions.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
        assert!((node[1] - highest).abs() < 1e-3, "{fine}: {node:?}, {highest}");
    }
}

#[test]
fn row_94_without_a_display_the_program_says_what_is_missing_and_what_works_instead() {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_opruga-studio"));
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let output = command.arg("heart").output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{said}");
    assert!(said.contains("studio.no_window") && said.contains("opruga run heart"), "{said}");
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn a_call_that_names_two_scenes_or_no_text_or_no_scene_is_told_what_is_allowed() {
    let said = |arguments: &[&std::ffi::OsStr]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_opruga-studio"));
        let output = command.args(arguments).output().expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains("panicked"), "{said}");
        assert_eq!(output.status.code(), Some(2), "{said}");
        said
    };
    assert!(said(&["ball".as_ref(), "heart".as_ref()]).contains("opruga-studio [SCENE]"));
    assert!(said(&["--fast".as_ref()]).contains("`--fast`"));
    let folder = std::env::temp_dir().join(format!("opruga-call-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("opruga")).expect("a folder");
    std::fs::write(folder.join("opruga/studio.toml"), "language = \"hr\"\n").expect("preferences");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_opruga-studio"));
    let croatian = command.arg("--fast").env("XDG_CONFIG_HOME", &folder).output().expect("it starts");
    std::fs::remove_dir_all(&folder).expect("it goes");
    let croatian = String::from_utf8_lossy(&croatian.stderr).into_owned();
    assert!(
        !cfg!(target_os = "linux") || croatian.starts_with("greška[studio.call]: nema opcije `--fast`"),
        "{croatian}"
    );
    assert!(said(&["presures".as_ref()]).contains("did you mean `pressures`?"));
    #[cfg(unix)]
    assert!(said(&[std::os::unix::ffi::OsStrExt::from_bytes(b"\xff")]).contains("UTF-8"));
}

#[test]
fn row_95_ten_hidden_minutes_are_neither_a_giant_step_nor_a_spiral() {
    let mut session = open("ball");
    session.handle(Request::Play(true));
    session.tick(Duration::from_millis(17), Duration::from_millis(12), &no_time);
    let before = session.frames();
    session.tick(Duration::from_secs(600), Duration::from_secs(600), &no_time);
    let leapt = session.frames() - before;
    assert!(leapt <= 7, "{leapt} frames at once");
    session.tick(Duration::from_millis(17), Duration::from_millis(12), &no_time);
    assert!(session.frames() - before <= leapt + 2, "nothing is made up for later");
    let mut other = open("ball");
    while other.frames() < session.frames() {
        other.handle(Request::Step);
    }
    assert_eq!(session.hash(), other.hash(), "the frames are those of any run");
}

#[test]
fn row_96_a_scene_that_is_too_slow_slows_down_and_says_by_how_much() {
    let mut session = open("ball");
    session.handle(Request::Play(true));
    // Every look at the clock, twice per frame, advances it by thirty milliseconds.
    let now = Cell::new(Duration::ZERO);
    let clock = || {
        now.set(now.get() + Duration::from_millis(30));
        now.get()
    };
    let mut begin = Duration::ZERO;
    for _ in 0..150 {
        let elapsed = now.get() - begin;
        begin = now.get();
        let frames = session.frames();
        session.tick(elapsed.max(Duration::from_millis(17)), Duration::from_millis(14), &clock);
        assert!(session.frames() - frames <= 1, "one slow frame at a time: the interface is served between them");
    }
    let pace = session.shown().pace;
    assert!(pace.ratio < 0.7 && pace.ratio > 0.1, "{}", pace.ratio);
    assert!((pace.frame_cost - 0.03).abs() < 0.005, "{}", pace.frame_cost);
}

#[test]
fn row_97_the_trajectory_is_the_same_to_the_bit_at_30_60_144_and_1000_frames_a_second() {
    let mut session = open("ball");
    let mut wanted = vec![session.hash()];
    for _ in 0..100 {
        session.handle(Request::Step);
        wanted.push(session.hash());
    }
    for rate in [30, 60, 144, 1000] {
        let mut session = open("ball");
        session.handle(Request::Play(true));
        while session.frames() < 90 {
            session.tick(Duration::from_secs_f64(1.0 / f64::from(rate)), Duration::from_millis(12), &no_time);
            let frame = session.frames() as usize;
            assert_eq!(session.hash(), wanted[frame], "{rate} Hz, frame {frame}");
        }
    }
}

#[test]
fn row_98_where_there_is_no_thread_the_bits_are_the_same_and_what_no_memory_holds_is_refused() {
    // As on a web page whose workers cannot share memory, every frame in a turn of the interface; and on four threads.
    let (text, files) = (opruga::scenes::find("balloons").expect("a scene"), opruga::scenes::files());
    let session = |threads| {
        let options = Options { threads, ..Options::default() };
        Session::open("balloons", text, files.clone(), options).expect("it opens")
    };
    let (alone, mut together) = (Link::start(session(1), || {}).expect("no thread is needed"), session(4));
    for _ in 0..20 {
        alone.ask(Request::Step);
        alone.turn();
        together.handle(Request::Step);
        assert_eq!(alone.with_session(Session::hash), together.hash());
    }
    // A web page has 4 GiB, a machine more. A scene that takes too much is refused before any memory is allocated.
    let vast = |vertices: &str| {
        let ball = opruga::scenes::find("ball").expect("a scene");
        let vast = ball.replace("vertices = 36", &format!("vertices = {vertices}"));
        assert_ne!(vast, ball);
        vast
    };
    let limits = Limits::of_addresses(32);
    assert!(limits.memory_bytes < 4 << 30);
    let options = scene::Options { limits, ..scene::Options::default() };
    let told = scene::read(vast("4000000").as_bytes(), "vast.toml", &opruga::catalogue(), &options);
    let codes: Vec<&str> = told.expect_err("it does not fit").iter().map(|error| error.code).collect();
    assert_eq!(codes, ["limit.memory"]);
    let hash = together.hash();
    let many = vast("33000000").replacen("shape = {", "copies = { count = [10], spacing = [2.0, 2.0] }\nshape = {", 1);
    together.handle(Request::Open { name: "vast".into(), text: many, files: files.clone() });
    let message = together.shown().message.expect("it is told");
    assert_eq!(message.severity, Severity::Refused);
    // A scene that is too large for every machine has another code.
    assert!(message.text.contains("limit.nodes") && message.text.contains("allowed: at most"), "{}", message.text);
    assert_eq!((together.name(), together.hash()), ("balloons", hash), "the old scene stays");
    together.handle(Request::Step);
    assert_eq!(together.frames(), 21);
}

#[test]
fn row_100_extreme_values_are_refused_or_run_and_what_failed_can_be_taken_back() {
    let numbers = [0.0, -1.0, 1e-300, 1e9, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
    let mut values: Vec<(String, Value)> = Vec::new();
    for field in ["mass_spring.stiffness", "mass_spring.damping", "pressure.nRT", "bending.stiffness"] {
        values.extend(numbers.map(|x| (format!("body.ball.models.{field}"), Value::Number(x))));
    }
    values.extend(numbers.map(|x| ("world.drag".into(), Value::Number(x))));
    values.extend([9.81, 1e6, 1e300, f64::NAN].map(|g| ("world.gravity".into(), Value::Numbers(vec![0.0, g]))));
    values.extend([1, 0, -5, 4096, i64::MAX].map(|n| ("time.substeps".into(), Value::Integer(n))));
    for (path, value) in values {
        let mut session = open("ball");
        (0..10).for_each(|_| session.handle(Request::Step));
        let (hash, text) = (session.hash(), session.text());
        let substeps = if let Value::Integer(n) = value { n } else { 0 };
        session.handle(Request::Set(path.clone(), value.clone()));
        let refused = session.shown().message.is_some_and(|m| m.severity == Severity::Refused);
        if refused {
            assert_eq!((session.hash(), session.text()), (hash, text), "{path} {value}: all is as it was");
            continue;
        }
        (0..8).for_each(|_| session.handle(Request::Step));
        let shown = session.shown();
        let numbers = shown.picture.bodies.iter().flat_map(|body| body.positions.iter().flatten());
        assert!(numbers.into_iter().all(|x| !x.is_nan()), "{path} {value}: the last good state");
        if session.frames() < 18 {
            let message = shown.message.expect("it says why");
            assert!(message.text.contains("ball"), "{path} {value}: {}", message.text);
            assert_eq!(message.offer, Some(Offer::HalveStep), "{path} {value}");
        }
        assert!(substeps < 5000, "{substeps}");
        // After an undo the scene is at the moment before the change, and continues.
        session.handle(Request::Undo);
        while session.is_seeking() {
            session.tick(Duration::from_millis(16), Duration::from_millis(12), &no_time);
        }
        assert_eq!((session.frames(), session.hash(), session.text()), (10, hash, text), "{path} {value}");
        session.handle(Request::Step);
        assert_eq!(session.frames(), 11);
    }
}

#[test]
fn row_100_a_slider_that_was_drawn_too_far_shows_the_last_good_value_and_the_message_offers_a_smaller_step() {
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Step);
    window.until("it moves", |shown| shown.frames == 1);
    let slider = || ("stiffness [N/m]", egui::Role::Slider);
    let rect = window.harness.get_by_role_and_label(slider().1, slider().0).rect();
    // From the middle of the slider to beyond its right end.
    let from = egui::pos2(rect.left() + 60.0, rect.center().y);
    window.drag(&[from, egui::pos2(rect.left() + 2000.0, rect.center().y)], PointerButton::Primary, Modifiers::NONE);
    window.until("a refusal", |shown| shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused));
    let shown = window.shown();
    let stiffness = shown.bodies[0].models[0].number("stiffness").expect("a stiffness");
    let node = window.harness.get_by_role_and_label(slider().1, slider().0);
    assert_eq!(node.accesskit_node().numeric_value(), Some(stiffness));
    assert!(matches!(shown.message.as_ref().and_then(|m| m.offer.clone()), Some(Offer::Substeps(_))));
    window.harness.get_by_label_contains("substeps, with a safety margin").click();
    window.until("it was taken", |shown| shown.substeps > 32);
    assert!(window.shown().bodies[0].models[0].number("stiffness").expect("one") > stiffness);
}

#[test]
fn row_100_more_substeps_than_a_frame_may_have_are_not_offered_and_the_message_says_what_else_helps() {
    let stiffer = |stiffness: f64| {
        let mut session = open("ball");
        session.handle(Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(stiffness)));
        let message = session.shown().message.expect("a refusal");
        assert_eq!(message.severity, Severity::Refused);
        (session, message)
    };
    let (mut session, message) = stiffer(1e12);
    let Some(Offer::Substeps(most)) = message.offer.clone() else { panic!("{message:?}") };
    assert!((2..=MOST_SUBSTEPS).contains(&most), "{most}");
    session.handle(Request::Accept(message.offer.expect("the offer")));
    let shown = session.shown();
    assert_eq!(shown.substeps, most, "{:?}", shown.message);
    // Stiffer only by the remaining margin: the offer ends at the limit for frames.
    let least = |message: &str| message.rsplit(">= ").next().and_then(|n| n.parse::<f64>().ok()).expect("a number");
    let almost = 1e12 * (0.97 * f64::from(MOST_SUBSTEPS) / least(&message.text)).powi(2);
    let (_, message) = stiffer(almost);
    assert_eq!(message.offer, Some(Offer::Substeps(MOST_SUBSTEPS)), "{}", message.text);
    let (mut session, message) = stiffer(4.0 * almost);
    assert_eq!(message.offer, None);
    assert!(
        message.text.contains("at most 1000000 substeps") && message.text.contains("integrator"),
        "{}",
        message.text
    );
    let croatian = Language::Croatian.report(&message.report);
    assert!(croatian.contains("najviše 1000000 podkoraka") && !croatian.contains("engleskom"), "{croatian}");
    assert_eq!(session.shown().substeps, 32);
}

#[test]
fn row_100_a_window_shows_more_substeps_than_its_slider_began_with_and_leaves_them() {
    let text = opruga::scenes::find("ball").expect("it").replace("substeps = 32", "substeps = 20000");
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Open { name: "fine".into(), text, files: Files::default() });
    window.until("it is open", |shown| shown.name == "fine");
    window.frames(5);
    let shown = window.shown();
    assert_eq!((shown.substeps, shown.undo.is_some(), shown.message.is_none()), (20_000, false, true));
}

#[test]
fn row_100_a_scene_that_diverges_in_the_window_names_body_and_node_and_offers_a_way_on() {
    let text = opruga::scenes::find("ball").expect("it").replace(
        "[[collider]]",
        "[[load]]\nkind = \"force\"\nbody = \"ball\"\nvalue = [1e300, 0.0]\ncurve = [[0.0, 0.0], [0.2, 0.0], [0.3, 1.0]]\n\n[[collider]]",
    );
    let mut window = Window::open("ball", SIZE);
    window.studio().ask(Request::Open { name: "bad".into(), text, files: Files::default() });
    window.until("it diverges", |shown| {
        shown.name == "bad" && shown.message.as_ref().is_some_and(|m| m.severity == Severity::Refused)
    });
    let shown = window.shown();
    let said = shown.message.as_ref().expect("a message").text.clone();
    assert!(said.contains("`ball`") && said.contains("node") && !shown.playing, "{said}");
    let frames = shown.frames;
    window.click("Go back a second and halve the step");
    window.until("it went back", |shown| shown.substeps == 64 && shown.frames < frames + 60);
}
