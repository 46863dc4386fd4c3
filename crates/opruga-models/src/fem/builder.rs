//! Builds a solid from the cells of a mesh, and refuses bad input.

use super::elements::{Cell, Shape, rest_gradient};
use super::mass;
use super::nodal_volume::NodalVolumes;
use super::numbers::{Numbers, beyond};
use super::refusals::{Refusal, Simplices};
use super::section::{Plan, Section};
use super::solid::{Built, Solid};
use crate::materials;
use crate::materials::law::Law;
use opruga_core::error::BuildError;
use opruga_core::potential::Ingredients;
use opruga_mesh::Mesh;

/// A cell counts as having no volume if det ∂X/∂ξ is below this fraction of the cube (in the plane, the square) of the longest
/// edge.
const NO_VOLUME: f64 = 1e-12;

/// The data that are common to all cells while a solid is built.
pub(super) struct Builder<'a, const D: usize> {
    ingredients: &'a Ingredients<'a, D>,
    /// Which cells have this material.
    chosen: Vec<bool>,
    numbers: Numbers<'a>,
    pub(super) stress: bool,
    /// The density [kg/m³, in the plane per area] of every cell, if the mass matrix is consistent.
    density: Option<Vec<f64>>,
}

impl<'a, const D: usize> Builder<'a, D> {
    pub(super) fn new(ingredients: &'a Ingredients<'a, D>) -> Result<Self, BuildError> {
        let (mesh, first) = (ingredients.mesh, ingredients.values[0]);
        if mesh.cells.is_empty() {
            return Err(Refusal::NoCellsAtAll {}.into());
        }
        let mut chosen = vec![true; mesh.cells.len()];
        if let Some(name) = first.text("cells") {
            let Some(group) = mesh.cell_groups.get(name) else {
                return Err(no_group(mesh, name).into());
            };
            chosen.fill(false);
            group.iter().for_each(|cell| chosen[*cell as usize] = true);
            if group.is_empty() {
                return Err(Refusal::EmptyGroup { name: name.into() }.into());
            }
        }
        let numbers = Numbers::new(ingredients, &chosen)?;
        if numbers.heated && first.text("locking") == Some("nodal_volume") {
            return Err(Refusal::NodalVolumeAndHeat {}.into());
        }
        Ok(Builder {
            ingredients,
            chosen,
            numbers,
            stress: D == 2 && first.text("plane") == Some("stress"),
            density: (first.text("mass") == Some("consistent")).then(|| densities(ingredients)).transpose()?,
        })
    }

    pub(super) fn laws(&self) -> Result<&'static materials::Laws, BuildError> {
        let name = self.ingredients.values[0].text("material").unwrap_or("");
        let found = materials::ALL.iter().find(|entry| entry.name == name);
        let entry = found.ok_or_else(|| {
            BuildError::of(super::SPEC.kind, materials::Refusal::Unknown { name: name.into(), nearest: None })
        })?;
        Ok(if self.numbers.heated { &entry.heated } else { &entry.cold })
    }

    /// The value of `locking`: how linear simplices near incompressibility are treated.
    fn locking(&self) -> &str {
        self.ingredients.values[0].text("locking").unwrap_or("refuse")
    }

    /// Adds a section of one kind of cells. The first of these cells has the number `first` in the mesh.
    pub(super) fn add<E: Shape<D, N>, const N: usize>(
        &self,
        built: &mut Built<D>,
        list: &[[u32; N]],
        first: usize,
        law: fn() -> Box<dyn Law<D>>,
        law_in_space: Option<fn() -> Box<dyn Law<3>>>,
    ) -> Result<(), BuildError> {
        let numbered = list.iter().enumerate().filter(|(k, _)| self.chosen[first + k]);
        let cells: Vec<Cell<N>> =
            numbered.map(|(k, nodes)| Cell { number: (first + k) as u32, nodes: *nodes }).collect();
        if cells.is_empty() {
            return Ok(());
        }
        let positions = &self.ingredients.mesh.positions;
        let mut measures = Vec::with_capacity(cells.len());
        for cell in &cells {
            measures.push(self.check::<E, N>(cell, positions)?);
        }
        if let Some(density) = &self.density {
            for cell in &cells {
                let rest = cell.nodes.map(|n| positions[n as usize]);
                mass::entries::<E, D, N>(&cell.nodes, &rest, density[cell.number as usize], &mut built.inertia);
            }
        }
        let law = law();
        let nodal = E::SIMPLEX && self.locking() == "nodal_volume";
        let turns = law.turns();
        if E::SIMPLEX && !nodal && !self.stress {
            let kind = if D == 2 { Simplices::Triangles } else { Simplices::Tetrahedra };
            self.numbers.refuse_what_locks(&mut cells.iter().map(|cell| cell.number), kind)?;
        }
        let plan = Plan {
            layout: self.ingredients.layout,
            law,
            law_in_space: law_in_space.map(|law| law()),
            positions,
            thickness: if D == 2 { self.ingredients.thickness } else { 1.0 },
            plane_stress: self.stress,
            nodal,
            damped: self.numbers.damped,
        };
        let numbers = |cell: u32, body: usize| {
            let mut numbers = self.numbers.of(cell, body);
            if nodal {
                numbers[1] -= beyond(numbers[0], numbers[1]);
            }
            numbers
        };
        if plan.law.cancels() {
            let modulus = |cell: u32, body: usize| {
                let [mu, lambda, ..] = numbers(cell, body);
                2.0 * mu + lambda
            };
            let bodies = self.ingredients.values.len();
            let of_cell = |(cell, measure): (&Cell<N>, &f64)| {
                measure * (0..bodies).map(|body| modulus(cell.number, body)).sum::<f64>()
            };
            built.energy_parts += plan.thickness * cells.iter().zip(&measures).map(of_cell).sum::<f64>();
        }
        let section = Section::<E, D, N>::new(plan, cells, &numbers);
        if nodal {
            let lame = |cell: u32, body: usize| {
                let [mu, lambda, ..] = self.numbers.of(cell, body);
                [mu, lambda]
            };
            let list = section.cells.iter().map(|cell| (cell.number, cell.nodes));
            let (layout, thickness) = (self.ingredients.layout, if D == 2 { self.ingredients.thickness } else { 1.0 });
            built.volumes = Some(NodalVolumes::new(layout, turns, positions, thickness, list, &lame));
        }
        built.parts.push(Box::new(section));
        Ok(())
    }

    /// Refuses a cell that is degenerate or inverted at rest. Returns the volume of the cell (area in the plane).
    fn check<E: Shape<D, N>, const N: usize>(&self, cell: &Cell<N>, positions: &[[f64; D]]) -> Result<f64, BuildError> {
        let rest: [[f64; D]; N] = cell.nodes.map(|n| positions[n as usize]);
        let mut longest = 0.0;
        for a in &rest {
            for b in &rest {
                let square: f64 = (0..D).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum();
                longest = if square > longest { square } else { longest };
            }
        }
        let size = longest.sqrt();
        let least = NO_VOLUME * (0..D).map(|_| size).product::<f64>();
        // Boxes are also checked at their centre.
        let middle = E::BOX.then(|| E::at([0.0; 3]).1);
        let mut measure = 0.0;
        for (slopes, weight) in E::SLOPES.iter().chain(&middle).zip(E::WEIGHTS.iter().chain(&[0.0])) {
            let (_, determinant) = rest_gradient(&rest, slopes);
            if !(determinant.is_finite() && determinant > least) {
                let (cell, nodes) = (cell.number, format!("{:?}", cell.nodes));
                let (inverted, least) = (determinant < -least, format!("{least:e}"));
                let determinant = format!("{determinant:e}");
                return Err(match inverted {
                    true => Refusal::Inverted { cell, nodes, determinant, least }.into(),
                    false => Refusal::FlatCell { cell, nodes, determinant, least }.into(),
                });
            }
            measure += weight * determinant;
        }
        // A quadratic cell may be folded at a point that is not an integration point.
        let folded = if E::BOX || E::SIMPLEX { None } else { opruga_mesh::least_jacobian(&rest) };
        if let Some(found) = folded.map(|jacobian| jacobian.found).filter(|found| *found < -least) {
            let (cell, nodes) = (cell.number, format!("{:?}", cell.nodes));
            let (determinant, least) = (format!("{found:e}"), format!("{least:e}"));
            return Err(Refusal::Inverted { cell, nodes, determinant, least }.into());
        }
        Ok(measure)
    }

    pub(super) fn finish(self, built: Built<D>) -> Result<Box<Solid<D>>, BuildError> {
        if self.locking() == "nodal_volume" && (self.stress || built.volumes.is_none()) {
            return Err(match self.stress {
                true => Refusal::NodalVolumeInPlaneStress {}.into(),
                false => Refusal::NodalVolumeOfOthers {}.into(),
            });
        }
        let (layout, nodes) = (self.ingredients.layout, self.ingredients.mesh.positions.len());
        Ok(Box::new(Solid::new(layout, nodes, built, self.numbers.damped)))
    }
}

/// The density of every cell [kg/m³, in the plane per area]. If no density is given, it is the total mass divided by the total
/// measure.
fn densities<const D: usize>(ingredients: &Ingredients<D>) -> Result<Vec<f64>, BuildError> {
    if let Some(densities) = ingredients.densities {
        let depth = if D == 2 { ingredients.thickness } else { 1.0 };
        return Ok(densities.iter().map(|density| depth * density).collect());
    }
    let measure = ingredients.mesh.measure().map_err(|problem| Refusal::Measure { problem })?.value();
    let nodes = 0..ingredients.mesh.nodes();
    Ok(vec![
        nodes.map(|node| ingredients.mass.at(ingredients.layout.index(node, 0))).sum::<f64>() / measure;
        ingredients.mesh.cells.len()
    ])
}

/// The refusal of a group that the mesh does not have.
fn no_group<const D: usize>(mesh: &Mesh<D>, name: &str) -> Refusal {
    let (name, names) = (name.to_string(), mesh.cell_groups.keys().map(|n| format!("`{n}`")).collect::<Vec<_>>());
    match names.is_empty() {
        true => Refusal::NoGroupsOfCells { name },
        false => Refusal::NoGroupOfCells { name, known: names.join(", ") },
    }
}
