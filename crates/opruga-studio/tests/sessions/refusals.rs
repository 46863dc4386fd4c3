//! What is refused leaves everything as it was, and what would help is offered.

use super::{arrive, assert_replays, ball, model, no_refusal, open, pass, refusal};
use opruga::Options;
use opruga::core::spec::Value;
use opruga::io::Files;
use opruga_studio::session::{Edit, Grip, Request, Session};
use opruga_studio::shown::Offer;
use std::time::Duration;

#[test]
fn what_is_refused_leaves_everything_as_it_was_and_says_what_would_help() {
    let mut session = open("ball");
    pass(&mut session, 12);
    let (hash, text) = (session.hash(), session.text());
    let mut unknown = ball("odd", 1.0);
    unknown.insert("models", "[{ kind = \"springy\" }]".parse().expect("a list"));
    for (request, word) in [
        (Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(-1.0)), "allowed"),
        (Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(1e9)), "unstable"),
        (Request::Set("body.bal.models.mass_spring.stiffness".into(), Value::Number(1.0)), "did you mean"),
        (Request::Models(0, vec![model("mass_spring", &[("stiffness", 1e12)])]), "unstable"),
        (Request::Edit(Edit::Delete("nobody".into())), "no such body"),
        (Request::Edit(Edit::Add(unknown)), "springy"),
        (Request::Edit(Edit::Shape("ball".into(), "vertices", Value::Integer(1))), "vertices"),
        (Request::Open { name: "x".into(), text: "format = 3".into(), files: Files::default() }, "format"),
        (Request::Grab(Grip::Pull, 7, [0.0; 3]), "no body `7`"),
    ] {
        let asked = format!("{request:?}");
        session.handle(request);
        arrive(&mut session);
        let said = refusal(&mut session);
        assert!(said.contains(word), "{asked}: {said}");
        assert_eq!((session.hash(), session.text()), (hash, text.clone()), "{asked}");
    }
    // The step that would do is offered, and taken.
    session.handle(Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(640_000.0)));
    let offer = session.shown().message.and_then(|m| m.offer).expect("an offer");
    assert!(matches!(offer, Offer::Substeps(n) if n > 32), "{offer:?}");
    session.handle(Request::Accept(offer));
    no_refusal(&mut session);
    pass(&mut session, 5);
    assert_replays(&session);
}

#[test]
fn a_scene_that_diverges_names_body_and_node_and_stops_at_its_last_good_frame() {
    let text = opruga::scenes::find("ball").expect("it").replace("[[collider]]", "[[load]]\nkind = \"force\"\nbody = \"ball\"\nvalue = [1e300, 0.0]\ncurve = [[0.0, 0.0], [0.2, 0.0], [0.3, 1.0]]\n\n[[collider]]");
    let mut session = Session::open("bad", &text, Files::default(), Options::default()).expect("it opens");
    session.handle(Request::Play(true));
    for _ in 0..60 {
        session.tick(Duration::from_millis(17), Duration::from_millis(12), &|| Duration::ZERO);
    }
    let said = refusal(&mut session);
    assert!(said.contains("`ball`") && said.contains("node"), "{said}");
    let shown = session.shown();
    assert!(!shown.playing && shown.time > 0.1, "{}", shown.time);
    assert_eq!(shown.message.and_then(|m| m.offer), Some(Offer::HalveStep));
    assert!(shown.picture.bodies[0].positions.iter().flatten().all(|x| !x.is_nan()), "the last good state is shown");
    session.handle(Request::Accept(Offer::HalveStep));
    assert_eq!(session.shown().substeps, 64);
}

/// What a message offers for a scene that was not opened changes that scene, and not the one that is open.
#[test]
fn a_scene_that_was_refused_for_its_step_is_opened_with_the_substeps_that_are_offered() {
    let mut session = open("ball");
    let own = session.shown().substeps;
    let text = opruga::scenes::find("pressures").expect("a scene");
    let line = text.lines().find(|line| line.starts_with("substeps")).expect("it says its substeps");
    let text = text.replace(line, "substeps = 1");
    session.handle(Request::Open { name: "coarse".into(), text, files: Files::default() });
    assert!(refusal(&mut session).contains("unstable"));
    let offer = session.shown().message.and_then(|message| message.offer).expect("an offer");
    session.handle(Request::Accept(offer.clone()));
    no_refusal(&mut session);
    assert_eq!(session.name(), "coarse");
    assert_eq!(offer, Offer::Substeps(session.shown().substeps));
    assert_eq!(open("ball").shown().substeps, own);
}
