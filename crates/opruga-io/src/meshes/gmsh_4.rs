//! Gmsh 4.1: entities, and nodes and elements in blocks of one entity.

use super::found::{Found, Numbers};
use super::gmsh::{Context, SIZE, SYNTAX, element_type, reorder};
use super::scanner::Scanner;
use crate::problem::SceneError;

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
            let (tag, _) = short(scanner, "the number of an entity")?;
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
            context.entities.insert((dimension, tag), groups);
        }
    }
    Ok(())
}

/// `$Nodes`: blocks of numbers and then of coordinates, parametric ones behind them.
pub(super) fn nodes(scanner: &mut Scanner<'_>, found: &mut Found) -> Result<(), SceneError> {
    let blocks = count(scanner, 20, "blocks")?;
    let (promised, from) = long(scanner, "the number of nodes")?;
    scanner.fits(SIZE, promised, if scanner.binary { 32 } else { 8 }, "nodes", from)?;
    long(scanner, "the lowest number of a node")?;
    long(scanner, "the highest number of a node")?;
    line_end(scanner, "the number of nodes")?;
    for _ in 0..blocks {
        let (dimension, at) = short(scanner, "the dimension of an entity")?;
        let dimension = match usize::try_from(dimension) {
            Ok(dimension) if dimension <= 3 => dimension,
            _ => {
                let error = scanner.error(SYNTAX, format!("an entity has {dimension} dimensions"), at);
                return Err(error.value(dimension.to_string()).allowed("0 to 3"));
            }
        };
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
    Ok(())
}

/// `$Elements`: blocks of elements of one type and one entity, which knows its physical groups.
pub(super) fn elements(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers) -> Result<(), SceneError> {
    let blocks = count(scanner, 20, "blocks")?;
    let (promised, from) = long(scanner, "the number of elements")?;
    scanner.fits(SIZE, promised, if scanner.binary { 16 } else { 4 }, "elements", from)?;
    long(scanner, "the lowest number of an element")?;
    long(scanner, "the highest number of an element")?;
    line_end(scanner, "the number of elements")?;
    for _ in 0..blocks {
        short(scanner, "the dimension of an entity")?;
        let (tag, _) = short(scanner, "the number of an entity")?;
        let (kind, at) = short(scanner, "the type of elements")?;
        let kind = element_type(scanner, i64::from(kind), at)?;
        let own = count(scanner, 8 * (1 + kind.nodes() as u64), "elements")?;
        line_end(scanner, "a block of elements")?;
        let groups: Vec<String> = context
            .entities
            .get(&(kind.dimension(), tag))
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
            groups.iter().for_each(|group| context.found.join(group.clone()));
        }
    }
    if context.found.items.len() as u64 != promised {
        let there = context.found.items.len();
        let error = scanner.error(SIZE, format!("{promised} elements are promised, but {there} are there"), from);
        return Err(error.value(promised.to_string()).allowed(there.to_string()));
    }
    Ok(())
}
