//! The cost of contact, in numbers that do not depend on the machine.

/// The cost of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Substeps.
    pub steps: u64,
    /// Searches for candidates.
    pub searches: u64,
    /// Candidates, summed over the substeps.
    pub candidates: u64,
    /// Pairs whose gap was computed.
    pub pairs: u64,
    /// Pairs that entered the solution.
    pub contacts: u64,
    /// The number of turns in which these were solved.
    pub turns: u64,
    /// The number of rounds, each of which computes gaps and solves for impulses. Every substep has one round, and another whenever contact pushes
    /// points close to others that were out of reach, or pairs would still pass through one another.
    pub rounds: u64,
}

impl Counts {
    /// Returns the sums of these counts and other ones.
    pub fn and(&self, other: &Counts) -> Counts {
        Counts {
            steps: self.steps + other.steps,
            searches: self.searches + other.searches,
            candidates: self.candidates + other.candidates,
            pairs: self.pairs + other.pairs,
            contacts: self.contacts + other.contacts,
            turns: self.turns + other.turns,
            rounds: self.rounds + other.rounds,
        }
    }
}
