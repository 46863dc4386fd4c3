//! Gmsh 2.2: nodes and elements, one per line, or consecutive in binary.

use super::format_errors::GmshError;
use super::found::{Found, Numbers};
use super::gmsh::{Context, SIZE, SYNTAX, element_type, reorder};
use super::scanner::Scanner;
use super::terms::Expected;
use crate::problem::SceneError;

/// `$Nodes`: number, x, y, z.
pub(super) fn nodes(scanner: &mut Scanner<'_>, found: &mut Found) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNodes)?;
    scanner.line_end(SYNTAX, Expected::NumberOfNodes)?;
    let each = if scanner.binary { 28 } else { 8 };
    for _ in 0..scanner.fits(SIZE, count, each, Expected::Nodes, from)? {
        let offset = scanner.at;
        if scanner.binary {
            let number = scanner.binary_i32(SIZE, Expected::Node)?;
            let mut position = [0.0; 3];
            for x in &mut position {
                *x = scanner.binary_f64(SIZE, Expected::Coordinate)?;
            }
            found.node(number as u64, position, offset);
        } else {
            let (number, offset) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNode)?;
            let mut position = [0.0; 3];
            for x in &mut position {
                *x = scanner.number(SYNTAX, Expected::Coordinate)?;
            }
            scanner.line_end(SYNTAX, Expected::Node)?;
            found.node(number, position, offset);
        }
    }
    Ok(())
}

/// `$Elements`: number, type, number of tags, tags (the first is the physical group), nodes.
pub(super) fn elements(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElements)?;
    scanner.line_end(SYNTAX, Expected::NumberOfElements)?;
    let count = scanner.fits(SIZE, count, if scanner.binary { 12 } else { 6 }, Expected::Elements, from)?;
    if scanner.binary {
        return binary(scanner, context, numbers, count);
    }
    for _ in 0..count {
        let (number, offset) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElement)?;
        let (kind, from) = scanner.whole::<i64>(SYNTAX, Expected::TypeOfElement)?;
        let kind = element_type(scanner, kind, from)?;
        let (tags, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfTags)?;
        let mut group = 0;
        for k in 0..scanner.fits(SIZE, tags, 2, Expected::Tags, from)? {
            let (tag, _) = scanner.whole::<i64>(SYNTAX, Expected::Tag)?;
            if k == 0 {
                group = tag;
            }
        }
        let mut nodes = [0; 10];
        for node in &mut nodes[..kind.nodes()] {
            let (named, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNode)?;
            *node = numbers.node(named, scanner, Some(number), from)?;
        }
        scanner.line_end(SYNTAX, Expected::Element)?;
        add(context, kind, &mut nodes, number, offset, group);
    }
    Ok(())
}

fn add(context: &mut Context, kind: super::found::Kind, nodes: &mut [u32; 10], number: u64, offset: usize, group: i64) {
    let nodes = &mut nodes[..kind.nodes()];
    reorder(kind, nodes);
    context.found.item(kind, nodes, number, offset);
    if group != 0 {
        let name = context.names.of(kind.dimension(), group);
        context.found.join(name);
    }
}

/// Blocks of elements of one type.
fn binary(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers, count: usize) -> Result<(), SceneError> {
    let mut read = 0;
    while read < count {
        let from = scanner.at;
        let kind = scanner.binary_i32(SIZE, Expected::BlockOfElements)?;
        let kind = element_type(scanner, i64::from(kind), from)?;
        let from = scanner.at;
        let follow = scanner.binary_i32(SIZE, Expected::NumberOfElementsOfBlock)?;
        let tags = scanner.binary_i32(SIZE, Expected::NumberOfTags)?;
        let (Ok(follow), Ok(tags)) = (u64::try_from(follow), u64::try_from(tags)) else {
            return Err(scanner.error(GmshError::NegativeBlock { elements: follow, tags }, from));
        };
        let each = 4 * (1 + tags + kind.nodes() as u64);
        let follow = scanner.fits(SIZE, follow, each, Expected::Elements, from)?;
        if follow == 0 || read + follow > count {
            return Err(scanner.error(GmshError::BlockSize { elements: follow, most: count - read }, from));
        }
        for _ in 0..follow {
            let offset = scanner.at;
            let number = scanner.binary_i32(SIZE, Expected::Element)? as u64;
            let mut group = 0;
            for k in 0..tags {
                let tag = scanner.binary_i32(SIZE, Expected::Tag)?;
                if k == 0 {
                    group = i64::from(tag);
                }
            }
            let mut nodes = [0; 10];
            for node in &mut nodes[..kind.nodes()] {
                let from = scanner.at;
                let named = scanner.binary_i32(SIZE, Expected::NodeOfElement)?;
                *node = numbers.node(named as u64, scanner, Some(number), from)?;
            }
            add(context, kind, &mut nodes, number, offset, group);
        }
        read += follow;
    }
    Ok(())
}
