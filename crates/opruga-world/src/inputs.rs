//! Inputs of a program to a world that are not part of its scene. Such inputs are recorded on request, so that a recording can repeat them.

use crate::blueprint::{Action, CommandBlueprint, Selector};
use crate::bytes::{Reader, Writer};
use crate::error::WorldError;
use crate::path_faults::{PathFault, SnapshotFault};
use opruga_core::spec::Value;

/// An input of a program to a world between two frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Input<const D: usize> {
    /// [`World::command`].
    Command(CommandBlueprint<D>),
    /// [`World::set`].
    Set {
        /// The path of the parameter.
        path: String,
        /// Its new value.
        value: Value,
    },
    /// [`World::remove_body`].
    Remove {
        /// The name of the body.
        name: String,
    },
    /// [`World::set_node`].
    SetNode {
        /// The body, by its number.
        body: usize,
        /// The node, by its number in the body.
        node: u32,
        /// Its new position [m].
        position: [f64; D],
        /// Its new velocity [m/s].
        velocity: [f64; D],
    },
    /// [`World::add_body`], which cannot be written as bytes.
    Add {
        /// The name of the body.
        name: String,
    },
    /// [`World::act`], [`World::lead`] or [`World::finish`]. These calls cannot be written as bytes; their commands are saved with the scene instead.
    Act,
    /// [`World::add_force`]: a law of the program, which cannot be written as bytes.
    Force {
        /// The body, by its number.
        body: usize,
    },
}

impl<const D: usize> Input<D> {
    pub(crate) fn unwritable(&self) -> WorldError {
        match self {
            Input::Force { body } => WorldError::path(format!("body.{body}"), PathFault::ForceUnrecorded {}),
            Input::Act => WorldError::path("command", PathFault::ActUnrecorded {}),
            Input::Add { name } => WorldError::path(name, PathFault::BodyUnrecorded {}),
            Input::Command(CommandBlueprint { action: Action::Add(body), .. }) => {
                WorldError::path(&body.name, PathFault::BodyUnrecorded {})
            }
            Input::Command(CommandBlueprint { action: Action::Change { body, .. }, .. }) => {
                WorldError::path(format!("body.{body}"), PathFault::ModelsUnrecorded {})
            }
            _ => WorldError::path("", PathFault::Unrecorded {}),
        }
    }

    /// The bytes of the input, for [`Input::from_bytes`].
    ///
    /// # Errors
    /// [`WorldError::Path`] for bodies and forces that the program has created itself: they cannot be written as data.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WorldError> {
        let mut bytes = Vec::new();
        let mut out = Writer(&mut bytes);
        match self {
            Input::Command(command) => {
                out.count(0);
                out.number(command.at);
                out.number(command.until);
                if !write_action(&mut out, &command.action) {
                    return Err(self.unwritable());
                }
            }
            Input::Set { path, value } => {
                out.count(1);
                out.text(path);
                out.value(value);
            }
            Input::Remove { name } => {
                out.count(2);
                out.text(name);
            }
            Input::SetNode { body, node, position, velocity } => {
                out.count(3);
                out.count(*body as u64);
                out.count(u64::from(*node));
                out.vectors(&[*position, *velocity]);
            }
            Input::Add { .. } | Input::Force { .. } | Input::Act => return Err(self.unwritable()),
        }
        Ok(bytes)
    }

    /// The input that these bytes contain.
    ///
    /// # Errors
    /// [`WorldError::Snapshot`] if the bytes contain no input.
    pub fn from_bytes(bytes: &[u8]) -> Result<Input<D>, WorldError> {
        let mut reader = Reader(bytes);
        let input = match reader.count()? {
            0 => {
                let (at, until) = (reader.number()?, reader.number()?);
                Input::Command(CommandBlueprint { at, until, action: read_action(&mut reader)? })
            }
            1 => Input::Set { path: reader.text()?, value: reader.value()? },
            2 => Input::Remove { name: reader.text()? },
            3 => {
                let (body, node) = (reader.count()? as usize, reader.count()? as u32);
                let [position, velocity] = reader.vectors::<D>()?[..] else { return Err(unknown()) };
                Input::SetNode { body, node, position, velocity }
            }
            _ => return Err(unknown()),
        };
        if reader.0.is_empty() { Ok(input) } else { Err(unknown()) }
    }
}

fn unknown() -> WorldError {
    WorldError::snapshot(SnapshotFault::Input {})
}

/// Writes an action; returns false if it cannot be written.
pub(crate) fn write_action<const D: usize>(out: &mut Writer<'_>, action: &Action<D>) -> bool {
    match action {
        Action::Drag { body, node, facet, stiffness, path, largest_force } => {
            out.count(0);
            out.count(*body as u64);
            let optional = [node.map(f64::from), *stiffness, *largest_force];
            for number in optional {
                out.numbers(number.as_slice());
            }
            out.count(u64::from(*facet));
            out.value(&Value::Rows(path.clone()));
        }
        Action::Push { body, select, force } => {
            out.count(1);
            out.count(*body as u64);
            write_selector(out, select);
            out.vectors(&[*force]);
        }
        Action::Pin { body, select, axes } => {
            out.count(2);
            out.count(*body as u64);
            write_selector(out, select);
            axes.iter().for_each(|axis| out.count(u64::from(*axis)));
        }
        Action::Set { path, value } => {
            out.count(3);
            out.text(path);
            out.value(value);
        }
        Action::Remove { name } => {
            out.count(4);
            out.text(name);
        }
        Action::Free { body, select } => {
            out.count(5);
            out.count(*body as u64);
            write_selector(out, select);
        }
        Action::Add(_) | Action::Change { .. } => return false,
    }
    true
}

pub(crate) fn read_action<const D: usize>(reader: &mut Reader<'_>) -> Result<Action<D>, WorldError> {
    Ok(match reader.count()? {
        0 => {
            let body = reader.count()? as usize;
            let mut optional = || Ok::<_, WorldError>(reader.numbers()?.first().copied());
            let (node, stiffness, largest_force) = (optional()?, optional()?, optional()?);
            let facet = reader.count()? == 1;
            let Value::Rows(path) = reader.value()? else { return Err(unknown()) };
            if path.is_empty() || path.iter().any(|row| row.len() != D + 1 || row.iter().any(|x| !x.is_finite())) {
                return Err(unknown());
            }
            Action::Drag { body, node: node.map(|n| n as u32), facet, stiffness, path, largest_force }
        }
        1 => {
            let (body, select) = (reader.count()? as usize, read_selector(reader, 0)?);
            let [force] = reader.vectors::<D>()?[..] else { return Err(unknown()) };
            Action::Push { body, select, force }
        }
        2 => {
            let (body, select) = (reader.count()? as usize, read_selector(reader, 0)?);
            let mut axes = [false; D];
            for axis in &mut axes {
                *axis = reader.count()? == 1;
            }
            Action::Pin { body, select, axes }
        }
        3 => Action::Set { path: reader.text()?, value: reader.value()? },
        4 => Action::Remove { name: reader.text()? },
        5 => Action::Free { body: reader.count()? as usize, select: read_selector(reader, 0)? },
        _ => return Err(unknown()),
    })
}

pub(crate) fn write_selector<const D: usize>(out: &mut Writer<'_>, select: &Selector<D>) {
    let sets = |out: &mut Writer<'_>, kind: u64, sets: &[Selector<D>]| {
        out.count(kind);
        out.count(sets.len() as u64);
        sets.iter().for_each(|set| write_selector(out, set));
    };
    match select {
        Selector::Box(low, high) => {
            out.count(0);
            out.vectors(&[*low, *high]);
        }
        Selector::Ball { center, radius } => {
            out.count(1);
            out.vectors(&[*center]);
            out.number(*radius);
        }
        Selector::HalfSpace { point, normal } => {
            out.count(2);
            out.vectors(&[*point, *normal]);
        }
        Selector::Side(side) => {
            out.count(3);
            out.text(side);
        }
        Selector::Nodes(nodes) => {
            out.count(4);
            out.value(&Value::Integers(nodes.clone()));
        }
        Selector::Group(name) => {
            out.count(5);
            out.text(name);
        }
        Selector::Boundary => out.count(6),
        Selector::All => out.count(7),
        Selector::And(all) => sets(out, 8, all),
        Selector::Or(any) => sets(out, 9, any),
        Selector::Not(set) => sets(out, 10, std::slice::from_ref(set)),
    }
}

/// The maximum nesting of sets of nodes.
const DEEPEST: u32 = 128;

pub(crate) fn read_selector<const D: usize>(reader: &mut Reader<'_>, depth: u32) -> Result<Selector<D>, WorldError> {
    if depth > DEEPEST {
        return Err(unknown());
    }
    let sets = |reader: &mut Reader<'_>| -> Result<Vec<Selector<D>>, WorldError> {
        let n = reader.length()?;
        (0..n).map(|_| read_selector(reader, depth + 1)).collect()
    };
    let pair = |reader: &mut Reader<'_>| match reader.vectors::<D>()?[..] {
        [a, b] => Ok((a, b)),
        _ => Err(unknown()),
    };
    Ok(match reader.count()? {
        0 => {
            let (low, high) = pair(reader)?;
            Selector::Box(low, high)
        }
        1 => {
            let [center] = reader.vectors::<D>()?[..] else { return Err(unknown()) };
            Selector::Ball { center, radius: reader.number()? }
        }
        2 => {
            let (point, normal) = pair(reader)?;
            Selector::HalfSpace { point, normal }
        }
        3 => Selector::Side(reader.text()?),
        4 => match reader.value()? {
            Value::Integers(nodes) => Selector::Nodes(nodes),
            _ => return Err(unknown()),
        },
        5 => Selector::Group(reader.text()?),
        6 => Selector::Boundary,
        7 => Selector::All,
        8 => Selector::And(sets(reader)?),
        9 => Selector::Or(sets(reader)?),
        10 => match sets(reader)?.pop() {
            Some(set) => Selector::Not(Box::new(set)),
            None => return Err(unknown()),
        },
        _ => return Err(unknown()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn selector() -> impl Strategy<Value = Selector<2>> {
        let point = || prop::array::uniform2(-9.0..9.0f64);
        let leaf = prop_oneof![
            (point(), point()).prop_map(|(low, high)| Selector::Box(low, high)),
            (point(), 0.1..9.0f64).prop_map(|(center, radius)| Selector::Ball { center, radius }),
            (point(), point()).prop_map(|(point, normal)| Selector::HalfSpace { point, normal }),
            "[a-z]{0,9}".prop_map(Selector::Side),
            "[a-z]{0,9}".prop_map(Selector::Group),
            prop::collection::vec(any::<u32>(), 0..9).prop_map(Selector::Nodes),
            Just(Selector::Boundary),
            Just(Selector::All),
        ];
        leaf.prop_recursive(3, 12, 3, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..3).prop_map(Selector::And),
                prop::collection::vec(inner.clone(), 0..3).prop_map(Selector::Or),
                inner.prop_map(|set| Selector::Not(Box::new(set))),
            ]
        })
    }

    fn input() -> impl Strategy<Value = Input<2>> {
        let vector = || prop::array::uniform2(-9.0..9.0f64);
        let path = prop::collection::vec(prop::collection::vec(-9.0..9.0f64, 3), 1..4);
        let number = || prop::option::of(0.1..9.0f64);
        let drag = (0..9usize, prop::option::of(any::<u32>()), any::<bool>(), number(), path, number()).prop_map(
            |(body, node, facet, stiffness, path, largest_force)| Action::Drag {
                body,
                node,
                facet,
                stiffness,
                path,
                largest_force,
            },
        );
        let action = prop_oneof![
            drag,
            (0..9usize, selector(), vector()).prop_map(|(body, select, force)| Action::Push { body, select, force }),
            (0..9usize, selector(), prop::array::uniform2(any::<bool>()))
                .prop_map(|(body, select, axes)| Action::Pin { body, select, axes }),
            (0..9usize, selector()).prop_map(|(body, select)| Action::Free { body, select }),
            ("[a-z.]{0,9}", -9.0..9.0f64).prop_map(|(path, x)| Action::Set { path, value: Value::Number(x) }),
            "[a-z]{0,9}".prop_map(|name| Action::Remove { name }),
        ];
        prop_oneof![
            (0.0..9.0f64, 0.0..9.0f64, action).prop_map(|(at, until, action)| Input::Command(CommandBlueprint {
                at,
                until,
                action
            })),
            ("[a-z.]{0,9}", prop::collection::vec(-9.0..9.0f64, 0..4))
                .prop_map(|(path, x)| Input::Set { path, value: Value::Numbers(x) }),
            "[a-z]{0,9}".prop_map(|name| Input::Remove { name }),
            (0..9usize, any::<u32>(), vector(), vector()).prop_map(|(body, node, position, velocity)| Input::SetNode {
                body,
                node,
                position,
                velocity
            }),
        ]
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(input in input()) {
            let bytes = input.to_bytes().expect("data");
            prop_assert_eq!(Input::from_bytes(&bytes).expect("read"), input);
            prop_assert!(Input::<2>::from_bytes(&bytes[..bytes.len() - 1]).is_err());
        }

        #[test]
        fn any_bytes_are_an_input_or_an_error(bytes in prop::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..200)) {
            let _ = Input::<3>::from_bytes(&bytes);
        }
    }

    #[test]
    fn laws_and_bodies_of_the_program_cannot_be_written() {
        for input in [Input::<2>::Force { body: 3 }, Input::Add { name: "it".into() }] {
            let error = input.to_bytes().expect_err("no data").to_string();
            assert!(error.contains("cannot be recorded") && (error.contains('3') || error.contains("it")), "{error}");
        }
    }
}
