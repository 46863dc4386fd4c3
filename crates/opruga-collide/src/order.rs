//! Orders of the features of a body in which neighbours follow one another.

use crate::vector::{length, subtract};
use core::ops::Range;
use opruga_math::Lane;

/// The kinds of features.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Vertices,
    Facets,
    Edges,
}

/// The features of one body in the order in which they are compared.
pub(crate) enum Ordered<'a> {
    ByNumber(Range<usize>),
    Along(&'a [u32]),
}

impl Ordered<'_> {
    /// Calls `visit` with every feature.
    pub(crate) fn visit(self, mut visit: impl FnMut(u32)) {
        match self {
            Ordered::ByNumber(numbers) => numbers.for_each(|number| visit(number as u32)),
            Ordered::Along(order) => order.iter().for_each(|number| visit(*number)),
        }
    }
}

/// Features at given positions [m] in an order that keeps neighbours together. This is the shorter of two paths through their positions: along a
/// Z-curve, or in the order of their numbers. In the second case the list is empty.
pub(crate) fn shorter<const D: usize>(numbers: Range<usize>, at: impl Fn(usize) -> [f64; D]) -> Vec<u32> {
    let (mut low, mut extent) = ([f64::INFINITY; D], 0.0);
    for x in numbers.clone().map(&at) {
        low = core::array::from_fn(|d| x[d].smaller(low[d]));
    }
    for x in numbers.clone().map(&at) {
        extent = (0..D).fold(extent, |most: f64, d| (x[d] - low[d]).larger(most));
    }
    let mut order: Vec<(u64, u32)> = numbers.clone().map(|k| (code(&at(k), &low, extent), k as u32)).collect();
    order.sort_unstable();
    let path = |order: &mut dyn Iterator<Item = usize>| {
        let mut last: Option<[f64; D]> = None;
        order.map(&at).fold(0.0, |sum, x| sum + last.replace(x).map_or(0.0, |last| length(&subtract(&x, &last))))
    };
    if path(&mut order.iter().map(|(_, k)| *k as usize)) < path(&mut numbers.clone()) {
        order.into_iter().map(|(_, k)| k).collect()
    } else {
        Vec::new()
    }
}

/// The bits of every coordinate of a position on the Z-curve, so that three coordinates fit into 64 bits. Fewer bits would leave more neighbours in the
/// order of their numbers; no result depends on it.
const BITS: u32 = 20;

/// The position along the Z-curve of a point in a cube, given the lowest corner and the extent of the cube [m].
fn code<const D: usize>(x: &[f64; D], low: &[f64; D], extent: f64) -> u64 {
    let cells = f64::from((1u32 << BITS) - 1);
    let cell = |d: usize| if extent > 0.0 { ((x[d] - low[d]) / extent * cells) as u64 } else { 0 };
    let cells: [u64; D] = core::array::from_fn(cell);
    let bit = |b: u32, d: usize| (cells[d] >> b & 1) << (b * D as u32 + d as u32);
    (0..BITS).flat_map(|b| (0..D).map(move |d| bit(b, d))).fold(0, |code, bit| code | bit)
}
