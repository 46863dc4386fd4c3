//! The unit normals of surfaces.

use opruga::draw::Facets;

/// The outward unit normals at the nodes of a surface: the mean of the normals of the adjacent facets, weighted by their area.
pub(crate) fn normals(body: &opruga::draw::BodyPicture) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; body.positions.len()];
    let at = |node: u32| body.positions[node as usize];
    let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|d| b[d] - a[d]);
    let mut add = |nodes: &[u32], normal: [f64; 3]| {
        for node in nodes {
            for d in 0..3 {
                sum[*node as usize][d] += normal[d];
            }
        }
    };
    match &body.facets {
        Facets::Edges(edges) => {
            for edge in edges {
                let [dx, dy, _] = between(at(edge[0]), at(edge[1]));
                add(edge, [dy, -dx, 0.0]);
            }
        }
        Facets::Triangles(triangles) => {
            for triangle in triangles {
                let [a, b] = [1, 2].map(|k| between(at(triangle[0]), at(triangle[k])));
                let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                add(triangle, cross);
            }
        }
    }
    for normal in &mut sum {
        let size = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        *normal = if size > 0.0 { normal.map(|c| c / size) } else { [0.0; 3] };
    }
    sum
}
