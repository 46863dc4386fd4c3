//! Impact and friction on obstacles.

use super::BASE;
use crate::case::{Case, Check, Family, Over};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;

const SLOPE: Case = Case {
    family: Family::Dynamics,
    quantity: "distance that a chain slides down a slope of tan θ = 1/2 in 2.5 s, μ = 0.49",
    unit: "m",
    source: "exact: g (sin θ − μ cos θ) t²/2 (C. A. Coulomb)",
    over: Over::Step("step [s]"),
    levels: &[1.0 / 960.0, 1.0 / 1920.0, 1.0 / 3840.0],
    expected: &[0.274_197_835_740_912_7],
    check: Check::Order(1.0),
    quick: true,
    ..BASE
};

const IMPACT: Case = Case {
    family: Family::Dynamics,
    quick: false,
    quantity: "time from the first contact of a bar with a wall until its momentum is zero, divided by L/c",
    source: "exact: half of the contact time 2L/c (B. de Saint-Venant 1867)",
    over: Over::Cells("springs along the bar"),
    levels: &[25.0, 50.0, 100.0],
    expected: &[1.0],
    check: Check::Finest,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case { name: "slope-way", measure: |lab, h| Ok(slide_down(lab, h)?[0]), ..SLOPE },
    Case {
        name: "slope-speed",
        quantity: "speed of a chain after 2.5 s on a slope of tan θ = 1/2, μ = 0.49",
        unit: "m/s",
        source: "exact: g (sin θ − μ cos θ) t, for every step",
        expected: &[0.219_358_268_592_730_17],
        tolerance: 1e-6,
        check: Check::Everywhere,
        measure: |lab, h| Ok(slide_down(lab, h)?[1]),
        ..SLOPE
    },
    Case {
        name: "sliding-stops",
        quantity: "distance that a chain slides on a horizontal plane from 2 m/s until it stops, μ = 0.4",
        source: "exact: v²/2μg",
        expected: &[0.509_683_995_922_528],
        measure: stop,
        ..SLOPE
    },
    // Changed after its first run, which assumed order 1. In a chain of masses, a wave front spreads over a number of springs that grows as the cube
    // root of the number of all springs.
    Case {
        name: "bar-hits-wall-half-time",
        check: Check::Everywhere,
        measure: |lab, n| Ok(impact(lab, n)?[0]),
        ..IMPACT
    },
    Case {
        name: "bar-hits-wall-rebound",
        quantity: "speed of the centre of mass of a bar after its impact on a wall, relative to that before",
        source: "exact: 1, the wave returns all of it (B. de Saint-Venant 1867); no order: some vibration remains in a chain of masses",
        levels: &[50.0, 100.0, 200.0],
        measure: |lab, n| Ok(impact(lab, n)?[1]),
        ..IMPACT
    },
];

fn mean_position(world: &World<2>) -> [f64; 2] {
    let n = world.node_count(0) as u32;
    let mut out = [0.0; 2];
    for k in 0..n {
        let x = world.position(0, k);
        (0..2).for_each(|d| out[d] += x[d] / f64::from(n));
    }
    out
}

/// The displacement and the speed of a chain that slides down a slope, after 150 frames.
fn slide_down(lab: &Lab, h: f64) -> Result<[f64; 2], Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, "symplectic_euler").add(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"chain\"\nmass = 1\n\
         shape = { kind = \"line\", from = [0, 0], to = [2, -1], segments = 10 }\n\
         models = [{ kind = \"mass_spring\", stiffness = 2000.0, damping = 2.0 }]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0.5, 1]\nfriction = 0.49",
    );
    let mut world = lab.plane(scene)?;
    let start = world.position(0, 3);
    for _ in 0..150 {
        world.frame()?;
    }
    let (x, v) = (world.position(0, 3), world.velocity(0, 3));
    Ok([(x[0] - start[0]).hypot(x[1] - start[1]), v[0].hypot(v[1])])
}

fn stop(lab: &Lab, h: f64) -> Result<f64, Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, "symplectic_euler").add(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"chain\"\nmass = 1\nvelocity = [2, 0]\n\
         shape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 5 }\n\
         models = [{ kind = \"mass_spring\", stiffness = 2000.0, damping = 20.0 }]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.4",
    );
    let mut world = lab.plane(scene)?;
    let start = mean_position(&world)[0];
    for _ in 0..60 {
        world.frame()?;
    }
    Ok(mean_position(&world)[0] - start)
}

/// A bar of n equal springs with c = 1 m/s and 1 kg/m hits a wall at 1 cm/s. Returns the time at which its momentum is zero, and its speed at the
/// end, divided by the initial speed.
fn impact(lab: &Lab, n: f64) -> Result<[f64; 2], Trouble> {
    let (speed, frame) = (0.01, 0.25 / n);
    let scene = Scene::new(2, frame, 4, "verlet").add(&format!(
        "[[body]]\nname = \"bar\"\nmass = 1.0\nvelocity = [{:?}, 0.0]\nshape = {{ kind = \"line\", from = [0, 0], to = [1, 0], segments = {n} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = {n:?} }}]\npin = [{{ select = {{ all = true }}, axes = \"y\" }}]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [1, 0]",
        -speed
    ));
    let mut world = lab.plane(scene)?;
    let (mut half, mut before) = (None, -1.0);
    while world.time() < 4.0 {
        world.frame()?;
        let now = world.momentum().linear.0[0] / speed;
        if half.is_none() && now >= 0.0 {
            half = Some(world.time() - frame * now / (now - before));
        }
        before = now;
    }
    Ok([half.ok_or("it does not turn round")?, before])
}
