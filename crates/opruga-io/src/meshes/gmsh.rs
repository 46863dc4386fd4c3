//! Gmsh, versions 2.2 and 4.1, as text or as bytes of either order: sections, names of groups, values of elements and nodes.
//!
//! Physical groups become groups. Groups of points, curves and surfaces become groups of nodes; groups of the elements that fill the body become
//! groups of nodes and of cells. A group without a name is named after its dimension and number, for example `curve 3`. `$ElementData` with one
//! component becomes a value of cells; `$NodeData` with up to three components becomes a value of nodes.
//!
//! # Source
//! C. Geuzaine, J.-F. Remacle, Gmsh reference manual, "MSH file format" and "Legacy formats".

use super::errors::{Keyword, MeshFileError, MeshFileNotice};
use super::format_errors::GmshError;
use super::found::{Found, Kind, Numbers, is_kept};
use super::scanner::Scanner;
use super::terms::{ElementName, Expected};
use super::{gmsh_2, gmsh_4};
use crate::problem::{SceneError, visible};
use opruga_mesh::NodeValues;
use std::collections::BTreeMap;

pub(super) const SYNTAX: &str = "msh.syntax";
pub(super) const SIZE: &str = "msh.size";

/// Names of physical groups, by dimension and number.
#[derive(Debug, Default)]
pub(super) struct Names(BTreeMap<(usize, i64), String>);

impl Names {
    pub(super) fn of(&self, dimension: usize, number: i64) -> String {
        match self.0.get(&(dimension, number)) {
            Some(name) => name.clone(),
            None => format!("{} {number}", ["point", "curve", "surface", "volume"][dimension.min(3)]),
        }
    }
}

/// State that the sections share.
#[derive(Debug, Default)]
pub(super) struct Context {
    pub(super) found: Found,
    pub(super) names: Names,
    /// Physical groups of entities, by dimension and number (version 4.1).
    pub(super) entities: BTreeMap<(usize, i32), Vec<i64>>,
    /// Whether the file has a section that lists entities, and a section that lists entities of partitions.
    pub(super) listed: bool,
    pub(super) divided: bool,
    /// How often values of the same name occurred again, for example those of later steps.
    later: BTreeMap<String, u64>,
    /// The numbers of elements in ascending order, with their indices in the list; computed when a value is first looked up.
    order: Vec<(u64, usize)>,
}

/// Reads a file.
///
/// # Errors
/// `msh.syntax`, `msh.size`, `msh.version` with the line or byte; `mesh.…` for faults of the elements.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let modern = format(scanner)?;
    let mut context = Context::default();
    let mut numbers: Option<Numbers> = None;
    let mut elements = false;
    while let Some((word, from)) = scanner.peek() {
        let Some(section) = word.strip_prefix('$') else {
            return Err(scanner.error(GmshError::BetweenSections { word: visible(word) }, from));
        };
        let (section, _) = (section.to_string(), scanner.line());
        match section.as_str() {
            // If these sections came after the elements, they would have no effect on them.
            "PhysicalNames" | "Entities" if elements && (modern || section == "PhysicalNames") => {
                return Err(scanner.error(GmshError::BehindElements { section }, from));
            }
            "PhysicalNames" => physical_names(scanner, &mut context.names)?,
            "Entities" if modern && !context.listed => {
                gmsh_4::entities(scanner, &mut context)?;
                context.listed = true;
            }
            "Nodes" if numbers.is_none() => {
                numbers = Some(if modern {
                    gmsh_4::nodes(scanner, &mut context.found)?
                } else {
                    gmsh_2::nodes(scanner, &mut context.found)?;
                    Numbers::of(&context.found, scanner)?
                });
            }
            "Elements" if !elements => {
                let Some(numbers) = &numbers else {
                    return Err(scanner.error(GmshError::ElementsFirst {}, from));
                };
                if modern {
                    gmsh_4::elements(scanner, &mut context, numbers)?;
                } else {
                    gmsh_2::elements(scanner, &mut context, numbers)?;
                    context.found.distinct_elements(scanner)?;
                }
                elements = true;
            }
            "ElementData" if elements => data(scanner, &mut context, None)?,
            "NodeData" if numbers.is_some() => data(scanner, &mut context, numbers.as_ref())?,
            "Nodes" | "Elements" | "Entities" if modern || section != "Entities" => {
                return Err(scanner.error(GmshError::SecondSection { section }, from));
            }
            other => {
                context.divided |= other == "PartitionedEntities";
                skip(scanner, other, from, &mut context.found)?;
            }
        }
        scanner.expect(SYNTAX, &format!("$End{section}"))?;
    }
    if !elements {
        let word = if numbers.is_some() { "$Elements" } else { "$Nodes" };
        return Err(scanner.ends(SYNTAX, Keyword::One { word: word.into() }));
    }
    for (name, count) in &context.later {
        context.found.left_out(MeshFileNotice::LaterSteps { count: *count, name: visible(name) });
    }
    Ok(context.found)
}

/// Reads `$MeshFormat` and returns whether it is version 4.1. The scanner then knows whether numbers are binary, and their byte order.
fn format(scanner: &mut Scanner<'_>) -> Result<bool, SceneError> {
    scanner.expect(SYNTAX, "$MeshFormat")?;
    let (version, from) = scanner.word(SYNTAX, Expected::Version)?;
    let modern = match version {
        "2" | "2.0" | "2.1" | "2.2" => false,
        "4.1" => true,
        _ => return Err(scanner.error(GmshError::Version { version: visible(version) }, from)),
    };
    let (kind, from) = scanner.whole::<u32>(SYNTAX, Expected::FileKind)?;
    if kind > 1 {
        return Err(scanner.error(GmshError::FileKind { kind }, from));
    }
    let (size, from) = scanner.whole::<u32>(SYNTAX, Expected::SizeOfNumbers)?;
    if size != 8 {
        return Err(scanner.error(GmshError::NumberSize { size }, from));
    }
    scanner.line_end(SYNTAX, Expected::Format)?;
    if kind == 1 {
        scanner.binary = true;
        let from = scanner.at;
        match scanner.binary_i32(SYNTAX, Expected::One)? {
            1 => {}
            0x0100_0000 => scanner.big_endian = true,
            number => return Err(scanner.error(GmshError::Endianness { number }, from)),
        }
    }
    scanner.expect(SYNTAX, "$EndMeshFormat")?;
    Ok(modern)
}

/// Reads `$PhysicalNames`, which is text in all files. Names may contain blanks.
fn physical_names(scanner: &mut Scanner<'_>, names: &mut Names) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfNames)?;
    let count = scanner.fits(SIZE, count, 6, Expected::Names, from)?;
    for _ in 0..count {
        let (dimension, from) = scanner.whole::<usize>(SYNTAX, Expected::Dimension)?;
        if dimension > 3 {
            return Err(scanner.error(GmshError::GroupDimension { dimension }, from));
        }
        let (number, at) = scanner.whole::<i64>(SYNTAX, Expected::NumberOfGroup)?;
        let (text, from) = scanner.line();
        let Some(name) = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).filter(|name| !name.is_empty())
        else {
            return Err(scanner.error(GmshError::GroupQuotes { text: visible(&text) }, from));
        };
        if let Some(first) = names.0.insert((dimension, number), name.to_string()) {
            return Err(scanner.error(GmshError::GroupTwice { group: number, dimension, name: visible(&first) }, at));
        }
    }
    Ok(())
}

/// Skips a section that is irrelevant for a body at rest.
fn skip(scanner: &mut Scanner<'_>, section: &str, from: usize, found: &mut Found) -> Result<(), SceneError> {
    let end = format!("$End{section}");
    let offset = scanner.bytes[scanner.at..].windows(end.len()).position(|window| window == end.as_bytes());
    let Some(offset) = offset else {
        return Err(scanner.error(GmshError::NoEnd { section: visible(section) }, from));
    };
    scanner.at += offset;
    if section != "Comments" {
        found.left_out(MeshFileNotice::Section { section: visible(section) });
    }
    Ok(())
}

/// Reads `$ElementData`, which has a number for all or some elements, or `$NodeData`, which has a number or a vector for nodes. `nodes` gives the
/// numbers of the nodes for `$NodeData`.
fn data(scanner: &mut Scanner<'_>, context: &mut Context, nodes: Option<&Numbers>) -> Result<(), SceneError> {
    let found = &mut context.found;
    let (section, number_of, there) = match nodes {
        Some(_) => ("NodeData", Expected::NumberOfNode, found.positions.len()),
        None => ("ElementData", Expected::NumberOfElement, found.items.len()),
    };
    let start = scanner.at;
    let (texts, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfTexts)?;
    let texts = scanner.fits(SIZE, texts, 2, Expected::Texts, from)?;
    scanner.line_end(SYNTAX, Expected::NumberOfTexts)?;
    let mut name = String::new();
    for k in 0..texts {
        let text = scanner.line().0;
        if k == 0 {
            name = text.trim_matches('"').to_string();
        }
    }
    let (reals, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfRealTags)?;
    for _ in 0..scanner.fits(SIZE, reals, 2, Expected::RealTags, from)? {
        scanner.number(SYNTAX, Expected::RealTag)?;
    }
    let (wholes, from) = scanner.whole::<u64>(SYNTAX, Expected::NumberOfWholeTags)?;
    let mut tags = Vec::new();
    for _ in 0..scanner.fits(SIZE, wholes, 2, Expected::WholeTags, from)? {
        tags.push(scanner.whole::<u64>(SYNTAX, Expected::WholeTag)?);
    }
    let (Some(&(components, _)), Some(&(count, from))) = (tags.get(1), tags.get(2)) else {
        return Err(scanner.error(GmshError::FewTags { tags: tags.len() }, from));
    };
    if components != 1 && !(nodes.is_some() && is_kept(components)) {
        found.left_out(MeshFileNotice::Components { components, name: visible(&name) });
        scanner.at = start;
        let end = format!("$End{section}");
        let offset = scanner.bytes[start..].windows(end.len()).position(|window| window == end.as_bytes());
        return match offset {
            Some(offset) => {
                scanner.at += offset;
                Ok(())
            }
            None => Err(scanner.ends(SYNTAX, Keyword::One { word: end })),
        };
    }
    let width = components as usize;
    scanner.line_end(SYNTAX, Expected::CountOfValues)?;
    if nodes.is_none() && context.order.len() != there {
        context.order = found.items.iter().zip(0..).map(|(item, k)| (item.number, k)).collect();
        context.order.sort_unstable();
    }
    let order = &context.order;
    // Missing values take memory, too.
    found.gives(there * width).map_err(|e| scanner.at(e, from))?;
    let mut values = vec![f64::NAN; there * width];
    for _ in 0..scanner.fits(SIZE, count, 2 + 2 * components, Expected::Values, from)? {
        if !scanner.binary {
            scanner.peek();
        }
        let offset = scanner.at;
        let number = if scanner.binary {
            scanner.binary_i32(SIZE, number_of)? as u64
        } else {
            scanner.whole::<u64>(SYNTAX, number_of)?.0
        };
        let at = match nodes {
            Some(nodes) => nodes.node(number, scanner, None, offset)? as usize,
            None => match order.binary_search_by_key(&number, |entry| entry.0) {
                Ok(at) => order[at].1,
                Err(_) => return Err(scanner.error(GmshError::NoElement { element: number }, offset)),
            },
        };
        let row = &mut values[at * width..(at + 1) * width];
        if !row[0].is_nan() {
            let twice = match nodes {
                Some(_) => GmshError::NodeValueTwice { node: number },
                None => GmshError::ElementValueTwice { element: number },
            };
            return Err(scanner.error(twice, offset));
        }
        for slot in row {
            *slot = if scanner.binary {
                scanner.binary_f64(SIZE, Expected::Value)?
            } else {
                scanner.number(SYNTAX, Expected::Value)?
            };
        }
    }
    // A body at rest has one value, that of the first step.
    let known = match nodes {
        Some(_) => found.node_values.contains_key(&name),
        None => found.item_values.contains_key(&name),
    };
    if known {
        *context.later.entry(name).or_default() += 1;
    } else if nodes.is_some() {
        found.node_values.insert(name, NodeValues { components: width, values });
    } else {
        found.item_values.insert(name, values);
    }
    Ok(())
}

/// Returns the kind of element with a type number.
///
/// # Errors
/// `mesh.unsupported_element` with name and number.
pub(super) fn element_type(scanner: &Scanner<'_>, number: i64, offset: usize) -> Result<Kind, SceneError> {
    use ElementName as Name;
    let element = match number {
        1 => return Ok(Kind::Line),
        2 => return Ok(Kind::Triangle),
        3 => return Ok(Kind::Quadrilateral),
        4 => return Ok(Kind::Tetrahedron),
        5 => return Ok(Kind::Hexahedron),
        8 => return Ok(Kind::QuadraticLine),
        9 => return Ok(Kind::QuadraticTriangle),
        11 => return Ok(Kind::QuadraticTetrahedron),
        15 => return Ok(Kind::Point),
        6 => Name::Prism,
        7 => Name::Pyramid,
        10 => Name::QuadraticQuadrilateral,
        12 => Name::QuadraticHexahedron,
        13 => Name::QuadraticPrism,
        14 => Name::QuadraticPyramid,
        16 => Name::SerendipityQuadrilateral,
        17 => Name::SerendipityHexahedron,
        18 => Name::SerendipityPrism,
        19 => Name::SerendipityPyramid,
        20 | 22 | 24 => Name::IncompleteTriangle,
        21 => Name::CubicTriangle,
        23 => Name::Triangle4,
        25 => Name::Triangle5,
        26 => Name::CubicLine,
        27 => Name::Line4,
        28 => Name::Line5,
        29 => Name::CubicTetrahedron,
        30 => Name::Tetrahedron4,
        31 => Name::Tetrahedron5,
        92 => Name::CubicHexahedron,
        _ => Name::UnknownType,
    };
    Err(scanner.error(MeshFileError::UnsupportedType { element, number }, offset))
}

/// Brings the nodes of an element into the order of Opruga: Gmsh lists the midpoints of edges 2–3 and 1–3 the other way round.
pub(super) fn reorder(kind: Kind, nodes: &mut [u32]) {
    if kind == Kind::QuadraticTetrahedron {
        nodes.swap(8, 9);
    }
}
