//! TetGen: nodes in `.node` and tetrahedra in `.ele`, two files with the same name.
//!
//! Boundary markers other than 0 become groups of nodes, for example `marker 3`; attributes of tetrahedra become values of cells, `attribute`,
//! `attribute 2` …
//!
//! # Source
//! Hang Si, TetGen manual 1.5, "File formats".

use super::errors::MeshFileNotice;
use super::format_errors::TetgenError;
use super::found::{Found, Kind, Numbers};
use super::scanner::Scanner;
use super::terms::Expected;
use crate::problem::SceneError;

const SYNTAX: &str = "tetgen.syntax";
const SIZE: &str = "tetgen.size";

/// Reads the nodes.
///
/// # Errors
/// `tetgen.syntax`, `tetgen.size` with the line.
pub(super) fn nodes(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let mut found = Found::default();
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNodes)?;
    let (dimension, at) = scanner.whole::<usize>(SYNTAX, Expected::TheDimension)?;
    if dimension != 2 && dimension != 3 {
        return Err(scanner.error(TetgenError::Coordinates { coordinates: dimension }, at));
    }
    let (attributes, _) = scanner.whole::<usize>(SYNTAX, Expected::NumberOfAttributes)?;
    let (markers, at) = scanner.whole::<usize>(SYNTAX, Expected::NumberOfMarkers)?;
    if markers > 1 {
        return Err(scanner.error(TetgenError::Markers { markers }, at));
    }
    scanner.line_end(SYNTAX, Expected::Head)?;
    for _ in 0..scanner.fits(SIZE, count, 2 * (1 + dimension as u64), Expected::Nodes, from)? {
        let (number, offset) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNode)?;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, Expected::Coordinate)?;
        }
        for _ in 0..attributes {
            scanner.number(SYNTAX, Expected::Attribute)?;
        }
        if markers == 1 {
            let (marker, _) = scanner.whole::<i64>(SYNTAX, Expected::Marker)?;
            if marker != 0 {
                let node = found.positions.len() as u32;
                found.node_groups.entry(format!("marker {marker}")).or_default().push(node);
            }
        }
        scanner.line_end(SYNTAX, Expected::Node)?;
        found.node(number, position, offset);
    }
    if attributes > 0 {
        found.left_out(MeshFileNotice::Attributes { count: attributes });
    }
    nothing_behind(scanner)?;
    Ok(found)
}

/// Reads the tetrahedra or, for plane meshes (of the program Triangle), the triangles.
///
/// # Errors
/// `tetgen.syntax`, `tetgen.size`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn elements(scanner: &mut Scanner<'_>, found: &mut Found, numbers: &Numbers) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElements)?;
    let (corners, at) = scanner.whole::<usize>(SYNTAX, Expected::NumberOfNodesOfElement)?;
    let kind = match corners {
        3 => Kind::Triangle,
        4 => Kind::Tetrahedron,
        _ => return Err(scanner.error(TetgenError::Corners { nodes: corners }, at)),
    };
    let (attributes, _) = scanner.whole::<usize>(SYNTAX, Expected::NumberOfAttributes)?;
    scanner.line_end(SYNTAX, Expected::Head)?;
    let count = scanner.fits(SIZE, count, 2 * (1 + corners as u64), Expected::Elements, from)?;
    let mut values: Vec<Vec<f64>> = Vec::new();
    let mut next: Option<u64> = None;
    for k in 0..count {
        let (number, offset) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElement)?;
        // Elements are numbered consecutively. Another number means that lines are missing, repeated or out of order.
        if let Some(wanted) = next.filter(|next| number != *next) {
            return Err(scanner.error(TetgenError::Order { element: number, wanted }, offset));
        }
        next = Some(number.saturating_add(1));
        let mut nodes = [0; 4];
        for node in &mut nodes[..corners] {
            let (named, at) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNode)?;
            *node = numbers.node(named, scanner, Some(number), at)?;
        }
        for attribute in 0..attributes {
            let value = scanner.number(SYNTAX, Expected::Attribute)?;
            if values.len() == attribute {
                values.push(Vec::new());
            }
            values[attribute].resize(k, f64::NAN);
            values[attribute].push(value);
        }
        scanner.line_end(SYNTAX, Expected::Element)?;
        found.item(kind, &nodes[..corners], number, offset);
    }
    for (attribute, values) in values.into_iter().enumerate() {
        let name = if attribute == 0 { "attribute".to_string() } else { format!("attribute {}", attribute + 1) };
        found.item_values.insert(name, values);
    }
    nothing_behind(scanner)
}

fn nothing_behind(scanner: &mut Scanner<'_>) -> Result<(), SceneError> {
    if scanner.is_done() {
        return scanner.last_line_ends(SYNTAX);
    }
    Err(scanner.error(TetgenError::Behind {}, scanner.at))
}
