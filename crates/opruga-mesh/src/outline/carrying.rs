//! A drawing that a body in the plane carries: its areas move with the cells that contain them.

use super::filling::triangles_between;
use super::{OutlineError, Overlap, Ring, distance, joined};
use crate::skin::{Area, Skin};
use crate::{Mesh, MeshError};
use std::collections::BTreeMap;

/// The maximum mean number of bins of the grid that each cell covers; compact cells cover four. This number limits the grid to about the size of the
/// body.
const MOST_BINS: f64 = 16.0;

/// An area to be painted on a body.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Painted {
    /// The boundary of the area; rings inside other rings are holes by the even-odd rule.
    pub rings: Vec<Ring>,
    /// Red, green, blue and opacity; none for the colour of the body.
    pub colour: Option<[u8; 4]>,
}

/// Paints areas on a body, one over another. Each point belongs to the cell that contains it, or to the nearest cell.
///
/// The weights of points are bilinear in a square and barycentric in a triangle. If a body has no cells, triangles between the nodes of its outline
/// `rings` are used instead. A body of squares touches others with its outline `rings`, divided into edges of about half a cell.
///
/// # Errors
/// [`OutlineError::TooCoarse`] if the rings of a body without cells meet, [`OutlineError::Mesh`] for too many points.
pub fn carry(mesh: &mut Mesh<2>, rings: &[Ring], painted: &[Painted]) -> Result<(), OutlineError> {
    let cells: Vec<Carrier> = if mesh.cells.is_empty() {
        triangles_between(rings)?.into_iter().map(Carrier::Triangle).collect()
    } else {
        let triangles = mesh.cells.triangles.iter().map(|t| Carrier::Triangle(*t));
        triangles.chain(mesh.cells.quadrilaterals.iter().map(|q| Carrier::Square(*q))).collect()
    };
    let Some(grid) = Grid::of(&cells, &mesh.positions) else { return Ok(()) };
    let mut skin = Skin::default();
    for area in painted {
        // Rings that cross themselves are converted to rings that do not: the area between them is cut into triangles.
        let rings = area.rings.iter().filter(|ring| ring.points.len() > 2);
        let one: Vec<Ring> = rings.map(|ring| Ring { part: 0, ..ring.clone() }).collect();
        let clean = joined(&one, Overlap::EvenOdd);
        if clean.is_empty() {
            continue;
        }
        let first = skin.carriers.len() as u32;
        // Rings that touch at a point cannot be triangulated here, but can still be painted as areas.
        let triangles = triangles_between(&clean).unwrap_or_default();
        let mut made = Area {
            colour: area.colour,
            rings: Vec::new(),
            triangles: triangles.into_iter().map(|t| t.map(|point| first + point)).collect(),
        };
        for ring in &clean {
            let from = skin.carriers.len() as u32;
            for point in &ring.points {
                let (nodes, weights) = grid.carrier(*point);
                skin.carriers.push(nodes);
                skin.weights.push(weights);
            }
            made.rings.push((from..skin.carriers.len() as u32).collect());
        }
        skin.areas.push(made);
    }
    if let Some([a, b, ..]) = mesh.cells.quadrilaterals.first() {
        let side = distance(mesh.positions[*a as usize], mesh.positions[*b as usize]);
        skin.follow(&grid, &followed(rings, EDGE * side));
    }
    if skin.carriers.len() > u32::MAX as usize / 4 {
        let most = crate::MAXIMUM_NODES;
        return Err(MeshError::TooManyNodes { nodes: skin.carriers.len() as u64, most }.into());
    }
    mesh.skin = Some(skin);
    Ok(())
}

/// The length of the contact edges of a lattice, relative to the size of its cells. Longer edges would cut off curves and would not bend as the cells
/// do; shorter ones would show details that no cell has.
const EDGE: f64 = 0.5;

/// Rings with edges of about this length [m]. If edges of this length would cross, the rings of the drawing are returned, with long edges divided.
fn followed(rings: &[Ring], length: f64) -> Vec<Ring> {
    super::resampled(rings, length).unwrap_or_else(|_| {
        let cut = |ring: &Ring| {
            let pieces = ring.edges().flat_map(|(a, b)| {
                let count = (distance(a, b) / length).ceil();
                let count = if count > 1.0 { count } else { 1.0 };
                let at = move |k: u32| core::array::from_fn(|d| a[d] + f64::from(k) / count * (b[d] - a[d]));
                (0..count as u32).map(at)
            });
            Ring { points: pieces.collect(), ..ring.clone() }
        };
        rings.iter().map(cut).collect()
    })
}

impl Skin {
    /// Uses rings as the outline with which the body touches others.
    fn follow(&mut self, grid: &Grid<'_>, rings: &[Ring]) {
        for ring in rings {
            let (first, count) = (self.carriers.len() as u32, ring.points.len() as u32);
            for point in &ring.points {
                let (nodes, weights) = grid.carrier(*point);
                self.carriers.push(nodes);
                self.weights.push(weights);
            }
            self.outline.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
        }
    }
}

/// A cell that carries points.
#[derive(Clone, Copy, Debug)]
enum Carrier {
    Triangle([u32; 3]),
    /// An axis-aligned square, counter-clockwise from its lowest corner.
    Square([u32; 4]),
}

/// Cells by the bins of a grid that their boxes overlap.
struct Grid<'m> {
    cells: &'m [Carrier],
    positions: &'m [[f64; 2]],
    low: [f64; 2],
    side: f64,
    /// Columns and rows.
    counts: [i64; 2],
    bins: BTreeMap<(i64, i64), Vec<u32>>,
}

impl<'m> Grid<'m> {
    /// None if there are no cells.
    fn of(cells: &'m [Carrier], positions: &'m [[f64; 2]]) -> Option<Grid<'m>> {
        let boxes: Vec<([f64; 2], [f64; 2])> = cells.iter().map(|cell| bounds_of(cell, positions)).collect();
        let (mut low, mut high) = *boxes.first()?;
        let mut widest = 0.0;
        for (from, to) in &boxes {
            for a in 0..2 {
                low[a] = if from[a] < low[a] { from[a] } else { low[a] };
                high[a] = if to[a] > high[a] { to[a] } else { high[a] };
                widest += (to[a] - from[a]) / (2 * cells.len()) as f64;
            }
        }
        // A bin is about as wide as a cell, but there are no more than a few bins for each cell.
        let least = distance(low, high) / (2.0 * (cells.len() as f64).sqrt() + 1.0);
        let side = if widest > least { widest } else { least };
        let counts = core::array::from_fn(|a| ((high[a] - low[a]) / side).floor() as i64);
        let mut grid = Grid { cells, positions, low, side, counts, bins: BTreeMap::new() };
        // Long slanted cells overlap many bins. In this case, use fewer and wider bins, down to one.
        while grid.covered(&boxes) > MOST_BINS * cells.len() as f64 && grid.counts != [0; 2] {
            grid.side *= 2.0;
            grid.counts = core::array::from_fn(|a| ((high[a] - low[a]) / grid.side).floor() as i64);
        }
        for (number, (from, to)) in boxes.iter().enumerate() {
            let (from, to) = (grid.bin(*from), grid.bin(*to));
            for i in from.0..=to.0 {
                for j in from.1..=to.1 {
                    grid.bins.entry((i, j)).or_default().push(number as u32);
                }
            }
        }
        Some(grid)
    }

    /// The number of bins that boxes overlap, counted with repetition.
    fn covered(&self, boxes: &[([f64; 2], [f64; 2])]) -> f64 {
        let of = |(from, to): &([f64; 2], [f64; 2])| {
            let (from, to) = (self.bin(*from), self.bin(*to));
            (to.0 - from.0 + 1) as f64 * (to.1 - from.1 + 1) as f64
        };
        boxes.iter().map(of).sum()
    }

    fn bin(&self, p: [f64; 2]) -> (i64, i64) {
        let along = |a: usize| {
            let bin = ((p[a] - self.low[a]) / self.side).floor() as i64;
            bin.clamp(0, self.counts[a])
        };
        (along(0), along(1))
    }

    /// The nodes that carry a point, and their weights. The nodes belong to the nearby cell in which the smallest weight of the point is largest.
    fn carrier(&self, point: [f64; 2]) -> ([u32; 4], [f64; 4]) {
        let (i, j) = self.bin(point);
        let widest = if self.counts[0] > self.counts[1] { self.counts[0] } else { self.counts[1] };
        let mut best = (f64::NEG_INFINITY, ([0; 4], [1.0, 0.0, 0.0, 0.0]));
        for reach in 0..=widest + 1 {
            // The bins at this distance; nearer bins have already been examined.
            let columns = (i - reach..=i + reach).filter(|column| (0..=self.counts[0]).contains(column));
            let ring = columns.flat_map(|column| {
                let step = if (column - i).abs() == reach { 1 } else { 2 * reach };
                (j - reach..=j + reach).step_by(step.max(1) as usize).map(move |row| (column, row))
            });
            for cell in ring.filter_map(|bin| self.bins.get(&bin)).flatten() {
                let weighed = self.weigh(&self.cells[*cell as usize], point);
                if weighed.0 > best.0 {
                    best = weighed;
                }
            }
            // A cell that contains the point ends the search. If a nearby cell has been found, the search continues for one more bin.
            if best.0 >= 0.0 || best.0 > f64::NEG_INFINITY && reach > 0 {
                break;
            }
        }
        best.1
    }

    /// The depth of a point inside a cell (negative outside, in widths of the cell), and its carrier.
    fn weigh(&self, cell: &Carrier, point: [f64; 2]) -> (f64, ([u32; 4], [f64; 4])) {
        let at = |node: u32| self.positions[node as usize];
        match *cell {
            Carrier::Triangle([a, b, c]) => {
                let twice = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
                    (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])
                };
                let whole = twice(at(a), at(b), at(c));
                let (u, v) = (twice(point, at(b), at(c)) / whole, twice(at(a), point, at(c)) / whole);
                let weights = [u, v, 1.0 - u - v, 0.0];
                (least(&weights[..3]), ([a, b, c, c], weights))
            }
            Carrier::Square(nodes) => {
                let (low, high) = (at(nodes[0]), at(nodes[2]));
                let [s, t]: [f64; 2] = core::array::from_fn(|k| (point[k] - low[k]) / (high[k] - low[k]));
                let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
                (least(&[s, t, 1.0 - s, 1.0 - t]), (nodes, weights))
            }
        }
    }
}

fn least(numbers: &[f64]) -> f64 {
    numbers.iter().fold(f64::INFINITY, |least, x| if *x < least { *x } else { least })
}

fn bounds_of(cell: &Carrier, positions: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    let nodes: &[u32] = match cell {
        Carrier::Triangle(nodes) => nodes,
        Carrier::Square(nodes) => nodes,
    };
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for node in nodes {
        let p = positions[*node as usize];
        for a in 0..2 {
            low[a] = if p[a] < low[a] { p[a] } else { low[a] };
            high[a] = if p[a] > high[a] { p[a] } else { high[a] };
        }
    }
    (low, high)
}
