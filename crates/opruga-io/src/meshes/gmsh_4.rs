//! Gmsh 4.1: entities, and nodes and elements in blocks of one entity.

use super::found::{Found, Numbers};
use super::gmsh::{Context, SIZE, SYNTAX, element_type, reorder};
use super::scanner::Scanner;
use crate::problem::SceneError;
use std::collections::BTreeSet;

/// A whole number of 8 bytes in binary, or a word; with its place.
fn long(scanner: &mut Scanner<'_>, what: &str) -> Result<(u64, usize), SceneError> {
    if scanner.binary {
        let from = scanner.at;
        return Ok((scanner.binary_u64(SIZE, what)?, from));
    }
    scanner.whole(SYNTAX, what)
}

/// A whole number of 4 bytes in binary, or a word; with its place.
fn short(scanner: &mut Scanner<'_>, what: &str) -> Result<(i32, usize), SceneError> {
    if scanner.binary {
        let from = scanner.at;
        return Ok((scanner.binary_i32(SIZE, what)?, from));
    }
    scanner.whole(SYNTAX, what)
}

fn number(scanner: &mut Scanner<'_>, what: &str) -> Result<f64, SceneError> {
    if scanner.binary { scanner.binary_f64(SIZE, what) } else { scanner.number(SYNTAX, what) }
}

/// The end of a line of a text; nothing in binary.
fn line_end(scanner: &mut Scanner<'_>, of: &str) -> Result<(), SceneError> {
    if scanner.binary { Ok(()) } else { scanner.line_end(SYNTAX, of) }
}

/// The dimension of an entity, with its place.
fn dimension(scanner: &mut Scanner<'_>) -> Result<(usize, usize), SceneError> {
    let (dimension, at) = short(scanner, "the dimension of an entity")?;
    match usize::try_from(dimension) {
        Ok(dimension) if dimension <= 3 => Ok((dimension, at)),
        _ => {
            let error = scanner.error(SYNTAX, format!("an entity has {dimension} dimensions"), at);
            Err(error.value(dimension.to_string()).allowed("0 to 3"))
        }
    }
}

/// A count of things that take so many bytes in binary, and two in a text.
fn count(scanner: &mut Scanner<'_>, bytes: u64, what: &str) -> Result<usize, SceneError> {
    let (count, from) = long(scanner, &format!("the number of {what}"))?;
    scanner.fits(SIZE, count, if scanner.binary { bytes } else { 2 }, what, from)
}

/// `$Entities`: points, curves, surfaces and volumes with their physical groups.
pub(super) fn entities(scanner: &mut Scanner<'_>, context: &mut Context) -> Result<(), SceneError> {
    let mut counts = [0; 4];
    for (dimension, slot) in counts.iter_mut().enumerate() {
        *slot = count(scanner, if dimension == 0 { 36 } else { 68 }, "entities")?;
    }
    for (dimension, of) in counts.into_iter().enumerate() {
        for _ in 0..of {
            let (tag, at) = short(scanner, "the number of an entity")?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                number(scanner, "a coordinate of an entity")?;
            }
            let mut groups = Vec::new();
            for _ in 0..count(scanner, 4, "physical groups")? {
                groups.push(i64::from(short(scanner, "a physical group")?.0));
            }
            if dimension > 0 {
                for _ in 0..count(scanner, 4, "bounding entities")? {
                    short(scanner, "a bounding entity")?;
                }
            }
            line_end(scanner, "an entity")?;
            if context.entities.insert((dimension, tag), groups).is_some() {
                let message = format!("two entities of {dimension} dimensions have the number {tag}");
                let error = scanner.error(SYNTAX, message, at).value(tag.to_string());
                return Err(error.allowed("a number of its own for every entity of a dimension"));
            }
        }
    }
    Ok(())
}

/// The lowest and the highest number that the file promises, with the place of the first.
fn bounds(scanner: &mut Scanner<'_>, of: &str) -> Result<([u64; 2], usize), SceneError> {
    let (lowest, from) = long(scanner, &format!("the lowest number of {of}"))?;
    let (highest, _) = long(scanner, &format!("the highest number of {of}"))?;
    Ok(([lowest, highest], from))
}

/// Refuses numbers whose lowest and highest are not the promised ones. Those between may be left out.
fn within(
    scanner: &Scanner<'_>,
    ([lowest, highest], from): ([u64; 2], usize),
    numbers: impl Iterator<Item = u64>,
    what: &str,
) -> Result<(), SceneError> {
    let there = numbers
        .fold(None, |bounds: Option<[u64; 2]>, n| Some(bounds.map_or([n, n], |[low, high]| [low.min(n), high.max(n)])));
    let Some([low, high]) = there.filter(|there| *there != [lowest, highest]) else { return Ok(()) };
    let message =
        format!("numbers of {what} from {lowest} to {highest} are promised, but those from {low} to {high} are there");
    let error = scanner.error(SIZE, message, from).value(format!("{lowest}, {highest}"));
    Err(error
        .allowed(format!("{low}, {high}"))
        .hint("the head of the section is wrong, or what it tells of is missing"))
}

/// `$Nodes`: blocks of numbers and then of coordinates, parametric ones behind them.
pub(super) fn nodes(scanner: &mut Scanner<'_>, found: &mut Found) -> Result<Numbers, SceneError> {
    let blocks = count(scanner, 20, "blocks")?;
    let (promised, from) = long(scanner, "the number of nodes")?;
    scanner.fits(SIZE, promised, if scanner.binary { 32 } else { 8 }, "nodes", from)?;
    let bounds = bounds(scanner, "a node")?;
    line_end(scanner, "the number of nodes")?;
    for _ in 0..blocks {
        let (dimension, _) = self::dimension(scanner)?;
        short(scanner, "the number of an entity")?;
        let (parametric, at) = short(scanner, "0 or 1")?;
        if !(0..=1).contains(&parametric) {
            let error = scanner.error(SYNTAX, format!("nodes are parametric or not, but not {parametric}"), at);
            return Err(error.value(parametric.to_string()).allowed("0 or 1"));
        }
        let more = if parametric == 1 { dimension } else { 0 };
        let own = count(scanner, 32 + 8 * more as u64, "nodes")?;
        line_end(scanner, "a block of nodes")?;
        let first = found.node_numbers.len();
        for _ in 0..own {
            let (name, place) = long(scanner, "the number of a node")?;
            line_end(scanner, "the number of a node")?;
            found.node(name, [0.0; 3], place);
        }
        for node in first..first + own {
            for axis in 0..3 {
                found.positions[node][axis] = number(scanner, "a coordinate")?;
            }
            for _ in 0..more {
                number(scanner, "a parametric coordinate")?;
            }
            line_end(scanner, "a node")?;
        }
    }
    if found.positions.len() as u64 != promised {
        let error = scanner.error(
            SIZE,
            format!("{promised} nodes are promised, but {} are there", found.positions.len()),
            from,
        );
        return Err(error.value(promised.to_string()).allowed(found.positions.len().to_string()));
    }
    let numbers = Numbers::of(found, scanner)?;
    within(scanner, bounds, found.node_numbers.iter().copied(), "nodes")?;
    Ok(numbers)
}

/// `$Elements`: blocks of elements of one type and one entity, which knows its physical groups.
pub(super) fn elements(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers) -> Result<(), SceneError> {
    let blocks = count(scanner, 20, "blocks")?;
    let (promised, from) = long(scanner, "the number of elements")?;
    scanner.fits(SIZE, promised, if scanner.binary { 16 } else { 4 }, "elements", from)?;
    let bounds = bounds(scanner, "an element")?;
    line_end(scanner, "the number of elements")?;
    for _ in 0..blocks {
        let (dimension, at) = self::dimension(scanner)?;
        let (tag, at_tag) = short(scanner, "the number of an entity")?;
        let (kind, at_kind) = short(scanner, "the type of elements")?;
        let kind = element_type(scanner, i64::from(kind), at_kind)?;
        if dimension != kind.dimension() {
            let message = format!("an entity of {dimension} dimensions has elements of the kind {}", kind.name());
            let error = scanner.error(SYNTAX, message, at);
            return Err(error.value(dimension.to_string()).allowed(kind.dimension().to_string()));
        }
        // Parts of a mesh that is divided have entities of their own, in a section that is left out.
        if context.listed && !context.divided && !context.entities.contains_key(&(dimension, tag)) {
            let tags: Vec<i32> = context.entities.keys().filter(|key| key.0 == dimension).map(|key| key.1).collect();
            let allowed = match &tags[..] {
                [] => format!("$Entities lists none of {dimension} dimensions"),
                [only] => only.to_string(),
                [first, .., last] => format!("one of the {} listed from {first} to {last}", tags.len()),
            };
            let message = format!("$Entities lists no entity {tag} of {dimension} dimensions");
            return Err(scanner.error("mesh.index", message, at_tag).value(tag.to_string()).allowed(allowed));
        }
        let own = count(scanner, 8 * (1 + kind.nodes() as u64), "elements")?;
        line_end(scanner, "a block of elements")?;
        let first = context.found.items.len();
        let entity = context.entities.get(&(kind.dimension(), tag)).filter(|_| own > 0);
        let groups: BTreeSet<String> = entity
            .into_iter()
            .flatten()
            // The sign of a group tells the direction of its curves and surfaces.
            .map(|group| context.names.of(kind.dimension(), group.abs()))
            .collect();
        for _ in 0..own {
            let (name, place) = long(scanner, "the number of an element")?;
            let mut nodes = [0; 10];
            for node in &mut nodes[..kind.nodes()] {
                let (named, at) = long(scanner, "the number of a node")?;
                *node = numbers.node(named, scanner, &format!("element {name}"), at)?;
            }
            line_end(scanner, "an element")?;
            let nodes = &mut nodes[..kind.nodes()];
            reorder(kind, nodes);
            context.found.item(kind, nodes, name, place);
        }
        context.found.join_all(&groups, first).map_err(|e| scanner.at(e, at_tag))?;
    }
    if context.found.items.len() as u64 != promised {
        let there = context.found.items.len();
        let error = scanner.error(SIZE, format!("{promised} elements are promised, but {there} are there"), from);
        return Err(error.value(promised.to_string()).allowed(there.to_string()));
    }
    context.found.distinct_elements(scanner)?;
    within(scanner, bounds, context.found.items.iter().map(|item| item.number), "elements")
}
