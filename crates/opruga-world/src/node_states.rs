//! Stress and volume ratio at the nodes of a body: means of the cells or facets around them.

use crate::world::World;
use opruga_core::potential::CellState;

/// The state of a node: the mean over the cells around it, weighted by their volume at rest, or over the facets, weighted by their area.
///
/// The state of a cell is itself a mean, which is exact if the stress is linear over the cell. At the boundary, where cells lie on one side only, a
/// node therefore has the mean of the states at the centres of these cells, and not the state at the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeState {
    /// Cauchy stress [Pa], row by row; in the plane including the component out of the plane.
    pub stress: [[f64; 3]; 3],
    /// The volume ratio J.
    pub volume_ratio: f64,
}

impl NodeState {
    /// The von Mises stress [Pa] of the mean stress.
    pub fn von_mises(&self) -> f64 {
        CellState {
            cell: 0,
            stress: self.stress,
            volume_ratio: self.volume_ratio,
            smallest_volume_ratio: self.volume_ratio,
            measure: 0.0,
        }
        .von_mises()
    }

    /// The components of the stress and the von Mises stress, in the order of [`crate::blueprint::Recorded::columns`] [Pa].
    pub fn components(&self, dimension: usize) -> Vec<f64> {
        let s = &self.stress;
        let mut out = vec![s[0][0], s[1][1], s[2][2], s[0][1]];
        if dimension == 3 {
            out.extend([s[1][2], s[2][0]]);
        }
        out.push(self.von_mises());
        out
    }
}

/// Weighted sums of states.
#[derive(Clone, Copy, Default)]
struct Sum {
    stress: [[f64; 3]; 3],
    ratio: f64,
    weight: f64,
}

impl Sum {
    fn add(&mut self, weight: f64, stress: &[[f64; 3]; 3], ratio: f64) {
        for (sum, own) in self.stress.as_flattened_mut().iter_mut().zip(stress.as_flattened()) {
            *sum += weight * own;
        }
        self.ratio += weight * ratio;
        self.weight += weight;
    }
    fn mean(&self) -> Option<NodeState> {
        let stress = self.stress.map(|row| row.map(|s| s / self.weight));
        (self.weight > 0.0).then(|| NodeState { stress, volume_ratio: self.ratio / self.weight })
    }
}

impl<const D: usize> World<D> {
    /// The states of the nodes of a body; `None` for a node without stress around it, empty if there is no such body.
    pub fn node_states(&self, body: usize) -> Vec<Option<NodeState>> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let mut sums = vec![Sum::default(); self.node_count(body)];
        self.visit_states(body, &mut |state, nodes| {
            for node in nodes {
                sums[*node as usize].add(state.measure, &state.stress, state.volume_ratio);
            }
        });
        sums.iter().map(Sum::mean).collect()
    }

    /// Visits the known states of the cells and facets of a body, with their nodes.
    pub fn visit_states(&self, body: usize, visit: &mut dyn FnMut(&CellState, &[u32])) {
        if self.handle(body).is_none() {
            return;
        }
        let mesh = &self.blueprint.bodies[body].mesh;
        let of_cell: Vec<&[u32]> = mesh.cells.iter().map(|(_, _, nodes)| nodes).collect();
        self.cell_states(body).iter().for_each(|state| visit(state, of_cell[state.cell as usize]));
        self.facet_states(body).iter().for_each(|state| visit(state, &mesh.facets[state.cell as usize]));
    }

    /// The mean over some nodes; `None` if no node has a state.
    pub(crate) fn mean_of_cells(&self, body: usize, nodes: &[u32]) -> Option<NodeState> {
        let states = self.node_states(body);
        let mut sum = Sum::default();
        for state in nodes.iter().filter_map(|node| states.get(*node as usize).copied().flatten()) {
            sum.add(1.0, &state.stress, state.volume_ratio);
        }
        sum.mean()
    }
}
