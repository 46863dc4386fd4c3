//! The storage of positions and velocities: one column of numbers for each coordinate of one body, or of eight identical bodies
//! side by side.

use opruga_math::{Column, Pack, Register, RepeatStrip, StripMut, WIDTH, lanes};

/// The layout of the nodes of a block in its columns.
///
/// Every loop of physics runs over the indices of a column, eight at a time:
///
/// ```text
/// Single: node i of the one body        at index i           (a pack = 8 neighbouring nodes)
/// Batch:  node i of body l (of eight)   at index 8 i + l     (a pack = the same node of 8 bodies)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// One body.
    Single,
    /// Up to eight bodies of the same topology.
    Batch,
}

impl Layout {
    /// The distance in a column between a node and the next one.
    #[inline(always)]
    pub fn stride(self) -> usize {
        match self {
            Layout::Single => 1,
            Layout::Batch => WIDTH,
        }
    }
    /// The number of indices of this many nodes, padded to whole packs.
    pub fn index_count(self, nodes: usize) -> usize {
        (nodes * self.stride()).next_multiple_of(WIDTH)
    }
    /// The index of a node of a body.
    #[inline(always)]
    pub fn index(self, node: usize, body: usize) -> usize {
        match self {
            Layout::Single => node,
            Layout::Batch => node * WIDTH + body,
        }
    }
}

/// One column of numbers per coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns<const D: usize>(pub [Column; D]);

impl<const D: usize> Columns<D> {
    /// Makes columns of zeros, with space for a whole pack after the last index.
    pub fn zeros(index_count: usize) -> Columns<D> {
        Columns(core::array::from_fn(|_| Column::zeros(index_count + WIDTH)))
    }
    /// The columns as slices.
    #[inline(always)]
    pub fn slices(&self) -> [&[f64]; D] {
        core::array::from_fn(|d| &*self.0[d])
    }
    /// Loads eight indices at once.
    #[inline(always)]
    pub fn load<P: Pack>(&self, index: usize) -> [P; D] {
        lanes!(P, d => P::load(&self.0[d][index..]))
    }
    /// Stores eight indices at once.
    #[inline(always)]
    pub fn store<P: Pack>(&mut self, index: usize, value: [P; D]) {
        for d in 0..D {
            value[d].store(&mut self.0[d][index..]);
        }
    }
    /// The same range of every column, for a loop over packs.
    #[inline(always)]
    pub fn strip_mut(&mut self, start: usize, length: usize) -> StripMut<'_, D> {
        StripMut::new(self.0.each_mut().map(|c| &mut **c), start, length)
    }
    /// The vector at one index.
    #[inline(always)]
    pub fn at(&self, index: usize) -> [f64; D] {
        core::array::from_fn(|d| self.0[d][index])
    }
    /// Writes the vector at one index.
    #[inline(always)]
    pub fn set(&mut self, index: usize, value: [f64; D]) {
        for d in 0..D {
            self.0[d][index] = value[d];
        }
    }
}

/// Loads eight indices of every coordinate.
#[inline(always)]
pub fn load<P: Pack, const D: usize>(columns: &[&[f64]; D], index: usize) -> [P; D] {
    lanes!(P, d => P::load(&columns[d][index..]))
}

/// A number per index. Often all packs hold the same eight numbers, which then represent the whole column.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter(Numbers);

#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    /// The same eight numbers throughout.
    Repeated(Eight),
    /// One number per index.
    Each(Column),
}

/// Eight numbers on a cache line of their own.
#[derive(Clone, Debug, PartialEq)]
#[repr(align(64))]
struct Eight([f64; WIDTH]);

impl Parameter {
    /// A parameter that is zero everywhere, for laws that read fewer numbers than the interface provides.
    pub const NONE: Parameter = Parameter(Numbers::Repeated(Eight([0.0; WIDTH])));

    /// Makes a parameter that has the same number everywhere.
    pub fn uniform(value: f64) -> Parameter {
        Parameter::by_body([value; WIDTH])
    }
    /// Makes a parameter that has one number for each of eight bodies side by side.
    pub fn by_body(values: [f64; WIDTH]) -> Parameter {
        Parameter(Numbers::Repeated(Eight(values)))
    }
    /// Makes a parameter from a number for every index. If all numbers are the same to the bit, they are stored once.
    pub fn column(values: Vec<f64>) -> Parameter {
        let first = values.first().copied().unwrap_or(0.0);
        if values.iter().all(|v| v.to_bits() == first.to_bits()) {
            return Parameter::uniform(first);
        }
        let mut column = Column::zeros(values.len() + WIDTH);
        column[..values.len()].copy_from_slice(&values);
        Parameter(Numbers::Each(column))
    }
    /// Makes a parameter from the number of every item (node, spring, …) and body, with the layout of the columns.
    pub fn from_items(layout: Layout, items: usize, mut number: impl FnMut(usize, usize) -> f64) -> Parameter {
        let mut values = vec![0.0; items * layout.stride()];
        for item in 0..items {
            for body in 0..layout.stride() {
                values[layout.index(item, body)] = number(item, body);
            }
        }
        let repeats = layout == Layout::Batch && values.chunks(WIDTH).all(|c| c == &values[..WIDTH]);
        if repeats && !values.is_empty() {
            let mut first = [0.0; WIDTH];
            first.copy_from_slice(&values[..WIDTH]);
            return Parameter::by_body(first);
        }
        Parameter::column(values)
    }
    /// The numbers of eight indices.
    #[inline(always)]
    pub fn load<P: Pack>(&self, index: usize) -> P {
        match &self.0 {
            Numbers::Repeated(eight) => P::load(&eight.0),
            Numbers::Each(column) => P::load(&column[index..]),
        }
    }
    /// A piece of the column for a loop over packs.
    #[inline(always)]
    pub fn strip(&self, start: usize, length: usize) -> RepeatStrip<'_> {
        match &self.0 {
            Numbers::Repeated(eight) => RepeatStrip::repeated(&eight.0, length),
            Numbers::Each(column) => RepeatStrip::new(column, start, length),
        }
    }
    /// The numbers of eight items.
    #[inline(always)]
    pub fn load_at<P: Pack>(&self, items: At) -> P {
        match items {
            At::Run(index) => self.load(index),
            At::Each(indices) => match &self.0 {
                Numbers::Repeated(eight) => P::load(&eight.0),
                Numbers::Each(column) => P::gather(column, indices),
            },
        }
    }
    /// The numbers of a register of items, which begins at `offset` among eight items.
    #[inline(always)]
    pub fn load_part<R: Register>(&self, items: At, offset: usize) -> R {
        match (&self.0, items) {
            (Numbers::Repeated(eight), _) => R::load(&eight.0[offset..]),
            (Numbers::Each(column), At::Run(index)) => R::load(&column[index + offset..]),
            (Numbers::Each(column), At::Each(indices)) => R::gather(column, &indices[offset..]),
        }
    }
    /// The number at one index.
    #[inline(always)]
    pub fn at(&self, index: usize) -> f64 {
        match &self.0 {
            Numbers::Repeated(eight) => eight.0[index % WIDTH],
            Numbers::Each(column) => column[index],
        }
    }
    /// Whether eight values represent the whole column.
    #[inline(always)]
    pub fn repeats(&self) -> bool {
        matches!(self.0, Numbers::Repeated(_))
    }
    /// Whether it is zero everywhere.
    pub fn is_zero(&self) -> bool {
        let numbers: &[f64] = match &self.0 {
            Numbers::Repeated(eight) => &eight.0,
            Numbers::Each(column) => column,
        };
        numbers.iter().all(|v| *v == 0.0)
    }
    /// The number of bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        match &self.0 {
            Numbers::Repeated(_) => 0,
            Numbers::Each(column) => column.heap_bytes(),
        }
    }
}

/// Eight items of a column: consecutive items after an index, or separate indices.
#[derive(Clone, Copy, Debug)]
pub enum At<'a> {
    /// From this index on.
    Run(usize),
    /// Eight separate indices.
    Each(&'a [u32]),
}

/// The state in which forces are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, const D: usize> {
    /// Positions x [m].
    pub x: [&'a [f64]; D],
    /// Velocities v [m/s].
    pub v: [&'a [f64]; D],
    /// The number of nodes of one body.
    pub nodes: usize,
    /// One body or eight.
    pub layout: Layout,
    /// The simulated time at this state [s].
    pub time: f64,
    /// The number of threads over which work on this state may be distributed ([`crate::threads`]); they do not change the bits.
    pub threads: usize,
}

impl<const D: usize> View<'_, D> {
    /// The position at an index [m].
    #[inline(always)]
    pub fn position(&self, index: usize) -> [f64; D] {
        core::array::from_fn(|d| self.x[d][index])
    }
    /// The velocity at an index [m/s].
    #[inline(always)]
    pub fn velocity(&self, index: usize) -> [f64; D] {
        core::array::from_fn(|d| self.v[d][index])
    }
}

/// A sum over items whose bits do not depend on the layout: eight partial sums by item number modulo eight.
///
/// With one body, the eight partial sums are the eight lanes of one pack. With eight bodies side by side they are eight packs.
/// Both are summed in the same order.
#[derive(Clone, Copy)]
pub struct OrderedSum<P: Pack> {
    layout: Layout,
    /// The partial sums of one body.
    lanes: P,
    /// The partial sums of eight bodies.
    packs: [P; WIDTH],
}

impl<P: Pack> OrderedSum<P> {
    /// Makes an empty sum.
    #[inline(always)]
    pub fn new(layout: Layout) -> Self {
        OrderedSum { layout, lanes: P::zero(), packs: [P::zero(); WIDTH] }
    }
    /// Adds the values of a pack that starts at `index`, in a run that ends before the index `end`.
    #[inline(always)]
    pub fn add(&mut self, index: usize, end: usize, value: P) {
        match self.layout {
            Layout::Single if index + WIDTH <= end => self.lanes += value,
            Layout::Single => self.lanes += P::select(P::first(end - index), value, P::zero()),
            Layout::Batch => self.packs[(index / WIDTH) % WIDTH] += value,
        }
    }
    /// Adds the values of a pack whose number modulo eight is `slot`, for bodies side by side.
    #[inline(always)]
    pub fn add_to(&mut self, slot: usize, value: P) {
        self.packs[slot] += value;
    }
    /// The sum: for one body the same number eight times, otherwise the number of each of eight bodies.
    #[inline(always)]
    pub fn total(&self) -> P {
        match self.layout {
            Layout::Single => P::splat(self.lanes.sum()),
            Layout::Batch => {
                let a = &self.packs;
                ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]))
            }
        }
    }
}
