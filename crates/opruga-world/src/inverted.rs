//! Cells of finite elements that are inverted in the present state, entirely or in part.
//!
//! Two checks are made. One check uses the integration points with the deformation that the law sees there; for boxes, this deformation does not
//! depend on the shape alone. The other uses J of the shape over the whole cell. For quadratic cells and boxes, J is a quotient of polynomials. Its
//! coefficients may prove that J is positive everywhere, or a single value may disprove this ([`opruga_mesh::least_jacobian`]). A cell may be folded
//! at a corner although none of its integration points is inverted. No force then shows the fold.

use crate::warnings::{CellHint, InvertedCells, UnfoldHint, Warning, WorldWarning};
use crate::world::World;
use opruga_core::spec::Role;
use opruga_mesh::{jacobian_at, least_jacobian};

/// The result for a cell.
enum Found {
    /// The cell is inverted; J has this value at the point at which it is inverted.
    Inverted(f64),
    /// Degenerate or nearly degenerate somewhere: J is as small as this value, which may be negative.
    Nearly(f64),
}

impl<const D: usize> World<D> {
    /// A warning (`cells.inverted`) about cells of finite elements that are inverted in the present state, entirely or in part. The integrators allow
    /// such cells. Returns none if certainly no cell is inverted. Every call computes it again.
    ///
    /// J of quadratic cells and boxes is bounded over the whole cell ([`opruga_mesh::least_jacobian`]), independently of the integration points. A
    /// cell that is so close to degenerate somewhere that the bounds are not conclusive counts as possibly inverted.
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
                // This form treats NaN as inverted.
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
                // A cell that is certainly inverted is reported rather than an uncertain one.
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

    /// The results for the shapes of the cells of a body, in the order of its cells. Some cells, such as those with nodes at a quarter of their
    /// sides, have no positive J at rest. Such cells have no result, because their J has no sign to keep.
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

    /// The hint to use `unfold` for a body that rests in a degenerate shape; `None` if the scene already uses it.
    pub(crate) fn or_unfold(&self) -> Option<UnfoldHint> {
        let allowed = !self.blueprint.surroundings.unfold && self.blueprint.contact.is_none();
        allowed.then_some(UnfoldHint::Unfold)
    }

    /// The hint that helps against inverted cells of a body, apart from more substeps. The hint never names a law that the body already has.
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
