//! Lengths, areas and volumes. Points in the plane are lifted to z = 0, so that one formula serves both dimensions.

pub(crate) type Point = [f64; 3];

/// The point in space, with z = 0 for a point in the plane.
#[inline]
pub(crate) fn lift<const D: usize>(point: &[f64; D]) -> Point {
    [point[0], point[1], point.get(2).copied().unwrap_or(0.0)]
}

#[inline]
pub(crate) fn subtract(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(crate) fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Area vector of a triangle [m²]: half the cross product of two sides.
#[inline]
pub(crate) fn area_vector(a: Point, b: Point, c: Point) -> Point {
    let doubled = cross(subtract(b, a), subtract(c, a));
    [0.5 * doubled[0], 0.5 * doubled[1], 0.5 * doubled[2]]
}

/// Area of a triangle [m²].
#[inline]
pub(crate) fn triangle_area(a: Point, b: Point, c: Point) -> f64 {
    norm(area_vector(a, b, c))
}

/// Signed volume of the tetrahedron o a b c [m³].
#[inline]
pub(crate) fn tetrahedron_volume(o: Point, a: Point, b: Point, c: Point) -> f64 {
    dot(subtract(a, o), cross(subtract(b, o), subtract(c, o))) / 6.0
}

/// Outward faces of a hexahedron, counter-clockwise seen from outside.
pub(crate) const HEXAHEDRON_FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Outward faces of a tetrahedron, counter-clockwise seen from outside.
pub(crate) const TETRAHEDRON_FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// Signed volume of a trilinear hexahedron [m³]: a bilinear face bounds the mean of the volumes that its two triangulations bound.
pub(crate) fn hexahedron_volume(corners: &[Point; 8]) -> f64 {
    let o = corners[0];
    let mut doubled = 0.0;
    for face in HEXAHEDRON_FACES {
        let [a, b, c, d] = face.map(|corner| corners[corner]);
        doubled += tetrahedron_volume(o, a, b, c) + tetrahedron_volume(o, a, c, d);
        doubled += tetrahedron_volume(o, a, b, d) + tetrahedron_volume(o, b, c, d);
    }
    0.5 * doubled
}

/// Signed area of a plane quadrilateral [m²].
pub(crate) fn quadrilateral_area(corners: &[Point; 4]) -> f64 {
    let [a, b, c, d] = *corners;
    0.5 * cross(subtract(c, a), subtract(d, b))[2]
}

/// The signed volume that closed facets enclose: area ½Σ(xᵢyⱼ − xⱼyᵢ) [m²] in the plane, volume ⅙ΣXₐ·(X_b×X_c) [m³] in space.
///
/// The volume is positive for counter-clockwise outlines and outward triangles. The volume is computed relative to the first node of the first facet,
/// so that a small body far from the origin keeps its digits. The volume has no meaning if facets are not closed, and is zero if there are no facets.
/// Shapes: `facets` F×D, `positions` N×D.
///
/// # Panics
/// If a facet names a node beyond `positions`; [`crate::Mesh::validate`] finds such facets.
pub fn signed_volume<const D: usize>(facets: &[[u32; D]], positions: &[[f64; D]]) -> f64 {
    let Some(first) = facets.first() else {
        return 0.0;
    };
    let o = lift(&positions[first[0] as usize]);
    let at = |node: u32| lift(&positions[node as usize]);
    let mut volume = 0.0;
    for facet in facets {
        volume += if D == 2 {
            area_vector(o, at(facet[0]), at(facet[1]))[2]
        } else {
            tetrahedron_volume(o, at(facet[0]), at(facet[1]), at(facet[D - 1]))
        };
    }
    volume
}

/// The edge with its lower node first.
#[inline]
pub(crate) fn ascending(a: u32, b: u32) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}
