//! The largest stable step, from the spectra of stiffness and damping and from the integrator.
//!
//! Near any state a system moves according to M x″ = −K x − C x′. Its fastest oscillation is ω = √λ(M⁻¹K) and its strongest damping is c = λ(M⁻¹C),
//! where λ is the largest eigenvalue. Both values are found before a run from the forces themselves:
//!
//! K d ≈ (F(x − εd) − F(x + εd)) / 2ε,  C d = F(x, 0) − F(x, d),
//!
//! so every model takes part, including the gas as a whole and models without a Hessian, and the same fast code runs as in a
//! step. Obstacles contribute nothing: explicit integrators treat them by impulses, which have no stiffness.
//!
//! **Which eigenvalue.** The products drive a Lanczos recurrence on the symmetric M^-½ K M^-½. The recurrence computes the same products as a power
//! iteration from the same start vector, but uses the best combination of these products. On a long chain of springs, whose spectrum is dense at its
//! upper end, a power iteration still has an error of 2 % after 30 products. The estimate is the largest Ritz value plus its residual, and the
//! resulting step is reduced by 2 %. Negative eigenvalues, which a body has when it is about to buckle, do not affect the step.
//!
//! **Which modes.** A mode M μ² q + C μ q + K q = 0 with q*Mq = 1 satisfies μ² + c μ + ω² = 0 with c = q*Cq and ω² = q*Kq. Therefore, the pairs (ω²,
//! c) of all modes are in the joint numerical range of K and C, whether or not K and C have the same eigenvectors. A polygon encloses this range. The
//! polygon follows from the spectra of K, of C and of C − γK with γ = c_max/ω²_max:
//!
//! ```text
//!     c │     ______________         0 ≤ ω² ≤ ω²_max,  c_min ≤ c ≤ c_max,
//!       │    /           / |
//!       │   /           /  |         offset₀ ≤ c − γω² ≤ offset₁
//!       │  /           /   |
//!       │ /___________/____|         (C ∝ K: a line from corner to corner;
//!       └────────────────── ω²        damping of every node alike: a line at one height)
//! ```
//!
//! A step that is stable in the whole polygon is stable for every mode. The price is that an integrator that is unstable
//! without damping has a stable step only if *all* motions are damped (`least_damping > 0`).

mod lanczos;

use crate::error::StepError;
use crate::integrator::Integrator;
use crate::state::{Columns, Layout, View};
use crate::system::System;
use crate::tile::Tile;
use lanczos::{extremes, largest};
use opruga_math::{Column, Lane, WIDTH, messages};

messages! {
    /// Why no stable step can be given.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Unstable {
        "step.not_finite" #[error("the forces near the present state are not finite, so no stable step can be computed")]
        Forces {},
    }
}

/// Limits are reduced by this factor, to allow for small changes of the state.
const SAFETY: f64 = 0.98;

/// Displacements for the differences of forces, as a fraction of the extent of the system.
const DISPLACEMENT: f64 = 1e-7;

/// If damping differs from stiffness-proportional damping by less than this fraction of the strongest damping, it counts as
/// proportional.
const PROPORTIONAL: f64 = 1e-7;

/// An integrator that is stable up to this angle ωh per step counts as one without a limit. Many implicit integrators have
/// none.
const LARGEST_PHASE: f64 = 1e6;

/// The ranges of the frequencies and damping of all modes of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// The fastest oscillation, √ of the largest eigenvalue of M⁻¹K [rad/s].
    pub omega: f64,
    /// The strongest damping, the largest eigenvalue of M⁻¹C [1/s].
    pub damping: f64,
    /// The weakest damping of any motion, the smallest eigenvalue of M⁻¹C [1/s].
    pub least_damping: f64,
    /// The smallest and the largest eigenvalue of M⁻¹(C − γK), γ = damping/omega² [1/s].
    pub offset: [f64; 2],
}

/// The spectra of a system, and the resulting limit of the step of an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// The spectra, each widened by its residual so that the step is safe. A smallest damping below 1 % of the strongest is replaced by the damping
    /// due to the drag on every node, which is known.
    pub spectrum: Spectrum,
    /// The largest step for which no mode grows, reduced by 2 % [s]. It is infinite for a free body and for integrators without a limit, and `None`
    /// if a mode grows at every step.
    pub largest_stable_step: Option<f64>,
}

/// Estimates the spectra of a system in its present state, and the largest stable step of an integrator.
///
/// The estimate takes about 30 evaluations of all forces, or 100 with damping; the system does not change. Pinned nodes and axes do not count.
///
/// # Errors
/// [`StepError`] if a model refuses the state or its forces are not finite.
pub fn estimate<const D: usize>(system: &System<D>, integrator: &dyn Integrator<D>) -> Result<Stability, StepError> {
    let spectrum = Spectrum::of(system)?;
    Ok(Stability { spectrum, largest_stable_step: spectrum.largest_stable_step(integrator).map(|h| SAFETY * h) })
}

impl Spectrum {
    /// All modes with frequencies up to ω [rad/s], with equal damping [1/s].
    pub fn uniform(omega: f64, damping: f64) -> Spectrum {
        let low = if omega > 0.0 { 0.0 } else { damping };
        Spectrum { omega, damping, least_damping: damping, offset: [low, damping] }
    }

    /// Estimates the spectra of a system in its present state.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state or its forces are not finite.
    pub fn of<const D: usize>(system: &System<D>) -> Result<Spectrum, StepError> {
        let mut probe = Probe::new(system);
        let weights = probe.weights.clone();
        let [_, stiffness] = extremes(&weights, false, 0.0, |d, out| probe.add_stiffness(1.0, d, out))?;
        let omega = stiffness.larger(0.0).sqrt();
        if !system.members.iter().any(|m| m.potential.properties().views.damping) {
            return Ok(Spectrum::uniform(omega, 0.0));
        }
        probe.start_damping()?;
        let [weakest, strongest] = extremes(&weights, true, 0.0, |d, out| probe.add_damping(d, out))?;
        let damping = strongest.larger(0.0);
        // A drag that is weak compared with strong springs is lost in the residual of the recurrence, but the damping that every
        // node has is known.
        let uniform: f64 = system.members.iter().map(|m| m.potential.properties().uniform_damping).sum();
        let found = if weakest > 0.01 * damping { weakest } else { 0.0 };
        let least_damping = found.larger(uniform).smaller(damping);
        if omega == 0.0 || damping == 0.0 {
            return Ok(Spectrum { least_damping, ..Spectrum::uniform(omega, damping) });
        }
        let gamma = damping / (omega * omega);
        let offset = extremes(&weights, true, damping, |d, out| {
            probe.add_damping(d, out)?;
            probe.add_stiffness(-gamma, d, out)
        })?;
        // For stiffness-proportional damping, such a small offset is only the rounding error of differences.
        let offset = offset.map(|end| if end.abs() <= PROPORTIONAL * damping { 0.0 } else { end });
        Ok(Spectrum { omega, damping, least_damping, offset })
    }

    /// The largest step of an integrator that is stable for all modes [s].
    ///
    /// Infinite if nothing oscillates and nothing is damped, or if the integrator has no limit; `None` if a mode grows at every
    /// step.
    pub fn largest_stable_step<const D: usize>(&self, integrator: &dyn Integrator<D>) -> Option<f64> {
        let fastest = self.omega.larger(self.damping);
        if fastest == 0.0 {
            return Some(f64::INFINITY);
        }
        let modes = self.corners();
        let stable = |h: f64| worst(integrator, &modes, h) <= 1.0 + 1e-9;
        // Find a stable step `low` below an unstable step `high`.
        let mut low = 1.0 / fastest;
        let mut high = 2.0 * low;
        if stable(low) {
            while stable(high) {
                low = high;
                high *= 2.0;
                if high * fastest > LARGEST_PHASE {
                    return Some(f64::INFINITY);
                }
            }
        } else {
            while !stable(low) {
                high = low;
                low *= 0.5;
                if low * fastest < 1e-9 {
                    return None;
                }
            }
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        // The search for the limit tolerates a little growth. An integrator that is stable shows no growth at half the step.
        (worst(integrator, &modes, 0.5 * low) <= 1.0 + SLOWEST).then_some(low)
    }

    /// The growth rate of the amplitude of the worst mode in steps of h [1/s]: ln ρ / h; zero if h is stable.
    pub fn growth_per_second<const D: usize>(&self, integrator: &dyn Integrator<D>, h: f64) -> f64 {
        let radius = worst(integrator, &self.corners(), h);
        if radius <= 1.0 + ROUNDING { 0.0 } else { Lane::ln(radius) / h }
    }

    /// Pairs (ω, c) on the boundary of the polygon: the weakest and the strongest damping within it at many frequencies.
    fn corners(&self) -> Vec<(f64, f64)> {
        const POINTS: usize = 24;
        let most = self.omega * self.omega;
        let mut squares: Vec<f64> = (0..=POINTS).map(|k| (k * k) as f64 / (POINTS * POINTS) as f64 * most).collect();
        let gamma = if most > 0.0 { self.damping / most } else { 0.0 };
        if gamma > 0.0 {
            // The intersections of the slanted edges with the horizontal ones.
            for offset in self.offset {
                squares.extend([(self.damping - offset) / gamma, (self.least_damping - offset) / gamma]);
            }
        }
        let mut out = Vec::with_capacity(2 * squares.len());
        for square in squares {
            // Because of rounding, a corner may be beyond the edges that meet there.
            if !(-1e-9 * most..=(1.0 + 1e-9) * most).contains(&square) {
                continue;
            }
            let square = square.larger(0.0).smaller(most);
            let within = |offset: f64| (gamma * square + offset).larger(self.least_damping).smaller(self.damping);
            let [least, greatest] = self.offset.map(within);
            if least <= greatest {
                out.extend([(square.sqrt(), least), (square.sqrt(), greatest)]);
            }
        }
        out
    }
}

/// The growth per step above which half a step counts as unstable. Growth of 1e-9, the tolerance at the full step, still
/// exceeds this at half the step if it falls with the sixth power of the step. Rounding in the amplification matrices of
/// integrators that carry many values is smaller than this.
const SLOWEST: f64 = 1e-12;

/// The amount by which rounding may raise the spectral radius of a stable step above 1.
const ROUNDING: f64 = 4e-15;

/// The largest spectral radius of an integrator over some points (ω, c); NaN counts as infinite.
fn worst<const D: usize>(integrator: &dyn Integrator<D>, points: &[(f64, f64)], h: f64) -> f64 {
    let mut worst = 0.0;
    for &(omega, c) in points {
        let radius = integrator.amplification(omega, c, h).spectral_radius();
        worst = if radius.is_finite() { radius.larger(worst) } else { f64::INFINITY };
    }
    worst
}

/// Evaluates the forces of a system in states near its present one.
struct Probe<'a, const D: usize> {
    system: &'a System<D>,
    /// M^-½ for every coordinate that can move, otherwise zero.
    weights: Columns<D>,
    /// The state to evaluate.
    x: Columns<D>,
    v: Columns<D>,
    /// The results of `prepare` in that state.
    scratch: Vec<Column>,
    slots: Column,
    force: Columns<D>,
    /// Forces of damped models at rest.
    at_rest: Columns<D>,
    /// The length of displacements [m].
    small: f64,
}

impl<'a, const D: usize> Probe<'a, D> {
    fn new(system: &'a System<D>) -> Self {
        let index_count = system.index_count();
        let mut weights = Columns::zeros(index_count);
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for node in 0..system.nodes {
            for body in 0..if system.layout == Layout::Batch { system.bodies } else { 1 } {
                let index = system.layout.index(node, body);
                let inverse = system.inverse_mass.at(index);
                weights.set(index, [if inverse > 0.0 { inverse.sqrt() } else { 0.0 }; D]);
                let x = system.state.x.at(index);
                for d in 0..D {
                    low[d] = low[d].smaller(x[d]);
                    high[d] = high[d].larger(x[d]);
                }
            }
        }
        for pin in &system.pins {
            for d in 0..D {
                if pin.axes[d] {
                    weights.0[d][pin.index] = 0.0;
                }
            }
        }
        let mut extent = 0.0;
        for d in 0..D {
            extent = (high[d] - low[d]).larger(extent);
        }
        Probe {
            x: system.state.x.clone(),
            v: Columns::zeros(index_count),
            scratch: system.members.iter().map(|m| Column::zeros(m.potential.properties().scratch_len)).collect(),
            slots: Column::default(),
            force: Columns::zeros(index_count),
            at_rest: Columns::zeros(index_count),
            small: DISPLACEMENT * if extent > 0.0 && extent.is_finite() { extent } else { 1.0 },
            weights,
            system,
        }
    }

    /// Computes the forces of all models, or of the damped ones, in the state to evaluate.
    fn evaluate(&mut self, damped_only: bool) -> Result<(), StepError> {
        let system = self.system;
        let index_count = system.index_count();
        let view = View {
            x: self.x.slices(),
            v: self.v.slices(),
            nodes: system.nodes,
            layout: system.layout,
            time: system.time,
            threads: system.threads,
        };
        for column in &mut self.force.0 {
            column.fill(0.0);
        }
        let mut power = [0.0; WIDTH];
        for (member, scratch) in system.members.iter().zip(&mut self.scratch) {
            if damped_only && !member.potential.properties().views.damping {
                continue;
            }
            member.potential.prepare(system.simd, &view, &member.memory, scratch)?;
            let force = self.force.0.each_mut().map(|f| &mut **f);
            let mut tile =
                Tile { range: 0..index_count, force, power: &mut power, weight: None, slots: &mut self.slots };
            member.potential.add_force(system.simd, &view, scratch, &mut tile);
        }
        Ok(())
    }

    /// Adds factor · K d, from central differences of forces without velocities.
    fn add_stiffness(&mut self, factor: f64, d: &Columns<D>, out: &mut Columns<D>) -> Result<(), StepError> {
        let step = self.small / largest(d);
        for column in &mut self.v.0 {
            column.fill(0.0);
        }
        for sign in [-1.0, 1.0] {
            let along = sign * step;
            for i in 0..D {
                for ((x, start), d) in self.x.0[i].iter_mut().zip(&self.system.state.x.0[i]).zip(&d.0[i]) {
                    *x = start + along * d;
                }
            }
            self.evaluate(false)?;
            let weight = -sign * factor / (2.0 * step);
            for i in 0..D {
                for (out, force) in out.0[i].iter_mut().zip(&self.force.0[i]) {
                    *out += weight * force;
                }
            }
        }
        Ok(())
    }

    /// Stores the forces of damped models without velocities.
    fn start_damping(&mut self) -> Result<(), StepError> {
        self.x = self.system.state.x.clone();
        self.v = Columns::zeros(self.system.index_count());
        self.evaluate(true)?;
        self.at_rest = self.force.clone();
        Ok(())
    }

    /// Adds C d. Because damping is linear in the velocity, C d follows from the difference due to a velocity along d of at most 1 m/s.
    fn add_damping(&mut self, d: &Columns<D>, out: &mut Columns<D>) -> Result<(), StepError> {
        let step = 1.0 / largest(d);
        self.x.clone_from(&self.system.state.x);
        for i in 0..D {
            for (v, d) in self.v.0[i].iter_mut().zip(&d.0[i]) {
                *v = step * d;
            }
        }
        self.evaluate(true)?;
        let weight = 1.0 / step;
        for i in 0..D {
            for ((out, rest), force) in out.0[i].iter_mut().zip(&self.at_rest.0[i]).zip(&self.force.0[i]) {
                *out += weight * (rest - force);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
