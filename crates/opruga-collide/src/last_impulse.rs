//! The impulses of the previous substep, from which the present one starts.

/// The impulse of a contact in the previous substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LastImpulse<const D: usize> {
    /// Its bodies in one number, and the key of its features. Impulses are sorted by both.
    pub(crate) bodies: u64,
    pub(crate) id: u64,
    /// The impulses along and across its normal [N s].
    pub(crate) along: f64,
    pub(crate) across: [f64; D],
}

/// The number of contacts of points with obstacles that hold them.
pub(crate) const NO_BODIES: u64 = u64::MAX;

/// Two bodies in one number, in the order of [`crate::body_pairs::BodyPairs::all`].
pub(crate) fn number_of([a, b]: [u32; 2]) -> u64 {
    let [a, b] = if a < b { [a, b] } else { [b, a] };
    u64::from(a) << 32 | u64::from(b)
}
