//! Sets of nodes: reads them, and refuses those that select nothing.

use super::body_list::Bodies;
use super::errors::{ReferenceError, SceneHint, Wanted};
use super::reader::{Reader, join, listed};
use crate::document::{Data, Location, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, nearest};
use opruga_world::blueprint::{BodyBlueprint, Selector};
use opruga_world::schema::{SELECTORS, Section};
use opruga_world::selection;
use opruga_world::validity::SelectorFault;

/// Reads the set of nodes of a table: `select = { … }`; all nodes if the table has none.
pub(crate) fn of<const D: usize>(reader: &mut Reader<'_>, table: &Node, path: &str) -> Option<Selector<D>> {
    match table.get("select") {
        Some(node) => one(reader, node, &join(path, "select")),
        None => Some(Selector::All),
    }
}

/// Reads one selector: a table with exactly one key.
fn one<const D: usize>(reader: &mut Reader<'_>, node: &Node, path: &str) -> Option<Selector<D>> {
    let words = || SELECTORS.iter().map(|s| s.kind);
    let entries = match &node.data {
        Data::Table(entries) => entries,
        _ => {
            reader.wrong_type(node, path, Wanted::Selector);
            return None;
        }
    };
    if entries.len() != 1 {
        let about = ReferenceError::Keys { count: entries.len(), value: node.shown() };
        reader.report(node.location, SceneError::of(about).path(path).allowed(listed(words())));
        return None;
    }
    let (key, value) = (entries[0].key.as_str(), &entries[0].value);
    let here = join(path, key);
    Some(match key {
        "box" => {
            let rows = reader.rows(value, &here, D, false, &Allowed::Points)?;
            let [a, b] = rows.as_slice() else {
                let about = ReferenceError::Corners { count: rows.len(), value: value.shown() };
                reader.report(value.location, SceneError::of(about).path(here));
                return None;
            };
            Selector::Box(fixed(a), fixed(b))
        }
        "ball" | "half_space" => {
            let spec = SELECTORS.iter().find(|s| s.kind == key)?;
            let before = reader.count();
            let values = reader.fields(value, &here, &Section { spec, children: &[] }, None);
            if reader.count() > before {
                return None;
            }
            if key == "ball" {
                Selector::Ball { center: values.vector("center"), radius: values.number("radius")? }
            } else {
                let normal: [f64; D] = values.vector("normal");
                if normal.iter().all(|n| *n == 0.0) {
                    let error = SceneError::of(ReferenceError::NoNormal {}).path(join(&here, "normal"));
                    reader.report(super::location_of(value, "normal"), error);
                    return None;
                }
                Selector::HalfSpace { point: values.vector("point"), normal }
            }
        }
        "side" => {
            let range = Allowed::Choice(if D == 2 {
                &["left", "right", "bottom", "top"]
            } else {
                &["left", "right", "bottom", "top", "back", "front"]
            });
            match reader.plain(value, &here, "side", &range)? {
                opruga_core::spec::Value::Text(side) => Selector::Side(side),
                _ => return None,
            }
        }
        "node" => Selector::Nodes(vec![reader.natural(value, &here)?]),
        "nodes" => Selector::Nodes(reader.naturals(value, &here, &Allowed::Integers)?),
        "group" => match reader.plain(value, &here, "group", &Allowed::Text)? {
            opruga_core::spec::Value::Text(name) => Selector::Group(name),
            _ => return None,
        },
        "boundary" | "all" => {
            if !matches!(value.data, Data::Boolean(true)) {
                let about = ReferenceError::NotTrue { field: key.into(), value: value.shown() };
                reader.report(value.location, SceneError::of(about).path(here));
                return None;
            }
            if key == "all" { Selector::All } else { Selector::Boundary }
        }
        "and" | "or" => {
            let Data::Array(items) = &value.data else {
                reader.wrong_type(value, &here, Wanted::Selectors);
                return None;
            };
            if items.is_empty() {
                let error = SceneError::of(ReferenceError::NoSelectors { field: key.into() });
                reader.report(value.location, error.path(here));
                return None;
            }
            let sets: Vec<Option<Selector<D>>> =
                items.iter().enumerate().map(|(k, item)| one(reader, item, &format!("{here}.{k}"))).collect();
            let sets: Vec<Selector<D>> = sets.into_iter().collect::<Option<_>>()?;
            if key == "and" { Selector::And(sets) } else { Selector::Or(sets) }
        }
        "not" => Selector::Not(Box::new(one(reader, value, &here)?)),
        _ => {
            let error = SceneError::of(ReferenceError::NoSelector { word: visible(key) })
                .path(visible(&here))
                .allowed(listed(words()))
                .nearest(nearest(key, words()));
            reader.report(entries[0].location, error);
            return None;
        }
    })
}

fn fixed<const D: usize>(row: &[f64]) -> [f64; D] {
    core::array::from_fn(|a| row.get(a).copied().unwrap_or(0.0))
}

/// Refuses a selector that names nonexistent nodes or groups, or that selects nothing.
pub(crate) fn check<const D: usize>(
    reader: &mut Reader<'_>,
    location: Location,
    path: &str,
    selector: &Selector<D>,
    body: &BodyBlueprint<D>,
) -> bool {
    let Some(fault) = selector.fault(body) else { return true };
    let groups: Vec<&str> = body.mesh.groups.keys().map(String::as_str).collect();
    let closest = match &fault {
        SelectorFault::NoGroup(group) => nearest(group, groups.iter().copied()),
        _ => None,
    };
    let is_empty = fault == SelectorFault::Nothing;
    let error = SceneError::of(fault.about(body, &visible)).path(path).nearest(closest);
    if !is_empty {
        reader.report(location, error);
        return false;
    }
    let (low, high) = selection::extent(&body.mesh);
    let corner = |x: [f64; D]| {
        let x: [f64; D] = core::array::from_fn(|a| x[a] + body.translation[a]);
        format!("{x:?}")
    };
    let (low, high) = (corner(low), corner(high));
    reader.report(location, error.advice(SceneHint::Extent { low, high }));
    false
}

/// Reads and checks the selector of a table that names a body.
pub(crate) fn of_body<const D: usize>(
    reader: &mut Reader<'_>,
    table: &Node,
    path: &str,
    bodies: &Bodies<D>,
    body: Option<usize>,
) -> Option<Selector<D>> {
    let selector = of(reader, table, path)?;
    let body = bodies.list.get(body?)?;
    let location = super::location_of(table, "select");
    check(reader, location, &join(path, "select"), &selector, body).then_some(selector)
}

/// Reads the selector of a table that names one or more bodies, and checks it on each of them.
pub(crate) fn of_bodies<const D: usize>(
    reader: &mut Reader<'_>,
    table: &Node,
    path: &str,
    bodies: &Bodies<D>,
    targets: Option<Vec<(usize, [f64; D])>>,
) -> Option<Vec<(usize, Selector<D>)>> {
    let selector = of(reader, table, path)?;
    let location = super::location_of(table, "select");
    let mut out = Vec::new();
    for (body, offset) in targets? {
        let selector = selector.moved(offset);
        if !check(reader, location, &join(path, "select"), &selector, bodies.list.get(body)?) {
            return None;
        }
        out.push((body, selector));
    }
    Some(out)
}
