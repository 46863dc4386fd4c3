//! Shapes of flat facets: thin surfaces that act on both sides, and convex hulls.
//!
//! The bounding-volume tree and the nearest point of a facet come from parry, whose types are used only in this file.

use crate::hull;
use crate::shape::{Shape, entry};
use crate::vector::{dot, length, scaled, subtract};
use core::fmt::Debug;
use opruga_math::{Lane, lanes};
use std::sync::Arc;

/// Finds facets in space.
trait Tree<const D: usize>: Send + Sync + Debug {
    /// Returns the nearest point of all facets and the index of its facet, if the point is nearer than `within` [m].
    fn nearest(&self, x: &[f64; D], within: f64) -> Option<([f64; D], usize)>;
    /// Calls `call` with every facet whose bounding box overlaps a box.
    fn visit(&self, low: &[f64; D], high: &[f64; D], call: &mut dyn FnMut(usize));
}

/// Implements a tree with one of parry's two crates.
macro_rules! tree {
    ($name:ident, $parry:ident, $facet:ident, $($corner:literal)*, $($axis:literal)*) => {
        #[derive(Debug)]
        struct $name {
            bounds: $parry::partitioning::Bvh,
            facets: Vec<$parry::shape::$facet>,
        }
        impl $name {
            fn new<const D: usize>(facets: &[[[f64; D]; D]]) -> $name {
                let vector = |p: &[f64; D]| $parry::math::Vector::new($(p[$axis % D]),*);
                let facets: Vec<_> = facets.iter().map(|f| $parry::shape::$facet::new($(vector(&f[$corner % D])),*)).collect();
                let boxes: Vec<_> = facets.iter().map(|f| f.local_aabb()).collect();
                let bounds = $parry::partitioning::Bvh::from_leaves(Default::default(), &boxes);
                $name { bounds, facets }
            }
        }
        impl<const D: usize> Tree<D> for $name {
            fn nearest(&self, x: &[f64; D], within: f64) -> Option<([f64; D], usize)> {
                use $parry::query::PointQuery;
                let x = $parry::math::Vector::new($(x[$axis % D]),*);
                let (facet, (_, point)) = self.bounds.find_best(
                    within,
                    |node, _| node.aabb().distance_to_local_point(x, true),
                    |facet, _| {
                        let point = self.facets.get(facet as usize)?.project_local_point(x, false).point;
                        Some(((point - x).length(), point))
                    },
                )?;
                let mut out = [0.0; D];
                $(out[$axis % D] = point[$axis];)*
                Some((out, facet as usize))
            }
            fn visit(&self, low: &[f64; D], high: &[f64; D], call: &mut dyn FnMut(usize)) {
                // The comparison is made here and not in parry, so that the loop is compiled with the kernels of this crate.
                let meets = |node: &$parry::partitioning::BvhNode| {
                    let (least, greatest) = (node.mins(), node.maxs());
                    $((least[$axis] <= high[$axis % D]) & (low[$axis % D] <= greatest[$axis]))&*
                };
                for facet in self.bounds.leaves(meets) {
                    call(facet as usize);
                }
            }
        }
    };
}
tree! { PlaneTree, parry2d_f64, Segment, 0 1, 0 1 }
tree! { SpaceTree, parry3d_f64, Triangle, 0 1 2, 0 1 2 }

/// A facet as part of a plane (line in 2D).
#[derive(Clone, Copy, Debug)]
struct Facet<const D: usize> {
    corner: [f64; D],
    normal: [f64; D],
    /// Gradients of the barycentric coordinates of the other corners, within the plane; the last row is unused.
    weights: [[f64; D]; D],
}

/// Facets of a thin surface or of a convex solid, at rest.
#[derive(Clone, Debug)]
pub(crate) struct Facets<const D: usize> {
    tree: Arc<dyn Tree<D>>,
    facets: Vec<Facet<D>>,
    /// Whether the inside is solid; the facets are then the faces of a convex body.
    pub(crate) solid: bool,
    /// The smallest coordinates.
    pub(crate) low: [f64; D],
    /// The largest coordinates.
    pub(crate) high: [f64; D],
    half_width: f64,
    /// The distance from the surface below which the computed direction to the surface consists only of rounding errors [m].
    /// Nearer nodes count as on the surface.
    grain: f64,
}

/// The gap of a node if nothing is within reach.
const NOTHING: f64 = f64::INFINITY;

/// Why facets could not be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Flaw {
    /// A degenerate facet.
    Degenerate(usize),
    /// The hull has no volume.
    Flat,
}

impl<const D: usize> Facets<D> {
    /// Makes a thin surface from the corners of its facets.
    pub(crate) fn surface(corners: &[[[f64; D]; D]]) -> Result<Facets<D>, Flaw> {
        Facets::new(corners, false)
    }
    /// Makes the convex hull of points.
    pub(crate) fn convex(points: &[[f64; D]]) -> Result<(Facets<D>, Vec<[usize; D]>), Flaw> {
        let faces = hull::faces(points).ok_or(Flaw::Flat)?;
        let corners: Vec<[[f64; D]; D]> = faces.iter().map(|f| f.map(|p| points[p])).collect();
        let mut out = Facets::new(&corners, true)?;
        // The smallest extent along the normal of a face.
        let mut width = f64::INFINITY;
        for facet in &out.facets {
            let mut extent = 0.0;
            for point in points {
                extent = (-dot(&subtract(point, &facet.corner), &facet.normal)).larger(extent);
            }
            width = extent.smaller(width);
        }
        out.half_width = 0.5 * width;
        Ok((out, faces))
    }
    fn new(corners: &[[[f64; D]; D]], solid: bool) -> Result<Facets<D>, Flaw> {
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        let mut facets = Vec::with_capacity(corners.len());
        for (number, corner) in corners.iter().enumerate() {
            facets.push(Facet::new(corner).ok_or(Flaw::Degenerate(number))?);
            for point in corner {
                for d in 0..D {
                    low[d] = point[d].smaller(low[d]);
                    high[d] = point[d].larger(high[d]);
                }
            }
        }
        let tree: Arc<dyn Tree<D>> =
            if D == 2 { Arc::new(PlaneTree::new(corners)) } else { Arc::new(SpaceTree::new(corners)) };
        let mut out = Facets { tree, facets, solid, low, high, half_width: f64::INFINITY, grain: 0.0 };
        out.grain = 0.01 * out.resolved();
        Ok(out)
    }
    /// Returns a distance from the surface at which the direction to the surface is well defined in spite of rounding [m].
    fn resolved(&self) -> f64 {
        let mut far = 0.0;
        for d in 0..D {
            far = self.low[d].abs().larger(self.high[d].abs()).larger(far);
        }
        1e-8 * length(&subtract(&self.high, &self.low)) + 1e-12 * far
    }
    /// The smallest distance that nodes keep, so that rounding never puts them on the other side [m].
    pub(crate) fn skin(&self) -> f64 {
        if self.solid { 0.0 } else { self.resolved() }
    }
    /// The distance below which a node counts as on a facet [m].
    pub(crate) fn grain(&self) -> f64 {
        self.grain
    }
    /// Whether a segment passes through the bounding box, enlarged by a margin. The coordinates must be finite.
    pub(crate) fn passes_bounds(&self, a: &[f64; D], b: &[f64; D], margin: f64) -> bool {
        for d in 0..D {
            if a[d].smaller(b[d]) > self.high[d] + margin || a[d].larger(b[d]) < self.low[d] - margin {
                return false;
            }
        }
        true
    }
    /// The gap of a node that moved from `before` to `x`, and the normal. A gap above `reach` may be given as infinite.
    ///
    /// Nodes keep the distance `margin` from the surface.
    pub(crate) fn touch(&self, x: &[f64; D], before: &[f64; D], margin: f64, reach: f64) -> (f64, [f64; D]) {
        if self.solid {
            self.touch_solid(x, before, margin, reach)
        } else {
            self.touch_surface(x, before, margin, reach)
        }
    }
    fn touch_solid(&self, x: &[f64; D], before: &[f64; D], margin: f64, reach: f64) -> (f64, [f64; D]) {
        let displacement = subtract(x, before);
        let far = 0.5 * self.half_width;
        let (gap, normal) = self.gap_and_normal(x);
        // The face through which the node entered need not be the nearest one.
        if (gap - margin < -self.grain || dot(&displacement, &displacement) > far * far)
            && let Some(found) = entry(self, margin, before, x)
        {
            return found;
        }
        // From a node on the surface, there is no direction towards the surface.
        if gap <= self.grain || gap >= margin + reach {
            return (gap - margin, normal);
        }
        self.approach(x, before, margin, reach)
    }
    fn touch_surface(&self, x: &[f64; D], before: &[f64; D], margin: f64, reach: f64) -> (f64, [f64; D]) {
        match self.crossed(before, x) {
            Some((depth, normal)) => (-depth - margin, normal),
            None => self.approach(x, before, margin, reach),
        }
    }
    /// The gap to the nearest point of the surface.
    fn approach(&self, x: &[f64; D], before: &[f64; D], margin: f64, reach: f64) -> (f64, [f64; D]) {
        let Some((point, facet)) = self.tree.nearest(x, margin + reach) else {
            return (NOTHING, [0.0; D]);
        };
        let away = subtract(x, &point);
        let distance = length(&away);
        // On the surface itself, the normal of the surface is used, towards the previous position of the node.
        if distance <= self.grain {
            let facet = &self.facets[facet];
            let side = dot(&subtract(before, &facet.corner), &facet.normal);
            let normal = if side < -self.grain { scaled(&facet.normal, -1.0) } else { facet.normal };
            return (distance - margin, normal);
        }
        (distance - margin, scaled(&away, 1.0 / distance))
    }
    /// The first facet that a segment crosses: how far the end is behind it, and its normal towards the start.
    pub(crate) fn crossed(&self, a: &[f64; D], b: &[f64; D]) -> Option<(f64, [f64; D])> {
        let low: [f64; D] = lanes!(f64, d => a[d].smaller(b[d]));
        let high: [f64; D] = lanes!(f64, d => a[d].larger(b[d]));
        let mut first: Option<(f64, usize, f64)> = None;
        self.tree.visit(&low, &high, &mut |number| {
            let facet = &self.facets[number];
            if let Some((s, depth)) = facet.crossed(a, b, self.grain)
                && first.is_none_or(|(t, other, _)| s < t || (s == t && number < other))
            {
                first = Some((s, number, depth));
            }
        });
        let (_, number, depth) = first?;
        let normal = self.facets[number].normal;
        Some(if depth > 0.0 { (depth, normal) } else { (-depth, scaled(&normal, -1.0)) })
    }
}

/// The convex solid as the intersection of the half-spaces behind its faces. The signed distance is exact inside and a lower
/// bound outside.
impl<const D: usize> Shape<D> for Facets<D> {
    const FACES: bool = true;
    fn visit_faces(&self, x: &[f64; D], grain: f64, visit: &mut dyn FnMut(f64, [f64; D])) {
        for facet in &self.facets {
            let height = dot(&subtract(x, &facet.corner), &facet.normal);
            if height >= -grain {
                visit(height, facet.normal);
            }
        }
    }
    fn half_width(&self) -> f64 {
        self.half_width
    }
    fn gap<S: Lane>(&self, x: &[S; D]) -> S {
        self.gap_and_normal(x).0
    }
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]) {
        let (mut gap, mut normal) = (S::splat(f64::NEG_INFINITY), [S::zero(); D]);
        for facet in &self.facets {
            let n = lanes!(S, d => S::splat(facet.normal[d]));
            let height = dot(&lanes!(S, d => x[d] - S::splat(facet.corner[d])), &n);
            let nearer = gap.less(height);
            gap = S::select(nearer, height, gap);
            normal = lanes!(S, d => S::select(nearer, n[d], normal[d]));
        }
        (gap, normal)
    }
}

impl<const D: usize> Facet<D> {
    /// Makes a facet from its corners; `None` if it is degenerate.
    fn new(corners: &[[f64; D]; D]) -> Option<Facet<D>> {
        let mut weights = [[0.0; D]; D];
        let mut normal = [0.0; D];
        let e = subtract(&corners[1], &corners[0]);
        let ee = dot(&e, &e);
        if D == 2 {
            (normal[0], normal[1]) = (-e[1], e[0]);
            weights[0] = scaled(&e, 1.0 / ee);
        } else {
            let f = subtract(&corners[2], &corners[0]);
            let (ef, ff) = (dot(&e, &f), dot(&f, &f));
            for d in 0..D {
                normal[d] = e[(d + 1) % D] * f[(d + 2) % D] - e[(d + 2) % D] * f[(d + 1) % D];
            }
            let determinant = dot(&normal, &normal);
            // Triangles whose height is less than a hundred-millionth of their length have no useful normal.
            let is_proper = determinant > 1e-16 * ee * ff;
            if !is_proper {
                return None;
            }
            weights[0] = lanes!(f64, d => (ff * e[d] - ef * f[d]) / determinant);
            weights[1] = lanes!(f64, d => (ee * f[d] - ef * e[d]) / determinant);
        }
        let size = length(&normal);
        if !(size > 1e-150 && size.is_finite()) {
            return None;
        }
        Some(Facet { corner: corners[0], normal: scaled(&normal, 1.0 / size), weights })
    }
    /// The position along a segment (0 … 1) at which it crosses the facet, and how far its end is behind the facet: positive if
    /// it came from the side of the normal, otherwise negative. A segment that begins closer than `grain` to the facet counts as
    /// beginning on it and as coming from the side of the normal.
    fn crossed(&self, a: &[f64; D], b: &[f64; D], grain: f64) -> Option<(f64, f64)> {
        let from = dot(&subtract(a, &self.corner), &self.normal);
        let from = if from.abs() <= grain { 0.0 } else { from };
        let to = dot(&subtract(b, &self.corner), &self.normal);
        let through = if from > 0.0 { to <= 0.0 } else { from == 0.0 && to < 0.0 || from < 0.0 && to >= 0.0 };
        if !through {
            return None;
        }
        let s = from / (from - to);
        let arm: [f64; D] = lanes!(f64, d => (a[d] - self.corner[d]) + s * (b[d] - a[d]));
        // Points slightly beyond the edge count too, so that no node slips between two facets.
        let (mut sum, mut inside) = (0.0, true);
        for weight in &self.weights[..D - 1] {
            let w = dot(weight, &arm);
            inside &= w >= -1e-9;
            sum += w;
        }
        // If the depth is exactly zero, its sign still gives the side.
        let least = f64::MIN_POSITIVE;
        let depth = if from >= 0.0 { (-to).larger(least) } else { (-to).smaller(-least) };
        (inside && sum <= 1.0 + 1e-9).then_some((s, depth))
    }
}
