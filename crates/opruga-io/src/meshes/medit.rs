//! Medit (INRIA), `.mesh` as text: vertices and elements with references.
//!
//! References other than 0 become groups. For example, `tetrahedron 2` is a group of nodes and cells, and `triangle 3`, `edge 1` and `vertex 4` are
//! groups of nodes.
//!
//! # Source
//! P. Frey, "Medit: an interactive mesh visualization software", INRIA RT-0253 (2001), section "File formats"; L. Maréchal, libMeshb.

use super::errors::{MeshFileError, MeshFileNotice, ScanError};
use super::format_errors::MeditError;
use super::found::{Found, Kind};
use super::scanner::Scanner;
use super::terms::{ElementName, Expected};
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "medit.syntax";
const SIZE: &str = "medit.size";

/// Reads a file.
///
/// # Errors
/// `medit.syntax`, `medit.size`, `medit.version`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    scanner.expect(SYNTAX, "MeshVersionFormatted")?;
    let (version, from) = scanner.whole::<u32>(SYNTAX, Expected::Version)?;
    // Versions 1 and 2 have single and double precision, and versions 3 and 4 are for larger files. As text they look the same.
    if !(1..=4).contains(&version) {
        return Err(scanner.error(MeditError::Version { version }, from));
    }
    let (mut found, mut dimension, mut seen) = (Found::default(), 0, false);
    let mut kinds = Vec::new();
    loop {
        // The keyword End is required: without it, a truncated file would look complete.
        let (word, from) = scanner.word(SYNTAX, Expected::End)?;
        let kind = match word {
            "End" => break,
            "Dimension" if dimension > 0 => {
                return Err(scanner.error_of(SYNTAX, ScanError::SecondSection { section: word.into() }, from));
            }
            "Dimension" => {
                let (number, at) = scanner.whole::<usize>(SYNTAX, Expected::TheDimension)?;
                if number != 2 && number != 3 {
                    return Err(scanner.error(MeditError::Dimension { dimension: number }, at));
                }
                dimension = number;
                continue;
            }
            "Vertices" if dimension > 0 && !seen => {
                vertices(scanner, &mut found, dimension)?;
                seen = true;
                continue;
            }
            "Vertices" => {
                let error = if seen { MeditError::VerticesTwice {} } else { MeditError::VerticesFirst {} };
                return Err(scanner.error(error, from));
            }
            "Edges" => Kind::Line,
            "Triangles" => Kind::Triangle,
            "Quadrilaterals" => Kind::Quadrilateral,
            "Tetrahedra" => Kind::Tetrahedron,
            "Hexahedra" | "Hexaedra" => Kind::Hexahedron,
            // These sections are not part of a body. Each is a count followed by that many lines.
            "Corners"
            | "RequiredVertices"
            | "Ridges"
            | "RequiredEdges"
            | "RequiredTriangles"
            | "RequiredQuadrilaterals"
            | "Normals"
            | "NormalAtVertices"
            | "Tangents"
            | "TangentAtVertices" => {
                let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::Count)?;
                scanner.line_end(SYNTAX, Expected::Count)?;
                for _ in 0..scanner.fits(SIZE, count, 2, Expected::Lines, from)? {
                    scanner.word(SYNTAX, Expected::Number)?;
                    scanner.line();
                }
                found.left_out(MeshFileNotice::Lines { count, section: word.into() });
                continue;
            }
            "Pyramids" | "Prisms" | "Pentahedra" | "EdgesP2" | "TrianglesP2" | "QuadrilateralsQ2" | "TetrahedraP2"
            | "HexahedraQ2" => {
                let keyword = word.to_string();
                return Err(match word.ends_with("P2") || word.ends_with("Q2") {
                    true => scanner.error(MeditError::Quadratic { keyword }, from),
                    false => scanner.error(MeditError::Unsupported { keyword }, from),
                });
            }
            other => return Err(scanner.error(MeditError::Keyword { word: visible(other) }, from)),
        };
        if !seen {
            return Err(scanner.error(MeditError::BeforeVertices { section: word.into() }, from));
        }
        if kinds.contains(&kind) {
            return Err(scanner.error_of(SYNTAX, ScanError::SecondSection { section: word.into() }, from));
        }
        kinds.push(kind);
        elements(scanner, &mut found, kind)?;
    }
    if let Some((word, from)) = scanner.peek() {
        return Err(scanner.error(MeditError::BehindEnd { word: visible(word) }, from));
    }
    Ok(found)
}

fn vertices(scanner: &mut Scanner<'_>, found: &mut Found, dimension: usize) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfVertices)?;
    for node in 0..scanner.fits(SIZE, count, 2 * (dimension as u64 + 1), Expected::Vertices, from)? {
        scanner.peek();
        let offset = scanner.at;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, Expected::Coordinate)?;
        }
        let (reference, _) = scanner.whole::<i64>(SYNTAX, Expected::ReferenceOfVertex)?;
        scanner.line_end(SYNTAX, Expected::Vertex)?;
        found.node(node as u64 + 1, position, offset);
        if reference != 0 {
            found.node_groups.entry(format!("vertex {reference}")).or_default().push(node as u32);
        }
    }
    Ok(())
}

fn elements(scanner: &mut Scanner<'_>, found: &mut Found, kind: Kind) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfElements)?;
    let nodes = found.positions.len() as u64;
    let element = if kind == Kind::Line { ElementName::Edge } else { kind.name() };
    for number in 0..scanner.fits(SIZE, count, 2 * (kind.nodes() as u64 + 1), Expected::Elements, from)? {
        scanner.peek();
        let offset = scanner.at;
        let mut own = [0; 8];
        for slot in &mut own[..kind.nodes()] {
            let (node, at) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfVertex)?;
            if !(1..=nodes).contains(&node) {
                let (index, least, most) = (number + 1, 1, nodes);
                return Err(scanner.error(MeshFileError::NoVertex { element, index, vertex: node, least, most }, at));
            }
            *slot = (node - 1) as u32;
        }
        let (reference, _) = scanner.whole::<i64>(SYNTAX, Expected::ReferenceOfElement)?;
        scanner.line_end(SYNTAX, Expected::Element)?;
        found.item(kind, &own[..kind.nodes()], number as u64 + 1, offset);
        if reference != 0 {
            found.join(format!("{element} {reference}"));
        }
    }
    Ok(())
}
