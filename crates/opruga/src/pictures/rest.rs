//! The outlines and sharp edges of bodies at their initial positions.

use crate::AnyBody;
use crate::draw::{BodyPicture, Facets, RestPicture};
use opruga_core::spec::{Role, Values};
use std::collections::BTreeMap;

/// The cosine of an angle. An edge is drawn if the normals of its two facets differ by more than this angle.
const SHARP: f64 = 0.8;

/// Whether pictures of a body show its initial position. They show this position for every body in statics and for pinned bodies that own their
/// cells, because these bend about that position. They do not show this position for bodies with a skin.
pub(super) fn is_shown(body: &dyn AnyBody, of_scene: &Values) -> bool {
    let integrator = body.integrator().unwrap_or(of_scene).spec();
    let pinned_solid = body.is_pinned_at_rest() && body.has_role(Role::OwnsCells);
    body.skin().is_none() && (integrator.has_role(Role::Statics) || pinned_solid)
}

/// Returns a body of a picture as lines: its outline, or the sharp edges of its surface.
pub fn rest_of(body: &BodyPicture) -> RestPicture {
    rest_lines(&body.facets, body.positions.clone())
}

/// Returns the outline or the sharp edges of facets whose nodes have these positions.
pub(super) fn rest_lines(facets: &Facets, positions: Vec<[f64; 3]>) -> RestPicture {
    let segments = match facets {
        Facets::Edges(edges) => edges.clone(),
        Facets::Triangles(triangles) => sharp_edges(triangles, &positions),
    };
    RestPicture { positions, segments }
}

/// Returns the edges that belong to one triangle only, and those at which two triangles meet at an angle.
fn sharp_edges(triangles: &[[u32; 3]], positions: &[[f64; 3]]) -> Vec<[u32; 2]> {
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| positions[k as usize]);
        let (u, v): ([f64; 3], [f64; 3]) =
            (core::array::from_fn(|d| b[d] - a[d]), core::array::from_fn(|d| c[d] - a[d]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = n.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        n.map(|x| x / length)
    };
    let mut edges: BTreeMap<[u32; 2], Vec<[f64; 3]>> = BTreeMap::new();
    for triangle in triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            edges.entry([a.min(b), a.max(b)]).or_default().push(normal(triangle));
        }
    }
    let sharp = |normals: &[[f64; 3]]| match normals {
        [a, b] => (0..3).map(|d| a[d] * b[d]).sum::<f64>() < SHARP,
        _ => true,
    };
    edges.into_iter().filter(|(_, normals)| sharp(normals)).map(|(edge, _)| edge).collect()
}
