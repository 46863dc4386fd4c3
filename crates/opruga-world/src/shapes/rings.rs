//! Several circular outlines in one body, and the rules for their positions.

use super::{number, points};
use opruga_core::spec::Values;
use opruga_mesh::{Mesh, MeshError, Quantity};

/// Circles that are closer than this fraction of their radii touch, because their nodes are rounded.
const TOUCHING: f64 = 1e-9;

/// Rings, one after another; rings with negative radius run clockwise.
pub(super) fn rings(shape: &Values) -> Result<Mesh<2>, MeshError> {
    let (centers, radii) = (points::<2>(shape.rows("centers")), shape.numbers("radii").unwrap_or(&[]));
    if radii.len() != centers.len() {
        let (value, wanted) = (radii.len() as u64, centers.len() as u64);
        return Err(MeshError::Count { what: Quantity::LengthRadii, value, least: wanted, most: wanted });
    }
    let vertices = number(shape, "vertices");
    let mut all = Mesh::<2>::default();
    for (center, radius) in centers.iter().zip(radii) {
        let mut ring = Mesh::ring(radius.abs(), vertices, *center, 0.0)?;
        let first = all.positions.len() as u32;
        all.positions.append(&mut ring.positions);
        let hole = *radius < 0.0;
        all.facets.extend(
            ring.facets.iter().map(|[a, b]| if hole { [b + first, a + first] } else { [a + first, b + first] }),
        );
    }
    let circles = centers.iter().zip(radii).zip(all.positions.chunks(vertices.max(1) as usize));
    let circles = circles.map(|((center, radius), nodes)| Circle { center: *center, radius: *radius, nodes });
    check(&circles.collect::<Vec<_>>())?;
    all.chambers()?;
    Ok(all)
}

/// A ring: a polygon of nodes on a circle.
struct Circle<'a> {
    center: [f64; 2],
    /// Negative for a hole [m].
    radius: f64,
    /// Counter-clockwise.
    nodes: &'a [[f64; 2]],
}

/// The relative position of two rings.
enum Lying {
    Apart,
    Meeting,
    /// The second is inside the first.
    Within,
    /// The first is inside the second.
    Around,
}

impl Circle<'_> {
    fn size(&self) -> f64 {
        self.radius.abs()
    }

    fn lies(&self, other: &Circle<'_>) -> Lying {
        let away = [other.center[0] - self.center[0], other.center[1] - self.center[1]];
        let distance = (away[0] * away[0] + away[1] * away[1]).sqrt();
        let sum = self.size() + other.size();
        if distance > sum * (1.0 + TOUCHING) {
            return Lying::Apart;
        }
        let (outer, inner, found) =
            if self.size() >= other.size() { (self, other, Lying::Within) } else { (other, self, Lying::Around) };
        if outer.holds(inner, distance, sum * TOUCHING) { found } else { Lying::Meeting }
    }

    /// Whether a smaller ring at a given distance of centres lies inside this one and is farther than `gap` from its sides.
    fn holds(&self, inner: &Circle<'_>, distance: f64, gap: f64) -> bool {
        if distance + inner.size() >= self.size() - gap {
            return false;
        }
        let side = |k: usize| (self.nodes[k], self.nodes[(k + 1) % self.nodes.len()]);
        let (a, b) = side(0);
        let middle = [0.5 * (a[0] + b[0]) - self.center[0], 0.5 * (a[1] + b[1]) - self.center[1]];
        if distance + inner.size() < (middle[0] * middle[0] + middle[1] * middle[1]).sqrt() - gap {
            return true;
        }
        // The circle of the inner ring may cross a side of this polygon. The inner polygon may still lie inside, because it is smaller than its
        // circle.
        (0..self.nodes.len()).all(|k| {
            let (a, b) = side(k);
            let along = [b[0] - a[0], b[1] - a[1]];
            let gap = gap * (along[0] * along[0] + along[1] * along[1]).sqrt();
            inner.nodes.iter().all(|x| along[0] * (x[1] - a[1]) - along[1] * (x[0] - a[0]) > gap)
        })
    }
}

/// Refuses rings that meet, rings directly inside a ring of their own kind, and holes outside any ring.
fn check(circles: &[Circle<'_>]) -> Result<(), MeshError> {
    let spread = |axis: usize| {
        let coordinates = circles.iter().map(|circle| circle.center[axis]);
        let (low, high) = coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (if x < low { x } else { low }, if x > high { x } else { high })
        });
        high - low
    };
    // Sort along the axis with the larger extent; compare each ring with those that overlap it along that axis.
    let axis = usize::from(spread(1) > spread(0));
    let ends = |k: usize| {
        let size = circles[k].size() * (1.0 + TOUCHING);
        (circles[k].center[axis] - size, circles[k].center[axis] + size)
    };
    let mut order: Vec<usize> = (0..circles.len()).collect();
    order.sort_by(|a, b| ends(*a).0.total_cmp(&ends(*b).0));
    // The smallest ring around each ring.
    let mut around: Vec<Option<usize>> = vec![None; circles.len()];
    let mut meeting: Option<(usize, usize)> = None;
    let mut overlapping: Vec<usize> = Vec::new();
    for k in order {
        overlapping.retain(|other| ends(*other).1 >= ends(k).0);
        for &other in &overlapping {
            let (inner, outer) = match circles[k].lies(&circles[other]) {
                Lying::Apart => continue,
                Lying::Meeting => {
                    let pair = if k < other { (k, other) } else { (other, k) };
                    meeting = Some(meeting.map_or(pair, |first| if pair < first { pair } else { first }));
                    continue;
                }
                Lying::Within => (other, k),
                Lying::Around => (k, other),
            };
            if around[inner].is_none_or(|known| circles[outer].size() < circles[known].size()) {
                around[inner] = Some(outer);
            }
        }
        overlapping.push(k);
    }
    if let Some((first, second)) = meeting {
        return Err(MeshError::RingsMeet { first, second });
    }
    for (ring, outer) in around.into_iter().enumerate() {
        let hole = circles[ring].radius < 0.0;
        match outer {
            Some(outer) if hole == (circles[outer].radius < 0.0) => {
                return Err(MeshError::RingsAlike { outer, inner: ring });
            }
            None if hole => return Err(MeshError::HoleInNothing { ring }),
            _ => {}
        }
    }
    Ok(())
}
