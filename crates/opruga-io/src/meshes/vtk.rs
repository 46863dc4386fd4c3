//! Legacy VTK: unstructured grids as text or binary, with values of cells and nodes. Versions 1 to 5.
//!
//! # Source
//! Kitware, "VTK File Formats", <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use super::found::{Found, Kind, SUPPORTED, is_kept};
use super::scanner::Scanner;
use super::vtk_numbers::{Number, Value};
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "vtk.syntax";
const SIZE: &str = "vtk.size";

/// What a type of cell in VTK is here, and in which order its nodes stand: pixels and voxels run row by row.
pub(super) fn kind(number: u64) -> Option<(Kind, &'static [usize])> {
    Some(match number {
        1 => (Kind::Point, &[0]),
        3 => (Kind::Line, &[0, 1]),
        5 => (Kind::Triangle, &[0, 1, 2]),
        8 => (Kind::Quadrilateral, &[0, 1, 3, 2]),
        9 => (Kind::Quadrilateral, &[0, 1, 2, 3]),
        10 => (Kind::Tetrahedron, &[0, 1, 2, 3]),
        11 => (Kind::Hexahedron, &[0, 1, 3, 2, 4, 5, 7, 6]),
        12 => (Kind::Hexahedron, &[0, 1, 2, 3, 4, 5, 6, 7]),
        21 => (Kind::QuadraticLine, &[0, 1, 2]),
        22 => (Kind::QuadraticTriangle, &[0, 1, 2, 3, 4, 5]),
        24 => (Kind::QuadraticTetrahedron, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]),
        _ => return None,
    })
}

/// Adds a cell of VTK whose nodes are counted from `first` on, or says why that cannot be.
pub(super) fn add(found: &mut Found, number: i128, nodes: &[i128], first: u32, place: usize) -> Result<(), SceneError> {
    let cell = found.items.len() as u64;
    let Some((kind, order)) = u64::try_from(number).ok().and_then(kind) else {
        let name = match number {
            2 => "set of points",
            4 => "chain of lines",
            6 => "strip of triangles",
            7 => "polygon",
            13 => "wedge",
            14 => "pyramid",
            23 | 28 => "quadratic quadrilateral",
            25 | 29 => "quadratic hexahedron",
            26 => "quadratic wedge",
            27 => "quadratic pyramid",
            42 => "polyhedron",
            68..=81 => "cell of higher order",
            _ => "cell of an unknown type",
        };
        let error = SceneError::new(
            "mesh.unsupported_element",
            format!("cell {cell}, a {name} (type {number}), cannot be read"),
        );
        return Err(error.value(number.to_string()).allowed(SUPPORTED));
    };
    if nodes.len() != order.len() {
        let message = format!("cell {cell}, a {}, has {} nodes", kind.name(), nodes.len());
        return Err(SceneError::new(SIZE, message).value(nodes.len().to_string()).allowed(order.len().to_string()));
    }
    let mut own = [0; 10];
    let there = found.positions.len() as i128 - i128::from(first);
    for (slot, &from) in own.iter_mut().zip(order) {
        let node = nodes[from];
        if !(0..there).contains(&node) {
            let message = format!("cell {cell} names node {node}");
            let allowed = format!("0 to {}", (there - 1).max(0));
            return Err(SceneError::new("mesh.index", message).value(node.to_string()).allowed(allowed));
        }
        *slot = first + node as u32;
    }
    found.item(kind, &own[..order.len()], cell, place);
    Ok(())
}

struct Reader<'s, 'a> {
    scanner: &'s mut Scanner<'a>,
    /// Whether numbers of arrays are binary; keywords are words in any case.
    binary: bool,
    found: Found,
    /// Nodes of the cells, before their types are known: their place and their nodes.
    cells: Vec<(usize, Vec<i128>)>,
}

/// Reads a file.
///
/// # Errors
/// `vtk.syntax`, `vtk.size` with line or byte; `mesh.…` for what the cells say.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let (head, from) = scanner.line();
    if !head.starts_with("# vtk DataFile Version") {
        let error = scanner.error(SYNTAX, "the file does not begin as VTK does", from);
        return Err(error.value(visible(&head)).allowed("# vtk DataFile Version 3.0"));
    }
    scanner.line();
    let (kind, from) = scanner.word(SYNTAX, "ASCII or BINARY")?;
    let binary = match kind.to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => {
            let error = scanner.error(SYNTAX, format!("`{}` is no kind of file", visible(kind)), from);
            return Err(error.value(visible(kind)).allowed("ASCII or BINARY"));
        }
    };
    scanner.binary = binary;
    scanner.big_endian = true;
    scanner.expect(SYNTAX, "DATASET")?;
    let (set, from) = scanner.word(SYNTAX, "the kind of data set")?;
    if !set.eq_ignore_ascii_case("UNSTRUCTURED_GRID") {
        let error = scanner.error(SYNTAX, format!("the data set is `{}`", visible(set)), from);
        return Err(error.value(visible(set)).allowed("UNSTRUCTURED_GRID"));
    }
    let mut reader = Reader { scanner, binary, found: Found::default(), cells: Vec::new() };
    reader.sections()?;
    Ok(reader.found)
}

impl Reader<'_, '_> {
    fn sections(&mut self) -> Result<(), SceneError> {
        // Sections of which there is one.
        let mut seen: Vec<&str> = Vec::new();
        // Whether arrays belong to cells, and how many there are of what they belong to.
        let mut of: Option<(bool, usize)> = None;
        while let Some((word, from)) = self.scanner.peek() {
            let word = word.to_ascii_uppercase();
            self.scanner.word(SYNTAX, "")?;
            if let Some(single) = ["POINTS", "CELLS", "CELL_TYPES"].into_iter().find(|single| word == *single) {
                if seen.contains(&single) {
                    let error = self.scanner.error(SYNTAX, format!("there is a second section `{single}`"), from);
                    return Err(error.value(single).allowed("one"));
                }
                seen.push(single);
            }
            match word.as_str() {
                "POINTS" => self.points()?,
                "CELLS" => self.connectivity()?,
                "CELL_TYPES" => self.types(from)?,
                "CELL_DATA" | "POINT_DATA" => {
                    let (count, at) = self.scanner.whole::<u64>(SYNTAX, "a count")?;
                    let cells = word == "CELL_DATA";
                    let there = if cells { self.cells.len() } else { self.found.positions.len() };
                    if count != there as u64 {
                        let what = if cells { "cells" } else { "points" };
                        let error = self.scanner.error(SIZE, format!("there are {there} {what}, not {count}"), at);
                        return Err(error.value(count.to_string()).allowed(there.to_string()));
                    }
                    of = Some((cells, there));
                }
                "FIELD" => self.field(of)?,
                "METADATA" => self.metadata(),
                "SCALARS"
                | "COLOR_SCALARS"
                | "VECTORS"
                | "NORMALS"
                | "TENSORS"
                | "TENSORS6"
                | "TEXTURE_COORDINATES"
                | "LOOKUP_TABLE" => {
                    self.attribute(&word, of, from)?;
                }
                _ => {
                    let error = self.scanner.error(SYNTAX, format!("`{}` is no keyword", visible(&word)), from);
                    let allowed = "POINTS, CELLS, CELL_TYPES, CELL_DATA, POINT_DATA, FIELD, SCALARS …";
                    return Err(error.value(visible(&word)).allowed(allowed));
                }
            }
        }
        if !seen.contains(&"CELL_TYPES") {
            let wanted = if self.found.positions.is_empty() { "`POINTS`" } else { "`CELLS` and `CELL_TYPES`" };
            return Err(self.scanner.ends(SYNTAX, wanted));
        }
        // Binary numbers have their length.
        if self.binary { Ok(()) } else { self.scanner.last_line_ends(SYNTAX) }
    }

    fn number_type(&mut self) -> Result<Number, SceneError> {
        let (word, from) = self.scanner.word(SYNTAX, "a type of numbers")?;
        Number::named(word).ok_or_else(|| {
            let error = self.scanner.error(SYNTAX, format!("`{}` is no type of numbers", visible(word)), from);
            error.value(visible(word)).allowed("int, long, float, double …")
        })
    }

    /// What is made of the numbers of an array. In binary they begin behind the end of the line.
    fn array<T>(
        &mut self,
        (count, from): (u64, usize),
        kind: Number,
        what: &str,
        made: impl Fn(&Scanner<'_>, Value, usize) -> Result<T, SceneError>,
    ) -> Result<Vec<(T, usize)>, SceneError> {
        if self.binary {
            self.scanner.line_end(SYNTAX, "the head of an array")?;
        }
        let least = if self.binary { kind.size() as u64 } else { 2 };
        let count = self.scanner.fits(SIZE, count, least, what, from)?;
        let mut out = Vec::with_capacity(count);
        for _ in 0..count {
            self.scanner.peek().filter(|_| !self.binary);
            let place = self.scanner.at;
            let value = self.value(kind, what)?;
            out.push((made(self.scanner, value, place)?, place));
        }
        Ok(out)
    }

    /// Numbers of an array, which may be real ones.
    fn values(&mut self, count: u64, kind: Number, what: &str, from: usize) -> Result<Vec<(f64, usize)>, SceneError> {
        self.array((count, from), kind, what, |_, value, _| Ok(value.real()))
    }

    /// Whole numbers of an array, whatever its type.
    fn wholes(&mut self, count: u64, kind: Number, what: &str, from: usize) -> Result<Vec<(i128, usize)>, SceneError> {
        self.array((count, from), kind, what, |scanner, value, place| {
            value.whole().map_err(|x| {
                let error = scanner.error(SYNTAX, format!("`{x}` stands where {what} should"), place);
                error.value(x.to_string()).allowed("a whole number")
            })
        })
    }

    fn value(&mut self, kind: Number, what: &str) -> Result<Value, SceneError> {
        let scanner = &mut *self.scanner;
        let (value, from) = if self.binary {
            let from = scanner.at;
            (kind.of_bytes(scanner.take(kind.size(), SIZE, what)?, true), from)
        } else {
            let (word, from) = scanner.word(SYNTAX, what)?;
            let value = kind.of_word(word).map_err(|allowed| {
                let error = scanner.error(SYNTAX, format!("`{}` stands where {what} should", visible(word)), from);
                let error = error.value(visible(word)).allowed(allowed);
                if word.contains(',') { error.hint("write a point, not a comma") } else { error }
            })?;
            (value, from)
        };
        scanner.finite(value.real(), what, from)?;
        Ok(value)
    }

    fn points(&mut self) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, "the number of points")?;
        let kind = self.number_type()?;
        self.found.single |= kind == Number::Real(4);
        let numbers = self.values(count.saturating_mul(3), kind, "coordinates", from)?;
        for (number, x) in numbers.chunks_exact(3).enumerate() {
            self.found.node(number as u64, [x[0].0, x[1].0, x[2].0], x[0].1);
        }
        Ok(())
    }

    /// `CELLS n size`, each with the count of its nodes; since version 5.1 `CELLS n+1 size` with `OFFSETS` and `CONNECTIVITY`.
    fn connectivity(&mut self) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, "the number of cells")?;
        let (size, size_from) = self.scanner.whole::<u64>(SYNTAX, "the size of the list of cells")?;
        let ahead = (self.scanner.at, self.scanner.peek().map(|(word, _)| word.to_ascii_uppercase()));
        if ahead.1.as_deref() == Some("OFFSETS") {
            self.scanner.expect(SYNTAX, "OFFSETS")?;
            let kind = self.number_type()?;
            let offsets = self.wholes(count, kind, "offsets", from)?;
            self.scanner.expect(SYNTAX, "CONNECTIVITY")?;
            let kind = self.number_type()?;
            let nodes = self.wholes(size, kind, "nodes of cells", size_from)?;
            // What no cell names would be lost.
            let there = nodes.len() as i128;
            let ends = [(offsets.first(), 0, "first cell begins"), (offsets.last(), there, "last cell ends")];
            for (end, wanted, which) in ends {
                if let Some((number, place)) = end.filter(|(number, _)| *number != wanted) {
                    let error = self.scanner.error(SIZE, format!("the {which} at {number}"), *place);
                    return Err(error.value(number.to_string()).allowed(wanted.to_string()));
                }
            }
            for pair in offsets.windows(2) {
                let (start, end) = (pair[0].0, pair[1].0);
                if !(start <= end && end <= there) {
                    let error = self.scanner.error(SIZE, format!("a cell reaches from {start} to {end}"), pair[1].1);
                    return Err(error.value(end.to_string()).allowed(format!("{start} to {there}")));
                }
                let own = &nodes[start as usize..end as usize];
                let place = own.first().map_or(pair[0].1, |x| x.1);
                self.cells.push((place, own.iter().map(|x| x.0).collect()));
            }
            return Ok(());
        }
        self.scanner.at = ahead.0;
        let numbers = self.wholes(size, Number::Whole(4, true), "nodes of cells", size_from)?;
        let mut rest = &numbers[..];
        for cell in 0..count {
            let there = rest.len().saturating_sub(1);
            let Some(&(length, place)) = rest.first() else {
                let error = self.scanner.error(SIZE, format!("there are {cell} cells, not {count}"), from);
                return Err(error.value(count.to_string()).allowed(cell.to_string()));
            };
            if !(0..=there as i128).contains(&length) {
                let error = self.scanner.error(SIZE, format!("a cell has {length} nodes, but {there} follow"), place);
                return Err(error.value(length.to_string()).allowed(format!("at most {there}")));
            }
            let (own, behind) = rest[1..].split_at(length as usize);
            self.cells.push((place, own.iter().map(|x| x.0).collect()));
            rest = behind;
        }
        if !rest.is_empty() {
            let error = self.scanner.error(SIZE, format!("numbers follow the last cell: {}", rest.len()), rest[0].1);
            return Err(error.value(size.to_string()).allowed((size - rest.len() as u64).to_string()));
        }
        Ok(())
    }

    fn types(&mut self, at: usize) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, "the number of cells")?;
        if count != self.cells.len() as u64 || self.found.positions.is_empty() {
            let error = self.scanner.error(
                SIZE,
                format!("there are types for {count} cells"),
                if count == 0 { at } else { from },
            );
            return Err(error.value(count.to_string()).allowed(self.cells.len().to_string()));
        }
        let types = self.wholes(count, Number::Whole(4, true), "types of cells", from)?;
        for ((place, nodes), (number, at)) in self.cells.iter().zip(types) {
            add(&mut self.found, number, nodes, 0, *place).map_err(|error| {
                let at = if error.code == "mesh.unsupported_element" { at } else { *place };
                let marked = self.scanner.error(error.code, error.message.clone(), at);
                SceneError { value: error.value, allowed: error.allowed, ..marked }
            })?;
        }
        Ok(())
    }

    /// Keeps values of cells of one component and those of nodes of up to three, and counts others.
    fn keep(
        &mut self,
        (name, at): (&str, usize),
        components: u64,
        values: Vec<(f64, usize)>,
        of: Option<(bool, usize)>,
    ) -> Result<(), SceneError> {
        match of {
            Some((true, _)) if components == 1 => {
                if self.found.item_values.contains_key(name) {
                    return Err(twice(self.scanner.error(SYNTAX, values_twice(false, name), at), name));
                }
                self.found.item_values.insert(name.to_string(), values.into_iter().map(|x| x.0).collect());
            }
            Some((false, _)) if is_kept(components) => {
                if self.found.node_values.contains_key(name) {
                    return Err(twice(self.scanner.error(SYNTAX, values_twice(true, name), at), name));
                }
                let numbers = values.into_iter().map(|x| x.0);
                let kept = self.found.values_of_nodes(name, 0, components as usize, numbers);
                kept.map_err(|error| self.scanner.at(error, at))?;
            }
            // Data of the whole file is no part of the body: time, cycle and the like.
            None => {}
            Some(_) => {
                let what = format!("the values `{}` are left out", visible(name));
                self.found.left_out(what, visible(name));
            }
        }
        Ok(())
    }

    fn field(&mut self, of: Option<(bool, usize)>) -> Result<(), SceneError> {
        self.scanner.word(SYNTAX, "the name of a field")?;
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, "the number of arrays")?;
        for _ in 0..self.scanner.fits(SIZE, count, 6, "arrays", from)? {
            let (mut name, mut at_name) = self.scanner.word(SYNTAX, "the name of an array")?;
            if name.eq_ignore_ascii_case("METADATA") {
                self.metadata();
                (name, at_name) = self.scanner.word(SYNTAX, "the name of an array")?;
            }
            let (components, _) = self.scanner.whole::<u64>(SYNTAX, "the number of components")?;
            let (tuples, from) = self.scanner.whole::<u64>(SYNTAX, "the number of values")?;
            if let Some((cells, there)) = of
                && tuples != there as u64
            {
                let what = if cells { "cells" } else { "points" };
                let error = self.scanner.error(SIZE, format!("{tuples} values for {there} {what}"), from);
                return Err(error.value(tuples.to_string()).allowed(there.to_string()));
            }
            let (word, at) = self.scanner.word(SYNTAX, "a type of numbers")?;
            if word.eq_ignore_ascii_case("string") {
                let error = self.scanner.error(SYNTAX, "a field of texts cannot be read", at);
                return Err(error.value("string").allowed("numbers"));
            }
            let Some(kind) = Number::named(word) else {
                let error = self.scanner.error(SYNTAX, format!("`{}` is no type of numbers", visible(word)), at);
                return Err(error.value(visible(word)).allowed("int, long, float, double …"));
            };
            let values = self.values(tuples.saturating_mul(components), kind, "values", from)?;
            let name = name.replace("%20", " ");
            self.keep((&name, at_name), components, values, of)?;
        }
        Ok(())
    }

    /// Passes over a block that ends with an empty line.
    fn metadata(&mut self) {
        self.scanner.line();
        while self.scanner.at < self.scanner.bytes.len() && !self.scanner.line().0.is_empty() {}
    }

    fn attribute(&mut self, word: &str, of: Option<(bool, usize)>, at: usize) -> Result<(), SceneError> {
        let Some((_, there)) = of else {
            let error = self.scanner.error(SYNTAX, format!("`{word}` stands before CELL_DATA and POINT_DATA"), at);
            return Err(error.value(word).allowed("CELL_DATA or POINT_DATA before it"));
        };
        let (name, at_name) = self.scanner.word(SYNTAX, "the name of values")?;
        let name = name.replace("%20", " ");
        let (components, kind, count) = match word {
            "SCALARS" => {
                let kind = self.number_type()?;
                let components = match self.scanner.word_of_line() {
                    Some((text, from)) => text.parse().map_err(|_| {
                        let error =
                            self.scanner.error(SYNTAX, format!("`{}` is no number of components", visible(text)), from);
                        error.value(visible(text)).allowed("1 to 4")
                    })?,
                    None => 1,
                };
                if self.scanner.peek().is_some_and(|(word, _)| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
                    self.scanner.expect(SYNTAX, "LOOKUP_TABLE")?;
                    self.scanner.word(SYNTAX, "the name of a table")?;
                }
                (components, kind, there as u64)
            }
            "COLOR_SCALARS" => {
                let (components, _) = self.scanner.whole::<u64>(SYNTAX, "the number of components")?;
                (components, if self.binary { Number::Whole(1, false) } else { Number::Real(4) }, there as u64)
            }
            "LOOKUP_TABLE" => {
                let (rows, _) = self.scanner.whole::<u64>(SYNTAX, "the number of colours")?;
                (4, if self.binary { Number::Whole(1, false) } else { Number::Real(4) }, rows)
            }
            "TEXTURE_COORDINATES" => {
                let (components, _) = self.scanner.whole::<u64>(SYNTAX, "the number of components")?;
                (components, self.number_type()?, there as u64)
            }
            "TENSORS" => (9, self.number_type()?, there as u64),
            "TENSORS6" => (6, self.number_type()?, there as u64),
            _ => (3, self.number_type()?, there as u64),
        };
        let values = self.values(count.saturating_mul(components), kind, "values", at)?;
        if word == "LOOKUP_TABLE" {
            self.found.left_out(format!("the colours `{}` are left out", visible(&name)), visible(&name));
        } else {
            self.keep((&name, at_name), components, values, of)?;
        }
        Ok(())
    }
}

/// What is said where cells or points have values of one name twice.
pub(super) fn values_twice(of_points: bool, name: &str) -> String {
    let name = visible(name);
    if of_points {
        format!("the points have values `{name}` twice")
    } else {
        format!("the cells have values `{name}` twice")
    }
}

/// An error at the second of them.
pub(super) fn twice(error: SceneError, name: &str) -> SceneError {
    error.value(visible(name)).allowed("a name of its own for every array")
}
