//! Medit (INRIA), `.mesh` as text: vertices and elements with references.
//!
//! References other than 0 become groups: `tetrahedron 2` of nodes and cells, `triangle 3`, `edge 1` and `vertex 4` of nodes.
//!
//! # Source
//! P. Frey, "Medit: an interactive mesh visualization software", INRIA RT-0253 (2001), section "File formats"; L. Maréchal, libMeshb.

use super::found::{Found, Kind};
use super::scanner::Scanner;
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "medit.syntax";
const SIZE: &str = "medit.size";

const SECOND_ORDER: &str = "triangles of 6 nodes and tetrahedra of 10 are read from Gmsh and VTK files";

/// Reads a file.
///
/// # Errors
/// `medit.syntax`, `medit.size`, `medit.version`, `mesh.index`, `mesh.unsupported_element` with the line.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    scanner.expect(SYNTAX, "MeshVersionFormatted")?;
    let (version, from) = scanner.whole::<u32>(SYNTAX, "the version")?;
    // 1 and 2 are single and double precision, 3 and 4 larger files: as text they look the same.
    if !(1..=4).contains(&version) {
        let error = scanner.error("medit.version", format!("version `{version}` cannot be read"), from);
        return Err(error.value(version.to_string()).allowed("1 to 4"));
    }
    let (mut found, mut dimension, mut seen) = (Found::default(), 0, false);
    let mut kinds = Vec::new();
    loop {
        // The keyword End is asked for: without it a file that is cut off would look whole.
        let (word, from) = scanner.word(SYNTAX, "`End`")?;
        let kind = match word {
            "End" => break,
            "Dimension" if dimension > 0 => {
                let error = scanner.error(SYNTAX, format!("there is a second section `{word}`"), from);
                return Err(error.value(visible(word)).allowed("one"));
            }
            "Dimension" => {
                let (number, at) = scanner.whole::<usize>(SYNTAX, "the dimension")?;
                if number != 2 && number != 3 {
                    let error = scanner.error(SYNTAX, format!("the dimension is {number}"), at);
                    return Err(error.value(number.to_string()).allowed("2 or 3"));
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
                let what = if seen { "there are vertices twice" } else { "the vertices come before the dimension" };
                return Err(scanner
                    .error(SYNTAX, what, from)
                    .value("Vertices")
                    .allowed("Dimension, then Vertices once"));
            }
            "Edges" => Kind::Line,
            "Triangles" => Kind::Triangle,
            "Quadrilaterals" => Kind::Quadrilateral,
            "Tetrahedra" => Kind::Tetrahedron,
            "Hexahedra" | "Hexaedra" => Kind::Hexahedron,
            // What these say is no part of a body; each is a count and that many lines.
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
                let (count, from) = scanner.whole::<u64>(SYNTAX, "a count")?;
                scanner.line_end(SYNTAX, "a count")?;
                for _ in 0..scanner.fits(SIZE, count, 2, "lines", from)? {
                    scanner.word(SYNTAX, "a number")?;
                    scanner.line();
                }
                found.left_out(format!("{count} {} are left out", visible(word)), count.to_string());
                continue;
            }
            "Pyramids" | "Prisms" | "Pentahedra" | "EdgesP2" | "TrianglesP2" | "QuadrilateralsQ2" | "TetrahedraP2"
            | "HexahedraQ2" => {
                let error = scanner.error("mesh.unsupported_element", format!("{word} cannot be read"), from);
                let error = error.value(word).allowed("Edges, Triangles, Quadrilaterals, Tetrahedra, Hexahedra");
                let is_quadratic = word.ends_with("P2") || word.ends_with("Q2");
                return Err(if is_quadratic { error.hint(SECOND_ORDER) } else { error });
            }
            other => {
                let error = scanner.error(SYNTAX, format!("`{}` is no keyword that can be read", visible(other)), from);
                return Err(error.value(visible(other)).allowed("Dimension, Vertices, Triangles, Tetrahedra … or End"));
            }
        };
        if !seen {
            let error = scanner.error(SYNTAX, format!("{word} come before the vertices"), from);
            return Err(error.value(visible(word)).allowed("Vertices"));
        }
        if kinds.contains(&kind) {
            let error = scanner.error(SYNTAX, format!("there is a second section `{word}`"), from);
            return Err(error.value(visible(word)).allowed("one"));
        }
        kinds.push(kind);
        elements(scanner, &mut found, kind)?;
    }
    if let Some((word, from)) = scanner.peek() {
        let error = scanner.error(SYNTAX, "something follows `End`", from);
        return Err(error.value(visible(word)).allowed("the end of the file"));
    }
    Ok(found)
}

fn vertices(scanner: &mut Scanner<'_>, found: &mut Found, dimension: usize) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of vertices")?;
    for node in 0..scanner.fits(SIZE, count, 2 * (dimension as u64 + 1), "vertices", from)? {
        scanner.peek();
        let place = scanner.at;
        let mut position = [0.0; 3];
        for x in &mut position[..dimension] {
            *x = scanner.number(SYNTAX, "a coordinate")?;
        }
        let (reference, _) = scanner.whole::<i64>(SYNTAX, "the reference of a vertex")?;
        scanner.line_end(SYNTAX, "a vertex")?;
        found.node(node as u64 + 1, position, place);
        if reference != 0 {
            found.node_groups.entry(format!("vertex {reference}")).or_default().push(node as u32);
        }
    }
    Ok(())
}

fn elements(scanner: &mut Scanner<'_>, found: &mut Found, kind: Kind) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of elements")?;
    let nodes = found.positions.len() as u64;
    let name = if kind == Kind::Line { "edge" } else { kind.name() };
    for number in 0..scanner.fits(SIZE, count, 2 * (kind.nodes() as u64 + 1), "elements", from)? {
        scanner.peek();
        let place = scanner.at;
        let mut own = [0; 8];
        for slot in &mut own[..kind.nodes()] {
            let (node, at) = scanner.whole::<u64>(SYNTAX, "the number of a vertex")?;
            if !(1..=nodes).contains(&node) {
                let error = scanner.error("mesh.index", format!("{name} {} names vertex {node}", number + 1), at);
                return Err(error.value(node.to_string()).allowed(format!("1 to {nodes}")));
            }
            *slot = (node - 1) as u32;
        }
        let (reference, _) = scanner.whole::<i64>(SYNTAX, "the reference of an element")?;
        scanner.line_end(SYNTAX, "an element")?;
        found.item(kind, &own[..kind.nodes()], number as u64 + 1, place);
        if reference != 0 {
            found.join(format!("{name} {reference}"));
        }
    }
    Ok(())
}
