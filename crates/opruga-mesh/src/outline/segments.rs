//! A tree of boxes over the edges of closed curves. It finds the edges near a position in a time that hardly grows with the number of edges.

/// Edges in a node of the lowest level.
const LEAF: usize = 4;

/// Lowest and highest corner.
pub(super) type Bounds = [[f64; 2]; 2];

const NOTHING: Bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];

/// The box around the ends of an edge.
pub(super) fn bounds_of(a: [f64; 2], b: [f64; 2]) -> Bounds {
    let mut bounds = [a, a];
    join(&mut bounds, &[b, b]);
    bounds
}

fn join(a: &mut Bounds, b: &Bounds) {
    for axis in 0..2 {
        if b[0][axis] < a[0][axis] {
            a[0][axis] = b[0][axis];
        }
        if b[1][axis] > a[1][axis] {
            a[1][axis] = b[1][axis];
        }
    }
}

fn overlap(a: &Bounds, b: &Bounds) -> bool {
    (0..2).all(|axis| a[0][axis] <= b[1][axis] && b[0][axis] <= a[1][axis])
}

/// A complete binary tree: node 1 is the root, nodes 2n and 2n + 1 are below node n, and edges follow a space-filling curve.
pub(super) struct Segments {
    leaves: usize,
    nodes: Vec<Bounds>,
    /// The box of every edge, by its number.
    own: Vec<Bounds>,
    order: Vec<u32>,
}

impl Segments {
    /// The tree over edges with these boxes.
    pub(super) fn of(own: Vec<Bounds>) -> Segments {
        let mut whole = NOTHING;
        own.iter().for_each(|bounds| join(&mut whole, bounds));
        let scale: [f64; 2] = core::array::from_fn(|axis| {
            let extent = whole[1][axis] - whole[0][axis];
            if extent > 0.0 { 4_294_967_295.0 / extent } else { 0.0 }
        });
        let key = |[low, high]: &Bounds| {
            let cell = |axis: usize| ((0.5 * low[axis] + 0.5 * high[axis] - whole[0][axis]) * scale[axis]) as u32;
            spread(cell(0)) | spread(cell(1)) << 1
        };
        let mut keys: Vec<(u64, u32)> = own.iter().zip(0..).map(|(bounds, number)| (key(bounds), number)).collect();
        keys.sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|(_, number)| number).collect();
        let leaves = order.len().div_ceil(LEAF).next_power_of_two();
        let mut tree = Segments { leaves, nodes: vec![NOTHING; 2 * leaves], own, order };
        for leaf in 0..leaves {
            let mut bounds = NOTHING;
            tree.edges_of(leaf).iter().for_each(|edge| join(&mut bounds, &tree.own[*edge as usize]));
            tree.nodes[leaves + leaf] = bounds;
        }
        for node in (1..leaves).rev() {
            let mut bounds = tree.nodes[2 * node];
            join(&mut bounds, &tree.nodes[2 * node + 1]);
            tree.nodes[node] = bounds;
        }
        tree
    }

    fn edges_of(&self, leaf: usize) -> &[u32] {
        let end = self.order.len();
        &self.order[(leaf * LEAF).min(end)..((leaf + 1) * LEAF).min(end)]
    }

    /// Visits all edges whose box overlaps the box of a given edge; returns the number of comparisons of boxes.
    pub(super) fn beside(&self, edge: u32, mut visit: impl FnMut(u32)) -> u64 {
        let area = self.own[edge as usize];
        let (mut waiting, mut compared) = (vec![1usize], 0);
        while let Some(node) = waiting.pop() {
            compared += 1;
            if !overlap(&self.nodes[node], &area) {
                continue;
            }
            if node < self.leaves {
                waiting.extend([2 * node + 1, 2 * node]);
                continue;
            }
            for other in self.edges_of(node - self.leaves) {
                compared += 1;
                if *other != edge && overlap(&self.own[*other as usize], &area) {
                    visit(*other);
                }
            }
        }
        compared
    }

    /// Visits edges whose box intersects the ray from a point to the right, near edges first. `visit` returns how far the ray has to be followed,
    /// which is the distance to the nearest edge found so far.
    pub(super) fn along_ray(&self, from: [f64; 2], mut visit: impl FnMut(u32) -> f64) {
        let mut reach = f64::INFINITY;
        let met = |bounds: &Bounds, reach: f64| {
            bounds[0][1] <= from[1] && from[1] <= bounds[1][1] && from[0] <= bounds[1][0] && bounds[0][0] <= reach
        };
        let mut waiting = vec![1usize];
        while let Some(node) = waiting.pop() {
            if !met(&self.nodes[node], reach) {
                continue;
            }
            if node < self.leaves {
                let (mut near, mut far) = (2 * node, 2 * node + 1);
                if self.nodes[far][0][0] < self.nodes[near][0][0] {
                    (near, far) = (far, near);
                }
                waiting.extend([far, near]);
                continue;
            }
            for edge in self.edges_of(node - self.leaves) {
                if met(&self.own[*edge as usize], reach) {
                    reach = visit(*edge);
                }
            }
        }
    }
}

/// The bits of a number, each followed by a zero.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x);
    x = (x | x << 16) & 0x0000_ffff_0000_ffff;
    x = (x | x << 8) & 0x00ff_00ff_00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}
