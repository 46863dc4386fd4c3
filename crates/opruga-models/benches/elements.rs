//! Time per element of forces and Hessians: `cargo bench -p opruga-models --bench elements`; after `--` a number of cells
//! along the side, a word out of a name for that alone, and `forces` or `Hessian` for one of the two.
//!
//! A cube of 24³ cells of six tetrahedra (82,944), bent; one thread. Hessians go into a matrix of blocks whose places are
//! known from the first time, as a solver has them.
#![allow(missing_docs)]

use opruga_core::potential::{Definiteness, Ingredients, Model, Potential, Sink};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter, View};
use opruga_core::tile::{TILE, Tile};
use opruga_math::{Column, Simd, WIDTH};
use opruga_mesh::Mesh;
use opruga_models::fem::{FemModel, SPEC};
use std::time::Instant;

/// Blocks in the order in which they come.
#[derive(Default)]
struct Replay {
    places: Vec<u32>,
    next: usize,
    blocks: Vec<[[f64; 3]; 3]>,
}
impl Sink<3> for Replay {
    fn block(&mut self, _a: usize, _b: usize, value: [[f64; 3]; 3]) {
        let block = &mut self.blocks[self.places[self.next] as usize];
        self.next += 1;
        for i in 0..3 {
            for j in 0..3 {
                block[i][j] += value[i][j];
            }
        }
    }
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; 3])]) {}
}

/// Finds the place of every block.
#[derive(Default)]
struct Learn(Vec<(u32, u32)>);
impl Sink<3> for Learn {
    fn block(&mut self, a: usize, b: usize, _value: [[f64; 3]; 3]) {
        self.0.push((a as u32, b as u32));
    }
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; 3])]) {}
}

fn best(repeats: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        work();
        let spent = start.elapsed().as_secs_f64();
        best = if spent < best { spent } else { best };
    }
    best
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let n: u32 = arguments.iter().find_map(|a| a.parse().ok()).unwrap_or(24);
    let part = |a: &String| a == "forces" || a == "Hessian";
    let word = arguments.iter().find(|a| a.parse::<u32>().is_err() && !part(a));
    let wanted = arguments.iter().find(|a| part(a)).map(String::as_str);
    let boxes = Mesh::<3>::grid([0.0; 3], [1.0; 3], [n; 3]).unwrap();
    let tetrahedra = boxes.clone().into_simplices().unwrap();
    let quadratic = Mesh::<3>::grid([0.0; 3], [1.0; 3], [n / 2; 3]).unwrap().into_simplices().unwrap();
    let quadratic = quadratic.into_quadratic().unwrap();
    for (kind, mesh) in [("tetrahedra", &tetrahedra), ("hexahedra", &boxes), ("quadratic tetrahedra", &quadratic)] {
        for material in ["neo_hookean", "stable_neo_hookean", "corotated", "linear"] {
            let name = format!("{kind} of {material}");
            if kind != "tetrahedra" && material != "neo_hookean" || word.is_some_and(|word| !name.contains(word)) {
                continue;
            }
            println!("{name} ({} of them), ns per element", mesh.cells.len());
            let mut values = Values::defaults(&SPEC, 3);
            for (name, value) in [("material", Value::Text(material.into())), ("youngs_modulus", Value::Number(1e5))] {
                values.set(&SPEC, name, value, 3).unwrap();
            }
            let mass = Parameter::uniform(1.0);
            let solid: Box<dyn Potential<3>> = FemModel
                .build(&Ingredients {
                    mesh,
                    layout: Layout::Single,
                    values: &[&values],
                    mass: &mass,
                    thickness: 1.0,
                    gravity: [0.0; 3],
                })
                .unwrap();
            measure(&*solid, mesh, wanted);
        }
    }
}

fn measure(solid: &dyn Potential<3>, mesh: &Mesh<3>, wanted: Option<&str>) {
    let nodes = mesh.positions.len();
    let places = Layout::Single.places(nodes);
    let (mut x, v) = (Columns::<3>::zeros(places), Columns::<3>::zeros(places));
    for (k, p) in mesh.positions.iter().enumerate() {
        x.set(k, [p[0] + 0.2 * p[1] * p[1], p[1] + 0.1 * p[0] * p[2], p[2] * (1.0 - 0.1 * p[0])]);
    }
    let view = View { x: x.slices(), v: v.slices(), nodes, layout: Layout::Single, time: 0.0 };
    let mut scratch = Column::zeros(solid.scratch_len());
    let mut force = Columns::<3>::zeros(places);
    let (mut slots, mut power) = (Column::default(), [0.0; WIDTH]);
    let cells = mesh.cells.len() as f64;
    for simd in Simd::available().into_iter().filter(|_| wanted != Some("Hessian")) {
        let forces = best(if wanted.is_some() { 400 } else { 20 }, || {
            solid.prepare(simd, &view, &[], &mut scratch).unwrap();
            for start in (0..places).step_by(TILE) {
                let range = start..(start + TILE).min(places);
                let columns = force.0.each_mut().map(|f| &mut f[range.clone()]);
                let mut tile = Tile { range, force: columns, power: &mut power, weight: None, slots: &mut slots };
                solid.add_force(simd, &view, &scratch, &mut tile);
            }
        });
        println!("  forces and energy  {:7}  {:6.2}", simd.name(), forces / cells * 1e9);
    }
    if wanted == Some("forces") {
        return;
    }
    let mut learn = Learn::default();
    solid.hessian(&view, &scratch, Definiteness::Exact, &mut learn);
    let mut sorted = learn.0.clone();
    sorted.sort_unstable();
    sorted.dedup();
    let find = |pair: &(u32, u32)| sorted.binary_search(pair).map_or(0, |at| at as u32);
    let mut replay =
        Replay { places: learn.0.iter().map(find).collect(), next: 0, blocks: vec![[[0.0; 3]; 3]; sorted.len()] };
    for keep in [Definiteness::Exact, Definiteness::Clamped] {
        let spent = best(5, || {
            replay.next = 0;
            solid.hessian(&view, &scratch, keep, &mut replay);
        });
        println!("  Hessian {keep:?}  {:6.1}", spent / cells * 1e9);
    }
}
