//! A barrier that keeps surfaces apart: its energy, forces and second derivatives, pair by pair.
//!
//! ```text
//! B = Σ κ m b(g),   b(g) = −(g − r)² ln(g/r) for g < r, else 0
//! ```
//!
//! g [m] is the distance between a vertex and a facet, or between two edges, minus their thickness, and r is the reach. b has
//! two continuous derivatives and grows without bound as g falls to zero. The factor m fades out pairs of nearly parallel
//! edges, whose closest points jump. κ [N/m] is the stiffness of the bodies at the pair, so the user need not give one.
//!
//! Of the second derivatives, only the part κ m b″ ∇g ∇gᵀ is used, because this matrix has no negative eigenvalue. The curvature of the distance is
//! left out; the next iteration accounts for it.
//!
//! The friction of a pair with the normal force N = −κ m b′ depends on its slip s in the step, perpendicular to the normal:
//!
//! ```text
//! t = λ + k s,   D = |t|²/(2 k) where |t| ≤ µ N, else µ N |t|/k − (µ N)²/(2 k)
//! ```
//!
//! The friction force −∂D/∂s is at most µ N. Repeated searches find λ: after each search, λ is replaced by the opposite of this
//! force. In the end, sticking pairs do not slip (method of multipliers).
//!
//! Sources: M. Li and others, Incremental potential contact, ACM Trans. Graph. 39 (2020), equations 6 and 24; M. Li, D. M. Kaufman, C. Jiang,
//! Codimensional incremental potential contact (2021), for the thickness; P. Alart, A. Curnier, A mixed formulation for frictional contact
//! problems prone to Newton like solution methods (1991), for the multipliers.

use crate::candidates::Candidates;
use crate::closest::{closest_of_segments, closest_on_facet};
use crate::gap::Gap;
use crate::impact::{key, meeting_time};
use crate::law::Laws;
use crate::reach::around;
use crate::reports;
use crate::row::Row;
use crate::surface::Surface;
use crate::touching::{Touching, Trouble};
use crate::vector::{add, dot, length, scaled, subtract};
use opruga_math::{Lane, Simd};

/// The smallest fraction of its gap that a pair keeps in one iteration, with the value of the source (2020, section 5).
const KEPT: f64 = 0.1;

/// The squared sine of the angle between two edges below which their barrier fades out. The source uses the same value (2020,
/// section 5.3).
const PARALLEL: f64 = 1e-3;

/// The stiffness of sticking, relative to the stiffness of the pair. The ratio of this stiffness to the response of the bodies determines the number
/// of rounds for the multipliers; where they converge slowly, the caller increases it. With 1000 from the beginning, the search for the equilibrium of
/// a stack of five blocks alternates between sticking and sliding.
const STICKING: f64 = 10.0;

/// A pair within reach of the barrier.
#[derive(Clone, Copy, Debug)]
pub struct Pressed<const D: usize> {
    /// The key of its two features. Pairs are sorted by this key.
    pub id: u64,
    /// The points of the pair; unused entries repeat the first point.
    pub points: [u32; 4],
    /// The weights wᵢ of its points, with ∇g = wᵢ n.
    pub weights: [f64; 4],
    /// The unit vector n from the second feature to the first.
    pub normal: [f64; D],
    /// The gap g [m].
    pub gap: f64,
    /// The energy [J].
    pub energy: f64,
    /// The normal force −κ m b′ [N].
    pub force: f64,
    /// The curvature κ m b″ [N/m].
    pub curvature: f64,
    /// κ b ∂m/∂x of its points [N]: zero except for nearly parallel edges.
    pub fading: [[f64; D]; 4],
    /// The stiffness κ [N/m].
    pub stiffness: f64,
    /// Coulomb's coefficient µ.
    pub friction: f64,
}

/// The friction of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Rubbing<const D: usize> {
    /// The key of the two features of the pair.
    pub id: u64,
    /// The points of the pair.
    pub points: [u32; 4],
    /// The weights wᵢ of these points.
    pub weights: [f64; 4],
    /// The normal n of the pair.
    pub normal: [f64; D],
    /// The largest friction force, µ N [N].
    pub most: f64,
    /// The stiffness of sticking, k [N/m].
    pub stiffness: f64,
    /// The multiplier λ [N].
    pub multiplier: [f64; D],
}

impl<const D: usize> Pressed<D> {
    /// Returns the friction of the pair. Only the part of the multiplier that is perpendicular to the normal counts, up to µ N. Sticking is `stiffer`
    /// times as stiff as at first.
    pub fn rubbing(&self, multiplier: [f64; D], stiffer: f64) -> Rubbing<D> {
        let Pressed { id, points, weights, normal, .. } = *self;
        let across = subtract(&multiplier, &scaled(&normal, dot(&multiplier, &normal)));
        let stiffness = stiffer * STICKING * self.stiffness;
        let mut rub = Rubbing { id, points, weights, normal, most: 0.0, stiffness, multiplier: across };
        rub.limit(self.friction * self.force);
        rub
    }
}

impl<const D: usize> Rubbing<D> {
    /// Sets the largest friction force [N]. The multiplier is shortened to it.
    pub fn limit(&mut self, most: f64) {
        let size = length(&self.multiplier);
        if size > most {
            self.multiplier = scaled(&self.multiplier, most / size);
        }
        self.most = most;
    }
    /// Returns the slip s [m] that results from the displacements of the points since the start of the step [m].
    pub fn slip(&self, moved: &[[f64; D]]) -> [f64; D] {
        let mut sum = [0.0; D];
        for (p, w) in self.points.iter().zip(&self.weights) {
            sum = add(&sum, &scaled(&moved[*p as usize], *w));
        }
        subtract(&sum, &scaled(&self.normal, dot(&sum, &self.normal)))
    }
    /// Returns the vector t of the formula for friction, and its magnitude [N].
    fn pull(&self, slip: &[f64; D]) -> ([f64; D], f64) {
        let pull = add(&self.multiplier, &scaled(slip, self.stiffness));
        (pull, length(&pull))
    }
    /// Returns the friction energy D [J].
    pub fn energy(&self, slip: &[f64; D]) -> f64 {
        let (_, size) = self.pull(slip);
        let inverse = 0.5 / self.stiffness;
        if size <= self.most { size * size * inverse } else { self.most * (2.0 * size - self.most) * inverse }
    }
    /// Returns the friction force −∂D/∂s [N].
    pub fn force(&self, slip: &[f64; D]) -> [f64; D] {
        let (pull, size) = self.pull(slip);
        scaled(&pull, -if size > self.most { self.most / size } else { 1.0 })
    }
    /// Returns whether the pair slides at this slip [m].
    pub fn slides(&self, slip: &[f64; D]) -> bool {
        self.pull(slip).1 > self.most
    }
    /// Returns ∂²D/∂s² as the direction of t and two values [N/m]: along t, and perpendicular to both t and the normal.
    fn curvature(&self, slip: &[f64; D]) -> ([f64; D], [f64; 2]) {
        let (pull, size) = self.pull(slip);
        if size <= self.most {
            return ([0.0; D], [self.stiffness; 2]);
        }
        (scaled(&pull, 1.0 / size), [0.0, self.stiffness * self.most / size])
    }
    /// Returns ∂²D/∂s² times a relative motion of the pair.
    pub fn stiffen(&self, slip: &[f64; D], motion: &[f64; D]) -> [f64; D] {
        let across = subtract(motion, &scaled(&self.normal, dot(motion, &self.normal)));
        let (direction, [along, aside]) = self.curvature(slip);
        add(&scaled(&across, aside), &scaled(&direction, (along - aside) * dot(&across, &direction)))
    }
}

/// The barrier between the surfaces of a scene.
#[derive(Clone, Debug, Default)]
pub struct Barrier<const D: usize> {
    /// The reach r [m].
    reach: f64,
    /// The compliance 1/k of every point [m/N], where k is the stiffness of its body at that point; 0 if the point is pinned.
    pub softness: Vec<f64>,
    candidates: Candidates<D>,
    /// Boxes around the paths of the points, and the boxes for which the present candidates are valid; empty if there are none.
    boxes: Vec<[[f64; D]; 2]>,
    searched: Vec<[[f64; D]; 2]>,
    /// The pairs that come within reach on the paths examined last: their features, and whether these are a vertex and a facet.
    close: Vec<([u32; 2], bool)>,
}

/// The margin around the paths of points within which candidates remain valid, as a fraction of the longest path. Each
/// correction is shorter than the one before, so the margin often saves a search. Without a margin, every correction would need
/// a search. The pairs found within reach do not depend on the margin.
const MARGIN: f64 = 0.25;

impl<const D: usize> Barrier<D> {
    /// Makes a barrier with a reach [m]. The bits of its results do not depend on the vector instructions.
    pub fn new(reach: f64, simd: Simd) -> Barrier<D> {
        let mut barrier = Barrier { reach, ..Barrier::default() };
        barrier.candidates.simd = simd;
        barrier
    }

    /// Discards the pairs that may come within reach, because the surface may have changed.
    pub fn forget(&mut self) {
        self.searched.clear();
    }

    /// Finds all pairs that may come within reach while the points move straight from x to y [m]; searches only if the present
    /// candidates do not cover the motion.
    ///
    /// # Errors
    /// [`Trouble::TooMany`] above a limit.
    pub fn look(
        &mut self,
        surface: &Surface<D>,
        laws: &Laws,
        [x, y]: [&[[f64; D]]; 2],
        most: usize,
    ) -> Result<(), Trouble> {
        let mut longest: f64 = 0.0;
        self.boxes.clear();
        self.boxes.extend(x.iter().zip(y).map(|(x, y)| {
            longest = (0..D).fold(longest, |longest, d| (y[d] - x[d]).abs().larger(longest));
            let at = |choose: fn(f64, f64) -> f64| core::array::from_fn(|d| choose(x[d], y[d]));
            [at(|a, b| a.smaller(b)), at(|a, b| a.larger(b))]
        }));
        let within = |([low, high], [least, most]): (&[[f64; D]; 2], &[[f64; D]; 2])| {
            (0..D).all(|d| least[d] <= low[d] && high[d] <= most[d])
        };
        let known = self.searched.len() == self.boxes.len() && self.boxes.iter().zip(&self.searched).all(within);
        let distances = laws.largest_thickness().map(|thickness| thickness + self.reach);
        if !known {
            self.search(surface, laws, distances, self.reach.larger(MARGIN * longest), most)?;
        }
        let mut close = std::mem::take(&mut self.close);
        close.clear();
        close
            .extend(self.pairs().filter(|(pair, with_facet)| self.comes_close(surface, distances, *pair, *with_facet)));
        self.close = close;
        Ok(())
    }

    /// Searches for the pairs that come closer than the given distances [m] while the points stay within a margin [m] around
    /// their boxes.
    fn search(
        &mut self,
        surface: &Surface<D>,
        laws: &Laws,
        distances: [f64; 2],
        margin: f64,
        most: usize,
    ) -> Result<(), Trouble> {
        // If there are too many pairs within the margin, there may be few enough without a margin.
        for margin in [margin, 0.0] {
            let wider = |[low, high]: &[[f64; D]; 2]| [low.map(|low| low - margin), high.map(|high| high + margin)];
            self.searched.clear();
            self.searched.extend(self.boxes.iter().map(wider));
            if self.candidates.find(surface, &self.searched, distances, most, |a, b| laws.meet(a, b)) {
                return Ok(());
            }
        }
        self.forget();
        Err(Trouble::TooMany)
    }

    /// Whether the boxes of a pair come within reach on the paths examined last. A pair that was found only because of the margin does not come
    /// within reach.
    fn comes_close(&self, surface: &Surface<D>, distances: [f64; 2], [a, b]: [u32; 2], with_facet: bool) -> bool {
        let at = |p: u32| self.boxes[p as usize];
        let (first, second, points) = if with_facet {
            let corners = &surface.facets[b as usize];
            (at(a), around(at, corners), [a, corners[0]])
        } else {
            let [a, b] = [a, b].map(|edge| &surface.edges[edge as usize]);
            (around(at, a), around(at, b), [a[0], b[0]])
        };
        let distance = distances[usize::from(points.iter().any(|p| surface.is_of_obstacle(*p)))];
        (0..D).all(|d| first[0][d] <= second[1][d] + distance && second[0][d] - distance <= first[1][d])
    }

    /// Returns every pair that the search has found, with its two features and whether these are a vertex and a facet.
    fn pairs(&self) -> impl Iterator<Item = ([u32; 2], bool)> + '_ {
        let Candidates { vertex_facet, edge_edge, .. } = &self.candidates;
        vertex_facet.iter().map(|pair| (*pair, true)).chain(edge_edge.iter().map(|pair| (*pair, false)))
    }

    /// Returns the closest points of a pair.
    fn closest(&self, surface: &Surface<D>, x: &[[f64; D]], [a, b]: [u32; 2], with_facet: bool) -> Pair<D> {
        let (mut points, mut weights) = ([a; 4], [0.0; 4]);
        if with_facet {
            let corners = surface.facets[b as usize];
            let at = closest_on_facet(&x[a as usize], &corners.map(|p| x[p as usize]));
            weights[0] = 1.0;
            for k in 0..D {
                (points[k + 1], weights[k + 1]) = (corners[k], -at[k]);
            }
        } else {
            let [first, second] = [a, b].map(|edge| surface.edges[edge as usize]);
            let [s, t] = closest_of_segments(&first.map(|p| x[p as usize]), &second.map(|p| x[p as usize]));
            points = [first[0], first[1], second[0], second[1]];
            weights = [1.0 - s, s, t - 1.0, -t];
        }
        let mut between = [0.0; D];
        for (p, w) in points.iter().zip(&weights) {
            between = add(&between, &scaled(&x[*p as usize], *w));
        }
        Pair { points, weights, between }
    }

    /// Returns the first and the second body of a pair.
    fn bodies(surface: &Surface<D>, pair: &Pair<D>, with_facet: bool) -> [u32; 2] {
        [pair.points[0], pair.points[if with_facet { 1 } else { 2 }]].map(|p| surface.body[p as usize])
    }

    /// Finds the pairs that are within reach when the points are at x [m], a position on the paths examined last.
    ///
    /// # Errors
    /// [`Trouble::Meet`] if the gap of a pair is not positive.
    pub fn press(
        &self,
        surface: &Surface<D>,
        laws: &Laws,
        x: &[[f64; D]],
        out: &mut Vec<Pressed<D>>,
    ) -> Result<(), Trouble> {
        out.clear();
        for (features, with_facet) in self.close.iter().copied() {
            let pair = self.closest(surface, x, features, with_facet);
            let [a, b] = Self::bodies(surface, &pair, with_facet);
            let law = laws.of(a, b);
            let square = dot(&pair.between, &pair.between);
            let within = law.thickness + self.reach;
            if square >= within * within {
                continue;
            }
            let distance = square.sqrt();
            let gap = distance - law.thickness;
            let stiffness = self.stiffness(&pair.points, with_facet);
            if stiffness == 0.0 {
                // Pins determine the motion of both features.
                continue;
            }
            if gap <= 0.0 || gap.is_nan() {
                return Err(Trouble::Meet { bodies: [a, b] });
            }
            let (share, fade) = if with_facet { (1.0, None) } else { fading(x, &pair.points) };
            let (apart, logarithm) = (gap - self.reach, Lane::ln(gap / self.reach));
            let energy = -stiffness * apart * apart * logarithm;
            let slope = 2.0 * apart * logarithm + apart * apart / gap;
            let curvature = -2.0 * logarithm - 4.0 * apart / gap + apart * apart / (gap * gap);
            out.push(Pressed {
                id: key(features, with_facet),
                points: pair.points,
                weights: pair.weights,
                normal: scaled(&pair.between, 1.0 / distance),
                gap,
                energy: share * energy,
                force: share * stiffness * slope,
                curvature: share * stiffness * curvature,
                fading: fade.map_or([[0.0; D]; 4], |fade: [[f64; D]; 4]| fade.map(|f| scaled(&f, energy))),
                stiffness,
                friction: law.friction,
            });
        }
        Ok(())
    }

    /// Returns κ of a pair: the stiffness of both features in series, each with the mean compliance of its points.
    fn stiffness(&self, points: &[u32; 4], with_facet: bool) -> f64 {
        let mean =
            |points: &[u32]| points.iter().map(|p| self.softness[*p as usize]).sum::<f64>() / points.len() as f64;
        let first = if with_facet { 1 } else { 2 };
        let softness = mean(&points[..first]) + mean(&points[first..=D]);
        if softness > 0.0 { 1.0 / softness } else { 0.0 }
    }

    /// Returns the largest fraction of the paths from x to y along which all points may move while each pair keeps a tenth of
    /// its gap; 1 if nothing is in the way. These paths must be the ones examined last.
    pub fn free_part(&self, surface: &Surface<D>, laws: &Laws, [x, y]: [&[[f64; D]]; 2]) -> f64 {
        let mut part: f64 = 1.0;
        for (features, with_facet) in self.close.iter().copied() {
            let pair = self.closest(surface, x, features, with_facet);
            let [a, b] = Self::bodies(surface, &pair, with_facet);
            let thickness = laws.of(a, b).thickness;
            let gap = length(&pair.between) - thickness;
            if self.stiffness(&pair.points, with_facet) == 0.0 {
                continue;
            }
            if let Some(time) = meeting_time(surface, [x, y], thickness + KEPT * gap, features, with_facet) {
                part = time.smaller(part);
            }
        }
        part
    }
}

impl<const D: usize> Touching<D> {
    /// Records the contacts of the barrier in a step of h [s] for reports. The arguments are the pairs and their friction, both
    /// in ascending order of their keys, and the displacements of the points at the end of the step [m]. Friction uses the
    /// normal forces of the previous round, so it may act on pairs that no longer press.
    pub fn take_pressed(&mut self, h: f64, pressed: &[Pressed<D>], rubbing: &[Rubbing<D>], moved: &[[f64; D]]) {
        self.rows.clear();
        self.spread.clear();
        let mut take = |id, gap: Gap<D>, coefficient, force: f64, friction: [f64; D]| {
            let mut row = Row::new(id, (gap.points, gap.weights), gap.normal, coefficient);
            row.gap = gap.gap;
            row.put_into(&mut self.spread, &self.surface);
            (row.normal_impulse, row.friction_impulse) = (force * h, scaled(&friction, h));
            self.rows.push(row);
        };
        for pair in pressed {
            let gap = Gap { points: pair.points, weights: pair.weights, gap: pair.gap, normal: pair.normal };
            let rub = rubbing.binary_search_by_key(&pair.id, |rub| rub.id);
            let friction = rub.map_or([0.0; D], |k| rubbing[k].force(&rubbing[k].slip(moved)));
            take(pair.id, gap, pair.friction, pair.force, friction);
        }
        for rub in rubbing.iter().filter(|rub| pressed.binary_search_by_key(&rub.id, |pair| pair.id).is_err()) {
            let gap = Gap { points: rub.points, weights: rub.weights, gap: 0.0, normal: rub.normal };
            take(rub.id, gap, 0.0, 0.0, rub.force(&rub.slip(moved)));
        }
        self.rows.sort_by_key(|row| row.id);
        self.counts.steps += 1;
        self.counts.contacts += self.rows.len() as u64;
        if self.report {
            reports::add(&mut self.reports, &self.rows, &self.surface, &self.after[0]);
        }
    }
}

/// Two features at their closest points.
struct Pair<const D: usize> {
    points: [u32; 4],
    weights: [f64; 4],
    /// The vector from the second feature to the first [m].
    between: [f64; D],
}

/// Returns the factor m of two edges and, if they are nearly parallel, its derivatives with respect to their points.
fn fading<const D: usize>(x: &[[f64; D]], points: &[u32; 4]) -> (f64, Option<[[f64; D]; 4]>) {
    let at = points.map(|p| x[p as usize]);
    let (u, v) = (subtract(&at[1], &at[0]), subtract(&at[3], &at[2]));
    let (uu, vv, uv) = (dot(&u, &u), dot(&v, &v), dot(&u, &v));
    // sin² of the angle between the edges, independent of their lengths.
    let sine = (uu * vv - uv * uv) / (uu * vv);
    if sine >= PARALLEL {
        return (1.0, None);
    }
    let part = sine / PARALLEL;
    let slope = (2.0 - 2.0 * part) / PARALLEL;
    // ∂ sin²/∂u = −2 uv/(uu vv) (v − u uv/uu).
    let by = |u: &[f64; D], v: &[f64; D], uu: f64, vv: f64| {
        scaled(&subtract(v, &scaled(u, uv / uu)), -2.0 * slope * uv / (uu * vv))
    };
    let (by_u, by_v) = (by(&u, &v, uu, vv), by(&v, &u, vv, uu));
    let less = |a: &[f64; D]| scaled(a, -1.0);
    (part * (2.0 - part), Some([less(&by_u), by_u, less(&by_v), by_v]))
}
