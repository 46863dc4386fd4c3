//! The vector instructions of the wide lane, chosen once at run time.
//!
//! The same code is compiled three times, in functions that may use SSE2, AVX2 or AVX-512. Rust never contracts `a * b + c` into
//! a fused operation, so the three versions give the same bits.

use crate::lane::Pack;
use crate::registers::Registers;
use core::sync::atomic::{AtomicU8, Ordering};

/// The result of [`Simd::best`]: 1 plus the number of the set, or 0 if the function has not been called yet.
static BEST: AtomicU8 = AtomicU8::new(0);

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// The instructions that every machine of the target has: SSE2 on x86-64, 128-bit vectors or none elsewhere.
    Baseline,
    /// 256-bit vectors.
    Avx2,
    /// 512-bit vectors.
    Avx512,
}

impl Default for Simd {
    /// The best set that this processor has.
    fn default() -> Simd {
        Simd::best()
    }
}

impl Simd {
    /// The name that `OPRUGA_SIMD` and the summaries use.
    pub fn name(self) -> &'static str {
        match self {
            Simd::Baseline if cfg!(target_arch = "x86_64") => "sse2",
            Simd::Baseline => "scalar",
            Simd::Avx2 => "avx2",
            Simd::Avx512 => "avx512",
        }
    }
    /// The best set that this processor has.
    #[inline]
    pub fn best() -> Simd {
        // This is called for every piece of work, and reading one number is faster than testing all features.
        match BEST.load(Ordering::Relaxed) {
            1 => Simd::Baseline,
            2 => Simd::Avx2,
            3 => Simd::Avx512,
            _ => Simd::ask(),
        }
    }
    #[cold]
    fn ask() -> Simd {
        let best = Simd::of_this_processor();
        BEST.store(1 + best as u8, Ordering::Relaxed);
        best
    }
    fn of_this_processor() -> Simd {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                return Simd::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Simd::Avx2;
            }
        }
        Simd::Baseline
    }
    /// The set with this name (`sse2`, `avx2`, `avx512`), or the best set below it that this processor has. The name `scalar`
    /// means the set that every machine of the target has.
    pub fn named(name: &str) -> Option<Simd> {
        let wanted = match name {
            "scalar" | "sse2" => Simd::Baseline,
            "avx2" => Simd::Avx2,
            "avx512" => Simd::Avx512,
            _ => return None,
        };
        Some(if wanted < Simd::best() { wanted } else { Simd::best() })
    }
    /// Every set that this processor has.
    pub fn available() -> Vec<Simd> {
        [Simd::Baseline, Simd::Avx2, Simd::Avx512].into_iter().filter(|s| *s <= Simd::best()).collect()
    }
    /// Runs a piece of work compiled for this set of instructions.
    ///
    /// A set that the processor does not have is replaced by the set that every machine has.
    #[inline(always)]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        {
            match self {
                // SAFETY: the processor was tested for the features that the wrapper functions enable.
                #[allow(unsafe_code)]
                Simd::Avx512 if Simd::best() >= Simd::Avx512 => return unsafe { run_avx512(work) },
                #[allow(unsafe_code)]
                Simd::Avx2 if Simd::best() >= Simd::Avx2 => return unsafe { run_avx2(work) },
                _ => {}
            }
            run_sse2(work)
        }
        #[cfg(not(target_arch = "x86_64"))]
        work.run::<Registers<f64, 8>>()
    }
}

/// A piece of work that is compiled once per set of instructions. Its `run` must be `#[inline(always)]`.
pub trait Work {
    /// The result of the work.
    type Output;
    /// Does the work with eight numbers at a time.
    fn run<P: Pack>(self) -> Self::Output;
}

// These are separate functions, so that callers stay small. Crates that need the same work use the version that one of them has
// compiled.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx,avx2,avx512f,avx512dq,avx512vl")]
#[inline(never)]
fn run_avx512<W: Work>(work: W) -> W::Output {
    work.run::<Registers<crate::x86_64::Avx512, 1>>()
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn run_sse2<W: Work>(work: W) -> W::Output {
    work.run::<Registers<crate::x86_64::Sse2, 4>>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx,avx2")]
#[inline(never)]
fn run_avx2<W: Work>(work: W) -> W::Output {
    work.run::<Registers<crate::x86_64::Avx2, 2>>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{Lane, ROW, Register, WIDTH};

    /// Applies every operation to special numbers and lists the results.
    struct Everything;
    impl Work for Everything {
        type Output = Vec<u64>;
        #[inline(always)]
        fn run<P: Pack>(self) -> Vec<u64> {
            let numbers = [1.5, -0.0, 3.75e-300, -2.0e200, 7.0, 0.1, -1.0 / 3.0, 42.0];
            let a = P::from_array(numbers);
            let b = P::from_array([0.3, 2.0, -5.0e-8, 1.0, 0.0, -0.1, 9.0, 1.0e-3]);
            let positive = a.abs() + P::splat(1.0e-3);
            let less = a.less(b);
            let most = [
                a + b,
                a - b,
                a * b,
                a / positive,
                -a,
                a.abs(),
                positive.sqrt(),
                a.smaller(b),
                a.larger(b),
                P::select(less, a, b),
                P::select(P::both(less, a.less_or_equal(P::zero())), a, b),
                a.after(b),
                P::select(P::first(3), a, b),
                P::gather(&numbers, &[7, 0, 6, 1, 5, 2, 4, 3]),
                positive.ln(),
                b.exp(),
                P::splat(a.sum()),
            ];
            let mut out = vec![u64::from(P::any(less)), u64::from(P::any(a.less(a)))];
            for value in most {
                out.extend(value.to_array().map(f64::to_bits));
            }
            // Rows of four of the numbers 0 … 39, in random order.
            let rows: Vec<f64> = (0..40).map(f64::from).collect();
            let order = [7, 0, 9, 1, 5, 2, 4, 3];
            let mut columns = [P::zero(); ROW];
            for part in 0..P::PARTS {
                let own = P::Part::gather_rows(&rows, &order[part * P::Part::NUMBERS..]);
                for k in 0..ROW {
                    columns[k].set_part(part, own[k]);
                }
            }
            // Single precision, from an unaligned index.
            let single: Vec<f32> = (0..=WIDTH).map(|k| k as f32 / 3.0).collect();
            let mut wide = P::zero();
            for part in 0..P::PARTS {
                wide.set_part(part, P::Part::load_single(&single[1 + part * P::Part::NUMBERS..]));
            }
            for (number, single) in wide.to_array().into_iter().zip(&single[1..]) {
                assert_eq!(number.to_bits(), f64::from(*single).to_bits());
            }
            // And back.
            let mut back = [0.0; ROW * WIDTH];
            for part in 0..P::PARTS {
                let mut own = [P::Part::zero(); ROW];
                for k in 0..ROW {
                    own[k] = columns[k].part(part);
                }
                P::Part::store_rows(own, &mut back[part * P::Part::NUMBERS * ROW..]);
            }
            for (row, at) in back.chunks_exact(ROW).zip(order) {
                assert_eq!(row, &rows[ROW * at as usize..][..ROW]);
            }
            for (k, column) in columns.iter().enumerate() {
                let numbers = column.to_array();
                assert_eq!(numbers, order.map(|row| f64::from(row * 4 + k as u32)));
                out.extend(numbers.map(f64::to_bits));
            }
            out
        }
    }

    #[test]
    fn all_sets_of_instructions_give_the_bits_of_plain_rust() {
        let plain = Everything.run::<Registers<f64, 8>>();
        assert_eq!(plain.len(), 2 + (17 + ROW) * WIDTH);
        for simd in Simd::available() {
            assert_eq!(simd.run(Everything), plain, "{simd:?}");
        }
    }

    /// Logarithms of numbers of every size, including numbers without a logarithm.
    struct Logarithms<'a>(&'a [f64]);
    impl Work for Logarithms<'_> {
        type Output = Vec<u64>;
        #[inline(always)]
        fn run<P: Pack>(self) -> Vec<u64> {
            self.0.chunks_exact(WIDTH).flat_map(|c| P::load(c).ln().to_array().map(f64::to_bits)).collect()
        }
    }

    #[test]
    fn logarithms_of_lanes_have_the_bits_of_libm() {
        let mut numbers = Vec::new();
        let mut random = 1u64;
        for k in 0..80_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Random bits of a positive number, numbers near 1, and numbers near √½ and √2.
            let near = 1.0 + (random >> 11) as f64 / (1u64 << 53) as f64;
            numbers.push(match k % 4 {
                0 => f64::from_bits(random >> 1),
                1 => near - 0.5,
                2 => near * 0.5f64.sqrt(),
                _ => 1.0 + (near - 1.5) * 1e-6,
            });
        }
        numbers.extend([1.0, 0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, 5e-324, f64::MIN_POSITIVE]);
        let expected: Vec<u64> = numbers.iter().map(|x| libm::log(*x).to_bits()).collect();
        for simd in Simd::available() {
            for (at, (got, expected)) in simd.run(Logarithms(&numbers)).iter().zip(&expected).enumerate() {
                let both_nan = f64::from_bits(*got).is_nan() && f64::from_bits(*expected).is_nan();
                assert!(got == expected || both_nan, "{simd:?}: ln {}", numbers[at]);
            }
        }
    }

    #[test]
    fn names_are_understood_and_capped_by_the_processor() {
        assert_eq!(Simd::named("scalar"), Some(Simd::Baseline));
        assert_eq!(Simd::named(Simd::Baseline.name()), Some(Simd::Baseline));
        assert_eq!(Simd::named("avx512"), Some(Simd::best()));
        assert_eq!(Simd::named("neon"), None);
    }
}
