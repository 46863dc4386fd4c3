//! Bars that pins stretch to five times their length against the elasticity and damping of their cells, compared with the closed form of Kelvin and
//! Voigt.

use crate::common;

use common::{solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Mass, PinBlueprint, Selector, Time};
use opruga_world::{Options, World};

const STIFFNESS: f64 = 1e4;
const RATIO: f64 = 0.3;
/// The retardation time [s].
const DAMPING: f64 = 0.05;
/// Change of the stretch per second.
const RATE: f64 = 2.0;

/// The force on the right side of a bar of 4 m along x [N], during and after stretching; lateral motion is pinned.
fn drawn<const D: usize>(mesh: &Mesh<D>, rule: &str) -> Vec<f64> {
    let mut world = bar(mesh, rule, "st_venant_kirchhoff", DAMPING);
    let right: Vec<usize> = (0..mesh.positions.len()).filter(|k| mesh.positions[*k][0] == 4.0).collect();
    let frame = |_| {
        world.frame().expect("a frame");
        let forces = world.node_forces(0, None);
        right.iter().map(|node| -forces[*node][0]).sum()
    };
    (0..150).map(frame).collect()
}

/// A bar of 4 m along x whose right side pins move by 16 m in 2 s; lateral motion is pinned.
fn bar<const D: usize>(mesh: &Mesh<D>, rule: &str, material: &str, damping: f64) -> World<D> {
    let fields = [
        ("material", text(material)),
        ("youngs_modulus", Value::Number(STIFFNESS)),
        ("poissons_ratio", Value::Number(RATIO)),
        ("damping", Value::Number(damping)),
    ];
    let mut blueprint = solid(mesh.clone(), rule, &[], &fields);
    // So light that forces balance at all times.
    blueprint.bodies[0].mass = Mass::Density(1e-3);
    blueprint.time = Time { seconds: 1e3, frame: 1.0 / 60.0, substeps: 1 };
    let row = |t: f64, way: f64| [t, way].into_iter().chain(core::iter::repeat_n(0.0, D - 1)).collect();
    let across = core::array::from_fn(|d| d > 0);
    let along = core::array::from_fn(|d| d == 0);
    blueprint.bodies[0].pins = vec![
        PinBlueprint { select: Selector::All, axes: across, motion: Vec::new() },
        PinBlueprint { select: Selector::Side("left".into()), axes: along, motion: Vec::new() },
        PinBlueprint {
            select: Selector::Side("right".into()),
            axes: along,
            motion: vec![row(0.0, 0.0), row(2.0, 16.0)],
        },
    ];
    World::new(blueprint, Options::default()).expect("a world")
}

/// Uniform stretch λ without lateral strain: Green's strain E₁₁ = (λ² − 1)/2, its rate λ λ̇, so P = (2μ + λₗ) (λ (λ² − 1)/2 + τ λ² λ̇).
fn at_the_closed_form<const D: usize>(mesh: &Mesh<D>, name: &str) {
    let modulus = STIFFNESS * (1.0 - RATIO) / ((1.0 + RATIO) * (1.0 - 2.0 * RATIO));
    for rule in ["backward_euler", "bdf2"] {
        let force = drawn(mesh, rule);
        // Skip the transients at the start and at the end of the motion.
        for (frame, force) in force.iter().enumerate().filter(|(k, _)| (30..118).contains(k) || *k > 145) {
            let time = (frame + 1) as f64 / 60.0;
            let (stretch, rate) = if time < 2.0 { (1.0 + RATE * time, RATE) } else { (5.0, 0.0) };
            let wanted = modulus * (0.5 * stretch * (stretch * stretch - 1.0) + DAMPING * stretch * stretch * rate);
            assert!((force / wanted - 1.0).abs() < 1e-5, "{name}, {rule}, {time} s: {force} N, {wanted} N");
        }
    }
}

#[test]
fn damped_bars_drawn_to_five_lengths_take_what_kelvin_and_voigt_say() {
    let flat = Mesh::<2>::grid([0.0; 2], [4.0, 1.0], [8, 2]).expect("a grid");
    at_the_closed_form(&flat, "quadrilaterals");
    let triangles = flat.into_simplices().expect("triangles");
    at_the_closed_form(&triangles, "triangles");
    at_the_closed_form(&triangles.into_quadratic().expect("quadratic triangles"), "quadratic triangles");
    let boxes = Mesh::<3>::grid([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).expect("a grid");
    at_the_closed_form(&boxes, "hexahedra");
    let tetrahedra = boxes.into_simplices().expect("tetrahedra");
    at_the_closed_form(&tetrahedra, "tetrahedra");
    at_the_closed_form(&tetrahedra.into_quadratic().expect("quadratic tetrahedra"), "quadratic tetrahedra");
}

/// Without damping such a bar stays uniform up to five times its volume: no law has a lower energy for a nonuniform shape of its boxes.
#[test]
fn boxes_drawn_to_five_times_their_volume_stay_even() {
    let boxes = Mesh::<3>::grid([0.0; 3], [4.0, 1.0, 1.0], [8, 2, 2]).expect("a grid");
    let laws =
        ["stable_neo_hookean", "neo_hookean", "fixed_corotated", "corotated", "mooney_rivlin", "st_venant_kirchhoff"];
    for material in laws {
        let mut world = bar(&boxes, "backward_euler", material, 0.0);
        for frame in 1..=120 {
            world.frame().unwrap_or_else(|error| panic!("{material}, frame {frame}: {error}"));
        }
        for (node, at) in boxes.positions.iter().enumerate() {
            let x = world.position(0, node as u32)[0];
            assert!((x - 5.0 * at[0]).abs() < 1e-5, "{material}, node {node}: {x} m, from {} m", at[0]);
        }
    }
}
