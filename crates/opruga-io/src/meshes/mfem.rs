//! MFEM meshes, version 1: straight elements with attributes.
//!
//! The attributes of elements become groups of nodes and cells, for example `attribute 1`; the attributes of the boundary become groups of nodes, for
//! example `boundary 3`.
//!
//! # Source
//! MFEM project, "Mesh formats", <https://mfem.org/mesh-format-v1.0/>.

use super::errors::{Keyword, MeshFileError, ScanError};
use super::format_errors::{Counts, Geometry, MfemError};
use super::found::{Found, Kind};
use super::scanner::Scanner;
use super::terms::{ElementName, Expected};
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "mfem.syntax";
const SIZE: &str = "mfem.size";

/// Sections that may occur only once in a file.
const SECTIONS: [&str; 4] = ["dimension", "elements", "boundary", "vertices"];

/// An element that is read before the number of vertices is known.
struct Draft {
    kind: Kind,
    nodes: Vec<(u64, usize)>,
    attribute: i64,
    boundary: bool,
    offset: usize,
}

/// Reads a file.
///
/// # Errors
/// `mfem.syntax`, `mfem.size`, `mfem.curved`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    scanner.expect(SYNTAX, "MFEM")?;
    scanner.expect(SYNTAX, "mesh")?;
    let (version, from) = scanner.word(SYNTAX, Expected::Version)?;
    if !matches!(version, "v1.0" | "v1.2" | "v1.3") {
        return Err(scanner.error(MfemError::Version { version: visible(version) }, from));
    }
    let (mut drafts, mut found, mut dimension) = (Vec::new(), Found::default(), None);
    let mut seen: Vec<&str> = Vec::new();
    let mut ended = false;
    while let Some((section, from)) = scanner.peek() {
        if ended {
            return Err(scanner.error(MfemError::BehindEnd { word: visible(section) }, from));
        }
        scanner.word(SYNTAX, Expected::Section)?;
        if let Some(single) = SECTIONS.into_iter().find(|single| section == *single) {
            if seen.contains(&single) {
                return Err(scanner.error_of(SYNTAX, ScanError::SecondSection { section: single.into() }, from));
            }
            seen.push(single);
        }
        match (section, dimension) {
            ("dimension", _) => {
                let (number, at) = scanner.whole::<usize>(SYNTAX, Expected::TheDimension)?;
                if !(1..=3).contains(&number) {
                    return Err(scanner.error(MfemError::Dimension { dimension: number }, at));
                }
                dimension = Some(number);
            }
            ("elements" | "boundary" | "vertices", None) => {
                return Err(scanner.error(MfemError::BeforeDimension { section: section.into() }, from));
            }
            ("elements" | "boundary", Some(dimension)) => {
                elements(scanner, &mut drafts, dimension, section == "boundary")?;
            }
            ("vertices", Some(dimension)) => vertices(scanner, &mut found, dimension)?,
            ("mfem_mesh_end", _) => ended = true,
            ("nodes", _) => return Err(scanner.error(MfemError::Curved {}, from)),
            (other, _) => return Err(scanner.error(MfemError::Section { word: visible(other) }, from)),
        }
    }
    if let Some(missing) = ["elements", "vertices"].into_iter().find(|section| !seen.contains(section)) {
        return Err(scanner.ends(SYNTAX, Keyword::One { word: missing.into() }));
    }
    // Since version 1.2 a mark shows that the mesh is complete.
    if version != "v1.0" && !ended {
        return Err(scanner.ends(SYNTAX, Keyword::One { word: "mfem_mesh_end".into() }));
    }
    if !ended {
        scanner.last_line_ends(SYNTAX)?;
    }
    for (number, draft) in drafts.iter().enumerate() {
        let mut nodes = [0; 10];
        for (slot, &(node, at)) in nodes.iter_mut().zip(&draft.nodes) {
            if node >= found.positions.len() as u64 {
                let (vertex, most) = (node, found.positions.len().saturating_sub(1));
                return Err(match draft.boundary {
                    true => scanner.error(MfemError::NoVertexOfBoundary { vertex, most }, at),
                    false => scanner.error(MfemError::NoVertexOfElement { vertex, most }, at),
                });
            }
            *slot = node as u32;
        }
        found.item(draft.kind, &nodes[..draft.nodes.len()], number as u64, draft.offset);
        found.join(format!("{} {}", if draft.boundary { "boundary" } else { "attribute" }, draft.attribute));
    }
    Ok(found)
}

/// Reads `elements`, which have the dimension of the mesh, or the `boundary`, whose elements have one dimension less.
fn elements(
    scanner: &mut Scanner<'_>,
    drafts: &mut Vec<Draft>,
    dimension: usize,
    boundary: bool,
) -> Result<(), SceneError> {
    let wanted = dimension - usize::from(boundary);
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElements)?;
    scanner.line_end(SYNTAX, Expected::NumberOfElements)?;
    for _ in 0..scanner.fits(SIZE, count, 6, Expected::Elements, from)? {
        let (attribute, offset) = scanner.whole::<i64>(SYNTAX, Expected::Attribute)?;
        let (geometry, at) = scanner.whole::<u64>(SYNTAX, Expected::GeometryOfElement)?;
        let kind = match geometry {
            0 => Kind::Point,
            1 => Kind::Line,
            2 => Kind::Triangle,
            3 => Kind::Quadrilateral,
            4 => Kind::Tetrahedron,
            5 => Kind::Hexahedron,
            _ => {
                let element = match geometry {
                    6 => ElementName::Prism,
                    7 => ElementName::Pyramid,
                    _ => ElementName::UnknownGeometry,
                };
                return Err(scanner.error(MeshFileError::UnsupportedGeometry { element, number: geometry }, at));
            }
        };
        if kind.dimension() != wanted {
            let section = if boundary { "boundary" } else { "elements" };
            let wanted = [Geometry::Point, Geometry::Line, Geometry::Plane, Geometry::Space][wanted];
            let element = kind.name();
            return Err(
                scanner.error(MfemError::ElementOfSection { section, dimension, element, geometry, wanted }, at)
            );
        }
        let mut nodes = Vec::with_capacity(kind.nodes());
        for _ in 0..kind.nodes() {
            nodes.push(scanner.whole::<u64>(SYNTAX, Expected::VertexOfElement)?);
        }
        scanner.line_end(SYNTAX, Expected::Element)?;
        drafts.push(Draft { kind, nodes, attribute, boundary, offset });
    }
    Ok(())
}

fn vertices(scanner: &mut Scanner<'_>, found: &mut Found, least: usize) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfVertices)?;
    if scanner.peek().is_some_and(|(word, _)| word == "nodes") {
        return Ok(()); // coordinates stand in `nodes`, which is refused
    }
    let (dimension, at) = scanner.whole::<usize>(SYNTAX, Expected::NumberOfCoordinates)?;
    if !(least..=3).contains(&dimension) {
        let wanted = [Counts::OneToThree, Counts::TwoOrThree, Counts::Three][least - 1];
        return Err(scanner.error(MfemError::Coordinates { coordinates: dimension, wanted }, at));
    }
    for number in 0..scanner.fits(SIZE, count, 2 * dimension as u64, Expected::Vertices, from)? {
        scanner.peek();
        let offset = scanner.at;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, Expected::Coordinate)?;
        }
        scanner.line_end(SYNTAX, Expected::Vertex)?;
        found.node(number as u64, position, offset);
    }
    Ok(())
}
