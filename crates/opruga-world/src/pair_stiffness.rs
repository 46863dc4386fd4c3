//! The second derivatives of the energies between bodies: blocks over the nodes of pairs.
//!
//! ```text
//! K = Σ Gᵀ S G,   S = κ m b″ n nᵀ, or ∂²D/∂s² of friction
//! ```
//!
//! G maps the coordinates to the relative motion of a pair. S is the stiffness of the barrier along the normal n of the pair (`opruga_collide`,
//! `barrier.rs`), or the stiffness of its friction energy D over the slip s. With the second derivatives of the distance, G also contains the rates at
//! which the features turn (`opruga_collide`, `curvature.rs`). Many pairs share the nodes of a corner, so their sum has far fewer blocks than the pairs
//! have together.

use opruga_collide::{Curvature, Pressed, Rubbing, Surface};
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
    /// The nodes of a pair.
    nodes: Vec<Node>,
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

/// A node of a pair: its first coordinate, its share of the relative motion, and its shares of the rates.
#[derive(Clone, Copy, Debug)]
struct Node {
    at: u32,
    weight: f64,
    rates: [f64; 2],
}

/// The surface of a scene, the body and first coordinate of every point, and the remaining displacements of points on obstacles [m].
pub(crate) struct Points<'a, const D: usize> {
    pub(crate) surface: &'a Surface<D>,
    pub(crate) coordinates: &'a [Option<(usize, usize)>],
    pub(crate) ahead: &'a [[f64; D]],
}

impl<const D: usize> PairStiffness<D> {
    /// Takes the pairs under pressure at positions x [m], and their friction after the displacements `moved` [m], for a number of coordinates. If
    /// `turns` is set, includes the second derivatives of the distances; the matrix may then have negative eigenvalues.
    pub(crate) fn take(
        &mut self,
        (pressed, rubbing): (&[Pressed<D>], &[Rubbing<D>]),
        [x, moved]: [&[[f64; D]]; 2],
        points: &Points<'_, D>,
        (length, turns): (usize, bool),
    ) {
        self.blocks.clear();
        self.last.clear();
        self.last.resize(length / D, NONE);
        self.by_obstacles.clear();
        self.by_obstacles.resize(length, 0.0);
        self.work = 0.0;
        for pair in pressed.iter().filter(|pair| pair.curvature != 0.0) {
            let n = &pair.normal;
            let curvature = if turns {
                pair.curvature_with_turns(x)
            } else {
                Curvature::along(std::array::from_fn(|i| std::array::from_fn(|j| pair.curvature * n[i] * n[j])))
            };
            self.add((&pair.points, &pair.weights, n), &curvature, points);
        }
        for rub in rubbing {
            // The columns of a symmetric matrix are its rows.
            let slip = rub.slip(moved);
            let unit = |d: usize| std::array::from_fn(|k| f64::from(u8::from(k == d)));
            let curvature = Curvature::along(std::array::from_fn(|d| rub.stiffen(&slip, &unit(d))));
            self.add((&rub.points, &rub.weights, &rub.normal), &curvature, points);
        }
    }

    /// Adds the matrix of a pair with the given points, weights and normal.
    fn add(
        &mut self,
        (own, weights, normal): (&[u32; 4], &[f64; 4], &[f64; D]),
        curvature: &Curvature<D>,
        points: &Points<'_, D>,
    ) {
        let Curvature { matrix, rates, mixed, turning } = curvature;
        let turns = *rates != [[0.0; 4]; 2];
        // The motion of obstacles, and the rates that it causes.
        let (mut along, mut turned, mut moves) = ([0.0; D], [0.0; 2], false);
        self.nodes.clear();
        for (k, (p, weight)) in own.iter().zip(weights).enumerate().filter(|(_, (_, w))| **w != 0.0) {
            let ahead = &points.ahead[*p as usize];
            if *ahead != [0.0; D] {
                moves = true;
                let across = dot(normal, ahead);
                (0..D).for_each(|d| along[d] += weight * ahead[d]);
                (0..2).for_each(|q| turned[q] += rates[q][k] * across);
            }
            points.surface.visit_nodes(*p, |index, share| {
                if let Some((_, at)) = points.coordinates[index as usize] {
                    let rates = [rates[0][k] * share, rates[1][k] * share];
                    self.nodes.push(Node { at: at as u32, weight: weight * share, rates });
                }
            });
        }
        let nodes = std::mem::take(&mut self.nodes);
        for from in &nodes {
            // The forces of the pair for unit displacements of a node, one per row, and the moments.
            let force: [[f64; D]; D] = std::array::from_fn(|i| {
                let turned: f64 = (0..2).map(|q| from.rates[q] * mixed[q][i]).sum();
                std::array::from_fn(|j| from.weight * matrix[i][j] + turned * normal[j])
            });
            let moment: [[f64; D]; 2] = std::array::from_fn(|q| {
                let turned: f64 = (0..2).map(|r| from.rates[r] * turning[q][r]).sum();
                std::array::from_fn(|j| from.weight * mixed[q][j] + turned * normal[j])
            });
            for to in nodes.iter().filter(|to| to.at >= from.at) {
                let block = self.block(to.at, from.at);
                for i in 0..D {
                    (0..D).for_each(|j| block[i][j] += to.weight * force[i][j]);
                }
                if turns {
                    for j in 0..D {
                        let turned: f64 = (0..2).map(|q| to.rates[q] * moment[q][j]).sum();
                        (0..D).for_each(|i| block[i][j] += normal[i] * turned);
                    }
                }
            }
        }
        if moves {
            let force: [f64; D] =
                std::array::from_fn(|i| dot(&matrix[i], &along) + (0..2).map(|q| mixed[q][i] * turned[q]).sum::<f64>());
            let moment: [f64; 2] = std::array::from_fn(|q| dot(&mixed[q], &along) + dot(&turning[q], &turned));
            for node in &nodes {
                let across = dot(&node.rates, &moment);
                let forces = &mut self.by_obstacles[node.at as usize..node.at as usize + D];
                (0..D).for_each(|d| forces[d] += node.weight * force[d] + across * normal[d]);
            }
            self.work += dot(&along, &force) + dot(&turned, &moment);
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
