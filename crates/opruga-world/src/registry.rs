//! The models and integrators that a world can use by name.

use opruga_core::integrator::IntegratorKind;
use opruga_core::potential::Model;
use opruga_core::spec::{Role, Spec, Values};
use std::sync::Arc;

/// Models and integrators by name. A user's crate can add its own.
#[derive(Clone)]
pub struct Registry<const D: usize> {
    models: Vec<Arc<dyn Model<D>>>,
    integrators: Vec<Arc<dyn IntegratorKind<D>>>,
}

/// The models and integrators for the plane and those for space, for programs whose scenes may have either dimension.
#[derive(Clone, Debug)]
pub struct Registries {
    /// For scenes in the plane.
    pub plane: Arc<Registry<2>>,
    /// For scenes in space.
    pub space: Arc<Registry<3>>,
}

impl Default for Registries {
    /// The registries of this library.
    fn default() -> Self {
        Registries { plane: Arc::new(Registry::default()), space: Arc::new(Registry::default()) }
    }
}

impl<const D: usize> Default for Registry<D> {
    fn default() -> Self {
        let models = opruga_models::all().into_iter().map(Arc::from).collect();
        Registry { models, integrators: opruga_integrators::all().into_iter().map(Arc::from).collect() }
    }
}

impl<const D: usize> core::fmt::Debug for Registry<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let names = |specs: Vec<&'static Spec>| specs.iter().map(|s| s.kind).collect::<Vec<_>>();
        f.debug_struct("Registry")
            .field("models", &names(self.models()))
            .field("integrators", &names(self.integrators()))
            .finish()
    }
}

impl<const D: usize> Registry<D> {
    /// Adds a model; it takes precedence over one of the same name.
    pub fn add_model(&mut self, model: Box<dyn Model<D>>) {
        self.models.insert(0, model.into());
    }
    /// Adds an integrator; it takes precedence over one of the same name.
    pub fn add_integrator(&mut self, integrator: Box<dyn IntegratorKind<D>>) {
        self.integrators.insert(0, integrator.into());
    }
    /// The model with a name.
    pub fn model(&self, kind: &str) -> Option<&dyn Model<D>> {
        self.models.iter().find(|m| m.spec().kind == kind).map(|m| &**m)
    }
    /// The first model with the given role.
    pub fn model_with(&self, role: Role) -> Option<&dyn Model<D>> {
        self.models.iter().find(|m| m.spec().has_role(role)).map(|m| &**m)
    }
    /// The first integrator with the given role.
    pub fn integrator_with(&self, role: Role) -> Option<&dyn IntegratorKind<D>> {
        self.integrators.iter().find(|m| m.spec().has_role(role)).map(|m| &**m)
    }
    /// The integrator with a name.
    pub fn integrator(&self, kind: &str) -> Option<&dyn IntegratorKind<D>> {
        self.integrators.iter().find(|m| m.spec().kind == kind).map(|m| &**m)
    }
    /// Every model with every integrator, and whether the integrator can step the model because the model has what it needs.
    pub fn pairs(&self) -> Vec<(&'static str, &'static str, bool)> {
        let mut out = Vec::new();
        for model in &self.models {
            for kind in &self.integrators {
                let needs = kind.build(&Values::defaults(kind.spec(), D)).map(|integrator| integrator.needs());
                let fits = needs.is_ok_and(|needs| model.views().include(needs));
                out.push((model.spec().kind, kind.spec().kind, fits));
            }
        }
        out
    }
    /// The specifications of all models.
    pub fn models(&self) -> Vec<&'static Spec> {
        self.models.iter().map(|m| m.spec()).collect()
    }
    /// The specifications of all integrators.
    pub fn integrators(&self) -> Vec<&'static Spec> {
        self.integrators.iter().map(|m| m.spec()).collect()
    }
}
