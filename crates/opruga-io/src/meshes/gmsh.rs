//! Gmsh, versions 2.2 and 4.1, as text or as bytes of either order: sections, names of groups, values of elements and nodes.
//!
//! Physical groups become groups: those of points, curves and surfaces of nodes, those of what fills the body of nodes and of cells. A group without a
//! name is called after its dimension and number: `curve 3`. `$ElementData` of one component becomes a value of cells, `$NodeData` of up to three a value of nodes.
//!
//! # Source
//! C. Geuzaine, J.-F. Remacle, Gmsh reference manual, "MSH file format" and "Legacy formats".

use super::found::{Found, Kind, Numbers, SUPPORTED, is_kept, one};
use super::scanner::Scanner;
use super::{gmsh_2, gmsh_4};
use crate::problem::{SceneError, visible};
use opruga_math::words::counted;
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

/// What the sections share.
#[derive(Debug, Default)]
pub(super) struct Context {
    pub(super) found: Found,
    pub(super) names: Names,
    /// Physical groups of entities, by dimension and number (version 4.1).
    pub(super) entities: BTreeMap<(usize, i32), Vec<i64>>,
    /// Whether the file has a section that lists entities, and one that lists those of parts.
    pub(super) listed: bool,
    pub(super) divided: bool,
    /// How often values of a name came again, as those of later steps do.
    later: BTreeMap<String, u64>,
    /// The numbers of elements, ascending, with their places in the list; made where values are first looked for.
    order: Vec<(u64, usize)>,
}

/// Reads a file.
///
/// # Errors
/// `msh.syntax`, `msh.size`, `msh.version` with the line or byte; `mesh.…` for what the elements say.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let modern = format(scanner)?;
    let mut context = Context::default();
    let mut numbers: Option<Numbers> = None;
    let mut elements = false;
    while let Some((word, from)) = scanner.peek() {
        let Some(section) = word.strip_prefix('$') else {
            let error = scanner.error(SYNTAX, format!("`{}` stands between sections", visible(word)), from);
            return Err(error.value(visible(word)).allowed("a section such as $Nodes"));
        };
        let (section, _) = (section.to_string(), scanner.line());
        match section.as_str() {
            // What comes behind the elements would no longer be theirs.
            "PhysicalNames" | "Entities" if elements && (modern || section == "PhysicalNames") => {
                let error = scanner.error(SYNTAX, format!("the section ${section} comes behind the elements"), from);
                return Err(error.value(format!("${section}")).allowed("before $Elements"));
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
                    let error = scanner.error(SYNTAX, "the elements come before the nodes", from);
                    return Err(error.value("$Elements").allowed("$Nodes"));
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
                let error = scanner.error(SYNTAX, format!("there is a second section ${section}"), from);
                return Err(error.value(format!("${section}")).allowed("one"));
            }
            other => {
                context.divided |= other == "PartitionedEntities";
                skip(scanner, other, from, &mut context.found)?;
            }
        }
        scanner.expect(SYNTAX, &format!("$End{section}"))?;
    }
    if !elements {
        return Err(scanner.ends(SYNTAX, if numbers.is_some() { "`$Elements`" } else { "`$Nodes`" }));
    }
    for (name, count) in &context.later {
        let what = counted(*count, "later step is", "later steps are");
        context.found.left_out(format!("{what} left out of the values `{}`", visible(name)), count.to_string());
    }
    Ok(context.found)
}

/// `$MeshFormat`: whether it is version 4.1; the scanner knows afterwards whether numbers are binary, and their order.
fn format(scanner: &mut Scanner<'_>) -> Result<bool, SceneError> {
    scanner.expect(SYNTAX, "$MeshFormat")?;
    let (version, from) = scanner.word(SYNTAX, "the version")?;
    let modern = match version {
        "2" | "2.0" | "2.1" | "2.2" => false,
        "4.1" => true,
        _ => {
            let error = scanner.error("msh.version", format!("version `{}` cannot be read", visible(version)), from);
            let error = error.value(visible(version)).allowed("2.2 or 4.1");
            return Err(error.hint("Gmsh writes another version with `-format msh41` or `-format msh22`"));
        }
    };
    let (kind, from) = scanner.whole::<u32>(SYNTAX, "the kind of file, 0 or 1")?;
    if kind > 1 {
        let error = scanner.error(SYNTAX, format!("{kind} is no kind of file"), from);
        return Err(error.value(kind.to_string()).allowed("0 (text) or 1 (binary)"));
    }
    let (size, from) = scanner.whole::<u32>(SYNTAX, "the size of numbers")?;
    if size != 8 {
        let error = scanner.error("msh.version", format!("numbers have {size} bytes"), from);
        return Err(error.value(size.to_string()).allowed("8"));
    }
    scanner.line_end(SYNTAX, "the format")?;
    if kind == 1 {
        scanner.binary = true;
        let from = scanner.at;
        match scanner.binary_i32(SYNTAX, "the number 1")? {
            1 => {}
            0x0100_0000 => scanner.big_endian = true,
            other => {
                let error = scanner.error("msh.endianness", format!("{other} stands where 1 should"), from);
                return Err(error.value(other.to_string()).allowed("1, in the order of the file's bytes"));
            }
        }
    }
    scanner.expect(SYNTAX, "$EndMeshFormat")?;
    Ok(modern)
}

/// `$PhysicalNames`: a text in all files. Names may hold blanks.
fn physical_names(scanner: &mut Scanner<'_>, names: &mut Names) -> Result<(), SceneError> {
    let (count, from) = scanner.whole::<u64>(SYNTAX, "the number of names")?;
    let count = scanner.fits(SIZE, count, 6, "names", from)?;
    for _ in 0..count {
        let (dimension, from) = scanner.whole::<usize>(SYNTAX, "a dimension")?;
        if dimension > 3 {
            let error = scanner.error(SYNTAX, format!("a group has {dimension} dimensions"), from);
            return Err(error.value(dimension.to_string()).allowed("0 to 3"));
        }
        let (number, at) = scanner.whole::<i64>(SYNTAX, "the number of a group")?;
        let (text, from) = scanner.line();
        let Some(name) = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).filter(|name| !name.is_empty())
        else {
            let error = scanner.error(SYNTAX, "the name of a group does not stand in quotes", from);
            return Err(error.value(visible(&text)).allowed("\"name\""));
        };
        if let Some(first) = names.0.insert((dimension, number), name.to_string()) {
            let message =
                format!("group {number} of {dimension} dimensions has the name `{}` already", visible(&first));
            let error = scanner.error(SYNTAX, message, at).value(number.to_string());
            return Err(error.allowed("one name for every group of a dimension"));
        }
    }
    Ok(())
}

/// Passes over a section that says nothing about a body at rest.
fn skip(scanner: &mut Scanner<'_>, section: &str, from: usize, found: &mut Found) -> Result<(), SceneError> {
    let end = format!("$End{section}");
    let place = scanner.bytes[scanner.at..].windows(end.len()).position(|window| window == end.as_bytes());
    let Some(place) = place else {
        let error = scanner.error(SYNTAX, format!("the section ${} has no end", visible(section)), from);
        return Err(error.value(visible(&format!("${section}"))).allowed(visible(&end)).hint("the file is cut off"));
    };
    scanner.at += place;
    if section != "Comments" {
        found.left_out(format!("the section ${} is left out", visible(section)), visible(section));
    }
    Ok(())
}

/// `$ElementData`, a number for every element or for some; `$NodeData`, a number or a vector of nodes, whose numbers are given then.
fn data(scanner: &mut Scanner<'_>, context: &mut Context, nodes: Option<&Numbers>) -> Result<(), SceneError> {
    let found = &mut context.found;
    let (section, number_of, there) = match nodes {
        Some(_) => ("NodeData", "the number of a node", found.positions.len()),
        None => ("ElementData", "the number of an element", found.items.len()),
    };
    let start = scanner.at;
    let (texts, from) = scanner.whole::<u64>(SYNTAX, "the number of texts")?;
    let texts = scanner.fits(SIZE, texts, 2, "texts", from)?;
    scanner.line_end(SYNTAX, "the number of texts")?;
    let mut name = String::new();
    for k in 0..texts {
        let text = scanner.line().0;
        if k == 0 {
            name = text.trim_matches('"').to_string();
        }
    }
    let (reals, from) = scanner.whole::<u64>(SYNTAX, "the number of real tags")?;
    for _ in 0..scanner.fits(SIZE, reals, 2, "real tags", from)? {
        scanner.number(SYNTAX, "a real tag")?;
    }
    let (wholes, from) = scanner.whole::<u64>(SYNTAX, "the number of whole tags")?;
    let mut tags = Vec::new();
    for _ in 0..scanner.fits(SIZE, wholes, 2, "whole tags", from)? {
        tags.push(scanner.whole::<u64>(SYNTAX, "a whole tag")?);
    }
    let (Some(&(components, _)), Some(&(count, from))) = (tags.get(1), tags.get(2)) else {
        let error = scanner.error(SYNTAX, "step, components and count of values are missing", from);
        return Err(error.value(tags.len().to_string()).allowed("3 whole tags or more"));
    };
    if components != 1 && !(nodes.is_some() && is_kept(components)) {
        found.left_out(
            format!("values of {components} components are left out: `{}`", visible(&name)),
            components.to_string(),
        );
        scanner.at = start;
        let end = format!("$End{section}");
        let place = scanner.bytes[start..].windows(end.len()).position(|window| window == end.as_bytes());
        return match place {
            Some(place) => {
                scanner.at += place;
                Ok(())
            }
            None => Err(scanner.ends(SYNTAX, &format!("`{end}`"))),
        };
    }
    let width = components as usize;
    scanner.line_end(SYNTAX, "the count of values")?;
    if nodes.is_none() && context.order.len() != there {
        context.order = found.items.iter().zip(0..).map(|(item, k)| (item.number, k)).collect();
        context.order.sort_unstable();
    }
    let order = &context.order;
    // What has no value takes room too.
    found.gives(there * width).map_err(|e| scanner.at(e, from))?;
    let mut values = vec![f64::NAN; there * width];
    for _ in 0..scanner.fits(SIZE, count, 2 + 2 * components, "values", from)? {
        if !scanner.binary {
            scanner.peek();
        }
        let place = scanner.at;
        let number = if scanner.binary {
            scanner.binary_i32(SIZE, number_of)? as u64
        } else {
            scanner.whole::<u64>(SYNTAX, number_of)?.0
        };
        let at = match nodes {
            Some(nodes) => nodes.node(number, scanner, "a value", place)? as usize,
            None => match order.binary_search_by_key(&number, |entry| entry.0) {
                Ok(at) => order[at].1,
                Err(_) => {
                    let message = format!("a value names element {number}, which is not there");
                    let error = scanner.error("mesh.index", message, place);
                    return Err(error.value(number.to_string()).allowed("the number of an element"));
                }
            },
        };
        let row = &mut values[at * width..(at + 1) * width];
        if !row[0].is_nan() {
            let (code, message, allowed) = match nodes {
                Some(_) => ("mesh.duplicate_node", format!("a value names node {number} twice"), "every node once"),
                None => {
                    ("mesh.duplicate_element", format!("a value names element {number} twice"), "every element once")
                }
            };
            return Err(scanner.error(code, message, place).value(number.to_string()).allowed(allowed));
        }
        for slot in row {
            *slot = if scanner.binary {
                scanner.binary_f64(SIZE, "a value")?
            } else {
                scanner.number(SYNTAX, "a value")?
            };
        }
    }
    // A body at rest has one number, that of the first step.
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

/// What a number of a type means.
///
/// # Errors
/// `mesh.unsupported_element` with name and number.
pub(super) fn element_type(scanner: &Scanner<'_>, number: i64, place: usize) -> Result<Kind, SceneError> {
    let (name, found) = match number {
        1 => ("line", Some(Kind::Line)),
        2 => ("triangle", Some(Kind::Triangle)),
        3 => ("quadrilateral", Some(Kind::Quadrilateral)),
        4 => ("tetrahedron", Some(Kind::Tetrahedron)),
        5 => ("hexahedron", Some(Kind::Hexahedron)),
        6 => ("prism", None),
        7 => ("pyramid", None),
        8 => ("quadratic line", Some(Kind::QuadraticLine)),
        9 => ("quadratic triangle", Some(Kind::QuadraticTriangle)),
        10 => ("quadratic quadrilateral", None),
        11 => ("quadratic tetrahedron", Some(Kind::QuadraticTetrahedron)),
        12 => ("quadratic hexahedron", None),
        13 => ("quadratic prism", None),
        14 => ("quadratic pyramid", None),
        15 => ("point", Some(Kind::Point)),
        16 => ("serendipity quadrilateral", None),
        17 => ("serendipity hexahedron", None),
        18 => ("serendipity prism", None),
        19 => ("serendipity pyramid", None),
        20 | 22 | 24 => ("incomplete triangle of higher order", None),
        21 => ("cubic triangle", None),
        23 => ("triangle of order 4", None),
        25 => ("triangle of order 5", None),
        26 => ("cubic line", None),
        27 => ("line of order 4", None),
        28 => ("line of order 5", None),
        29 => ("cubic tetrahedron", None),
        30 => ("tetrahedron of order 4", None),
        31 => ("tetrahedron of order 5", None),
        92 => ("cubic hexahedron", None),
        _ => ("element of an unknown type", None),
    };
    match found {
        Some(kind) => Ok(kind),
        None => {
            let error = scanner.error(
                "mesh.unsupported_element",
                format!("{} (type {number}) cannot be read", one(name)),
                place,
            );
            Err(error.value(number.to_string()).allowed(SUPPORTED))
        }
    }
}

/// Brings the nodes of an element into the order of Opruga: Gmsh lists the middles of edges 2–3 and 1–3 the other way round.
pub(super) fn reorder(kind: Kind, nodes: &mut [u32]) {
    if kind == Kind::QuadraticTetrahedron {
        nodes.swap(8, 9);
    }
}
