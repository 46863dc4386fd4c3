//! The triangulation of closed curves and points inside them.

use super::{OutlineError, Ring};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Triangulation};

/// The number of consecutive points of a ring on one line that make a long straight side.
const LONG_SIDE: usize = 500;

/// The triangulation of rings and of points inside them, with the edges of the rings. Also returns the number of the point of every vertex; points of
/// the rings come first.
///
/// The library inserts many points at once, from their centre outwards, which is fast for points that cover an area. Along a long straight side,
/// however, the library walks past all earlier points for each new point, so the time grows with the square of the number of points. Rings with such
/// sides are therefore inserted from coarse to fine, see [`coarse_to_fine`]. (The triangulations are equal either way, but a refinement adds its
/// points in another order.)
pub(super) fn constrained<V: HasPosition<Scalar = f64>>(
    rings: &[Ring],
    inside: &[[f64; 2]],
    shrink: impl Fn([f64; 2]) -> V,
    failed: impl Fn(u32, [f64; 2]) -> OutlineError,
) -> Result<(ConstrainedDelaunayTriangulation<V>, Vec<usize>), OutlineError> {
    let points: Vec<[f64; 2]> = rings.iter().flat_map(|ring| &ring.points).chain(inside).copied().collect();
    let mut edges: Vec<[usize; 2]> = Vec::new();
    let mut first = 0;
    for ring in rings {
        let next = first + ring.points.len();
        edges.extend((first..next).map(|k| [k, if k + 1 < next { k + 1 } else { first }]));
        first = next;
    }
    let refuse = |number: usize| {
        let mut first = 0;
        let ring = rings.iter().find(|ring| {
            first += ring.points.len();
            number < first
        });
        failed(ring.map_or(0, |ring| ring.part), points.get(number).copied().unwrap_or([0.0; 2]))
    };
    let (mut triangulation, numbers) = if rings.iter().any(has_long_side) {
        coarse_to_fine(&points, shrink).map_err(&refuse)?
    } else {
        let made = ConstrainedDelaunayTriangulation::try_bulk_load_cdt(
            points.iter().map(|point| shrink(*point)).collect(),
            edges.clone(),
            |_| {},
        );
        // Coincident points make one vertex.
        let made = made.ok().filter(|made| made.num_vertices() == points.len()).ok_or_else(|| refuse(0))?;
        (made, (0..points.len()).collect())
    };
    let mut vertices = vec![FixedVertexHandle::from_index(0); points.len()];
    numbers.iter().enumerate().for_each(|(vertex, number)| vertices[*number] = FixedVertexHandle::from_index(vertex));
    for [from, to] in edges {
        let (a, b) = (vertices[from], vertices[to]);
        // An edge that crosses another is not added; an edge with a point on it becomes two.
        if a != b && !triangulation.exists_constraint(a, b) {
            triangulation.try_add_constraint(a, b);
        }
        if a == b || !triangulation.exists_constraint(a, b) {
            return Err(refuse(from));
        }
    }
    Ok((triangulation, numbers))
}

/// Whether many consecutive points are on one line.
fn has_long_side(ring: &Ring) -> bool {
    let n = ring.points.len();
    let mut run = 0;
    for k in 0..n {
        let [o, a, b] = [0, 1, 2].map(|step| ring.points[(k + step) % n]);
        let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
        let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
        run = if cross.abs() <= 1e-6 * dot.abs() { run + 1 } else { 0 };
        if run >= LONG_SIDE {
            return true;
        }
    }
    false
}

/// Inserts vertices without edges. Returns the triangulation and, for each vertex, the number of its point. The error is the number of a point that
/// coincides with another.
///
/// From the list of all points, some distant ones are inserted first, then those halfway between, and so on. The search for each starts at the
/// previous point of the list, which is near. The outer corners are inserted before all others, because points on one straight line form no
/// triangles, and a search would walk along the whole line.
fn coarse_to_fine<V: HasPosition<Scalar = f64>>(
    points: &[[f64; 2]],
    shrink: impl Fn([f64; 2]) -> V,
) -> Result<(ConstrainedDelaunayTriangulation<V>, Vec<usize>), usize> {
    let mut triangulation = ConstrainedDelaunayTriangulation::new();
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; points.len()];
    let mut numbers = Vec::with_capacity(points.len());
    for (number, neighbour) in
        outer_corners(points).map(|number| (number, None)).into_iter().chain(halvings(points.len()))
    {
        if handles[number].is_some() {
            continue;
        }
        let point = shrink(points[number]);
        let made = match neighbour.and_then(|neighbour: usize| handles[neighbour]) {
            Some(hint) => triangulation.insert_with_hint(point, hint),
            None => triangulation.insert(point),
        };
        let handle = made.ok().filter(|handle| handle.index() == numbers.len()).ok_or(number)?;
        handles[number] = Some(handle);
        numbers.push(number);
    }
    Ok((triangulation, numbers))
}

/// Three points that form a triangle: both extremes along x, and the point farthest from the line through them.
fn outer_corners(points: &[[f64; 2]]) -> [usize; 3] {
    let along = |a: &usize, b: &usize| {
        let (a, b) = (points[*a], points[*b]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    };
    let (left, right) = ((0..points.len()).min_by(along).unwrap_or(0), (0..points.len()).max_by(along).unwrap_or(0));
    let (p, q) = (points[left], points[right]);
    let off = |k: usize| ((q[0] - p[0]) * (points[k][1] - p[1]) - (q[1] - p[1]) * (points[k][0] - p[0])).abs();
    [left, right, (0..points.len()).max_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0)]
}

/// The numbers below a count from coarse to fine, each with its lower neighbour among the earlier numbers: 0; 4 after 0; 2 after 0, 6 after 4; …
fn halvings(count: usize) -> impl Iterator<Item = (usize, Option<usize>)> {
    let strides = core::iter::successors(Some(count.next_power_of_two()), |stride| Some(stride / 2));
    let finer = strides.take_while(|stride| *stride > 1).flat_map(move |stride| {
        (stride / 2..count).step_by(stride).map(move |number| (number, Some(number - stride / 2)))
    });
    (0..count.min(1)).map(|number| (number, None)).chain(finer)
}

#[cfg(test)]
mod tests {
    use super::{Ring, constrained, halvings};
    use crate::outline::OutlineError;
    use core::cell::Cell;
    use spade::{HasPosition, Point2};

    thread_local! {
        /// The number of times that the library has accessed a point.
        static LOOKS: Cell<u64> = const { Cell::new(0) };
    }

    struct Counted(Point2<f64>);

    impl HasPosition for Counted {
        type Scalar = f64;
        fn position(&self) -> Point2<f64> {
            LOOKS.set(LOOKS.get() + 1);
            self.0
        }
    }

    #[test]
    fn halvings_name_every_number_once_and_after_its_neighbour() {
        for count in [0usize, 1, 2, 3, 7, 8, 9, 100] {
            let mut seen = vec![false; count];
            for (number, neighbour) in halvings(count) {
                assert!(!seen[number] && neighbour.is_none_or(|neighbour| seen[neighbour]), "{number} of {count}");
                seen[number] = true;
            }
            assert!(seen.iter().all(|seen| *seen), "{count}");
        }
    }

    /// Before a corner has been inserted, points of a straight side are in no triangle. For one side of a strip, both sides of a strip, and the sides
    /// of a rotated square, each point is accessed a few hundred times, however many points there are.
    #[test]
    fn points_of_long_straight_sides_are_looked_at_equally_often_however_many_there_are() {
        let looks = |points: Vec<[f64; 2]>| {
            let count = points.len() as f64;
            LOOKS.set(0);
            let counted = |p: [f64; 2]| Counted(Point2::new(p[0], p[1]));
            constrained(&[Ring { points, part: 0 }], &[], counted, |_, _| OutlineError::Empty {})
                .expect("a triangulation");
            LOOKS.get() as f64 / count
        };
        for count in [4_000u32, 16_000] {
            let part = |k: u32, of: u32| f64::from(k) / f64::from(of);
            let side: Vec<[f64; 2]> = (0..count).map(|k| [part(k, count), 0.0]).collect();
            let one = [&side[..], &[[1.0, 0.0], [1.0, 1e-4], [0.0, 1e-4]]].concat();
            let both = [&side[..], &side.iter().map(|p| [1.0 - p[0], 1e-4]).collect::<Vec<_>>()].concat();
            let around = (0..count).map(|k| {
                let (corner, t) = (4 * k / count, 4.0 * part(k, count) % 1.0);
                let (x, y) = [(t, 0.0), (1.0, t), (1.0 - t, 1.0), (0.0, 1.0 - t)][corner as usize];
                [0.5 + 0.28 * x - 0.096 * y, 0.096 * x + 0.28 * y]
            });
            for (name, points) in [("one side", one), ("both sides", both), ("a square", around.collect())] {
                let looks = looks(points);
                assert!(looks > 1.0 && looks < 500.0, "{name}: {looks} looks at each of {count} points");
            }
        }
    }
}
