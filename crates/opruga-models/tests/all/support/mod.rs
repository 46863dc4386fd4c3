//! Common code of the tests of the models: parameters, meshes, energies and dense matrices, Newton's method.
#![allow(dead_code)] // each test uses some of it

pub(crate) mod models;

use opruga_core::potential::{Definiteness, Ingredients, Model, Potential, Sink};
use opruga_core::spec::{Spec, Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::{Stage, System};
use opruga_math::{Simd, sum_in_fixed_order};
use opruga_mesh::Mesh;

/// Types from which a parameter can be made.
pub(crate) trait IntoValue {
    /// Converts it to a value.
    fn value(self) -> Value;
}
impl IntoValue for f64 {
    fn value(self) -> Value {
        Value::Number(self)
    }
}
impl IntoValue for bool {
    fn value(self) -> Value {
        Value::Boolean(self)
    }
}
impl IntoValue for &str {
    fn value(self) -> Value {
        Value::Text(self.into())
    }
}
impl<const N: usize, const ROWS: usize> IntoValue for &[[f64; N]; ROWS] {
    fn value(self) -> Value {
        Value::Rows(self.iter().map(|r| r.to_vec()).collect())
    }
}

/// The defaults of a model with some parameters set.
pub(crate) fn values(spec: &'static Spec, set: Vec<(&str, Value)>) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in set {
        values.set(spec, name, value, 2).unwrap();
    }
    values
}

/// `values!(mass_spring, stiffness: 3.0, edges: "all")`.
#[macro_export]
macro_rules! values {
    ($model:ident $(, $name:ident : $value:expr)*) => {
        $crate::support::values(&opruga_models::$model::SPEC, vec![$((stringify!($name), $crate::support::IntoValue::value($value))),*])
    };
}

/// A model and its parameters.
pub(crate) type Part<'a, const D: usize> = (&'a dyn Model<D>, Values);

/// A system of one body with some models, at rest in its rest shape, with a mass of 1 kg at every node.
pub(crate) fn system<const D: usize>(mesh: &Mesh<D>, parts: &[Part<D>]) -> System<D> {
    system_with_mass(mesh, parts, 1.0)
}

/// The same system with a given mass of every node [kg].
pub(crate) fn system_with_mass<const D: usize>(mesh: &Mesh<D>, parts: &[Part<D>], mass: f64) -> System<D> {
    let nodes = mesh.positions.len();
    let places = Layout::Single.index_count(nodes);
    let mut x = Columns::zeros(places);
    for p in 0..places {
        x.set(p, mesh.positions[p.min(nodes - 1)]);
    }
    let mass = Parameter::uniform(mass);
    let mut system = System::new(Simd::best(), Layout::Single, nodes, 1, x, Columns::zeros(places), mass.clone());
    for (model, values) in parts {
        let ingredients = Ingredients {
            mesh,
            layout: Layout::Single,
            values: &[values],
            mass: &mass,
            densities: None,
            thickness: 1.0,
            gravity: [0.0; D],
            step: 1e-3,
            break_off: &Default::default(),
        };
        system.add(model.build(&ingredients).unwrap());
    }
    system.plan(0);
    system
}

/// The code and message with which a model refuses a body.
pub(crate) fn refusal<const D: usize>(mesh: &Mesh<D>, model: &dyn Model<D>, values: Values) -> String {
    let mass = Parameter::uniform(1.0);
    let ingredients = Ingredients {
        mesh,
        layout: Layout::Single,
        values: &[&values],
        mass: &mass,
        densities: None,
        thickness: 1.0,
        gravity: [0.0; D],
        step: 1e-3,
        break_off: &Default::default(),
    };
    match model.build(&ingredients) {
        Ok(_) => "built".into(),
        Err(error) => format!("{} {error}", error.code()),
    }
}

/// The energy of all models [J].
pub(crate) fn energy<const D: usize>(system: &mut System<D>) -> f64 {
    // Computing the forces prepares all models.
    system.forces(true).unwrap();
    let view = system.view(Stage::Current, system.time);
    system.members.iter().map(|m| sum_in_fixed_order(&m.potential.energy(system.simd, &view, &m.scratch))).sum()
}

/// Forces at rest [N], node after node.
pub(crate) fn forces<const D: usize>(system: &mut System<D>) -> Vec<f64> {
    let forces = system.forces(false).unwrap();
    (0..system.nodes).flat_map(|n| forces.at(n)).collect()
}

/// A symmetric matrix, row after row.
#[derive(Clone, Debug)]
pub(crate) struct Dense {
    pub(crate) size: usize,
    pub(crate) entries: Vec<f64>,
}

impl Dense {
    pub(crate) fn times(&self, v: &[f64]) -> Vec<f64> {
        self.entries.chunks(self.size).map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
    }
    /// Solves by Gaussian elimination with row exchanges.
    pub(crate) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let n = self.size;
        let mut rows: Vec<Vec<f64>> = self.entries.chunks(n).map(|row| row.to_vec()).collect();
        let mut x = right.to_vec();
        for k in 0..n {
            let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())).unwrap();
            rows.swap(k, pivot);
            x.swap(k, pivot);
            for i in k + 1..n {
                let factor = rows[i][k] / rows[k][k];
                if factor != 0.0 {
                    let (above, below) = rows.split_at_mut(i);
                    for j in k..n {
                        below[0][j] -= factor * above[k][j];
                    }
                    x[i] -= factor * x[k];
                }
            }
        }
        for k in (0..n).rev() {
            for j in k + 1..n {
                x[k] -= rows[k][j] * x[j];
            }
            x[k] /= rows[k][k];
        }
        x
    }
    /// The number of eigenvalues below a value, as the number of negative pivots of the shifted matrix (Sylvester), in the order
    /// of the rows.
    pub(crate) fn eigenvalues_below(&self, shift: f64) -> usize {
        let n = self.size;
        let mut rows: Vec<Vec<f64>> = self.entries.chunks(n).map(|row| row.to_vec()).collect();
        for (k, row) in rows.iter_mut().enumerate() {
            row[k] -= shift;
        }
        let mut negative = 0;
        for k in 0..n {
            negative += usize::from(rows[k][k] < 0.0);
            for i in k + 1..n {
                let factor = rows[i][k] / rows[k][k];
                let (above, below) = rows.split_at_mut(i);
                for j in k..n {
                    below[0][j] -= factor * above[k][j];
                }
            }
        }
        negative
    }
}

struct DenseSink(Dense);

impl<const D: usize> Sink<D> for DenseSink {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                self.0.entries[(a * D + i) * self.0.size + b * D + j] += value[i][j];
            }
        }
    }
    fn low_rank(&mut self, c: f64, u: &[(usize, [f64; D])]) {
        for (a, ua) in u {
            for (b, ub) in u {
                Sink::<D>::block(self, *a, *b, core::array::from_fn(|i| core::array::from_fn(|j| c * ua[i] * ub[j])));
            }
        }
    }
}

/// The Hessian of all models in the present state [N/m].
pub(crate) fn hessian<const D: usize>(system: &mut System<D>) -> Dense {
    system.forces(false).unwrap();
    let size = system.nodes * D;
    let mut sink = DenseSink(Dense { size, entries: vec![0.0; size * size] });
    let view = system.view(Stage::Current, system.time);
    for member in &system.members {
        let potential: &dyn Potential<D> = &*member.potential;
        potential.hessian(&view, &member.scratch, Definiteness::Exact, &mut sink);
    }
    sink.0
}

/// The number of eigenvalues of the Hessian below a value [N/m].
pub(crate) fn eigenvalues_below<const D: usize>(system: &mut System<D>, shift: f64) -> usize {
    hessian(system).eigenvalues_below(shift)
}

/// Newton's method for forces + load = 0 with some coordinates (node · D + axis) pinned; returns the last residual [N].
///
/// `shift` [N/m] is added to the diagonal if rigid motion is free; it does not change the solution.
pub(crate) fn newton<const D: usize>(system: &mut System<D>, load: &[f64], held: &[usize], shift: f64) -> f64 {
    let mut residual = f64::INFINITY;
    for _ in 0..60 {
        let mut right = forces(system);
        for (r, l) in right.iter_mut().zip(load) {
            *r += l;
        }
        held.iter().for_each(|k| right[*k] = 0.0);
        residual = right.iter().fold(0.0, |m, r| if r.abs() > m { r.abs() } else { m });
        let mut matrix = hessian(system);
        let n = matrix.size;
        for k in 0..n {
            matrix.entries[k * n + k] += shift;
        }
        for &k in held {
            for j in 0..n {
                matrix.entries[k * n + j] = 0.0;
                matrix.entries[j * n + k] = 0.0;
            }
            matrix.entries[k * n + k] = 1.0;
        }
        let step = matrix.solve(&right);
        for node in 0..system.nodes {
            let x = system.state.x.at(node);
            system.state.x.set(node, core::array::from_fn(|d| x[d] + step[node * D + d]));
        }
        if step.iter().all(|s| s.abs() < 1e-15) {
            break;
        }
    }
    residual
}
