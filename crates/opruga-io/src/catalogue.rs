//! What the caller offers to scenes: the models, integrators and colliders that exist.

use opruga_core::spec::{Field, Spec};

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

/// Groups the specifications by kind, in the order in which the kinds first occur. A kind has several specifications if its fields differ between
/// dimensions.
pub(crate) fn by_kind(list: &[&'static Spec]) -> Vec<Vec<&'static Spec>> {
    let mut kinds: Vec<Vec<&'static Spec>> = Vec::new();
    for spec in list {
        match kinds.iter_mut().find(|kind| kind[0].kind == spec.kind) {
            Some(kind) => kind.push(spec),
            None => kinds.push(vec![spec]),
        }
    }
    kinds
}

/// The dimensions in which a kind exists, ascending.
pub(crate) fn dimensions(kind: &[&'static Spec]) -> Vec<usize> {
    let mut dimensions: Vec<usize> = kind.iter().flat_map(|spec| spec.dimensions).copied().collect();
    dimensions.sort_unstable();
    dimensions.dedup();
    dimensions
}

/// The fields of a kind in their order, one for each name and meaning, each with the specifications that have this field.
pub(crate) fn fields(kind: &[&'static Spec]) -> Vec<(&'static Field, Vec<&'static Spec>)> {
    let mut fields: Vec<(&'static Field, Vec<&'static Spec>)> = Vec::new();
    for spec in kind {
        for field in spec.fields {
            match fields.iter_mut().find(|(known, _)| **known == *field) {
                Some((_, of)) => of.push(spec),
                None => {
                    // Placed next to the field of the same name, if another dimension has one.
                    let index = fields.iter().rposition(|(known, _)| known.name == field.name);
                    fields.insert(index.map_or(fields.len(), |index| index + 1), (field, vec![spec]));
                }
            }
        }
    }
    fields
}

/// The specification of a kind, if it is in the list. If there are several (one per dimension), the one that exists in `dimension`.
pub(crate) fn find(list: &[&'static Spec], kind: &str, dimension: usize) -> Option<&'static Spec> {
    let mut named = list.iter().copied().filter(|s| s.kind == kind);
    let first = named.clone().next();
    named.find(|s| s.dimensions.contains(&dimension)).or(first)
}
