//! The end of a scene, edits, the hash, and frames that take long.

use super::{arrive, no_refusal, open, pass, replayed};
use opruga::Options;
use opruga::core::spec::Value;
use opruga::io::Files;
use opruga_studio::report::Report;
use opruga_studio::runner::{Copied, Link};
use opruga_studio::session::{Edit, Request, Session, by_the_clock};
use opruga_studio::shown::{Offer, Severity, Show};
use std::time::{Duration, Instant};

fn of(text: &str) -> Session {
    Session::open("it", text, Files::default(), Options::default()).expect("it opens")
}

/// A square of finite elements at rest.
const CALM: &str = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.1\nframe = 0.02\nsubsteps = 40\n\
    [integrator]\nkind = \"symplectic_euler\"\n[world]\ngravity = [0.0, 0.0]\n[[body]]\nname = \"it\"\nmass = 1.0\n\
    shape = { kind = \"grid\", corner = [0.0, 0.0], size = [1.0, 1.0], cells = [4, 4] }\n\
    models = [{ kind = \"fem\", youngs_modulus = 100.0, poissons_ratio = 0.3 }]\n";

#[test]
fn what_attracts_attention_at_the_end_of_a_scene_is_told_there_once() {
    // One second after the start of this scene, cells are inverted.
    let mut session = open("jelly");
    session.handle(Request::Set("time.seconds".into(), Value::Number(1.0)));
    no_refusal(&mut session);
    let end = (1.0 / session.shown().frame).round() as u32;
    pass(&mut session, end - 1);
    let inverted = |session: &mut Session| session.shown().warnings.iter().any(|w| w.code == "cells.inverted");
    assert!(session.shown().message.is_none() && !inverted(&mut session));
    pass(&mut session, 1);
    let message = session.shown().message.expect("it is told at the end");
    assert_eq!(message.severity, Severity::Done);
    let told = |said: &str| said.contains("inverted");
    assert!(
        matches!(&message.report, Report::AtTheEnd(time, list) if (time - 1.0).abs() < 1e-9 && told(&list[0].message))
    );
    assert!(inverted(&mut session), "and stands with the other warnings");
    // Time continues, and when the same end is reached again nothing is reported twice.
    let message_count = session.message_count();
    pass(&mut session, 3);
    session.handle(Request::Seek(u64::from(end) - 3));
    arrive(&mut session);
    assert!(!inverted(&mut session), "before it nobody has looked");
    pass(&mut session, 5);
    assert_eq!(session.message_count(), message_count);
    // A scene without anything unusual ends without a message.
    let mut calm = of(CALM);
    pass(&mut calm, 8);
    assert!(calm.shown().message.is_none(), "{:?}", calm.shown().message);
}

#[test]
fn a_scene_is_edited_once_something_was_done_in_it_and_until_that_is_saved() {
    let mut session = open("ball");
    let edited = |session: &Session| Copied::of(session).edited;
    pass(&mut session, 5);
    assert!(!edited(&session), "time that passes is no edit");
    session.handle(Request::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(900.0)));
    no_refusal(&mut session);
    assert!(edited(&session));
    let saved = Copied::of(&session);
    pass(&mut session, 1);
    session.handle(Request::Saved(saved.mark));
    assert!(!edited(&session), "nothing was done since");
    session.handle(Request::Edit(Edit::Duplicate("ball".into())));
    assert!(edited(&session));
    // Changes made while it was being saved are not saved.
    session.handle(Request::Saved(saved.mark));
    assert!(edited(&session));
    session.handle(Request::Open { name: "it".into(), text: CALM.into(), files: Files::default() });
    assert!(!edited(&session), "another scene");
}

#[test]
fn the_hash_of_the_state_is_shown_where_somebody_looks_at_it_and_is_that_of_the_command_line() {
    let mut session = open("ball");
    pass(&mut session, 7);
    assert_eq!(session.shown().hash, None);
    session.handle(Request::Show(Show { hash: true, ..Show::default() }));
    let hash = session.shown().hash.expect("it is looked at");
    assert_eq!((hash, replayed(&session.saved(), 7)), (session.hash(), hash));
}

#[test]
fn optional_fields_of_shapes_and_obstacles_are_given_no_longer() {
    let text =
        format!("{CALM}\n[[collider]]\nkind = \"box\"\ncenter = [0.0, -2.0]\nsize = [4.0, 1.0]\nrotation = 0.2\n");
    let mut session = of(&text);
    let rotation = |session: &mut Session| session.shown().obstacles[0].values.number("rotation");
    assert_eq!(rotation(&mut session), Some(0.2));
    session.handle(Request::Unset("collider.0.rotation".into()));
    no_refusal(&mut session);
    assert_eq!(rotation(&mut session), None);
    assert!(!session.text().contains("rotation"), "the scene is silent about it");
    session.handle(Request::Undo);
    assert_eq!((rotation(&mut session), session.text().contains("rotation")), (Some(0.2), true));
    // During the run it gets the equivalent value, as a command.
    pass(&mut session, 2);
    session.handle(Request::Unset("collider.0.rotation".into()));
    no_refusal(&mut session);
    assert_eq!((rotation(&mut session), session.shown().recorded), (Some(0.0), 1));
    // A field without such a value stays, and the message says what helps.
    session.handle(Request::Unset("collider.0.size".into()));
    let message = session.shown().message.expect("a refusal");
    assert_eq!(message.report, Report::AtTheStartAlone("collider.0.size".into()));
    // A field of a shape is removed, at the start and later.
    let folder = std::env::temp_dir().join(format!("opruga-unset-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("square.svg");
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path id=\"it\" d=\"M0 0 H10 V10 H0 Z\"/>\
                   <path id=\"other\" d=\"M20 0 H25 V10 H20 Z\"/></svg>";
    std::fs::write(&path, drawing).expect("a file");
    let begin = CALM.split_once("shape = ").expect("it").0;
    let text = format!(
        "{begin}shape = {{ kind = \"svg\", file = \"square.svg\", path = \"it\", size = 1.0, spacing = 0.2 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 100.0 }}]\n"
    );
    let session = Session::open("it", &text, Files::beside(&folder.join("it.toml")), Options::default());
    let mut session = session.unwrap_or_else(|said| panic!("{said}"));
    let nodes = |session: &mut Session| session.shown().bodies[0].nodes;
    let few = nodes(&mut session);
    session.handle(Request::Edit(Edit::ShapeWithout("it".into(), "path")));
    no_refusal(&mut session);
    assert!(!session.text().contains("path = ") && nodes(&mut session) != few);
    std::fs::remove_dir_all(folder).expect("it was made here");
}

#[test]
fn a_frame_that_takes_long_is_broken_off_for_what_cannot_wait_and_made_again_later() {
    // Minutes of steps in one frame.
    let text = CALM.replace("substeps = 40", "substeps = 400000").replace("cells = [4, 4]", "cells = [40, 40]");
    let link = Link::start(of(&text), || {}).expect("a thread");
    let until = |what: &str, holds: &dyn Fn() -> bool| {
        let begin = Instant::now();
        while !holds() {
            assert!(begin.elapsed() < Duration::from_secs(60), "{what}");
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    let busy = || link.busy().is_some_and(|busy| busy > Duration::from_millis(600));
    link.ask(Request::Play(true));
    until("it computes", &busy);
    link.ask(Request::Play(false));
    until("it stands", &|| !link.shown().playing && link.busy().is_none());
    assert_eq!((link.shown().frames, link.shown().message.is_none()), (0, true));
    // A single step is interrupted to open another scene.
    link.ask(Request::Step);
    until("it computes", &busy);
    let files = opruga::scenes::files();
    let text = opruga::scenes::find("ball").expect("it").to_string();
    link.ask(Request::Open { name: "ball".into(), text, files });
    until("another scene moves", &|| link.shown().name == "ball" && link.shown().frames > 3);
    assert!(link.shown().message.is_none());
}

#[test]
fn where_nobody_can_be_asked_meanwhile_a_frame_that_takes_long_ends_by_the_clock_and_the_person_is_asked() {
    // Minutes of steps in one frame.
    let text = CALM.replace("substeps = 40", "substeps = 400000").replace("cells = [4, 4]", "cells = [40, 40]");
    let options = Options { break_off: by_the_clock(), ..Options::default() };
    let mut session = Session::open("it", &text, Files::default(), options).expect("it opens");
    session.wait_for_frames(0.25);
    let asked = |session: &mut Session| {
        let shown = session.shown();
        let message = shown.message.expect("a message");
        assert_eq!((shown.playing, shown.frames, message.severity), (false, 0, Severity::Refused));
        (message.report, message.offer.expect("an offer"))
    };
    session.handle(Request::Play(true));
    let begin = Instant::now();
    session.tick(Duration::from_millis(100), Duration::from_millis(8), &|| begin.elapsed());
    assert!(begin.elapsed() < Duration::from_secs(30), "{:?}", begin.elapsed());
    assert_eq!(asked(&mut session), (Report::TakesLong(0.25), Offer::Wait(1.0)));
    // The user waits longer for the request, still in vain; a single step then has the same limit.
    session.handle(Request::Accept(Offer::Wait(1.0)));
    assert!(session.shown().playing && session.shown().message.is_none());
    session.tick(Duration::from_millis(100), Duration::from_millis(8), &|| begin.elapsed());
    assert_eq!(asked(&mut session), (Report::TakesLong(1.0), Offer::Wait(4.0)));
    session.handle(Request::Step);
    assert_eq!(asked(&mut session), (Report::TakesLong(1.0), Offer::Wait(4.0)));
    // Travel to another moment is interrupted as well.
    session.handle(Request::Seek(3));
    session.tick(Duration::ZERO, Duration::from_millis(8), &|| begin.elapsed());
    assert!(!session.is_seeking());
    assert_eq!(asked(&mut session), (Report::TakesLong(1.0), Offer::Wait(4.0)));
    // With fewer substeps frames are fast, and the user is not asked.
    session.handle(Request::Set("time.substeps".into(), Value::Integer(40)));
    no_refusal(&mut session);
    pass(&mut session, 2);
    assert!(session.shown().message.is_none());
    // Another scene has the initial limit again.
    session.handle(Request::Open { name: "it".into(), text, files: Files::default() });
    session.handle(Request::Step);
    assert_eq!(asked(&mut session).0, Report::TakesLong(0.25));
}
