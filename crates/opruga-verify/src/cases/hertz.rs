//! Hertz's contact between two elastic bodies at rest: the extent of the contact at the measured force.
//!
//! Hertz's pressure on a line of half-width b is p₀ √(1 − x²/b²), so the mean of x² weighted by the force is b²/4. On a circle of radius a it is p₀
//! √(1 − r²/a²), and the mean of r² is 2a²/5. These means weight every force by its position, so they do not jump by the size of a cell if one more
//! node touches.

use super::BASE;
use super::pressed::Worlds;
use crate::bodies::{Cells, mapped, nodes};
use crate::case::{Case, Over};
use crate::lab::{Lab, Scene, Trouble};
use opruga::mesh::Mesh;
use std::f64::consts::{FRAC_PI_4, PI};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "hertz-line-bodies",
        quantity: "half width of the contact between two elastic cylinders of radii 1 and 2 m, the second of which is twice as stiff, relative to \
Hertz's value at the same force, plane strain, by `equilibrium`",
        source: "closed form: √(4 F R/(π E*)), 1/R = 1/R₁ + 1/R₂, 1/E* = (1 − ν²)(1/E₁ + 1/E₂) (H. Hertz 1882; K. L. Johnson, Contact Mechanics, 1985, ch. 4)",
        over: Over::Cells("cells along an eighth of the smaller circle; 7/8 as many along the larger one"),
        levels: &[12.0, 24.0, 48.0],
        expected: &[1.0],
        measure: line,
        ..BASE
    },
    Case {
        name: "hertz-sphere",
        quantity: "radius of the contact between two equal elastic balls, relative to Hertz's value at the same force, by `equilibrium`",
        source: "closed form: (3 F R/(4 E*))^⅓, R = R₁/2, E* = E/(2(1 − ν²)) (H. Hertz 1882; K. L. Johnson, Contact Mechanics, 1985, ch. 4)",
        over: Over::Cells("cells along an eighth of a great circle; one less for the other ball"),
        levels: &[4.0, 5.0, 6.0],
        expected: &[1.0],
        measure: sphere,
        ..BASE
    },
    Case {
        name: "hertz-held-balls",
        quantity: "force between two elastic half balls of 1 m whose middle planes approach one another by 2 cm, by `equilibrium`",
        unit: "N",
        source: "independent finite-element model of a half ball that is held at its middle plane and pressed against a rigid plane by 1 cm \
(Hertz's theory gives 1465.2 N, because his approach is that of points far away)",
        over: Over::Cells("cells along an eighth of a great circle; one less for the other ball"),
        levels: &[4.0, 5.0, 6.0],
        expected: &[1548.4],
        measure: force_of_balls,
        ..BASE
    },
    Case {
        name: "hertz-approach",
        quantity: "force between two elastic half balls of 1 m, relative to Hertz's value at the same approach of their middle planes, extrapolated to \
small contacts from approaches of 2 cm and 5 mm, by `equilibrium`",
        source: "closed form: F = 4/3 E* √R δ^(3/2), R = R₁/2, E* = E/(2(1 − ν²)), as a/R → 0 (H. Hertz 1882; K. L. Johnson, Contact Mechanics, \
1985, ch. 4)",
        over: Over::Cells("cells along an eighth of a great circle; one less for the other ball"),
        levels: &[6.0, 8.0, 10.0],
        expected: &[1.0],
        measure: ratio_at_small_contacts,
        ..BASE
    },
];

/// The distance between two meshes at which their surfaces touch [m].
const THICKNESS: f64 = 1e-3;
const POISSON: f64 = 0.3;

/// Half of a cylinder, or half of a ball.
#[derive(Clone, Copy)]
struct Round {
    /// The radius [m].
    radius: f64,
    /// Young's modulus [Pa].
    young: f64,
    /// Cells along an axis.
    cells: u32,
    /// The ratio of the sizes of the cells at the rim and at the pole is cosh of this number.
    grading: f64,
}

/// Cells grow by a factor of 27 from the pole to the rim. Cells of equal size would be about as large as the contact.
const GRADING: f64 = 4.0;

/// The interaction of two bodies.
struct Press {
    /// The force between them [N].
    force: f64,
    /// The mean of the square of the distance from the axis at rest, weighted by the force [m²].
    spread: f64,
}

impl Round {
    /// The mesh of half of this body or, in space, of a quarter of it. The centre is at the origin, and the pole is at the top or at the bottom.
    /// Cells near the pole are small.
    fn mesh<const D: usize>(self, up: bool) -> Result<Mesh<D>, Trouble> {
        // The surface of a body is half of the thickness outside its mesh.
        let radius = self.radius - 0.5 * THICKNESS;
        let graded = |s: f64| (self.grading * s).sinh() / self.grading.sinh();
        mapped([self.cells; D], Cells::Boxes, |s| {
            let cube: [f64; D] = core::array::from_fn(|d| match d {
                1 if up => 1.0 - graded(1.0 - s[1]),
                1 => 1.0 - graded(s[1]),
                _ => graded(s[d]),
            });
            // The cells change from a cube at the centre to a ball at the surface. Equal lengths on the sides of the cube become equal angles.
            let most = cube.iter().copied().fold(0.0, f64::max);
            let ray = cube.map(|c| if most > 0.0 { (FRAC_PI_4 * c / most).tan() } else { 1.0 });
            let length = ray.iter().map(|c| c * c).sum::<f64>().sqrt();
            core::array::from_fn(|d| {
                let x = radius * ((1.0 - most) * cube[d] + most * most * ray[d] / length);
                if d == 1 && !up { -x } else { x }
            })
        })
    }

    /// The lines of the scene for this body. Its centre is at the given height, and the horizontal plane through the centre is displaced vertically
    /// by `by`.
    fn text<const D: usize>(self, mesh: &Mesh<D>, height: f64, by: f64) -> String {
        let upward =
            |y: f64| (0..D).map(|d| if d == 1 { format!("{y:?}") } else { "0".into() }).collect::<Vec<_>>().join(", ");
        let still: Vec<String> = (0..D)
            .filter(|d| *d != 1)
            .map(|d| {
                let middle = nodes(mesh, |x| x[d].abs() < 1e-9);
                format!("{{ select = {{ nodes = {middle:?} }}, axes = \"{}\" }}", ["x", "y", "z"][d])
            })
            .collect();
        let base = nodes(mesh, |x| x[1].abs() < 1e-9);
        // As in Hertz's theory, the material is linear, and forces refer to rest positions.
        format!(
            "density = 1.0\nposition = [{}]\n\
             models = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = {:?}, poissons_ratio = {POISSON:?} }}]\n\
             pin = [{}, {{ select = {{ nodes = {base:?} }}, axes = \"y\", motion = [[0, {}], [1, {}]] }}]",
            upward(height),
            self.young,
            still.join(", "),
            upward(0.0),
            upward(by)
        )
    }
}

/// Presses two bodies together by moving their central planes towards each other by `approach` [m]. The returned force is that between whole bodies,
/// although the scene contains only a half or a quarter of each.
fn press<const D: usize>(lab: &Lab, lower: Round, upper: Round, approach: f64) -> Result<Press, Trouble>
where
    Lab: Worlds<D>,
{
    let meshes = [lower.mesh::<D>(true)?, upper.mesh::<D>(false)?];
    let scene = Scene::statics(D, 1e-9)
        .add(&format!("[contact]\nthickness = {THICKNESS:?}\nself = false"))
        .named("lower", &meshes[0], &lower.text(&meshes[0], -lower.radius, 0.0))?
        .named("upper", &meshes[1], &upper.text(&meshes[1], upper.radius, -approach))?;
    let mut world = lab.world(scene)?;
    world.frame()?;
    // The mean over both bodies is used. They carry the same pressure, but at different nodes.
    let (mut force, mut moment) = (0.0, 0.0);
    for (body, (mesh, half)) in meshes.iter().zip([-0.5, 0.5]).enumerate() {
        for (x, push) in mesh.positions.iter().zip(world.contact_forces(body)) {
            force += half * push[1];
            moment += half * push[1] * (0..D).filter(|d| *d != 1).map(|d| x[d] * x[d]).sum::<f64>();
        }
    }
    Ok(Press { force: (1 << (D - 1)) as f64 * force, spread: moment / force })
}

fn line(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    // The nodes of the two meshes do not coincide.
    let upper = Round { radius: 1.0, young: 1e6, cells: n as u32, grading: GRADING };
    let lower = Round { radius: 2.0, young: 2e6, cells: n as u32 * 7 / 8, grading: GRADING };
    let press = press::<2>(lab, lower, upper, 0.02)?;
    let stiffness = 1.0 / ((1.0 - POISSON * POISSON) * (1.0 / upper.young + 1.0 / lower.young));
    let radius = 1.0 / (1.0 / upper.radius + 1.0 / lower.radius);
    Ok(2.0 * press.spread.sqrt() / (4.0 * press.force * radius / (PI * stiffness)).sqrt())
}

/// Two equal balls pressed together by an approach [m].
fn balls(lab: &Lab, n: f64, approach: f64, grading: f64) -> Result<Press, Trouble> {
    let upper = Round { radius: 1.0, young: 1e6, cells: n as u32, grading };
    press::<3>(lab, Round { cells: upper.cells - 1, ..upper }, upper, approach)
}

fn sphere(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let press = balls(lab, n, 0.02, GRADING)?;
    let stiffness = 1e6 / (2.0 * (1.0 - POISSON * POISSON));
    Ok((2.5 * press.spread).sqrt() / (0.75 * press.force * 0.5 / stiffness).cbrt())
}

fn force_of_balls(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    Ok(balls(lab, n, 0.02, GRADING)?.force)
}

/// The ratio of the force to Hertz's deviates from 1 in proportion to a/R, because the middle planes are not far away. A quarter of the approach
/// halves this deviation.
fn ratio_at_small_contacts(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let stiffness = 1e6 / (2.0 * (1.0 - POISSON * POISSON));
    let ratio = |approach: f64, grading| -> Result<f64, Trouble> {
        Ok(balls(lab, n, approach, grading)?.force / (4.0 / 3.0 * stiffness * 0.5f64.sqrt() * approach.powf(1.5)))
    };
    // With the second grading, the cells at the pole are half as large, as is the contact.
    Ok(2.0 * ratio(0.005, 4.895)? - ratio(0.02, GRADING)?)
}
