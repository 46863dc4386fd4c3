//! A shrink fit: bodies that start closer to one another than the distance that contact keeps between their surfaces.

use super::BASE;
use crate::bodies::{Cells, mapped, symmetric};
use crate::case::{Case, Check, Over};
use crate::lab::{Lab, Scene, Trouble};
use opruga::mesh::Mesh;
use std::f64::consts::FRAC_PI_2;

pub(super) const CASES: &[Case] = &[Case {
    name: "shrink-fit",
    quantity: "pressure between two tubes of radii 1, 1.5 and 2 m, the outer of which is 1 mm too narrow, plane stress",
    unit: "Pa",
    source: "closed form: E δ (b² − a²) (c² − b²)/(2 b³ (c² − a²)) (G. Lamé, B. Clapeyron 1833)",
    over: Over::Cells("sides of a quarter of the outer tube"),
    levels: &[64.0, 128.0, 256.0],
    expected: &[108.024_691_358_024_7],
    check: Check::Order(2.0),
    measure: shrink_fit,
    ..BASE
}];

/// A quarter of a tube. The mean radii of its polygonal sides are `inner` and `outer` [m].
fn tube(sides: u32, layers: u32, inner: f64, outer: f64) -> Result<Mesh<2>, Trouble> {
    let half = 0.5 * FRAC_PI_2 / f64::from(sides);
    // The mean radius of a side between two points on the unit circle.
    let mean = half.cos() * half.sin().atanh() / half;
    mapped([layers, sides], Cells::Boxes, |[s, t]| {
        let radius = (inner + s * (outer - inner)) / mean;
        let (sin, cos) = (FRAC_PI_2 * t).sin_cos();
        [if t == 1.0 { 0.0 } else { radius * cos }, radius * sin]
    })
}

/// The pressure between two light tubes after their first steps, in which backward Euler brings them to rest. Contact keeps their surfaces 2 mm
/// apart, and they start 1 mm apart.
fn shrink_fit(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let (apart, interference) = (1e-3, 1e-3);
    let sides = n as u32;
    // The nodes of the two meshes do not coincide.
    let inner = tube(sides * 7 / 8, sides / 16, 1.0, 1.5 - 0.5 * apart)?;
    let outer = tube(sides, sides / 16, 1.5 + 0.5 * apart, 2.0)?;
    let body = |mesh: &Mesh<2>| {
        format!(
            "mass = 1.0\nmodels = [{{ kind = \"fem\", youngs_modulus = 1e6, poissons_ratio = 0.3, plane = \"stress\" }}]\n{}",
            symmetric(mesh)
        )
    };
    let scene = Scene::new(2, 0.1, 1, "backward_euler")
        .add(&format!("[contact]\nthickness = {:?}\nself = false", apart + interference))
        .named("inner", &inner, &body(&inner))?
        .named("outer", &outer, &body(&outer))?;
    let mut world = lab.plane(scene)?;
    for _ in 0..4 {
        world.frame()?;
    }
    // The integral of p cos φ along a quarter of the circle is p r.
    let force: f64 = world.contact_forces(1).iter().map(|[x, y]| 0.5 * (x + y)).sum();
    Ok(force / 1.5)
}
