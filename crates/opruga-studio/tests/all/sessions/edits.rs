//! Bodies that are changed, moved, copied and removed.

use super::{arrive, assert_replays, integrator, no_refusal, open, pass};
use opruga::core::spec::Value;
use opruga_studio::report::Step;
use opruga_studio::session::{Edit, Placed, Request, Session};

#[test]
fn an_edit_at_the_start_is_written_into_the_scene_itself() {
    let mut session = open("ball");
    session.handle(Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(900.0)));
    session.handle(Request::Set("world.gravity".into(), Value::Numbers(vec![0.0, -1.6])));
    session.handle(Request::Edit(Edit::Shape("ball".into(), "vertices", Value::Integer(48))));
    session.handle(Request::Edit(Edit::Duplicate("ball".into())));
    session.handle(Request::Integrator(None, integrator("symplectic_euler")));
    no_refusal(&mut session);
    assert_eq!(session.shown().recorded, 0, "no commands");
    let text = session.text();
    assert!(text.contains("stiffness = 900.0") && text.contains("vertices = 48"), "{text}");
    assert!(text.contains("ball-2") && text.contains("# The elastic ball"), "comments stay: {text}");
    let shown = session.shown();
    assert_eq!(shown.bodies.iter().map(|b| b.nodes).collect::<Vec<_>>(), [48, 48]);
    pass(&mut session, 30);
    assert_replays(&session);
    for _ in 0..5 {
        session.handle(Request::Undo);
        arrive(&mut session);
    }
    assert_eq!(session.text(), opruga::scenes::find("ball").expect("it"));
}

#[test]
fn a_body_turns_and_grows_about_its_middle() {
    let mut session = open("ball");
    let middle = |session: &mut Session| {
        let positions = session.shown().picture.bodies[0].positions.clone();
        let mean = |d: usize| positions.iter().map(|p| p[d]).sum::<f64>() / positions.len() as f64;
        let far = positions.iter().map(|p| (p[0] - mean(0)).hypot(p[1] - mean(1))).fold(0.0, f64::max);
        (mean(0), mean(1), far)
    };
    let (x, y, radius) = middle(&mut session);
    let placed = Placed { moved: [0.5, 0.25, 0.0], turned: 1.1, scaled: 2.0 };
    session.handle(Request::Edit(Edit::Transform("ball".into(), placed)));
    no_refusal(&mut session);
    let (x2, y2, radius2) = middle(&mut session);
    // Pictures have single precision.
    assert!((x2 - x - 0.5).abs() < 1e-6 && (y2 - y - 0.25).abs() < 1e-6, "{x2} {y2}");
    assert!((radius2 - 2.0 * radius).abs() < 1e-6, "{radius2}");
}

#[test]
fn a_body_that_has_fallen_is_moved_turned_and_copied_from_where_it_is() {
    let mut session = open("ball");
    pass(&mut session, 30);
    let middle = |session: &mut Session, place: usize| {
        let positions = session.shown().picture.bodies[place].positions.clone();
        [0, 1].map(|d| positions.iter().map(|p| p[d]).sum::<f64>() / positions.len() as f64)
    };
    let [x, y] = middle(&mut session, 0);
    assert!(y < 1.5, "it has fallen: {y}");
    session.handle(Request::Edit(Edit::Duplicate("ball".into())));
    no_refusal(&mut session);
    let [beside, level] = middle(&mut session, 1);
    assert!(beside > x + 0.9 && (level - y).abs() < 1e-6, "{beside} {level}");
    let placed = Placed { moved: [-1.0, 0.5, 0.0], turned: 0.3, scaled: 1.5 };
    session.handle(Request::Edit(Edit::Transform("ball".into(), placed)));
    no_refusal(&mut session);
    let [x2, y2] = middle(&mut session, 1);
    assert!((x2 - x + 1.0).abs() < 1e-6 && (y2 - y - 0.5).abs() < 1e-6, "{x2} {y2}");
    assert_eq!(session.shown().renamed, [("ball".to_string(), "ball-3".to_string())]);
    pass(&mut session, 10);
    assert_replays(&session);
}

#[test]
fn pins_of_the_scene_can_be_freed_and_the_saved_scene_frees_them_too() {
    let mut session = open("hanging-net");
    pass(&mut session, 10);
    let pinned = session.shown().picture.bodies[0].pinned.clone();
    assert!(pinned.len() >= 2, "{pinned:?}");
    let (number, node) = (session.shown().bodies[0].number, pinned[0]);
    let place = session.shown().picture.bodies[0].positions[node as usize];
    session.handle(Request::Unpin(number, node));
    no_refusal(&mut session);
    pass(&mut session, 30);
    let shown = session.shown();
    assert_eq!(shown.picture.bodies[0].pinned, pinned[1..]);
    assert!(shown.picture.bodies[0].positions[node as usize][1] < place[1] - 0.05, "it falls");
    assert_replays(&session);
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!(session.shown().picture.bodies[0].pinned, pinned);
    assert_eq!(session.frames(), 10);
}

#[test]
fn a_body_that_is_set_down_anew_keeps_the_name_by_which_it_is_known() {
    let mut session = open("ball");
    let titles = |session: &mut Session| -> Vec<String> {
        session.shown().bodies.iter().map(|body| body.title.clone()).collect()
    };
    session.handle(Request::Step);
    let moved = Placed { moved: [0.3, 0.0, 0.0], turned: 0.0, scaled: 1.0 };
    for _ in 0..2 {
        let name = session.shown().bodies[0].name.clone();
        session.handle(Request::Edit(Edit::Transform(name, moved)));
        session.handle(Request::Step);
        assert_eq!(titles(&mut session), ["ball"]);
    }
    // A copy is another body, with a name of its own.
    let name = session.shown().bodies[0].name.clone();
    session.handle(Request::Edit(Edit::Duplicate(name)));
    let both = titles(&mut session);
    assert!(both.len() == 2 && both[0] == "ball" && both[1] != "ball", "{both:?}");
    for _ in 0..3 {
        session.handle(Request::Undo);
    }
    assert_eq!(titles(&mut session), ["ball"]);
}

#[test]
fn what_a_hand_draws_from_its_press_on_is_undone_as_one_however_many_frames_pass_meanwhile() {
    let mut session = open("ball");
    pass(&mut session, 5);
    let before = session.hash();
    let stiffness = "body.ball.models.mass_spring.stiffness";
    for k in 0..20 {
        session.handle(Request::Draw(7, stiffness.into(), Value::Number(1600.0 - 10.0 * f64::from(k))));
        pass(&mut session, 1);
    }
    let drawn = session.hash();
    // Another press is another edit, also of the same field and at the same moment.
    for k in 0..2 {
        session.handle(Request::Draw(8 + k, stiffness.into(), Value::Number(900.0 + k as f64)));
    }
    assert_replays(&session);
    for (hash, frame) in [(drawn, 25), (drawn, 25), (before, 5)] {
        assert_eq!(session.shown().undo, Some(Step::Set(stiffness.into())));
        session.handle(Request::Undo);
        arrive(&mut session);
        assert_eq!(session.frames(), frame);
        if frame == 5 {
            assert_eq!(session.hash(), hash);
        }
    }
    assert_eq!(session.shown().undo, None);
    assert_eq!(session.shown().bodies[0].models[0].number("stiffness"), Some(1600.0));
}

#[test]
fn an_arrow_of_gravity_that_is_drawn_is_one_edit_too() {
    let mut session = open("ball");
    for k in 0..10 {
        session.handle(Request::Draw(1, "world.gravity".into(), Value::Numbers(vec![0.1 * f64::from(k), -9.81])));
        pass(&mut session, 2);
    }
    assert_replays(&session);
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!((session.frames(), session.shown().undo, session.shown().gravity), (0, None, [0.0, -9.81, 0.0]));
}

#[test]
fn a_body_goes_back_to_the_integrator_of_the_scene() {
    let mut session = open("ball");
    let of_scene = session.shown().integrator;
    session.handle(Request::Integrator(Some(0), integrator("symplectic_euler")));
    assert_eq!(session.shown().bodies[0].integrator.as_ref().map(|values| values.kind()), Some("symplectic_euler"));
    session.handle(Request::AsTheScene(0));
    no_refusal(&mut session);
    assert_eq!((session.shown().bodies[0].integrator.clone(), session.shown().recorded), (None, 0));
    session.handle(Request::Undo);
    arrive(&mut session);
    assert!(session.shown().bodies[0].integrator.is_some());
    // During the run it is a command, and the body has an integrator of its own that is the same.
    pass(&mut session, 3);
    session.handle(Request::AsTheScene(0));
    no_refusal(&mut session);
    assert_eq!(session.shown().bodies[0].integrator, of_scene);
    pass(&mut session, 3);
    assert_replays(&session);
}

#[test]
fn a_turn_and_a_scaling_are_undone_by_their_names() {
    let mut session = open("ball");
    let place = |moved: [f64; 3], turned: f64, scaled: f64| {
        Request::Edit(Edit::Transform("ball".into(), Placed { moved, turned, scaled }))
    };
    for (request, step) in [
        (place([0.1, 0.0, 0.0], 0.0, 1.0), Step::Move),
        (place([0.0; 3], 0.3, 1.0), Step::Turn),
        (place([0.1, 0.0, 0.0], 0.0, 1.1), Step::Scale),
    ] {
        session.handle(request);
        assert_eq!(session.shown().undo, Some(step));
    }
}

/// If the user adds and removes fields of a model, its table is written again, without fields that have no effect and that nobody has set.
#[test]
fn models_that_are_written_anew_bring_no_warnings() {
    for frames in [0, 10] {
        let mut session = open("ball");
        pass(&mut session, frames);
        let body = session.shown().bodies[0].clone();
        session.handle(Request::Models(body.number, body.models.clone()));
        no_refusal(&mut session);
        pass(&mut session, 5);
        assert_replays(&session);
        let (text, files) = (session.saved(), opruga::scenes::files());
        let mut again = Session::open("ball", &text, files, opruga::Options::default()).expect("it opens");
        for warnings in [session.shown().warnings, again.shown().warnings] {
            assert!(warnings.is_empty(), "after {frames} frames: {:?}\n{text}", warnings[0].message);
        }
    }
}
