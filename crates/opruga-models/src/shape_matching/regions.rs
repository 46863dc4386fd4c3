//! The sets of nodes that are matched together: the whole body, overlapping boxes of it, or groups of its mesh.

use super::refusals::Refusal;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;

/// The largest number of boxes per node.
const MOST_BOXES_PER_NODE: usize = 8;

/// A node counts as lying on the face of a box if their distance is below this fraction of half the size of the box.
const FACE: f64 = 1e-9;

/// The nodes of every cluster, ascending.
pub(super) fn clusters<const D: usize>(mesh: &Mesh<D>, values: &Values) -> Result<Vec<Vec<u32>>, Refusal> {
    let nodes = mesh.positions.len();
    if let Some(names) = values.text("groups") {
        return groups(mesh, names);
    }
    match values.number("region") {
        Some(region) => boxes(&mesh.positions, region),
        None => Ok(vec![(0..nodes as u32).collect()]),
    }
}

fn groups<const D: usize>(mesh: &Mesh<D>, names: &str) -> Result<Vec<Vec<u32>>, Refusal> {
    let mut out = Vec::new();
    let mut covered = vec![false; mesh.positions.len()];
    for name in names.split(',').map(str::trim) {
        let Some(group) = mesh.groups.get(name) else {
            let known: Vec<_> = mesh.groups.keys().map(|known| format!("`{known}`")).collect();
            let known = if known.is_empty() { "none, the mesh has no groups".into() } else { known.join(", ") };
            return Err(Refusal::NoGroup { name: name.into(), known });
        };
        let mut own = group.clone();
        own.sort_unstable();
        own.dedup();
        own.iter().for_each(|node| covered[*node as usize] = true);
        out.push(own);
    }
    match covered.iter().position(|covered| !covered) {
        None => Ok(out),
        Some(first) => {
            let missed = covered.iter().filter(|covered| !**covered).count();
            Err(Refusal::Misses { missed, nodes: covered.len(), first })
        }
    }
}

/// Boxes that overlap by half along every axis and cover the body evenly. Empty boxes are left out.
///
/// ```text
/// |----- box 0 -----|
///          |----- box 1 -----|
/// low               |----- box 2 -----| high
/// ```
fn boxes<const D: usize>(positions: &[[f64; D]], region: f64) -> Result<Vec<Vec<u32>>, Refusal> {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for x in positions {
        for d in 0..D {
            low[d] = if x[d] < low[d] { x[d] } else { low[d] };
            high[d] = if x[d] > high[d] { x[d] } else { high[d] };
        }
    }
    // The number of half boxes along each axis; the number of boxes is one less.
    let mut halves = [1.0; D];
    let mut number = 1.0;
    for d in 0..D {
        halves[d] = (2.0 * (high[d] - low[d]) / region).ceil();
        halves[d] = if halves[d] < 2.0 { 2.0 } else { halves[d] };
        number *= halves[d] - 1.0;
    }
    let most = MOST_BOXES_PER_NODE * positions.len();
    if number > most as f64 {
        return Err(Refusal::TooManyRegions { region, boxes: number, nodes: positions.len(), most });
    }
    let counts: [usize; D] = core::array::from_fn(|d| halves[d] as usize - 1);
    let mut out = vec![Vec::new(); counts.iter().product()];
    for (node, x) in positions.iter().enumerate() {
        // The boxes along each axis that contain the node, including their faces, so that a mirrored body has mirrored boxes.
        let (mut first, mut last) = ([0; D], [0; D]);
        for d in 0..D {
            let length = high[d] - low[d];
            let part = if length > 0.0 { (x[d] - low[d]) / length * halves[d] } else { 0.0 };
            first[d] = (part - 2.0 - FACE).ceil() as usize;
            last[d] = ((part + FACE) as usize).min(counts[d] - 1);
        }
        let mut at = first;
        loop {
            out[(0..D).fold(0, |sum, d| sum * counts[d] + at[d])].push(node as u32);
            let Some(next) = (0..D).rev().find(|d| at[*d] < last[*d]) else { break };
            at[next] += 1;
            at[next + 1..].copy_from_slice(&first[next + 1..]);
        }
    }
    out.retain(|nodes| !nodes.is_empty());
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_overlap_by_half_and_cover_every_node() {
        let line: Vec<[f64; 2]> = (0..=8).map(|k| [f64::from(k), 0.0]).collect();
        let found = boxes(&line, 4.0).unwrap();
        assert_eq!(found, [vec![0, 1, 2, 3, 4], vec![2, 3, 4, 5, 6], vec![4, 5, 6, 7, 8]]);
        let one = boxes(&line, 100.0).unwrap();
        assert_eq!(one, [(0..9).collect::<Vec<u32>>()]);
        assert!(matches!(boxes(&line, 1e-3), Err(Refusal::TooManyRegions { .. })));
    }

    #[test]
    fn in_space_a_node_inside_is_in_eight_boxes() {
        let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [9, 9, 9]).unwrap();
        let found = boxes(&mesh.positions, 0.5).unwrap();
        assert_eq!(found.len(), 27);
        let mut times = vec![0; mesh.positions.len()];
        found.iter().flatten().for_each(|node| times[*node as usize] += 1);
        assert_eq!((times.iter().min(), times.iter().max()), (Some(&1), Some(&8)));
    }
}
