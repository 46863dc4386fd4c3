//! Whether a body is slender, as determined from the couplings of its nodes. In slender bodies the sparse factor is narrow.
//! Conjugate gradients carry information by only one cell per product, so they are slow for such bodies and would stop before
//! the whole body has bent.

use opruga_core::potential::{Definiteness, DensePart, Sink};
use opruga_core::system::{Stage, System};

/// A body is slender if no layer has more nodes than this number times the number of layers.
const SLENDER: usize = 8;

/// The largest size of the factor: the number of nodes of the widest layer times the number of nodes of the body.
const LARGEST_FACTOR: usize = 400_000;

/// Collects which nodes the delivered blocks couple.
struct Touching {
    neighbours: Vec<Vec<u32>>,
}

impl<const D: usize> Sink<D> for Touching {
    fn block(&mut self, a: usize, b: usize, _value: [[f64; D]; D]) {
        if a != b {
            self.neighbours[a].push(b as u32);
        }
    }
    /// Rank-one terms are stored separately from the factored matrix.
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; D])]) {}
    fn dense(&mut self, _part: &DensePart<'_, D>) {}
}

/// Whether a dense part is delivered.
struct Dense(bool);

impl<const D: usize> Sink<D> for Dense {
    fn block(&mut self, _a: usize, _b: usize, _value: [[f64; D]; D]) {}
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; D])]) {}
    fn dense(&mut self, _part: &DensePart<'_, D>) {
        self.0 = true;
    }
}

/// Whether a model of a body delivers a dense part, which has a factor and no sparse rows for products.
pub(crate) fn has_dense<const D: usize>(system: &System<D>) -> bool {
    let mut found = Dense(false);
    system.hessian(Stage::Current, 0.0, Definiteness::Exact, &mut found);
    found.0
}

/// Whether the factor of the matrix of a body is narrow for its size. The answer depends only on which nodes are coupled, not
/// on the state.
pub(crate) fn is_slender<const D: usize>(system: &System<D>) -> bool {
    let mut touching = Touching { neighbours: vec![Vec::new(); system.nodes] };
    system.hessian(Stage::Current, 0.0, Definiteness::Exact, &mut touching);
    for list in &mut touching.neighbours {
        list.sort_unstable();
        list.dedup();
    }
    // The layers start from one end of the body. A walk from any node ends at such an end.
    let Some(end) = layers(&touching.neighbours, 0).last().and_then(|layer| layer.first().copied()) else {
        return false;
    };
    let layers = layers(&touching.neighbours, end as usize);
    let widest = layers.iter().map(Vec::len).max().unwrap_or(0);
    let reached: usize = layers.iter().map(Vec::len).sum();
    reached == system.nodes && widest <= SLENDER * layers.len() && widest * system.nodes <= LARGEST_FACTOR
}

/// The nodes that are reached from one node in zero, one, two, … steps.
fn layers(neighbours: &[Vec<u32>], from: usize) -> Vec<Vec<u32>> {
    let mut seen = vec![false; neighbours.len()];
    if neighbours.is_empty() {
        return Vec::new();
    }
    seen[from] = true;
    let mut layers = vec![vec![from as u32]];
    while let Some(last) = layers.last() {
        let mut next = Vec::new();
        for node in last {
            for other in &neighbours[*node as usize] {
                if !std::mem::replace(&mut seen[*other as usize], true) {
                    next.push(*other);
                }
            }
        }
        if next.is_empty() {
            break;
        }
        layers.push(next);
    }
    layers
}
