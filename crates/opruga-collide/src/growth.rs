//! The decision whether to repeat a step because contact pushed points farther than expected.

use crate::body_pairs::{BodyPair, Piece};
use crate::distances::Distances;
use crate::impact::meeting_time;
use crate::reach::SPARE;
use crate::touching::{Touching, Trouble};
use crate::unclear::FindUnclear;
use crate::vector::{dot, subtract};
use opruga_math::Lane;

impl<const D: usize> Touching<D> {
    /// Takes account of points that contact pushed farther than expected. Returns whether further pairs may have come too close, so that the step needs
    /// another round.
    ///
    /// # Errors
    /// [`Trouble`] as for [`Touching::step`].
    pub(crate) fn is_pushed_into_others(&mut self) -> Result<bool, Trouble> {
        if !self.grow() {
            return Ok(false);
        }
        self.search()?;
        Ok(self.any_come_within_reach())
    }

    /// Whether any candidate that was left out, because its features could not meet within their boxes, may have come too close in the motion to the
    /// end of the step. The result follows from exact distances, so it does not depend on the steps in which candidates are searched.
    fn any_come_within_reach(&mut self) -> bool {
        let mut unclear = std::mem::take(&mut self.found[0].unclear);
        let mut least = std::mem::take(&mut self.found[0].least);
        unclear.iter_mut().for_each(Vec::clear);
        least.clear();
        let Touching { surface, before: [x, _], pairs: known, reach, .. } = &*self;
        let mut of_grown = vec![false; surface.bodies()];
        reach.grown().for_each(|p| of_grown[surface.body[p as usize] as usize] = true);
        let has_grown = |pair: &BodyPair<D>| pair.is_active && pair.bodies.iter().any(|body| of_grown[*body as usize]);
        let all = known.all.iter().enumerate().filter(|(_, pair)| has_grown(pair));
        let pieces: Vec<Piece> =
            all.flat_map(|(k, pair)| [0, 1].map(|list| (k as u32, list, pair.range(list)))).collect();
        // For bodies at rest, the gaps of pairs somewhat beyond their boxes are computed too.
        let beyond = if self.at_once { SPARE * self.margin } else { 0.0 };
        let (pieces, lists, found) = (&pieces[..], [true; 2], &mut unclear);
        known.simd.run(FindUnclear { known, pieces, lists, beyond, unclear: found, least: &mut least });
        let mut any = false;
        for (list, pairs) in unclear.iter_mut().enumerate() {
            let (with_facet, features) = (list == 0, &known.features[list][..]);
            pairs.retain(|pair| {
                let pair = pair.features(features);
                let points = surface.points_of_features(&pair, with_facet);
                points.into_iter().flatten().any(|p| reach.has_grown(*p))
            });
            known.simd.run(Distances { surface, x, pairs, features, with_facet });
            let mut known = pairs.iter().map(|pair| (pair.features(features), pair.distance));
            any |= known.any(|pair| self.comes_within_reach(pair, with_facet, beyond));
        }
        (self.found[0].unclear, self.found[0].least) = (unclear, least);
        any
    }

    /// Whether a pair of features may have come within reach, given its distance at the start of the step [m].
    fn comes_within_reach(&self, (pair, distance): ([u32; 2], f64), with_facet: bool, beyond: f64) -> bool {
        let Touching { surface, reach, laws, .. } = self;
        let points = surface.points_of_features(&pair, with_facet);
        let features = points.map(|points| (points, surface.body[points[0] as usize]));
        let [own, other] = features.map(|(_, body)| body);
        // A facet without an inner side has the same distance on both sides.
        let has_inside = with_facet && own != other && surface.closed[pair[1] as usize];
        let distance = if has_inside { distance } else { distance.abs() };
        let least = laws.of(own, other).thickness + beyond;
        let ends = [&self.before[0][..], &self.end];
        distance <= least + self.largest_relative_displacement(points)
            && reach.may_meet(distance, least, features, false)
            && !reach.may_meet(distance, least, features, true)
            && (self.at_once || meeting_time(surface, ends, least, pair, with_facet).is_some())
    }

    /// The largest displacement to the end of the step of a point of one feature relative to a point of the other [m]. The distance of the features
    /// changes by no more than this.
    fn largest_relative_displacement(&self, [first, second]: [&[u32]; 2]) -> f64 {
        let displacement = |p: u32| subtract(&self.end[p as usize], &self.before[0][p as usize]);
        let mut square: f64 = 0.0;
        for a in first.iter().map(|p| displacement(*p)) {
            for b in second.iter().map(|p| displacement(*p)) {
                let relative = subtract(&a, &b);
                square = dot(&relative, &relative).larger(square);
            }
        }
        square.sqrt()
    }
}
