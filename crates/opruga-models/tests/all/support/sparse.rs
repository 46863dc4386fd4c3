//! Equilibria of bodies of some thousand nodes: sparse rows, conjugate gradients, Newton's method with step halving.

use opruga_core::potential::{Definiteness, Potential, Sink};
use opruga_core::system::{Stage, System};

/// A symmetric matrix as rows of (column, entry).
struct Rows(Vec<Vec<(u32, f64)>>);

impl<const D: usize> Sink<D> for Rows {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        for i in 0..D {
            let row = &mut self.0[a * D + i];
            for j in 0..D {
                let column = (b * D + j) as u32;
                match row.binary_search_by_key(&column, |entry| entry.0) {
                    Ok(at) => row[at].1 += value[i][j],
                    Err(at) => row.insert(at, (column, value[i][j])),
                }
            }
        }
    }
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; D])]) {
        unreachable!("elements have blocks alone")
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Rows {
    fn times(&self, v: &[f64], out: &mut [f64]) {
        for (row, out) in self.0.iter().zip(out) {
            *out = row.iter().map(|(column, entry)| entry * v[*column as usize]).sum();
        }
    }
    /// Conjugate gradients with a diagonal preconditioner; entries of pinned coordinates are zero. Stops early if the matrix is
    /// not positive.
    fn solve(&self, right: &[f64], held: &[bool]) -> Vec<f64> {
        let n = right.len();
        let inverse: Vec<f64> = (0..n)
            .map(|k| {
                let at = self.0[k].binary_search_by_key(&(k as u32), |entry| entry.0);
                if held[k] { 0.0 } else { 1.0 / at.map_or(1.0, |at| self.0[k][at].1) }
            })
            .collect();
        let (mut x, mut r) = (vec![0.0; n], right.to_vec());
        let mut z: Vec<f64> = r.iter().zip(&inverse).map(|(r, m)| r * m).collect();
        let mut p = z.clone();
        let mut product = vec![0.0; n];
        let mut rz = dot(&r, &z);
        let target = 1e-16 * rz;
        for _ in 0..20 * n {
            self.times(&p, &mut product);
            let curvature: f64 = (0..n).filter(|k| !held[*k]).map(|k| p[k] * product[k]).sum();
            if curvature <= 0.0 || rz <= target {
                break;
            }
            let alpha = rz / curvature;
            for k in 0..n {
                if !held[k] {
                    x[k] += alpha * p[k];
                    r[k] -= alpha * product[k];
                    z[k] = r[k] * inverse[k];
                }
            }
            let next = dot(&r, &z);
            for k in 0..n {
                p[k] = z[k] + next / rz * p[k];
            }
            rz = next;
        }
        x
    }
}

/// Finds the equilibrium under a dead load (node · D + axis) with some coordinates pinned; returns the last residual [N].
pub(crate) fn equilibrium<const D: usize>(system: &mut System<D>, load: &[f64], held: &[bool]) -> f64 {
    let free_force = |system: &mut System<D>| -> Vec<f64> {
        let mut all = crate::support::forces(system);
        for k in 0..all.len() {
            all[k] = if held[k] { 0.0 } else { all[k] + load[k] };
        }
        all
    };
    let potential_energy = |system: &mut System<D>| {
        let work: f64 = (0..system.nodes).map(|n| dot(&system.state.x.at(n), &load[n * D..n * D + D])).sum();
        crate::support::energy(system) - work
    };
    let mut residual = f64::INFINITY;
    for _ in 0..60 {
        let right = free_force(system);
        residual = dot(&right, &right).sqrt();
        if residual <= 1e-7 * dot(load, load).sqrt() {
            break;
        }
        let mut rows = Rows(vec![Vec::new(); right.len()]);
        let view = system.view(Stage::Current, system.time);
        for member in &system.members {
            let potential: &dyn Potential<D> = &*member.potential;
            potential.hessian(&view, &member.scratch, Definiteness::Clamped, &mut rows);
        }
        let step = rows.solve(&right, held);
        let start = system.state.x.clone();
        let before = potential_energy(system);
        let mut factor = 1.0;
        loop {
            for node in 0..system.nodes {
                let x = start.at(node);
                system.state.x.set(node, core::array::from_fn(|d| x[d] + factor * step[node * D + d]));
            }
            let slack = 1e-12 * (1.0 + before.abs());
            if potential_energy(system) <= before + slack || factor < 1e-6 {
                break;
            }
            factor *= 0.5;
        }
    }
    residual
}
