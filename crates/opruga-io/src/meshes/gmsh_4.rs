//! Gmsh 4.1: entities, and nodes and elements in blocks that each belong to one entity.

use super::errors::Listed;
use super::format_errors::GmshError;
use super::found::{Found, Numbers};
use super::gmsh::{Context, SIZE, SYNTAX, element_type, reorder};
use super::scanner::Scanner;
use super::terms::Expected;
use crate::problem::SceneError;
use std::collections::BTreeSet;

/// A whole number, of 8 bytes in binary or as a word, with its position.
fn long(scanner: &mut Scanner<'_>, what: Expected) -> Result<(u64, usize), SceneError> {
    if scanner.binary {
        let from = scanner.at;
        return Ok((scanner.binary_u64(SIZE, what)?, from));
    }
    scanner.whole(SYNTAX, what)
}

/// A whole number, of 4 bytes in binary or as a word, with its position.
fn short(scanner: &mut Scanner<'_>, what: Expected) -> Result<(i32, usize), SceneError> {
    if scanner.binary {
        let from = scanner.at;
        return Ok((scanner.binary_i32(SIZE, what)?, from));
    }
    scanner.whole(SYNTAX, what)
}

fn number(scanner: &mut Scanner<'_>, what: Expected) -> Result<f64, SceneError> {
    if scanner.binary { scanner.binary_f64(SIZE, what) } else { scanner.number(SYNTAX, what) }
}

/// The end of a line in a text file; nothing in binary.
fn line_end(scanner: &mut Scanner<'_>, of: Expected) -> Result<(), SceneError> {
    if scanner.binary { Ok(()) } else { scanner.line_end(SYNTAX, of) }
}

/// The dimension of an entity, with its position.
fn dimension(scanner: &mut Scanner<'_>) -> Result<(usize, usize), SceneError> {
    let (dimension, at) = short(scanner, Expected::DimensionOfEntity)?;
    match usize::try_from(dimension) {
        Ok(dimension) if dimension <= 3 => Ok((dimension, at)),
        _ => Err(scanner.error(GmshError::EntityDimension { dimension }, at)),
    }
}

/// Reads a count of items that each take at least `bytes` bytes in binary, or two in a text. The last argument names the count and the counted items.
fn count(scanner: &mut Scanner<'_>, bytes: u64, [number, what]: [Expected; 2]) -> Result<usize, SceneError> {
    let (count, from) = long(scanner, number)?;
    scanner.fits(SIZE, count, if scanner.binary { bytes } else { 2 }, what, from)
}

/// `$Entities`: points, curves, surfaces and volumes with their physical groups.
pub(super) fn entities(scanner: &mut Scanner<'_>, context: &mut Context) -> Result<(), SceneError> {
    let mut counts = [0; 4];
    for (dimension, slot) in counts.iter_mut().enumerate() {
        *slot = count(scanner, if dimension == 0 { 36 } else { 68 }, [Expected::NumberOfEntities, Expected::Entities])?;
    }
    for (dimension, of) in counts.into_iter().enumerate() {
        for _ in 0..of {
            let (tag, at) = short(scanner, Expected::NumberOfEntity)?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                number(scanner, Expected::CoordinateOfEntity)?;
            }
            let mut groups = Vec::new();
            for _ in 0..count(scanner, 4, [Expected::NumberOfPhysicalGroups, Expected::PhysicalGroups])? {
                groups.push(i64::from(short(scanner, Expected::PhysicalGroup)?.0));
            }
            if dimension > 0 {
                for _ in 0..count(scanner, 4, [Expected::NumberOfBoundingEntities, Expected::BoundingEntities])? {
                    short(scanner, Expected::BoundingEntity)?;
                }
            }
            line_end(scanner, Expected::Entity)?;
            if context.entities.insert((dimension, tag), groups).is_some() {
                return Err(scanner.error(GmshError::EntityTwice { dimension, entity: tag }, at));
            }
        }
    }
    Ok(())
}

/// The lowest and the highest number that the file announces, with the position of the first.
fn bounds(scanner: &mut Scanner<'_>, [low, high]: [Expected; 2]) -> Result<([u64; 2], usize), SceneError> {
    let (lowest, from) = long(scanner, low)?;
    let (highest, _) = long(scanner, high)?;
    Ok(([lowest, highest], from))
}

/// Refuses numbers if the lowest and the highest of them are not the announced ones. Numbers between these may be missing.
fn within(
    scanner: &Scanner<'_>,
    ([lowest, highest], from): ([u64; 2], usize),
    numbers: impl Iterator<Item = u64>,
    what: Expected,
) -> Result<(), SceneError> {
    let there = numbers
        .fold(None, |bounds: Option<[u64; 2]>, n| Some(bounds.map_or([n, n], |[low, high]| [low.min(n), high.max(n)])));
    let Some([low, high]) = there.filter(|there| *there != [lowest, highest]) else { return Ok(()) };
    Err(scanner.error(GmshError::Bounds { what, lowest, highest, low, high }, from))
}

/// `$Nodes`: blocks of numbers followed by coordinates and, if present, parametric coordinates.
pub(super) fn nodes(scanner: &mut Scanner<'_>, found: &mut Found) -> Result<Numbers, SceneError> {
    let blocks = count(scanner, 20, [Expected::NumberOfBlocks, Expected::Blocks])?;
    let (promised, from) = long(scanner, Expected::NumberOfNodes)?;
    scanner.fits(SIZE, promised, if scanner.binary { 32 } else { 8 }, Expected::Nodes, from)?;
    let bounds = bounds(scanner, [Expected::LowestNode, Expected::HighestNode])?;
    line_end(scanner, Expected::NumberOfNodes)?;
    for _ in 0..blocks {
        let (dimension, _) = self::dimension(scanner)?;
        short(scanner, Expected::NumberOfEntity)?;
        let (parametric, at) = short(scanner, Expected::ZeroOrOne)?;
        if !(0..=1).contains(&parametric) {
            return Err(scanner.error(GmshError::Parametric { parametric }, at));
        }
        let more = if parametric == 1 { dimension } else { 0 };
        let own = count(scanner, 32 + 8 * more as u64, [Expected::NumberOfNodes, Expected::Nodes])?;
        line_end(scanner, Expected::BlockOfNodes)?;
        let first = found.node_numbers.len();
        for _ in 0..own {
            let (name, offset) = long(scanner, Expected::NumberOfNode)?;
            line_end(scanner, Expected::NumberOfNode)?;
            found.node(name, [0.0; 3], offset);
        }
        for node in first..first + own {
            for axis in 0..3 {
                found.positions[node][axis] = number(scanner, Expected::Coordinate)?;
            }
            for _ in 0..more {
                number(scanner, Expected::ParametricCoordinate)?;
            }
            line_end(scanner, Expected::Node)?;
        }
    }
    let there = found.positions.len();
    if there as u64 != promised {
        return Err(scanner.error(GmshError::Promised { promised, what: Expected::Nodes, there }, from));
    }
    let numbers = Numbers::of(found, scanner)?;
    within(scanner, bounds, found.node_numbers.iter().copied(), Expected::Nodes)?;
    Ok(numbers)
}

/// `$Elements`: blocks of elements of one type and one entity. The entity determines the physical groups of the elements.
pub(super) fn elements(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers) -> Result<(), SceneError> {
    let blocks = count(scanner, 20, [Expected::NumberOfBlocks, Expected::Blocks])?;
    let (promised, from) = long(scanner, Expected::NumberOfElements)?;
    scanner.fits(SIZE, promised, if scanner.binary { 16 } else { 4 }, Expected::Elements, from)?;
    let bounds = bounds(scanner, [Expected::LowestElement, Expected::HighestElement])?;
    line_end(scanner, Expected::NumberOfElements)?;
    for _ in 0..blocks {
        let (dimension, at) = self::dimension(scanner)?;
        let (tag, at_tag) = short(scanner, Expected::NumberOfEntity)?;
        let (kind, at_kind) = short(scanner, Expected::TypeOfElements)?;
        let kind = element_type(scanner, i64::from(kind), at_kind)?;
        if dimension != kind.dimension() {
            let (element, wanted) = (kind.name(), kind.dimension());
            return Err(scanner.error(GmshError::ElementOfEntity { dimension, element, wanted }, at));
        }
        // A partitioned mesh has entities of its own, in a section that is skipped.
        if context.listed && !context.divided && !context.entities.contains_key(&(dimension, tag)) {
            let tags: Vec<i32> = context.entities.keys().filter(|key| key.0 == dimension).map(|key| key.1).collect();
            let listed = match tags[..] {
                [] => Listed::NoEntities { dimension },
                [entity] => Listed::Entity { entity },
                [first, .., last] => Listed::Entities { count: tags.len(), first, last },
            };
            return Err(scanner.error(GmshError::NoEntity { entity: tag, dimension, listed }, at_tag));
        }
        let own = count(scanner, 8 * (1 + kind.nodes() as u64), [Expected::NumberOfElements, Expected::Elements])?;
        line_end(scanner, Expected::BlockOfElements)?;
        let first = context.found.items.len();
        let entity = context.entities.get(&(kind.dimension(), tag)).filter(|_| own > 0);
        let groups: BTreeSet<String> = entity
            .into_iter()
            .flatten()
            // The sign of a group gives the orientation of its curves and surfaces.
            .map(|group| context.names.of(kind.dimension(), group.abs()))
            .collect();
        for _ in 0..own {
            let (name, offset) = long(scanner, Expected::NumberOfElement)?;
            let mut nodes = [0; 10];
            for node in &mut nodes[..kind.nodes()] {
                let (named, at) = long(scanner, Expected::NumberOfNode)?;
                *node = numbers.node(named, scanner, Some(name), at)?;
            }
            line_end(scanner, Expected::Element)?;
            let nodes = &mut nodes[..kind.nodes()];
            reorder(kind, nodes);
            context.found.item(kind, nodes, name, offset);
        }
        context.found.join_all(&groups, first).map_err(|e| scanner.at(e, at_tag))?;
    }
    let there = context.found.items.len();
    if there as u64 != promised {
        return Err(scanner.error(GmshError::Promised { promised, what: Expected::Elements, there }, from));
    }
    context.found.distinct_elements(scanner)?;
    within(scanner, bounds, context.found.items.iter().map(|item| item.number), Expected::Elements)
}
