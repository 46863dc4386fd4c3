//! TetGen: nodes in `.node`, tetrahedra in `.ele`, of one name.
//!
//! Boundary markers other than 0 become groups of nodes, `marker 3`; attributes of tetrahedra become values of cells, `attribute`, `attribute 2` …
//!
//! # Source
//! Hang Si, TetGen manual 1.5, "File formats".

use super::found::{Found, Kind, Numbers};
use super::scanner::Scanner;
use crate::problem::SceneError;
use opruga_math::words::counted;

const SYNTAX: &str = "tetgen.syntax";
const SIZE: &str = "tetgen.size";

/// Reads the nodes.
///
/// # Errors
/// `tetgen.syntax`, `tetgen.size` with the line.
pub(super) fn nodes(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let mut found = Found::default();
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of nodes")?;
    let (dimension, at) = scanner.whole::<usize>(SYNTAX, "the dimension")?;
    if dimension != 2 && dimension != 3 {
        let error = scanner.error(SYNTAX, format!("nodes have {dimension} coordinates"), at);
        return Err(error.value(dimension.to_string()).allowed("2 or 3"));
    }
    let (attributes, _) = scanner.whole::<usize>(SYNTAX, "the number of attributes")?;
    let (markers, at) = scanner.whole::<usize>(SYNTAX, "the number of markers")?;
    if markers > 1 {
        let error = scanner.error(SYNTAX, format!("nodes have {markers} markers"), at);
        return Err(error.value(markers.to_string()).allowed("0 or 1"));
    }
    scanner.line_end(SYNTAX, "the head")?;
    for _ in 0..scanner.fits(SIZE, count, 2 * (1 + dimension as u64), "nodes", from)? {
        let (number, place) = scanner.whole::<u64>(SYNTAX, "the number of a node")?;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, "a coordinate")?;
        }
        for _ in 0..attributes {
            scanner.number(SYNTAX, "an attribute")?;
        }
        if markers == 1 {
            let (marker, _) = scanner.whole::<i64>(SYNTAX, "a marker")?;
            if marker != 0 {
                let node = found.positions.len() as u32;
                found.node_groups.entry(format!("marker {marker}")).or_default().push(node);
            }
        }
        scanner.line_end(SYNTAX, "a node")?;
        found.node(number, position, place);
    }
    if attributes > 0 {
        let what = counted(attributes as u64, "attribute of every node is", "attributes of every node are");
        found.left_out(format!("{what} left out"), attributes.to_string());
    }
    nothing_behind(scanner)?;
    Ok(found)
}

/// Reads the tetrahedra; of plane meshes (the program Triangle) the triangles.
///
/// # Errors
/// `tetgen.syntax`, `tetgen.size`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn elements(scanner: &mut Scanner<'_>, found: &mut Found, numbers: &Numbers) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of elements")?;
    let (corners, at) = scanner.whole::<usize>(SYNTAX, "the number of nodes of an element")?;
    let kind = match corners {
        3 => Kind::Triangle,
        4 => Kind::Tetrahedron,
        _ => {
            let error = scanner.error("mesh.unsupported_element", format!("elements have {corners} nodes"), at);
            let error = error.value(corners.to_string()).allowed("4 (tetrahedra) or 3 (triangles)");
            return Err(error.hint("TetGen writes linear tetrahedra without the option -o2"));
        }
    };
    let (attributes, _) = scanner.whole::<usize>(SYNTAX, "the number of attributes")?;
    scanner.line_end(SYNTAX, "the head")?;
    let count = scanner.fits(SIZE, count, 2 * (1 + corners as u64), "elements", from)?;
    let mut values: Vec<Vec<f64>> = Vec::new();
    let mut next: Option<u64> = None;
    for k in 0..count {
        let (number, place) = scanner.whole::<u64>(SYNTAX, "the number of an element")?;
        // Elements are counted: another number says that lines are missing, twice there or out of order.
        if let Some(next) = next.filter(|next| number != *next) {
            let error = scanner.error(SYNTAX, format!("element {number} stands where element {next} should"), place);
            return Err(error.value(number.to_string()).allowed(next.to_string()));
        }
        next = Some(number.saturating_add(1));
        let mut nodes = [0; 4];
        for node in &mut nodes[..corners] {
            let (named, at) = scanner.whole::<u64>(SYNTAX, "the number of a node")?;
            *node = numbers.node(named, scanner, &format!("element {number}"), at)?;
        }
        for attribute in 0..attributes {
            let value = scanner.number(SYNTAX, "an attribute")?;
            if values.len() == attribute {
                values.push(Vec::new());
            }
            values[attribute].resize(k, f64::NAN);
            values[attribute].push(value);
        }
        scanner.line_end(SYNTAX, "an element")?;
        found.item(kind, &nodes[..corners], number, place);
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
    let at = scanner.at;
    let error = scanner.error(SIZE, "the file goes on behind what its head promises", at);
    Err(error.value("more lines").allowed("as many lines as promised"))
}
