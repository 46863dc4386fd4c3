//! The inside of closed curves as a lattice of equal squares.

use super::{OutlineError, Ring, bounds};
use crate::{MAXIMUM_NODES, Mesh, Quantity};
use std::collections::{BTreeMap, BTreeSet};

/// A square, given by its column and row.
type Square = (i64, i64);

/// The approximate number of nodes of [`squares`]: one for each square inside, plus those along the rings.
pub fn squares_estimate(rings: &[Ring], spacing: f64) -> f64 {
    let inside = rings.iter().map(Ring::area).sum::<f64>().abs() / (spacing * spacing);
    let border = 2.0 * rings.iter().map(Ring::length).sum::<f64>() / spacing;
    crate::mesh::estimated(inside + border + 4.0)
}

/// The inside of rings that [`super::nest`] has oriented, as equal squares of side `spacing` [m], which extend slightly beyond the rings. A square is
/// kept if a ring passes through it or if its centre is inside. If two squares would touch only at a corner, a square beside them is added.
///
/// Detail finer than the spacing is lost: parts that are less than a square apart become one body. The lattice is centred in the box of the rings.
/// Nodes are numbered row by row, from below.
///
/// # Errors
/// [`OutlineError::TooFine`] if the lattice would be too large, [`OutlineError::Empty`] without rings.
pub fn squares(rings: &[Ring], spacing: f64) -> Result<Mesh<2>, OutlineError> {
    crate::mesh::positive(Quantity::Spacing, spacing)?;
    let (low, high) = bounds(rings).ok_or(OutlineError::Empty {})?;
    let nodes = squares_estimate(rings, spacing) as u64;
    if nodes > MAXIMUM_NODES {
        return Err(OutlineError::TooFine { spacing, nodes });
    }
    let origin: [f64; 2] = core::array::from_fn(|a| {
        let count = ((high[a] - low[a]) / spacing).ceil();
        0.5 * (low[a] + high[a]) - 0.5 * count * spacing
    });
    let mut kept = crossed(rings, origin, spacing);
    kept.extend(inside(rings, origin, spacing));
    close_corners(&mut kept);

    let mut numbers: BTreeMap<(i64, i64), u32> =
        kept.iter().flat_map(|square| corners(*square)).map(|(i, j)| ((j, i), 0)).collect();
    if numbers.len() as u64 > MAXIMUM_NODES {
        return Err(OutlineError::TooFine { spacing, nodes: numbers.len() as u64 });
    }
    let mut mesh = Mesh::<2>::default();
    for (&(j, i), number) in &mut numbers {
        *number = mesh.positions.len() as u32;
        mesh.positions.push([origin[0] + i as f64 * spacing, origin[1] + j as f64 * spacing]);
    }
    mesh.cells.quadrilaterals =
        kept.iter().map(|square| corners(*square).map(|(i, j)| numbers[&(j, i)])).collect::<Vec<[u32; 4]>>();
    mesh.facets = mesh.facets_from_cells()?;
    Ok(mesh)
}

/// The corners of a square, counter-clockwise.
fn corners((i, j): Square) -> [(i64, i64); 4] {
    [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
}

/// The squares that a ring passes through: in each column of squares, those between the two points where an edge enters and leaves the column.
fn crossed(rings: &[Ring], origin: [f64; 2], spacing: f64) -> BTreeSet<Square> {
    let mut found = BTreeSet::new();
    for (a, b) in rings.iter().flat_map(Ring::edges) {
        let local = |p: [f64; 2]| [(p[0] - origin[0]) / spacing, (p[1] - origin[1]) / spacing];
        let (a, b) = (local(a), local(b));
        let (a, b) = if b[0] < a[0] { (b, a) } else { (a, b) };
        let height = |x: f64| {
            let share = if b[0] > a[0] { (x - a[0]) / (b[0] - a[0]) } else { 0.0 };
            a[1] + share * (b[1] - a[1])
        };
        let (first, last) = (a[0].floor(), b[0].floor());
        for column in first as i64..=last as i64 {
            let from = if column as f64 <= a[0] { a[1] } else { height(column as f64) };
            let to = if column as f64 + 1.0 >= b[0] { b[1] } else { height(column as f64 + 1.0) };
            let (from, to) = if to < from { (to, from) } else { (from, to) };
            found.extend((from.floor() as i64..=to.floor() as i64).map(|row| (column, row)));
        }
    }
    found
}

/// Squares whose centre is inside by the even-odd rule, row by row.
fn inside(rings: &[Ring], origin: [f64; 2], spacing: f64) -> Vec<Square> {
    // Every edge adds a crossing to each row whose middle is between its ends.
    let mut rows: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (a, b) in rings.iter().flat_map(Ring::edges) {
        let row = |y: f64| (y - origin[1]) / spacing - 0.5;
        let (a, b) = if b[1] < a[1] { (b, a) } else { (a, b) };
        for j in row(a[1]).ceil() as i64..=row(b[1]).floor() as i64 {
            let y = origin[1] + (j as f64 + 0.5) * spacing;
            if (a[1] > y) != (b[1] > y) {
                rows.entry(j).or_default().push(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
            }
        }
    }
    let mut found = Vec::new();
    for (row, mut crossings) in rows {
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let column = |x: f64| (x - origin[0]) / spacing - 0.5;
            found.extend((column(pair[0]).ceil() as i64..=column(pair[1]).floor() as i64).map(|column| (column, row)));
        }
    }
    found
}

/// Adds a square wherever two squares touch only at a corner, because the body would be connected there by a single point.
fn close_corners(kept: &mut BTreeSet<Square>) {
    // A square that was just added may touch further ones.
    let mut added: Vec<Square> = kept.iter().copied().collect();
    while !added.is_empty() {
        let mut missing = BTreeSet::new();
        for (i, j) in added {
            for side in [-1, 1] {
                // The square is tested both as the lower and as the upper one of two that touch.
                for (i, j) in [(i, j), (i - side, j - 1)] {
                    let beside = [(i + side, j), (i, j + 1)];
                    let both = kept.contains(&(i, j)) && kept.contains(&(i + side, j + 1));
                    if both && !beside.iter().any(|square| kept.contains(square)) {
                        missing.insert(beside[0]);
                    }
                }
            }
        }
        kept.extend(&missing);
        added = missing.into_iter().collect();
    }
}
