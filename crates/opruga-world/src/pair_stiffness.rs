//! The second derivatives of the energies between bodies: a matrix for each pair, over the coordinates of its nodes.
//!
//! ```text
//! y += Gᵀ S G x,   S = κ m b″ n nᵀ, or ∂²D/∂s² of friction
//! ```
//!
//! G maps the coordinates to the relative motion of a pair. S is the stiffness of the barrier along the normal n of the pair (`opruga_collide`,
//! `barrier.rs`), or the stiffness of its friction energy D over the slip s.

use opruga_collide::{Pressed, Rubbing, Surface};

/// The matrices of all pairs whose matrix is not zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairStiffness<const D: usize> {
    pairs: Vec<Pair<D>>,
    /// The first coordinate of each node and the weight of the node, ordered by pair.
    nodes: Vec<(u32, f64)>,
}

#[derive(Clone, Copy, Debug)]
struct Pair<const D: usize> {
    /// The end of its range of nodes.
    end: u32,
    /// S [N/m].
    matrix: [[f64; D]; D],
    /// The remaining relative displacement of its points on obstacles [m].
    obstacles: [f64; D],
}

impl<const D: usize> PairStiffness<D> {
    /// Takes the pairs under pressure, and their friction after these displacements [m]. `coordinates` contains the body and first coordinate of each
    /// point, and `ahead` the remaining displacements of points on obstacles [m].
    pub(crate) fn take(
        &mut self,
        (pressed, rubbing): (&[Pressed<D>], &[Rubbing<D>]),
        moved: &[[f64; D]],
        (surface, coordinates): (&Surface<D>, &[Option<(usize, usize)>]),
        ahead: &[[f64; D]],
    ) {
        self.pairs.clear();
        self.nodes.clear();
        let mut add = |points: &[u32; 4], weights: &[f64; 4], matrix| {
            let mut obstacles = [0.0; D];
            for (p, w) in points.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
                (0..D).for_each(|d| obstacles[d] += w * ahead[*p as usize][d]);
                surface.visit_nodes(*p, |node, share| {
                    if let Some((_, at)) = coordinates[node as usize] {
                        self.nodes.push((at as u32, w * share));
                    }
                });
            }
            self.pairs.push(Pair { end: self.nodes.len() as u32, matrix, obstacles });
        };
        for pair in pressed.iter().filter(|pair| pair.curvature != 0.0) {
            let n = &pair.normal;
            let matrix = core::array::from_fn(|i| core::array::from_fn(|j| pair.curvature * n[i] * n[j]));
            add(&pair.points, &pair.weights, matrix);
        }
        for rub in rubbing {
            // The columns of a symmetric matrix are its rows.
            let slip = rub.slip(moved);
            let unit = |d: usize| core::array::from_fn(|k| f64::from(u8::from(k == d)));
            add(&rub.points, &rub.weights, core::array::from_fn(|d| rub.stiffen(&slip, &unit(d))));
        }
    }

    /// The work of the forces S G x on the motion of obstacles, which is part of G x [J].
    pub(crate) fn work_on_obstacles(&self, x: &[f64]) -> f64 {
        let (mut first, mut work) = (0, 0.0);
        for pair in &self.pairs {
            let nodes = &self.nodes[first..pair.end as usize];
            first = pair.end as usize;
            let force = pair.force(nodes, x, true);
            (0..D).for_each(|d| work += pair.obstacles[d] * force[d]);
        }
        work
    }

    /// y += Gᵀ S G x; `with_obstacles` includes the motion of obstacles.
    pub(crate) fn multiply(&self, x: &[f64], with_obstacles: bool, y: &mut [f64]) {
        let mut first = 0;
        for pair in &self.pairs {
            let nodes = &self.nodes[first..pair.end as usize];
            first = pair.end as usize;
            let force = pair.force(nodes, x, with_obstacles);
            for (at, weight) in nodes {
                let y = &mut y[*at as usize..*at as usize + D];
                (0..D).for_each(|d| y[d] += weight * force[d]);
            }
        }
    }
}

impl<const D: usize> Pair<D> {
    /// S G x for the pair with these nodes; `with_obstacles` includes the motion of obstacles.
    fn force(&self, nodes: &[(u32, f64)], x: &[f64], with_obstacles: bool) -> [f64; D] {
        let mut motion = if with_obstacles { self.obstacles } else { [0.0; D] };
        for (at, weight) in nodes {
            let x = &x[*at as usize..*at as usize + D];
            (0..D).for_each(|d| motion[d] += weight * x[d]);
        }
        core::array::from_fn(|i| (0..D).map(|j| self.matrix[i][j] * motion[j]).sum::<f64>())
    }
}
