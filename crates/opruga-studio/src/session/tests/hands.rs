//! Pulls of the user together with the drags in a scene.

use super::{ask, assert_replays, pass, quiet};
use crate::report::Step;
use crate::session::{Grip, Request, Session};
use opruga::Options;

#[test]
fn a_pull_and_a_push_are_undone_and_done_again() {
    let mut session = quiet();
    pass(&mut session, 5);
    for (grip, step) in [(Grip::Pull, Step::Pull), (Grip::Push, Step::Push)] {
        let (before, text, from) = (session.hash(), session.text(), session.frames());
        ask(&mut session, Request::Grab(grip, 0, [0.4, 2.0, 0.0]));
        for k in 0..10 {
            ask(&mut session, Request::Lead([0.5, 2.0 + 0.05 * f64::from(k), 0.0]));
            pass(&mut session, 1);
        }
        ask(&mut session, Request::Release);
        let after = session.hash();
        assert_eq!(session.shown().undo, Some(step.clone()));
        ask(&mut session, Request::Undo);
        assert_eq!((session.hash(), session.text(), session.frames()), (before, text, from));
        assert_eq!((session.shown().undo, session.shown().redo), (None, Some(step)));
        pass(&mut session, 10);
        assert_ne!(session.hash(), after, "nobody pulls");
        assert_replays(&session);
        ask(&mut session, Request::Redo);
        assert_eq!((session.hash(), session.frames()), (after, from + 10));
        assert_replays(&session);
        ask(&mut session, Request::Undo);
    }
    // A press without movement is not a push, and leaves nothing to be undone.
    ask(&mut session, Request::Grab(Grip::Push, 0, [0.4, 2.0, 0.0]));
    pass(&mut session, 3);
    ask(&mut session, Request::Release);
    assert_eq!(session.shown().undo, None);
}

/// A ball with a drag from frame 8 to frame 16 and another drag from frame 30 on, and a second ball with a drag from 0.1 s on.
fn with_hands() -> Session {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let other = text[text.find("[[body]]").expect("a body")..text.find("[[collider]]").expect("a floor")]
        .replace("\"ball\"", "\"other\"");
    let other = other.replace("center = [0.0, 2.0]", "center = [3.0, 2.0]");
    let hand = |body: &str, from: f64, to: f64| {
        format!(
            "[[command]]\nat = {from}\nuntil = {to}\ndo = \"drag\"\nbody = \"{body}\"\nnode = \"nearest\"\n\
             path = [[{from}, 1.0, 2.0], [{to}, 2.0, 3.0]]\n\n"
        )
    };
    let hands = [hand("ball", 0.13, 0.27), hand("ball", 0.5, 4.0), hand("other", 0.1, 4.0)].concat();
    let text = format!("{}{other}{hands}", &text[..end]);
    Session::open("hands", &text, opruga::scenes::files(), Options::default()).expect("it opens")
}

#[test]
fn a_hand_that_is_in_the_scene_lets_go_of_a_body_that_a_person_takes_hold_of_and_a_reset_gives_it_back() {
    let pulls = |session: &mut Session| session.shown().pulls.len();
    let mut untouched = with_hands();
    pass(&mut untouched, 40);
    for (grip, first) in [(Grip::Pull, 12), (Grip::Push, 12), (Grip::Pull, 4), (Grip::Pull, 20)] {
        let mut session = with_hands();
        let begun = session.text();
        pass(&mut session, first);
        let (before, hash) = (pulls(&mut session), session.hash());
        // The second ball is dragged after frame 6, and the first one between its frames 8 and 16.
        assert_eq!(before, usize::from((8..16).contains(&first)) + usize::from(first > 6), "{first}");
        ask(&mut session, Request::Grab(grip, 0, [0.0, 2.4, 0.0]));
        for k in 0..30 {
            ask(&mut session, Request::Lead([0.1, 2.4 + 0.02 * f64::from(k), 0.0]));
            pass(&mut session, 1);
            let of_hand = usize::from(grip == Grip::Pull);
            let others = usize::from(session.frames() > 6);
            assert_eq!(pulls(&mut session), of_hand + others, "{grip:?} from {first}: frame {}", session.frames());
        }
        ask(&mut session, Request::Release);
        // The drag does not resume when the user releases the ball.
        pass(&mut session, 10);
        assert_eq!(pulls(&mut session), 1);
        assert_replays(&session);
        let after = session.hash();
        ask(&mut session, Request::Seek(u64::from(first) - 1));
        ask(&mut session, Request::Seek(u64::from(first) + 40));
        assert_eq!(session.hash(), after, "it comes to the same again");
        ask(&mut session, Request::Undo);
        assert_eq!((session.hash(), session.text(), session.shown().recorded), (hash, begun.clone(), 0));
        ask(&mut session, Request::Redo);
        ask(&mut session, Request::Reset);
        assert_eq!((session.text(), session.frames(), session.shown().recorded), (begun.clone(), 0, 0));
        pass(&mut session, 40);
        assert_eq!(session.hash(), untouched.hash(), "the hands are as they were");
        // When the reset is undone, the actions of the user are restored.
        ask(&mut session, Request::Undo);
        pass(&mut session, 1);
        assert_ne!(session.text(), begun);
        assert_replays(&session);
    }
}

#[test]
fn pins_are_let_go_by_their_own_commands_where_a_hand_of_the_scene_has_gone_meanwhile() {
    let mut session = with_hands();
    pass(&mut session, 3);
    ask(&mut session, Request::Grab(Grip::Pin, 0, [0.0, 2.5, 0.0]));
    ask(&mut session, Request::Release);
    pass(&mut session, 2);
    ask(&mut session, Request::Grab(Grip::Pull, 0, [0.5, 2.0, 0.0]));
    pass(&mut session, 4);
    ask(&mut session, Request::Release);
    let (body, node, _) = session.shown().pins[0];
    ask(&mut session, Request::Unpin(body, node));
    pass(&mut session, 4);
    assert!(session.shown().pins.is_empty());
    assert!(!session.text().contains("until = 1000000000"), "{}", session.text());
    assert_replays(&session);
}
