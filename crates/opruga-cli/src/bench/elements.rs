//! `opruga bench elements`: forces and Hessians of finite elements.
//!
//! A cube of tetrahedra, hexahedra or quadratic tetrahedra, bent; one thread. Hessians go into the matrix of a solver,
//! where the places of their blocks are known from the first time.

use super::{Machine, best};
use crate::arguments::BenchElements;
use crate::failure::{Failure, print_data};
use opruga::core::potential::{Definiteness, Ingredients, Potential};
use opruga::core::spec::{Allowed, Spec, Value, Values};
use opruga::core::state::{Columns, Layout, Parameter, View};
use opruga::core::tile::{TILE, Tile};
use opruga::math::{Column, WIDTH};
use opruga::mesh::Mesh;
use opruga::{Registry, Simd};
use opruga_solve::BlockMatrix;
use serde_json::json;

/// Times of one material on one kind of element [ns per element].
#[derive(serde::Serialize)]
struct Row {
    element: &'static str,
    elements: usize,
    material: &'static str,
    /// By set of vector instructions.
    forces: Vec<(&'static str, f64)>,
    hessian: f64,
    clamped_hessian: f64,
}

/// The materials of `fem`.
fn materials(spec: &Spec) -> &'static [&'static str] {
    match spec.fields.iter().find(|field| field.name == "material").map(|field| &field.range) {
        Some(Allowed::Choice(names)) => names,
        _ => &[],
    }
}

/// Measures and prints.
pub(crate) fn bench(call: &BenchElements) -> Result<u8, Failure> {
    let registry = Registry::<3>::default();
    let model = registry.model("fem").ok_or_else(|| Failure::call("there are no finite elements"))?;
    let names = materials(model.spec());
    if let Some(name) = call.material.as_deref().filter(|name| !names.contains(name)) {
        return Err(Failure::range("--material", format!("`{name}`"), &names.join(", ")));
    }
    let refused = |error: opruga::mesh::MeshError| Failure::call(error.to_string());
    let grid = |cells: u32| Mesh::<3>::grid([0.0; 3], [1.0; 3], [cells; 3]);
    let boxes = grid(call.cells).map_err(refused)?;
    let tetrahedra = boxes.clone().into_simplices().map_err(refused)?;
    let coarse = grid(call.cells / 2).and_then(Mesh::into_simplices);
    let quadratic = coarse.and_then(Mesh::into_quadratic).map_err(refused)?;
    let mut rows = Vec::new();
    for (element, mesh) in [("tetrahedron", &tetrahedra), ("hexahedron", &boxes), ("quadratic tetrahedron", &quadratic)]
    {
        for &material in names {
            // The other elements once: it is the same material at more points.
            let wanted = call.material.as_deref().unwrap_or("neo_hookean");
            if material != wanted && (element != "tetrahedron" || call.material.is_some()) {
                continue;
            }
            let mut values = Values::defaults(model.spec(), 3);
            for (name, value) in [("material", Value::Text(material.into())), ("youngs_modulus", Value::Number(1e5))] {
                values.set(model.spec(), name, value, 3).map_err(|e| Failure::call(e.to_string()))?;
            }
            let solid = model.build(&Ingredients {
                mesh,
                layout: Layout::Single,
                values: &[&values],
                mass: &Parameter::uniform(1.0),
                densities: None,
                thickness: 1.0,
                gravity: [0.0; 3],
                step: 1e-3,
            });
            let solid = solid.map_err(|e| Failure::call(e.to_string()))?;
            rows.push(measure(&*solid, mesh, element, material)?);
        }
    }
    let machine = Machine::measure(Simd::best());
    if call.json {
        print_data(&format!("{}\n", json!({ "rows": rows, "calibration": machine })))?;
        return Ok(0);
    }
    let mut text = String::from("ns per element, one thread\n");
    for row in &rows {
        text += &format!("{} of {} ({})\n  forces and energy", row.element, row.material, row.elements);
        for (simd, time) in &row.forces {
            text += &format!("  {time:.1} ({simd})");
        }
        text += &format!("\n  Hessian  {:.0}, clamped  {:.0}\n", row.hessian, row.clamped_hessian);
    }
    print_data(&format!("{text}{}\n", machine.sentence()))?;
    Ok(0)
}

fn measure(
    solid: &dyn Potential<3>,
    mesh: &Mesh<3>,
    element: &'static str,
    material: &'static str,
) -> Result<Row, Failure> {
    let nodes = mesh.positions.len();
    let places = Layout::Single.places(nodes);
    let (mut x, v) = (Columns::<3>::zeros(places), Columns::<3>::zeros(places));
    for (k, p) in mesh.positions.iter().enumerate() {
        x.set(k, [p[0] + 0.2 * p[1] * p[1], p[1] + 0.1 * p[0] * p[2], p[2] * (1.0 - 0.1 * p[0])]);
    }
    let view = View { x: x.slices(), v: v.slices(), nodes, layout: Layout::Single, time: 0.0, threads: 1 };
    let mut scratch = Column::zeros(solid.properties().scratch_len);
    let mut force = Columns::<3>::zeros(places);
    let (mut slots, mut power) = (Column::default(), [0.0; WIDTH]);
    let elements = mesh.cells.len();
    let per_element = |seconds: f64| seconds * 1e9 / elements as f64;
    let mut forces = Vec::new();
    let mut refused = None;
    for simd in Simd::available() {
        let seconds = best(12, || {
            if let Err(error) = solid.prepare(simd, &view, &[], &mut scratch) {
                refused = Some(error);
            }
            for start in (0..places).step_by(TILE) {
                let range = start..(start + TILE).min(places);
                let columns = force.0.each_mut().map(|f| &mut f[range.clone()]);
                let mut tile = Tile { range, force: columns, power: &mut power, weight: None, slots: &mut slots };
                solid.add_force(simd, &view, &scratch, &mut tile);
            }
        });
        forces.push((simd.name(), per_element(seconds)));
    }
    if let Some(error) = refused {
        return Err(Failure::call(error.to_string()));
    }
    let mut matrix = BlockMatrix::<3>::default();
    let mut hessian = |keep: Definiteness| {
        let mut assemble = || matrix.assemble_one(solid, &view, &scratch, keep);
        assemble();
        per_element(best(5, assemble))
    };
    let (exact, clamped) = (hessian(Definiteness::Exact), hessian(Definiteness::Clamped));
    Ok(Row { element, elements, material, forces, hessian: exact, clamped_hessian: clamped })
}
