//! Cells of the law `linear` that have rotated.
//!
//! The strain of small motions is ε = sym F − 1. A rotation by θ has sym F = cos θ 1 in the plane perpendicular to its axis. The law treats this as a
//! strain of cos θ − 1, whose pressure makes the body grow. The criterion is the rotation of every cell: the rotation nearest to its F (polar
//! decomposition). The tip of a bar under large bending rotates, although the bar as a whole hardly does.

use crate::other_balances::{in_space, turn_in_plane, turn_in_space};
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_core::spec::Role;

/// The code of the warning.
const TURNED: &str = "law.turned";

/// The cosine of 20°. Rotations by more than this angle count, because the law treats a rotation by 20° as a strain of 6 %, which is beyond its
/// range.
const FAR: f64 = 0.939_692_620_785_908_4;

/// |R − 1|² of a rotation by 20°: 4 (1 − cos θ).
const FAR_SQUARED: f64 = 4.0 * (1.0 - FAR);

/// The cell of a body with the largest rotation.
#[derive(Clone, Copy, Debug)]
struct Turned {
    cell: u32,
    cosine: f64,
}

impl<const D: usize> World<D> {
    /// Warns about bodies with cells of the law `linear` that have rotated by more than 20°. The warning is issued once, with the largest rotation so
    /// far, and counts frames and bodies. Nothing is allocated unless there is a warning.
    pub(crate) fn warn_of_turned_cells(&mut self) {
        let (mut worst, mut count): (Option<(usize, Turned)>, u64) = (None, 0);
        for body in 0..self.blueprint.bodies.len() {
            let models = &self.blueprint.bodies[body].models;
            if models
                .iter()
                .any(|model| model.spec().has_role(Role::OwnsCells) && model.text("material") == Some("linear"))
                && self.handle(body).is_some()
                && let Some(turned) = self.farthest_turned(body)
            {
                count += 1;
                if worst.is_none_or(|(_, known)| turned.cosine < known.cosine) {
                    worst = Some((body, turned));
                }
            }
        }
        let Some((body, Turned { cell, cosine })) = worst else { return };
        let before = self.warnings.iter().position(|warning| warning.code == TURNED);
        if before.is_some() && cosine >= self.farthest_turn {
            self.warnings[before.unwrap_or_default()].count += count;
            return;
        }
        self.farthest_turn = cosine;
        let warning = WorldWarning::Turned {
            time: self.time(),
            cell,
            body: self.blueprint.bodies[body].name.clone(),
            angle: libm::acos(cosine).to_degrees(),
            strain: 100.0 * (cosine - 1.0),
        };
        match before {
            Some(known) => self.warnings[known] = Warning::new(warning, self.warnings[known].count + count),
            None => self.warnings.push(Warning::new(warning, count)),
        }
    }

    /// The cell of a body under the law `linear` with the largest rotation, if that is large.
    fn farthest_turned(&self, body: usize) -> Option<Turned> {
        let own = &self.blueprint.bodies[body];
        let mut worst: Option<Turned> = None;
        for model in
            own.models.iter().filter(|m| m.spec().has_role(Role::OwnsCells) && m.text("material") == Some("linear"))
        {
            let group = model.text("cells").and_then(|name| own.mesh.cell_groups.get(name));
            for (cell, (_, _, nodes)) in own.mesh.cells.iter().enumerate() {
                let cell = cell as u32;
                if group.is_some_and(|group| group.binary_search(&cell).is_err()) {
                    continue;
                }
                let rest = axes(nodes, |node| own.mesh.positions[node as usize]);
                let now = axes(nodes, |node| self.position(body, node));
                let Some(gradient) = gradient(&rest, &now) else { continue };
                if let Some(cosine) = turned_far::<D>(&gradient)
                    && worst.is_none_or(|known| cosine < known.cosine)
                {
                    worst = Some(Turned { cell, cosine });
                }
            }
        }
        worst
    }
}

/// The axes of a cell, as rows: for triangles and tetrahedra the sides from the first corner, for boxes the mean sides.
fn axes<const D: usize>(nodes: &[u32], at: impl Fn(u32) -> [f64; D]) -> [[f64; 3]; 3] {
    let mut out = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    if nodes.len() == 1 << D {
        let high = |k: usize, axis: usize| [matches!(k % 4, 1 | 2), k % 4 >= 2, k >= 4][axis];
        for (k, node) in nodes.iter().enumerate() {
            let x = in_space(&at(*node));
            for (axis, row) in out.iter_mut().enumerate().take(D) {
                for (to, x) in row.iter_mut().zip(x) {
                    *to += if high(k, axis) { x } else { -x };
                }
            }
        }
        return out;
    }
    let first = in_space(&at(nodes[0]));
    for (row, node) in out.iter_mut().zip(&nodes[1..]).take(D) {
        let x = in_space(&at(*node));
        *row = core::array::from_fn(|d| x[d] - first[d]);
    }
    out
}

/// F, row by row, from the axes of a cell at rest and the present axes; `None` for a cell without volume at rest.
fn gradient(rest: &[[f64; 3]; 3], now: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cross = |a: &[f64; 3], b: &[f64; 3]| -> [f64; 3] {
        core::array::from_fn(|d| a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3])
    };
    // The vectors dual to the axes at rest.
    let dual: [[f64; 3]; 3] = core::array::from_fn(|k| cross(&rest[(k + 1) % 3], &rest[(k + 2) % 3]));
    let volume: f64 = (0..3).map(|d| rest[0][d] * dual[0][d]).sum();
    let f = core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| now[k][i] * dual[k][j] / volume).sum()));
    (volume != 0.0).then_some(f)
}

/// The cosine of the angle of the rotation nearest to F, if the angle is more than 20°.
fn turned_far<const D: usize>(f: &[[f64; 3]; 3]) -> Option<f64> {
    // No rotation is nearer to F than R, so |R − 1| ≤ 2 |F − 1|, and most cells need no decomposition.
    let mut off = 0.0;
    for (i, row) in f.iter().enumerate() {
        for (j, x) in row.iter().enumerate() {
            let difference = if i == j { x - 1.0 } else { *x };
            off += difference * difference;
        }
    }
    // NaN has no rotation.
    let may_be_far = 4.0 * off > FAR_SQUARED;
    if !(may_be_far && off.is_finite()) {
        return None;
    }
    let transposed = core::array::from_fn(|i| core::array::from_fn(|j| f[j][i]));
    let turn = if D == 2 { turn_in_plane(&transposed) } else { turn_in_space(&transposed) };
    let cosine = 0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1.0);
    (cosine < FAR).then_some(if cosine > -1.0 { cosine } else { -1.0 })
}
