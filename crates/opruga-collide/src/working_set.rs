//! Impulses of contacts of coupled bodies, when far more pairs are examined than press.
//!
//! Most pairs of a step are only near one another and have no impulse in the end. Therefore, the laws are solved only for some contacts, the working
//! set. Contacts that approach too fast then join the set, the fastest first, until none is left. Each solution satisfies the laws of all contacts of
//! the set, so the last solution satisfies the laws of all contacts of the step.

use crate::coupled::Coupled;
use crate::newton::{self, Aim};
use crate::row::Row;
use crate::spread::Spread;
use crate::vector::{dot, subtract};

/// The largest number of solutions. Two to five are enough in most steps. Without a limit, contacts could leave and join
/// alternately without end.
const MOST_SOLUTIONS: usize = 40;

/// Finds the impulses with which all contacts obey their laws, to the required accuracy. Returns the number of turns. Returns none if more contacts
/// press than one solution can handle, or if the set does not settle. Impulses and velocities are then consistent, and sweeps can continue from
/// there.
pub(crate) fn solve<const D: usize>(
    rows: &mut [Row<D>],
    spread: &Spread,
    inverse_mass: &[[f64; D]],
    coupled: &mut Coupled<D>,
    v: &mut [[f64; D]],
    aim: Aim,
) -> Option<usize> {
    let mut belongs: Vec<bool> = rows.iter().map(|row| row.normal_impulse > 0.0).collect();
    let mut turns = 0;
    for solution in 0..MOST_SOLUTIONS {
        let approach = |row: &Row<D>| row.target - dot(&subtract(&row.mean(spread, v), &row.carry), &row.normal);
        let mut joining: Vec<(f64, usize)> = (0..rows.len())
            .filter(|k| !belongs[*k] && rows[*k].mass[0] > 0.0)
            .map(|k| (approach(&rows[k]), k))
            .filter(|(approach, _)| *approach > aim.enough)
            .collect();
        if joining.is_empty() && solution > 0 {
            return Some(turns);
        }
        joining.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let unknowns = |belongs: &[bool]| -> usize {
            rows.iter().zip(belongs).filter(|(_, own)| **own).map(|(row, _)| newton::count_of(row)).sum()
        };
        let mut size = unknowns(&belongs);
        // Contacts that do not press leave the set to make space for those that approach.
        let fits = |size: usize, k: usize| size + newton::count_of(&rows[k]) <= newton::MOST_UNKNOWNS;
        if size > newton::MOST_UNKNOWNS || joining.first().is_some_and(|(_, k)| !fits(size, *k)) {
            belongs.iter_mut().zip(rows.iter()).for_each(|(own, row)| *own = row.normal_impulse > 0.0);
            size = unknowns(&belongs);
            if size > newton::MOST_UNKNOWNS || joining.first().is_some_and(|(_, k)| !fits(size, *k)) {
                return None;
            }
        }
        for (_, k) in joining {
            if !fits(size, k) {
                break;
            }
            belongs[k] = true;
            size += newton::count_of(&rows[k]);
        }
        let numbers: Vec<usize> = (0..rows.len()).filter(|k| belongs[*k]).collect();
        let mut set: Vec<Row<D>> = numbers.iter().map(|k| rows[*k]).collect();
        turns += rows.len() + newton::solve(&mut set, spread, inverse_mass, coupled, v, aim);
        numbers.iter().zip(set).for_each(|(k, row)| rows[*k] = row);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subspace::tests::column;

    /// Forty points fall onto a pinned one. Two thousand further pairs of these points could approach at a kilometre per second
    /// without touching.
    #[test]
    fn pairs_that_only_might_touch_are_no_unknowns() {
        let (mut rows, inverse_mass) = column(41, 0.5);
        let pressing = rows.len();
        for k in 0..2000 {
            let mut apart = rows[k % pressing];
            (apart.id, apart.target, apart.normal_impulse) = (1000 + k as u64, -1000.0, 0.0);
            rows.push(apart);
        }
        let mut v = vec![[0.0, -1.0]; 41];
        v[0] = [0.0; 2];
        let spread = Spread::default();
        let aim = Aim { enough: 1e-9, sweeps: None };
        let turns = solve(&mut rows, &spread, &inverse_mass, &mut Coupled::default(), &mut v, aim);
        assert!(turns.is_some() && v.iter().flatten().all(|v| v.abs() < 1e-6), "{turns:?} {v:?}");
        assert!(rows[pressing..].iter().all(|row| row.normal_impulse == 0.0));
        // Each contact carries the points above it, in addition to its previous impulse.
        let carried = rows[..pressing].iter().zip((1..=40).rev());
        carried.for_each(|(row, above)| assert!((row.normal_impulse - 1.0 - f64::from(above)).abs() < 1e-3, "{row:?}"));
    }
}
