//! Cells of finite elements that are inside out in the present state.

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
            for cell in self.cell_states(body).iter().filter(|cell| cell.volume_ratio <= 0.0) {
                first.get_or_insert((body, cell.cell, cell.volume_ratio));
                count += 1;
            }
        }
        let (body, cell, ratio) = first?;
        let message = format!(
            "at t = {} s {} inside out, the first of them cell {cell} of body `{}` with J = {}; hint: more substeps, or a material \
             that pushes such cells back (`stable_neo_hookean`, `fixed_corotated`)",
            number(self.time()),
            match count {
                1 => "1 cell is".into(),
                _ => format!("{} are", counted(count, "cell", "cells")),
            },
            self.blueprint.bodies[body].name,
            number(ratio),
        );
        Some(Warning { code: INVERTED.into(), message, count })
    }
}
