//! What the caller offers to scenes: the models, integrators and colliders that exist.

use opruga_core::spec::Spec;

/// The specifications that a scene may name by `kind`.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    /// Models of bodies.
    pub models: Vec<&'static Spec>,
    /// Integrators.
    pub integrators: Vec<&'static Spec>,
    /// Rigid obstacles.
    pub colliders: Vec<&'static Spec>,
}

/// The specification of a kind, if it is in the list: of several (one per dimension) the one that exists in `dimension`.
pub(crate) fn find(list: &[&'static Spec], kind: &str, dimension: usize) -> Option<&'static Spec> {
    let mut named = list.iter().copied().filter(|s| s.kind == kind);
    let first = named.clone().next();
    named.find(|s| s.dimensions.contains(&dimension)).or(first)
}
