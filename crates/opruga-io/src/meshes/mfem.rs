//! MFEM meshes, version 1: straight elements with attributes.
//!
//! Attributes of elements become groups of nodes and cells, `attribute 1`; those of the boundary groups of nodes, `boundary 3`.
//!
//! # Source
//! MFEM project, "Mesh formats", <https://mfem.org/mesh-format-v1.0/>.

use super::found::{Found, Kind, SUPPORTED, one};
use super::scanner::Scanner;
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "mfem.syntax";
const SIZE: &str = "mfem.size";

/// Sections of which a file has one.
const SECTIONS: [&str; 4] = ["dimension", "elements", "boundary", "vertices"];

/// An element before the number of vertices is known.
struct Draft {
    kind: Kind,
    nodes: Vec<(u64, usize)>,
    attribute: i64,
    boundary: bool,
    place: usize,
}

/// Reads a file.
///
/// # Errors
/// `mfem.syntax`, `mfem.size`, `mfem.curved`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    scanner.expect(SYNTAX, "MFEM")?;
    scanner.expect(SYNTAX, "mesh")?;
    let (version, from) = scanner.word(SYNTAX, "the version")?;
    if !matches!(version, "v1.0" | "v1.2" | "v1.3") {
        let error = scanner.error("mfem.version", format!("version `{}` cannot be read", visible(version)), from);
        return Err(error.value(visible(version)).allowed("v1.0, v1.2, v1.3"));
    }
    let (mut drafts, mut found, mut dimension) = (Vec::new(), Found::default(), None);
    let mut seen: Vec<&str> = Vec::new();
    let mut ended = false;
    while let Some((section, from)) = scanner.peek() {
        if ended {
            let error = scanner.error(SYNTAX, "something follows `mfem_mesh_end`", from);
            return Err(error.value(visible(section)).allowed("the end of the file"));
        }
        scanner.word(SYNTAX, "a section")?;
        if let Some(single) = SECTIONS.into_iter().find(|single| section == *single) {
            if seen.contains(&single) {
                let error = scanner.error(SYNTAX, format!("there is a second section `{single}`"), from);
                return Err(error.value(single).allowed("one"));
            }
            seen.push(single);
        }
        match (section, dimension) {
            ("dimension", _) => {
                let (number, at) = scanner.whole::<usize>(SYNTAX, "the dimension")?;
                if !(1..=3).contains(&number) {
                    let error = scanner.error(SYNTAX, format!("the dimension is {number}"), at);
                    return Err(error.value(number.to_string()).allowed("1, 2 or 3"));
                }
                dimension = Some(number);
            }
            ("elements" | "boundary" | "vertices", None) => {
                let error = scanner.error(SYNTAX, format!("`{section}` stands before `dimension`"), from);
                return Err(error.value(section).allowed("dimension"));
            }
            ("elements" | "boundary", Some(dimension)) => {
                elements(scanner, &mut drafts, dimension, section == "boundary")?;
            }
            ("vertices", Some(dimension)) => vertices(scanner, &mut found, dimension)?,
            ("mfem_mesh_end", _) => ended = true,
            ("nodes", _) => {
                let error = scanner.error("mfem.curved", "curved elements (`nodes`) cannot be read", from);
                let hint = "save the mesh without `nodes`, its sides straight; curved cells of second order can be read from Gmsh and VTK files";
                return Err(error.value("nodes").allowed("`vertices` with coordinates").hint(hint));
            }
            (other, _) => {
                let error = scanner.error(SYNTAX, format!("`{}` is no section that can be read", visible(other)), from);
                return Err(error.value(visible(other)).allowed("dimension, elements, boundary, vertices"));
            }
        }
    }
    if let Some(missing) = ["elements", "vertices"].into_iter().find(|section| !seen.contains(section)) {
        return Err(scanner.ends(SYNTAX, &format!("`{missing}`")));
    }
    // Since version 1.2 a mark tells that the mesh is whole.
    if version != "v1.0" && !ended {
        return Err(scanner.ends(SYNTAX, "`mfem_mesh_end`"));
    }
    if !ended {
        scanner.last_line_ends(SYNTAX)?;
    }
    for (number, draft) in drafts.iter().enumerate() {
        let mut nodes = [0; 10];
        for (slot, &(node, at)) in nodes.iter_mut().zip(&draft.nodes) {
            if node >= found.positions.len() as u64 {
                let what = if draft.boundary { "a boundary element" } else { "an element" };
                let error = scanner.error("mesh.index", format!("{what} names vertex {node}"), at);
                let allowed = format!("0 to {}", found.positions.len().saturating_sub(1));
                return Err(error.value(node.to_string()).allowed(allowed));
            }
            *slot = node as u32;
        }
        found.item(draft.kind, &nodes[..draft.nodes.len()], number as u64, draft.place);
        found.join(format!("{} {}", if draft.boundary { "boundary" } else { "attribute" }, draft.attribute));
    }
    Ok(found)
}

/// `elements` fill a mesh of so many dimensions, those of its `boundary` have one less.
fn elements(
    scanner: &mut Scanner<'_>,
    drafts: &mut Vec<Draft>,
    dimension: usize,
    boundary: bool,
) -> Result<(), SceneError> {
    let wanted = dimension - usize::from(boundary);
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of elements")?;
    scanner.line_end(SYNTAX, "the number of elements")?;
    for _ in 0..scanner.fits(SIZE, count, 6, "elements", from)? {
        let (attribute, place) = scanner.whole::<i64>(SYNTAX, "an attribute")?;
        let (geometry, at) = scanner.whole::<u64>(SYNTAX, "the geometry of an element")?;
        let kind = match geometry {
            0 => Kind::Point,
            1 => Kind::Line,
            2 => Kind::Triangle,
            3 => Kind::Quadrilateral,
            4 => Kind::Tetrahedron,
            5 => Kind::Hexahedron,
            _ => {
                let name = match geometry {
                    6 => "prism",
                    7 => "pyramid",
                    _ => "element of an unknown geometry",
                };
                let message = format!("{} (geometry {geometry}) cannot be read", one(name));
                let error = scanner.error("mesh.unsupported_element", message, at);
                return Err(error.value(geometry.to_string()).allowed(SUPPORTED));
            }
        };
        if kind.dimension() != wanted {
            let section = if boundary { "boundary" } else { "elements" };
            let message =
                format!("`{section}` of a mesh of {dimension} dimensions has elements of the kind {}", kind.name());
            let allowed =
                ["0 (point)", "1 (line)", "2 (triangle) or 3 (quadrilateral)", "4 (tetrahedron) or 5 (hexahedron)"];
            let error = scanner.error("mesh.mixed_dimension", message, at).value(geometry.to_string());
            return Err(error.allowed(allowed[wanted]));
        }
        let mut nodes = Vec::with_capacity(kind.nodes());
        for _ in 0..kind.nodes() {
            nodes.push(scanner.whole::<u64>(SYNTAX, "a vertex of an element")?);
        }
        scanner.line_end(SYNTAX, "an element")?;
        drafts.push(Draft { kind, nodes, attribute, boundary, place });
    }
    Ok(())
}

fn vertices(scanner: &mut Scanner<'_>, found: &mut Found, least: usize) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of vertices")?;
    if scanner.peek().is_some_and(|(word, _)| word == "nodes") {
        return Ok(()); // coordinates stand in `nodes`, which is refused
    }
    let (dimension, at) = scanner.whole::<usize>(SYNTAX, "the number of coordinates")?;
    if !(least..=3).contains(&dimension) {
        let error = scanner.error(SYNTAX, format!("vertices have {dimension} coordinates"), at);
        let allowed = ["1, 2 or 3", "2 or 3", "3"][least - 1];
        return Err(error.value(dimension.to_string()).allowed(allowed));
    }
    for number in 0..scanner.fits(SIZE, count, 2 * dimension as u64, "vertices", from)? {
        scanner.peek();
        let place = scanner.at;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, "a coordinate")?;
        }
        scanner.line_end(SYNTAX, "a vertex")?;
        found.node(number as u64, position, place);
    }
    Ok(())
}
