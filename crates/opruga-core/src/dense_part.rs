//! Dense matrices that rotate with their body, in a frame that may follow its nodes.

use crate::dense::Dense;
use opruga_math::Simd;
use std::sync::Arc;

/// A dense symmetric matrix that rotates with its body: c 𝓡 A 𝓡ᵀ on a list of nodes, where 𝓡 rotates every node by R.
///
/// A is the matrix K or, if the frame follows displacements, Tᵀ K T + J Qᵀ + Q Jᵀ with T = 1 − V Jᵀ. [`Following`] describes J,
/// V and Q.
#[derive(Clone, Copy, Debug)]
pub struct DensePart<'a, const D: usize> {
    /// The factor c.
    pub factor: f64,
    /// The rotation R, by rows.
    pub frame: &'a [[f64; D]; D],
    /// The indices of the nodes of K, in its order, each once.
    pub indices: &'a [u32],
    /// K, with D rows per node.
    pub matrix: &'a Arc<Dense>,
    /// How the frame follows displacements; `None` if it does not.
    pub following: Option<&'a Following>,
}

/// A rank-one term c u uᵀ: c, and the entries of u by the indices of nodes.
pub type RankOnePart<const D: usize> = (f64, Vec<(usize, [f64; D])>);

/// How a frame follows displacements d, in the coordinates of the frame. The frame rotates about each axis by the spin θ = Jᵀ d, which displaces
/// nodes by V θ. The remainder, d − V θ, strains the body. J, V and Q have one column for each axis. Columns are stored one after the other, with
/// [`Dense::padded`] numbers each.
#[derive(Clone, Debug, Default)]
pub struct Following {
    /// The part of J that does not change with the state: the k-th column of J is Σ `mix[k][l]` times the l-th vector of
    /// `base`. The vectors keep their address, by which parts with the same vectors are recognised.
    pub base: Arc<Vec<f64>>,
    /// The part of J that changes with the state, by rows.
    pub mix: [[f64; 3]; 3],
    /// The matrix V: the displacements due to a unit spin about each axis.
    pub spins: Vec<f64>,
    /// The matrix Q, divided by the factor of the dense part: the terms due to forces that rotate with the frame.
    pub forces: Vec<f64>,
}

impl Following {
    /// Returns the matrix J, with columns of a given length.
    pub fn follows(&self, length: usize) -> Vec<f64> {
        mixed(&self.mix, &self.base, length)
    }
}

/// Returns linear combinations of consecutive vectors of a given length: the k-th is Σ `mix[k][l]` times the l-th vector of
/// `base`.
pub fn mixed(mix: &[[f64; 3]; 3], base: &[f64], length: usize) -> Vec<f64> {
    let mut out = vec![0.0; base.len()];
    for (row, out) in mix.iter().zip(out.chunks_exact_mut(length)) {
        for (weight, vector) in row.iter().zip(base.chunks_exact(length)) {
            out.iter_mut().zip(vector).for_each(|(out, x)| *out += weight * x);
        }
    }
    out
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(out: &mut [f64], factor: f64, x: &[f64]) {
    out.iter_mut().zip(x).for_each(|(out, x)| *out += factor * x);
}

impl<const D: usize> DensePart<'_, D> {
    /// Returns the product of this part with a vector x at its indices, node by node. x is given as a function of the index.
    pub fn product(&self, x: impl Fn(usize) -> [f64; D]) -> Vec<[f64; D]> {
        let length = self.matrix.padded();
        let mut turned = vec![0.0; 2 * length];
        let (own, out) = turned.split_at_mut(length);
        for (to, index) in own.chunks_exact_mut(D).zip(self.indices) {
            let x = x(*index as usize);
            for j in 0..D {
                to[j] = (0..D).map(|i| self.frame[i][j] * x[i]).sum();
            }
        }
        self.product_in_frame(own, out);
        out.chunks_exact(D).take(self.indices.len()).map(|g| self.turned_back(g)).collect()
    }
    /// Computes A x in the coordinates of the frame. Replaces x by the displacements that strain the body.
    fn product_in_frame(&self, x: &mut [f64], out: &mut [f64]) {
        let simd = Simd::best();
        let Some(following) = self.following else { return self.matrix.multiply(simd, x, out) };
        let Following { spins, forces, .. } = following;
        let length = x.len();
        let follows = following.follows(length);
        let [spin, along] =
            [&follows, forces].map(|all| -> Vec<f64> { all.chunks_exact(length).map(|j| dot(j, x)).collect() });
        for (v, spin) in spins.chunks_exact(length).zip(&spin) {
            add(x, -spin, v);
        }
        self.matrix.multiply(simd, x, out);
        let pulls: Vec<f64> = spins.chunks_exact(length).map(|v| dot(v, out)).collect();
        for (k, (j, q)) in follows.chunks_exact(length).zip(forces.chunks_exact(length)).enumerate() {
            add(out, along[k] - pulls[k], j);
            add(out, spin[k], q);
        }
    }
    /// Returns c R g for the vector g of a node.
    fn turned_back(&self, g: &[f64]) -> [f64; D] {
        core::array::from_fn(|i| self.factor * (0..D).map(|j| self.frame[i][j] * g[j]).sum::<f64>())
    }
    /// Returns the block of two nodes, given by their numbers in the list of nodes. The block does not include the terms that a
    /// following frame adds.
    pub fn block(&self, a: usize, b: usize) -> [[f64; D]; D] {
        let mut half = [[0.0; D]; D];
        let mut out = [[0.0; D]; D];
        for i in 0..D {
            for j in 0..D {
                half[i][j] = (0..D).map(|k| self.frame[i][k] * self.matrix.at(a * D + k, b * D + j)).sum();
            }
        }
        for i in 0..D {
            for j in 0..D {
                out[i][j] = self.factor * (0..D).map(|k| half[i][k] * self.frame[j][k]).sum::<f64>();
            }
        }
        out
    }
    /// The terms that a following frame adds to the blocks, as rank-one terms c u uᵀ, two for each axis. The terms of each axis
    /// cost one product with K.
    ///
    /// Tᵀ K T + J Qᵀ + Q Jᵀ = K + J Zᵀ + Z Jᵀ with Z = Q − K V + ½ J VᵀK V, and j zᵀ + z jᵀ is ½ (a j + z/a)(…)ᵀ − ½ (a j −
    /// z/a)(…)ᵀ, where a gives both vectors the same size.
    pub fn parts_of_rank_one(&self) -> Vec<RankOnePart<D>> {
        let Some(following) = self.following else { return Vec::new() };
        let (length, Following { spins, forces, .. }) = (self.matrix.padded(), following);
        let follows = following.follows(length);
        let mut pulls = vec![0.0; spins.len()];
        self.matrix.multiply(Simd::best(), spins, &mut pulls);
        let mut out = Vec::new();
        for (k, (j, q)) in follows.chunks_exact(length).zip(forces.chunks_exact(length)).enumerate() {
            let pulled = &pulls[k * length..][..length];
            let mut z: Vec<f64> = q.iter().zip(pulled).map(|(q, pulled)| q - pulled).collect();
            for (v, j) in spins.chunks_exact(length).zip(follows.chunks_exact(length)) {
                add(&mut z, 0.5 * dot(v, pulled), j);
            }
            let ratio = (dot(&z, &z) / dot(j, j)).sqrt();
            if !(ratio > 0.0 && ratio.is_finite()) {
                continue;
            }
            let a = ratio.sqrt();
            for sign in [1.0, -1.0] {
                let vector: Vec<f64> = j.iter().zip(&z).map(|(j, z)| a * j + sign * z / a).collect();
                let turned = |x: &[f64]| core::array::from_fn(|i| (0..D).map(|j| self.frame[i][j] * x[j]).sum());
                let indices = self.indices.iter().map(|index| *index as usize);
                out.push((0.5 * sign * self.factor, indices.zip(vector.chunks_exact(D).map(turned)).collect()));
            }
        }
        out
    }
}
