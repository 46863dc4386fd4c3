//! Free particles, or particles tied by springs, under symplectic Euler.
#![allow(dead_code, missing_docs, unreachable_pub)]

use core::ops::Range;
use opruga_collide::Colliders;
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::{Stage, State, System, Update};
use opruga_math::{Pack, Simd, WIDTH};

pub const G: f64 = 9.81;

/// The rule v₁ = v₀ + h a, x₁ = x₀ + h v₁.
pub struct Rule(pub f64);
impl<const D: usize> Update<D> for Rule {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.0
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let h = P::splat(self.0);
        for place in range.clone().step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(place);
            let (mut x, mut v) = (state.x.load::<P>(place), state.v.load::<P>(place));
            for d in 0..D {
                v[d] += P::load(&force[d][place - range.start..]) * kick;
                x[d] += v[d] * h;
            }
            state.x.store(place, x);
            state.v.store(place, v);
        }
    }
}

pub fn values<const D: usize>(kind: &str, fields: &[(&str, Value)]) -> Values {
    let spec = opruga_collide::all(D).into_iter().find(|s| s.kind == kind).expect(kind);
    let mut values = Values::defaults(spec, D);
    for (name, value) in fields {
        values.set(spec, name, value.clone(), D).expect(name);
    }
    assert!(values.missing(spec).is_empty());
    values
}
pub fn number(x: f64) -> Value {
    Value::Number(x)
}
pub fn vector(x: &[f64]) -> Value {
    Value::Numbers(x.to_vec())
}
pub fn rows(x: &[&[f64]]) -> Value {
    Value::Rows(x.iter().map(|r| r.to_vec()).collect())
}
pub fn colliders<const D: usize>(list: &[Values]) -> Colliders<D> {
    Colliders::build(list).unwrap()
}

/// Particles of one body.
pub fn particles<const D: usize>(x: &[[f64; D]], v: &[[f64; D]], mass: f64, list: &[Values]) -> System<D> {
    laid_out(Simd::best(), Layout::Single, x, v, mass, list)
}
/// Particles of one body, or the same eight times side by side.
pub fn laid_out<const D: usize>(
    simd: Simd,
    layout: Layout,
    x: &[[f64; D]],
    v: &[[f64; D]],
    mass: f64,
    list: &[Values],
) -> System<D> {
    let places = layout.index_count(x.len());
    let (mut cx, mut cv) = (Columns::zeros(places), Columns::zeros(places));
    for node in 0..x.len() {
        for body in 0..layout.stride() {
            cx.set(layout.index(node, body), x[node]);
            cv.set(layout.index(node, body), v[node]);
        }
    }
    let mut system = System::new(simd, layout, x.len(), layout.stride(), cx, cv, Parameter::uniform(mass));
    system.contacts = Some(std::sync::Arc::new(colliders::<D>(list)));
    system.plan(0);
    system
}
pub fn step<const D: usize>(system: &mut System<D>, h: f64) {
    system.advance(Stage::Current, 0.0, h, Some(h), &Rule(h)).unwrap();
    system.finish_step(h);
}
pub fn run<const D: usize>(system: &mut System<D>, h: f64, steps: usize) {
    for _ in 0..steps {
        step(system, h);
    }
}
pub fn at<const D: usize>(system: &System<D>, node: usize) -> ([f64; D], [f64; D]) {
    (system.state.x.at(node), system.state.v.at(node))
}
pub fn sum(work: &[f64; WIDTH]) -> f64 {
    work.iter().sum()
}
pub fn kinetic<const D: usize>(system: &System<D>) -> f64 {
    let mut sum = 0.0;
    for place in 0..system.nodes {
        for d in 0..D {
            sum += 0.5 * system.mass.at(place) * system.state.v.0[d][place] * system.state.v.0[d][place];
        }
    }
    sum
}
pub fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
