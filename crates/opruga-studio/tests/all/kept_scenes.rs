//! Saved scenes: with the files that they name, and against the loss of the window.

use opruga::Options;
use opruga::io::Files;
use opruga_studio::handing::{Folder, named_files};
use opruga_studio::rescue::{self, Rescue};
use opruga_studio::runner::Link;
use opruga_studio::session::{Grip, Request, Session};
use opruga_studio::share::Shared;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A folder that is removed at the end of the test.
struct Room(PathBuf);

impl Room {
    fn new(name: &str) -> Room {
        let path = std::env::temp_dir().join(format!("opruga-kept-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder");
        Room(path)
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

/// Frames with a pull in the middle.
fn pull(session: &mut Session) {
    (0..8).for_each(|_| session.handle(Request::Step));
    let node = session.shown().picture.bodies[0].positions[0];
    session.handle(Request::Grab(Grip::Pull, 0, node));
    for step in 1..12 {
        session.handle(Request::Lead([node[0] + 0.05 * f64::from(step), node[1] + 0.04 * f64::from(step), 0.0]));
        session.handle(Request::Step);
    }
    session.handle(Request::Release);
    (0..5).for_each(|_| session.handle(Request::Step));
}

/// The hash at the end of a scene file, with the files next to it.
fn run(path: &Path) -> u64 {
    let text = std::fs::read_to_string(path).expect("the scene is there");
    let opened = Session::open("again", &text, Files::beside(path), Options::default());
    let mut session = opened.unwrap_or_else(|said| panic!("{said}"));
    to_the_end(&mut session);
    session.hash()
}

fn to_the_end(session: &mut Session) {
    session.go_to_the_end();
    let begin = Instant::now();
    while session.is_seeking() {
        session.tick(Duration::ZERO, Duration::from_millis(100), &|| begin.elapsed());
    }
}

#[test]
fn a_saved_scene_that_names_files_lies_beside_them_and_runs_to_the_same_bits() {
    let room = Room::new("files");
    let mut session = open("heart");
    pull(&mut session);
    let folder = Folder::at(&room.0);
    for expected in ["heart/heart.toml", "heart-2/heart.toml"] {
        let written = folder
            .scene(session.name(), &session.saved(), session.files(), session.registries())
            .expect("it is written");
        assert_eq!(written[0], room.0.join(expected).with_file_name("heart.toml"));
        assert!(written.len() > 1 && written.iter().all(|path| path.is_file()), "{written:?}");
        assert_eq!(run(&written[0]), session.hash());
    }
    // A scene without files is a single file, and replaces none.
    let ball = open("ball");
    for expected in ["ball.toml", "ball-2.toml"] {
        let written = folder.scene("ball", &ball.saved(), ball.files(), ball.registries()).expect("it is written");
        assert_eq!(written, [room.0.join(expected)]);
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_told_and_nothing_is_left() {
    let room = Room::new("refused");
    std::fs::write(room.0.join("out"), "a file where a folder should be").expect("written");
    let session = open("heart");
    let refused =
        Folder::at(room.0.join("out")).scene("heart", &session.saved(), session.files(), session.registries());
    assert!(refused.is_err_and(|said| said.to_string().contains("cannot be created")));
    assert_eq!(std::fs::read_dir(&room.0).expect("a folder").count(), 1);
}

#[test]
fn row_93_what_was_done_in_a_window_that_is_lost_goes_on_in_the_next_to_the_same_bits() {
    for scene in ["ball", "heart"] {
        let mut session = open(scene);
        pull(&mut session);
        let held =
            Files::in_memory(named_files(session.name(), &session.saved(), session.files(), session.registries()));
        let shared = Shared { name: session.name().into(), text: session.saved(), files: held };
        let room = Room::new(scene);
        let path = room.0.join("kept");
        rescue::write(&path, &shared).expect("it is kept");
        let mut again = rescue::resume(&rescue::read(&path).expect("it is read"), Options::default()).expect("opens");
        to_the_end(&mut again);
        assert_eq!((again.frames(), again.hash(), again.name()), (session.frames(), session.hash(), session.name()));
        assert!(!again.is_moving(), "time stands until somebody lets it pass");
    }
}

#[test]
fn row_93_what_is_done_is_kept_while_it_is_done() {
    let room = Room::new("while");
    let path = room.0.join("kept");
    let mut session = open("ball");
    pull(&mut session);
    let (hash, frames) = (session.hash(), session.frames());
    let link = Link::start(session, || {}).expect("a thread");
    let mut rescue = Rescue::at(&path);
    let begin = Instant::now();
    while !path.exists() {
        assert!(begin.elapsed() < Duration::from_secs(120), "nothing is kept");
        rescue.poll(&link);
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut again = rescue::resume(&rescue::read(&path).expect("it is read"), Options::default()).expect("opens");
    to_the_end(&mut again);
    assert_eq!((again.frames(), again.hash()), (frames, hash));
    // A second file exists as long as the user has not saved the work.
    let until = |rescue: &mut Rescue, edited: bool| {
        while rescue::mark_of(&path).exists() != edited {
            assert!(begin.elapsed() < Duration::from_secs(120), "edited: {edited}");
            rescue.poll(&link);
            std::thread::sleep(Duration::from_millis(2));
        }
    };
    until(&mut rescue, true);
    link.ask(Request::Saved(link.copy().recv().expect("a copy").mark));
    until(&mut rescue, false);
}
