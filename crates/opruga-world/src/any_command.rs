//! Commands without a dimension in their type. Such commands have the form of commands in space. A world in the plane ignores their z components.

use crate::blueprint::{Action, AnyBlueprint, Blueprint, CommandBlueprint, Selector};
use crate::bytes::{Reader, Writer};
use crate::error::WorldError;
use crate::path_faults::PathFault;
use crate::registry::Registry;

fn cut<T: Copy, const D: usize>(vector: [T; 3]) -> [T; D] {
    core::array::from_fn(|d| vector[d])
}

impl Selector<3> {
    fn cut<const D: usize>(&self) -> Selector<D> {
        let all = |sets: &[Selector<3>]| sets.iter().map(Selector::cut).collect();
        match self {
            Selector::Box(low, high) => Selector::Box(cut(*low), cut(*high)),
            Selector::Ball { center, radius } => Selector::Ball { center: cut(*center), radius: *radius },
            Selector::HalfSpace { point, normal } => Selector::HalfSpace { point: cut(*point), normal: cut(*normal) },
            Selector::Side(side) => Selector::Side(side.clone()),
            Selector::Nodes(nodes) => Selector::Nodes(nodes.clone()),
            Selector::Group(name) => Selector::Group(name.clone()),
            Selector::Boundary => Selector::Boundary,
            Selector::All => Selector::All,
            Selector::And(sets) => Selector::And(all(sets)),
            Selector::Or(sets) => Selector::Or(all(sets)),
            Selector::Not(set) => Selector::Not(Box::new(set.cut())),
        }
    }
}

impl CommandBlueprint<3> {
    /// The same command in `D` dimensions.
    ///
    /// # Errors
    /// [`WorldError::Path`] if the command adds a body, because a body has the dimension of its scene. Use [`crate::AnyWorld::act_of`] for such a
    /// command.
    pub(crate) fn cut<const D: usize>(&self) -> Result<CommandBlueprint<D>, WorldError> {
        let action = match &self.action {
            Action::Drag { body, node, facet, stiffness, path, largest_force } => Action::Drag {
                body: *body,
                node: *node,
                facet: *facet,
                stiffness: *stiffness,
                path: path.iter().map(|row| row[..row.len().min(1 + D)].to_vec()).collect(),
                largest_force: *largest_force,
            },
            Action::Push { body, select, force } => {
                Action::Push { body: *body, select: select.cut(), force: cut(*force) }
            }
            Action::Pin { body, select, axes } => Action::Pin { body: *body, select: select.cut(), axes: cut(*axes) },
            Action::Free { body, select } => Action::Free { body: *body, select: select.cut() },
            Action::Set { path, value } => Action::Set { path: path.clone(), value: value.clone() },
            Action::Change { body, models, integrator } => {
                Action::Change { body: *body, models: models.clone(), integrator: integrator.clone() }
            }
            Action::Remove { name } => Action::Remove { name: name.clone() },
            Action::Add(_) => {
                return Err(WorldError::path("command", PathFault::NoForm {}));
            }
        };
        Ok(CommandBlueprint { at: self.at, until: self.until, action })
    }
}

impl<const D: usize> Blueprint<D> {
    /// The last command that adds a body and has begun by a given time [s].
    fn addition(&self, now: f64) -> Option<&CommandBlueprint<D>> {
        self.commands.iter().rfind(|command| command.at <= now && matches!(command.action, Action::Add(_)))
    }
}

impl AnyBlueprint {
    /// The last command that adds a body and has begun by a given time [s], for a world of the same dimension.
    ///
    /// The body is passed on as bytes, as in a snapshot.
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no such command, or if the world has another dimension.
    pub(crate) fn addition_for<const D: usize>(
        &self,
        registry: &Registry<D>,
        now: f64,
    ) -> Result<CommandBlueprint<D>, WorldError> {
        let refuse = |fault: PathFault| WorldError::path("add", fault);
        if self.scene().dimension() != D {
            return Err(refuse(PathFault::OtherDimension {}));
        }
        let mut bytes = Vec::new();
        let mut out = Writer(&mut bytes);
        let written = match self {
            AnyBlueprint::Plane(blueprint) => blueprint.addition(now).map(|command| out.command(command)),
            AnyBlueprint::Space(blueprint) => blueprint.addition(now).map(|command| out.command(command)),
        };
        written.ok_or_else(|| refuse(PathFault::AddsNothing {}))?;
        Reader(&bytes).command(registry)
    }
}
