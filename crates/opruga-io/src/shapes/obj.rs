//! Wavefront OBJ: vertices and polygons, line by line.
//!
//! The reader takes `v`, `f` (polygons, which are divided into triangles; indices count from 1, or from the end if negative), `o` and `g` (groups of
//! vertices). `vt`, `vn`, `vp`, `s`, `usemtl`, `mtllib` and comments are irrelevant for a body, but the `vt` and `vn` that faces name must exist.
//! Lines and points (`l`, `p`) and weights of vertices are counted and omitted; everything else is refused. A `\` at the end of a line continues the
//! statement on the next line.
//!
//! # Source
//! Wavefront Technologies, Object Files, version 3.0.

use super::surface_errors::{ObjError, ObjNotice, SurfaceNotice};
use super::triangles::{Locations, Triangles};
use crate::meshes::NumberHint;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::message::AnyMessage;
use std::collections::BTreeMap;

/// A polygon as it is written in the file, before all vertices are known.
struct Face {
    line: u32,
    corners: (usize, usize),
    group: Option<usize>,
}

/// Reads the file.
///
/// # Errors
/// `obj.syntax`, `mesh.index`, `mesh.degenerate_face` with the line.
pub(super) fn read(source: &Source<'_>) -> Result<Triangles, SceneError> {
    let mut statements = Statements::default();
    let mut start = 0;
    while start < source.text.len() {
        let line = Line::at(source, start);
        start += line.text.len();
        let mut words = line.words();
        let Some(word) = words.next() else { continue };
        match word {
            "v" => statements.vertex(&line, word, words)?,
            "f" => statements.face(&line, words)?,
            "o" | "g" => statements.group(words.collect::<Vec<_>>().join(" ")),
            "l" | "p" => statements.strokes += 1,
            "vt" => statements.extras[0] += 1,
            "vn" => statements.extras[1] += 1,
            "vp" | "s" | "usemtl" | "mtllib" | "usemap" | "maplib" => {}
            _ => return Err(line.refuse(word, ObjError::Statement { word: visible(word) })),
        }
    }
    statements.check_extras(source)?;
    statements.count_left_out();
    statements.triangles(source)
}

/// A line together with its continuation lines.
struct Line<'a> {
    source: &'a Source<'a>,
    start: usize,
    text: &'a str,
}

impl<'a> Line<'a> {
    fn at(source: &'a Source<'a>, start: usize) -> Line<'a> {
        let (mut end, mut goes_on) = (start, true);
        while goes_on && end < source.text.len() {
            let piece = source.text[end..].split_inclusive('\n').next().unwrap_or("");
            end += piece.len();
            goes_on = statement(piece).1;
        }
        Line { source, start, text: &source.text[start..end] }
    }

    fn words(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.text.split_inclusive('\n').flat_map(|piece| statement(piece).0.split_ascii_whitespace())
    }

    /// The range of a part of the line in the file.
    fn range(&self, part: &str) -> (usize, usize) {
        let from = self.start + (part.as_ptr() as usize - self.text.as_ptr() as usize);
        (from, from + part.len())
    }

    /// An error at a part of the line; the part is the value.
    fn refuse(&self, part: &str, error: impl Into<AnyMessage>) -> SceneError {
        self.mark(part, SceneError::of(error))
    }

    fn mark(&self, part: &str, error: SceneError) -> SceneError {
        let (from, to) = self.range(part);
        self.source.mark(error.value(visible(part)), from, to)
    }

    /// An error at a part of the line; the whole statement is the value.
    fn refuse_whole(&self, part: &str, error: ObjError) -> SceneError {
        self.refuse(part, error).value(visible(statement(self.text).0.trim()))
    }

    fn number(&self, part: &str) -> Result<f64, SceneError> {
        number(part).map_err(|error| self.mark(part, error))
    }
}

/// The result of the statements of a file.
#[derive(Default)]
struct Statements {
    found: Triangles,
    faces: Vec<Face>,
    /// Vertices of all faces.
    corners: Vec<i64>,
    /// Groups of vertices, the index of each name, and the present group.
    names: Vec<String>,
    numbers: BTreeMap<String, usize>,
    group: Option<usize>,
    /// The number of lines and points, and of vertices with weights.
    strokes: usize,
    weighed: usize,
    /// The numbers of `vt` and `vn`, and the largest index of each that a face names, with its range in the file.
    extras: [i64; 2],
    largest: [(i64, usize, usize); 2],
}

impl Statements {
    /// `v x y z [w]` or `v x y z r g b`.
    fn vertex<'a>(
        &mut self,
        line: &Line<'a>,
        word: &str,
        mut words: impl Iterator<Item = &'a str>,
    ) -> Result<(), SceneError> {
        let mut position = [0.0; 3];
        for x in &mut position {
            let Some(part) = words.next() else { return Err(line.refuse_whole(word, ObjError::FewCoordinates {})) };
            *x = line.number(part)?;
        }
        // A weight or a colour may follow.
        let more: Vec<&str> = words.collect();
        if more.len() > 4 {
            return Err(line.refuse(more[4], ObjError::ManyNumbers {}));
        }
        if more.len() == 2 {
            return Err(line.refuse_whole(more[1], ObjError::FiveNumbers {}));
        }
        let numbers = more.into_iter().map(|part| line.number(part)).collect::<Result<Vec<_>, _>>()?;
        // Three additional numbers are a colour.
        self.weighed += usize::from(numbers.len() % 3 == 1 && numbers[0] != 1.0);
        self.found.positions.push(position);
        Ok(())
    }

    /// `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face<'a>(&mut self, line: &Line<'a>, words: impl Iterator<Item = &'a str>) -> Result<(), SceneError> {
        let from = self.corners.len();
        for part in words {
            let index = part.split('/').next().unwrap_or("");
            let corner = || line.refuse(part, ObjError::Corner {});
            let index: i64 = index.parse().map_err(|_| corner())?;
            let count = self.found.positions.len() as i64;
            if index == 0 || index < -count {
                let zero = index == 0;
                let error = if zero { ObjError::Zero { count } } else { ObjError::BeforeFirst { count } };
                return Err(line.refuse(part, error));
            }
            self.corners.push(if index < 0 { count + index } else { index - 1 });
            for (k, text) in part.split('/').skip(1).enumerate() {
                if text.is_empty() && k < 2 {
                    continue;
                }
                let index = text.parse::<i64>().ok().filter(|index| k < 2 && *index != 0);
                let Some(index) = index else { return Err(corner()) };
                // An index before the first can never become valid.
                let wanted = if index < -self.extras[k] { i64::MAX } else { index };
                if wanted > self.largest[k].0 {
                    let (from, to) = line.range(part);
                    self.largest[k] = (wanted, from, to);
                }
            }
        }
        let corners = (from, self.corners.len());
        self.faces.push(Face { line: line.start as u32, corners, group: self.group });
        Ok(())
    }

    /// `o NAME` or `g NAME`: the following faces belong to this group.
    fn group(&mut self, name: String) {
        self.group = (!name.is_empty()).then(|| {
            *self.numbers.entry(name).or_insert_with_key(|name| {
                self.names.push(name.clone());
                self.names.len() - 1
            })
        });
    }

    /// Counts parts that are irrelevant for a body.
    fn count_left_out(&mut self) {
        if self.strokes > 0 {
            self.found.notices.push(SceneError::of(SurfaceNotice::Strokes { count: self.strokes }));
        }
        if self.weighed > 0 {
            self.found.notices.push(SceneError::of(ObjNotice::Weights { count: self.weighed }));
        }
    }

    /// Refuses faces that name a missing `vt` or `vn`.
    fn check_extras(&self, source: &Source<'_>) -> Result<(), SceneError> {
        for (k, name) in ["vt", "vn"].into_iter().enumerate() {
            let (index, from, to) = self.largest[k];
            if index > self.extras[k] {
                let error = match self.extras[k] {
                    0 => ObjError::NoExtras { what: name },
                    count => ObjError::NoExtra { what: name, count },
                };
                return Err(source.mark(SceneError::of(error), from, to).value(visible(&source.text[from..to])));
            }
        }
        Ok(())
    }

    /// Converts the faces to triangles, and collects the vertices of the groups.
    fn triangles(self, source: &Source<'_>) -> Result<Triangles, SceneError> {
        let Statements { mut found, faces, corners, names, .. } = self;
        let mut lines = Vec::with_capacity(faces.len());
        let mut groups: Vec<Vec<u32>> = vec![Vec::new(); names.len()];
        let count = found.positions.len();
        for face in faces {
            let at = face.line as usize;
            let end = source.text[at..].find(['\n', '\r', '#']).map_or(source.text.len(), |k| at + k);
            let own = &corners[face.corners.0..face.corners.1];
            if let Some(far) = own.iter().find(|c| **c >= count as i64) {
                let error = SceneError::of(ObjError::NoVertexOfFile { vertex: far + 1, count });
                return Err(source.mark(error, at, end));
            }
            let own: Vec<u32> = own.iter().map(|c| *c as u32).collect();
            match found.polygon(&own) {
                Ok(n) => lines.extend(std::iter::repeat_n(face.line, n)),
                Err(problem) => {
                    let value = visible(source.text[at..end].trim());
                    return Err(source.mark(SceneError::of(problem), at, end).value(value));
                }
            }
            if let Some(group) = face.group {
                groups[group].extend(own);
            }
        }
        for (name, mut nodes) in names.into_iter().zip(groups) {
            nodes.sort_unstable();
            nodes.dedup();
            if !nodes.is_empty() {
                found.groups.insert(name, nodes);
            }
        }
        found.locations = Locations::Lines(lines);
        Ok(found)
    }
}

/// A line without its comment, and whether a `\` continues its statement on the next line.
fn statement(line: &str) -> (&str, bool) {
    let Some((before, _)) = line.split_once('#') else {
        let text = line.trim_end_matches(['\n', '\r']);
        return text.strip_suffix('\\').map_or((text, false), |before| (before, true));
    };
    (before, false)
}

/// A finite number with a decimal point, independently of the locale.
pub(super) fn number(text: &str) -> Result<f64, SceneError> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(SceneError::of(ObjError::NotFiniteNumberOfVertex {})),
        Err(_) if text.contains(',') => Err(SceneError::of(ObjError::NoNumber {}).advice(NumberHint::Comma)),
        Err(_) => Err(SceneError::of(ObjError::NoNumber {})),
    }
}
