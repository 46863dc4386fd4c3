//! PLY: elements with properties, as text or as bytes of either order.
//!
//! The reader takes the properties `x`, `y`, `z` of `vertex` and the list `vertex_indices` (or `vertex_index`) of `face`; polygons are divided into
//! triangles. Other properties, which concern the appearance of vertices, are skipped; the header gives their sizes. Other elements are skipped as
//! well, and counted.
//!
//! # Source
//! G. Turk, The PLY Polygon File Format (1994).

use super::surface_errors::{PlyError, PlyNotice, SurfaceError};
use super::triangles::{Locations, Triangles};
use crate::meshes::cut_line;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::message::AnyMessage;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(word: &str) -> Option<Kind> {
        Some(match word {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }
    fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }
}

struct Property {
    name: String,
    /// The type of the count, for a list.
    count: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Text,
    Little,
    Big,
}

/// Reads the file.
///
/// # Errors
/// `ply.syntax` with the line of the header or of the text; `ply.size` if the header announces more than the file contains, before anything is
/// allocated; `mesh.index`, `mesh.degenerate_face`, with the number of the element and, in binary files, the byte.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Triangles, SceneError> {
    let (format, elements, body) = header(file, bytes)?;
    let mut values = Reader { file, bytes, at: body, begun: body, format };
    let mut found = Triangles::default();
    let mut starts: Vec<u64> = Vec::new();
    let (mut seen_vertices, mut seen_faces) = (false, false);
    for element in &elements {
        values.check_count(element)?;
        match element.name.as_str() {
            "vertex" => {
                seen_vertices = true;
                read_vertices(&mut values, element, &mut found)?;
            }
            "face" => {
                seen_faces = true;
                read_faces(&mut values, element, &mut found, &mut starts)?;
            }
            _ => found.notices.extend(pass_over(&mut values, element)?),
        }
    }
    if !seen_vertices || !seen_faces {
        return Err(values.of_file(PlyError::NoElement { element: if seen_vertices { "face" } else { "vertex" } }));
    }
    values.check_end()?;
    found.locations = match format {
        Format::Text => Locations::Lines(starts.into_iter().map(|start| start as u32).collect()),
        Format::Little | Format::Big => Locations::Starts(starts),
    };
    Ok(found)
}

/// Reads the positions of vertices.
fn read_vertices(values: &mut Reader<'_>, element: &Element, found: &mut Triangles) -> Result<(), SceneError> {
    let number = |name: &str| element.properties.iter().position(|p| p.name == name && p.count.is_none());
    let (Some(x), Some(y), Some(z)) = (number("x"), number("y"), number("z")) else {
        return Err(values.of_file(PlyError::NoCoordinates {}));
    };
    found.single |= [x, y, z].into_iter().any(|k| element.properties[k].kind == Kind::F32);
    for _ in 0..element.count {
        let mut row = [0.0; 3];
        values.begin();
        for (k, property) in element.properties.iter().enumerate() {
            let list = values.property(property)?;
            for (axis, wanted) in [x, y, z].into_iter().enumerate() {
                if wanted == k {
                    row[axis] = list.first().copied().unwrap_or(0.0);
                }
            }
        }
        if let Some(bad) = row.iter().find(|x| !x.is_finite()) {
            let (vertex, value) = (found.positions.len(), bad.to_string());
            return Err(values.error(SurfaceError::NotFiniteVertex { vertex, value }));
        }
        found.positions.push(row);
    }
    Ok(())
}

/// Reads faces as triangles, each with the location of its face in the file.
fn read_faces(
    values: &mut Reader<'_>,
    element: &Element,
    found: &mut Triangles,
    starts: &mut Vec<u64>,
) -> Result<(), SceneError> {
    let list = element
        .properties
        .iter()
        .position(|p| p.count.is_some() && (p.name == "vertex_indices" || p.name == "vertex_index"));
    let Some(wanted) = list else {
        return Err(values.of_file(PlyError::NoIndices {}));
    };
    for face in 0..element.count {
        values.begin();
        let start = values.begun as u64;
        for (k, property) in element.properties.iter().enumerate() {
            let row = values.property(property)?;
            if k != wanted {
                continue;
            }
            let count = found.positions.len();
            let mut corners = Vec::with_capacity(row.len());
            for index in row {
                if !(index >= 0.0 && index < count as f64) {
                    let most = count.saturating_sub(1);
                    return Err(values.error(PlyError::NoVertexOfFace { face, vertex: index, most }));
                }
                corners.push(index as u32);
            }
            match found.polygon(&corners) {
                Ok(triangles) => starts.extend(std::iter::repeat_n(start, triangles)),
                Err(problem) => {
                    let corners = visible(&format!("{corners:?}"));
                    return Err(values.error(SurfaceError::Face { problem, face, corners }));
                }
            }
        }
    }
    Ok(())
}

/// Skips elements that are neither vertices nor faces; returns a notice with their number.
fn pass_over(values: &mut Reader<'_>, element: &Element) -> Result<Option<SceneError>, SceneError> {
    // Elements without properties take no space, however many there are.
    for _ in 0..if element.properties.is_empty() { 0 } else { element.count } {
        values.begin();
        for property in &element.properties {
            values.property(property)?;
        }
    }
    let notice = PlyNotice::Element { count: element.count, element: visible(&element.name) };
    Ok((element.count > 0).then(|| SceneError::of(notice)))
}

/// Reads the format, the elements, and the offset at which their data begin.
fn header(file: &str, bytes: &[u8]) -> Result<(Format, Vec<Element>, usize), SceneError> {
    let refuse = |from: usize, end: usize, error: PlyError| {
        // The contents may be binary; the header itself is text.
        let good = bytes[..end].iter().position(|b| !b.is_ascii()).unwrap_or(end);
        let text = core::str::from_utf8(&bytes[..good]).unwrap_or("");
        let value = text.get(from..).unwrap_or("").trim().to_string();
        Source { file, text }.mark(SceneError::of(error), from, end).value(visible(&value))
    };
    let (mut format, mut elements): (Option<Format>, Vec<Element>) = (None, Vec::new());
    let mut at = 0;
    let mut first = true;
    loop {
        let from = at;
        let Some(length) = bytes[at..].iter().take(4096).position(|b| *b == b'\n') else {
            return Err(refuse(from, bytes.len().min(from + 80), PlyError::NoEnd {}));
        };
        at += length + 1;
        let line = core::str::from_utf8(&bytes[from..at - 1]).unwrap_or("\u{fffd}").trim();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let bad = |error: PlyError| Err(refuse(from, at - 1, error));
        if first && line != "ply" {
            return bad(PlyError::NoMagic {});
        }
        match words.as_slice() {
            ["ply"] if first => {}
            ["format", kind, "1.0"] if format.is_none() => {
                format = Some(match *kind {
                    "ascii" => Format::Text,
                    "binary_little_endian" => Format::Little,
                    "binary_big_endian" => Format::Big,
                    _ => return bad(PlyError::Format {}),
                });
            }
            ["comment" | "obj_info", ..] => {}
            ["element", name, count] => {
                let Ok(count) = count.parse() else { return bad(PlyError::Count {}) };
                elements.push(Element { name: (*name).to_string(), count, properties: Vec::new() });
            }
            ["property", "list", count, kind, name] => {
                let (Some(count), Some(kind), Some(element)) =
                    (Kind::named(count), Kind::named(kind), elements.last_mut())
                else {
                    return bad(PlyError::ListProperty {});
                };
                if matches!(count, Kind::F32 | Kind::F64) {
                    return bad(PlyError::ListCount {});
                }
                element.properties.push(Property { name: (*name).to_string(), count: Some(count), kind });
            }
            ["property", kind, name] => {
                let (Some(kind), Some(element)) = (Kind::named(kind), elements.last_mut()) else {
                    return bad(PlyError::Property {});
                };
                element.properties.push(Property { name: (*name).to_string(), count: None, kind });
            }
            ["end_header"] => break,
            _ => return bad(PlyError::Line {}),
        }
        first = false;
        if elements.len() > 1000 || elements.iter().map(|e| e.properties.len()).sum::<usize>() > 10_000 {
            return bad(PlyError::LongHeader {});
        }
    }
    let Some(format) = format else {
        return Err(refuse(0, 3, PlyError::NoFormat {}));
    };
    Ok((format, elements, at))
}

/// The values after the header.
struct Reader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    at: usize,
    /// The offset at which the present element begins.
    begun: usize,
    format: Format,
}

impl Reader<'_> {
    /// An error about the file as a whole.
    fn of_file(&self, error: PlyError) -> SceneError {
        SceneError { file: self.file.into(), ..SceneError::of(error) }
    }

    /// Refuses more elements than the rest of the file can contain.
    fn check_count(&self, element: &Element) -> Result<(), SceneError> {
        let size = |p: &Property| if self.format == Format::Text { 2 } else { p.count.unwrap_or(p.kind).size() };
        let least: usize = element.properties.iter().map(size).sum();
        let (count, rest) = (element.count, (self.bytes.len() + 1).saturating_sub(self.at));
        if u128::from(count) * least as u128 > rest as u128 {
            let (element, most) = (visible(&element.name), rest / least.max(1));
            return Err(self.of_file(PlyError::Promised { count, element, rest, most }));
        }
        Ok(())
    }

    /// Refuses data after the last element, and truncated texts.
    fn check_end(&mut self) -> Result<(), SceneError> {
        let rest = self.bytes.get(self.at..).unwrap_or(&[]);
        if self.format != Format::Text && !rest.is_empty() || !rest.trim_ascii().is_empty() {
            self.begin();
            return Err(self.error(PlyError::Behind { count: rest.len() }));
        }
        // A truncated index looks complete.
        if self.format == Format::Text && self.bytes.last().is_some_and(|b| !b.is_ascii_whitespace()) {
            let from = self.bytes.iter().rposition(u8::is_ascii_whitespace).map_or(0, |at| at + 1);
            return Err(self.placed(cut_line("ply.syntax", &self.bytes[from..])));
        }
        Ok(())
    }

    /// An error at the position of the reader: the line of a text, the byte of a binary file.
    fn error(&self, error: impl Into<AnyMessage>) -> SceneError {
        self.placed(SceneError::of(error))
    }

    fn placed(&self, error: SceneError) -> SceneError {
        if self.format == Format::Text {
            let good = self.bytes[..self.at].iter().position(|b| !b.is_ascii()).unwrap_or(self.at);
            let text = core::str::from_utf8(&self.bytes[..good]).unwrap_or("");
            let from = text.trim_end().rfind('\n').map_or(0, |k| k + 1);
            return Source { file: self.file, text }.mark(error, from, text.trim_end().len());
        }
        SceneError { file: self.file.to_string(), byte: Some(self.begun), ..error }
    }

    /// Goes to the beginning of the next element; in a text, to the next word.
    fn begin(&mut self) {
        if self.format == Format::Text {
            self.at += self.bytes[self.at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        }
        self.begun = self.at;
    }

    /// Reads the values of one property: one value, or those of a list.
    fn property(&mut self, property: &Property) -> Result<Vec<f64>, SceneError> {
        let Some(count) = property.count else { return Ok(vec![self.value(property.kind)?]) };
        let length = self.value(count)?;
        let least = if self.format == Format::Text { 1 } else { property.kind.size() };
        let most = self.bytes.len().saturating_sub(self.at) / least + 1;
        if !(length >= 0.0 && length <= most as f64) {
            return Err(self.error(PlyError::ListLength { property: visible(&property.name), length, most }));
        }
        (0..length as u64).map(|_| self.value(property.kind)).collect()
    }

    fn value(&mut self, kind: Kind) -> Result<f64, SceneError> {
        if self.format == Format::Text {
            return self.word(kind);
        }
        let size = kind.size();
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.error(PlyError::Ends { length: self.bytes.len() }));
        };
        let mut word = [0u8; 8];
        word[..size].copy_from_slice(bytes);
        if self.format == Format::Big {
            word[..size].reverse();
        }
        self.at += size;
        let [a, b, c, d, ..] = word;
        Ok(match kind {
            Kind::I8 => f64::from(a as i8),
            Kind::U8 => f64::from(a),
            Kind::I16 => f64::from(i16::from_le_bytes([a, b])),
            Kind::U16 => f64::from(u16::from_le_bytes([a, b])),
            Kind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Kind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Kind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Kind::F64 => f64::from_le_bytes(word),
        })
    }

    fn word(&mut self, kind: Kind) -> Result<f64, SceneError> {
        let rest = &self.bytes[self.at..];
        let skipped = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let length = rest[skipped..].iter().take_while(|b| !b.is_ascii_whitespace()).count();
        let word = core::str::from_utf8(&rest[skipped..skipped + length]).unwrap_or("\u{fffd}").to_string();
        self.at += skipped + length;
        if word.is_empty() {
            return Err(self.error(PlyError::TextEnds {}));
        }
        let parsed = match kind {
            Kind::F32 | Kind::F64 => word.parse::<f64>().ok(),
            _ => word.parse::<i64>().ok().map(|x| x as f64),
        };
        parsed.ok_or_else(|| {
            let word = visible(&word);
            self.error(match kind {
                Kind::F32 | Kind::F64 => PlyError::NoDecimalNumber { word },
                _ => PlyError::NotWhole { word },
            })
        })
    }
}
