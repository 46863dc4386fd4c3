//! What a scene may cost.

/// What a scene may cost, checked before anything is allocated.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The largest scene file [bytes].
    pub file_bytes: u64,
    /// The largest file of a shape [bytes].
    pub shape_bytes: u64,
    /// How deep tables and arrays may be nested.
    pub depth: usize,
    /// The largest number of values in the lists of a scene file; what else takes memory when it is parsed counts by what it takes, a
    /// line with a key as three.
    pub values: u64,
    /// The largest number of bodies.
    pub bodies: u64,
    /// The largest number of nodes of all bodies together.
    pub nodes: u64,
    /// The largest estimate of memory [bytes].
    pub memory_bytes: u64,
}

impl Default for Limits {
    /// Those of this machine.
    fn default() -> Limits {
        let limits = Limits::of_addresses(usize::BITS);
        Limits { memory_bytes: crate::machine::memory_bytes().unwrap_or(limits.memory_bytes), ..limits }
    }
}

impl Limits {
    /// Those of a machine whose addresses have so many bits. A page in a browser has 4 GiB for everything: what takes more than half of
    /// that is refused, as asking for more would end the page.
    pub fn of_addresses(bits: u32) -> Limits {
        Limits {
            file_bytes: 64 << 20,
            shape_bytes: 256 << 20,
            depth: 128,
            // Read in 300 MB and two seconds, whatever they are.
            values: 1 << 20,
            bodies: 4_000_000,
            nodes: 200_000_000,
            memory_bytes: if bits > 32 { 8 << 30 } else { 2 << 30 },
        }
    }
}
