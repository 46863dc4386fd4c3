//! Limits on the cost of a scene.

/// Limits on the cost of a scene, checked before anything is allocated.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The largest scene file [bytes].
    pub file_bytes: u64,
    /// The largest file of a shape [bytes].
    pub shape_bytes: u64,
    /// The largest depth of nested tables and arrays.
    pub depth: usize,
    /// The largest number of values in the lists of a scene file. Other parts of the file count by the memory that they take when parsed: a line with
    /// a key counts as three.
    pub values: u64,
    /// The largest number of bodies.
    pub bodies: u64,
    /// The largest total number of nodes of all bodies.
    pub nodes: u64,
    /// The largest estimate of memory [bytes].
    pub memory_bytes: u64,
}

impl Default for Limits {
    /// The limits on this machine.
    fn default() -> Limits {
        let limits = Limits::of_addresses(usize::BITS);
        Limits { memory_bytes: crate::machine::memory_bytes().unwrap_or(limits.memory_bytes), ..limits }
    }
}

impl Limits {
    /// The limits on a machine with addresses of this many bits. A web page has 4 GiB in total. A scene that would take more than half of this memory
    /// is refused, because the page would crash if it asked for more.
    pub fn of_addresses(bits: u32) -> Limits {
        Limits {
            file_bytes: 64 << 20,
            shape_bytes: 256 << 20,
            depth: 128,
            // Reading this many values takes at most 300 MB and two seconds, whatever the values are.
            values: 1 << 20,
            bodies: 4_000_000,
            nodes: 200_000_000,
            memory_bytes: if bits > 32 { 8 << 30 } else { 2 << 30 },
        }
    }
}
