//! Second derivatives of the distance between the closest points of two features.
//!
//! ```text
//! g = |r|,  r = Σ wᵢ xᵢ,  t_k = Σ c_ki xᵢ,  G = (Tᵀ T)⁻¹,  T = (t₁ …)
//! ρ = Σ wᵢ uᵢ,  σ_k = Σ c_ki n·uᵢ
//! u·∇²g u = ρ·(1 − n nᵀ − T G Tᵀ) ρ/g − 2 σ·G Tᵀ ρ − g σ·G σ
//! ```
//!
//! w are the weights of the closest points. The closest points may move along the features in the directions t_k: these are the differences between
//! corners with positive weights. The formula results from the minimum of |r| over these motions (implicit function theorem).

use crate::barrier::Pressed;
use crate::vector::{add, dot, length, scaled};

/// Directions whose determinant, relative to the product of their squares, is smaller than this are linearly dependent.
const DEPENDENT: f64 = 1e-9;

/// The second derivatives of the energy of a pair for displacements u of its points [N/m].
///
/// The energy changes by ½ (ρ·S ρ + 2 Σ σ_k q_k·ρ + σ·R σ), where ρ and σ are defined by the weights of the pair and by `rates`.
#[derive(Clone, Copy, Debug)]
pub struct Curvature<const D: usize> {
    /// S, over the relative motion of the closest points.
    pub matrix: [[f64; D]; D],
    /// The weights c_ki: the motion of the points along n that turns the features.
    pub rates: [[f64; 4]; 2],
    /// The vectors q_k.
    pub mixed: [[f64; D]; 2],
    /// R.
    pub turning: [[f64; 2]; 2],
}

impl<const D: usize> Curvature<D> {
    /// Second derivatives over the relative motion alone [N/m].
    pub fn along(matrix: [[f64; D]; D]) -> Self {
        Curvature { matrix, rates: [[0.0; 4]; 2], mixed: [[0.0; D]; 2], turning: [[0.0; 2]; 2] }
    }
}

impl<const D: usize> Pressed<D> {
    /// Returns the second derivatives κ m (b″ ∇g ∇gᵀ + b′ ∇²g) of the energy, including those of the distance, at the positions x [m]. The factor m
    /// counts as constant.
    pub fn curvature_with_turns(&self, x: &[[f64; D]]) -> Curvature<D> {
        let n = &self.normal;
        let at = self.points.map(|p| x[p as usize]);
        let sum = |weights: &[f64; 4]| {
            at.iter().zip(weights).fold([0.0; D], |sum, (x, w)| if *w == 0.0 { sum } else { add(&sum, &scaled(x, *w)) })
        };
        let distance = length(&sum(&self.weights));
        let (mut rates, mut count) = ([[0.0; 4]; 2], 0);
        for sign in [1.0, -1.0] {
            let mut corners = (0..4).filter(|k| sign * self.weights[*k] > 0.0);
            let Some(base) = corners.next() else { continue };
            for corner in corners {
                (rates[count][corner], rates[count][base]) = (1.0, -1.0);
                count += 1;
            }
        }
        let along = rates.map(|rates| sum(&rates));
        // G, which is zero for directions in which the closest points cannot move.
        let [aa, bb, ab] = [dot(&along[0], &along[0]), dot(&along[1], &along[1]), dot(&along[0], &along[1])];
        let determinant = aa * bb - ab * ab;
        let inverse = match count {
            2 if determinant > DEPENDENT * aa * bb => {
                [[bb / determinant, -ab / determinant], [-ab / determinant, aa / determinant]]
            }
            0 => [[0.0; 2]; 2],
            _ => [[1.0 / aa, 0.0], [0.0, 0.0]],
        };
        // b′ < 0: the force shortens what the distance resists.
        let force = self.force;
        let turned: [[f64; D]; 2] =
            [0, 1].map(|k| add(&scaled(&along[0], inverse[k][0]), &scaled(&along[1], inverse[k][1])));
        let matrix = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let unit = if i == j { 1.0 } else { 0.0 };
                let free = unit - n[i] * n[j] - along[0][i] * turned[0][j] - along[1][i] * turned[1][j];
                self.curvature * n[i] * n[j] - force / distance * free
            })
        });
        Curvature {
            matrix,
            rates,
            mixed: turned.map(|turned| scaled(&turned, force)),
            turning: inverse.map(|row| row.map(|g| force * distance * g)),
        }
    }
}
