//! Compares the energy that implicit integrators themselves dissipate with the ledger, and with formulas that contain
//! differences of states.

use super::{problems, two_nodes};
use opruga_core::history::Content;
use opruga_core::integrator::Integrator;
use opruga_core::spec::{Value, Values};
use opruga_core::state::Columns;
use opruga_core::system::{Pin, Stage, System};
use opruga_math::Lane;
use std::sync::Arc;

const NODES: usize = 2;
type Vectors = [[f64; 2]; NODES];

/// The formula of an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Formula {
    BackwardEuler,
    Bdf2,
    Midpoint,
    /// The generalised-α method with its spectral radius, or with `None` for average acceleration.
    GeneralisedAlpha(Option<f64>),
}

const FORMULAS: [Formula; 7] = [
    Formula::BackwardEuler,
    Formula::Bdf2,
    Formula::Midpoint,
    Formula::GeneralisedAlpha(None),
    Formula::GeneralisedAlpha(Some(0.0)),
    Formula::GeneralisedAlpha(Some(0.5)),
    Formula::GeneralisedAlpha(Some(1.0)),
];

impl Formula {
    fn rule(self) -> Box<dyn Integrator<2>> {
        let name = match self {
            Formula::BackwardEuler => "backward_euler",
            Formula::Bdf2 => "bdf2",
            Formula::Midpoint => "implicit_midpoint",
            Formula::GeneralisedAlpha(_) => "newmark",
        };
        let kinds = crate::all::<2>();
        let kind = kinds.iter().find(|kind| kind.spec().kind == name).unwrap();
        let mut values = Values::defaults(kind.spec(), 2);
        values.set_instead(kind.spec(), "tolerance", Value::Number(1e-13), 2).unwrap();
        if let Formula::GeneralisedAlpha(Some(radius)) = self {
            values.set_instead(kind.spec(), "spectral_radius", Value::Number(radius), 2).unwrap();
        }
        kind.build(&values).unwrap()
    }
}

/// A state: positions, velocities, ∇U, the remembered accelerations, U.
#[derive(Clone, Copy, Debug)]
struct Moment {
    x: Vectors,
    v: Vectors,
    g: Vectors,
    a: Vectors,
    u: f64,
}

fn of(columns: &Columns<2>) -> Vectors {
    core::array::from_fn(|node| columns.at(node))
}

impl Moment {
    fn of(system: &mut System<2>) -> Moment {
        let g = of(&system.forces(false).unwrap()).map(|f| f.map(|f| -f));
        let u = system.potential_energy(Stage::Current, 0.0).unwrap();
        let a = system
            .history
            .channels()
            .find_map(|(_, content)| if let Content::Vectors(a) = content { Some(of(a)) } else { None })
            .unwrap_or([[0.0; 2]; NODES]);
        Moment { x: of(&system.state.x), v: of(&system.state.v), g, a, u }
    }
}

fn combined(a: &Vectors, s: f64, b: &Vectors) -> Vectors {
    core::array::from_fn(|node| core::array::from_fn(|d| a[node][d] + s * b[node][d]))
}

fn less(a: &Vectors, b: &Vectors) -> Vectors {
    combined(a, -1.0, b)
}

fn dot(a: &Vectors, b: &Vectors) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

/// Returns a·M b.
fn by_mass(system: &System<2>, a: &Vectors, b: &Vectors) -> f64 {
    (0..NODES).map(|n| system.mass.at(n) * (a[n][0] * b[n][0] + a[n][1] * b[n][1])).sum()
}

/// ∇U at another position.
fn gradient_at(system: &mut System<2>, x: &Vectors) -> Vectors {
    let kept = system.state.x.clone();
    x.iter().enumerate().for_each(|(node, x)| system.state.x.set(node, *x));
    let forces = system.forces(false).unwrap();
    system.state.x = kept;
    of(&forces).map(|f| f.map(|f| -f))
}

/// The dissipation according to the formula of an integrator. `before` is the state at the start of the previous step.
fn dissipated(formula: Formula, system: &mut System<2>, [before, start, end]: [Option<Moment>; 3], h: f64) -> f64 {
    let (start, end) = (start.unwrap(), end.unwrap());
    let (dx, dv) = (less(&end.x, &start.x), less(&end.v, &start.v));
    let fallen = start.u - end.u;
    match (formula, before) {
        (Formula::BackwardEuler, _) | (Formula::Bdf2, None) => {
            0.5 * by_mass(system, &dv, &dv) + fallen + dot(&end.g, &dx)
        }
        (Formula::Bdf2, Some(before)) => {
            let (dx_before, dv_before) = (less(&start.x, &before.x), less(&start.v, &before.v));
            0.5 * by_mass(system, &dv, &dv) - by_mass(system, &end.v, &dv_before) / 3.0 - dot(&end.g, &dx_before) / 3.0
                + fallen
                + dot(&end.g, &dx)
        }
        (Formula::Midpoint, _) => {
            let g = gradient_at(system, &combined(&start.x, 0.5, &dx));
            fallen + dot(&g, &dx)
        }
        (Formula::GeneralisedAlpha(radius), _) => {
            let [alpha_m, alpha_f] =
                radius.map_or([0.0; 2], |rho| [(2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)]);
            let (gamma, beta) = (0.5 - alpha_m + alpha_f, 0.25 * (1.0 - alpha_m + alpha_f) * (1.0 - alpha_m + alpha_f));
            // The force in the averaged state.
            let g = gradient_at(system, &combined(&start.x, 1.0 - alpha_f, &dx));
            let da = less(&end.a, &start.a);
            let squares = by_mass(system, &end.a, &end.a) - by_mass(system, &start.a, &start.a);
            fallen
                + dot(&g, &dx)
                + (1.0 - gamma - alpha_m) * by_mass(system, &dx, &da)
                + h * h * (beta - 0.5 * gamma) * (0.5 * squares + (gamma - 0.5) * by_mass(system, &da, &da))
        }
    }
}

/// A spring that spins, drifts and oscillates with a large amplitude, undamped, with nine steps per period. Every step
/// obeys the formula of its integrator, and the losses of all steps add up to the energy that is missing at the end.
#[test]
fn what_a_rule_dissipates_is_what_its_formula_says() {
    for formula in FORMULAS {
        let (rule, h) = (formula.rule(), 0.08);
        let mut system: System<2> = two_nodes(0.0);
        system.equip(&*rule);
        let first = Moment::of(&mut system);
        let begun = problems::energy_of_two_nodes(&system);
        let (mut before, mut start) = (None, first);
        if let Formula::GeneralisedAlpha(_) = formula {
            start.a = core::array::from_fn(|n| start.g[n].map(|g| -g / system.mass.at(n)));
        }
        let (mut most, mut all) = (0.0f64, 0.0);
        for step in 0..200 {
            let entered: f64 = system.work.numerical.iter().sum();
            rule.step(&mut system, h).unwrap();
            let end = Moment::of(&mut system);
            let measured = system.work.numerical.iter().sum::<f64>() - entered + start.u - end.u;
            let expected = dissipated(formula, &mut system, [before, Some(start), Some(end)], h);
            assert!((measured - expected).abs() < 1e-10 * begun, "{formula:?}, step {step}: {measured} {expected}");
            most = if expected.abs() > most { expected.abs() } else { most };
            all += measured;
            (before, start) = (Some(start), end);
        }
        let missing = begun - problems::energy_of_two_nodes(&system);
        assert!((all - missing).abs() < 1e-10 * begun, "{formula:?}: {all} {missing}");
        // The formulas are not trivially zero: the energy exchanged with a rotating spring is visible.
        assert!(most > 1e-4 * begun, "{formula:?}: {most}");
        let damps = matches!(formula, Formula::BackwardEuler | Formula::GeneralisedAlpha(Some(0.0)));
        assert!(!damps || all > 0.05 * begun, "{formula:?}: {all} of {begun}");
    }
}

/// The ledger explains all energy in a system with a damper, weight, a node that a pin moves, and steps of different
/// lengths.
#[test]
fn the_ledger_of_implicit_rules_closes_whatever_acts() {
    for formula in FORMULAS {
        for led in [false, true] {
            let rule = formula.rule();
            let mut system: System<2> = two_nodes(0.8);
            system.gravity = [0.3, -2.0];
            if led {
                let (start, speed) = (system.state.x.at(0), [2.0, -0.5]);
                let motion = Arc::new(vec![vec![0.0, 0.0, 0.0], vec![10.0, 10.0 * speed[0], 10.0 * speed[1]]]);
                system.pins.push(Pin { index: 0, axes: [true, true], anchor: start, motion });
                system.state.v.set(0, speed);
            }
            system.equip(&*rule);
            let total = |system: &mut System<2>| {
                let stored = Moment::of(system).u;
                (stored, stored + system.kinetic_energy())
            };
            let (stored, begun) = total(&mut system);
            for step in 0..60 {
                rule.step(&mut system, if step % 5 == 4 { 0.11 } else { 0.05 }).unwrap();
                let (now, ended) = total(&mut system);
                let sum = |parts: &[f64; 8]| parts.iter().sum::<f64>();
                let work = &system.work;
                let taken = sum(&work.damping) - sum(&work.user) + sum(&work.numerical) + stored - now;
                let left = begun - ended - taken;
                assert!(
                    left.abs() < 1e-10 * begun.abs().larger(ended.abs()),
                    "{formula:?}, {led}, step {step}: {left}"
                );
            }
        }
    }
}
