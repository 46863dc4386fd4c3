//! Faces with many corners, cut into triangles between their corners.

use crate::geometry::{Point, cross, dot, norm, subtract};
use crate::outline::{Ring, triangles_between};

/// A corner is straight if its triangle with its neighbours has less than this fraction of the area of the face.
const STRAIGHT: f64 = 1e-12;

/// A face is folded too far if its corners are farther from its plane than this fraction of its size. The fraction has this value for a square that
/// is folded along its diagonal by a right angle.
const FOLDED: f64 = 0.25;

/// If the lengths of the diagonals differ by less than this fraction, the first one is used, so that rounding does not decide.
const AS_LONG: f64 = 1e-9;

/// Reasons why a face cannot be cut into triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceError {
    /// The edges of the face cross or touch, or the face encloses no area.
    Crossing,
    /// The face is folded too far: the largest distance of a corner from its plane, relative to the size of the face.
    Folded(f64),
}

/// A face cut into triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct CutFace {
    /// The triangles, given by the numbers of their corners and wound like the face. There are two fewer triangles than corners.
    pub triangles: Vec<[u32; 3]>,
    /// Whether the face has a corner that points inward.
    pub concave: bool,
    /// The largest distance of a corner from the plane of the face, relative to the size of the face, which is the longest side of its bounding box.
    pub bent: f64,
}

/// Cuts a face with at least three corners along diagonals inside it.
///
/// The plane of the face is normal to the area vector ½Σ xᵢ×xⱼ and passes through the mean of the corners. The inside of the face is determined in
/// this plane. A face of four corners is cut along the diagonal that is inside it, or along the shorter one if both are inside. Larger faces get the
/// constrained Delaunay triangulation of their corners, which maximises the smallest angle.
///
/// # Errors
/// [`FaceError::Crossing`], [`FaceError::Folded`].
///
/// # Source
/// I. Sutherland, R. Sproull, R. Schumacker (1974) for the area vector, which they credit to M. Newell; library spade.
pub fn cut_face(corners: &[[f64; 3]]) -> Result<CutFace, FaceError> {
    let n = corners.len();
    let size = (0..3).map(|axis| range(corners, axis)).fold(0.0, |a, b| if b > a { b } else { a });
    if n < 3 || !(size > 0.0 && size.is_finite()) {
        return Err(FaceError::Crossing);
    }
    // Scaled to unit size and relative to the first corner, so that nothing overflows and little is lost to rounding.
    let local = |p: &[f64; 3]| -> Point { core::array::from_fn(|d| p[d] / size - corners[0][d] / size) };
    let points: Vec<Point> = corners.iter().map(local).collect();
    let mut whole = [0.0; 3];
    for k in 0..n {
        let part = cross(points[k], points[(k + 1) % n]);
        whole = core::array::from_fn(|d| whole[d] + part[d]);
    }
    let doubled = norm(whole);
    if doubled.is_nan() || doubled <= STRAIGHT {
        return Err(FaceError::Crossing);
    }
    let normal = whole.map(|x| x / doubled);
    let mean: Point = core::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / n as f64);
    let bent = points.iter().map(|p| dot(subtract(*p, mean), normal).abs()).fold(0.0, |a, b| if b > a { b } else { a });
    if bent > FOLDED {
        return Err(FaceError::Folded(bent));
    }

    let [along, across] = plane(normal);
    // The library does not accept coordinates close to the underflow limit.
    let flat = |x: f64| if x.abs() < 1e-100 { 0.0 } else { x };
    let flat: Vec<[f64; 2]> = points.iter().map(|p| [flat(dot(*p, along)), flat(dot(*p, across))]).collect();
    let side = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [a, b, c].map(|k| flat[k % n]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let turn = |k: usize| side([k + n - 1, k, k + 1]);
    let concave = (0..n).any(|k| turn(k) < -STRAIGHT * doubled);
    let triangles: Vec<[u32; 3]> = match n {
        3 => vec![[0, 1, 2]],
        4 => {
            let square = |a: usize, b: usize| {
                let diagonal = subtract(points[b], points[a]);
                dot(diagonal, diagonal)
            };
            let sharpest = (1..4).fold(0, |best, k| if turn(k) < turn(best) { k } else { best });
            let from = match turn(sharpest) > STRAIGHT * doubled {
                true => usize::from(square(1, 3) < (1.0 - AS_LONG) * square(0, 2)),
                false => sharpest,
            };
            let corner = |k: usize| ((from + k) % 4) as u32;
            vec![[corner(0), corner(1), corner(2)], [corner(0), corner(2), corner(3)]]
        }
        _ => triangles_between(&[Ring { points: flat.clone(), part: 0 }]).map_err(|_| FaceError::Crossing)?,
    };
    // If the face crosses itself, there are too many triangles, or some are reversed.
    let turned = |triangle: &[u32; 3]| side(triangle.map(|k| k as usize)) <= 0.0;
    if triangles.len() != n - 2 || triangles.iter().any(turned) {
        return Err(FaceError::Crossing);
    }
    Ok(CutFace { triangles, concave, bent })
}

/// The difference of the highest and the lowest coordinate.
fn range(points: &[[f64; 3]], axis: usize) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for point in points {
        low = if point[axis] < low { point[axis] } else { low };
        high = if point[axis] > high { point[axis] } else { high };
    }
    high - low
}

/// Two directions in the plane with a given normal, counter-clockwise as seen against the normal; exact if the normal is an axis.
fn plane(normal: Point) -> [Point; 2] {
    let least = (1..3).fold(0, |best, axis| if normal[axis].abs() < normal[best].abs() { axis } else { best });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let along = cross(normal, axis);
    let length = norm(along);
    let along = along.map(|x| x / length);
    [along, cross(normal, along)]
}
