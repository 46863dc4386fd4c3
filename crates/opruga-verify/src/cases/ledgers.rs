//! Conservation of momentum and energy, and the account of energies.

use super::BASE;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};

const LINEAR: Case = Case {
    family: Family::Ledgers,
    quantity: "largest change of the momentum of a rotating, vibrating ball in flight within 2 s, divided by Σ m |v|",
    source: "exact: inner forces come in pairs (I. Newton)",
    over: Over::Step("step [s]"),
    levels: &[1.0 / 960.0, 1.0 / 1920.0],
    scale: Scale::Of(1.0),
    tolerance: 1e-12,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const ANGULAR: Case = Case {
    quantity: "largest change of the angular momentum of a rotating, vibrating ball in flight within 2 s, divided by Σ m |x| |v|",
    source: "exact for integrators that rotate x and v alike: inner forces act along the lines between nodes (E. Hairer, C. Lubich, G. Wanner, \
Geometric Numerical Integration, IV.2)",
    ..LINEAR
};

const ENERGY: Case = Case {
    quantity: "largest fraction of the energy of a vibrating ball that the ledger cannot explain, within 2 s",
    source: "exact: 0; the remainder is the error of the integrator, with its order in the step",
    levels: &[1.0 / 960.0, 1.0 / 1920.0, 1.0 / 3840.0],
    tolerance: 0.01,
    check: Check::Order(1.0),
    ..LINEAR
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "momentum-symplectic-euler",
        measure: |lab, h| flight(lab, h, "symplectic_euler", Kept::Momentum),
        ..LINEAR
    },
    Case { name: "momentum-runge-kutta", measure: |lab, h| flight(lab, h, "runge_kutta", Kept::Momentum), ..LINEAR },
    Case {
        name: "momentum-implicit-midpoint",
        tolerance: 1e-10,
        levels: &[1.0 / 480.0, 1.0 / 960.0],
        measure: |lab, h| flight(lab, h, "implicit_midpoint\ntolerance = 1e-12", Kept::Momentum),
        ..LINEAR
    },
    Case {
        name: "angular-momentum-symplectic-euler",
        measure: |lab, h| flight(lab, h, "symplectic_euler", Kept::AngularMomentum),
        ..ANGULAR
    },
    Case {
        name: "angular-momentum-verlet",
        measure: |lab, h| flight(lab, h, "verlet", Kept::AngularMomentum),
        ..ANGULAR
    },
    Case {
        name: "angular-momentum-implicit-midpoint",
        tolerance: 1e-10,
        levels: &[1.0 / 480.0, 1.0 / 960.0],
        measure: |lab, h| flight(lab, h, "implicit_midpoint\ntolerance = 1e-12", Kept::AngularMomentum),
        ..ANGULAR
    },
    Case {
        name: "energy-symplectic-euler",
        measure: |lab, h| flight(lab, h, "symplectic_euler", Kept::Energy),
        ..ENERGY
    },
    Case {
        name: "energy-verlet",
        check: Check::Order(2.0),
        measure: |lab, h| flight(lab, h, "verlet", Kept::Energy),
        ..ENERGY
    },
    Case {
        name: "energy-heun",
        check: Check::Order(2.0),
        measure: |lab, h| flight(lab, h, "heun", Kept::Energy),
        ..ENERGY
    },
    Case {
        name: "energy-runge-kutta",
        levels: &[1.0 / 480.0, 1.0 / 960.0, 1.0 / 1920.0],
        check: Check::Order(4.0),
        measure: |lab, h| flight(lab, h, "runge_kutta", Kept::Energy),
        ..ENERGY
    },
    Case {
        name: "pins-lift-a-weight",
        quantity: "work of pins that lift 2 kg by 1 m within 1 s and hold it there",
        unit: "J",
        source: "exact: m g h",
        expected: &[19.62],
        scale: Scale::Relative,
        tolerance: 1e-9,
        quick: false,
        measure: lift,
        ..LINEAR
    },
    Case {
        name: "friction-takes-the-energy",
        quantity: "energy that friction takes from a chain of 1 kg at 2 m/s until it stops",
        unit: "J",
        source: "exact: m v²/2",
        levels: &[1.0 / 960.0, 1.0 / 1920.0, 1.0 / 3840.0],
        expected: &[2.0],
        scale: Scale::Relative,
        tolerance: 0.01,
        check: Check::Finest,
        measure: rub,
        ..LINEAR
    },
    super::heat::START,
];

/// The conserved quantity of a ball in flight.
enum Kept {
    Momentum,
    AngularMomentum,
    Energy,
}

/// The largest relative change of a conserved quantity of a rotating ring of springs around gas. The ring is out of equilibrium, and there is no
/// gravity.
fn flight(lab: &Lab, h: f64, rule: &str, kept: Kept) -> Result<f64, Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, rule).add(
        "[[body]]\nname = \"ball\"\nmass = 1\nvelocity = [0.3, 0.2]\nangular_velocity = 2.0\n\
         shape = { kind = \"ring\", radius = 0.5, vertices = 24, center = [0.2, -0.1] }\n\
         models = [{ kind = \"mass_spring\", stiffness = 400.0 }, { kind = \"pressure\", nRT = 20.0 }]",
    );
    let mut world = lab.plane(scene)?;
    let mut before = None;
    let mut worst: f64 = 0.0;
    for _ in 0..120 {
        world.frame()?;
        let now = world.momentum();
        let (mut sum, mut turning) = (0.0, 0.0);
        for node in 0..world.node_count(0) as u32 {
            let (x, v) = (world.position(0, node), world.velocity(0, node));
            let p = world.node_mass(0, node) * v[0].hypot(v[1]);
            sum += p;
            turning += p * x[0].hypot(x[1]);
        }
        let first = *before.get_or_insert(now);
        let change = match kept {
            Kept::Momentum => (now.linear.0[0] - first.linear.0[0]).hypot(now.linear.0[1] - first.linear.0[1]) / sum,
            Kept::AngularMomentum => (now.angular[2] - first.angular[2]).abs() / turning,
            Kept::Energy => world.energy().drift(),
        };
        worst = worst.max(change);
    }
    Ok(worst)
}

fn lift(lab: &Lab, h: f64) -> Result<f64, Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, "verlet").add(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"load\"\nmass = 2\n\
         shape = { kind = \"ring\", radius = 0.5, vertices = 11 }\n\
         pin = [{ select = { all = true }, motion = [[0, 0, 0], [1, 0, 1]] }]",
    );
    let mut world = lab.plane(scene)?;
    for _ in 0..120 {
        world.frame()?;
    }
    Ok(world.energy().work_user)
}

fn rub(lab: &Lab, h: f64) -> Result<f64, Trouble> {
    let frame = 1.0 / 60.0;
    let scene = Scene::new(2, frame, (frame / h).round() as u32, "symplectic_euler").add(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"chain\"\nmass = 1\nvelocity = [2, 0]\n\
         shape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 5 }\n\
         models = [{ kind = \"mass_spring\", stiffness = 2000.0 }]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.4",
    );
    let mut world = lab.plane(scene)?;
    for _ in 0..60 {
        world.frame()?;
    }
    Ok(world.energy().loss_friction)
}
