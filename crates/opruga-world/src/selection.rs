//! Converts a [`Selector`] to node numbers.

use crate::blueprint::Selector;
use opruga_mesh::Mesh;

/// The tolerance of selections relative to the extent of the body, so that rounding of coordinates does not decide.
const TOLERANCE: f64 = 1e-9;

impl<const D: usize> Selector<D> {
    /// The numbers of the selected nodes, ascending. Node i is at `mesh.positions[i] + translation`.
    ///
    /// Node numbers beyond the last node select nothing, and neither do groups that the mesh does not have.
    pub fn resolve(&self, mesh: &Mesh<D>, translation: &[f64; D]) -> Vec<u32> {
        let (low, high) = extent(mesh);
        let reach = (0..D).map(|a| high[a] - low[a]).fold(0.0, |m, x| if x > m { x } else { m }) * TOLERANCE;
        let mask = self.mask(mesh, *translation, low, high, reach);
        mask.iter().enumerate().filter(|(_, inside)| **inside).map(|(k, _)| k as u32).collect()
    }

    /// The same set for a body that was moved: positions move with it, numbers and names stay the same.
    #[must_use]
    pub fn moved(&self, by: [f64; D]) -> Selector<D> {
        let add = |x: &[f64; D]| core::array::from_fn(|a| x[a] + by[a]);
        match self {
            Selector::Box(low, high) => Selector::Box(add(low), add(high)),
            Selector::Ball { center, radius } => Selector::Ball { center: add(center), radius: *radius },
            Selector::HalfSpace { point, normal } => Selector::HalfSpace { point: add(point), normal: *normal },
            Selector::And(sets) => Selector::And(sets.iter().map(|s| s.moved(by)).collect()),
            Selector::Or(sets) => Selector::Or(sets.iter().map(|s| s.moved(by)).collect()),
            Selector::Not(set) => Selector::Not(Box::new(set.moved(by))),
            Selector::Side(_) | Selector::Nodes(_) | Selector::Group(_) | Selector::Boundary | Selector::All => {
                self.clone()
            }
        }
    }

    fn mask(&self, mesh: &Mesh<D>, translation: [f64; D], low: [f64; D], high: [f64; D], reach: f64) -> Vec<bool> {
        let count = mesh.positions.len();
        let each = |inside: &dyn Fn([f64; D]) -> bool| -> Vec<bool> {
            mesh.positions.iter().map(|x| inside(core::array::from_fn(|a| x[a] + translation[a]))).collect()
        };
        let numbered = |nodes: &mut dyn Iterator<Item = u32>| {
            let mut mask = vec![false; count];
            for node in nodes {
                if let Some(inside) = mask.get_mut(node as usize) {
                    *inside = true;
                }
            }
            mask
        };
        match self {
            Selector::Box(a, b) => each(&|x| {
                (0..D).all(|k| {
                    let (least, greatest) = if a[k] < b[k] { (a[k], b[k]) } else { (b[k], a[k]) };
                    x[k] >= least - reach && x[k] <= greatest + reach
                })
            }),
            Selector::Ball { center, radius } => each(&|x| {
                let square: f64 = (0..D).map(|k| (x[k] - center[k]) * (x[k] - center[k])).sum();
                square.sqrt() <= radius + reach
            }),
            Selector::HalfSpace { point, normal } => {
                let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
                each(&|x| (0..D).map(|k| (x[k] - point[k]) * normal[k]).sum::<f64>() >= -reach * length)
            }
            Selector::Side(side) => {
                let Some((axis, upper)) = side_of(side) else { return vec![false; count] };
                if axis >= D {
                    return vec![false; count];
                }
                mesh.positions
                    .iter()
                    .map(|x| if upper { x[axis] >= high[axis] - reach } else { x[axis] <= low[axis] + reach })
                    .collect()
            }
            Selector::Nodes(nodes) => numbered(&mut nodes.iter().copied()),
            Selector::Group(name) => numbered(&mut group(mesh, name).iter().copied()),
            Selector::Boundary => numbered(&mut boundary(mesh).into_iter()),
            Selector::All => vec![true; count],
            Selector::And(sets) => sets.iter().map(|s| s.mask(mesh, translation, low, high, reach)).fold(
                vec![true; count],
                |mut all, one| {
                    all.iter_mut().zip(one).for_each(|(a, b)| *a &= b);
                    all
                },
            ),
            Selector::Or(sets) => sets.iter().map(|s| s.mask(mesh, translation, low, high, reach)).fold(
                vec![false; count],
                |mut any, one| {
                    any.iter_mut().zip(one).for_each(|(a, b)| *a |= b);
                    any
                },
            ),
            Selector::Not(set) => set.mask(mesh, translation, low, high, reach).into_iter().map(|b| !b).collect(),
        }
    }
}

/// Axis and end of a side of the bounding box, given by its name.
pub fn side_of(name: &str) -> Option<(usize, bool)> {
    Some(match name {
        "left" => (0, false),
        "right" => (0, true),
        "bottom" => (1, false),
        "top" => (1, true),
        "back" => (2, false),
        "front" => (2, true),
        _ => return None,
    })
}

/// The nodes of the boundary: the nodes of the facets; for an open surface, the nodes of edges with only one triangle; for a chain, its free ends.
fn boundary<const D: usize>(mesh: &Mesh<D>) -> Vec<u32> {
    let mut nodes: Vec<u32> = mesh.facets.iter().flatten().copied().collect();
    let mut edges: Vec<[u32; 2]> = mesh
        .sheets
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| if a < b { [a, b] } else { [b, a] })
        .collect();
    edges.sort_unstable();
    nodes.extend(edges.chunk_by(|p, q| p == q).filter(|same| same.len() == 1).flat_map(|same| same[0]));
    let mut ends: Vec<u32> = mesh.wires.iter().flatten().copied().collect();
    ends.sort_unstable();
    nodes.extend(ends.chunk_by(|p, q| p == q).filter(|same| same.len() == 1).map(|same| same[0]));
    nodes
}

/// The nodes of a named group.
fn group<'m, const D: usize>(mesh: &'m Mesh<D>, name: &str) -> &'m [u32] {
    mesh.groups.get(name).map_or(&[], Vec::as_slice)
}

/// The corners of the bounding box of a mesh; zeros if it has no nodes.
pub fn extent<const D: usize>(mesh: &Mesh<D>) -> ([f64; D], [f64; D]) {
    let Some(first) = mesh.positions.first() else { return ([0.0; D], [0.0; D]) };
    let (mut low, mut high) = (*first, *first);
    for x in &mesh.positions {
        for a in 0..D {
            if x[a] < low[a] {
                low[a] = x[a];
            }
            if x[a] > high[a] {
                high[a] = x[a];
            }
        }
    }
    (low, high)
}

/// The longest side of the bounding box of a mesh [m]; zero if it has no nodes.
pub fn longest_side<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let (low, high) = extent(mesh);
    (0..D).map(|a| high[a] - low[a]).fold(0.0, |most, side| if side > most { side } else { most })
}
