//! The functions of a web page, tested without one: scenes in addresses, the simulation in turns, work in the background.
#![allow(missing_docs)]

use opruga::Options;
use opruga::io::Files;
use opruga_studio::runner::sliced::Link;
use opruga_studio::session::{Request, Session};
use opruga_studio::share::{MOST_LETTERS, Shared, of_fragment, to_fragment};
use opruga_studio::work::{breathe, done, spawn};
use std::sync::Arc;
use std::time::Duration;

fn scene(name: &str) -> Shared {
    let text = opruga::scenes::find(name).expect("a scene of the program").to_string();
    Shared { name: name.into(), text, files: opruga::scenes::files() }
}

#[test]
fn scenes_come_back_from_an_address_as_they_were() {
    for name in opruga::scenes::names() {
        let scene = scene(name);
        let fragment = to_fragment(&scene).expect("it fits");
        assert!(fragment.bytes().all(|b| b.is_ascii_alphanumeric() || b"=-_".contains(&b)), "{fragment}");
        assert_eq!(of_fragment(&format!("#{fragment}")), Ok(Some(scene)), "{name}");
    }
}

#[test]
fn a_file_of_its_own_is_in_the_address_and_those_of_the_program_are_not() {
    let plain = scene("heart");
    let bytes: Arc<[u8]> = Arc::from(&b"<svg/>"[..]);
    let own = Shared { files: plain.files.clone().with([("mine.svg".into(), Arc::clone(&bytes))]), ..plain.clone() };
    let fragment = to_fragment(&own).expect("it fits");
    let back = of_fragment(&fragment).expect("a scene").expect("one");
    assert_eq!(back.files.file_in_memory("mine.svg"), Some(&bytes));
    assert_eq!(back, own);
    let plain = to_fragment(&plain).expect("it fits");
    assert!(plain.len() < 4000 && plain.len() < fragment.len(), "{} {}", plain.len(), fragment.len());
}

#[test]
fn names_are_addresses_too_and_wrong_ones_are_told() {
    assert_eq!(of_fragment("#"), Ok(None));
    assert_eq!(of_fragment("#jelly"), Ok(Some(scene("jelly"))));
    assert!(of_fragment("#jely").expect_err("no such scene").to_string().contains("jelly"));
}

#[test]
fn addresses_that_were_cut_off_or_changed_are_refused() {
    let fragment = to_fragment(&scene("ball")).expect("it fits");
    for length in [6, 7, fragment.len() / 2, fragment.len() - 1] {
        assert!(of_fragment(&fragment[..length]).is_err(), "{length}");
    }
    assert!(of_fragment("scene=§").is_err());
}

#[test]
fn a_scene_that_is_too_large_for_an_address_is_refused() {
    let mut seed = 1u64;
    let noise: Vec<u8> = (0..MOST_LETTERS)
        .map(|_| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 56) as u8
        })
        .collect();
    let large = Shared { files: Files::in_memory([("noise.ply".into(), Arc::from(noise))]), ..scene("ball") };
    assert!(to_fragment(&large).expect_err("too large").to_string().contains("too large"));
}

fn link() -> Link {
    let text = opruga::scenes::find("ball").expect("a scene of the program");
    let session = Session::open("ball", text, opruga::scenes::files(), Options::default()).expect("it opens");
    Link::start(session, || {}).expect("no thread is needed")
}

#[test]
fn turns_do_what_is_asked_and_nothing_moves_by_itself() {
    let link = link();
    link.turn();
    assert_eq!(link.shown().frames, 0);
    link.ask(Request::Step);
    assert_eq!(link.shown().frames, 0, "it waits for its turn");
    link.turn();
    assert_eq!(link.shown().frames, 1);
    let copied = link.copy();
    link.turn();
    assert_eq!(copied.try_recv().map(|copied| copied.frames), Ok(1));
}

#[test]
fn a_long_time_without_a_turn_is_not_made_up_for() {
    let link = link();
    link.ask(Request::Play(true));
    link.turn();
    let before = link.shown().frames;
    std::thread::sleep(Duration::from_millis(600));
    link.turn();
    // At most a tenth of a second, of which a frame may have been due before the first turn.
    let frames = link.shown().frames - before;
    assert!((1..=7).contains(&frames), "{frames} frames");
}

#[test]
fn turns_and_a_thread_come_to_the_same_bits() {
    let link = link();
    for _ in 0..30 {
        link.ask(Request::Step);
        link.turn();
    }
    let (text, files) = (opruga::scenes::find("ball").expect("a scene"), opruga::scenes::files());
    let mut session = Session::open("ball", text, files, Options::default()).expect("it opens");
    (0..30).for_each(|_| session.handle(Request::Step));
    assert_eq!(link.with_session(Session::hash), session.hash());
}

#[test]
fn work_that_breathes_is_done_on_its_thread() {
    let sum = spawn(async {
        let mut sum = 0;
        for k in 0..100 {
            breathe().await;
            sum += k;
        }
        sum
    });
    assert_eq!(sum.recv(), Ok(4950));
    assert_eq!(done(&sum), None, "it is received once");
}
