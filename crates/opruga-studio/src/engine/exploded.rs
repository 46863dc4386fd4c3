//! Detects bodies that have grown to many times their size. Such a body can no longer be seen long before its positions lose digits.

use super::Living;
use crate::exploded::Exploded;
use opruga::{AnyBody, AnyWorld};

/// A body has exploded if it is larger than the scene by more than this factor [1]. A body that the user pulls, or that gas inflates, reaches a few
/// times its size. A body whose step is too long grows by a factor in every substep, so the limit affects only how soon this is detected.
const LARGEST: f64 = 100.0;

/// The codes of the world's warnings about a step that is too long, or about an integrator without a stable step.
const STEPS: [&str; 3] = ["step.unstable", "step.no_stable_step", "step.outgrown"];

/// The longest side of the box around points [m]; 0 where there are none.
fn longest_side(points: impl Iterator<Item = [f64; 3]>) -> f64 {
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for point in points {
        for (end, x) in ends.iter_mut().zip(point) {
            *end = [end[0].min(x), end[1].max(x)];
        }
    }
    ends.iter().map(|[low, high]| high - low).fold(0.0, f64::max)
}

/// The longest side of the box around all bodies [m].
pub(super) fn size_of(world: &dyn AnyWorld) -> f64 {
    longest_side(world.bodies().into_iter().flat_map(|body| world.positions(body).iter()))
}

impl Living {
    /// The first body that has exploded.
    pub(super) fn first_exploded(&mut self) -> Option<Exploded> {
        let exploded = |body: &usize| {
            let size = longest_side(self.world.positions(*body).iter());
            if size <= LARGEST * self.size {
                return false;
            }
            // A body that is added later may be larger than everything at the start, so its own size counts as well. A body of zero size cannot be
            // measured.
            let at_rest = self.world.scene().body(*body).map_or_else(Vec::new, AnyBody::rest_positions);
            let at_rest = longest_side(at_rest.into_iter());
            let scene = self.size.max(at_rest);
            scene > 0.0 && size > LARGEST * scene
        };
        let number = self.world.bodies().into_iter().find(exploded)?;
        self.world.look_at_steps_again();
        let body = self.world.scene().body(number)?;
        let integrator = body.integrator().unwrap_or(self.world.scene().integrator()).kind().to_string();
        let unstable = self.world.warnings().iter().any(|warning| STEPS.contains(&warning.code.as_str()));
        Some(Exploded { body: body.name().to_string(), integrator, unstable })
    }
}
