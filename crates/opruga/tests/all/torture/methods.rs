//! Row 62 for the other methods of the survey: bodies that are collapsed, mirrored, stretched or twisted recover, or Opruga reports why not.

use super::*;
use opruga::AnyWorld;
use opruga::math::Lane;

/// The new position of a node of a body about the origin, from its position and its number.
type Spoil = (&'static str, fn([f64; 3], usize) -> [f64; 3]);

/// A number from −0.5 to 0.5 that depends on a node and an axis.
fn random(node: usize, axis: usize) -> f64 {
    let mut number = (node * 3 + axis + 1) as u64;
    for _ in 0..3 {
        number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    }
    (number >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

/// Twists a body about x by this number of turns from one end to the other.
#[allow(clippy::disallowed_methods, reason = "the start of a test, compared with nothing")]
fn twisted(x: [f64; 3], turns: f64) -> [f64; 3] {
    let (sine, cosine) = (core::f64::consts::TAU * turns * x[0]).sin_cos();
    [x[0], cosine * x[1] - sine * x[2], sine * x[1] + cosine * x[2]]
}

const SHAPES: &[Spoil] = &[
    ("a plane", |x, _| [x[0], x[1], 0.0]),
    ("a line", |x, _| [x[0], 0.0, 0.0]),
    ("a point", |_, _| [0.0; 3]),
    ("mirrored", |x, _| [-x[0], x[1], x[2]]),
    ("scattered", |_, node| [random(node, 0), random(node, 1), random(node, 2)]),
    ("ten times as long", |x, _| [10.0 * x[0], x[1], x[2]]),
    ("a hundredth as thick", |x, _| [x[0], 0.01 * x[1], x[2]]),
    ("twisted", |x, _| twisted(x, 0.5)),
];

/// The changes of slender bodies.
const TWISTS: &[Spoil] = &[
    ("twisted once", |x, _| twisted(x, 1.0)),
    ("twisted twice", |x, _| twisted(x, 2.0)),
    ("twisted three times", |x, _| twisted(x, 3.0)),
];

/// Bodies about the origin: their name, dimension, shape and models.
type Body = (&'static str, usize, &'static str, &'static str);

const BODIES: &[Body] = &[
    (
        "finite volumes",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }\nsimplices = true\norder = 1",
        "kind = \"finite_volume\", youngs_modulus = 2e3",
    ),
    (
        "finite volumes",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }\nsimplices = true\norder = 1",
        "kind = \"finite_volume\", youngs_modulus = 2e3",
    ),
    (
        "a solid of finite differences",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }",
        "kind = \"finite_difference\", youngs_modulus = 2e3, damping = 0.01",
    ),
    (
        "a solid of finite differences",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"finite_difference\", youngs_modulus = 2e3, damping = 0.01",
    ),
    (
        "one cluster",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }",
        "kind = \"shape_matching\", stiffness = 800, fit_share = 0.5",
    ),
    (
        "one cluster",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"shape_matching\", stiffness = 800, fit_share = 0.5",
    ),
    (
        "overlapping clusters",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"shape_matching\", stiffness = 800, region = 0.7",
    ),
    (
        "boundary elements",
        2,
        "shape = { kind = \"polygon\", points = [[-0.5, -0.5], [-0.25, -0.5], [0, -0.5], [0.25, -0.5], [0.5, -0.5], [0.5, -0.25], [0.5, 0], \
         [0.5, 0.25], [0.5, 0.5], [0.25, 0.5], [0, 0.5], [-0.25, 0.5], [-0.5, 0.5], [-0.5, 0.25], [-0.5, 0], [-0.5, -0.25]] }",
        "kind = \"boundary_element\", youngs_modulus = 2e3",
    ),
    (
        "boundary elements",
        3,
        "shape = { kind = \"box\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"boundary_element\", youngs_modulus = 2e3",
    ),
    (
        "finite volumes of quadrilaterals",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }",
        "kind = \"finite_volume\", youngs_modulus = 2e3",
    ),
    (
        "finite volumes of hexahedra",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"finite_volume\", youngs_modulus = 2e3",
    ),
    (
        "a curve of finite differences",
        2,
        "shape = { kind = \"line\", from = [-0.5, 0], to = [0.5, 0], segments = 12 }",
        "kind = \"finite_difference\", youngs_modulus = 200, thickness = 0.1, damping = 0.01",
    ),
    (
        "a curve of finite differences",
        3,
        "shape = { kind = \"line\", from = [-0.5, 0, 0], to = [0.5, 0, 0], segments = 12 }",
        "kind = \"finite_difference\", youngs_modulus = 200, thickness = 0.1, damping = 0.01",
    ),
    (
        "a sheet of finite differences",
        3,
        "shape = { kind = \"sheet\", corner = [-0.5, -0.5, 0], u = [1, 0, 0], v = [0, 1, 0], cells = [4, 4] }",
        "kind = \"finite_difference\", youngs_modulus = 200, thickness = 0.1, damping = 0.01",
    ),
    (
        "overlapping clusters",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }",
        "kind = \"shape_matching\", stiffness = 800, region = 0.7",
    ),
    (
        "a quadratic cluster",
        2,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5], size = [1, 1], cells = [4, 4] }",
        "kind = \"shape_matching\", stiffness = 800, fit_share = 0.5, fit = \"quadratic\"",
    ),
    (
        "a quadratic cluster",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [3, 3, 3] }",
        "kind = \"shape_matching\", stiffness = 800, fit_share = 0.5, fit = \"quadratic\"",
    ),
];

/// Beams along x.
const BEAMS: &[Body] = &[
    (
        "a beam of finite volumes",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.1, -0.1], size = [1, 0.2, 0.2], cells = [15, 3, 3] }\nsimplices = true\norder = 1",
        "kind = \"finite_volume\", youngs_modulus = 2e4",
    ),
    (
        "a beam of finite differences",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.1, -0.1], size = [1, 0.2, 0.2], cells = [15, 3, 3] }",
        "kind = \"finite_difference\", youngs_modulus = 2e4, damping = 0.01",
    ),
    (
        "a beam of overlapping clusters",
        3,
        "shape = { kind = \"grid\", corner = [-0.5, -0.1, -0.1], size = [1, 0.2, 0.2], cells = [15, 3, 3] }",
        "kind = \"shape_matching\", stiffness = 8000, region = 0.15",
    ),
    (
        "a beam of boundary elements",
        3,
        "shape = { kind = \"box\", corner = [-0.5, -0.1, -0.1], size = [1, 0.2, 0.2], cells = [15, 3, 3] }",
        "kind = \"boundary_element\", youngs_modulus = 2e4",
    ),
];

/// Codes that explain why a body does not have its shape.
const REASONS: &[&str] =
    &["cells.inverted", "step.odd_rest", "shape_matching.mirrored", "finite_difference.folded", "cells.other_balance"];

/// The largest deviation of the edges of a body from their rest lengths [m], or 1 if a solid is mirrored or collapsed: its corners along the axes
/// span less than 0.9 of their volume at rest.
fn off(world: &dyn AnyWorld, dimension: usize, rest: &[[f64; 3]], edges: &[[usize; 2]]) -> f64 {
    let now = world.positions(0);
    let length = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>().sqrt();
    let off = edges.iter().map(|&[a, b]| (length(now.at(a), now.at(b)) - length(rest[a], rest[b])).abs());
    let [low, high] = [Lane::smaller, Lane::larger]
        .map(|least: fn(f64, f64) -> f64| [0, 1, 2].map(|d| rest.iter().map(|x| x[d]).reduce(least).expect("a node")));
    let corner = |x: [f64; 3]| (0..rest.len()).find(|node| length(rest[*node], x) < 1e-9).expect("a corner");
    let corners = [0, 1, 2].map(|k| corner(core::array::from_fn(|d| if d == k { high[d] } else { low[d] })));
    let lowest = corner(low);
    let spanned = |at: &dyn Fn(usize) -> [f64; 3]| {
        let axes = corners.map(|k| [0, 1, 2].map(|d| at(k)[d] - at(lowest)[d]));
        match high[2] == low[2] {
            true => axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0],
            false => opruga::math::matrix::determinant(&axes),
        }
    };
    let at_rest = spanned(&|k| rest[k]);
    // The mirror image of a curve or a surface in space is a rotated one.
    let is_thin = at_rest == 0.0 || dimension == 3 && high[2] == low[2];
    if is_thin || spanned(&|k| now.at(k)) > 0.9 * at_rest { off.fold(0.0, Lane::larger) } else { 1.0 }
}

/// Within twenty seconds of damped motion, with steps that are stable for every body.
#[test]
fn bodies_of_the_other_methods_come_back_or_opruga_says_why_not() {
    come_back(|number| number % 12 == 0);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn bodies_of_the_other_methods_come_back_or_opruga_says_why_not_whole_sweep() {
    // Two in five, because all of them take minutes; five has no common divisor with the numbers of shapes.
    come_back(|number| number % 12 != 0 && number % 5 < 2);
}

/// The cases with selected numbers.
fn come_back(chosen: fn(usize) -> bool) {
    let of = |bodies: &'static [Body], shapes: &'static [Spoil]| {
        bodies.iter().flat_map(move |body| {
            ["symplectic_euler", "backward_euler"].into_iter().flat_map(move |rule| {
                let meant = |what: &str| body.1 == 3 || !["a plane", "twisted"].contains(&what);
                shapes.iter().filter(move |(what, _)| meant(what)).map(move |spoil| (body, rule, spoil))
            })
        })
    };
    // Implicit integrators refuse a model without an energy.
    let all = of(BODIES, SHAPES)
        .chain(of(BEAMS, TWISTS))
        .filter(|(body, rule, _)| has_energy(body) || *rule == "symplectic_euler");
    let silent: Vec<String> = all
        .enumerate()
        .filter(|(number, _)| chosen(*number))
        .filter_map(|(_, (body, rule, spoil))| comes_back(body, rule, spoil))
        .collect();
    assert!(silent.is_empty(), "{silent:#?}");
}

fn has_energy(body: &Body) -> bool {
    !["finite volumes of quadrilaterals", "finite volumes of hexahedra"].contains(&body.0)
}

/// Runs a case; returns an error if the body does not recover and Opruga does not report why.
fn comes_back(body: &Body, rule: &str, (what, spoil): &Spoil) -> Option<String> {
    let (name, dimension, shape, model) = body;
    // Thin bodies are far stiffer when scattered than at rest.
    let is_thin = model.contains("thickness");
    let explicit = if is_thin { 1024 } else { 64 };
    let (substeps, gravity) =
        (if rule == "backward_euler" { 1 } else { explicit }, if *dimension == 2 { "[0, 0]" } else { "[0, 0, 0]" });
    let more = if rule == "backward_euler" { "when_not_converged = \"halve\"\n" } else { "" };
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\nframe = 0.016666666666666666\nsubsteps = {substeps}\n\
         [integrator]\nkind = \"{rule}\"\n{more}[world]\ngravity = {gravity}\ndrag = 2.0\nunfold = true\n\
         [[body]]\nname = \"b\"\nnode_mass = 1\n{shape}\nmodels = [{{ {model} }}]\n"
    );
    let mut world = read(&text).unwrap_or_else(|e| panic!("{}", e[0])).build(Options::default()).expect("a world");
    let rest: Vec<[f64; 3]> = (0..world.positions(0).len()).map(|node| world.positions(0).at(node)).collect();
    let edges: Vec<[usize; 2]> = (0..rest.len())
        .flat_map(|a| (0..a).map(move |b| [a, b]))
        .filter(|&[a, b]| (0..3).map(|d| (rest[a][d] - rest[b][d]).abs()).sum::<f64>() < 0.4)
        .collect();
    for (node, x) in rest.iter().enumerate() {
        world.set_node(0, node as u32, spoil(*x, node), [0.0; 3]).expect("a node");
    }
    let energy = |world: &dyn AnyWorld| {
        let e = world.energy();
        e.kinetic + e.elastic
    };
    let start = energy(&*world);
    // Warnings about the state, not about the steps.
    let reasons = |world: &dyn AnyWorld| {
        let codes = world.warnings_at_the_end().into_iter().map(|warning| warning.code);
        codes.filter(|code| REASONS.contains(&code.as_str())).collect::<Vec<_>>()
    };
    let mut end = None;
    for frame in 1..=1200 {
        if let Err(error) = world.frame() {
            end = Some(error.to_string());
            break;
        }
        let now = energy(&*world);
        assert!(
            now.is_finite() && (now <= 1.01 * start + 1e-6 || !has_energy(body)),
            "{name} {dimension}D under {rule}, {what}: {start} J became {now} J"
        );
        if off(&*world, *dimension, &rest, &edges) < 5e-3 {
            end = Some("back".into());
            break;
        }
        // The law of St. Venant and Kirchhoff does not resist a mirrored cell, which stays mirrored.
        let stays = model.contains("finite_difference") && frame % 150 == 0;
        if stays && !reasons(&*world).is_empty() {
            break;
        }
    }
    let warned = reasons(&*world);
    let said = end.unwrap_or_else(|| format!("{warned:?}"));
    println!("{name} {dimension}D under {rule}, {what}: {}", said.chars().take(160).collect::<String>());
    (said == "[]").then(|| {
        format!("{name} {dimension}D under {rule}, {what}: off by {}", off(&*world, *dimension, &rest, &edges))
    })
}

/// A bent curve is reported only if its law does not push it back.
#[test]
fn a_folded_and_a_crushed_curve_are_reported_and_a_bent_one_is_not() {
    let text = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 1\n[integrator]\nkind = \"verlet\"\n\
                [[body]]\nname = \"b\"\nnode_mass = 1\nshape = { kind = \"line\", from = [0, 0], to = [3, 0], segments = 3 }\n\
                models = [{ kind = \"finite_difference\", youngs_modulus = 200, thickness = 0.1 }]\n";
    // Edges fold back if they turn by more than 120°, and yield below 0.577 of their length.
    for (end, count) in [([2.0, 1.0], 0), ([1.0, 0.1], 1), ([2.57, 0.0], 1), ([2.59, 0.0], 0)] {
        let mut world = read(text).unwrap_or_else(|e| panic!("{}", e[0])).build(Options::default()).expect("a world");
        world.set_node(0, 3, [end[0], end[1], 0.0], [0.0; 3]).expect("a node");
        let found = world.warnings_at_the_end().into_iter().find(|warning| warning.code == "finite_difference.folded");
        assert_eq!(found.map_or(0, |warning| warning.count), count, "{end:?}");
    }
}
