//! Chains, lattices and trusses of springs.

use super::BASE;
use crate::bodies::boundary;
use crate::case::{Case, Check, Over};
use crate::lab::{Lab, Scene, Trouble, moved_pins};
use opruga::mesh::Mesh;

const LATTICE: Case = Case {
    unit: "N/m",
    source: "exact: equal springs k along a triangular lattice act as a sheet with E₂D = 2k/√3 and ν = 1/3 (M. Ostoja-Starzewski 2002; here E₂D = 1 \
N/m is given)",
    over: Over::Parameter("strain"),
    levels: &[1e-5, 1e-4],
    tolerance: 0.001,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "catenary",
        quantity: "sag of a chain of 2 m that hangs between two points 1 m apart",
        unit: "m",
        source: "exact: y = a cosh x/a with a = 0.229640 m: sag 0.796388 m",
        over: Over::Cells("links"),
        levels: &[20.0, 40.0, 80.0],
        expected: &[0.796388],
        check: Check::Order(2.0),
        quick: true,
        measure: catenary,
        ..BASE
    },
    Case {
        name: "lattice-stretched",
        quantity: "modulus 2U/ε²A of a triangular lattice of fixed width: E₂D/(1 − ν²)",
        expected: &[1.125],
        measure: |lab, strain| lattice(lab, strain, |x, e| [e * x[0], 0.0]),
        ..LATTICE
    },
    Case {
        name: "lattice-sheared",
        quantity: "modulus 2U/γ²A of a sheared triangular lattice: E₂D/2(1 + ν)",
        expected: &[0.375],
        measure: |lab, strain| lattice(lab, strain, |x, e| [e * x[1], 0.0]),
        ..LATTICE
    },
    Case {
        name: "snap-through",
        quantity: "largest load on a shallow roof of two springs, k = 100 N/m, 2 m wide, 0.3 m high",
        unit: "N",
        source: "exact: P = 2k (l₀ − l) y/l has its maximum at l³ = l₀ b² (R. von Mises 1923), l₀² = 1.09 m², b = 1 m",
        over: Over::Step("length of a step along the curve of equilibria [m]"),
        levels: &[0.02, 0.01, 0.005],
        expected: &[SNAP],
        tolerance: 0.001,
        quick: true,
        measure: snap,
        ..BASE
    },
];

/// The largest load: 200 N · (√1.09 − l)·√(l² − 1)/l with l = 1.09^(1/6).
const SNAP: f64 = 0.994_991_695_774_456_3;

fn catenary(lab: &Lab, links: f64) -> Result<f64, Trouble> {
    let count = links as u32;
    let points: Vec<[f64; 2]> = (0..=count)
        .map(|k| {
            let s = f64::from(k) / links;
            [s, 0.75f64.sqrt() * ((2.0 * s - 1.0).abs() - 1.0)]
        })
        .collect();
    let scene = Scene::statics(2, 1e-8).add(&format!(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"chain\"\nmass = 1.0\nshape = {{ kind = \"polyline\", points = {points:?} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 1e7 }}]\npin = [{{ select = {{ nodes = [0, {count}] }} }}]"
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    Ok(-(0..=count).map(|k| world.position(0, k)[1]).fold(0.0, f64::min))
}

/// Twice the elastic energy of a lattice whose whole boundary is displaced, divided by its area and by the square of the strain.
fn lattice(lab: &Lab, strain: f64, by: impl Fn(&[f64; 2], f64) -> [f64; 2]) -> Result<f64, Trouble> {
    let (columns, rows, height) = (6u32, 4u32, 0.75f64.sqrt());
    let mut mesh = Mesh::<2>::default();
    for j in 0..=rows {
        for i in 0..=columns {
            mesh.positions.push([f64::from(i) + 0.5 * f64::from(j), height * f64::from(j)]);
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let a = i + (columns + 1) * j;
            let c = a + columns + 1;
            mesh.cells.triangles.extend([[a, a + 1, c], [a + 1, c + 1, c]]);
        }
    }
    mesh.facets = mesh.facets_from_cells()?;
    let pins = moved_pins(boundary(&mesh).into_iter().map(|k| (k, by(&mesh.positions[k as usize], strain))));
    let scene = Scene::statics(2, 1e-13)
        .body(&mesh, &format!("mass = 1.0\nmodels = [{{ kind = \"mass_spring\", modulus = 1.0 }}]\n{pins}"))?;
    let mut world = lab.plane(scene)?;
    world.frame()?;
    let area = f64::from(columns * rows) * height;
    Ok(2.0 * world.energy().elastic / (strain * strain * area))
}

/// The largest load on the path along which a roof snaps through.
fn snap(lab: &Lab, arc_length: f64) -> Result<f64, Trouble> {
    let load = 10.0;
    let scene = Scene::new(2, 1.0, 1, &format!("equilibrium\narc_length = {arc_length:?}\ntolerance = 1e-11")).add(&format!(
        "[[body]]\nname = \"roof\"\nmass = 1.0\nshape = {{ kind = \"polyline\", points = [[-1.0, 0.0], [0.0, 0.3], [1.0, 0.0]] }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 100.0 }}]\npin = [{{ select = {{ nodes = [0, 2] }} }}]\n\
         [[load]]\nkind = \"force\"\nbody = \"roof\"\nselect = {{ node = 1 }}\nvalue = [0.0, {:?}]",
        -load
    ));
    let mut world = lab.plane(scene)?;
    // The path contains pairs of height and load, until the roof is on the other side.
    let mut path: Vec<[f64; 2]> = Vec::new();
    for _ in 0..2000 {
        world.frame()?;
        let factor = world.readings(0).into_iter().find(|r| r.0 == "load_factor").ok_or("no load factor")?.1;
        path.push([world.position(0, 1)[1], load * factor]);
        if world.position(0, 1)[1] < 0.0 {
            return summit(&path).ok_or_else(|| "the load has no maximum".into());
        }
    }
    Err("it does not snap".into())
}

/// The maximum of the parabola through the highest point of a path and its neighbours.
pub(super) fn summit(path: &[[f64; 2]]) -> Option<f64> {
    let top = (0..path.len()).reduce(|a, b| if path[b][1] > path[a][1] { b } else { a })?;
    let [p, q, r] = [*path.get(top.checked_sub(1)?)?, path[top], *path.get(top + 1)?];
    let (left, right) = ((q[1] - p[1]) / (q[0] - p[0]), (r[1] - q[1]) / (r[0] - q[0]));
    let bend = (right - left) / (r[0] - p[0]);
    // The slope of the parabola at q.
    let slope = left + bend * (q[0] - p[0]);
    Some(q[1] - 0.25 * slope * slope / bend)
}
