//! Suspicious shapes of a curve or a surface: folds, and edges that are compressed so far that their force falls.

use super::FiniteDifferenceWarning;
use opruga_core::potential::Count;
use opruga_core::state::View;

/// Below this squared stretch, the force of an edge decreases, because the St. Venant–Kirchhoff law softens.
const TURNING_POINT: f64 = 1.0 / 3.0;

/// The cosine of 60°. Two edges count as one line if their directions differ by less than this angle at rest. Such edges
/// count as folded back if their directions later differ by more than 120°. The angles of a smooth closed curve with more
/// than six edges are smaller.
const IN_LINE: f64 = 0.5;

/// The edges of a curve or a surface, and the nodes between two edges of one line.
#[derive(Debug)]
pub(super) struct Folds {
    /// Two nodes and the square of their distance at rest [m²].
    edges: Vec<([u32; 2], f64)>,
    between: Vec<[u32; 3]>,
}

fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| a[d] - b[d])
}
fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}
/// The cosine between the directions from a to b and from b to c, or NaN if two of these points coincide.
fn cosine<const D: usize>([a, b, c]: [[f64; D]; 3]) -> f64 {
    let (first, second) = (minus(&b, &a), minus(&c, &b));
    dot(&first, &second) / (dot(&first, &first) * dot(&second, &second)).sqrt()
}

impl Folds {
    pub(super) fn new<const D: usize>(positions: &[[f64; D]], mut edges: Vec<[u32; 2]>) -> Folds {
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        edges.dedup();
        let at = |node: u32| positions[node as usize];
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); positions.len()];
        for [a, b] in &edges {
            neighbours[*a as usize].push(*b);
            neighbours[*b as usize].push(*a);
        }
        let mut between = Vec::new();
        for (node, around) in (0u32..).zip(&neighbours) {
            for (k, a) in around.iter().enumerate() {
                let in_line = |c: &&u32| cosine([at(*a), at(node), at(**c)]) >= IN_LINE;
                between.extend(around[k + 1..].iter().filter(in_line).map(|c| [*a, node, *c]));
            }
        }
        let square = |[a, b]: [u32; 2]| {
            let arm = minus(&at(a), &at(b));
            ([a, b], dot(&arm, &arm))
        };
        Folds { edges: edges.into_iter().map(square).collect(), between }
    }

    /// The number of edges, in all bodies, that are compressed beyond the turning point of the law or folded back.
    pub(super) fn found<const D: usize>(&self, view: &View<D>) -> Count {
        let mut count = 0;
        for body in 0..view.layout.stride() {
            let at = |node: u32| view.position(view.layout.index(node as usize, body));
            let short = self.edges.iter().filter(|([a, b], rest)| {
                let arm = minus(&at(*a), &at(*b));
                dot(&arm, &arm) < TURNING_POINT * rest
            });
            count += short.count();
            count += self.between.iter().filter(|nodes| cosine(nodes.map(at)) < -IN_LINE).count();
        }
        Count { what: FiniteDifferenceWarning::Folded {}.into(), count: count as u64 }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        size_of_val(&*self.edges) + size_of_val(&*self.between)
    }
}
