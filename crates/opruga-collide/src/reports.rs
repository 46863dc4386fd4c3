//! The effects of contact on bodies, pair by pair, for programs that request them.

use crate::row::Row;
use crate::surface::Surface;

/// The effect of contact on two bodies, or on a body and itself, summed over substeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report<const D: usize> {
    /// The bodies, the lower one first.
    pub bodies: [u32; 2],
    /// The impulse on the first body [N s].
    pub impulse: [f64; D],
    /// Σ λₙ: the sum of the normal impulses of all contacts [N s].
    pub pressed: f64,
    /// Σ λₙ n, from the second body to the first [N s].
    pub normal: [f64; D],
    /// Σ λₙ x, with the position x of each contact at the end of its substep [N s m].
    pub moment: [f64; D],
}

/// Adds the impulses of a step to the reports, in the order of its contacts, so that the sums do not depend on the number of
/// threads.
pub(crate) fn add<const D: usize>(
    reports: &mut Vec<Report<D>>,
    rows: &[Row<D>],
    surface: &Surface<D>,
    end: &[[f64; D]],
) {
    for row in rows.iter().filter(|row| row.normal_impulse > 0.0 && !row.of_obstacle) {
        // The points of the first feature have positive weights, those of the second negative ones.
        let (mut first, mut second, mut position) = (None, None, None);
        for k in (0..=D).filter(|k| row.weights[*k] != 0.0) {
            let (p, weight) = (row.points[k] as usize, row.weights[k]);
            if weight > 0.0 {
                first = Some(surface.body[p]);
                let position = position.get_or_insert([0.0; D]);
                for d in 0..D {
                    position[d] += weight * end[p][d];
                }
            } else {
                second = Some(surface.body[p]);
            }
        }
        let (Some(first), Some(second), Some(position)) = (first, second, position) else { continue };
        if [first, second].iter().any(|body| surface.is_obstacle(*body)) {
            continue;
        }
        let (bodies, sign) = if first <= second { ([first, second], 1.0) } else { ([second, first], -1.0) };
        let nothing = Report { bodies, impulse: [0.0; D], pressed: 0.0, normal: [0.0; D], moment: [0.0; D] };
        let at = reports.binary_search_by_key(&bodies, |report| report.bodies).unwrap_or_else(|at| {
            reports.insert(at, nothing);
            at
        });
        let (report, whole) = (&mut reports[at], row.impulse());
        report.pressed += row.normal_impulse;
        for d in 0..D {
            report.impulse[d] += sign * whole[d];
            report.normal[d] += sign * row.normal_impulse * row.normal[d];
            report.moment[d] += row.normal_impulse * position[d];
        }
    }
}
