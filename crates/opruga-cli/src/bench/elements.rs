//! `opruga bench elements`: measures the forces and Hessians of finite elements and of other methods.
//!
//! The body is a bent cube of tetrahedra, hexahedra or quadratic tetrahedra, or a bent ring, on one thread. Hessians are added to the matrix of a
//! solver, which knows the positions of their blocks after the first time. Finite volumes, finite differences and shape matching are each shown
//! next to an existing model, which is measured in the same run for comparison.

use super::{Machine, best};
use crate::arguments::BenchElements;
use crate::errors::{CallFault, CallRange};
use crate::failure::{Failure, print_data};
use opruga::core::potential::{Definiteness, Ingredients, Potential};
use opruga::core::spec::{Allowed, Spec, Value, Values};
use opruga::core::state::{Columns, Layout, Parameter, View};
use opruga::core::tile::{TILE, Tile};
use opruga::math::{Column, WIDTH};
use opruga::mesh::Mesh;
use opruga::{Registries, Registry, Simd};
use opruga_solve::BlockMatrix;
use serde_json::json;

/// Times of one model on one kind of element [ns per element or node].
#[derive(serde::Serialize)]
struct Row {
    model: &'static str,
    element: &'static str,
    elements: usize,
    material: &'static str,
    /// Times of the forces for each set of vector instructions.
    forces: Vec<(&'static str, f64)>,
    hessian: f64,
    clamped_hessian: f64,
    /// The time of the forces, divided by the time of the row with which this row is compared. Both times are with the best vector instructions.
    #[serde(skip_serializing_if = "Option::is_none")]
    ratio: Option<f64>,
}

/// One body with one model.
struct Subject<'a, const D: usize> {
    model: &'static str,
    element: &'static str,
    /// The number of elements of the body.
    elements: usize,
    material: &'static str,
    mesh: &'a Mesh<D>,
    values: Vec<(&'static str, Value)>,
}

/// The materials of `fem`.
fn materials(spec: &Spec) -> &'static [&'static str] {
    match spec.fields.iter().find(|field| field.name == "material").map(|field| &field.range) {
        Some(Allowed::Choice(names)) => names,
        _ => &[],
    }
}

/// Measures all rows and prints them.
pub(crate) fn bench(call: &BenchElements, registries: &Registries) -> Result<u8, Failure> {
    let model = registries.space.model("fem").ok_or_else(|| Failure::call(CallFault::NoModel { name: "fem" }))?;
    let names = materials(model.spec());
    if let Some(name) = call.material.as_deref().filter(|name| !names.contains(name)) {
        return Err(Failure::range("--material", format!("`{name}`"), CallRange::OneOf { names: names.join(", ") }));
    }
    let refused = |error: opruga::mesh::MeshError| Failure::call(error);
    let grid = |cells: u32| Mesh::<3>::grid([0.0; 3], [1.0; 3], [cells; 3]);
    let boxes = grid(call.cells).map_err(refused)?;
    let tetrahedra = boxes.clone().into_simplices().map_err(refused)?;
    let coarse = grid(call.cells / 2).and_then(Mesh::into_simplices);
    let quadratic = coarse.and_then(Mesh::into_quadratic).map_err(refused)?;
    let mut rows = Vec::new();
    for (element, mesh) in [("tetrahedron", &tetrahedra), ("hexahedron", &boxes), ("quadratic tetrahedron", &quadratic)]
    {
        for &material in names {
            // Other elements are measured with one material only, because they evaluate the same material at more points.
            let wanted = call.material.as_deref().unwrap_or("neo_hookean");
            if material != wanted && (element != "tetrahedron" || call.material.is_some()) {
                continue;
            }
            let values = vec![("material", Value::Text(material.into())), modulus()];
            rows.push(
                Subject { model: "fem", element, elements: mesh.cells.len(), material, mesh, values }
                    .measure(&registries.space)?,
            );
        }
    }
    if call.material.is_none() {
        survey(registries, &boxes, &tetrahedra, &mut rows)?;
    }
    let machine = Machine::measure(Simd::best());
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": rows, "calibration": machine })))?;
        return Ok(0);
    }
    let mut text = String::from("ns per element or node, one thread; x: times the row that it is compared with\n");
    for row in &rows {
        text += &format!("{}: {} of {} ({})\n  forces and energy", row.model, row.element, row.material, row.elements);
        for (simd, time) in &row.forces {
            text += &format!("  {time:.1} ({simd})");
        }
        if let Some(ratio) = row.ratio {
            text += &format!("  {ratio:.2} x");
        }
        text += &format!("\n  Hessian  {:.0}, clamped  {:.0}\n", row.hessian, row.clamped_hessian);
    }
    print_data(&format!("{text}{}\n", machine.sentence()))?;
    Ok(0)
}

/// The field of Young's modulus, with the value that all measurements use, 1e5 Pa.
fn modulus() -> (&'static str, Value) {
    ("youngs_modulus", Value::Number(1e5))
}
/// Vertices of the rings.
const RING: u32 = 4096;

/// Measures each of the other methods, and the existing model with which it is compared.
fn survey(registries: &Registries, boxes: &Mesh<3>, tetrahedra: &Mesh<3>, rows: &mut Vec<Row>) -> Result<(), Failure> {
    let Registries { plane, space } = registries;
    let refused = |error: opruga::mesh::MeshError| Failure::call(error);
    let of = |rows: &[Row], element: &str, material: &str| {
        rows.iter().find(|row| row.element == element && row.material == material).map_or(f64::NAN, Row::best)
    };
    let tetrahedron = of(rows, "tetrahedron", "linear");
    let values = vec![("material", Value::Text("linear".into())), modulus()];
    let (model, element, material) = ("finite_volume", "tetrahedron", "linear");
    let elements = tetrahedra.cells.len();
    let subject = Subject { model, element, elements, material, mesh: tetrahedra, values };
    rows.push(subject.measure(space)?.beside(tetrahedron));

    let (model, element, material) = ("finite_difference", "hexahedron", "St. Venant-Kirchhoff");
    let hexahedron = of(rows, "hexahedron", "neo_hookean");
    let subject =
        Subject { model, element, elements: boxes.cells.len(), material, mesh: boxes, values: vec![modulus()] };
    rows.push(subject.measure(space)?.beside(hexahedron));

    let ring = Mesh::<2>::ring(0.5, RING, [0.0; 2], 0.0).map_err(refused)?;
    let ring = |model, material, values| {
        Subject { model, element: "vertex of a ring", elements: RING as usize, material, mesh: &ring, values }
            .measure(plane)
    };
    let springs = ring("mass_spring", "springs", vec![("stiffness", Value::Number(1e5))])?;
    let spring = springs.best();
    rows.push(springs);
    let curve = vec![modulus(), ("thickness", Value::Number(0.02))];
    rows.push(ring("finite_difference", "stretch and bending", curve)?.beside(spring));

    let nodes = boxes.positions.len();
    let side = 4.0 * boxes.positions.get(1).map_or(1.0, |p| p[0]);
    let clusters = |material, region: Option<f64>| {
        let mut values = vec![("stiffness", Value::Number(1e3)), ("fit_share", Value::Number(0.5))];
        values.extend(region.map(|side| ("region", Value::Number(side))));
        Subject { model: "shape_matching", element: "node", elements: nodes, material, mesh: boxes, values }
            .measure(space)
    };
    rows.push(clusters("one cluster", None)?);
    rows.push(clusters("overlapping clusters", Some(side))?);

    // Every vertex attracts every other one.
    let ball = Mesh::<3>::icosphere(0.5, 3).map_err(refused)?;
    let (model, element, material) = ("boundary_element", "vertex of a sphere", "isotropic");
    let elements = ball.positions.len();
    rows.push(Subject { model, element, elements, material, mesh: &ball, values: vec![modulus()] }.measure(space)?);
    Ok(())
}

impl Row {
    /// The time of the forces with the best vector instructions.
    fn best(&self) -> f64 {
        self.forces.iter().map(|(_, time)| *time).fold(f64::INFINITY, f64::min)
    }
    fn beside(self, reference: f64) -> Row {
        Row { ratio: Some(self.best() / reference), ..self }
    }
}

impl<const D: usize> Subject<'_, D> {
    /// Builds the model and measures it.
    fn measure(self, registry: &Registry<D>) -> Result<Row, Failure> {
        let model = registry.model(self.model).ok_or_else(|| Failure::call(CallFault::NoModel { name: self.model }))?;
        let mut values = Values::defaults(model.spec(), D);
        for (name, value) in &self.values {
            values.set(model.spec(), name, value.clone(), D).map_err(Failure::call)?;
        }
        let potential = model.build(&Ingredients {
            mesh: self.mesh,
            layout: Layout::Single,
            values: &[&values],
            mass: &Parameter::uniform(1.0),
            densities: None,
            thickness: 1.0,
            gravity: [0.0; D],
            step: 1e-3,
            break_off: &Default::default(),
        });
        let potential = potential.map_err(|error| Failure::call(error.about))?;
        let (forces, [hessian, clamped_hessian]) = times(&*potential, self.mesh, self.elements)?;
        let Subject { model, element, elements, material, .. } = self;
        Ok(Row { model, element, elements, material, forces, hessian, clamped_hessian, ratio: None })
    }
}

/// Times of the forces for each set of vector instructions, and of the exact and the clamped Hessian [ns per element].
type Times = (Vec<(&'static str, f64)>, [f64; 2]);

fn times<const D: usize>(solid: &dyn Potential<D>, mesh: &Mesh<D>, elements: usize) -> Result<Times, Failure> {
    let nodes = mesh.positions.len();
    let column_length = Layout::Single.index_count(nodes);
    let v = Columns::<D>::zeros(column_length);
    // Two alternating states, because a model may reuse its results for the previous one.
    let mut states = [Columns::<D>::zeros(column_length), Columns::<D>::zeros(column_length)];
    for (k, p) in mesh.positions.iter().enumerate() {
        let across = p.get(2).copied().unwrap_or(0.0);
        let bent = [p[0] + 0.2 * p[1] * p[1], p[1] + 0.1 * p[0] * across, across * (1.0 - 0.1 * p[0])];
        for (x, factor) in states.iter_mut().zip([1.0, 1.0 + 1e-9]) {
            x.set(k, core::array::from_fn(|d| factor * bent[d]));
        }
    }
    let views = states.each_ref().map(|x| {
        let (x, v) = (x.slices(), v.slices());
        View { x, v, nodes, layout: Layout::Single, time: 0.0, threads: 1 }
    });
    let mut turn = 0;
    let mut scratch = Column::zeros(solid.properties().scratch_len);
    let mut force = Columns::<D>::zeros(column_length);
    let (mut slots, mut power) = (Column::default(), [0.0; WIDTH]);
    let per_element = |seconds: f64| seconds * 1e9 / elements as f64;
    let mut forces = Vec::new();
    let mut refused = None;
    for simd in Simd::available() {
        let seconds = best(12, || {
            turn = 1 - turn;
            let view = &views[turn];
            if let Err(error) = solid.prepare(simd, view, &[], &mut scratch) {
                refused = Some(error);
            }
            for start in (0..column_length).step_by(TILE) {
                let range = start..(start + TILE).min(column_length);
                let columns = force.0.each_mut().map(|f| &mut f[range.clone()]);
                let mut tile = Tile { range, force: columns, power: &mut power, weight: None, slots: &mut slots };
                solid.add_force(simd, view, &scratch, &mut tile);
            }
        });
        forces.push((simd.name(), per_element(seconds)));
    }
    if let Some(error) = refused {
        return Err(Failure::call(error));
    }
    let view = &views[turn];
    let mut matrix = BlockMatrix::<D>::default();
    let mut hessian = |keep: Definiteness| {
        let mut assemble = || matrix.assemble_one(solid, view, &scratch, keep);
        assemble();
        per_element(best(5, assemble))
    };
    let (exact, clamped) = (hessian(Definiteness::Exact), hessian(Definiteness::Clamped));
    Ok((forces, [exact, clamped]))
}
