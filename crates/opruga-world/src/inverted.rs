//! Cells of finite elements that are inside out in the present state, wholly or somewhere.
//!
//! Two things are looked at. Integration points, with what the law is asked with there: that of a box is not its shape alone. And J of
//! the shape over the whole cell: it is a polynomial over another one, of quadratic cells and boxes, whose sign its coefficients prove
//! or one of its values refutes ([`opruga_mesh::least_jacobian`]). A cell may be folded at a corner while all of its integration points
//! are right side out, and no force tells.

use crate::warnings::{CellHint, InvertedCells, UnfoldHint, Warning, WorldWarning};
use crate::world::World;
use opruga_core::spec::Role;
use opruga_mesh::{jacobian_at, least_jacobian};

/// What is known of a cell.
enum Found {
    /// It is inside out where J is this.
    Inverted(f64),
    /// It is flat somewhere, or nearly: J is as little as this, and may be negative.
    Nearly(f64),
}

impl<const D: usize> World<D> {
    /// A warning (`cells.inverted`) of cells of finite elements that are inside out in the present state, wholly or
    /// somewhere, which the rules of motion allow; none where all are certainly right side out. Looked for anew by every call.
    ///
    /// J of quadratic cells and boxes is bounded over the whole cell ([`opruga_mesh::least_jacobian`]), whatever their integration
    /// points see. A cell that is so nearly flat somewhere that the bounds do not decide is counted as one that may be.
    pub fn inverted_cells(&self) -> Option<Warning> {
        let solid = |body: &usize| {
            self.blueprint.bodies[*body].models.iter().any(|model| model.spec().has_role(Role::OwnsCells))
        };
        let mut first: Option<(usize, u32, Found)> = None;
        let (mut count, mut uncertain) = (0, 0);
        for body in self.bodies().filter(solid) {
            let shapes = self.shapes_of_cells(body);
            for cell in self.cell_states(body) {
                let points = cell.smallest_volume_ratio;
                // Written so that what is no number is inverted.
                let right = points > 0.0;
                let found = match shapes.get(cell.cell as usize) {
                    Some(Some(Found::Inverted(ratio))) if right || *ratio < points => Found::Inverted(*ratio),
                    _ if !right => Found::Inverted(points),
                    _ if cell.is_degenerate() => Found::Nearly(points),
                    Some(Some(Found::Nearly(ratio))) => Found::Nearly(*ratio),
                    _ => continue,
                };
                let certain = matches!(found, Found::Inverted(_));
                (count, uncertain) = if certain { (count + 1, uncertain) } else { (count, uncertain + 1) };
                // What is certain is named before what is not.
                if first.as_ref().is_none_or(|(.., known)| certain && matches!(known, Found::Nearly(_))) {
                    first = Some((body, cell.cell, found));
                }
            }
        }
        let (body, cell, Found::Inverted(ratio) | Found::Nearly(ratio)) = first?;
        let cells = match (count, uncertain) {
            (count, 0) => InvertedCells::Certain { count },
            (0, count) => InvertedCells::Perhaps { count },
            (count, perhaps) => InvertedCells::Both { count, perhaps },
        };
        let warning = WorldWarning::Inverted {
            time: self.time(),
            cells,
            cell,
            body: self.blueprint.bodies[body].name.clone(),
            ratio,
            help: self.what_rights_cells(body),
            unfold: self.or_unfold(),
        };
        Some(Warning::new(warning, count + uncertain))
    }

    /// What the shapes of the cells of a body show, in the order of its cells. Cells that have no positive J at rest, such as those with
    /// nodes at a quarter of their sides, have none that could keep its sign.
    fn shapes_of_cells(&self, body: usize) -> Vec<Option<Found>> {
        let mesh = &self.blueprint.bodies[body].mesh;
        let (mut now, mut rest) = (Vec::new(), Vec::new());
        let found = mesh.cells.iter().map(|(_, _, nodes)| {
            now.clear();
            now.extend(nodes.iter().map(|node| self.position(body, *node)));
            let least = least_jacobian(&now).filter(|least| !least.is_upright())?;
            rest.clear();
            rest.extend(nodes.iter().map(|node| mesh.positions[*node as usize]));
            if !least_jacobian(&rest)?.is_positive() {
                return None;
            }
            let ratio = least.found / jacobian_at(&rest, least.at)?;
            Some(if least.is_inverted() { Found::Inverted(ratio) } else { Found::Nearly(ratio) })
        });
        found.collect()
    }

    /// What helps a body that rests in a degenerate shape, where the scene does not say it.
    pub(crate) fn or_unfold(&self) -> Option<UnfoldHint> {
        (!self.blueprint.surroundings.unfold).then_some(UnfoldHint::Unfold)
    }

    /// What else than more substeps turns cells of a body right side out: no law that it already has.
    fn what_rights_cells(&self, body: usize) -> CellHint {
        let solids = self.blueprint.bodies[body].models.iter().filter(|model| model.spec().has_role(Role::OwnsCells));
        let laws: Vec<&str> = solids.filter_map(|model| model.text("material")).collect();
        match laws.as_slice() {
            laws if laws.iter().all(|law| *law == "fixed_corotated") => CellHint::Smaller,
            laws if laws.iter().all(|law| ["fixed_corotated", "stable_neo_hookean"].contains(law)) => CellHint::Farther,
            _ => CellHint::Material,
        }
    }
}
