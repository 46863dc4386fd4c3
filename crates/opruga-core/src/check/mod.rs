//! The conformance suite: what every model must obey, checked on random states from a fixed seed.
//!
//! One line in a test adds a model:
//!
//! ```ignore
//! conformance("springs", &MassSpring, &[values], &mesh, &Options::default()).assert();
//! ```
//!
//! | row | what is compared |
//! |---|---|
//! | gradient | force at rest with central differences of the energy (fourth order) |
//! | hessian | second derivatives with central differences of the force; symmetric if the model declares it |
//! | product | `add_hessian_product` with the assembled matrix, and eight bodies in one batch with a single body |
//! | clamped | the clamped Hessian has no negative eigenvalue, if it is symmetric |
//! | views | energy and second derivatives exist if the model declares them for all its potentials |
//! | tiles | forces in tiles of any size with forces in one tile, to the bit; also if they begin with the weight |
//! | lanes | all sets of vector instructions of this processor, to the bit |
//! | batch | forces and energy of eight bodies side by side with those of each body alone, to the bit |
//! | translation, rotation | U(Qx + t) = U(x), F(Qx + t, Qv) = Q F(x, v) |
//! | net force, net torque | Σ F = 0, Σ x × F = 0, damping included |
//! | infinitesimal rotation | H Ωx = Ω ∇U for skew Ω, also under load |
//! | rigid motion | no damping force if v = v₀ + ω × x |
//! | damping matrix | −∂F/∂v with central differences of the force in the velocities |
//! | power | the power of damping that the model reports is −F·v of the damping force, and not negative |
//! | coincident | all nodes at one point: energy and force are finite |
//!
//! Rows for properties that a model does not claim ([`Potential::views`], [`Options::rigid`]) are omitted.

mod bits;
mod case;
mod derivatives;
mod dissipation;
mod invariance;
mod random;

use crate::potential::{Ingredients, Model, Potential, Views};
use crate::spec::Values;
use crate::state::{Layout, Parameter};
use case::{Answer, Body, Case};
use core::fmt;
use opruga_math::{Lane, Simd, WIDTH, sum_in_fixed_order};
use opruga_mesh::Mesh;
pub use random::Random;

/// The states in which a model is checked, and the properties that it claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Seed of the random states.
    pub seed: u64,
    /// The number of states.
    pub states: usize,
    /// The random displacement of each coordinate, in mean edge lengths of the mesh.
    pub noise: f64,
    /// The factor by which the rest shape is scaled before the random displacement.
    pub stretch: f64,
    /// Whether the first axis is mirrored, which inverts the body.
    pub mirrored: bool,
    /// Whether the model claims the rows on rigid motion, net force and net torque.
    pub rigid: bool,
    /// Whether the model has the properties that [`Model::views`] claims, also with the parameters of this check.
    pub views: bool,
    /// Whether the model claims a finite force if all nodes coincide.
    pub coincident: bool,
    /// Whether finite differences are computed. Each coordinate needs some of them, so this check is not meant for meshes of more than a few hundred
    /// nodes.
    pub derivatives: bool,
    /// The time of the state [s].
    pub time: f64,
    /// The depth out of the plane, or the thickness of a sheet [m].
    pub thickness: f64,
    /// The allowed error of the gradient, relative to the largest force.
    pub gradient_tolerance: f64,
    /// The allowed error of the Hessian, relative to its largest entry.
    pub hessian_tolerance: f64,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            seed: 1,
            states: 3,
            noise: 0.15,
            stretch: 1.0,
            mirrored: false,
            rigid: true,
            views: true,
            coincident: true,
            derivatives: true,
            time: 0.37,
            thickness: 0.8,
            gradient_tolerance: 1e-8,
            hessian_tolerance: 1e-7,
        }
    }
}

/// One comparison of the suite, with its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What was compared.
    pub quantity: &'static str,
    /// The number of the state.
    pub state: usize,
    /// The largest error; relative, unless it is a count of unequal bits.
    pub error: f64,
    /// The allowed error.
    pub tolerance: f64,
}

impl Row {
    /// Whether the error is allowed; NaN is not.
    pub fn passes(&self) -> bool {
        self.error <= self.tolerance
    }
}

/// All comparisons of one model on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The name that the caller of the suite gave.
    pub name: String,
    /// The dimension of the mesh.
    pub dimension: usize,
    /// The comparisons.
    pub rows: Vec<Row>,
    /// The reason if no state could be checked.
    pub refused: Option<String>,
}

impl Report {
    /// Whether everything was checked and every row passes.
    pub fn passes(&self) -> bool {
        self.refused.is_none() && self.rows.iter().all(Row::passes)
    }
    /// The largest error of a quantity; `None` if it was not compared.
    pub fn worst(&self, quantity: &str) -> Option<f64> {
        self.rows.iter().filter(|r| r.quantity == quantity).map(|r| r.error).reduce(Lane::larger)
    }
    /// Fails a test with a table of all rows, unless everything passes.
    ///
    /// # Panics
    /// If a row does not pass.
    #[track_caller]
    pub fn assert(&self) {
        assert!(self.passes(), "{self}");
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} in {}D", self.name, self.dimension)?;
        if let Some(reason) = &self.refused {
            writeln!(f, "  refused: {reason}")?;
        }
        for row in &self.rows {
            let mark = if row.passes() { "      " } else { "FAILS " };
            let Row { quantity, state, error, tolerance } = row;
            writeln!(f, "  {mark}{quantity:<24} state {state}  {error:>10.2e}  allowed {tolerance:.0e}")?;
        }
        Ok(())
    }
}

/// Checks a model on a mesh, with the parameters of one body or of several (used in turn for eight bodies).
pub fn conformance<const D: usize>(
    name: &str,
    model: &dyn Model<D>,
    values: &[Values],
    mesh: &Mesh<D>,
    options: &Options,
) -> Report {
    let mut report = Report { name: name.into(), dimension: D, rows: Vec::new(), refused: None };
    let mut random = Random::new(options.seed);
    for state in 0..options.states {
        let bodies: Vec<Body<D>> = (0..WIDTH).map(|_| Body::new(mesh, options, &mut random)).collect();
        let suite = Suite { model, values, mesh, options, bodies };
        if let Err(reason) = suite.run(state, &mut random, &mut report.rows) {
            report.refused = Some(reason);
            return report;
        }
    }
    report
}

struct Suite<'a, const D: usize> {
    model: &'a dyn Model<D>,
    values: &'a [Values],
    mesh: &'a Mesh<D>,
    options: &'a Options,
    bodies: Vec<Body<D>>,
}

impl<const D: usize> Suite<'_, D> {
    /// Builds the model of one of the bodies, or of all eight.
    fn build(&self, body: Option<usize>) -> Answer<Box<dyn Potential<D>>> {
        let nodes = self.mesh.positions.len();
        let values: Vec<&Values> = match body {
            Some(l) => vec![&self.values[l % self.values.len()]],
            None => (0..WIDTH).map(|l| &self.values[l % self.values.len()]).collect(),
        };
        let layout = if body.is_some() { Layout::Single } else { Layout::Batch };
        let mass = Parameter::from_items(layout, nodes, |node, l| self.bodies[body.unwrap_or(l)].mass[node]);
        let ingredients = Ingredients {
            mesh: self.mesh,
            layout,
            values: &values,
            mass: &mass,
            densities: None,
            thickness: self.options.thickness,
            gravity: [0.0; D],
            step: 1e-3,
            break_off: &Default::default(),
        };
        self.model.build(&ingredients).map_err(|e| e.to_string())
    }

    fn run(&self, state: usize, random: &mut Random, rows: &mut Vec<Row>) -> Answer<()> {
        if self.values.is_empty() {
            return Err("no parameters were given".into());
        }
        let mut add = |quantity, error, tolerance| rows.push(Row { quantity, state, error, tolerance });
        let potential = self.build(Some(0))?;
        let views = potential.properties().views;
        let claimed = self.model.views();
        let kept = !self.options.views || views.include(Views { damping: false, ..claimed });
        add("views", if kept { 0.0 } else { 1.0 }, 0.0);
        self.same_bits(random, &*potential, &mut add)?;
        if views.energy && self.options.derivatives {
            self.gradient(&*potential, &mut add)?;
        }
        if views.hessian && self.options.derivatives {
            self.hessian(random, &*potential, &mut add)?;
        }
        if self.options.rigid {
            self.invariance(random, &*potential, views, &mut add)?;
        }
        if views.damping && potential.properties().account == crate::potential::Account::Elastic {
            self.dissipation(random, &*potential, &mut add)?;
        }
        if views.damping && views.hessian && self.options.derivatives {
            self.damping_matrix(&*potential, &mut add)?;
        }
        if self.options.coincident {
            let mut body = self.bodies[0].clone();
            let point = body.x[0];
            body.x.iter_mut().for_each(|x| *x = point);
            let mut case = self.case(&*potential, &body);
            let (force, power) = case.plain(Simd::best())?;
            let energy = sum_in_fixed_order(&case.energy(Simd::best())?);
            let finite = force.iter().flatten().chain([&power, &energy]).all(|c| c.is_finite());
            add("coincident", if finite { 0.0 } else { f64::NAN }, 0.0);
        }
        Ok(())
    }

    fn case<'a>(&self, potential: &'a dyn Potential<D>, body: &Body<D>) -> Case<'a, D> {
        Case::new(potential, Layout::Single, &[body], self.options.time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_number_fails() {
        let row = |error| Row { quantity: "gradient", state: 0, error, tolerance: 1e-8 };
        assert!(row(1e-9).passes() && !row(1e-7).passes() && !row(f64::NAN).passes());
    }
}
