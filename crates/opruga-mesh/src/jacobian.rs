//! The minimum of det ∂x/∂ξ over a whole cell.
//!
//! The determinant of the map of a cell is a polynomial in its reference coordinates ξ. In the Bernstein basis, this polynomial has these
//! coefficients:
//!
//! | cell | degree | coefficients |
//! |---|---|---|
//! | triangle, tetrahedron | 0 | 1 |
//! | quadrilateral | 1 along each axis | 4 |
//! | quadratic triangle | 2 | 6 |
//! | quadratic tetrahedron | 3 | 20 |
//! | hexahedron | 2 along each axis | 27 |
//!
//! The values of the determinant are between the smallest and the largest coefficient, and the values at the vertices are coefficients. If all
//! coefficients are positive, the cell is nowhere inverted. A negative value proves that the cell is inverted somewhere. Otherwise the cell is
//! bisected (de Casteljau), which brings the coefficients closer to the values: the gap between them falls with the square of the size. A piece
//! without negative coefficients needs no further bisection. After [`MOST_PIECES`] pieces the bisection ends, and the minimum is known to lie between
//! two bounds.
//!
//! # Source
//! A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite elements", Journal of Computational Physics 233 (2013).

use crate::quadratic::{TETRAHEDRON_EDGES, TRIANGLE_SIDES};
use std::collections::VecDeque;

/// The maximum number of pieces of a cell that are examined. A quadratic cell that is nearly degenerate over a tenth of its size at one corner needs
/// about ten pieces. If a cell needs more than the maximum, its smallest determinant differs from zero by at most about a thousandth of its largest
/// one.
const MOST_PIECES: usize = 512;

/// The error of a coefficient, in units of the rounding error of a position times the derivative by that position. A coefficient is a sum of about
/// ten products.
const ROUNDINGS: f64 = 16.0;

/// The minimum of det ∂x/∂ξ over a cell [m², m³]. This is twice the area of a straight triangle, six times the volume of a straight tetrahedron, or
/// the area or volume of a straight box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastJacobian {
    /// A lower bound on the minimum.
    pub bound: f64,
    /// The smallest value found.
    pub found: f64,
    /// The position of that value: barycentric coordinates for triangles and tetrahedra, coordinates from 0 to 1 along the axes for boxes.
    pub at: [f64; 4],
    /// The error due to rounding of the positions. At a corner whose neighbours all lie on one obstacle, the value consists only of rounding errors.
    pub rounding: f64,
}

impl LeastJacobian {
    /// Whether the cell certainly has a positive Jacobian everywhere.
    pub fn is_positive(&self) -> bool {
        self.bound > self.rounding
    }
    /// Whether the cell is certainly nowhere inverted; it may be degenerate at a point.
    pub fn is_upright(&self) -> bool {
        self.bound >= -self.rounding
    }
    /// Whether the cell is certainly inverted somewhere; NaN counts as inverted.
    pub fn is_inverted(&self) -> bool {
        // This form treats NaN as inverted.
        let upright = self.found >= -self.rounding;
        !upright
    }
}

/// The minimum of det ∂x/∂ξ over a cell with these nodes, numbered as in [`crate::Cells`]; none for elements without such a determinant.
pub fn least_jacobian<const D: usize>(nodes: &[[f64; D]]) -> Option<LeastJacobian> {
    let whole = Net::of(nodes)?;
    let scale = whole.coefficients.iter().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
    let size = if D == 2 { scale.sqrt() } else { libm::cbrt(scale) };
    let farthest = nodes.iter().flatten().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
    let rounding = ROUNDINGS * f64::EPSILON * scale * (1.0 + if size > 0.0 { farthest / size } else { 0.0 });
    let mut least = LeastJacobian { bound: f64::INFINITY, found: f64::INFINITY, at: [0.0; 4], rounding };
    least.bound = whole.least();
    if least.is_upright() {
        whole.vertices().into_iter().for_each(|(value, at)| least.see(value, at));
        return Some(least);
    }
    // The values at midpoints of edges are not coefficients; most folded cells are folded there or at a vertex.
    for at in whole.samples() {
        least.see(whole.value(at), at);
    }
    if least.is_inverted() {
        return Some(least);
    }
    least.bound = f64::INFINITY;
    let mut pieces = VecDeque::from([whole]);
    let mut looked_at = 0;
    while let Some(piece) = pieces.pop_front() {
        for half in piece.halves() {
            looked_at += 1;
            for (value, at) in half.vertices() {
                least.see(value, at);
            }
            let bound = half.least();
            if bound >= -rounding {
                least.bound = if bound < least.bound { bound } else { least.bound };
            } else {
                pieces.push_back(half);
            }
        }
        if least.is_inverted() || looked_at >= MOST_PIECES {
            break;
        }
    }
    for piece in pieces {
        let bound = piece.least();
        least.bound = if bound < least.bound { bound } else { least.bound };
    }
    Some(least)
}

/// The determinant det ∂x/∂ξ of a cell [m², m³] at a point, which is given in the coordinates of [`LeastJacobian::at`].
pub fn jacobian_at<const D: usize>(nodes: &[[f64; D]], at: [f64; 4]) -> Option<f64> {
    Some(Net::of(nodes)?.value(at))
}

impl LeastJacobian {
    /// Records a value; NaN is kept.
    fn see(&mut self, value: f64, at: [f64; 4]) {
        if value < self.found || value.is_nan() {
            (self.found, self.at) = (value, at);
        }
    }
}

/// A polynomial over a piece of a cell, given by its coefficients in the Bernstein basis.
#[derive(Clone, Debug)]
struct Net {
    basis: Basis,
    coefficients: Vec<f64>,
    /// The corners of the piece in coordinates of the cell: all corners of a simplex, or the lowest and the highest corner of a
    /// box.
    corners: Vec<[f64; 4]>,
}

/// The coefficients and their order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Basis {
    /// For a simplex: the indices, one for each corner, which add up to the degree, in the order of [`indices`].
    Simplex { corners: usize, degree: usize },
    /// For a box: the first axis varies fastest.
    Box { axes: usize, degree: usize },
}

/// The indices of the coefficients of a simplex.
fn indices(corners: usize, degree: usize) -> Vec<[usize; 4]> {
    let mut out = Vec::new();
    for a in 0..=degree {
        for b in 0..=degree - a {
            let c_most = if corners == 4 { degree - a - b } else { 0 };
            for c in 0..=c_most {
                let rest = degree - a - b - c;
                out.push(if corners == 4 { [rest, a, b, c] } else { [rest, a, b, 0] });
            }
        }
    }
    out
}

/// The position of a coefficient of a simplex in the order of [`indices`], by the indices of the corners after the first.
#[derive(Clone, Copy, Debug)]
struct Order([u8; 64]);

impl Order {
    fn of(list: &[[usize; 4]]) -> Order {
        let mut order = Order([0; 64]);
        for (at, index) in list.iter().enumerate() {
            order.0[index[1] + 4 * index[2] + 16 * index[3]] = at as u8;
        }
        order
    }
    fn rank(&self, index: [usize; 4]) -> usize {
        usize::from(self.0[index[1] + 4 * index[2] + 16 * index[3]])
    }
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// The binomial coefficient n over k.
fn binomial(n: usize, k: usize) -> f64 {
    factorial(n) / (factorial(k) * factorial(n - k))
}

/// x to a small integer power.
fn power(x: f64, n: usize) -> f64 {
    (0..n).map(|_| x).product()
}

fn determinant<const D: usize>(columns: &[[f64; D]]) -> f64 {
    match columns {
        [a, b] => a[0] * b[1] - a[1] * b[0],
        [a, b, c] => {
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        }
        _ => f64::NAN,
    }
}

fn less<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| a[d] - b[d])
}

impl Net {
    /// The determinant det ∂x/∂ξ over a whole cell.
    fn of<const D: usize>(nodes: &[[f64; D]]) -> Option<Net> {
        match (D, nodes.len()) {
            (2, 3) | (3, 4) => Some(Net::constant(nodes)),
            (2, 6) => Some(Net::quadratic(nodes, &TRIANGLE_SIDES)),
            (3, 10) => Some(Net::quadratic(nodes, &TETRAHEDRON_EDGES)),
            (2, 4) => Some(Net::quadrilateral(nodes)),
            (3, 8) => Some(Net::hexahedron(nodes)),
            _ => None,
        }
    }

    fn simplex(corners: usize, degree: usize, coefficients: Vec<f64>) -> Net {
        let unit = |k: usize| core::array::from_fn(|l| if k == l { 1.0 } else { 0.0 });
        Net { basis: Basis::Simplex { corners, degree }, coefficients, corners: (0..corners).map(unit).collect() }
    }

    fn constant<const D: usize>(nodes: &[[f64; D]]) -> Net {
        let sides: Vec<[f64; D]> = nodes[1..].iter().map(|x| less(x, &nodes[0])).collect();
        Net::simplex(D + 1, 0, vec![determinant(&sides)])
    }

    /// The determinant of a quadratic simplex. Each ∂x/∂ξₖ is linear. The index of a coefficient of a product of D linear functions names D corners.
    /// These corners are assigned to the factors in every possible way, and the coefficient is the mean of the products of the factors at their
    /// corners.
    fn quadratic<const D: usize, const E: usize>(nodes: &[[f64; D]], edges: &[[usize; 2]; E]) -> Net {
        let corners = D + 1;
        // ∂x/∂λᵢ at corner c: (4 δ − 1) xᵢ + 4 xᵢ꜀.
        let slope = |i: usize, c: usize| -> [f64; D] {
            let own = if i == c { 3.0 } else { -1.0 };
            let mut out: [f64; D] = nodes[i].map(|x| own * x);
            if let Some(edge) = edges.iter().position(|edge| i != c && edge.contains(&i) && edge.contains(&c)) {
                (0..D).for_each(|d| out[d] += 4.0 * nodes[corners + edge][d]);
            }
            out
        };
        let side: Vec<Vec<[f64; D]>> =
            (1..corners).map(|k| (0..corners).map(|c| less(&slope(k, c), &slope(0, c))).collect()).collect();
        let list = indices(corners, D);
        let order = Order::of(&list);
        let (mut coefficients, mut counts) = (vec![0.0; list.len()], vec![0.0; list.len()]);
        for assignment in 0..corners.pow(D as u32) {
            let mut index = [0; 4];
            let mut rest = assignment;
            let columns: [[f64; D]; D] = core::array::from_fn(|k| {
                let corner = rest % corners;
                rest /= corners;
                index[corner] += 1;
                side[k][corner]
            });
            let at = order.rank(index);
            coefficients[at] += determinant(&columns);
            counts[at] += 1.0;
        }
        coefficients.iter_mut().zip(&counts).for_each(|(c, count)| *c /= count);
        Net::simplex(corners, D, coefficients)
    }

    fn boxed(axes: usize, degree: usize, coefficients: Vec<f64>) -> Net {
        Net { basis: Basis::Box { axes, degree }, coefficients, corners: vec![[0.0; 4], [1.0; 4]] }
    }

    /// The determinant of a quadrilateral. The coefficients are the values at the corners, because det ∂x/∂ξ is bilinear.
    fn quadrilateral<const D: usize>(nodes: &[[f64; D]]) -> Net {
        // The first axis runs from corner 0 to 1 below and 3 to 2 above, the second from 0 to 3 and 1 to 2.
        let first = [less(&nodes[1], &nodes[0]), less(&nodes[2], &nodes[3])];
        let second = [less(&nodes[3], &nodes[0]), less(&nodes[2], &nodes[1])];
        let at = |x: usize, y: usize| determinant(&[first[y], second[x]]);
        Net::boxed(2, 1, vec![at(0, 0), at(1, 0), at(0, 1), at(1, 1)])
    }

    /// The determinant of a hexahedron. Each ∂x/∂ξₖ is bilinear in the other two coordinates, so two of the three columns depend on each coordinate.
    /// A coefficient is therefore bᵢ = Σ det / Π (2 over i), summed over all ways to distribute its index along each axis over these two columns.
    fn hexahedron<const D: usize>(nodes: &[[f64; D]]) -> Net {
        let corner = |x: usize, y: usize, z: usize| &nodes[[0, 1, 3, 2][x + 2 * y] + 4 * z];
        let mut coefficients = vec![0.0; 27];
        for assignment in 0..64_usize {
            let bit = |k: usize| assignment >> k & 1;
            let (y1, z1, x2, z2, x3, y3) = (bit(0), bit(1), bit(2), bit(3), bit(4), bit(5));
            let columns = [
                less(corner(1, y1, z1), corner(0, y1, z1)),
                less(corner(x2, 1, z2), corner(x2, 0, z2)),
                less(corner(x3, y3, 1), corner(x3, y3, 0)),
            ];
            let (i, j, k) = (x2 + x3, y1 + y3, z1 + z2);
            let share = binomial(2, i) * binomial(2, j) * binomial(2, k);
            coefficients[i + 3 * j + 9 * k] += determinant(&columns) / share;
        }
        Net::boxed(3, 2, coefficients)
    }

    /// The smallest coefficient; NaN is kept.
    fn least(&self) -> f64 {
        self.coefficients.iter().fold(f64::INFINITY, |least, c| if *c < least || c.is_nan() { *c } else { least })
    }

    /// Vertices and midpoints of edges of a whole cell.
    fn samples(&self) -> Vec<[f64; 4]> {
        let middle = |a: &[f64; 4], b: &[f64; 4]| core::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        match self.basis {
            Basis::Simplex { degree: 0, .. } => vec![self.corners[0]],
            Basis::Simplex { corners, .. } => {
                let mut out = self.corners.clone();
                for b in 0..corners {
                    out.extend((0..b).map(|a| middle(&self.corners[a], &self.corners[b])));
                }
                out
            }
            Basis::Box { axes, .. } => {
                // At most one coordinate is at a midpoint.
                let all = (0..3_usize.pow(axes as u32)).map(|code| -> [f64; 4] {
                    core::array::from_fn(
                        |d| if d < axes { 0.5 * (code / 3_usize.pow(d as u32) % 3) as f64 } else { 0.0 },
                    )
                });
                all.filter(|at| at.iter().filter(|x| **x == 0.5).count() <= 1).collect()
            }
        }
    }

    /// The value at a point of the cell. The net must be that of a whole cell.
    fn value(&self, at: [f64; 4]) -> f64 {
        match self.basis {
            Basis::Simplex { corners, degree } => {
                let term = |(index, c): (&[usize; 4], &f64)| {
                    let weights = (0..corners).map(|k| power(at[k], index[k]) / factorial(index[k]));
                    factorial(degree) * weights.product::<f64>() * c
                };
                indices(corners, degree).iter().zip(&self.coefficients).map(term).sum()
            }
            Basis::Box { axes, degree } => {
                let mut sum = 0.0;
                for (k, c) in self.coefficients.iter().enumerate() {
                    let mut weight = 1.0;
                    for (d, x) in at.iter().enumerate().take(axes) {
                        let i = k / (degree + 1).pow(d as u32) % (degree + 1);
                        weight *= binomial(degree, i) * power(*x, i) * power(1.0 - x, degree - i);
                    }
                    sum += weight * c;
                }
                sum
            }
        }
    }

    /// The values at the vertices of a piece, which are coefficients, and the positions of these vertices.
    fn vertices(&self) -> Vec<(f64, [f64; 4])> {
        match self.basis {
            Basis::Simplex { corners, degree } => {
                let order = Order::of(&indices(corners, degree));
                let index = |k: usize| core::array::from_fn(|l| if k == l { degree } else { 0 });
                (0..corners).map(|k| (self.coefficients[order.rank(index(k))], self.corners[k])).collect()
            }
            Basis::Box { axes, degree } => {
                let vertex = |code: usize| {
                    let high = |d: usize| code >> d & 1;
                    let k: usize = (0..axes).map(|d| high(d) * degree * (degree + 1).pow(d as u32)).sum();
                    let at = core::array::from_fn(|d| if d < axes { self.corners[high(d)][d] } else { 0.0 });
                    (self.coefficients[k], at)
                };
                (0..1 << axes).map(vertex).collect()
            }
        }
    }

    /// The two halves of a piece, cut across its longest edge in the reference cell.
    fn halves(&self) -> [Net; 2] {
        match self.basis {
            Basis::Simplex { corners, degree } => {
                let square = |a: usize, b: usize| -> f64 {
                    (0..4).map(|k| self.corners[a][k] - self.corners[b][k]).map(|x| x * x).sum()
                };
                let (mut a, mut b) = (0, 1);
                for q in 0..corners {
                    for p in 0..q {
                        if square(p, q) > square(a, b) {
                            (a, b) = (p, q);
                        }
                    }
                }
                let list = indices(corners, degree);
                let order = Order::of(&list);
                let (mut first, mut second) = (self.clone(), self.clone());
                // Rows of coefficients along the edge, with the other indices fixed.
                for start in list.iter().filter(|index| index[b] == 0) {
                    let steps = start[a];
                    let at = |k: usize| {
                        let mut index = *start;
                        (index[a], index[b]) = (steps - k, k);
                        order.rank(index)
                    };
                    let row: Vec<f64> = (0..=steps).map(|k| self.coefficients[at(k)]).collect();
                    let (low, high) = split(&row);
                    for k in 0..=steps {
                        first.coefficients[at(k)] = low[k];
                        second.coefficients[at(k)] = high[k];
                    }
                }
                let middle = core::array::from_fn(|k| 0.5 * (self.corners[a][k] + self.corners[b][k]));
                first.corners[b] = middle;
                second.corners[a] = middle;
                [first, second]
            }
            Basis::Box { axes, degree } => {
                let length = |d: usize| self.corners[1][d] - self.corners[0][d];
                let axis = (1..axes).fold(0, |best, d| if length(d) > length(best) { d } else { best });
                let step = (degree + 1).pow(axis as u32);
                let (mut first, mut second) = (self.clone(), self.clone());
                for start in (0..self.coefficients.len()).filter(|k| k / step % (degree + 1) == 0) {
                    let row: Vec<f64> = (0..=degree).map(|k| self.coefficients[start + k * step]).collect();
                    let (low, high) = split(&row);
                    for k in 0..=degree {
                        first.coefficients[start + k * step] = low[k];
                        second.coefficients[start + k * step] = high[k];
                    }
                }
                let middle = 0.5 * (self.corners[0][axis] + self.corners[1][axis]);
                first.corners[1][axis] = middle;
                second.corners[0][axis] = middle;
                [first, second]
            }
        }
    }
}

/// The coefficients of both halves of a polynomial of one variable (de Casteljau).
fn split(row: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut now = row.to_vec();
    let (mut low, mut high) = (vec![now[0]], vec![now[row.len() - 1]]);
    while now.len() > 1 {
        now = now.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        low.push(now[0]);
        high.push(now[now.len() - 1]);
    }
    high.reverse();
    (low, high)
}

#[cfg(test)]
mod tests;
