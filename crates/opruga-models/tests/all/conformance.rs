//! Every model in the plane and in space, one line each.

use crate::support::models::{
    AsPublished, Bending, BoundaryElement, Drag, FiniteVolume, MassSpring, Pressure, ShapeMatching,
};
use opruga_core::check::{Options, conformance};
use opruga_core::error::BuildError;
use opruga_core::potential::{Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink};
use opruga_core::spec::Spec;
use opruga_core::state::{Layout, View};
use opruga_core::tile::Tile;
use opruga_math::Simd;
use opruga_mesh::Mesh;
use opruga_models::mass_spring;
use opruga_models::materials::NAMES;

fn ring(vertices: u32) -> Mesh<2> {
    Mesh::ring(0.5, vertices, [0.2, 2.0], 0.1).unwrap()
}
fn plate() -> Mesh<2> {
    Mesh::grid([0.0, 1.0], [1.0, 0.6], [5, 3]).unwrap()
}
fn chain<const D: usize>() -> Mesh<D> {
    let at =
        |k: u32| core::array::from_fn(|d| [0.1 * f64::from(k), 0.05 * f64::from(k % 3), 0.03 * f64::from(k % 2)][d]);
    Mesh::polyline(&(0..29).map(at).collect::<Vec<_>>(), false).unwrap()
}
fn sphere() -> Mesh<3> {
    Mesh::icosphere(0.5, 1).unwrap()
}
fn cloth() -> Mesh<3> {
    Mesh::sheet([0.0, 1.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [5, 4]).unwrap()
}
fn block() -> Mesh<3> {
    Mesh::grid([0.0; 3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap()
}
/// Three by three cells without the middle one.
fn frame() -> Mesh<2> {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [1.0, 0.9], [3, 3]).unwrap();
    mesh.cells.quadrilaterals.remove(4);
    mesh.facets = mesh.facets_from_cells().unwrap();
    mesh
}
fn hollow() -> Mesh<3> {
    let mut mesh = Mesh::<3>::grid([0.0; 3], [1.0, 0.9, 0.8], [3, 3, 3]).unwrap();
    mesh.cells.hexahedra.remove(13);
    mesh.facets = mesh.facets_from_cells().unwrap();
    mesh
}
/// Options with a single random state, for larger meshes: a state takes as many finite differences as there are coordinates.
fn once() -> Options {
    Options { states: 1, ..Options::default() }
}
fn mirrored() -> Options {
    Options { mirrored: true, ..Options::default() }
}
fn shrunk() -> Options {
    Options { stretch: 0.05, noise: 0.01, coincident: false, ..Options::default() }
}

#[test]
fn mass_spring_in_the_plane() {
    let soft = [values!(mass_spring, stiffness: 300.0)];
    let damped =
        [values!(mass_spring, stiffness: 300.0, damping: 2.0), values!(mass_spring, stiffness: 50.0, damping: 3.0)];
    conformance("ring", &MassSpring, &soft, &ring(36), &Options::default()).assert();
    conformance("ring of five", &MassSpring, &damped, &ring(5), &Options::default()).assert();
    conformance("long ring", &MassSpring, &damped, &ring(130), &once()).assert();
    conformance("chain", &MassSpring, &damped, &chain::<2>(), &Options::default()).assert();
    let modulus = values!(mass_spring, modulus: 800.0, damping: 1.0, edges: "shear");
    conformance("plate", &MassSpring, &[modulus], &plate(), &Options::default()).assert();
    conformance("mirrored", &MassSpring, &soft, &plate(), &mirrored()).assert();
}

#[test]
fn mass_spring_in_space() {
    let damped = [values!(mass_spring, stiffness: 300.0, damping: 2.0), values!(mass_spring, stiffness: 50.0)];
    conformance("sphere", &MassSpring, &damped, &sphere(), &Options::default()).assert();
    conformance("cloth", &MassSpring, &damped, &cloth(), &Options::default()).assert();
    conformance("block", &MassSpring, &damped, &block(), &Options::default()).assert();
    conformance("chain", &MassSpring, &damped, &chain::<3>(), &Options::default()).assert();
}

#[test]
fn pressure_in_the_plane() {
    let isothermal = [values!(pressure, nRT: 70.0), values!(pressure, pressure: 200.0, ambient: 150.0)];
    conformance("isothermal", &Pressure, &isothermal, &ring(36), &Options::default()).assert();
    conformance("of five", &Pressure, &isothermal, &ring(5), &Options::default()).assert();
    let adiabatic = [values!(pressure, pressure: 200.0, process: "adiabatic", ambient: 90.0)];
    conformance("adiabatic", &Pressure, &adiabatic, &ring(37), &Options::default()).assert();
    conformance("plate", &Pressure, &adiabatic, &plate(), &Options::default()).assert();
    conformance("inside out", &Pressure, &adiabatic, &ring(36), &mirrored()).assert();
    conformance("inside out", &Pressure, &isothermal[..1], &ring(36), &mirrored()).assert();
    conformance("nearly empty", &Pressure, &adiabatic, &ring(36), &shrunk()).assert();
    let capped = values!(pressure, nRT: 70.0, largest_pressure: 20.0, ambient: 7.0);
    conformance("capped", &Pressure, &[capped], &ring(36), &Options::default()).assert();
    let inside = [values!(pressure, nRT: 7.0, ambient: 20.0, inside: "cavities")];
    conformance("frame", &Pressure, &inside, &frame(), &Options::default()).assert();
}

#[test]
fn pressure_in_space() {
    let isothermal = [values!(pressure, nRT: 70.0), values!(pressure, pressure: 200.0, ambient: 150.0)];
    conformance("isothermal", &Pressure, &isothermal, &sphere(), &Options::default()).assert();
    let adiabatic = [values!(pressure, pressure: 200.0, process: "adiabatic", gamma: 1.67, ambient: 90.0)];
    conformance("adiabatic", &Pressure, &adiabatic, &sphere(), &Options::default()).assert();
    conformance("block", &Pressure, &adiabatic, &block(), &once()).assert();
    conformance("inside out", &Pressure, &adiabatic, &sphere(), &mirrored()).assert();
    conformance("nearly empty", &Pressure, &adiabatic, &sphere(), &shrunk()).assert();
    let capped = values!(pressure, nRT: 70.0, process: "adiabatic", largest_pressure: 20.0, ambient: 7.0);
    conformance("capped", &Pressure, &[capped], &sphere(), &Options::default()).assert();
    let inside = [values!(pressure, nRT: 7.0, ambient: 20.0, inside: "cavities")];
    conformance("hollow", &Pressure, &inside, &hollow(), &Options::default()).assert();
}

#[test]
fn bending_in_the_plane() {
    let damped = [
        values!(bending, stiffness: 0.3, damping: 0.02),
        values!(bending, modulus: 5e4, thickness: 0.02, damping: 0.01),
    ];
    conformance("ring", &Bending, &damped, &ring(36), &Options::default()).assert();
    conformance("of three", &Bending, &damped, &ring(3), &Options::default()).assert();
    conformance("long ring", &Bending, &damped, &ring(130), &once()).assert();
    conformance("chain", &Bending, &damped, &chain::<2>(), &Options::default()).assert();
    let straight = [values!(bending, stiffness: 0.3, rest: "straight")];
    conformance("straight", &Bending, &straight, &plate(), &Options::default()).assert();
    conformance("inside out", &Bending, &damped, &ring(36), &mirrored()).assert();
}

#[test]
fn bending_in_space() {
    let damped = [
        values!(bending, stiffness: 0.3, damping: 0.02),
        values!(bending, modulus: 5e4, thickness: 0.02, damping: 0.01),
    ];
    conformance("sphere", &Bending, &damped, &sphere(), &Options::default()).assert();
    conformance("cloth", &Bending, &damped, &cloth(), &Options::default()).assert();
    conformance("chain", &Bending, &damped, &chain::<3>(), &Options::default()).assert();
    let straight = [values!(bending, stiffness: 0.3, rest: "straight")];
    conformance("straight", &Bending, &straight, &chain::<3>(), &Options::default()).assert();
    conformance("block", &Bending, &straight, &block(), &once()).assert();
    conformance("inside out", &Bending, &damped, &sphere(), &mirrored()).assert();
}

#[test]
fn shape_matching_in_the_plane() {
    let rigid = [values!(shape_matching, stiffness: 300.0)];
    let fitted = [
        values!(shape_matching, stiffness: 300.0, fit_share: 0.7),
        values!(shape_matching, stiffness: 50.0, fit_share: 1.0),
    ];
    let bent = [values!(shape_matching, stiffness: 300.0, fit_share: 0.9, fit: "quadratic")];
    conformance("ring", &ShapeMatching, &rigid, &ring(36), &Options::default()).assert();
    conformance("of three", &ShapeMatching, &fitted, &ring(3), &Options::default()).assert();
    conformance("fitted", &ShapeMatching, &fitted, &plate(), &Options::default()).assert();
    conformance("bent", &ShapeMatching, &bent, &plate(), &Options::default()).assert();
    conformance("chain", &ShapeMatching, &bent, &chain::<2>(), &Options::default()).assert();
    conformance("inside out", &ShapeMatching, &fitted, &plate(), &mirrored()).assert();
    conformance("shrunk", &ShapeMatching, &fitted, &plate(), &shrunk()).assert();
    let regions = [values!(shape_matching, stiffness: 300.0, fit_share: 0.5, region: 0.4)];
    conformance("regions", &ShapeMatching, &regions, &plate(), &Options::default()).assert();
}

#[test]
fn shape_matching_in_space() {
    let rigid = [values!(shape_matching, stiffness: 300.0), values!(shape_matching, stiffness: 20.0)];
    let fitted = [values!(shape_matching, stiffness: 300.0, fit_share: 0.7)];
    let bent = [values!(shape_matching, stiffness: 300.0, fit_share: 0.9, fit: "quadratic")];
    conformance("sphere", &ShapeMatching, &rigid, &sphere(), &Options::default()).assert();
    conformance("cloth", &ShapeMatching, &fitted, &cloth(), &Options::default()).assert();
    conformance("block", &ShapeMatching, &bent, &block(), &Options::default()).assert();
    conformance("chain", &ShapeMatching, &fitted, &chain::<3>(), &Options::default()).assert();
    conformance("inside out", &ShapeMatching, &fitted, &block(), &mirrored()).assert();
    conformance("shrunk", &ShapeMatching, &bent, &block(), &shrunk()).assert();
    let regions = [values!(shape_matching, stiffness: 300.0, fit_share: 0.5, region: 0.7)];
    conformance("regions", &ShapeMatching, &regions, &block(), &Options::default()).assert();
}

/// No frame follows a collapsed body, so the model does not claim a finite force for coincident nodes.
#[test]
fn boundary_element_in_the_plane() {
    let options = Options { coincident: false, ..once() };
    let values = [
        values!(boundary_element, youngs_modulus: 900.0),
        values!(boundary_element, youngs_modulus: 200.0, poissons_ratio: 0.4, plane: "stress"),
    ];
    conformance("ring", &BoundaryElement, &values, &ring(36), &options).assert();
    conformance("of five", &BoundaryElement, &values, &ring(5), &options).assert();
    let exterior = [values!(boundary_element, youngs_modulus: 900.0, exterior: true)];
    let options = Options { rigid: false, ..options };
    conformance("outside", &BoundaryElement, &exterior, &ring(20), &options).assert();
}

#[test]
fn boundary_element_in_space() {
    let options = Options { coincident: false, ..once() };
    let values = [
        values!(boundary_element, youngs_modulus: 900.0),
        values!(boundary_element, youngs_modulus: 200.0, poissons_ratio: 0.4),
    ];
    conformance("sphere", &BoundaryElement, &values, &sphere(), &options).assert();
    let surface = Mesh::box_surface([0.0; 3], [1.0, 0.8, 0.6], [2, 2, 1]).unwrap();
    conformance("block", &BoundaryElement, &values, &surface, &options).assert();
    let exterior = [values!(boundary_element, youngs_modulus: 900.0, exterior: true)];
    let options = Options { rigid: false, ..options };
    conformance("outside", &BoundaryElement, &exterior, &sphere(), &options).assert();
}

/// The published force is not a gradient: only its bits and invariances are claimed.
#[test]
fn shape_matching_as_published() {
    let published = [
        values!(shape_matching, stiffness: 300.0, fit_share: 0.7, scheme: "as_published"),
        values!(shape_matching, goal_step: 0.1, fit_share: 0.3, scheme: "as_published"),
    ];
    let options = Options { views: false, ..Options::default() };
    conformance("plate", &ShapeMatching, &published, &plate(), &options).assert();
    conformance("block", &ShapeMatching, &published, &block(), &options).assert();
    conformance("inside out", &ShapeMatching, &published, &block(), &Options { mirrored: true, ..options }).assert();
}

#[test]
fn finite_volume_in_the_plane() {
    let mesh = plate().into_simplices().unwrap();
    for material in NAMES {
        for plane in ["strain", "stress"] {
            let values = [
                values!(finite_volume, youngs_modulus: 900.0, material: *material, plane: plane),
                values!(finite_volume, youngs_modulus: 200.0, poissons_ratio: 0.4, material: *material, plane: plane),
            ];
            let options = Options { rigid: *material != "linear", coincident: false, ..once() };
            conformance(material, &FiniteVolume, &values, &mesh, &options).assert();
            // F differs between the faces of a quadrilateral: the torque does not vanish, and there is no energy.
            let options = Options { rigid: false, ..options };
            conformance(material, &FiniteVolume, &values, &plate(), &options).assert();
        }
    }
}

#[test]
fn finite_volume_in_space() {
    let mesh = block().into_simplices().unwrap();
    for material in NAMES {
        let values = [
            values!(finite_volume, youngs_modulus: 900.0, material: *material),
            values!(finite_volume, youngs_modulus: 200.0, poissons_ratio: 0.4, material: *material),
        ];
        let options = Options { rigid: *material != "linear", coincident: false, ..once() };
        conformance(material, &FiniteVolume, &values, &mesh, &options).assert();
        let options = Options { rigid: false, ..options };
        conformance(material, &FiniteVolume, &values, &block(), &options).assert();
    }
}

/// Drag brakes rigid motion by design, so it does not claim the properties of rigid motion.
#[test]
fn drag() {
    let options = Options { rigid: false, ..Options::default() };
    conformance("drag", &Drag, &[values!(drag, rate: 0.7)], &ring(36), &options).assert();
    conformance("drag", &Drag, &[values!(drag, rate: 0.7), values!(drag, rate: 0.0)], &sphere(), &options).assert();
}

/// The published forces have no potential, do not rotate with the body and are not finite for edges without length.
#[test]
fn as_published_in_the_plane() {
    let options = Options { rigid: false, coincident: false, ..Options::default() };
    conformance("published", &AsPublished, &[values!(as_published)], &ring(36), &options).assert();
}

/// Meshes of many tiles: bits and invariance, without finite differences.
#[test]
fn many_tiles() {
    let large = Options { states: 1, derivatives: false, ..Options::default() };
    let springs = [values!(mass_spring, stiffness: 300.0, damping: 2.0)];
    let gas = [values!(pressure, nRT: 70.0, ambient: 10.0)];
    let hinges = [values!(bending, stiffness: 0.3, damping: 0.02)];
    let goals = [values!(shape_matching, stiffness: 300.0, fit_share: 0.5)];
    let regions = [values!(shape_matching, stiffness: 300.0, fit_share: 0.5, region: 0.2)];
    let (ring, grid) = (ring(1700), Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [37, 41]).unwrap());
    conformance("ring", &MassSpring, &springs, &ring, &large).assert();
    conformance("grid", &MassSpring, &springs, &grid, &large).assert();
    conformance("ring", &Pressure, &gas, &ring, &large).assert();
    conformance("ring", &Bending, &hinges, &ring, &large).assert();
    conformance("whole", &ShapeMatching, &goals, &grid, &large).assert();
    conformance("regions", &ShapeMatching, &regions, &grid, &large).assert();
    conformance("ring", &Drag, &[values!(drag, rate: 2.0)], &ring, &Options { rigid: false, ..large }).assert();
    let (sphere, cloth) = (
        Mesh::icosphere(0.5, 4).unwrap(),
        Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [37, 41]).unwrap(),
    );
    for mesh in [&sphere, &cloth] {
        conformance("shell", &MassSpring, &springs, mesh, &large).assert();
        conformance("shell", &Bending, &hinges, mesh, &large).assert();
    }
    conformance("sphere", &Pressure, &gas, &sphere, &large).assert();
}

/// The faults that a wrong model adds to the right one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Slope,
    Tile,
    Batch,
    Push,
    Skew,
    Vector,
    Lift,
    /// A damping matrix that is not the derivative of the damping force.
    Brake,
    /// Springs that are missing from the stencils.
    Hidden,
}

#[derive(Debug)]
struct Faulty(Fault);

#[derive(Debug)]
struct FaultySprings(Fault, Layout, Box<dyn Potential<2>>);

impl Model<2> for Faulty {
    fn spec(&self) -> &'static Spec {
        &mass_spring::SPEC
    }
    fn build(&self, ingredients: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        Ok(Box::new(FaultySprings(self.0, ingredients.layout, MassSpring.build(ingredients)?)))
    }
}

impl Potential<2> for FaultySprings {
    fn properties(&self) -> Properties {
        Properties::new("faulty", self.2.properties().views)
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        if self.0 != Fault::Hidden {
            self.2.stencils(visit);
        }
    }
    fn add_force(&self, simd: Simd, view: &View<2>, scratch: &[f64], tile: &mut Tile<2>) {
        self.2.add_force(simd, view, scratch, tile);
        match self.0 {
            Fault::Slope if tile.range.contains(&9) => tile.force[0][9 - tile.range.start] *= 1.0 + 1e-5,
            Fault::Tile => tile.force[0][0] *= 1.0 + 1e-15 * tile.range.len() as f64,
            Fault::Batch if self.1 == Layout::Batch => tile.force[1][0] *= 1.0 + 1e-15,
            Fault::Push => tile.force[1][0] += 1e-6,
            Fault::Vector if simd == Simd::Baseline => tile.force[1][0] *= 1.0 + 1e-15,
            // A force against the motion of the whole body.
            Fault::Lift => tile.force[1][0] -= 1e-6 * view.v[1][tile.range.start],
            _ => {}
        }
    }
    fn energy(&self, simd: Simd, view: &View<2>, scratch: &[f64]) -> [f64; 8] {
        self.2.energy(simd, view, scratch)
    }
    fn damping_matrix(&self, view: &View<2>, scratch: &[f64], sink: &mut dyn Sink<2>) {
        self.2.damping_matrix(view, scratch, sink);
        if self.0 == Fault::Brake {
            sink.block(3, 3, [[1e-4, 0.0], [0.0, 0.0]]);
        }
    }
    fn hessian(&self, view: &View<2>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<2>) {
        self.2.hessian(view, scratch, keep, sink);
        if self.0 == Fault::Skew {
            sink.block(0, 8, [[1e-3, 0.0], [0.0, 0.0]]);
        }
    }
}

impl Observe<2> for FaultySprings {}

#[test]
fn faults_are_found() {
    let damped = [values!(mass_spring, stiffness: 300.0, damping: 2.0)];
    let mut faults = vec![
        (Fault::Slope, vec!["gradient", "net force"]),
        (Fault::Tile, vec!["tiles"]),
        (Fault::Batch, vec!["batch"]),
        (Fault::Push, vec!["net force"]),
        (Fault::Skew, vec!["hessian", "symmetry", "infinitesimal rotation"]),
        (Fault::Lift, vec!["rigid motion", "power", "damping matrix"]),
        (Fault::Brake, vec!["damping matrix"]),
        (Fault::Hidden, vec!["stencils"]),
    ];
    if Simd::available().len() > 1 {
        faults.push((Fault::Vector, vec!["lanes"]));
    }
    for (fault, quantities) in faults {
        let report = conformance("faulty", &Faulty(fault), &damped, &ring(20), &Options::default());
        for quantity in quantities {
            let failed = report.rows.iter().any(|r| r.quantity == quantity && !r.passes());
            assert!(failed, "{fault:?} did not show in {quantity}\n{report}");
        }
    }
}
