//! The same scene in two configurations, side by side.
#![allow(missing_docs)]
// Distances in pictures may differ in the last bit.
#![allow(clippy::disallowed_methods)]

use opruga::Options;
use opruga::Registry;
use opruga::core::spec::{Value, Values};
use opruga_studio::differences::{Difference, right_of};
use opruga_studio::document::Document;
use opruga_studio::panels::keeping::{What, content};
use opruga_studio::runner::Copied;
use opruga_studio::session::{Grip, Request, Session};
use opruga_studio::shown::{Beside, Severity, Show};
use opruga_studio::words::Language;
use std::time::Duration;

fn open(name: &str) -> Session {
    let text = opruga::scenes::find(name).expect("a scene of the program");
    Session::open(name, text, opruga::scenes::files(), Options::default()).expect("it opens")
}

fn ask(session: &mut Session, request: Request) {
    let asked = format!("{request:?}");
    session.handle(request);
    let message = session.shown().message;
    assert!(message.as_ref().is_none_or(|m| m.severity == Severity::Done), "{asked}: {message:?}");
    while session.is_seeking() {
        session.tick(Duration::from_millis(16), Duration::from_millis(12), &|| Duration::ZERO);
    }
}

fn pass(session: &mut Session, frames: u32) {
    (0..frames).for_each(|_| ask(session, Request::Step));
}

/// The differences of the right side in words.
fn words(beside: &Beside) -> Vec<String> {
    beside.differences.iter().map(|difference| Language::English.difference(difference)).collect()
}

fn beside(session: &mut Session) -> Beside {
    session.shown().beside.expect("two scenes")
}

fn integrator(kind: &str) -> Values {
    Values::defaults(Registry::<2>::default().integrator(kind).expect("an integrator").spec(), 2)
}

fn column(session: &mut Session, name: &str) -> f64 {
    let row = session.row();
    row.iter().find(|(column, _)| column == name).unwrap_or_else(|| panic!("no column {name}: {row:?}")).1
}

#[test]
fn without_a_difference_both_sides_are_equal_to_the_bit_whatever_a_person_does() {
    let mut session = open("ball");
    pass(&mut session, 5);
    ask(&mut session, Request::Compare(true));
    assert_eq!(session.frames(), 5, "the moment stays");
    ask(&mut session, Request::Grab(Grip::Pull, 0, [0.4, 2.0, 0.0]));
    for k in 0..20 {
        ask(&mut session, Request::Lead([0.5, 2.0 + 0.05 * f64::from(k), 0.0]));
        pass(&mut session, 1);
    }
    ask(&mut session, Request::Release);
    ask(&mut session, Request::Grab(Grip::Pin, 0, [0.0, 1.4, 0.0]));
    ask(&mut session, Request::Set("world.gravity".into(), Value::Numbers(vec![0.5, -5.0])));
    pass(&mut session, 20);
    assert_eq!(beside(&mut session).distances, Some([0.0, 0.0]));
    assert_eq!(beside(&mut session).energy, Some(0.0));
    let hash = session.hash();
    ask(&mut session, Request::Compare(false));
    assert!(session.shown().beside.is_none());
    assert_eq!(session.hash(), hash, "the scene itself knows nothing of the one beside it");
}

#[test]
fn the_right_side_is_the_scene_with_the_differences_and_the_distance_is_that_between_the_two() {
    let mut session = open("ball");
    pass(&mut session, 12);
    let alone = session.hash();
    ask(&mut session, Request::Compare(true));
    let differences = [
        Difference::Integrator(None, integrator("symplectic_euler")),
        Difference::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(900.0)),
        Difference::Set("time.substeps".into(), Value::Integer(64)),
    ];
    for difference in &differences {
        ask(&mut session, Request::Differ(difference.clone()));
        assert_eq!(session.frames(), 12, "both come to the present moment again");
    }
    assert_eq!(session.hash(), alone);
    pass(&mut session, 30);
    let text = right_of(
        &Document::new("ball", &session.text()).expect("a text"),
        &differences,
        &opruga::scenes::files(),
        &opruga::Registries::default(),
    );
    let text = text.expect("a scene").0.text();
    let mut right = Session::open("right", &text, opruga::scenes::files(), Options::default()).expect("it opens");
    pass(&mut right, 42);
    for name in ["time", "kinetic", "elastic", "gas", "ball.volume"] {
        let other = if name == "time" { "time".to_string() } else { format!("right.{name}") };
        assert_eq!(column(&mut session, &other), column(&mut right, name), "{name}");
    }
    let (here, there) = (session.shown().picture, right.shown().picture);
    let far = |d: usize, k: usize| here.bodies[0].positions[k][d] - there.bodies[0].positions[k][d];
    let largest = (0..36).map(|k| far(0, k).hypot(far(1, k))).fold(0.0, f64::max);
    let [mean, told] = beside(&mut session).distances.expect("a distance");
    assert!((told - largest).abs() < 1e-6 && mean > 1e-3 && mean <= told, "{mean} {told} {largest}");
    assert_eq!(words(&beside(&mut session)), ["symplectic euler", "stiffness 900", "substeps 64"]);
    assert_eq!(beside(&mut session).right.hash, None, "nobody looks at it");
    ask(&mut session, Request::Show(Show { hash: true, ..Show::default() }));
    assert_eq!(beside(&mut session).right.hash, Some(right.hash()));
    // Both sides go back and forth in time together.
    ask(&mut session, Request::Seek(7));
    ask(&mut session, Request::Seek(42));
    assert_eq!(beside(&mut session).distances, Some([mean, told]));
    // A difference is undone like any other edit.
    ask(&mut session, Request::Undo);
    assert_eq!(beside(&mut session).differences.len(), 2);
    ask(&mut session, Request::Redo);
    assert_eq!(beside(&mut session).differences.len(), 3);
}

#[test]
fn a_difference_that_is_refused_leaves_everything_as_it_was() {
    let mut session = open("ball");
    ask(&mut session, Request::Compare(true));
    pass(&mut session, 10);
    let (hash, distances) = (session.hash(), beside(&mut session).distances);
    for difference in [
        Difference::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(1e9)),
        Difference::Set("body.ball.models.mass_spring.stiffness".into(), Value::Number(-1.0)),
        Difference::Set("body.nobody.models.mass_spring.stiffness".into(), Value::Number(1.0)),
    ] {
        session.handle(Request::Differ(difference));
        let shown = session.shown();
        assert_eq!(shown.message.map(|m| m.severity), Some(Severity::Refused));
        assert_eq!((session.hash(), session.frames()), (hash, 10));
        assert_eq!(beside(&mut session).distances, distances);
    }
    session.handle(Request::Step);
    assert_eq!(session.frames(), 11);
}

#[test]
fn a_right_side_that_diverges_says_where_and_the_left_one_goes_on() {
    // An excessive force, which the scene limits and the right side does not.
    let text = opruga::scenes::find("ball").expect("it").replace("[world]", "[world]\nlargest_force = 100.0").replace(
        "[[collider]]",
        "[[load]]\nkind = \"force\"\nbody = \"ball\"\nvalue = [1e300, 0.0]\ncurve = [[0.0, 0.0], [0.2, 0.0], [0.3, 1.0]]\n\n[[collider]]",
    );
    let mut session = Session::open("bad", &text, opruga::scenes::files(), Options::default()).expect("it opens");
    ask(&mut session, Request::Compare(true));
    ask(&mut session, Request::Differ(Difference::Set("world.largest_force".into(), Value::Number(1e307))));
    for _ in 0..40 {
        session.handle(Request::Step);
    }
    assert_eq!(session.frames(), 40);
    let right = beside(&mut session);
    let stopped = right.stopped;
    let said = stopped.as_ref().expect("it has stopped").to_string();
    assert!(said.contains("`ball`") && said.contains("node"), "{said}");
    assert!(right.distances.is_none() && right.right.frames < 40);
    assert!(right.right.picture.bodies[0].positions.iter().flatten().all(|x| !x.is_nan()), "its last good state");
    // Before that moment it still moves.
    ask(&mut session, Request::Seek(0));
    assert!(beside(&mut session).stopped.is_none());
    // Values that are set after it apply in two worlds that are rebuilt, and the reason is still known.
    ask(&mut session, Request::Seek(38));
    ask(&mut session, Request::Set("world.gravity".into(), Value::Numbers(vec![0.5, -5.0])));
    assert_eq!((session.latest(), beside(&mut session).stopped), (38, stopped));
    ask(&mut session, Request::Compare(false));
    pass(&mut session, 3);
}

#[test]
fn the_table_holds_both_sides_and_their_difference() {
    let mut session = open("ball");
    ask(&mut session, Request::Compare(true));
    ask(&mut session, Request::Differ(Difference::Integrator(None, integrator("symplectic_euler"))));
    pass(&mut session, 20);
    let table = content(What::Table, &Copied::of(&session), Show::default()).expect("a table");
    let table = String::from_utf8(table).expect("a text");
    let head: Vec<&str> = table.lines().next().expect("a head").split(',').collect();
    let place = |name: &str| head.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
    let rows: Vec<Vec<f64>> =
        table.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().expect("a number")).collect()).collect();
    assert_eq!(rows.len(), 21);
    let (mean, energy) = (place("difference.mean_distance"), place("difference.energy"));
    assert_eq!(rows[0][mean], 0.0);
    assert!(rows[20][mean] > 0.0 && rows.windows(2).any(|pair| pair[0][energy] != pair[1][energy]));
    let stocks = |row: &[f64], side: &str| -> f64 {
        ["kinetic", "elastic", "gas", "gravity"].iter().map(|name| row[place(&format!("{side}{name}"))]).sum()
    };
    for row in &rows {
        assert!((stocks(row, "right.") - stocks(row, "") - row[energy]).abs() < 1e-9);
    }
}

#[test]
fn scenes_of_space_stand_side_by_side_too() {
    let mut session = open("balloons");
    ask(&mut session, Request::Compare(true));
    ask(&mut session, Request::Differ(Difference::Set("world.gravity".into(), Value::Numbers(vec![0.0, -1.0, 0.0]))));
    pass(&mut session, 6);
    let beside = beside(&mut session);
    assert_eq!(beside.right.dimension, 3);
    assert!(beside.distances.expect("a distance")[0] > 1e-3);
}

fn finer(vertices: i64) -> Difference {
    Difference::Shape("ball".into(), "vertices", Value::Integer(vertices))
}

#[test]
fn the_sides_can_differ_in_resolution_and_are_compared_by_what_both_have() {
    let mut session = open("ball");
    ask(&mut session, Request::Compare(true));
    ask(&mut session, Request::Differ(finer(90)));
    let shown = session.shown();
    let right = shown.beside.as_ref().expect("two scenes");
    assert_eq!((shown.bodies[0].nodes, right.right.bodies[0].nodes, right.right.frames), (36, 90, 0));
    assert_eq!(words(right), ["vertices 90"]);
    assert!(right.distances.is_none(), "there is no distance between nodes that are not the same");
    // The area of a polygon of n corners in a circle: n/2 sin(2π/n) times the square of the radius.
    let polygon = |n: f64| 0.5 * n * (std::f64::consts::TAU / n).sin() * 0.5 * 0.5;
    let wanted = polygon(90.0) - polygon(36.0);
    let found = right.volume.expect("areas");
    assert!((found / wanted - 1.0).abs() < 1e-9, "{found} {wanted}");
    assert!(right.center.is_some_and(|far| far < 1e-12), "{:?}", right.center);
    pass(&mut session, 60);
    assert!(beside(&mut session).center.is_some_and(|far| far > 1e-6 && far < 0.5));
    assert!(column(&mut session, "difference.center_of_mass") > 0.0);
    assert!(column(&mut session, "difference.volume").is_finite());
}

#[test]
fn a_pull_on_either_side_takes_the_nodes_that_lie_at_the_same_place_at_rest_and_runs_to_the_same_bits() {
    for on_right in [false, true] {
        let mut session = open("ball");
        ask(&mut session, Request::Compare(true));
        ask(&mut session, Request::Differ(finer(7)));
        ask(&mut session, Request::Differ(finer(72)));
        pass(&mut session, 3);
        // The top of the ball: node 9 of 36, node 18 of 72.
        let top = beside(&mut session).right.picture.bodies[0].positions[18];
        let grab = if on_right { Request::GrabBeside } else { Request::Grab };
        ask(&mut session, grab(Grip::Pull, 0, top));
        for k in 0..12 {
            ask(&mut session, Request::Lead([top[0] + 0.3, top[1] + 0.05 * f64::from(k), 0.0]));
            pass(&mut session, 1);
        }
        let shown = session.shown();
        let right = &shown.beside.as_ref().expect("two scenes").right;
        for (side, node) in [(&shown, 9), (&**right, 18)] {
            let [held, ..] = side.pulls[0];
            let at = side.picture.bodies[0].positions[node];
            assert!((0..2).all(|d| (held[d] - at[d]).abs() < 1e-6), "{on_right}: {held:?} {at:?}");
        }
        ask(&mut session, Request::Release);
        ask(&mut session, Request::Grab(Grip::Pin, 0, shown.picture.bodies[0].positions[27]));
        pass(&mut session, 4);
        // The saved scene of the right side reaches the same state.
        let differences = session.differences().expect("two scenes").to_vec();
        let document = Document::new("ball", &session.saved()).expect("a text");
        let (right, _) = right_of(&document, &differences, &opruga::scenes::files(), &opruga::Registries::default())
            .expect("a scene");
        let mut alone =
            Session::open("right", &right.text(), opruga::scenes::files(), Options::default()).expect("it opens");
        while alone.frames() < session.frames() {
            alone.handle(Request::Step);
        }
        for name in ["kinetic", "elastic", "gas", "work_user"] {
            assert_eq!(column(&mut session, &format!("right.{name}")), column(&mut alone, name), "{on_right} {name}");
        }
        // Computed again from the start, it reaches the same state as well.
        let before = session.shown().beside.expect("two").right.picture.bodies[0].positions.clone();
        ask(&mut session, Request::Seek(0));
        let last = session.latest();
        ask(&mut session, Request::Seek(last));
        assert_eq!(session.shown().beside.expect("two").right.picture.bodies[0].positions, before);
    }
}
