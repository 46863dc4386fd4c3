//! Bodies that have left every measure: long before their positions lose digits there is nothing to be seen of them.

use super::{Living, three};
use opruga::World;

/// A body that is larger than this many times the scene has exploded [1]. A body that a person pulls, or that gas inflates, comes to
/// a few times its size; one that is torn apart by a step that is too long grows by a factor with every substep, so that the bound
/// tells when it is noticed and not whether.
const LARGEST: f64 = 100.0;

/// What the world calls a step that is too long, or a rule without a stable one.
const STEPS: [&str; 3] = ["step.unstable", "step.no_stable_step", "step.outgrown"];

/// A body that has exploded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exploded {
    /// The body.
    pub body: String,
    /// The kind of its integrator.
    pub integrator: String,
    /// Whether that integrator is unstable at this step, as far as the world can tell.
    pub unstable: bool,
}

/// What is said of it beside the other scene, in the words of the world: a kind in quotes.
impl core::fmt::Display for Exploded {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Exploded { body, integrator, unstable } = self;
        match unstable {
            true => write!(f, "`{body}` exploded: `{integrator}` is unstable at this step"),
            false => write!(f, "`{body}` exploded: it is more than 100 times as large as the scene was"),
        }
    }
}

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

fn positions<const D: usize>(world: &World<D>, body: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..world.node_count(body) as u32).map(move |node| three(world.position(body, node)))
}

/// The longest side of the box around all bodies [m].
pub(super) fn size_of<const D: usize>(world: &World<D>) -> f64 {
    longest_side(world.bodies().flat_map(|body| positions(world, body)))
}

impl<const D: usize> Living<D> {
    /// The first body that has exploded.
    pub(super) fn first_exploded(&mut self) -> Option<Exploded> {
        let exploded = |body: &usize| {
            let size = longest_side(positions(&self.world, *body));
            if size <= LARGEST * self.size {
                return false;
            }
            // What came later may be larger than everything was at the start; what has no size cannot be measured.
            let at_rest = longest_side(self.world.blueprint().bodies[*body].mesh.positions.iter().copied().map(three));
            let scene = self.size.max(at_rest);
            scene > 0.0 && size > LARGEST * scene
        };
        let body = self.world.bodies().find(exploded)?;
        self.world.look_at_steps_again();
        let blueprint = self.world.blueprint();
        let own = blueprint.bodies[body].integrator.as_ref();
        let integrator = own.unwrap_or(&blueprint.integrator).kind().to_string();
        let unstable = self.world.warnings().iter().any(|warning| STEPS.contains(&warning.code.as_str()));
        Some(Exploded { body: blueprint.bodies[body].name.clone(), integrator, unstable })
    }
}
