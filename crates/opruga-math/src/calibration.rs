//! Loops that measure the speed of the machine, for comparison with other loops. The loops are compiled with this crate, as
//! kernels are, and not with the program that calls them.

use crate::{Pack, Simd, WIDTH, Work};

const ROUNDS: usize = 4096;
const CHAINS: usize = 12;

/// Computes products and sums in registers, not fused, in twelve independent chains. Returns the number of operations.
#[inline(never)]
pub fn products_and_sums(simd: Simd, out: &mut [f64; WIDTH]) -> usize {
    struct Chains<'a>(&'a mut [f64]);
    impl Work for Chains<'_> {
        type Output = ();
        #[inline(always)]
        fn run<P: Pack>(self) {
            let (factor, term) = (P::splat(0.999_999), P::splat(1e-6));
            // The numbers are loaded at run time; otherwise the compiler would know the result.
            let mut chains = [P::load(&*self.0); CHAINS];
            for k in 0..CHAINS {
                chains[k] += P::splat(k as f64);
            }
            for _ in 0..ROUNDS {
                for k in 0..CHAINS {
                    chains[k] = chains[k] * factor + term;
                }
            }
            let mut sum = P::zero();
            for k in 0..CHAINS {
                sum += chains[k];
            }
            sum.store(self.0);
        }
    }
    simd.run(Chains(out));
    2 * ROUNDS * CHAINS * WIDTH
}

/// Computes a = b + c/2 for arrays of equal length, which must be a multiple of the width. Returns the number of bytes that are
/// read and written.
#[inline(never)]
pub fn triad(simd: Simd, a: &mut [f64], b: &[f64], c: &[f64]) -> usize {
    struct Triad<'a>(&'a mut [f64], &'a [f64], &'a [f64]);
    impl Work for Triad<'_> {
        type Output = ();
        #[inline(always)]
        fn run<P: Pack>(self) {
            for k in (0..self.0.len()).step_by(WIDTH) {
                (P::load(&self.1[k..]) + P::splat(0.5) * P::load(&self.2[k..])).store(&mut self.0[k..]);
            }
        }
    }
    let bytes = 24 * a.len();
    simd.run(Triad(a, b, c));
    bytes
}

/// Replaces every number by the inverse of its square root, and returns the number of packs. The number of entries must be a
/// multiple of the width.
#[inline(never)]
pub fn inverse_roots(simd: Simd, numbers: &mut [f64]) -> usize {
    struct Roots<'a>(&'a mut [f64]);
    impl Work for Roots<'_> {
        type Output = ();
        #[inline(always)]
        fn run<P: Pack>(self) {
            for k in (0..self.0.len()).step_by(WIDTH) {
                let x = P::load(&self.0[k..]);
                (P::one() / x.sqrt()).store(&mut self.0[k..]);
            }
        }
    }
    let packs = numbers.len() / WIDTH;
    simd.run(Roots(numbers));
    packs
}
