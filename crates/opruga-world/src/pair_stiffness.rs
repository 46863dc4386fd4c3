//! The second derivatives of the energies between bodies: blocks over the nodes of pairs.
//!
//! ```text
//! K = Σ Gᵀ S G,   S = κ m b″ n nᵀ, or ∂²D/∂s² of friction
//! ```
//!
//! G maps the coordinates to the relative motion of a pair. S is the stiffness of the barrier along the normal n of the pair (`opruga_collide`,
//! `barrier.rs`), or the stiffness of its friction energy D over the slip s. Many pairs share the nodes of a corner, so their sum has far fewer blocks
//! than the pairs have together.

use opruga_collide::{Pressed, Rubbing, Surface};
use opruga_solve::dot;

/// The sum of the matrices of all pairs.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairStiffness<const D: usize> {
    /// The blocks whose row is not above their column, in the order in which pairs need them.
    blocks: Vec<Block<D>>,
    /// The last block of the row of every node, or `NONE`.
    last: Vec<u32>,
    /// The forces that the remaining motion of obstacles exerts on all coordinates [N], and the work of these forces on the obstacles [J].
    by_obstacles: Vec<f64>,
    work: f64,
    /// The nodes of a pair: their first coordinates, and their shares of the relative motion.
    nodes: Vec<(u32, f64)>,
}

/// A block of the matrix.
#[derive(Clone, Copy, Debug)]
struct Block<const D: usize> {
    /// The first coordinates of its two nodes.
    row: u32,
    column: u32,
    /// The previous block of the same row, or `NONE`.
    before: u32,
    matrix: [[f64; D]; D],
}

const NONE: u32 = u32::MAX;

/// The surface of a scene, the body and first coordinate of every point, and the remaining displacements of points on obstacles [m].
pub(crate) struct Points<'a, const D: usize> {
    pub(crate) surface: &'a Surface<D>,
    pub(crate) coordinates: &'a [Option<(usize, usize)>],
    pub(crate) ahead: &'a [[f64; D]],
}

impl<const D: usize> PairStiffness<D> {
    /// Takes the pairs under pressure, and their friction after the displacements `moved` [m], for a number of coordinates.
    pub(crate) fn take(
        &mut self,
        (pressed, rubbing): (&[Pressed<D>], &[Rubbing<D>]),
        moved: &[[f64; D]],
        points: &Points<'_, D>,
        length: usize,
    ) {
        self.blocks.clear();
        self.last.clear();
        self.last.resize(length / D, NONE);
        self.by_obstacles.clear();
        self.by_obstacles.resize(length, 0.0);
        self.work = 0.0;
        for pair in pressed.iter().filter(|pair| pair.curvature != 0.0) {
            let n = &pair.normal;
            let matrix = std::array::from_fn(|i| std::array::from_fn(|j| pair.curvature * n[i] * n[j]));
            self.add((&pair.points, &pair.weights), &matrix, points);
        }
        for rub in rubbing {
            // The columns of a symmetric matrix are its rows.
            let slip = rub.slip(moved);
            let unit = |d: usize| std::array::from_fn(|k| f64::from(u8::from(k == d)));
            self.add((&rub.points, &rub.weights), &std::array::from_fn(|d| rub.stiffen(&slip, &unit(d))), points);
        }
    }

    /// Adds the matrix S of a pair with the given points and weights.
    fn add(&mut self, (own, weights): (&[u32; 4], &[f64; 4]), matrix: &[[f64; D]; D], points: &Points<'_, D>) {
        let mut obstacles = [0.0; D];
        let mut nodes = std::mem::take(&mut self.nodes);
        nodes.clear();
        for (p, weight) in own.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            (0..D).for_each(|d| obstacles[d] += weight * points.ahead[*p as usize][d]);
            points.surface.visit_nodes(*p, |index, share| {
                if let Some((_, at)) = points.coordinates[index as usize] {
                    nodes.push((at as u32, weight * share));
                }
            });
        }
        for (from, weight) in &nodes {
            for (to, other) in nodes.iter().filter(|(to, _)| to >= from) {
                let block = self.block(*to, *from);
                for i in 0..D {
                    (0..D).for_each(|j| block[i][j] += other * weight * matrix[i][j]);
                }
            }
        }
        if obstacles != [0.0; D] {
            let force: [f64; D] = std::array::from_fn(|i| dot(&matrix[i], &obstacles));
            for (at, weight) in &nodes {
                let forces = &mut self.by_obstacles[*at as usize..*at as usize + D];
                (0..D).for_each(|d| forces[d] += weight * force[d]);
            }
            self.work += dot(&obstacles, &force);
        }
        self.nodes = nodes;
    }

    /// The block of two nodes, which is zero at first.
    fn block(&mut self, row: u32, column: u32) -> &mut [[f64; D]; D] {
        let last = self.last[row as usize / D];
        let mut k = last;
        while k != NONE && self.blocks[k as usize].column != column {
            k = self.blocks[k as usize].before;
        }
        if k == NONE {
            k = self.blocks.len() as u32;
            self.blocks.push(Block { row, column, before: last, matrix: [[0.0; D]; D] });
            self.last[row as usize / D] = k;
        }
        &mut self.blocks[k as usize].matrix
    }

    /// The work of the forces K x and of those of obstacles on the motion of obstacles [J].
    pub(crate) fn work_on_obstacles(&self, x: &[f64]) -> f64 {
        dot(&self.by_obstacles, x) + self.work
    }

    /// y += K x; `with_obstacles` includes the forces that the motion of obstacles exerts.
    pub(crate) fn multiply(&self, x: &[f64], with_obstacles: bool, y: &mut [f64]) {
        for Block { row, column, matrix, .. } in &self.blocks {
            let [row, column] = [*row as usize, *column as usize];
            let from: [f64; D] = std::array::from_fn(|d| x[column + d]);
            for i in 0..D {
                y[row + i] += (0..D).map(|j| matrix[i][j] * from[j]).sum::<f64>();
            }
            if row != column {
                let from: [f64; D] = std::array::from_fn(|d| x[row + d]);
                for j in 0..D {
                    y[column + j] += (0..D).map(|i| matrix[i][j] * from[i]).sum::<f64>();
                }
            }
        }
        if with_obstacles {
            y.iter_mut().zip(&self.by_obstacles).for_each(|(y, force)| *y += force);
        }
    }
}
