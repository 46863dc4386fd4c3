//! The saved scene contains the actions of the user: every run of it gives the same bits.

use super::{assert_replays, ball, integrator, model, no_refusal, open, pass, pull, replayed};
use opruga::core::spec::Value;
use opruga_studio::session::{Edit, Grip, Placed, Request};

#[test]
fn what_a_person_does_runs_to_the_same_bits_from_the_saved_scene() {
    let mut session = open("ball");
    pass(&mut session, 20);
    pull(&mut session, 40);
    session.handle(Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(1200.0)));
    pass(&mut session, 10);
    session.handle(Request::Grab(Grip::Pin, 0, [0.0, 2.5, 0.0]));
    session.handle(Request::Release);
    pass(&mut session, 15);
    let (_, node, _) = session.shown().pins[0];
    session.handle(Request::Unpin(0, node));
    session.handle(Request::Grab(Grip::Push, 0, [0.4, 1.0, 0.0]));
    for k in 0..10 {
        session.handle(Request::Lead([1.0, 1.0 + 0.1 * f64::from(k), 0.0]));
        pass(&mut session, 1);
    }
    session.handle(Request::Release);
    session.handle(Request::Set("world.gravity".into(), Value::Numbers(vec![1.0, -4.0])));
    session.handle(Request::Models(
        0,
        vec![model("pressure", &[("nRT", 40.0)]), model("mass_spring", &[("stiffness", 800.0)])],
    ));
    session.handle(Request::Edit(Edit::Add(ball("small", 1.4))));
    no_refusal(&mut session);
    pass(&mut session, 30);
    session.handle(Request::Integrator(None, integrator("runge_kutta")));
    pass(&mut session, 30);
    let turned = Placed { moved: [0.3, 0.5, 0.0], turned: 0.7, scaled: 1.2 };
    session.handle(Request::Edit(Edit::Transform("small".into(), turned)));
    pass(&mut session, 30);
    session.handle(Request::Edit(Edit::Delete("ball".into())));
    pass(&mut session, 30);
    assert_eq!(session.shown().bodies.len(), 1);
    assert_replays(&session);
    assert_ne!(session.hash(), replayed(opruga::scenes::find("ball").expect("it"), session.frames()));
}

#[test]
fn a_pull_in_space_runs_to_the_same_bits_and_its_force_is_told() {
    let mut session = open("balloons");
    pass(&mut session, 5);
    session.handle(Request::Grab(Grip::Pull, 1, [-0.3, 1.7, 0.2]));
    session.handle(Request::Lead([-0.3, 2.2, 0.6]));
    pass(&mut session, 8);
    let [node, pointer, force] = session.shown().pulls[0];
    assert!(pointer[1] > node[1] && force[1] > 0.1, "{node:?} {pointer:?} {force:?}");
    session.handle(Request::Release);
    pass(&mut session, 4);
    assert!(session.shown().pulls.is_empty());
    assert_replays(&session);
}
