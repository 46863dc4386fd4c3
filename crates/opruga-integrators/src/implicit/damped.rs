//! Directions that know how damping forces change with position.
//!
//! The matrix σM + βC + K leaves ∂(C v)/∂x out, which is not symmetric. Where a damped body is deformed much within a step,
//! the iteration with it converges slowly or not at all. Then the whole derivative of the balance is used, by differences
//! along the directions of a Krylov space; the symmetric matrix is its preconditioner, so few directions do.
//!
//! Source: Saad, *A flexible inner–outer preconditioned GMRES algorithm*, 1993; Knoll and Keyes 2004.

use super::linear::Filter;
use super::newton::{Balance, Keep, evaluate, mixture};
use super::room::Room;
use super::settings::Settings;
use opruga_core::error::StepError;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::dot;

/// Directions of the space at most.
const DIRECTIONS: usize = 12;

/// The part of what is out of balance that may be left by them.
const ENOUGH: f64 = 1e-2;

/// The length of a difference, in extents of the body.
const DIFFERENCE: f64 = 1e-7;

/// Halvings of a step at most.
const MOST_HALVINGS: usize = 8;

/// Room for the vectors.
#[derive(Debug, Default)]
pub(crate) struct Krylov {
    /// An orthonormal basis, and what the preconditioner makes of it.
    basis: Vec<Vec<f64>>,
    improved: Vec<Vec<f64>>,
    /// What is out of balance in the state where the directions begin.
    residual: Vec<f64>,
}

impl Krylov {
    /// Makes room for vectors of so many numbers.
    pub(crate) fn fit(&mut self, size: usize) {
        self.basis.resize_with(DIRECTIONS + 1, Vec::new);
        self.improved.resize_with(DIRECTIONS, Vec::new);
        for vector in self.basis.iter_mut().chain(&mut self.improved).chain([&mut self.residual]) {
            vector.resize(size, 0.0);
        }
    }
}

/// Makes of `room.step`, a direction of the symmetric matrix, one of the whole derivative, and goes along it as long as less
/// is out of balance then; gives the length that was gone, 0 where that failed and everything is as it was.
pub(crate) fn go<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    keep: Keep,
) -> Result<f64, StepError> {
    let mut krylov = std::mem::take(&mut room.krylov);
    let outcome = go_in(system, room, balance, settings, keep, &mut krylov);
    room.krylov = krylov;
    outcome
}

fn go_in<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    keep: Keep,
    krylov: &mut Krylov,
) -> Result<f64, StepError> {
    let Krylov { basis, improved, residual } = krylov;
    let size = room.u.len();
    residual.clone_from(&room.residual);
    basis[0].clone_from(&room.right);
    let first = dot(&basis[0], &basis[0]).sqrt();
    if !(first > 0.0 && first.is_finite()) {
        return Ok(0.0);
    }
    basis[0].iter_mut().for_each(|b| *b /= first);
    // The Hessenberg matrix, made triangular by rotations as it grows, and the right-hand side that follows them.
    let mut matrix = [[0.0; DIRECTIONS]; DIRECTIONS + 1];
    let (mut turns, mut right) = ([(1.0, 0.0); DIRECTIONS], [0.0; DIRECTIONS + 1]);
    right[0] = first;
    let mut used = 0;
    while used < DIRECTIONS && right[used].abs() > ENOUGH * first {
        let k = used;
        if k == 0 {
            // The direction that is there is that of the first vector.
            for (z, s) in improved[0].iter_mut().zip(&room.step) {
                *z = s / first;
            }
        } else {
            let Room { linear, mass, free, projectors, .. } = &mut *room;
            let (mixture, filter) =
                (mixture(system, mass, balance, keep.definiteness(), settings), Filter { free, projectors });
            if linear.solve(&mixture, &filter, settings, ENOUGH, &basis[k], &mut improved[k]).is_err() {
                break;
            }
            filter.apply(&mut improved[k]);
        }
        let longest = improved[k].iter().fold(0.0, |most: f64, z| z.abs().larger(most));
        let length = DIFFERENCE * room.extent / longest;
        if !length.is_finite() {
            break;
        }
        for ((t, u), z) in room.trial.iter_mut().zip(&room.u).zip(&improved[k]) {
            *t = u + length * z;
        }
        evaluate(system, room, balance, true)?;
        basis[k + 1].clear();
        basis[k + 1].extend(room.residual.iter().zip(&*residual).map(|(after, before)| (after - before) / length));
        Filter { free: &room.free, projectors: &room.projectors }.apply(&mut basis[k + 1]);
        // Gram and Schmidt.
        let (known, next) = basis.split_at_mut(k + 1);
        for (j, known) in known.iter().enumerate() {
            matrix[j][k] = dot(known, &next[0]);
            next[0].iter_mut().zip(known).for_each(|(n, b)| *n -= matrix[j][k] * b);
        }
        let rest = dot(&next[0], &next[0]).sqrt();
        if !rest.is_finite() {
            break;
        }
        for j in 0..k {
            let (c, s) = turns[j];
            let (a, b) = (matrix[j][k], matrix[j + 1][k]);
            (matrix[j][k], matrix[j + 1][k]) = (c * a + s * b, c * b - s * a);
        }
        let radius = (matrix[k][k] * matrix[k][k] + rest * rest).sqrt();
        if radius == 0.0 {
            break;
        }
        turns[k] = (matrix[k][k] / radius, rest / radius);
        matrix[k][k] = radius;
        (right[k], right[k + 1]) = (turns[k].0 * right[k], -turns[k].1 * right[k]);
        used += 1;
        if rest == 0.0 {
            break;
        }
        next[0].iter_mut().for_each(|n| *n /= rest);
    }
    // Back from the last unknown to the first.
    let mut weights = [0.0; DIRECTIONS];
    for k in (0..used).rev() {
        let known: f64 = (k + 1..used).map(|j| matrix[k][j] * weights[j]).sum();
        weights[k] = (right[k] - known) / matrix[k][k];
    }
    let before = out_of_balance(room, residual);
    let mut length = 1.0;
    for _ in 0..MOST_HALVINGS {
        room.trial.copy_from_slice(&room.u);
        for (weight, z) in weights[..used].iter().zip(&*improved) {
            for (t, z) in room.trial.iter_mut().zip(z) {
                *t += length * weight * z;
            }
        }
        let allowed = evaluate(system, room, balance, true).is_ok();
        let now = std::mem::take(&mut room.residual);
        let after = out_of_balance(room, &now);
        room.residual = now;
        if allowed && after < (1.0 - 0.1 * length) * before {
            for k in 0..size {
                room.step[k] = (room.trial[k] - room.u[k]) / length;
            }
            room.u.copy_from_slice(&room.trial);
            return Ok(length);
        }
        length *= 0.5;
    }
    evaluate(system, room, balance, false)?;
    Ok(0.0)
}

/// The size of what is out of balance in the free directions, friction included [N²s²/kg, but for a factor].
fn out_of_balance<const D: usize>(room: &mut Room<D>, residual: &[f64]) -> f64 {
    room.right.copy_from_slice(residual);
    room.contacting.subtract_friction(&mut room.right);
    Filter { free: &room.free, projectors: &room.projectors }.apply(&mut room.right);
    let nodes = room.right.as_chunks::<D>().0.iter().zip(&room.mass);
    nodes.map(|(rest, mass)| rest.iter().map(|r| r * r).sum::<f64>() / if *mass > 0.0 { *mass } else { 1.0 }).sum()
}
