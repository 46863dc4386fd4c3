//! What the forces of a body do not depend on: its position, its orientation, the numbering of its nodes, and the units in which
//! it is given.

use crate::support::models::{BoundaryElement as Boundary, FiniteDifference, FiniteVolume, ShapeMatching};
use crate::support::{Part, energy, forces, system};
use opruga_core::potential::Model;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;

/// A body of one method.
struct Body<'a, const D: usize> {
    name: &'static str,
    model: &'a dyn Model<D>,
    /// The parameters, if lengths are given in units that are smaller by a factor.
    values: &'a dyn Fn(f64) -> Values,
    mesh: Mesh<D>,
    /// Forces in the smaller units of length, over those in metres.
    unit: f64,
    /// Whether the order of nodes is arbitrary.
    any_order: bool,
    /// Whether the orientation of the rest shape is arbitrary: regions are boxes along the axes.
    any_direction: bool,
    /// Whether mirrored cells are given with their nodes in another order.
    turns_cells: bool,
}

const UNIT: f64 = 1e3;

fn moved<const D: usize>(mesh: &Mesh<D>, map: impl Fn(&[f64; D]) -> [f64; D]) -> Mesh<D> {
    Mesh { positions: mesh.positions.iter().map(map).collect(), ..mesh.clone() }
}
fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
fn off(a: &[f64], b: &[f64]) -> f64 {
    size(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>()) / size(b)
}
/// A displacement without symmetry, of a twentieth of the size.
fn shaken<const D: usize>(node: usize, x: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| x[d] + 0.05 * (((node * 7 + d * 5) % 11) as f64 / 5.0 - 1.0))
}
/// A rotation in the first two axes.
fn turn<const D: usize>(x: &[f64; D]) -> [f64; D] {
    let mut out = *x;
    (out[0], out[1]) = (0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1]);
    out
}
fn mirror<const D: usize>(x: &[f64; D]) -> [f64; D] {
    let mut out = *x;
    out[0] = -x[0];
    out
}
fn mapped<const D: usize>(forces: &[f64], map: impl Fn(&[f64; D]) -> [f64; D]) -> Vec<f64> {
    forces.as_chunks::<D>().0.iter().flat_map(map).collect()
}

impl<const D: usize> Body<'_, D> {
    /// The forces of a rest shape in a state, and their energy.
    fn pulled(&self, rest: &Mesh<D>, unit: f64, map: impl Fn(usize, &[f64; D]) -> [f64; D]) -> (Vec<f64>, f64) {
        let parts: [Part<D>; 1] = [(self.model, (self.values)(unit))];
        let mut body = system(rest, &parts);
        for (node, x) in rest.positions.iter().enumerate() {
            body.state.x.set(node, map(node, x));
        }
        (forces(&mut body), energy(&mut body))
    }

    fn agrees(&self, what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
        let off = off(found, expected);
        assert!(off < tolerance, "{}, {what}: {off:e}", self.name);
    }

    fn is_invariant(&self) {
        let mesh = &self.mesh;
        let (own, energy) = self.pulled(mesh, 1.0, shaken);
        // Positions are rounded to 1e-10 m; edges are a tenth of a metre long.
        let shift = |x: &[f64; D]| core::array::from_fn(|d| x[d] + [1e6, -1e6, 1e6][d]);
        let far = moved(mesh, shift);
        let (found, _) = self.pulled(&far, 1.0, |node, _| shift(&shaken(node, &mesh.positions[node])));
        self.agrees("far from the origin", &found, &own, 1e-7);

        let (found, other) = self.pulled(mesh, 1.0, |node, x| turn(&shaken(node, x)));
        self.agrees("turned", &found, &mapped::<D>(&own, turn), 1e-11);
        assert!((other - energy).abs() <= 1e-11 * energy.abs(), "{}: {other} {energy}", self.name);

        let scaled = moved(mesh, |x| x.map(|c| UNIT * c));
        let (found, _) = self.pulled(&scaled, UNIT, |node, _| shaken(node, &mesh.positions[node]).map(|c| UNIT * c));
        self.agrees("in millimetres", &found, &own.iter().map(|f| self.unit * f).collect::<Vec<f64>>(), 1e-11);

        if self.any_order {
            self.is_the_same_in_any_order(&own);
        }
        if self.any_direction {
            self.is_the_same_in_any_direction(&own, energy);
        }
    }

    fn is_the_same_in_any_direction(&self, own: &[f64], energy: f64) {
        let mesh = &self.mesh;
        let (found, other) = self.pulled(&moved(mesh, turn), 1.0, |node, _| turn(&shaken(node, &mesh.positions[node])));
        self.agrees("turned as a whole", &found, &mapped::<D>(own, turn), 1e-9);
        assert!((other - energy).abs() <= 1e-9 * energy.abs(), "{}: {other} {energy}", self.name);
        let mut mirrored = moved(mesh, mirror);
        mirrored.facets.iter_mut().for_each(|facet| facet.swap(D - 2, D - 1));
        if self.turns_cells {
            mirrored.cells.triangles.iter_mut().for_each(|cell| cell.swap(1, 2));
            mirrored.cells.tetrahedra.iter_mut().for_each(|cell| cell.swap(2, 3));
        }
        let (found, _) = self.pulled(&mirrored, 1.0, |node, _| mirror(&shaken(node, &mesh.positions[node])));
        self.agrees("in a mirror", &found, &mapped::<D>(own, mirror), 1e-9);
    }

    fn is_the_same_in_any_order(&self, own: &[f64]) {
        let (mesh, count) = (&self.mesh, self.mesh.nodes());
        let step = (2..count).find(|step| (2..=*step).all(|k| count % k != 0 || step % k != 0)).unwrap();
        let number = |node: usize| (node * step + 1) % count;
        let mut back = vec![0; count];
        let mut permuted = mesh.clone();
        for node in 0..count {
            back[number(node)] = node;
            permuted.positions[number(node)] = mesh.positions[node];
        }
        let renumber = |node: &mut u32| *node = number(*node as usize) as u32;
        permuted.facets.iter_mut().flatten().for_each(renumber);
        permuted.wires.iter_mut().flatten().for_each(renumber);
        permuted.cells.triangles.iter_mut().flatten().for_each(renumber);
        permuted.cells.quadrilaterals.iter_mut().flatten().for_each(renumber);
        permuted.cells.tetrahedra.iter_mut().flatten().for_each(renumber);
        permuted.cells.hexahedra.iter_mut().flatten().for_each(renumber);
        permuted.groups.clear();
        let (found, _) = self.pulled(&permuted, 1.0, |place, x| shaken(back[place], x));
        let sorted: Vec<f64> = (0..count).flat_map(|node| found[D * number(node)..][..D].to_vec()).collect();
        self.agrees("in another order", &sorted, own, 1e-9);
    }
}

fn block() -> Mesh<3> {
    Mesh::grid([0.1, 0.2, 0.3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap()
}
fn plate() -> Mesh<2> {
    Mesh::grid([0.1, 0.2], [1.0, 0.8], [4, 3]).unwrap()
}

#[test]
fn forces_of_finite_volumes_do_not_depend_on_place_direction_order_and_units() {
    let values = |unit: f64| values!(finite_volume, youngs_modulus: 900.0 / (unit * unit), material: "neo_hookean");
    let mesh = block().into_simplices().unwrap();
    let (name, model) = ("tetrahedra", &FiniteVolume);
    Body { name, model, values: &values, mesh, unit: 1.0, any_order: true, any_direction: true, turns_cells: true }
        .is_invariant();
    // In the plane, forces refer to a depth of one metre, which is a thousand millimetres.
    let (name, mesh, unit) = ("triangles", plate().into_simplices().unwrap(), 1.0 / UNIT);
    Body { name, model, values: &values, mesh, unit, any_order: true, any_direction: true, turns_cells: true }
        .is_invariant();
}

#[test]
fn forces_of_finite_differences_do_not_depend_on_place_direction_order_and_units() {
    let modulus = |unit: f64| 900.0 / (unit * unit);
    let body = |name, values, mesh, any_order| {
        let model = &FiniteDifference;
        Body { name, model, values, mesh, unit: 1.0, any_order, any_direction: true, turns_cells: false }
    };
    let of_solids = |unit: f64| values!(finite_difference, youngs_modulus: modulus(unit), poissons_ratio: 0.3);
    body("solid", &of_solids, block(), false).is_invariant();
    let of_sheets = |unit: f64| values!(finite_difference, youngs_modulus: modulus(unit), poissons_ratio: 0.3, thickness: 0.05 * unit);
    let sheet = Mesh::sheet([0.0, 1.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 0.0, 0.8]], [4, 3]).unwrap();
    body("sheet", &of_sheets, sheet, false).is_invariant();
    let points: Vec<[f64; 3]> =
        (0..13).map(|k| [0.1 * f64::from(k), 0.03 * f64::from(k % 3), 0.02 * f64::from(k % 2)]).collect();
    let of_curves = |unit: f64| values!(finite_difference, youngs_modulus: modulus(unit), thickness: 0.05 * unit);
    body("curve", &of_curves, Mesh::polyline(&points, false).unwrap(), true).is_invariant();
}

#[test]
fn forces_of_shape_matching_do_not_depend_on_place_direction_order_and_units() {
    for (name, region, fit) in
        [("one cluster", None, "linear"), ("quadratic", None, "quadratic"), ("regions", Some(0.7), "linear")]
    {
        let values = |unit: f64| match region {
            Some(region) => values!(shape_matching, stiffness: 800.0, fit_share: 0.5, fit: fit, region: region * unit),
            None => values!(shape_matching, stiffness: 800.0, fit_share: 0.5, fit: fit),
        };
        // κ m |x − g| in the smaller unit of length; masses stay the same.
        let model = &ShapeMatching;
        Body {
            name,
            model,
            values: &values,
            mesh: block(),
            unit: UNIT,
            any_order: region.is_none(),
            any_direction: region.is_none(),
            turns_cells: false,
        }
        .is_invariant();
    }
}

#[test]
fn forces_of_boundary_elements_do_not_depend_on_place_direction_order_and_units() {
    let values = |unit: f64| values!(boundary_element, youngs_modulus: 900.0 / (unit * unit));
    let mesh = Mesh::box_surface([0.1, 0.2, 0.3], [1.0, 0.8, 0.6], [3, 2, 2]).unwrap();
    let (name, model) = ("boundary elements", &Boundary);
    Body { name, model, values: &values, mesh, unit: 1.0, any_order: true, any_direction: true, turns_cells: false }
        .is_invariant();
}
