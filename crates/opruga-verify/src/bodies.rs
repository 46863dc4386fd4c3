//! Makes bodies at rest whose sides follow circles, ellipses and spheres, and measures quantities on them.

use crate::lab::Trouble;
use opruga::World;
use opruga::mesh::Mesh;
use std::collections::BTreeMap;

/// The kind of cells of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cells {
    /// Quadrilaterals, hexahedra.
    Boxes,
    /// Triangles of three nodes, tetrahedra of four.
    Linear,
    /// Triangles of six nodes, tetrahedra of ten.
    Quadratic,
}

impl Cells {
    /// The fields that give a body these cells if its shape consists of boxes.
    pub(crate) fn fields(self) -> &'static str {
        match self {
            Cells::Boxes => "",
            Cells::Linear => "simplices = true\norder = 1",
            Cells::Quadratic => "simplices = true\norder = 2",
        }
    }

    /// Cuts boxes into cells of this kind.
    pub(crate) fn cut<const D: usize>(self, boxes: Mesh<D>) -> Result<Mesh<D>, Trouble> {
        Ok(match self {
            Cells::Boxes => boxes,
            Cells::Linear => boxes.into_simplices()?,
            Cells::Quadratic => boxes.into_simplices()?.into_quadratic()?,
        })
    }
}

/// Divides the unit square or cube into equal cells, and transforms them by a map. Nodes at midpoints of edges are transformed, too, so that sides
/// become curved.
pub(crate) fn mapped<const D: usize>(
    counts: [u32; D],
    cells: Cells,
    map: impl Fn([f64; D]) -> [f64; D],
) -> Result<Mesh<D>, Trouble> {
    let mut mesh = cells.cut(Mesh::grid([0.0; D], [1.0; D], counts)?)?;
    for x in &mut mesh.positions {
        *x = map(*x);
    }
    Ok(mesh)
}

/// A quarter of a disc or an eighth of a ball, or of a shell, with positive coordinates.
///
/// ```text
/// ┌───┬──╮      n cells along each side of a block, `layers` from the core (a square with side ½ of the outer radius,
/// │ 2 │1  ╲     bulging), or from the inner radius, to the outer one. Without a core the blocks 1 and 2 begin at the
/// ├───┤    │    inner radius.
/// │ 0 │ 1  │
/// └───┴────┘
/// ```
pub(crate) fn octant<const D: usize>(
    n: u32,
    layers: u32,
    inner: Option<f64>,
    outer: f64,
    cells: Cells,
) -> Result<Mesh<D>, Trouble> {
    // Equal steps along the faces of the square or cube give directions at equal angles.
    let direction = |s: &[f64; D]| -> [f64; D] {
        let t = s.map(|c| (std::f64::consts::FRAC_PI_4 * c).tan());
        let length = t.iter().map(|c| c * c).sum::<f64>().sqrt();
        t.map(|c| c / length)
    };
    let core = |s: &[f64; D]| -> [f64; D] {
        // The shape of the core is between a cube and a ball, so that no cell has an angle near 180°.
        let most = s.iter().copied().fold(0.0, f64::max);
        let round = if most > 0.0 { direction(&s.map(|c| c / most)) } else { [0.0; D] };
        core::array::from_fn(|d| 0.5 * outer * (0.6 * s[d] / (D as f64).sqrt() * 1.4 + 0.4 * most * round[d]))
    };
    let mut merged = Mesh::<D>::default();
    let mut known: BTreeMap<[i64; D], u32> = BTreeMap::new();
    let first = usize::from(inner.is_some());
    for block in first..=D {
        // Block 0 is the core. Block 1 + a is beyond the face of the core that is perpendicular to the axis a.
        let mut counts = [n; D];
        if block > 0 {
            counts[block - 1] = layers;
        }
        let grid = Mesh::<D>::grid([0.0; D], [1.0; D], counts)?;
        let numbers: Vec<u32> = grid
            .positions
            .iter()
            .map(|p| {
                let x = if block == 0 {
                    core(p)
                } else {
                    let (mut s, t) = (*p, p[block - 1]);
                    s[block - 1] = 1.0;
                    let (ray, start) = (direction(&s), core(&s));
                    core::array::from_fn(|d| {
                        let from = inner.map_or(start[d], |radius| radius * ray[d]);
                        (1.0 - t) * from + t * outer * ray[d]
                    })
                };
                *known.entry(x.map(|c| (c / outer * 1e9).round() as i64)).or_insert_with(|| {
                    merged.positions.push(x);
                    merged.positions.len() as u32 - 1
                })
            })
            .collect();
        merged.cells.quadrilaterals.extend(grid.cells.quadrilaterals.iter().map(|c| c.map(|k| numbers[k as usize])));
        merged.cells.hexahedra.extend(grid.cells.hexahedra.iter().map(|c| c.map(|k| numbers[k as usize])));
    }
    merged.facets = merged.facets_from_cells()?;
    let mut mesh = cells.cut(merged)?;
    // Mid-edge nodes between two nodes at the same distance from the centre are moved to that distance.
    if cells == Cells::Quadratic {
        let radius = |x: &[f64; D]| x.iter().map(|c| c * c).sum::<f64>().sqrt();
        let round = |r: f64| inner.is_some() || (r - outer).abs() < 1e-9 * outer;
        for [a, b, middle] in middles(&mesh) {
            let (p, q) = (mesh.positions[a], mesh.positions[b]);
            let r = radius(&p);
            if (radius(&q) - r).abs() < 1e-9 * outer && round(r) {
                let factor = r / radius(&mesh.positions[middle]);
                mesh.positions[middle] = mesh.positions[middle].map(|c| factor * c);
            }
        }
    }
    Ok(mesh)
}

/// Both ends and the midpoint of every edge of quadratic cells.
fn middles<const D: usize>(mesh: &Mesh<D>) -> Vec<[usize; 3]> {
    let mut out: BTreeMap<u32, [usize; 3]> = BTreeMap::new();
    for cell in &mesh.cells.quadratic_triangles {
        for (k, [i, j]) in opruga::mesh::TRIANGLE_SIDES.into_iter().enumerate() {
            out.insert(cell[3 + k], [cell[i], cell[j], cell[3 + k]].map(|node| node as usize));
        }
    }
    for cell in &mesh.cells.quadratic_tetrahedra {
        for (k, [i, j]) in opruga::mesh::TETRAHEDRON_EDGES.into_iter().enumerate() {
            out.insert(cell[4 + k], [cell[i], cell[j], cell[4 + k]].map(|node| node as usize));
        }
    }
    out.into_values().collect()
}

/// The indices of the nodes whose rest positions satisfy a condition.
pub(crate) fn nodes<const D: usize>(mesh: &Mesh<D>, which: impl Fn(&[f64; D]) -> bool) -> Vec<u32> {
    (0..mesh.positions.len() as u32).filter(|node| which(&mesh.positions[*node as usize])).collect()
}

/// The indices of the nodes at a given distance from the origin.
pub(crate) fn at_radius<const D: usize>(mesh: &Mesh<D>, radius: f64) -> Vec<u32> {
    nodes(mesh, |x| (x.iter().map(|c| c * c).sum::<f64>().sqrt() - radius).abs() < 1e-6 * radius)
}

/// The indices of the nodes of the boundary.
pub(crate) fn boundary<const D: usize>(mesh: &Mesh<D>) -> Vec<u32> {
    let mut out: Vec<u32> = mesh.facets.iter().flatten().copied().collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Planes of symmetry through the origin, one perpendicular to each axis: rows for `pin = [ … ]`.
pub(crate) fn symmetric<const D: usize>(mesh: &Mesh<D>) -> String {
    let rows: Vec<String> = (0..D)
        .map(|d| {
            let on_plane = nodes(mesh, |x| x[d].abs() < 1e-9);
            format!("{{ select = {{ nodes = {on_plane:?} }}, axes = \"{}\" }}", ["x", "y", "z"][d])
        })
        .collect();
    format!("pin = [{}]", rows.join(", "))
}

/// The displacement of the node of body 0 that is nearest to a given rest position.
pub(crate) fn displacement<const D: usize>(world: &World<D>, at: [f64; D]) -> [f64; D] {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    let far = |x: &[f64; D]| (0..D).map(|d| (x[d] - at[d]) * (x[d] - at[d])).sum::<f64>();
    let node =
        (0..rest.len()).reduce(|nearest, k| if far(&rest[k]) < far(&rest[nearest]) { k } else { nearest }).unwrap_or(0);
    let now = world.position(0, node as u32);
    core::array::from_fn(|d| now[d] - rest[node][d])
}

/// The mean displacement of nodes of body 0 away from the origin.
pub(crate) fn outward<const D: usize>(world: &World<D>, which: &[u32]) -> f64 {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    let of = |node: &u32| {
        let (x, now) = (rest[*node as usize], world.position(0, *node));
        let length = x.iter().map(|c| c * c).sum::<f64>().sqrt();
        (0..D).map(|d| (now[d] - x[d]) * x[d] / length).sum::<f64>()
    };
    which.iter().map(of).sum::<f64>() / which.len() as f64
}

/// A component of the Cauchy stress of body 0 at a rest position. The quadratic polynomial that best fits the mean stresses of the nearby cells gives
/// its value at this position (patch recovery: Zienkiewicz and Zhu 1992).
pub(crate) fn stress_at<const D: usize>(world: &World<D>, at: [f64; D], [i, j]: [usize; 2]) -> Result<f64, Trouble> {
    let samples = cell_stresses(world).into_iter().map(|(middle, stress)| {
        let away: Vec<f64> = (0..D).map(|d| middle[d] - at[d]).collect();
        (away.iter().map(|c| c * c).sum::<f64>().sqrt(), away, stress[i][j])
    });
    continued(samples.collect(), 3 * (D + 1) * (D + 2) / 2)
}

/// The hoop stress at a radius, for a body in space whose stress depends only on the distance from the origin. In each of the nearest `count` cells,
/// it is half of the trace of the mean stress without the radial part. These values are extrapolated to the radius by the best quadratic polynomial.
pub(crate) fn hoop_stress_at(world: &World<3>, radius: f64, count: usize) -> Result<f64, Trouble> {
    let states = cell_stresses(world);
    let samples = states.into_iter().map(|(middle, stress)| {
        let distance = middle.iter().map(|c| c * c).sum::<f64>().sqrt();
        let ray = middle.map(|c| c / distance);
        let radial: f64 = (0..3).map(|a| (0..3).map(|b| ray[a] * stress[a][b] * ray[b]).sum::<f64>()).sum();
        let around = 0.5 * (stress[0][0] + stress[1][1] + stress[2][2] - radial);
        ((distance - radius).abs(), vec![distance - radius], around)
    });
    continued(samples.collect(), count)
}

/// The centres at rest of the cells of body 0, and their mean stresses.
fn cell_stresses<const D: usize>(world: &World<D>) -> Vec<([f64; D], [[f64; 3]; 3])> {
    let mesh = &world.blueprint().bodies[0].mesh;
    let corners = |nodes: &[u32]| match nodes.len() {
        6 => 3,
        10 => 4,
        all => all,
    };
    let middle_of = |nodes: &[u32]| {
        let count = corners(nodes);
        let mut middle = [0.0; D];
        for node in &nodes[..count] {
            (0..D).for_each(|d| middle[d] += mesh.positions[*node as usize][d] / count as f64);
        }
        middle
    };
    mesh.cells.iter().zip(world.cell_states(0)).map(|((_, _, nodes), state)| (middle_of(nodes), state.stress)).collect()
}

/// Fits a quadratic polynomial to the `count` samples that are nearest to a point, and returns its value at this point. Each sample contains its
/// distance, its displacement from the point, and its value.
fn continued(mut samples: Vec<(f64, Vec<f64>, f64)>, count: usize) -> Result<f64, Trouble> {
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    samples.truncate(count);
    let reach = samples.last().ok_or("no cells")?.0;
    // 1, x, …, x², xy, …
    let monomials = |away: &[f64]| -> Vec<f64> {
        let x: Vec<f64> = away.iter().map(|c| c / reach).collect();
        let mut out = vec![1.0];
        out.extend(&x);
        (0..x.len()).for_each(|a| (a..x.len()).for_each(|b| out.push(x[a] * x[b])));
        out
    };
    let terms = monomials(&samples[0].1).len();
    let mut matrix = vec![vec![0.0; terms + 1]; terms];
    for (_, away, value) in &samples {
        let row = monomials(away);
        for a in 0..terms {
            (0..terms).for_each(|b| matrix[a][b] += row[a] * row[b]);
            matrix[a][terms] += row[a] * value;
        }
    }
    solve(matrix).map(|solution| solution[0])
}

/// Solves a system of linear equations by Gaussian elimination with pivoting.
fn solve(mut matrix: Vec<Vec<f64>>) -> Result<Vec<f64>, Trouble> {
    let n = matrix.len();
    for k in 0..n {
        let pivot = (k..n).reduce(|a, b| if matrix[b][k].abs() > matrix[a][k].abs() { b } else { a }).unwrap_or(k);
        matrix.swap(k, pivot);
        if matrix[k][k].abs() < 1e-12 * n as f64 {
            return Err("the cells near by lie too evenly for a polynomial".into());
        }
        for row in k + 1..n {
            let factor = matrix[row][k] / matrix[k][k];
            for column in k..=n {
                matrix[row][column] -= factor * matrix[k][column];
            }
        }
    }
    let mut out = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k][j] * out[j]).sum();
        out[k] = (matrix[k][n] - known) / matrix[k][k];
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_eighth_of_a_ball_has_the_volume_of_it() {
        for cells in [Cells::Boxes, Cells::Linear, Cells::Quadratic] {
            let ball = octant::<3>(5, 5, None, 2.0, cells).unwrap();
            let shell = octant::<3>(5, 3, Some(1.0), 2.0, cells).unwrap();
            let disc = octant::<2>(8, 8, None, 2.0, cells).unwrap();
            let tolerance = if cells == Cells::Quadratic { 2e-4 } else { 2e-2 };
            let pi = std::f64::consts::PI;
            for (found, expected) in [
                (ball.measure().unwrap().value(), pi * 8.0 / 6.0),
                (shell.measure().unwrap().value(), pi * 7.0 / 6.0),
                (disc.measure().unwrap().value(), pi),
            ] {
                assert!((found / expected - 1.0).abs() < tolerance, "{cells:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn elimination_solves() {
        let found = solve(vec![vec![0.0, 2.0, 2.0], vec![3.0, 1.0, 7.0]]).unwrap();
        assert_eq!(found, [2.0, 1.0]);
        assert!(solve(vec![vec![1.0, 1.0, 1.0], vec![1.0, 1.0, 1.0]]).is_err());
    }
}
