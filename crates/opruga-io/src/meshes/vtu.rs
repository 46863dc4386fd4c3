//! VTK XML unstructured grids (`.vtu`): text, base64 or raw appended bytes, of either byte order, uncompressed or compressed by zlib.
//!
//! # Source
//! Kitware, "VTK XML Formats", <https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html>.

use super::errors::{MeshFileNotice, ScanError};
use super::found::{Found, is_kept};
use super::scanner::Scanner;
use super::vtk;
use super::vtk_errors::{ArrayName, Doubled, VtuError};
use super::vtk_numbers::{Number, Value};
use crate::base64;
use crate::budget::{LimitHint, NUMBERS, NUMBERS_PER_BYTE};
use crate::problem::{SceneError, visible};
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::io::Read;

const SYNTAX: &str = "vtu.syntax";

/// The largest ratio, approximately, by which zlib can compress data.
const MOST_COMPRESSED: u64 = 1100;

/// The properties that the head of the file gives for all arrays.
struct Reader<'a> {
    scanner: &'a Scanner<'a>,
    big_endian: bool,
    /// Size of the numbers in front of binary arrays [bytes].
    header: usize,
    compressed: bool,
    /// Appended data after the underscore, and whether they are raw or letters.
    appended: Option<(&'a [u8], bool)>,
    /// Count of the numbers in binary arrays.
    numbers: Cell<u64>,
}

/// An error at an element of the file.
fn at(scanner: &Scanner<'_>, node: Node<'_, '_>, message: VtuError) -> SceneError {
    marked(scanner, node, SceneError::of(message))
}

/// An error that files of other formats can have, too, at an element.
fn common(scanner: &Scanner<'_>, node: Node<'_, '_>, message: ScanError) -> SceneError {
    marked(scanner, node, SceneError { code: SYNTAX, ..SceneError::of(message) })
}

/// Adds the position of an element to an error that has none yet.
fn marked(scanner: &Scanner<'_>, node: Node<'_, '_>, error: SceneError) -> SceneError {
    let range = node.range();
    let end = scanner.bytes[range.start..].iter().position(|b| *b == b'>').map_or(range.end, |k| range.start + k + 1);
    scanner.mark(error, range.start, end)
}

/// Splits a file into its text without appended data, and those data.
fn split(bytes: &[u8]) -> (Vec<u8>, Option<(&[u8], bool)>) {
    let find = |from: usize, what: &[u8]| bytes[from..].windows(what.len()).position(|w| w == what).map(|k| from + k);
    let Some(start) = find(0, b"<AppendedData") else { return (bytes.to_vec(), None) };
    let Some(tag) = find(start, b">") else { return (bytes.to_vec(), None) };
    let raw = find(start, b"\"raw\"").is_some_and(|k| k < tag) || find(start, b"'raw'").is_some_and(|k| k < tag);
    let Some(mark) = find(tag, b"_") else { return (bytes.to_vec(), None) };
    // Raw bytes may hold anything, so the closing tag is searched for from the end.
    let close = b"</AppendedData>";
    let end = bytes.windows(close.len()).rposition(|w| w == close).filter(|end| *end > mark);
    let Some(end) = end else { return (bytes.to_vec(), None) };
    let head = [&bytes[..=mark], &bytes[end..]].concat();
    (head, Some((&bytes[mark + 1..end], raw)))
}

/// Reads a file.
///
/// # Errors
/// `vtu.syntax`, `vtu.size`, `vtu.compressor` with the line of the array; `mesh.…` for faults of the cells.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Found, SceneError> {
    let (head, appended) = split(bytes);
    let scanner = Scanner::new(file, &head, None);
    let text = match core::str::from_utf8(&head) {
        Ok(text) => text,
        Err(e) => return Err(scanner.error(VtuError::Encoding { byte: e.valid_up_to() }, e.valid_up_to())),
    };
    let options = ParsingOptions { nodes_limit: 1_000_000, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let position = e.pos();
        let from = crate::source::Source { file, text }.offset(position.row as usize, position.col as usize);
        scanner.error(VtuError::Xml { reason: visible(&e.to_string()) }, from)
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "VTKFile" || root.attribute("type") != Some("UnstructuredGrid") {
        let kind = root.attribute("type").unwrap_or(root.tag_name().name());
        return Err(at(&scanner, root, VtuError::Kind { kind: visible(kind) }));
    }
    let compressor = root.attribute("compressor");
    if !matches!(compressor, None | Some("vtkZLibDataCompressor")) {
        let name = visible(compressor.unwrap_or(""));
        return Err(at(&scanner, root, VtuError::Compressor { name }));
    }
    let header = match root.attribute("header_type") {
        None | Some("UInt32") => 4,
        Some("UInt64") => 8,
        Some(other) => return Err(at(&scanner, root, VtuError::HeaderType { word: visible(other) })),
    };
    let big_endian = match root.attribute("byte_order") {
        None | Some("LittleEndian") => false,
        Some("BigEndian") => true,
        Some(other) => return Err(at(&scanner, root, VtuError::ByteOrder { word: visible(other) })),
    };
    let reader = Reader {
        scanner: &scanner,
        big_endian,
        header,
        compressed: compressor.is_some(),
        appended,
        numbers: Cell::new(0),
    };
    let mut found = Found::default();
    let pieces = root.descendants().filter(|node| node.has_tag_name("Piece"));
    let mut any = false;
    for piece in pieces {
        any = true;
        reader.piece(piece, &mut found)?;
    }
    // Cells and nodes without a value take memory, too.
    let items = found.items.len();
    let nodes = found.positions.len();
    let of_nodes = found.node_values.values().map(|field| nodes * field.components - field.values.len());
    let missing = found.item_values.values().map(|values| items - values.len()).chain(of_nodes).sum();
    found.gives(missing).map_err(|e| marked(&scanner, root, e))?;
    found.item_values.values_mut().for_each(|values| values.resize(items, f64::NAN));
    found.node_values.values_mut().for_each(|field| field.values.resize(nodes * field.components, f64::NAN));
    if !any {
        return Err(at(&scanner, root, VtuError::NoPiece {}));
    }
    Ok(found)
}

impl Reader<'_> {
    fn count(&self, piece: Node<'_, '_>, attribute: &'static str) -> Result<u64, SceneError> {
        let text = piece.attribute(attribute).unwrap_or("");
        match text.parse() {
            Ok(count) if count <= 1 << 31 => Ok(count),
            _ => Err(at(self.scanner, piece, VtuError::Count { attribute, word: visible(text) })),
        }
    }

    /// Returns the only element with this name within another element.
    fn only<'a>(
        &self,
        parent: Node<'a, 'a>,
        (what, word): (Doubled, &str),
        wanted: impl Fn(&Node<'a, 'a>) -> bool,
    ) -> Result<Option<Node<'a, 'a>>, SceneError> {
        let mut all = parent.children().filter(wanted);
        let first = all.next();
        match all.next() {
            None => Ok(first),
            Some(second) => Err(at(self.scanner, second, VtuError::Second { what, word: word.into() })),
        }
    }

    /// Returns the array of a name within an element of a piece.
    fn array<'a>(&self, piece: Node<'a, 'a>, of: &str, name: Option<&str>) -> Result<Node<'a, 'a>, SceneError> {
        let tag = || of.to_string();
        let parent =
            self.only(piece, (Doubled::Tag { tag: tag() }, &format!("<{of}>")), |node| node.has_tag_name(of))?;
        let named = || name.map(|name| ArrayName::Named { name: name.into() });
        let is_wanted =
            |node: &Node<'_, '_>| node.has_tag_name("DataArray") && (name.is_none() || node.attribute("Name") == name);
        let found = match parent {
            Some(parent) => {
                let twice = Doubled::Array { name: named(), tag: tag() };
                self.only(parent, (twice, name.unwrap_or("<DataArray>")), is_wanted)?
            }
            None => None,
        };
        let none = || VtuError::NoArray { tag: tag(), name: named() };
        found.ok_or_else(|| at(self.scanner, parent.unwrap_or(piece), none()))
    }

    fn piece(&self, piece: Node<'_, '_>, found: &mut Found) -> Result<(), SceneError> {
        let (points, cells) = (self.count(piece, "NumberOfPoints")?, self.count(piece, "NumberOfCells")?);
        let first = found.positions.len() as u32;
        let first_cell = found.items.len();
        let array = self.array(piece, "Points", None)?;
        let offset = array.range().start;
        if let Some(components) = array.attribute("NumberOfComponents").filter(|components| components.trim() != "3") {
            return Err(at(self.scanner, array, VtuError::Coordinates { components: visible(components) }));
        }
        found.single |= array.attribute("type") == Some("Float32");
        let numbers = self.values(array, points * 3)?;
        for (number, x) in numbers.chunks_exact(3).enumerate() {
            if let Some(bad) = x.iter().find(|x| !x.is_finite()) {
                return Err(at(self.scanner, array, VtuError::NotFinitePoint { point: number, number: *bad }));
            }
            found.node(u64::from(first) + number as u64, [x[0], x[1], x[2]], offset);
        }
        let offset_array = self.array(piece, "Cells", Some("offsets"))?;
        let offsets = self.wholes(offset_array, cells)?;
        let type_array = self.array(piece, "Cells", Some("types"))?;
        let types = self.wholes(type_array, cells)?;
        let total = offsets.last().copied().unwrap_or(0);
        if !(0..=10_000_000_000).contains(&total) {
            return Err(at(self.scanner, offset_array, VtuError::LastOffset { offset: total }));
        }
        let array = self.array(piece, "Cells", Some("connectivity"))?;
        let offset = array.range().start;
        let nodes = self.wholes(array, total as u64)?;
        let mut start = 0;
        for (cell, (&end, kind)) in offsets.iter().zip(types).enumerate() {
            if !(start..=total).contains(&end) {
                return Err(at(self.scanner, offset_array, VtuError::Reach { cell, start, end, most: nodes.len() }));
            }
            vtk::add(found, kind, &nodes[start as usize..end as usize], first, offset).map_err(|error| {
                let of = if error.code == "mesh.unsupported_element" { type_array } else { array };
                marked(self.scanner, of, error)
            })?;
            start = end;
        }
        self.data(piece, (cells, first_cell), (points, first as usize), found)
    }

    /// Reads cell values with one component and point values with up to three components; counts all other values.
    fn data(
        &self,
        piece: Node<'_, '_>,
        (cells, first): (u64, usize),
        (points, first_point): (u64, usize),
        found: &mut Found,
    ) -> Result<(), SceneError> {
        for tag in ["CellData", "PointData"] {
            let twice = Doubled::Tag { tag: tag.into() };
            self.only(piece, (twice, &format!("<{tag}>")), |node| node.has_tag_name(tag))?;
        }
        let mut names = BTreeSet::new();
        for (of, node) in piece.children().filter(Node::is_element).flat_map(|parent| {
            parent.children().filter(|n| n.has_tag_name("DataArray")).map(move |n| (parent.tag_name().name(), n))
        }) {
            let name = node.attribute("Name").unwrap_or("values");
            let components = match node.attribute("NumberOfComponents") {
                None | Some("1" | "0") => 1,
                Some(text) => text.trim().parse().unwrap_or(0),
            };
            // Arrays of strings have a type of their own.
            let numbers = node.attribute("type").and_then(Number::of_xml).is_some();
            let second = || common(self.scanner, node, vtk::values_twice(of == "PointData", name));
            match of {
                "PointData" if numbers && is_kept(components) => {
                    if !names.insert((of, name)) {
                        return Err(second());
                    }
                    let own = self.values(node, points * components)?;
                    let kept = found.values_of_nodes(name, first_point, components as usize, own.into_iter());
                    kept.map_err(|e| marked(self.scanner, node, e))?;
                }
                "CellData" if components == 1 => {
                    if !names.insert((of, name)) {
                        return Err(second());
                    }
                    let own = self.values(node, cells)?;
                    let before = found.item_values.get(name).map_or(0, Vec::len);
                    found.gives(first - before + own.len()).map_err(|e| marked(self.scanner, node, e))?;
                    let values = found.item_values.entry(name.to_string()).or_default();
                    values.resize(first, f64::NAN);
                    values.extend(own);
                }
                "CellData" | "PointData" => {
                    found.left_out(MeshFileNotice::Values { name: visible(name) });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads an array of exactly `count` numbers.
    fn values(&self, array: Node<'_, '_>, count: u64) -> Result<Vec<f64>, SceneError> {
        self.numbers(array, count, |value| Ok(value.real()))
    }

    /// Reads an array of exactly `count` whole numbers, whatever its type.
    fn wholes(&self, array: Node<'_, '_>, count: u64) -> Result<Vec<i128>, SceneError> {
        self.numbers(array, count, |value| {
            value.whole().map_err(|number| at(self.scanner, array, VtuError::NotWhole { number }))
        })
    }

    fn numbers<T>(
        &self,
        array: Node<'_, '_>,
        count: u64,
        made: impl Fn(Value) -> Result<T, SceneError>,
    ) -> Result<Vec<T>, SceneError> {
        let name = array.attribute("type").unwrap_or("");
        let Some(kind) = Number::of_xml(name) else {
            let allowed = "Int8 … UInt64, Float32, Float64";
            return Err(common(self.scanner, array, ScanError::NumberType { word: visible(name), allowed }));
        };
        let size = kind.size();
        let text: String = array.children().filter_map(|n| n.text()).collect();
        let bytes = match array.attribute("format") {
            Some("ascii") | None => return self.words(array, &text, count, kind, made),
            Some("binary") => {
                let letters: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace()).collect();
                self.unpack(array, &letters, false, count, size)?
            }
            Some("appended") => {
                let Some((data, raw)) = self.appended else {
                    return Err(at(self.scanner, array, VtuError::NothingAppended {}));
                };
                let offset = array.attribute("offset").and_then(|text| text.parse::<usize>().ok());
                let Some(rest) = offset.and_then(|offset| data.get(offset..)) else {
                    let offset = visible(array.attribute("offset").unwrap_or("no offset"));
                    return Err(at(self.scanner, array, VtuError::BehindAppended { offset, most: data.len() }));
                };
                self.unpack(array, rest, raw, count, size)?
            }
            Some(other) => return Err(at(self.scanner, array, VtuError::ArrayFormat { word: visible(other) })),
        };
        bytes.chunks_exact(size).map(|word| made(kind.of_bytes(word, self.big_endian))).collect()
    }

    /// Counts the numbers in binary arrays. The size of the file does not limit them: compressed arrays take few bytes, and appended data may be
    /// referenced repeatedly.
    fn counted(&self, array: Node<'_, '_>, count: u64) -> Result<(), SceneError> {
        self.numbers.set(self.numbers.get().saturating_add(count));
        let available = (self.scanner.bytes.len() + self.appended.map_or(0, |(data, _)| data.len())) as u64;
        let counted = NUMBERS.check_beside(self.numbers.get(), NUMBERS_PER_BYTE.saturating_mul(available));
        counted.map_err(|e| marked(self.scanner, array, e.advice(LimitHint::Compression)))
    }

    fn wrong_count(&self, array: Node<'_, '_>, there: u64, count: u64) -> SceneError {
        at(self.scanner, array, VtuError::ArraySize { there, count })
    }

    fn words<T>(
        &self,
        array: Node<'_, '_>,
        text: &str,
        count: u64,
        kind: Number,
        made: impl Fn(Value) -> Result<T, SceneError>,
    ) -> Result<Vec<T>, SceneError> {
        let mut out = Vec::new();
        for word in text.split_ascii_whitespace() {
            let refused = |range| at(self.scanner, array, VtuError::NotOfArray { word: visible(word), range });
            out.push(made(kind.of_word(word).map_err(refused)?)?);
        }
        if out.len() as u64 == count { Ok(out) } else { Err(self.wrong_count(array, out.len() as u64, count)) }
    }

    /// Returns the bytes of a binary array: a header with sizes, then the data. Header and data are either raw bytes or letters.
    fn unpack(
        &self,
        array: Node<'_, '_>,
        data: &[u8],
        raw: bool,
        count: u64,
        size: usize,
    ) -> Result<Vec<u8>, SceneError> {
        let wanted = count * size as u64;
        let cut = || at(self.scanner, array, VtuError::Cut { there: data.len(), wanted });
        let letters = || at(self.scanner, array, VtuError::Base64 {});
        // At least `least` bytes from the beginning.
        let take = |least: u64| -> Result<Vec<u8>, SceneError> {
            let least = usize::try_from(least).map_err(|_| cut())?;
            let bytes = if raw {
                data.get(..least).ok_or_else(cut)?.to_vec()
            } else {
                base64::decode_up_to(letters_of(data), least).ok_or_else(letters)?.0
            };
            if bytes.len() < least { Err(cut()) } else { Ok(bytes) }
        };
        let word = |bytes: &[u8], k: usize| {
            let mut eight = [0; 8];
            eight[..self.header].copy_from_slice(&bytes[k * self.header..(k + 1) * self.header]);
            if self.big_endian {
                eight[..self.header].reverse();
            }
            u64::from_le_bytes(eight)
        };
        let header = self.header as u64;
        if !self.compressed {
            let own = word(&take(header)?, 0);
            if own != wanted {
                return Err(self.wrong_count(array, own / size as u64, count));
            }
            let bytes = take(header + wanted)?;
            self.counted(array, count)?;
            return Ok(bytes[self.header..][..wanted as usize].to_vec());
        }
        // Number of blocks, their size, the size of the last one, then the compressed sizes.
        let blocks = word(&take(header)?, 0);
        if blocks > wanted + 1 {
            return Err(self.wrong_count(array, blocks, count));
        }
        let head = take(header * (3 + blocks))?;
        let (block, last) = (word(&head, 1), word(&head, 2));
        let plain = |k: u64| if k + 1 == blocks && last > 0 { last } else { block };
        let mut total = 0u64;
        let mut packed = 0u64;
        for k in 0..blocks {
            total = total.saturating_add(plain(k));
            packed = packed.saturating_add(word(&head, 3 + k as usize));
        }
        if total != wanted || total > packed.saturating_mul(MOST_COMPRESSED) + MOST_COMPRESSED {
            return Err(self.wrong_count(array, total / size as u64, count));
        }
        self.counted(array, count)?;
        let start = (header * (3 + blocks)) as usize;
        let bytes = take((start as u64).saturating_add(packed))?;
        let (mut at_byte, mut out) = (start, Vec::with_capacity(wanted as usize));
        for k in 0..blocks {
            let length = word(&head, 3 + k as usize) as usize;
            let own = bytes.get(at_byte..at_byte + length).ok_or_else(cut)?;
            at_byte += length;
            let mut piece = Vec::new();
            let read = flate2::read::ZlibDecoder::new(own).take(plain(k) + 1).read_to_end(&mut piece);
            if read.is_err() || piece.len() as u64 != plain(k) {
                let error = VtuError::Block { block: k, there: piece.len(), wanted: plain(k) };
                return Err(at(self.scanner, array, error));
            }
            out.extend_from_slice(&piece);
        }
        Ok(out)
    }
}

/// The letters without blanks at the end; appended data may be followed by a line end.
fn letters_of(data: &[u8]) -> &[u8] {
    data.trim_ascii()
}
