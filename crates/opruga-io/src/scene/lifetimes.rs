//! Commands on bodies that do not exist when the commands begin, because another command adds them later or has already removed
//! them.

use super::body_list::Bodies;
use super::errors::CommandError;
use super::location_of;
use super::reader::{Reader, join};
use crate::document::Node;
use crate::problem::{SceneError, visible};
use opruga_world::blueprint::Action;
use std::collections::BTreeMap;

/// What a command requires of bodies, which are given by their indices in the list.
enum Asks {
    /// The command adds this body.
    Adds(usize),
    /// The command removes this body.
    Removes(usize),
    /// This body must exist.
    Needs(usize),
    /// At least one of these bodies must exist: the copies of a body.
    NeedsOneOf(Vec<usize>),
}

/// Commands and what they require of bodies, in the order of the file.
#[derive(Default)]
pub(super) struct Lifetimes<'n> {
    asked: Vec<Asked<'n>>,
}

struct Asked<'n> {
    at: f64,
    node: &'n Node,
    path: String,
    asks: Vec<Asks>,
}

impl<'n> Lifetimes<'n> {
    /// Adds a command whose time is known.
    pub(super) fn add<const D: usize>(
        &mut self,
        at: f64,
        (node, path): (&'n Node, &str),
        actions: &[Action<D>],
        added: Option<usize>,
        bodies: &Bodies<D>,
    ) {
        let asks = actions.iter().filter_map(|action| match action {
            Action::Add(_) => added.map(Asks::Adds),
            Action::Remove { name } => bodies.names.get(name).map(|k| Asks::Removes(*k)),
            Action::Set { path, .. } => named(path, bodies).map(Asks::NeedsOneOf),
            other => other.body().map(Asks::Needs),
        });
        self.asked.push(Asked { at, node, path: path.to_string(), asks: asks.collect() });
    }

    /// Reports every command that begins while its body does not exist.
    pub(super) fn report<const D: usize>(mut self, reader: &mut Reader<'_>, bodies: &Bodies<D>) {
        // Sorted in the order in which the world runs them; commands with the same time run in the order of the file.
        self.asked.sort_by(|a, b| a.at.total_cmp(&b.at));
        let mut coming: BTreeMap<usize, f64> = bodies.later.values().copied().collect();
        let mut gone: BTreeMap<usize, f64> = BTreeMap::new();
        for Asked { at, node, path, asks } in self.asked {
            for asks in asks {
                let missing = match &asks {
                    Asks::Adds(k) => {
                        coming.remove(k);
                        None
                    }
                    Asks::Needs(k) | Asks::Removes(k) => Some(*k),
                    Asks::NeedsOneOf(all) => {
                        let there = |k: &usize| !coming.contains_key(k) && !gone.contains_key(k);
                        all.last().copied().filter(|_| !all.iter().any(there))
                    }
                };
                if let Some(k) = missing {
                    let body = bodies.list.get(k).map_or(String::new(), |body| visible(&body.name));
                    let fault = match (coming.get(&k), gone.get(&k)) {
                        (Some(added), _) => Some(CommandError::BeforeAdded { at, body, added: *added }),
                        (_, Some(removed)) => Some(CommandError::AfterRemoved { at, body, removed: *removed }),
                        _ => None,
                    };
                    if let Some(about) = fault {
                        reader.report(location_of(node, "at"), SceneError::of(about).path(join(&path, "at")));
                        continue;
                    }
                }
                if let Asks::Removes(k) = asks {
                    gone.insert(k, at);
                }
            }
        }
    }
}

/// The bodies that the path of a parameter names: one, or all copies; none if the path names something else.
fn named<const D: usize>(path: &str, bodies: &Bodies<D>) -> Option<Vec<usize>> {
    let name = path.strip_prefix("body.")?.split('.').next()?;
    if let Some(k) = bodies.names.get(name) {
        return Some(vec![*k]);
    }
    match bodies.copied.get(name) {
        Some((first, copies)) => Some((*first..first + copies.len()).collect()),
        None => name.parse().ok().filter(|k| *k < bodies.list.len()).map(|k| vec![k]),
    }
}
