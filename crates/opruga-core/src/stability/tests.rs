//! The recurrence, compared with known spectra. The steps of real integrators are compared with their true limits in the crate of
//! the integrators.

use super::*;
use crate::integrator::Amplification;
use crate::potential::{Observe, Potential, Properties, Views};
use crate::state::Parameter;
use crate::system::Pin;
use opruga_math::Simd;

/// Every coordinate on its own spring and damper to the origin: a diagonal K and C.
#[derive(Debug)]
struct Anchors {
    stiffness: Vec<f64>,
    damping: Vec<f64>,
}

impl<const D: usize> Potential<D> for Anchors {
    fn properties(&self) -> Properties {
        Properties::new(
            "anchors",
            Views { energy: true, hessian: false, symmetric: false, damping: self.damping.iter().any(|c| *c > 0.0) },
        )
    }
    fn add_force(&self, _simd: Simd, view: &View<D>, _scratch: &[f64], tile: &mut Tile<D>) {
        for p in tile.range.clone().take(self.stiffness.len()) {
            for d in 0..D {
                tile.force[d][p - tile.range.start] -=
                    self.stiffness[p] * view.x[d][p] + self.damping[p] * view.v[d][p];
            }
        }
    }
}

impl<const D: usize> Observe<D> for Anchors {}

/// The amplification of symplectic Euler, or of explicit Euler.
#[derive(Debug)]
struct Rule {
    symplectic: bool,
}

impl Integrator<2> for Rule {
    fn name(&self) -> &'static str {
        "rule"
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        let (k, d) = (-omega * omega * h, 1.0 - c * h);
        Amplification::new(if self.symplectic { [[1.0 + h * k, h * d], [k, d]] } else { [[1.0, h], [k, d]] })
    }
    fn step(&self, _system: &mut System<2>, _h: f64) -> Result<(), StepError> {
        Ok(())
    }
}

const SYMPLECTIC: Rule = Rule { symplectic: true };
const EXPLICIT: Rule = Rule { symplectic: false };

fn anchored(
    layout: Layout,
    nodes: usize,
    bodies: usize,
    mass: f64,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
) -> System<2> {
    let index_count = layout.index_count(nodes);
    let (mut x, v) = (Columns::zeros(index_count), Columns::zeros(index_count));
    for p in 0..nodes * layout.stride() {
        x.set(p, [0.1 * p as f64, 1.0 / (1.0 + p as f64)]);
    }
    let mut system = System::new(Simd::best(), layout, nodes, bodies, x, v, Parameter::uniform(mass));
    system.add(Box::new(Anchors { stiffness, damping }));
    system.plan(0);
    system
}

fn close(computed: f64, exact: f64) {
    // Not below the exact value except for rounding, and not much above it.
    assert!(computed >= 0.999_999 * exact && computed <= 1.005 * exact, "{computed} {exact}");
}

#[test]
fn the_largest_eigenvalues_are_found() {
    let stiffness: Vec<f64> = (0..500).map(|k| 1.0 + k as f64).collect();
    let damping: Vec<f64> = (0..500).map(|k| 3.0 + 0.01 * k as f64).collect();
    let system = anchored(Layout::Single, 500, 1, 2.0, stiffness, damping);
    let stability = estimate(&system, &SYMPLECTIC).unwrap();
    close(stability.spectrum.omega, (500.0f64 / 2.0).sqrt());
    close(stability.spectrum.damping, 7.99 / 2.0);
    assert!(stability.spectrum.least_damping <= 1.5 && stability.spectrum.least_damping > 1.48, "{stability:?}");
}

#[test]
fn pinned_nodes_and_axes_and_unused_bodies_do_not_count() {
    let mut stiffness = vec![4.0; 20];
    (stiffness[3], stiffness[7]) = (400.0, 900.0);
    let mut system = anchored(Layout::Single, 20, 1, 1.0, stiffness, vec![0.0; 20]);
    let pin = |index, axes| Pin { index, axes, anchor: [0.0; 2], motion: Default::default() };
    close(estimate(&system, &SYMPLECTIC).unwrap().spectrum.omega, 30.0);
    system.pins.push(pin(7, [true, false]));
    close(estimate(&system, &SYMPLECTIC).unwrap().spectrum.omega, 30.0);
    system.pins.push(pin(7, [false, true]));
    close(estimate(&system, &SYMPLECTIC).unwrap().spectrum.omega, 20.0);
    system.pins.push(pin(3, [true, true]));
    close(estimate(&system, &SYMPLECTIC).unwrap().spectrum.omega, 2.0);

    // Eight lanes, of which three are bodies; the stiffest spring is in lane 5, the next one in lane 2.
    let mut stiffness = vec![1.0; 80];
    (stiffness[8 * 4 + 5], stiffness[8 * 6 + 2]) = (400.0, 100.0);
    let system = anchored(Layout::Batch, 10, 3, 1.0, stiffness, vec![0.0; 80]);
    close(estimate(&system, &SYMPLECTIC).unwrap().spectrum.omega, 10.0);
}

#[test]
fn nothing_to_move_is_stable() {
    let system = anchored(Layout::Single, 9, 1, 1.0, vec![0.0; 9], vec![0.0; 9]);
    let stability = estimate(&system, &EXPLICIT).unwrap();
    assert_eq!((stability.spectrum.omega, stability.spectrum.damping), (0.0, 0.0));
    assert_eq!(stability.largest_stable_step, Some(f64::INFINITY));
    let pinned = anchored(Layout::Single, 9, 1, 0.0, vec![5.0; 9], vec![0.0; 9]);
    assert_eq!(estimate(&pinned, &SYMPLECTIC).unwrap().largest_stable_step, Some(f64::INFINITY));
}

#[test]
fn states_without_finite_forces_are_refused() {
    let mut system = anchored(Layout::Single, 9, 1, 1.0, vec![5.0; 9], vec![0.0; 9]);
    system.state.x.0[1][4] = f64::NAN;
    assert!(estimate(&system, &SYMPLECTIC).is_err());
}

/// Any frequency up to ω with any damping in a range.
fn rectangle(omega: f64, [least_damping, damping]: [f64; 2]) -> Spectrum {
    Spectrum { omega, damping, least_damping, offset: [least_damping - damping, damping] }
}

#[test]
fn limits_of_symplectic_euler() {
    // The limit is 2/ω without damping and (2/ω)(√(1 + ζ²) − ζ) with damping. For the springs of the thesis, ω = 80 and c =
    // 160, it is 0.01036 s, not 0.025 s.
    let limit = |omega, c| rectangle(omega, [0.0, c]).largest_stable_step(&SYMPLECTIC).unwrap();
    assert!((limit(80.0, 0.0) - 0.025).abs() < 1e-9);
    assert!((limit(80.0, 160.0) - 0.025 * (2.0f64.sqrt() - 1.0)).abs() < 1e-9);
    assert!((limit(0.0, 10.0) - 0.2).abs() < 1e-9);
    assert!((limit(1e-6, 10.0) - 0.2).abs() < 1e-6);
    assert!((limit(10.0, 1e-7) - 0.2).abs() < 1e-6);
    // The worst corner is that of the fastest oscillation and the strongest damping, whatever other modes there are.
    let proportional = Spectrum { omega: 80.0, damping: 160.0, least_damping: 0.0, offset: [0.0, 0.0] };
    assert!((proportional.largest_stable_step(&SYMPLECTIC).unwrap() - limit(80.0, 160.0)).abs() < 1e-12);
}

#[test]
fn limits_of_explicit_euler() {
    let limit = |omega, least, most| rectangle(omega, [least, most]).largest_stable_step(&EXPLICIT);
    assert_eq!(limit(80.0, 0.0, 0.0), None);
    // If one mode may be undamped, there is no stable step, however strongly others are damped.
    assert_eq!(limit(80.0, 0.0, 160.0), None);
    // Equal damping of all modes: h = c/ω².
    let h = limit(80.0, 1.0, 1.0).unwrap();
    assert!((h * 6400.0 - 1.0).abs() < 1e-4, "{h}");
    assert!((limit(0.0, 4.0, 4.0).unwrap() - 0.5).abs() < 1e-9);
    // Stiffness-proportional damping, c = ω²/160: h = 1/160 for every mode.
    let proportional = Spectrum { omega: 80.0, damping: 40.0, least_damping: 0.0, offset: [0.0, 0.0] };
    let h = proportional.largest_stable_step(&EXPLICIT).unwrap();
    assert!((h * 160.0 - 1.0).abs() < 1e-4, "{h}");
}

#[test]
fn growth_is_that_of_the_worst_mode() {
    let spectrum = Spectrum::uniform(80.0, 0.0);
    // ½ ln(1 + h²ω²)/h.
    let h = 1e-3;
    let expected = 0.5 * Lane::ln(1.0f64 + 0.0064) / h;
    assert!((spectrum.growth_per_second(&EXPLICIT, h) - expected).abs() < 1e-9 * expected);
    assert_eq!(spectrum.growth_per_second(&SYMPLECTIC, h), 0.0);
}

#[test]
fn the_polygon_is_narrow_where_damping_follows_stiffness() {
    let stiffness: Vec<f64> = (0..200).map(|k| 10.0 + k as f64).collect();
    let follows = anchored(Layout::Single, 200, 1, 1.0, stiffness.clone(), stiffness.iter().map(|k| 0.1 * k).collect());
    let spectrum = Spectrum::of(&follows).unwrap();
    assert!(
        spectrum.offset[0].abs() < 0.05 * spectrum.damping && spectrum.offset[1].abs() < 0.05 * spectrum.damping,
        "{spectrum:?}"
    );
    // The damping opposes the stiffness: the softest spring has the strongest damper.
    let opposes =
        anchored(Layout::Single, 200, 1, 1.0, stiffness.clone(), stiffness.iter().map(|k| 0.1 * (219.0 - k)).collect());
    let spectrum = Spectrum::of(&opposes).unwrap();
    assert!(
        spectrum.offset[1] > 0.9 * spectrum.damping && spectrum.offset[0] < -0.9 * spectrum.damping,
        "{spectrum:?}"
    );
}

#[test]
fn damping_in_proportion_to_stiffness_has_its_closed_form_whatever_the_rounding() {
    for k in 0..2_000 {
        let omega = 3.0 + 0.0137 * f64::from(k);
        let damping = omega * (0.1 + 0.000_71 * f64::from(k % 977));
        let spectrum = Spectrum { omega, damping, least_damping: 0.0, offset: [0.0; 2] };
        let ratio = 0.5 * damping / omega;
        // ω² h² + 2 c h = 4 at the limit of symplectic Euler.
        let limit = 2.0 / omega * ((1.0 + ratio * ratio).sqrt() - ratio);
        let found = spectrum.largest_stable_step(&SYMPLECTIC).expect("a stable step");
        assert!((found / limit - 1.0).abs() < 1e-6, "ω = {omega}, c = {damping}: {found} {limit}");
    }
}
