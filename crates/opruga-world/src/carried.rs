//! The part of the state of a body that is kept when its island is rebuilt.

use opruga_core::history::Content;
use opruga_core::system::System;

/// The state of a body that is kept when islands are rebuilt.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyState<const D: usize> {
    pub(crate) x: Vec<[f64; D]>,
    pub(crate) v: Vec<[f64; D]>,
    /// The memory of each model of the blueprint: the numbers of this body, taken from every eighth number of the memory in a system.
    pub(crate) memory: Vec<Vec<f64>>,
    pub(crate) history: BodyHistory<D>,
}

/// The history of one body, by channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BodyHistory<const D: usize> {
    /// The name of the owner, which is the integrator that declared the first channels.
    pub(crate) owner: String,
    /// Name and content.
    pub(crate) channels: Vec<(String, Kept<D>)>,
}

/// The content of a channel for one body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kept<const D: usize> {
    Number(f64),
    Count(u64),
    Flag(bool),
    /// One vector per node.
    Vectors(Vec<[f64; D]>),
}

impl<const D: usize> BodyHistory<D> {
    /// The history of the body in a lane.
    pub(crate) fn of(system: &System<D>, lane: usize) -> BodyHistory<D> {
        let kept = |content: &Content<D>| match content {
            Content::Number(number) => Kept::Number(*number),
            Content::Count(count) => Kept::Count(*count),
            Content::Flag(flag) => Kept::Flag(*flag),
            Content::Vectors(columns) => {
                Kept::Vectors((0..system.nodes).map(|node| columns.at(system.layout.index(node, lane))).collect())
            }
        };
        BodyHistory {
            owner: system.history.owner().into(),
            channels: system
                .history
                .channels()
                .map(|(channel, content)| (channel.name.to_string(), kept(content)))
                .collect(),
        }
    }
    /// Whether a system has the same channels.
    pub(crate) fn fits(&self, system: &System<D>) -> bool {
        let own = system.history.channels();
        self.owner == system.history.owner()
            && self.channels.len() == own.len()
            && self
                .channels
                .iter()
                .zip(own)
                .all(|((name, kept), (channel, content))| name == channel.name && kept.is_like(content))
    }
    /// Whether its vectors belong to the given number of nodes.
    pub(crate) fn is_of_nodes(&self, nodes: usize) -> bool {
        self.channels.iter().all(|(_, kept)| !matches!(kept, Kept::Vectors(vectors) if vectors.len() != nodes))
    }
    /// Restores the history of a body in a system, channel by channel, if the system has the same integrator.
    pub(crate) fn restore(&self, system: &mut System<D>, lane: usize) {
        if self.owner != system.history.owner() {
            return;
        }
        let (layout, nodes) = (system.layout, system.nodes);
        for (channel, content) in system.history.channels_mut() {
            let Some((_, kept)) = self.channels.iter().find(|(name, _)| name == channel.name) else { continue };
            match (content, kept) {
                (Content::Number(own), Kept::Number(kept)) => *own = *kept,
                (Content::Count(own), Kept::Count(kept)) => *own = *kept,
                (Content::Flag(own), Kept::Flag(kept)) => *own = *kept,
                (Content::Vectors(own), Kept::Vectors(kept)) => {
                    for (node, value) in kept.iter().enumerate().take(nodes) {
                        own.set(layout.index(node, lane), *value);
                    }
                }
                _ => {}
            }
        }
    }
}

impl<const D: usize> Kept<D> {
    fn is_like(&self, content: &Content<D>) -> bool {
        matches!(
            (self, content),
            (Kept::Number(_), Content::Number(_))
                | (Kept::Count(_), Content::Count(_))
                | (Kept::Flag(_), Content::Flag(_))
                | (Kept::Vectors(_), Content::Vectors(_))
        )
    }
}
