//! The outline of a body of space as it is seen: the edges between a side that is seen and one that is not.

use opruga::draw::{BodyPicture, Facets, Lens};
use std::collections::BTreeMap;

/// Triangles up to which an outline is looked for.
const MOST: usize = 60_000;

/// The ends of the lines around a body in pixels; of a body without a surface, its springs.
pub(crate) fn outline(body: &BodyPicture, lens: &Lens) -> Vec<[[f64; 2]; 2]> {
    let seen: Vec<Option<[f64; 2]>> = body.positions.iter().map(|p| lens.see(*p).map(|(pixel, _)| pixel)).collect();
    let line = |[a, b]: [u32; 2]| Some([seen[a as usize]?, seen[b as usize]?]);
    let triangles = match &body.facets {
        Facets::Triangles(triangles) if !triangles.is_empty() => triangles,
        _ => return body.segments.iter().take(MOST).filter_map(|s| line(*s)).collect(),
    };
    if triangles.len() > MOST {
        return Vec::new();
    }
    // An edge lies on the outline where the sides next to it are seen once from the front and once from behind, or where
    // there is but one.
    let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for triangle in triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(|node| seen[node as usize]) else { continue };
        let front = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
        for k in 0..3 {
            let (i, j) = (triangle[k], triangle[(k + 1) % 3]);
            *sides.entry([i.min(j), i.max(j)]).or_insert(0) += if front { 1 } else { -1 };
        }
    }
    sides.into_iter().filter(|(_, sum)| sum.abs() < 2).filter_map(|(edge, _)| line(edge)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::draw::{Eye, Picture, View};

    #[test]
    fn the_outline_of_a_closed_surface_is_closed_and_lies_at_its_border() {
        // An octahedron of radius 1.
        let positions = vec![
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let body = BodyPicture { positions, facets: Facets::Triangles(triangles), ..Default::default() };
        let picture = Picture { dimension: 3, bodies: vec![body.clone()], ..Default::default() };
        let view = View::fit([&picture]).expect("a view");
        let lens = Eye::of(&view).lens(&view, [400.0, 400.0]);
        let lines = outline(&body, &lens);
        assert!((4..=6).contains(&lines.len()), "{lines:?}");
        // Every corner of the outline belongs to two of its lines.
        let mut ends: Vec<[u64; 2]> = lines.iter().flatten().map(|p| p.map(f64::to_bits)).collect();
        ends.sort_unstable();
        assert!(ends.chunks(2).all(|pair| pair[0] == pair[1]), "{lines:?}");
        // Nothing of the body is seen farther left.
        let left = |points: &mut dyn Iterator<Item = [f64; 2]>| points.map(|p| p[0]).fold(f64::MAX, f64::min);
        let all = left(&mut body.positions.iter().filter_map(|p| lens.see(*p)).map(|(pixel, _)| pixel));
        assert_eq!(left(&mut lines.iter().flatten().copied()), all);
    }
}
