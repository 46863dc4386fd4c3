//! Contact between bodies: impacts of bars, friction of one body on another, momentum.

use super::BASE;
use super::pressed::weight;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;

const BARS: Case = Case {
    family: Family::Dynamics,
    over: Over::Cells("springs along the first bar"),
    levels: &[50.0, 100.0, 200.0],
    expected: &[1.0],
    check: Check::Finest,
    ..BASE
};

const SLOPE: Case = Case {
    family: Family::Dynamics,
    unit: "m",
    over: Over::Step("step [s]"),
    levels: &[1.0 / 960.0, 1.0 / 1920.0, 1.0 / 3840.0],
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "bars-meet-swap",
        quantity: "speed of a bar after an equal bar has hit it, relative to the speed of the other bar before the impact",
        source: "exact: 1, they swap their speeds (B. de Saint-Venant 1867); no order: some vibration remains in a chain of masses",
        measure: |lab, n| Ok(impact(lab, n, 1.0, 0.0)?.gained),
        ..BARS
    },
    Case {
        name: "bars-meet-half-time",
        quantity: "time from the first contact of two equal bars until half of the momentum has been transferred, divided by L/c",
        source: "exact: half of the contact time 2L/c (B. de Saint-Venant 1867)",
        check: Check::Everywhere,
        measure: |lab, n| Ok(impact(lab, n, 1.0, 0.0)?.half),
        ..BARS
    },
    Case {
        name: "bars-meet-stress",
        quantity: "stress in the middle of a bar at rest after an equal bar has hit it, divided by ρcv/2",
        source: "exact: ρcv/2 until the wave returns from the end (B. de Saint-Venant 1867)",
        measure: |lab, n| Ok(impact(lab, n, 1.0, 0.0)?.stress),
        ..BARS
    },
    Case {
        name: "bars-meet-head-on",
        quantity: "speed of one of two equal bars after they have collided at ±v, divided by v",
        source: "exact: 1, they swap their speeds (B. de Saint-Venant 1867); no order: some vibration remains in a chain of masses",
        measure: |lab, n| Ok(impact(lab, n, 1.0, -1.0)?.gained),
        ..BARS
    },
    Case {
        name: "bars-meet-head-on-stress",
        quantity: "stress in the middle of one of two equal bars that have collided at ±v, divided by ρcv",
        source: "exact: ρcv until the wave returns from the end (B. de Saint-Venant 1867)",
        measure: |lab, n| Ok(impact(lab, n, 1.0, -1.0)?.stress),
        ..BARS
    },
    Case {
        name: "bars-meet-twice-as-long",
        quantity: "speed at which two bars separate after the impact of one on another of twice its length, relative to their speed of approach",
        source: "exact: the ratio of the lengths (B. de Saint-Venant 1867)",
        expected: &[0.5],
        measure: |lab, n| Ok(impact(lab, n, 2.0, 0.0)?.apart),
        ..BARS
    },
    Case {
        name: "bodies-bounce",
        quantity: "speed at which two rods of 1 and 2 kg separate after a flat impact, relative to their speed of approach",
        source: "exact: the restitution e (I. Newton)",
        over: Over::Parameter("e"),
        levels: &[0.25, 0.5, 1.0],
        expected: &[0.25, 0.5, 1.0],
        tolerance: 1e-9,
        check: Check::Everywhere,
        measure: |lab, e| Ok(bounce(lab, e, "verlet")?[0]),
        ..BARS
    },
    Case {
        name: "bodies-bounce-loss",
        quantity: "energy that contact takes from the same rods according to the ledger, divided by half the reduced mass times the square of their \
speed of approach",
        source: "exact: 1 − e² (I. Newton)",
        over: Over::Parameter("e"),
        levels: &[0.0, 0.25, 0.5],
        expected: &[1.0, 0.9375, 0.75],
        tolerance: 1e-9,
        check: Check::Everywhere,
        measure: |lab, e| Ok(bounce(lab, e, "verlet")?[1]),
        ..BARS
    },
    Case {
        name: "slope-way-on-body",
        quantity: "distance that a chain slides down a fixed body with a slope of tan θ = 1/2 in 2.5 s, μ = 0.49",
        source: "exact: g (sin θ − μ cos θ) t²/2 (C. A. Coulomb)",
        expected: &[0.274_197_835_740_912_7],
        check: Check::Order(1.0),
        measure: |lab, h| slide_down(lab, h, 0.49, "symplectic_euler"),
        ..SLOPE
    },
    Case {
        name: "slope-stick-on-body",
        quantity: "distance that the same chain slides with μ = 0.505",
        source: "exact: 0, tan θ < μ (C. A. Coulomb)",
        scale: Scale::Of(1.0),
        tolerance: 1e-4,
        check: Check::Everywhere,
        measure: |lab, h| slide_down(lab, h, 0.505, "symplectic_euler"),
        ..SLOPE
    },
    Case {
        name: "bodies-bounce-implicit",
        quantity: "as `bodies-bounce`, by backward Euler",
        source: "exact: the restitution e (I. Newton)",
        over: Over::Parameter("e"),
        levels: &[0.25, 0.5, 1.0],
        expected: &[0.25, 0.5, 1.0],
        tolerance: 1e-6,
        check: Check::Everywhere,
        measure: |lab, e| Ok(bounce(lab, e, "backward_euler")?[0]),
        ..BARS
    },
    Case {
        name: "slope-way-on-body-implicit",
        quantity: "as `slope-way-on-body`, by backward Euler",
        source: "exact: g (sin θ − μ cos θ) t²/2 (C. A. Coulomb)",
        levels: &[1.0 / 240.0, 1.0 / 480.0, 1.0 / 960.0],
        expected: &[0.274_197_835_740_912_7],
        check: Check::Order(1.0),
        measure: |lab, h| slide_down(lab, h, 0.49, "backward_euler"),
        ..SLOPE
    },
    Case {
        name: "slope-stick-on-body-implicit",
        quantity: "distance that the same chain slides with μ = 0.505",
        source: "exact: 0, tan θ < μ (C. A. Coulomb)",
        levels: &[1.0 / 240.0, 1.0 / 480.0, 1.0 / 960.0],
        scale: Scale::Of(1.0),
        tolerance: 1e-4,
        check: Check::Everywhere,
        measure: |lab, h| slide_down(lab, h, 0.505, "backward_euler"),
        ..SLOPE
    },
    Case {
        name: "weight-on-body",
        quantity: "force between a solid at rest and the one that it stands on, relative to its weight, by backward Euler at 1/60 s",
        source: "exact: 1 (I. Newton)",
        over: Over::Parameter("mass of the upper body divided by that of the lower one"),
        levels: &[1e-2, 1.0, 1e2],
        expected: &[1.0],
        tolerance: 1e-6,
        check: Check::Everywhere,
        measure: |lab, ratio| weight(lab, "backward_euler", "", ratio, 1.0),
        ..BARS
    },
];

pub(super) const LEDGERS: &[Case] = &[
    Case {
        name: "balls-meet-momentum",
        family: Family::Ledgers,
        quantity: "momentum of two balls after a collision with friction, relative to that before",
        source: "exact: the impulses of a pair sum to zero",
        over: Over::Cells("vertices of a ball"),
        levels: &[24.0, 48.0, 96.0],
        expected: &[1.0],
        tolerance: 1e-12,
        check: Check::Everywhere,
        measure: |lab, n| balls(lab, n, 64, "symplectic_euler"),
        ..BASE
    },
    Case {
        name: "balls-meet-momentum-implicit",
        family: Family::Ledgers,
        quantity: "as `balls-meet-momentum`, by backward Euler",
        source: "exact: the impulses of a pair sum to zero",
        over: Over::Cells("vertices of a ball"),
        levels: &[24.0, 48.0],
        expected: &[1.0],
        tolerance: 1e-6,
        check: Check::Everywhere,
        measure: |lab, n| balls(lab, n, 4, "backward_euler"),
        ..BASE
    },
];

/// The results for two bars.
struct Impact {
    /// The speed of the second bar divided by the speed of the first before the impact.
    gained: f64,
    /// The time at which half of the momentum has been transferred [s].
    half: f64,
    /// The compressive strain at the middle of the second bar, divided by v/(2c), where v is the speed of approach and c the speed of waves.
    stress: f64,
    /// The speed of separation divided by the speed of approach.
    apart: f64,
}

/// Two bars of equal springs with c = 1 m/s and 1 kg/m collide. The first one is 1 m long, has n springs and moves at 1 cm/s. The second one moves at
/// `times` that speed.
fn impact(lab: &Lab, n: f64, length: f64, times: f64) -> Result<Impact, Trouble> {
    let (speed, frame, gap) = (0.01, 0.25 / n, 1e-4);
    let bar = |name: &str, from: f64, to: f64, v: f64| {
        let springs = n * (to - from).round();
        format!(
            "[[body]]\nname = \"{name}\"\nmass = {:?}\nvelocity = [{v:?}, 0.0]\nshape = {{ kind = \"line\", from = [{from:?}, 0], to = [{to:?}, 0], \
             segments = {springs} }}\nmodels = [{{ kind = \"mass_spring\", stiffness = {n:?} }}]\npin = [{{ select = {{ all = true }}, axes = \"y\" }}]\n",
            (to - from).round()
        )
    };
    let scene = Scene::new(2, frame, 4, "verlet")
        .add(&format!("[contact]\nthickness = {gap:?}\nself = false"))
        .add(&bar("first", -1.0 - gap, -gap, speed))
        .add(&bar("second", 0.0, length, times * speed));
    let mut world = lab.plane(scene)?;
    let (mut half, mut before) = (None, 0.0);
    let (mut strain, mut frames) = (0.0, 0.0);
    let middle = (n / 2.0) as u32;
    while world.time() < 2.0 + 2.0 * length {
        world.frame()?;
        let (time, now) = (world.time(), momentum(&world, 1) / speed);
        if half.is_none() && now >= 0.5 {
            half = Some(time - frame * (now - 0.5) / (now - before));
        }
        before = now;
        if (0.7..1.3).contains(&time) && length == 1.0 {
            let [a, b] = [middle, middle + 1].map(|node| world.position(1, node)[0]);
            strain += 1.0 - (b - a) * n;
            frames += 1.0;
        }
    }
    let [first, second] = [momentum(&world, 0), momentum(&world, 1) / length];
    Ok(Impact {
        gained: second / speed,
        half: half.ok_or("half of the momentum does not go over")?,
        stress: strain / frames / (0.5 * speed * (1.0 - times)),
        apart: (second - first) / (speed * (1.0 - times)),
    })
}

/// The momentum of a body along x [kg m/s].
fn momentum(world: &World<2>, body: usize) -> f64 {
    (0..world.node_count(body) as u32).map(|n| world.node_mass(body, n) * world.velocity(body, n)[0]).sum()
}

/// Two parallel rods collide at a relative speed v = 4 m/s. Returns their speed of separation divided by v, and the loss divided by ½ m v² with the
/// reduced mass m = ⅔ kg.
fn bounce(lab: &Lab, restitution: f64, rule: &str) -> Result<[f64; 2], Trouble> {
    let rod = |name: &str, x: f64, v: f64, mass: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = {mass:?}\nvelocity = [{v:?}, 0]\n\
             shape = {{ kind = \"line\", from = [{x:?}, -0.5], to = [{x:?}, 0.5], segments = 1 }}\n\
             models = [{{ kind = \"mass_spring\", stiffness = 100.0 }}]\n"
        )
    };
    let scene = Scene::new(2, 1.0 / 60.0, 16, rule)
        .add(&format!("[contact]\nrestitution = {restitution:?}\nthickness = 0.01"))
        .add(&rod("first", -1.0, 3.0, 1.0))
        .add(&rod("second", 0.5, -1.0, 2.0));
    let mut world = lab.plane(scene)?;
    for _ in 0..60 {
        world.frame()?;
    }
    let [first, second] = [momentum(&world, 0), momentum(&world, 1) / 2.0];
    Ok([(second - first) / 4.0, world.energy().loss_contact / (0.5 * 2.0 / 3.0 * 16.0)])
}

/// The displacement after 150 frames of a chain that slides down a pinned line [m].
fn slide_down(lab: &Lab, h: f64, friction: f64, rule: &str) -> Result<f64, Trouble> {
    let (frame, gap) = (1.0 / 60.0, 1e-3);
    let [x, y] = [gap / 5f64.sqrt(), 2.0 * gap / 5f64.sqrt()];
    let scene = Scene::new(2, frame, (frame / h).round() as u32, rule).add(&format!(
        "[world]\ngravity = [0.0, -9.81]\n[contact]\nfriction = {friction:?}\nthickness = {gap:?}\nself = false\n\
         [[body]]\nname = \"chain\"\nmass = 1\nshape = {{ kind = \"line\", from = [{x:?}, {y:?}], to = [{:?}, {:?}], segments = 10 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 2000.0, damping = 2.0 }}]\n\
         [[body]]\nname = \"slope\"\nmass = 1\nshape = {{ kind = \"line\", from = [-2, 1], to = [6, -3], segments = 4 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 2000.0 }}]\npin = [{{ select = {{ all = true }} }}]",
        2.0 + x,
        y - 1.0
    ));
    let mut world = lab.plane(scene)?;
    let start = world.position(0, 3);
    for _ in 0..150 {
        world.frame()?;
    }
    let x = world.position(0, 3);
    Ok((x[0] - start[0]).hypot(x[1] - start[1]))
}

/// The total momentum of two balls of gas after their contact, divided by that before the contact.
fn balls(lab: &Lab, n: f64, substeps: u32, rule: &str) -> Result<f64, Trouble> {
    let ball = |name: &str, x: f64, y: f64, v: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = 1\nvelocity = [{v:?}, 0.5]\nshape = {{ kind = \"ring\", radius = 0.5, vertices = {n}, center = [{x:?}, {y:?}] }}\n\
             models = [{{ kind = \"mass_spring\", stiffness = 400.0, damping = 0.2 }}, {{ kind = \"pressure\", nRT = 20.0 }}]\n"
        )
    };
    let scene = Scene::new(2, 1.0 / 60.0, substeps, rule)
        .add("[contact]\nfriction = 0.5")
        .add(&ball("first", -0.7, 0.1, 3.0))
        .add(&ball("second", 0.7, 0.0, -1.0));
    let mut world = lab.plane(scene)?;
    let before = momentum(&world, 0) + momentum(&world, 1);
    for _ in 0..60 {
        world.frame()?;
    }
    if world.energy().loss_friction <= 0.0 {
        return Err("they have not met".into());
    }
    Ok((momentum(&world, 0) + momentum(&world, 1)) / before)
}
