//! Back and forth in time: rewinding, undo and redo.

use super::{arrive, assert_replays, ball, no_refusal, open, pass, pull};
use opruga::core::spec::Value;
use opruga::io::Files;
use opruga_studio::session::{Edit, Grip, Request};

#[test]
fn rewinding_comes_to_the_same_bits_and_what_is_done_then_replaces_the_future() {
    let mut session = open("ball");
    let mut hashes = vec![session.hash()];
    for _ in 0..30 {
        pass(&mut session, 1);
        hashes.push(session.hash());
    }
    pull(&mut session, 25);
    for _ in 0..20 {
        pass(&mut session, 1);
    }
    let end = session.hash();
    for frame in [3, 25, 10, 0, 30] {
        session.handle(Request::Seek(frame));
        arrive(&mut session);
        assert_eq!((session.frames(), session.hash()), (frame, hashes[frame as usize]));
    }
    session.handle(Request::Seek(75));
    arrive(&mut session);
    assert_eq!(session.hash(), end, "the pull happens again");
    assert!(session.shown().recorded > 0);
    // From the middle of the pull on, another future.
    session.handle(Request::Seek(40));
    arrive(&mut session);
    session.handle(Request::Set("world.gravity".into(), Value::Numbers(vec![0.0, 3.0])));
    pass(&mut session, 20);
    assert_eq!(session.shown().latest, 60);
    assert_replays(&session);
    assert_ne!(session.hash(), end);
}

#[test]
fn a_point_stays_pinned_when_the_future_is_written_anew() {
    let mut session = open("ball");
    pass(&mut session, 10);
    session.handle(Request::Grab(Grip::Pin, 0, [0.0, 2.5, 0.0]));
    session.handle(Request::Release);
    pass(&mut session, 20);
    let (body, node, place) = session.shown().pins[0];
    session.handle(Request::Unpin(body, node));
    pass(&mut session, 20);
    assert!(session.shown().pins.is_empty());
    session.handle(Request::Seek(20));
    arrive(&mut session);
    assert_eq!(session.shown().pins, [(body, node, place)]);
    // From here on another future, in which nobody lets go of it.
    session.handle(Request::Set("world.gravity".into(), Value::Numbers(vec![0.0, -2.0])));
    pass(&mut session, 40);
    assert_eq!(session.shown().pins, [(body, node, place)]);
    assert_replays(&session);
    session.handle(Request::Undo);
    arrive(&mut session);
    session.handle(Request::Unpin(body, node));
    pass(&mut session, 10);
    assert!(session.shown().pins.is_empty());
    assert_replays(&session);
}

#[test]
fn undo_goes_back_to_the_moment_before_an_edit_and_redo_does_it_again() {
    let mut session = open("ball");
    pass(&mut session, 25);
    let before = session.hash();
    session.handle(Request::Edit(Edit::Add(ball("small", 1.4))));
    session.handle(Request::Set("body.small.models.pressure.nRT".into(), Value::Number(20.0)));
    no_refusal(&mut session);
    pass(&mut session, 20);
    let after = session.hash();
    session.handle(Request::Undo);
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!((session.frames(), session.hash(), session.shown().bodies.len()), (25, before, 1));
    session.handle(Request::Redo);
    session.handle(Request::Redo);
    arrive(&mut session);
    assert_eq!(session.shown().bodies.len(), 2);
    session.handle(Request::Seek(45));
    arrive(&mut session);
    if session.frames() < 45 {
        let left = 45 - session.frames() as u32;
        pass(&mut session, left);
    }
    assert_eq!(session.hash(), after);
    session.handle(Request::Redo);
    assert!(session.shown().redo.is_none());
    assert_replays(&session);
}

#[test]
fn from_a_scene_that_was_opened_there_is_a_way_back_to_what_was_done_in_the_one_before() {
    let mut session = open("ball");
    pull(&mut session, 12);
    let (hash, saved) = (session.hash(), session.saved());
    let text = opruga::scenes::find("pressures").expect("a scene");
    let request = Request::Open { name: "pressures".into(), text: text.into(), files: Files::default() };
    session.handle(request.clone());
    pass(&mut session, 3);
    assert_eq!(session.name(), "pressures");
    assert_eq!(session.shown().undo, Some(opruga_studio::said::Step::Open("ball".into())));
    session.handle(Request::Undo);
    assert_eq!((session.name(), session.hash(), session.saved()), ("ball", hash, saved));
    assert!(!session.is_moving());
    session.handle(Request::Seek(3));
    arrive(&mut session);
    assert_eq!(session.frames(), 3);
    // Where nothing was done there is nothing to come back to.
    let mut fresh = open("ball");
    fresh.handle(request);
    assert_eq!(fresh.shown().undo, None);
}
