//! Legacy VTK: unstructured grids as text or binary, with values of cells and nodes. Versions 1 to 5.
//!
//! # Source
//! Kitware, "VTK File Formats", <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use super::errors::{Keyword, MeshFileError, MeshFileNotice, ScanError};
use super::found::{Found, Kind, is_kept};
use super::scanner::Scanner;
use super::terms::{ElementName, Expected};
use super::vtk_errors::VtkError;
use super::vtk_numbers::{Number, Value};
use crate::problem::{SceneError, visible};

const SYNTAX: &str = "vtk.syntax";
const SIZE: &str = "vtk.size";

/// The kind of element for a cell type of VTK, and the order of its nodes: VTK lists the nodes of pixels and voxels row by row.
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

/// Adds a VTK cell whose nodes are counted from `first`, or returns why it cannot be added.
pub(super) fn add(
    found: &mut Found,
    number: i128,
    nodes: &[i128],
    first: u32,
    byte_offset: usize,
) -> Result<(), SceneError> {
    let cell = found.items.len() as u64;
    let Some((kind, order)) = u64::try_from(number).ok().and_then(kind) else {
        let element = match number {
            2 => ElementName::Points,
            4 => ElementName::Lines,
            6 => ElementName::Strip,
            7 => ElementName::Polygon,
            13 => ElementName::Wedge,
            14 => ElementName::Pyramid,
            23 | 28 => ElementName::QuadraticQuadrilateral,
            25 | 29 => ElementName::QuadraticHexahedron,
            26 => ElementName::QuadraticWedge,
            27 => ElementName::QuadraticPyramid,
            42 => ElementName::Polyhedron,
            68..=81 => ElementName::HigherCell,
            _ => ElementName::UnknownCell,
        };
        return Err(SceneError::of(MeshFileError::UnsupportedCell { cell, element, number }));
    };
    if nodes.len() != order.len() {
        let (element, nodes, wanted) = (kind.name(), nodes.len(), order.len());
        return Err(SceneError::of(VtkError::CellNodes { cell, element, nodes, wanted }));
    }
    let mut own = [0; 10];
    let there = found.positions.len() as i128 - i128::from(first);
    for (slot, &from) in own.iter_mut().zip(order) {
        let node = nodes[from];
        if !(0..there).contains(&node) {
            return Err(SceneError::of(VtkError::NoNodeOfCell { cell, node, most: (there - 1).max(0) }));
        }
        *slot = first + node as u32;
    }
    found.item(kind, &own[..order.len()], cell, byte_offset);
    Ok(())
}

struct Reader<'s, 'a> {
    scanner: &'s mut Scanner<'a>,
    /// Whether the numbers of arrays are binary. Keywords are always text.
    binary: bool,
    found: Found,
    /// The cells before their types are known: their offset in the file and their nodes.
    cells: Vec<(usize, Vec<i128>)>,
}

/// Reads a file.
///
/// # Errors
/// `vtk.syntax`, `vtk.size` with line or byte; `mesh.…` for faults of the cells.
pub(super) fn read(scanner: &mut Scanner<'_>) -> Result<Found, SceneError> {
    let (head, from) = scanner.line();
    if !head.starts_with("# vtk DataFile Version") {
        return Err(scanner.error(VtkError::Head { head: visible(&head) }, from));
    }
    scanner.line();
    let (kind, from) = scanner.word(SYNTAX, Expected::AsciiOrBinary)?;
    let binary = match kind.to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => return Err(scanner.error(VtkError::FileKind { word: visible(kind) }, from)),
    };
    scanner.binary = binary;
    scanner.big_endian = true;
    scanner.expect(SYNTAX, "DATASET")?;
    let (set, from) = scanner.word(SYNTAX, Expected::DataSet)?;
    if !set.eq_ignore_ascii_case("UNSTRUCTURED_GRID") {
        return Err(scanner.error(VtkError::DataSet { word: visible(set) }, from));
    }
    let mut reader = Reader { scanner, binary, found: Found::default(), cells: Vec::new() };
    reader.sections()?;
    Ok(reader.found)
}

impl Reader<'_, '_> {
    fn sections(&mut self) -> Result<(), SceneError> {
        // Sections that may occur only once.
        let mut seen: Vec<&str> = Vec::new();
        // Whether the following arrays belong to cells or to points, and the number of these cells or points.
        let mut of: Option<(bool, usize)> = None;
        while let Some((word, from)) = self.scanner.peek() {
            let word = word.to_ascii_uppercase();
            self.scanner.word(SYNTAX, Expected::Nothing)?;
            if let Some(single) = ["POINTS", "CELLS", "CELL_TYPES"].into_iter().find(|single| word == *single) {
                if seen.contains(&single) {
                    let twice = ScanError::SecondSection { section: single.into() };
                    return Err(self.scanner.error_of(SYNTAX, twice, from));
                }
                seen.push(single);
            }
            match word.as_str() {
                "POINTS" => self.points()?,
                "CELLS" => self.connectivity()?,
                "CELL_TYPES" => self.types(from)?,
                "CELL_DATA" | "POINT_DATA" => {
                    let (count, at) = self.scanner.whole::<u64>(SYNTAX, Expected::Count)?;
                    let cells = word == "CELL_DATA";
                    let there = if cells { self.cells.len() } else { self.found.positions.len() };
                    if count != there as u64 {
                        return Err(match cells {
                            true => self.scanner.error(VtkError::Cells { there: there as u64, count }, at),
                            false => self.scanner.error(VtkError::Points { there, count }, at),
                        });
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
                _ => return Err(self.scanner.error(VtkError::Keyword { word: visible(&word) }, from)),
            }
        }
        if !seen.contains(&"CELL_TYPES") {
            let wanted = match self.found.positions.is_empty() {
                true => Keyword::One { word: "POINTS".into() },
                false => Keyword::Two { first: "CELLS", second: "CELL_TYPES" },
            };
            return Err(self.scanner.ends(SYNTAX, wanted));
        }
        // Binary numbers have a known length, so a truncated file is detected without a line end.
        if self.binary { Ok(()) } else { self.scanner.last_line_ends(SYNTAX) }
    }

    fn number_type(&mut self) -> Result<Number, SceneError> {
        let (word, from) = self.scanner.word(SYNTAX, Expected::NumberType)?;
        Number::named(word).ok_or_else(|| self.no_type(word, from))
    }

    fn no_type(&self, word: &str, from: usize) -> SceneError {
        let error = ScanError::NumberType { word: visible(word), allowed: "int, long, float, double …" };
        self.scanner.error_of(SYNTAX, error, from)
    }

    /// Reads the numbers of an array and converts them. Binary numbers begin after the end of the line.
    fn array<T>(
        &mut self,
        (count, from): (u64, usize),
        kind: Number,
        what: Expected,
        made: impl Fn(&Scanner<'_>, Value, usize) -> Result<T, SceneError>,
    ) -> Result<Vec<(T, usize)>, SceneError> {
        if self.binary {
            self.scanner.line_end(SYNTAX, Expected::HeadOfArray)?;
        }
        let least = if self.binary { kind.size() as u64 } else { 2 };
        let count = self.scanner.fits(SIZE, count, least, what, from)?;
        let mut out = Vec::with_capacity(count);
        for _ in 0..count {
            self.scanner.peek().filter(|_| !self.binary);
            let byte_offset = self.scanner.at;
            let value = self.value(kind, what)?;
            out.push((made(self.scanner, value, byte_offset)?, byte_offset));
        }
        Ok(out)
    }

    /// Numbers of an array, not necessarily whole.
    fn values(
        &mut self,
        count: u64,
        kind: Number,
        what: Expected,
        from: usize,
    ) -> Result<Vec<(f64, usize)>, SceneError> {
        self.array((count, from), kind, what, |_, value, _| Ok(value.real()))
    }

    /// Whole numbers of an array, whatever its type.
    fn wholes(
        &mut self,
        count: u64,
        kind: Number,
        what: Expected,
        from: usize,
    ) -> Result<Vec<(i128, usize)>, SceneError> {
        self.array((count, from), kind, what, |scanner, value, byte_offset| {
            let refused =
                |x: f64| scanner.error_of(SYNTAX, ScanError::NotWhole { word: x.to_string(), what }, byte_offset);
            value.whole().map_err(refused)
        })
    }

    fn value(&mut self, kind: Number, what: Expected) -> Result<Value, SceneError> {
        let scanner = &mut *self.scanner;
        let (value, from) = if self.binary {
            let from = scanner.at;
            (kind.of_bytes(scanner.take(kind.size(), SIZE, what)?, true), from)
        } else {
            let (word, from) = scanner.word(SYNTAX, what)?;
            (kind.of_word(word).map_err(|allowed| scanner.no_number(SYNTAX, word, what, allowed, from))?, from)
        };
        scanner.finite(value.real(), what, from)?;
        Ok(value)
    }

    fn points(&mut self) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfPoints)?;
        let kind = self.number_type()?;
        self.found.single |= kind == Number::Real(4);
        let numbers = self.values(count.saturating_mul(3), kind, Expected::Coordinates, from)?;
        for (number, x) in numbers.chunks_exact(3).enumerate() {
            self.found.node(number as u64, [x[0].0, x[1].0, x[2].0], x[0].1);
        }
        Ok(())
    }

    /// `CELLS n size`, where each cell begins with the count of its nodes; since version 5.1 `CELLS n+1 size` with `OFFSETS` and `CONNECTIVITY`.
    fn connectivity(&mut self) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfCells)?;
        let (size, size_from) = self.scanner.whole::<u64>(SYNTAX, Expected::SizeOfCells)?;
        let ahead = (self.scanner.at, self.scanner.peek().map(|(word, _)| word.to_ascii_uppercase()));
        if ahead.1.as_deref() == Some("OFFSETS") {
            self.scanner.expect(SYNTAX, "OFFSETS")?;
            let kind = self.number_type()?;
            let offsets = self.wholes(count, kind, Expected::Offsets, from)?;
            self.scanner.expect(SYNTAX, "CONNECTIVITY")?;
            let kind = self.number_type()?;
            let nodes = self.wholes(size, kind, Expected::NodesOfCells, size_from)?;
            // Nodes that no cell names would be lost.
            let there = nodes.len() as i128;
            if let Some(&(offset, byte_offset)) = offsets.first().filter(|(offset, _)| *offset != 0) {
                return Err(self.scanner.error(VtkError::FirstOffset { offset, wanted: 0 }, byte_offset));
            }
            if let Some(&(offset, byte_offset)) = offsets.last().filter(|(offset, _)| *offset != there) {
                return Err(self.scanner.error(VtkError::LastOffset { offset, wanted: there }, byte_offset));
            }
            for pair in offsets.windows(2) {
                let (start, end) = (pair[0].0, pair[1].0);
                if !(start <= end && end <= there) {
                    return Err(self.scanner.error(VtkError::Reach { start, end, most: there }, pair[1].1));
                }
                let own = &nodes[start as usize..end as usize];
                let begin = own.first().map_or(pair[0].1, |x| x.1);
                self.cells.push((begin, own.iter().map(|x| x.0).collect()));
            }
            return Ok(());
        }
        self.scanner.at = ahead.0;
        let numbers = self.wholes(size, Number::Whole(4, true), Expected::NodesOfCells, size_from)?;
        let mut rest = &numbers[..];
        for cell in 0..count {
            let there = rest.len().saturating_sub(1);
            let Some(&(length, byte_offset)) = rest.first() else {
                return Err(self.scanner.error(VtkError::Cells { there: cell, count }, from));
            };
            if !(0..=there as i128).contains(&length) {
                return Err(self.scanner.error(VtkError::Follow { nodes: length, there }, byte_offset));
            }
            let (own, behind) = rest[1..].split_at(length as usize);
            self.cells.push((byte_offset, own.iter().map(|x| x.0).collect()));
            rest = behind;
        }
        if !rest.is_empty() {
            let (numbers, wanted) = (rest.len(), size - rest.len() as u64);
            return Err(self.scanner.error(VtkError::BehindCells { numbers, size, wanted }, rest[0].1));
        }
        Ok(())
    }

    fn types(&mut self, at: usize) -> Result<(), SceneError> {
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfCells)?;
        if count != self.cells.len() as u64 || self.found.positions.is_empty() {
            let begin = if count == 0 { at } else { from };
            return Err(self.scanner.error(VtkError::Types { count, cells: self.cells.len() }, begin));
        }
        let types = self.wholes(count, Number::Whole(4, true), Expected::TypesOfCells, from)?;
        for ((byte_offset, nodes), (number, at)) in self.cells.iter().zip(types) {
            add(&mut self.found, number, nodes, 0, *byte_offset).map_err(|error| {
                let at = if error.code == "mesh.unsupported_element" { at } else { *byte_offset };
                self.scanner.at(error, at)
            })?;
        }
        Ok(())
    }

    /// Keeps cell values with one component and node values with up to three components; counts all other values.
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
                    return Err(self.scanner.error_of(SYNTAX, values_twice(false, name), at));
                }
                self.found.item_values.insert(name.to_string(), values.into_iter().map(|x| x.0).collect());
            }
            Some((false, _)) if is_kept(components) => {
                if self.found.node_values.contains_key(name) {
                    return Err(self.scanner.error_of(SYNTAX, values_twice(true, name), at));
                }
                let numbers = values.into_iter().map(|x| x.0);
                let kept = self.found.values_of_nodes(name, 0, components as usize, numbers);
                kept.map_err(|error| self.scanner.at(error, at))?;
            }
            // Data of the whole file, such as time and cycle, are not part of the body.
            None => {}
            Some(_) => self.found.left_out(MeshFileNotice::Values { name: visible(name) }),
        }
        Ok(())
    }

    fn field(&mut self, of: Option<(bool, usize)>) -> Result<(), SceneError> {
        self.scanner.word(SYNTAX, Expected::NameOfField)?;
        let (count, from) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfArrays)?;
        for _ in 0..self.scanner.fits(SIZE, count, 6, Expected::Arrays, from)? {
            let (mut name, mut at_name) = self.scanner.word(SYNTAX, Expected::NameOfArray)?;
            if name.eq_ignore_ascii_case("METADATA") {
                self.metadata();
                (name, at_name) = self.scanner.word(SYNTAX, Expected::NameOfArray)?;
            }
            let (components, _) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfComponents)?;
            let (tuples, from) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfValues)?;
            if let Some((cells, there)) = of
                && tuples != there as u64
            {
                let error = match cells {
                    true => VtkError::ValuesOfCells { values: tuples, cells: there },
                    false => VtkError::ValuesOfPoints { values: tuples, points: there },
                };
                return Err(self.scanner.error(error, from));
            }
            let (word, at) = self.scanner.word(SYNTAX, Expected::NumberType)?;
            if word.eq_ignore_ascii_case("string") {
                return Err(self.scanner.error(VtkError::Texts {}, at));
            }
            let Some(kind) = Number::named(word) else { return Err(self.no_type(word, at)) };
            let values = self.values(tuples.saturating_mul(components), kind, Expected::Values, from)?;
            let name = name.replace("%20", " ");
            self.keep((&name, at_name), components, values, of)?;
        }
        Ok(())
    }

    /// Skips a block that ends with an empty line.
    fn metadata(&mut self) {
        self.scanner.line();
        while self.scanner.at < self.scanner.bytes.len() && !self.scanner.line().0.is_empty() {}
    }

    fn attribute(&mut self, word: &str, of: Option<(bool, usize)>, at: usize) -> Result<(), SceneError> {
        let Some((_, there)) = of else {
            return Err(self.scanner.error(VtkError::BeforeData { word: word.into() }, at));
        };
        let (name, at_name) = self.scanner.word(SYNTAX, Expected::NameOfValues)?;
        let name = name.replace("%20", " ");
        let (components, kind, count) = match word {
            "SCALARS" => {
                let kind = self.number_type()?;
                let components = match self.scanner.word_of_line() {
                    Some((text, from)) => text
                        .parse()
                        .map_err(|_| self.scanner.error(VtkError::Components { word: visible(text) }, from))?,
                    None => 1,
                };
                if self.scanner.peek().is_some_and(|(word, _)| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
                    self.scanner.expect(SYNTAX, "LOOKUP_TABLE")?;
                    self.scanner.word(SYNTAX, Expected::NameOfTable)?;
                }
                (components, kind, there as u64)
            }
            "COLOR_SCALARS" => {
                let (components, _) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfComponents)?;
                (components, if self.binary { Number::Whole(1, false) } else { Number::Real(4) }, there as u64)
            }
            "LOOKUP_TABLE" => {
                let (rows, _) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfColours)?;
                (4, if self.binary { Number::Whole(1, false) } else { Number::Real(4) }, rows)
            }
            "TEXTURE_COORDINATES" => {
                let (components, _) = self.scanner.whole::<u64>(SYNTAX, Expected::NumberOfComponents)?;
                (components, self.number_type()?, there as u64)
            }
            "TENSORS" => (9, self.number_type()?, there as u64),
            "TENSORS6" => (6, self.number_type()?, there as u64),
            _ => (3, self.number_type()?, there as u64),
        };
        let values = self.values(count.saturating_mul(components), kind, Expected::Values, at)?;
        if word == "LOOKUP_TABLE" {
            self.found.left_out(MeshFileNotice::Colours { name: visible(&name) });
        } else {
            self.keep((&name, at_name), components, values, of)?;
        }
        Ok(())
    }
}

/// The error for two values of cells or points with the same name.
pub(super) fn values_twice(of_points: bool, name: &str) -> ScanError {
    let name = visible(name);
    if of_points { ScanError::PointValuesTwice { name } } else { ScanError::CellValuesTwice { name } }
}
