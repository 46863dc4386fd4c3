//! The least work that a thread takes over in one piece.
//!
//! Each number stands for ten to some tens of microseconds, several times as long as it takes to wake a thread. With smaller
//! pieces, more than one thread would slow small scenes down. The numbers change times only, no bit of the results
//! (`threads_change_no_bit_of_many_rings` compares one, two and five threads with enough work for several pieces of each kind).

/// Pairs of bodies whose features are compared.
pub(crate) const PAIRS_OF_BODIES: usize = 16;

/// Candidates whose gaps are computed, or close pairs that are checked for passages.
pub(crate) const CANDIDATES: usize = 1024;

/// Points whose boxes are computed, or that are moved.
pub(crate) const POINTS: usize = 4096;

/// Contacts that are solved for, or points of contacts whose obstacles are examined.
pub(crate) const CONTACTS: usize = 256;
