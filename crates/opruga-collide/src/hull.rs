//! Convex hulls of points in the plane and in space. A point that lies on a face (within rounding) does not divide this face.

use crate::vector::{dot, length, scaled, subtract};

/// The faces of the convex hull as indices of points, with outward normals. In 2D the normal is to the *left* of the direction
/// of each face, so faces run clockwise. None if the hull has no area or volume.
pub(crate) fn faces<const D: usize>(points: &[[f64; D]]) -> Option<Vec<[usize; D]>> {
    let faces = if D == 2 { polygon(points)? } else { polyhedron(points)? };
    Some(
        faces
            .iter()
            .map(|face| {
                let mut out = [0; D];
                out.copy_from_slice(&face[..D]);
                out
            })
            .collect(),
    )
}

/// The largest distance of any point from the first one.
fn size<const D: usize>(points: &[[f64; D]]) -> f64 {
    points.iter().fold(0.0, |far: f64, p| {
        let r = length(&subtract(p, &points[0]));
        if r > far { r } else { far }
    })
}

/// Returns the edges of the convex hull in the plane, found by Andrew's monotone chain.
fn polygon<const D: usize>(points: &[[f64; D]]) -> Option<Vec<[usize; 3]>> {
    let tolerance = 1e-12 * size(points);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        points[a][0].total_cmp(&points[b][0]).then(points[a][1].total_cmp(&points[b][1])).then(a.cmp(&b))
    });
    // Whether b is to the right of the line from a to c by more than rounding, and so is a corner.
    let is_corner = |a: usize, b: usize, c: usize| {
        let (u, w) = (subtract(&points[c], &points[a]), subtract(&points[b], &points[a]));
        u[1] * w[0] - u[0] * w[1] > tolerance * length(&u)
    };
    let mut chain: Vec<usize> = Vec::new();
    for (pass, sweep) in [order.clone(), order.iter().rev().copied().collect()].iter().enumerate() {
        let floor = if pass == 0 { 0 } else { chain.len() - 1 };
        for &p in sweep {
            while chain.len() >= floor + 2 && !is_corner(chain[chain.len() - 2], chain[chain.len() - 1], p) {
                chain.pop();
            }
            if chain.last() != Some(&p) {
                chain.push(p);
            }
        }
    }
    chain.pop();
    if chain.len() < 3 {
        return None;
    }
    // The chain runs counterclockwise; faces run clockwise, so that the normal on their left points outward.
    Some((0..chain.len()).map(|k| [chain[(k + 1) % chain.len()], chain[k], 0]).collect())
}

/// A face of a growing hull.
struct Face<const D: usize> {
    corners: [usize; 3],
    normal: [f64; D],
    offset: f64,
    alive: bool,
}

/// Returns the faces of the convex hull in space. The hull is built by adding one point after the other. If a point is outside the present hull, the
/// faces that are visible from it are replaced by faces between the point and the rim of the visible faces.
fn polyhedron<const D: usize>(points: &[[f64; D]]) -> Option<Vec<[usize; 3]>> {
    let tolerance = 1e-10 * size(points);
    let farthest = |score: &dyn Fn(&[f64; D]) -> f64| {
        let mut best = (0, f64::NEG_INFINITY);
        for (k, p) in points.iter().enumerate() {
            let s = score(p);
            if s > best.1 {
                best = (k, s);
            }
        }
        best
    };
    // A tetrahedron of distant points.
    let (a, _) = farthest(&|p| -p[0]);
    let (b, far) = farthest(&|p| length(&subtract(p, &points[a])));
    if far.is_nan() || far <= 0.0 {
        return None;
    }
    let axis = scaled(&subtract(&points[b], &points[a]), 1.0 / far);
    let (c, far) = farthest(&|p| {
        let arm = subtract(p, &points[a]);
        length(&subtract(&arm, &scaled(&axis, dot(&arm, &axis))))
    });
    if far.is_nan() || far <= tolerance {
        return None;
    }
    let base = face(points, [a, b, c])?;
    let (d, far) = farthest(&|p| (dot(p, &base.normal) - base.offset).abs());
    if far.is_nan() || far <= tolerance {
        return None;
    }
    let up = dot(&points[d], &base.normal) > base.offset;
    let [a, b, c] = if up { [a, c, b] } else { [a, b, c] };
    let mut faces: Vec<Face<D>> = Vec::new();
    for corners in [[a, b, c], [b, a, d], [c, b, d], [a, c, d]] {
        faces.push(face(points, corners)?);
    }
    for (k, point) in points.iter().enumerate() {
        let sees = |f: &Face<D>| f.alive && dot(point, &f.normal) - f.offset > tolerance;
        let seen: Vec<usize> = (0..faces.len()).filter(|&f| sees(&faces[f])).collect();
        // The rim: edges between a visible and an invisible face.
        let mut rim = Vec::new();
        for &f in &seen {
            let [a, b, c] = faces[f].corners;
            for edge in [[a, b], [b, c], [c, a]] {
                let twin = seen.iter().any(|&g| {
                    let [a, b, c] = faces[g].corners;
                    [[b, a], [c, b], [a, c]].contains(&edge)
                });
                if !twin {
                    rim.push(edge);
                }
            }
        }
        for f in seen {
            faces[f].alive = false;
        }
        for [a, b] in rim {
            faces.push(face(points, [a, b, k])?);
        }
        faces.retain(|f| f.alive);
    }
    // Results that rounding may have spoiled are refused: every edge must have two faces, and every point must be behind every
    // face.
    let allowed = 10.0 * tolerance;
    let edges: Vec<[usize; 2]> = faces
        .iter()
        .flat_map(|f| [[f.corners[0], f.corners[1]], [f.corners[1], f.corners[2]], [f.corners[2], f.corners[0]]])
        .collect();
    let mut sorted = edges.clone();
    sorted.sort_unstable();
    let closed = edges.iter().all(|e| sorted.binary_search(&[e[1], e[0]]).is_ok());
    let holds = faces.iter().all(|f| points.iter().all(|p| dot(p, &f.normal) - f.offset <= allowed));
    (closed && holds).then(|| faces.iter().map(|f| f.corners).collect())
}

/// A face through three points, with the normal by the right-hand rule; `None` if they are collinear.
fn face<const D: usize>(points: &[[f64; D]], corners: [usize; 3]) -> Option<Face<D>> {
    let [a, b, c] = corners.map(|p| points[p]);
    let (e, f) = (subtract(&b, &a), subtract(&c, &a));
    let mut normal = [0.0; D];
    for d in 0..D {
        normal[d] = e[(d + 1) % D] * f[(d + 2) % D] - e[(d + 2) % D] * f[(d + 1) % D];
    }
    let size = length(&normal);
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let normal = scaled(&normal, 1.0 / size);
    Some(Face { corners, normal, offset: dot(&a, &normal), alive: true })
}
