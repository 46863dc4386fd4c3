//! Sessions without a window: actions of a user on a scene, and their results.
#![allow(missing_docs)]
// Paths of pointers may differ in the last bit.
#![allow(clippy::disallowed_methods)]

mod edits;
mod ends;
mod files;
mod refusals;
mod replays;
mod seen;
mod travel;

use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Value, Values};
use opruga::io::scene;
use opruga::{Options, Registry, World, catalogue};
use opruga_studio::session::{Grip, Request, Session};
use opruga_studio::shown::Severity;
use std::time::Duration;

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

/// Simulates the passing of this number of frames of the screen, on an infinitely fast machine.
fn pass(session: &mut Session, frames: u32) {
    for _ in 0..frames {
        session.handle(Request::Step);
    }
    no_refusal(session);
}

fn no_refusal(session: &mut Session) {
    let message = session.shown().message;
    assert!(message.as_ref().is_none_or(|m| m.severity == Severity::Done), "{message:?}");
}

fn refusal(session: &mut Session) -> String {
    let message = session.shown().message.expect("a message");
    assert_eq!(message.severity, Severity::Refused, "{}", message.text);
    message.text
}

/// Lets a session reach its goal.
fn arrive(session: &mut Session) {
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

/// The hash of a text after a number of frames on the command line.
fn replayed(text: &str, frames: u64) -> u64 {
    fn run<const D: usize>(blueprint: opruga::blueprint::Blueprint<D>, frames: u64) -> u64 {
        let mut world = World::new(blueprint, Options { threads: 2, ..Options::default() }).expect("a world");
        (0..frames).for_each(|_| world.frame().expect("a frame"));
        world.state_hash()
    }
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    let read = scene::read(text.as_bytes(), "saved.toml", &catalogue(), &options);
    let errors = |errors: Vec<_>| errors.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n");
    match read.map_err(errors).unwrap_or_else(|errors| panic!("{errors}\n{text}")).0 {
        AnyBlueprint::Plane(blueprint) => run(blueprint, frames),
        AnyBlueprint::Space(blueprint) => run(blueprint, frames),
    }
}

fn assert_replays(session: &Session) {
    assert_eq!(replayed(&session.saved(), session.frames()), session.hash(), "{}", session.saved());
}

fn model(kind: &str, numbers: &[(&str, f64)]) -> Values {
    let registry = Registry::<2>::default();
    let spec = registry.model(kind).expect("a model").spec();
    let mut values = Values::defaults(spec, 2);
    for (name, number) in numbers {
        values.set(spec, name, Value::Number(*number), 2).expect("allowed");
    }
    values
}

fn integrator(kind: &str) -> Values {
    Values::defaults(Registry::<2>::default().integrator(kind).expect("an integrator").spec(), 2)
}

/// Pulls the ball along an arc for a number of frames.
fn pull(session: &mut Session, frames: u32) {
    session.handle(Request::Grab(Grip::Pull, 0, [0.4, 2.0, 0.0]));
    for k in 0..frames {
        let turn = 0.1 * f64::from(k);
        session.handle(Request::Lead([0.4 + 0.3 * turn.sin(), 2.0 + 0.2 * turn, 0.0]));
        pass(session, 1);
    }
    session.handle(Request::Release);
}

fn ball(name: &str, x: f64) -> toml_edit::InlineTable {
    let text = format!(
        "{{ name = \"{name}\", shape = {{ kind = \"ring\", radius = 0.3, vertices = 24, center = [{x}, 1.5] }}, mass = 0.5, \
         models = [{{ kind = \"mass_spring\", stiffness = 300.0, damping = 1.0 }}, {{ kind = \"pressure\", nRT = 10.0 }}] }}"
    );
    text.parse::<toml_edit::Value>().expect("a table").as_inline_table().expect("a table").clone()
}
