//! Data that are kept from step to step in addition to positions and velocities. The data are stored in channels, each with a name and a type.
//!
//! An integrator that keeps data declares its channels once ([`Integrator::history`](crate::integrator::Integrator::history)).
//! Snapshots, recordings, rewinding, rebuilding of islands and resets follow from the declaration.

use crate::state::Columns;
use core::marker::PhantomData;

/// A value that a channel can hold once per body.
pub trait PerBodyValue: Copy + Default + 'static {
    /// Returns this value as the content of a channel.
    fn content<const D: usize>(self) -> Content<D>;
    /// The value of a channel; `None` if it holds another type.
    fn of<const D: usize>(content: &Content<D>) -> Option<Self>;
}

/// A channel of one value per body: a number, a whole number or a Boolean.
#[derive(Clone, Copy, Debug)]
pub struct PerBody<T> {
    name: &'static str,
    value: PhantomData<fn() -> T>,
}

/// A channel of one vector per node.
#[derive(Clone, Copy, Debug)]
pub struct PerNode {
    name: &'static str,
}

/// The type of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// One number per body.
    Number,
    /// One whole number per body.
    Count,
    /// One Boolean per body.
    Flag,
    /// One vector per node.
    Vectors,
}

/// The declaration of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The name, unique in a history.
    pub name: &'static str,
    /// The type of its content.
    pub holds: Type,
}

/// The content of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<const D: usize> {
    /// A number.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// A Boolean.
    Flag(bool),
    /// A vector per node, in the order of the indices.
    Vectors(Columns<D>),
}

impl<T: PerBodyValue> PerBody<T> {
    /// Makes a channel with this name.
    pub const fn new(name: &'static str) -> PerBody<T> {
        PerBody { name, value: PhantomData }
    }
    /// Returns the declaration of the channel.
    pub fn declared(&self) -> Channel {
        // For a value per body the dimension does not matter.
        Channel { name: self.name, holds: T::default().content::<2>().holds() }
    }
}

impl PerNode {
    /// Makes a channel with this name.
    pub const fn new(name: &'static str) -> PerNode {
        PerNode { name }
    }
    /// Returns the declaration of the channel.
    pub fn declared(&self) -> Channel {
        Channel { name: self.name, holds: Type::Vectors }
    }
}

macro_rules! per_body {
    ($($type:ty => $variant:ident),*) => { $(
        impl PerBodyValue for $type {
            fn content<const D: usize>(self) -> Content<D> {
                Content::$variant(self)
            }
            fn of<const D: usize>(content: &Content<D>) -> Option<$type> {
                if let Content::$variant(value) = content { Some(*value) } else { None }
            }
        }
    )* };
}
per_body!(f64 => Number, u64 => Count, bool => Flag);

impl<const D: usize> Content<D> {
    /// The initial content: zero.
    fn initial(holds: Type, index_count: usize) -> Content<D> {
        match holds {
            Type::Number => Content::Number(0.0),
            Type::Count => Content::Count(0),
            Type::Flag => Content::Flag(false),
            Type::Vectors => Content::Vectors(Columns::zeros(index_count)),
        }
    }
    /// Returns the type of the content.
    pub fn holds(&self) -> Type {
        match self {
            Content::Number(_) => Type::Number,
            Content::Count(_) => Type::Count,
            Content::Flag(_) => Type::Flag,
            Content::Vectors(_) => Type::Vectors,
        }
    }
    /// Copies another content, reusing memory.
    fn copy_from(&mut self, other: &Content<D>) {
        match (self, other) {
            (Content::Vectors(own), Content::Vectors(other)) => {
                for (own, other) in own.0.iter_mut().zip(&other.0) {
                    own.grow(other.len());
                    own.copy_from_slice(other);
                }
            }
            (own, other) => own.clone_from(other),
        }
    }
}

/// The channels of a system, in the order of their declaration, with their contents; part of the state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History<const D: usize> {
    owner: &'static str,
    channels: Vec<(Channel, Content<D>)>,
}

impl<const D: usize> History<D> {
    /// Makes the channels of an owner, such as an integrator, for `index_count` indices. All contents begin at zero.
    pub fn new(owner: &'static str, channels: &[Channel], index_count: usize) -> History<D> {
        let mut history = History { owner, channels: Vec::new() };
        history.add(channels, index_count);
        history
    }
    /// Adds channels, which begin at zero; existing ones do not change.
    pub fn add(&mut self, channels: &[Channel], index_count: usize) {
        for channel in channels {
            if self.find(channel.name).is_none() {
                self.channels.push((*channel, Content::initial(channel.holds, index_count)));
            }
        }
    }
    /// The name of the owner, such as the integrator that declared the first channels.
    pub fn owner(&self) -> &'static str {
        self.owner
    }
    /// All channels and their contents.
    pub fn channels(&self) -> impl ExactSizeIterator<Item = (Channel, &Content<D>)> + Clone {
        self.channels.iter().map(|(channel, content)| (*channel, content))
    }
    /// All channels, with mutable contents.
    pub fn channels_mut(&mut self) -> impl ExactSizeIterator<Item = (Channel, &mut Content<D>)> {
        self.channels.iter_mut().map(|(channel, content)| (*channel, content))
    }
    /// Whether the channels belong to this owner and begin with the given ones. Channels that were added later may follow them.
    pub fn is_of(&self, owner: &str, channels: &[Channel]) -> bool {
        let declared = self.channels.iter().map(|(channel, _)| channel);
        self.owner == owner && self.channels.len() >= channels.len() && declared.zip(channels).all(|(a, b)| a == b)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|(channel, _)| channel.name == name)
    }

    /// The value of a channel; zero or `false` if the system has no such channel.
    pub fn get<T: PerBodyValue>(&self, channel: PerBody<T>) -> T {
        self.find(channel.name).and_then(|k| T::of(&self.channels[k].1)).unwrap_or_default()
    }
    /// Sets the value of a channel; does nothing if the system has no such channel.
    pub fn set<T: PerBodyValue>(&mut self, channel: PerBody<T>, value: T) {
        if let Some(k) = self.find(channel.name).filter(|k| T::of(&self.channels[*k].1).is_some()) {
            self.channels[k].1 = value.content();
        }
    }
    /// The vectors of a channel; `None` if the system has no such channel.
    pub fn vectors(&self, channel: PerNode) -> Option<&Columns<D>> {
        match &self.channels[self.find(channel.name)?].1 {
            Content::Vectors(columns) => Some(columns),
            _ => None,
        }
    }
    /// The mutable vectors of a channel; `None` if the system has no such channel.
    pub fn vectors_mut(&mut self, channel: PerNode) -> Option<&mut Columns<D>> {
        let k = self.find(channel.name)?;
        match &mut self.channels[k].1 {
            Content::Vectors(columns) => Some(columns),
            _ => None,
        }
    }

    /// Resets all channels, because their contents do not fit a state that was changed from outside.
    pub fn reset(&mut self) {
        for (channel, content) in &mut self.channels {
            match content {
                Content::Vectors(columns) => columns.0.iter_mut().for_each(|column| column.fill(0.0)),
                content => *content = Content::initial(channel.holds, 0),
            }
        }
    }
    /// Copies the contents of another history, reusing memory.
    pub fn copy_from(&mut self, other: &History<D>) {
        if !self.is_alike(other) {
            self.clone_from(other);
            return;
        }
        for ((_, own), (_, other)) in self.channels.iter_mut().zip(&other.channels) {
            own.copy_from(other);
        }
    }
    fn is_alike(&self, other: &History<D>) -> bool {
        self.owner == other.owner
            && self.channels.iter().map(|(channel, _)| channel).eq(other.channels.iter().map(|(channel, _)| channel))
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let vectors = self.channels.iter().map(|(_, content)| match content {
            Content::Vectors(columns) => columns.0.iter().map(opruga_math::Column::heap_bytes).sum(),
            _ => 0,
        });
        vectors.sum::<usize>() + self.channels.capacity() * size_of::<(Channel, Content<D>)>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: PerBody<f64> = PerBody::new("load");
    const TURN: PerBody<u64> = PerBody::new("turn");
    const BEGUN: PerBody<bool> = PerBody::new("begun");
    const ACCELERATION: PerNode = PerNode::new("acceleration");

    fn history() -> History<2> {
        let declared = [LOAD.declared(), TURN.declared(), BEGUN.declared(), ACCELERATION.declared()];
        History::new("rule", &declared, 8)
    }

    #[test]
    fn channels_begin_at_zero_and_keep_what_they_are_given_by_name_and_type() {
        let mut history = history();
        assert_eq!((history.get(LOAD), history.get(TURN), history.get(BEGUN)), (0.0, 0, false));
        history.set(LOAD, 0.25);
        history.set(TURN, 3);
        history.set(BEGUN, true);
        history.vectors_mut(ACCELERATION).expect("vectors").set(5, [1.0, 2.0]);
        assert_eq!((history.get(LOAD), history.get(TURN), history.get(BEGUN)), (0.25, 3, true));
        assert_eq!(history.vectors(ACCELERATION).expect("vectors").at(5), [1.0, 2.0]);
        // The name alone does not give access to a channel: its type must match too.
        const OTHER: PerBody<f64> = PerBody::new("turn");
        history.set(OTHER, 7.0);
        assert_eq!((history.get(OTHER), history.get(TURN)), (0.0, 3));
        assert_eq!(history.vectors(PerNode::new("load")), None);
    }

    #[test]
    fn a_reset_history_is_one_that_was_just_declared_and_a_copy_is_equal() {
        let mut changed = history();
        changed.set(LOAD, 0.5);
        changed.set(BEGUN, true);
        changed.vectors_mut(ACCELERATION).expect("vectors").set(0, [3.0, 4.0]);
        let mut copy = history();
        copy.copy_from(&changed);
        assert_eq!(copy, changed);
        let mut other = History::default();
        other.copy_from(&changed);
        assert_eq!(other, changed);
        changed.reset();
        assert_eq!(changed, history());
    }

    #[test]
    fn a_channel_that_is_added_twice_keeps_what_it_holds() {
        let mut history = history();
        history.set(TURN, 2);
        history.add(&[TURN.declared(), PerBody::<f64>::new("last").declared()], 8);
        assert_eq!((history.get(TURN), history.channels().len()), (2, 5));
        // The owner that declared the first channels stays the owner.
        let declared: Vec<Channel> = history.channels().map(|(channel, _)| channel).collect();
        assert!(history.is_of("rule", &declared[..4]) && !history.is_of("rule", &declared[1..]));
    }
}
