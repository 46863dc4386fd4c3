//! The material parameters of every cell, from the scene or from the cells of the mesh.

use super::SPEC;
use super::refusals::{Refusal, Simplices};
use crate::materials::moduli::{lame, refuse_what_is_not_convex};
use opruga_core::error::BuildError;
use opruga_core::potential::Ingredients;
use opruga_core::spec::{Field, Values};

/// The number of parameters of an element: μ, λ, the material's own parameter, the thermal growth and the retardation time.
pub(super) const NUMBERS: usize = 5;

/// λ − λ′ with λ′ = min(λ, 2μ). If this part of the volumetric stiffness acted at every point, most cells could not bend.
pub(super) fn beyond(mu: f64, lambda: f64) -> f64 {
    if lambda > 2.0 * mu { lambda - 2.0 * mu } else { 0.0 }
}

/// Poisson's ratio above which linear triangles and tetrahedra are refused.
const LOCKS_ABOVE: f64 = 0.45;

/// A parameter that the mesh may give for each cell: the field of the scene that applies to all cells, and the field that names
/// values of the mesh.
pub(super) const YOUNGS_MODULUS: [&str; 2] = ["youngs_modulus", "youngs_modulus_of_cells"];
const POISSONS_RATIO: [&str; 2] = ["poissons_ratio", "poissons_ratio_of_cells"];
const DAMPING: [&str; 2] = ["damping", "damping_of_cells"];
pub(super) const EXPANSION: [&str; 2] = ["thermal_expansion", "thermal_expansion_of_cells"];
const TEMPERATURE: [&str; 2] = ["temperature", "temperature_of_cells"];
const REFERENCE: [&str; 2] = ["reference_temperature", "reference_temperature_of_cells"];

/// The material parameters of all cells.
pub(super) struct Numbers<'a> {
    /// The fields of every body of a batch.
    values: &'a [&'a Values],
    moduli: Option<&'a [f64]>,
    ratios: Option<&'a [f64]>,
    times: Option<&'a [f64]>,
    expansions: Option<&'a [f64]>,
    temperatures: Option<&'a [f64]>,
    references: Option<&'a [f64]>,
    /// Whether any cell dissipates energy.
    pub(super) damped: bool,
    /// Whether any cell has expanded or shrunk thermally.
    pub(super) heated: bool,
}

impl<'a> Numbers<'a> {
    /// The parameters of the chosen cells, checked against their ranges.
    pub(super) fn new<const D: usize>(
        ingredients: &'a Ingredients<'a, D>,
        chosen: &[bool],
    ) -> Result<Numbers<'a>, BuildError> {
        // The values that the mesh gives for its cells are the same for all bodies of a batch.
        let first = ingredients.values[0];
        let of = |field| of_cells(ingredients, field, chosen);
        let mut numbers = Numbers {
            values: ingredients.values,
            moduli: of(YOUNGS_MODULUS)?,
            ratios: of(POISSONS_RATIO)?,
            times: of(DAMPING)?,
            expansions: of(EXPANSION)?,
            temperatures: of(TEMPERATURE)?,
            references: of(REFERENCE)?,
            damped: false,
            heated: false,
        };
        first.check_choices(&SPEC)?;
        let cells = || (0..chosen.len()).filter(|cell| chosen[*cell]).map(|cell| cell as u32);
        for (body, values) in ingredients.values.iter().enumerate() {
            numbers.damped |= cells().any(|cell| numbers.time(cell, body) > 0.0);
            for cell in cells() {
                let growth = numbers.growth(cell, body);
                if !(growth > 0.0 && growth.is_finite()) {
                    return Err(numbers.no_growth(cell, body).into());
                }
            }
            cells().try_for_each(|cell| refuse_what_is_not_convex(values, numbers.ratio(cell, body)))?;
        }
        let bodies = 0..ingredients.values.len();
        let heated = bodies.into_iter().any(|body| cells().any(|cell| numbers.growth(cell, body) != 1.0));
        numbers.heated = heated;
        Ok(numbers)
    }

    /// μ, λ, the material's own parameter, the thermal growth and the retardation time of a cell of a body.
    pub(super) fn of(&self, cell: u32, body: usize) -> [f64; NUMBERS] {
        let modulus = self.number(YOUNGS_MODULUS[0], self.moduli, cell, body);
        let ratio = self.ratio(cell, body);
        let [mu, lambda] = lame(modulus, ratio);
        [mu, lambda, self.number("mooney_share", None, cell, body), self.growth(cell, body), self.time(cell, body)]
    }

    /// Refuses linear cells near incompressibility.
    pub(super) fn refuse_what_locks(
        &self,
        cells: &mut dyn Iterator<Item = u32>,
        kind: Simplices,
    ) -> Result<(), BuildError> {
        let refusing = |body: &usize| self.values[*body].text("locking") != Some("accept");
        let bodies: Vec<usize> = (0..self.values.len()).filter(refusing).collect();
        let mut ratios = cells.flat_map(|cell| bodies.iter().map(move |body| self.ratio(cell, *body)));
        let Some(ratio) = ratios.find(|ratio| *ratio > LOCKS_ABOVE) else { return Ok(()) };
        Err(Refusal::LinearCellsLock { ratio, cells: kind, most: LOCKS_ABOVE }.into())
    }

    fn ratio(&self, cell: u32, body: usize) -> f64 {
        self.number(POISSONS_RATIO[0], self.ratios, cell, body)
    }
    /// T and T₀ [K]. If no temperature is given, T is the reference temperature T₀.
    fn temperatures(&self, cell: u32, body: usize) -> [f64; 2] {
        let reference = self.number(REFERENCE[0], self.references, cell, body);
        let own = || self.values[body.min(self.values.len() - 1)].number(TEMPERATURE[0]).unwrap_or(reference);
        [self.temperatures.map_or_else(own, |all| all[cell as usize]), reference]
    }
    /// g = 1 + α (T − T₀).
    fn growth(&self, cell: u32, body: usize) -> f64 {
        let [now, reference] = self.temperatures(cell, body);
        1.0 + self.number(EXPANSION[0], self.expansions, cell, body) * (now - reference)
    }
    /// Why the growth of a cell is refused.
    fn no_growth(&self, cell: u32, body: usize) -> Refusal {
        let ([now, reference], growth) = (self.temperatures(cell, body), self.growth(cell, body));
        let expansion = self.number(EXPANSION[0], self.expansions, cell, body);
        Refusal::NoGrowth { cell, growth, expansion, reference, now }
    }
    fn time(&self, cell: u32, body: usize) -> f64 {
        self.number(DAMPING[0], self.times, cell, body)
    }
    fn number(&self, field: &str, of_cells: Option<&[f64]>, cell: u32, body: usize) -> f64 {
        let of_body = || self.values[body.min(self.values.len() - 1)].number(field).unwrap_or(0.0);
        of_cells.map_or_else(of_body, |all| all[cell as usize])
    }
}

/// The values of the mesh that a field names. The values of the chosen cells must be in the range of the field that they
/// replace.
fn of_cells<'a, const D: usize>(
    ingredients: &'a Ingredients<'a, D>,
    [field, of_cells]: [&'static str; 2],
    chosen: &[bool],
) -> Result<Option<&'a [f64]>, BuildError> {
    let Some(name) = ingredients.values[0].text(of_cells) else { return Ok(None) };
    let all = &ingredients.mesh.cell_values;
    let Some(numbers) = all.get(name) else {
        let names: Vec<_> = all.keys().map(|n| format!("`{n}`")).collect();
        let (field, instead, name) = (of_cells, field, name.to_string());
        return Err(match names.is_empty() {
            true => Refusal::NoValuesAtAll { field, name, instead }.into(),
            false => Refusal::NoValues { field, name, known: names.join(", "), instead }.into(),
        });
    };
    let range = super::SPEC.fields.iter().find(|known: &&Field| known.name == field).map(|known| known.range);
    for (cell, number) in numbers.iter().enumerate().filter(|(cell, _)| chosen[*cell]) {
        let value = opruga_core::spec::Value::Number(*number);
        if let Some(Err((value, allowed))) = range.map(|range| range.accept(value, D)) {
            return Err(Refusal::CellValue { field: of_cells, cell, value, allowed, instead: field }.into());
        }
    }
    Ok(Some(numbers.as_slice()))
}
