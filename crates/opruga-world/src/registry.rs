//! Which models and integrators a world can name.

use opruga_core::integrator::IntegratorKind;
use opruga_core::potential::Model;
use opruga_core::spec::Spec;
use std::any::Any;

/// Models and integrators by name. A user's crate adds its own.
pub struct Registry<const D: usize> {
    models: Vec<Box<dyn Model<D>>>,
    integrators: Vec<Box<dyn IntegratorKind<D>>>,
}

impl<const D: usize> Default for Registry<D> {
    fn default() -> Self {
        if D == 2 { same_dimension(plane()) } else { same_dimension(space()) }
    }
}

/// Every model and integrator of this library in the plane.
///
/// It and [`space`] are functions without parameters of type, so that the kernels are compiled once, here, and not
/// again in every crate, program and test that builds a world.
#[inline(never)]
fn plane() -> Registry<2> {
    Registry::of_this_library()
}

/// Every model and integrator of this library in space.
#[inline(never)]
fn space() -> Registry<3> {
    Registry::of_this_library()
}

/// What is already there under another name of its dimension.
fn same_dimension<const A: usize, const D: usize>(registry: Registry<A>) -> Registry<D> {
    let registry: Box<dyn Any> = Box::new(registry);
    registry.downcast().map_or_else(|_| Registry { models: Vec::new(), integrators: Vec::new() }, |r| *r)
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
    fn of_this_library() -> Self {
        Registry { models: opruga_models::all(), integrators: opruga_integrators::all() }
    }
    /// Adds a model; it takes precedence over one of the same name.
    pub fn add_model(&mut self, model: Box<dyn Model<D>>) {
        self.models.insert(0, model);
    }
    /// Adds an integrator; it takes precedence over one of the same name.
    pub fn add_integrator(&mut self, integrator: Box<dyn IntegratorKind<D>>) {
        self.integrators.insert(0, integrator);
    }
    /// The model of a name.
    pub fn model(&self, kind: &str) -> Option<&dyn Model<D>> {
        self.models.iter().find(|m| m.spec().kind == kind).map(|m| &**m)
    }
    /// The integrator of a name.
    pub fn integrator(&self, kind: &str) -> Option<&dyn IntegratorKind<D>> {
        self.integrators.iter().find(|m| m.spec().kind == kind).map(|m| &**m)
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
