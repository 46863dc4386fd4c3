//! Where closed curves cross or touch, themselves or one another.

/// Twice the signed area of the triangle a b c [m²]; positive where c lies left of a → b.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Lower and higher of two coordinates.
fn span(p: f64, q: f64) -> [f64; 2] {
    if p <= q { [p, q] } else { [q, p] }
}

/// Whether the segments a b and c d have a common point.
fn segments_meet(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> bool {
    // Their boxes must overlap, and each must have no whole segment strictly on one side.
    let overlap = (0..2).all(|axis| {
        let (p, q) = (span(a[axis], b[axis]), span(c[axis], d[axis]));
        p[0] <= q[1] && q[0] <= p[1]
    });
    let parted = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    overlap && !parted(side(a, b, c), side(a, b, d)) && !parted(side(c, d, a), side(c, d, b))
}

/// An edge of a ring: (number of the ring, number of the edge); edge i runs from point i to the next.
pub(crate) type EdgeOfRing = (usize, usize);

/// The lowest pair of edges of closed rings that meet beyond a shared end.
///
/// A sweep along the longer side of the bounding box: only edges that overlap there are compared.
pub(crate) fn first_meeting(rings: &[&[[f64; 2]]]) -> Option<[EdgeOfRing; 2]> {
    let ends = |(ring, edge): EdgeOfRing| (rings[ring][edge], rings[ring][(edge + 1) % rings[ring].len()]);
    let first = rings.iter().find_map(|ring| ring.first())?;
    let extent = |axis: usize| {
        let (mut low, mut high) = (first[axis], first[axis]);
        for point in rings.iter().flat_map(|ring| ring.iter()) {
            low = span(low, point[axis])[0];
            high = span(high, point[axis])[1];
        }
        high - low
    };
    let axis = usize::from(extent(1) > extent(0));

    // Edges by where they begin along the sweep.
    let all = rings.iter().enumerate().flat_map(|(ring, points)| (0..points.len()).map(move |edge| (ring, edge)));
    let mut order: Vec<(f64, f64, EdgeOfRing)> = all
        .map(|edge| {
            let (a, b) = ends(edge);
            let [low, high] = span(a[axis], b[axis]);
            (low, high, edge)
        })
        .collect();
    order.sort_unstable_by(|p, q| p.0.total_cmp(&q.0).then(p.2.cmp(&q.2)));

    let mut active: Vec<(f64, EdgeOfRing)> = Vec::new();
    let mut found: Option<[EdgeOfRing; 2]> = None;
    for (low, high, edge) in order {
        active.retain(|other| other.0 >= low);
        for &(_, other) in &active {
            let pair = if edge < other { [edge, other] } else { [other, edge] };
            if found.is_none_or(|best| pair < best) && edges_conflict(rings, pair) {
                found = Some(pair);
            }
        }
        active.push((high, edge));
    }
    found
}

/// Whether two edges, the lower first, meet in more than the end that neighbours of one ring share.
fn edges_conflict(rings: &[&[[f64; 2]]], [first, second]: [EdgeOfRing; 2]) -> bool {
    let ends = |(ring, edge): EdgeOfRing| (rings[ring][edge], rings[ring][(edge + 1) % rings[ring].len()]);
    let folds_back = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        side(a, b, c) == 0.0 && ahead < 0.0
    };
    let ((a, b), (c, d)) = (ends(first), ends(second));
    let same = first.0 == second.0;
    if same && second.1 == first.1 + 1 {
        folds_back(a, b, d)
    } else if same && first.1 == 0 && second.1 == rings[first.0].len() - 1 {
        folds_back(c, d, b)
    } else {
        segments_meet(a, b, c, d)
    }
}
