//! Gmsh 2.2: nodes and elements one a line, or one after the other in binary.

use super::found::{Found, Numbers};
use super::gmsh::{Context, SIZE, SYNTAX, element_type, reorder};
use super::scanner::Scanner;
use crate::problem::SceneError;

/// `$Nodes`: number, x, y, z.
pub(super) fn nodes(scanner: &mut Scanner<'_>, found: &mut Found) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of nodes")?;
    scanner.line_end(SYNTAX, "the number of nodes")?;
    let each = if scanner.binary { 28 } else { 8 };
    for _ in 0..scanner.fits(SIZE, count, each, "nodes", from)? {
        let place = scanner.at;
        if scanner.binary {
            let number = scanner.binary_i32(SIZE, "a node")?;
            let mut position = [0.0; 3];
            for x in &mut position {
                *x = scanner.binary_f64(SIZE, "a coordinate")?;
            }
            found.node(number as u64, position, place);
        } else {
            let (number, place) = scanner.whole::<u64>(SYNTAX, "the number of a node")?;
            let mut position = [0.0; 3];
            for x in &mut position {
                *x = scanner.number(SYNTAX, "a coordinate")?;
            }
            scanner.line_end(SYNTAX, "a node")?;
            found.node(number, position, place);
        }
    }
    Ok(())
}

/// `$Elements`: number, type, number of tags, tags (the first is the physical group), nodes.
pub(super) fn elements(scanner: &mut Scanner<'_>, context: &mut Context, numbers: &Numbers) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of elements")?;
    scanner.line_end(SYNTAX, "the number of elements")?;
    let count = scanner.fits(SIZE, count, if scanner.binary { 12 } else { 6 }, "elements", from)?;
    if scanner.binary {
        return binary(scanner, context, numbers, count);
    }
    for _ in 0..count {
        let (number, place) = scanner.whole::<u64>(SYNTAX, "the number of an element")?;
        let (kind, from) = scanner.whole::<i64>(SYNTAX, "the type of an element")?;
        let kind = element_type(scanner, kind, from)?;
        let (tags, from) = scanner.whole::<u64>(SYNTAX, "the number of tags")?;
        let mut group = 0;
        for k in 0..scanner.fits(SIZE, tags, 2, "tags", from)? {
            let (tag, _) = scanner.whole::<i64>(SYNTAX, "a tag")?;
            if k == 0 {
                group = tag;
            }
        }
        let mut nodes = [0; 10];
        for node in &mut nodes[..kind.nodes()] {
            let (named, from) = scanner.whole::<u64>(SYNTAX, "the number of a node")?;
            *node = numbers.node(named, scanner, &format!("element {number}"), from)?;
        }
        scanner.line_end(SYNTAX, "an element")?;
        add(context, kind, &mut nodes, number, place, group);
    }
    Ok(())
}

fn add(context: &mut Context, kind: super::found::Kind, nodes: &mut [u32; 10], number: u64, place: usize, group: i64) {
    let nodes = &mut nodes[..kind.nodes()];
    reorder(kind, nodes);
    context.found.item(kind, nodes, number, place);
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
        let kind = scanner.binary_i32(SIZE, "a block of elements")?;
        let kind = element_type(scanner, i64::from(kind), from)?;
        let from = scanner.at;
        let follow = scanner.binary_i32(SIZE, "the number of elements of a block")?;
        let tags = scanner.binary_i32(SIZE, "the number of tags")?;
        let (Ok(follow), Ok(tags)) = (u64::try_from(follow), u64::try_from(tags)) else {
            let error = scanner.error(SIZE, "a block has a negative number of elements or tags", from);
            return Err(error.value(format!("{follow}, {tags}")).allowed("0 or more"));
        };
        let each = 4 * (1 + tags + kind.nodes() as u64);
        let follow = scanner.fits(SIZE, follow, each, "elements", from)?;
        if follow == 0 || read + follow > count {
            let error = scanner.error(SIZE, format!("a block has {follow} elements"), from);
            return Err(error.value(follow.to_string()).allowed(format!("1 to {}", count - read)));
        }
        for _ in 0..follow {
            let place = scanner.at;
            let number = scanner.binary_i32(SIZE, "an element")? as u64;
            let mut group = 0;
            for k in 0..tags {
                let tag = scanner.binary_i32(SIZE, "a tag")?;
                if k == 0 {
                    group = i64::from(tag);
                }
            }
            let mut nodes = [0; 10];
            for node in &mut nodes[..kind.nodes()] {
                let from = scanner.at;
                let named = scanner.binary_i32(SIZE, "a node of an element")?;
                *node = numbers.node(named as u64, scanner, &format!("element {number}"), from)?;
            }
            add(context, kind, &mut nodes, number, place, group);
        }
        read += follow;
    }
    Ok(())
}
