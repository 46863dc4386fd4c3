//! Chains edges in any order into loops.

/// The nodes of one loop, and whether the last is joined to the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Loop {
    /// The nodes along the loop.
    pub(crate) nodes: Vec<u32>,
    /// Whether the last node is joined to the first.
    pub(crate) closed: bool,
}

/// Chains edges into loops; an edge may point either way.
pub(crate) fn chain(edges: &[[u32; 2]]) -> Vec<Loop> {
    if let Some(whole) = chain_ordered(edges) {
        return vec![whole];
    }
    let count = edges.iter().flatten().max().map_or(0, |&node| node as usize + 1);
    let mut starts = vec![0_u32; count + 1];
    for &node in edges.iter().flatten() {
        starts[node as usize + 1] += 1;
    }
    for node in 0..count {
        starts[node + 1] += starts[node];
    }
    let mut fill = starts.clone();
    let mut incident = vec![0_u32; 2 * edges.len()];
    for (index, edge) in edges.iter().enumerate() {
        for &node in edge {
            incident[fill[node as usize] as usize] = index as u32;
            fill[node as usize] += 1;
        }
    }
    let mut used = vec![false; edges.len()];
    let around = |node: u32| &incident[starts[node as usize] as usize..starts[node as usize + 1] as usize];
    let is_end = |edge: &[u32; 2]| edge.iter().any(|&node| around(node).len() == 1);
    // Open lines first, from their ends; what is left then are closed loops.
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by_key(|&index| !is_end(&edges[index]));
    let mut loops = Vec::new();
    for first in order {
        if used[first] || edges[first][0] == edges[first][1] {
            continue;
        }
        used[first] = true;
        let backwards = around(edges[first][1]).len() == 1 && around(edges[first][0]).len() != 1;
        let [start, mut end] = if backwards { [edges[first][1], edges[first][0]] } else { edges[first] };
        let mut nodes = vec![start];
        while end != start {
            nodes.push(end);
            let free = || around(end).iter().copied().filter(|&index| !used[index as usize]);
            let next = free().find(|&index| edges[index as usize][0] == end).or_else(|| free().next());
            let Some(next) = next else { break };
            used[next as usize] = true;
            let [a, b] = edges[next as usize];
            end = if a == end { b } else { a };
        }
        loops.push(Loop { nodes, closed: end == start });
    }
    loops
}

/// The single loop of edges which already follow each other.
fn chain_ordered(edges: &[[u32; 2]]) -> Option<Loop> {
    let (first, last) = (edges.first()?, edges.last()?);
    let follows = edges.windows(2).all(|pair| pair[0][1] == pair[1][0] && pair[1][0] != first[0]);
    (follows && last[1] == first[0] && edges.len() > 2)
        .then(|| Loop { nodes: edges.iter().map(|edge| edge[0]).collect(), closed: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordered_edges_are_one_loop() {
        let found = chain(&[[4, 2], [2, 9], [9, 4]]);
        assert_eq!(found, vec![Loop { nodes: vec![4, 2, 9], closed: true }]);
    }

    #[test]
    fn shuffled_edges_of_two_loops_are_chained() {
        let found = chain(&[[0, 1], [5, 4], [2, 0], [3, 4], [1, 2], [5, 3]]);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|chain| chain.closed && chain.nodes.len() == 3));
        assert_eq!(found[0].nodes, vec![0, 1, 2]);
    }

    #[test]
    fn an_open_line_stays_open() {
        let found = chain(&[[1, 2], [3, 2], [0, 1]]);
        assert_eq!(found.len(), 1);
        assert!(!found[0].closed);
        assert_eq!(found[0].nodes.len(), 4);
    }

    #[test]
    fn loops_which_touch_in_a_node_use_each_edge_once() {
        let found = chain(&[[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 2]]);
        assert_eq!(found.iter().map(|chain| chain.nodes.len()).sum::<usize>(), 6);
        assert!(found.iter().all(|chain| chain.closed));
    }
}
