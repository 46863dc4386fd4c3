//! Recorded runs in the window.
#![allow(missing_docs)]
#![allow(clippy::disallowed_methods)]

use opruga::blueprint::AnyBlueprint;
use opruga::io::recording::{Header, Recording, RecordingError};
use opruga::io::scene;
use opruga::recordings::Tape;
use opruga::{Options, World, catalogue};
use opruga_studio::document::Document;
use opruga_studio::report::Report;
use opruga_studio::session::{Grip, Request, Session};
use opruga_studio::shown::Offer;
use opruga_studio::view_errors::ViewError;
use opruga_studio::words::Language;
use std::io::Cursor;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// Records the ball with overrides, with one state every `every` frames; returns the bytes, and the hash of every frame.
fn record(every: u64, led: bool) -> (Vec<u8>, Vec<u64>) {
    let text = opruga::scenes::find("ball").expect("it comes with the program");
    let overrides: Vec<(String, String)> =
        [("time.seconds", "1.5"), ("body.ball.models.pressure.nRT", "80")].map(|(p, v)| (p.into(), v.into())).into();
    let options = scene::Options { overrides: overrides.clone(), ..scene::Options::default() };
    let Ok((AnyBlueprint::Plane(blueprint), _)) = scene::read(text.as_bytes(), "ball.toml", &catalogue(), &options)
    else {
        panic!("a scene of the plane")
    };
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let file = std::env::temp_dir().join(format!("opruga-view-{}-{number}.rec", std::process::id()));
    let header = Header {
        name: "ball".into(),
        scene: text.into(),
        frame: blueprint.time.frame,
        every,
        overrides,
        ..Header::default()
    };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    let mut tape = Tape::begin(&file, true, &header, &mut world).expect("a recording");
    let mut hashes = vec![world.state_hash()];
    for frame in 0..90 {
        if led && frame == 30 {
            world
                .set("body.ball.models.mass_spring.stiffness", opruga::core::spec::Value::Number(900.0))
                .expect("allowed");
        }
        tape.step(&mut world).expect("a frame");
        hashes.push(world.state_hash());
    }
    tape.finish(&mut world).expect("an end");
    let bytes = std::fs::read(&file).expect("the recording");
    std::fs::remove_file(file).expect("the recording");
    (bytes, hashes)
}

fn view(bytes: &[u8]) -> Result<Session, Report> {
    Session::view(Recording::open(Cursor::new(bytes)).expect("its head is whole"), Options::default())
}

fn arrive(session: &mut Session) {
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

/// Any moment of a recorded run is that of the run, whatever moment was shown before.
#[test]
fn every_frame_of_a_recording_is_seen_as_it_was() {
    for every in [1, 7, 32] {
        let (bytes, hashes) = record(every, false);
        let mut session = view(&bytes).expect("a recording");
        assert_eq!((session.frames(), session.latest()), (0, 90));
        for frame in [0, 1, 45, 90, 13, 14, 89, 32] {
            session.handle(Request::Seek(frame));
            arrive(&mut session);
            assert_eq!((session.frames(), session.hash()), (frame, hashes[frame as usize]), "every {every}");
        }
        // Played, it shows the same frames.
        for frame in 33..=90 {
            session.handle(Request::Step);
            assert_eq!(session.hash(), hashes[frame], "every {every}, frame {frame}");
        }
    }
}

/// At the end of a recording time stops and the user is asked; what follows is marked as a different run.
#[test]
fn time_stands_at_the_end_of_a_recording_until_somebody_wants_a_course_of_their_own() {
    let (bytes, hashes) = record(7, false);
    let mut session = view(&bytes).expect("a recording");
    let tick = |session: &mut Session| {
        session.tick(Duration::from_millis(34), Duration::from_millis(500), &|| Duration::ZERO);
    };
    session.handle(Request::Play(true));
    (0..200).for_each(|_| tick(&mut session));
    let shown = session.shown();
    let message = shown.message.expect("a message");
    assert_eq!((session.frames(), shown.playing, shown.recorded_until), (90, false, Some(90)));
    assert_eq!((message.report, message.offer), (Report::RecordingEnds(shown.time), Some(Offer::GoOn)));
    session.handle(Request::Step);
    assert_eq!((session.frames(), session.hash()), (90, hashes[90]), "not even by a step");
    // To the start and back: it is still the recording.
    session.handle(Request::Reset);
    assert_eq!((session.frames(), session.latest(), session.hash()), (0, 90, hashes[0]));
    session.handle(Request::Seek(90));
    arrive(&mut session);
    session.handle(Request::Accept(Offer::GoOn));
    let shown = session.shown();
    assert_eq!(shown.message.map(|message| message.report), Some(Report::OwnCourse(shown.time)));
    (0..20).for_each(|_| tick(&mut session));
    let shown = session.shown();
    assert!(shown.playing && session.frames() > 100, "{}", session.frames());
    assert_eq!(shown.recorded_until, Some(90), "the recording still ends where it ended");
}

/// Actions of the user within a recording start a different run, which the command line repeats from the saved scene.
#[test]
fn a_recording_goes_on_by_hand() {
    let (bytes, hashes) = record(1, false);
    let mut session = view(&bytes).expect("a recording");
    session.handle(Request::Seek(40));
    arrive(&mut session);
    session.handle(Request::Grab(Grip::Pull, 0, [0.4, 1.0, 0.0]));
    let shown = session.shown();
    assert_eq!(shown.recorded_until, Some(40), "up to here it is as it was recorded");
    assert_eq!(shown.message.map(|message| message.report), Some(Report::OwnCourse(shown.time)));
    for k in 0..20 {
        session.handle(Request::Lead([0.4 + 0.02 * f64::from(k), 1.2, 0.0]));
        session.handle(Request::Step);
    }
    session.handle(Request::Release);
    assert_eq!((session.frames(), session.latest()), (60, 60), "the rest of the recording is another future");
    assert_ne!(session.hash(), hashes[60]);
    let text = session.saved();
    let read = scene::read(text.as_bytes(), "saved.toml", &catalogue(), &scene::Options::default());
    let Ok((AnyBlueprint::Plane(blueprint), _)) = read else { panic!("a scene of the plane: {text}") };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    (0..60).for_each(|_| world.frame().expect("a frame"));
    assert_eq!(world.state_hash(), session.hash());
}

#[test]
fn what_cannot_be_viewed_says_why() {
    let (led, _) = record(1, true);
    let refused = |bytes: &[u8]| view(bytes).expect_err("it is refused");
    assert_eq!(refused(&led), Report::Recording(ViewError::Led {}));
    let croatian = Language::Croatian.report(&refused(&led));
    assert_eq!(
        croatian,
        "ovaj je tijek vodio program, što tekst prizora ne može reći; savjet: `opruga replay` ga prikazuje"
    );
    let (bytes, _) = record(1, false);
    assert!(Recording::open(Cursor::new(&bytes[..100])).is_err());
    let mut other = bytes.clone();
    let place = other.windows(9).position(|bytes| bytes == b"nRT = 55.").expect("it is in the scene");
    other[place + 6] = b'6';
    let changed = Recording::open(Cursor::new(&other[..])).map(|_| refused(&other));
    assert!(changed.is_err() || changed == Ok(Report::Recording(ViewError::OtherProgram {})), "{changed:?}");
    // One bit of a state is changed: its bytes are named.
    let mut damaged = bytes.clone();
    let place = damaged.len() * 2 / 3;
    damaged[place] ^= 1;
    let Report::Recording(ViewError::State { cause: RecordingError::Damaged { from, to } }) = refused(&damaged) else {
        panic!("{:?}", refused(&damaged))
    };
    assert!((from..to).contains(&(place as u64)), "{from} {place} {to}");
}

/// A run that was killed before its first frame, and one with something else after its frames.
#[test]
fn a_recording_without_frames_and_one_with_damage_behind_them_are_not_viewed() {
    let (bytes, _) = record(1, false);
    let chunk = |bytes: &[u8]| bytes == b"FRAM";
    let first = bytes.windows(4).position(chunk).expect("a frame");
    let refused = |bytes: &[u8]| view(bytes).expect_err("it is refused");
    assert_eq!(refused(&bytes[..first]), Report::Recording(ViewError::Empty {}));
    let last = bytes.windows(4).rposition(chunk).expect("a frame");
    let damaged = [&bytes[..last], &[0; 48]].concat();
    let (from, to) = (last as u64, damaged.len() as u64);
    let cause = RecordingError::Damaged { from, to };
    assert_eq!(refused(&damaged), Report::Recording(ViewError::DamagedBehind { frame: 89, cause }));
    let croatian = Language::Croatian.report(&refused(&damaged));
    assert_eq!(croatian, format!("iza sličice 89: snimka je oštećena između bajtova {from} i {to}"));
}

#[test]
fn overrides_that_the_scene_does_not_take_are_named() {
    let text = opruga::scenes::find("ball").expect("it comes with the program");
    let mut document = Document::new("ball", text).expect("it is read");
    let [path, value] = ["time.seconds".to_string(), "= 3".to_string()];
    assert_eq!(document.take_override(&path, &value), Err(ViewError::NoValue { path, value }));
    let path = "body.nobody.mass".to_string();
    assert_eq!(document.take_override(&path, "3"), Err(ViewError::NoPath { path }));
}
