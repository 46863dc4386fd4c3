//! The decision whether to repeat a step because contact pushed points farther than expected.

use crate::distances::{Distances, Unclear};
use crate::reach::SPARE;
use crate::touching::{Touching, Trouble};
use crate::vector::{dot, subtract};
use opruga_math::Lane;

impl<const D: usize> Touching<D> {
    /// Extends the boxes of points that contact pushed beyond them. Returns whether further pairs may have come too close, so that the step needs
    /// another round.
    ///
    /// # Errors
    /// [`Trouble`] as for [`Touching::step`].
    pub(crate) fn is_pushed_into_others(&mut self) -> Result<bool, Trouble> {
        if !self.grow() {
            return Ok(false);
        }
        self.search()?;
        let mut of_grown = vec![false; self.laws.class.len()];
        self.reach.grown().for_each(|p| of_grown[self.surface.body[p as usize] as usize] = true);
        // The next round sets the limits of all pairs again.
        self.clearance.set_limits(&self.surface, self.thickest, |body| of_grown[body as usize]);
        Ok(self.any_come_within_reach(true) || self.any_come_within_reach(false))
    }

    /// Whether any candidate that was left out, because its features could not meet within their boxes, may have come too close in the motion to the
    /// end of the step. The result follows from exact distances, so it does not depend on the steps in which candidates are searched.
    fn any_come_within_reach(&mut self, with_facet: bool) -> bool {
        let list = usize::from(!with_facet);
        let mut pairs = std::mem::take(&mut self.found[0].unclear[list]);
        pairs.clear();
        let Touching { surface, before: [x, _], candidates, clearance, reach, laws, .. } = &*self;
        // For bodies at rest, the gaps of pairs somewhat beyond their boxes are computed too.
        let beyond = if self.at_once { SPARE * self.margin } else { 0.0 };
        let all = if with_facet { &candidates.vertex_facet } else { &candidates.edge_edge };
        for (candidate, features) in all.iter().enumerate() {
            if !clearance.is_clear(list, candidate, beyond)
                && surface.points_of_features(features, with_facet).into_iter().flatten().any(|p| reach.has_grown(*p))
            {
                pairs.push(Unclear { candidate, features: *features, distance: 0.0 });
            }
        }
        candidates.simd.run(Distances { surface, x, pairs: &mut pairs, with_facet });
        let comes = |pair: &Unclear| {
            let [own, other] = clearance.bodies(list, pair.candidate);
            let thickness = laws.of(own, other).thickness;
            let points = surface.points_of_features(&pair.features, with_facet);
            // A facet without an inner side has the same distance on both sides.
            let has_inside = with_facet && own != other && surface.closed[pair.features[1] as usize];
            let distance = if has_inside { pair.distance } else { pair.distance.abs() };
            let least = thickness + beyond;
            distance <= least + self.largest_relative_displacement(points)
                && reach.may_meet(distance, least, points, false)
                && !reach.may_meet(distance, least, points, true)
        };
        let any = pairs.iter().any(comes);
        self.found[0].unclear[list] = pairs;
        any
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
