//! A tree of boxes over triangles in the order of a space-filling curve.

/// Triangles in a node of the lowest level of the tree.
const LEAF: usize = 4;

/// Lowest and highest corner.
pub(crate) type Bounds = [[f64; 3]; 2];

const NOTHING: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The squared distance of a box from a point.
pub(crate) fn distance_to(bounds: &Bounds, point: &[f64; 3]) -> f64 {
    let mut square = 0.0;
    for d in 0..3 {
        let (below, above) = (bounds[0][d] - point[d], point[d] - bounds[1][d]);
        let out = if below > 0.0 {
            below
        } else if above > 0.0 {
            above
        } else {
            0.0
        };
        square += out * out;
    }
    square
}

fn join(a: &mut Bounds, b: &Bounds) {
    for d in 0..3 {
        if b[0][d] < a[0][d] {
            a[0][d] = b[0][d];
        }
        if b[1][d] > a[1][d] {
            a[1][d] = b[1][d];
        }
    }
}

/// A complete binary tree of boxes: node 1 is the root, nodes 2n and 2n + 1 are below node n.
pub(crate) struct Tree {
    /// Nodes of the lowest level: a power of two.
    pub(crate) leaves: usize,
    pub(crate) boxes: Vec<Bounds>,
    pub(crate) facet_boxes: Vec<Bounds>,
    /// Triangles in the order of the curve.
    order: Vec<u32>,
}

impl Tree {
    /// The tree over the triangles with these corners.
    pub(crate) fn of(corners: impl ExactSizeIterator<Item = [[f64; 3]; 3]>) -> Tree {
        let mut whole = NOTHING;
        let mut facet_boxes: Vec<Bounds> = Vec::with_capacity(corners.len());
        for triangle in corners {
            let mut bounds = NOTHING;
            triangle.iter().for_each(|p| join(&mut bounds, &[*p, *p]));
            join(&mut whole, &bounds);
            facet_boxes.push(bounds);
        }
        let scale: [f64; 3] = core::array::from_fn(|d| {
            let extent = whole[1][d] - whole[0][d];
            if extent > 0.0 { 1_048_575.0 / extent } else { 0.0 }
        });
        let mut keys: Vec<(u64, u32)> = facet_boxes
            .iter()
            .enumerate()
            .map(|(number, [low, high])| {
                let cell = |d: usize| ((0.5 * low[d] + 0.5 * high[d] - whole[0][d]) * scale[d]) as u64;
                (spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2, number as u32)
            })
            .collect();
        keys.sort_unstable();
        let order: Vec<u32> = keys.into_iter().map(|(_, number)| number).collect();
        let leaves = order.len().div_ceil(LEAF).next_power_of_two();
        let mut tree = Tree { leaves, boxes: vec![NOTHING; 2 * leaves], facet_boxes, order };
        for leaf in 0..leaves {
            let mut bounds = NOTHING;
            tree.facets_of(leaf).iter().for_each(|facet| join(&mut bounds, &tree.facet_boxes[*facet as usize]));
            tree.boxes[leaves + leaf] = bounds;
        }
        for node in (1..leaves).rev() {
            let mut bounds = tree.boxes[2 * node];
            join(&mut bounds, &tree.boxes[2 * node + 1]);
            tree.boxes[node] = bounds;
        }
        tree
    }

    /// The numbers of the boxes that contain a point, ascending.
    pub(crate) fn around(&self, point: &[f64; 3]) -> Vec<u32> {
        let holds = |bounds: &Bounds| (0..3).all(|d| bounds[0][d] <= point[d] && point[d] <= bounds[1][d]);
        let (mut waiting, mut found) = (vec![1usize], Vec::new());
        while let Some(node) = waiting.pop() {
            if !holds(&self.boxes[node]) {
                continue;
            }
            if node < self.leaves {
                waiting.extend([2 * node, 2 * node + 1]);
            } else {
                let own = self.facets_of(node - self.leaves).iter();
                found.extend(own.filter(|number| holds(&self.facet_boxes[**number as usize])));
            }
        }
        found.sort_unstable();
        found
    }

    /// The triangles of a leaf.
    pub(crate) fn facets_of(&self, leaf: usize) -> &[u32] {
        let end = self.order.len();
        &self.order[(leaf * LEAF).min(end)..((leaf + 1) * LEAF).min(end)]
    }
}

/// The lower 20 bits of a number, each followed by two zeros.
fn spread(x: u64) -> u64 {
    let mut x = x & 0xf_ffff;
    x = (x | x << 32) & 0x1f_0000_0000_ffff;
    x = (x | x << 16) & 0x1f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}
