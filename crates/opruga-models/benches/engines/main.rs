//! Measures the cost of one engine for all stencils: `cargo bench -p opruga-models --bench engines`.
//!
//! Springs and linear tetrahedra are evaluated in turns on one thread
//!
//! * by the models as they are: runs and lists of partners (`mass_spring`), sections of elements (`fem`),
//! * by `Stencils`, tile by tile, with slots that are summed at the nodes,
//! * by `Scattered`, which evaluates each of them once, as sections do, but with any kernel.
//!
//! Each row shows the shortest time over all turns and all intervals of a millisecond [ns per spring or tetrahedron of a body],
//! and its ratio to the time of the model. `cargo bench … -- TEXT` measures the bodies whose titles contain the text.
#![allow(missing_docs)]

mod kernels;
mod scattered;

use kernels::{Spring, Tetrahedron, spring_parameters, tetrahedron_parameters};
use opruga_core::potential::{Definiteness, Ingredients, Model, Potential, Sink, StencilPack};
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter, View};
use opruga_core::stencil::Stencils;
use opruga_core::tile::{TILE, Tile};
use opruga_math::{Column, Lane, Simd, WIDTH};
use opruga_mesh::{EdgeSet, Mesh};
use opruga_models::fem::FemModel;
use opruga_models::mass_spring::MassSpring;
use opruga_models::materials::{Linear, NeoHookean};
use opruga_solve::BlockMatrix;
use scattered::Scattered;
use std::hint::black_box;
use std::time::Instant;

const TURNS: usize = 12;
/// Matrices are not measured for larger bodies: the clamped ones of `Stencils` take microseconds per tetrahedron.
const MOST_IN_MATRICES: usize = 40_000;

type Rivals<const D: usize> = Vec<(&'static str, Box<dyn Potential<D>>)>;

fn main() {
    let space = |cells: u32| Mesh::<3>::grid([0.0; 3], [1.0; 3], [cells; 3]).and_then(Mesh::into_simplices).unwrap();
    let (large, middle, small) = (space(24), space(12), space(4));
    let plane = |cells: u32| Mesh::<2>::grid([0.0; 2], [1.0; 2], [cells; 2]).and_then(Mesh::into_simplices).unwrap();
    let ring = |vertices: u32| Mesh::<2>::ring(0.5, vertices, [0.0; 2], 0.0).unwrap();
    let ball = |cuts: u32| Mesh::<3>::icosphere(0.5, cuts).unwrap();
    println!("the least of {TURNS} turns on one thread; ns (x times the model)");

    springs("ring of 4,096", &ring(4096), Layout::Single, 0.0);
    springs("sheet of triangles, 64 x 64 squares", &plane(64), Layout::Single, 0.0);
    springs("sphere", &ball(5), Layout::Single, 0.0);
    springs("sphere, damped", &ball(5), Layout::Single, 4.0);
    springs("edges of tetrahedra, 24 x 24 x 24 cubes", &large, Layout::Single, 0.0);
    springs("the same, nodes in another order", &shuffled(&large), Layout::Single, 0.0);
    springs("eight rings of 36", &ring(36), Layout::Batch, 0.0);
    springs("eight sheets, 6 x 6 squares", &plane(6), Layout::Batch, 0.0);
    springs("eight spheres", &ball(2), Layout::Batch, 0.0);
    springs("eight spheres, damped", &ball(2), Layout::Batch, 4.0);
    springs("edges of tetrahedra of eight cubes, 4 x 4 x 4", &small, Layout::Batch, 0.0);

    tetrahedra("24 x 24 x 24 cubes", &large, Layout::Single);
    tetrahedra("the same, nodes in another order", &shuffled(&large), Layout::Single);
    tetrahedra("12 x 12 x 12 cubes", &middle, Layout::Single);
    tetrahedra("4 x 4 x 4 cubes", &small, Layout::Single);
    tetrahedra("eight bodies of 4 x 4 x 4 cubes", &small, Layout::Batch);
}

/// Shuffles the numbers of the nodes of a mesh within every 64 consecutive ones, so that neighbours are consecutive only by
/// chance.
fn shuffled(mesh: &Mesh<3>) -> Mesh<3> {
    let mut new: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let mut state = 1u64;
    for some in new.chunks_mut(64) {
        for k in (1..some.len()).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            some.swap(k, (state >> 33) as usize % (k + 1));
        }
    }
    let mut out = Mesh::<3> { positions: vec![[0.0; 3]; new.len()], ..Mesh::default() };
    for (old, new) in new.iter().enumerate() {
        out.positions[*new as usize] = mesh.positions[old];
    }
    let number = |node: u32| new[node as usize];
    out.facets = mesh.facets.iter().map(|facet| facet.map(number)).collect();
    out.cells.tetrahedra = mesh.cells.tetrahedra.iter().map(|cell| cell.map(number)).collect();
    out
}

fn springs<const D: usize>(title: &str, mesh: &Mesh<D>, layout: Layout, damping: f64) {
    let edges = mesh.edges(EdgeSet::All);
    let set = vec![("stiffness", Value::Number(kernels::STIFFNESS)), ("damping", Value::Number(damping))];
    let nodes = mesh.positions.len();
    let of = |spring: usize, _: usize| spring_parameters(&mesh.positions, edges[spring], damping);
    let mut rivals: Rivals<D> = vec![
        ("mass_spring", build(&MassSpring, mesh, layout, set)),
        ("Stencils", Box::new(Stencils::<Spring, 2, 3>::new(layout, nodes, &edges, damping > 0.0, of))),
    ];
    if damping == 0.0 {
        rivals.push(("Scattered", Box::new(Scattered::<Spring, 2, 3, 0>::new(layout, nodes, &edges, of))));
    }
    compare(&format!("springs: {title}"), mesh, layout, edges.len(), &rivals);
}

fn tetrahedra(title: &str, mesh: &Mesh<3>, layout: Layout) {
    let cells = &mesh.cells.tetrahedra;
    let nodes = mesh.positions.len();
    let of = |cell: usize, _: usize| tetrahedron_parameters(&mesh.positions, cells[cell]);
    let model = |material: &str| {
        let text = Value::Text(material.to_string());
        build(&FemModel, mesh, layout, vec![("material", text), ("youngs_modulus", Value::Number(kernels::MODULUS))])
    };
    type Linears = Tetrahedron<Linear>;
    let rivals: Rivals<3> = vec![
        ("fem", model("linear")),
        ("Stencils", Box::new(Stencils::<Linears, 4, 12>::new(layout, nodes, cells, false, of))),
        ("Scattered", Box::new(Scattered::<Linears, 4, 12, 10>::new(layout, nodes, cells, of))),
    ];
    compare(&format!("linear tetrahedra: {title}"), mesh, layout, cells.len(), &rivals);
    type Rubbers = Tetrahedron<NeoHookean>;
    let rivals: Rivals<3> = vec![
        ("fem", model("neo_hookean")),
        ("Stencils", Box::new(Stencils::<Rubbers, 4, 12>::new(layout, nodes, cells, false, of))),
        ("Scattered", Box::new(Scattered::<Rubbers, 4, 12, 10>::new(layout, nodes, cells, of))),
    ];
    compare(&format!("neo-Hookean tetrahedra: {title}"), mesh, layout, cells.len(), &rivals);
}

fn build<const D: usize>(
    model: &dyn Model<D>,
    mesh: &Mesh<D>,
    layout: Layout,
    set: Vec<(&str, Value)>,
) -> Box<dyn Potential<D>> {
    let mut values = Values::defaults(model.spec(), D);
    for (name, value) in set {
        values.set(model.spec(), name, value, D).unwrap();
    }
    let ingredients = Ingredients {
        mesh,
        layout,
        values: &vec![&values; layout.stride()],
        mass: &Parameter::uniform(1.0),
        densities: None,
        thickness: 1.0,
        gravity: [0.0; D],
        step: 1e-3,
        break_off: &Default::default(),
    };
    model.build(&ingredients).unwrap()
}

/// A potential, with everything that its evaluation writes.
struct Run<'a, const D: usize> {
    potential: &'a dyn Potential<D>,
    view: View<'a, D>,
    scratch: Column,
    slots: Column,
    force: Columns<D>,
}

impl<'a, const D: usize> Run<'a, D> {
    fn new(potential: &'a dyn Potential<D>, view: View<'a, D>) -> Self {
        let scratch = Column::zeros(potential.properties().scratch_len);
        Run {
            potential,
            view,
            scratch,
            slots: Column::default(),
            force: Columns::zeros(view.layout.index_count(view.nodes)),
        }
    }
    fn forces(&mut self, simd: Simd) {
        self.potential.prepare(simd, &self.view, &[], &mut self.scratch).unwrap();
        let indices = self.view.layout.index_count(self.view.nodes);
        let mut power = [0.0; WIDTH];
        for start in (0..indices).step_by(TILE) {
            let range = start..(start + TILE).min(indices);
            let force = self.force.0.each_mut().map(|f| &mut f[range.start..range.end + WIDTH]);
            let mut tile = Tile { range, force, power: &mut power, weight: None, slots: &mut self.slots };
            self.potential.add_force(simd, &self.view, &self.scratch, &mut tile);
        }
    }
    fn energy(&mut self, simd: Simd) -> f64 {
        self.potential.energy(simd, &self.view, &self.scratch).iter().sum()
    }
}

fn compare<const D: usize>(title: &str, mesh: &Mesh<D>, layout: Layout, elements: usize, rivals: &Rivals<D>) {
    if std::env::args().skip(1).any(|text| !text.starts_with("--") && !title.contains(&text)) {
        return;
    }
    let nodes = mesh.positions.len();
    let indices = layout.index_count(nodes);
    let (mut x, v) = (Columns::<D>::zeros(indices), Columns::<D>::zeros(indices));
    for (node, p) in mesh.positions.iter().enumerate() {
        for body in 0..layout.stride() {
            let (across, size) = (p.get(2).copied().unwrap_or(0.0), 1.0 + 1e-3 * body as f64);
            let bent = [p[0] + 0.2 * p[1] * p[1], p[1] + 0.1 * p[0] * across, across * (1.0 - 0.1 * p[0])];
            x.set(layout.index(node, body), std::array::from_fn(|d| size * bent[d]));
        }
    }
    let view = View { x: x.slices(), v: v.slices(), nodes, layout, time: 0.0, threads: 1 };
    let mut runs: Vec<Run<D>> = rivals.iter().map(|(_, potential)| Run::new(&**potential, view)).collect();
    check_same(&mut runs);

    let bodies = layout.stride();
    let each = |seconds: f64| seconds * 1e9 / (elements * bodies) as f64;
    println!(
        "\n{title}: {elements} a body, {:.2} evaluations of each by tiles",
        by_tiles(&*rivals[0].1, layout, elements)
    );
    for ((name, potential), run) in rivals.iter().zip(&runs) {
        let bytes = |numbers: usize| numbers as f64 * 8.0 / elements as f64;
        println!(
            "  {name}: {:.0} bytes kept for each, {:.0} of scratch; {:.0} kB of slots",
            potential.heap_bytes() as f64 / elements as f64,
            bytes(potential.properties().scratch_len),
            run.slots.len() as f64 * 8e-3
        );
    }
    for simd in Simd::available() {
        for with_energy in [false, true] {
            let times = turns(runs.len(), |k| {
                each(least(|| {
                    runs[k].forces(simd);
                    if with_energy {
                        black_box(runs[k].energy(simd));
                    }
                }))
            });
            print_row(
                &format!("{}, forces{}", simd.name(), if with_energy { " and energy" } else { "" }),
                rivals,
                &times,
            );
        }
    }
    if layout == Layout::Batch || elements > MOST_IN_MATRICES {
        return;
    }
    let with_matrix = rivals.iter().filter(|rival| rival.1.properties().views.hessian).count();
    for (what, keep) in [("Hessian", Definiteness::Exact), ("clamped Hessian", Definiteness::Clamped)] {
        let mut matrices: Vec<BlockMatrix<D>> = (0..with_matrix).map(|_| BlockMatrix::default()).collect();
        let times = turns(with_matrix, |k| {
            each(least(|| matrices[k].assemble_one(&*rivals[k].1, &view, &runs[k].scratch, keep)))
        });
        print_row(what, rivals, &times);
    }
    let times = turns(with_matrix, |k| {
        let mut sink = NodeBlocks::<D>(vec![[[0.0; D]; D]; nodes]);
        each(least(|| rivals[k].1.hessian(&view, &runs[k].scratch, Definiteness::Exact, &mut sink)))
    });
    print_row("blocks of nodes", rivals, &times);
    let start = Instant::now();
    let colours = colours(&*rivals[0].1, nodes);
    println!("  {colours} colours of nodes from the description, {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
}

/// Checks that all implementations give the same forces and energies up to rounding, and visit the same stencils.
fn check_same<const D: usize>(runs: &mut [Run<D>]) {
    let mut first: Option<(Vec<f64>, f64, Vec<Vec<u32>>)> = None;
    for run in runs {
        run.forces(Simd::best());
        let energy = run.energy(Simd::best());
        let force: Vec<f64> = run.force.0.iter().flat_map(|column| column.iter().copied()).collect();
        let mut stencils = Vec::new();
        run.potential.stencils(&mut |nodes| stencils.push(nodes.to_vec()));
        stencils.sort();
        let Some((expected, of_first, known)) = &first else {
            first = Some((force, energy, stencils));
            continue;
        };
        let most = expected.iter().fold(0.0f64, |most, f| most.larger(f.abs()));
        let off = expected.iter().zip(&force).fold(0.0f64, |off, (f, g)| off.larger((f - g).abs()));
        assert!(most > 0.0 && off < 1e-8 * most, "forces differ by {off} of {most}");
        assert!((energy - of_first).abs() < 1e-11 * of_first.abs(), "energies {energy} and {of_first}");
        assert_eq!(known, &stencils);
    }
}

/// How often each stencil is evaluated if every tile evaluates the stencils that touch it.
fn by_tiles<const D: usize>(potential: &dyn Potential<D>, layout: Layout, elements: usize) -> f64 {
    let mut count = 0;
    potential.stencils(&mut |nodes| {
        let mut tiles: Vec<u32> = nodes.iter().map(|node| node * layout.stride() as u32 / TILE as u32).collect();
        tiles.sort_unstable();
        tiles.dedup();
        count += tiles.len();
    });
    count as f64 / elements as f64
}

/// The times of `rivals` implementations in several turns.
fn turns(rivals: usize, mut time: impl FnMut(usize) -> f64) -> Vec<Vec<f64>> {
    (0..TURNS).map(|_| (0..rivals).map(&mut time).collect()).collect()
}

/// The shortest time of a piece of work in five intervals of at least a millisecond [s].
fn least(mut work: impl FnMut()) -> f64 {
    let (mut together, mut done, mut best) = (1, 0, f64::INFINITY);
    while done < 5 {
        let start = Instant::now();
        (0..together).for_each(|_| work());
        let spent = start.elapsed().as_secs_f64();
        if spent < 1e-3 {
            together *= 2;
            continue;
        }
        best = best.smaller(spent / f64::from(together));
        done += 1;
    }
    best
}

fn print_row<const D: usize>(what: &str, rivals: &Rivals<D>, times: &[Vec<f64>]) {
    let least = |k: usize| times.iter().map(|turn| turn[k]).fold(f64::INFINITY, Lane::smaller);
    let mut text = format!("  {what}:");
    for k in 0..times[0].len() {
        text += &format!("  {} {:.2}", rivals[k].0, least(k));
        if k > 0 {
            text += &format!(" ({:.2} x)", least(k) / least(0));
        }
    }
    println!("{text}");
}

/// The diagonal blocks of the nodes, summed from the blocks that a model delivers for a whole matrix.
struct NodeBlocks<const D: usize>(Vec<[[f64; D]; D]>);
impl<const D: usize> NodeBlocks<D> {
    fn add(&mut self, node: usize, value: &[[f64; D]; D]) {
        for i in 0..D {
            for j in 0..D {
                self.0[node][i][j] += value[i][j];
            }
        }
    }
}
impl<const D: usize> Sink<D> for NodeBlocks<D> {
    fn block(&mut self, a: usize, b: usize, value: [[f64; D]; D]) {
        if a == b {
            self.add(a, &value);
        }
    }
    fn low_rank(&mut self, _: f64, _: &[(usize, [f64; D])]) {}
    fn stencils(&mut self, pack: &StencilPack<'_>) {
        for lane in 0..pack.count {
            for a in 0..pack.nodes {
                self.add(pack.index(a, lane), &pack.block(a, a, lane));
            }
        }
    }
}

/// The number of colours that the nodes need so that no two nodes of a stencil have the same colour. Each node takes the first
/// free colour.
fn colours<const D: usize>(potential: &dyn Potential<D>, nodes: usize) -> usize {
    let mut stencils = Vec::new();
    potential.stencils(&mut |of| stencils.push(of.to_vec()));
    let mut at = vec![Vec::new(); nodes];
    for (number, of) in stencils.iter().enumerate() {
        of.iter().for_each(|node| at[*node as usize].push(number));
    }
    let (mut colour, mut most) = (vec![usize::MAX; nodes], 0);
    for node in 0..nodes {
        let taken: Vec<usize> =
            at[node].iter().flat_map(|k| &stencils[*k]).map(|other| colour[*other as usize]).collect();
        colour[node] = (0..).find(|c| !taken.contains(c)).unwrap_or(0);
        most = most.max(colour[node] + 1);
    }
    most
}
