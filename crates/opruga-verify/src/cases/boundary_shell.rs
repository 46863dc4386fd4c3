//! Lamé's thick sphere with boundary elements.

use super::boundary_bodies::{SMALL, body, outward, pinned, pressed, radius, solid};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;
use opruga::mesh::Mesh;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Makes a ball from an icosahedron, each of whose faces is divided into n² triangles. The first and the last node are poles.
fn ball(radius_of: f64, n: u32) -> Result<Mesh<3>, Trouble> {
    let coarse = Mesh::icosphere(1.0, 0)?;
    let mut known: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut mesh = Mesh::<3>::default();
    for facet in &coarse.facets {
        let [a, b, c] = facet.map(|node| coarse.positions[node as usize]);
        let mut node = |i: u32, j: u32| -> u32 {
            let (p, q) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let x: [f64; 3] = std::array::from_fn(|d| a[d] + p * (b[d] - a[d]) + q * (c[d] - a[d]));
            let length = radius(&x) / radius_of;
            let x = x.map(|x| x / length);
            *known.entry(x.map(|x| (x * 1e9).round() as i64)).or_insert_with(|| {
                mesh.positions.push(x);
                mesh.positions.len() as u32 - 1
            })
        };
        let mut facets = Vec::new();
        for i in 0..n {
            for j in 0..n - i {
                facets.push([node(i, j), node(i + 1, j), node(i, j + 1)]);
                if i + j + 1 < n {
                    facets.push([node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
                }
            }
        }
        mesh.facets.extend(facets);
    }
    // As in an icosphere, the poles are the first and the last node.
    let last = mesh.positions.len() as u32 - 1;
    let lowest = mesh.positions.iter().position(|x| x[2] < -0.999_999 * radius_of).ok_or("no pole")? as u32;
    mesh.positions.swap(lowest as usize, last as usize);
    for node in mesh.facets.iter_mut().flatten() {
        *node = if *node == lowest {
            last
        } else if *node == last {
            lowest
        } else {
            *node
        };
    }
    Ok(mesh)
}

/// Two balls, one inside the other, as the text of a file.
fn shell_surface(edges: f64) -> Result<String, Trouble> {
    let mut out = String::new();
    let mut first = 1;
    for (radius, n) in [(1.0, edges as u32), (2.0, edges as u32 / 2)] {
        let ball = ball(radius, n)?;
        for [x, y, z] in &ball.positions {
            writeln!(out, "v {x:?} {y:?} {z:?}")?;
        }
        for [a, b, c] in &ball.facets {
            let [b, c] = if radius == 1.0 { [c, b] } else { [b, c] };
            writeln!(out, "f {} {} {}", a + first, b + first, c + first)?;
        }
        first += ball.positions.len() as u32;
    }
    Ok(out)
}

/// A thick sphere of E = 1 Pa under inner pressure. Its inner ball has `edges` edges for each edge of the icosahedron, and its outer ball half as
/// many.
pub(super) fn shell(lab: &Lab, edges: f64, stress: bool) -> Result<f64, Trouble> {
    let count = 10 * (edges * edges) as u32 + 2;
    let scene = Scene::statics(3, 1e-13)
        .file("shell.obj", shell_surface(edges)?)
        .add(&body("kind = \"surface\", file = \"shell.obj\"", &format!("{}{}", solid(0.3, ""), pinned(3, count))));
    let inner: Vec<u32> = (0..count).collect();
    let mut world = lab.space(scene.add(&pressed(&inner, SMALL)))?;
    world.frame()?;
    let moved = outward(&world, 0..count) / SMALL;
    if !stress {
        return Ok(moved);
    }
    // σθθ = E ε/(1 − ν) + ν/(1 − ν) σrr. The strain ε is the same in both directions of the wall and follows from the growth of its area.
    let strain = 0.5 * (area(&world, count, true) / area(&world, count, false) - 1.0) / SMALL;
    Ok((strain - 0.3) / 0.7)
}

/// The area of the triangles between the first `count` nodes, now or at rest [m²].
fn area(world: &World<3>, count: u32, now: bool) -> f64 {
    let mesh = &world.blueprint().bodies[0].mesh;
    let at = |node: u32| if now { world.position(0, node) } else { mesh.positions[node as usize] };
    let own = mesh.facets.iter().filter(|facet| facet.iter().all(|node| *node < count));
    own.map(|facet| {
        let [a, b, c] = facet.map(at);
        let (p, q): ([f64; 3], [f64; 3]) = (std::array::from_fn(|d| b[d] - a[d]), std::array::from_fn(|d| c[d] - a[d]));
        let normal: [f64; 3] =
            std::array::from_fn(|d| p[(d + 1) % 3] * q[(d + 2) % 3] - p[(d + 2) % 3] * q[(d + 1) % 3]);
        0.5 * radius(&normal)
    })
    .sum()
}
