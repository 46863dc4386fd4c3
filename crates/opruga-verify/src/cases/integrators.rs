//! Integrators in time: their orders, damping, limits and recurrences.

use super::BASE;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};

const ORDER: Case = Case {
    family: Family::Integrators,
    quantity: "displacement after 1 s of a damped oscillator, relative to that at the start, k = 4 N/m, m = 1 kg, c = 0.4 N s/m",
    source: "exact: e^(−ct/2m) (cos ωt + c/2mω sin ωt), ω² = k/m − c²/4m²",
    over: Over::Step("step [s]"),
    levels: &[1.0 / 64.0, 1.0 / 128.0, 1.0 / 256.0, 1.0 / 512.0],
    expected: &[-0.258_070_263_439_546_4],
    scale: Scale::Of(1.0),
    check: Check::Order(1.0),
    quick: true,
    ..BASE
};

const LIMIT: Case = Case {
    family: Family::Integrators,
    quantity: "largest hω at which the amplitude of an undamped oscillator does not grow",
    over: Over::Parameter("oscillator"),
    levels: &[1.0],
    tolerance: 0.002,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const FALL: Case = Case {
    family: Family::Integrators,
    quantity: "fall from rest within 1 s in n steps",
    unit: "m",
    over: Over::Parameter("steps n"),
    levels: &[16.0, 32.0, 64.0],
    tolerance: 1e-12,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case { name: "order-symplectic-euler", measure: |lab, h| damped(lab, h, "symplectic_euler"), ..ORDER },
    Case { name: "order-explicit-euler", measure: |lab, h| damped(lab, h, "explicit_euler"), ..ORDER },
    Case { name: "order-heun", check: Check::Order(2.0), measure: |lab, h| damped(lab, h, "heun"), ..ORDER },
    Case { name: "order-verlet", check: Check::Order(2.0), measure: |lab, h| damped(lab, h, "verlet"), ..ORDER },
    Case {
        name: "order-runge-kutta",
        check: Check::Order(4.0),
        measure: |lab, h| damped(lab, h, "runge_kutta"),
        ..ORDER
    },
    Case {
        name: "order-backward-euler",
        measure: |lab, h| damped(lab, h, "backward_euler\ntolerance = 1e-13"),
        ..ORDER
    },
    Case {
        name: "order-bdf2",
        check: Check::Order(2.0),
        measure: |lab, h| damped(lab, h, "bdf2\ntolerance = 1e-13"),
        ..ORDER
    },
    Case {
        name: "order-implicit-midpoint",
        check: Check::Order(2.0),
        measure: |lab, h| damped(lab, h, "implicit_midpoint\ntolerance = 1e-13"),
        ..ORDER
    },
    Case {
        name: "order-newmark",
        check: Check::Order(2.0),
        measure: |lab, h| damped(lab, h, "newmark\ntolerance = 1e-13"),
        ..ORDER
    },
    Case {
        name: "order-generalised-alpha",
        check: Check::Order(2.0),
        measure: |lab, h| damped(lab, h, "newmark\ntolerance = 1e-13\nspectral_radius = 0.5"),
        ..ORDER
    },
    Case {
        name: "backward-euler-damps",
        quantity: "amplitude √(x² + v²/ω²) of an oscillator after a step of backward Euler, relative to that before",
        source: "exact: 1/√(1 + h²ω²)",
        over: Over::Parameter("hω"),
        levels: &[0.1, 1.0, 10.0],
        expected: &[0.995_037_190_21, std::f64::consts::FRAC_1_SQRT_2, 0.099_503_719_021],
        tolerance: 1e-8,
        check: Check::Everywhere,
        scale: Scale::Relative,
        measure: amplitude,
        ..ORDER
    },
    Case {
        name: "limit-symplectic-euler",
        source: "exact: hω < 2 (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, I.5)",
        expected: &[2.0],
        measure: |lab, _| limit(lab, "symplectic_euler"),
        ..LIMIT
    },
    Case {
        name: "limit-verlet",
        source: "exact: hω < 2 (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, I.5)",
        expected: &[2.0],
        measure: |lab, _| limit(lab, "verlet"),
        ..LIMIT
    },
    Case {
        name: "limit-runge-kutta",
        source: "exact: hω ≤ 2√2 (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, IV.2)",
        expected: &[2.828_427_124_746_19],
        measure: |lab, _| limit(lab, "runge_kutta"),
        ..LIMIT
    },
    Case {
        name: "fall-symplectic-euler",
        source: "exact: −g h² n(n + 1)/2",
        expected: &[-5.211_562_5, -5.058_281_25, -4.981_640_625],
        measure: |lab, n| fall(lab, n, "symplectic_euler"),
        ..FALL
    },
    Case {
        name: "fall-backward-euler",
        source: "exact: −g h² n(n + 1)/2",
        expected: &[-5.211_562_5, -5.058_281_25, -4.981_640_625],
        measure: |lab, n| fall(lab, n, "backward_euler"),
        ..FALL
    },
    Case {
        name: "fall-bdf2",
        source: "exact: −g h² (n²/2 + 3/4 (1 − 3⁻ⁿ)), the first step by backward Euler",
        expected: &[-4.933_740_233_707_348, -4.912_185_058_593_75, -4.906_796_264_648_437],
        measure: |lab, n| fall(lab, n, "bdf2"),
        ..FALL
    },
    Case {
        name: "fall-newmark",
        source: "exact: −g t²/2 for every step",
        expected: &[-4.905],
        measure: |lab, n| fall(lab, n, "newmark"),
        ..FALL
    },
];

/// A mass of 1 kg that moves along x on a spring of 4 N/m. The scene has `substeps` steps per frame.
fn oscillator(rule: &str, h: f64, substeps: u32, damping: f64) -> Scene {
    Scene::new(2, h * f64::from(substeps), substeps, rule).add(&format!(
        "[[body]]\nname = \"weight\"\nnode_mass = 1.0\nshape = {{ kind = \"line\", from = [0, 0], to = [1, 0], segments = 1 }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 4.0, damping = {damping:?} }}]\n\
         pin = [{{ select = {{ node = 0 }} }}, {{ select = {{ node = 1 }}, axes = \"y\" }}]"
    ))
}

fn damped(lab: &Lab, h: f64, rule: &str) -> Result<f64, Trouble> {
    let mut world = lab.plane(oscillator(rule, h, (1.0 / h).round() as u32, 0.4))?;
    world.set_node(0, 1, [1.5, 0.0], [0.0; 2])?;
    world.frame()?;
    Ok((world.position(0, 1)[0] - 1.0) / 0.5)
}

fn amplitude(lab: &Lab, step: f64) -> Result<f64, Trouble> {
    let mut world = lab.plane(oscillator("backward_euler\ntolerance = 1e-13", 0.5 * step, 1, 0.0))?;
    world.set_node(0, 1, [1.5, 0.0], [0.0; 2])?;
    world.frame()?;
    let (x, v) = (world.position(0, 1)[0] - 1.0, world.velocity(0, 1)[0]);
    Ok(x.hypot(0.5 * v) / 0.5)
}

/// Finds the stable limit of ωh by bisection. A step is unstable if an oscillation of 1 mm grows a hundredfold within 2000 steps.
fn limit(lab: &Lab, rule: &str) -> Result<f64, Trouble> {
    let (mut stable, mut unstable) = (1.0, 4.0);
    for _ in 0..16 {
        let middle = 0.5 * (stable + unstable);
        let mut world = lab.plane(oscillator(rule, 0.5 * middle, 20, 0.0))?;
        world.set_node(0, 1, [1.001, 0.0], [0.0; 2])?;
        // A run that fails because of NaN counts as growing, too.
        let grows = (0..100).any(|_| world.frame().is_err() || (world.position(0, 1)[0] - 1.0).abs() > 0.1);
        if grows { unstable = middle } else { stable = middle }
    }
    Ok(stable)
}

fn fall(lab: &Lab, n: f64, rule: &str) -> Result<f64, Trouble> {
    let scene = Scene::new(2, 1.0, n as u32, rule).add(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"stone\"\nmass = 3\nshape = { kind = \"ring\", radius = 0.5, vertices = 11 }",
    );
    let mut world = lab.plane(scene)?;
    let start = world.position(0, 0)[1];
    world.frame()?;
    Ok(world.position(0, 0)[1] - start)
}
