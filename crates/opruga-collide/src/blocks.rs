//! Blocks of two contacts that bound almost the same velocity.

use crate::row::Row;
use crate::vector::{dot, scaled, subtract};
use opruga_math::Lane;

/// The contacts of a set that are solved together in pairs.
///
/// ```text
/// A λ − q ≥ 0,  λ ≥ 0,  λᵀ (A λ − q) = 0     A = [a₁₁ a₁₂; a₁₂ a₂₂],  q = target − u_n + A λ_old
/// ```
///
/// Two vertices that almost coincide form two contacts: each vertex with an edge of the other body. Both contacts bound almost the same velocity, but
/// with different gaps. Gauss–Seidel then moves the impulse from one to the other by the same small amount in every sweep. The block finds at once which
/// of the two presses. In a heap of a thousand balls, sets of contacts take 2 sweeps in the mean instead of 17.
#[derive(Debug, Default)]
pub(crate) struct Blocks {
    /// The other contact of the block, and the coupling a₁₂ [1/kg].
    of: Vec<Option<(u32, f64)>>,
    /// The last entry of every point. An entry contains a contact, its weight at this point, and the previous entry of the point.
    last: Vec<u32>,
    entries: Vec<(u32, f64, u32)>,
    /// The couplings of the present contact with those before it, and the contacts with which it shares a point.
    couplings: Vec<f64>,
    met: Vec<u32>,
    /// For every contact, the largest a₁₂² / (a₁₁ a₂₂) so far.
    shares: Vec<f64>,
}

const NONE: u32 = u32::MAX;

/// The smallest a₁₂² / (a₁₁ a₂₂) of a block. Contacts below it converge without a block. The number of turns of a heap of balls changes by 2 % if it is
/// 0.1 or 0.7, and by 10 % if it is 0.9.
const LEAST_SHARE: f64 = 0.5;

impl Blocks {
    /// Makes all contacts single ones.
    pub(crate) fn clear(&mut self, rows: usize) {
        self.of.clear();
        self.of.resize(rows, None);
    }

    /// The other contact of the block of a contact, and their coupling [1/kg].
    pub(crate) fn partner(&self, row: usize) -> Option<(usize, f64)> {
        self.of[row].map(|(other, coupling)| (other as usize, coupling))
    }

    /// Finds the blocks of some rows, given their points. Each row joins the row with which its coupling is strongest.
    pub(crate) fn find<const D: usize>(
        &mut self,
        rows: &[Row<D>],
        heads: &[([u32; 4], u32)],
        inverse_mass: &[[f64; D]],
    ) {
        let Blocks { of, last, entries, couplings, met, shares } = self;
        last.clear();
        last.resize(inverse_mass.len(), NONE);
        entries.clear();
        couplings.clear();
        couplings.resize(rows.len(), 0.0);
        shares.clear();
        shares.resize(rows.len(), LEAST_SHARE);
        for (i, (row, (points, _))) in rows.iter().zip(heads).enumerate() {
            met.clear();
            for (p, weight) in points.iter().zip(&row.weights).take(D + 1) {
                let inverse = &inverse_mass[*p as usize];
                let own: [f64; D] = core::array::from_fn(|d| weight * inverse[d] * row.normal[d]);
                if own == [0.0; D] {
                    continue;
                }
                let mut entry = last[*p as usize];
                while entry != NONE {
                    let (other, weight, before) = entries[entry as usize];
                    let coupling = &mut couplings[other as usize];
                    if *coupling == 0.0 {
                        met.push(other);
                    }
                    *coupling += weight * dot(&own, &rows[other as usize].normal);
                    entry = before;
                }
                entries.push((i as u32, *weight, last[*p as usize]));
                last[*p as usize] = entries.len() as u32 - 1;
            }
            for other in met.drain(..) {
                let k = other as usize;
                let coupling = core::mem::take(&mut couplings[k]);
                let share = coupling * coupling * row.mass[0] * rows[k].mass[0];
                if k == i || coupling <= 0.0 || share <= shares[k].larger(shares[i]) {
                    continue;
                }
                for row in [i, k] {
                    if let Some((left, _)) = of[row].take() {
                        (of[left as usize], shares[left as usize]) = (None, LEAST_SHARE);
                    }
                }
                (of[i], shares[i]) = (Some((other, coupling)), share);
                (of[k], shares[k]) = (Some((i as u32, coupling)), share);
            }
        }
    }
}

/// Solves for the normal impulses of two contacts together, given their points and their coupling [1/kg]. Returns the largest change of their
/// velocities [m/s].
#[inline(always)]
pub(crate) fn solve<const D: usize>(
    rows: [&mut Row<D>; 2],
    points: [&[u32; 4]; 2],
    coupling: f64,
    inverse_mass: &[[f64; D]],
    v: &mut [[f64; D]],
) -> f64 {
    let [a, b] = [&*rows[0], &*rows[1]];
    let old = [a.normal_impulse, b.normal_impulse];
    if old == [0.0; 2] {
        return 0.0;
    }
    let (aa, bb) = (1.0 / a.mass[0], 1.0 / b.mass[0]);
    let qa = a.target - a.normal_velocity(points[0], v) + aa * old[0] + coupling * old[1];
    let qb = b.target - b.normal_velocity(points[1], v) + bb * old[1] + coupling * old[0];
    let determinant = aa * bb - coupling * coupling;
    let both = [(bb * qa - coupling * qb) / determinant, (aa * qb - coupling * qa) / determinant];
    let (only_a, only_b) = (qa / aa, qb / bb);
    let new = if determinant > 0.0 && both[0] >= 0.0 && both[1] >= 0.0 {
        both
    } else if only_a > 0.0 && coupling * only_a >= qb {
        [only_a, 0.0]
    } else if only_b > 0.0 && coupling * only_b >= qa {
        [0.0, only_b]
    } else if qa <= 0.0 && qb <= 0.0 {
        [0.0; 2]
    } else {
        // Rounding errors hide the solution.
        return 0.0;
    };
    let mut changed: f64 = 0.0;
    for (k, row) in rows.into_iter().enumerate() {
        let change = new[k] - old[k];
        if change == 0.0 {
            continue;
        }
        let mut impulse = scaled(&row.normal, change);
        row.normal_impulse = new[k];
        changed = (change / row.mass[0]).abs().larger(changed);
        // A contact that no longer presses has no friction. Its own turn would not notice.
        if new[k] == 0.0 {
            impulse = subtract(&impulse, &row.friction_impulse);
            row.friction_impulse = [0.0; D];
        }
        row.push(points[k], &impulse, inverse_mass, v);
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweeps::Sweeps;

    /// Two vertices that almost coincide, each with an edge of the other body: the vertices have the indices 0 and 1.
    fn vertices_that_almost_coincide(numbers: &mut impl FnMut() -> f64) -> [Row<2>; 2] {
        let tilt = 0.2 * numbers();
        let row = |points: [u32; 4], sign: f64| {
            let w = 0.05 * (1.0 + sign * tilt);
            let n = [sign * tilt, sign * (1.0 - tilt * tilt).sqrt()];
            let mut row = Row::new(0, (points, [1.0, w - 1.0, -w, 0.0]), n, 0.0);
            let squares: f64 = row.weights.iter().map(|w| w * w).sum();
            row.mass = [1.0 / squares; 2];
            row
        };
        [row([0, 1, 2, 0], -1.0), row([1, 0, 3, 1], 1.0)]
    }

    #[test]
    fn a_block_meets_the_bounds_of_both_contacts_and_only_presses_where_they_touch() {
        let mut state = 11_u64;
        let mut numbers = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let inverse_mass = [[1.0; 2]; 4];
        for k in 0..1000 {
            let mut rows = vertices_that_almost_coincide(&mut numbers);
            let mut v: [[f64; 2]; 4] = core::array::from_fn(|_| [numbers(), numbers()]);
            for row in &mut rows {
                row.target = 0.1 * numbers();
                row.normal_impulse = numbers().abs();
            }
            let mut blocks = Blocks::default();
            blocks.clear(2);
            let heads = [(rows[0].points, 0), (rows[1].points, 0)];
            blocks.find(&rows, &heads, &inverse_mass);
            let (other, coupling) = blocks.partner(0).expect("a block");
            assert_eq!((other, blocks.partner(1).map(|(other, _)| other)), (1, Some(0)));
            let [a, b] = &mut rows;
            solve([a, b], [&heads[0].0, &heads[1].0], coupling, &inverse_mass, &mut v);
            for row in &rows {
                let left = row.normal_velocity(&row.points, &v) - row.target;
                assert!(row.normal_impulse >= 0.0 && left > -1e-12, "{k}: {row:?}, {left} m/s");
                assert!((row.normal_impulse * left).abs() < 1e-12, "{k}: {row:?}, {left} m/s");
            }
        }
    }

    /// The number of sweeps after which the impulses of two vertices that almost coincide no longer change.
    fn sweeps(with_blocks: bool) -> usize {
        let mut rows = vertices_that_almost_coincide(&mut || 0.1);
        rows[0].target = -0.01;
        let mut heads = rows.each_ref().map(|row| (row.points, 0));
        let (mut v, mut stamps, mut now) = ([[0.0, 1.0], [0.0, -1.0], [0.0, -1.0], [0.0, 1.0]], [0; 4], 0);
        let inverse_mass = [[1.0; 2]; 4];
        let mut sweeps = Sweeps {
            rows: &mut rows,
            heads: &mut heads,
            inverse_mass: &inverse_mass,
            v: &mut v,
            stamps: &mut stamps,
            now: &mut now,
        };
        let mut blocks = Blocks::default();
        blocks.clear(2);
        if with_blocks {
            sweeps.find_blocks(&mut blocks);
        }
        (0..1000).take_while(|sweep| sweeps.sweep_alone(sweep % 2 == 1, 1e-5, &mut blocks)).count()
    }

    #[test]
    fn a_block_saves_the_sweeps_that_move_an_impulse_from_one_contact_to_the_other() {
        let (single, together) = (sweeps(false), sweeps(true));
        assert!(single > 60 && together < 5, "{single} sweeps, {together} with a block");
    }
}
