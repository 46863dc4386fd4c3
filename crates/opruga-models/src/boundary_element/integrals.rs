//! Integrals of Kelvin's solution over one side: an edge in the plane, a triangle in space.
//!
//! If the source lies on the side, the side is divided into parts with their apex at the source, r = s ρ(t). Then neither U dS
//! nor T (u(y) − u(ξ)) dS depends on s, and the integral over s is computed analytically. The remaining integrand is smooth in
//! the variable τ with dt/ρ = dτ/ℓ. Each piece of length 1 gets 12 points. If the source does not lie on the side, Gauss's rules
//! have as many points as the distance requires. Sides that are nearer than 1.6 times their size (in the plane, their length) are
//! halved in each direction. The total error is below 1e-9 of the integrals. The error is measured by the tractions of a
//! rotation, which should be zero (docs/boundary-elements.md).

use super::kernels::{Block, Kelvin};
use super::quadrature::{Rule, SimplexRule};
use opruga_math::elementary::{exponential, natural_logarithm};

/// ∫ N_k U dS and ∫ N_k T dS for the nodes k of a side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<const D: usize> {
    pub(super) displacement: [Block<D>; D],
    pub(super) traction: [Block<D>; D],
}

impl<const D: usize> Sums<D> {
    const NONE: Self = Sums { displacement: [[[0.0; D]; D]; D], traction: [[[0.0; D]; D]; D] };
}

/// A side: its corners [scaled lengths] and its unit normal, which points out of the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<const D: usize> {
    pub(super) corners: [[f64; D]; D],
    pub(super) normal: [f64; D],
    /// Length or area.
    pub(super) measure: f64,
}

/// A piece of a side: its corners, and the shape functions of the side there.
#[derive(Clone, Copy)]
struct Piece<const D: usize> {
    corners: [[f64; D]; D],
    shape: Block<D>,
    measure: f64,
}

/// Rules for all distances.
#[derive(Clone, Debug)]
pub(super) struct Integrator<const D: usize> {
    pub(super) kelvin: Kelvin,
    /// The rules in the order of descending distance. Each rule comes with the smallest distance at which it is accurate enough,
    /// relative to the size of a piece.
    rules: Vec<(f64, SimplexRule<D>)>,
    along: Rule,
}

/// The largest number of halvings of a side. After that many, the source is as near as rounding permits.
const MOST_HALVINGS: u32 = 40;

fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| a[d] - b[d])
}
fn square<const D: usize>(a: &[f64; D]) -> f64 {
    a.iter().map(|x| x * x).sum()
}
fn mean<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| 0.5 * (a[d] + b[d]))
}

impl<const D: usize> Integrator<D> {
    pub(super) fn new(kelvin: Kelvin) -> Integrator<D> {
        let rules = if D == 2 {
            vec![(4.0, SimplexRule::far()), (1.0, SimplexRule::of(8))]
        } else {
            vec![(12.0, SimplexRule::far()), (4.0, SimplexRule::of(4)), (1.6, SimplexRule::of(6))]
        };
        Integrator { kelvin, rules, along: Rule::of(12) }
    }

    /// Computes the integrals over a side that does not contain the source.
    pub(super) fn regular(&self, source: &[f64; D], side: &Side<D>) -> Sums<D> {
        let mut sums = Sums::NONE;
        self.visit(source, side, &mut |r, shape, weight| {
            let (u, t) = (self.kelvin.displacement(r), self.kelvin.traction(r, &side.normal));
            for k in 0..D {
                let share = weight * shape[k];
                for i in 0..D {
                    for j in 0..D {
                        sums.displacement[k][i][j] += share * u[i][j];
                        sums.traction[k][i][j] += share * t[i][j];
                    }
                }
            }
        });
        sums
    }

    /// Calls `visit` with r = y − ξ, the shape functions and the weight at points y. The points are dense enough for kernels that
    /// are large near the source.
    #[inline(always)]
    pub(super) fn visit(&self, source: &[f64; D], side: &Side<D>, visit: &mut impl FnMut(&[f64; D], &[f64; D], f64)) {
        let mut shape = [[0.0; D]; D];
        for k in 0..D {
            shape[k][k] = 1.0;
        }
        let mut waiting = Vec::new();
        let mut next = Some((Piece { corners: side.corners, shape, measure: side.measure }, 0));
        while let Some((piece, depth)) = next.take().or_else(|| waiting.pop()) {
            let ratio = distance(source, &piece);
            let rule = self.rules.iter().find(|(least, _)| ratio >= *least);
            let rule = rule.or(self.rules.last().filter(|_| depth >= MOST_HALVINGS));
            let Some((_, rule)) = rule else {
                piece.halve(depth + 1, &mut waiting);
                continue;
            };
            for (at, weight) in &rule.points {
                let (mut r, mut shape) = ([0.0; D], [0.0; D]);
                for d in 0..D {
                    for k in 0..D {
                        r[d] += at[k] * piece.corners[k][d];
                        shape[d] += at[k] * piece.shape[k][d];
                    }
                    r[d] -= source[d];
                }
                visit(&r, &shape, weight * piece.measure);
            }
        }
    }

    /// Computes the integrals over the side that contains the source. `shape` contains the shape functions of the side at the
    /// source. The integrals of T contain N_k(y) − N_k(ξ) instead of N_k(y).
    pub(super) fn singular(&self, source: &[f64; D], shape: &[f64; D], side: &Side<D>) -> Sums<D> {
        let mut sums = Sums::NONE;
        for k in 0..D {
            // The part without corner k, and the change of the shape functions along its edges.
            let others: [usize; 2] = [(k + 1) % D, (k + 2) % D];
            let step =
                |a: usize| -> [f64; D] { core::array::from_fn(|m| if m == a { 1.0 - shape[m] } else { -shape[m] }) };
            let reach = |a: usize| minus(&side.corners[a], source);
            // The distance of the source from the edge without k, as a fraction of the height of the side.
            if shape[k] <= 1e-12 {
                continue;
            }
            if D == 2 {
                self.of_segment(&reach(others[0]), shape, &step(others[0]), &side.normal, &mut sums);
            } else {
                let arms = others.map(reach);
                let steps = others.map(step);
                self.of_triangle(&arms, 2.0 * side.measure * shape[k], shape, &steps, &side.normal, &mut sums);
            }
        }
        sums
    }

    /// The integrals over a segment from the source along r, with ∫₀¹ ln s ds = −1 and ∫₀¹ s ln s ds = −¼.
    fn of_segment(&self, r: &[f64; D], shape: &[f64; D], step: &[f64; D], normal: &[f64; D], sums: &mut Sums<D>) {
        let length = square(r).sqrt();
        let [unit, _] = self.kelvin.displacement_factors::<D>();
        let (u, t) = (self.kelvin.displacement(r), self.kelvin.traction(r, normal));
        for k in 0..D {
            for i in 0..D {
                for j in 0..D {
                    let logarithm = if i == j { unit * (shape[k] + 0.25 * step[k]) } else { 0.0 };
                    sums.displacement[k][i][j] += length * ((shape[k] + 0.5 * step[k]) * u[i][j] + logarithm);
                    sums.traction[k][i][j] += length * step[k] * t[i][j];
                }
            }
        }
    }

    /// The integrals over the triangle that the source and two arms span. `twice` is double the area of the triangle.
    fn of_triangle(
        &self,
        arms: &[[f64; D]; 2],
        twice: f64,
        shape: &[f64; D],
        steps: &[[f64; D]; 2],
        normal: &[f64; D],
        sums: &mut Sums<D>,
    ) {
        let base = minus(&arms[1], &arms[0]);
        let length = square(&base).sqrt();
        let height = twice / length;
        // Along the base from the foot of the source: x = h sinh τ, ρ = h cosh τ.
        let first = (0..D).map(|d| arms[0][d] * base[d]).sum::<f64>() / length;
        let (from, to) = (inverse_sinh(first / height), inverse_sinh((first + length) / height));
        let pieces = (to - from).ceil();
        let pieces = if pieces >= 1.0 { pieces as usize } else { 1 };
        let width = (to - from) / pieces as f64;
        for piece in 0..pieces {
            for (point, weight) in self.along.points.iter().zip(&self.along.weights) {
                let tau = from + (piece as f64 + point) * width;
                let grown = exponential(tau);
                let (sinh, cosh) = (0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown));
                let t = (height * sinh - first) / length;
                let r: [f64; D] = core::array::from_fn(|d| arms[0][d] + t * base[d]);
                let weight = twice * weight * width * height * cosh / length;
                let (u, traction) = (self.kelvin.displacement(&r), self.kelvin.traction(&r, normal));
                for k in 0..D {
                    let step = (1.0 - t) * steps[0][k] + t * steps[1][k];
                    for i in 0..D {
                        for j in 0..D {
                            sums.displacement[k][i][j] += weight * (shape[k] + 0.5 * step) * u[i][j];
                            sums.traction[k][i][j] += weight * step * traction[i][j];
                        }
                    }
                }
            }
        }
    }
}

/// A lower bound on the distance of a source from a piece, relative to the size of the piece.
fn distance<const D: usize>(source: &[f64; D], piece: &Piece<D>) -> f64 {
    let center: [f64; D] =
        core::array::from_fn(|d| piece.corners.iter().map(|corner| corner[d]).sum::<f64>() / D as f64);
    let (mut size, mut radius) = (0.0, 0.0);
    for k in 0..D {
        let edge = square(&minus(&piece.corners[k], &piece.corners[(k + 1) % D]));
        size = if edge > size { edge } else { size };
        let reach = square(&minus(&piece.corners[k], &center));
        radius = if reach > radius { reach } else { radius };
    }
    (square(&minus(source, &center)).sqrt() - radius.sqrt()) / size.sqrt()
}

impl<const D: usize> Piece<D> {
    /// Divides an edge into two halves, or a triangle into four quarters.
    fn halve(&self, depth: u32, out: &mut Vec<(Piece<D>, u32)>) {
        let (x, n) = (&self.corners, &self.shape);
        let middle = |a: usize, b: usize| (mean(&x[a], &x[b]), mean(&n[a], &n[b]));
        let corner = |a: usize| (x[a], n[a]);
        let mut push = |corners: [([f64; D], [f64; D]); D], part: f64| {
            let [corners, shape] = [corners.map(|corner| corner.0), corners.map(|corner| corner.1)];
            out.push((Piece { corners, shape, measure: part * self.measure }, depth));
        };
        if D == 2 {
            for a in 0..2 {
                let mut pair = [middle(0, 1); D];
                pair[a] = corner(a);
                push(pair, 0.5);
            }
            return;
        }
        let middles = [middle(0, 1), middle(1, 2), middle(2, 0)];
        for a in 0..3 {
            let mut three = [corner(a); D];
            (three[1], three[2]) = (middles[a], middles[(a + 2) % 3]);
            push(three, 0.25);
        }
        push(core::array::from_fn(|k| middles[k]), 0.25);
    }
}

/// arsinh x.
fn inverse_sinh(x: f64) -> f64 {
    let size = x.abs();
    let value = natural_logarithm(size + (size * size + 1.0).sqrt());
    if x < 0.0 { -value } else { value }
}
