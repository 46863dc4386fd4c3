//! Contracts tangents at the points of elements to the blocks of their matrices, for every set of vector instructions.

use super::elements::Shape;
use super::group::Group;
use super::work::geometry;
use crate::materials::points::{INVARIANTS, PRINCIPAL, read_matrix, write_matrix};
use core::marker::PhantomData;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Pack, Register, WIDTH, Work};

/// Contracts tangents at the points of one pack of elements to blocks K_ab, a ≤ b, `[(a N + b)][i][k]` packs.
pub(super) struct Contract<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// The index of the pack in the group.
    pub(super) pack: usize,
    /// D⁴ packs for every pack of points.
    pub(super) tangent: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for Contract<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        // The blocks of the first node of a simplex follow from the others.
        let start = usize::from(E::SIMPLEX);
        let pack = self.group.first + self.pack;
        let tangents = &self.tangent[self.pack * self.group.points * D * D * D * D * WIDTH..];
        for part in 0..P::PARTS {
            let mut blocks = [[[[P::Part::zero(); D]; D]; N]; N];
            for q in 0..self.group.points {
                let (inverse, measure) = geometry::<P::Part, D>(&self.group, pack, q, part);
                let mut slopes = [[P::Part::zero(); D]; N];
                for a in start..N {
                    for m in 0..D {
                        slopes[a][m] = if E::SIMPLEX {
                            inverse[a - 1][m]
                        } else {
                            let mut sum = inverse[0][m] * P::Part::splat(E::SLOPES[q][a][0]);
                            for j in 1..D {
                                sum += inverse[j][m] * P::Part::splat(E::SLOPES[q][a][j]);
                            }
                            sum
                        };
                    }
                }
                for i in 0..D {
                    // Row i of the tangent: ∂Pᵢⱼ/∂Fₖₗ.
                    let mut row = [[[P::Part::zero(); D]; D]; D];
                    for j in 0..D {
                        row[j] = read_matrix(&tangents[((q * D + i) * D + j) * D * D * WIDTH..], part);
                    }
                    for a in start..N {
                        let mut pulled = matrix::zeros::<P::Part, D>();
                        for j in 0..D {
                            let weight = measure * slopes[a][j];
                            for k in 0..D {
                                for l in 0..D {
                                    pulled[k][l] += weight * row[j][k][l];
                                }
                            }
                        }
                        for b in a..N {
                            for k in 0..D {
                                for l in 0..D {
                                    blocks[a][b][i][k] += pulled[k][l] * slopes[b][l];
                                }
                            }
                        }
                    }
                }
            }
            if E::SIMPLEX {
                complete(&mut blocks);
            }
            for a in 0..N {
                for b in a..N {
                    write_matrix(&mut self.blocks[(a * N + b) * D * D * WIDTH..], part, &blocks[a][b]);
                }
            }
        }
    }
}

/// Computes the blocks of the first node of a simplex from the others, since the sum of K_ab over b is zero.
#[inline(always)]
fn complete<R: Register, const D: usize, const N: usize>(blocks: &mut [[Matrix<R, D>; N]; N]) {
    for b in 1..N {
        for i in 0..D {
            for k in 0..D {
                let mut sum = R::zero();
                for a in 1..N {
                    sum += if a <= b { blocks[a][b][i][k] } else { blocks[b][a][k][i] };
                }
                blocks[0][b][i][k] = -sum;
            }
        }
    }
    for i in 0..D {
        for k in 0..D {
            let mut sum = R::zero();
            for b in 1..N {
                sum += blocks[0][b][i][k];
            }
            blocks[0][0][i][k] = -sum;
        }
    }
}

/// Computes the blocks of simplices from tangents that are given in the frame of the singular vectors, F = U diag(σ) Vᵀ.
///
/// With ĝ = Vᵀ ∂N/∂X the block K_ab is U K̂ Uᵀ, where K̂ᵢₖ = Hᵢₖ ĝᵃᵢ ĝᵇₖ + Tᵢₖ ĝᵃₖ ĝᵇᵢ off the diagonal and K̂ᵢᵢ = Hᵢᵢ ĝᵃᵢ ĝᵇᵢ +
/// Σⱼ Sᵢⱼ ĝᵃⱼ ĝᵇⱼ on it, so the D⁴ numbers of the tangent are never written out.
pub(super) struct ContractPrincipal<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// The index of the pack in the group.
    pub(super) pack: usize,
    /// The data that [`crate::materials::law::Law::principal`] writes.
    pub(super) principal: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for ContractPrincipal<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let size = D * D * WIDTH;
        let from = &self.principal[self.pack * PRINCIPAL * size..(self.pack + 1) * PRINCIPAL * size];
        for part in 0..P::PARTS {
            let (inverse, measure) = geometry::<P::Part, D>(&self.group, self.group.first + self.pack, 0, part);
            // Row a is ĝ of the node a + 1.
            let slopes = matrix::product(&inverse, &read_matrix::<P::Part, D>(&from[size..], part));
            let u = read_matrix::<P::Part, D>(from, part);
            let second = read_matrix::<P::Part, D>(&from[2 * size..], part);
            let pairs = read_matrix::<P::Part, D>(&from[3 * size..], part);
            let mut blocks = [[[[P::Part::zero(); D]; D]; N]; N];
            for a in 0..D {
                let mut left = slopes[a];
                for i in 0..D {
                    left[i] = measure * left[i];
                }
                // The part of K̂ that does not depend on b.
                let mut own = second;
                let mut other = pairs;
                let mut along = pairs;
                for i in 0..D {
                    for k in 0..D {
                        let (low, high) = if i < k { (i, k) } else { (k, i) };
                        own[i][k] = second[i][k] * left[i];
                        other[i][k] = pairs[high][low] * left[k];
                        along[i][k] = pairs[low][high] * left[k];
                    }
                }
                for b in a..D {
                    let right = &slopes[b];
                    let mut inner = [[P::Part::zero(); D]; D];
                    for i in 0..D {
                        for k in 0..D {
                            inner[i][k] = own[i][k] * right[k];
                            if i != k {
                                inner[i][k] += other[i][k] * right[i];
                            }
                        }
                        for j in 0..D {
                            if i != j {
                                inner[i][i] += along[i][j] * right[j];
                            }
                        }
                    }
                    blocks[a + 1][b + 1] = matrix::product_transposed(&matrix::product(&u, &inner), &u);
                }
            }
            complete(&mut blocks);
            for a in 0..N {
                for b in a..N {
                    write_matrix(&mut self.blocks[(a * N + b) * size..], part, &blocks[a][b]);
                }
            }
        }
    }
}

/// Computes the blocks of simplices from derivatives by the invariants I = tr FᵀF and J = det F.
///
/// With g = ∂N/∂X, f = F g and c = cof F g the block K_ab is
/// V (2ψ_I gᵃ·gᵇ 1 + 4ψ_II fᵃ fᵇᵀ + ψ_JJ cᵃ cᵇᵀ + ψ_J W) with Wᵢₖ = εᵢₖₘ wₘ and w = F (gᵃ × gᵇ).
pub(super) struct ContractInvariants<'a, E, const D: usize, const N: usize> {
    pub(super) shape: PhantomData<E>,
    pub(super) group: Group<'a>,
    /// The index of the pack in the group.
    pub(super) pack: usize,
    /// Deformation gradients.
    pub(super) gradient: &'a [f64],
    /// As described at [`crate::materials::law::Form::Invariants`].
    pub(super) invariants: &'a [f64],
    pub(super) blocks: &'a mut [f64],
}

impl<E: Shape<D, N>, const D: usize, const N: usize> Work for ContractInvariants<'_, E, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let size = D * D * WIDTH;
        let numbers = &self.invariants[self.pack * INVARIANTS * WIDTH..(self.pack + 1) * INVARIANTS * WIDTH];
        for part in 0..P::PARTS {
            // Row a is g of the node a + 1.
            let (slopes, measure) = geometry::<P::Part, D>(&self.group, self.group.first + self.pack, 0, part);
            let number = |k: usize| measure * P::Part::load(&numbers[k * WIDTH + part * P::Part::NUMBERS..]);
            let [stretch, stretch_twice, volume, volume_twice] = [number(0), number(1), number(2), number(3)];
            let f = read_matrix::<P::Part, D>(&self.gradient[self.pack * size..], part);
            let along = matrix::product_transposed(&slopes, &f);
            let across = matrix::product_transposed(&slopes, &matrix::cofactor(&f));
            let mut blocks = [[[[P::Part::zero(); D]; D]; N]; N];
            for a in 0..D {
                let mut along_left = along[a];
                let mut across_left = across[a];
                for i in 0..D {
                    along_left[i] = stretch_twice * along_left[i];
                    across_left[i] = volume_twice * across_left[i];
                }
                for b in a..D {
                    let mut inner = slopes[a][0] * slopes[b][0];
                    for j in 1..D {
                        inner += slopes[a][j] * slopes[b][j];
                    }
                    let block = &mut blocks[a + 1][b + 1];
                    for i in 0..D {
                        for k in 0..D {
                            // Symmetric blocks are symmetric to the bit.
                            block[i][k] = if a == b && k < i {
                                block[k][i]
                            } else {
                                along_left[i] * along[b][k] + across_left[i] * across[b][k]
                            };
                        }
                        block[i][i] += stretch * inner;
                    }
                    if a != b {
                        add_turn(block, volume, &f, &slopes[a], &slopes[b]);
                    }
                }
            }
            complete(&mut blocks);
            for a in 0..N {
                for b in a..N {
                    write_matrix(&mut self.blocks[(a * N + b) * size..], part, &blocks[a][b]);
                }
            }
        }
    }
}

/// Adds s εᵢₖₘ wₘ with w = F (a × b). In the plane F has no effect, because a × b is normal to the plane.
#[inline(always)]
fn add_turn<R: Register, const D: usize>(block: &mut Matrix<R, D>, s: R, f: &Matrix<R, D>, a: &[R; D], b: &[R; D]) {
    let cross = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    if D == 2 {
        let turn = s * cross(0, 1);
        block[0][1] += turn;
        block[1][0] -= turn;
        return;
    }
    let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
    for m in 0..D {
        let mut sum = f[m][0] * normal[0];
        for j in 1..D {
            sum += f[m][j] * normal[j];
        }
        let turn = s * sum;
        let (i, k) = ((m + 1) % D, (m + 2) % D);
        block[i][k] += turn;
        block[k][i] -= turn;
    }
}
