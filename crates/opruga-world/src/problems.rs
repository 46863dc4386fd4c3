//! All errors that a world would return, found part by part; [`World::new`] stops at the first of them.

use crate::blueprint::{Blueprint, BodyBlueprint, LoadBlueprint};
use crate::error::{Part, WorldError};
use crate::registry::Registry;
use crate::world::{Options, World};
use opruga_core::spec::Values;
use std::sync::Arc;

/// The maximum number of problems, because a longer list would not help anyone.
const MOST_PROBLEMS: usize = 200;

impl<const D: usize> World<D> {
    /// The errors from building a world of this blueprint: the integrator, every obstacle, and every kind of body with its models, loads and stable
    /// step, each separately. Copies of a body count as one kind. Empty if there are no errors.
    pub fn problems(blueprint: &Blueprint<D>, options: &Options, registry: &Arc<Registry<D>>) -> Vec<WorldError> {
        let options = Options { threads: 1, ..options.clone() };
        let part = |bodies, colliders, loads| blueprint.part(bodies, colliders, loads);
        let refused = |part| World::with_registry(part, options.clone(), Arc::clone(registry)).err();
        if let Some(error) = refused(part(Vec::new(), Vec::new(), Vec::new())) {
            // Without surroundings and an integrator no part can be built.
            return vec![error];
        }
        let mut problems = Vec::new();
        let mut obstacles = Vec::new();
        for (number, collider) in blueprint.colliders.iter().enumerate() {
            if let Some(mut error) = refused(part(Vec::new(), vec![collider.clone()], Vec::new())) {
                // In the world that was built for it alone, the obstacle has number 0.
                if let WorldError::Build { part: Part::Collider { index }, .. } = &mut error {
                    *index = number;
                }
                problems.push(error);
            } else {
                obstacles.push(collider.clone());
            }
        }
        let all_obstacles = obstacles.len() == blueprint.colliders.len();
        let mut last: Option<(&str, usize, &[Values], Option<&Values>)> = None;
        for (number, body) in blueprint.bodies.iter().enumerate() {
            let kind = (
                body.common_name(),
                Arc::as_ptr(&body.mesh) as usize,
                body.models.as_slice(),
                body.integrator.as_ref(),
            );
            // Copies are adjacent.
            if last.replace(kind) == Some(kind) || problems.len() >= MOST_PROBLEMS {
                continue;
            }
            let loads = blueprint.loads.iter().filter(|l| l.body == number);
            let loads = loads.map(|l| LoadBlueprint { body: 0, ..l.clone() }).collect();
            // A pin that selects missing nodes holds nothing; the reader of a scene has already reported it at its line.
            let mut body = body.clone();
            body.pins = body.pins.iter().filter(|pin| pin.select.fault(&body).is_none()).cloned().collect();
            let body = &body;
            // Obstacles are included because they may hold the body.
            let Some(first) = refused(part(vec![body.clone()], obstacles.clone(), loads)) else { continue };
            if !all_obstacles && first.code().starts_with("static.") {
                // A refused obstacle might have held the body, which is not known.
                continue;
            }
            // Building stops at the first model that refuses; each of the other models is tested alone.
            let start = problems.len();
            for model in &body.models {
                let alone = BodyBlueprint { models: vec![model.clone()], pins: Vec::new(), ..body.clone() };
                // It is not an error of this model that it leaves cells to the other models.
                let own = |error: &WorldError| {
                    matches!(error, WorldError::Build { source, .. } if source.kind == model.kind())
                        && error.code() != "model.uncovered_cells"
                };
                problems.extend(refused(part(vec![alone], Vec::new(), Vec::new())).filter(own));
            }
            if !problems[start..].contains(&first)
                && !problems[..start].iter().any(|known| is_same_setting(known, &first))
            {
                problems.insert(start, first);
            }
        }
        problems
    }
}

/// Whether two errors of different bodies have the same cause in the scene, which does not depend on the shapes of the bodies.
fn is_same_setting(a: &WorldError, b: &WorldError) -> bool {
    const OF_SHAPES: [&str; 2] = ["contact.thickness", "contact.reach"];
    match (a, b) {
        (WorldError::Build { source: a, .. }, WorldError::Build { source: b, .. }) => {
            a.kind == "contact" && a == b && !OF_SHAPES.contains(&a.code())
        }
        _ => false,
    }
}

impl<const D: usize> BodyBlueprint<D> {
    /// The name in the scene. For copies this is the name without the number: `ball` for `ball[3]`.
    pub fn common_name(&self) -> &str {
        self.name.split('[').next().unwrap_or(&self.name)
    }
}
