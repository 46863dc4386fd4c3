//! Differences in the cells of a grid: Green's strain of its edges and faces.
//!
//! Strains along an axis are defined on edges, and shear strains are defined at the centres of faces. Where the law multiplies
//! the strains of two axes, the means of these strains over the cell are used. Every edge and every face has its own energy, so
//! no checkerboard of displacements has zero energy.

use opruga_core::stencil::Kernel;
use opruga_math::Lane;

/// A quadrilateral cell of a body in the plane or of a surface in space. Its parameters are c₁ A, c₂ A, c₃ A [N·m], 1/h₁², 1/h₂²,
/// 1/(h₁ h₂) [1/m²] and the retardation time τ [s].
///
/// ```text
///   3 ──── 2     ε₁₁ = ½ (|Δ₁x|²/h₁² − 1) on the edges 0–1 and 3–2, ε₂₂ likewise on 0–3 and 1–2
///   │      │     ε₁₂ = ½ x₁·x₂ in the middle, where x₁ and x₂ are the means of Δ₁x/h₁ and Δ₂x/h₂
///   0 ──── 1
/// ```
/// U = ½ A [c₁ (mean ε₁₁² + mean ε₂₂²) + 2 c₂ (mean ε₁₁)(mean ε₂₂) + c₃ ε₁₂²].
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadrilateral;

/// The difference of two nodes.
#[inline(always)]
fn difference<S: Lane, const D: usize>(from: &[S; D], to: &[S; D]) -> [S; D] {
    opruga_math::lanes!(S, d => to[d] - from[d])
}
#[inline(always)]
fn product<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> S {
    let mut sum = a[0] * b[0];
    for d in 1..D {
        sum += a[d] * b[d];
    }
    sum
}
#[inline(always)]
fn sum<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> [S; D] {
    opruga_math::lanes!(S, d => a[d] + b[d])
}
#[inline(always)]
fn times<S: Lane, const D: usize>(a: &[S; D], s: S) -> [S; D] {
    opruga_math::lanes!(S, d => a[d] * s)
}
/// Adds a force on the difference of two nodes.
#[inline(always)]
fn add<S: Lane, const D: usize, const N: usize>(out: &mut [[S; D]; N], from: usize, to: usize, value: &[S; D]) {
    for d in 0..D {
        out[from][d] -= value[d];
        out[to][d] += value[d];
    }
}

/// The edges of a quadrilateral, two along each axis.
const SIDES: [[[usize; 2]; 2]; 2] = [[[0, 1], [3, 2]], [[0, 3], [1, 2]]];

/// The edges, their strains and the shear of a quadrilateral.
struct Strained<S, const D: usize> {
    edges: [[[S; D]; 2]; 2],
    along: [[S; 2]; 2],
    shear: S,
}

impl Quadrilateral {
    #[inline(always)]
    fn edges<S: Lane, const D: usize>(x: &[[S; D]; 4]) -> [[[S; D]; 2]; 2] {
        let mut edges = [[[S::zero(); D]; 2]; 2];
        for axis in 0..2 {
            for k in 0..2 {
                let [from, to] = SIDES[axis][k];
                edges[axis][k] = difference(&x[from], &x[to]);
            }
        }
        edges
    }
    #[inline(always)]
    fn strained<S: Lane, const D: usize>(p: &[S; 7], x: &[[S; D]; 4]) -> Strained<S, D> {
        let edges = Quadrilateral::edges(x);
        let mut along = [[S::zero(); 2]; 2];
        for axis in 0..2 {
            for k in 0..2 {
                let square = product(&edges[axis][k], &edges[axis][k]);
                along[axis][k] = S::splat(0.5) * (square * p[3 + axis] - S::one());
            }
        }
        let [first, second] = [sum(&edges[0][0], &edges[0][1]), sum(&edges[1][0], &edges[1][1])];
        Strained { edges, along, shear: S::splat(0.125) * product(&first, &second) * p[5] }
    }
    /// Stresses times area, for the edges and for the shear.
    #[inline(always)]
    fn stresses<S: Lane>(p: &[S; 7], along: &[[S; 2]; 2], shear: S) -> ([[S; 2]; 2], S) {
        let half = S::splat(0.5);
        let mean = [half * (along[0][0] + along[0][1]), half * (along[1][0] + along[1][1])];
        let mut out = [[S::zero(); 2]; 2];
        for axis in 0..2 {
            for k in 0..2 {
                out[axis][k] = half * (p[0] * along[axis][k] + p[1] * mean[1 - axis]);
            }
        }
        (out, p[2] * shear)
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(
        p: &[S; 7],
        edges: &[[[S; D]; 2]; 2],
        (along, shear): &([[S; 2]; 2], S),
    ) -> [[S; D]; 4] {
        let mut out = [[S::zero(); D]; 4];
        let means = [sum(&edges[0][0], &edges[0][1]), sum(&edges[1][0], &edges[1][1])];
        let of_shear = S::splat(0.125) * *shear * p[5];
        for axis in 0..2 {
            for k in 0..2 {
                let [from, to] = SIDES[axis][k];
                let own = times(&edges[axis][k], along[axis][k] * p[3 + axis]);
                add(&mut out, from, to, &sum(&own, &times(&means[1 - axis], of_shear)));
            }
        }
        out
    }
}

impl<const D: usize> Kernel<D, 4, 7> for Quadrilateral {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 7], x: &[[S; D]; 4]) -> S {
        let strained = Quadrilateral::strained(p, x);
        let (along, shear) = Quadrilateral::stresses(p, &strained.along, strained.shear);
        let mut twice = shear * strained.shear;
        for axis in 0..2 {
            for k in 0..2 {
                twice += along[axis][k] * strained.along[axis][k];
            }
        }
        S::splat(0.5) * twice
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 7], x: &[[S; D]; 4]) -> [[S; D]; 4] {
        let strained = Quadrilateral::strained(p, x);
        let stresses = Quadrilateral::stresses(p, &strained.along, strained.shear);
        Quadrilateral::spread(p, &strained.edges, &stresses)
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 7], x: &[[S; D]; 4], v: &[[S; D]; 4]) -> ([[S; D]; 4], S) {
        let (edges, rates) = (Quadrilateral::edges(x), Quadrilateral::edges(v));
        let mut along = [[S::zero(); 2]; 2];
        for axis in 0..2 {
            for k in 0..2 {
                along[axis][k] = product(&edges[axis][k], &rates[axis][k]) * p[3 + axis];
            }
        }
        let [x1, x2] = [sum(&edges[0][0], &edges[0][1]), sum(&edges[1][0], &edges[1][1])];
        let [v1, v2] = [sum(&rates[0][0], &rates[0][1]), sum(&rates[1][0], &rates[1][1])];
        let shear = S::splat(0.125) * (product(&x1, &v2) + product(&v1, &x2)) * p[5];
        let (mut stress, mut of_shear) = Quadrilateral::stresses(p, &along, shear);
        let minus = -p[6];
        let mut power = of_shear * shear;
        of_shear = of_shear * minus;
        for axis in 0..2 {
            for k in 0..2 {
                power += stress[axis][k] * along[axis][k];
                stress[axis][k] = stress[axis][k] * minus;
            }
        }
        (Quadrilateral::spread(p, &edges, &(stress, of_shear)), p[6] * power)
    }
}

/// A hexahedral cell. Its parameters are c₁ V, c₂ V, c₃ V [N·m], 1/h² of the three axes [1/m²] and the retardation time τ [s].
///
/// The strains of an axis are defined on its four edges, and the shear of two axes is defined on two opposite faces. U = ½ V [c₁
/// Σ mean εᵢᵢ² + 2 c₂ Σ (mean εᵢᵢ)(mean εⱼⱼ) + c₃ Σ mean εᵢⱼ²], sums over i and over i < j.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hexahedron;

/// The edges of a hexahedron, four along each axis. Corners are numbered as in [`opruga_mesh::Cells`].
const EDGES: [[[usize; 2]; 4]; 3] =
    [[[0, 1], [3, 2], [4, 5], [7, 6]], [[0, 3], [1, 2], [4, 7], [5, 6]], [[0, 4], [1, 5], [3, 7], [2, 6]]];

/// The two edges of a face along each of its two axes, by their index in [`EDGES`].
type Face = [[usize; 2]; 2];

/// Both opposite faces for each pair of axes (0, 1), (0, 2), (1, 2).
const FACES: [([usize; 2], [Face; 2]); 3] = [
    ([0, 1], [[[0, 1], [0, 1]], [[2, 3], [2, 3]]]),
    ([0, 2], [[[0, 2], [0, 1]], [[1, 3], [2, 3]]]),
    ([1, 2], [[[0, 2], [0, 2]], [[1, 3], [1, 3]]]),
];

type Edges<S, const D: usize> = [[[S; D]; 4]; 3];

/// Strains or stresses of a hexahedron: on its edges and on its faces.
struct Tensor<S> {
    along: [[S; 4]; 3],
    shear: [[S; 2]; 3],
}

impl Hexahedron {
    #[inline(always)]
    fn edges<S: Lane, const D: usize>(x: &[[S; D]; 8]) -> Edges<S, D> {
        let mut edges = [[[S::zero(); D]; 4]; 3];
        for axis in 0..3 {
            for k in 0..4 {
                let [from, to] = EDGES[axis][k];
                edges[axis][k] = difference(&x[from], &x[to]);
            }
        }
        edges
    }
    /// 1/(hᵢ hⱼ).
    #[inline(always)]
    fn across<S: Lane>(p: &[S; 10], pair: usize) -> S {
        p[6 + pair]
    }
    #[inline(always)]
    fn strains<S: Lane, const D: usize>(p: &[S; 10], edges: &Edges<S, D>) -> Tensor<S> {
        let mut out = Tensor { along: [[S::zero(); 4]; 3], shear: [[S::zero(); 2]; 3] };
        for axis in 0..3 {
            for k in 0..4 {
                let square = product(&edges[axis][k], &edges[axis][k]);
                out.along[axis][k] = S::splat(0.5) * (square * p[3 + axis] - S::one());
            }
        }
        for pair in 0..3 {
            let ([i, j], faces) = FACES[pair];
            for face in 0..2 {
                let [a, b] = faces[face];
                let first = sum(&edges[i][a[0]], &edges[i][a[1]]);
                let second = sum(&edges[j][b[0]], &edges[j][b[1]]);
                out.shear[pair][face] = S::splat(0.125) * product(&first, &second) * Hexahedron::across(p, pair);
            }
        }
        out
    }
    /// Stresses times volume, from strains or from their rates.
    #[inline(always)]
    fn stresses<S: Lane>(p: &[S; 10], strain: &Tensor<S>) -> Tensor<S> {
        let mut mean = [S::zero(); 3];
        for axis in 0..3 {
            let [a, b, c, d] = strain.along[axis];
            mean[axis] = S::splat(0.25) * ((a + b) + (c + d));
        }
        let all = mean[0] + mean[1] + mean[2];
        let mut out = Tensor { along: [[S::zero(); 4]; 3], shear: [[S::zero(); 2]; 3] };
        for axis in 0..3 {
            for k in 0..4 {
                let own = p[0] * strain.along[axis][k] + p[1] * (all - mean[axis]);
                out.along[axis][k] = S::splat(0.25) * own;
            }
        }
        for pair in 0..3 {
            for face in 0..2 {
                out.shear[pair][face] = S::splat(0.5) * p[2] * strain.shear[pair][face];
            }
        }
        out
    }
    #[inline(always)]
    fn contracted<S: Lane>(a: &Tensor<S>, b: &Tensor<S>) -> S {
        let mut sum = S::zero();
        for axis in 0..3 {
            for k in 0..4 {
                sum += a.along[axis][k] * b.along[axis][k];
            }
            for face in 0..2 {
                sum += a.shear[axis][face] * b.shear[axis][face];
            }
        }
        sum
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(p: &[S; 10], edges: &Edges<S, D>, stress: &Tensor<S>) -> [[S; D]; 8] {
        // Forces on edges first.
        let mut pull = [[[S::zero(); D]; 4]; 3];
        for axis in 0..3 {
            for k in 0..4 {
                pull[axis][k] = times(&edges[axis][k], stress.along[axis][k] * p[3 + axis]);
            }
        }
        for pair in 0..3 {
            let ([i, j], faces) = FACES[pair];
            for face in 0..2 {
                let [a, b] = faces[face];
                let scale = S::splat(0.125) * stress.shear[pair][face] * Hexahedron::across(p, pair);
                let first = times(&sum(&edges[i][a[0]], &edges[i][a[1]]), scale);
                let second = times(&sum(&edges[j][b[0]], &edges[j][b[1]]), scale);
                for k in 0..2 {
                    pull[i][a[k]] = sum(&pull[i][a[k]], &second);
                    pull[j][b[k]] = sum(&pull[j][b[k]], &first);
                }
            }
        }
        let mut out = [[S::zero(); D]; 8];
        for axis in 0..3 {
            for k in 0..4 {
                let [from, to] = EDGES[axis][k];
                add(&mut out, from, to, &pull[axis][k]);
            }
        }
        out
    }
}

impl<const D: usize> Kernel<D, 8, 10> for Hexahedron {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 10], x: &[[S; D]; 8]) -> S {
        let strain = Hexahedron::strains(p, &Hexahedron::edges(x));
        S::splat(0.5) * Hexahedron::contracted(&Hexahedron::stresses(p, &strain), &strain)
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 10], x: &[[S; D]; 8]) -> [[S; D]; 8] {
        let edges = Hexahedron::edges(x);
        let stress = Hexahedron::stresses(p, &Hexahedron::strains(p, &edges));
        Hexahedron::spread(p, &edges, &stress)
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 10], x: &[[S; D]; 8], v: &[[S; D]; 8]) -> ([[S; D]; 8], S) {
        let (edges, rates) = (Hexahedron::edges(x), Hexahedron::edges(v));
        let mut rate = Tensor { along: [[S::zero(); 4]; 3], shear: [[S::zero(); 2]; 3] };
        for axis in 0..3 {
            for k in 0..4 {
                rate.along[axis][k] = product(&edges[axis][k], &rates[axis][k]) * p[3 + axis];
            }
        }
        for pair in 0..3 {
            let ([i, j], faces) = FACES[pair];
            for face in 0..2 {
                let [a, b] = faces[face];
                let [x1, v1] = [&edges, &rates].map(|e| sum(&e[i][a[0]], &e[i][a[1]]));
                let [x2, v2] = [&edges, &rates].map(|e| sum(&e[j][b[0]], &e[j][b[1]]));
                let both = product(&x1, &v2) + product(&v1, &x2);
                rate.shear[pair][face] = S::splat(0.125) * both * Hexahedron::across(p, pair);
            }
        }
        let mut stress = Hexahedron::stresses(p, &rate);
        let power = p[9] * Hexahedron::contracted(&stress, &rate);
        for axis in 0..3 {
            for k in 0..4 {
                stress.along[axis][k] = -(p[9] * stress.along[axis][k]);
            }
            for face in 0..2 {
                stress.shear[axis][face] = -(p[9] * stress.shear[axis][face]);
            }
        }
        (Hexahedron::spread(p, &edges, &stress), power)
    }
}
