//! What a person does is in the scene that is saved: whoever runs it gets the same bits.
#![allow(missing_docs)]
// Paths of pointers may differ in a last bit.
#![allow(clippy::disallowed_methods)]

use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Value, Values};
use opruga::draw::ArrowKind;
use opruga::io::{Files, scene};
use opruga::{Options, Registry, World, catalogue};
use opruga_studio::session::{Edit, Grip, Placed, Request, Session};
use opruga_studio::shown::{Offer, Severity, Show};
use std::time::Duration;

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

/// As if so many frames of the screen had passed, on a machine that takes no time at all.
fn pass(session: &mut Session, frames: u32) {
    for _ in 0..frames {
        session.handle(Request::Step);
    }
    no_refusal(session);
}

fn no_refusal(session: &mut Session) {
    let message = session.shown().message;
    assert!(message.as_ref().is_none_or(|m| m.severity == Severity::Told), "{message:?}");
}

fn refusal(session: &mut Session) -> String {
    let message = session.shown().message.expect("a message");
    assert_eq!(message.severity, Severity::Refused, "{}", message.text);
    message.text
}

/// Lets a session come to where it goes.
fn arrive(session: &mut Session) {
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

/// What the command line makes of a text: the hash after so many frames.
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

/// Pulls the ball along an arc for so many frames.
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
    session.handle(Request::Edit(Edit::Place("small".into(), turned)));
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
    // From the middle of the pull on, another future.
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
    // From here on another future, in which nobody lets go of it.
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
    session.handle(Request::Edit(Edit::Place("ball".into(), placed)));
    no_refusal(&mut session);
    let (x2, y2, radius2) = middle(&mut session);
    // Pictures have the digits of single precision.
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
    session.handle(Request::Edit(Edit::Place("ball".into(), placed)));
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
fn the_contact_forces_of_a_body_at_rest_carry_its_weight() {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let mut session = Session::open("quiet", &text[..end], Files::default(), Options::default()).expect("it opens");
    session.handle(Request::Show(Show { contacts: true, normals: true, ..Show::default() }));
    assert!(session.shown().picture.arrows.iter().all(|a| a.kind != ArrowKind::Contact), "in the air there are none");
    // Once it has come to lie, obstacles carry its weight of 9.81 N and what it still gains in momentum. One substep of
    // every thirty-two is looked at, and vertices still tremble: a twentieth may be missed.
    pass(&mut session, 600);
    let (mut sum, before) = ([0.0; 2], session.shown().momentum);
    for _ in 0..60 {
        pass(&mut session, 1);
        let arrows = session.shown().picture.arrows;
        let contacts = arrows.iter().filter(|arrow| arrow.kind == ArrowKind::Contact);
        contacts.for_each(|arrow| (0..2).for_each(|d| sum[d] += arrow.vector[d] / 60.0));
        // The normals of the ring point away from its middle.
        let normals: Vec<_> = arrows.iter().filter(|arrow| arrow.kind == ArrowKind::Normal).collect();
        let middle = [0, 1].map(|d| normals.iter().map(|n| n.from[d]).sum::<f64>() / normals.len() as f64);
        let out =
            |n: &&&opruga::draw::ArrowPicture| (0..2).map(|d| n.vector[d] * (n.from[d] - middle[d])).sum::<f64>() > 0.0;
        assert_eq!(normals.iter().filter(out).count(), 36);
    }
    let gained = session.shown().momentum[1] - before[1];
    assert!((sum[1] - 9.81 - gained).abs() < 0.4 && sum[0].abs() < 0.05, "{sum:?}, {gained}");
}

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

#[test]
fn every_scene_of_the_program_opens_moves_and_can_be_seen_in_every_colour() {
    for name in opruga::scenes::names().filter(|n| !["million-vertices", "thousand-balls", "giant-ring"].contains(n)) {
        let mut session = open(name);
        pass(&mut session, 2);
        for quantity in opruga::pictures::Quantity::ALL {
            session.handle(Request::Show(Show {
                quantity,
                arrows: true,
                vertices: true,
                velocities: true,
                normals: true,
                contacts: true,
                own_colours: false,
                ..Show::default()
            }));
            let shown = session.shown();
            assert_eq!(shown.bodies.len(), shown.picture.bodies.len(), "{name}");
            assert!(shown.picture.legend.is_some() != (quantity == opruga::pictures::Quantity::Plain), "{name}");
        }
    }
}

#[test]
fn scene_picture_film_animation_and_table_are_kept() {
    use opruga_studio::panels::keeping::{What, content};
    let mut session = open("ball");
    pull(&mut session, 12);
    let copied = opruga_studio::runner::Copied::of(&session);
    let bytes = |what| content(what, &copied, Show::default()).expect("a file");
    assert!(bytes(What::Picture).starts_with(b"\x89PNG"));
    assert_eq!(&bytes(What::Film)[4..8], b"ftyp");
    assert!(bytes(What::Animation).starts_with(b"GIF89a"));
    let table = String::from_utf8(bytes(What::Table)).expect("a text");
    assert_eq!(table.lines().count(), 14, "a head and thirteen states");
    assert!(table.starts_with("time,kinetic,") && table.contains("ball.volume"));
    let scene = String::from_utf8(bytes(What::Scene)).expect("a text");
    assert_eq!(replayed(&scene, 12), session.hash());
}

#[test]
fn row_99_files_that_are_dropped_become_scenes_or_are_refused_with_a_reason() {
    use opruga_studio::dropping::take;
    let folder = std::env::temp_dir().join(format!("opruga-dropped-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let refused = |path: &std::path::Path| take(path).expect_err("it is refused").to_string();
    assert!(refused(&put("letter.docx", b"PK")).contains(".toml"));
    assert!(refused(&put("bytes.toml", &[0xff, 0xfe, 0x00])).contains("UTF-8"));
    assert!(refused(&folder.join("absent.toml")).contains("read"));
    // Two gigabytes that take no room: they are refused before they are read.
    let large = std::fs::File::create(folder.join("large.toml")).expect("a file");
    large.set_len(2 << 30).expect("a length");
    assert!(refused(&folder.join("large.toml")).contains("2147483648 bytes"));
    let mut session = open("ball");
    let (hash, name) = (session.hash(), session.name().to_string());
    let wrong = take(&put("wrong.toml", b"format = \"opruga-1\"\ndimension = 7\n")).expect("it is read");
    session.handle(wrong);
    assert!(refusal(&mut session).contains("dimension"));
    assert_eq!((session.hash(), session.name()), (hash, name.as_str()));
    let svg = b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/></svg>";
    // A shape of the plane comes into a scene of the plane, also on the way, and again under another name.
    for count in 2..4 {
        session.handle(take(&put("square.svg", svg)).expect("a shape"));
        no_refusal(&mut session);
        assert_eq!((session.shown().bodies.len(), session.name()), (count, name.as_str()));
        pass(&mut session, 3);
    }
    let squares = session.shown().bodies.iter().filter(|body| body.name.starts_with("square")).count();
    assert_eq!(squares, 2);
    let other = String::from_utf8_lossy(svg).replace("H10 V10", "H10 V5");
    session.handle(take(&put("square.svg", other.as_bytes())).expect("a shape"));
    no_refusal(&mut session);
    assert!(session.saved().contains("square-2.svg"), "another file of the same name");
    session.handle(Request::Undo);
    arrive(&mut session);
    assert_eq!(session.shown().bodies.len(), 3);
    // One of space opens a scene of its own, from which there is a way back.
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    session.handle(take(&put("four.obj", obj)).expect("a shape"));
    no_refusal(&mut session);
    pass(&mut session, 3);
    assert_eq!(session.shown().dimension, 3);
    session.handle(Request::Undo);
    assert_eq!((session.shown().bodies.len(), session.name()), (3, name.as_str()));
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

/// A fine surface needs more substeps than a coarse one; nobody who drops a file knows how many.
#[test]
fn a_surface_that_is_dropped_takes_as_many_substeps_as_it_needs() {
    let spot = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/spot.obj");
    let mut session = open("ball");
    session.handle(opruga_studio::dropping::take(std::path::Path::new(spot)).expect("a shape"));
    no_refusal(&mut session);
    assert_eq!(session.name(), "spot");
    assert!(session.shown().substeps > 96, "more than it begins with");
    pass(&mut session, 2);
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
    assert_eq!(session.shown().undo, Some(opruga_studio::said::Step::Open("ball".into())));
    session.handle(Request::Undo);
    assert_eq!((session.name(), session.hash(), session.saved()), ("ball", hash, saved));
    assert!(!session.is_moving());
    session.handle(Request::Seek(3));
    arrive(&mut session);
    assert_eq!(session.frames(), 3);
    // Where nothing was done there is nothing to come back to.
    let mut fresh = open("ball");
    fresh.handle(request);
    assert_eq!(fresh.shown().undo, None);
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

#[test]
fn drawings_are_seen_in_their_own_colours_until_another_colouring_is_chosen() {
    let mut session = open("emoji");
    let coloured = |session: &mut Session| {
        let shown = session.shown();
        assert!(shown.has_drawings);
        shown.picture.bodies.iter().flat_map(|body| &body.areas).any(|area| area.colour.is_some())
    };
    assert!(coloured(&mut session), "by themselves");
    session.handle(Request::Show(Show { own_colours: false, ..Show::default() }));
    assert!(!coloured(&mut session), "told by their strain");
    assert!(!open("ball").shown().has_drawings);
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
        session.handle(Request::Edit(Edit::Place(name, moved)));
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
