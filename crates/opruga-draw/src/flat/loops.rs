//! Joins unordered edges into loops.

/// The nodes of one loop, and whether the last is joined to the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Loop {
    /// The nodes along the loop.
    pub(crate) nodes: Vec<u32>,
    /// Whether the last node is joined to the first.
    pub(crate) closed: bool,
}

/// Groups each outer line with the holes in it. Outer lines run counter-clockwise, and holes run clockwise. If a hole is in no outer line, all loops
/// form one group.
pub(crate) fn parts<'a>(loops: &'a [Loop], positions: &[[f64; 3]]) -> Vec<Vec<&'a Loop>> {
    let at = |node: u32| [positions[node as usize][0], positions[node as usize][1]];
    let corners = |chain: &Loop| chain.nodes.iter().map(|node| at(*node)).collect::<Vec<[f64; 2]>>();
    let area = |line: &[[f64; 2]]| -> f64 {
        let next = line.iter().cycle().skip(1);
        line.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - b[0] * a[1])).sum()
    };
    let lines: Vec<Vec<[f64; 2]>> = loops.iter().map(corners).collect();
    let areas: Vec<f64> = lines.iter().map(|line| area(line)).collect();
    let outer: Vec<usize> = (0..loops.len()).filter(|k| loops[*k].closed && areas[*k] > 0.0).collect();
    let mut parts: Vec<Vec<&Loop>> = outer.iter().map(|k| vec![&loops[*k]]).collect();
    for hole in (0..loops.len()).filter(|k| !outer.contains(k)) {
        let around = (0..outer.len()).filter(|k| encloses(&lines[outer[*k]], lines[hole][0]));
        match around.min_by(|a, b| areas[outer[*a]].total_cmp(&areas[outer[*b]])) {
            Some(home) => parts[home].push(&loops[hole]),
            None => return vec![loops.iter().collect()],
        }
    }
    parts
}

/// Whether a closed line encloses a point, by the even-odd rule.
pub(crate) fn encloses(line: &[[f64; 2]], point: [f64; 2]) -> bool {
    let next = line.iter().cycle().skip(1);
    line.iter().zip(next).filter(|(a, b)| crosses(**a, **b, point)).count() % 2 == 1
}

/// Whether the ray from a point along x crosses an edge.
pub(crate) fn crosses(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> bool {
    (a[1] > point[1]) != (b[1] > point[1]) && point[0] < a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

/// Joins edges, which may have either direction, into loops.
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
    // Open lines are followed first, beginning at their ends. The remaining edges form closed loops.
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

/// The single loop of edges that are already in order.
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
    fn a_hole_belongs_to_the_tightest_line_around_it() {
        // Two squares side by side; a square hole, and a smaller square inside it.
        let square = |x: f64, s: f64, turn: bool| {
            let mut corners = [[x - s, -s, 0.0], [x + s, -s, 0.0], [x + s, s, 0.0], [x - s, s, 0.0]];
            if turn {
                corners.reverse();
            }
            corners
        };
        let positions =
            [square(0.0, 4.0, false), square(9.0, 4.0, false), square(0.0, 2.0, true), square(0.0, 1.0, false)];
        let ring = |k: u32| Loop { nodes: (4 * k..4 * k + 4).collect(), closed: true };
        let loops: Vec<Loop> = (0..4).map(ring).collect();
        let found = parts(&loops, positions.as_flattened());
        assert_eq!(found, [vec![&loops[0], &loops[2]], vec![&loops[1]], vec![&loops[3]]]);
        // A hole without an outer line is an inverted body, and is drawn as a body.
        assert_eq!(parts(&loops[2..3], positions.as_flattened()).len(), 1);
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
