//! Bodies that grow to many times their size.

use super::{ask, pass, quiet};
use crate::report::Report;
use crate::session::{Edit, Request, Session};
use crate::shown::{Offer, Severity};
use opruga::Options;
use opruga::core::spec::Value;
use std::time::Duration;

/// The undamped ball with an integrator without a stable step, and a gentle scene of falling bodies.
fn growing() -> Session {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let text = text[..end].replace("damping = 1.0", "damping = 0.0").replace("substeps = 32", "substeps = 2");
    let text = text.replace("kind = \"verlet\"", "kind = \"explicit_euler\"");
    Session::open("growing", &text, opruga::scenes::files(), Options::default()).expect("it opens")
}

fn play(session: &mut Session, ticks: u32) {
    session.handle(Request::Play(true));
    for _ in 0..ticks {
        session.tick(Duration::from_millis(17), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

fn arrive(session: &mut Session) {
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

/// The longer side of the box around all bodies.
fn extent(session: &mut Session) -> f64 {
    let corners: Vec<_> = session.shown().extents.iter().map(|extent| extent.corners).collect();
    let side = |d: usize| corners.iter().map(|[low, high]| high[d] - low[d]).fold(0.0, f64::max);
    side(0).max(side(1))
}

#[test]
fn a_body_that_explodes_stops_time_while_it_can_still_be_seen_also_side_by_side() {
    for beside in [false, true] {
        let mut session = growing();
        if beside {
            pass(&mut session, 2);
            ask(&mut session, Request::Compare(true));
        }
        play(&mut session, 600);
        let shown = session.shown();
        let message = shown.message.expect("it is told");
        assert_eq!(message.text, "`ball` exploded: explicit euler is unstable at this step");
        assert_eq!(
            (message.severity, message.offer),
            (Severity::Refused, Some(Offer::Steady(None, "symplectic_euler")))
        );
        assert!(!shown.playing);
        let size = extent(&mut session);
        assert!(size > 100.0 && size < 1e6, "{size} m");
        if beside {
            let right = session.shown().beside.expect("two scenes");
            assert_eq!(
                right.stopped.as_ref().map(Report::to_string).as_deref(),
                Some("`ball` exploded: explicit euler is unstable at this step")
            );
        }
        // The explosion is reported again if the user starts time again, and if both sides are computed again.
        let (message_count, frames) = (message.number, session.frames());
        play(&mut session, 5);
        assert!(session.frames() <= frames + 1 && session.message_count() > message_count && !session.is_moving());
        session.handle(Request::Compare(!beside));
        arrive(&mut session);
        let message = session.shown().message.expect("it is told");
        assert!(message.text.contains("exploded"), "{}", message.text);
        // Going back in time is not an explosion.
        let message_count = session.message_count();
        session.handle(Request::Seek(3));
        arrive(&mut session);
        assert_eq!((session.frames(), session.message_count()), (3, message_count));
    }
}

#[test]
fn a_right_side_that_explodes_stops_and_the_left_one_goes_on() {
    let mut session = quiet();
    ask(&mut session, Request::Compare(true));
    let spec = opruga::Registry::<2>::default().integrator("explicit_euler").expect("it").spec();
    let euler = crate::differences::Difference::Integrator(None, opruga::core::spec::Values::defaults(spec, 2));
    ask(&mut session, Request::Differ(euler));
    let soft = |field: &str, value: f64| {
        crate::differences::Difference::Set(format!("body.ball.models.mass_spring.{field}"), Value::Number(value))
    };
    ask(&mut session, Request::Differ(soft("damping", 0.0)));
    ask(&mut session, Request::Differ(crate::differences::Difference::Set("time.substeps".into(), Value::Integer(8))));
    play(&mut session, 900);
    let shown = session.shown();
    assert!(shown.playing && shown.message.is_none_or(|message| message.severity == Severity::Done));
    let stopped = shown.beside.expect("two scenes").stopped.expect("it has stopped");
    assert!(stopped.to_string().contains("exploded"), "{stopped}");
}

#[test]
fn a_body_that_falls_far_and_one_that_is_larger_than_the_scene_have_not_exploded() {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[collider]]").expect("its floor");
    let text = text[..end].replace("gravity = [0.0, -9.81]", "gravity = [0.0, -400.0]");
    let mut session = Session::open("falling", &text, opruga::scenes::files(), Options::default()).expect("it opens");
    let wide = "{ name = \"wide\", shape = { kind = \"line\", from = [-400.0, 0.0], to = [400.0, 0.0], segments = 4 }, mass = 1.0, \
                models = [{ kind = \"mass_spring\", stiffness = 1.0 }] }";
    let wide = wide.parse::<toml_edit::Value>().expect("a table").as_inline_table().expect("a table").clone();
    pass(&mut session, 2);
    ask(&mut session, Request::Edit(Edit::Add(wide)));
    pass(&mut session, 120);
    assert!(session.shown().extents[0].corners[1][1] < -500.0);
}
