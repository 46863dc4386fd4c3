//! Patch tests: solutions that a kind of cells must represent exactly on irregular meshes.

use super::BASE;
use crate::bodies::{Cells, boundary};
use crate::case::{Case, Check, Over, Scale};
use crate::lab::{Lab, Scene, Trouble, moved_pins};
use opruga::mesh::Mesh;

const AFFINE: Case = Case {
    quantity: "largest deviation of inner nodes from the affine displacement that is prescribed on the boundary, neo-Hookean",
    unit: "m",
    source: "exact: an affine displacement has constant stress (B. Irons, A. Razzaque 1972; O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, ch. patch test)",
    over: Over::Cells("cells along a side of 1 m"),
    levels: &[2.0, 3.0, 4.0],
    expected: &[0.0],
    scale: Scale::Of(1.0),
    tolerance: 1e-12,
    check: Check::Everywhere,
    quick: true,
    ..BASE
};

const BENDING: Case = Case {
    quantity: "largest deviation of inner nodes from pure bending, which is prescribed on the boundary, linear",
    source: "exact: pure bending is of second degree and in equilibrium (S. Timoshenko, J. N. Goodier, Theory of Elasticity, art. 102)",
    ..AFFINE
};

pub(super) const CASES: &[Case] = &[
    Case { name: "patch-triangles", measure: |lab, n| plane(lab, n, Cells::Linear, false), ..AFFINE },
    Case { name: "patch-quadratic-triangles", measure: |lab, n| plane(lab, n, Cells::Quadratic, false), ..AFFINE },
    Case { name: "patch-quadrilaterals", measure: |lab, n| plane(lab, n, Cells::Boxes, false), ..AFFINE },
    Case { name: "patch-tetrahedra", measure: |lab, n| space(lab, n, Cells::Linear, false), ..AFFINE },
    Case { name: "patch-quadratic-tetrahedra", measure: |lab, n| space(lab, n, Cells::Quadratic, false), ..AFFINE },
    Case { name: "patch-hexahedra", measure: |lab, n| space(lab, n, Cells::Boxes, false), ..AFFINE },
    Case {
        name: "bending-patch-quadratic-triangles",
        measure: |lab, n| plane(lab, n, Cells::Quadratic, true),
        ..BENDING
    },
    Case {
        name: "bending-patch-quadratic-tetrahedra",
        measure: |lab, n| space(lab, n, Cells::Quadratic, true),
        ..BENDING
    },
];

/// Equal cells whose nodes are moved at random by up to an eighth of a cell.
pub(super) fn irregular<const D: usize>(n: f64, cells: Cells) -> Result<Mesh<D>, Trouble> {
    let mut grid = Mesh::<D>::grid([0.0; D], [1.0; D], [n as u32; D])?;
    let mut random = 11u64;
    for c in grid.positions.iter_mut().flatten() {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *c += 0.25 / n * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5);
    }
    cells.cut(grid)
}

/// The displacement at a point in an affine deformation, or in pure bending in plane stress with ν = 0.4. Displacements are up to about a tenth of
/// the size.
pub(super) fn displaced<const D: usize>(x: &[f64; D], bends: bool) -> [f64; D] {
    if bends {
        let (curvature, poisson) = (0.1, 0.4);
        let z = if D == 3 { x[2] } else { 0.0 };
        let up = 0.5 * curvature * (x[0] * x[0] + poisson * (x[1] * x[1] - z * z));
        return core::array::from_fn(|d| [-curvature * x[0] * x[1], up, poisson * curvature * x[1] * z][d]);
    }
    core::array::from_fn(|i| {
        let row = (0..D).map(|j| [0.9, -0.4, 0.7, 0.3, -0.6][(2 * i + 3 * j) % 5] * x[j]);
        0.03 + 0.05 * row.sum::<f64>()
    })
}

fn scene<const D: usize>(mesh: &Mesh<D>, bends: bool) -> Result<Scene, Trouble> {
    let law = if bends { if D == 2 { "linear\", plane = \"stress" } else { "linear" } } else { "neo_hookean" };
    let pins = moved_pins(boundary(mesh).into_iter().map(|k| (k, displaced(&mesh.positions[k as usize], bends))));
    Scene::statics(D, 1e-13).body(
        mesh,
        &format!("density = 1.0\nmodels = [{{ kind = \"fem\", material = \"{law}\", youngs_modulus = 1.0, poissons_ratio = 0.4 }}]\n{pins}"),
    )
}

pub(super) fn worst<const D: usize>(mesh: &Mesh<D>, bends: bool, now: impl Fn(u32) -> [f64; D]) -> f64 {
    let mut worst: f64 = 0.0;
    for (node, x) in mesh.positions.iter().enumerate() {
        let (u, now) = (displaced(x, bends), now(node as u32));
        (0..D).for_each(|d| worst = worst.max((now[d] - x[d] - u[d]).abs()));
    }
    worst
}

fn plane(lab: &Lab, n: f64, cells: Cells, bends: bool) -> Result<f64, Trouble> {
    let mesh = irregular::<2>(n, cells)?;
    let mut world = lab.plane(scene(&mesh, bends)?)?;
    world.frame()?;
    Ok(worst(&mesh, bends, |node| world.position(0, node)))
}

fn space(lab: &Lab, n: f64, cells: Cells, bends: bool) -> Result<f64, Trouble> {
    let mesh = irregular::<3>(n, cells)?;
    let mut world = lab.space(scene(&mesh, bends)?)?;
    world.frame()?;
    Ok(worst(&mesh, bends, |node| world.position(0, node)))
}
