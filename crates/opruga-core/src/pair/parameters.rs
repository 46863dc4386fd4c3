//! The parameters of pairs, as laws and sums read them: eight at a time.

use super::PairLaw;
use crate::state::{At, Parameter};
use opruga_math::Pack;

/// The numbers that a law reads for eight pairs.
#[inline(always)]
pub(super) fn law_parameters<P: Pack, L: PairLaw<D>, const D: usize>(law: &L, at: At) -> [P; 3] {
    if L::UNIFORM {
        let [second, third] = law.uniform();
        return [P::zero(), second, third];
    }
    load_parameters(&law.parameters(), at)
}

/// Three numbers of eight pairs.
#[inline(always)]
pub(super) fn load_parameters<P: Pack>(parameters: &[&Parameter; 3], at: At) -> [P; 3] {
    [parameters[0].load_at(at), parameters[1].load_at(at), parameters[2].load_at(at)]
}
