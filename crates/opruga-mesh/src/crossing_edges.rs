//! Edges in the plane that meet although they are not neighbours.

use crate::crossings::{Crossings, MOST_LISTED};
use robust::{Coord, orient2d};

/// Pairs of edges that cross, touch or overlap, except at nodes that they share. The side of an edge on which a point lies is determined exactly for
/// the given coordinates.
///
/// # Source
/// J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete and Computational Geometry 18
/// (1997); library robust.
pub fn crossing_edges(edges: &[[u32; 2]], positions: &[[f64; 2]]) -> Crossings {
    let at = |node: u32| positions[node as usize];
    let range = |edge: &[u32; 2], d: usize| {
        let [a, b] = edge.map(|node| at(node)[d]);
        if a < b { [a, b] } else { [b, a] }
    };
    // A sweep along x keeps only the edges that overlap the present x.
    let mut order: Vec<u32> = (0..edges.len() as u32).collect();
    order.sort_by(|a, b| range(&edges[*a as usize], 0)[0].total_cmp(&range(&edges[*b as usize], 0)[0]));
    let (mut over, mut pairs): (Vec<u32>, Vec<[u32; 2]>) = (Vec::new(), Vec::new());
    for number in order {
        let edge = &edges[number as usize];
        let ([from, _], [low, high]) = (range(edge, 0), range(edge, 1));
        over.retain(|other| range(&edges[*other as usize], 0)[1] >= from);
        for other in &over {
            let second = &edges[*other as usize];
            let [low_2, high_2] = range(second, 1);
            let apart = high_2 < low || high < low_2 || edge.iter().any(|node| second.contains(node));
            if !apart && meet(edge.map(at), second.map(at)) {
                pairs.push(if number < *other { [number, *other] } else { [*other, number] });
                if pairs.len() > MOST_LISTED {
                    pairs.sort_unstable();
                    pairs.truncate(MOST_LISTED);
                    return Crossings { pairs, complete: false };
                }
            }
        }
        over.push(number);
    }
    pairs.sort_unstable();
    Crossings { pairs, complete: true }
}

/// Whether two edges with overlapping boxes meet.
fn meet([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let side = orient2d(coord(a), coord(b), coord(c));
        i32::from(side > 0.0) - i32::from(side < 0.0)
    };
    side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0
}

fn coord([x, y]: [f64; 2]) -> Coord<f64> {
    Coord { x, y }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_cross_touch_or_overlap_are_found_and_neighbours_are_not() {
        let points = [
            [0.0, 0.0],
            [2.0, 0.0],
            [1.0, -1.0],
            [1.0, 1.0],
            [3.0, 0.0],
            [1.5, 0.0],
            [4.0, 0.0],
            [0.1, 0.1],
            [0.1, 0.9],
        ];
        let found = |edges: &[[u32; 2]]| crossing_edges(edges, &points).pairs;
        assert_eq!(found(&[[0, 1], [2, 3]]), [[0, 1]], "across");
        assert_eq!(found(&[[0, 1], [5, 3]]), [[0, 1]], "an end on the other");
        assert_eq!(found(&[[0, 1], [5, 6]]), [[0, 1]], "along one another");
        assert_eq!(found(&[[0, 1], [4, 6]]), [[0u32; 2]; 0], "on one line, apart");
        assert_eq!(found(&[[0, 1], [1, 3]]), [[0u32; 2]; 0], "neighbours");
        assert_eq!(found(&[[0, 1], [7, 8]]), [[0u32; 2]; 0], "beside");
    }
}
