//! Plane stress: a law in space with a free stretch of the thickness.

use super::law::Law;
use super::material::Tangent;
use super::points::{MOST_PACKS, PARAMETERS, PackBuffer, Points, read_matrix, write_matrix};
use opruga_core::potential::Definiteness;
use opruga_math::{Lane, Pack, Register, Simd, WIDTH, Work, symmetric};

/// A law in space, for a thin plate: at every point the stretch t of the thickness has the value for which P₃₃ = 0.
///
/// ψ(F) = min over t of ψ₃(diag(F, t)); P is the in-plane part of P₃, and the tangent is condensed: Cᵢⱼₖₗ − Cᵢⱼ₃₃ C₃₃ₖₗ / C₃₃₃₃.
/// If P₃₃ = 0 for no t > 0, energy and stress are NaN, and the step is refused.
#[derive(Debug)]
pub(crate) struct PlaneStress(pub(crate) Box<dyn Law<3>>);

/// The largest number of Newton iterations for the thickness. Five are usual.
const MOST_ITERATIONS: usize = 60;

/// The thickness has converged if its relative change is below this number.
const FOUND: f64 = 1e-12;

/// Buffers for packs of points in space.
struct Space {
    gradient: PackBuffer<{ MOST_PACKS * 9 * WIDTH }>,
    energy: PackBuffer<{ MOST_PACKS * WIDTH }>,
    stress: PackBuffer<{ MOST_PACKS * 9 * WIDTH }>,
    tangent: PackBuffer<{ MOST_PACKS * 81 * WIDTH }>,
    /// 1 while the thickness has not converged.
    open: PackBuffer<{ MOST_PACKS * WIDTH }>,
}

impl PlaneStress {
    /// Finds the thickness at all points. Afterwards, the gradients and stresses in `space` are those for this thickness.
    fn solve(&self, simd: Simd, points: Points<'_>, space: &mut Space) {
        for point in 0..points.count {
            for i in 0..3 {
                for j in 0..3 {
                    let to = &mut space.gradient.0[(point * 9 + i * 3 + j) * WIDTH..][..WIDTH];
                    match (i < 2 && j < 2, i == j) {
                        (true, _) => to.copy_from_slice(&points.gradient[(point * 4 + i * 2 + j) * WIDTH..][..WIDTH]),
                        (false, diagonal) => to.fill(f64::from(u8::from(diagonal))),
                    }
                }
            }
        }
        space.open.0.fill(1.0);
        for _ in 0..MOST_ITERATIONS {
            let now = Points { gradient: &space.gradient.0, ..points };
            self.0.stress(simd, now, &mut space.energy.0, &mut space.stress.0);
            self.0.tangent(simd, now, Definiteness::Exact, &mut space.tangent.0);
            let closed = simd.run(Thin { count: points.count, space, last: false });
            if closed {
                break;
            }
        }
        simd.run(Thin { count: points.count, space, last: true });
        let now = Points { gradient: &space.gradient.0, ..points };
        self.0.stress(simd, now, &mut space.energy.0, &mut space.stress.0);
    }
}

impl Space {
    fn new() -> Space {
        Space {
            gradient: PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]),
            energy: PackBuffer([0.0; MOST_PACKS * WIDTH]),
            stress: PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]),
            tangent: PackBuffer([0.0; MOST_PACKS * 81 * WIDTH]),
            open: PackBuffer([0.0; MOST_PACKS * WIDTH]),
        }
    }
}

impl Law<2> for PlaneStress {
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]) {
        debug_assert!(points.parameters.len() >= points.count * PARAMETERS * WIDTH);
        let mut space = Space::new();
        self.solve(simd, points, &mut space);
        energy[..points.count * WIDTH].copy_from_slice(&space.energy.0[..points.count * WIDTH]);
        for point in 0..points.count {
            for i in 0..2 {
                for j in 0..2 {
                    stress[(point * 4 + i * 2 + j) * WIDTH..][..WIDTH]
                        .copy_from_slice(&space.stress.0[(point * 9 + i * 3 + j) * WIDTH..][..WIDTH]);
                }
            }
        }
    }
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]) {
        let mut space = Space::new();
        self.solve(simd, points, &mut space);
        let now = Points { gradient: &space.gradient.0, ..points };
        self.0.tangent(simd, now, Definiteness::Exact, &mut space.tangent.0);
        simd.run(Condense { count: points.count, keep, space: &space.tangent.0, tangent });
    }
    fn thickness(&self, simd: Simd, points: Points<'_>, out: &mut [f64]) -> bool {
        let mut space = Space::new();
        self.solve(simd, points, &mut space);
        for point in 0..points.count {
            out[point * WIDTH..][..WIDTH].copy_from_slice(&space.gradient.0[(point * 9 + 8) * WIDTH..][..WIDTH]);
        }
        true
    }
    fn turns(&self) -> bool {
        self.0.turns()
    }
    fn cancels(&self) -> bool {
        self.0.cancels()
    }
}

/// Makes one Newton iteration for the thickness. Returns whether all points have converged. In the `last` call, points that have
/// not converged become NaN.
struct Thin<'a> {
    count: usize,
    space: &'a mut Space,
    last: bool,
}
impl Work for Thin<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<P: Pack>(self) -> bool {
        let mut closed = true;
        for point in 0..self.count {
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let state = point * WIDTH + offset;
                let corner = (point * 9 + 8) * WIDTH + offset;
                let t = P::Part::load(&self.space.gradient.0[corner..]);
                let is_open = P::Part::zero().less(P::Part::load(&self.space.open.0[state..]));
                if self.last {
                    let t = P::Part::select(is_open, P::Part::splat(f64::NAN), t);
                    t.store(&mut self.space.gradient.0[corner..]);
                    continue;
                }
                // Newton's method for t P₃₃ = 0 in ln t, which keeps t positive.
                let value = P::Part::load(&self.space.stress.0[corner..]);
                let stiffness = P::Part::load(&self.space.tangent.0[(point * 81 + 80) * WIDTH + offset..]);
                let slope = value + t * stiffness;
                let rising = P::Part::zero().less(slope);
                let newton = -value / P::Part::select(rising, slope, P::Part::one());
                let away = P::Part::select(value.less(P::Part::zero()), P::Part::one(), P::Part::splat(-0.5));
                let change = P::Part::select(rising, newton, away);
                let change = change.larger(P::Part::splat(-0.5)).smaller(P::Part::one());
                P::Part::select(is_open, t + t * change, t).store(&mut self.space.gradient.0[corner..]);
                let still = P::Part::both(is_open, P::Part::splat(FOUND).less(change.abs()));
                P::Part::select(still, P::Part::one(), P::Part::zero()).store(&mut self.space.open.0[state..]);
                closed &= !P::Part::any(still);
            }
        }
        closed
    }
}

/// Condenses tangents in space for zero out-of-plane stress.
struct Condense<'a> {
    count: usize,
    keep: Definiteness,
    space: &'a [f64],
    tangent: &'a mut [f64],
}
impl Work for Condense<'_> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for point in 0..self.count {
            for part in 0..P::PARTS {
                let mut space: Tangent<P::Part, 3> = [[[[P::Part::zero(); 3]; 3]; 3]; 3];
                for i in 0..3 {
                    for j in 0..3 {
                        space[i][j] = read_matrix(&self.space[((point * 3 + i) * 3 + j) * 9 * WIDTH..], part);
                    }
                }
                let inverse = P::Part::one() / space[2][2][2][2];
                let mut square = [[P::Part::zero(); 4]; 4];
                for row in 0..4 {
                    let weight = space[row / 2][row % 2][2][2] * inverse;
                    for column in 0..4 {
                        let (k, l) = (column / 2, column % 2);
                        square[row][column] = space[row / 2][row % 2][k][l] - weight * space[2][2][k][l];
                    }
                }
                if self.keep == Definiteness::Clamped {
                    square = symmetric::positive_part(&square);
                }
                for row in 0..4 {
                    let [a, b, c, d] = square[row];
                    write_matrix(&mut self.tangent[(point * 4 + row) * 4 * WIDTH..], part, &[[a, b], [c, d]]);
                }
            }
        }
    }
}
