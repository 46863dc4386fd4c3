//! The pieces of a body: sets of nodes that its models couple. A map with islands is one body of many pieces.

use opruga_core::potential::{Definiteness, DensePart, Sink};
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::Column;
use opruga_solve::blocks::Block;

/// All nodes of a body, as one piece.
pub(super) fn whole<const D: usize>(system: &System<D>) -> Vec<usize> {
    (0..system.nodes).collect()
}

/// The pieces of a body, each as an ordered list of nodes. The pieces are ordered by their first nodes. If a model has no
/// value in the present state, the body counts as one piece.
pub(crate) fn pieces<const D: usize>(system: &System<D>) -> Vec<Vec<usize>> {
    let mut ties = Ties { tied_to: whole(system) };
    let rest = Columns::zeros(system.index_count());
    let mut view = system.view(opruga_core::system::Stage::Current, system.time);
    view.v = rest.slices();
    for member in system.members.iter().filter(|member| member.potential.properties().views.hessian) {
        let mut scratch = Column::zeros(member.potential.properties().scratch_len);
        if member.potential.prepare(system.simd, &view, &member.memory, &mut scratch).is_err() {
            return vec![whole(system)];
        }
        member.potential.hessian(&view, &scratch, Definiteness::Exact, &mut ties);
    }
    let mut number = vec![usize::MAX; system.nodes];
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    for node in 0..system.nodes {
        let first = ties.first(node);
        if number[first] == usize::MAX {
            number[first] = pieces.len();
            pieces.push(Vec::new());
        }
        pieces[number[first]].push(node);
    }
    pieces
}

/// Which nodes share second derivatives, whatever the values of these derivatives. Every node points to another node of its
/// piece, and the first node points to itself.
struct Ties {
    tied_to: Vec<usize>,
}

impl Ties {
    fn first(&mut self, mut node: usize) -> usize {
        while self.tied_to[node] != node {
            self.tied_to[node] = self.tied_to[self.tied_to[node]];
            node = self.tied_to[node];
        }
        node
    }
    fn tie(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.tied_to[a.max(b)] = a.min(b);
    }
}

impl<const D: usize> Sink<D> for Ties {
    fn block(&mut self, a: usize, b: usize, _value: Block<D>) {
        self.tie(a, b);
    }
    fn low_rank(&mut self, _c: f64, u: &[(usize, [f64; D])]) {
        u.windows(2).for_each(|pair| self.tie(pair[0].0, pair[1].0));
    }
    fn dense(&mut self, part: &DensePart<'_, D>) {
        part.indices.windows(2).for_each(|pair| self.tie(pair[0] as usize, pair[1] as usize));
    }
}
