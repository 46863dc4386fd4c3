//! Actions of the pointer, and undo.

mod exploding;
mod hands;
mod landing;

use super::{Edit, Grip, Request, Session};
use crate::report::Step;
use crate::shown::{Offer, Severity};
use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::Value;
use opruga::io::scene;
use opruga::{Options, World, catalogue};
use std::time::Duration;

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

/// A ball that only the pointer pulls.
fn quiet() -> Session {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    Session::open("quiet", &text[..end], opruga::scenes::files(), Options::default()).expect("it opens")
}

fn ask(session: &mut Session, request: Request) {
    session.handle(request);
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
    let message = session.shown().message;
    assert!(message.as_ref().is_none_or(|m| m.severity == Severity::Done), "{message:?}");
}

fn pass(session: &mut Session, frames: u32) {
    (0..frames).for_each(|_| ask(session, Request::Step));
}

/// Asserts that a run of the saved text ends with the same bits.
fn assert_replays(session: &Session) {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let saved = session.saved();
    let read = scene::read(saved.as_bytes(), "saved.toml", &catalogue(), &options);
    let Ok((AnyBlueprint::Plane(blueprint), _)) = read else { panic!("{saved}") };
    let mut world = World::new(blueprint, Options::default()).expect("a world");
    (0..session.frames()).for_each(|_| world.frame().expect("a frame"));
    assert_eq!(world.state_hash(), session.hash(), "{saved}");
}

fn newtons(force: [f64; 3]) -> f64 {
    force.iter().map(|f| f * f).sum::<f64>().sqrt()
}

#[test]
fn what_is_undone_while_the_hand_holds_a_node_leaves_nothing_that_nobody_holds() {
    let mut session = quiet();
    pass(&mut session, 5);
    ask(&mut session, Request::Grab(Grip::Pin, 0, [0.0, 2.5, 0.0]));
    ask(&mut session, Request::Release);
    pass(&mut session, 20);
    let (body, node, point) = session.shown().pins[0];
    // This is like a double click: two presses, and the second one is still held.
    ask(&mut session, Request::Grab(Grip::Pull, body, point));
    ask(&mut session, Request::Release);
    ask(&mut session, Request::Grab(Grip::Pull, body, point));
    ask(&mut session, Request::Unpin(body, node));
    ask(&mut session, Request::Release);
    pass(&mut session, 2);
    ask(&mut session, Request::Undo);
    assert_eq!(session.shown().pins, [(body, node, point)]);
    let open_ends = |text: &str| text.matches("until = 1000000000").count();
    assert_eq!(open_ends(&session.text()), 1, "the pin alone: {}", session.text());
    pass(&mut session, 30);
    assert!(session.shown().pulls.is_empty());
    assert_replays(&session);
    // A scene that is saved during a pull contains its release, too.
    ask(&mut session, Request::Grab(Grip::Pull, 0, [0.4, 2.0, 0.0]));
    for saved_at in [0, 3] {
        pass(&mut session, saved_at);
        assert_eq!(open_ends(&session.saved()), 1, "{}", session.saved());
        assert_eq!(open_ends(&session.text()), 2);
        assert_replays(&session);
    }
    // The scene after an undo contains the release as well, whatever was done in between.
    let gravity = Value::Numbers(vec![0.0, -3.0]);
    ask(&mut session, Request::Set("world.gravity".into(), gravity));
    pass(&mut session, 3);
    ask(&mut session, Request::Undo);
    pass(&mut session, 3);
    assert!(session.shown().pulls.is_empty());
    assert_replays(&session);
}

#[test]
fn a_point_that_was_pinned_or_taken_elsewhere_is_as_before_after_undo() {
    let mut session = open("ball");
    pass(&mut session, 10);
    ask(&mut session, Request::Grab(Grip::Pin, 0, [0.0, 2.5, 0.0]));
    ask(&mut session, Request::Release);
    assert_eq!(session.shown().undo, Some(Step::Pin));
    pass(&mut session, 10);
    let pinned = session.shown().pins;
    // The pinned point moves with the pointer.
    ask(&mut session, Request::Grab(Grip::Pin, 0, pinned[0].2));
    for k in 0..10 {
        ask(&mut session, Request::Lead([0.05 * f64::from(k), 2.5, 0.0]));
        pass(&mut session, 1);
    }
    ask(&mut session, Request::Release);
    let moved = session.shown().pins;
    assert!(moved[0].2[0] > pinned[0].2[0] + 0.1, "{moved:?}");
    ask(&mut session, Request::Undo);
    assert_eq!((session.frames(), session.shown().pins), (20, pinned.clone()));
    pass(&mut session, 5);
    assert_eq!(session.shown().pins, pinned);
    assert_replays(&session);
    ask(&mut session, Request::Undo);
    assert_eq!((session.frames(), session.shown().pins.len()), (10, 0));
    assert_eq!(session.shown().undo, None);
    ask(&mut session, Request::Redo);
    assert_eq!(session.shown().pins.len(), 1);
    pass(&mut session, 5);
    assert_replays(&session);
}

#[test]
fn a_push_follows_the_pointer_and_stays_the_same_while_that_stands_still() {
    let mut session = quiet();
    pass(&mut session, 5);
    let pressed = [0.4, 2.0, 0.0];
    let force = |session: &mut Session| session.shown().pushes.first().map(|[.., force]| *force);
    ask(&mut session, Request::Grab(Grip::Push, 0, pressed));
    ask(&mut session, Request::Lead(pressed));
    pass(&mut session, 3);
    assert_eq!(force(&mut session), None, "without a displacement there is no force");
    // The first movement of the pointer is small.
    ask(&mut session, Request::Lead([0.41, 2.0, 0.0]));
    assert!((newtons(force(&mut session).expect("a push")) - 0.2).abs() < 1e-9);
    ask(&mut session, Request::Lead([0.9, 2.5, 0.0]));
    let steady = force(&mut session).expect("a push");
    assert!((steady[0] - 10.0).abs() < 1e-9 && (steady[1] - 10.0).abs() < 1e-9, "{steady:?}");
    let node = session.shown().pushes[0][0];
    pass(&mut session, 20);
    assert_eq!(force(&mut session), Some(steady), "the pointer stands still, the node moves");
    assert_ne!(session.shown().pushes[0][0], node);
    let pushes = |session: &Session| session.text().matches("do = \"push\"").count();
    assert_eq!(pushes(&session), 1, "one force is one command");
    // The pointer does not push when it is back at the point of the press, nor after it is released.
    ask(&mut session, Request::Lead(pressed));
    pass(&mut session, 3);
    assert_eq!((force(&mut session), pushes(&session)), (None, 1));
    ask(&mut session, Request::Lead([0.4, 1.5, 0.0]));
    pass(&mut session, 3);
    ask(&mut session, Request::Release);
    assert_eq!((force(&mut session), pushes(&session)), (None, 2));
    assert!(!session.text().contains("until = 1000000000"));
    pass(&mut session, 5);
    assert_replays(&session);
}

#[test]
fn while_time_stands_a_pull_follows_the_pointer_and_one_that_was_let_go_is_over() {
    let mut session = quiet();
    pass(&mut session, 5);
    for steps in [0, 4] {
        ask(&mut session, Request::Grab(Grip::Pull, 0, [0.0, 2.5, 0.0]));
        pass(&mut session, steps);
        ask(&mut session, Request::Lead([0.3, 2.9, 0.0]));
        let pulls = session.shown().pulls;
        assert_eq!(pulls.len(), 1);
        let [node, pointer, force] = pulls[0];
        assert_eq!(pointer, [0.3, 2.9, 0.0]);
        // The displayed force already points towards the new position of the pointer.
        assert!(force[0] > 1.0 && force[1] > 1.0 && node[1] < 2.9, "{force:?}");
        // However far the pointer moves, the displayed force is not larger than the force in the world can be.
        ask(&mut session, Request::Lead([1e6, 2.9, 0.0]));
        let [stiffness, most] = session.engine.usual_pull(0).expect("a body");
        let far = newtons(session.shown().pulls[0][2]);
        assert!(stiffness > 100.0 && (far - most).abs() < 1e-6 * most, "{far} of {most}");
        ask(&mut session, Request::Lead([0.3, 2.9, 0.0]));
        ask(&mut session, Request::Release);
        assert!(session.shown().pulls.is_empty(), "after {steps} frames");
        pass(&mut session, 1);
        assert!(session.shown().pulls.is_empty(), "a frame later");
        assert_replays(&session);
    }
}

#[test]
fn curves_are_the_same_after_going_back_and_forth_and_side_by_side_and_know_no_future_that_was_cut_off() {
    let mut session = quiet();
    pass(&mut session, 40);
    let samples = |session: &mut Session| {
        let samples = session.shown().samples.read().expect("no panic").clone();
        let mut all = samples.all().to_vec();
        // The computing time differs from run to run.
        all.iter_mut().for_each(|sample| sample.cost = 0.0);
        assert_eq!(samples.runs().count(), 1, "no gaps");
        all
    };
    let before = samples(&mut session);
    assert_eq!(before.len(), 41);
    assert!(before[40].energy[0] > before[0].energy[0] && !before[40].readings_of(0).is_empty());
    assert!((before[20].time - session.time_of(20)).abs() < 1e-12);
    for frame in [13, 0, 40] {
        ask(&mut session, Request::Seek(frame));
        assert_eq!(samples(&mut session), before, "at frame {frame}");
    }
    ask(&mut session, Request::Compare(true));
    let both = samples(&mut session);
    assert_eq!(both.len(), 41);
    assert!(both.iter().all(|sample| sample.beside.is_some_and(|beside| beside[0] == 0.0)));
    ask(&mut session, Request::Compare(false));
    assert_eq!(samples(&mut session), before);
    // Another action at an earlier frame starts a different future.
    ask(&mut session, Request::Seek(25));
    let gravity = Value::Numbers(vec![0.0, 3.0]);
    ask(&mut session, Request::Set("world.gravity".into(), gravity));
    assert_eq!(samples(&mut session), before[..=25]);
    pass(&mut session, 10);
    let other = samples(&mut session);
    assert_eq!(other.len(), 36);
    assert_ne!(other[35].energy, before[35].energy);
    ask(&mut session, Request::Undo);
    assert_eq!(samples(&mut session), before[..=25]);
}

/// A number of substeps with which a frame takes half a minute is not offered, because nothing else could be done in the meantime.
#[test]
fn substeps_of_which_a_frame_would_take_long_are_refused_with_its_duration_and_a_coarser_body_is_offered_instead() {
    let mut session = quiet();
    session.handle(Request::Play(true));
    let clock = std::cell::Cell::new(Duration::ZERO);
    // Assume that a frame takes 20 ms on this machine.
    for _ in 0..80 {
        session.tick(Duration::from_millis(40), Duration::from_millis(30), &|| {
            clock.set(clock.get() + Duration::from_millis(20));
            clock.get()
        });
    }
    session.handle(Request::Play(false));
    let (frames, hash) = (session.frames(), session.hash());
    assert!(frames > 40, "{frames}");
    let finer = |vertices| Request::Edit(Edit::Shape("ball".into(), "vertices", Value::Integer(vertices)));
    session.handle(finer(4000));
    let message = session.shown().message.expect("a refusal");
    assert_eq!((message.severity, session.hash()), (Severity::Refused, hash));
    assert!(message.frame_seconds.is_some_and(|seconds| seconds > 30.0), "{message:?}");
    let Some(Offer::Coarser(body, field, value)) = message.offer.clone() else { panic!("{message:?}") };
    assert!(body == "ball" && field == "vertices" && (37..2000).contains(&value), "{value}");
    ask(&mut session, Request::Accept(message.offer.expect("the offer")));
    let shown = session.shown();
    assert_eq!((shown.bodies.len(), shown.bodies[0].nodes as i64), (1, value));
    pass(&mut session, 2);
    assert_replays(&session);
    // If a frame with the needed number of substeps does not take long, this number is offered.
    let stiffness =
        |k| Request::Set(format!("body.{}.models.mass_spring.stiffness", shown.bodies[0].name), Value::Number(k));
    session.handle(stiffness(16_000.0));
    let message = session.shown().message.expect("a refusal");
    assert!(matches!(message.offer, Some(Offer::Substeps(n)) if n > shown.substeps), "{message:?}");
    // A number of substeps that is too small is refused, and no number is offered, because the present number is sufficient.
    session.handle(Request::Set("time.substeps".into(), Value::Integer(1)));
    let message = session.shown().message.expect("a refusal");
    assert!(message.severity == Severity::Refused && message.offer.is_none(), "{message:?}");
}

#[test]
fn another_integrator_that_is_offered_after_a_divergence_comes_with_the_substeps_that_it_needs() {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let text = text[..end].replace("damping = 1.0", "damping = 0.0").replace("substeps = 32", "substeps = 2");
    let text = text.replace("kind = \"verlet\"", "kind = \"explicit_euler\"");
    let mut session = Session::open("growing", &text, opruga::scenes::files(), Options::default()).expect("it opens");
    session.handle(Request::Play(true));
    for _ in 0..600 {
        session.tick(Duration::from_millis(17), Duration::from_millis(12), &|| Duration::ZERO);
    }
    let message = session.shown().message.expect("it diverges");
    assert_eq!(message.offer, Some(Offer::Steady(None, "symplectic_euler")), "{message:?}");
    ask(&mut session, Request::Accept(Offer::Steady(None, "symplectic_euler")));
    let shown = session.shown();
    assert!(shown.playing && shown.substeps > 2, "{}", shown.substeps);
    assert_eq!(shown.integrator.as_ref().map(|values| values.kind()), Some("symplectic_euler"));
    pass(&mut session, 30);
    assert_replays(&session);
}

#[test]
fn what_one_scene_differs_in_from_that_beside_it_is_to_be_saved_too() {
    let mut session = quiet();
    assert!(!session.is_edited());
    pass(&mut session, 3);
    ask(&mut session, Request::Compare(true));
    assert!(!session.is_edited(), "time has passed, and nothing was done");
    let softer =
        crate::differences::Difference::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(900.0));
    ask(&mut session, Request::Differ(softer));
    assert!(session.is_edited());
    let mark = session.mark();
    ask(&mut session, Request::Saved(mark));
    assert!(!session.is_edited());
    ask(&mut session, Request::Grab(Grip::Pull, 0, [0.4, 2.0, 0.0]));
    pass(&mut session, 1);
    assert!(session.is_edited());
}

/// Contact is switched on at the start, and its parameters change while bodies move. The command line repeats the scene.
#[test]
fn bodies_that_land_on_each_other_touch_once_contact_is_switched_on() {
    let text = opruga::scenes::find("pressures").expect("it").replace("center = [1.7, 1.6]", "center = [0.2, 2.8]");
    let mut session = Session::open("landing", &text, opruga::scenes::files(), Options::default()).expect("it opens");
    assert!(session.shown().contact.is_none());
    let height = |session: &mut Session| {
        let center = |body: usize| {
            let positions = session.shown().picture.bodies[body].positions.clone();
            positions.iter().fold(0.0, |sum, x| sum + x[1] / positions.len() as f64)
        };
        [0, 1].map(center)
    };
    let touch = |on: bool| Request::Edit(Edit::Contact(on));
    ask(&mut session, touch(true));
    ask(&mut session, touch(false));
    assert!(session.shown().contact.is_none() && !session.saved().contains("[contact]"));
    ask(&mut session, Request::Undo);
    assert_eq!(session.shown().contact.as_ref().and_then(|values| values.number("friction")), Some(0.0));
    ask(&mut session, Request::Set("contact.restitution".into(), Value::Number(0.2)));
    assert!(session.saved().contains("[contact]\nrestitution = 0.2"), "{}", session.saved());
    pass(&mut session, 60);
    ask(&mut session, Request::Set("contact.friction".into(), Value::Number(0.7)));
    assert_eq!(session.shown().contact.as_ref().and_then(|values| values.number("friction")), Some(0.7));
    pass(&mut session, 60);
    assert_replays(&session);
    let [lower, upper] = height(&mut session);
    assert!(upper - lower > 0.3 || (upper - lower).abs() < 0.2, "one lies on the other or beside it: {lower} {upper}");
    // Contact cannot be switched off while bodies move.
    let hash = session.hash();
    session.handle(touch(false));
    let message = session.shown().message.expect("a refusal");
    assert_eq!((message.severity, message.report), (Severity::Refused, crate::report::Report::ContactAtTheStartAlone));
    assert_eq!(session.hash(), hash);
}
