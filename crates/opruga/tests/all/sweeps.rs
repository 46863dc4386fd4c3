//! The measurements of sweeps, compared with closed forms.
#![allow(clippy::disallowed_methods)] // no physics here

use opruga::sweep::{Axis, Design, Metric, Row, Status, Sweep};
use std::sync::atomic::AtomicBool;

fn sweep(text: &str, axes: &[&str], metrics: &[&str]) -> Sweep {
    Sweep {
        name: "test".into(),
        file: "test.toml".into(),
        text: text.into(),
        files: opruga::io::Files::default(),
        fixed: Vec::new(),
        axes: axes.iter().map(|a| Axis::parse(a).expect("it can be read").expect("it varies")).collect(),
        design: Design::Grid,
        metrics: metrics.iter().map(|m| Metric::parse(m).expect("a metric")).collect(),
        allow_unstable: false,
        lenient: false,
        registries: opruga::Registries::default(),
    }
}

fn rows(sweep: &Sweep) -> Vec<Row> {
    let points = sweep.points().unwrap_or_else(|errors| panic!("{}", errors[0]));
    let measure = |(number, point): (usize, &Vec<Option<String>>)| {
        sweep.measure(number, point, None, &|| 0.0, &AtomicBool::new(false)).expect("nobody stops it")
    };
    points.iter().enumerate().map(measure).collect()
}

fn value(row: &Row, metric: usize) -> f64 {
    assert_eq!(row.status, Status::Done, "{}", row.message);
    row.numbers[metric].expect("a number")
}

/// Nodes without forces between them, at most 0.2 mm apart, which fall like a point.
const FALLING: &str = r#"
format = "opruga-1"
dimension = 2
[time]
seconds = 2.0
frame = 0.02
substeps = 100
[world]
gravity = [0.0, -9.81]
[integrator]
kind = "verlet"
[[body]]
name = "drop"
shape = { kind = "ring", radius = 1e-4, vertices = 8, center = [0.0, 1.4001] }
mass = 1.0
models = [{ kind = "mass_spring", stiffness = 0.0, damping = 0.0 }]
[[collider]]
kind = "half_space"
point = [0.0, 0.5]
normal = [0.0, 1.0]
restitution = 0.5
friction = 0.0
[[probe]]
name = "low"
body = "drop"
select = { node = 6 }
record = ["position", "velocity"]
"#;

/// Without spring forces each node is a point mass: after a fall from h it rises to e² h, and its impact speed is √(2 g h).
#[test]
fn a_point_that_falls_from_a_height_bounces_to_the_square_of_its_restitution_times_that_height() {
    let sweep = sweep(
        FALLING,
        &["collider.0.restitution=0.3,0.5,0.8,1"],
        &["bounce_height.drop", "low.vy.min", "low.y.max", "energy_drift"],
    );
    let fall: f64 = 0.9; // from 1.4 m to the floor at 0.5 m
    for row in rows(&sweep) {
        let e: f64 = row.values[0].as_deref().and_then(opruga::sweep::number).expect("a number");
        let height = value(&row, 0);
        // The displacement in one substep of 0.2 ms at the speeds of the impact and of the bounce, and the size of the body.
        let tolerance = 2.0 * 2e-4 * (2.0 * 9.81 * fall).sqrt() + 2e-4;
        assert!((height - e * e * fall).abs() < tolerance, "e = {e}: {height} against {}", e * e * fall);
        // Probes are evaluated at the ends of frames, at most 0.02 s before the impact.
        let speed = (2.0 * 9.81 * fall).sqrt();
        assert!(value(&row, 1) >= -speed * 1.001 && value(&row, 1) <= -speed + 0.02 * 9.81 * 1.001);
        assert!((value(&row, 2) - 1.4).abs() < tolerance);
        assert!(value(&row, 3) < 1e-2);
    }
}

/// k (l − l₀) = 2 nRT / (N l): the ring of N springs around a gas without ambient pressure.
#[test]
fn a_pressurised_ring_settles_at_the_radius_of_the_closed_form() {
    let text = r#"
format = "opruga-1"
dimension = 2
[time]
seconds = 4.0
frame = 0.02
substeps = 40
[integrator]
kind = "symplectic_euler"
[[body]]
name = "ring"
shape = { kind = "ring", radius = 0.5, vertices = 24, center = [0.0, 0.0] }
mass = 1.0
models = [
    { kind = "mass_spring", stiffness = 400.0, damping = 4.0 },
    { kind = "pressure", nRT = 10.0, ambient = 0.0 },
]
"#;
    let question = sweep(
        text,
        &["body.ring.models.pressure.nRT=5..80:log:3", "body.ring.models.mass_spring.stiffness=200,800"],
        &["equilibrium_radius", "settling_time"],
    );
    let rows = rows(&question);
    assert_eq!(rows.len(), 6);
    for row in &rows {
        let of = |k: usize| row.values[k].as_deref().and_then(opruga::sweep::number).expect("a number");
        let (gas, k, n): (f64, f64, f64) = (of(0), of(1), 24.0);
        let edge = 2.0 * (std::f64::consts::PI / n).sin();
        let rest = 0.5 * edge;
        let length = 0.5 * (rest + (rest * rest + 8.0 * gas / (k * n)).sqrt());
        let (radius, expected) = (value(row, 0), length / edge);
        assert!((radius - expected).abs() < 1e-6 * expected, "nRT = {gas}, k = {k}: {radius} against {expected}");
        let settled = value(row, 1);
        assert!(settled > 0.0 && settled < 4.0);
    }
}

#[test]
fn a_point_that_is_refused_or_diverges_is_a_row_with_its_code() {
    let mut question = sweep(FALLING, &["body.drop.models.mass_spring.stiffness=0,1e12,-1"], &["energy_drift"]);
    let codes: Vec<String> = rows(&question).iter().map(|row| row.status.word().to_string()).collect();
    assert_eq!(codes, ["done", "step.unstable", "scene.range"]);
    question.allow_unstable = true;
    question.fixed.push(("body.drop.velocity".into(), "[1, 2]".into()));
    question.fixed.push(("body.drop.angular_velocity".into(), "3".into()));
    let rows = rows(&question);
    assert_eq!(rows[1].status.word(), "run.diverged", "{:?}", rows[1]);
    assert!(rows[1].message.contains("drop") && rows[1].numbers == [None]);
}

#[test]
fn a_question_that_makes_no_sense_is_refused_before_any_run() {
    let codes = |sweep: &Sweep| -> Vec<&str> { sweep.points().expect_err("refused").iter().map(|e| e.code).collect() };
    let good = sweep(FALLING, &["body.drop.mass=1,2"], &["energy_drift"]);
    assert!(good.points().is_ok());
    assert_eq!(codes(&sweep(FALLING, &["body.drip.mass=1,2"], &["energy_drift"])), ["set.path"]);
    assert_eq!(codes(&sweep(FALLING, &["body.drop.maas=1,2"], &["energy_drift"])), ["scene.unknown_field"]);
    assert_eq!(codes(&sweep(FALLING, &["body.drop.mass=1,2"], &["bounce_height.drip"])), ["sweep.metric"]);
    assert_eq!(codes(&sweep(FALLING, &["body.drop.mass=1,2"], &["low.z.max"])), ["sweep.metric"]);
    assert_eq!(codes(&sweep(FALLING, &["body.drop.mass=1,2"], &[])), ["sweep.metric"]);
    let twice = sweep(FALLING, &["body.drop.mass=1,2"], &["energy_drift", "energy_drift"]);
    assert_eq!(codes(&twice), ["sweep.metric"]);
    let text = FALLING.replace("dimension = 2", "dimension = 5");
    assert!(sweep(&text, &["body.drop.mass=1,2"], &["energy_drift"]).points().is_err());
}

/// Measuring a run does not change it, and a speed depends on the given clock.
#[test]
fn speeds_are_those_of_the_clock_and_change_nothing_else() {
    let plain = rows(&sweep(FALLING, &["body.drop.mass=1,2"], &["bounce_height", "low.y.mean"]));
    let timed = sweep(FALLING, &["body.drop.mass=1,2"], &["bounce_height", "low.y.mean", "nanoseconds_per_step"]);
    let points = timed.points().expect("points");
    let ticks = std::cell::Cell::new(0.0);
    // This clock advances by half a second between two readings.
    let clock = || {
        ticks.set(ticks.get() + 0.5);
        ticks.get()
    };
    for (number, point) in points.iter().enumerate() {
        let row = timed.measure(number, point, None, &clock, &AtomicBool::new(false)).expect("nobody stops it");
        assert_eq!(row.numbers[..2], plain[number].numbers[..]);
        assert_eq!(row.numbers[2], Some(0.5e9 / 10_000.0), "one run of 100 frames of 100 substeps");
    }
    assert_eq!(timed.measure(0, &points[0], None, &clock, &AtomicBool::new(true)), None, "stopped");
}

#[test]
fn one_parameter_is_drawn_as_lines_and_two_as_a_map_with_failures_marked() {
    let of = |axes: &[&str], design: Design| {
        let mut question = sweep(FALLING, axes, &["bounce_height", "energy_drift"]);
        question.fixed.push(("time.seconds".into(), "0.8".into()));
        question.design = design;
        let rows = rows(&question);
        opruga::sweep::plots(&question, &rows, "m", "by somebody, CC-BY 4.0").expect("plots")
    };
    let (restitution, stiffness) =
        ("collider.0.restitution=0,0.5,1", "body.drop.models.mass_spring.stiffness=0,1,1e12");
    let lines = of(&[restitution], Design::Grid);
    assert_eq!(lines.len(), 1);
    assert!(lines[0].1.contains("bounce height [m]") && lines[0].1.matches("<circle").count() >= 6);
    let map = of(&[restitution, stiffness], Design::Grid);
    assert_eq!(map[0].1.matches(">×<").count(), 6, "three points have failed, in two panels");
    let each = of(&[restitution, stiffness], Design::Each);
    let names: Vec<&str> = each.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["plots-restitution.svg", "plots-stiffness.svg"]);
    for (name, text) in lines.iter().chain(&map).chain(&each) {
        assert!(text.contains("by somebody, CC-BY 4.0"), "{name}");
    }
    let words = of(&["integrator.kind=verlet,heun"], Design::Grid);
    assert!(words[0].1.contains("1 verlet, 2 heun"));
}
