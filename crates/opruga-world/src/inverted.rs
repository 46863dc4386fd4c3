//! Cells of finite elements that are inside out in the present state, wholly or at some of their integration points.

use crate::world::{Warning, World};
use opruga_math::words::{counted, number};

/// The code of the warning.
const INVERTED: &str = "cells.inverted";

impl<const D: usize> World<D> {
    pub(crate) fn inverted_cells_here(&self) -> Option<Warning> {
        let solid = |body: &usize| self.blueprint.bodies[*body].models.iter().any(|model| model.kind() == "fem");
        let mut first: Option<(usize, u32, f64)> = None;
        let mut count = 0;
        for body in self.bodies().filter(solid) {
            for cell in self.cell_states(body).iter().filter(|cell| cell.smallest_volume_ratio <= 0.0) {
                first.get_or_insert((body, cell.cell, cell.smallest_volume_ratio));
                count += 1;
            }
        }
        let (body, cell, ratio) = first?;
        let message = format!(
            "at t = {} s {} inside out, the first of them cell {cell} of body `{}` with J = {}; hint: more substeps, {}",
            number(self.time()),
            match count {
                1 => "1 cell is".into(),
                _ => format!("{} are", counted(count, "cell", "cells")),
            },
            self.blueprint.bodies[body].name,
            number(ratio),
            self.what_rights_cells(body),
        );
        Some(Warning { code: INVERTED.into(), message, count })
    }

    /// What else than more substeps turns cells of a body right side out: no law that it already has.
    fn what_rights_cells(&self, body: usize) -> &'static str {
        let solids = self.blueprint.bodies[body].models.iter().filter(|model| model.kind() == "fem");
        let laws: Vec<&str> = solids.filter_map(|model| model.text("material")).collect();
        match laws.as_slice() {
            laws if laws.iter().all(|law| *law == "fixed_corotated") => "smaller cells, or less that crushes them",
            laws if laws.iter().all(|law| ["fixed_corotated", "stable_neo_hookean"].contains(law)) => {
                "smaller cells, or a material that pushes such cells back from farther (`fixed_corotated`)"
            }
            _ => "or a material that pushes such cells back (`stable_neo_hookean`, `fixed_corotated`)",
        }
    }
}
