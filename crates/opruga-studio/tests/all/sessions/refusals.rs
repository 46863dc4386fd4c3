//! A refused request changes nothing, and a remedy is offered.

use super::{arrive, assert_replays, ball, integrator, model, no_refusal, open, pass, refusal};
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
        // Nobody has seen the text that the studio writes, so its lines mean nothing.
        assert!(!said.contains("ball.toml"), "{asked}: {said}");
        assert_eq!((session.hash(), session.text()), (hash, text.clone()), "{asked}");
    }
    // A sufficient step is offered, and accepted.
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

/// The offer of a message about a scene that was not opened changes that scene, not the open one.
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

/// In the studio, time continues after the end that a scene gives for a run, and commands there are executed.
#[test]
fn commands_behind_the_stated_end_of_a_scene_are_not_warned_of() {
    let text = opruga::scenes::find("ball").expect("it").replace("seconds = 8.0", "seconds = 0.1");
    let mut session = Session::open("short", &text, Files::default(), Options::default()).expect("it opens");
    let never = |session: &mut Session| {
        arrive(session);
        no_refusal(session);
        let shown = session.shown();
        let right = shown.beside.map_or(Vec::new(), |beside| beside.right.warnings.clone());
        let told: Vec<_> = shown.warnings.into_iter().chain(right).map(|warning| warning.code).collect();
        assert!(!told.contains(&"command.never".to_string()), "{told:?}");
    };
    never(&mut session);
    pass(&mut session, 12);
    for request in [
        Request::Set("world.gravity".into(), Value::Numbers(vec![0.0, -5.0])),
        Request::Edit(Edit::Add(ball("small", 1.4))),
        Request::Edit(Edit::Shape("ball".into(), "vertices", Value::Integer(48))),
        Request::Compare(true),
        Request::Undo,
    ] {
        session.handle(request);
        never(&mut session);
    }
    pass(&mut session, 3);
    assert_replays(&session);
}

/// The window calls a replaced body by its old name, and so do messages about it.
#[test]
fn messages_and_warnings_call_a_body_that_was_set_down_anew_by_the_name_that_the_window_shows() {
    let mut session = open("ball");
    pass(&mut session, 5);
    let finer =
        |name: &str, vertices: i64| Request::Edit(Edit::Shape(name.into(), "vertices", Value::Integer(vertices)));
    // Even if the first change is refused, it is still the same body.
    for name in ["ball", "ball-2"] {
        session.handle(finer(name, 4000));
        let said = refusal(&mut session);
        assert!(said.contains("unstable") && said.contains("`ball`") && !said.contains("ball-"), "{said}");
        if name == "ball" {
            session.handle(finer(name, 48));
            no_refusal(&mut session);
        }
    }
    let shown = session.shown();
    assert_eq!((shown.bodies[0].name.as_str(), shown.bodies[0].title.as_str()), ("ball-2", "ball"));
    let number = shown.bodies[0].number;
    for request in [
        Request::Set("body.ball-2.models.mass_spring.stiffness".into(), Value::Number(1e7)),
        Request::Set("body.ball-2.models.mass_spring.stiffness".into(), Value::Number(-1.0)),
        Request::Models(number, vec![model("mass_spring", &[("stiffness", 1e9)])]),
    ] {
        session.handle(request);
        let said = refusal(&mut session);
        assert!(said.contains("ball") && !said.contains("ball-2"), "{said}");
    }
    let undamped = model("mass_spring", &[("stiffness", 800.0), ("damping", 0.0)]);
    for request in [Request::Models(number, vec![undamped]), Request::Integrator(Some(number), integrator("heun"))] {
        session.handle(request);
        no_refusal(&mut session);
        let message = session.shown().message.expect("it goes on");
        assert!(message.text.starts_with("`ball` "), "{}", message.text);
    }
    session.handle(Request::Compare(true));
    arrive(&mut session);
    let shown = session.shown();
    let right = shown.beside.expect("two scenes").right;
    assert_eq!(right.bodies[0].title, "ball");
    for warnings in [&shown.warnings, &right.warnings] {
        let growing = warnings.iter().find(|warning| warning.code == "step.no_stable_step").expect("a warning");
        assert!(growing.message.contains("body `ball`"), "{}", growing.message);
    }
    pass(&mut session, 2);
    assert_replays(&session);
}

/// If no step is stable, half of it is not, either: an integrator with a stable step is offered for the body or scene that uses the other one.
#[test]
fn where_no_step_is_stable_another_integrator_is_offered_and_not_half_the_step() {
    let ball = opruga::scenes::find("ball").expect("it").replace("damping = 1.0", "damping = 0.0");
    let text = ball.replace("[[collider]]", "[[load]]\nkind = \"force\"\nbody = \"ball\"\nvalue = [1e300, 0.0]\ncurve = [[0.0, 0.0], [0.2, 0.0], [0.3, 1.0]]\n\n[[collider]]");
    let of_the_scene = text.replace("kind = \"verlet\"", "kind = \"explicit_euler\"");
    let of_the_body = text.replace("mass = 1.0", "mass = 1.0\nintegrator = { kind = \"explicit_euler\" }");
    for (text, own) in [(of_the_scene, None), (of_the_body, Some(0))] {
        let mut session = Session::open("growing", &text, Files::default(), Options::default()).expect("it opens");
        session.handle(Request::Play(true));
        for _ in 0..60 {
            session.tick(Duration::from_millis(17), Duration::from_millis(12), &|| Duration::ZERO);
        }
        refusal(&mut session);
        assert_eq!(
            session.shown().message.and_then(|message| message.offer),
            Some(Offer::Steady(own, "symplectic_euler"))
        );
        let substeps = session.shown().substeps;
        session.handle(Request::Accept(Offer::Steady(own, "symplectic_euler")));
        no_refusal(&mut session);
        let shown = session.shown();
        let kind =
            |values: &Option<opruga::core::spec::Values>| values.as_ref().map(|values| values.kind().to_string());
        let (scene, body) = (kind(&shown.integrator), kind(&shown.bodies[0].integrator));
        let steady = Some("symplectic_euler".to_string());
        match own {
            None => assert_eq!(scene, steady),
            Some(_) => assert_eq!((scene, body), (Some("verlet".into()), steady)),
        }
        assert!(shown.playing && shown.substeps == substeps);
        assert!(shown.warnings.iter().all(|warning| warning.code != "step.no_stable_step"));
    }
}
