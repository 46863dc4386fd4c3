//! Travel in time: rewinding, undo and redo.

use super::{arrive, assert_replays, ball, no_refusal, open, pass, pull};
use opruga::core::spec::Value;
use opruga::io::Files;
use opruga_studio::session::{Edit, Grip, Placed, Request, Session};

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
    // A different future from the middle of the pull on.
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
    // A different future from here on, in which the pull is not released.
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
fn bodies_added_while_time_stands_still_are_seen_at_once_after_undo_and_redo_and_when_one_comes_back_to_their_moment() {
    let mut session = open("ball");
    pass(&mut session, 25);
    let bodies = |session: &mut Session| {
        arrive(session);
        no_refusal(session);
        (session.frames(), session.shown().bodies.len())
    };
    session.handle(Request::Edit(Edit::Add(ball("first", 1.4))));
    session.handle(Request::Edit(Edit::Add(ball("second", -1.4))));
    let added = (bodies(&mut session), session.hash());
    assert_eq!(added.0, (25, 3));
    session.handle(Request::Undo);
    assert_eq!(bodies(&mut session), (25, 2), "what was done before it is still there");
    session.handle(Request::Undo);
    assert_eq!(bodies(&mut session), (25, 1));
    session.handle(Request::Redo);
    assert_eq!(bodies(&mut session), (25, 2));
    session.handle(Request::Redo);
    assert_eq!((bodies(&mut session), session.hash()), added);
    session.handle(Request::Seek(10));
    assert_eq!(bodies(&mut session), (10, 1));
    session.handle(Request::Seek(25));
    assert_eq!((bodies(&mut session), session.hash()), added);
    pass(&mut session, 5);
    assert_replays(&session);
}

/// One undo reverts one action, however often the same action was done at one moment.
#[test]
fn edits_of_one_kind_while_time_stands_still_are_undone_and_redone_one_by_one() {
    let mut session = open("ball");
    pass(&mut session, 25);
    let state = |session: &mut Session| {
        arrive(session);
        no_refusal(session);
        let bodies = session.shown().bodies;
        (bodies.into_iter().map(|body| (body.name, body.nodes)).collect::<Vec<_>>(), session.text())
    };
    let last = |session: &mut Session| session.shown().bodies.last().expect("a body").name.clone();
    let mut states = vec![state(&mut session)];
    let edits: [fn(String) -> Edit; 8] = [
        |_| Edit::Add(ball("small", 1.4)),
        |_| Edit::Add(ball("small", -1.4)),
        Edit::Duplicate,
        Edit::Duplicate,
        |name| Edit::Shape(name, "vertices", Value::Integer(30)),
        |name| Edit::Shape(name, "vertices", Value::Integer(48)),
        Edit::Delete,
        Edit::Delete,
    ];
    for edit in edits {
        let name = last(&mut session);
        session.handle(Request::Edit(edit(name)));
        let now = state(&mut session);
        assert_ne!(Some(&now), states.last());
        states.push(now);
    }
    for _ in 0..2 {
        for before in states.iter().rev().skip(1) {
            session.handle(Request::Undo);
            assert_eq!(&state(&mut session), before);
        }
        assert_eq!(session.shown().undo, None);
        for after in &states[1..] {
            session.handle(Request::Redo);
            assert_eq!(&state(&mut session), after);
        }
        assert_eq!(session.shown().redo, None);
    }
    assert_eq!(session.frames(), 25);
    pass(&mut session, 5);
    assert_replays(&session);
}

#[test]
fn a_slider_that_is_drawn_while_time_stands_still_is_one_edit_and_two_moves_are_two() {
    let mut session = open("ball");
    pass(&mut session, 25);
    let stiffness = "body.ball.models.mass_spring.stiffness";
    for value in [700.0, 800.0, 900.0] {
        session.handle(Request::Set(stiffness.into(), Value::Number(value)));
    }
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!(session.shown().undo, None);
    let middle = |session: &mut Session| {
        arrive(session);
        no_refusal(session);
        let positions = session.shown().picture.bodies[0].positions.clone();
        positions.iter().map(|p| p[0]).sum::<f64>() / positions.len() as f64
    };
    let start = middle(&mut session);
    for _ in 0..2 {
        let name = session.shown().bodies[0].name.clone();
        let placed = Placed { moved: [0.3, 0.0, 0.0], turned: 0.0, scaled: 1.0 };
        session.handle(Request::Edit(Edit::Transform(name, placed)));
    }
    // Pictures have single precision.
    for moved in [0.6, 0.3, 0.0] {
        let x = middle(&mut session);
        assert!((x - start - moved).abs() < 1e-5, "{x} {start} {moved}");
        session.handle(Request::Undo);
    }
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
    assert_eq!(session.shown().undo, Some(opruga_studio::report::Step::Open("ball".into())));
    session.handle(Request::Undo);
    assert_eq!((session.name(), session.hash(), session.saved()), ("ball", hash, saved));
    assert!(!session.is_moving());
    session.handle(Request::Seek(3));
    arrive(&mut session);
    assert_eq!(session.frames(), 3);
    // If nothing was done, there is nothing to return to.
    let mut fresh = open("ball");
    fresh.handle(request);
    assert_eq!(fresh.shown().undo, None);
}
