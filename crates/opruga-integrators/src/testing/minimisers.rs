//! A minimiser that has nothing in common with Newton's method reaches the same incremental potential, and rules do not depend
//! on which minimiser is used.

use super::problems::Springs;
use super::{distance, state};
use crate::backward_euler::BackwardEuler;
use crate::bdf2::Bdf2;
use crate::implicit::balance::{Balance, Solved};
use crate::implicit::linear::Linear;
use crate::implicit::minimiser::Minimiser;
use crate::implicit::newton::Newton;
use crate::implicit::rule::Rule;
use crate::implicit::settings::Settings;
use crate::implicit::stage::{evaluate, mixture, potential};
use crate::implicit::step::Implicit;
use crate::implicit::theta::Theta;
use crate::implicit::workspace::Workspace;
use crate::implicit_midpoint::ImplicitMidpoint;
use crate::newmark::Newmark;
use crate::{backward_euler, bdf2, implicit_midpoint, newmark};
use core::cell::RefCell;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::spec::{Spec, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::System;
use opruga_math::{Lane, Simd};

/// Gradient descent with a line search by energy. The gradient of each node is divided by the mean diagonal of its own block.
#[derive(Debug)]
struct GradientDescent(Settings);

impl Minimiser<2> for GradientDescent {
    fn minimise(
        &self,
        system: &mut System<2>,
        workspace: &mut Workspace<2>,
        balance: &Balance,
    ) -> Result<Solved, StepError> {
        let mut solved = Solved::default();
        let mut linear = Linear::default();
        evaluate(system, workspace, balance, false)?;
        let (mut energy, mut parts) = potential(system, workspace, balance, false).unwrap();
        while solved.iterations < 100_000 && !solved.converged {
            solved.iterations += 1;
            let mixture = mixture(system, &workspace.mass, balance, Definiteness::Clamped, &self.0);
            linear.assemble(&mixture);
            let step: Vec<f64> = (0..workspace.u.len())
                .map(|k| -workspace.residual[k] / (0.5 * linear.size_at(&mixture, k / 2)))
                .collect();
            let slope: f64 = step.iter().zip(&workspace.residual).map(|(s, r)| s * r).sum();
            solved.correction = step.iter().fold(0.0, |most: f64, s| s.abs().larger(most));
            solved.converged = solved.correction <= 1e-12 * workspace.extent;
            let mut length = 1.0;
            loop {
                for k in 0..workspace.u.len() {
                    workspace.trial[k] = workspace.u[k] + length * step[k];
                }
                evaluate(system, workspace, balance, true)?;
                let (after, size) = potential(system, workspace, balance, true).unwrap();
                if after <= energy + 1e-4 * length * slope + 1e-15 * parts {
                    (energy, parts) = (after, size);
                    break;
                }
                length *= 0.5;
                assert!(length > 1e-9, "no progress along {step:?}");
            }
            workspace.u.copy_from_slice(&workspace.trial);
        }
        evaluate(system, workspace, balance, false)?;
        Ok(solved)
    }
    fn same_bits_everywhere(&self, _system: &System<2>) -> bool {
        true
    }
}

/// Makes both minimisers find the stage from the same start, and uses the result of Newton's method.
#[derive(Debug)]
struct Both {
    newton: Newton,
    descent: GradientDescent,
    /// Φ at the common start, and at the ends of gradient descent and Newton's method [J].
    energies: RefCell<Vec<[f64; 3]>>,
}

impl Minimiser<2> for Both {
    fn minimise(
        &self,
        system: &mut System<2>,
        workspace: &mut Workspace<2>,
        balance: &Balance,
    ) -> Result<Solved, StepError> {
        let start = workspace.u.clone();
        evaluate(system, workspace, balance, false)?;
        let at = |system: &System<2>, workspace: &Workspace<2>| potential(system, workspace, balance, false).unwrap().0;
        let begun = at(system, workspace);
        assert!(self.descent.minimise(system, workspace, balance)?.converged);
        let descended = at(system, workspace);
        workspace.u.copy_from_slice(&start);
        let solved = self.newton.minimise(system, workspace, balance)?;
        self.energies.borrow_mut().push([begun, descended, at(system, workspace)]);
        Ok(solved)
    }
    fn same_bits_everywhere(&self, _system: &System<2>) -> bool {
        true
    }
}

/// A ring of eight nodes with springs along and across it. The ring is stretched and spins, and one node is pushed.
fn ring() -> System<2> {
    let (mut x, mut v) = (Columns::zeros(8), Columns::zeros(8));
    for node in 0..8 {
        let angle = core::f64::consts::TAU * node as f64 / 8.0;
        let at = [1.3 * libm::cos(angle), libm::sin(angle)];
        x.set(node, at);
        v.set(node, [-2.0 * at[1], 2.0 * at[0]]);
    }
    v.set(0, [-3.0, 1.0]);
    let mut system = System::new(Simd::best(), Layout::Single, 8, 1, x, v, Parameter::uniform(0.2));
    system.gravity = [0.0, -9.81];
    let pairs = (0..8).flat_map(|a| [[a, (a + 1) % 8], [a, (a + 2) % 8]]).collect();
    system.add(Box::new(Springs { pairs, stiffness: 300.0, damping: 0.0, rest_length: 0.9, gas: 0.0 }));
    system
}

fn check<R: Rule<2>>(spec: &'static Spec, rule: R) {
    let implicit = Implicit::new(spec.kind, rule, &Values::defaults(spec, 2)).unwrap();
    let (h, steps) = (0.02, 6);
    let (newton, descent) = (Newton(implicit.settings), GradientDescent(implicit.settings));
    let both = Both { newton, descent: GradientDescent(implicit.settings), energies: RefCell::default() };
    let [by_newton, by_descent] = [&both as &dyn Minimiser<2>, &descent].map(|minimiser| {
        let mut system = ring();
        system.equip(&implicit);
        for _ in 0..steps {
            implicit.step_by(minimiser, &mut system, h).unwrap();
        }
        state(&system)
    });
    let energies = both.energies.into_inner();
    assert_eq!(energies.len(), steps);
    for [begun, descended, found] in energies {
        assert!(begun - found > 1e-3, "{}: nothing to find: {begun} {found}", spec.kind);
        let apart = (descended - found).abs();
        assert!(apart <= 1e-8 * (begun - found), "{}: {descended} and {found} from {begun}", spec.kind);
    }
    // Whole steps agree too, including the memory of rules.
    let apart = distance(&by_newton, &by_descent) / distance(&by_newton, &vec![0.0; by_newton.len()]);
    assert!(apart <= 1e-8, "{}: {apart}", spec.kind);
}

#[test]
fn gradient_descent_finds_the_stage_of_backward_euler() {
    check(&backward_euler::SPEC, BackwardEuler);
}
#[test]
fn gradient_descent_finds_the_stage_of_bdf2() {
    check(&bdf2::SPEC, Bdf2::default());
}
#[test]
fn gradient_descent_finds_the_stage_of_the_implicit_midpoint_rule() {
    check(&implicit_midpoint::SPEC, ImplicitMidpoint(Theta::MIDDLE));
}
#[test]
fn gradient_descent_finds_the_stage_of_newmark() {
    check(&newmark::SPEC, Newmark::new(&Values::defaults(&newmark::SPEC, 2)));
}
